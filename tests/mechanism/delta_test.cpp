#include "zwidth/mechanism/delta.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "support/deltas.h"
#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Interval kAnyAngle{-std::numbers::pi, std::numbers::pi};
const DeltaGeometry kPublished = delta_geometry(test::published_delta());

// The three-sphere equations as the source prints them (A.12-A.21).
Vector3 printed_forward(const DeltaGeometry& geometry, const Vector3& theta) {
  std::array<Vector3, 3> c;
  for (int i = 0; i < 3; ++i) {
    const double alpha = delta_azimuth(i);
    const double out = geometry.offset() + geometry.upper_arm * std::cos(theta[i]);
    c[i] = {out * std::cos(alpha), out * std::sin(alpha), geometry.upper_arm * std::sin(theta[i])};
  }
  const auto [x1, y1, z1] = std::tuple(c[0].x(), c[0].y(), c[0].z());
  const auto [x2, y2, z2] = std::tuple(c[1].x(), c[1].y(), c[1].z());
  const auto [x3, y3, z3] = std::tuple(c[2].x(), c[2].y(), c[2].z());
  const double w1 = c[0].squaredNorm(), w2 = c[1].squaredNorm(), w3 = c[2].squaredNorm();
  const double den = (x1 - x3) * (y1 - y2) - (x1 - x2) * (y1 - y3);
  const double ax = ((z1 - z2) * (y1 - y3) - (z1 - z3) * (y1 - y2)) / den;
  const double bx = (-(w1 - w2) * (y1 - y3) + (w1 - w3) * (y1 - y2)) / (2 * den);
  const double ay = (-(z1 - z2) * (x1 - x3) + (z1 - z3) * (x1 - x2)) / den;
  const double by = ((w1 - w2) * (x1 - x3) - (w1 - w3) * (x1 - x2)) / (2 * den);
  const double a = ax * ax + ay * ay + 1, b = 2 * (ax * (bx - x1) + ay * (by - y1) - z1);
  const double d3 = geometry.forearm;
  const double k = (bx - x1) * (bx - x1) + (by - y1) * (by - y1) + z1 * z1 - d3 * d3;
  const double z = (-b + std::sqrt(b * b - 4 * a * k)) / (2 * a);
  return {ax * z + bx, ay * z + by, z};
}

TEST(DeltaForward, EqualsThePrintedEquations) {
  std::mt19937_64 random(1);
  for (int k = 0; k < test::storm_size(2000); ++k) {
    const DeltaDescription delta = test::random_delta(random);
    const Vector3 theta = test::random_angles(random, delta.joint_range);
    const DeltaForward forward = delta_forward(delta_geometry(delta), theta);
    if (forward.status != SolveStatus::reached) continue;
    // The printed form loses digits where the centres' plane is steep.
    EXPECT_LT((forward.position - printed_forward(delta_geometry(delta), theta)).norm(), 1e-9);
  }
}

TEST(DeltaForward, ClosesEveryLegAndTakesTheUpperMode) {
  std::mt19937_64 random(2);
  int reached = 0;
  for (int k = 0; k < test::storm_size(5000); ++k) {
    const DeltaGeometry geometry = delta_geometry(test::random_delta(random));
    const Vector3 theta = test::random_angles(random, {-1.5, 1.5});
    const DeltaForward forward = delta_forward(geometry, theta);
    if (forward.status != SolveStatus::reached) continue;
    ++reached;
    std::array<Vector3, 3> c;
    for (int i = 0; i < 3; ++i) {
      const double alpha = delta_azimuth(i), out = geometry.offset() + geometry.upper_arm * std::cos(theta[i]);
      c[i] = {out * std::cos(alpha), out * std::sin(alpha), geometry.upper_arm * std::sin(theta[i])};
      EXPECT_NEAR((forward.position - c[i]).norm(), geometry.forearm, 1e-14);
    }
    // The other mode is the mirror image in the plane of the centres.
    const Vector3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    const Vector3 other = forward.position - 2.0 * normal.dot(forward.position - c[0]) * normal;
    EXPECT_GE(forward.position.z(), other.z());
  }
  EXPECT_GT(reached, 1000);
}

