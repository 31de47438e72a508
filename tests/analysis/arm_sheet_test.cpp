#include "zwidth/analysis/arm_sheet.h"

#include <cmath>
#include <gtest/gtest.h>

#include "support/small_arms.h"

namespace zwidth {
namespace {

const ArmSheetOptions kQuick{.postures = 500, .reach_postures = 400'000, .slice_postures = 5'000};

TEST(ArmSheet, HomeLoadsAreTheLimitsOfItsJacobian) {
  const Mechanism arm(test::seven_joint_arm(0.3, 0.2));
  ActiveVector limit(7);
  limit << 1.0, 0.8, 0.5, 0.7, 0.05, 0.05, 0.02;
  const TorqueSource source = [&](const Posture&) { return TorqueRange::symmetric(limit); };
  const ArmSheet sheet = arm_sheet(arm, source, {}, ActiveVector::Constant(7, 1e-3), kQuick);
  ASSERT_TRUE(sheet.home.has_value());
  const HomePosture& home = *sheet.home;
  EXPECT_TRUE(home.continuous_loads.head(3).isApprox(
      axis_force_limits(Jacobian(home.jacobian.topRows(3)), limit), 1e-12));
  EXPECT_TRUE(home.continuous_loads.tail(3).isApprox(
      axis_force_limits(Jacobian(home.jacobian.bottomRows(3)), limit), 1e-12));
  EXPECT_EQ(home.peak_loads.size(), 0);
  EXPECT_FALSE(sheet.peak.has_value());
  EXPECT_GT(sheet.continuous.turn_step.min, 0.0);
}

TEST(ArmSheet, TheReachLiesWithinItsEnds) {
  const Mechanism arm(test::seven_joint_arm(0.25, 0.25));
  const ArmSheet sheet = arm_sheet(arm, {}, {}, {}, kQuick);
  ASSERT_TRUE(sheet.reach.has_value());
  const double h = sheet.reach->volume.spacing;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sheet.reach->volume.bounds[k].min, sheet.ends[k][0].distance, 2.0 * h);
    EXPECT_NEAR(sheet.reach->volume.bounds[k].max, sheet.ends[k][1].distance, 2.0 * h);
  }
  // The corner that is farthest from the origin is not nearer than the farthest posture.
  EXPECT_LE(sheet.farthest.distance, 0.5);
  EXPECT_GT(sheet.reach->inscribed.sphere.size, 0.05);
  EXPECT_EQ(sheet.continuous.force[0].count, 0);  // no drives
}

TEST(ArmSheet, AFreeWristFeelsNoForce) {
  Description description = test::arm_description(
      {test::turning("q1", 0.1, 0.0, -90.0, {-60.0, 60.0}), test::turning("q2", 0.0, 0.2, 0.0, {-80.0, 10.0}),
       test::turning("q3", 0.0, 0.2, 0.0, {20.0, 120.0}), test::turning("q4", 0.0, 0.0, 90.0, {-90.0, 90.0}),
       test::turning("q5", 0.0, 0.0, 0.0, {-90.0, 90.0})});
  auto& joints = std::get<SerialDescription>(description.mechanism).joints;
  joints[3].free = joints[4].free = true;
  const Mechanism arm(description);
  ActiveVector limit(5);
  limit << 1.0, 1.0, 1.0, 0.0, 0.0;
  const TorqueSource source = [&](const Posture&) { return TorqueRange::symmetric(limit); };
  const ArmSheet sheet = arm_sheet(arm, source, source, {}, kQuick);
  // The wrist's axes meet in the tool point, so that forces there do not turn it, and moments cannot be held.
  EXPECT_GT(sheet.continuous.weakest_force.min, 0.0);
  EXPECT_EQ(sheet.continuous.weakest_moment.max, 0.0);
}

}  // namespace
}  // namespace zwidth
