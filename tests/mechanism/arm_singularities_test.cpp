#include "zwidth/mechanism/arm_singularities.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/arms.h"

#include "zwidth/mechanism/jacobian.h"

namespace zwidth {
namespace {

constexpr double kLink = 0.25;  // both links of the arm

Mechanism locked(double theta3) {
  Description device;
  device.name = "locked";
  device.mechanism = test::seven_dof_locked(theta3);
  return Mechanism(device);
}

// Distance of the wrist from the plane of axes 1 and 2.
double from_plane(double theta2, double theta3, double theta4) {
  return std::cos(theta2) * kLink * std::cos(theta3) * std::sin(theta4) +
         std::sin(theta2) * kLink * (1.0 + std::cos(theta4));
}

ActiveVector random_joints(std::mt19937_64& random) {
  ActiveVector q(6);
  for (double& one : q) one = test::arm_uniform(random, -3.0, 3.0);
  return q;
}

// The three factors of the determinant are what the three sets are about, wherever theta3 is locked.
TEST(LockedArm, LosesRankWhereOneOfItsSetsSays) {
  std::mt19937_64 random(41);
  for (int n = 0; n < 500; ++n) {
    const double theta3 = test::arm_uniform(random, -3.0, 3.0);
    const Mechanism arm = locked(theta3);
    const ActiveVector q = random_joints(random);
    const Solution solution = solve_forward(arm, q);
    const double wanted = kLink * kLink * std::sin(q[2]) * from_plane(q[1], theta3, q[2]) * std::sin(q[4]);
    EXPECT_NEAR(std::abs(jacobian(*solution.posture).determinant()), std::abs(wanted), 1e-15);
    EXPECT_EQ(arm_singularities(*solution.posture).size(), 3U);
  }
}

TEST(LockedArm, NamesTheSetThatAPostureIsIn) {
  std::mt19937_64 random(42);
  for (int n = 0; n < 300; ++n) {
    const double theta3 = n % 10 == 0 ? 0.0 : test::arm_uniform(random, -3.0, 3.0);
    const Mechanism arm = locked(theta3);
    ActiveVector q = random_joints(random);
    const int set = n % 3;
    if (set == 0) q[2] = n % 2 == 0 ? 0.0 : std::numbers::pi;
    if (set == 1) q[1] = -std::atan2(kLink * std::cos(theta3) * std::sin(q[2]), kLink * (1.0 + std::cos(q[2])));
    if (set == 2) q[4] = n % 2 == 0 ? 0.0 : std::numbers::pi;
    const Solution solution = solve_forward(arm, q);
    const std::vector<SrsSingularity> sets = arm_singularities(*solution.posture);
    EXPECT_LT(sets[static_cast<std::size_t>(set)].distance, 1e-12) << theta3 << " " << q.transpose();
    EXPECT_TRUE(solution.near_singularity());
  }
}

// Within the distance the wrist keeps to its side of the plane; beyond it does not.
TEST(LockedArm, DistanceFromTheShoulderSetIsThatOfTheJointAngles) {
  std::mt19937_64 random(43);
  for (int n = 0; n < 200; ++n) {
    const double theta3 = test::arm_uniform(random, -3.0, 3.0);
    const Mechanism arm = locked(theta3);
    const ActiveVector q = random_joints(random);
    const SrsSingularity shoulder = arm_singularities(*solve_forward(arm, q).posture)[1];
    ASSERT_EQ(shoulder.name, "shoulder");
    const auto crosses = [&](double radius) {
      const bool side = from_plane(q[1], theta3, q[2]) > 0.0;
      for (int k = 0; k < 3600; ++k) {
        const double angle = k * std::numbers::pi / 1800.0;
        const double p = from_plane(q[1] + radius * std::cos(angle), theta3, q[2] + radius * std::sin(angle));
        if ((p > 0.0) != side) return true;
      }
      return false;
    };
    EXPECT_FALSE(crosses(0.999 * shoulder.distance)) << n;
    EXPECT_TRUE(crosses(1.001 * shoulder.distance + 1e-9)) << n;
  }
}

// What it is said to carry does no work with any joint.
TEST(LockedArm, ShoulderSetCarriesAForceInThePlaneOfAxes1And2) {
  std::mt19937_64 random(44);
  for (int n = 0; n < 100; ++n) {
    const double theta3 = test::arm_uniform(random, -3.0, 3.0);
    const Mechanism arm = locked(theta3);
    ActiveVector q = random_joints(random);
    q[1] = -std::atan2(kLink * std::cos(theta3) * std::sin(q[2]), kLink * (1.0 + std::cos(q[2])));
    const Jacobian J = jacobian(*solve_forward(arm, q).posture);
    const Vector3 normal(std::cos(q[0]), std::sin(q[0]), 0.0);  // of the plane of axes 1 and 2
    const Vector3 elbow_way = J.col(2).head<3>();
    ToolVector load = ToolVector::Zero(6);
    load.head<3>() = normal.cross(elbow_way).normalized();
    EXPECT_LT((J.transpose() * load).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// On axis 1 that joint turns freely: it stays where it is, and the others follow from the pose.
TEST(LockedArm, TakesAPoseWithItsWristOnAxis1) {
  std::mt19937_64 random(45);
  const Mechanism arm = locked(0.0);
  for (int n = 0; n < 50; ++n) {
    ActiveVector q = random_joints(random);
    q[2] = test::arm_uniform(random, 0.3, 2.5);
    q[1] = -0.5 * q[2];
    for (const Match match : {Match::pose, Match::position}) {
      const Solution start = solve_forward(arm, q);
      const Solution solution =
          solve_inverse(arm, start.posture->tool(), {.start = &*start.posture, .match = match});
      ASSERT_TRUE(solution) << to_string(solution.status);
      EXPECT_TRUE(solution.near_singularity());
      EXPECT_LT((solution.posture->tool().position - start.posture->tool().position).norm(), 1e-9);
      if (match == Match::pose) {
        EXPECT_LT((solution.posture->tool().rotation - start.posture->tool().rotation).norm(), 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace zwidth
