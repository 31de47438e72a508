#include "zwidth/mechanism/wrist.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "support/allocation_counter.h"
#include "support/kdl_arm.h"
#include "support/pneumatics.h"
#include "support/storm.h"

#include "zwidth/mechanism/posture.h"

namespace zwidth {
namespace {

using std::numbers::pi;

class Storm {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3 direction() {
    Vector3 v;
    do v = Vector3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
    while (v.norm() < 0.1 || v.norm() > 1.0);
    return v.normalized();
  }
  bool coin() { return (*this)(0.0, 1.0) < 0.5; }

 private:
  std::mt19937_64 random_{3117};
};

Matrix3 about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// A leg that is nothing but a wrist, its axes through `centre`.
LegDescription wrist_leg(Storm& any, int joints, const Vector3& centre) {
  LegDescription leg;
  for (int j = 0; j < joints; ++j) {
    Vector3 axis;
    do axis = any.direction();
    while (j > 0 && axis.cross(leg.joints.back().axis).norm() < 0.2);
    leg.joints.push_back({.active = true, .axis = axis, .point = centre + any(-0.3, 0.3) * axis});
  }
  leg.tip = centre + Vector3(0.1, 0.02, -0.05);
  return leg;
}

double apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * pi));
}

TEST(Wrist, TurnsAsItIsAskedAndOneWayIsWhereItCameFrom) {
  Storm any;
  for (int n = 0; n < test::storm_size(30000); ++n) {
    const int joints = n % 4;
    const Vector3 centre(any(-1, 1), any(-1, 1), any(-1, 1));
    const LegDescription leg = wrist_leg(any, joints, centre);
    const auto wrist = Wrist::of(leg, 0);
    ASSERT_TRUE(wrist);
    EXPECT_EQ(wrist->joint_count(), joints);
    if (joints >= 2) {
      EXPECT_LT((wrist->centre() - centre).norm(), 1e-12);
    }
    Wrist::Angles q{};
    Matrix3 turn = Matrix3::Identity();
    for (int j = 0; j < joints; ++j) {
      q[j] = any(-pi, pi);
      turn = turn * about(leg.joints[j].axis, q[j]);
    }
    const Wrist::Solutions all = wrist->inverse(turn, {});
    ASSERT_EQ(all.status, SolveStatus::reached) << n;
    ASSERT_EQ(all.count, wrist->branch_count());
    double nearest = HUGE_VAL;
    for (int k = 0; k < all.count; ++k) {
      Matrix3 back = Matrix3::Identity();
      double way = 0.0;
      for (int j = 0; j < joints; ++j) {
        back = back * about(leg.joints[j].axis, all.angles[k][j]);
        way = std::max(way, apart(all.angles[k][j], q[j]));
      }
      EXPECT_LT((back - turn).cwiseAbs().maxCoeff(), 1e-7) << n;
      nearest = std::min(nearest, way);
    }
    EXPECT_LT(nearest, 1e-5) << n;  // a root that is nearly double is known to half the digits
  }
}

TEST(Wrist, OfOneOrTwoJointsRefusesOtherTurns) {
  Storm any;
  for (int n = 0; n < 300; ++n) {
    const int joints = n % 3;
    const LegDescription leg = wrist_leg(any, joints, Vector3::Zero());
    Matrix3 turn = Matrix3::Identity();
    for (const JointDescription& joint : leg.joints) turn = turn * about(joint.axis, any(-3.0, 3.0));
    // Away from all that the joints do: about what their axes leave.
    const Vector3 other = joints == 0   ? any.direction()
                          : joints == 1 ? Vector3(leg.joints[0].axis.unitOrthogonal())
                                        : leg.joints[0].axis.cross(leg.joints[1].axis).normalized();
    const auto wrist = Wrist::of(leg, 0);
    EXPECT_EQ(wrist->inverse(turn, {}).status, SolveStatus::reached);
    EXPECT_EQ(wrist->inverse(about(turn * other, 1e-4) * turn, {}).status, SolveStatus::unreachable) << n;
  }
}

TEST(Wrist, KnowsWhatItIsNot) {
  Storm any;
  const LegDescription leg = wrist_leg(any, 3, Vector3::Zero());
  LegDescription other = leg;
  other.joints[2].point += 0.01 * other.joints[2].axis.unitOrthogonal();  // passes by
  EXPECT_FALSE(Wrist::of(other, 0));
  other = leg;
  other.joints[1].axis = other.joints[0].axis;
  other.joints[1].point = other.joints[0].point;
  EXPECT_FALSE(Wrist::of(other, 0));
  other = leg;
  other.joints[1].type = JointType::prismatic;
  EXPECT_FALSE(Wrist::of(other, 0));
  other = leg;
  other.joints.push_back(leg.joints[0]);  // a fourth
  EXPECT_FALSE(Wrist::of(other, 0));
}

