#pragma once

#include <optional>
#include <string>
#include <vector>

#include "zwidth/description/parts.h"
#include "zwidth/description/units.h"

/// A direct-current motor (brushed, or brushless with its commutation), electrical, mechanical and thermal
/// (Neal 2015, section 4.1). All quantities at the motor shaft.
///
/// The formulas on plain numbers throw std::invalid_argument when a quantity that divides is not positive.

namespace zwidth {

/// Damping felt at the shaft with the terminals held at a voltage, k_t k_b / R + b [N m s/rad] (eq 4.5).
double equivalent_damping(double torque_constant, double back_emf_constant, double resistance,
                          double viscous_damping = 0.0);

/// J / b_e [s] (eq 4.4).
double mechanical_time_constant(double inertia, double damping);

/// L / R [s] (eq 4.6).
double electrical_time_constant(double resistance, double inductance);

/// Torque of the field, k_t I [N m].
double motor_torque(double torque_constant, double current);

/// Torque at the shaft, k_t (I - I0 sign(speed)) [N m] (eq 4.8). At rest, friction holds up to k_t I0 either
/// way: the torque shrinks towards zero by that much, and is zero inside.
double shaft_torque(double torque_constant, double current, double no_load_current, double speed);

/// Loss of speed per torque at constant voltage, R / k_t^2 [rad/s per N m].
double speed_torque_gradient(double torque_constant, double resistance);

/// Torque with the shaft held at a voltage, k_t V / R [N m].
double stall_torque(double torque_constant, double resistance, double voltage);

/// Speed per voltage without friction, 1/k_t [rad/s/V].
double speed_constant(double torque_constant);

/// Speed without load at a voltage, (V - R I0)/k_t [rad/s].
double no_load_speed(double torque_constant, double resistance, double voltage, double no_load_current);

/// Highest share of the electrical power that reaches the shaft at a voltage, (1 - sqrt(I0 R/V))^2; zero if the
/// voltage does not suffice to turn it.
double max_efficiency(double resistance, double voltage, double no_load_current);

/// One value that a data sheet repeats, beside what follows from voltage, resistance, torque constant, rotor
/// inertia and no-load current.
struct MotorConsistency {
  std::string key;        ///< as in parts/motors.toml
  double given = 0.0;     ///< [SI]
  double computed = 0.0;  ///< [SI]
  Dimension dimension = Dimension::number;
  double difference() const { return computed / given - 1.0; }  ///< relative
};

/// Every value of the data sheet that can be checked so, in a fixed order. A difference beyond two hundredths
/// or so is a misprint, a coarse rounding or another operating point.
std::vector<MotorConsistency> motor_consistency(const Motor& motor);

/// What follows from the data of one motor. The back-EMF constant is taken equal to the torque constant, as the
/// energy balance demands (and as Neal 2015 computes, though he prints 1/k_n).
double equivalent_damping(const Motor& motor);
double mechanical_time_constant(const Motor& motor);
double electrical_time_constant(const Motor& motor);

/// Speed [rad/s] at a voltage [V] under a shaft torque [N m], from the speed constant, the resistance and the
/// no-load current; negative when the torque drives the motor backwards.
double motor_speed(const Motor& motor, double voltage, double torque);

/// Two bodies, winding and housing, warmed by I^2 R with the resistance of warm copper.
/// Temperatures in kelvin. Build one with `thermal_model`.
class ThermalModel {
 public:
  /// Winding temperature in the end [K] at an effective current [A]; empty when it runs away (the copper's
  /// resistance rises faster than the heat leaves).
  std::optional<double> steady_winding_temperature(double current, double ambient = kRoomTemperature) const;

  /// Effective current [A] that ends at the maximum winding temperature; zero when the room is hotter than
  /// that.
  double continuous_current(double ambient = kRoomTemperature) const;

  /// Winding temperature [K] after `time` [s] at a constant current [A], from ambient.
  double winding_temperature(double current, double time, double ambient = kRoomTemperature) const;

  /// Time [s] from ambient to the maximum winding temperature at a constant current [A]; empty when it is never
  /// reached, zero when the room is already hotter.
  std::optional<double> time_to_overheat(double current, double ambient = kRoomTemperature) const;

  double max_winding_temperature() const { return max_temperature_; }

  static constexpr double kRoomTemperature = 298.15;  ///< [K], at which data sheets give the resistance
  static constexpr double kCopperResistanceRise =
      0.00393;  ///< per kelvin, of the resistance at kRoomTemperature

 private:
  friend std::optional<ThermalModel> thermal_model(const Motor& motor);
  double resistance_ = 0.0;
  double resistance_winding_ = 0.0;
  double resistance_housing_ = 0.0;
  double capacity_winding_ = 0.0;
  double capacity_housing_ = 0.0;
  double max_temperature_ = 0.0;
};

/// Empty when the motor's thermal data are not given.
std::optional<ThermalModel> thermal_model(const Motor& motor);

}  // namespace zwidth
