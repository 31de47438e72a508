#include "zwidth/analysis/orientation.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/deltas.h"
#include "support/small_arms.h"

#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi, kDegree = kPi / 180.0;

// The arm of Baser 2006, its wrist within ranges [deg].
Description with_wrist(SerialDescription arm, const Interval& yaw, const Interval& pitch,
                       const Interval& roll) {
  const std::array<Interval, 3> ranges = {yaw, pitch, roll};
  for (std::size_t j = 0; j < 3; ++j) {
    SerialJointDescription& joint = arm.joints[4 + j];
    joint.range = {ranges[j].min * kDegree, ranges[j].max * kDegree};
    joint.home = joint.range.middle();
  }
  return test::arm_description(arm.joints);
}

const Interval kTurn{0.0, 360.0};

Vector3 place_of(const Mechanism& mechanism, double share) {
  ActiveVector q(mechanism.active_count());
  for (int j = 0; j < q.size(); ++j)
    q[j] = mechanism.active_range(j).min + share * mechanism.active_range(j).width();
  return solve_forward(mechanism, q).posture->tool().position;
}

// With theta3 locked the wrist's place decides the arm, and the forearm is the axis of the wrist: theta6 within
// (a, b) leaves a band of (cos a - cos b)/2 of the sphere, theta5 and theta7 their part of a turn.
TEST(Orientation, OfAnArmThatIsNotRedundantIsThatOfItsWrist) {
  const double band = 0.5 * (std::cos(20.0 * kDegree) - std::cos(110.0 * kDegree));
  struct Case {
    Interval yaw, roll;
    double directions, orientations;
  };
  for (const Case& c : {Case{kTurn, kTurn, band, band}, Case{{0.0, 90.0}, kTurn, 0.25 * band, 0.25 * band},
                        Case{{0.0, 90.0}, {10.0, 130.0}, 0.25 * band, 0.25 * band / 3.0}}) {
    const Mechanism arm(with_wrist(test::seven_dof_locked(), c.yaw, {20.0, 110.0}, c.roll));
    for (const double share : {0.3, 0.6}) {
      const OrientationsAt found =
          orientations_at(arm, place_of(arm, share), {.orientations = 1500, .directions = 1500});
      ASSERT_TRUE(found.reached);
      ASSERT_TRUE(found.orientations);
      EXPECT_NEAR(found.directions.value, c.directions, 2.5 * found.directions.error);
      EXPECT_NEAR(found.orientations->value, c.orientations, 2.5 * found.orientations->error);
    }
  }
}

// The elbow may be anywhere on its circle that the ranges allow; from each place of it the wrist covers a band
// about the forearm. The union of the bands by the closed form, on a fine grid of both.
TEST(Orientation, OfARedundantArmIsTheUnionOverItsElbowCircle) {
  const SrsLengths lengths{.upper_arm = 0.25, .forearm = 0.25};
  const Interval pitch{10.0, 50.0};
  const Mechanism arm(with_wrist(test::seven_dof(), kTurn, pitch, kTurn));
  for (const double share : {0.35, 0.5, 0.8}) {
    const Vector3 place = place_of(arm, share);
    std::vector<Vector3> forearms;
    const SrsElbowCircle circle = srs_elbow_circle(lengths, place);
    ASSERT_EQ(circle.status, SrsStatus::solved);
    for (int n = 0; n < 2000; ++n) {
      const double angle = 2.0 * kPi * n / 2000;
      const Vector3 elbow =
          circle.centre + std::cos(angle) * circle.cosine_arm + std::sin(angle) * circle.sine_arm;
      for (int branch = 0; branch < 8; branch += 2) {
        const SrsAngles theta = srs_on_circle(lengths, {.position = place}, circle, angle, branch, {});
        bool within = true;
        for (int j = 0; j < 4; ++j) {
          const Interval range = arm.active_range(j);
          const double turned = range.middle() + std::remainder(theta[j] - range.middle(), 2.0 * kPi);
          within = within && range.contains(turned);
        }
        if (within) forearms.push_back((place - elbow) / lengths.forearm);
      }
    }
    ASSERT_FALSE(forearms.empty());
    int covered = 0;
    constexpr int kDirections = 20000;
    for (int n = 0; n < kDirections; ++n) {
      const double z = 1.0 - (2.0 * n + 1.0) / kDirections, r = std::sqrt(1.0 - z * z), turn = 2.399963 * n;
      const Vector3 direction(r * std::cos(turn), r * std::sin(turn), z);
      covered += std::ranges::any_of(forearms, [&](const Vector3& forearm) {
        return pitch.contains(std::acos(std::clamp(direction.dot(forearm), -1.0, 1.0)) / kDegree);
      });
    }
    const OrientationsAt found = orientations_at(arm, place, {.orientations = 50, .directions = 1500});
    EXPECT_NEAR(found.directions.value, static_cast<double>(covered) / kDirections,
                2.5 * found.directions.error);
  }
}

