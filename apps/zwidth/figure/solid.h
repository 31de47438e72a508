#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "figure/svg.h"

#include "zwidth/math/spatial.h"

/// Shaded solids seen from a corner, as inline SVG.

namespace zwidth {

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
  /// A flat pane between closed curves of one plane, holes left out, with its edges.
  void pane(const std::vector<std::vector<Vector3>>& curves, std::string_view css_class);
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
