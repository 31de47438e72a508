#include <algorithm>
#include <cmath>

#include "zwidth/mechanism/families.h"

// The R-CUBE in the general form. A leg's zero posture has all its links in a row along its third axis.

namespace zwidth {

LegsDescription legs_of(const RCubeDescription& r_cube) {
  const double l1 = r_cube.drive_link, l2 = r_cube.inner_link, l3 = r_cube.outer_link, S = r_cube.base_offset;
  const double q1 = r_cube.joint_range.middle();
  const double r = S + l1 * std::sin(q1);  // of the home position, the same along each axis

  // The planar 2R of a leg at home, X = r_c - l1 cos q1, Y = -r_b (Görgülü 2018, eq 5.39-5.45).
  const double X = r - l1 * std::cos(q1), Y = -r;
  const double c3 = std::clamp((X * X + Y * Y - l2 * l2 - l3 * l3) / (2.0 * l2 * l3), -1.0, 1.0);
  const double s3 = r_cube.elbow_mode * std::sqrt(1.0 - c3 * c3);
  const double q3 = std::atan2(s3, c3);
  const double q2 = std::atan2((l2 + l3 * c3) * Y - l3 * s3 * X, (l2 + l3 * c3) * X + l3 * s3 * Y);

  LegsDescription legs;
  legs.platform = PlatformFreedom::translation;
  for (int i = 0; i < 3; ++i) {
    const Vector3 e_a = Vector3::Unit(i), e_b = Vector3::Unit((i + 1) % 3), e_c = Vector3::Unit((i + 2) % 3);
    const std::string number = std::to_string(i + 1);
    const Vector3 motor = S * e_a;
    const auto along = [&](double length) -> Vector3 { return motor + length * e_c; };
    LegDescription leg;
    leg.name = "leg" + number;
    leg.joints = {{.name = "theta" + number,
                   .active = true,
                   .axis = e_b,
                   .point = motor,
                   .range = r_cube.joint_range,
                   .home = q1},
                  {.name = "tilt" + number, .axis = e_b, .point = along(l1), .home = -q1},
                  {.name = "swing" + number, .axis = e_a, .point = along(l1), .home = q2},
                  {.name = "elbow" + number, .axis = e_a, .point = along(l1 + l2), .home = q3},
                  {.name = "wrist" + number, .axis = e_a, .point = along(l1 + l2 + l3), .home = -(q2 + q3)}};
    leg.tip = along(l1 + l2 + l3);
    leg.attachment = Attachment::rigid;
    legs.legs.push_back(leg);
  }
  return legs;
}

}  // namespace zwidth
