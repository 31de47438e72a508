#pragma once

#include <optional>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/analysis/force.h"

/// What the joints can give, whatever drives them. The limits of a cylinder follow the joint's angle and differ
/// with the direction, so they are asked for posture by posture.

namespace zwidth {

/// One pneumatic drive per active joint, in order, where the description gives one. Throws InvalidDrive.
std::vector<std::optional<PneumaticDrive>> joint_pneumatic_drives(const Description& description,
                                                                  const Mechanism& mechanism);

/// Torques that the drives can give with the active joints at `joints` [N m, N]; `peak` takes the short-time
/// torque of motors. Joints without a drive, such as free ones, hold nothing. REQUIRES: one entry per active
/// joint each.
TorqueRange torque_range(const std::vector<std::optional<Drive>>& drives,
                         const std::vector<std::optional<PneumaticDrive>>& pneumatic_drives,
                         const ActiveVector& joints, bool peak);

/// Of each joint the weaker direction: what it can give either way [N m, N].
ActiveVector either_way(const TorqueRange& range);

}  // namespace zwidth
