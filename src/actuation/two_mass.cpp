#include "zwidth/actuation/two_mass.h"

#include <cmath>
#include <numbers>

#include "zwidth/actuation/require.h"

namespace zwidth {

using std::numbers::pi;

double mass_at_radius(double inertia, double radius) {
  require_positive("radius", radius);
  return inertia / (radius * radius);
}

double damping_at_radius(double damping, double radius) {
  return mass_at_radius(damping, radius);
}

double tip_to_cable(double tip_value, double tip_radius, double output_radius) {
  const double r =
      require_positive("tip radius", tip_radius) / require_positive("output radius", output_radius);
  return r * r * tip_value;
}

double reflected_inertia(double input_inertia, double output_inertia, double ratio) {
  return output_inertia + ratio * ratio * input_inertia;
}

double perceived_mass(double input_inertia, double output_inertia, double ratio, double tip_radius) {
  return mass_at_radius(reflected_inertia(input_inertia, output_inertia, ratio), tip_radius);
}

double torque_resolution(double torque_constant, double current_step, double ratio) {
  return torque_constant * current_step * ratio;
}

double angular_resolution(double counts_per_turn, double ratio) {
  return 2.0 * pi / (require_positive("counts per turn", counts_per_turn) * require_positive("ratio", ratio));
}

std::optional<TwoMassModel> TwoMassModel::make(const TwoMassParameters& parameters) {
  const TwoMassParameters& p = parameters;
  for (double x : {p.input_inertia, p.input_radius, p.output_inertia, p.output_radius, p.tip_radius,
                   p.contact_stiffness, p.cable_stiffness, p.torque_constant}) {
    if (!(x > 0.0) || !std::isfinite(x)) {
      return std::nullopt;
    }
  }
  for (double x : {p.input_damping, p.contact_damping}) {
    if (!(x >= 0.0) || !std::isfinite(x)) {
      return std::nullopt;
    }
  }
  const double r1 = p.input_radius;
  const double r2 = p.output_radius;
  const double r_o = p.tip_radius;
  const double m1 = mass_at_radius(p.input_inertia, r1);         // (5.1)
  const double m2 = mass_at_radius(p.output_inertia, r2);        // (5.1)
  const double c1 = damping_at_radius(p.input_damping, r1);      // (5.2)
  const double k2 = tip_to_cable(p.contact_stiffness, r_o, r2);  // (5.3)
  const double c2 = tip_to_cable(p.contact_damping, r_o, r2);    // (5.4)
  const double k1 = p.cable_stiffness;                           // (5.5)

  TwoMassModel model;
  model.parameters_ = parameters;
  model.coefficients_ = {m1, c1, k1, m2, c2, k2};
  LinearSystem& system = model.system_;
  system.A.resize(4, 4);
  system.A << 0.0, 1.0, 0.0, 0.0,               //
      -k1 / m1, -c1 / m1, k1 / m1, 0.0,         //
      0.0, 0.0, 0.0, 1.0,                       //
      k1 / m2, 0.0, -(k1 + k2) / m2, -c2 / m2;  // (5.11)
  system.B = InputMatrix::Zero(4, 1);
  system.B(1, 0) = p.torque_constant / (r1 * m1);
  system.C.resize(3, 4);
  system.C << 0.0, 0.0, r2 * k2 / r_o, r2 * c2 / r_o,  // (5.15)
      1.0 / r1, 0.0, 0.0, 0.0,                         // (5.16)
      0.0, 0.0, 1.0 / r2, 0.0;
  system.D = FeedthroughMatrix::Zero(3, 1);
  return model;
}

std::array<double, 3> TwoMassModel::dc_gain() const {
  const double r1 = parameters_.input_radius;
  const double r2 = parameters_.output_radius;
  const double F = parameters_.torque_constant / r1;  // in the cable, per ampere
  return {F * r2 / parameters_.tip_radius, F * (1.0 / coefficients_.k1 + 1.0 / coefficients_.k2) / r1,
          F / (coefficients_.k2 * r2)};
}

std::complex<double> TwoMassModel::frequency_response(double frequency, Output output) const {
  return system_.frequency_response(2.0 * pi * frequency)(output, 0);
}

GainPeak TwoMassModel::resonance(double max_frequency) const {
  return system_.peak_gain(max_frequency, tip_force);
}

double TwoMassModel::resonance_peak(double max_frequency) const {
  return decibel(resonance(max_frequency).gain / dc_gain()[tip_force]);
}

std::optional<double> TwoMassModel::bandwidth(double drop_decibels, double max_frequency) const {
  const double level = dc_gain()[tip_force] * ratio_of_decibel(-drop_decibels);
  return system_.first_fall_below(level, resonance(max_frequency).frequency, tip_force);
}

double TwoMassModel::static_force(double current) const {
  return dc_gain()[tip_force] * current;
}

std::vector<double> TwoMassModel::step_force(double current, double period, int count) const {
  return step_response(system_.zero_order_hold(period), count, current, tip_force);
}

}  // namespace zwidth
