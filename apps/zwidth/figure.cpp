#include "figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <utility>

#include "terminal.h"

namespace zwidth {

namespace {

constexpr double kLeft = 58.0;
constexpr double kTop = 14.0;
constexpr double kBottom = 46.0;
constexpr int kBands = 14;

std::string pixel(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

/// Viridis at ten even steps (van der Walt & Smith 2015).
constexpr std::array<std::array<int, 3>, 10> kViridis = {{{68, 1, 84},
                                                          {72, 40, 120},
                                                          {62, 74, 137},
                                                          {49, 104, 142},
                                                          {38, 130, 142},
                                                          {31, 158, 137},
                                                          {53, 183, 121},
                                                          {109, 205, 89},
                                                          {180, 222, 44},
                                                          {253, 231, 37}}};

/// A field whose values reach a few cells beyond their region, so that bands can be cut along a smooth outline.
Field spread(const Field& field, int rounds) {
  Field result = field;
  for (int round = 0; round < rounds; ++round) {
    const Field before = result;
    for (int r = 0; r < field.rows; ++r) {
      for (int c = 0; c < field.columns; ++c) {
        if (!std::isnan(before.at(c, r))) continue;
        double sum = 0.0;
        int count = 0;
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const int rr = r + dr;
            const int cc = c + dc;
            if (rr < 0 || cc < 0 || rr >= field.rows || cc >= field.columns || std::isnan(before.at(cc, rr)))
              continue;
            sum += before.at(cc, rr);
            ++count;
          }
        }
        if (count > 0) result.values[static_cast<size_t>(r) * field.columns + c] = sum / count;
      }
    }
  }
  return result;
}

/// 1 where the field has a value, 0 elsewhere, averaged over 3 x 3 cells.
Field presence(const Field& field) {
  Field result = field;
  for (int r = 0; r < field.rows; ++r) {
    for (int c = 0; c < field.columns; ++c) {
      int inside = 0;
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          const int rr = r + dr;
          const int cc = c + dc;
          if (rr >= 0 && cc >= 0 && rr < field.rows && cc < field.columns && !std::isnan(field.at(cc, rr)))
            ++inside;
        }
      }
      result.values[static_cast<size_t>(r) * field.columns + c] = inside / 9.0;
    }
  }
  return result;
}

/// Leaves out points that lie within `tolerance` of the line through those that stay (Douglas & Peucker 1973).
void simplify(const std::vector<Point2>& points, size_t first, size_t last, double tolerance,
              std::vector<bool>& keep) {
  if (last <= first + 1) return;
  const double dx = points[last].x - points[first].x;
  const double dy = points[last].y - points[first].y;
  const double length = std::hypot(dx, dy);
  double worst = -1.0;
  size_t at = first;
  for (size_t i = first + 1; i < last; ++i) {
    const double ax = points[i].x - points[first].x;
    const double ay = points[i].y - points[first].y;
    const double distance = length > 0.0 ? std::abs(dx * ay - dy * ax) / length : std::hypot(ax, ay);
    if (distance > worst) {
      worst = distance;
      at = i;
    }
  }
  if (worst <= tolerance) return;
  keep[at] = true;
  simplify(points, first, at, tolerance, keep);
  simplify(points, at, last, tolerance, keep);
}