/// Prototypes 2 and 3 with wrists, their tools asked to lie and to stand as they should.
Description turning_arm(Storm& any) {
  const bool third = any.coin();
  Description device =
      third
          ? test::prototype(test::Prototype3{any(0.05, 0.2), any(0.0, 0.15), any(0.01, 0.05), any(0.01, 0.06)})
          : test::prototype(test::Prototype2{any(0.05, 0.25), any(0.0, 0.2), any(-0.05, 0.05), any(0.0, 0.25),
                                             any(0.05, 0.2)});
  auto& arm = std::get<SerialDescription>(device.mechanism);
  arm.platform = PlatformFreedom::rigid;
  if (!third) {
    arm.joints.push_back({.name = "theta4", .theta = 0.4, .alpha = any(0.5, 2.5), .range = test::kWide});
    arm.joints.push_back({.name = "theta5", .alpha = -any(0.5, 2.5), .range = test::kWide});
  }
  for (SerialJointDescription& row : arm.joints) row.range = test::kWide;
  if (any.coin()) {  // the handle turns about its own axis, or another
    arm.joints.back().alpha = any(0.5, 2.5);
    arm.joints.push_back({.name = "theta6", .range = test::kWide});
  }
  // The hand holds it beside the wrist, or in its middle.
  if (any.coin())
    arm.joints.push_back({.name = "hand", .type = SerialJointType::fixed, .theta = 0.3, .d = 0.05, .a = 0.02});
  return device;
}

double apart(const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).norm(), (a.rotation - b.rotation).cwiseAbs().maxCoeff());
}

TEST(PositioningArmWithWrist, TakesAPoseAsKdlHasIt) {
  Storm any;
  std::optional<Mechanism> arm;
  std::optional<test::KdlArm> kdl;
  int found = 0, looked = 0;
  for (int n = 0; n < test::storm_size(100000); ++n) {
    if (n % 100 == 0) {
      const Description device = turning_arm(any);
      arm.emplace(device);
      kdl.emplace(std::get<SerialDescription>(device.mechanism));
      ASSERT_GT(arm->closed_form()->branch_count(), 0);
    }
    ActiveVector q(arm->active_count());
    for (int j = 0; j < q.size(); ++j) q[j] = any(-3.0, 3.0);
    const Pose wanted = kdl->pose(q);
    const std::vector<Solution> all = solve_inverse_all(*arm, wanted);
    ASSERT_GE(all.size(), 1U) << n;
    double nearest = HUGE_VAL;
    for (const Solution& one : all) {
      EXPECT_LT(apart(kdl->pose(one.posture->active()), wanted), 1e-6) << n;
      double way = 0.0;
      for (int j = 0; j < q.size(); ++j) way = std::max(way, apart(one.posture->active()[j], q[j]));
      nearest = std::min(nearest, way);
    }
    ++looked;
    found += nearest < 1e-6 ? 1 : 0;
  }
  EXPECT_GT(found, looked * 0.999);  // the others are near a singularity
}

TEST(PositioningArmWithWrist, AgreesWithTheGeneralSolver) {
  Storm any;
  std::optional<Mechanism> arm;
  int compared = 0;
  const int count = test::storm_size(100000);
  for (int n = 0; n < count; ++n) {
    if (n % 50 == 0) arm.emplace(turning_arm(any));
    ActiveVector q(arm->active_count()), near = q;
    for (int j = 0; j < q.size(); ++j) {
      q[j] = any(-3.0, 3.0);
      near[j] = q[j] + any(-0.002, 0.002);
    }
    const Solution there = solve_forward(*arm, q), start = solve_forward(*arm, near);
    if (there.conditioning < 1e-2) continue;
    SolveOptions closed, general;
    closed.start = general.start = &*start.posture;
    general.closed_form = false;
    general.restart = false;
    const Solution one = solve_inverse(*arm, there.posture->tool(), closed),
                   other = solve_inverse(*arm, there.posture->tool(), general);
    ASSERT_TRUE(one) << n;
    if (!other) continue;
    EXPECT_LT(apart(one.posture->tool(), other.posture->tool()), 1e-7) << n;
    EXPECT_LT((one.posture->active() - other.posture->active()).norm(), 1e-7) << n;
    ++compared;
  }
  EXPECT_GT(compared, count / 2);
}

TEST(PositioningArmWithWrist, StaysNearItsStartOverSeveralTurns) {
  Description device = test::prototype(test::Prototype3{});
  auto& arm = std::get<SerialDescription>(device.mechanism);
  arm.platform = PlatformFreedom::rigid;
  for (SerialJointDescription& row : arm.joints) row.range = {-4.0 * pi, 4.0 * pi};
  const Mechanism mechanism(device);
  ActiveVector q(5);
  q << 0.4, 2.0 * pi + 0.3, -0.2, -2.0 * pi - 1.0, 3.5;
  const Solution start = solve_forward(mechanism, q);
  q.array() += 0.01;
  SolveOptions options;
  options.start = &*start.posture;
  const Solution moved = solve_inverse(mechanism, solve_forward(mechanism, q).posture->tool(), options);
  ASSERT_TRUE(moved);
  EXPECT_LT((moved.posture->active() - q).norm(), 1e-9);
}

TEST(PositioningArmWithWrist, DoesNotAllocate) {
  Description device = test::prototype(test::Prototype3{});
  std::get<SerialDescription>(device.mechanism).platform = PlatformFreedom::rigid;
  const Mechanism arm(device);
  ActiveVector q(5);
  q << 0.1, 0.2, 0.3, 0.4, 0.5;
  const Pose tool = solve_forward(arm, q).posture->tool();
  const long before = test::allocations();
  const Solution solution = solve_inverse(arm, tool);
  EXPECT_EQ(test::allocations(), before);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution.posture->active() - q).norm(), 1e-12);
}

}  // namespace
}  // namespace zwidth
