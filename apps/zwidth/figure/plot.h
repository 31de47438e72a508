#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "figure/field.h"

/// Plots with axes, series and filled maps, as inline SVG.

namespace zwidth {

struct Axis {
  std::string label;  ///< with its unit
  Interval range;
  bool logarithmic = false;
};

/// A plot in the making. Series are numbered 1..4 and have a colour each.
class Plot {
 public:
  Plot(double width, double height, Axis x, Axis y)
      : width_(width), height_(height), x_(std::move(x)), y_(std::move(y)) {
    make_room();
  }

  /// One unit takes the same length along both axes; the plot's height follows. `with_scale`: colours will be
  /// explained at the right. Call it before anything is drawn.
  void keep_shape(bool with_scale = true);
  void line(const std::vector<Point2>& points, int series, std::string_view label = {}, bool dashed = false);
  /// Holds each value until the next.
  void steps(const std::vector<Point2>& points, int series, std::string_view label = {});
  void dots(const std::vector<Point2>& points, int series, std::string_view label = {});
  /// Bands of colour within closed curves, and their scale at the right. Call it before anything else is drawn.
  void map(const Field& field, const std::vector<std::vector<Point2>>& boundary, std::string_view label,
           Interval range);
  enum class Side { right_above, left_below };
  void horizontal(double y, std::string_view text,
                  Side side = Side::right_above);  ///< a reference line with its name
  void vertical(double x, std::string_view text);
  void circle(Point2 centre, double radius, std::string_view text);
  void rectangle(Point2 centre, double side, std::string_view text);
  /// A point with its name, which keeps clear of the names of marks before it.
  void mark(Point2 point, std::string_view text, int series = 2);
  void silhouette(const std::vector<std::array<Point2, 3>>& triangles);     ///< their union, as a faint shadow
  void curves(const std::vector<std::vector<Point2>>& closed, int series);  ///< closed curves, filled
  /// Closed curves filled with a colour that carries a value, holes left out.
  void area(const std::vector<std::vector<Point2>>& closed, std::string_view rgb);
  void edge(const std::vector<std::vector<Point2>>& closed);  ///< closed curves as thin lines
  /// What the colours of areas mean, at the right, first at the bottom. Call it before anything else is drawn.
  void swatches(const std::vector<std::pair<std::string_view, std::string_view>>& meaning);
  /// A link of a mechanism, as wide as said [px].
  void bar(Point2 a, Point2 b, double width, std::string_view rgb);
  void disc(Point2 centre, double radius, std::string_view rgb);  ///< a joint; radius [px]
  void ground(Point2 centre, double size);                        ///< a joint fixed to the ground; size [px]
  /// The figure; `title` is read out by screen readers.
  std::string svg(std::string_view title) const;

 private:
  double px(double x) const;
  double py(double y) const;
  std::string path(const std::vector<Point2>& points) const;
  std::string regions(const Field& field, double threshold) const;
  void make_room();
  double right_margin() const;

  /// Where the name of a mark stands [px].
  struct MarkName {
    double x = 0.0, y = 0.0, width = 0.0;
    bool at_left = false;
  };

  double width_;
  double height_;
  Axis x_;
  Axis y_;
  double left_ = 0.0;  // margins [px]
  double right_ = 0.0;
  std::vector<MarkName> marks_;
  std::string body_;
  std::string over_;   // drawn above the axes
  std::string scale_;  // colour scale at the right
  std::vector<std::pair<int, std::string>> legend_;
};

}  // namespace zwidth