TEST(DeltaForward, TellsUnreachableFromDegenerate) {
  DeltaGeometry geometry = kPublished;
  geometry.forearm = 0.05;  // too short for elbows 0.105 m out
  EXPECT_EQ(delta_forward(geometry, Vector3::Zero()).status, SolveStatus::unreachable);
  // Elbows meet on the axis when d5 + d2 cos(theta) = 0.
  const double together = std::acos(-kPublished.offset() / kPublished.upper_arm);
  EXPECT_EQ(delta_forward(kPublished, Vector3::Constant(together)).status, SolveStatus::degenerate);
}

TEST(DeltaForward, IsDegradedWhereTheForearmsAreCoplanar) {
  DeltaGeometry geometry = kPublished;
  geometry.forearm = geometry.offset() + geometry.upper_arm + 1e-16;  // flat at theta = 0
  const DeltaForward forward = delta_forward(geometry, Vector3::Zero());
  EXPECT_EQ(forward.status, SolveStatus::degraded);
  EXPECT_TRUE(forward.jacobian.allFinite());
}

TEST(DeltaInverse, ReturnsTheAnglesOfForward) {
  std::mt19937_64 random(3);
  for (int k = 0; k < test::storm_size(5000); ++k) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const Vector3 theta = test::random_angles(random, delta.joint_range);
    const DeltaForward forward = delta_forward(geometry, theta);
    if (forward.status != SolveStatus::reached) continue;
    const Vector3 sides = DeltaState(geometry, theta, forward.position).inverse_singularity();
    if (sides.minCoeff() < 1e-3) continue;  // knee inwards, or too near the boundary to invert
    const DeltaInverse inverse = delta_inverse(geometry, forward.position, delta.joint_range);
    ASSERT_EQ(inverse.status, SolveStatus::reached);
    EXPECT_LT((inverse.theta - theta).norm(), 1e-11);
    EXPECT_LT((inverse.jacobian - forward.jacobian).norm(), 1e-9 * (1.0 + forward.jacobian.norm()));
  }
}

TEST(DeltaInverse, EveryBranchClosesTheLegs) {
  std::mt19937_64 random(4);
  for (int k = 0; k < 500; ++k) {
    const Vector3 p(test::uniform(random, -0.08, 0.08), test::uniform(random, -0.08, 0.08),
                    test::uniform(random, -0.2, 0.2));
    for (int branch = 0; branch < 8; ++branch) {
      std::array<Knee, 3> knees;
      for (int l = 0; l < 3; ++l) knees[l] = (branch >> l & 1) != 0 ? Knee::inwards : Knee::outwards;
      const DeltaInverse inverse = delta_inverse(kPublished, p, kAnyAngle, knees);
      if (inverse.status != SolveStatus::reached) continue;
      const DeltaState state(kPublished, inverse.theta, p);
      for (int i = 0; i < 3; ++i) {
        const double alpha = delta_azimuth(i), out = 0.025 + 0.08 * std::cos(inverse.theta[i]);
        const Vector3 c(out * std::cos(alpha), out * std::sin(alpha), 0.08 * std::sin(inverse.theta[i]));
        EXPECT_NEAR((p - c).norm(), 0.16, 1e-14);
        EXPECT_EQ(state.inverse_singularity()[i] > 0.0, knees[i] == Knee::outwards);
      }
    }
  }
}

