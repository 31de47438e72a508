#include "figure/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "figure/svg.h"

namespace zwidth {

namespace {

constexpr double kSide = 46.0;    // beside the outer axes, half a name
constexpr double kBottom = 26.0;  // below them
constexpr std::size_t kLongestName = 16;
constexpr double kTextRow = 15.0;

// A name in rows short enough to stand above its axis, broken at its joints.
std::vector<std::string> rows_of(const std::string& name) {
  std::vector<std::string> rows{""};
  std::size_t from = 0;
  while (from < name.size()) {
    const std::size_t end = std::min(name.find_first_of(" _.", from), name.size() - 1) + 1;
    const std::string piece = name.substr(from, end - from);
    if (!rows.back().empty() && rows.back().size() + piece.size() > kLongestName) rows.emplace_back();
    rows.back() += piece;
    from = end;
  }
  return rows;
}

}  // namespace

std::string parallel_coordinates(double width, double height, const std::vector<ParallelAxis>& axes,
                                 std::optional<std::size_t> marked, std::string_view title) {
  std::size_t rows = 1;
  for (const ParallelAxis& axis : axes) rows = std::max(rows, rows_of(axis.name).size());
  const double top = kTextRow * (static_cast<double>(rows) + 1.5);
  const auto x = [&](std::size_t axis) {
    return kSide + (width - 2.0 * kSide) * static_cast<double>(axis) / static_cast<double>(axes.size() - 1);
  };
  const auto y = [&](double share) { return height - kBottom - share * (height - kBottom - top); };
  const auto line = [&](std::size_t i, std::string_view style) {
    std::string path;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      path += fmt::format("{}{} {}", a == 0 ? "M" : "L", pixel(x(a)), pixel(y(axes[a].shares[i])));
    }
    return fmt::format("<path {} d=\"{}\"/>", style, path);
  };
  const std::size_t count = axes.front().shares.size();
  // Many lines are fainter each, so that their bundles tell.
  const double opacity = std::clamp(12.0 / std::sqrt(static_cast<double>(count)) / 4.0, 0.15, 0.8);
  std::string body;
  const std::string thin =
      fmt::format("class=\"line s1\" style=\"stroke-width:1;stroke-opacity:{:.2f}\"", opacity);
  for (std::size_t i = 0; i < count; ++i) {
    if (i != marked) body += line(i, thin);
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    body += fmt::format("<path class=\"{}\" d=\"M{} {}V{}\"/>", axes[a].strong ? "limit" : "axis", pixel(x(a)),
                        pixel(y(0.0)), pixel(y(1.0)));
    const std::vector<std::string> name = rows_of(axes[a].name);
    for (std::size_t r = 0; r < name.size(); ++r) {
      const double above = kTextRow * (static_cast<double>(name.size() - r) + 0.4);
      body += fmt::format("<text class=\"strong\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                          pixel(x(a)), pixel(y(1.0) - above), escaped(name[r]));
    }
    body += fmt::format("<text class=\"halo\" x=\"{0}\" y=\"{1}\" text-anchor=\"middle\">{2}</text>",
                        pixel(x(a)), pixel(y(1.0) - 5.0), escaped(axes[a].high));
    body += fmt::format("<text class=\"halo\" x=\"{0}\" y=\"{1}\" text-anchor=\"middle\">{2}</text>",
                        pixel(x(a)), pixel(y(0.0) + 15.0), escaped(axes[a].low));
  }
  if (marked) body += line(*marked, "class=\"line s2\" style=\"stroke-width:3\"");
  return fmt::format("<svg class=\"figure\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>",
                     pixel(width), pixel(height), escaped(title), body);
}

}  // namespace zwidth
