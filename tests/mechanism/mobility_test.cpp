#include "zwidth/mechanism/mobility.h"

#include <gtest/gtest.h>

#include "support/deltas.h"

namespace zwidth {
namespace {

TEST(Mobility, OfTheDeltaIsThree) {
  const Mechanism delta(test::with_bodies(test::published_delta()));
  const Mobility count = mobility(*solve_forward(delta, Vector3(0.1, 0.2, 0.3)).posture);
  EXPECT_EQ(count.gruebler, 3);
  EXPECT_EQ(count.freedoms, 3);
  EXPECT_EQ(count.tool_freedoms, 3);
  EXPECT_EQ(count.redundant_equations, 0);
  EXPECT_EQ(count.active, 3);
}

TEST(Mobility, OfParallelogramsOnAFreePlatformNeedsTheRank) {
  const Mechanism delta(test::with_parallelograms(test::published_delta()));
  const Mobility count = mobility(*solve_forward(delta, Vector3(0.1, 0.2, 0.3)).posture);
  EXPECT_EQ(count.group, MotionGroup::spatial);
  EXPECT_EQ(count.gruebler, 0);  // three equations say again that the platform does not turn
  EXPECT_EQ(count.redundant_equations, 3);
  EXPECT_EQ(count.freedoms, 3);
  EXPECT_EQ(count.tool_freedoms, 3);
}

Mechanism of_legs(const LegsDescription& legs) {
  Description description;
  description.name = "legs";
  description.mechanism = legs;
  return Mechanism(description);
}

TEST(Mobility, OfAPlanarMechanismIsCountedInItsPlane) {
  const Mechanism bars = of_legs(legs_of(FiveBarDescription{
      .crank = 0.1, .coupler = 0.15, .half_base = 0.03, .left_range = {1.5, 3.0}, .right_range = {0.0, 1.6}}));
  const MobilitySample sample = sample_mobility(bars);
  EXPECT_EQ(sample.typical.group, MotionGroup::planar);
  EXPECT_EQ(sample.typical.gruebler, 2);
  EXPECT_EQ(sample.typical.freedoms, 2);
  EXPECT_EQ(sample.typical.redundant_equations, 0);
}

// Two legs of three parallel revolutes each, across each other: the platform goes up and down, which Grübler,
// counting in space, does not see (Sarrus 1853).
LegsDescription sarrus() {
  LegsDescription legs;
  for (const bool along_x : {true, false}) {
    const Vector3 out = along_x ? Vector3::UnitX() : Vector3::UnitY(),
                  axis = along_x ? Vector3::UnitY() : Vector3::UnitX();
    LegDescription leg;
    leg.name = along_x ? "a" : "b";
    leg.joints = {{.name = "foot", .active = along_x, .axis = axis, .point = 0.1 * out, .range = {-0.5, 0.5}},
                  {.name = "knee", .axis = axis, .point = 0.2 * out + 0.1 * Vector3::UnitZ()},
                  {.name = "hip", .axis = axis, .point = 0.1 * out + 0.2 * Vector3::UnitZ()}};
    leg.tip = {0.0, 0.0, 0.2};
    legs.legs.push_back(leg);
  }
  return legs;
}

TEST(Mobility, OfTheSarrusLinkageIsMoreThanGrueblerCounts) {
  const MobilitySample sample = sample_mobility(of_legs(sarrus()));
  EXPECT_EQ(sample.typical.gruebler, 0);
  EXPECT_EQ(sample.typical.freedoms, 1);
  EXPECT_EQ(sample.typical.redundant_equations, 1);
  EXPECT_EQ(sample.typical.tool_freedoms, 1);
}

TEST(Mobility, OfASingularPostureDoesNotDecide) {
  // Drawn flat, the five-bar's couplers are in line: one freedom more at the moment, but not for any way.
  LegsDescription legs;
  legs.platform = PlatformFreedom::planar_translation;
  for (const double side : {-1.0, 1.0}) {
    LegDescription leg;
    leg.name = side < 0 ? "left" : "right";
    leg.joints = {{.name = "crank", .active = true, .point = {side * 0.2, 0.0, 0.0}, .range = {-0.8, 0.8}},
                  {.name = "elbow", .point = {side * 0.2, 0.1, 0.0}}};
    leg.tip = {0.0, 0.1, 0.0};
    leg.attachment = Attachment::spherical;
    legs.legs.push_back(leg);
  }
  const Mechanism flat = of_legs(legs);
  EXPECT_EQ(mobility(*solve_forward(flat, Eigen::Vector2d::Zero()).posture).loose, 1);
  const MobilitySample sample = sample_mobility(flat);
  EXPECT_EQ(sample.typical.loose, 0);
  EXPECT_EQ(sample.typical.freedoms, 2);
}

TEST(Mobility, SaysWhichJointsAreLooseOrDecided) {
  LegsDescription legs = sarrus();
  legs.legs[0].joints[0].active = false;
  legs.legs[1].joints[1].active = true;
  legs.legs[1].joints[1].range = {-0.5, 0.5};
  const Mechanism one = of_legs(legs);
  EXPECT_TRUE(loose_joints(sample_mobility(one).posture.at(0)).empty());
  legs.legs[0].joints[0].active = true;  // two drives for one freedom
  const Mechanism two = of_legs(legs);
  EXPECT_EQ(decided_joints(sample_mobility(two).posture.at(0)), std::vector<int>{1});
  legs.legs.pop_back();  // a chain of three, one driven
  const Mechanism chain = of_legs(legs);
  EXPECT_EQ(loose_joints(sample_mobility(chain).posture.at(0)), (std::vector<int>{1, 2}));
}

}  // namespace
}  // namespace zwidth
