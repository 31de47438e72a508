#include "zwidth/analysis/force.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"

#include "zwidth/analysis/resolution.h"
#include "zwidth/mechanism/figure.h"

namespace zwidth {
namespace {

using test::uniform;

Matrix3 random_jacobian(std::mt19937_64& random) {
  for (;;) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaForward forward =
        delta_forward(delta_geometry(delta), test::random_angles(random, delta.joint_range));
    if (forward.status == SolveStatus::reached) return forward.jacobian;
  }
}

ActiveVector random_limits(std::mt19937_64& random) {
  return Vector3(uniform(random, 0.2, 2.0), uniform(random, 0.2, 2.0), uniform(random, 0.2, 2.0));
}

Vector3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

TEST(ForcePolytope, EveryVertexSaturatesEveryTorque) {
  std::mt19937_64 random(41);
  for (int n = 0; n < 200; ++n) {
    const Jacobian J = random_jacobian(random);
    const ActiveVector limit = random_limits(random);
    const ForcePolytope polytope = force_polytope(J, limit);
    ASSERT_EQ(polytope.vertices.size(), 8u);
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const ActiveVector torque = torques_for_load(J, polytope.vertices[corner]);
      for (int j = 0; j < 3; ++j) {
        const double sign = (corner >> j & 1) != 0 ? 1.0 : -1.0;
        EXPECT_NEAR(torque[j], sign * limit[j], 1e-10);
      }
    }
  }
}

TEST(ForcePolytope, SupportAndReachOfEveryDirectionAgreeWithTheInequalities) {
  std::mt19937_64 random(42);
  for (int n = 0; n < 100; ++n) {
    const Jacobian J = random_jacobian(random);
    const ActiveVector limit = random_limits(random);
    const ForcePolytope polytope = force_polytope(J, limit);
    for (int m = 0; m < 50; ++m) {
      const ToolVector u = random_direction(random);
      // Support by the vertices; by duality it is sum_j limit_j |J^-1 u|_j.
      double support = 0.0;
      for (const ToolVector& vertex : polytope.vertices) support = std::max(support, vertex.dot(u));
      const Vector3 dual = Matrix3(J).inverse() * Vector3(u);
      EXPECT_NEAR(support, dual.cwiseAbs().dot(Vector3(limit)), 1e-9 * support);
      // The largest force along u lies on the boundary, between the weakest and the strongest force.
      const double along = force_limit_along(J, limit, 3.0 * u);
      const ActiveVector load = torques_for_load(J, along * u).cwiseAbs().cwiseQuotient(limit);
      EXPECT_NEAR(load.maxCoeff(), 1.0, 1e-12);
      EXPECT_GE(along, polytope.weakest * (1.0 - 1e-12));
      EXPECT_LE(along, polytope.strongest * (1.0 + 1e-12));
    }
    EXPECT_NEAR(force_limit_along(J, limit, polytope.weakest_direction), polytope.weakest, 1e-9);
    EXPECT_NEAR(force_limit_along(J, limit, polytope.strongest_direction) / polytope.strongest, 1.0, 1e-9);
    EXPECT_NEAR(polytope.volume * std::abs(Matrix3(J).determinant()), 8.0 * limit.prod(), 1e-12);
  }
}

TEST(AxisForce, IsTheLargestPureForceOfTheSource) {
  // F_k = tau_max / max_j |J_kj|, Neal 2015, table 3.2.
  std::mt19937_64 random(43);
  for (int n = 0; n < 100; ++n) {
    const Matrix3 J = random_jacobian(random);
    const ToolVector limits = axis_force_limits(Jacobian(J), ActiveVector(Vector3::Constant(1.359)));
    const Vector3 fixed = axis_force_limits(J, Vector3(1.359, 1.359, 1.359));
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(limits[k], 1.359 / J.row(k).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_NEAR(limits[k], fixed[k], 1e-12);
    }
  }
}

