#include <gtest/gtest.h>
#include <numbers>

#include "support/allocation_counter.h"
#include "support/r_cubes.h"
#include "support/storm.h"

#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mobility.h"
#include "zwidth/mechanism/posture.h"

// The R-CUBE as a mechanism of legs, beside its closed form.

namespace zwidth {
namespace {

const SolveOptions kGeneral{.closed_form = false};
const Interval kWindow{-0.5672, 0.5672};
const Interval kAnyAngle{-std::numbers::pi, std::numbers::pi};

Mechanism published() {
  return Mechanism(test::r_cube_device());
}

TEST(RCubeLegs, GeneralSolverAgreesWithTheClosedForm) {
  std::mt19937_64 random(21);
  const Mechanism r_cube = published();
  ASSERT_NE(r_cube.closed_form(), nullptr);
  double worst_position = 0.0, worst_joint = 0.0;
  Solution last = solve_forward(r_cube, ActiveVector(Vector3::Zero()), kGeneral);
  ASSERT_TRUE(last);
  for (int k = 0; k < test::storm_size(100000); ++k) {
    const Vector3 theta = test::random_angles(random, kWindow);
    const Solution general = solve_forward(r_cube, theta, {.start = &*last.posture, .closed_form = false});
    ASSERT_EQ(general.status, SolveStatus::reached) << theta.transpose();
    const Solution closed = solve_forward(r_cube, theta);
    worst_position =
        std::max(worst_position, (general.posture->tool().position - closed.posture->tool().position).norm());
    worst_joint = std::max(worst_joint, (general.posture->joints() - closed.posture->joints()).norm());
  }
  EXPECT_LT(worst_position, 1e-9);
  EXPECT_LT(worst_joint, 1e-9);
}

TEST(RCubeLegs, GeneralSolverAgreesOnRandomLengthsAndBothElbows) {
  std::mt19937_64 random(22);
  int compared = 0;
  for (int d = 0; d < 300; ++d) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const Interval range{test::uniform(random, -1.0, -0.1), test::uniform(random, 0.1, 1.0)};
    const int elbow = d % 2 == 0 ? -1 : 1;
    const Mechanism r_cube(test::r_cube_device(geometry, range, elbow));
    for (int k = 0; k < 20; ++k) {
      const Vector3 theta = test::random_angles(random, range);
      const Solution closed = solve_forward(r_cube, theta);
      if (!closed || closed.conditioning < 1e-2) continue;
      const RCubeSolution expected = r_cube_forward(geometry, theta, r_cube_branches(0, elbow));
      for (int leg = 0; leg < 3; ++leg) {
        EXPECT_LT((closed.posture->joints().segment<5>(5 * leg) - r_cube_leg_joints(expected, leg)).norm(),
                  1e-15);
      }
      EXPECT_LT(closed.residual, 1e-14);
      const Solution general = solve_forward(r_cube, theta, kGeneral);
      if (!general) continue;  // the way from home may leave the arms' reach
      EXPECT_LT((general.posture->tool().position - expected.position).norm(), 1e-9);
      // Where an arm passes through a straight line on the way, it may come out with the other elbow.
      if ((general.posture->joints() - closed.posture->joints()).norm() < 1e-8) ++compared;
    }
  }
  EXPECT_GT(compared, 2500);
}

TEST(RCubeLegs, InverseAgreesAndTakesTheDevicesOwnBranch) {
  std::mt19937_64 random(23);
  const Mechanism r_cube = published();
  for (int k = 0; k < test::storm_size(3000); ++k) {
    const Vector3 theta = test::random_angles(random, kWindow);
    const Pose tool = solve_forward(r_cube, theta).posture->tool();
    const Solution closed = solve_inverse(r_cube, tool), general = solve_inverse(r_cube, tool, kGeneral);
    ASSERT_EQ(closed.status, SolveStatus::reached);
    ASSERT_EQ(general.status, SolveStatus::reached);
    EXPECT_LT((closed.posture->active() - theta).norm(), 1e-13);
    EXPECT_LT((general.posture->joints() - closed.posture->joints()).norm(), 1e-9);
  }
}

TEST(RCubeLegs, EveryBranchIsAPostureAndTheGeneralSolverFindsThem) {
  const RCubeGeometry roomy = {.drive_link = 0.1, .inner_link = 0.2, .outer_link = 0.25, .base_offset = 0.1};
  const Mechanism r_cube(test::r_cube_device(roomy, kAnyAngle));
  const Pose tool{.position = {0.11, 0.09, 0.12}};
  const std::vector<Solution> closed = solve_inverse_all(r_cube, tool);
  ASSERT_EQ(closed.size(), 64u);
  for (const Solution& one : closed) {
    EXPECT_EQ(one.status, SolveStatus::reached);
    EXPECT_LT(one.residual, 1e-14);
    EXPECT_LT((one.posture->tool().position - tool.position).norm(), 1e-15);
  }
  const std::vector<Solution> general = solve_inverse_all(r_cube, tool, kGeneral);
  EXPECT_EQ(general.size(), 64u);
  for (const Solution& one : general) {
    const bool known = std::ranges::any_of(closed, [&](const Solution& other) {
      return (one.posture->active() - other.posture->active()).norm() < 1e-9 &&
             (one.posture->joint_point(3) - other.posture->joint_point(3)).norm() < 1e-9;
    });
    EXPECT_TRUE(known);
  }
}

TEST(RCubeLegs, RatesAndAccelerationsEqualTheClosedForm) {
  std::mt19937_64 random(24);
  for (int k = 0; k < 2000; ++k) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const Mechanism r_cube(test::r_cube_device(geometry, {-1.2, 1.2}));
    const Vector3 theta = test::random_angles(random, {-1.2, 1.2}),
                  rate = test::random_angles(random, {-2.0, 2.0});
    const Solution solution = solve_forward(r_cube, theta);
    if (!solution || solution.conditioning < 1e-2) continue;
    const RCubeState state(geometry, r_cube_forward(geometry, theta));
    if (state.nearest_singularity().measure < 1e-2) continue;
    const Rates all = rates(*solution.posture);
    EXPECT_LT((all.tool - state.jacobian()).norm(), 1e-12);
    const BiasAcceleration bias = bias_acceleration(*solution.posture, all, ActiveVector(rate));
    EXPECT_LT((bias.tool - state.jacobian_rate(rate) * rate).norm(), 1e-10);
    for (int leg = 0; leg < 3; ++leg) {
      const Vector3 q_rate = *state.leg_rates(leg, rate),
                    q_bias = *state.leg_accelerations(leg, rate, Vector3::Zero());
      const JointVector joint_rate = all.joints * rate;
      EXPECT_LT((joint_rate.segment<2>(5 * leg + 2) - q_rate.tail<2>()).norm(), 1e-9 * (1.0 + q_rate.norm()));
      EXPECT_NEAR(joint_rate[5 * leg + 1], -rate[leg], 1e-12);
      EXPECT_NEAR(joint_rate[5 * leg + 4], -q_rate[1] - q_rate[2], 1e-9 * (1.0 + q_rate.norm()));
      EXPECT_LT((bias.joints.segment<2>(5 * leg + 2) - q_bias.tail<2>()).norm(), 1e-8 * (1.0 + q_bias.norm()));
    }
  }
}

