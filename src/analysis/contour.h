#pragma once

#include <vector>

#include "zwidth/analysis/workspace.h"

namespace zwidth {

/// Values on a regular grid of a plane, NaN where there is none.
struct PlaneGrid {
  Interval u, v;               ///< of the first and last point [m]
  int nu = 0, nv = 0;          ///< points
  std::vector<double> values;  ///< [iv * nu + iu]

  double at(int iu, int iv) const { return values[static_cast<std::size_t>(iv) * nu + iu]; }
};

/// Closed lines round the regions where the values are at least `level`, with the region on their left, by
/// marching squares and linear interpolation. Beyond the rim, and where there is no value, counts as below.
/// REQUIRES: at least two points along each side.
std::vector<Outline> contours(const PlaneGrid& grid, double level);

/// Area within such lines, holes taken off [m^2].
double area_within(const std::vector<Outline>& outlines);

}  // namespace zwidth
