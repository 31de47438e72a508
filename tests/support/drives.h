#pragma once

#include <numbers>

#include "zwidth/description/description.h"

namespace zwidth::test {

/// The capstan drive of Neal 2015 (tables 4.2 to 4.11 and 5.1), with the sector's middle where table 5.1 has
/// it. The supply voltage is chosen: the source has none.
inline DriveDescription published_drive() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;
  DriveDescription drive;
  drive.motor.supply_voltage = 48.0;
  drive.motor.no_load_speed = 17800.0 * kRpm;
  drive.motor.no_load_current = 0.290;
  drive.motor.nominal_speed = 16800.0 * kRpm;
  drive.motor.nominal_torque = 0.0694;
  drive.motor.nominal_current = 2.96;
  drive.motor.stall_torque = 1.470;
  drive.motor.resistance = 0.836;
  drive.motor.inductance = 0.118e-3;
  drive.motor.torque_constant = 0.0255;
  drive.motor.speed_constant = 374.0 * kRpm;
  drive.motor.rotor_inertia = 1.83e-6;
  drive.motor.max_radial_load = 25.0;
  drive.motor.max_axial_load = 5.5;
  drive.encoder.pulses_per_turn = 1000.0;
  drive.encoder.max_frequency = 200e3;
  drive.encoder.code_wheel_inertia = 0.07e-6;
  drive.amplifier.min_supply_voltage = 11.0;
  drive.amplifier.max_supply_voltage = 50.0;
  drive.amplifier.output_voltage_factor = 0.9;
  drive.amplifier.max_current = 10.0;
  drive.amplifier.continuous_current = 5.0;
  drive.amplifier.current_resolution = 1e-3;
  drive.amplifier.proportional_gain_scale = 256.0;
  drive.amplifier.integral_gain_scale = 0.0256;
  drive.supply_voltage = 48.0;
  drive.proportional_gain = 300.0;
  drive.integral_gain = 130.0;
  drive.input_inertia = 0.044e-6;
  drive.peak_factor = 1.3;

  CapstanDescription capstan;
  capstan.input_diameter = 10e-3;
  capstan.lead = 1e-3;
  capstan.cable.coated_diameter = 0.762e-3;
  capstan.cable.bare_diameter = 0.6096e-3;
  capstan.cable.strands = 7;
  capstan.cable.wires_per_strand = 19;
  capstan.cable.elastic_modulus = 1.9e11;
  capstan.cable.max_working_load = 45.0;
  capstan.cable.breaking_load = 270.0;
  capstan.cable.min_bend_radius = 5e-3;
  capstan.output_diameter = 150e-3;
  capstan.centre_distance = 80.5e-3;
  capstan.wraps = 3.0;
  capstan.friction = 0.1;
  capstan.preload = 9.5;
  capstan.output_range = 120.0 * kDegree;
  capstan.mid_angle = 24.14 * kDegree;
  capstan.cable_stiffness_factor = 0.225;
  drive.transmission = capstan;

  FlexureDescription flexure;
  flexure.flexible_length = 55e-3;
  flexure.rigid_length = 15e-3;
  flexure.width = 4e-3;
  flexure.height = 2.5e-3;
  flexure.material.elastic_modulus = 68.98e9;
  flexure.material.yield_strength = 276e6;
  drive.preloader = flexure;

  DriveOutputDescription output;
  output.inertia = 2.117e-4;
  output.radius = 80e-3;
  output.contact_stiffness = 9.8e7;
  output.contact_damping = 0.0;
  drive.output = output;
  return drive;
}

/// The joint's range as the source prints it.
inline Interval published_drive_range() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  return {-36.0 * kDegree, 84.0 * kDegree};
}

}  // namespace zwidth::test