TEST(RCubeLegs, FaultsNameTheJoint) {
  const Mechanism r_cube = published();
  const Solution far = solve_inverse(r_cube, {.position = {0.11, 0.11, 0.3}});
  EXPECT_EQ(far.status, SolveStatus::unreachable);
  EXPECT_EQ(r_cube.joint_names()[far.joint], "leg3/theta3");
  const Solution limit = solve_inverse(r_cube, {.position = {0.1117, 0.1117 + 0.065, 0.1117}});
  EXPECT_EQ(limit.status, SolveStatus::joint_limit);
  EXPECT_EQ(r_cube.joint_names()[limit.joint], "leg2/theta2");
  RCubeGeometry short_arm = test::published_r_cube();
  short_arm.outer_link = 0.07;
  const Solution arm =
      solve_forward(Mechanism(test::r_cube_device(short_arm)), ActiveVector(Vector3::Constant(0.56)));
  EXPECT_EQ(arm.status, SolveStatus::unreachable);
  EXPECT_EQ(arm.joint, 3);
}

TEST(RCubeLegs, StretchedArmIsDegraded) {
  RCubeGeometry straight = test::published_r_cube();
  straight.inner_link = 0.05;
  straight.outer_link = straight.base_offset - 0.05;
  const Mechanism r_cube(test::r_cube_device(straight));
  const Solution at = solve_forward(r_cube, ActiveVector(Vector3::Zero()));
  EXPECT_EQ(at.status, SolveStatus::degraded);
}

