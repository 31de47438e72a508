#include "figure/plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

#include "figure/svg.h"
#include "terminal.h"

namespace zwidth {

namespace {

constexpr double kLeft = 58.0;  // at least; more where the numbers are long
constexpr double kTop = 14.0;
constexpr double kRight = 14.0;  // the same
constexpr double kScale = 66.0;  // margin at the right that holds a scale of colours
constexpr double kBottom = 46.0;
constexpr int kBands = 14;

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

// Where lines of the grid lie, and what stands at them; nothing at the finer ones of a logarithmic axis.
std::vector<std::pair<double, std::string>> ticks_of(const Axis& axis, int about) {
  std::vector<std::pair<double, std::string>> ticks;
  if (!axis.logarithmic) {
    const auto values = round_ticks(axis.range.min, axis.range.max, about);
    const double step = values.size() > 1 ? values[1] - values[0] : 1.0;
    for (const double value : values) ticks.emplace_back(value, tick_text(value, step));
    return ticks;
  }
  for (double decade = std::pow(10.0, std::floor(std::log10(axis.range.min))); decade <= axis.range.max;
       decade *= 10.0) {
    for (int k = 1; k < 10; ++k) {
      const double value = k * decade;
      if (value < axis.range.min * 0.999 || value > axis.range.max * 1.001) continue;
      ticks.emplace_back(value, k == 1 ? number(value, 1) : "");
    }
  }
  return ticks;
}

constexpr int kTicksAlong = 6;
int ticks_up(double height) {
  return std::max(3, static_cast<int>((height - kTop - kBottom) / 45.0));
}

// Of text as the figure's style has it, in a wide typeface.
double width_of(std::string_view text) {
  constexpr double kDigit = 7.7;
  return kDigit * columns(text);
}

}  // namespace

void Plot::make_room() {
  constexpr double kName = 20.0, kGap = 8.0;  // the axis' name stands upright at the very left
  double widest = 0.0;
  for (const auto& [value, text] : ticks_of(y_, ticks_up(height_))) widest = std::max(widest, width_of(text));
  left_ = std::max(kLeft, kName + kGap + widest);
  right_ = kRight;
  const auto along = ticks_of(x_, kTicksAlong);
  if (!along.empty()) right_ = std::max(kRight, width_of(along.back().second) / 2.0 + 2.0);
}

double Plot::right_margin() const {
  return scale_.empty() ? right_ : kScale;
}

double Plot::px(double x) const {
  const Interval& range = x_.range;
  const double share = x_.logarithmic ? std::log(x / range.min) / std::log(range.max / range.min)
                                      : (x - range.min) / range.width();
  return left_ + share * (width_ - left_ - right_margin());
}

double Plot::py(double y) const {
  const Interval& range = y_.range;
  const double share = y_.logarithmic ? std::log(y / range.min) / std::log(range.max / range.min)
                                      : (y - range.min) / range.width();
  return height_ - kBottom - share * (height_ - kTop - kBottom);
}

void Plot::keep_shape(bool with_scale) {
  const double per_unit = (width_ - left_ - (with_scale ? kScale : right_)) / x_.range.width();
  height_ = kTop + kBottom + per_unit * y_.range.width();
}

std::string Plot::path(const std::vector<Point2>& points) const {
  std::vector<Point2> pixels;
  pixels.reserve(points.size());
  for (const Point2& point : points) {
    const Point2 at{px(point.x), py(point.y)};
    if (std::isfinite(at.x) && std::isfinite(at.y)) pixels.push_back(at);
  }
  std::string result;
  for (const Point2& at : simplified(pixels, 0.12))
    result += fmt::format("{}{} {}", result.empty() ? "M" : "L", pixel(at.x), pixel(at.y));
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

void Plot::area(const std::vector<std::vector<Point2>>& closed, std::string_view rgb) {
  std::string d;
  for (const auto& curve : closed) d += path(curve) + "Z";
  body_ += fmt::format("<path fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"/>", rgb, d);
}

void Plot::edge(const std::vector<std::vector<Point2>>& closed) {
  std::string d;
  for (const auto& curve : closed) d += path(curve) + "Z";
  body_ += fmt::format("<path class=\"axis\" d=\"{}\"/>", d);
}

void Plot::swatches(const std::vector<std::pair<std::string_view, std::string_view>>& meaning) {
  double y = kTop + 20.0 * static_cast<double>(meaning.size());
  for (const auto& [rgb, text] : meaning) {
    y -= 20.0;
    scale_ += fmt::format(
        "<rect x=\"{0}\" y=\"{1}\" width=\"12\" height=\"12\" rx=\"2\" fill=\"{2}\"/><text x=\"{3}\" "
        "y=\"{4}\">{5}</text>",
        pixel(width_ - 58.0), pixel(y), rgb, pixel(width_ - 42.0), pixel(y + 10.5), escaped(text));
  }
}

void Plot::bar(Point2 a, Point2 b, double width, std::string_view rgb) {
  const std::string d =
      fmt::format("M{} {}L{} {}", pixel(px(a.x)), pixel(py(a.y)), pixel(px(b.x)), pixel(py(b.y)));
  over_ += fmt::format(
      "<path d=\"{0}\" stroke=\"#2b3442\" stroke-width=\"{1}\" stroke-linecap=\"round\"/><path d=\"{0}\" "
      "stroke=\"{2}\" stroke-width=\"{3}\" stroke-linecap=\"round\"/>",
      d, pixel(width), rgb, pixel(width - 2.4));
}

void Plot::disc(Point2 centre, double radius, std::string_view rgb) {
  over_ +=
      fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" stroke=\"#2b3442\" stroke-width=\"1.2\"/>",
                  pixel(px(centre.x)), pixel(py(centre.y)), pixel(radius), rgb);
}

void Plot::ground(Point2 centre, double size) {
  const double x = px(centre.x), y = py(centre.y), w = size;
  over_ += fmt::format(
      "<path d=\"M{} {}L{} {}H{}Z\" fill=\"#8a94a4\" stroke=\"#2b3442\" stroke-width=\"1.2\" "
      "stroke-linejoin=\"round\"/>",
      pixel(x), pixel(y - 0.3 * w), pixel(x + 0.9 * w), pixel(y + 1.4 * w), pixel(x - 0.9 * w));
  disc(centre, 0.55 * size, "#dfe4ea");
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
      pixel(left_), pixel(py(y)), pixel(width_ - right_margin()),
      pixel(left ? left_ + 8.0 : width_ - right_margin() - 4.0), pixel(py(y) + (left ? 16.0 : -4.0)),
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

void Plot::mark(Point2 point, std::string_view text, int series) {
  const double x = px(point.x), y = py(point.y), width = width_of(text);
  constexpr double kAside = 7.0, kHeight = 14.0;
  const bool left = x > 0.6 * width_;
  // Beside the point and above it, or where no other mark's name stands yet.
  MarkName chosen;
  bool found = false;
  for (const bool below : {false, true}) {
    for (const bool other : {false, true}) {
      const bool at_left = left != other;
      const MarkName name{.x = at_left ? x - kAside - width : x + kAside,
                          .y = below ? y + 15.0 : y - 6.0,
                          .width = width,
                          .at_left = at_left};
      const bool taken = std::any_of(marks_.begin(), marks_.end(), [&](const MarkName& one) {
        return name.x < one.x + one.width && one.x < name.x + width && std::abs(name.y - one.y) < kHeight;
      });
      const bool outside = name.x < left_ || name.x + width > width_ || name.y < kTop;
      if (found || taken || outside) continue;
      chosen = name;
      found = true;
    }
  }
  if (!found)
    chosen = {.x = left ? x - kAside - width : x + kAside, .y = y - 6.0, .width = width, .at_left = left};
  marks_.push_back(chosen);
  over_ += fmt::format(
      "<circle class=\"f{6}\" cx=\"{0}\" cy=\"{1}\" r=\"3.5\"/><text class=\"strong halo\" x=\"{2}\" y=\"{3}\" "
      "text-anchor=\"{4}\">{5}</text>",
      pixel(x), pixel(y), pixel(chosen.at_left ? x - kAside : x + kAside), pixel(chosen.y),
      chosen.at_left ? "end" : "start", escaped(text), series);
}

std::string Plot::svg(std::string_view title) const {
  static int count = 0;
  const std::string id = fmt::format("c{}", ++count);
  const double right = width_ - right_margin();
  const double bottom = height_ - kBottom;
  std::string axes;
  for (const auto& [value, text] : ticks_of(x_, kTicksAlong)) {
    axes += fmt::format("<path class=\"grid\" d=\"M{} {}V{}\"/>", pixel(px(value)), pixel(kTop), pixel(bottom));
    if (!text.empty()) {
      axes += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", pixel(px(value)),
                          pixel(bottom + 16.0), text);
    }
  }
  for (const auto& [value, text] : ticks_of(y_, ticks_up(height_))) {
    axes += fmt::format("<path class=\"grid\" d=\"M{} {}H{}\"/>", pixel(left_), pixel(py(value)), pixel(right));
    if (!text.empty()) {
      axes += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", pixel(left_ - 6.0),
                          pixel(py(value) + 4.0), text);
    }
  }
  const std::string frame = fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>", pixel(left_), pixel(kTop),
                                        pixel(bottom), pixel(right));
  std::string names = fmt::format("<text class=\"strong\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                                  pixel((left_ + right) / 2.0), pixel(height_ - 12.0), escaped(x_.label));
  names += fmt::format(
      "<text class=\"strong\" transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
      pixel((kTop + bottom) / 2.0), escaped(y_.label));
  double legend_y = kTop + 12.0;
  for (const auto& [series, label] : legend_) {
    names += fmt::format(
        "<path class=\"line s{}\" d=\"M{} {}h16\"/><text class=\"strong halo\" x=\"{}\" y=\"{}\">{}</text>",
        series, pixel(left_ + 12.0), pixel(legend_y - 4.0), pixel(left_ + 34.0), pixel(legend_y),
        escaped(label));
    legend_y += 17.0;
  }
  std::string result = fmt::format(
      "<svg class=\"figure\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\"><title>{2}</title>"
      "<clipPath id=\"CLIP\"><rect x=\"{3}\" y=\"{4}\" width=\"{5}\" "
      "height=\"{6}\"/></clipPath>{7}{8}{9}{10}{11}{12}</svg>",
      pixel(width_), pixel(height_), escaped(title), pixel(left_), pixel(kTop), pixel(right - left_),
      pixel(bottom - kTop), axes, body_, frame, over_, names, scale_);
  for (size_t at = result.find("CLIP"); at != std::string::npos; at = result.find("CLIP", at))
    result.replace(at, 4, id);
  return result;
}

}  // namespace zwidth
