#pragma once

#include <numbers>
#include <random>
#include <string>

#include "zwidth/description/description.h"

namespace zwidth::test {

inline double arm_uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// The 7-DOF arm of Baser 2006 with the mechanical limits; theta3 moves, or is fixed at an angle [rad].
inline SerialDescription seven_dof(double upper_arm = 0.25, double forearm = 0.25) {
  constexpr double kDegree = std::numbers::pi / 180.0, kQuarter = 0.5 * std::numbers::pi;
  const double alpha[7] = {-kQuarter, kQuarter, -kQuarter, kQuarter, -kQuarter, kQuarter, 0.0};
  const double d[7] = {0.0, 0.0, upper_arm, 0.0, forearm, 0.0, 0.0};
  const Interval range[7] = {{-90.0, 90.0}, {30.0, 120.0}, {-60.0, 60.0}, {45.0, 135.0},
                             {0.0, 360.0},  {0.0, 360.0},  {0.0, 360.0}};
  const double home[7] = {0.0, 75.0, 0.0, 90.0, 90.0, 90.0, 90.0};
  SerialDescription arm;
  for (int i = 0; i < 7; ++i) {
    arm.joints.push_back({.name = "theta" + std::to_string(i + 1),
                          .type = SerialJointType::revolute,
                          .theta = 0.0,
                          .d = d[i],
                          .a = 0.0,
                          .alpha = alpha[i],
                          .range = {range[i].min * kDegree, range[i].max * kDegree},
                          .home = home[i] * kDegree});
  }
  return arm;
}
inline SerialDescription seven_dof_locked(double theta3 = 0.0) {
  SerialDescription arm = seven_dof();
  arm.joints[2].type = SerialJointType::fixed;
  arm.joints[2].theta = theta3;
  return arm;
}

/// Any rows: `moving` of them revolute, or prismatic one in four, and fixed ones among them.
inline SerialDescription random_arm(std::mt19937_64& random, int moving, bool prismatic = true) {
  constexpr double kPi = std::numbers::pi;
  SerialDescription arm;
  int moved = 0;
  while (moved < moving || arm_uniform(random, 0.0, 1.0) < 0.2) {
    SerialJointDescription row;
    row.name = "row" + std::to_string(arm.joints.size());
    const bool fixed = moved == moving || arm_uniform(random, 0.0, 1.0) < 0.15;
    const bool slides = prismatic && arm_uniform(random, 0.0, 1.0) < 0.25;
    row.type = fixed ? SerialJointType::fixed : slides ? SerialJointType::prismatic : SerialJointType::revolute;
    row.theta = arm_uniform(random, -kPi, kPi);
    row.d = arm_uniform(random, 0.0, 1.0) < 0.4 ? 0.0 : arm_uniform(random, -0.3, 0.3);
    row.a = arm_uniform(random, 0.0, 1.0) < 0.4 ? 0.0 : arm_uniform(random, -0.3, 0.3);
    const double quarters[4] = {0.0, 0.5 * kPi, -0.5 * kPi, arm_uniform(random, -kPi, kPi)};
    row.alpha = quarters[static_cast<int>(arm_uniform(random, 0.0, 4.0)) % 4];
    row.range = slides ? Interval{-0.2, 0.3} : Interval{-2.5, 2.8};
    row.home = 0.1;
    if (!fixed) ++moved;
    arm.joints.push_back(row);
  }
  return arm;
}

}  // namespace zwidth::test
