#include "zwidth/mechanism/five_bar.h"

#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "support/allocation_counter.h"
#include "support/five_bars.h"
#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const FiveBarGeometry kPublished = test::kPublishedFiveBar;

Vector2 elbow(const FiveBarGeometry& g, int leg, double theta) {
  return {(leg == 0 ? -g.half_base : g.half_base) + g.crank * std::cos(theta), g.crank * std::sin(theta)};
}

// A posture well inside: both legs bent and the couplers apart, by `margin` in the scale-free measures.
bool regular(const FiveBarState& state, double margin) {
  return state.inverse_singularity().cwiseAbs().minCoeff() > margin &&
         std::abs(state.direct_singularity()) > margin;
}

// The elimination of section 3.2, with the d and e that its text lost.
Vector2 printed_forward(const FiveBarGeometry& g, const Vector2& theta, int assembly_mode) {
  const double r1 = g.crank, r2 = g.coupler, r3 = g.half_base;
  const double c1 = std::cos(theta[0]), s1 = std::sin(theta[0]), c2 = std::cos(theta[1]),
               s2 = std::sin(theta[1]);
  const double q = 2 * r3 - r1 * c1 + r1 * c2, d = r1 * (s1 - s2) / q, e = r1 * r3 * (c1 + c2) / q;
  const double f = 1 + d * d, gg = 2 * (d * e - d * r1 * c1 + d * r3 - r1 * s1);
  const double h = e * e - 2 * e * (r1 * c1 - r3) - 2 * r1 * r3 * c1 + r3 * r3 + r1 * r1 - r2 * r2;
  // Of the two roots the larger y lies to the left of a line that runs to the right.
  const double sign = (q > 0) == (assembly_mode > 0) ? 1.0 : -1.0;
  const double y = (-gg + sign * std::sqrt(gg * gg - 4 * f * h)) / (2 * f);
  return {d * y + e, y};
}

TEST(FiveBarForward, EqualsThePrintedElimination) {
  std::mt19937_64 random(1);
  int compared = 0;
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const Vector2 theta = test::random_cranks(random);
    const int mode = k % 2 == 0 ? 1 : -1;
    const FiveBarForward forward = five_bar_forward(g, theta, mode);
    if (forward.status != SolveStatus::reached) continue;
    const Vector2 v = elbow(g, 1, theta[1]) - elbow(g, 0, theta[0]);
    // The printed form loses 2 log10(|v_y/v_x|) digits, and its root half of those that h has lost.
    const FiveBarState state(g, theta, forward.position);
    if (std::abs(v.x()) < 0.1 * v.norm() || !regular(state, 0.01)) continue;
    EXPECT_LT((forward.position - printed_forward(g, theta, mode)).norm(), 1e-10 * g.scale());
    ++compared;
  }
  EXPECT_GT(compared, 5000);
}

TEST(FiveBarForward, ClosesBothLegsOnTheSideAskedFor) {
  std::mt19937_64 random(2);
  int reached = 0;
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const Vector2 theta = test::random_cranks(random);
    const Vector2 B1 = elbow(g, 0, theta[0]), B2 = elbow(g, 1, theta[1]), v = B2 - B1;
    for (const int mode : {1, -1}) {
      const FiveBarForward forward = five_bar_forward(g, theta, mode);
      ASSERT_EQ(forward.status == SolveStatus::unreachable, v.norm() > 2.0 * g.coupler) << k;
      if (forward.status == SolveStatus::unreachable) continue;
      ++reached;
      EXPECT_NEAR((forward.position - B1).norm(), g.coupler, 1e-14 * g.scale());
      EXPECT_NEAR((forward.position - B2).norm(), g.coupler, 1e-14 * g.scale());
      const Vector2 w = forward.position - B1;
      EXPECT_GE(mode * (v.x() * w.y() - v.y() * w.x()), 0.0);
      if (forward.status == SolveStatus::reached) {
        EXPECT_EQ(assembly_mode(g, theta, forward.position), mode);
      }
    }
  }
  EXPECT_GT(reached, 10000);
}