/// Closed curves around where the field is at least `threshold`, in cell coordinates (marching squares).
std::vector<std::vector<Point2>> contours(const Field& field, double threshold) {
  // A border of cells below the threshold closes every curve.
  const int w = field.columns + 2;
  const int h = field.rows + 2;
  const auto value = [&](int c, int r) {
    if (c == 0 || r == 0 || c == w - 1 || r == h - 1) return -1e300;
    const double v = field.at(c - 1, r - 1);
    return std::isnan(v) ? -1e300 : v;
  };
  const auto crossing = [&](int c0, int r0, int c1, int r1) {
    const double a = value(c0, r0);
    const double b = value(c1, r1);
    const double t = a < -1e299 || b < -1e299 ? 0.5 : (threshold - a) / (b - a);
    return Point2{c0 + t * (c1 - c0) - 1.0, r0 + t * (r1 - r0) - 1.0};
  };
  // Edge ids: 2 (r w + c) is the edge to the right of node (c, r), 2 (r w + c) + 1 the edge upwards.
  std::vector<int> next(static_cast<size_t>(2) * w * h, -1);
  std::vector<Point2> points(next.size());
  const auto join = [&](int from, int to) { next[static_cast<size_t>(from)] = to; };
  for (int r = 0; r + 1 < h; ++r) {
    for (int c = 0; c + 1 < w; ++c) {
      const bool a = value(c, r) >= threshold;
      const bool b = value(c + 1, r) >= threshold;
      const bool d = value(c + 1, r + 1) >= threshold;
      const bool e = value(c, r + 1) >= threshold;
      const int kind = a + 2 * b + 4 * d + 8 * e;
      if (kind == 0 || kind == 15) continue;
      const int south = 2 * (r * w + c);
      const int west = south + 1;
      const int north = 2 * ((r + 1) * w + c);
      const int east = 2 * (r * w + c + 1) + 1;
      if (a != b) points[static_cast<size_t>(south)] = crossing(c, r, c + 1, r);
      if (a != e) points[static_cast<size_t>(west)] = crossing(c, r, c, r + 1);
      if (d != e) points[static_cast<size_t>(north)] = crossing(c, r + 1, c + 1, r + 1);
      if (b != d) points[static_cast<size_t>(east)] = crossing(c + 1, r, c + 1, r + 1);
      // Inside lies on the left of each piece.
      switch (kind) {
        case 1:
          join(south, west);
          break;
        case 2:
          join(east, south);
          break;
        case 3:
          join(east, west);
          break;
        case 4:
          join(north, east);
          break;
        case 5:
          join(south, west), join(north, east);
          break;
        case 6:
          join(north, south);
          break;
        case 7:
          join(north, west);
          break;
        case 8:
          join(west, north);
          break;
        case 9:
          join(south, north);
          break;
        case 10:
          join(east, south), join(west, north);
          break;
        case 11:
          join(east, north);
          break;
        case 12:
          join(west, east);
          break;
        case 13:
          join(south, east);
          break;
        case 14:
          join(west, south);
          break;
        default:
          break;
      }
    }
  }
  std::vector<std::vector<Point2>> result;
  for (size_t start = 0; start < next.size(); ++start) {
    if (next[start] < 0) continue;
    std::vector<Point2> curve;
    for (int at = static_cast<int>(start); at >= 0 && next[static_cast<size_t>(at)] >= 0;) {
      curve.push_back(points[static_cast<size_t>(at)]);
      at = std::exchange(next[static_cast<size_t>(at)], -1);
    }
    if (curve.size() >= 4) result.push_back(std::move(curve));
  }
  return result;
}

std::string tick_text(double value, double step) {
  if (std::abs(value) < 1e-9 * std::abs(step)) return "0";
  int decimals = 0;
  for (double scaled = std::abs(step); decimals < 6 && std::abs(scaled - std::round(scaled)) > 1e-6 * scaled;
       scaled *= 10.0)
    ++decimals;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-')) text = "−" + text.substr(1);
  return text;
}

}  // namespace