TEST(DeltaInverse, NamesTheLegAtFaultInTheOrderUnreachableDegenerateLimit) {
  const Interval window = test::published_delta().joint_range;
  EXPECT_EQ(delta_inverse(kPublished, {0.0, 0.0, 0.5}, window).status, SolveStatus::unreachable);
  const Vector3 lower = delta_forward(kPublished, Vector3::Constant(window.min - 0.1)).position;
  const DeltaInverse low = delta_inverse(kPublished, lower, window);
  EXPECT_EQ(low.status, SolveStatus::joint_limit);
  EXPECT_EQ(low.joint, 0);
  EXPECT_LT(low.theta[0], window.min);
  // A platform point on leg 1's actuator axis, with equal links: the angle is free.
  DeltaGeometry equal = kPublished;
  equal.forearm = equal.upper_arm;
  const DeltaInverse free = delta_inverse(equal, {0.0, equal.offset(), 0.0}, kAnyAngle);
  EXPECT_EQ(free.status, SolveStatus::degenerate);
  EXPECT_EQ(free.joint, 0);
}

TEST(DeltaInverse, AcceptsAngleWindowsBeyondHalfATurn) {
  const DeltaInverse inverse = delta_inverse(kPublished, {0.0, 0.0, 0.15}, kAnyAngle);
  ASSERT_EQ(inverse.status, SolveStatus::reached);
  const double theta = inverse.theta[0] + 2.0 * std::numbers::pi;
  EXPECT_EQ(delta_inverse(kPublished, {0.0, 0.0, 0.15}, {theta - 0.1, theta + 0.1}).status,
            SolveStatus::reached);
}

TEST(DeltaState, JacobianAndItsRateEqualDifferences) {
  std::mt19937_64 random(5);
  const Interval window = test::published_delta().joint_range;
  const double h = 1e-5;
  for (int k = 0; k < 300; ++k) {
    const Vector3 theta = test::random_angles(random, window), rate = test::random_angles(random, {-2.0, 2.0});
    const auto at = [&](const Vector3& q) { return delta_forward(kPublished, q); };
    const DeltaState state(kPublished, theta, at(theta).position);
    Matrix3 J;
    for (int i = 0; i < 3; ++i) {
      J.col(i) =
          (at(theta + h * Vector3::Unit(i)).position - at(theta - h * Vector3::Unit(i)).position) / (2 * h);
    }
    const Matrix3 Jdot = (at(theta + h * rate).jacobian - at(theta - h * rate).jacobian) / (2 * h);
    EXPECT_LT((state.jacobian() - J).norm(), 1e-8);  // h^2 |third derivative| / 6, a few 1e-9
    EXPECT_LT((state.jacobian_rate(rate) - Jdot).norm(), 1e-7);
    EXPECT_LT((state.jacobian() - at(theta).jacobian).norm(), 1e-14);
  }
}

TEST(DeltaState, PublishedWindowHoldsNoSingularity) {
  const Interval window = test::published_delta().joint_range;
  const int n = 31;
  double least_side = 1e9, least_condition = 1e9, most_condition = 0.0, least_det = 1e9, most_det = 0.0;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      for (int c = 0; c < n; ++c) {
        const Vector3 theta = Vector3::Constant(window.min) + Vector3(a, b, c) * window.width() / (n - 1);
        const DeltaForward forward = delta_forward(kPublished, theta);
        ASSERT_EQ(forward.status, SolveStatus::reached);
        const DeltaState state(kPublished, theta, forward.position);
        least_side = std::min(least_side, state.inverse_singularity().minCoeff() * 0.08 * 0.16);
        const Vector3 sigma = forward.jacobian.jacobiSvd().singularValues();
        const double condition = sigma[0] / sigma[2];
        least_condition = std::min(least_condition, condition);
        most_condition = std::max(most_condition, condition);
        const double det = forward.jacobian.determinant();
        least_det = std::min(least_det, det);
        most_det = std::max(most_det, det);
      }
    }
  }
  EXPECT_GE(least_side, 3.96e-3);
  EXPECT_NEAR(least_condition, 1.63,
              0.01);  // the spacing of a 31^3 grid, not of the 61^3 one of the source of 1.63
  EXPECT_NEAR(most_condition, 6.63, 0.01);
  EXPECT_GE(least_det, 2.97e-5);
  EXPECT_LE(most_det, 8.03e-4);
}