TEST(FiveBarForward, HasNoExceptionWhereTheElbowsAreAboveEachOther) {
  // q = 0 in the source's elimination.
  const FiveBarGeometry g{.crank = 1.0, .coupler = 1.0, .half_base = 0.6};
  const Vector2 theta(kPi / 3.0, -std::acos(-0.7));
  for (const int mode : {1, -1}) {
    const FiveBarForward forward = five_bar_forward(g, theta, mode);
    ASSERT_EQ(forward.status, SolveStatus::reached);
    EXPECT_NEAR((forward.position - elbow(g, 1, theta[1])).norm(), 1.0, 1e-15);
    EXPECT_GT(mode * (forward.position.x() + 0.1), 0.0);  // the elbows lie at x = -0.1, the second one below
  }
}

TEST(FiveBarForward, TellsUnreachableFromDegenerateAndFlat) {
  const Vector2 apart(kPi, 0.0);  // |B1 B2| = 2 (r1 + r3)
  EXPECT_EQ(five_bar_forward({1.0, 1.4, 0.5}, apart).status, SolveStatus::unreachable);
  EXPECT_EQ(five_bar_forward_count({1.0, 1.4, 0.5}, apart), 0);
  const FiveBarForward flat = five_bar_forward({1.0, 1.5, 0.5}, apart);
  EXPECT_EQ(flat.status, SolveStatus::degraded);
  EXPECT_LT(flat.position.norm(), 1e-15);
  EXPECT_TRUE(flat.jacobian.isZero(0.0));
  EXPECT_EQ(five_bar_forward_count({1.0, 1.5, 0.5}, apart), 1);
  EXPECT_EQ(five_bar_forward_count({1.0, 1.6, 0.5}, apart), 2);
  const double together = std::acos(0.3);  // r3/r1
  const Vector2 elbows_meet(together, kPi - together);
  EXPECT_EQ(five_bar_forward(kPublished, elbows_meet).status, SolveStatus::degenerate);
  EXPECT_EQ(five_bar_forward_count(kPublished, elbows_meet), std::nullopt);
  // Any crank angle with r2 = r3: couplers parallel to a base of their length, folded onto each other or flat.
  EXPECT_EQ(five_bar_forward({1.0, 0.8, 0.8}, {0.9, 0.9}).status, SolveStatus::degraded);
}

TEST(FiveBarForward, TakesMotorsOnOneAxis) {
  const FiveBarGeometry coaxial{.crank = 0.1, .coupler = 0.15, .half_base = 0.0};
  const FiveBarForward forward = five_bar_forward(coaxial, {2.5, 0.6});
  ASSERT_EQ(forward.status, SolveStatus::reached);
  // Symmetric about the bisector of the cranks.
  EXPECT_NEAR(std::atan2(forward.position.y(), forward.position.x()), 1.55, 1e-14);
  EXPECT_LT((five_bar_inverse(coaxial, forward.position).theta - Vector2(2.5, 0.6)).norm(), 1e-13);
  EXPECT_EQ(five_bar_forward(coaxial, {0.6, 0.6}).status, SolveStatus::degenerate);
}

TEST(FiveBarForward, RefusesLengthsThatCannotBeAssembled) {
  for (const FiveBarGeometry& g :
       {FiveBarGeometry{0.0, 1.0, 0.5}, FiveBarGeometry{1.0, -1.0, 0.5}, FiveBarGeometry{1.0, 1.0, 2.0},
        FiveBarGeometry{kInfinity, 1.0, 0.5}, FiveBarGeometry{std::nan(""), 1.0, 0.5}}) {
    EXPECT_FALSE(can_assemble(g));
    EXPECT_EQ(five_bar_forward(g, {1.0, 2.0}).status, SolveStatus::unreachable);
    EXPECT_EQ(five_bar_inverse(g, {0.1, 0.9}).status, SolveStatus::unreachable);
    EXPECT_EQ(five_bar_inverse_all(g, {0.1, 0.9}).count, 0);
    EXPECT_FALSE(inscribed_circle(g));
  }
  EXPECT_EQ(five_bar_forward(kPublished, {std::nan(""), 1.0}).status, SolveStatus::unreachable);
  EXPECT_EQ(five_bar_inverse(kPublished, {std::nan(""), 1.0}).status, SolveStatus::unreachable);
}

