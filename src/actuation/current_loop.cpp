#include "zwidth/actuation/current_loop.h"

#include <cmath>
#include <numbers>

namespace zwidth {

std::optional<CurrentLoop> CurrentLoop::make(double resistance, double inductance, const CurrentGains& gains) {
  if (!(resistance > 0.0) || !std::isfinite(resistance) || !(inductance > 0.0) || !std::isfinite(inductance) ||
      !std::isfinite(gains.proportional) || !std::isfinite(gains.integral)) {
    return std::nullopt;
  }
  CurrentLoop loop;
  loop.resistance_ = resistance;
  loop.inductance_ = inductance;
  loop.gains_ = gains;
  return loop;
}

LinearSystem CurrentLoop::closed_loop() const {
  const auto [KP, KI] = gains_;
  const double R = resistance_;
  const double L = inductance_;
  if (KI == 0.0) {  // eq 4.11 less the common factor s
    return LinearSystem::from_transfer_function(std::array{KP / L}, std::array{1.0, (KP + R) / L});
  }
  return LinearSystem::from_transfer_function(std::array{KP / L, KI / L},
                                              std::array{1.0, (KP + R) / L, KI / L});
}

std::array<std::complex<double>, 2> CurrentLoop::poles() const {
  // s^2 + c s + b = 0
  const double c = (gains_.proportional + resistance_) / inductance_;
  const double b = gains_.integral / inductance_;
  const double discriminant = 0.25 * c * c - b;
  if (discriminant < 0.0) {
    const double w = std::sqrt(-discriminant);
    return {std::complex<double>{-0.5 * c, w}, std::complex<double>{-0.5 * c, -w}};
  }
  const double larger = -0.5 * c - std::copysign(std::sqrt(discriminant), c);  // no cancellation
  const double smaller = larger == 0.0 ? 0.0 : b / larger;
  if (std::abs(smaller) <= std::abs(larger)) {
    return {std::complex<double>{smaller, 0.0}, std::complex<double>{larger, 0.0}};
  }
  return {std::complex<double>{larger, 0.0}, std::complex<double>{smaller, 0.0}};
}

std::optional<double> CurrentLoop::zero() const {
  return gains_.proportional == 0.0 ? std::nullopt : std::optional(-gains_.integral / gains_.proportional);
}

double CurrentLoop::natural_frequency() const {
  return gains_.integral > 0.0 ? std::sqrt(gains_.integral / inductance_) : 0.0;
}

std::optional<double> CurrentLoop::damping_ratio() const {
  if (!(gains_.integral > 0.0)) {
    return std::nullopt;
  }
  return (gains_.proportional + resistance_) / (2.0 * std::sqrt(gains_.integral * inductance_));
}

bool CurrentLoop::is_stable() const {
  return gains_.proportional + resistance_ > 0.0 && gains_.integral >= 0.0;
}

std::optional<double> CurrentLoop::bandwidth(double drop_decibels) const {
  if (!is_stable() || !(drop_decibels > 0.0)) {
    return std::nullopt;
  }
  // |Y/R|^2 = G with u = w^2:  G ((b - u)^2 + c^2 u) = a^2 u + b^2, that is  G u^2 + p u - q = 0.
  const double a = gains_.proportional / inductance_;
  const double b = gains_.integral / inductance_;
  const double c = (gains_.proportional + resistance_) / inductance_;
  const double G = std::pow(10.0, -drop_decibels / 10.0);
  const double p = G * (c * c - 2.0 * b) - a * a;
  const double q = (1.0 - G) * b * b;  // not negative: the roots have different signs
  const double root = std::sqrt(p * p + 4.0 * G * q);
  const double u = p > 0.0 ? 2.0 * q / (p + root) : (root - p) / (2.0 * G);
  return u > 0.0 ? std::optional(std::sqrt(u) / (2.0 * std::numbers::pi)) : std::nullopt;
}

std::vector<double> CurrentLoop::step(double period, int count) const {
  return step_response(closed_loop().zero_order_hold(period), count);
}

std::optional<StepMetrics> CurrentLoop::metrics(double period) const {
  return is_stable() ? step_metrics(closed_loop().zero_order_hold(period)) : std::nullopt;
}

}  // namespace zwidth
