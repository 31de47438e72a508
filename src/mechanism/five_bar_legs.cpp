#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/five_bar.h"

// The five-bar in the general form. A leg's zero posture has crank and coupler along +x.

namespace zwidth {
namespace {

struct Home {
  Vector2 theta = Vector2::Zero();
  Vector2 position = Vector2::Zero();
  double score = -2.0;
};

// Cranks and tool, and how far from a singularity they are: 0 to 1 in the device's working mode, one less in
// another, which is no place to start from, and -2 where the couplers do not meet.
Home rated(const FiveBarDescription& description, const Vector2& theta) {
  const FiveBarGeometry geometry = five_bar_geometry(description);
  Home home{.theta = theta};
  const FiveBarForward forward = five_bar_forward(geometry, theta, description.assembly_mode);
  if (forward.status != SolveStatus::reached) return home;
  home.position = forward.position;
  const FiveBarState state(geometry, theta, home.position);
  home.score =
      std::min(state.inverse_singularity().cwiseAbs().minCoeff(), std::abs(state.direct_singularity()));
  if (working_mode(geometry, theta, home.position) != working_mode(description)) home.score -= 1.0;
  return home;
}

// The middle of the ranges if it will do, or else the best of a grid over them.
Home home_of(const FiveBarDescription& description) {
  constexpr double kGood = 0.3;
  constexpr int kGrid = 12;
  const Interval &left = description.left_range, &right = description.right_range;
  Home best = rated(description, {left.middle(), right.middle()});
  if (best.score >= kGood) return best;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const Home one = rated(description, {left.min + left.width() * (i + 0.5) / kGrid,
                                           right.min + right.width() * (j + 0.5) / kGrid});
      if (one.score > best.score) best = one;
    }
  }
  return best;
}

}  // namespace

LegsDescription legs_of(const FiveBarDescription& five_bar) {
  const double r1 = five_bar.crank, r2 = five_bar.coupler, r3 = five_bar.half_base;
  const Interval ranges[] = {five_bar.left_range, five_bar.right_range};
  const Home home = home_of(five_bar);
  LegsDescription legs;
  legs.platform = PlatformFreedom::planar_translation;
  for (int i = 0; i < 2; ++i) {
    const std::string number = std::to_string(i + 1);
    const Vector3 motor(i == 0 ? -r3 : r3, 0.0, 0.0);
    const double theta = home.theta[i];
    const Vector2 coupler = home.position - motor.head<2>() - r1 * Vector2(std::cos(theta), std::sin(theta));
    LegDescription leg;
    leg.name = i == 0 ? "left" : "right";
    leg.joints = {
        {.name = "theta" + number, .active = true, .point = motor, .range = ranges[i], .home = theta},
        {.name = "elbow" + number,
         .point = motor + r1 * Vector3::UnitX(),
         .home = std::remainder(std::atan2(coupler.y(), coupler.x()) - theta, 2.0 * std::numbers::pi)}};
    leg.tip = motor + (r1 + r2) * Vector3::UnitX();
    leg.attachment = Attachment::spherical;
    legs.legs.push_back(leg);
  }
  return legs;
}

}  // namespace zwidth
