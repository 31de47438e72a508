#pragma once

#include <vector>

#include "figure/svg.h"

#include "zwidth/math/spatial.h"

/// Values over a plane, and the curves between them.

namespace zwidth {

/// Values on a regular grid, NaN where there is none.
struct Field {
  Interval x;  ///< of the first and last column
  Interval y;  ///< of the first and last row
  int columns = 0;
  int rows = 0;
  std::vector<double> values;  ///< row after row

  double at(int column, int row) const { return values[static_cast<size_t>(row) * columns + column]; }
};

/// A field whose values reach `rounds` cells beyond their region, so that bands can be cut along a smooth
/// outline.
Field spread(const Field& field, int rounds);

/// 1 where the field has a value, 0 elsewhere, averaged over 3 x 3 cells.
Field presence(const Field& field);

/// Closed curves around where the field is at least `threshold`, in cell coordinates (marching squares).
std::vector<std::vector<Point2>> contours(const Field& field, double threshold);

/// The points of a curve without those that lie within `tolerance` of the line through the others (Douglas &
/// Peucker 1973). Its ends stay.
std::vector<Point2> simplified(const std::vector<Point2>& points, double tolerance);

}  // namespace zwidth
