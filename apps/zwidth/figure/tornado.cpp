#include "figure/tornado.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "figure/svg.h"
#include "terminal.h"

namespace zwidth {

namespace {

constexpr double kRow = 26.0, kBar = 15.0, kEdge = 6.0;
constexpr double kLetter = 7.2;       // of a wide typeface at the figure's size
constexpr double kMostOfNames = 0.6;  // of the width

std::string shortened(const std::string& text, double room) {
  const auto most = static_cast<std::size_t>(std::max(4.0, room / kLetter + 0.01));
  if (static_cast<std::size_t>(columns(text)) <= most) return text;
  std::size_t end = 0;
  for (std::size_t count = 0; end < text.size() && count < most; ++count) {
    do ++end;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U);
  }
  return text.substr(0, end) + "…";
}

}  // namespace

std::string tornado(double width, const std::vector<TornadoBar>& bars, std::string_view title) {
  double names = 0.0, text = 0.0, least = 0.0, most = 0.0;
  for (const TornadoBar& bar : bars) {
    const int letters = columns(bar.name) + (bar.note.empty() ? 0 : columns(bar.note) + 2);
    names = std::max(names, kLetter * letters);
    text = std::max(text, kLetter * columns(bar.text) + 8.0);
    if (std::isnan(bar.change)) continue;
    least = std::min(least, bar.change);
    most = std::max(most, bar.change);
  }
  names = std::min(names, kMostOfNames * width);
  const double left = names + 12.0 + (least < 0.0 ? text : 4.0);
  const double right = width - (most > 0.0 || least == 0.0 ? text : 4.0);
  const double scale = most > least ? (right - left) / (most - least) : 0.0;
  const double zero = left - scale * least;
  std::string body;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const TornadoBar& bar = bars[i];
    const double middle = kEdge + kRow * (static_cast<double>(i) + 0.5);
    const double note = bar.note.empty() ? 0.0 : kLetter * (columns(bar.note) + 2.0);
    body += fmt::format(
        "<text class=\"strong\" x=\"0\" y=\"{}\">{}<tspan style=\"fill:var(--muted)\" "
        "dx=\"7\">{}</tspan></text>",
        pixel(middle + 4.0), escaped(shortened(bar.name, names - note)), escaped(bar.note));
    const double change = std::isnan(bar.change) ? 0.0 : bar.change;
    const double end = zero + scale * change;
    if (change != 0.0) {
      body += fmt::format("<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"2\"/>",
                          bar.better ? "f3" : "bad", pixel(std::min(zero, end)), pixel(middle - kBar / 2.0),
                          pixel(std::max(1.0, std::abs(end - zero))), pixel(kBar));
    }
    body += fmt::format("<text class=\"strong\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>",
                        pixel(end + (change < 0.0 ? -6.0 : 6.0)), pixel(middle + 4.0),
                        change < 0.0 ? "end" : "start", escaped(bar.text));
  }
  const double height = 2.0 * kEdge + kRow * static_cast<double>(bars.size());
  body += fmt::format("<path class=\"axis\" d=\"M{0} {1}V{2}\"/>", pixel(zero), pixel(kEdge),
                      pixel(height - kEdge));
  return fmt::format(
      "<svg class=\"figure\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><title>{}</title>{}</svg>",
      pixel(width), pixel(height), escaped(title), escaped(title), body);
}

}  // namespace zwidth