TEST(RCubeLegs, LinksStandForThoseOfAllLegs) {
  Description by_link = test::r_cube_device(), by_leg = test::r_cube_device();
  const RCubeGeometry g = test::published_r_cube();
  Matrix3 inertia = test::thin_rod(0.03, 0.1, Vector3::UnitZ());
  inertia(0, 1) = inertia(1, 0) = 2e-6;
  const std::array<std::string, 3> links = {"drive_link", "inner_link", "outer_link"},
                                   joints = {"theta", "swing", "elbow"};
  const std::array<double, 3> roots = {0.0, g.drive_link, g.drive_link + g.inner_link};
  for (int link = 0; link < 3; ++link) {
    const Vector3 centre(0.002, -0.001, 0.04 + 0.01 * link);
    by_link.bodies.push_back(
        {.on = links[link], .mass = 0.03 + 0.01 * link, .centre = centre, .inertia = inertia});
    for (int leg = 0; leg < 3; ++leg) {
      const std::string number = std::to_string(leg + 1);
      BodyDescription body = by_link.bodies.back();
      body.on = "leg" + number + "/" + joints[link] + number;
      Matrix3 frame;  // columns e_a, e_b, e_c
      for (int step = 0; step < 3; ++step) frame.col(step) = Vector3::Unit((leg + step) % 3);
      body.centre = g.base_offset * frame.col(0) + roots[link] * frame.col(2) + frame * centre;
      body.inertia = frame * inertia * frame.transpose();
      by_leg.bodies.push_back(body);
    }
  }
  const Mechanism one(by_link), other(by_leg);
  ASSERT_EQ(one.bodies().size(), 9u);
  const Vector3 theta(0.3, -0.4, 0.1);
  const ActiveMatrix difference =
      mass_matrix(*solve_forward(one, theta).posture) - mass_matrix(*solve_forward(other, theta).posture);
  EXPECT_LT(difference.norm(), 1e-15);
  // Legs are images of each other under a cyclic exchange of the axes.
  const ActiveMatrix here = mass_matrix(*solve_forward(one, Vector3(0.3, -0.4, 0.1)).posture),
                     there = mass_matrix(*solve_forward(one, Vector3(0.1, 0.3, -0.4)).posture);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(here(i, j), there((i + 1) % 3, (j + 1) % 3), 1e-15);
  }
}

TEST(RCubeLegs, HasThreeFreedomsAndNoFourth) {
  const Mobility count = mobility(*solve_forward(published(), ActiveVector(Vector3(0.1, 0.2, -0.3))).posture);
  EXPECT_EQ(count.freedoms, 3);
  EXPECT_EQ(count.tool_freedoms, 3);
  // With a platform that may turn, the legs hold it upright and the count by Gruebler is right at once.
  Description free = spelled_out(test::r_cube_device());
  std::get<LegsDescription>(free.mechanism).platform = PlatformFreedom::rigid;
  const Mechanism turning(free);
  const Mobility six = mobility(*solve_forward(turning, ActiveVector(Vector3(0.1, 0.2, -0.3))).posture);
  EXPECT_EQ(six.gruebler, 3);
  EXPECT_EQ(six.freedoms, 3);
  EXPECT_EQ(six.redundant_equations, 0);
  const Solution solution = solve_forward(turning, ActiveVector(Vector3(0.4, 0.2, -0.3)));
  ASSERT_TRUE(solution);
  EXPECT_LT((solution.posture->tool().rotation - Matrix3::Identity()).norm(), 1e-11);
}

TEST(RCubeLegs, HomeClosesWhereverThereIsAPosture) {
  std::mt19937_64 random(25);
  int shifted = 0;
  for (int d = 0; d < 300; ++d) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const double middle = test::uniform(random, -1.0, 1.0);
    const Interval range{middle - 0.4, middle + 0.4};
    bool reachable = false;
    for (int k = 0; k < 200 && !reachable; ++k) {
      reachable = r_cube_forward(geometry, test::random_angles(random, range)).status == SolveStatus::reached;
    }
    if (!reachable) continue;
    const LegsDescription legs = legs_of(test::described(geometry, range));
    Vector3 theta;
    for (int i = 0; i < 3; ++i) theta[i] = legs.legs[i].joints[0].home;
    const RCubeSolution home = r_cube_forward(geometry, theta);
    EXPECT_TRUE(home.closed()) << d;
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(range.contains(theta[i]));
      for (int j = 0; j < 5; ++j) {
        EXPECT_NEAR(legs.legs[i].joints[j].home, r_cube_leg_joints(home, i)[j], 1e-15);
      }
    }
    if (theta != Vector3::Constant(middle)) ++shifted;
  }
  EXPECT_GT(shifted, 10);
}

TEST(RCubeLegs, ACycleDoesNotAllocate) {
  const Mechanism r_cube = published();
  const Posture start = *solve_forward(r_cube, ActiveVector(Vector3(0.1, 0.1, 0.1))).posture;
  for (const bool closed_form : {true, false}) {
    const long before = test::allocations();
    const SolveOptions options{.start = &start, .closed_form = closed_form};
    const Solution forward = solve_forward(r_cube, ActiveVector(Vector3(0.11, 0.09, 0.12)), options);
    const Solution inverse = solve_inverse(r_cube, forward.posture->tool(), options);
    const Rates all = rates(*inverse.posture);
    EXPECT_TRUE(all.tool.allFinite());
    EXPECT_EQ(test::allocations(), before);
  }
}

}  // namespace
}  // namespace zwidth