TEST(ForcePolytope, FiguresOfTheMapsAgree) {
  std::mt19937_64 random(44);
  for (int n = 0; n < 100; ++n) {
    const Matrix3 J = random_jacobian(random);
    const DriveLimits limits{.torque = Vector3(random_limits(random)), .step = Vector3(1e-4, 2e-4, 3e-4)};
    const FigureValues values = jacobian_figures(J, limits);
    const ForcePolytope polytope = force_polytope(J, ActiveVector(limits.torque));
    EXPECT_NEAR(figure(values, Figure::weakest_force) / polytope.weakest, 1.0, 1e-12);
    EXPECT_NEAR(figure(values, Figure::strongest_force) / polytope.strongest, 1.0, 1e-10);
    const ToolVector axes = axis_force_limits(Jacobian(J), ActiveVector(limits.torque));
    const ToolVector steps = tool_resolution(J, ActiveVector(limits.step));
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(values[2 + k] / axes[k], 1.0, 1e-13);
      EXPECT_NEAR(values[7 + k] / steps[k], 1.0, 1e-13);
    }
  }
}

TEST(ForcePolytope, IsUnboundedAtASingularity) {
  Matrix3 J;
  J << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0;
  const ForcePolytope polytope = force_polytope(J, Vector3::Ones());
  EXPECT_TRUE(polytope.vertices.empty());
  EXPECT_TRUE(std::isinf(polytope.strongest));
  EXPECT_DOUBLE_EQ(polytope.weakest, 1.0);
  EXPECT_NEAR(std::abs(polytope.strongest_direction[2]), 1.0, 1e-12);
  EXPECT_TRUE(std::isinf(axis_force_limits(J, Vector3(1.0, 1.0, 1.0))[2]));
}

Jacobian random_rows(std::mt19937_64& random, int rows, int columns) {
  Jacobian J(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) J(i, j) = uniform(random, -0.3, 0.3);
  }
  return J;
}

TorqueRange random_range(std::mt19937_64& random, int joints) {
  TorqueRange range{ActiveVector(joints), ActiveVector(joints)};
  for (int j = 0; j < joints; ++j) {
    range.min[j] = uniform(random, -2.0, -0.2);
    range.max[j] = uniform(random, 0.2, 2.0);
  }
  return range;
}

ToolVector random_load(std::mt19937_64& random, int rows) {
  ToolVector load(rows);
  for (double& x : load) x = uniform(random, -1.0, 1.0);
  return load;
}

TEST(ForcePolytope, OfARedundantArmHoldsEveryLoadThatItsJointsCanHoldAndNoOther) {
  std::mt19937_64 random(46);
  for (int round = 0; round < 100; ++round) {
    const int rows = 2 + round % 2, joints = rows + 1 + round % 4;
    const Jacobian J = random_rows(random, rows, joints);
    const TorqueRange range = random_range(random, joints);
    const ForcePolytope forces = force_polytope(J, range);
    ASSERT_EQ(forces.status, PolytopeStatus::bounded);
    double nearest = 1e9;
    for (int n = 0; n < 200; ++n) {
      const ToolVector u = random_load(random, rows).normalized();
      const LoadLimit limit = load_limit(J, range, u);
      ASSERT_EQ(limit.status, LoadStatus::limited);
      const ActiveVector torque = torques_for_load(J, limit.load);
      EXPECT_GE((torque - range.min).minCoeff(), -1e-12);
      EXPECT_GE((range.max - torque).minCoeff(), -1e-12);
      EXPECT_NEAR(
          std::min(range.max[limit.joint] - torque[limit.joint], torque[limit.joint] - range.min[limit.joint]),
          0.0, 1e-12);
      EXPECT_GE(limit.value, forces.weakest - 1e-12);
      EXPECT_LE(limit.value, forces.strongest + 1e-9);
      nearest = std::min(nearest, limit.value);
      // With the directions across left free, the linear programme gives the support of the corners.
      ToolMatrix across(rows, rows - 1);
      for (int k = 0; k < rows - 1; ++k) {
        ToolVector v = random_load(random, rows);
        across.col(k) = v - u * u.dot(v);
      }
      double support = 0.0;
      for (const ToolVector& vertex : forces.vertices) support = std::max(support, vertex.dot(u));
      EXPECT_NEAR(load_limit(J, range, u, across).value, support, 1e-8 * support);
    }
    EXPECT_NEAR(load_limit(J, range, forces.weakest_direction).value, forces.weakest, 1e-12);
    EXPECT_NEAR(load_limit(J, range, forces.strongest_direction).value, forces.strongest,
                1e-9 * forces.strongest);
  }
}

