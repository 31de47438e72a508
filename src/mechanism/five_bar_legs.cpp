#include <cmath>
#include <numbers>

#include "zwidth/mechanism/families.h"

// The five-bar in the general form. A leg's zero posture has crank and coupler along +x.

namespace zwidth {

LegsDescription legs_of(const FiveBarDescription& five_bar) {
  const double r1 = five_bar.crank, r2 = five_bar.coupler, r3 = five_bar.half_base;
  const Interval ranges[] = {five_bar.left_range, five_bar.right_range};
  const Vector3 motors[] = {{-r3, 0.0, 0.0}, {r3, 0.0, 0.0}};

  // Home: the cranks in the middle of their ranges; there the couplers meet, or else as near as they come.
  Vector3 elbows[2];
  for (int i = 0; i < 2; ++i) {
    const double theta = ranges[i].middle();
    elbows[i] = motors[i] + r1 * Vector3(std::cos(theta), std::sin(theta), 0.0);
  }
  const Vector3 between = elbows[1] - elbows[0];
  const double half = 0.5 * between.norm();
  const double height = std::sqrt(std::max(0.0, r2 * r2 - half * half));
  Vector3 left_of = Vector3::UnitY();  // unit, to the left of the line between the elbows
  if (half > 0.0) left_of = Vector3(-between.y(), between.x(), 0.0) / (2.0 * half);
  const Vector3 tool = 0.5 * (elbows[0] + elbows[1]) + five_bar.assembly_mode * height * left_of;

  LegsDescription legs;
  legs.platform = PlatformFreedom::planar_translation;
  for (int i = 0; i < 2; ++i) {
    const std::string number = std::to_string(i + 1);
    const double theta = ranges[i].middle();
    const Vector3 coupler = tool - elbows[i];
    LegDescription leg;
    leg.name = i == 0 ? "left" : "right";
    leg.joints = {
        {.name = "theta" + number, .active = true, .point = motors[i], .range = ranges[i], .home = theta},
        {.name = "elbow" + number,
         .point = motors[i] + r1 * Vector3::UnitX(),
         .home = std::remainder(std::atan2(coupler.y(), coupler.x()) - theta, 2.0 * std::numbers::pi)}};
    leg.tip = motors[i] + (r1 + r2) * Vector3::UnitX();
    leg.attachment = Attachment::spherical;
    legs.legs.push_back(leg);
  }
  return legs;
}

}  // namespace zwidth
