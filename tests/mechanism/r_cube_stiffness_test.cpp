#include "zwidth/mechanism/r_cube_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>

#include "support/r_cubes.h"

#include "zwidth/mechanism/stiffness.h"

namespace zwidth {
namespace {

const Material kSteel{.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = 7850.0};
const std::array<std::array<double, 2>, 3> kTubes = {{{0.03, 0.0225}, {0.024, 0.018}, {0.0144, 0.0108}}};

RCubeLinks links_of(const RCubeGeometry& geometry) {
  RCubeLinks links{.geometry = geometry, .rigidity = {}};
  for (std::size_t k = 0; k < 3; ++k)
    links.rigidity[k] = beam_rigidity(*tube_section(kTubes[k][0], kTubes[k][1]), 200e9, 200e9 / 2.6);
  return links;
}

Vector3 random_angles(std::mt19937_64& random) {
  return {test::uniform(random, -0.6, 0.6), test::uniform(random, -1.0, 0.5),
          test::uniform(random, -2.5, -0.4)};
}

// The two numbers by which a leg's stiffness is known, written out: what the statically determinate structure
// gives by the unit-load method.
Matrix6 written_out(const RCubeLinks& links, int leg, const Vector3& q) {
  const double l1 = links.geometry.drive_link, l2 = links.geometry.inner_link, l3 = links.geometry.outer_link;
  const double EA1 = links.rigidity[0].axial, EA2 = links.rigidity[1].axial, EA3 = links.rigidity[2].axial;
  const double EI1 = links.rigidity[0].bending_y, EI2 = links.rigidity[1].bending_y,
               EI3 = links.rigidity[2].bending_y;
  const double GJ1 = links.rigidity[0].torsion, GJ2 = links.rigidity[1].torsion,
               GJ3 = links.rigidity[2].torsion;
  const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]),
               s = std::sin(q[1] + q[2]), c = std::cos(q[1] + q[2]);
  const double y = -l2 * s2 - l3 * s, z = l2 * c2 + l3 * c;
  (void)EA2;  // the wrenches that a leg carries pull on neither of the outer links
  (void)EA3;
  const double t = c1 * c1 / GJ1 + s1 * s1 / EI1;
  const double ff =
      l1 * s1 * s1 / EA1 + c1 * c1 * std::pow(l1, 3) / (3 * EI1) + y * y * l1 * t + l2 * y * y * c2 * c2 / GJ2 +
      (l2 * y * y * s2 * s2 + y * s2 * l2 * l2 + std::pow(l2, 3) / 3) / EI2 + l3 * z * z * s * s / GJ3 +
      (std::pow(l3, 3) / 3 - z * c * l3 * l3 + z * z * c * c * l3) / EI3;
  const double fm = -y * l1 * t - y * c2 * c2 * l2 / GJ2 - (y * s2 * s2 * l2 + s2 * l2 * l2 / 2) / EI2 +
                    l3 * z * s * c / GJ3 + (s * l3 * l3 / 2 - z * c * s * l3) / EI3;
  const double mm = l1 * t + l2 * (c2 * c2 / GJ2 + s2 * s2 / EI2) + l3 * (c * c / GJ3 + s * s / EI3);
  Eigen::Matrix<double, 6, 2> N = Eigen::Matrix<double, 6, 2>::Zero();
  N(r_cube_axis(leg, 0), 0) = 1.0;
  N(3 + r_cube_axis(leg, 1), 0) = -z;
  N(3 + r_cube_axis(leg, 2), 1) = 1.0;
  const Eigen::Matrix2d D = (Eigen::Matrix2d() << ff, fm, fm, mm).finished();
  return N * D.inverse() * N.transpose();
}

TEST(RCubeLegElasticity, IsTheWrittenOutFormInEveryPosture) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 300; ++i) {
    const RCubeLinks links = links_of(test::random_r_cube(random));
    const int leg = i % 3;
    const Vector3 q = random_angles(random);
    const Matrix6 expected = written_out(links, leg, q), K = r_cube_leg_elasticity(links, leg, q).stiffness;
    EXPECT_LT((K - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff());
  }
}

TEST(RCubeLegElasticity, IsWhatTheGeneralMethodFindsOfEachLeg) {
  std::mt19937_64 random(12);
  Description device = test::r_cube_device();
  const char* names[] = {"drive_link", "inner_link", "outer_link"};
  for (std::size_t k = 0; k < 3; ++k)
    device.bodies.push_back({.on = names[k], .beam = TubeDescription{kTubes[k][0], kTubes[k][1], kSteel}});
  const Mechanism mechanism(device);
  const RCubeLinks links = links_of(test::published_r_cube());
  for (int i = 0; i < 100; ++i) {
    const Vector3 theta(test::uniform(random, -0.56, 0.56), test::uniform(random, -0.56, 0.56),
                        test::uniform(random, -0.56, 0.56));
    const RCubeSolution closed = r_cube_forward(links.geometry, theta);
    const Solution general = solve_forward(mechanism, theta);
    ASSERT_TRUE(closed.closed() && general);
    const Stiffness K = stiffness(*general.posture);
    const Matrix6 sum = r_cube_stiffness(links, closed);
    EXPECT_LT((K.matrix - sum).cwiseAbs().maxCoeff(), 1e-9 * sum.cwiseAbs().maxCoeff());
    for (int leg = 0; leg < 3; ++leg) {
      const Vector3 q(closed.theta[leg], closed.swing[leg], closed.elbow[leg]);
      const Matrix6 own = r_cube_leg_elasticity(links, leg, q).stiffness;
      EXPECT_LT((K.legs[leg].matrix() - own).cwiseAbs().maxCoeff(), 1e-9 * own.cwiseAbs().maxCoeff());
    }
  }
}