TEST(ForceLimit, WithAnyMomentIsTheFarthestCornerOfForceAndMoments) {
  // Largest s with w = (s u, M) held: corners of the polytope of (s, M), by enumeration.
  std::mt19937_64 random(47);
  for (int round = 0; round < 60; ++round) {
    const int joints = 6 + round % 3;
    const Jacobian J = random_rows(random, 6, joints);
    TorqueRange range = random_range(random, joints);
    if (round % 4 == 0) range.min[1] = range.max[1] = 0.0;  // a joint without a drive
    ToolVector u = ToolVector::Zero(6);
    u.head(3) = random_direction(random);
    ToolMatrix moments = ToolMatrix::Zero(6, 3);
    moments.bottomRows(3).setIdentity();
    const LoadLimit limit = load_limit(J, range, u, moments);
    ASSERT_EQ(limit.status, LoadStatus::limited);
    Slabs slabs;
    slabs.rows.resize(joints, 4);
    slabs.rows.col(0) = J.transpose() * u;
    slabs.rows.rightCols(3) = J.bottomRows(3).transpose();
    slabs.lower = range.min;
    slabs.upper = range.max;
    double best = 0.0;
    for (const PolytopeVector& corner : polytope(slabs).vertices) best = std::max(best, corner[0]);
    EXPECT_NEAR(limit.value, best, 1e-8 * best) << round;
    EXPECT_GE(limit.value, load_limit(J, range, u).value - 1e-9);  // a moment of one's choice can only help
    const ActiveVector torque = torques_for_load(J, limit.load);
    EXPECT_GE((torque - range.min).minCoeff(), -1e-9);
    EXPECT_GE((range.max - torque).minCoeff(), -1e-9);
    EXPECT_NEAR(limit.load.head(3).dot(u.head(3)), limit.value, 1e-12);
  }
}

TEST(ForcePolytope, AJointWithoutADriveCarriesNothing) {
  // A planar arm whose last joint the hand moves: only forces through that joint's point are held.
  Jacobian J(2, 3);
  J << -0.2, -0.1, -0.05, 0.3, 0.25, 0.0;
  const TorqueRange range = TorqueRange::symmetric(Vector3(1.0, 0.5, 0.0));
  const ForcePolytope forces = force_polytope(J, range);
  EXPECT_EQ(forces.status, PolytopeStatus::bounded);
  EXPECT_EQ(forces.dimension, 1);
  EXPECT_EQ(forces.weakest, 0.0);
  ASSERT_EQ(forces.vertices.size(), 2u);
  EXPECT_NEAR(forces.strongest, std::min(1.0 / 0.3, 0.5 / 0.25), 1e-12);
  EXPECT_NEAR(load_limit(J, range, Eigen::Vector2d(1.0, 0.0)).value, 0.0, 1e-15);
  EXPECT_NEAR(load_limit(J, range, Eigen::Vector2d(0.0, -1.0)).value, 2.0, 1e-12);
  // Joints that turn about the tool feel no force, but for rounding, and leave the others alone.
  Jacobian wrist(3, 6);
  wrist.leftCols(3) << 0.1, 0.2, 0.0, 0.0, 0.1, 0.3, 0.2, 0.0, 0.1;
  wrist.rightCols(3).setConstant(1e-17);
  ActiveVector limits(6);
  limits << 1.0, 1.0, 1.0, 0.0, 0.0, 0.0;
  const ForcePolytope all = force_polytope(wrist, limits),
                      arm = force_polytope(wrist.leftCols(3), Vector3::Ones());
  EXPECT_EQ(all.dimension, 3);
  EXPECT_NEAR(all.weakest, arm.weakest, 1e-12);
  EXPECT_NEAR(all.volume, arm.volume, 1e-9 * arm.volume);
}

