#include "zwidth/actuation/capstan.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace zwidth {
namespace {

using std::numbers::pi;

constexpr double kTan30 = 0.577350269189625764509148780502;  // the thread's flanks lean 30 degrees

bool positive(double x) {
  return x > 0.0 && std::isfinite(x);
}

/// The rule that the chosen dimensions break; empty when none.
std::string_view broken_rule(const CapstanDimensions& dimensions) {
  if (!positive(dimensions.input_diameter)) return "the input diameter must be positive";
  if (!positive(dimensions.lead)) return "the lead must be positive";
  if (!positive(dimensions.cable_diameter)) return "the cable diameter must be positive";
  if (!positive(dimensions.output_diameter)) return "the output diameter must be positive";
  if (!positive(dimensions.centre_distance)) return "the centre distance must be positive";
  if (!(dimensions.wraps >= 1.0) || !std::isfinite(dimensions.wraps)) return "there must be at least one wrap";
  if (!positive(dimensions.friction)) return "the friction coefficient must be positive";
  if (!(dimensions.output_range >= 0.0) || !std::isfinite(dimensions.output_range)) {
    return "the output range must not be negative";
  }
  return {};
}

}  // namespace

CapstanDimensions capstan_dimensions(const CapstanDescription& description, const Interval& joint_range) {
  return {.input_diameter = description.input_diameter,
          .lead = description.lead,
          .cable_diameter = description.cable.coated_diameter,
          .output_diameter = description.output_diameter,
          .centre_distance = description.centre_distance,
          .wraps = description.wraps,
          .friction = description.friction,
          .output_range = description.output_range == 0.0 ? joint_range.width() : description.output_range};
}

Capstan solve_capstan(const CapstanDimensions& dimensions, const CapstanOptions& options) {
  Capstan capstan;
  capstan.dimensions = dimensions;
  capstan.reason = broken_rule(dimensions);
  if (!capstan.reason.empty()) {
    return capstan;
  }
  const double d1 = dimensions.input_diameter;
  const double d2 = dimensions.lead;
  const double d4 = dimensions.cable_diameter;
  const double d6 = dimensions.output_diameter;
  const double d8 = dimensions.centre_distance;
  const double k_r = dimensions.wraps;
  const double mu = dimensions.friction;
  const double theta6 = dimensions.output_range;

  const double d3 = d1 - 3.0 * d2 / (8.0 * kTan30);  // (4.14)
  capstan.pitch_diameter = d3;
  if (!(d3 > 0.0)) {
    capstan.reason =
        "the thread is deeper than its core: the pitch diameter d1 - 3 d2/(8 tan 30 deg) must be positive";
    return capstan;
  }

  double theta1 = std::atan(d2 / (pi * d3));  // (4.15)
  double theta2 = 0.0;
  double d5 = 0.0;
  double d3_contact = 0.0;
  constexpr int kMaxRounds = 200;  // each gains about two digits
  bool converged = false;
  for (int round = 0; round < kMaxRounds && !converged; ++round) {
    theta2 = std::atan(std::cos(theta1) * kTan30);                                                  // (4.16)
    d5 = d1 - 7.0 * d2 / (8.0 * kTan30) + d4 / std::sin(theta2);                                    // (4.17)
    d3_contact = std::hypot(d5 - d4 * std::sin(theta2), d4 * std::cos(theta2) * std::sin(theta1));  // (4.18)
    if (!options.iterate_helix) {
      break;
    }
    const double theta1_next = std::atan(d2 / (pi * d3_contact));
    converged = std::abs(theta1_next - theta1) <= 4e-16 * theta1_next;
    theta1 = theta1_next;
  }
  if (!(d5 > 0.0)) {
    capstan.reason = "the cable is too thin for the groove: its centre line would lie behind the axis";
    return capstan;
  }
  const double d7 = d6 + d4;                        // (4.25)
  const double theta3 = std::atan(d2 / (pi * d5));  // (4.19)
  const double k_g = d7 / d5;                       // (4.43)
  capstan.contact_diameter = d3_contact;
  capstan.helix_angle = theta1;
  capstan.groove_half_angle = theta2;
  capstan.input_pitch_diameter = d5;
  capstan.cable_angle = theta3;
  capstan.output_pitch_diameter = d7;
  capstan.ratio = k_g;
  capstan.min_centre_distance = 0.5 * (d5 + d7);
  capstan.wraps_touch = d4 > d2 * std::cos(theta3);
  if (2.0 * d8 < d5 + d7) {
    capstan.reason =
        "the pulleys overlap: the centre distance must be at least half the sum of the pitch diameters";
    return capstan;
  }

  // (4.24), without the cancellation of acos near one
  const double theta4 = std::atan2(std::sqrt((2.0 * d8 - d5 - d7) * (2.0 * d8 + d5 + d7)), d5 + d7);
  const double theta5 = 2.0 * pi * k_r - 2.0 * theta4;  // (4.26)
  capstan.tangent_angle = theta4;
  capstan.contact_angle = theta5;
  capstan.friction_exponent = mu * theta5 / std::sin(theta2);  // exponent of (4.28)

  capstan.length_on_input = theta5 * std::hypot(0.5 * d5, d2 / (2.0 * pi));         // d9 (4.45)
  capstan.length_on_output = theta6 * std::hypot(0.5 * d7, k_g * d2 / (2.0 * pi));  // d10 (4.46)
  capstan.length_between = 2.0 * d8 * std::sin(theta4) / std::cos(theta3);          // d11 (4.47)
  capstan.cable_length =
      capstan.length_on_input + capstan.length_on_output + capstan.length_between;  // d12 (4.48)
  capstan.input_width = (theta5 + k_g * (theta6 - 2.0 * theta4)) * d2 / (2.0 * pi) +
                        2.0 * std::sin(theta4) / pi * (d2 * d8 / d5);  // d13 (4.50)
  capstan.thread_width = (theta5 + k_g * theta6) * d2 / (2.0 * pi);    // d14 (4.51)

  if (d3_contact > d1) {
    capstan.status = CapstanStatus::not_seated;
    capstan.reason =
        "the cable rides on the thread's crests: its contact diameter exceeds the thread's major diameter";
    return capstan;
  }
  capstan.status = CapstanStatus::ok;
  return capstan;
}

