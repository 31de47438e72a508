#include "zwidth/analysis/balance.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"
#include "support/positioning_stage.h"

#include "zwidth/analysis/statics.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

using test::PositioningStage;
using test::uniform;

PositioningStage random_stage(std::mt19937_64& random) {
  PositioningStage s;
  for (double* x : {&s.m1, &s.m3, &s.m4, &s.mL, &s.mc}) *x *= uniform(random, 0.7, 1.3);
  for (double* x : {&s.l1, &s.l2, &s.l3, &s.l4, &s.d1, &s.d2, &s.d3, &s.d4}) *x *= uniform(random, 0.8, 1.2);
  return s;
}

ActiveVector random_joints(std::mt19937_64& random) {
  ActiveVector q(7);
  for (double& x : q) x = uniform(random, -3.0, 3.0);
  return q;
}

TEST(FirstMoments, AreTheResidualsOfTheSource) {  // Baser 2006, eq 5.24 and 5.25
  std::mt19937_64 random(81);
  const auto check = [](const PositioningStage& stage) {
    const std::vector<Vector3> moments = first_moments(Mechanism(test::balanced_arm(stage)));
    ASSERT_EQ(moments.size(), 7u);
    EXPECT_NEAR(moments[1].z(), stage.A(), 1e-15);
    EXPECT_NEAR(moments[3].z(), stage.B(), 1e-15);
    for (std::size_t j = 0; j < 7; ++j) {
      EXPECT_NEAR(moments[j].head<2>().norm(), 0.0, 1e-15);
      if (j != 1 && j != 3) {
        EXPECT_NEAR(moments[j].z(), 0.0, 1e-15);
      }
    }
  };
  check({});
  EXPECT_NEAR(PositioningStage{}.A(), -1450e-6, 1e-12);
  EXPECT_NEAR(PositioningStage{}.B(), -600e-6, 1e-12);
  for (int n = 0; n < 20; ++n) check(random_stage(random));
}

TEST(MassCentre, AndWeightFollowFromTheFirstMoments) {
  std::mt19937_64 random(82);
  for (int n = 0; n < 50; ++n) {
    const PositioningStage stage = random_stage(random);
    const Description description = test::balanced_arm(stage);
    const Mechanism arm(description);
    const ActiveVector q = random_joints(random);
    const Posture posture = *solve_forward(arm, q).posture;
    const double s2 = std::sin(q[1]), c2 = std::cos(q[1]), s3 = std::sin(q[2]), c3 = std::cos(q[2]),
                 s4 = std::sin(q[3]), c4 = std::cos(q[3]);
    const Vector3 upper = posture.link_rotation(2).col(2), fore = posture.link_rotation(3).col(2);
    EXPECT_LT((mass_centre(posture) - (stage.A() * upper + stage.B() * fore) / stage.mass()).norm(), 1e-15);
    EXPECT_NEAR(moving_mass(arm), stage.mass(), 1e-15);
    // dV/dtheta with gravity along -z.
    const double g = kStandardGravity, A = stage.A(), B = stage.B();
    const ActiveVector torque = gravity_torques(posture);
    EXPECT_NEAR(torque[0], 0.0, 1e-14);
    EXPECT_NEAR(torque[1], g * (-A * s2 - B * (c2 * c3 * s4 + s2 * c4)), 1e-14);
    EXPECT_NEAR(torque[2], g * B * s2 * s3 * s4, 1e-14);
    EXPECT_NEAR(torque[3], -g * B * (s2 * c3 * c4 + c2 * s4), 1e-14);
    for (int j = 4; j < 7; ++j) EXPECT_NEAR(torque[j], 0.0, 1e-14);
  }
}

TEST(FirstMoments, GiveTheMassCentreOfAnyArm) {
  std::mt19937_64 random(83);
  for (int n = 0; n < 30; ++n) {
    Description description = test::arm_description(uniform(random, 0.1, 0.4), uniform(random, 0.1, 0.4));
    auto& arm = std::get<SerialDescription>(description.mechanism);
    for (SerialJointDescription& joint : arm.joints) {
      joint.a = uniform(random, -0.1, 0.1);
      joint.d += uniform(random, -0.1, 0.1);
      joint.alpha = uniform(random, -2.0, 2.0);
    }
    const auto anywhere = [&] { return Vector3(uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), 0.1); };
    for (int k = 0; k < 6; ++k) {
      BodyDescription body;
      body.on = k == 5 ? "platform" : "arm/theta" + std::to_string(1 + k);
      body.mass = uniform(random, 0.1, 1.0);
      body.centre = anywhere();
      if (k == 2) {
        body.turns_with = "arm/theta6";
        body.pivot = anywhere();
      }
      description.bodies.push_back(body);
    }
    const Mechanism mechanism(description);
    const std::vector<Vector3> moments = first_moments(mechanism);
    // Constant plus sum of turned first moments, whichever posture.
    std::vector<Vector3> rest;
    for (int m = 0; m < 5; ++m) {
      const Posture posture = *solve_forward(mechanism, random_joints(random)).posture;
      Vector3 sum = Vector3::Zero();
      for (int j = 0; j < 7; ++j) sum += posture.link_rotation(j) * moments[static_cast<std::size_t>(j)];
      rest.push_back(moving_mass(mechanism) * mass_centre(posture) - sum);
    }
    for (const Vector3& one : rest) EXPECT_LT((one - rest[0]).norm(), 1e-14);
    for (int j = 0; j < 7; ++j) {
      if (j > 0) {
        EXPECT_NEAR(
            moments[static_cast<std::size_t>(j)].dot(mechanism.joints()[static_cast<std::size_t>(j)].axis), 0.0,
            1e-14);
      }
    }
  }
}