std::string_view figure_style() {
  return R"css(
svg.figure{display:block;width:100%;height:auto;font-family:inherit}
svg.figure text{font-size:12px;fill:var(--muted)}
svg.figure .strong{fill:var(--text)}
svg.figure .grid{stroke:var(--grid);stroke-width:1;fill:none}
svg.figure .axis{stroke:var(--axis);stroke-width:1;fill:none}
svg.figure .reference{stroke:var(--muted);stroke-width:1;stroke-dasharray:2 3;fill:none}
svg.figure .s1{stroke:var(--s1)} svg.figure .s2{stroke:var(--s2)} svg.figure .s3{stroke:var(--s3)} svg.figure .s4{stroke:var(--s4)}
svg.figure .line{fill:none;stroke-width:2;stroke-linejoin:round;stroke-linecap:round}
svg.figure .dashed{stroke-dasharray:6 4}
svg.figure .f1{fill:var(--s1)} svg.figure .f2{fill:var(--s2)} svg.figure .f3{fill:var(--s3)} svg.figure .f4{fill:var(--s4)}
svg.figure .wash{fill-opacity:.16;stroke-width:1.5}
svg.figure .shadow{fill-opacity:.07;stroke:none}
svg.figure .bad{fill:var(--bad)} svg.figure .limit{stroke:var(--text);stroke-width:1.5;fill:none}
svg.figure .inner{fill:none;stroke:var(--text);stroke-width:1.4;stroke-dasharray:5 3}
svg.figure .halo{paint-order:stroke;stroke:var(--card);stroke-width:3.5px;stroke-linejoin:round}
)css";
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string map_colour(double share) {
  const double position = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const size_t i = std::min(static_cast<size_t>(position), kViridis.size() - 2);
  const double t = position - static_cast<double>(i);
  std::array<int, 3> rgb{};
  for (size_t k = 0; k < 3; ++k) {
    rgb[k] = static_cast<int>(std::lround((1.0 - t) * kViridis[i][k] + t * kViridis[i + 1][k]));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::vector<double> round_ticks(double min, double max, int count) {
  if (!(max > min)) return {min};
  const double raw = (max - min) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double factor : {1.0, 2.0, 2.5, 5.0}) {
    if (factor * power >= raw * 0.999) {
      step = factor * power;
      break;
    }
  }
  std::vector<double> ticks;
  for (double k = std::ceil(min / step - 1e-9); k * step <= max + 1e-9 * step; k += 1.0)
    ticks.push_back(k * step);
  return ticks;
}

double Plot::px(double x) const {
  const Interval& range = x_.range;
  const double share = x_.logarithmic ? std::log(x / range.min) / std::log(range.max / range.min)
                                      : (x - range.min) / range.width();
  return kLeft + share * (width_ - kLeft - right_margin());
}

double Plot::py(double y) const {
  const Interval& range = y_.range;
  const double share = y_.logarithmic ? std::log(y / range.min) / std::log(range.max / range.min)
                                      : (y - range.min) / range.width();
  return height_ - kBottom - share * (height_ - kTop - kBottom);
}

void Plot::keep_shape() {
  const double per_unit = (width_ - kLeft - 66.0) / x_.range.width();
  height_ = kTop + kBottom + per_unit * y_.range.width();
}

std::string Plot::path(const std::vector<Point2>& points) const {
  std::vector<Point2> pixels;
  pixels.reserve(points.size());
  for (const Point2& point : points) {
    const Point2 at{px(point.x), py(point.y)};
    if (std::isfinite(at.x) && std::isfinite(at.y)) pixels.push_back(at);
  }
  if (pixels.empty()) return {};
  std::vector<bool> keep(pixels.size(), false);
  keep.front() = keep.back() = true;
  simplify(pixels, 0, pixels.size() - 1, 0.12, keep);
  std::string result;
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (keep[i])
      result += fmt::format("{}{} {}", result.empty() ? "M" : "L", pixel(pixels[i].x), pixel(pixels[i].y));
  }
  return result;
}

void Plot::line(const std::vector<Point2>& points, int series, std::string_view label, bool dashed) {
  body_ += fmt::format("<path class=\"line s{}{}\" d=\"{}\" clip-path=\"url(#CLIP)\"/>", series,
                       dashed ? " dashed" : "", path(points));
  if (!label.empty()) legend_.emplace_back(series, std::string(label));
}