TEST(Orientation, OfAFullWristIsWholeWhereverTheArmReaches) {
  const Mechanism arm(test::seven_joint_arm(0.25, 0.25));
  const ReachMap map = reach_map(arm, {.samples = 200'000});
  const OrientationWorkspace workspace =
      orientation_workspace(arm, map, {.orientations = 60, .directions = 60, .places = 40});
  EXPECT_GT(workspace.places, 20);
  ASSERT_TRUE(workspace.orientations);
  EXPECT_EQ(workspace.orientations->least, 1.0);
  EXPECT_EQ(workspace.directions.least, 1.0);
  EXPECT_DOUBLE_EQ(workspace.orientations->dexterous_volume(), reachable_volume(map).value);
}

TEST(Orientation, DoesNotDependOnTheNumberOfThreads) {
  const Mechanism arm(with_wrist(test::seven_dof(), {0.0, 200.0}, {20.0, 60.0}, kTurn));
  const ReachMap map = reach_map(arm, {.samples = 100'000});
  const OrientationOptions options{.orientations = 60, .directions = 60, .places = 30};
  const OrientationWorkspace one = orientation_workspace(arm, map, options, {.threads = 1});
  const OrientationWorkspace all = orientation_workspace(arm, map, options);
  EXPECT_EQ(one.orientations->mean, all.orientations->mean);
  EXPECT_EQ(one.directions.volume, all.directions.volume);
  // Whoever can turn the tool any way can point its axis anywhere.
  EXPECT_LE(one.orientations->mean, one.directions.mean + 0.05);
}

TEST(Orientation, OfAPlaceOutOfReachIsNone) {
  const Mechanism arm(test::seven_joint_arm(0.25, 0.25));
  const OrientationsAt found = orientations_at(arm, {0.0, 0.0, 1.0});
  EXPECT_FALSE(found.reached);
  EXPECT_EQ(found.directions.value, 0.0);
  EXPECT_EQ(found.orientations->value, 0.0);
}

TEST(Orientation, FiveJointsTurnTheToolsAxisButNotTheWholeTool) {
  SerialDescription arm = test::seven_dof_locked();
  arm.joints[6].type = SerialJointType::fixed;
  arm.joints[5].range = {20.0 * kDegree, 110.0 * kDegree};
  const Mechanism five(test::arm_description(arm.joints));
  ASSERT_EQ(five.active_count(), 5);
  const OrientationsAt found = orientations_at(five, place_of(five, 0.4), {.directions = 1500});
  EXPECT_FALSE(found.orientations);
  EXPECT_NEAR(found.directions.value, 0.5 * (std::cos(20.0 * kDegree) - std::cos(110.0 * kDegree)),
              2.5 * found.directions.error);
}

TEST(Orientation, IsRefusedWithAReason) {
  EXPECT_TRUE(orientation_obstacle(Mechanism(test::cylindrical_arm(0.2, 0.1))));
  Description delta;
  delta.mechanism = test::published_delta();
  EXPECT_TRUE(orientation_obstacle(Mechanism(delta)));
}

}  // namespace
}  // namespace zwidth