TEST(FiveBarInverse, ReturnsTheCranksOfForwardInTheirMode) {
  std::mt19937_64 random(3);
  int compared = 0;
  for (int k = 0; k < test::storm_size(100000); ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const Vector2 theta = test::random_cranks(random);
    const FiveBarForward forward = five_bar_forward(g, theta, k % 2 == 0 ? 1 : -1);
    if (forward.status != SolveStatus::reached) continue;
    const FiveBarState state(g, theta, forward.position);
    if (!regular(state, 1e-3)) continue;
    const FiveBarInverse inverse =
        five_bar_inverse(g, forward.position, working_mode(g, theta, forward.position));
    ASSERT_EQ(inverse.status, SolveStatus::reached);
    // theta = phi + s alpha with dalpha = eps/sin: a thousand times rounding.
    EXPECT_LT((inverse.theta - theta).norm(), 1e-11) << k;
    EXPECT_LT((inverse.jacobian - forward.jacobian).norm(), 1e-8 * forward.jacobian.norm());
    ++compared;
  }
  EXPECT_GT(compared, 30000);
}

TEST(FiveBarInverse, EveryModeClosesAndTurnsTheCrankItsWay) {
  std::mt19937_64 random(4);
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const double reach = g.crank + g.coupler;
    const Vector2 p(test::draw(random, -reach, reach), test::draw(random, -reach, reach));
    const FiveBarSolutions all = five_bar_inverse_all(g, p);
    int count = 0;
    for (const WorkingMode mode : kWorkingModes) {
      const FiveBarInverse inverse = five_bar_inverse(g, p, mode);
      EXPECT_EQ(inverse.status == SolveStatus::unreachable, all.status == SolveStatus::unreachable);
      if (inverse.status == SolveStatus::unreachable) {
        const Vector2 from_motor = p - Vector2(inverse.joint == 0 ? -g.half_base : g.half_base, 0.0);
        const double D = from_motor.norm();
        EXPECT_TRUE(D > reach || D < std::abs(g.crank - g.coupler));
        continue;
      }
      for (int i = 0; i < 2; ++i) {
        EXPECT_GT(inverse.theta[i], -kPi);
        EXPECT_LE(inverse.theta[i], kPi);
        EXPECT_NEAR((p - elbow(g, i, inverse.theta[i])).norm(), g.coupler, 1e-14 * g.scale());
      }
      if (regular(FiveBarState(g, inverse.theta, p), 1e-6)) {
        EXPECT_EQ(working_mode(g, inverse.theta, p), mode);
      }
      ASSERT_LT(count, 4);
      int same = 0;
      for (int s = 0; s < all.count; ++s) {
        if ((all.theta[s] - inverse.theta).norm() == 0.0) {
          ++same;
          EXPECT_EQ(all.mode[s], mode);
        }
      }
      EXPECT_EQ(same, 1);
      ++count;
    }
    EXPECT_EQ(count, all.count);
    for (int s = 1; s < all.count; ++s) {
      EXPECT_TRUE(all.theta[s - 1][0] < all.theta[s][0] ||
                  (all.theta[s - 1][0] == all.theta[s][0] && all.theta[s - 1][1] < all.theta[s][1]));
    }
  }
}

TEST(FiveBarInverse, MirrorsAsTheSpecificationSays) {
  // (s1, s2) at (x, y) is (-s2, -s1) at (-x, y), and (-s1, -s2) at (x, -y).
  const Vector2 p(0.04, 0.12);
  for (const WorkingMode mode : kWorkingModes) {
    const FiveBarInverse one = five_bar_inverse(kPublished, p, mode);
    const FiveBarInverse sideways =
        five_bar_inverse(kPublished, {-p.x(), p.y()}, {.left = -mode.right, .right = -mode.left});
    const FiveBarInverse down =
        five_bar_inverse(kPublished, {p.x(), -p.y()}, {.left = -mode.left, .right = -mode.right});
    ASSERT_EQ(one.status, SolveStatus::reached);
    EXPECT_NEAR(std::remainder(kPi - one.theta[1] - sideways.theta[0], 2 * kPi), 0.0, 1e-14);
    EXPECT_NEAR(std::remainder(kPi - one.theta[0] - sideways.theta[1], 2 * kPi), 0.0, 1e-14);
    EXPECT_NEAR((one.theta + down.theta).norm(), 0.0, 1e-14);
  }
}

