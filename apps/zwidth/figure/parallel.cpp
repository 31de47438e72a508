#include "figure/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "figure/svg.h"

namespace zwidth {

namespace {

constexpr double kSide = 58.0;  // beside the outer axes, half a name
constexpr std::size_t kLongestName = 14;
constexpr double kTextRow = 15.0;

// A text in rows short enough to stand above its axis, broken at its joints.
std::vector<std::string> rows_of(const std::string& name) {
  std::vector<std::string> rows{""};
  std::size_t from = 0;
  while (from < name.size()) {
    const std::size_t end = std::min(name.find_first_of(" _.-/", from + 1), name.size() - 1) + 1;
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
  // Numbers keep to one row, names of parts may take several.
  const auto ends_of = [](const std::string& text) {
    return text.size() <= kLongestName ? std::vector<std::string>{text} : rows_of(text);
  };
  std::size_t above = 1, below = 1;
  for (const ParallelAxis& axis : axes) {
    above = std::max(above, rows_of(axis.name).size() + ends_of(axis.high).size());
    below = std::max(below, ends_of(axis.low).size());
  }
  const double top = kTextRow * (static_cast<double>(above) + 0.5);
  const double bottom = kTextRow * (static_cast<double>(below) + 0.7);
  height += top + bottom;
  const auto x = [&](std::size_t axis) {
    return kSide + (width - 2.0 * kSide) * static_cast<double>(axis) / static_cast<double>(axes.size() - 1);
  };
  const auto y = [&](double share) { return height - bottom - share * (height - bottom - top); };
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
    const auto write = [&](const std::string& row, double at, const char* kind) {
      if (row.empty()) return;
      body += fmt::format("<text class=\"{}\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", kind,
                          pixel(x(a)), pixel(at), escaped(row));
    };
    double at = y(1.0) - 5.0;
    const std::vector<std::string> high = ends_of(axes[a].high), low = ends_of(axes[a].low);
    for (std::size_t r = high.size(); r-- > 0; at -= kTextRow) write(high[r], at, "halo");
    const std::vector<std::string> name = rows_of(axes[a].name);
    for (std::size_t r = name.size(); r-- > 0; at -= kTextRow) write(name[r], at, "strong");
    at = y(0.0) + 15.0;
    for (const std::string& row : low) {
      write(row, at, "halo");
      at += kTextRow;
    }
  }
  if (marked) body += line(*marked, "class=\"line s2\" style=\"stroke-width:3\"");
  return fmt::format("<svg class=\"figure\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>",
                     pixel(width), pixel(height), escaped(title), body);
}

}  // namespace zwidth
