#include <Eigen/SVD>
#include <algorithm>
#include <gtest/gtest.h>

#include "support/allocation_counter.h"
#include "support/arms.h"
#include "support/storm.h"

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

// The inverse of serial arms, in closed form and by iteration, and what is done with a joint to spare.

namespace zwidth {
namespace {

using test::arm_uniform;
constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

Mechanism mechanism_of(const MechanismDescription& mechanism) {
  Description description;
  description.name = "arm";
  description.mechanism = mechanism;
  return Mechanism(description);
}

ActiveVector within_ranges(std::mt19937_64& random, const Mechanism& mechanism) {
  ActiveVector q(mechanism.active_count());
  for (int j = 0; j < q.size(); ++j) {
    const Interval range = mechanism.active_range(j);
    q[j] = arm_uniform(random, std::max(range.min, -kPi), std::min(range.max, kPi));
  }
  return q;
}

double gap(const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).cwiseAbs().maxCoeff(),
                  (a.rotation - b.rotation).cwiseAbs().maxCoeff());
}

// Redundant, without a closed form: an offset at the elbow, as the arms of many cobots have it.
SerialDescription offset_arm() {
  SerialDescription arm = test::seven_dof(0.316, 0.384);
  arm.joints[2].a = 0.0825;
  arm.joints[3].a = -0.0825;
  for (SerialJointDescription& row : arm.joints) row.range = {-2.9, 2.9};
  arm.joints[3].range = {0.1, 3.0};
  for (const auto& [i, home] : {std::pair(1, 0.4), {3, 1.2}, {4, 0.3}, {5, 1.3}, {6, 0.2}})
    arm.joints[i].home = home;
  return arm;
}

