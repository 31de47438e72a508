#include "zwidth/analysis/joint_torque.h"

#include "zwidth/description/names.h"

namespace zwidth {

std::vector<std::optional<PneumaticDrive>> joint_pneumatic_drives(const Description& description,
                                                                  const Mechanism& mechanism) {
  std::vector<std::optional<PneumaticDrive>> drives(static_cast<std::size_t>(mechanism.active_count()));
  for (const PneumaticDriveDescription& drive : description.pneumatic_drives) {
    for (const int joint : driven_joints(description.mechanism, drive)) {
      drives[static_cast<std::size_t>(joint)].emplace(drive, mechanism.active_range(joint));
    }
  }
  return drives;
}

TorqueRange torque_range(const std::vector<std::optional<Drive>>& drives,
                         const std::vector<std::optional<PneumaticDrive>>& pneumatic_drives,
                         const ActiveVector& joints, bool peak) {
  TorqueRange range{ActiveVector::Zero(joints.size()), ActiveVector::Zero(joints.size())};
  for (Eigen::Index i = 0; i < joints.size(); ++i) {
    const auto j = static_cast<std::size_t>(i);
    if (drives[j]) {
      range.max[i] = (peak ? drives[j]->peak_torque() : drives[j]->continuous_torque()).usable;
      range.min[i] = -range.max[i];
    } else if (pneumatic_drives[j]) {
      const Interval torque = pneumatic_drives[j]->torque_range(joints[i]);
      range.min[i] = torque.min;
      range.max[i] = torque.max;
    }
  }
  return range;
}

ActiveVector either_way(const TorqueRange& range) {
  return range.max.cwiseMin(-range.min).cwiseMax(0.0);
}

}  // namespace zwidth
