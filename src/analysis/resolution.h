#pragma once

#include "zwidth/mechanism/jacobian.h"

/// What the resolution of the joints means at the tool.

namespace zwidth {

/// Tool step along each axis per joint: |J_kj| step_j (tool rows x active) [m, rad].
Jacobian tool_steps(const Jacobian& jacobian, const ActiveVector& joint_step);

/// Tool step along each axis when all joints move by their resolution, at worst: sum_j |J_kj| step_j [m, rad].
ToolVector tool_resolution(const Jacobian& jacobian, const ActiveVector& joint_step);

/// Force step along each axis when all torques change by their resolution, at worst: sum_j |J^-T_kj| step_j [N,
/// N m]. REQUIRES: square J. Infinite at a singularity.
ToolVector force_resolution(const Jacobian& jacobian, const ActiveVector& torque_step);

}  // namespace zwidth
