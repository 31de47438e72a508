#include "zwidth/analysis/posture_sweep.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/small_arms.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Mechanism cylindrical(double upper, double fore) {
  return Mechanism(test::cylindrical_arm(upper, fore));
}
Mechanism seven_joints(double upper, double fore) {
  return Mechanism(test::seven_joint_arm(upper, fore));
}

TEST(PostureSweep, SpreadsPosturesEvenlyOverEveryRange) {
  const Mechanism mechanism = seven_joints(0.25, 0.25);
  constexpr int kSamples = 4000, kBins = 20;
  for (int j = 0; j < mechanism.active_count(); ++j) {
    std::array<int, kBins> bins{};
    const Interval range = mechanism.active_range(j);
    for (int i = 0; i < kSamples; ++i) {
      const double q = spread_posture(mechanism, i)[j];
      ASSERT_TRUE(range.contains(q));
      ++bins[static_cast<std::size_t>(std::min(kBins - 1.0, (q - range.min) / range.width() * kBins))];
    }
    // An additive sequence misses its share by the order of its logarithm, random ones by some 14 here.
    for (const int count : bins) EXPECT_NEAR(count, kSamples / kBins, 8) << j;
  }
}

TEST(PostureSweep, ManipulabilityIsThatOfTheClosedForm) {
  const double upper = 0.225, fore = 0.35;
  const PostureSweep sweep = sweep_postures(cylindrical(upper, fore), {.samples = 20'000});
  EXPECT_EQ(sweep.solved, 20'000);
  // w = upper fore |sin elbow|, whose mean over -60..60 deg is (1 - cos 60)/(pi/3).
  const double mean = upper * fore * 0.5 / (std::numbers::pi / 3.0);
  EXPECT_NEAR(sweep.manipulability.mean, mean, 2e-4 * mean);
  EXPECT_NEAR(sweep.manipulability.max, upper * fore * std::sin(60.0 * kDegree), 1e-4 * upper * fore);
  EXPECT_LT(sweep.manipulability.min, 1e-3 * upper * fore);
  EXPECT_NEAR(std::abs(sweep.manipulability.max_at[2]), 60.0 * kDegree, 1e-2);
}

TEST(PostureSweep, ForcesAreThoseOfTheLimitsAtTheirPosture) {
  const Mechanism mechanism = seven_joints(0.3, 0.2);
  ActiveVector limit(7);
  limit << 1.0, 0.8, 0.5, 0.7, 0.05, 0.05, 0.02;
  const PostureSweepOptions options{.samples = 500,
                                    .torque = [&](const Posture&) { return TorqueRange::symmetric(limit); }};
  const PostureSweep sweep = sweep_postures(mechanism, options);
  // Asked again where the sweep says its extremes are.
  const auto jacobian_at = [&](const ActiveVector& q) {
    return jacobian(*solve_forward(mechanism, q).posture);
  };
  for (int k = 0; k < 3; ++k) {
    const Jacobian linear = jacobian_at(sweep.force[k].min_at).topRows(3);
    EXPECT_NEAR(axis_force_limits(linear, limit)[k], sweep.force[k].min, 1e-9 * sweep.force[k].min);
    const Jacobian angular = jacobian_at(sweep.moment[k].max_at).bottomRows(3);
    EXPECT_NEAR(axis_force_limits(angular, limit)[k], sweep.moment[k].max, 1e-9 * sweep.moment[k].max);
  }
  // No direction is weaker than the weakest force, and one comes near it.
  const Jacobian linear = jacobian_at(sweep.weakest_force.min_at).topRows(3);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20'000; ++i) {
    const double z = -1.0 + 2.0 * (i + 0.5) / 20'000, turn = 2.399963229728653 * i;
    const double r = std::sqrt(1.0 - z * z);
    least =
        std::min(least, force_limit_along(linear, limit, Vector3(r * std::cos(turn), r * std::sin(turn), z)));
  }
  EXPECT_GE(least, sweep.weakest_force.min * (1.0 - 1e-12));
  EXPECT_NEAR(least, sweep.weakest_force.min, 1e-3 * least);  // the directions are some 0.02 rad apart
}

TEST(PostureSweep, DoesNotDependOnTheNumberOfThreads) {
  const Mechanism mechanism = seven_joints(0.25, 0.25);
  const PostureSweep one = sweep_postures(mechanism, {.samples = 3000}, {.threads = 1});
  const PostureSweep all = sweep_postures(mechanism, {.samples = 3000});
  EXPECT_EQ(one.translation.index(), all.translation.index());
  EXPECT_EQ(one.homogeneous.index(), all.homogeneous.index());
  EXPECT_EQ(one.manipulability.mean, all.manipulability.mean);
  EXPECT_EQ(one.rotation_conditioning.min_at, all.rotation_conditioning.min_at);
}

TEST(PostureSweep, StopsWhenItIsCancelled) {
  const std::atomic<bool> cancel{true};
  EXPECT_FALSE(sweep_postures(cylindrical(0.2, 0.2), {.samples = 3000}, {.cancel = &cancel}).complete);
}

TEST(PostureSweep, AToolThatOnlyTranslatesHasNoMoments) {
  Description description;
  description.mechanism = DeltaDescription{.base_radius = 0.08,
                                           .upper_arm = 0.08,
                                           .forearm = 0.16,
                                           .platform_radius = 0.055,
                                           .joint_range = {-0.6, 1.4}};
  const Mechanism delta(description);
  const PostureSweepOptions options{
      .samples = 300, .torque = [](const Posture&) { return TorqueRange::symmetric(Vector3::Ones()); }};
  const PostureSweep sweep = sweep_postures(delta, options);
  EXPECT_GT(sweep.force[2].count, 200);
  EXPECT_EQ(sweep.moment[2].count, 0);
  EXPECT_EQ(sweep.rotation_conditioning.count, 0);
  EXPECT_EQ(sweep.characteristic_length, 0.0);
}

TEST(FarthestPosture, IsWhereTheElbowIsStraightest) {
  const double upper = 0.31, fore = 0.22;
  const Mechanism mechanism = seven_joints(upper, fore);
  const double reach = std::sqrt(upper * upper + fore * fore + 2.0 * upper * fore * std::cos(45.0 * kDegree));
  EXPECT_NEAR(farthest_from(mechanism, Vector3::Zero()).distance, reach, 1e-9);
}

TEST(FarthestPosture, AlongAnAxisEndsAtAJointLimit) {
  const Mechanism mechanism = cylindrical(0.2, 0.3);
  EXPECT_NEAR(farthest_along(mechanism, Vector3::UnitZ()).distance, 0.1, 1e-12);
  EXPECT_NEAR(farthest_along(mechanism, Vector3::UnitX()).distance, 0.5, 1e-9);
  // Both joints at 60 deg.
  const double y = 0.2 * std::sin(60.0 * kDegree) + 0.3 * std::sin(120.0 * kDegree);
  const double best = 0.2 * std::sin(60.0 * kDegree) + 0.3;  // the elbow need not go so far
  EXPECT_GT(best, y);
  EXPECT_NEAR(farthest_along(mechanism, Vector3::UnitY()).distance, best, 1e-9);
}

}  // namespace
}  // namespace zwidth
