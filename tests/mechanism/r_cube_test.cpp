#include "zwidth/mechanism/r_cube.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <set>

#include "support/r_cubes.h"
#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
const Interval kAnyAngle{-kPi, kPi};
const RCubeGeometry kPublished = test::published_r_cube();

using Transform = Eigen::Isometry3d;

Transform turn(int axis, double angle) {
  return Transform(Eigen::AngleAxisd(angle, Vector3::Unit(axis - 1)));
}
Transform along(int axis, double length) {
  return Transform(Eigen::Translation3d(length * Vector3::Unit(axis - 1)));
}

// The chain of transforms from base to platform as the source has it (5.2, 5.5-5.9, 5.15-5.18), with the signs
// and constant rotations that make all three chains end in the same frame.
Transform chain(const RCubeGeometry& geometry, int leg, const RCubeSolution& at) {
  const std::array<Transform, 3> base = {along(1, geometry.base_offset) * turn(1, -kPi / 2) * turn(3, -kPi / 2),
                                         along(2, geometry.base_offset),
                                         along(3, geometry.base_offset) * turn(3, kPi / 2) * turn(1, kPi / 2)};
  const double q1 = at.theta[leg], q2 = at.swing[leg], q3 = at.elbow[leg];
  const Transform moving = turn(3, q1) * along(1, geometry.drive_link) * turn(3, -q1) * turn(1, -kPi / 2) *
                           turn(3, q2) * along(1, geometry.inner_link) * turn(3, q3) *
                           along(1, geometry.outer_link) * turn(3, -(q2 + q3));
  const Transform end = Transform((base[leg].linear() * turn(1, -kPi / 2).linear()).transpose());
  return base[leg] * moving * end;
}

void expect_closed(const RCubeGeometry& geometry, const RCubeSolution& at) {
  for (int leg = 0; leg < 3; ++leg) {
    const Transform end = chain(geometry, leg, at);
    EXPECT_LT((end.translation() - at.position).norm(), 1e-14) << "leg " << leg;
    EXPECT_LT((end.linear() - Matrix3::Identity()).norm(), 1e-14) << "leg " << leg;
  }
}

TEST(RCubeForward, EveryChainOfTransformsEndsInOneUnturnedFrame) {
  std::mt19937_64 random(1);
  int reached = 0;
  for (int k = 0; k < test::storm_size(5000); ++k) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const RCubeBranches branches = test::random_branches(random);
    const RCubeSolution at = r_cube_forward(geometry, test::random_angles(random, {-3.1, 3.1}), branches);
    if (!at.closed()) continue;
    ++reached;
    expect_closed(geometry, at);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(at.elbow[i] > 0.0, branches[i].elbow > 0);
      EXPECT_NEAR(at.lever[i], geometry.drive_link * std::cos(at.theta[i]), 1e-15);
    }
  }
  EXPECT_GT(reached, 200);
}

TEST(RCubeForward, PublishedWindowIsReachedEverywhere) {
  const int n = 21;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      for (int c = 0; c < n; ++c) {
        const Vector3 theta = (Vector3(a, b, c) * 2.0 / (n - 1) - Vector3::Ones()) * 32.5 * kDegree;
        ASSERT_EQ(r_cube_forward(kPublished, theta).status, SolveStatus::reached) << theta.transpose();
      }
    }
  }
}

TEST(RCubeInverse, ReturnsTheAnglesOfForward) {
  std::mt19937_64 random(2);
  int compared = 0;
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const Vector3 theta = test::random_angles(random, {-1.4, 1.4});
    const RCubeSolution forward = r_cube_forward(geometry, theta);
    if (forward.status != SolveStatus::reached) continue;
    if (RCubeState(geometry, forward).nearest_singularity().measure < 1e-2) continue;  // loses digits there
    const RCubeSolution inverse = r_cube_inverse(geometry, forward.position, kAnyAngle);
    ASSERT_EQ(inverse.status, SolveStatus::reached);
    EXPECT_LT((inverse.theta - theta).norm(), 1e-13);
    EXPECT_LT((inverse.swing - forward.swing).norm(), 1e-11);
    EXPECT_LT((inverse.elbow - forward.elbow).norm(), 1e-11);
    EXPECT_LT((inverse.lever - forward.lever).norm(), 1e-14);
    ++compared;
  }
  EXPECT_GT(compared, 2000);
}

