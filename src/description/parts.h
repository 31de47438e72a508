#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <string>

/// Parts: catalogue entries that a device file names. Plain data in SI units, read from `parts/*.toml`.
/// A quantity whose source gives no value is NaN ("not given"); `given(x)` tells. Values below that start as
/// NaN may be left out of a file, the others are always there.

namespace zwidth {

inline constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
inline bool given(double value) {
  return !std::isnan(value);
}

/// What every part carries.
struct PartInfo {
  std::string name;    ///< catalogue key, as a device file writes it
  std::string title;   ///< what a person calls it
  std::string source;  ///< where its values come from; "chosen: ..." where no source gives them
  std::map<std::string, std::string> sources = {};  ///< of single values (by key) that come from elsewhere

  bool operator==(const PartInfo&) const = default;
};

struct Motor {
  PartInfo info;
  double supply_voltage = 0.0;                    ///< nominal [V]
  double no_load_speed = 0.0;                     ///< [rad/s]
  double no_load_current = 0.0;                   ///< [A]
  double nominal_speed = kNotGiven;               ///< [rad/s]
  double nominal_torque = 0.0;                    ///< continuous [N m]
  double nominal_current = 0.0;                   ///< continuous [A]
  double stall_torque = 0.0;                      ///< [N m]
  double resistance = 0.0;                        ///< terminal, phase to phase [ohm]
  double inductance = 0.0;                        ///< terminal, phase to phase [H]
  double torque_constant = 0.0;                   ///< [N m/A]
  double speed_constant = 0.0;                    ///< [rad/s/V]
  double rotor_inertia = 0.0;                     ///< [kg m^2]
  double viscous_damping = 0.0;                   ///< bearing and iron losses b [N m s/rad]; 0 when not given
  double thermal_resistance_winding = kNotGiven;  ///< winding to housing [K/W]
  double thermal_resistance_housing = kNotGiven;  ///< housing to ambient [K/W]
  double thermal_time_constant_winding = kNotGiven;  ///< [s]
  double thermal_time_constant_housing = kNotGiven;  ///< [s]
  double max_winding_temperature = kNotGiven;        ///< [K]
  double max_radial_load = kNotGiven;       ///< on the shaft, at `radial_load_distance` from the flange [N]
  double radial_load_distance = kNotGiven;  ///< [m]
  double max_axial_load = kNotGiven;        ///< dynamic [N]
  double shaft_diameter = kNotGiven;        ///< [m]
  double max_speed = kNotGiven;             ///< that the bearings and the commutation permit [rad/s]
  // What a data sheet repeats; `motor_consistency` compares it with what follows from the values above.
  double speed_torque_gradient = kNotGiven;     ///< loss of speed per torque [rad/s/(N m)]
  double mechanical_time_constant = kNotGiven;  ///< [s]
  double max_efficiency = kNotGiven;            ///< [-]
  double starting_current = kNotGiven;          ///< at standstill and nominal voltage [A]
  double max_output_power = kNotGiven;          ///< at nominal voltage [W]
  double rated_power = kNotGiven;               ///< by which the type is called [W]

  bool operator==(const Motor& other) const;  ///< values not given are equal
};

/// A gear train between motor and joint.
struct Gearhead {
  PartInfo info;
  double reduction_numerator = 0.0;    ///< of the exact reduction, turns of the motor per turn of the output
  double reduction_denominator = 1.0;  ///< 1 where the reduction is given as a decimal number
  int stages = 0;
  double continuous_torque = 0.0;      ///< that the output may carry for ever [N m]
  double intermittent_torque = 0.0;    ///< that it may carry for a short time [N m]
  double max_efficiency = 1.0;         ///< [-]
  double backlash = kNotGiven;         ///< of the output, without load, on average [rad]
  double inertia = 0.0;                ///< felt at the motor [kg m^2]; 0 when not given
  double mass = kNotGiven;             ///< [kg]
  double length = kNotGiven;           ///< [m]
  double max_motor_shaft = kNotGiven;  ///< largest diameter of the motor's shaft [m]
  double max_input_speed = kNotGiven;  ///< [rad/s]

  bool operator==(const Gearhead& other) const;  ///< values not given are equal
};

struct Encoder {
  PartInfo info;
  double pulses_per_turn = 0.0;      ///< lines; a quadrature decoder counts four per line
  double max_frequency = kNotGiven;  ///< of one channel [Hz]
  double code_wheel_inertia = 0.0;   ///< [kg m^2]; 0 when not given