TEST(ArmForward, ClosedFormAndLegsAgree) {
  std::mt19937_64 random(1);
  for (const SerialDescription& arm : {test::seven_dof(), test::seven_dof_locked(0.4), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    double worst = 0.0;
    for (int n = 0; n < test::storm_size(100000) / 3; ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Solution closed = solve_forward(mechanism, q),
                     general = solve_forward(mechanism, q, {.closed_form = false});
      ASSERT_TRUE(closed && general);
      worst = std::max(worst, gap(closed.posture->tool(), general.posture->tool()));
      if (n % 50 == 0) {
        EXPECT_LT((jacobian(*closed.posture) - mechanism.serial()->forward(q).jacobian).cwiseAbs().maxCoeff(),
                  1e-14);
      }
    }
    EXPECT_LT(worst, 1e-11);  // the general solver closes to 1e-12 of the arm's size
  }
}

// The six-joint arm: eight postures or fewer, the one it came from among them, found by both solvers.
TEST(ArmInverse, TheLockedArmHasEveryBranch) {
  std::mt19937_64 random(2);
  for (const double theta3 : {0.0, 0.7, -2.0}) {
    SerialDescription arm = test::seven_dof_locked(theta3);
    for (SerialJointDescription& row : arm.joints) row.range = {-kPi, kPi};
    const Mechanism mechanism = mechanism_of(arm);
    ASSERT_EQ(mechanism.closed_form()->branch_count(), 8);
    for (int n = 0; n < test::storm_size(300); ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      if (std::abs(std::sin(q[2])) < 0.05 || std::abs(std::sin(q[4])) < 0.05) continue;
      const Pose tool = mechanism.serial()->pose(q);
      const std::vector<Solution> all = solve_inverse_all(mechanism, tool);
      ASSERT_EQ(all.size(), 8u);
      double nearest = 10.0;
      for (const Solution& one : all) {
        EXPECT_LT(gap(mechanism.serial()->pose(one.posture->active()), tool), 1e-12);
        nearest = std::min(nearest, (one.posture->active() - q).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(nearest, 1e-9);
      if (n % 20 != 0) continue;
      const Posture start = *solve_forward(mechanism, q).posture;
      const Solution general = solve_inverse(mechanism, tool, {.start = &start, .closed_form = false});
      ASSERT_TRUE(general);
      EXPECT_LT((general.posture->active() - q).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

// Arms of the form with any lengths, over many postures: of six joints the general solver of legs, led from a
// posture beside it, comes back to the posture that the closed form has among its own; of seven so does the
// iteration with the joint kept.
TEST(ArmInverse, ClosedFormAndGeneralSolverAgree) {
  std::mt19937_64 random(12);
  const int count = test::storm_size(100000);
  double worst_closed = 0.0, worst_general = 0.0;
  int solved = 0;
  for (int n = 0; n < count;) {
    const bool locked = n % 2000 < 1000;
    SerialDescription arm = test::seven_dof(arm_uniform(random, 0.1, 0.5), arm_uniform(random, 0.1, 0.5));
    if (locked) {
      arm.joints[2].type = SerialJointType::fixed;
      arm.joints[2].theta = arm_uniform(random, -3.0, 3.0);
    }
    for (SerialJointDescription& row : arm.joints) row.range = {-kPi, kPi};
    const Mechanism mechanism = mechanism_of(arm);
    for (int k = 0; k < 1000; ++k, ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Solution here = solve_forward(mechanism, q);
      const int kept = n % 3;
      Eigen::MatrixXd J = jacobian(*here.posture);
      J.topRows(3) /= mechanism.characteristic_length();
      if (!locked) J.col(kept).setZero();
      const double smallest = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues()[5];
      if (smallest < 0.05) continue;  // beside a singularity another posture is near
      ActiveVector beside = q;
      for (double& one : beside) one = std::clamp(one + arm_uniform(random, -0.005, 0.005), -kPi, kPi);
      if (!locked) beside[kept] = q[kept];
      const Posture start = *solve_forward(mechanism, beside).posture;
      SolveOptions options{.start = &start};
      options.redundancy = {.rule = Redundancy::Rule::keep, .joint = kept, .value = q[kept]};
      const Solution closed = solve_inverse(mechanism, here.posture->tool(), options);
      options.closed_form = false;
      const Solution general = solve_inverse(mechanism, here.posture->tool(), options);
      ASSERT_TRUE(closed && general);
      worst_closed = std::max(worst_closed, gap(closed.posture->tool(), here.posture->tool()));
      EXPECT_LT(closed.residual, 1e-12);
      // The general solver meets the tool to 1e-12, and so the joints to that over the smallest singular value.
      for (int j = 0; j < q.size(); ++j) {  // an angle of half a turn has two readings
        const double apart = closed.posture->active()[j] - general.posture->active()[j];
        worst_general = std::max(worst_general, std::abs(std::remainder(apart, 2.0 * kPi)));
      }
      ++solved;
    }
  }
  EXPECT_LT(worst_general, 1e-10);
  EXPECT_LT(worst_closed, 1e-12);
  EXPECT_GT(solved, count / 2);
}

// Six joints that are no shoulder and wrist: the general solver of legs finds the pose from home, and among all
// of its postures the one that the pose was taken from.
TEST(ArmInverse, AnySixJointsAreSolved) {
  std::mt19937_64 random(13);
  int asked = 0, found = 0, listed = 0;
  for (int n = 0; n < 12; ++n) {
    SerialDescription arm = test::random_arm(random, 6, n % 2 == 0);
    for (SerialJointDescription& row : arm.joints) {
      if (row.type == SerialJointType::revolute) row.range = {-kPi, kPi};
    }
    const Mechanism mechanism = mechanism_of(arm);
    for (int k = 0; k < 4; ++k) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Solution here = solve_forward(mechanism, q);
      if (here.conditioning < 0.01) continue;
      ++asked;
      const Solution one = solve_inverse(mechanism, here.posture->tool());
      if (one) {
        ++found;
        EXPECT_LT(gap(mechanism.serial()->pose(one.posture->active()), here.posture->tool()), 1e-11);
      }
      for (const Solution& solution : solve_inverse_all(mechanism, here.posture->tool())) {
        double apart = 0.0;
        for (int j = 0; j < 6; ++j) {
          const double way = solution.posture->active()[j] - q[j];
          const bool slides = mechanism.joints()[j].type == JointType::prismatic;
          apart = std::max(apart, std::abs(slides ? way : std::remainder(way, 2.0 * kPi)));
        }
        if (apart < 1e-6) {
          ++listed;
          break;
        }
      }
    }
  }
  EXPECT_GT(asked, 10);
  EXPECT_EQ(found, asked);
  EXPECT_GT(listed, asked * 9 / 10);
}

// An S-R-S arm set up in any way: other base, other zeros, axes the other way round, another tool.
LegsDescription disguised(std::mt19937_64& random, const SerialDescription& arm) {
  LegsDescription legs = legs_of(arm);
  LegDescription& leg = legs.legs.front();
  // New zeros: the axes and points where another posture has them.
  ActiveVector zero(static_cast<Eigen::Index>(leg.joints.size()));
  for (double& z : zero) z = arm_uniform(random, -3.0, 3.0);
  const Mechanism mechanism = mechanism_of(arm);
  const Posture posture = *solve_forward(mechanism, zero).posture;
  const Matrix3 R = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
  const Vector3 shift(arm_uniform(random, -1.0, 1.0), 0.3, -0.2);
  for (std::size_t j = 0; j < leg.joints.size(); ++j) {
    const double sign = arm_uniform(random, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    leg.joints[j].axis = sign * (R * posture.joint_axis(static_cast<int>(j)));
    leg.joints[j].point = R * posture.joint_point(static_cast<int>(j)) + shift +
                          arm_uniform(random, -0.3, 0.3) * leg.joints[j].axis;
    leg.joints[j].range = {-kPi, kPi};
    leg.joints[j].home = 0.0;
  }
  leg.tip = R * posture.tool().position + shift + Vector3(0.03, -0.02, 0.05);
  leg.platform_rotation = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
  leg.platform_point = Vector3(0.01, 0.02, -0.03);
  return legs;
}

TEST(ArmInverse, TheFormIsRecognisedInAnyDisguise) {
  std::mt19937_64 random(3);
  std::srand(3);  // what Eigen draws its rotations from
  for (int n = 0; n < test::storm_size(60); ++n) {
    const SerialDescription arm =
        n % 3 == 0 ? test::seven_dof_locked(arm_uniform(random, -3.0, 3.0))
                   : test::seven_dof(arm_uniform(random, 0.1, 0.5), arm_uniform(random, 0.1, 0.5));
    const Mechanism mechanism = mechanism_of(disguised(random, arm));
    ASSERT_NE(mechanism.closed_form(), nullptr);
    ASSERT_EQ(mechanism.closed_form()->branch_count(), 8) << n;
    for (int k = 0; k < 3; ++k) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Pose tool = mechanism.serial()->pose(q);
      const Posture start = *solve_forward(mechanism, q).posture;
      for (const int keep : {0, 1, 2}) {
        SolveOptions options{.start = &start};
        options.redundancy = {.rule = Redundancy::Rule::keep, .joint = keep};
        const Solution solution = solve_inverse(mechanism, tool, options);
        if (!solution) continue;  // beside a singularity
        EXPECT_LT(gap(mechanism.serial()->pose(solution.posture->active()), tool), 1e-11);
        EXPECT_LT((solution.posture->active() - q).cwiseAbs().maxCoeff(), 1e-6);
      }
    }
  }
}

TEST(ArmInverse, OtherArmsAreNotTakenForIt) {
  EXPECT_EQ(mechanism_of(offset_arm()).closed_form()->branch_count(), 0);
  SerialDescription arm = test::seven_dof();
  arm.joints[5].d = 0.01;  // axis 7 misses the wrist
  EXPECT_EQ(mechanism_of(arm).closed_form()->branch_count(), 0);
  arm = test::seven_dof();
  arm.joints[1].alpha = 1.5;  // axes 2 and 3 not at right angles
  EXPECT_EQ(mechanism_of(arm).closed_form()->branch_count(), 0);
  arm = test::seven_dof();
  arm.joints[6].d = 0.1;  // a tool beyond the wrist is no matter
  EXPECT_EQ(mechanism_of(arm).closed_form()->branch_count(), 8);
  arm.joints[3].type = SerialJointType::prismatic;
  EXPECT_EQ(mechanism_of(arm).closed_form()->branch_count(), 0);
}

// ------------------------------------------------------------------------------------------ a joint to spare

SolveOptions with(const Posture* start, const Redundancy& redundancy, bool closed_form = true) {
  SolveOptions options{.start = start, .closed_form = closed_form};
  options.redundancy = redundancy;
  return options;
}

TEST(Redundancy, KeepsTheJointThatIsNamed) {
  std::mt19937_64 random(4);
  for (const SerialDescription& arm : {test::seven_dof(), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    int solved = 0, asked = 0;
    for (int n = 0; n < test::storm_size(10); ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Pose tool = mechanism.serial()->pose(q);
      for (const int joint : {0, 1, 2, 4, 5, 6}) {
        for (const bool closed_form : {true, false}) {
          ++asked;
          const Solution solution = solve_inverse(
              mechanism, tool,
              with(nullptr, {.rule = Redundancy::Rule::keep, .joint = joint, .value = q[joint]}, closed_form));
          if (!solution) continue;
          ++solved;
          const ActiveVector found = solution.posture->active();
          EXPECT_LT(gap(mechanism.serial()->pose(found), tool), 1e-11);
          EXPECT_NEAR(std::remainder(found[joint] - q[joint], 2.0 * kPi), 0.0, 1e-9);
        }
      }
    }
    EXPECT_GT(solved, asked * 98 / 100);
  }
}

// Stretched or folded the arm leaves theta3 and theta5 open together: either may be kept.
TEST(Redundancy, KeepsAJointOfASingularElbow) {
  SerialDescription arm = test::seven_dof();
  for (SerialJointDescription& row : arm.joints) row.range = {-kPi, kPi};
  const Mechanism mechanism = mechanism_of(arm);
  const auto turned = [](double a, double b, double c) {
    return (Eigen::AngleAxisd(a, Vector3::UnitZ()) * Eigen::AngleAxisd(b, Vector3::UnitY()) *
            Eigen::AngleAxisd(c, Vector3::UnitX()))
        .toRotationMatrix();
  };
  for (const Vector3& position : {Vector3(0.5, 0.0, 0.0), Vector3(0.0, 0.3, -0.4), Vector3(0.0, 0.0, 0.0)}) {
    const Pose tool{.position = position, .rotation = turned(0.3, -0.4, 0.7)};
    for (const int joint : {2, 4}) {
      const double value = joint == 2 ? -0.3 : 0.8;
      const Redundancy keep{.rule = Redundancy::Rule::keep, .joint = joint, .value = value};
      const std::vector<Solution> all = solve_inverse_all(mechanism, tool, with(nullptr, keep));
      EXPECT_EQ(all.size(), 8u);
      for (const Solution& one : all) {
        EXPECT_EQ(one.status, SolveStatus::degraded);
        EXPECT_LT(gap(mechanism.serial()->pose(one.posture->active()), tool), 1e-12);
        EXPECT_NEAR(std::remainder(one.posture->active()[joint] - value, 2.0 * kPi), 0.0, 1e-12);
      }
    }
  }
}

// Nearest: a small move of the goal makes a small move of the joints, across which nothing along the
// self-motion is nearer (its gradient along the null space of J vanishes); both solvers agree.
TEST(Redundancy, NearestIsNearest) {
  std::mt19937_64 random(5);
  for (const SerialDescription& arm : {test::seven_dof(), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    for (int n = 0; n < test::storm_size(200); ++n) {
      ActiveVector q = within_ranges(random, mechanism);
      for (int j = 0; j < 7; ++j) {  // in the middle of the ranges, away from singularities
        const Interval range = mechanism.active_range(j);
        q[j] = range.middle() + 0.5 * (std::clamp(q[j], range.min, range.max) - range.middle());
      }
      if (std::abs(std::sin(q[5])) < 0.2) continue;
      const Posture start = *solve_forward(mechanism, q).posture;
      Pose tool = start.tool();
      tool.position += Vector3(0.01, -0.006, 0.004);
      tool.rotation = Eigen::AngleAxisd(0.02, Vector3(0.6, 0.0, 0.8)) * tool.rotation;
      const Solution closed = solve_inverse(mechanism, tool, {.start = &start});
      const Solution general = solve_inverse(mechanism, tool, {.start = &start, .closed_form = false});
      ASSERT_TRUE(closed && general);
      if (closed.status == SolveStatus::joint_limit) continue;
      const ActiveVector found = closed.posture->active();
      EXPECT_LT(gap(mechanism.serial()->pose(found), tool), 1e-11);
      // Comparing squared distances finds where the least is to 2 sqrt(epsilon) of the distance, in units of
      // how fast the joints move along the self-motion.
      const double distance = (found - q).norm();
      EXPECT_LT((found - general.posture->active()).norm(), 1e-6 * (1.0 + distance));
      const Eigen::MatrixXd J = jacobian(*closed.posture);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeFullV);
      if (svd.singularValues()[5] < 0.02) continue;
      EXPECT_NEAR(svd.matrixV().col(6).dot(Eigen::VectorXd(found - q)), 0.0, 1e-7 * (1.0 + distance));
    }
  }
}

TEST(Redundancy, APostureThatReachesTheGoalIsItsOwnNearest) {
  std::mt19937_64 random(6);
  const Mechanism mechanism = mechanism_of(test::seven_dof());
  for (int n = 0; n < test::storm_size(300); ++n) {
    const ActiveVector q = within_ranges(random, mechanism);
    const Posture start = *solve_forward(mechanism, q).posture;
    const Solution solution = solve_inverse(mechanism, start.tool(), {.start = &start});
    ASSERT_TRUE(solution);
    EXPECT_LT((solution.posture->active() - q).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// What maximises a figure is not beaten by any of many elbows, and the general solver finds no better one
// either.
TEST(Redundancy, MaximisesTheFigure) {
  std::mt19937_64 random(7);
  const Mechanism mechanism = mechanism_of(test::seven_dof());
  std::vector<Interval> ranges;
  for (int j = 0; j < 7; ++j) ranges.push_back(mechanism.active_range(j));
  for (const auto which : {RedundancyFigure::manipulability, RedundancyFigure::inverse_condition,
                           RedundancyFigure::limit_distance}) {
    const Redundancy choice{.rule = Redundancy::Rule::maximise, .figure = which};
    const auto figure = [&](const ActiveVector& q) {
      return redundancy_figure(which, Match::pose, mechanism.serial()->forward(q).jacobian, q, ranges, 0.25);
    };
    for (int n = 0; n < 6; ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      const Pose tool = mechanism.serial()->pose(q);
      const Solution best = solve_inverse(mechanism, tool, with(nullptr, choice));
      ASSERT_TRUE(best);
      ASSERT_NE(best.status, SolveStatus::joint_limit);
      const double value = figure(best.posture->active());
      for (int k = -40; k <= 40; ++k) {
        const Redundancy keep{.rule = Redundancy::Rule::keep, .joint = 2, .value = k * 1.5 * kDegree};
        for (const Solution& other : solve_inverse_all(mechanism, tool, with(nullptr, keep))) {
          if (other.status == SolveStatus::joint_limit) continue;
          EXPECT_LT(figure(other.posture->active()), value + 1e-8);  // elbows are found to 1e-9 rad
        }
      }
      const Posture start = *solve_forward(mechanism, q).posture;
      const Solution climbed = solve_inverse(mechanism, tool, with(&start, choice, false));
      ASSERT_TRUE(climbed);
      EXPECT_LT(figure(climbed.posture->active()), value + 1e-9);
      EXPECT_GT(figure(climbed.posture->active()), figure(q) - 1e-9);
    }
  }
}

TEST(Redundancy, StaysWithinTheRangesWhereItCan) {
  std::mt19937_64 random(8);
  for (const SerialDescription& arm : {test::seven_dof(), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    int within = 0, count = 0;
    for (int n = 0; n < test::storm_size(100); ++n) {
      const Pose tool = mechanism.serial()->pose(within_ranges(random, mechanism));
      for (const bool closed_form : {true, false}) {
        ++count;
        const Solution solution = solve_inverse(mechanism, tool, {.closed_form = closed_form});
        ASSERT_TRUE(solution);
        if (solution.status != SolveStatus::joint_limit) ++within;
      }
    }
    EXPECT_GT(within, count * 95 / 100);
  }
}

TEST(Redundancy, EightJointsLeaveTwoFreedoms) {
  std::mt19937_64 random(9);
  SerialDescription arm = offset_arm();
  SerialJointDescription slide;
  slide.name = "slide";
  slide.type = SerialJointType::prismatic;
  slide.range = {-0.4, 0.4};
  slide.alpha = 0.5 * kPi;
  arm.joints.insert(arm.joints.begin(), slide);
  const Mechanism mechanism = mechanism_of(arm);
  for (int n = 0; n < 30; ++n) {
    ActiveVector q = within_ranges(random, mechanism);
    const Posture start = *solve_forward(mechanism, q).posture;
    const Pose tool = start.tool();
    const Solution kept = solve_inverse(
        mechanism, tool, with(&start, {.rule = Redundancy::Rule::keep, .joint = 0, .value = q[0] * 0.9}));
    if (!kept) continue;
    EXPECT_NEAR(kept.posture->active()[0], q[0] * 0.9, 1e-12);
    EXPECT_LT(gap(mechanism.serial()->pose(kept.posture->active()), tool), 1e-11);
  }
}

// ------------------------------------------------------------------------------------------- position alone

TEST(PositionGoal, IsMetByEveryArm) {
  std::mt19937_64 random(10);
  SerialDescription with_tool = test::seven_dof();
  with_tool.joints[6].d = 0.12;
  SerialDescription three;  // as many joints as the position has coordinates
  for (int i = 0; i < 3; ++i) {
    three.joints.push_back({.name = std::string(1, static_cast<char>('a' + i)),
                            .a = i == 0 ? 0.0 : 0.3,
                            .alpha = i == 0 ? 0.5 * kPi : 0.0,
                            .range = {-2.0, 2.0},
                            .home = 0.5});
  }
  for (const SerialDescription& arm :
       {test::seven_dof(), test::seven_dof_locked(), with_tool, offset_arm(), three}) {
    const Mechanism mechanism = mechanism_of(arm);
    for (int n = 0; n < test::storm_size(60); ++n) {
      const ActiveVector q = within_ranges(random, mechanism);
      Pose goal;
      goal.position = mechanism.serial()->pose(q).position;
      for (const bool closed_form : {true, false}) {
        SolveOptions options{.closed_form = closed_form};
        options.match = Match::position;
        const Solution solution = solve_inverse(mechanism, goal, options);
        ASSERT_TRUE(solution) << arm.joints.size() << ' ' << closed_form;
        EXPECT_LT((solution.posture->tool().position - goal.position).norm(), 1e-11);
        EXPECT_LT(gap(mechanism.serial()->pose(solution.posture->active()), solution.posture->tool()), 1e-12);
      }
    }
  }
}

TEST(PositionGoal, KeepsTheWristAndTheJointThatIsNamed) {
  const Mechanism mechanism = mechanism_of(test::seven_dof());
  Pose goal;
  goal.position = {0.3, 0.1, 0.05};
  for (const bool closed_form : {true, false}) {
    SolveOptions options =
        with(nullptr, {.rule = Redundancy::Rule::keep, .joint = 2, .value = 10.0 * kDegree}, closed_form);
    options.match = Match::position;
    const Solution solution = solve_inverse(mechanism, goal, options);
    ASSERT_TRUE(solution);
    const ActiveVector q = solution.posture->active();
    EXPECT_NEAR(q[2], 10.0 * kDegree, 1e-9);
    for (int j = 4; j < 7; ++j) EXPECT_NEAR(q[j], 90.0 * kDegree, 1e-6);
    EXPECT_EQ(solution.status, SolveStatus::reached);
  }
}

TEST(PositionGoal, OutOfReachIsSaid) {
  for (const SerialDescription& arm : {test::seven_dof(), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    SolveOptions options;
    options.match = Match::position;
    Pose goal;
    goal.position = {1.0, 0.2, 0.1};
    EXPECT_EQ(solve_inverse(mechanism, goal, options).status, SolveStatus::unreachable);
    EXPECT_TRUE(solve_inverse_all(mechanism, goal, options).empty());
    options.match = Match::pose;
    EXPECT_EQ(solve_inverse(mechanism, goal, options).status, SolveStatus::unreachable);
  }
}

TEST(ArmInverse, DoesNotAllocate) {
  for (const SerialDescription& arm : {test::seven_dof(), test::seven_dof_locked(), offset_arm()}) {
    const Mechanism mechanism = mechanism_of(arm);
    const ActiveVector home = mechanism.home_guess();
    const Posture start = *solve_forward(mechanism, home).posture;
    Pose tool = start.tool();
    tool.position.x() += 0.002;
    const long before = test::allocations();
    for (const bool closed_form : {true, false}) {
      const Solution solution = solve_inverse(mechanism, tool, {.start = &start, .closed_form = closed_form});
      EXPECT_TRUE(solution);
      EXPECT_GT(rates(*solution.posture).tool.norm(), 0.0);
    }
    EXPECT_EQ(test::allocations(), before);
  }
}

}  // namespace
}  // namespace zwidth
