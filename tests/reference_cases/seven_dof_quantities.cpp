#include <algorithm>
#include <fmt/format.h>
#include <numbers>

#include "quantities.h"
#include "support/positioning_stage.h"

#include "zwidth/actuation/gearhead.h"
#include "zwidth/actuation/motor.h"
#include "zwidth/actuation/two_mass.h"
#include "zwidth/analysis/balance.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/analysis/statics.h"
#include "zwidth/description/names.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/dynamics.h"

// Statics, balance, resolution and drives of the 7-DOF arm (Baser 2006).

namespace zwidth::reference {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRpm = std::numbers::pi / 30.0;

// Seven angles, or the first few of them.
ActiveVector angles(const Inputs& in) {
  const bool degrees = in.has("theta_deg");
  const Values given = in.list(degrees ? "theta_deg" : "theta_rad");
  ActiveVector theta = ActiveVector::Zero(7);
  for (std::size_t i = 0; i < given.size() && i < 7; ++i) {
    theta[static_cast<Eigen::Index>(i)] = given[i] * (degrees ? kDegree : 1.0);
  }
  if (!theta.allFinite()) throw Refusal("invalid_argument");
  return theta;
}

double link(const Inputs& in, const char* key) {
  const double length = in.number_or(key, 0.25);
  if (!(length > 0.0)) throw Refusal("invalid_argument");
  return length;
}

Mechanism arm(const Inputs& in) {
  return Mechanism(test::arm_description(link(in, "d3_m"), link(in, "d4_m")));
}

Posture posture(const Mechanism& mechanism, const Inputs& in) {
  return *solve_forward(mechanism, angles(in)).posture;
}

MomentFrame moment_frame(const Inputs& in) {
  for (const auto& [name, frame] : moment_frame_names()) {
    if (name == in.text("moment_frame")) return frame;
  }
  throw Refusal("invalid_argument");
}

ActiveVector torques(const Inputs& in) {
  const Mechanism mechanism = arm(in);
  const Posture at = posture(mechanism, in);
  const Wrench wrench =
      wrench_in_base(in.vector("F_N"), in.vector("M_Nm"), moment_frame(in), at.tool().rotation);
  return torques_against(jacobian(at), tool_load(mechanism, wrench));
}

test::PositioningStage stage(const Inputs& in) {
  return {.m1 = in.number("m1_kg"),
          .m3 = in.number("m3_kg"),
          .m4 = in.number("m4_kg"),
          .mL = in.number("mL_kg"),
          .mc = in.number("mc_kg"),
          .l1 = in.number("l1_m"),
          .l2 = in.number("l2_m"),
          .l3 = in.number("l3_m"),
          .l4 = in.number("l4_m"),
          .d1 = in.number("d1_m"),
          .d2 = in.number("d2_m"),
          .d3 = in.number("d3_m"),
          .d4 = in.number("d4_m")};
}

Description balanced(const Inputs& in) {
  Description description = test::balanced_arm(stage(in));
  description.gravity = {0.0, 0.0, -in.number_or("g_mps2", kStandardGravity)};
  return description;
}

// Along the upper link and along the forearm.
Values residuals(const Inputs& in) {
  const std::vector<Vector3> moments = first_moments(Mechanism(balanced(in)));
  return {moments[1].z(), moments[3].z()};
}

Values list(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

double quantity(const std::string& unit, double value, Dimension dimension) {
  const ParsedQuantity parsed = parse_quantity(fmt::format("{} {}", value, unit), dimension);
  if (!parsed) throw Refusal("invalid_argument");
  return *parsed.value;
}

void add_statics(Quantities& q) {
  q["joint_torques"] = [](const Inputs& in) {
    const ActiveVector all = torques(in);
    return Values(all.begin(), all.end());
  };
  q["abs_joint_torques"] = [](const Inputs& in) {
    const ActiveVector all = torques(in);
    Values chosen;
    for (const double joint : in.list("joints")) chosen.push_back(std::abs(all[static_cast<int>(joint) - 1]));
    return chosen;
  };
  q["balance_residuals"] = [](const Inputs& in) { return residuals(in); };
  q["balance_residual_over_mc_l3"] = [](const Inputs& in) {
    return Values{residuals(in)[0] / (in.number("mc_kg") * in.number("l3_m"))};
  };
  q["balance_residual_over_mL_d1"] = [](const Inputs& in) {
    return Values{residuals(in)[1] / (in.number("mL_kg") * in.number("d1_m"))};
  };
  q["mass_centre"] = [](const Inputs& in) {
    const Mechanism mechanism(balanced(in));
    return list(mass_centre(posture(mechanism, in)));
  };
  q["gravity_torque"] = [](const Inputs& in) {
    const Mechanism mechanism(balanced(in));
    const ActiveVector torque = gravity_torques(posture(mechanism, in));
    return Values(torque.begin(), torque.begin() + 4);
  };
  q["balancing_counterweight"] = [](const Inputs& in) {
    constexpr std::size_t kCounterweight = 4;
    const auto body = balanced_body(balanced(in), kCounterweight);
    if (!body) throw Refusal("invalid_argument");
    const double along_upper = body->body.pivot.z(), along_fore = body->body.centre.z() - along_upper;
    return Values{-along_fore, -along_upper};  // d4_m, l3_m
  };
  q["stiffness"] = [](const Inputs& in) {
    return Values{stiffness_under_weight(in.number("mass_kg"), in.number("deflection_m"),
                                         in.number_or("g_mps2", kStandardGravity))};
  };
}

void add_drives(Quantities& q) {
  q["motor_torque"] = [](const Inputs& in) {
    return Values{required_motor_torque(in.number("Q_Nm"), in.number("ratio"), in.number("efficiency"))};
  };
  q["output_torque"] = [](const Inputs& in) {
    return Values{output_torque(in.number("M_Nm"), in.number("ratio"), in.number("efficiency"))};
  };
  q["reduction"] = [](const Inputs& in) { return Values{reduction(in.number("num"), in.number("den"))}; };
  q["stall_torque"] = [](const Inputs& in) {
    return Values{stall_torque(in.number("kt_Nm_per_A"), in.number("R_ohm"), in.number("U_V"))};
  };
  q["speed_constant"] = [](const Inputs& in) {
    return Values{speed_constant(in.number("kt_Nm_per_A")) / kRpm};
  };
  q["speed_torque_gradient"] = [](const Inputs& in) {
    return Values{speed_torque_gradient(in.number("kt_Nm_per_A"), in.number("R_ohm")) / (kRpm * 1e3)};
  };
  q["mechanical_time_constant"] = [](const Inputs& in) {
    const double kt = in.number("kt_Nm_per_A");
    return Values{
        mechanical_time_constant(in.number("J_kgm2"), equivalent_damping(kt, kt, in.number("R_ohm")))};
  };
  q["max_efficiency"] = [](const Inputs& in) {
    return Values{max_efficiency(in.number("R_ohm"), in.number("U_V"), in.number("I0_A"))};
  };
  q["no_load_speed"] = [](const Inputs& in) {
    return Values{
        no_load_speed(in.number("kt_Nm_per_A"), in.number("R_ohm"), in.number("U_V"), in.number("I0_A")) /
        kRpm};
  };
  q["joint_step_deg"] = [](const Inputs& in) {
    return Values{angular_resolution(in.number("counts"), in.number("ratio")) / kDegree};
  };
  q["translational_resolution"] = [](const Inputs& in) {
    const Mechanism mechanism = arm(in);
    const int joint = in.integer("joint") - 1;
    if (joint < 0 || joint > 6) throw Refusal("invalid_argument");
    return Values{tool_step(posture(mechanism, in), joint, in.degrees("step_deg")).distance};
  };
}

void add_conversions(Quantities& q) {
  q["newton_of_lbf"] = [](const Inputs& in) {
    return Values{quantity("lbf", in.number("lbf"), Dimension::force)};
  };
  q["newtonmetre_of_lbf_ft"] = [](const Inputs& in) {
    return Values{quantity("lbf ft", in.number("lbf_ft"), Dimension::torque)};
  };
  q["metre_of_foot"] = [](const Inputs& in) {
    return Values{quantity("ft", in.number(in.has("ft") ? "ft" : "foot"), Dimension::length)};
  };
}

}  // namespace

void add_seven_dof(Quantities& quantities) {
  add_statics(quantities);
  add_drives(quantities);
  add_conversions(quantities);
}

}  // namespace zwidth::reference
