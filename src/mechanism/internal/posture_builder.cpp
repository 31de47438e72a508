#include "zwidth/mechanism/internal/posture_builder.h"

#include <cmath>
#include <numbers>

#include "zwidth/math/trigonometry.h"

namespace zwidth::internal {
namespace {

// R times the rotation by `angle` about the unit vector `axis` (Rodrigues), written out by columns.
Matrix3 turned(const Matrix3& R, const Vector3& axis, double angle) {
  const auto [s, c] = sine_cosine(angle);
  const double v = 1.0 - c, x = axis.x(), y = axis.y(), z = axis.z();
  const double vx = v * x, vy = v * y, vz = v * z;
  const Vector3 r0 = R.col(0), r1 = R.col(1), r2 = R.col(2);
  Matrix3 result;
  result.col(0) = (c + vx * x) * r0 + (vx * y + s * z) * r1 + (vx * z - s * y) * r2;
  result.col(1) = (vx * y - s * z) * r0 + (c + vy * y) * r1 + (vy * z + s * x) * r2;
  result.col(2) = (vx * z + s * y) * r0 + (vy * z - s * x) * r1 + (c + vz * z) * r2;
  return result;
}

}  // namespace

void PostureBuilder::place_leg(Posture& posture, int l) noexcept {
  const Mechanism& mechanism = *posture.mechanism_;
  const LegModel& leg = mechanism.legs()[l];
  Matrix3 R = Matrix3::Identity();    // orientation that the next joint's axis sits in
  Matrix3 arm = Matrix3::Identity();  // orientation of the link that carries the next joint's point
  Vector3 p = Vector3::Zero();
  for (int j = leg.first; j < leg.first + leg.count; ++j) {
    const JointModel& joint = mechanism.joints()[j];
    const double q = posture.joints_[j];
    p += arm * joint.offset;
    posture.axes_[j] = R * joint.axis;
    switch (joint.type) {
      case JointType::revolute:
        R = turned(R, joint.axis, q);
        arm = R;
        break;
      case JointType::prismatic:
        p += posture.axes_[j] * q;
        arm = R;
        break;
      case JointType::parallelogram:
        arm = turned(R, joint.axis, q);
        break;
    }
    posture.points_[j] = p;
    posture.links_[j] = arm;
  }
  posture.tips_[l] = p + arm * leg.tip;
  posture.tip_rotations_[l] = R * leg.platform_rotation;
}

void PostureBuilder::place_legs(Posture& posture) noexcept {
  for (int l = 0; l < static_cast<int>(posture.mechanism_->legs().size()); ++l) place_leg(posture, l);
}

int closure_error(const Posture& posture, int l, std::array<double, 6>& error) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const Vector3 gap =
      posture.leg_tip(l) - posture.tool().position - posture.tool().rotation * leg.platform_point;
  for (int i = 0; i < 3; ++i) error[i] = gap[i];
  if (leg.attachment == Attachment::spherical) return 3;
  const Vector3 turn = rotation_vector(posture.leg_tip_rotation(l) * posture.tool().rotation.transpose());
  for (int i = 0; i < 3; ++i) error[3 + i] = turn[i] * mechanism.characteristic_length();
  return 6;
}

void closure_column(const Posture& posture, int l, int j, std::array<double, 6>& column) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const Vector3& axis = posture.joint_axis(j);
  Vector3 linear, angular = Vector3::Zero();
  switch (mechanism.joints()[j].type) {
    case JointType::revolute:
      linear = axis.cross(posture.leg_tip(l) - posture.joint_point(j));
      angular = axis;
      break;
    case JointType::prismatic:
      linear = axis;
      break;
    case JointType::parallelogram: {
      const bool last = j + 1 == leg.first + leg.count;
      linear = axis.cross(posture.link_rotation(j) * (last ? leg.tip : mechanism.joints()[j + 1].offset));
      break;
    }
  }
  for (int i = 0; i < 3; ++i) {
    column[i] = linear[i];
    column[3 + i] = angular[i] * mechanism.characteristic_length();
  }
}

void platform_columns(const Posture& posture, int l, std::array<std::array<double, 6>, 6>& columns) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const std::span<const int> axes = mechanism.tool_axes();
  for (std::size_t c = 0; c < axes.size(); ++c) {
    columns[c].fill(0.0);
    columns[c][axes[c]] = 1.0;
    if (axes[c] < 3) continue;
    const Vector3 arm = posture.tool().rotation * mechanism.legs()[l].platform_point;
    const Vector3 linear = Vector3::Unit(axes[c] - 3).cross(arm) / mechanism.characteristic_length();
    for (int i = 0; i < 3; ++i) columns[c][i] = linear[i];
  }
}

Vector3 rotation_vector(const Matrix3& R) noexcept {
  const Vector3 sine(0.5 * (R(2, 1) - R(1, 2)), 0.5 * (R(0, 2) - R(2, 0)), 0.5 * (R(1, 0) - R(0, 1)));
  const double s = sine.norm(), c = 0.5 * (R.trace() - 1.0);
  if (c > 0.0 && s < 1e-8) return sine;
  if (s > 1e-6) return sine * (std::atan2(s, c) / s);
  const Eigen::AngleAxisd half_turn(R);  // near pi the skew part says nothing of the axis
  return half_turn.axis() * half_turn.angle();
}

double wrapped(const JointModel& joint, double value) noexcept {
  if (joint.type == JointType::prismatic) return value;
  constexpr double turn = 2.0 * std::numbers::pi;
  double angle = std::remainder(value, turn);
  for (const double candidate : {angle, angle + turn, angle - turn}) {
    if (joint.range.contains(candidate, 1e-9)) return candidate;
  }
  return angle;
}

}  // namespace zwidth::internal