double Capstan::tension_difference(double input_torque) const {
  assert(status != CapstanStatus::invalid_argument);
  return std::abs(input_torque) / (input_pitch_diameter * std::cos(cable_angle));  // (4.30)
}

double Capstan::min_preload(double input_torque) const {
  // (4.31), as a hyperbolic tangent: no overflow for many wraps, no cancellation for few
  return tension_difference(input_torque) / std::tanh(0.5 * friction_exponent);
}

CapstanLoads Capstan::loads(double preload, double input_torque) const {
  const double F_u = tension_difference(input_torque);
  CapstanLoads loads;
  loads.tension_difference = F_u;
  loads.preload = preload;
  loads.low_tension = preload - F_u;
  loads.high_tension = preload + F_u;
  loads.bearing_x = 2.0 * std::cos(cable_angle) * std::sin(tangent_angle) * preload;  // (4.39)
  loads.bearing_y = 2.0 * std::cos(cable_angle) * std::cos(tangent_angle) * F_u;      // (4.40)
  loads.bearing_axial = 2.0 * std::sin(cable_angle) * F_u;                            // (4.41)
  loads.bearing_radial = std::hypot(loads.bearing_x, loads.bearing_y);                // (4.42)
  return loads;
}

CapstanLoads Capstan::loads_at_min_preload(double input_torque) const {
  CapstanLoads result = loads(min_preload(input_torque), input_torque);
  // F_p - F_u without the cancellation of many wraps
  result.low_tension = 2.0 * result.tension_difference / std::expm1(friction_exponent);
  return result;
}

double Capstan::slip_torque(double preload) const {
  assert(status != CapstanStatus::invalid_argument);
  return preload * input_pitch_diameter * std::cos(cable_angle) * std::tanh(0.5 * friction_exponent) * ratio;
}

std::optional<double> Capstan::equivalent_cable_length(double angle) const {
  assert(status != CapstanStatus::invalid_argument);
  const double per_radian = std::hypot(0.5 * output_pitch_diameter, ratio * dimensions.lead / (2.0 * pi));
  const double L_a = 0.5 * cable_length + angle * per_radian;
  const double L_b = 0.5 * cable_length - angle * per_radian;
  if (!(L_a > 0.0) || !(L_b > 0.0)) {
    return std::nullopt;
  }
  return L_a * L_b / cable_length;
}

}  // namespace zwidth
