#pragma once

#include <string>
#include <vector>

#include "zwidth/description/description.h"

/// The names that a mechanism gives to its joints and links, for drives and bodies to refer to.
///
/// A delta has legs leg1, leg2, leg3 with joints theta1 (driven), elbow1, swing1, and so on.

namespace zwidth {

/// Names of the active joints, leg after leg, from the base outwards: "JOINT" where no other joint of the
/// mechanism has that name, else "LEG/JOINT".
std::vector<std::string> active_joint_names(const MechanismDescription& mechanism);

/// Every name that `BodyDescription::on` may have.
std::vector<std::string> link_names(const MechanismDescription& mechanism);

/// Index in `active_joint_names` of the joint called "JOINT" (if unique) or "LEG/JOINT"; -1 if there is none.
int active_joint_index(const MechanismDescription& mechanism, const std::string& name);

/// Indices in `active_joint_names` of the joints that a drive moves: all of them if it names none.
/// REQUIRES: the drive names active joints only, as `validate` sees to.
std::vector<int> driven_joints(const MechanismDescription& mechanism, const DriveDescription& drive);

}  // namespace zwidth