TEST(FirstMoments, AreForSerialArmsOnly) {
  EXPECT_TRUE(first_moments(Mechanism(test::with_bodies(test::published_delta()))).empty());
}

TEST(BalancedBody, ACounterweightTakesTheWholeWeight) {
  std::mt19937_64 random(84);
  for (int n = 0; n < 20; ++n) {
    const PositioningStage stage = random_stage(random);
    Description description = test::balanced_arm(stage);
    const std::optional<BalancedBody> balanced = balanced_body(description, 4);
    ASSERT_TRUE(balanced);
    // l3 and d4 that null eq 5.24 and 5.25.
    EXPECT_NEAR(-balanced->body.pivot.z(), stage.l3 + stage.A() / stage.mc, 1e-15);
    EXPECT_NEAR(balanced->body.pivot.z() - balanced->body.centre.z(), stage.d4 + stage.B() / stage.mc, 1e-15);
    for (const Vector3& moment : balanced->residual) EXPECT_LT(moment.norm(), 1e-15);
    description.bodies[4] = balanced->body;
    const Mechanism arm(description);
    std::vector<Posture> postures;
    for (int m = 0; m < 20; ++m) postures.push_back(*solve_forward(arm, random_joints(random)).posture);
    const BalanceResidual residual = balance_residual(postures);
    EXPECT_LT(residual.torque.maxCoeff(), 1e-14);
    EXPECT_LT(residual.stray, 1e-15);
    EXPECT_LT(weight_at_tool(postures[0]).force.norm(), 1e-12);
  }
}

TEST(BalancedBody, OnOneLinkTakesWhatItCan) {
  Description description = test::balanced_arm({});
  const std::optional<BalancedBody> upper = balanced_body(description, 0);  // m1, fixed to the upper link
  ASSERT_TRUE(upper);
  EXPECT_LT(upper->residual[1].norm(), 1e-15);
  EXPECT_GT(upper->residual[3].norm(), 1e-4);  // the forearm's share is out of its reach
  description.bodies[0].on = "platform";
  EXPECT_FALSE(balanced_body(description, 0));
}

TEST(BalanceResidual, OfThePublishedStage) {  // at most 0.020 N m, and 1.7 mm off the support centre
  const Mechanism arm(test::balanced_arm({}));
  std::vector<Posture> postures;
  std::mt19937_64 random(85);
  for (int n = 0; n < 3000; ++n) postures.push_back(*solve_forward(arm, random_joints(random)).posture);
  const BalanceResidual residual = balance_residual(postures);
  EXPECT_NEAR(residual.torque[1], kStandardGravity * (1.45e-3 + 0.6e-3), 2e-4);
  EXPECT_LT(residual.torque[0], 1e-12);
  double farthest = 0.0;
  for (const Posture& posture : postures) farthest = std::max(farthest, mass_centre(posture).norm());
  EXPECT_NEAR(farthest, 1.7e-3, 5e-5);
  for (std::size_t j = 0; j < 4; ++j) {
    const Posture& worst = postures[static_cast<std::size_t>(residual.worst[j])];
    EXPECT_NEAR(std::abs(gravity_torques(worst)[static_cast<Eigen::Index>(j)]),
                residual.torque[static_cast<Eigen::Index>(j)], 1e-15);
  }
}

TEST(Counterweight, HeavyAndCloseIsBest) {
  const Counterweight light = counterweight_of_mass(0.2, 0.3, 0.3),
                      heavy = counterweight_of_mass(0.2, 0.3, 0.6);
  for (const Counterweight& one : {light, heavy}) {
    EXPECT_NEAR(one.mass * one.distance, 0.2 * 0.3, 1e-15);
    EXPECT_NEAR(one.inertia, 0.2 * 0.3 * 0.3 + one.mass * one.distance * one.distance, 1e-15);
  }
  EXPECT_LT(heavy.inertia, light.inertia);
  EXPECT_NEAR(counterweight_at(0.2, 0.3, heavy.distance).mass, 0.6, 1e-15);
  EXPECT_THROW(counterweight_of_mass(0.2, 0.3, 0.0), std::invalid_argument);
}

TEST(WeightAtTool, OfAHangingPointIsItsMass) {
  // A delta whose only mass is the platform: the hand holds all of it, upwards.
  Description description = test::with_bodies(test::published_delta());
  description.bodies = {description.bodies[2]};
  const Mechanism delta(description);
  const Posture posture = *solve_forward(delta, Vector3::Constant(0.4)).posture;
  const WeightAtTool weight = weight_at_tool(posture);
  EXPECT_NEAR(weight.mass, description.bodies[0].mass, 1e-12);
  EXPECT_LT((weight.force - Vector3(0, 0, kStandardGravity * description.bodies[0].mass)).norm(), 1e-12);
  EXPECT_LT(weight.left.norm(), 1e-12);
}

}  // namespace
}  // namespace zwidth
