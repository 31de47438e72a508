#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/families.h"

// A serial arm as a leg, whose axes and points are those of the Denavit-Hartenberg frames with all joints at
// zero, and such a leg as Denavit-Hartenberg rows.

namespace zwidth {

namespace {

// A turn about an axis of the frame, exact where it is a whole number of quarters: 90 deg leave no dust on the
// axes.
Matrix3 turn_about(double angle, const Vector3& axis) {
  constexpr double kQuarter = 0.5 * std::numbers::pi, kSame = 1e-15;
  const double quarters = std::round(angle / kQuarter);
  if (std::abs(angle - quarters * kQuarter) > kSame * std::max(1.0, std::abs(angle)))
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix().array().round().matrix();
}

}  // namespace

LegsDescription legs_of(const SerialDescription& arm) {
  LegDescription leg;
  leg.name = "arm";
  // Where the tool's orientation means nothing, the last row is held by its point alone.
  const bool by_point =
      arm.platform == PlatformFreedom::translation || arm.platform == PlatformFreedom::planar_translation;
  leg.attachment = by_point ? Attachment::spherical : Attachment::rigid;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (const SerialJointDescription& row : arm.joints) {
    if (row.type != SerialJointType::fixed) {
      leg.joints.push_back(
          {.name = row.name,
           .type = row.type == SerialJointType::prismatic ? JointType::prismatic : JointType::revolute,
           .active = true,
           .free = row.free,
           .axis = T.linear().col(2),
           .point = T.translation(),
           .range = row.range,
           .home = row.home});
    }
    T.rotate(turn_about(row.theta, Vector3::UnitZ()));
    T.translate(Vector3(row.a, 0.0, row.d));
    T.rotate(turn_about(row.alpha, Vector3::UnitX()));
  }
  leg.tip = T.translation();
  if (!by_point) leg.platform_rotation = T.linear();

  LegsDescription legs;
  legs.platform = arm.platform;
  legs.legs = {leg};
  return legs;
}

namespace {

constexpr double kParallel = 1e-12;  // sine of the angle between axes that count as parallel
constexpr double kSame = 1e-12;      // [m]

// The row that takes a frame to one whose z axis lies along a line.
SerialJointDescription row_to(Eigen::Isometry3d& frame, const Vector3& point, const Vector3& direction) {
  const Vector3 x = frame.linear().col(0), y = frame.linear().col(1), z = frame.linear().col(2);
  const Vector3 between = point - frame.translation(), across = z.cross(direction);
  SerialJointDescription row;
  Vector3 normal;  // common to both axes: x of the new frame
  if (across.norm() > kParallel) {
    // Feet of the common normal: d z + a normal + b direction = between.
    normal = across.normalized();
    row.a = between.dot(normal);
    row.d = between.dot(direction.cross(normal)) / z.dot(direction.cross(normal));
    if (std::abs(row.a) < kSame) row.a = 0.0;
    if (row.a < 0.0 || (row.a == 0.0 && normal.dot(x) < -kParallel)) {
      normal = -normal;
      row.a = -row.a;
    }
  } else {
    const Vector3 sideways = between - z * between.dot(z);
    row.a = sideways.norm();
    normal = row.a > kSame ? Vector3(sideways / row.a) : x;
    if (row.a <= kSame) row.a = 0.0;
  }
  if (std::abs(row.d) < kSame) row.d = 0.0;
  row.theta = std::atan2(normal.dot(y), normal.dot(x));
  row.alpha = std::atan2(across.dot(normal), z.dot(direction));
  frame.translation() += row.d * z + row.a * normal;
  frame.linear().col(0) = normal;
  frame.linear().col(1) = direction.cross(normal);
  frame.linear().col(2) = direction;
  return row;
}

bool is_identity(const SerialJointDescription& row) {
  return row.theta == 0.0 && row.d == 0.0 && row.a == 0.0 && row.alpha == 0.0;
}

}  // namespace

std::optional<SerialDescription> rows_of(const LegDescription& leg) {
  if (leg.attachment != Attachment::rigid || leg.joints.empty()) return std::nullopt;
  for (const JointDescription& joint : leg.joints) {
    if (!joint.active || joint.type == JointType::parallelogram) return std::nullopt;
  }
  SerialDescription arm;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  SerialJointDescription base = row_to(frame, leg.joints.front().point, leg.joints.front().axis.normalized());
  base.name = "base";
  base.type = SerialJointType::fixed;
  if (!is_identity(base)) arm.joints.push_back(base);

  const Vector3 tool = leg.tip - leg.platform_rotation * leg.platform_point;
  for (std::size_t j = 0; j < leg.joints.size(); ++j) {
    const JointDescription& joint = leg.joints[j];
    const bool last = j + 1 == leg.joints.size();
    SerialJointDescription row =
        last ? row_to(frame, tool, leg.platform_rotation.col(2))
             : row_to(frame, leg.joints[j + 1].point, leg.joints[j + 1].axis.normalized());
    row.name = joint.name;
    row.type = joint.type == JointType::prismatic ? SerialJointType::prismatic : SerialJointType::revolute;
    row.range = joint.range;
    row.home = joint.home;
    row.free = joint.free;
    arm.joints.push_back(row);
  }
  // What is left is a turn about the tool's z axis and a shift along it.
  SerialJointDescription hand;
  hand.name = "tool";
  hand.type = SerialJointType::fixed;
  const Vector3 x = leg.platform_rotation.col(0);
  hand.theta = std::atan2(x.dot(frame.linear().col(1)), x.dot(frame.linear().col(0)));
  hand.d = (tool - frame.translation()).dot(frame.linear().col(2));
  if (std::abs(hand.theta) < kParallel) hand.theta = 0.0;
  if (std::abs(hand.d) < kSame) hand.d = 0.0;
  if (!is_identity(hand)) arm.joints.push_back(hand);
  return arm;
}

Description without_free_joints(const Description& description) {
  const auto* arm = std::get_if<SerialDescription>(&description.mechanism);
  if (arm == nullptr) return description;
  Description result = description;
  auto& rows = std::get<SerialDescription>(result.mechanism).joints;
  const std::vector<JointDescription> joints = legs_of(*arm).legs.front().joints;
  Eigen::Isometry3d held = Eigen::Isometry3d::Identity();  // what the free joints so far do at home
  std::string link;                                        // of the last joint that is not free
  std::size_t j = 0;
  for (SerialJointDescription& row : rows) {
    if (row.type == SerialJointType::fixed) continue;
    const JointDescription& joint = joints[j++];
    if (!row.free) {
      link = "arm/" + row.name;
      held.setIdentity();
      continue;
    }
    if (joint.type == JointType::prismatic) {
      held.translate(Vector3(row.home * joint.axis));
      row.d += row.home;
    } else {
      held = held * Eigen::Translation3d(joint.point) * Eigen::AngleAxisd(row.home, joint.axis) *
             Eigen::Translation3d(-joint.point);
      row.theta += row.home;
    }
    for (BodyDescription& body : result.bodies) {
      if (body.on != "arm/" + row.name) continue;
      body.centre = held * body.centre;
      body.inertia = held.linear() * body.inertia * held.linear().transpose();
      body.on = link;
    }
    row.type = SerialJointType::fixed;
    row.free = false;
  }
  // Links that no drive moves are part of the base.
  std::erase_if(result.bodies, [](const BodyDescription& body) { return body.on.empty(); });
  return result;
}

}  // namespace zwidth