TEST(RCubeDeflection, OfTheDeterminateStructureNeedsNoInverse) {
  std::mt19937_64 random(14);
  const RCubeLinks links = links_of(test::published_r_cube());
  for (int i = 0; i < 100; ++i) {
    const Vector3 theta(test::uniform(random, -0.56, 0.56), test::uniform(random, -0.56, 0.56),
                        test::uniform(random, -0.56, 0.56));
    const RCubeSolution at = r_cube_forward(links.geometry, theta);
    ASSERT_TRUE(at.closed());
    Vector6 load;
    for (double& component : load) component = test::uniform(random, -10.0, 10.0);
    load.tail<3>() *= 0.1;
    const Vector6 u = r_cube_deflection(links, at, load), back = r_cube_stiffness(links, at) * u;
    EXPECT_LT((back - load).norm(), 1e-9 * load.norm());
  }
}

TEST(RCubeLegElasticity, OfLockedJointsIsACantilever) {
  // At zero angles all links lie along e_c: one beam of their whole length.
  RCubeLinks links = links_of(test::published_r_cube());
  links.rigidity[1] = links.rigidity[2] = links.rigidity[0];
  const Matrix6 C = r_cube_leg_elasticity(links, 2, Vector3::Zero()).compliance;
  const BeamFlexibility whole = beam_flexibility(links.rigidity[0], links.geometry.total_length());
  // Leg 3: e_a = e3, e_b = e1, e_c = e2.
  EXPECT_NEAR(C(1, 1) / whole.stretch, 1.0, 1e-12);
  EXPECT_NEAR(C(0, 0) / whole.deflection_y, 1.0, 1e-12);
  EXPECT_NEAR(C(2, 2) / whole.deflection_y, 1.0, 1e-12);
  EXPECT_NEAR(C(4, 4) / whole.twist, 1.0, 1e-12);
}

TEST(RCubeLegElasticity, UnderASmallLoadIsTheUnloadedOneAndKeepsItsRank) {
  std::mt19937_64 random(13);
  const RCubeLinks links = links_of(test::published_r_cube());
  const Vector6 wrench = (Vector6() << 10, -5, 8, 1, 2, -1).finished();
  for (int i = 0; i < 20; ++i) {
    const Vector3 q = random_angles(random);
    const Matrix6 K = r_cube_leg_elasticity(links, i % 3, q).stiffness;
    const auto change = [&](double load) {
      return (r_cube_leg_elasticity(links, i % 3, q, load * wrench).stiffness - K).norm() / K.norm();
    };
    EXPECT_EQ(change(0.0), 0.0);
    EXPECT_NEAR(change(2e-3) / change(1e-3), 2.0, 1e-2);  // in proportion to the load
    const Matrix6 loaded = r_cube_leg_elasticity(links, i % 3, q, 10.0 * wrench).stiffness;
    const Eigen::JacobiSVD<Matrix6> svd(loaded);
    EXPECT_LT(svd.singularValues()[2], 1e-10 * svd.singularValues()[0]);
    EXPECT_GT(svd.singularValues()[1], 1e-6 * svd.singularValues()[0]);
  }
}

TEST(RCubeLoadedLeg, GoesOnFromTheDirectStepToWhatStays) {
  const RCubeLinks links = links_of(test::published_r_cube());
  const Vector3 q(0.2, -0.4, -1.2);
  const Vector6 wrench = (Vector6() << 100, -50, 80, 10, 20, -10).finished();
  const Matrix6 direct = r_cube_leg_elasticity(links, 1, q, wrench).stiffness;
  const RCubeLoadedLeg once = r_cube_loaded_leg(links, 1, q, wrench, 1e-12, 1);
  EXPECT_FALSE(once.converged);
  EXPECT_EQ(once.elasticity.stiffness, direct);
  const RCubeLoadedLeg balanced = r_cube_loaded_leg(links, 1, q, wrench);
  ASSERT_TRUE(balanced.converged);
  EXPECT_GT(balanced.iterations, 2);
  EXPECT_LE(balanced.residual, 1e-12);
  // From there, nothing more changes; and the direct step was near, in proportion to the load squared.
  const RCubeLoadedLeg more = r_cube_loaded_leg(links, 1, q, wrench, 0.0, balanced.iterations + 5);
  EXPECT_LT((more.elasticity.stiffness - balanced.elasticity.stiffness).norm(), 1e-10 * direct.norm());
  const auto off = [&](double load) {
    return (r_cube_leg_elasticity(links, 1, q, load * wrench).stiffness -
            r_cube_loaded_leg(links, 1, q, load * wrench).elasticity.stiffness)
        .norm();
  };
  EXPECT_NEAR(off(0.02) / off(0.01), 4.0, 0.2);
  EXPECT_FALSE(r_cube_loaded_leg(links, 1, q, 1e6 * wrench).converged);
}

TEST(RCubeLegElasticity, TakesOtherLengthsForTheLinksOwnStiffness) {
  RCubeLinks links = links_of(test::published_r_cube());
  const Vector3 q(0.2, -0.4, -1.2);
  const Matrix6 plain = r_cube_leg_elasticity(links, 0, q).compliance;
  links.stiffness_lengths = Vector3(0.1117, 0.0741, 0.1218);
  EXPECT_EQ(r_cube_leg_elasticity(links, 0, q).compliance, plain);
  links.stiffness_lengths = Vector3(0.2, 0.1, 0.2);
  EXPECT_GT(r_cube_leg_elasticity(links, 0, q).compliance(0, 0), plain(0, 0));
}

}  // namespace
}  // namespace zwidth
