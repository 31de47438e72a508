#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "zwidth/math/linear_system.h"

/// A cable-driven joint as two masses (motor side, sector side) on two springs (cable, contact), in the cable's
/// coordinate: state (z1, z1dot, z2, z2dot) [m, m/s], input the motor current [A] (Neal 2015, chapter 5).

namespace zwidth {

struct TwoMassParameters {
  double input_inertia = 0.0;      ///< rotor, code wheel and input pulley J1 [kg m^2]
  double input_damping = 0.0;      ///< at the motor shaft b1 [N m s/rad]
  double input_radius = 0.0;       ///< of the cable on the input pulley r1 [m]
  double output_inertia = 0.0;     ///< sector and what is fixed to it J2 [kg m^2]
  double output_radius = 0.0;      ///< of the cable on the sector r2 [m]
  double tip_radius = 0.0;         ///< of the point that pushes r_o [m]
  double contact_stiffness = 0.0;  ///< of what it pushes against k_o [N/m]
  double contact_damping = 0.0;    ///< c_o [N s/m]
  double cable_stiffness = 0.0;    ///< k1 [N/m]
  double torque_constant = 0.0;    ///< k_t [N m/A]
};

/// The parameters reduced to the cable (eq 5.1-5.5).
struct TwoMassCoefficients {
  double m1 = 0.0, c1 = 0.0, k1 = 0.0;  ///< motor side: [kg], [N s/m], [N/m]
  double m2 = 0.0, c2 = 0.0, k2 = 0.0;  ///< sector side
};

/// m = J/r^2, the mass [kg] that a point at radius r feels (eq 5.1); throws std::invalid_argument unless r > 0.
double mass_at_radius(double inertia, double radius);

/// c1 = b/r^2 [N s/m] (eq 5.2); throws std::invalid_argument unless r > 0.
double damping_at_radius(double damping, double radius);

/// k2 = (r_o/r2)^2 k_o: a stiffness (or damping) at the tip, felt at the cable (eq 5.3, 5.4); throws
/// std::invalid_argument unless both radii are positive.
double tip_to_cable(double tip_value, double tip_radius, double output_radius);

/// J2 + k_g^2 J1 [kg m^2]: inertia felt at the joint.
double reflected_inertia(double input_inertia, double output_inertia, double ratio);

/// Mass [kg] felt at the tip; throws std::invalid_argument unless r_o > 0.
double perceived_mass(double input_inertia, double output_inertia, double ratio, double tip_radius);

/// Smallest step of joint torque [N m]: k_t dI k_g.
double torque_resolution(double torque_constant, double current_step, double ratio);

/// Smallest step of joint angle [rad]: 2 pi / (counts k_g); throws std::invalid_argument unless both are
/// positive.
double angular_resolution(double counts_per_turn, double ratio);

class TwoMassModel {
 public:
  enum Output { tip_force, motor_angle, sector_angle };  ///< [N], [rad], [rad]
  static constexpr double kDefaultSearchLimit = 2000.0;  ///< below the contact's own mode [Hz]

  /// Empty unless inertias, radii, stiffnesses and torque constant are positive, dampings not negative, all
  /// finite.
  static std::optional<TwoMassModel> make(const TwoMassParameters& parameters);

  const TwoMassParameters& parameters() const { return parameters_; }
  const TwoMassCoefficients& coefficients() const { return coefficients_; }

  /// One input, the three outputs (eq 5.11-5.16).
  const LinearSystem& system() const { return system_; }

  /// Static output per ampere, of all three; the force's, k_t r2/(r1 r_o), does not depend on any stiffness.
  std::array<double, 3> dc_gain() const;

  /// Output per ampere at a frequency [Hz]; magnitude std::abs, phase std::arg in (-pi, pi].
  std::complex<double> frequency_response(double frequency, Output output = tip_force) const;

  /// Largest force per ampere below `max_frequency` [Hz]; see GainPeak.
  GainPeak resonance(double max_frequency = kDefaultSearchLimit) const;

  /// That gain over the static one [dB].
  double resonance_peak(double max_frequency = kDefaultSearchLimit) const;

  /// First frequency [Hz] above the resonance at which the force has fallen `drop` dB below its static value.
  std::optional<double> bandwidth(double drop_decibels = 3.0, double max_frequency = kDefaultSearchLimit) const;

  /// Force [N] in the end under a constant current [A].
  double static_force(double current) const;

  /// Force [N] at the samples 0 .. count-1 after a step of current [A] from rest, held over each period [s];
  /// exact at the samples.
  std::vector<double> step_force(double current, double period, int count) const;

 private:
  TwoMassParameters parameters_;
  TwoMassCoefficients coefficients_;
  LinearSystem system_;
};

}  // namespace zwidth
