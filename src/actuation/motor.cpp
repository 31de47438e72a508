#include "zwidth/actuation/motor.h"

#include <algorithm>
#include <cmath>

#include "zwidth/actuation/require.h"

namespace zwidth {

double equivalent_damping(double torque_constant, double back_emf_constant, double resistance,
                          double viscous_damping) {
  return torque_constant * back_emf_constant / require_positive("resistance", resistance) + viscous_damping;
}

double mechanical_time_constant(double inertia, double damping) {
  return inertia / require_positive("damping", damping);
}

double electrical_time_constant(double resistance, double inductance) {
  return inductance / require_positive("resistance", resistance);
}

double motor_torque(double torque_constant, double current) {
  return torque_constant * current;
}

double shaft_torque(double torque_constant, double current, double no_load_current, double speed) {
  if (speed != 0.0) {
    return torque_constant * (current - std::copysign(no_load_current, speed));
  }
  return torque_constant * std::copysign(std::max(0.0, std::abs(current) - no_load_current), current);
}

double speed_torque_gradient(double torque_constant, double resistance) {
  require_positive("torque constant", torque_constant);
  return resistance / (torque_constant * torque_constant);
}

double stall_torque(double torque_constant, double resistance, double voltage) {
  return torque_constant * voltage / require_positive("resistance", resistance);
}

double speed_constant(double torque_constant) {
  return 1.0 / require_positive("torque constant", torque_constant);
}

double no_load_speed(double torque_constant, double resistance, double voltage, double no_load_current) {
  return (voltage - resistance * no_load_current) / require_positive("torque constant", torque_constant);
}

double max_efficiency(double resistance, double voltage, double no_load_current) {
  const double share = no_load_current * resistance / require_positive("voltage", voltage);
  if (!(share >= 0.0)) throw std::invalid_argument("resistance and no-load current must not be negative");
  return share < 1.0 ? std::pow(1.0 - std::sqrt(share), 2) : 0.0;
}

std::vector<MotorConsistency> motor_consistency(const Motor& motor) {
  const double U = motor.supply_voltage, R = motor.resistance, kt = motor.torque_constant,
               I0 = motor.no_load_current;
  std::vector<MotorConsistency> list;
  const auto add = [&](const char* key, double value, double computed, Dimension dimension) {
    if (given(value)) list.push_back({key, value, computed, dimension});
  };
  add("stall_torque", motor.stall_torque, stall_torque(kt, R, U), Dimension::torque);
  add("speed_constant", motor.speed_constant, speed_constant(kt), Dimension::speed_constant);
  add("speed_torque_gradient", motor.speed_torque_gradient, speed_torque_gradient(kt, R),
      Dimension::speed_torque_gradient);
  add("mechanical_time_constant", motor.mechanical_time_constant,
      mechanical_time_constant(motor.rotor_inertia, equivalent_damping(kt, kt, R)), Dimension::time);
  add("no_load_speed", motor.no_load_speed, no_load_speed(kt, R, U, I0), Dimension::angular_speed);
  add("max_efficiency", motor.max_efficiency, max_efficiency(R, U, I0), Dimension::number);
  add("starting_current", motor.starting_current, U / R, Dimension::current);
  // A straight line of speed against torque has its most power in the middle.
  add("max_output_power", motor.max_output_power, 0.25 * stall_torque(kt, R, U) * no_load_speed(kt, R, U, I0),
      Dimension::power);
  return list;
}

double equivalent_damping(const Motor& motor) {
  return equivalent_damping(motor.torque_constant, motor.torque_constant, motor.resistance,
                            motor.viscous_damping);
}

double mechanical_time_constant(const Motor& motor) {
  return mechanical_time_constant(motor.rotor_inertia, equivalent_damping(motor));
}

double electrical_time_constant(const Motor& motor) {
  return electrical_time_constant(motor.resistance, motor.inductance);
}

double motor_speed(const Motor& motor, double voltage, double torque) {
  const double current =
      torque / require_positive("torque constant", motor.torque_constant) + motor.no_load_current;
  return motor.speed_constant * (voltage - motor.resistance * current);
}

std::optional<ThermalModel> thermal_model(const Motor& motor) {
  const double data[] = {motor.resistance,
                         motor.thermal_resistance_winding,
                         motor.thermal_resistance_housing,
                         motor.thermal_time_constant_winding,
                         motor.thermal_time_constant_housing,
                         motor.max_winding_temperature};
  if (!std::all_of(std::begin(data), std::end(data), [](double x) { return x > 0.0 && std::isfinite(x); })) {
    return std::nullopt;
  }
  ThermalModel model;
  model.resistance_ = motor.resistance;
  model.resistance_winding_ = motor.thermal_resistance_winding;
  model.resistance_housing_ = motor.thermal_resistance_housing;
  model.capacity_winding_ = motor.thermal_time_constant_winding / motor.thermal_resistance_winding;
  model.capacity_housing_ = motor.thermal_time_constant_housing / motor.thermal_resistance_housing;
  model.max_temperature_ = motor.max_winding_temperature;
  return model;
}

// With P = I^2 R and the copper's rise, x = T_winding - T_ambient and y = T_housing - T_ambient obey
//   C_w xdot = P (1 + alpha (T_ambient - T_room)) + alpha P x - (x - y)/R_w
//   C_h ydot = (x - y)/R_w - y/R_h

std::optional<double> ThermalModel::steady_winding_temperature(double current, double ambient) const {
  const double P = current * current * resistance_;
  const double R_th = resistance_winding_ + resistance_housing_;
  const double stay = 1.0 - R_th * P * kCopperResistanceRise;
  if (!(stay > 0.0)) {
    return std::nullopt;
  }
  const double P_ambient = P * (1.0 + kCopperResistanceRise * (ambient - kRoomTemperature));
  return ambient + R_th * P_ambient / stay;
}

double ThermalModel::continuous_current(double ambient) const {
  const double hot = resistance_ * (1.0 + kCopperResistanceRise * (max_temperature_ - kRoomTemperature));
  const double rise = std::max(0.0, max_temperature_ - ambient);
  return std::sqrt(rise / ((resistance_winding_ + resistance_housing_) * hot));
}

double ThermalModel::winding_temperature(double current, double time, double ambient) const {
  const double P = current * current * resistance_;
  const double a11 = (kCopperResistanceRise * P - 1.0 / resistance_winding_) / capacity_winding_;
  const double a12 = 1.0 / (resistance_winding_ * capacity_winding_);
  const double a21 = 1.0 / (resistance_winding_ * capacity_housing_);
  const double a22 = -(1.0 / resistance_winding_ + 1.0 / resistance_housing_) / capacity_housing_;
  const double heat = P * (1.0 + kCopperResistanceRise * (ambient - kRoomTemperature)) / capacity_winding_;
  // a12 a21 > 0: two real rates. x is the integral of the impulse response
  //   h(t) = heat ((r1 - a22) e^{r1 t} - (r2 - a22) e^{r2 t})/(r1 - r2).
  const double half_gap = std::hypot(0.5 * (a11 - a22), std::sqrt(a12 * a21));
  const double r1 = 0.5 * (a11 + a22) + half_gap;
  const double r2 = 0.5 * (a11 + a22) - half_gap;
  const auto integral = [time](double r) { return r == 0.0 ? time : std::expm1(r * time) / r; };
  return ambient + heat * ((r1 - a22) * integral(r1) - (r2 - a22) * integral(r2)) / (r1 - r2);
}

std::optional<double> ThermalModel::time_to_overheat(double current, double ambient) const {
  if (ambient >= max_temperature_) {
    return 0.0;
  }
  const std::optional<double> end = steady_winding_temperature(current, ambient);
  if (end && *end <= max_temperature_) {
    return std::nullopt;
  }
  // From rest under a constant current the temperature only rises, so that one crossing exists.
  double before = 0.0;
  double after = resistance_winding_ * capacity_winding_;
  while (winding_temperature(current, after, ambient) < max_temperature_) {
    before = after;
    after *= 2.0;
  }
  for (;;) {
    const double middle = 0.5 * (before + after);
    if (middle <= before || middle >= after) {
      return middle;
    }
    (winding_temperature(current, middle, ambient) < max_temperature_ ? before : after) = middle;
  }
}

}  // namespace zwidth
