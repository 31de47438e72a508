#include "zwidth/mechanism/point_reach.h"

#include <gtest/gtest.h>

#include "support/arms.h"
#include "support/storm.h"

namespace zwidth {
namespace {

using test::arm_uniform;
constexpr double kPi = std::numbers::pi;

bool holds(const Interval& range, double angle) {
  return angle + 2.0 * kPi * std::ceil((range.min - angle) / (2.0 * kPi)) <= range.max;
}

std::array<Interval, 4> random_ranges(std::mt19937_64& random) {
  std::array<Interval, 4> ranges;
  for (Interval& range : ranges) {
    const double middle = arm_uniform(random, -kPi, kPi);
    const double half =
        arm_uniform(random, 0.0, 1.0) < 0.3 ? arm_uniform(random, 0.0, 3.5) : arm_uniform(random, 0.0, 1.5);
    range = {middle - half, middle + half};
  }
  return ranges;
}

// Every posture within the ranges has its wrist within reach.
TEST(SrsReach, HoldsEveryPosture) {
  std::mt19937_64 random(1);
  for (int n = 0; n < test::storm_size(5000); ++n) {
    const SrsLengths lengths{arm_uniform(random, 0.1, 0.5), arm_uniform(random, 0.1, 0.5)};
    const std::array<Interval, 4> ranges = random_ranges(random);
    const SrsReach reach(lengths, ranges);
    for (int k = 0; k < 20; ++k) {
      SrsAngles theta{};
      for (int i = 0; i < 4; ++i) theta[i] = arm_uniform(random, ranges[i].min, ranges[i].max);
      EXPECT_TRUE(reach.contains(srs_forward(lengths, theta).wrist.position));
    }
  }
}

// And of a point within reach some elbow, among many around its circle, has all joints in their ranges.
TEST(SrsReach, HoldsNothingElse) {
  std::mt19937_64 random(2);
  int inside = 0, outside = 0;
  for (int n = 0; n < test::storm_size(400); ++n) {
    const SrsLengths lengths{arm_uniform(random, 0.1, 0.5), arm_uniform(random, 0.1, 0.5)};
    const std::array<Interval, 4> ranges = random_ranges(random);
    SrsAngles theta{};
    for (double& t : theta) t = arm_uniform(random, -kPi, kPi);
    const Pose wrist = srs_forward(lengths, theta).wrist;
    const bool reached = SrsReach(lengths, ranges).contains(wrist.position);
    const SrsElbowCircle circle = srs_elbow_circle(lengths, wrist.position);
    bool found = false;
    for (int branch = 0; branch < 8 && !found; branch += 2) {
      for (int s = 0; s < 2000 && !found; ++s) {
        const SrsAngles one = srs_on_circle(lengths, wrist, circle, s * kPi / 1000.0, branch, theta);
        found = true;
        for (int i = 0; i < 4; ++i) found = found && holds(ranges[i], one[i]);
      }
    }
    EXPECT_TRUE(reached || !found);
    // An arc of allowed elbows shorter than 0.18 deg may be missed.
    if (reached != found) continue;
    ++(found ? inside : outside);
  }
  EXPECT_GT(inside, 10);
  EXPECT_GT(inside + outside, 390);
}

TEST(SrsReach, OnAxisAndStretched) {
  const Interval all{-4.0, 4.0};
  const SrsReach free({0.25, 0.25}, {all, all, all, all});
  EXPECT_TRUE(free.contains({0.0, 0.0, 0.3}));
  EXPECT_TRUE(free.contains({0.0, 0.0, 0.5}));
  EXPECT_TRUE(free.contains({0.5, 0.0, 0.0}));
  EXPECT_FALSE(free.contains({0.0, 0.0, 0.51}));
  const SrsReach front({0.25, 0.25}, {Interval{-0.5, 0.5}, Interval{1.0, 2.0}, all, all});
  EXPECT_TRUE(front.contains({0.4, 0.0, 0.0}));
  EXPECT_FALSE(front.contains({0.0, 0.0, 0.49}));
}

TEST(SrsReach, DistancesFollowTheElbow) {
  constexpr double kDegree = kPi / 180.0;
  const SrsLengths lengths{0.25, 0.25};
  EXPECT_NEAR(srs_reach(lengths, {-45.0 * kDegree, 45.0 * kDegree}).max, 0.5, 1e-15);
  EXPECT_NEAR(srs_reach(lengths, {45.0 * kDegree, 135.0 * kDegree}).max, 0.46193976625564337, 1e-15);
  EXPECT_NEAR(srs_reach(lengths, {45.0 * kDegree, 135.0 * kDegree}).min, 0.19134171618254489, 1e-15);
  EXPECT_NEAR(srs_reach({0.3, 0.2}, {-4.0, 4.0}).min, 0.1, 1e-15);
  EXPECT_NEAR(srs_reach({0.3, 0.2}, {2.0 * kPi - 0.1, 2.0 * kPi + 0.1}).max, 0.5, 1e-15);
}

TEST(PointReach, KnowsWhichArmsItDecides) {
  const auto of = [](const SerialDescription& arm) {
    Description description;
    description.mechanism = arm;
    const Mechanism mechanism(description);
    return PointReach::of(mechanism);
  };
  ASSERT_TRUE(of(test::seven_dof()));
  EXPECT_TRUE(of(test::seven_dof())->contains({0.35, 0.05, -0.05}));
  EXPECT_FALSE(of(test::seven_dof())->contains({-0.35, 0.05, -0.05}));
  EXPECT_TRUE(of(test::seven_dof_locked()));
  SerialDescription arm = test::seven_dof();
  arm.joints[6].d = 0.1;  // the tool point is not the wrist
  EXPECT_FALSE(of(arm));
}

}  // namespace
}  // namespace zwidth
