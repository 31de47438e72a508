#include "figure/solid.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <utility>

#include "figure/field.h"

namespace zwidth {

Solid::Solid(double width, double height, double azimuth, double elevation, double scale, const Vector3& centre)
    : width_(width), height_(height), scale_(scale), centre_(centre) {
  towards_ = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
              std::sin(elevation)};
  right_ = Vector3(-std::sin(azimuth), std::cos(azimuth), 0.0);
  up_ = towards_.cross(right_);
}

Point2 Solid::project(const Vector3& point) const {
  const Vector3 d = point - centre_;
  return {width_ / 2.0 + scale_ * d.dot(right_), height_ / 2.0 - scale_ * d.dot(up_)};
}

double Solid::depth(const Vector3& point) const {
  return (point - centre_).dot(towards_);
}

namespace {

std::string colour(const Vector3& rgb) {
  const auto channel = [](double v) { return static_cast<int>(std::clamp(std::lround(v), 0L, 255L)); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(rgb.x()), channel(rgb.y()), channel(rgb.z()));
}

}  // namespace

void Solid::polygon(const std::vector<Vector3>& corners, const Vector3& rgb, double opacity,
                    double edge_opacity, double behind) {
  Vector3 normal = Vector3::Zero();
  Vector3 middle = Vector3::Zero();
  for (size_t i = 0; i < corners.size(); ++i) {
    normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
    middle += corners[i] / static_cast<double>(corners.size());
  }
  if (normal.norm() == 0.0) return;
  normal.normalize();
  if (normal.dot(towards_) < 0.0) normal = -normal;
  const Vector3 light = (0.75 * towards_ + 0.75 * up_ - 0.45 * right_).normalized();
  const double shade = 0.62 + 0.42 * std::max(0.0, normal.dot(light));
  std::string d;
  for (const Vector3& corner : corners) {
    const Point2 at = project(corner);
    d += fmt::format("{}{} {}", d.empty() ? "M" : "L", pixel(at.x), pixel(at.y));
  }
  const std::string fill = colour(shade * rgb);
  std::string svg = fmt::format("<path d=\"{}Z\" fill=\"{}\"", d, fill);
  if (opacity < 1.0) svg += fmt::format(" fill-opacity=\"{:.2g}\"", opacity);
  if (edge_opacity > 0.0) {
    svg += fmt::format(" stroke=\"{}\" stroke-opacity=\"{:.2g}\" stroke-width=\".7\" stroke-linejoin=\"round\"",
                       colour(0.75 * shade * rgb), edge_opacity);
  } else if (opacity >= 1.0) {
    svg += fmt::format(" stroke=\"{}\" stroke-width=\".6\" stroke-linejoin=\"round\"", fill);
  }
  add(depth(middle) - behind, svg + "/>");
}

void Solid::bar(const Vector3& a, const Vector3& b, double radius, const Vector3& rgb) {
  // Short pieces sort correctly against what they pass; balls round the ends.
  const int parts = 8;
  const Vector3 along = (b - a).normalized();
  const double facing = std::sqrt(std::max(0.0, 1.0 - std::pow(along.dot(towards_), 2)));
  const Vector3 shaded = rgb * (0.8 + 0.2 * facing);
  const double width = 2.0 * radius * scale_;
  const Vector3 overlap = along * (0.5 / scale_);
  for (int i = 0; i < parts; ++i) {
    const Vector3 from = a + (b - a) * i / parts;
    const Vector3 to = a + (b - a) * (i + 1) / parts;
    const Point2 p = project(i == 0 ? from : Vector3(from - overlap));
    const Point2 q = project(i + 1 == parts ? to : Vector3(to + overlap));
    const double nx = -(q.y - p.y);
    const double ny = q.x - p.x;
    const double norm = std::max(1e-9, std::hypot(nx, ny));
    // The lit edge lies on the side of the light, up and left.
    const double side = (nx * -0.5 + ny * -0.85) > 0.0 ? 1.0 : -1.0;
    const auto stroke = [&](double shift, double share, const Vector3& tint) {
      const double ox = side * nx / norm * width * shift;
      const double oy = side * ny / norm * width * shift;
      return fmt::format("<path d=\"M{} {}L{} {}\" stroke=\"{}\" stroke-width=\"{}\"/>", pixel(p.x + ox),
                         pixel(p.y + oy), pixel(q.x + ox), pixel(q.y + oy), colour(tint), pixel(width * share));
    };
    add(depth(0.5 * (from + to)) + radius, stroke(0.0, 1.0, 0.62 * shaded) + stroke(0.03, 0.74, 0.9 * shaded) +
                                               stroke(0.16, 0.3, Vector3::Constant(40.0) + 0.98 * shaded));
  }
  for (const Vector3& end : {a, b}) {
    const Point2 at = project(end);
    add(depth(end) + 0.9 * radius,
        fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>", pixel(at.x), pixel(at.y),
                    pixel(0.5 * width), colour(0.72 * shaded)));
  }
}