TEST(FiveBarInverse, NamesTheLegAtFaultInTheOrderUnreachableDegenerateLimit) {
  const FiveBarInverse far = five_bar_inverse(kPublished, {0.225, 0.0});
  EXPECT_EQ(far.status, SolveStatus::unreachable);
  EXPECT_EQ(far.joint, 0);
  EXPECT_EQ(five_bar_inverse(kPublished, {-0.225, 0.0}).joint, 1);
  EXPECT_EQ(five_bar_inverse(kPublished, {0.03, 0.0}).status, SolveStatus::unreachable);  // on O2, r1 != r2
  const FiveBarGeometry equal{.crank = 0.1, .coupler = 0.1, .half_base = 0.03};
  const FiveBarInverse open = five_bar_inverse(equal, {0.03, 0.0});
  EXPECT_EQ(open.status, SolveStatus::degenerate);
  EXPECT_EQ(open.joint, 1);
  // On O1, and out of the right leg's reach: the leg that cannot reach is named.
  const FiveBarInverse both = five_bar_inverse({0.1, 0.1, 0.15}, {-0.15, 0.0});
  EXPECT_EQ(both.status, SolveStatus::unreachable);
  EXPECT_EQ(both.joint, 1);
  const FiveBarInverse free = five_bar_inverse(kPublished, {0.0, 0.15});
  ASSERT_EQ(free.status, SolveStatus::reached);
  const FiveBarInverse limited =
      five_bar_inverse(kPublished, {0.0, 0.15}, {}, {Interval{-kPi, kPi}, Interval{free.theta[1] + 0.1, kPi}});
  EXPECT_EQ(limited.status, SolveStatus::joint_limit);
  EXPECT_EQ(limited.joint, 1);
  EXPECT_EQ(limited.theta, free.theta);
  // Windows are met modulo a turn.
  const double beyond = free.theta[0] + 2.0 * kPi;
  EXPECT_EQ(
      five_bar_inverse(kPublished, {0.0, 0.15}, {}, {Interval{beyond - 0.1, beyond + 0.1}, kAnyCrankAngle[1]})
          .status,
      SolveStatus::reached);
}

TEST(FiveBarInverse, ModesMergeOnTheBoundaryCircles) {
  for (const auto& [p, count] : {std::pair(Vector2(0.22, 0.0), 2), std::pair(Vector2(0.08, 0.0), 2),
                                 std::pair(Vector2(0.0, 0.04), 1), std::pair(Vector2(0.1, 0.1), 4)}) {
    EXPECT_EQ(five_bar_inverse_all(kPublished, p).count, count) << p.transpose();
    EXPECT_NE(five_bar_inverse(kPublished, p).status, SolveStatus::unreachable);
  }
  // A picometre beyond still counts as the boundary, a nanometre does not.
  EXPECT_EQ(five_bar_inverse(kPublished, {0.22 + 1e-13, 0.0}).status, SolveStatus::degraded);
  EXPECT_EQ(five_bar_inverse(kPublished, {0.22 + 1e-9, 0.0}).status, SolveStatus::unreachable);
}

TEST(FiveBarState, JacobiansEqualDifferencesAndInvertEachOther) {
  std::mt19937_64 random(5);
  int compared = 0;
  for (int k = 0; k < 3000; ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const Vector2 theta = test::random_cranks(random), rate = test::random_cranks(random);
    const int mode = k % 2 == 0 ? 1 : -1;
    const FiveBarForward forward = five_bar_forward(g, theta, mode);
    if (forward.status != SolveStatus::reached) continue;
    const FiveBarState state(g, theta, forward.position);
    if (!regular(state, 0.05)) continue;
    ++compared;
    const double h = 1e-6;
    const auto at = [&](const Vector2& q) { return five_bar_forward(g, q, mode); };
    Matrix2 J;
    for (int i = 0; i < 2; ++i) {
      J.col(i) =
          (at(theta + h * Vector2::Unit(i)).position - at(theta - h * Vector2::Unit(i)).position) / (2 * h);
    }
    const Matrix2 Jdot = (at(theta + h * rate).jacobian - at(theta - h * rate).jacobian) / (2 * h);
    // Third derivatives grow with the fifth power of the distance 0.05 from a singularity, at worst.
    EXPECT_LT((*state.jacobian() - J).norm(), 1e-5 * J.norm());
    EXPECT_LT((*state.jacobian_rate(rate) - Jdot).norm(), 1e-4 * (Jdot.norm() + J.norm()));
    EXPECT_LT((*state.jacobian() - forward.jacobian).norm(), 1e-11 * J.norm());
    EXPECT_LT((*state.jacobian() * *state.inverse_jacobian() - Matrix2::Identity()).norm(), 1e-10);
    // Jp and Jtheta as printed.
    const double x = forward.position.x(), y = forward.position.y(), r1 = g.crank, r3 = g.half_base;
    const double c1 = std::cos(theta[0]), s1 = std::sin(theta[0]), c2 = std::cos(theta[1]),
                 s2 = std::sin(theta[1]);
    Matrix2 Jp;
    Jp << x - r1 * c1 + r3, y - r1 * s1, x - r1 * c2 - r3, y - r1 * s2;
    EXPECT_LT((state.jacobian_p() - Jp).norm(), 1e-14 * g.scale());
    EXPECT_NEAR(state.jacobian_theta()[0], r1 * (y * c1 - (x + r3) * s1), 1e-14 * g.scale() * g.scale());
    EXPECT_NEAR(state.jacobian_theta()[1], r1 * (y * c2 + (r3 - x) * s2), 1e-14 * g.scale() * g.scale());
  }
  EXPECT_GT(compared, 500);
}

