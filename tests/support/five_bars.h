#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "zwidth/mechanism/five_bar.h"

namespace zwidth::test {

/// The selected design (Singh, Saha and Manivannan, section 5.1).
inline constexpr FiveBarGeometry kPublishedFiveBar{.crank = 0.10, .coupler = 0.15, .half_base = 0.03};

inline double draw(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Any lengths that can be assembled, of the order of 1 m to 1 cm.
inline FiveBarGeometry random_five_bar(std::mt19937_64& random) {
  const double size = std::pow(10.0, draw(random, -2.0, 0.0));
  FiveBarGeometry geometry{.crank = size * draw(random, 0.3, 1.0), .coupler = size * draw(random, 0.3, 1.0)};
  geometry.half_base = draw(random, 0.05, 0.9) * (geometry.crank + geometry.coupler);
  return geometry;
}

/// A device with these lengths and modes, and cranks that turn all round unless `ranges` says otherwise.
inline Description five_bar_device(const FiveBarGeometry& geometry, WorkingMode mode = {},
                                   int assembly_mode = 1,
                                   const std::array<Interval, 2>& ranges = kAnyCrankAngle) {
  Description description;
  description.name = "five-bar";
  description.mechanism = FiveBarDescription{.crank = geometry.crank,
                                             .coupler = geometry.coupler,
                                             .half_base = geometry.half_base,
                                             .left_range = ranges[0],
                                             .right_range = ranges[1],
                                             .left_mode = mode.left,
                                             .right_mode = mode.right,
                                             .assembly_mode = assembly_mode};
  return description;
}

inline Vector2 random_cranks(std::mt19937_64& random) {
  return {draw(random, -std::numbers::pi, std::numbers::pi), draw(random, -std::numbers::pi, std::numbers::pi)};
}

}  // namespace zwidth::test
