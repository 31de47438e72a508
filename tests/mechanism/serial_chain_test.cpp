#include "zwidth/mechanism/serial_chain.h"

#include <gtest/gtest.h>

#include "support/allocation_counter.h"
#include "support/arms.h"
#include "support/kdl_arm.h"
#include "support/storm.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {
namespace {

ActiveVector random_joints(std::mt19937_64& random, const SerialDescription& arm, double widest = 3.0) {
  ActiveVector q(0);
  for (const SerialJointDescription& row : arm.joints) {
    if (row.type == SerialJointType::fixed) continue;
    q.conservativeResize(q.size() + 1);
    q[q.size() - 1] = row.type == SerialJointType::prismatic ? test::arm_uniform(random, -0.3, 0.3)
                                                             : test::arm_uniform(random, -widest, widest);
  }
  return q;
}

using test::KdlArm;

double worst_difference(const SerialForward& ours, const KDL::Frame& frame, const KDL::Jacobian& jacobian) {
  double worst = (ours.jacobian - jacobian.data).cwiseAbs().maxCoeff();
  for (int i = 0; i < 3; ++i) {
    worst = std::max(worst, std::abs(ours.tool.position[i] - frame.p[i]));
    for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(ours.tool.rotation(i, k) - frame.M(i, k)));
  }
  return worst;
}

// Some twenty products of rotations, each with an error of 1e-16, on lengths of about 1 m.
constexpr double kRounding = 1e-14;

TEST(SerialChain, AgreesWithKdlForTheSevenDofArm) {
  std::mt19937_64 random(1);
  const SerialDescription arm = test::seven_dof();
  const SerialChain chain(arm);
  KdlArm kdl(arm);
  KDL::Frame frame;
  KDL::Jacobian jacobian;
  double worst = 0.0;
  for (int n = 0; n < test::storm_size(100000); ++n) {
    const ActiveVector q = random_joints(random, arm);
    kdl.forward(q, frame, jacobian);
    worst = std::max(worst, worst_difference(chain.forward(q), frame, jacobian));
  }
  EXPECT_LT(worst, kRounding);
}

TEST(SerialChain, AgreesWithKdlForAnyRows) {
  std::mt19937_64 random(2);
  KDL::Frame frame;
  KDL::Jacobian jacobian;
  for (int n = 0; n < test::storm_size(5000); ++n) {
    const SerialDescription arm = test::random_arm(random, 1 + n % kMaxActive);
    const SerialChain chain(arm);
    ASSERT_EQ(chain.joint_count(), 1 + n % kMaxActive);
    const ActiveVector q = random_joints(random, arm);
    KdlArm(arm).forward(q, frame, jacobian);
    EXPECT_LT(worst_difference(chain.forward(q), frame, jacobian), kRounding);
    EXPECT_LT((chain.pose(q).position - chain.forward(q).tool.position).norm(), kRounding);
  }
}

TEST(SerialChain, AgreesWithTheSameArmAsALeg) {
  std::mt19937_64 random(3);
  for (int n = 0; n < test::storm_size(400); ++n) {
    Description description;
    const SerialDescription arm = test::random_arm(random, 1 + n % kMaxActive);
    description.mechanism = arm;
    const Mechanism mechanism(description);
    const SerialChain chain(arm);
    for (int k = 0; k < 5; ++k) {
      const ActiveVector q = random_joints(random, arm, 2.5);
      const Solution solution = solve_forward(mechanism, q, {.closed_form = false});
      ASSERT_TRUE(solution);
      const SerialForward here = chain.forward(q);
      EXPECT_LT((here.tool.position - solution.posture->tool().position).norm(), 1e-11);
      EXPECT_LT((here.tool.rotation - solution.posture->tool().rotation).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_LT((here.jacobian - jacobian(*solution.posture)).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

// Axes and points back to rows: other rows, the same arm.
TEST(SerialChain, ALegAsRowsIsTheSameArm) {
  std::mt19937_64 random(4);
  for (int n = 0; n < test::storm_size(2000); ++n) {
    const SerialDescription arm = test::random_arm(random, 1 + n % kMaxActive);
    const LegDescription leg = legs_of(arm).legs.front();
    const auto back = rows_of(leg);
    ASSERT_TRUE(back);
    EXPECT_LE(back->joints.size(), leg.joints.size() + 2);
    for (int k = 0; k < 3; ++k) {
      const ActiveVector q = random_joints(random, arm);
      const SerialForward here = SerialChain(arm).forward(q), there = SerialChain(*back).forward(q);
      EXPECT_LT((here.tool.position - there.tool.position).norm(), 1e-11);
      EXPECT_LT((here.tool.rotation - there.tool.rotation).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_LT((here.jacobian - there.jacobian).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(SerialChain, LegsThatAreNoArmHaveNoRows) {
  LegDescription leg = legs_of(test::seven_dof()).legs.front();
  leg.joints[3].active = false;
  EXPECT_FALSE(rows_of(leg));
  leg.joints[3].active = true;
  leg.joints[3].type = JointType::parallelogram;
  EXPECT_FALSE(rows_of(leg));
  leg.joints[3].type = JointType::revolute;
  EXPECT_TRUE(rows_of(leg));
  leg.attachment = Attachment::spherical;
  EXPECT_FALSE(rows_of(leg));
}

TEST(SerialChain, ThePositionPartHasTheSamePosition) {
  std::mt19937_64 random(5);
  const SerialDescription arm = test::seven_dof();
  const SerialChain part = SerialChain(arm).position_part();
  EXPECT_EQ(part.joint_count(), 5);  // the forearm is laid off in row 5, along axis 5
  for (int n = 0; n < 100; ++n) {
    const ActiveVector q = random_joints(random, arm);
    EXPECT_EQ(part.pose(q.head(5)).position, SerialChain(arm).pose(q).position);
  }
}

TEST(SerialChain, DoesNotAllocate) {
  const SerialChain chain(test::seven_dof());
  const ActiveVector q = ActiveVector::Constant(7, 0.3);
  SerialForward result;
  const long before = test::allocations();
  chain.forward(q, result);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(result.jacobian.norm(), 0.0);
}

}  // namespace
}  // namespace zwidth
