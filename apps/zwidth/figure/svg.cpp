#include "figure/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace zwidth {

namespace {

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

}  // namespace

std::string pixel(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

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

}  // namespace zwidth
