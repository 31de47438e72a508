#include <numbers>
#include <optional>

#include "quantities.h"

#include "zwidth/actuation/cable.h"
#include "zwidth/actuation/capstan.h"
#include "zwidth/actuation/current_loop.h"
#include "zwidth/actuation/encoder.h"
#include "zwidth/actuation/flexure.h"
#include "zwidth/actuation/motor.h"
#include "zwidth/actuation/two_mass.h"
#include "zwidth/math/statistics.h"

namespace zwidth::reference {
namespace {

constexpr double kRpm = std::numbers::pi / 30.0;                    // [rad/s]
constexpr double kArcSecond = std::numbers::pi / (180.0 * 3600.0);  // [rad]

template <class T>
const T& valid(const std::optional<T>& answer) {
  if (!answer) throw Refusal("invalid_argument");
  return *answer;
}

Capstan capstan(const Inputs& in) {
  const Capstan answer = solve_capstan({.input_diameter = in.number("d1_m"),
                                        .lead = in.number("d2_m"),
                                        .cable_diameter = in.number("d4_m"),
                                        .output_diameter = in.number("d6_m"),
                                        .centre_distance = in.number("d8_m"),
                                        .wraps = in.number("k_r"),
                                        .friction = in.number("mu"),
                                        .output_range = in.degrees("theta6_deg")});
  if (answer.status == CapstanStatus::invalid_argument) throw Refusal("invalid_argument");
  if (answer.status == CapstanStatus::not_seated) throw Refusal("not_seated");
  return answer;
}

double in_degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

CapstanLoads loads(const Inputs& in) {
  const double torque = in.number("T_u_Nm");
  return in.has("F_p_N") ? capstan(in).loads(in.number("F_p_N"), torque)
                         : capstan(in).loads_at_min_preload(torque);
}

CurrentLoop loop(const Inputs& in) {
  return valid(CurrentLoop::make(in.number("R_ohm"), in.number("L_H"),
                                 {.proportional = in.number("KP_ohm"), .integral = in.number("KI_ohm_s")}));
}
StepMetrics step(const Inputs& in) {
  return valid(loop(in).metrics(in.number("sample_period_s")));
}

RopeSection rope(const Inputs& in) {
  return valid(
      rope_section(in.number("bare_diameter_m"), in.integer("strands"), in.integer("wires_per_strand")));
}

Flexure flexure(const Inputs& in) {
  return valid(Flexure::make(in.number("l1_m"), in.number("l2_m"), in.number("w_m"), in.number("h_m"),
                             in.number("E_Pa")));
}

TwoMassModel actuator(const Inputs& in) {
  return valid(TwoMassModel::make({.input_inertia = in.number("J1_kgm2"),
                                   .input_damping = in.number("b1_Nms_rad"),
                                   .input_radius = in.number("r1_m"),
                                   .output_inertia = in.number("J2_kgm2"),
                                   .output_radius = in.number("r2_m"),
                                   .tip_radius = in.number("r_o_m"),
                                   .contact_stiffness = in.number("k_o_N_m"),
                                   .contact_damping = in.number("c_o_Ns_m"),
                                   .cable_stiffness = in.number("k1_N_m"),
                                   .torque_constant = in.number("kt_Nm_A")}));
}

double search_limit(const Inputs& in) {
  return in.number_or("f_max_Hz", TwoMassModel::kDefaultSearchLimit);
}

void add_motor(Quantities& q) {
  const auto damping = [](const Inputs& in) {
    return equivalent_damping(in.number("kt_Nm_A"), in.number("kb_Vs_rad"), in.number("R_ohm"),
                              in.number_or("b_Nms_rad", 0.0));
  };
  q["motor.equivalent_damping"] = [damping](const Inputs& in) { return Values{damping(in)}; };
  q["motor.mechanical_time_constant"] = [damping](const Inputs& in) {
    return Values{mechanical_time_constant(in.number("J_kgm2"), damping(in))};
  };
  q["motor.electrical_time_constant"] = [](const Inputs& in) {
    return Values{electrical_time_constant(in.number("R_ohm"), in.number("L_H"))};
  };
  q["motor.torque"] = [](const Inputs& in) {
    return Values{motor_torque(in.number("kt_Nm_A"), in.number("current_A"))};
  };
  q["encoder.max_speed"] = [](const Inputs& in) {
    return Values{encoder_max_speed(in.number("max_frequency_Hz"), in.number("pulses_per_rev")) / kRpm};
  };
  q["noise.standard_deviation"] = [](const Inputs& in) {
    return Values{valid(standard_deviation(in.number("variance_mA2")))};
  };
  q["noise.average_power"] = [](const Inputs& in) {
    return Values{valid(average_power(in.number("variance_mA2"), in.number("mean_mA"), in.integer("samples")))};
  };
  q["spectrum.frequency_resolution"] = [](const Inputs& in) {
    return Values{
        valid(frequency_resolution(in.number("sample_rate_Hz"), in.integer("samples"), in.integer("windows")))};
  };
}

void add_current_loop(Quantities& q) {
  q["current_loop.gain_si.P"] = [](const Inputs& in) {
    return Values{gains_from_registers(in.number("P_epos"), 0.0, kEpos2GainScale).proportional};
  };
  q["current_loop.gain_si.I"] = [](const Inputs& in) {
    return Values{gains_from_registers(0.0, in.number("I_epos"), kEpos2GainScale).integral};
  };
  q["current_loop.gain_epos"] = [](const Inputs& in) {
    const GainRegisters r = registers_from_gains({in.number("KP_ohm"), in.number("KI_ohm_s")}, kEpos2GainScale);
    return Values{static_cast<double>(r.proportional), static_cast<double>(r.integral)};
  };
  q["current_loop.bandwidth"] = [](const Inputs& in) {
    return Values{valid(loop(in).bandwidth(in.number("drop_dB")))};
  };
  q["current_loop.step.samples"] = [](const Inputs& in) {
    return loop(in).step(in.number("sample_period_s"), in.integer("count"));
  };
  q["current_loop.step.rise_samples"] = [](const Inputs& in) {
    return Values{1.0 * valid(step(in).rise_samples)};
  };
  q["current_loop.step.time_constant_samples"] = [](const Inputs& in) {
    return Values{1.0 * valid(step(in).time_constant_samples)};
  };
  q["current_loop.step.settling_samples"] = [](const Inputs& in) {
    return Values{1.0 * valid(step(in).settling_samples)};
  };
  q["current_loop.step.overshoot"] = [](const Inputs& in) { return Values{100.0 * step(in).overshoot}; };
  q["current_loop.step.steady_state_error"] = [](const Inputs& in) {
    return Values{step(in).steady_state_error};
  };
}

void add_capstan(Quantities& q) {
  const std::map<std::string, double Capstan::*> lengths = {
      {"d3", &Capstan::pitch_diameter},        {"d5", &Capstan::input_pitch_diameter},
      {"d7", &Capstan::output_pitch_diameter}, {"d9", &Capstan::length_on_input},
      {"d10", &Capstan::length_on_output},     {"d11", &Capstan::length_between},
      {"d12", &Capstan::cable_length},         {"d13", &Capstan::input_width},
      {"d14", &Capstan::thread_width},         {"k_g", &Capstan::ratio}};
  for (const auto& [name, member] : lengths) {
    q["capstan." + name] = [member = member](const Inputs& in) { return Values{capstan(in).*member}; };
  }
  const std::map<std::string, double Capstan::*> angles = {{"theta1", &Capstan::helix_angle},
                                                           {"theta2", &Capstan::groove_half_angle},
                                                           {"theta3", &Capstan::cable_angle},
                                                           {"theta4", &Capstan::tangent_angle},
                                                           {"theta5", &Capstan::contact_angle}};
  for (const auto& [name, member] : angles) {
    q["capstan." + name] = [member = member](const Inputs& in) {
      return Values{in_degrees(capstan(in).*member)};
    };
  }
  const std::map<std::string, double CapstanLoads::*> forces = {
      {"F_u", &CapstanLoads::tension_difference}, {"F_p", &CapstanLoads::preload},
      {"F_l", &CapstanLoads::low_tension},        {"F_h", &CapstanLoads::high_tension},
      {"F_bx", &CapstanLoads::bearing_x},         {"F_by", &CapstanLoads::bearing_y},
      {"F_bz", &CapstanLoads::bearing_axial},     {"F_br", &CapstanLoads::bearing_radial}};
  for (const auto& [name, member] : forces) {
    q["capstan." + name] = [member = member](const Inputs& in) { return Values{loads(in).*member}; };
  }
  q["capstan.d8_min"] = [](const Inputs& in) { return Values{capstan(in).min_centre_distance}; };
  q["capstan.T_o"] = [](const Inputs& in) { return Values{capstan(in).output_torque(in.number("T_u_Nm"))}; };
  q["capstan.torque_with_factor"] = [](const Inputs& in) {
    return Values{capstan(in).output_torque(in.number("T_u_Nm"), in.number("factor"))};
  };
  q["capstan.torque_limit"] = [](const Inputs& in) {
    return Values{capstan(in).slip_torque(in.number("F_p_N"))};
  };

  q["cable.strand_diameter"] = [](const Inputs& in) { return Values{rope(in).strand_diameter}; };
  q["cable.wire_diameter"] = [](const Inputs& in) { return Values{rope(in).wire_diameter}; };
  q["cable.wire_area"] = [](const Inputs& in) { return Values{rope(in).wire_area}; };
  q["cable.metal_area"] = [](const Inputs& in) { return Values{rope(in).metal_area}; };
  q["cable.equivalent_length"] = [](const Inputs& in) {
    return Values{valid(capstan(in).equivalent_cable_length(in.degrees("offset_deg")))};
  };
  q["cable.stiffness"] = [](const Inputs& in) {
    return Values{
        valid(cable_stiffness(in.number("E_Pa"), in.number("A_m2"), in.number("l_m"), in.number_or("S", 1.0)))};
  };
}

void add_flexure(Quantities& q) {
  q["flexure.area_moment"] = [](const Inputs& in) { return Values{flexure(in).area_moment()}; };
  q["flexure.section_modulus"] = [](const Inputs& in) { return Values{flexure(in).section_modulus()}; };
  q["flexure.stiffness"] = [](const Inputs& in) { return Values{flexure(in).stiffness()}; };
  q["flexure.deflection"] = [](const Inputs& in) {
    return Values{valid(flexure(in).deflection(in.number("F_N"), in.number("x_m")))};
  };
  q["flexure.slope"] = [](const Inputs& in) {
    return Values{valid(flexure(in).slope(in.number("F_N"), in.number("x_m")))};
  };
  q["flexure.moment_magnitude"] = [](const Inputs& in) {
    return Values{std::abs(valid(flexure(in).moment(in.number("F_N"), in.number("x_m"))))};
  };
  q["flexure.bending_stress"] = [](const Inputs& in) {
    return Values{flexure(in).bending_stress(in.number("F_N"))};
  };
}

void add_actuator(Quantities& q) {
  q["actuator.r1"] = [](const Inputs& in) { return Values{capstan(in).input_pitch_diameter / 2.0}; };
  q["actuator.r2"] = [](const Inputs& in) { return Values{capstan(in).output_pitch_diameter / 2.0}; };
  q["actuator.m1"] = [](const Inputs& in) {
    return Values{mass_at_radius(in.number("J1_kgm2"), in.number("r1_m"))};
  };
  q["actuator.m2"] = [](const Inputs& in) {
    return Values{mass_at_radius(in.number("J2_kgm2"), in.number("r2_m"))};
  };
  q["actuator.c1"] = [](const Inputs& in) {
    return Values{damping_at_radius(in.number("b1_Nms_rad"), in.number("r1_m"))};
  };
  q["actuator.k2"] = [](const Inputs& in) {
    return Values{tip_to_cable(in.number("k_o_N_m"), in.number("r_o_m"), in.number("r2_m"))};
  };
  q["actuator.inertia"] = [](const Inputs& in) {
    return Values{reflected_inertia(in.number("J1_kgm2"), in.number("J2_kgm2"), in.number("k_g"))};
  };
  q["actuator.perceived_mass"] = [](const Inputs& in) {
    return Values{
        perceived_mass(in.number("J1_kgm2"), in.number("J2_kgm2"), in.number("k_g"), in.number("r_o_m"))};
  };
  q["actuator.torque_resolution"] = [](const Inputs& in) {
    return Values{torque_resolution(in.number("kt_Nm_A"), in.number("current_A"), in.number("k_g"))};
  };
  q["actuator.angular_resolution"] = [](const Inputs& in) {
    return Values{angular_resolution(in.number("counts_per_rev"), in.number("k_g")) / kArcSecond};
  };
  q["actuator.static_force"] = [](const Inputs& in) {
    return Values{actuator(in).static_force(in.number("current_A"))};
  };
  q["actuator.dc_gain"] = [](const Inputs& in) {
    const auto gain = actuator(in).dc_gain();
    return Values(gain.begin(), gain.end());
  };
  q["actuator.resonance_frequency"] = [](const Inputs& in) {
    return Values{actuator(in).resonance(search_limit(in)).frequency};
  };
  q["actuator.resonance_peak"] = [](const Inputs& in) {
    return Values{actuator(in).resonance_peak(search_limit(in))};
  };
  q["actuator.bandwidth"] = [](const Inputs& in) {
    return Values{valid(actuator(in).bandwidth(in.number("drop_dB"), search_limit(in)))};
  };
  q["actuator.frf"] = [](const Inputs& in) {
    const auto output = static_cast<TwoMassModel::Output>(in.has("output") ? in.integer("output") : 0);
    const std::complex<double> response = actuator(in).frequency_response(in.number("frequency_Hz"), output);
    return Values{std::abs(response), std::arg(response)};
  };
  q["actuator.step.force"] = [](const Inputs& in) {
    return actuator(in).step_force(in.number("current_A"), in.number("sample_period_s"), in.integer("count"));
  };
}

}  // namespace

void add_actuation(Quantities& quantities) {
  add_motor(quantities);
  add_current_loop(quantities);
  add_capstan(quantities);
  add_flexure(quantities);
  add_actuator(quantities);
}

}  // namespace zwidth::reference