void Solid::ball(const Vector3& centre, double radius, const Vector3& rgb) {
  const Point2 at = project(centre);
  const double r = radius * scale_;
  std::string svg = fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>", pixel(at.x), pixel(at.y),
                                pixel(r), colour(0.6 * rgb));
  svg += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>", pixel(at.x - 0.1 * r),
                     pixel(at.y - 0.1 * r), pixel(0.82 * r), colour(0.92 * rgb));
  svg += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>", pixel(at.x - 0.3 * r),
                     pixel(at.y - 0.35 * r), pixel(0.32 * r), colour(Vector3::Constant(60.0) + rgb));
  add(depth(centre) + radius, svg);
}

void Solid::plate(const std::vector<Vector3>& corners, const Vector3& thickness, const Vector3& rgb,
                  double opacity) {
  std::vector<Vector3> other;
  for (const Vector3& corner : corners) other.push_back(corner + thickness);
  for (size_t i = 0; i < corners.size(); ++i) {
    const size_t j = (i + 1) % corners.size();
    polygon({corners[i], corners[j], other[j], other[i]}, 0.85 * rgb, opacity);
  }
  polygon(corners, rgb, opacity);
  polygon(other, rgb, opacity);
}

void Solid::pane(const std::vector<std::vector<Vector3>>& curves, std::string_view css_class) {
  std::string d;
  Vector3 middle = Vector3::Zero();
  double points = 0.0;
  for (const auto& curve : curves) {
    std::vector<Point2> projected;
    for (const Vector3& point : curve) {
      middle += point;
      points += 1.0;
      projected.push_back(project(point));
    }
    bool first = true;
    for (const Point2& at : simplified(projected, 0.4)) {
      d += fmt::format("{}{} {}", first ? "M" : "L", pixel(at.x), pixel(at.y));
      first = false;
    }
    d += "Z";
  }
  if (points > 0.0)
    add(depth(middle / points),
        fmt::format("<path class=\"{}\" fill-rule=\"evenodd\" d=\"{}\"/>", css_class, d));
}

void Solid::thread(const Vector3& a, const Vector3& b, std::string_view css_class) {
  const Point2 p = project(a);
  const Point2 q = project(b);
  add(-1e9, fmt::format("<path class=\"{}\" d=\"M{} {}L{} {}\"/>", css_class, pixel(p.x), pixel(p.y),
                        pixel(q.x), pixel(q.y)));
}

void Solid::text(const Vector3& at, std::string_view text, std::string_view anchor, double dx, double dy) {
  const Point2 p = project(at);
  over_ += fmt::format("<text class=\"halo\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>", pixel(p.x + dx),
                       pixel(p.y + dy), anchor, escaped(text));
}

void Solid::layer(double opacity) {
  layers_.push_back({opacity, {}});
}

std::string Solid::svg(std::string_view title) const {
  std::string result = fmt::format(
      "<svg class=\"figure\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\"><title>{2}</title>",
      pixel(width_), pixel(height_), escaped(title));
  for (const Layer& layer : layers_) {
    std::vector<const Piece*> sorted;
    for (const Piece& piece : layer.pieces) sorted.push_back(&piece);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Piece* a, const Piece* b) { return a->depth < b->depth; });
    result += fmt::format("<g opacity=\"{:.2g}\">", layer.opacity);
    for (const Piece* piece : sorted) result += piece->svg;
    result += "</g>";
  }
  return result + over_ + "</svg>";
}

}  // namespace zwidth