DeltaMasses some_masses(std::mt19937_64& random) {
  DeltaMasses masses;
  masses.upper_arm = test::uniform(random, 0.02, 0.2);
  masses.forearms = test::random_angles(random, {0.01, 0.1});
  masses.platform = test::uniform(random, 0.02, 0.2);
  masses.payload = test::uniform(random, 0.0, 0.2);
  masses.centre_along = test::uniform(random, 0.0, 0.08);
  masses.centre_normal = test::uniform(random, -0.02, 0.02);
  masses.upper_arm_inertia = test::random_angles(random, {1e-4, 1e-3});
  masses.motor_inertia = test::random_angles(random, {1e-6, 3e-6});
  masses.gear_ratio = test::uniform(random, 5.0, 20.0);
  masses.mass_split = test::uniform(random, 0.5, 1.0);
  return masses;
}

TEST(DeltaPointMassDynamics, IsTheEulerLagrangeEquationOfItsEnergies) {
  std::mt19937_64 random(6);
  const Interval window = test::published_delta().joint_range;
  const double h = 1e-5;
  for (int k = 0; k < 100; ++k) {
    const DeltaPointMassDynamics dynamics(kPublished, some_masses(random));
    const Vector3 theta = test::random_angles(random, window), rate = test::random_angles(random, {-2.0, 2.0}),
                  acceleration = test::random_angles(random, {-20.0, 20.0});
    const auto state = [&](const Vector3& q) {
      return DeltaState(kPublished, q, delta_forward(kPublished, q).position);
    };
    const auto kinetic = [&](const Vector3& q) {
      return 0.5 * rate.dot(dynamics.mass_matrix(state(q)) * rate);
    };
    const Matrix3 Mdot =
        (dynamics.mass_matrix(state(theta + h * rate)) - dynamics.mass_matrix(state(theta - h * rate))) /
        (2 * h);
    Vector3 expected = dynamics.mass_matrix(state(theta)) * acceleration + Mdot * rate;
    Vector3 slope;
    for (int i = 0; i < 3; ++i) {
      const Vector3 up = theta + h * Vector3::Unit(i), down = theta - h * Vector3::Unit(i);
      expected[i] -= (kinetic(up) - kinetic(down)) / (2 * h);
      slope[i] = (dynamics.potential_energy(state(up)) - dynamics.potential_energy(state(down))) / (2 * h);
    }
    EXPECT_LT((dynamics.gravity_torque(state(theta)) + slope).norm(), 1e-8);
    EXPECT_LT((dynamics.inverse(state(theta), rate, acceleration) - (expected + slope)).norm(), 1e-7);
    // Mdot - 2C is skew-symmetric.
    const Matrix3 N = Mdot - 2.0 * dynamics.coriolis_matrix(state(theta), rate);
    EXPECT_LT((N + N.transpose()).norm(), 1e-8);
  }
}

TEST(DeltaPointMassDynamics, ForwardUndoesInverse) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 100; ++k) {
    const DeltaPointMassDynamics dynamics(kPublished, some_masses(random));
    const Vector3 theta = test::random_angles(random, test::published_delta().joint_range);
    const DeltaState state(kPublished, theta, delta_forward(kPublished, theta).position);
    const Vector3 rate = test::random_angles(random, {-2.0, 2.0}),
                  wanted = test::random_angles(random, {-50.0, 50.0}),
                  push = test::random_angles(random, {-5.0, 5.0});
    const Vector3 torque = dynamics.inverse(state, rate, wanted, push);
    EXPECT_LT((dynamics.forward(state, rate, torque, push) - wanted).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace zwidth
