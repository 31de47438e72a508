#pragma once

#include <span>

namespace zwidth {

/// Sine and cosine of all angles [rad] at once, by the widest instructions that the machine has: those of a
/// whole arm in the time of one. Absolute error below 2.5e-16 for any finite angle, NaN otherwise. REQUIRES:
/// all three of one size; `sine` and `cosine` do not overlap `angle`.
void sine_cosines(std::span<const double> angle, std::span<double> sine, std::span<double> cosine) noexcept;

/// Angles of the directions (cosine, sine), which need not have length 1, in [-pi, pi]: atan2(sine, cosine)
/// with an absolute error below 5e-16. Zero for (0, 0). REQUIRES: as above.
void angles_of(std::span<const double> cosine, std::span<const double> sine, std::span<double> angle) noexcept;

}  // namespace zwidth
