#include "zwidth/mechanism/internal/srs_pattern.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace zwidth::internal {
namespace {

constexpr double kSame = 1e-9;  // of the arm's size, and of cosines

struct Line {
  Vector3 point;
  Vector3 direction;  // unit
};

bool perpendicular(const Vector3& a, const Vector3& b) {
  return std::abs(a.dot(b)) < kSame;
}

// Where two lines at right angles meet.
std::optional<Vector3> crossing(const Line& one, const Line& other, double scale) {
  if (!perpendicular(one.direction, other.direction)) return std::nullopt;
  const Vector3 apart = other.point - one.point;
  if (std::abs(apart.dot(one.direction.cross(other.direction))) > kSame * scale) return std::nullopt;
  return one.point + one.direction * apart.dot(one.direction);
}

bool passes(const Line& line, const Vector3& point, double scale) {
  return (point - line.point).cross(line.direction).norm() < kSame * scale;
}

Matrix3 about_y(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitY()).toRotationMatrix();
}
Matrix3 about_z(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
}

}  // namespace

Pose SrsPattern::wrist_of(const Pose& tool_pose) const noexcept {
  Pose wrist;
  const Matrix3 in_base = tool_pose.rotation * tool.rotation.transpose();
  wrist.rotation = base.rotation.transpose() * in_base;
  wrist.position = base.rotation.transpose() * (tool_pose.position - in_base * tool.position - base.position);
  return wrist;
}

std::optional<SrsPattern> srs_pattern(const LegDescription& leg) {
  const std::size_t count = leg.joints.size();
  if ((count != 6 && count != 7) || leg.attachment != Attachment::rigid) return std::nullopt;
  const bool locked = count == 6;
  std::vector<Line> axes;  // 1, 2, 3 (if it moves), 4, 5, 6, 7
  double scale = 0.0;
  for (const JointDescription& joint : leg.joints) {
    if (joint.type != JointType::revolute || !joint.active) return std::nullopt;
    axes.push_back({joint.point, joint.axis.normalized()});
    scale = std::max(scale, (joint.point - leg.joints.front().point).norm());
  }
  if (scale == 0.0) return std::nullopt;
  const Line& axis1 = axes[0];
  const Line& axis2 = axes[1];
  const Line* axis = axes.data() + (locked ? -1 : 0);  // axis[3] is axis 4, axis[6] axis 7

  const auto shoulder = crossing(axis1, axis2, scale), elbow = crossing(axis[3], axis[4], scale),
             wrist = crossing(axis[4], axis[5], scale);
  if (!shoulder || !elbow || !wrist) return std::nullopt;
  const Vector3 upper = *elbow - *shoulder, fore = *wrist - *elbow;
  SrsPattern pattern;
  pattern.lengths = {upper.norm(), fore.norm()};
  if (std::min(pattern.lengths.upper_arm, pattern.lengths.forearm) < kSame * scale) return std::nullopt;
  const Vector3 u3 = upper.normalized(), u5 = fore.normalized();
  if (!perpendicular(u3, axis2.direction) || !perpendicular(u3, axis[3].direction)) return std::nullopt;
  if (!perpendicular(axis[5].direction, axis[6].direction) || !passes(axis[6], *wrist, scale))
    return std::nullopt;
  if (!locked && (!passes(axes[2], *shoulder, scale) || !passes(axes[2], *elbow, scale))) return std::nullopt;

  pattern.theta3_locked = locked;
  pattern.sign.fill(1.0);
  for (int i = 0; i < 7; ++i) pattern.joint[i] = locked ? (i < 2 ? i : i == 2 ? -1 : i - 1) : i;
  if (!locked) pattern.sign[2] = axes[2].direction.dot(u3) > 0.0 ? 1.0 : -1.0;
  pattern.sign[4] = axis[4].direction.dot(u5) > 0.0 ? 1.0 : -1.0;

  // The canonical frame from joint to joint at the leg's zero posture: each offset turns it so that its y, or
  // z, falls on the next axis.
  Matrix3 R;
  R.col(2) = axis1.direction;
  R.col(1) = axis2.direction;
  R.col(0) = R.col(1).cross(R.col(2));
  pattern.base = {.position = *shoulder, .rotation = R};
  const auto bring_z = [&](int i, const Vector3& to) {
    pattern.offset[i] = std::atan2(to.dot(R.col(0)), to.dot(R.col(2)));
    R = R * about_y(pattern.offset[i]);
  };
  const auto bring_y = [&](int i, const Vector3& to) {
    pattern.offset[i] = std::atan2(-to.dot(R.col(0)), to.dot(R.col(1)));
    R = R * about_z(pattern.offset[i]);
  };
  pattern.offset[0] = 0.0;
  bring_z(1, u3);
  bring_y(2, axis[3].direction);
  bring_z(3, u5);
  bring_y(4, axis[5].direction);
  bring_z(5, axis[6].direction);
  pattern.offset[6] = 0.0;

  // The tool's frame at the zero posture: where the tip is, less the arm of the attachment.
  const Matrix3 tool_rotation = leg.platform_rotation;
  const Vector3 tool_position = leg.tip - tool_rotation * leg.platform_point;
  pattern.tool = {.position = R.transpose() * (tool_position - *wrist),
                  .rotation = R.transpose() * tool_rotation};
  return pattern;
}

}  // namespace zwidth::internal
