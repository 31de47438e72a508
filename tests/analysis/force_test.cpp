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