TEST(RCubeInverse, BranchesAreSixtyFourPosturesOfOneTool) {
  const Vector3 position(0.125, 0.104, 0.131);
  std::set<std::array<long, 9>> different;
  for (int number = 0; number < kRCubeBranches; ++number) {
    const RCubeBranches branches = r_cube_branches(number);
    const RCubeSolution at = r_cube_inverse(kPublished, position, kAnyAngle, branches);
    if (!at.closed()) continue;  // a drive link that is turned over may be out of the arm's reach
    expect_closed(kPublished, at);
    std::array<long, 9> key;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(std::abs(at.theta[i]) > kPi / 2, branches[i].turned_over);
      EXPECT_EQ(at.elbow[i] > 0.0, branches[i].elbow > 0);
      key[3 * i] = std::lround(at.theta[i] * 1e9);
      key[3 * i + 1] = std::lround(at.swing[i] * 1e9);
      key[3 * i + 2] = std::lround(at.elbow[i] * 1e9);
    }
    different.insert(key);
  }
  EXPECT_EQ(different.size(), 8u);
  // Long outer links reach a drive link that is turned over, too.
  const RCubeGeometry roomy = {.drive_link = 0.1, .inner_link = 0.2, .outer_link = 0.25, .base_offset = 0.1};
  int reached = 0;
  for (int number = 0; number < kRCubeBranches; ++number) {
    const RCubeSolution at = r_cube_inverse(roomy, {0.11, 0.09, 0.12}, kAnyAngle, r_cube_branches(number));
    if (at.closed()) ++reached, expect_closed(roomy, at);
  }
  EXPECT_EQ(reached, kRCubeBranches);
}

TEST(RCubeInverse, BranchNumberZeroIsTheDevicesOwn) {
  for (const int elbow : {-1, 1}) {
    for (const RCubeBranch& branch : r_cube_branches(0, elbow)) {
      EXPECT_FALSE(branch.turned_over);
      EXPECT_EQ(branch.elbow, elbow);
    }
    for (const RCubeBranch& branch : r_cube_branches(63, elbow)) {
      EXPECT_TRUE(branch.turned_over);
      EXPECT_EQ(branch.elbow, -elbow);
    }
  }
}

TEST(RCubeInverse, HomeElbowsMirrorEachOther) {
  const Vector3 home = Vector3::Constant(kPublished.base_offset);
  const RCubeSolution down = r_cube_inverse(kPublished, home, kAnyAngle),
                      up = r_cube_inverse(kPublished, home, kAnyAngle, r_cube_branches(0, 1));
  ASSERT_EQ(down.status, SolveStatus::reached);
  EXPECT_LT(down.theta.norm(), 1e-15);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(down.elbow[i], -up.elbow[i], 1e-15);
    // The arm spans from (0, l1) to (S, S) with S = l1: both elbows lie on opposite sides of a line along e_b.
    EXPECT_NEAR(std::cos(down.swing[i]), -std::cos(up.swing[i]), 1e-14);
    EXPECT_NEAR(std::sin(down.swing[i]), std::sin(up.swing[i]), 1e-14);
  }
}

TEST(RCubeInverse, NamesTheJointAtFaultDriveBeforeArmBeforeLimit) {
  // e3 out of leg 3's drive, and also out of reach for the arms of the others.
  const RCubeSolution far = r_cube_inverse(kPublished, {0.11, 0.11, 0.3}, kAnyAngle);
  EXPECT_EQ(far.status, SolveStatus::unreachable);
  EXPECT_EQ(far.joint, 10);
  EXPECT_TRUE(far.drive_too_short());
  RCubeGeometry short_arm = kPublished;
  short_arm.outer_link = 0.03;
  const RCubeSolution arm = r_cube_inverse(short_arm, {0.11, 0.11, 0.11}, kAnyAngle);
  EXPECT_EQ(arm.status, SolveStatus::unreachable);
  EXPECT_EQ(arm.joint, 3);
  EXPECT_FALSE(arm.drive_too_short());
  const RCubeSolution limit = r_cube_inverse(kPublished, {0.112, 0.16, 0.112}, {-0.4, 0.4});
  EXPECT_EQ(limit.status, SolveStatus::joint_limit);
  EXPECT_EQ(limit.joint, 5);
  EXPECT_GT(limit.theta[1], 0.4);
  expect_closed(kPublished, limit);
}

TEST(RCubeInverse, BoundariesAreReachedAndDegraded) {
  // Drive link 2 along its axis, to the last bit.
  const RCubeGeometry roomy = {.drive_link = 0.1, .inner_link = 0.2, .outer_link = 0.25, .base_offset = 0.1};
  const RCubeSolution across = r_cube_inverse(roomy, {0.1, 0.2, 0.1}, kAnyAngle);
  EXPECT_EQ(across.status, SolveStatus::degraded);
  EXPECT_NEAR(across.theta[1], kPi / 2, 1e-7);
  // Arm 1 at home exactly stretched: span S along e_b.
  RCubeGeometry straight = kPublished;
  straight.inner_link = 0.05;
  straight.outer_link = kPublished.base_offset - 0.05;
  const RCubeSolution stretched = r_cube_inverse(straight, Vector3::Constant(straight.base_offset), kAnyAngle);
  EXPECT_EQ(stretched.status, SolveStatus::degraded);
  EXPECT_NEAR(stretched.elbow[0], 0.0, 1e-7);
  straight.outer_link -= 1e-9;
  EXPECT_EQ(r_cube_inverse(straight, Vector3::Constant(straight.base_offset), kAnyAngle).status,
            SolveStatus::unreachable);
}

