#pragma once

#include <numbers>
#include <utility>
#include <vector>

#include "support/arms.h"

#include "zwidth/mechanism/mechanism.h"

/// Serial arms for tests.

namespace zwidth::test {

/// A revolute row of a Denavit-Hartenberg table, its range in degrees and its home in the middle of it.
inline SerialJointDescription turning(const char* name, double d, double a, double alpha_degrees,
                                      const Interval& degrees) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  return {.name = name,
          .d = d,
          .a = a,
          .alpha = alpha_degrees * kDegree,
          .range = {degrees.min * kDegree, degrees.max * kDegree},
          .home = degrees.middle() * kDegree};
}

inline Description arm_description(std::vector<SerialJointDescription> joints) {
  Description description;
  description.name = "arm";
  description.mechanism = SerialDescription{.joints = std::move(joints)};
  return description;
}

/// Slides along z, then turns twice about it: the first positioning stage of Akhoondi Asadi 2017 without its
/// offset.
inline Description cylindrical_arm(double upper, double fore) {
  return arm_description(
      {{.name = "lift", .type = SerialJointType::prismatic, .range = {0.0, 0.1}, .home = 0.05},
       turning("shoulder", 0.0, upper, 0.0, {-60.0, 60.0}),
       turning("elbow", 0.0, fore, 0.0, {-60.0, 60.0})});
}

/// The 7-DOF arm of Baser 2006 with other link lengths.
inline Description seven_joint_arm(double upper, double fore) {
  return arm_description(seven_dof(upper, fore).joints);
}

}  // namespace zwidth::test
