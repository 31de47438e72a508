#include "zwidth/math/section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zwidth {

std::optional<Section> tube_section(double outer_diameter, double inner_diameter) noexcept {
  const double D = outer_diameter, d = inner_diameter;
  if (!(d >= 0.0 && d < D && std::isfinite(D))) return std::nullopt;
  // D^2 - d^2 and D^4 - d^4 as products: no loss for thin walls.
  const double ring = (D - d) * (D + d);
  const double I = std::numbers::pi / 64.0 * ring * (D * D + d * d);
  return Section{.area = std::numbers::pi / 4.0 * ring,
                 .second_moment_y = I,
                 .second_moment_z = I,
                 .torsion_constant = 2.0 * I};
}

std::optional<Section> bar_section(double width, double height) noexcept {
  if (!(width > 0.0 && height > 0.0 && std::isfinite(width) && std::isfinite(height))) return std::nullopt;
  const double a = std::max(width, height), b = std::min(width, height);
  double series = 0.0;
  for (int n = 1; n <= 59; n += 2) {  // what is left out is below 1e-8 of J
    series += std::tanh(0.5 * n * std::numbers::pi * a / b) / std::pow(n, 5);
  }
  const double J = a * b * b * b * (1.0 / 3.0 - 64.0 / std::pow(std::numbers::pi, 5) * (b / a) * series);
  return Section{.area = width * height,
                 .second_moment_y = width * std::pow(height, 3) / 12.0,
                 .second_moment_z = height * std::pow(width, 3) / 12.0,
                 .torsion_constant = J};
}

LinkMass link_mass(const Section& section, double length, double density) noexcept {
  const double line = density * length, mass = line * section.area, slender = mass * length * length / 12.0;
  return {.mass = mass,
          .about_axis = line * (section.second_moment_y + section.second_moment_z),
          .about_y = slender + line * section.second_moment_y,
          .about_z = slender + line * section.second_moment_z};
}

std::optional<TubeDiameters> laminated_tube(int plies, double ply_thickness, double ratio) noexcept {
  if (plies < 1 || !(ply_thickness > 0.0 && std::isfinite(ply_thickness)) || !(ratio >= 0.0 && ratio < 1.0)) {
    return std::nullopt;
  }
  const double outer = 2.0 * plies * ply_thickness / (1.0 - ratio);
  return TubeDiameters{.outer = outer, .inner = ratio * outer};
}

}  // namespace zwidth