void Plot::steps(const std::vector<Point2>& points, int series, std::string_view label) {
  std::vector<Point2> held;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i > 0) held.push_back({points[i].x, points[i - 1].y});
    held.push_back(points[i]);
  }
  line(held, series, label);
}

void Plot::dots(const std::vector<Point2>& points, int series, std::string_view label) {
  for (const Point2& point : points) {
    body_ += fmt::format("<circle class=\"f{}\" cx=\"{}\" cy=\"{}\" r=\"3\"/>", series, pixel(px(point.x)),
                         pixel(py(point.y)));
  }
  if (!label.empty()) legend_.emplace_back(series, std::string(label));
}

std::string Plot::regions(const Field& field, double threshold) const {
  const double dx = field.columns > 1 ? field.x.width() / (field.columns - 1) : 0.0;
  const double dy = field.rows > 1 ? field.y.width() / (field.rows - 1) : 0.0;
  std::string result;
  for (auto& curve : contours(field, threshold)) {
    for (Point2& point : curve) point = {field.x.min + dx * point.x, field.y.min + dy * point.y};
    // A closed curve has no ends to keep: cut it in halves.
    const auto half = curve.begin() + static_cast<std::ptrdiff_t>(curve.size() / 2);
    std::vector<Point2> first(curve.begin(), half + 1);
    std::vector<Point2> second(half, curve.end());
    second.push_back(curve.front());
    std::string back = path(second);
    if (const size_t at = back.find('L'); at != std::string::npos) back.erase(0, at);
    result += path(first) + back + "Z";
  }
  return result;
}

void Plot::silhouette(const std::vector<std::array<Point2, 3>>& triangles) {
  Field field{x_.range, y_.range, 181, 0, {}};
  field.rows = std::max(2, static_cast<int>(180.0 * y_.range.width() / x_.range.width()) + 1);
  field.values.assign(static_cast<size_t>(field.columns) * static_cast<size_t>(field.rows), std::nan(""));
  const double dx = field.x.width() / (field.columns - 1);
  const double dy = field.y.width() / (field.rows - 1);
  for (const auto& t : triangles) {
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto side = [](const Point2& a, const Point2& b, double x, double y) {
      return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    };
    for (int r = std::max(0, static_cast<int>((low - field.y.min) / dy));
         r < field.rows && field.y.min + r * dy <= high; ++r) {
      for (int c = std::max(0, static_cast<int>((left - field.x.min) / dx));
           c < field.columns && field.x.min + c * dx <= right; ++c) {
        const double x = field.x.min + c * dx;
        const double y = field.y.min + r * dy;
        const double d0 = side(t[0], t[1], x, y);
        const double d1 = side(t[1], t[2], x, y);
        const double d2 = side(t[2], t[0], x, y);
        if ((d0 >= 0.0 && d1 >= 0.0 && d2 >= 0.0) || (d0 <= 0.0 && d1 <= 0.0 && d2 <= 0.0)) {
          field.values[static_cast<size_t>(r) * static_cast<size_t>(field.columns) + static_cast<size_t>(c)] =
              1.0;
        }
      }
    }
  }
  body_ +=
      fmt::format("<path class=\"f1 shadow\" fill-rule=\"evenodd\" d=\"{}\"/>", regions(presence(field), 0.5));
}

void Plot::curves(const std::vector<std::vector<Point2>>& closed, int series) {
  std::string d;
  for (const auto& curve : closed) d += path(curve) + "Z";
  body_ += fmt::format("<path class=\"wash s{0} f{0}\" fill-rule=\"evenodd\" d=\"{1}\"/>", series, d);
}

