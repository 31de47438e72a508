#pragma once

#include <numbers>
#include <vector>

#include "support/arms.h"

namespace zwidth::test {

inline constexpr double kDegreeOfArc = std::numbers::pi / 180.0;

inline Description arm_description(double upper_arm = 0.25, double forearm = 0.25) {
  Description description;
  description.name = "arm";
  description.mechanism = seven_dof(upper_arm, forearm);
  return description;
}

/// Moving masses of the positioning stage of the 7-DOF arm (Baser 2006, section 5.2), distances from the
/// support centre.
struct PositioningStage {
  double m1 = 0.210, m3 = 0.160, m4 = 0.170, mL = 0.120, mc = 0.570;
  double l1 = 0.250, l2 = -0.045, l3 = 0.130, l4 = 0.190;
  double d1 = 0.250, d2 = 0.100, d3 = 0.065, d4 = 0.045;

  double A() const { return m1 * l2 + m3 * (l1 - l4) + m4 * l1 + mL * l1 - mc * l3; }  // eq 5.24
  double B() const { return -m3 * d2 + m4 * d3 + mL * d1 - mc * d4; }                  // eq 5.25
  double mass() const { return m1 + m3 + m4 + mL + mc; }
};

/// The bodies of such a stage. The bars of the parallelogram and the counterweight hang on the upper link and
/// turn with the forearm.
inline std::vector<BodyDescription> stage_bodies(const PositioningStage& s) {
  const auto fixed = [](const char* on, double mass, double height) {
    BodyDescription body;
    body.on = on;
    body.mass = mass;
    body.centre = {0.0, 0.0, height};
    return body;
  };
  const auto hung = [&](double mass, double along_upper, double along_fore) {
    BodyDescription body = fixed("arm/theta3", mass, along_upper + along_fore);
    body.turns_with = "arm/theta4";
    body.pivot = {0.0, 0.0, along_upper};
    return body;
  };
  return {fixed("arm/theta3", s.m1, s.l2), hung(s.m3, s.l1 - s.l4, -s.d2),
          fixed("arm/theta4", s.m4, s.l1 + s.d3), fixed("arm/theta4", s.mL, s.l1 + s.d1),
          hung(s.mc, -s.l3, -s.d4)};
}

inline Description balanced_arm(const PositioningStage& stage) {
  Description description = arm_description(stage.l1, stage.d1);
  description.bodies = stage_bodies(stage);
  return description;
}

}  // namespace zwidth::test
