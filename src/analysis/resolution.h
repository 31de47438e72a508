#pragma once

#include <vector>

#include "zwidth/mechanism/jacobian.h"

/// What the resolution of the joints means at the tool.

namespace zwidth {

/// Tool step along each axis per joint: |J_kj| step_j (tool rows x active) [m, rad].
Jacobian tool_steps(const Jacobian& jacobian, const ActiveVector& joint_step);

/// Tool step along each axis when all joints move by their resolution, at worst: sum_j |J_kj| step_j [m, rad].
ToolVector tool_resolution(const Jacobian& jacobian, const ActiveVector& joint_step);

/// How far the tool goes and turns.
struct ToolStep {
  double distance = 0.0;  ///< [m]; 0 for a tool that only turns
  double angle = 0.0;     ///< [rad]; 0 for a tool that does not turn
};

/// The tool's step when one active joint moves by `step` [rad] or [m] from a posture, the others held: exactly,
/// from where the tool then is (Baser 2006, section 5.4). Zero where the loops do not close there.
ToolStep tool_step(const Posture& posture, int joint, double step);

/// What the resolution of the joints means in a posture, to first order.
struct PostureResolution {
  std::vector<ToolStep> joints;  ///< each joint alone by its step
  ToolStep worst;                ///< the largest of those, distance and angle by themselves
  ToolStep together;             ///< all joints by their steps, with the signs that add up to the most
};
/// REQUIRES: joint_step.size() == active count.
PostureResolution posture_resolution(const Posture& posture, const ActiveVector& joint_step);

/// Force step along each axis when all torques change by their resolution, at worst: sum_j |J^-T_kj| step_j [N,
/// N m]. REQUIRES: square J. Infinite at a singularity.
ToolVector force_resolution(const Jacobian& jacobian, const ActiveVector& torque_step);

}  // namespace zwidth