void Plot::map(const Field& field, const std::vector<std::vector<Point2>>& boundary, std::string_view label,
               Interval range) {
  if (!(range.max > range.min)) range.max = range.min + std::max(1e-12, std::abs(range.min) * 1e-3);
  const auto level = [&](int k) { return range.min + range.width() * k / kBands; };
  // The scale takes room at the right, so it must be known before the first pixel is placed.
  const double x0 = width_ - 52.0;
  const double y0 = height_ - kBottom;
  const double step = (height_ - kTop - kBottom) / kBands;
  for (int k = 0; k < kBands; ++k) {
    scale_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"{}\" fill=\"{}\"/>", pixel(x0),
                          pixel(y0 - step * (k + 1)), pixel(step + 0.5), map_colour((k + 0.5) / kBands));
  }
  for (const int k : {0, kBands / 2, kBands}) {
    scale_ += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>", pixel(x0 + 16.0), pixel(y0 - step * k + 4.0),
                          number(level(k), 3));
  }
  scale_ += fmt::format("<text class=\"strong\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                        pixel(width_ - 4.0), pixel(height_ - 12.0), escaped(label));
  std::string edge;
  for (const auto& curve : boundary) edge += path(curve) + "Z";
  const Field wide = spread(field, 3);
  body_ += fmt::format(
      "<clipPath id=\"CLIPM\"><path clip-rule=\"evenodd\" d=\"{}\"/></clipPath><g clip-path=\"url(#CLIPM)\">",
      edge);
  for (int k = 0; k < kBands; ++k) {
    // The lowest band takes everything, so that no gap opens below it.
    const std::string d = regions(wide, k == 0 ? -1e299 : level(k));
    if (!d.empty())
      body_ +=
          fmt::format("<path fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"/>", map_colour((k + 0.5) / kBands), d);
  }
  body_ += fmt::format("</g><path class=\"axis\" d=\"{}\"/>", edge);
}

void Plot::horizontal(double y, std::string_view text, Side side) {
  const bool left = side == Side::left_below;
  over_ += fmt::format(
      "<path class=\"reference\" d=\"M{} {}H{}\"/><text class=\"halo\" x=\"{}\" y=\"{}\" "
      "text-anchor=\"{}\">{}</text>",
      pixel(kLeft), pixel(py(y)), pixel(width_ - right_margin()),
      pixel(left ? kLeft + 8.0 : width_ - right_margin() - 4.0), pixel(py(y) + (left ? 16.0 : -4.0)),
      left ? "start" : "end", escaped(text));
}

void Plot::vertical(double x, std::string_view text) {
  const bool left = px(x) > 0.6 * width_;
  over_ += fmt::format(
      "<path class=\"reference\" d=\"M{0} {1}V{2}\"/><text class=\"halo\" x=\"{3}\" y=\"{4}\" "
      "text-anchor=\"{5}\">{6}</text>",
      pixel(px(x)), pixel(kTop), pixel(height_ - kBottom), pixel(px(x) + (left ? -5.0 : 5.0)),
      pixel(height_ - kBottom - 6.0), left ? "end" : "start", escaped(text));
}

void Plot::circle(Point2 centre, double radius, std::string_view text) {
  over_ +=
      fmt::format("<ellipse class=\"inner\" cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{}\"/>", pixel(px(centre.x)),
                  pixel(py(centre.y)), pixel(px(radius) - px(0.0)), pixel(py(0.0) - py(radius)));
  if (!text.empty()) mark(centre, text);
}

void Plot::rectangle(Point2 centre, double side, std::string_view text) {
  over_ += fmt::format("<rect class=\"inner\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                       pixel(px(centre.x - side / 2)), pixel(py(centre.y + side / 2)),
                       pixel(px(side) - px(0.0)), pixel(py(0.0) - py(side)));
  if (!text.empty()) {
    over_ += fmt::format("<text class=\"strong halo\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                         pixel(px(centre.x)), pixel(py(centre.y - side / 2) - 6.0), escaped(text));
  }
}

void Plot::mark(Point2 point, std::string_view text) {
  over_ += fmt::format(
      "<circle class=\"f2\" cx=\"{0}\" cy=\"{1}\" r=\"3.5\"/><text class=\"strong halo\" x=\"{2}\" y=\"{3}\" "
      "text-anchor=\"{4}\">{5}</text>",
      pixel(px(point.x)), pixel(py(point.y)), pixel(px(point.x) + (px(point.x) > 0.6 * width_ ? -7.0 : 7.0)),
      pixel(py(point.y) - 6.0), px(point.x) > 0.6 * width_ ? "end" : "start", escaped(text));
}

std::string Plot::svg(std::string_view title) const {
  static int count = 0;
  const std::string id = fmt::format("c{}", ++count);
  const double right = width_ - right_margin();
  const double bottom = height_ - kBottom;
  std::string axes;
  const auto ticks = [&](const Axis& axis, int about, auto draw) {
    if (!axis.logarithmic) {
      const auto values = round_ticks(axis.range.min, axis.range.max, about);
      const double step = values.size() > 1 ? values[1] - values[0] : 1.0;
      for (const double value : values) draw(value, tick_text(value, step));
      return;
    }
    for (double decade = std::pow(10.0, std::floor(std::log10(axis.range.min))); decade <= axis.range.max;
         decade *= 10.0) {
      for (int k = 1; k < 10; ++k) {
        const double value = k * decade;
        if (value < axis.range.min * 0.999 || value > axis.range.max * 1.001) continue;
        draw(value, k == 1 ? number(value, 1) : "");
      }
    }
  };
  ticks(x_, 6, [&](double value, const std::string& text) {
    axes += fmt::format("<path class=\"grid\" d=\"M{} {}V{}\"/>", pixel(px(value)), pixel(kTop), pixel(bottom));
    if (!text.empty()) {
      axes += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", pixel(px(value)),
                          pixel(bottom + 16.0), text);
    }
  });
  ticks(y_, std::max(3, static_cast<int>((bottom - kTop) / 45.0)), [&](double value, const std::string& text) {
    axes += fmt::format("<path class=\"grid\" d=\"M{} {}H{}\"/>", pixel(kLeft), pixel(py(value)), pixel(right));
    if (!text.empty()) {
      axes += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", pixel(kLeft - 6.0),
                          pixel(py(value) + 4.0), text);
    }
  });
  const std::string frame = fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>", pixel(kLeft), pixel(kTop),
                                        pixel(bottom), pixel(right));
  std::string names = fmt::format("<text class=\"strong\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                                  pixel((kLeft + right) / 2.0), pixel(height_ - 12.0), escaped(x_.label));
  names += fmt::format(
      "<text class=\"strong\" transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
      pixel((kTop + bottom) / 2.0), escaped(y_.label));
  double legend_y = kTop + 12.0;
  for (const auto& [series, label] : legend_) {
    names += fmt::format(
        "<path class=\"line s{}\" d=\"M{} {}h16\"/><text class=\"strong halo\" x=\"{}\" y=\"{}\">{}</text>",
        series, pixel(kLeft + 12.0), pixel(legend_y - 4.0), pixel(kLeft + 34.0), pixel(legend_y),
        escaped(label));
    legend_y += 17.0;
  }
  std::string result = fmt::format(
      "<svg class=\"figure\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\"><title>{2}</title>"
      "<clipPath id=\"CLIP\"><rect x=\"{3}\" y=\"{4}\" width=\"{5}\" "
      "height=\"{6}\"/></clipPath>{7}{8}{9}{10}{11}{12}</svg>",
      pixel(width_), pixel(height_), escaped(title), pixel(kLeft), pixel(kTop), pixel(right - kLeft),
      pixel(bottom - kTop), axes, body_, frame, over_, names, scale_);
  for (size_t at = result.find("CLIP"); at != std::string::npos; at = result.find("CLIP", at))
    result.replace(at, 4, id);
  return result;
}

// -------------------------------------------------------------------------------------------------------
// solids

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
