#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "zwidth/math/spatial.h"

/// Figures as inline SVG: plots with axes, filled maps, and shaded solids. Colours that must follow the page's
/// light or dark theme are CSS classes (`figure_style`), colours that carry a value are written out.

namespace zwidth {

struct Point2 {
  double x = 0.0;
  double y = 0.0;
};

/// CSS for the classes that figures use: inside a page it follows the theme.
std::string_view figure_style();

/// `text` with the characters that HTML and SVG reserve written as entities.
std::string escaped(std::string_view text);

/// Colour "#rrggbb" of a share 0..1 on a perceptually even dark-to-light scale.
std::string map_colour(double share);

/// Round values that divide a range into about `count` steps.
std::vector<double> round_ticks(double min, double max, int count);

struct Axis {
  std::string label;  ///< with its unit
  Interval range;
  bool logarithmic = false;
};

/// Values on a regular grid, NaN where there is none.
struct Field {
  Interval x;  ///< of the first and last column
  Interval y;  ///< of the first and last row
  int columns = 0;
  int rows = 0;
  std::vector<double> values;  ///< row after row

  double at(int column, int row) const { return values[static_cast<size_t>(row) * columns + column]; }
};

/// A plot in the making. Series are numbered 1..4 and have a colour each.
class Plot {
 public:
  Plot(double width, double height, Axis x, Axis y)
      : width_(width), height_(height), x_(std::move(x)), y_(std::move(y)) {}

  /// One unit takes the same length along both axes; the plot's height follows. Call it before anything is
  /// drawn.
  void keep_shape();
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
  void mark(Point2 point, std::string_view text);
  void silhouette(const std::vector<std::array<Point2, 3>>& triangles);     ///< their union, as a faint shadow
  void curves(const std::vector<std::vector<Point2>>& closed, int series);  ///< closed curves, filled
  /// The figure; `title` is read out by screen readers.
  std::string svg(std::string_view title) const;

 private:
  double px(double x) const;
  double py(double y) const;
  std::string path(const std::vector<Point2>& points) const;
  std::string regions(const Field& field, double threshold) const;
  double right_margin() const { return scale_.empty() ? 14.0 : 66.0; }

  double width_;
  double height_;
  Axis x_;
  Axis y_;
  std::string body_;
  std::string over_;   // drawn above the axes
  std::string scale_;  // colour scale at the right
  std::vector<std::pair<int, std::string>> legend_;
};

/// Solids and lines seen from a corner, drawn far to near.
class Solid {
 public:
  /// The view looks along `azimuth` and down by `elevation` [rad]; `scale` is pixels per metre.
  Solid(double width, double height, double azimuth, double elevation, double scale, const Vector3& centre);

  /// A flat polygon, shaded by how it faces the light. `rgb` 0..255; `behind` moves it away from the viewer
  /// [m].
  void polygon(const std::vector<Vector3>& corners, const Vector3& rgb, double opacity,
               double edge_opacity = 0.0, double behind = 0.0);
  /// A round bar from a to b of `radius` [m].
  void bar(const Vector3& a, const Vector3& b, double radius, const Vector3& rgb);
  void ball(const Vector3& centre, double radius, const Vector3& rgb);
  /// A plate between a polygon and the same polygon moved by `thickness`.
  void plate(const std::vector<Vector3>& corners, const Vector3& thickness, const Vector3& rgb,
             double opacity = 1.0);
  /// A thin line of the theme's colour.
  void thread(const Vector3& a, const Vector3& b, std::string_view css_class);
  void text(const Vector3& at, std::string_view text, std::string_view anchor = "middle", double dx = 0.0,
            double dy = 0.0);

  /// What follows is drawn above what came before, as one sheet of glass of this opacity.
  void layer(double opacity);
  /// The surface turns towards the viewer.
  bool faces_viewer(const Vector3& normal) const { return normal.dot(towards_) > 0.0; }

  std::string svg(std::string_view title) const;

 private:
  struct Piece {
    double depth;
    std::string svg;
  };
  Point2 project(const Vector3& point) const;
  double depth(const Vector3& point) const;

  double width_;
  double height_;
  double scale_;
  Vector3 centre_;
  Vector3 right_;
  Vector3 up_;
  Vector3 towards_;
  struct Layer {
    double opacity = 1.0;
    std::vector<Piece> pieces;
  };
  void add(double depth, std::string svg) { layers_.back().pieces.push_back({depth, std::move(svg)}); }
  std::vector<Layer> layers_{1};
  std::string over_;
};

}  // namespace zwidth