TEST(FiveBarState, PowerIsConserved) {
  std::mt19937_64 random(6);
  for (int k = 0; k < 2000; ++k) {
    const Vector2 theta = test::random_cranks(random), rate = test::random_cranks(random);
    const Vector2 force = test::random_cranks(random);
    const FiveBarForward forward = five_bar_forward(kPublished, theta);
    if (forward.status != SolveStatus::reached) continue;
    const FiveBarState state(kPublished, theta, forward.position);
    const Vector2 torque = *state.torque_from_force(force), pdot = *state.jacobian() * rate;
    EXPECT_NEAR(torque.dot(rate), force.dot(pdot), 1e-12 * (1.0 + torque.norm() * rate.norm()));
    EXPECT_LT((*state.force_from_torque(torque) - force).norm(), 1e-7);
  }
}

TEST(FiveBarState, EllipsesAndConditionNumberAreThoseOfTheSingularValues) {
  std::mt19937_64 random(7);
  int compared = 0;
  for (int k = 0; k < test::storm_size(20000); ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const Vector2 theta = test::random_cranks(random);
    const FiveBarForward forward = five_bar_forward(g, theta);
    if (forward.status != SolveStatus::reached) continue;
    const FiveBarState state(g, theta, forward.position);
    if (!regular(state, 1e-3)) continue;
    ++compared;
    const Matrix2 J = *state.inverse_jacobian();
    const Eigen::JacobiSVD<Matrix2> svd(J, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vector2 sigma = svd.singularValues();
    const double K = sigma[0] / sigma[1];
    EXPECT_NEAR(state.condition_number(), K, 1e-9 * K);
    const Ellipse force = *state.force_ellipse(), velocity = *state.velocity_ellipse();
    EXPECT_NEAR(force.major, sigma[0], 1e-12 * sigma[0]);
    EXPECT_NEAR(force.minor, sigma[1], 1e-9 * sigma[1]);
    EXPECT_NEAR(velocity.major * sigma[1], 1.0, 1e-9);
    EXPECT_NEAR(velocity.minor * sigma[0], 1.0, 1e-9);
    for (const double direction : {force.direction, velocity.direction}) {
      EXPECT_GE(direction, 0.0);
      EXPECT_LT(direction, kPi);
    }
    if (K < 1.01) continue;
    const Vector2 major = svd.matrixV().col(0), along(std::cos(force.direction), std::sin(force.direction));
    EXPECT_NEAR(std::abs(major.dot(along)), 1.0, 1e-10);
    EXPECT_NEAR(std::cos(force.direction - velocity.direction), 0.0, 1e-8 / (1.0 - 1.0 / K));  // axes swapped
  }
  EXPECT_GT(compared, 8000);
}

TEST(FiveBarState, IsSingularOnTheBoundaryAndWhereTheCouplersAlign) {
  struct Expectation {
    FiveBarGeometry geometry;
    Vector2 position;
    WorkingMode mode;
    FiveBarSingularity singularity;
  };
  const FiveBarGeometry flat{.crank = 1.0, .coupler = 1.25, .half_base = 0.5};
  const double h = std::sqrt(1.0 - 0.75 * 0.75);
  const auto bent = LegShape::bent, out = LegShape::stretched, in = LegShape::folded;
  for (const auto& [geometry, position, mode, expected] : std::vector<Expectation>{
           {kPublished, {0.22, 0.0}, {}, {.leg = {out, bent}}},
           {kPublished, {-0.22, 0.0}, {}, {.leg = {bent, out}}},
           {kPublished, {0.08, 0.0}, {}, {.leg = {bent, in}}},
           {kPublished, {0.0, 0.04}, {}, {.leg = {in, in}}},
           // Elbows at the outer ends of their circles, level with each other: B1 C B2 on a horizontal line.
           {flat, {0.0, h}, {.left = 1, .right = -1}, {.couplers = CouplerShape::aligned}}}) {
    const FiveBarInverse inverse = five_bar_inverse(geometry, position, mode);
    ASSERT_EQ(inverse.status, SolveStatus::degraded) << position.transpose();
    const FiveBarState state(geometry, inverse.theta, position);
    const FiveBarSingularity found = state.singularity();
    EXPECT_EQ(found.leg, expected.leg) << position.transpose();
    EXPECT_EQ(found.couplers, expected.couplers) << position.transpose();
    EXPECT_EQ(state.condition_number(), kInfinity);
    EXPECT_EQ(state.inverse_jacobian().has_value(), !expected.inverse());
    EXPECT_EQ(state.force_ellipse().has_value(), !expected.inverse());
    EXPECT_EQ(state.jacobian().has_value(), !expected.direct());
    EXPECT_EQ(state.torque_from_force({1.0, 0.0}).has_value(), !expected.direct());
    EXPECT_EQ(state.velocity_ellipse().has_value(), !expected.direct());
    EXPECT_EQ(state.jacobian_rate({1.0, 0.0}).has_value(), !expected.direct());
  }
  EXPECT_TRUE(FiveBarState(kPublished, {1.8, 1.2}, {0.0, 0.2}).singularity().none());
}

TEST(FiveBarState, NamesElbowsThatCoincide) {
  const double together = std::acos(0.3);
  const Vector2 theta(together, kPi - together), B(0.0, 0.1 * std::sin(together));
  const Vector2 position = B + 0.15 * Vector2(std::cos(0.4), std::sin(0.4));
  const FiveBarSingularity found = FiveBarState(kPublished, theta, position).singularity();
  EXPECT_EQ(found.couplers, CouplerShape::elbows_coincide);
  EXPECT_FALSE(found.inverse());
  EXPECT_NEAR(B.y(), 0.095394, 5e-7);  // section 5 of the reading in docs/devices/five-bar.md
}

TEST(FiveBarState, CombinedSingularityNeedsParticularLengths) {
  const FiveBarGeometry g{.crank = 1.0, .coupler = 1.0, .half_base = 1.0};
  // r3 = r1 = r2: both cranks point at the origin, both elbows there, the couplers fold back or turn together.
  const FiveBarSingularity found = FiveBarState(g, {0.0, kPi}, {1.0, 0.0}).singularity();
  EXPECT_TRUE(found.combined());
  EXPECT_EQ(found.couplers, CouplerShape::elbows_coincide);
  EXPECT_EQ(found.leg[0], LegShape::stretched);
  EXPECT_EQ(found.leg[1], LegShape::folded);
}

TEST(FiveBarState, ParallelogramIsSingularAtEveryCrankAngle) {
  const FiveBarGeometry g{.crank = 1.0, .coupler = 0.8, .half_base = 0.8};
  for (double angle = -3.0; angle < 3.0; angle += 0.25) {
    const FiveBarForward forward = five_bar_forward(g, {angle, angle});
    EXPECT_EQ(forward.status, SolveStatus::degraded);
    EXPECT_LT(std::abs(FiveBarState(g, {angle, angle}, forward.position).direct_singularity()), 1e-7);
  }
}

TEST(FiveBarState, ConditionNumbersOfTheAccuracySection) {
  const auto K = [](const Vector2& p) {
    return FiveBarState(kPublished, five_bar_inverse(kPublished, p).theta, p).condition_number();
  };
  EXPECT_NEAR(K({0.0, 0.18}), 1.0845, 5e-5);
  EXPECT_NEAR(K({0.0, 0.15}), 1.1850, 5e-5);
  EXPECT_EQ(five_bar_inverse(kPublished, {0.0, 0.03}).status, SolveStatus::unreachable);
}

TEST(FiveBarConditions, AgreeWithSampledDistancesOfTheElbows) {
  std::mt19937_64 random(8);
  int coincide = 0, align = 0;
  for (int k = 0; k < 200; ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const FiveBarConditions conditions = avoidance_conditions(g);
    double least = kInfinity, most = 0.0;
    constexpr int n = 60;
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        const double apart = (elbow(g, 1, 2 * kPi * a / n) - elbow(g, 0, 2 * kPi * b / n)).norm();
        least = std::min(least, apart);
        most = std::max(most, apart);
      }
    }
    const double step = 2.0 * kPi / n * g.crank;  // no distance changes by more between neighbours
    const double nearest = conditions.elbows_can_coincide ? 0.0 : 2.0 * (g.half_base - g.crank);
    EXPECT_GE(least, nearest - 1e-14);
    EXPECT_LT(least, nearest + step);
    EXPECT_NEAR(most, 2.0 * (g.half_base + g.crank), 1e-14);  // both angles are among the samples
    if (std::abs(2.0 * g.coupler - least) > step) {
      EXPECT_EQ(conditions.couplers_can_align, least < 2.0 * g.coupler && 2.0 * g.coupler < most);
    }
    coincide += conditions.elbows_can_coincide;
    align += conditions.couplers_can_align;
  }
  EXPECT_GT(coincide, 5);
  EXPECT_GT(align, 20);
}

