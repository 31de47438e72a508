#include "zwidth/math/beam.h"

#include <gtest/gtest.h>

namespace zwidth {
namespace {

const BeamRigidity kBeam{.axial = 3e6, .bending_y = 120.0, .bending_z = 47.0, .torsion = 63.0};

TEST(Beam, ComplianceAndStiffnessAreInverses) {
  const double length = 0.17;
  const Matrix6 product = beam_stiffness(kBeam, length) * beam_compliance(kBeam, length);
  // Scaled by the length, all entries are of one size.
  const Vector6 scale = (Vector6() << 1, 1, 1, length, length, length).finished();
  const Matrix6 pure = scale.asDiagonal() * product * scale.cwiseInverse().asDiagonal();
  EXPECT_LT((pure - Matrix6::Identity()).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Beam, BendsAsTheMomentsAlongItSay) {
  // The unit-load method: deflection = integral of M m/(E I) over the length, by Simpson's rule, which is exact
  // for products of two straight lines.
  const double L = 0.17;
  const Matrix6 C = beam_compliance(kBeam, L);
  // Moments about y and z at a distance x from the held end, per force along y and z and moment about y and z.
  const auto about_z = [&](int load, double x) { return load == 1 ? L - x : load == 5 ? 1.0 : 0.0; };
  const auto about_y = [&](int load, double x) { return load == 2 ? -(L - x) : load == 4 ? 1.0 : 0.0; };
  const auto simpson = [&](auto f) { return L / 6.0 * (f(0.0) + 4.0 * f(0.5 * L) + f(L)); };
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      double expected = simpson([&](double x) {
        return about_z(i, x) * about_z(j, x) / kBeam.bending_z +
               about_y(i, x) * about_y(j, x) / kBeam.bending_y;
      });
      if (i == 0 && j == 0) expected = L / kBeam.axial;
      if (i == 3 && j == 3) expected = L / kBeam.torsion;
      EXPECT_NEAR(C(i, j), expected, 1e-15 * C.cwiseAbs().maxCoeff()) << i << j;
    }
  }
}

TEST(Beam, InTwoPiecesIsTheWhole) {
  // The compliance of two beams in a row: the inner one is loaded through the outer one's length.
  const double inner = 0.06, outer = 0.11;
  Matrix6 carry = Matrix6::Identity();  // displacement of the end per displacement of the joint between
  carry.topRightCorner<3, 3>() = -cross_matrix(Vector3(outer, 0.0, 0.0));
  const Matrix6 both =
      carry * beam_compliance(kBeam, inner) * carry.transpose() + beam_compliance(kBeam, outer);
  const Matrix6 whole = beam_compliance(kBeam, inner + outer);
  EXPECT_LT((both - whole).cwiseAbs().maxCoeff(), 1e-14 * whole.cwiseAbs().maxCoeff());
}

TEST(Beam, RigidityTakesTheModulusAlongItInBending) {
  const Section section = *bar_section(0.01, 0.02);
  const BeamRigidity own = beam_rigidity(section, 70e9, 26e9), mixed = beam_rigidity(section, 70e9, 9e9, 26e9);
  EXPECT_EQ(own.axial, 70e9 * section.area);
  EXPECT_EQ(own.bending_y, 70e9 * section.second_moment_y);
  EXPECT_GT(own.bending_y, own.bending_z);  // the height is the larger one
  EXPECT_EQ(mixed.axial, own.axial);
  EXPECT_EQ(mixed.bending_z, 9e9 * section.second_moment_z);
  EXPECT_EQ(mixed.torsion, own.torsion);
}

}  // namespace
}  // namespace zwidth