TEST(ForcePolytope, WeightShiftsTheRange) {
  std::mt19937_64 random(48);
  const Jacobian J = random_rows(random, 3, 3);
  const Vector3 limit(1.0, 0.8, 0.9), weight(0.3, -0.2, 0.1);
  const TorqueRange left = TorqueRange::symmetric(limit).beside(weight);
  EXPECT_TRUE(left.holds());
  const ForcePolytope forces = force_polytope(J, left), alone = force_polytope(J, ActiveVector(limit));
  EXPECT_NEAR(forces.volume, alone.volume, 1e-9 * alone.volume);  // shifted, not shrunk
  double weakest = 1e9;
  for (int j = 0; j < 3; ++j) weakest = std::min(weakest, (limit[j] - std::abs(weight[j])) / J.col(j).norm());
  EXPECT_NEAR(forces.weakest, weakest, 1e-12);
  for (const ToolVector& vertex : forces.vertices) {
    const ActiveVector torque = torques_for_load(J, vertex) + ActiveVector(weight);
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(std::abs(torque[j]), limit[j], 1e-9);
  }
  // Too heavy to hold.
  const TorqueRange heavy = TorqueRange::symmetric(limit).beside(3.0 * limit);
  EXPECT_FALSE(heavy.holds());
  EXPECT_EQ(load_limit(J, heavy, Vector3::UnitX()).status, LoadStatus::none);
  EXPECT_EQ(force_polytope(J, heavy).weakest, 0.0);
}