  bool operator==(const Encoder& other) const;  ///< values not given are equal
};

struct Amplifier {
  PartInfo info;
  double max_supply_voltage = 0.0;              ///< [V]
  double min_supply_voltage = kNotGiven;        ///< [V]
  double output_voltage_factor = 1.0;           ///< output voltage per supply voltage
  double max_current = 0.0;                     ///< for `max_current_time` [A]
  double max_current_time = kNotGiven;          ///< [s]
  double continuous_current = 0.0;              ///< [A]
  double current_resolution = kNotGiven;        ///< smallest commanded step [A]
  double current_loop_rate = kNotGiven;         ///< [Hz]
  double pwm_frequency = kNotGiven;             ///< [Hz]
  double command_rate_one_node = kNotGiven;     ///< bus commands per second with one drive [Hz]
  double command_rate_three_nodes = kNotGiven;  ///< with three drives on the bus [Hz]
  double proportional_gain_scale = 1.0;         ///< register value per ohm
  double integral_gain_scale = 1.0;             ///< register value per ohm/s

  bool operator==(const Amplifier& other) const;  ///< values not given are equal
};

struct Cable {
  PartInfo info;
  double coated_diameter = 0.0;  ///< over the coating [m]
  double bare_diameter = 0.0;    ///< of the metal rope [m]
  int strands = 0;
  int wires_per_strand = 0;
  double elastic_modulus = 0.0;         ///< of the wire material [Pa]
  double breaking_load = kNotGiven;     ///< [N]
  double max_working_load = kNotGiven;  ///< recommended [N]
  double min_bend_radius = kNotGiven;   ///< [m]

  bool operator==(const Cable& other) const;  ///< values not given are equal
};

struct Bearing {
  PartInfo info;
  double bore = 0.0;               ///< [m]
  double outer_diameter = 0.0;     ///< [m]
  double width = kNotGiven;        ///< [m]
  double static_load = kNotGiven;  ///< basic static radial load rating C0 [N]
  double dynamic_load = 0.0;       ///< basic dynamic radial load rating C [N]

  bool operator==(const Bearing& other) const;  ///< values not given are equal
};

struct Material {
  PartInfo info;
  double elastic_modulus = 0.0;       ///< Young's modulus [Pa]
  double poisson_ratio = 0.0;         ///< [-]
  double density = 0.0;               ///< [kg/m^3]
  double yield_strength = kNotGiven;  ///< 0.2 % proof stress [Pa]

  bool operator==(const Material& other) const;  ///< values not given are equal
};

/// Parallel fibres in a matrix: what one ply is made of. Axis 1 lies along the fibres, axis 2 across them.
struct Lamina {
  PartInfo info;
  double longitudinal_modulus = 0.0;  ///< E1 [Pa]
  double transverse_modulus = 0.0;    ///< E2 [Pa]
  double shear_modulus = 0.0;         ///< G12 [Pa]
  double poisson_ratio = 0.0;         ///< nu12 [-]
  double density = 0.0;               ///< [kg/m^3]
  double ply_thickness = kNotGiven;   ///< [m]

  bool operator==(const Lamina& other) const;  ///< values not given are equal
};

/// A double-acting air cylinder with one rod.
struct Cylinder {
  PartInfo info;
  double stroke = 0.0;              ///< [m]
  double bore = kNotGiven;          ///< [m]
  double rear_area = 0.0;           ///< of the piston on the closed side A1 [m^2]
  double rod_area = 0.0;            ///< of the piston on the rod's side A2 [m^2]
  double max_pressure = 0.0;        ///< gauge [Pa]
  double breakaway_pressure = 0.0;  ///< pressure difference that just moves the piston [Pa]; 0 when not given
  double friction_share = 0.0;      ///< piston friction per force; 0 when not given
  double moving_mass = 0.0;         ///< piston and rod [kg]; 0 when not given
  double mass = kNotGiven;          ///< the whole cylinder [kg]

  bool operator==(const Cylinder& other) const;  ///< values not given are equal
};

/// A proportional pressure regulator: a voltage commands a chamber's pressure, another reports it.
struct Regulator {
  PartInfo info;
  double min_pressure = 0.0;         ///< gauge, at the least command [Pa]
  double max_pressure = 0.0;         ///< gauge, at the largest command [Pa]
  double min_command = 0.0;          ///< [V]
  double max_command = 0.0;          ///< [V]
  double min_monitor = kNotGiven;    ///< of the reported pressure, at min_pressure [V]
  double max_monitor = kNotGiven;    ///< at max_pressure [V]
  double max_supply_pressure = 0.0;  ///< gauge [Pa]
  double linearity = kNotGiven;      ///< largest deviation per span [-]
  double response_time = kNotGiven;  ///< to a step of the command [s]

  bool operator==(const Regulator& other) const;  ///< values not given are equal
};

/// A rotary potentiometer as an angle sensor.
struct Potentiometer {
  PartInfo info;
  double electrical_angle = 0.0;       ///< over which the voltage rises from zero to that applied [rad]
  double linearity = kNotGiven;        ///< largest deviation per voltage applied [-]
  double max_voltage = kNotGiven;      ///< that may be applied [V]
  double friction_torque = kNotGiven;  ///< [N m]

  bool operator==(const Potentiometer& other) const;  ///< values not given are equal
};

}  // namespace zwidth
