#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "zwidth/actuation/amplifier.h"
#include "zwidth/math/linear_system.h"

namespace zwidth {

/// A winding (resistance, inductance) under proportional-integral current control, back-EMF neglected:
///
///     Y/R = (KP s + KI)/L / (s^2 + (KP + R)/L s + KI/L)          (Neal 2015, eq 4.9-4.11)
///
/// A loop without integral gain has one pole less and a steady error of R/(KP + R).
class CurrentLoop {
 public:
  /// Empty unless resistance [ohm] and inductance [H] are positive and all four numbers finite.
  static std::optional<CurrentLoop> make(double resistance, double inductance, const CurrentGains& gains);

  /// From commanded to actual current, continuous.
  LinearSystem closed_loop() const;

  /// Closed-loop poles [rad/s], the slower first; without integral gain the first is the cancelled one at zero.
  std::array<std::complex<double>, 2> poles() const;

  /// Closed-loop zero -KI/KP [rad/s]; empty without proportional gain.
  std::optional<double> zero() const;

  /// Undamped natural frequency sqrt(KI/L) [rad/s]; zero unless the integral gain is positive.
  double natural_frequency() const;

  /// (KP + R)/(2 sqrt(KI L)) [-]; empty unless the integral gain is positive. Below one the loop rings.
  std::optional<double> damping_ratio() const;

  bool is_stable() const;

  /// Highest frequency [Hz] at which the gain is still -drop dB, in closed form. Three decibels are taken as
  /// such, not as half power (which would be 3.0103). Empty when the loop is unstable or its gain is below
  /// -drop at every frequency; `drop` must be positive, else empty.
  std::optional<double> bandwidth(double drop_decibels = 3.0) const;

  /// Unit step response of the closed loop at the samples 0 .. count-1; the command is held over each period
  /// [s].
  std::vector<double> step(double period, int count) const;

  /// Metrics of that response with 1 as the target; empty when the loop is unstable (see step_metrics).
  std::optional<StepMetrics> metrics(double period) const;

  double resistance() const { return resistance_; }
  double inductance() const { return inductance_; }
  const CurrentGains& gains() const { return gains_; }

 private:
  double resistance_ = 0.0;
  double inductance_ = 0.0;
  CurrentGains gains_;
};

}  // namespace zwidth
