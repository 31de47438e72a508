#include <gtest/gtest.h>
#include <numbers>

#include "support/arms.h"
#include "support/deltas.h"
#include "support/five_bars.h"
#include "support/storm.h"

#include "zwidth/mechanism/batch_delta.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {
namespace {

const SolveOptions kGeneral{.closed_form = false};

Mechanism published() {
  return Mechanism(test::with_bodies(test::published_delta()));
}

TEST(SolveForward, GeneralSolverAgreesWithTheClosedForm) {
  std::mt19937_64 random(11);
  const Mechanism delta = published();
  double worst = 0.0;
  for (int k = 0; k < test::storm_size(100000); ++k) {
    const Vector3 theta = test::random_angles(random, test::published_delta().joint_range);
    const Solution general = solve_forward(delta, theta, kGeneral);
    ASSERT_EQ(general.status, SolveStatus::reached) << theta.transpose();
    worst = std::max(worst,
                     (general.posture->tool().position - delta_forward(*delta.delta(), theta).position).norm());
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(SolveForward, GeneralSolverAgreesOnRandomDeltasAndTheirPassiveJoints) {
  std::mt19937_64 random(12);
  int compared = 0;
  for (int d = 0; d < 200; ++d) {
    const DeltaDescription description = test::random_delta(random);
    // Where an elbow crosses the axis, "the mode with the larger z" is not the mode one arrives in.
    const double most = std::max(std::abs(description.joint_range.min), std::abs(description.joint_range.max));
    if (delta_geometry(description).offset() + description.upper_arm * std::cos(most) <= 0.0) continue;
    const Mechanism delta(test::with_bodies(description));
    for (int k = 0; k < 20; ++k) {
      const Vector3 theta = test::random_angles(random, description.joint_range);
      const Solution closed = solve_forward(delta, theta);
      if (!closed || closed.conditioning < 1e-2) continue;
      const Solution general = solve_forward(delta, theta, kGeneral);
      ASSERT_TRUE(general) << "delta " << d << " at " << theta.transpose();
      EXPECT_LT((general.posture->joints() - closed.posture->joints()).norm(), 1e-9);
      EXPECT_LT((general.posture->tool().position - closed.posture->tool().position).norm(), 1e-9);
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(SolveForward, ParallelogramsHoldAFreePlatformParallel) {
  std::mt19937_64 random(13);
  const DeltaDescription description = test::published_delta();
  const Mechanism delta(test::with_parallelograms(description));
  ASSERT_EQ(delta.tool_rows(), 6);
  for (int k = 0; k < 2000; ++k) {
    const Vector3 theta = test::random_angles(random, description.joint_range);
    const Solution solution = solve_forward(delta, theta);
    ASSERT_EQ(solution.status, SolveStatus::reached);
    EXPECT_LT((solution.posture->tool().rotation - Matrix3::Identity()).norm(), 1e-10);
    EXPECT_LT(
        (solution.posture->tool().position - delta_forward(delta_geometry(description), theta).position).norm(),
        1e-10);
  }
}

TEST(SolveForward, FollowsTheStartInFewSteps) {
  std::mt19937_64 random(14);
  const Mechanism delta = published();
  Vector3 theta(0.3, 0.4, 0.5);
  Solution last = solve_forward(delta, theta, kGeneral);
  for (int k = 0; k < 1000; ++k) {
    theta += test::random_angles(random, {-0.01, 0.01});
    theta = theta.cwiseMax(-0.6).cwiseMin(1.4);
    const Solution next = solve_forward(delta, theta, {.start = &*last.posture, .closed_form = false});
    ASSERT_EQ(next.status, SolveStatus::reached);
    EXPECT_LE(next.iterations, 4);
    EXPECT_LE(next.residual, 1e-12 * delta.characteristic_length());
    last = next;
  }
}

TEST(SolveForward, SaysUnreachableWithTheGapThatIsLeft) {
  DeltaDescription description = test::published_delta();
  description.forearm = 0.1;  // closes at large angles only
  description.joint_range = {0.0, 1.4};
  const Mechanism delta(test::with_bodies(description));
  EXPECT_EQ(solve_forward(delta, Vector3(0.0, 0.0, 0.0)).status, SolveStatus::unreachable);
  const Solution general = solve_forward(delta, Vector3(0.0, 0.0, 0.0), kGeneral);
  EXPECT_EQ(general.status, SolveStatus::unreachable);
  EXPECT_GT(general.residual, kGeneral.tolerance * delta.characteristic_length());
  EXPECT_FALSE(general);
}

TEST(SolveForward, AnglesBeyondTheRangeAnswerJointLimitWithThePosture) {
  const Mechanism delta = published();
  for (const bool closed_form : {true, false}) {
    const Solution solution = solve_forward(delta, Vector3(0.0, 0.0, 1.6), {.closed_form = closed_form});
    EXPECT_EQ(solution.status, SolveStatus::joint_limit);
    EXPECT_EQ(solution.joint, delta.active_joint(2));
    ASSERT_TRUE(solution);
  }
}

// Cranks beside each other and far apart, so that both cannot point outwards at once: the straight way from
// above to below is barred, and one crank must go round the inside.
TEST(SolveForward, GoesRoundTheOtherWayWhereTheStraightWayIsBarred) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Description five_bar = test::five_bar_device({.crank = 0.10, .coupler = 0.15, .half_base = 0.10});
  const ActiveVector home = Vector2(120.0 * kDegree, 60.0 * kDegree),
                     target = Vector2(250.0 * kDegree, -70.0 * kDegree);
  const JointVector joints = solve_forward(Mechanism(five_bar), home).posture->joints();
  for (const bool turns : {true, false}) {
    Description device = spelled_out(five_bar);
    int next = 0;
    for (LegDescription& leg : std::get<LegsDescription>(device.mechanism).legs) {
      for (JointDescription& joint : leg.joints) {
        joint.home = joints[next++];
        if (joint.active) joint.range = turns ? Interval{-7.0, 7.0} : Interval{-1.3, 4.5};
      }
    }
    const Mechanism legs(device);
    const Solution solution = solve_forward(legs, target, kGeneral);
    EXPECT_EQ(solution.status, turns ? SolveStatus::reached : SolveStatus::unreachable);
    if (!turns) continue;  // a joint that does not go round has one way only
    EXPECT_LT((solution.posture->active() - target).norm(), 1e-15);
    EXPECT_LT(solution.residual, 1e-12);
    EXPECT_FALSE(solve_forward(legs, target, {.closed_form = false, .restart = false}));
  }
}

TEST(SolveInverse, GeneralSolverAgreesWithTheClosedForm) {
  std::mt19937_64 random(15);
  const Mechanism delta = published();
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const Vector3 theta = test::random_angles(random, test::published_delta().joint_range);
    const Pose tool{.position = delta_forward(*delta.delta(), theta).position};
    const Solution general = solve_inverse(delta, tool, kGeneral);
    ASSERT_EQ(general.status, SolveStatus::reached) << theta.transpose();
    EXPECT_LT((general.posture->active() - theta).norm(), 1e-9);
  }
}

TEST(SolveInverse, BothSolversCallTheSamePointsUnreachable) {
  std::mt19937_64 random(16);
  const Mechanism delta = published();
  int in = 0, out = 0;
  for (int k = 0; k < 2000; ++k) {
    const Pose tool{.position = {test::uniform(random, -0.2, 0.2), test::uniform(random, -0.2, 0.2),
                                 test::uniform(random, 0.0, 0.3)}};
    const Solution closed = solve_inverse(delta, tool);
    if (closed && closed.conditioning < 1e-3) continue;  // on the boundary either answer is right
    const Solution general = solve_inverse(delta, tool, kGeneral);
    EXPECT_EQ(general.status == SolveStatus::unreachable, closed.status == SolveStatus::unreachable)
        << tool.position.transpose();
    ++(closed ? in : out);
  }
  EXPECT_GT(in, 300);
  EXPECT_GT(out, 300);
}

TEST(SolveInverse, ReachesThePointsOfTheWorkspaceAndNoOthers) {
  // Windows so wide that legs reach points which only the other assembly mode would take.
  std::mt19937_64 random(17);
  DeltaDescription description = test::published_delta();
  description.joint_range = {-2.8, 2.8};
  const Mechanism delta(test::with_bodies(description));
  const DeltaBatch batch(*delta.delta(), description.joint_range);
  int in = 0, other = 0;
  for (int k = 0; k < 20000; ++k) {
    const double x = test::uniform(random, -0.2, 0.2), y = test::uniform(random, -0.2, 0.2),
                 z = test::uniform(random, -0.25, 0.25);
    std::uint8_t inside = 0;
    batch.inside({&x, 1}, {&y, 1}, {&z, 1}, {&inside, 1});
    const Solution solution = solve_inverse(delta, {.position = {x, y, z}});
    const bool reached = solution.status == SolveStatus::reached || solution.status == SolveStatus::degraded;
    if (solution && solution.conditioning < 1e-6) continue;
    EXPECT_EQ(reached, inside != 0) << x << ' ' << y << ' ' << z;
    in += reached ? 1 : 0;
    if (!solution.other_assembly) continue;
    ++other;
    EXPECT_EQ(solution.status, SolveStatus::unreachable);
    EXPECT_FALSE(solution);
    EXPECT_LE(delta_inverse(*delta.delta(), {x, y, z}, {-4.0, 4.0}).status, SolveStatus::degraded)
        << "the legs reach it all the same";
  }
  EXPECT_GT(in, 1000);
  EXPECT_GT(other, 300);
}

TEST(SolveInverse, GeneralSolverKeepsToItsAssemblyModeToo) {
  std::mt19937_64 random(18);
  DeltaDescription description = test::published_delta();
  description.joint_range = {-1.2, 2.0};
  const Mechanism delta(test::with_bodies(description));
  int other = 0;
  for (int k = 0; k < 8000; ++k) {
    const Pose tool{.position = {test::uniform(random, -0.1, 0.1), test::uniform(random, -0.1, 0.1),
                                 test::uniform(random, -0.15, 0.0)}};
    const Solution closed = solve_inverse(delta, tool);
    if (!closed.other_assembly) continue;
    ++other;
    EXPECT_EQ(solve_inverse(delta, tool, kGeneral).status, SolveStatus::unreachable)
        << tool.position.transpose();
  }
  EXPECT_GT(other, 20);
}

TEST(SolveInverseAll, MarksTheOtherAssemblyModeByWhereTheJointsLead) {
  DeltaDescription description = test::published_delta();
  description.joint_range = {-2.8, 2.8};
  const Mechanism delta(test::with_bodies(description));
  for (const double z : {-0.1, 0.1}) {
    const std::vector<Solution> all = solve_inverse_all(delta, {.position = {0.01, -0.02, z}});
    ASSERT_EQ(all.size(), 8u);
    bool others = false;
    for (const Solution& one : all) {
      const Vector3 there = delta_forward(*delta.delta(), Vector3(one.posture->active())).position;
      EXPECT_EQ((there - one.posture->tool().position).norm() > 1e-6, one.other_assembly);
      EXPECT_FALSE(others && !one.other_assembly) << "the mechanism's own come first";
      others = others || one.other_assembly;
    }
    EXPECT_EQ(all.front().other_assembly, z < 0.0);
  }
}

TEST(SolveInverseAll, GeneralSolverFindsTheSameEightBranches) {
  const Mechanism delta = published();
  const Pose tool{.position = {0.02, -0.03, 0.12}};
  const std::vector<Solution> closed = solve_inverse_all(delta, tool),
                              general = solve_inverse_all(delta, tool, kGeneral);
  ASSERT_EQ(closed.size(), 8u);
  ASSERT_EQ(general.size(), 8u);
  for (const Solution& one : closed) {
    double nearest = 1e9;
    for (const Solution& other : general) {
      nearest = std::min(nearest, (one.posture->active() - other.posture->active()).norm());
    }
    EXPECT_LT(nearest, 1e-9);
  }
  EXPECT_EQ(closed.front().status, SolveStatus::reached);
  EXPECT_LT((closed.front().posture->active() - general.front().posture->active()).norm(), 1e-9);
}

TEST(SolveInverseAll, IsEmptyOutOfReach) {
  const Mechanism delta = published();
  EXPECT_TRUE(solve_inverse_all(delta, {.position = {0.0, 0.0, 0.5}}).empty());
  EXPECT_TRUE(solve_inverse_all(delta, {.position = {0.0, 0.0, 0.5}}, kGeneral).empty());
}

Mechanism six_joint_arm(std::mt19937_64& random, const Interval& range) {
  Description device;
  device.name = "arm";
  SerialDescription arm = test::random_arm(random, 6, false);
  for (SerialJointDescription& row : arm.joints) row.range = range;
  device.mechanism = arm;
  return Mechanism(device);
}

// Six joints in any order have no closed form: one posture within the ranges is as good as any.
TEST(SolveInverse, OfAnyArmOneWithinTheRangesIsTakenIfOneIsFound) {
  std::mt19937_64 random(19);
  int within = 0;
  for (int n = 0; n < 150; ++n) {
    const Mechanism arm = six_joint_arm(random, {-1.6, 1.6});
    ActiveVector q(6);
    for (double& one : q) one = test::arm_uniform(random, -1.5, 1.5);
    const Pose tool = solve_forward(arm, q).posture->tool();
    const Solution one = solve_inverse(arm, tool, kGeneral);
    bool some = false;
    for (const Solution& other : solve_inverse_all(arm, tool, kGeneral))
      some = some || other.status != SolveStatus::joint_limit;
    if (!some) continue;
    ASSERT_TRUE(one) << n;
    EXPECT_NE(one.status, SolveStatus::joint_limit) << n;
    EXPECT_LT((one.posture->tool().position - tool.position).norm(), 1e-9);
    EXPECT_LT(one.residual, 1e-10);
    ++within;
  }
  EXPECT_GT(within, 100);
}

TEST(SolveInverse, FollowsJointsBeyondHalfATurn) {
  std::mt19937_64 random(20);
  for (int n = 0; n < 100; ++n) {
    const Mechanism arm = six_joint_arm(random, {-7.0, 7.0});
    ActiveVector q(6);
    for (double& one : q) one = test::arm_uniform(random, -6.5, 6.5);
    const Solution start = solve_forward(arm, q);
    if (start.conditioning < 1e-2) continue;
    q.array() += 0.002;
    const Solution moved = solve_inverse(arm, solve_forward(arm, q).posture->tool(),
                                         {.start = &*start.posture, .closed_form = false});
    ASSERT_TRUE(moved);
    EXPECT_LT((moved.posture->active() - q).norm(), 1e-7) << n;
  }
}

}  // namespace
}  // namespace zwidth
