#include "zwidth/analysis/reach.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/small_arms.h"

#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth {
namespace {

TEST(Reach, OfACylindricalArmIsTheVolumeOfItsClosedForm) {
  // r^2 = a^2 + b^2 + 2 a b cos(elbow), an elbow of 20..100 deg to one side, swept by the shoulder and the
  // lift.
  const double a = 0.22, b = 0.18;
  Description description = test::cylindrical_arm(a, b);
  Interval& elbow = std::get<SerialDescription>(description.mechanism).joints[2].range;
  constexpr double kDegree = std::numbers::pi / 180.0;
  elbow = {20.0 * kDegree, 100.0 * kDegree};
  std::get<SerialDescription>(description.mechanism).joints[2].home = elbow.middle();
  const ReachableVolume volume = reachable_volume(Mechanism(description), {.samples = 2'000'000});
  const double exact =
      0.1 * (120.0 * kDegree) * 0.5 * 2.0 * a * b * (std::cos(elbow.min) - std::cos(elbow.max));
  EXPECT_NEAR(volume.value, exact, volume.error_estimate);
  EXPECT_LT(volume.error_estimate, 0.05 * exact);
  EXPECT_NEAR(volume.bounds[2].max, 0.1, volume.spacing);
}

TEST(Reach, OfTheSevenJointArmIsThatOfTheSource) {
  // Volumes over a (rho, z) grid of 1 mm with theta3 in steps of 0.25 deg, repeated to 1 %: 0.19302 and 0.11797
  // m^3.
  const Mechanism seven(test::seven_joint_arm(0.25, 0.25));
  const Mechanism locked(test::arm_description(test::seven_dof_locked().joints));
  for (const bool closed_form : {true, false}) {
    const ReachOptions options{.closed_form = closed_form, .samples = 3'000'000};
    const ReachableVolume more = reachable_volume(seven, options), less = reachable_volume(locked, options);
    EXPECT_NEAR(more.value, 0.19302, 0.01 * 0.19302 + more.error_estimate);
    EXPECT_NEAR(less.value, 0.11797, 0.01 * 0.11797 + less.error_estimate);
    EXPECT_NEAR(more.value / less.value - 1.0, 0.636, 0.03);
  }
}

TEST(Reach, DoesNotDependOnTheNumberOfThreads) {
  const Mechanism arm(test::seven_joint_arm(0.3, 0.2));
  for (const bool closed_form : {true, false}) {
    const ReachMap one = reach_map(arm, {.closed_form = closed_form, .samples = 100'000}, {.threads = 1});
    const ReachMap all = reach_map(arm, {.closed_form = closed_form, .samples = 100'000});
    EXPECT_EQ(one.inside, all.inside);
  }
}

TEST(Reach, HoldsEveryPostureAndNoPointBeyond) {
  const Mechanism arm(test::seven_joint_arm(0.3, 0.2));
  const ReachMap map = reach_map(arm, {.closed_form = false, .samples = 300'000});
  const double reach = std::sqrt(0.09 + 0.04 + 0.12 * std::cos(std::numbers::pi / 4.0));
  std::int64_t beyond = 0;
  for (std::int64_t i = 0; i < map.count[0]; ++i) {
    for (std::int64_t j = 0; j < map.count[1]; ++j) {
      for (std::int64_t k = 0; k < map.count[2]; ++k) {
        if (!map.at(map.first[0] + i, map.first[1] + j, map.first[2] + k)) continue;
        const Vector3 middle = map.spacing * Vector3(static_cast<double>(map.first[0] + i) + 0.5,
                                                     static_cast<double>(map.first[1] + j) + 0.5,
                                                     static_cast<double>(map.first[2] + k) + 0.5);
        if (middle.norm() > reach + 2e-3 * map.spacing) ++beyond;
      }
    }
  }
  EXPECT_EQ(beyond, 0);
}

// The map by drawn postures and Newton's method against the exact test of one point in closed form.
TEST(Reach, AgreesWithTheClosedFormOfASphericalShoulder) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const std::array<Interval, 4> ranges = {Interval{-90.0 * kDegree, 90.0 * kDegree},
                                          {30.0 * kDegree, 120.0 * kDegree},
                                          {-60.0 * kDegree, 60.0 * kDegree},
                                          {45.0 * kDegree, 135.0 * kDegree}};
  for (const auto& [upper, fore] : {std::pair{0.25, 0.25}, {0.3, 0.2}, {0.15, 0.4}}) {
    const SrsReach exact({.upper_arm = upper, .forearm = fore}, ranges);
    const Mechanism arm(test::seven_joint_arm(upper, fore));
    for (int i = 0; i < 20'000; ++i) {
      const Solution drawn = solve_forward(arm, spread_posture(arm, i));
      ASSERT_TRUE(exact.contains(drawn.posture->tool().position)) << i;
    }
    const ReachMap map = reach_map(arm, {.closed_form = false, .samples = 500'000});
    std::int64_t inside = 0, missed = 0, beyond = 0;
    for (std::int64_t i = map.first[0]; i < map.first[0] + map.count[0]; ++i) {
      for (std::int64_t j = map.first[1]; j < map.first[1] + map.count[1]; ++j) {
        for (std::int64_t k = map.first[2]; k < map.first[2] + map.count[2]; ++k) {
          const Vector3 middle =
              map.spacing *
              Vector3(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5, static_cast<double>(k) + 0.5);
          const bool reached = exact.contains(middle);
          inside += reached ? 1 : 0;
          missed += reached && !map.at(i, j, k) ? 1 : 0;
          beyond += !reached && map.at(i, j, k) ? 1 : 0;
        }
      }
    }
    EXPECT_GT(inside, 5000);
    // Middles within the map's tolerance of a thousandth of a cube may count as reached; misses are those that
    // Newton's method finds no way to.
    EXPECT_LE(beyond, inside / 500) << upper;
    EXPECT_LE(missed, inside / 500) << upper;
  }
}

TEST(Reach, RefusesWhatIsNoArm) {
  Description delta;
  delta.mechanism = DeltaDescription{.base_radius = 0.08,
                                     .upper_arm = 0.08,
                                     .forearm = 0.16,
                                     .platform_radius = 0.055,
                                     .joint_range = {-0.6, 1.4}};
  EXPECT_TRUE(reach_obstacle(Mechanism(delta)).has_value());
}

}  // namespace
}  // namespace zwidth
