#include "zwidth/description/internal/schema.h"

#include <cmath>
#include <fmt/format.h>

namespace zwidth {
namespace {

using enum Dimension;

using enum Need;

constexpr double kHalfTurn = 3.14159265358979323846;

constexpr Bounds kPositive{.min = 0.0, .above_min = true};
constexpr Bounds kNotNegative{.min = 0.0};
// Longer is a forgotten unit: a plain 80 is 80 m.
constexpr Bounds kLinkLength{.min = 0.0, .max = 10.0, .above_min = true};
constexpr Bounds kCoordinate{.min = -10.0, .max = 10.0};
constexpr Bounds kRadius{.min = 0.0, .max = 10.0};
constexpr Bounds kSmallLength{.min = 0.0, .max = 1.0, .above_min = true};
constexpr Bounds kAtLeastOne{.min = 1.0};
constexpr Bounds kShare{.min = 0.0, .max = 1.0, .above_min = true};
constexpr Bounds kWithinHalfTurn{.min = -kHalfTurn, .max = kHalfTurn};
constexpr Bounds kWithinTurn{.min = -2.0 * kHalfTurn, .max = 2.0 * kHalfTurn};
constexpr Bounds kOffset{.min = -10.0, .max = 10.0};  // [m]
constexpr Bounds kSign{.min = -1.0, .max = 1.0};      // 0 is refused by `validate`
constexpr Bounds kUpToTurn{.min = 0.0, .max = 2.0 * kHalfTurn};
constexpr Bounds kTurn{.min = 0.0, .max = 2.0 * kHalfTurn, .above_min = true};
constexpr Bounds kNotBelowVacuum{.min = -101325.0};
constexpr Bounds kBore{.min = 0.0, .max = 1.0};
constexpr Bounds kPlies{.min = 0.0, .max = 1000.0};
constexpr Bounds kLaminaPoisson{.min = -10.0, .max = 10.0};
constexpr Bounds kPoisson{.min = -1.0, .max = 0.5, .above_min = true};

bool bare_key(std::string_view key) {
  const auto bare = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !key.empty() && std::all_of(key.begin(), key.end(), bare);
}

}  // namespace

template <>
std::span<const Field<Motor>> fields<Motor>() {
  static const Field<Motor> list[] = {
      {"supply_voltage", &Motor::supply_voltage, voltage, kPositive, required, "nominal voltage", "\"48 V\""},
      {"no_load_speed", &Motor::no_load_speed, angular_speed, kPositive, required,
       "speed without load at the nominal voltage", "\"17800 rpm\""},
      {"no_load_current", &Motor::no_load_current, current, kNotNegative, required, "current without load",
       "\"290 mA\""},
      {"nominal_speed", &Motor::nominal_speed, angular_speed, kPositive, optional, "speed at nominal torque",
       "\"16800 rpm\""},
      {"nominal_torque", &Motor::nominal_torque, torque, kPositive, required,
       "torque that can be held continuously", "\"69.4 mN m\""},
      {"nominal_current", &Motor::nominal_current, current, kPositive, required,
       "current that can flow continuously", "\"2.96 A\""},
      {"stall_torque", &Motor::stall_torque, torque, kPositive, required,
       "torque at standstill and nominal voltage", "\"1.47 N m\""},
      {"resistance", &Motor::resistance, resistance, kPositive, required, "terminal resistance, phase to phase",
       "\"0.836 ohm\""},
      {"inductance", &Motor::inductance, inductance, kPositive, required, "terminal inductance, phase to phase",
       "\"0.118 mH\""},
      {"torque_constant", &Motor::torque_constant, torque_constant, kPositive, required, "torque per current",
       "\"25.5 mN m/A\""},
      {"speed_constant", &Motor::speed_constant, speed_constant, kPositive, required, "speed per voltage",
       "\"374 rpm/V\""},
      {"rotor_inertia", &Motor::rotor_inertia, inertia, kPositive, required, "moment of inertia of the rotor",
       "\"18.3 g cm^2\""},
      {"viscous_damping", &Motor::viscous_damping, angular_damping, kNotNegative, optional,
       "torque of bearings and iron per speed", "\"1e-6 N m s/rad\""},
      {"thermal_resistance_winding", &Motor::thermal_resistance_winding, thermal_resistance, kPositive,
       optional, "thermal resistance from winding to housing", "\"0.29 K/W\""},
      {"thermal_resistance_housing", &Motor::thermal_resistance_housing, thermal_resistance, kPositive,
       optional, "thermal resistance from housing to ambient", "\"3.5 K/W\""},
      {"thermal_time_constant_winding", &Motor::thermal_time_constant_winding, time, kPositive, optional,
       "thermal time constant of the winding", "\"3.8 s\""},
      {"thermal_time_constant_housing", &Motor::thermal_time_constant_housing, time, kPositive, optional,
       "thermal time constant of the motor", "\"952 s\""},
      {"max_winding_temperature", &Motor::max_winding_temperature, temperature, kPositive, optional,
       "highest temperature of the winding", "\"155 degC\""},
      {"max_radial_load", &Motor::max_radial_load, force, kPositive, optional,
       "largest radial force on the shaft", "\"25 N\""},
      {"radial_load_distance", &Motor::radial_load_distance, length, kNotNegative, optional,
       "distance from the flange at which the radial force acts", "\"5 mm\""},
      {"max_axial_load", &Motor::max_axial_load, force, kPositive, optional,
       "largest axial force on the turning shaft", "\"5.5 N\""},
      {"shaft_diameter", &Motor::shaft_diameter, length, kSmallLength, optional, "diameter of the shaft",
       "\"5 mm\""},
      {"max_speed", &Motor::max_speed, angular_speed, kPositive, optional, "highest permissible speed",
       "\"12000 rpm\""},
      {"speed_torque_gradient", &Motor::speed_torque_gradient, speed_torque_gradient, kPositive, optional,
       "loss of speed per torque, as the data sheet repeats it", "\"4.61 rpm/(mN m)\""},
      {"mechanical_time_constant", &Motor::mechanical_time_constant, time, kPositive, optional,
       "mechanical time constant, as the data sheet repeats it", "\"4.9 ms\""},
      {"max_efficiency", &Motor::max_efficiency, number, kShare, optional,
       "highest efficiency, as the data sheet repeats it", "0.85"},
      {"starting_current", &Motor::starting_current, current, kPositive, optional,
       "current at standstill and nominal voltage", "\"3.55 A\""},
      {"max_output_power", &Motor::max_output_power, Dimension::power, kPositive, optional,
       "highest power at nominal voltage", "\"10.2 W\""},
      {"rated_power", &Motor::rated_power, Dimension::power, kPositive, optional,
       "power that the type is called by", "\"120 W\""},
  };
  return list;
}

template <>
std::span<const Field<Gearhead>> fields<Gearhead>() {
  static const Field<Gearhead> list[] = {
      {"reduction_numerator", &Gearhead::reduction_numerator, number, kPositive, required,
       "numerator of the exact reduction", "3249"},
      {"reduction_denominator", &Gearhead::reduction_denominator, number, kPositive, optional,
       "denominator of the exact reduction", "169"},
      {"stages", &Gearhead::stages, number, kAtLeastOne, required, "number of stages", "2"},
      {"continuous_torque", &Gearhead::continuous_torque, torque, kPositive, required,
       "torque that the output may carry for ever", "\"0.15 N m\""},
      {"intermittent_torque", &Gearhead::intermittent_torque, torque, kPositive, required,
       "torque that the output may carry for a short time", "\"0.225 N m\""},
      {"max_efficiency", &Gearhead::max_efficiency, number, kShare, required, "highest efficiency", "0.81"},
      {"backlash", &Gearhead::backlash, angle, kNotNegative, optional, "backlash of the output without load",
       "\"0.8 deg\""},
      {"inertia", &Gearhead::inertia, inertia, kNotNegative, optional, "moment of inertia felt at the motor",
       "\"0.05 g cm^2\""},
      {"mass", &Gearhead::mass, mass, kPositive, optional, "mass", "\"23 g\""},
      {"length", &Gearhead::length, length, kSmallLength, optional, "length", "\"19.1 mm\""},
      {"max_motor_shaft", &Gearhead::max_motor_shaft, length, kSmallLength, optional,
       "largest diameter of the motor's shaft", "\"2 mm\""},
      {"max_input_speed", &Gearhead::max_input_speed, angular_speed, kPositive, optional,
       "highest speed of the motor", "\"8000 rpm\""},
  };
  return list;
}

template <>
std::span<const Field<Encoder>> fields<Encoder>() {
  static const Field<Encoder> list[] = {
      {"pulses_per_turn", &Encoder::pulses_per_turn, number, kAtLeastOne, required,
       "lines per turn; a quadrature decoder counts four per line", "1000"},
      {"max_frequency", &Encoder::max_frequency, frequency, kPositive, optional,
       "highest frequency of one channel", "\"200 kHz\""},
      {"code_wheel_inertia", &Encoder::code_wheel_inertia, inertia, kNotNegative, optional,
       "moment of inertia of the code wheel", "\"0.7 g cm^2\""},
  };
  return list;
}

template <>
std::span<const Field<Amplifier>> fields<Amplifier>() {
  static const Field<Amplifier> list[] = {
      {"max_supply_voltage", &Amplifier::max_supply_voltage, voltage, kPositive, required,
       "highest supply voltage", "\"50 V\""},
      {"min_supply_voltage", &Amplifier::min_supply_voltage, voltage, kNotNegative, optional,
       "lowest supply voltage", "\"11 V\""},
      {"output_voltage_factor", &Amplifier::output_voltage_factor, number, kShare, optional,
       "largest output voltage per supply voltage", "0.9"},
      {"max_current", &Amplifier::max_current, current, kPositive, required,
       "largest output current, for a short time", "\"10 A\""},
      {"max_current_time", &Amplifier::max_current_time, time, kPositive, optional,
       "how long the largest current may flow", "\"1 s\""},
      {"continuous_current", &Amplifier::continuous_current, current, kPositive, required,
       "largest continuous output current", "\"5 A\""},
      {"current_resolution", &Amplifier::current_resolution, current, kPositive, optional,
       "smallest step of a commanded current", "\"1 mA\""},
      {"current_loop_rate", &Amplifier::current_loop_rate, frequency, kPositive, optional,
       "samples per second of the current loop", "\"10 kHz\""},
      {"pwm_frequency", &Amplifier::pwm_frequency, frequency, kPositive, optional,
       "switching frequency of the output stage", "\"50 kHz\""},
      {"command_rate_one_node", &Amplifier::command_rate_one_node, frequency, kPositive, optional,
       "commands per second over the bus with one drive", "\"2000 Hz\""},
      {"command_rate_three_nodes", &Amplifier::command_rate_three_nodes, frequency, kPositive, optional,
       "commands per second over the bus with three drives", "\"666 Hz\""},
      {"proportional_gain_scale", &Amplifier::proportional_gain_scale, number, kPositive, optional,
       "register value per ohm of proportional gain", "256"},
      {"integral_gain_scale", &Amplifier::integral_gain_scale, number, kPositive, optional,
       "register value per ohm/s of integral gain", "0.0256"},
  };
  return list;
}

template <>
std::span<const Field<Cable>> fields<Cable>() {
  static const Field<Cable> list[] = {
      {"coated_diameter", &Cable::coated_diameter, length, kSmallLength, required, "diameter over the coating",
       "\"0.762 mm\""},
      {"bare_diameter", &Cable::bare_diameter, length, kSmallLength, required, "diameter of the metal rope",
       "\"0.6096 mm\""},
      {"strands", &Cable::strands, number, kAtLeastOne, required, "number of strands", "7"},
      {"wires_per_strand", &Cable::wires_per_strand, number, kAtLeastOne, required,
       "number of wires in a strand", "19"},
      {"elastic_modulus", &Cable::elastic_modulus, pressure, kPositive, required, "Young's modulus of the wire",
       "\"190 GPa\""},
      {"breaking_load", &Cable::breaking_load, force, kPositive, optional, "tension that breaks it",
       "\"270 N\""},
      {"max_working_load", &Cable::max_working_load, force, kPositive, optional, "recommended largest tension",
       "\"45 N\""},
      {"min_bend_radius", &Cable::min_bend_radius, length, kSmallLength, optional,
       "smallest radius to bend it around", "\"5 mm\""},
  };
  return list;
}

template <>
std::span<const Field<Bearing>> fields<Bearing>() {
  static const Field<Bearing> list[] = {
      {"bore", &Bearing::bore, length, kSmallLength, required, "inner diameter", "\"5 mm\""},
      {"outer_diameter", &Bearing::outer_diameter, length, kSmallLength, required, "outer diameter",
       "\"10 mm\""},
      {"width", &Bearing::width, length, kSmallLength, optional, "width", "\"4 mm\""},
      {"static_load", &Bearing::static_load, force, kPositive, optional, "basic static radial load rating C0",
       "\"1370 N\""},
      {"dynamic_load", &Bearing::dynamic_load, force, kPositive, required, "basic dynamic radial load rating C",
       "\"3450 N\""},
  };
  return list;
}

template <>
std::span<const Field<Material>> fields<Material>() {
  static const Field<Material> list[] = {
      {"elastic_modulus", &Material::elastic_modulus, pressure, kPositive, required, "Young's modulus",
       "\"68.9 GPa\""},
      {"poisson_ratio", &Material::poisson_ratio, number, kPoisson, required, "Poisson's ratio", "0.33"},
      {"density", &Material::density, density, kPositive, required, "density", "\"2700 kg/m^3\""},
      {"yield_strength", &Material::yield_strength, pressure, kPositive, optional, "0.2 % proof stress",
       "\"276 MPa\""},
  };
  return list;
}

template <>
std::span<const Field<Lamina>> fields<Lamina>() {
  static const Field<Lamina> list[] = {
      {"longitudinal_modulus", &Lamina::longitudinal_modulus, pressure, kPositive, required,
       "Young's modulus along the fibres", "\"300 GPa\""},
      {"transverse_modulus", &Lamina::transverse_modulus, pressure, kPositive, required,
       "Young's modulus across the fibres", "\"12 GPa\""},
      {"shear_modulus", &Lamina::shear_modulus, pressure, kPositive, required, "shear modulus in the plane",
       "\"5 GPa\""},
      // Its square is less than longitudinal over transverse modulus, which `validate` sees to.
      {"poisson_ratio", &Lamina::poisson_ratio, number, kLaminaPoisson, required,
       "contraction across the fibres per strain along them", "0.3"},
      {"density", &Lamina::density, density, kPositive, required, "density", "\"1600 kg/m^3\""},
      {"ply_thickness", &Lamina::ply_thickness, length, kSmallLength, optional, "thickness of one ply",
       "\"0.15 mm\""},
  };
  return list;
}

template <>
std::span<const Field<TubeDescription>> fields<TubeDescription>() {
  using Tube = TubeDescription;
  static const Field<Tube> list[] = {
      {"outer_diameter", &Tube::outer_diameter, length, kSmallLength, required, "outer diameter", "\"20 mm\""},
      {"inner_diameter", &Tube::inner_diameter, length, kBore, optional,
       "inner diameter, less than the outer one; 0 for a solid bar", "\"16 mm\""},
  };
  return list;
}

template <>
std::span<const Field<BarDescription>> fields<BarDescription>() {
  using Bar = BarDescription;
  static const Field<Bar> list[] = {
      {"width", &Bar::width, length, kSmallLength, required, "width of the section", "\"10 mm\""},
      {"height", &Bar::height, length, kSmallLength, required, "height of the section, across the width",
       "\"20 mm\""},
  };
  return list;
}

template <>
std::span<const Field<PlyDescription>> fields<PlyDescription>() {
  using Ply = PlyDescription;
  static const Field<Ply> list[] = {
      {"count", &Ply::count, number, kPlies, required, "number of plies at this angle", "4"},
      {"angle", &Ply::angle, angle, kWithinHalfTurn, optional, "angle of the fibres from the link's axis",
       "\"45 deg\""},
  };
  return list;
}

template <>
std::span<const Field<Cylinder>> fields<Cylinder>() {
  static const Field<Cylinder> list[] = {
      {"stroke", &Cylinder::stroke, length, kSmallLength, required, "way of the rod", "\"12.5 mm\""},
      {"bore", &Cylinder::bore, length, kSmallLength, optional, "diameter of the piston", "\"0.366 in\""},
      {"rear_area", &Cylinder::rear_area, area, kPositive, required, "area of the piston on the closed side",
       "\"0.105 in^2\""},
      {"rod_area", &Cylinder::rod_area, area, kPositive, required,
       "area of the piston on the rod's side, less the rod", "\"0.093 in^2\""},
      {"max_pressure", &Cylinder::max_pressure, pressure, kPositive, required, "highest pressure, gauge",
       "\"100 psi\""},
      {"breakaway_pressure", &Cylinder::breakaway_pressure, pressure, kNotNegative, optional,
       "least pressure difference that moves the piston", "\"0.2 psi\""},
      {"friction_share", &Cylinder::friction_share, number, kNotNegative, optional,
       "friction of the piston per force", "0.015"},
      {"moving_mass", &Cylinder::moving_mass, mass, kNotNegative, optional, "mass of piston and rod",
       "\"5.2 g\""},
      {"mass", &Cylinder::mass, mass, kPositive, optional, "mass of the whole cylinder", "\"36 g\""},
  };
  return list;
}

template <>
std::span<const Field<Regulator>> fields<Regulator>() {
  static const Field<Regulator> list[] = {
      {"min_pressure", &Regulator::min_pressure, pressure, kNotBelowVacuum, required,
       "pressure at the least command, gauge", "\"1 kPa\""},
      {"max_pressure", &Regulator::max_pressure, pressure, kPositive, required,
       "pressure at the largest command, gauge", "\"500 kPa\""},
      {"min_command", &Regulator::min_command, voltage, {}, optional, "least command", "0"},
      {"max_command", &Regulator::max_command, voltage, kPositive, required, "largest command", "\"10 V\""},
      {"min_monitor",
       &Regulator::min_monitor,
       voltage,
       {},
       optional,
       "monitor output at the least pressure",
       "\"1 V\""},
      {"max_monitor", &Regulator::max_monitor, voltage, kPositive, optional,
       "monitor output at the highest pressure", "\"5 V\""},
      {"max_supply_pressure", &Regulator::max_supply_pressure, pressure, kPositive, required,
       "highest supply pressure, gauge", "\"1 MPa\""},
      {"linearity", &Regulator::linearity, number, kShare, optional,
       "largest deviation from a straight line, per span", "0.01"},
      {"response_time", &Regulator::response_time, time, kPositive, optional,
       "time to follow a step of the command", "\"0.1 s\""},
  };
  return list;
}

template <>
std::span<const Field<Potentiometer>> fields<Potentiometer>() {
  static const Field<Potentiometer> list[] = {
      {"electrical_angle", &Potentiometer::electrical_angle, angle, kTurn, required,
       "angle over which the output goes from end to end", "\"330 deg\""},
      {"linearity", &Potentiometer::linearity, number, kShare, optional,
       "largest deviation from a straight line, per voltage applied", "0.02"},
      {"max_voltage", &Potentiometer::max_voltage, voltage, kPositive, optional,
       "highest voltage that may be applied", "\"16 V\""},
      {"friction_torque", &Potentiometer::friction_torque, torque, kNotNegative, optional,
       "torque that turns it", "\"2.9 mN m\""},
  };
  return list;
}

template <>
std::span<const Field<DeltaDescription>> fields<DeltaDescription>() {
  using Delta = DeltaDescription;
  static const Field<Delta> list[] = {
      {"base_radius", &Delta::base_radius, length, kRadius, required, "radius of the actuator axes",
       "\"80 mm\""},
      {"upper_arm", &Delta::upper_arm, length, kLinkLength, required, "length of the driven link", "\"80 mm\""},
      {"forearm", &Delta::forearm, length, kLinkLength, required, "length of the parallelogram", "\"160 mm\""},
      {"platform_radius", &Delta::platform_radius, length, kRadius, required,
       "radius of the joints on the platform", "\"55 mm\""},
      {"joint_range", &Delta::joint_range, angle, kWithinHalfTurn, required,
       "lowest and highest angle of every driven joint; 0 is horizontal, positive lifts the elbow",
       "[\"-36 deg\", \"84 deg\"]"},
  };
  return list;
}

template <>
std::span<const Field<FiveBarDescription>> fields<FiveBarDescription>() {
  using FiveBar = FiveBarDescription;
  static const Field<FiveBar> list[] = {
      {"crank", &FiveBar::crank, length, kLinkLength, required, "length of each driven link", "\"100 mm\""},
      {"coupler", &FiveBar::coupler, length, kLinkLength, required, "length of each link that holds the tool",
       "\"150 mm\""},
      {"half_base", &FiveBar::half_base, length, kRadius, required, "half the distance of the motors",
       "\"30 mm\""},
      {"left_range", &FiveBar::left_range, angle, kWithinTurn, required,
       "lowest and highest angle of the left crank, from +x", "[\"60 deg\", \"200 deg\"]"},
      {"right_range", &FiveBar::right_range, angle, kWithinTurn, required,
       "lowest and highest angle of the right crank, from +x", "[\"-20 deg\", \"120 deg\"]"},
      {"left_mode", &FiveBar::left_mode, number, kSign, optional,
       "working mode of the left leg, 1 or -1: on which side of the line from motor to tool its elbow is; 1 is "
       "anticlockwise",
       "1"},
      {"right_mode", &FiveBar::right_mode, number, kSign, optional, "working mode of the right leg, 1 or -1",
       "-1"},
      {"assembly_mode", &FiveBar::assembly_mode, number, kSign, optional,
       "1 or -1: the tool lies to the left or right of the line from the left elbow to the right one", "1"},
  };
  return list;
}

template <>
std::span<const Field<RCubeDescription>> fields<RCubeDescription>() {
  using RCube = RCubeDescription;
  static const Field<RCube> list[] = {
      {"drive_link", &RCube::drive_link, length, kLinkLength, required, "length of the driven link",
       "\"106 mm\""},
      {"inner_link", &RCube::inner_link, length, kLinkLength, required,
       "length of the link after the universal joint", "\"200 mm\""},
      {"outer_link", &RCube::outer_link, length, kLinkLength, required,
       "length of the link that holds the platform", "\"200 mm\""},
      {"base_offset", &RCube::base_offset, length, kRadius, required,
       "distance of each motor axis from the base origin", "\"106 mm\""},
      {"joint_range", &RCube::joint_range, angle, kWithinHalfTurn, required,
       "lowest and highest angle of every driven joint", "[\"-34 deg\", \"34 deg\"]"},
      {"elbow_mode", &RCube::elbow_mode, number, kSign, optional,
       "1 or -1: the sign of the sine of every elbow angle", "-1"},
  };
  return list;
}

template <>
std::span<const Field<SerialJointDescription>> fields<SerialJointDescription>() {
  using Joint = SerialJointDescription;
  static const Field<Joint> list[] = {
      {"theta", &Joint::theta, angle, kWithinTurn, optional, "turn about z; of a revolute joint at value 0",
       "\"90 deg\""},
      {"d", &Joint::d, length, kOffset, optional, "shift along z; of a prismatic joint at value 0",
       "\"250 mm\""},
      {"a", &Joint::a, length, kOffset, optional, "shift along x", "\"95 mm\""},
      {"alpha", &Joint::alpha, angle, kWithinTurn, optional, "turn about x", "\"-90 deg\""},
  };
  return list;
}

template <>
std::span<const Field<CapstanDescription>> fields<CapstanDescription>() {
  using Capstan = CapstanDescription;
  static const Field<Capstan> list[] = {
      {"input_diameter", &Capstan::input_diameter, length, kSmallLength, required,
       "major diameter of the thread on the input pulley", "\"10 mm\""},
      {"lead", &Capstan::lead, length, kSmallLength, required, "lead of the thread (single start, 60 deg V)",
       "\"1 mm\""},
      {"output_diameter", &Capstan::output_diameter, length, kLinkLength, required,
       "diameter of the output sector", "\"150 mm\""},
      {"centre_distance", &Capstan::centre_distance, length, kLinkLength, required, "distance of the two axes",
       "\"80.5 mm\""},
      {"wraps", &Capstan::wraps, number, kAtLeastOne, required, "turns of cable on the input pulley", "3"},
      {"friction", &Capstan::friction, number, kPositive, required,
       "coefficient of friction between cable and pulley", "0.1"},
      {"preload", &Capstan::preload, force, kPositive, required, "cable tension at rest", "\"9.5 N\""},
      {"output_range", &Capstan::output_range, angle, kUpToTurn, optional,
       "angle that the output turns through; 0 takes the joint's range", "\"120 deg\""},
      {"mid_angle", &Capstan::mid_angle, angle, kWithinHalfTurn, optional,
       "joint angle in the middle of the output range; left out: the middle of the joint's range",
       "\"24 deg\""},
      {"cable_stiffness_factor", &Capstan::cable_stiffness_factor, number, kShare, optional,
       "share of the metal's stiffness that the rope really has", "0.225"},
  };
  return list;
}

template <>
std::span<const Field<RatioDescription>> fields<RatioDescription>() {
  using Ratio = RatioDescription;
  static const Field<Ratio> list[] = {
      {"ratio", &Ratio::ratio, number, kPositive, required, "turns of the motor per turn of the joint", "10"},
      {"efficiency", &Ratio::efficiency, number, kShare, optional,
       "share of the motor's torque that reaches the joint", "0.95"},
      {"stiffness", &Ratio::stiffness, angular_stiffness, kPositive, optional, "stiffness felt at the joint",
       "\"500 N m/rad\""},
      {"backlash", &Ratio::backlash, angle, kNotNegative, optional, "backlash felt at the joint", "0"},
      {"inertia", &Ratio::inertia, inertia, kNotNegative, optional,
       "moment of inertia of its wheels, felt at the joint", "\"2e-4 kg m^2\""},
  };
  return list;
}

template <>
std::span<const Field<GearheadDescription>> fields<GearheadDescription>() {
  using Gear = GearheadDescription;
  static const Field<Gear> list[] = {
      {"further_ratio", &Gear::further_ratio, number, kPositive, optional,
       "turns of the gearhead's output per turn of the joint", "1"},
      {"further_efficiency", &Gear::further_efficiency, number, kShare, optional,
       "efficiency of what lies between gearhead and joint", "1"},
      {"stiffness", &Gear::stiffness, angular_stiffness, kPositive, optional, "stiffness felt at the joint",
       "\"40 N m/rad\""},
  };
  return list;
}

template <>
std::span<const Field<FlexureDescription>> fields<FlexureDescription>() {
  using Flexure = FlexureDescription;
  static const Field<Flexure> list[] = {
      {"flexible_length", &Flexure::flexible_length, length, kSmallLength, required, "length that bends",
       "\"55 mm\""},
      {"rigid_length", &Flexure::rigid_length, length, kRadius, required, "length beyond it that does not",
       "\"15 mm\""},
      {"width", &Flexure::width, length, kSmallLength, required, "width of the spring", "\"4 mm\""},
      {"height", &Flexure::height, length, kSmallLength, required,
       "height of the spring, in the direction of bending", "\"2.5 mm\""},
  };
  return list;
}

template <>
std::span<const Field<DriveOutputDescription>> fields<DriveOutputDescription>() {
  using Output = DriveOutputDescription;
  static const Field<Output> list[] = {
      {"inertia", &Output::inertia, inertia, kPositive, required,
       "moment of inertia of the sector and what is bolted to it", "\"2.117e-4 kg m^2\""},
      {"radius", &Output::radius, length, kLinkLength, required,
       "distance from the joint axis to the point that pushes", "\"80 mm\""},
      {"contact_stiffness", &Output::contact_stiffness, stiffness, kPositive, required,
       "stiffness of what it pushes against", "\"9.8e7 N/m\""},
      {"contact_damping", &Output::contact_damping, damping, kNotNegative, optional,
       "damping of what it pushes against", "0"},
  };
  return list;
}

template <>
std::span<const Field<ArmCylinderDescription>> fields<ArmCylinderDescription>() {
  using Arm = ArmCylinderDescription;
  static const Field<Arm> list[] = {
      {"l0", &Arm::l0, length, kCoordinate, optional,
       "base pin along the arm (two, two_mod); arm pin along the arm (three)", "\"10.8 mm\""},
      {"l1", &Arm::l1, length, kCoordinate, required,
       "base pin across the arm (one, two, two_mod); arm pin across the arm (three)", "\"81.3 mm\""},
      {"l2", &Arm::l2, length, kLinkLength, required,
       "arm pin from the pivot (one, two, two_mod); base pin behind the pivot (three)", "\"12.5 mm\""},
      {"h", &Arm::h, length, kCoordinate, optional, "base pin above the pivot (three)", "\"10.8 mm\""},
      {"retracted_length", &Arm::retracted_length, length, kLinkLength, required,
       "length from pin to pin with the rod in", "\"75 mm\""},
  };
  return list;
}

template <>
std::span<const Field<PneumaticDriveDescription>> fields<PneumaticDriveDescription>() {
  using Drive = PneumaticDriveDescription;
  static const Field<Drive> list[] = {
      {"supply_pressure", &Drive::supply_pressure, pressure, kPositive, required,
       "pressure that supplies the regulators, gauge", "\"0.7 MPa\""},
      {"bias_pressure", &Drive::bias_pressure, pressure, kNotNegative, optional,
       "pressure of the chamber that works against the force, gauge", "\"0.02 MPa\""},
      {"sensor_voltage", &Drive::sensor_voltage, voltage, kNotNegative, optional,
       "voltage across the potentiometer", "\"5 V\""},
      {"sensor_step", &Drive::sensor_step, voltage, kNotNegative, optional,
       "smallest step of its output that is read", "\"1.22 mV\""},
  };
  return list;
}

template <>
std::span<const Field<DriveDescription>> fields<DriveDescription>() {
  using Drive = DriveDescription;
  static const Field<Drive> list[] = {
      {"supply_voltage", &Drive::supply_voltage, voltage, kPositive, required,
       "voltage that supplies the amplifier", "\"48 V\""},
      {"proportional_gain", &Drive::proportional_gain, number, kNotNegative, optional,
       "proportional gain of the current loop, in the amplifier's register units", "300"},
      {"integral_gain", &Drive::integral_gain, number, kNotNegative, optional,
       "integral gain of the current loop, in the amplifier's register units", "130"},
      {"input_inertia", &Drive::input_inertia, inertia, kNotNegative, optional,
       "moment of inertia on the motor shaft beside rotor and code wheel", "\"0.44 g cm^2\""},
      {"peak_factor", &Drive::peak_factor, number, kAtLeastOne, optional,
       "short-time torque per continuous torque", "1.3"},
  };
  return list;
}

std::string bounds_rule(const Bounds& bounds, Dimension dimension) {
  const bool low = std::isfinite(bounds.min), high = std::isfinite(bounds.max);
  const auto text = [dimension](double value) {
    if (value == 0.0) return std::string("0");
    if (dimension == Dimension::number) return fmt::format("{}", value);
    if (dimension == Dimension::angle) return format_quantity(value, dimension);
    return fmt::format("{} {}", value, si_unit(dimension));
  };
  if (low && high) {
    if (bounds.above_min)
      return fmt::format("must be more than {} and at most {}", text(bounds.min), text(bounds.max));
    return fmt::format("must be from {} to {}", text(bounds.min), text(bounds.max));
  }
  if (low && bounds.min == 0.0) return bounds.above_min ? "must be positive" : "must not be negative";
  if (low) return fmt::format("must be {} {}", bounds.above_min ? "more than" : "at least", text(bounds.min));
  if (high) return fmt::format("must be at most {}", text(bounds.max));
  return "must be finite";
}

std::string shortened(std::string text) {
  constexpr std::size_t kLongestShown = 60;
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (text.size() <= kLongestShown) return text;
  std::size_t end = kLongestShown - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // not within a character
  return text.substr(0, end) + "...";
}

std::string join_path(const std::string& table, std::string_view key) {
  std::string name = bare_key(key) ? std::string(key) : '"' + shortened(std::string(key)) + '"';
  return table.empty() ? name : table + '.' + name;
}

std::string join_path(const std::string& array, std::size_t index) {
  return fmt::format("{}[{}]", array, index);
}

void check_number(double value, Dimension dimension, const Bounds& bounds, const std::string& path,
                  const std::string& advice, std::vector<Problem>& problems) {
  if (!std::isfinite(value)) {
    problems.push_back(
        {.key = path, .value = fmt::format("{}", value), .rule = "must be finite", .advice = advice});
  } else if (!bounds.contains(value)) {
    problems.push_back({.key = path,
                        .value = format_quantity(value, dimension),
                        .rule = bounds_rule(bounds, dimension),
                        .advice = advice});
  }
}

void check_interval(const Interval& interval, Dimension dimension, const Bounds& bounds,
                    const std::string& path, const std::string& advice, std::vector<Problem>& problems) {
  const std::size_t before = problems.size();
  check_number(interval.min, dimension, bounds, join_path(path, 0), advice, problems);
  check_number(interval.max, dimension, bounds, join_path(path, 1), advice, problems);
  if (problems.size() == before && !(interval.min < interval.max)) {
    problems.push_back({.key = path,
                        .value = fmt::format("[{}, {}]", format_quantity(interval.min, dimension),
                                             format_quantity(interval.max, dimension)),
                        .rule = "must go from a smaller to a larger value",
                        .advice = advice});
  }
}

}  // namespace zwidth
