#include "zwidth/description/names.h"

#include <algorithm>
#include <array>
#include <map>

namespace zwidth {
namespace {

struct NamedJoint {
  std::string leg;
  std::string joint;
  bool active = false;
  Interval range = {};  // of an active joint
  bool free = false;
  bool slides = false;
};

// Three equal legs whose first joint is the driven one.
std::vector<NamedJoint> three_legs(const std::vector<std::string>& joints, const Interval& range) {
  std::vector<NamedJoint> all;
  for (const char* number : {"1", "2", "3"}) {
    for (const std::string& joint : joints) {
      all.push_back({std::string("leg") + number, joint + number, joint == joints.front(), range});
    }
  }
  return all;
}

std::vector<NamedJoint> joints_of(const DeltaDescription& delta) {
  return three_legs({"theta", "elbow", "swing"}, delta.joint_range);
}

std::vector<NamedJoint> joints_of(const FiveBarDescription& five_bar) {
  return {{"left", "theta1", true, five_bar.left_range},
          {"left", "elbow1"},
          {"right", "theta2", true, five_bar.right_range},
          {"right", "elbow2"}};
}

std::vector<NamedJoint> joints_of(const RCubeDescription& r_cube) {
  return three_legs({"theta", "tilt", "swing", "elbow", "wrist"}, r_cube.joint_range);
}

std::vector<NamedJoint> joints_of(const SerialDescription& arm) {
  std::vector<NamedJoint> joints;
  for (const SerialJointDescription& joint : arm.joints) {
    if (joint.type != SerialJointType::fixed)
      joints.push_back(
          {"arm", joint.name, true, joint.range, joint.free, joint.type == SerialJointType::prismatic});
  }
  return joints;
}

std::vector<NamedJoint> joints_of(const LegsDescription& legs) {
  std::vector<NamedJoint> joints;
  for (const LegDescription& leg : legs.legs) {
    for (const JointDescription& joint : leg.joints) {
      joints.push_back(
          {leg.name, joint.name, joint.active, joint.range, joint.free, joint.type == JointType::prismatic});
    }
  }
  return joints;
}

std::vector<NamedJoint> joints_of(const MechanismDescription& mechanism) {
  return std::visit([](const auto& family) { return joints_of(family); }, mechanism);
}

const NamedJoint* active_joint(const std::vector<NamedJoint>& joints, int active) {
  int index = 0;
  for (const NamedJoint& joint : joints) {
    if (joint.active && index++ == active) return &joint;
  }
  return nullptr;
}

// Indices of the named joints; without names, of all that are not free.
std::vector<int> joint_indices(const MechanismDescription& mechanism, const std::vector<std::string>& names) {
  std::vector<int> indices;
  if (names.empty()) {
    int index = 0;
    for (const NamedJoint& joint : joints_of(mechanism)) {
      if (joint.active && !joint.free) indices.push_back(index);
      if (joint.active) ++index;
    }
    return indices;
  }
  for (const std::string& name : names) indices.push_back(active_joint_index(mechanism, name));
  return indices;
}

}  // namespace

std::string family_name(const MechanismDescription& mechanism) {
  constexpr std::array<const char*, 5> names = {"delta", "five-bar", "r-cube", "serial", "legs"};
  static_assert(std::variant_size_v<MechanismDescription> == names.size());
  return names[mechanism.index()];
}

std::vector<std::string> active_joint_names(const MechanismDescription& mechanism) {
  const std::vector<NamedJoint> joints = joints_of(mechanism);
  std::map<std::string, int> uses;
  for (const NamedJoint& joint : joints) ++uses[joint.joint];
  std::vector<std::string> names;
  for (const NamedJoint& joint : joints) {
    if (joint.active) names.push_back(uses[joint.joint] == 1 ? joint.joint : joint.leg + "/" + joint.joint);
  }
  return names;
}

std::vector<Dimension> active_joint_dimensions(const MechanismDescription& mechanism) {
  std::vector<Dimension> dimensions;
  for (const NamedJoint& joint : joints_of(mechanism)) {
    if (joint.active) dimensions.push_back(joint.slides ? Dimension::length : Dimension::angle);
  }
  return dimensions;
}

std::vector<Interval> active_joint_ranges(const MechanismDescription& mechanism) {
  std::vector<Interval> ranges;
  for (const NamedJoint& joint : joints_of(mechanism)) {
    if (joint.active) ranges.push_back(joint.range);
  }
  return ranges;
}

const std::vector<std::pair<std::string, PlatformFreedom>>& platform_freedom_names() {
  static const std::vector<std::pair<std::string, PlatformFreedom>> names = {
      {"translation", PlatformFreedom::translation},
      {"rigid", PlatformFreedom::rigid},
      {"planar-translation", PlatformFreedom::planar_translation},
      {"planar", PlatformFreedom::planar},
      {"rotation", PlatformFreedom::rotation},
      {"point", PlatformFreedom::point}};
  return names;
}

const std::vector<std::pair<std::string, ArmCylinderLayout>>& arm_cylinder_layout_names() {
  static const std::vector<std::pair<std::string, ArmCylinderLayout>> names = {
      {"one", ArmCylinderLayout::one},
      {"two", ArmCylinderLayout::two},
      {"two_mod", ArmCylinderLayout::two_mod},
      {"three", ArmCylinderLayout::three}};
  return names;
}

std::string to_string(ArmCylinderLayout layout) {
  for (const auto& [name, value] : arm_cylinder_layout_names()) {
    if (value == layout) return name;
  }
  return {};
}

const std::vector<std::pair<std::string, MomentFrame>>& moment_frame_names() {
  static const std::vector<std::pair<std::string, MomentFrame>> names = {
      {"base", MomentFrame::base}, {"tool", MomentFrame::tool}, {"published", MomentFrame::published}};
  return names;
}

const std::vector<std::pair<std::string, LoadKind>>& load_kind_names() {
  static const std::vector<std::pair<std::string, LoadKind>> names = {{"continuous", LoadKind::continuous},
                                                                      {"peak", LoadKind::peak}};
  return names;
}

const std::vector<std::pair<std::string, LaminateRule>>& laminate_rule_names() {
  static const std::vector<std::pair<std::string, LaminateRule>> names = {
      {"lamination", LaminateRule::lamination}, {"mean", LaminateRule::mean}};
  return names;
}

std::string to_string(LaminateRule rule) {
  return laminate_rule_names()[static_cast<std::size_t>(rule)].first;
}

std::string to_string(MomentFrame frame) {
  return moment_frame_names()[static_cast<std::size_t>(frame)].first;
}

std::string to_string(LoadKind kind) {
  return load_kind_names()[static_cast<std::size_t>(kind)].first;
}

std::vector<std::string> link_names(const MechanismDescription& mechanism) {
  std::vector<std::string> names{"platform"};
  if (std::holds_alternative<DeltaDescription>(mechanism)) names.insert(names.end(), {"upper_arm", "forearm"});
  if (std::holds_alternative<RCubeDescription>(mechanism)) {
    names.insert(names.end(), {"drive_link", "inner_link", "outer_link"});
  }
  for (const NamedJoint& joint : joints_of(mechanism)) names.push_back(joint.leg + "/" + joint.joint);
  return names;
}

std::vector<std::string> joint_link_names(const MechanismDescription& mechanism) {
  std::vector<std::string> names;
  for (const NamedJoint& joint : joints_of(mechanism)) names.push_back(joint.leg + "/" + joint.joint);
  return names;
}

bool is_free_joint(const MechanismDescription& mechanism, int active) {
  const std::vector<NamedJoint> joints = joints_of(mechanism);
  const NamedJoint* joint = active_joint(joints, active);
  return joint != nullptr && joint->free;
}

bool is_sliding_joint(const MechanismDescription& mechanism, int active) {
  const std::vector<NamedJoint> joints = joints_of(mechanism);
  const NamedJoint* joint = active_joint(joints, active);
  return joint != nullptr && joint->slides;
}

int active_joint_index(const MechanismDescription& mechanism, const std::string& name) {
  const std::vector<std::string> names = active_joint_names(mechanism);
  int index = 0;
  for (const NamedJoint& joint : joints_of(mechanism)) {
    if (!joint.active) continue;
    if (name == names[index] || name == joint.leg + "/" + joint.joint) return index;
    ++index;
  }
  return -1;
}

std::vector<int> driven_joints(const MechanismDescription& mechanism, const DriveDescription& drive) {
  return joint_indices(mechanism, drive.joints);
}

std::vector<int> driven_joints(const MechanismDescription& mechanism, const PneumaticDriveDescription& drive) {
  return joint_indices(mechanism, drive.joints);
}

std::string_view transmission_type(const TransmissionDescription& transmission) {
  struct Type {
    std::string_view operator()(const DirectDriveDescription&) const { return "direct"; }
    std::string_view operator()(const CapstanDescription&) const { return "capstan"; }
    std::string_view operator()(const RatioDescription&) const { return "ratio"; }
    std::string_view operator()(const GearheadDescription&) const { return "gearhead"; }
  };
  return std::visit(Type{}, transmission);
}

}  // namespace zwidth
