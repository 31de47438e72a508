#include "zwidth/mechanism/internal/closure_equations.h"

#include <algorithm>
#include <numeric>

#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth::internal {

Eigen::MatrixXd closure_equations(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  const int joints = mechanism.joint_count();
  int count = 0;
  for (const LegModel& leg : mechanism.legs()) count += closure_rows(leg);
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(count, joints + 6);
  int row = 0;
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    const int rows = closure_rows(leg);
    std::array<double, 6> column;
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      closure_column(posture, l, j, column);
      for (int i = 0; i < rows; ++i) equations(row + i, j) = column[i];
    }
    const Vector3 arm = posture.tool().rotation * leg.platform_point;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 turn = Vector3::Unit(axis).cross(arm) / mechanism.characteristic_length();
      equations(row + axis, joints + axis) = -1.0;
      equations.block<3, 1>(row, joints + 3 + axis) = -turn;
      if (rows == 6) equations(row + 3 + axis, joints + 3 + axis) = -1.0;
    }
    row += rows;
  }
  return equations;
}

bool held_rigidly(const Mechanism& mechanism) {
  return std::all_of(mechanism.legs().begin(), mechanism.legs().end(),
                     [](const LegModel& leg) { return leg.attachment == Attachment::rigid; });
}

Unknowns unknowns_of(const Mechanism& mechanism) {
  Unknowns unknowns;
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    unknowns.joints.push_back(j);
    (mechanism.joints()[j].active < 0 ? unknowns.passive : unknowns.active).push_back(j);
  }
  for (const int axis : mechanism.tool_axes()) unknowns.declared.push_back(mechanism.joint_count() + axis);
  unknowns.platform = unknowns.declared;
  if (held_rigidly(mechanism)) {
    unknowns.platform.resize(6);
    std::iota(unknowns.platform.begin(), unknowns.platform.end(), mechanism.joint_count());
  }
  return unknowns;
}

}  // namespace zwidth::internal