TEST(RCubeInverse, EqualLinksFoldedOntoEachOtherLeaveTheSwingOpen) {
  const RCubeGeometry equal = {.drive_link = 0.1, .inner_link = 0.1, .outer_link = 0.1, .base_offset = 0.0};
  const RCubeSolution at = r_cube_forward(equal, {0.0, 0.0, kPi / 2});  // arm 1 spans from (0, l1) to (0, l1)
  EXPECT_EQ(at.status, SolveStatus::degenerate);
  EXPECT_EQ(at.joint, 2);
}

TEST(RCubeState, JacobiansAndTheirRatesEqualDifferences) {
  std::mt19937_64 random(3);
  const double h = 1e-5;
  for (int k = 0; k < 300; ++k) {
    const Vector3 theta = test::random_angles(random, {-0.56, 0.56}),
                  rate = test::random_angles(random, {-2.0, 2.0});
    const auto at = [&](const Vector3& q) { return RCubeState(kPublished, r_cube_forward(kPublished, q)); };
    const RCubeSolution here = r_cube_forward(kPublished, theta);
    const RCubeState state(kPublished, here);
    const Matrix3 rate_of_J = (at(theta + h * rate).jacobian() - at(theta - h * rate).jacobian()) / (2 * h);
    EXPECT_LT((state.jacobian_rate(rate) - rate_of_J).norm(), 1e-9);
    for (int leg = 0; leg < 3; ++leg) {
      // Differences of the transforms, joint by joint: the loops need not stay closed.
      Matrix3 J;
      for (int j = 0; j < 3; ++j) {
        RCubeSolution up = here, down = here;
        Vector3 RCubeSolution::*angle = j == 0   ? &RCubeSolution::theta
                                        : j == 1 ? &RCubeSolution::swing
                                                 : &RCubeSolution::elbow;
        (up.*angle)[leg] += h;
        (down.*angle)[leg] -= h;
        J.col(j) =
            (chain(kPublished, leg, up).translation() - chain(kPublished, leg, down).translation()) / (2 * h);
      }
      EXPECT_LT((state.leg_jacobian(leg) - J).norm(), 1e-9);
      EXPECT_NEAR(state.leg_determinant(leg), state.leg_jacobian(leg).determinant(), 1e-18);

      const Vector3 leg_rate = *state.leg_rates(leg, rate);
      const Matrix3 leg_J_rate =
          (at(theta + h * rate).leg_jacobian(leg) - at(theta - h * rate).leg_jacobian(leg)) / (2 * h);
      EXPECT_LT((state.leg_jacobian_rate(leg, leg_rate) - leg_J_rate).norm(), 1e-7);
      EXPECT_LT((state.leg_jacobian(leg) * leg_rate - state.velocity(rate)).norm(), 1e-14);
    }
  }
}

TEST(RCubeState, RatesAndAccelerationsAreThoseOfAMotion) {
  std::mt19937_64 random(4);
  const double h = 1e-4;
  for (int k = 0; k < 300; ++k) {
    const Vector3 theta = test::random_angles(random, {-0.5, 0.5}),
                  rate = test::random_angles(random, {-1.0, 1.0}),
                  acceleration = test::random_angles(random, {-1.0, 1.0});
    const auto at = [&](double t) {
      return r_cube_forward(kPublished, theta + t * rate + 0.5 * t * t * acceleration);
    };
    const RCubeSolution before = at(-h), here = at(0.0), after = at(h);
    const RCubeState state(kPublished, here);
    const auto first = [&](const Vector3& a, const Vector3& b) { return Vector3((b - a) / (2 * h)); };
    const auto second = [&](const Vector3& a, const Vector3& m, const Vector3& b) {
      return Vector3((a - 2.0 * m + b) / (h * h));
    };
    EXPECT_LT((state.velocity(rate) - first(before.position, after.position)).norm(), 1e-8);
    EXPECT_LT((state.acceleration(rate, acceleration) - second(before.position, here.position, after.position))
                  .norm(),
              1e-6);
    const Vector3 swing_rate = first(before.swing, after.swing), elbow_rate = first(before.elbow, after.elbow),
                  swing_acceleration = second(before.swing, here.swing, after.swing),
                  elbow_acceleration = second(before.elbow, here.elbow, after.elbow);
    for (int leg = 0; leg < 3; ++leg) {
      const Vector3 leg_rate = *state.leg_rates(leg, rate),
                    leg_acceleration = *state.leg_accelerations(leg, rate, acceleration);
      // h^2 times third and fourth derivatives of the passive angles, some tens near the window's corners.
      EXPECT_LT((leg_rate - Vector3(rate[leg], swing_rate[leg], elbow_rate[leg])).norm(), 2e-6);
      EXPECT_LT(
          (leg_acceleration - Vector3(acceleration[leg], swing_acceleration[leg], elbow_acceleration[leg]))
              .norm(),
          2e-4);
    }
  }
}