TEST(FiveBarConditions, OfTheSixtyDesignsNoneMeetsTheFirstAndTenTheSecond) {
  int first = 0, second = 0;
  for (int a1 = 9; a1 <= 12; ++a1) {
    for (int a2 = 11; a2 <= 15; ++a2) {
      for (int a3 = 3; a3 <= 5; ++a3) {
        const FiveBarConditions conditions = avoidance_conditions({1.0 * a1, 1.0 * a2, 1.0 * a3});
        first += !conditions.elbows_can_coincide;
        second += !conditions.couplers_can_align;
        EXPECT_TRUE(conditions.can_assemble && conditions.lengths_in_range && !conditions.parallelogram);
        EXPECT_FALSE(conditions.all());
      }
    }
  }
  EXPECT_EQ(first, 0);
  EXPECT_EQ(second, 10);
  EXPECT_TRUE(avoidance_conditions({0.6, 1.8, 0.7}).all());
  EXPECT_TRUE(avoidance_conditions({1.0, 0.8, 0.8}).parallelogram);
}

TEST(FiveBarGeometry, InscribedCircleTouchesBothBoundaries) {
  std::mt19937_64 random(9);
  for (int k = 0; k < 200; ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const auto circle = inscribed_circle(g);
    ASSERT_EQ(circle.has_value(), g.half_base <= std::max(g.crank, g.coupler));
    if (!circle) continue;
    const double from_motor = std::hypot(g.half_base, circle->centre_y);
    EXPECT_NEAR(from_motor + circle->radius, g.crank + g.coupler, 1e-14 * g.scale());
    EXPECT_NEAR(from_motor - circle->radius, std::abs(g.crank - g.coupler), 1e-14 * g.scale());
  }
  EXPECT_NEAR(inscribed_circle(kPublished)->centre_y, 0.14697, 5e-6);
}

TEST(FiveBarGeometry, NormalisedLengthsAddUpToThree) {
  const FiveBarGeometry r = normalised_lengths(kPublished);
  EXPECT_NEAR(r.crank, 1.0714, 5e-5);
  EXPECT_NEAR(r.coupler, 1.6071, 5e-5);
  EXPECT_NEAR(r.half_base, 0.3214, 5e-5);
  EXPECT_NEAR(r.scale(), 3.0, 1e-15);
}

TEST(FiveBar, NeedsNoHeap) {
  const long before = test::allocations();
  const FiveBarForward forward = five_bar_forward(kPublished, {2.4, 0.7});
  const FiveBarInverse inverse = five_bar_inverse(kPublished, forward.position);
  const FiveBarSolutions all = five_bar_inverse_all(kPublished, forward.position);
  const FiveBarState state(kPublished, inverse.theta, forward.position);
  EXPECT_TRUE(state.jacobian() && state.jacobian_rate({1.0, 2.0}) && state.force_ellipse() &&
              state.velocity_ellipse() && state.torque_from_force({1.0, 2.0}) && all.count == 4 &&
              state.condition_number() > 1.0 && state.singularity().none());
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace zwidth
