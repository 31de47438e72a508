#include "zwidth/mechanism/jacobian.h"

#include <gtest/gtest.h>

#include "support/deltas.h"

namespace zwidth {
namespace {

TEST(Rates, OfTheDeltaEqualTheClosedForm) {
  std::mt19937_64 random(21);
  const DeltaDescription description = test::published_delta();
  const Mechanism delta(test::with_bodies(description)), free(test::with_parallelograms(description));
  for (int k = 0; k < 500; ++k) {
    const Vector3 theta = test::random_angles(random, description.joint_range);
    const Matrix3 expected = delta_forward(*delta.delta(), theta).jacobian;
    EXPECT_LT((jacobian(*solve_forward(delta, theta).posture) - expected).norm(), 1e-12);
    const Jacobian full = jacobian(*solve_forward(free, theta).posture);
    EXPECT_LT((full.topRows<3>() - expected).norm(), 1e-10);
    EXPECT_LT(full.bottomRows<3>().norm(), 1e-9);  // the platform never turns
  }
}

TEST(Rates, OfEveryJointEqualDifferences) {
  std::mt19937_64 random(22);
  const double h = 1e-5;
  const DeltaDescription description = test::published_delta();
  for (const Description& device : {test::with_bodies(description), test::with_parallelograms(description)}) {
    const Mechanism mechanism(device);
    for (int k = 0; k < 50; ++k) {
      const Vector3 theta = test::random_angles(random, description.joint_range);
      const Rates all = rates(*solve_forward(mechanism, theta).posture);
      for (int a = 0; a < 3; ++a) {
        const Solution up = solve_forward(mechanism, Vector3(theta + h * Vector3::Unit(a)));
        const Solution down = solve_forward(mechanism, Vector3(theta - h * Vector3::Unit(a)));
        const JointVector difference = (up.posture->joints() - down.posture->joints()) / (2 * h);
        EXPECT_LT((all.joints.col(a) - difference).norm(), 1e-6);
      }
    }
  }
}

TEST(BiasAcceleration, OfTheDeltaEqualsTheClosedForm) {
  std::mt19937_64 random(23);
  const DeltaDescription description = test::published_delta();
  const Mechanism delta(test::with_bodies(description)), free(test::with_parallelograms(description));
  for (int k = 0; k < 200; ++k) {
    const Vector3 theta = test::random_angles(random, description.joint_range),
                  rate = test::random_angles(random, {-3.0, 3.0});
    const DeltaState state(*delta.delta(), theta, delta_forward(*delta.delta(), theta).position);
    const Vector3 expected = state.jacobian_rate(rate) * rate;
    for (const Mechanism* mechanism : {&delta, &free}) {
      const Solution solution = solve_forward(*mechanism, theta);
      const BiasAcceleration bias = bias_acceleration(*solution.posture, rates(*solution.posture), rate);
      EXPECT_LT((bias.tool.head<3>() - expected).norm(), 1e-9);
    }
  }
}

TEST(Rates, OfASerialLegEqualItsSpatialVelocity) {
  // Prismatic, revolute and parallelogram joints in one leg, all active: no loop, six tool rows.
  LegsDescription arm;
  arm.legs = {{.name = "arm",
               .joints = {{.name = "lift",
                           .type = JointType::prismatic,
                           .active = true,
                           .axis = {0, 0, 1},
                           .point = {0, 0, 0}},
                          {.name = "turn",
                           .type = JointType::revolute,
                           .active = true,
                           .axis = {0, 0, 1},
                           .point = {0, 0, 0.1}},
                          {.name = "bars",
                           .type = JointType::parallelogram,
                           .active = true,
                           .axis = {0, 1, 0},
                           .point = {0.1, 0, 0.1}},
                          {.name = "tilt",
                           .type = JointType::revolute,
                           .active = true,
                           .axis = {0, 1, 0},
                           .point = {0.3, 0, 0.1}}},
               .tip = {0.4, 0.0, 0.05}}};
  Description description;
  description.mechanism = arm;
  const Mechanism mechanism(description);
  std::mt19937_64 random(24);
  const double h = 1e-6;
  for (int k = 0; k < 50; ++k) {
    ActiveVector q(4), rate(4);
    for (int i = 0; i < 4; ++i) {
      q[i] = test::uniform(random, -1.0, 1.0);
      rate[i] = test::uniform(random, -1.0, 1.0);
    }
    const Posture here = *solve_forward(mechanism, q).posture;
    const Pose up = solve_forward(mechanism, ActiveVector(q + h * rate)).posture->tool();
    const Pose down = solve_forward(mechanism, ActiveVector(q - h * rate)).posture->tool();
    const Rates all = rates(here);
    const ToolVector twist = all.tool * rate;
    const Matrix3 spin = (up.rotation - down.rotation) / (2 * h) * here.tool().rotation.transpose();
    EXPECT_LT((twist.head<3>() - (up.position - down.position) / (2 * h)).norm(), 1e-8);
    EXPECT_LT((twist.tail<3>() - Vector3(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 1e-8);
    // Jdot qdot by differences of the twist at constant rates.
    const ToolVector later = rates(*solve_forward(mechanism, ActiveVector(q + h * rate)).posture).tool * rate;
    const ToolVector sooner = rates(*solve_forward(mechanism, ActiveVector(q - h * rate)).posture).tool * rate;
    EXPECT_LT((bias_acceleration(here, all, rate).tool - (later - sooner) / (2 * h)).norm(), 1e-7);
    // And the general inverse finds a way back to the pose.
    const Solution back = solve_inverse(mechanism, here.tool());
    ASSERT_TRUE(back);
    EXPECT_LT((back.posture->tool().position - here.tool().position).norm(), 1e-10);
  }
}

TEST(Dexterity, NamesTheDirectionThatASingularityLoses) {
  Jacobian J(3, 3);
  J << 1, 0, 0, 0, 2, 0, 0, 0, 0;
  const Dexterity flat = dexterity(J);
  EXPECT_TRUE(std::isinf(flat.condition_number));
  EXPECT_EQ(flat.manipulability, 0.0);
  EXPECT_NEAR(std::abs(flat.weak_direction[2]), 1.0, 1e-15);
  J(2, 2) = 0.5;
  EXPECT_NEAR(dexterity(J).condition_number, 4.0, 1e-15);
  EXPECT_NEAR(dexterity(J).manipulability, 1.0, 1e-15);
}

// A pan and tilt head moves its tool on a sphere: of the two motions that there are, all figures, whatever the
// frame; the third is none of its singularities.
TEST(Dexterity, WithFewerJointsThanRowsIsOfTheMotionsThatThereAre) {
  const Matrix3 R =
      (Eigen::AngleAxisd(0.4, Vector3::UnitX()) * Eigen::AngleAxisd(1.1, Vector3::UnitY())).matrix();
  Jacobian J(3, 2);
  J << 0.2, 0.0, 0.0, 0.5, 0.0, 0.0;
  const Dexterity head = dexterity(Jacobian(R * J));
  EXPECT_NEAR(head.condition_number, 2.5, 1e-14);
  EXPECT_NEAR(head.manipulability, 0.1, 1e-15);
  EXPECT_NEAR(head.min_singular_value, 0.2, 1e-15);
  EXPECT_NEAR(std::abs(head.weak_direction.dot(R.col(0))), 1.0, 1e-14);
  J(0, 0) = 0.0;  // on the pan axis it only tilts
  EXPECT_GT(dexterity(Jacobian(R * J)).condition_number, 1e14);
}

}  // namespace
}  // namespace zwidth