TEST(RCubeState, SingularitiesAreAsFarAsTheySay) {
  std::mt19937_64 random(5);
  int drives = 0, stretched = 0, folded = 0;
  for (int k = 0; k < 3000; ++k) {
    const RCubeGeometry geometry = test::random_r_cube(random);
    const RCubeSolution at = r_cube_forward(geometry, test::random_angles(random, {-1.3, 1.3}));
    if (at.status != SolveStatus::reached) continue;
    const RCubeState state(geometry, at);
    double least = 1.0;
    for (const RCubeSingularity& one : state.singularities()) {
      EXPECT_NEAR(one.direction.norm(), 1.0, 1e-14);
      EXPECT_GE(one.distance, 0.0);
      least = std::min(least, one.measure);
      using Kind = RCubeSingularity::Kind;
      (one.kind == Kind::drive_across ? drives : one.kind == Kind::arm_stretched ? stretched : folded) += 1;
      // Half the way is still regular; all of it is the boundary: a little more is beyond reach. The way there
      // may leave the reach of another leg, which is then at fault.
      const int joint = 5 * one.leg + (one.kind == Kind::drive_across ? 0 : 3);
      const auto moved = [&](double way) {
        return r_cube_inverse(geometry, at.position + way * one.direction, kAnyAngle);
      };
      const double margin = 1e-7 * geometry.total_length();
      EXPECT_NE(moved(one.distance - margin).joint, joint);
      const RCubeSolution beyond = moved(one.distance + margin);
      EXPECT_EQ(beyond.status, SolveStatus::unreachable);
      if (one.kind == Kind::drive_across) {
        EXPECT_EQ(beyond.joint, joint);
      }
      // The velocity that is lost: what moves the tool so takes rates that grow as 1/measure.
      const Matrix3 J = state.leg_jacobian(one.leg);
      EXPECT_GT((J.inverse() * one.direction).norm() * one.measure * geometry.total_length(), 0.1);
    }
    EXPECT_EQ(state.nearest_singularity().measure, least);
  }
  EXPECT_GT(drives, 500);
  EXPECT_GT(stretched, 100);
  EXPECT_GT(folded, 100);
}

TEST(RCubeState, RefusesRatesWhereTheyHaveNoBound) {
  RCubeGeometry straight = kPublished;
  straight.inner_link = 0.05;
  straight.outer_link = kPublished.base_offset - 0.05;
  const RCubeState stretched(straight, r_cube_forward(straight, Vector3::Zero()));
  EXPECT_TRUE(stretched.singular());
  EXPECT_FALSE(stretched.leg_rates(0, Vector3::Ones()));
  EXPECT_FALSE(stretched.leg_accelerations(0, Vector3::Ones(), Vector3::Ones()));
  EXPECT_EQ(stretched.nearest_singularity().kind, RCubeSingularity::Kind::arm_stretched);
  const RCubeState regular(kPublished, r_cube_forward(kPublished, Vector3::Zero()));
  EXPECT_FALSE(regular.singular());
  EXPECT_TRUE(regular.leg_rates(0, Vector3::Ones()));
}

TEST(RCubeGeometry, KnowsAnImpossibleLength) {
  EXPECT_TRUE(kPublished.valid());
  for (double RCubeGeometry::*length :
       {&RCubeGeometry::drive_link, &RCubeGeometry::inner_link, &RCubeGeometry::outer_link}) {
    for (const double bad : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
      RCubeGeometry geometry = kPublished;
      geometry.*length = bad;
      EXPECT_FALSE(geometry.valid());
    }
  }
  RCubeGeometry geometry = kPublished;
  geometry.base_offset = HUGE_VAL;
  EXPECT_FALSE(geometry.valid());
  geometry.base_offset = -0.02;
  EXPECT_TRUE(geometry.valid());
}

}  // namespace
}  // namespace zwidth
