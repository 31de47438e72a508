#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/units.h"

/// The names that a mechanism gives to its joints and links, for drives and bodies to refer to.
///
/// Those of the closed-form families stand at their structs in description.h; a delta has legs leg1, leg2, leg3
/// with joints theta1 (driven), elbow1, swing1, and so on.

namespace zwidth {

/// "delta", "five-bar", "r-cube", "serial" or "legs": the family as files call it.
std::string family_name(const MechanismDescription& mechanism);

/// Names of the active joints, leg after leg, from the base outwards: "JOINT" where no other joint of the
/// mechanism has that name, else "LEG/JOINT".
std::vector<std::string> active_joint_names(const MechanismDescription& mechanism);

/// What the active joints are measured in, in the order of their names: Dimension::angle or length.
std::vector<Dimension> active_joint_dimensions(const MechanismDescription& mechanism);

/// Ranges of the active joints, in the order of their names [rad] or [m].
std::vector<Interval> active_joint_ranges(const MechanismDescription& mechanism);

/// "translation", "rigid", ...: every platform freedom as files call it.
const std::vector<std::pair<std::string, PlatformFreedom>>& platform_freedom_names();

/// "one", "two", "two_mod", "three": every layout of a cylinder on an arm as files call it.
const std::vector<std::pair<std::string, ArmCylinderLayout>>& arm_cylinder_layout_names();
std::string to_string(ArmCylinderLayout layout);

/// "base", "tool", "published"; "continuous", "peak": as files call them.
const std::vector<std::pair<std::string, MomentFrame>>& moment_frame_names();
const std::vector<std::pair<std::string, LoadKind>>& load_kind_names();
/// "lamination", "mean": every rule for laminates as files call it.
const std::vector<std::pair<std::string, LaminateRule>>& laminate_rule_names();
std::string to_string(LaminateRule rule);
std::string to_string(MomentFrame frame);
std::string to_string(LoadKind kind);

/// Every name that `BodyDescription::on` may have.
std::vector<std::string> link_names(const MechanismDescription& mechanism);

/// Every name that `BodyDescription::turns_with` may have: single links that joints move.
std::vector<std::string> joint_link_names(const MechanismDescription& mechanism);

/// Index in `active_joint_names` of the joint called "JOINT" (if unique) or "LEG/JOINT"; -1 if there is none.
int active_joint_index(const MechanismDescription& mechanism, const std::string& name);

/// Whether an active joint is moved by the hand alone.
bool is_free_joint(const MechanismDescription& mechanism, int active);

/// A transmission's type as device files write it: "direct", "capstan", "ratio" or "gearhead".
std::string_view transmission_type(const TransmissionDescription& transmission);

/// Whether an active joint slides.
bool is_sliding_joint(const MechanismDescription& mechanism, int active);

/// Indices in `active_joint_names` of the joints that a drive moves: all but the free ones if it names none.
/// REQUIRES: the drive names active joints only, as `validate` sees to.
std::vector<int> driven_joints(const MechanismDescription& mechanism, const DriveDescription& drive);
std::vector<int> driven_joints(const MechanismDescription& mechanism, const PneumaticDriveDescription& drive);

}  // namespace zwidth