TEST(ForcePolytope, StructureCarriesWhatNoJointFeels) {
  Jacobian J(3, 2);
  J << 0.1, 0.0, 0.0, 0.2, 0.0, 0.0;
  const TorqueRange range = TorqueRange::symmetric(Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(force_polytope(J, range).status, PolytopeStatus::unbounded);
  EXPECT_NEAR(std::abs(force_polytope(J, range).strongest_direction[2]), 1.0, 1e-12);
  EXPECT_EQ(load_limit(J, range, Vector3::UnitZ()).status, LoadStatus::unlimited);
  EXPECT_TRUE(std::isinf(load_limit(J, range, Vector3::UnitZ()).value));
  ToolMatrix free = Vector3::UnitZ();
  EXPECT_NEAR(load_limit(J, range, Vector3(1.0, 0.0, 1.0), free.leftCols(0)).value, std::sqrt(2.0) / 0.1, 1e-9);
  EXPECT_EQ(load_limit(J, range, Vector3(1.0, 0.0, 1.0), free).status, LoadStatus::unlimited);
}

TEST(ForcePolytope, OfATwoJointArm) {
  // Worked by hand from J = [-l1 s1 - l2 s12, -l2 s12; l1 c1 + l2 c12, l2 c12]: bounds_j/|J_j| for the ball,
  // the farthest of four corners, 4 t1 t2/|det J| for the area.
  const double l1 = 0.2, l2 = 0.15, q1 = 0.3, q12 = 1.5;
  Jacobian J(2, 2);
  J << -l1 * std::sin(q1) - l2 * std::sin(q12), -l2 * std::sin(q12), l1 * std::cos(q1) + l2 * std::cos(q12),
      l2 * std::cos(q12);
  const ForcePolytope forces = force_polytope(J, Eigen::Vector2d(1.0, 0.8));
  EXPECT_NEAR(forces.weakest, 3.4453793298510194, 1e-9);
  EXPECT_NEAR(forces.strongest, 12.885309783698554, 1e-8);
  EXPECT_NEAR(forces.volume, 114.44441362238906, 1e-7);
  ASSERT_EQ(forces.faces.size(), 1u);
  EXPECT_EQ(forces.faces[0].size(), 4u);
}

TEST(Ellipsoid, OfForcesLiesWithinThePolytopeAndTurnsTheOneOfVelocities) {
  std::mt19937_64 random(49);
  for (int round = 0; round < 50; ++round) {
    const int rows = 2 + round % 2, joints = rows + round % 3;
    const Jacobian J = random_rows(random, rows, joints);
    ActiveVector limit(joints);
    for (double& x : limit) x = uniform(random, 0.2, 2.0);
    const Ellipsoid forces = force_ellipsoid(J, limit);
    const Ellipsoid speeds = velocity_ellipsoid(J, limit.cwiseInverse());
    const TorqueRange range = TorqueRange::symmetric(limit);
    for (int k = 0; k < rows; ++k) {
      const ToolVector axis = forces.axes.col(k);
      const double length = load_limit(J, range, axis).value;
      EXPECT_LE(forces.lengths[k], length * (1.0 + 1e-12));
      EXPECT_GE(forces.lengths[k] * std::sqrt(static_cast<double>(joints)), length * (1.0 - 1e-12));
      EXPECT_NEAR(torques_for_load(J, forces.lengths[k] * axis).cwiseQuotient(limit).norm(), 1.0, 1e-9);
      // Where the arm is fast it is weak: the half-axes are reciprocal, the other way round.
      EXPECT_NEAR(forces.lengths[k] * speeds.lengths[rows - 1 - k], 1.0, 1e-9);
      EXPECT_NEAR(std::abs(axis.dot(speeds.axes.col(rows - 1 - k))), 1.0, 1e-6);
    }
  }
}

TEST(Ellipsoid, OfForcesLeavesWhatAJointWithoutADriveFeels) {
  Jacobian J(2, 3);
  J << -0.2, -0.1, -0.05, 0.3, 0.25, 0.0;
  const Ellipsoid forces = force_ellipsoid(J, Vector3(1.0, 0.5, 0.0));
  EXPECT_NEAR(std::abs(forces.axes(1, 0)), 1.0, 1e-12);
  EXPECT_NEAR(forces.lengths[0], 1.0 / std::hypot(0.3, 0.25 / 0.5), 1e-12);
  EXPECT_EQ(forces.lengths[1], 0.0);
  J.col(2).setZero();
  J.row(0).setZero();
  EXPECT_TRUE(std::isinf(force_ellipsoid(J, Vector3(1.0, 0.5, 0.0)).lengths[0]));
}

TEST(VelocityPolytope, MatchesTheForcePolytopeByPower) {
  // The largest power of a unit force along u at joint rates within their limits is the support of the
  // velocities.
  std::mt19937_64 random(50);
  for (int round = 0; round < 30; ++round) {
    const Jacobian J = random_rows(random, 3, 3 + round % 4);
    ActiveVector limit(J.cols());
    for (double& x : limit) x = uniform(random, 0.5, 3.0);
    const Zonotope speeds = velocity_polytope(J, limit);
    for (int n = 0; n < 20; ++n) {
      const Vector3 u = random_direction(random);
      double reach = 0.0;
      for (const PolytopeVector& corner : speeds.vertices)
        reach = std::max(reach, corner.dot(PolytopeVector(u)));
      EXPECT_NEAR(reach, torques_for_load(J, u).cwiseAbs().dot(limit), 1e-9);
    }
  }
}

TEST(Resolution, NoCombinationOfJointStepsMovesTheToolFarther) {
  std::mt19937_64 random(45);
  for (int n = 0; n < 50; ++n) {
    const Matrix3 J = random_jacobian(random);
    const Vector3 step(uniform(random, 1e-5, 1e-3), uniform(random, 1e-5, 1e-3), uniform(random, 1e-5, 1e-3));
    const ToolVector worst = tool_resolution(J, ActiveVector(step));
    const ToolVector worst_force = force_resolution(J, ActiveVector(step));
    Vector3 largest = Vector3::Zero(), largest_force = Vector3::Zero();
    for (int signs = 0; signs < 8; ++signs) {
      const Vector3 move((signs & 1 ? 1 : -1) * step[0], (signs & 2 ? 1 : -1) * step[1],
                         (signs & 4 ? 1 : -1) * step[2]);
      largest = largest.cwiseMax((J * move).cwiseAbs());
      largest_force = largest_force.cwiseMax((J.transpose().inverse() * move).cwiseAbs());
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(worst[k] / largest[k], 1.0, 1e-12);
      EXPECT_NEAR(worst_force[k] / largest_force[k], 1.0, 1e-9);
      EXPECT_NEAR(tool_steps(J, ActiveVector(step)).row(k).sum(), worst[k], 1e-15);
    }
  }
}

}  // namespace
}  // namespace zwidth
