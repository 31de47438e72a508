#include "zwidth/analysis/contour.h"

#include <cmath>

#include "zwidth/analysis/internal/trace.h"

namespace zwidth {

std::vector<Outline> contours(const PlaneGrid& grid, double level) {
  // One point more on each side, below the level, so that every line closes.
  const int nu = grid.nu + 2, nv = grid.nv + 2;
  const auto has_value = [&](int iu, int iv) {
    return iu > 0 && iv > 0 && iu <= grid.nu && iv <= grid.nv && !std::isnan(grid.at(iu - 1, iv - 1));
  };
  const auto value = [&](int iu, int iv) { return grid.at(iu - 1, iv - 1); };
  const auto inside = [&](int iu, int iv) { return has_value(iu, iv) && value(iu, iv) >= level; };
  const auto joined = [&](int iu, int iv) {
    double sum = 0.0;
    int count = 0;
    for (const auto& [du, dv] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      if (!has_value(iu + du, iv + dv)) continue;
      sum += value(iu + du, iv + dv);
      ++count;
    }
    return count == 4 && sum >= 4.0 * level;
  };
  const double hu = grid.u.width() / (grid.nu - 1), hv = grid.v.width() / (grid.nv - 1);
  const auto crossing = [&](const internal::GridLine& line) -> std::array<double, 2> {
    const int ju = line.iu + (line.up ? 0 : 1), jv = line.iv + (line.up ? 1 : 0);
    double share = 0.5;  // where one end has no value
    if (has_value(line.iu, line.iv) && has_value(ju, jv)) {
      const double a = value(line.iu, line.iv), b = value(ju, jv);
      if (std::isfinite(a) && std::isfinite(b) && a != b) share = (level - a) / (b - a);
    }
    return {grid.u.min + hu * (line.iu - 1 + (line.up ? 0.0 : share)),
            grid.v.min + hv * (line.iv - 1 + (line.up ? share : 0.0))};
  };
  return internal::trace_outlines(nu, nv, inside, joined, crossing);
}

double area_within(const std::vector<Outline>& outlines) {
  return internal::enclosed_area(outlines);
}

}  // namespace zwidth
