#pragma once

#include <array>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth::internal {

/// How an arm is brought to the form of srs_arm.h: theta_i = sign_i q_i + offset_i between frames of its own.
struct SrsPattern {
  SrsLengths lengths;
  Pose base;                   ///< frame of the shoulder, in the base frame of the arm
  Pose tool;                   ///< frame of the tool, in that of the wrist
  bool theta3_locked = false;  ///< six joints; theta3 is then always offset[2]
  std::array<int, 7> joint{};  ///< index among the arm's joints, -1 for a locked one
  std::array<double, 7> sign{};
  std::array<double, 7> offset{};  ///< [rad]

  Pose wrist_of(const Pose& tool_pose) const noexcept;
  /// Joint values of canonical angles, and back. The size of `joints` is the arm's.
  template <class Joints>
  void joints_of(const SrsAngles& theta, Joints& joints) const noexcept {
    for (int i = 0; i < 7; ++i) {
      if (joint[i] >= 0) joints[joint[i]] = sign[i] * (theta[i] - offset[i]);
    }
  }
  template <class Joints>
  SrsAngles angles_of(const Joints& joints) const noexcept {
    SrsAngles theta;
    for (int i = 0; i < 7; ++i) {
      theta[i] = joint[i] >= 0 ? sign[i] * joints[joint[i]] + offset[i] : offset[i];
    }
    return theta;
  }
};

/// Whether one leg is such an arm, however its frames and zeros lie: seven revolute joints of which 1, 2, 3
/// meet in the shoulder, 3, 4, 5 in the elbow and 5, 6, 7 in the wrist, each at right angles to the next; or
/// six, without the third, whose elbow moves in a plane through axis 1. Lengths count as equal within 1e-9 of
/// the arm's size.
std::optional<SrsPattern> srs_pattern(const LegDescription& leg);

}  // namespace zwidth::internal
