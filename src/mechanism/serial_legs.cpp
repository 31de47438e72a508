#include <Eigen/Geometry>

#include "zwidth/mechanism/families.h"

// A serial arm in the general form: one leg, whose axes and points are those of the Denavit-Hartenberg frames
// with all joints at zero.

namespace zwidth {

LegsDescription legs_of(const SerialDescription& arm) {
  LegDescription leg;
  leg.name = "arm";
  leg.attachment = Attachment::rigid;
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
    T = T * Eigen::AngleAxisd(row.theta, Vector3::UnitZ()) * Eigen::Translation3d(row.a, 0.0, row.d) *
        Eigen::AngleAxisd(row.alpha, Vector3::UnitX());
  }
  leg.tip = T.translation();
  leg.platform_rotation = T.linear();

  LegsDescription legs;
  legs.platform = PlatformFreedom::rigid;
  legs.legs = {leg};
  return legs;
}

}  // namespace zwidth
