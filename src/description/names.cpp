#include "zwidth/description/names.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace zwidth {
namespace {

struct NamedJoint {
  std::string leg;
  std::string joint;
  bool active = false;
};

std::vector<NamedJoint> joints_of(const MechanismDescription& mechanism) {
  std::vector<NamedJoint> joints;
  if (const auto* legs = std::get_if<LegsDescription>(&mechanism)) {
    for (const LegDescription& leg : legs->legs) {
      for (const JointDescription& joint : leg.joints) joints.push_back({leg.name, joint.name, joint.active});
    }
    return joints;
  }
  for (const char* number : {"1", "2", "3"}) {
    for (const char* joint : {"theta", "elbow", "swing"}) {
      joints.push_back(
          {std::string("leg") + number, std::string(joint) + number, joint == std::string("theta")});
    }
  }
  return joints;
}

}  // namespace

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

std::vector<std::string> link_names(const MechanismDescription& mechanism) {
  std::vector<std::string> names{"platform"};
  if (std::holds_alternative<DeltaDescription>(mechanism)) names.insert(names.end(), {"upper_arm", "forearm"});
  for (const NamedJoint& joint : joints_of(mechanism)) names.push_back(joint.leg + "/" + joint.joint);
  return names;
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
  std::vector<int> indices;
  if (drive.joints.empty()) {
    indices.resize(active_joint_names(mechanism).size());
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
  }
  for (const std::string& name : drive.joints) indices.push_back(active_joint_index(mechanism, name));
  return indices;
}

}  // namespace zwidth
