#pragma once

#include <cmath>
#include <numbers>

#include "zwidth/math/spatial.h"

namespace zwidth::internal {

constexpr double kLimitTolerance = 1e-9;  ///< by which a joint may be beyond its range [rad] or [m]

/// The angle a whole number of turns away that lies in the range, next to `near` if several do; in (-pi, pi] if
/// none does.
inline double settled(double angle, const Interval& range, double near) noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double result = near + std::remainder(angle - near, kTurn);
  if (result > range.max + kLimitTolerance) result -= kTurn * std::ceil((result - range.max) / kTurn);
  if (result < range.min - kLimitTolerance) result += kTurn * std::ceil((range.min - result) / kTurn);
  return range.contains(result, kLimitTolerance) ? result : std::remainder(angle, kTurn);
}

/// Whether turns beyond the ends of a range come back into it.
inline bool goes_round(const Interval& range) noexcept {
  return range.width() > 2.0 * std::numbers::pi - kLimitTolerance;
}

}  // namespace zwidth::internal
