#include "zwidth/math/laminate.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const PlyModuli kM55j{.longitudinal = 300e9, .transverse = 12e9, .shear = 5e9, .poisson = 0.3};

TEST(TurnedPly, IsTheCompliancesTurnedAsATensor) {
  // The plane-stress compliance as a fourth-order tensor, turned index by index.
  const double E1 = kM55j.longitudinal, E2 = kM55j.transverse, G = kM55j.shear, nu = kM55j.poisson;
  for (const double angle : {0.0, 0.3, -0.7, 45.0 * kDegree, 1.2, 90.0 * kDegree}) {
    double S[2][2][2][2] = {};
    S[0][0][0][0] = 1.0 / E1;
    S[1][1][1][1] = 1.0 / E2;
    S[0][0][1][1] = S[1][1][0][0] = -nu / E1;
    S[0][1][0][1] = S[0][1][1][0] = S[1][0][0][1] = S[1][0][1][0] = 0.25 / G;
    const double R[2][2] = {{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
    const auto turned = [&](int i, int j, int k, int l) {
      double sum = 0.0;
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
          for (int c = 0; c < 2; ++c)
            for (int d = 0; d < 2; ++d) sum += R[i][a] * R[j][b] * R[k][c] * R[l][d] * S[a][b][c][d];
      return sum;
    };
    const WallModuli ply = turned_ply(kM55j, angle);
    EXPECT_NEAR(ply.axial * turned(0, 0, 0, 0), 1.0, 1e-13);
    EXPECT_NEAR(ply.transverse * turned(1, 1, 1, 1), 1.0, 1e-13);
    EXPECT_NEAR(ply.shear * 4.0 * turned(0, 1, 0, 1), 1.0, 1e-13);
  }
}

TEST(MeanModuli, HasTheSourcesShearOnlyWhenAskedFor) {
  const std::array<PlyGroup, 1> diagonal = {{{.angle = 45.0 * kDegree, .count = 4.0}}};
  EXPECT_NEAR(mean_moduli(kM55j, diagonal)->shear, 11.278e9, 5e5);                      // eq 4.69
  EXPECT_NEAR(mean_moduli(kM55j, diagonal, ShearAt45::printed)->shear, 25.862e9, 5e5);  // eq 5.175
  const std::array<PlyGroup, 1> straight = {{{.angle = 0.0, .count = 4.0}}};
  EXPECT_EQ(mean_moduli(kM55j, straight, ShearAt45::printed)->shear, kM55j.shear);
}

TEST(MeanModuli, IsTheMeanByNumbersOfPlies) {
  const std::array<PlyGroup, 3> plies = {{{0.0, 2.0}, {90.0 * kDegree, 6.0}, {-45.0 * kDegree, 4.0}}};
  const WallModuli mean = *mean_moduli(kM55j, plies);
  const WallModuli diagonal = turned_ply(kM55j, -45.0 * kDegree);
  EXPECT_NEAR(mean.axial, (2.0 * 300e9 + 6.0 * 12e9 + 4.0 * diagonal.axial) / 12.0, 1.0);
  EXPECT_NEAR(mean.transverse, (2.0 * 12e9 + 6.0 * 300e9 + 4.0 * diagonal.transverse) / 12.0, 1.0);
}

TEST(LaminateModuli, OfOneKindOfPliesAreThoseOfThePly) {
  for (const double angle : {0.0, 0.4, 45.0 * kDegree, -1.1}) {
    const std::array<PlyGroup, 2> plies = {{{angle, 3.0}, {angle, 1.0}}};
    const WallModuli one = turned_ply(kM55j, angle), laminate = *laminate_moduli(kM55j, plies);
    EXPECT_NEAR(laminate.axial / one.axial, 1.0, 1e-12);
    EXPECT_NEAR(laminate.transverse / one.transverse, 1.0, 1e-12);
    EXPECT_NEAR(laminate.shear / one.shear, 1.0, 1e-12);
  }
}

TEST(LaminateModuli, AreTheMeanOfStiffnessesForIsotropicAndQuasiIsotropicWalls) {
  // Isotropic plies do not care how they lie.
  const PlyModuli steel{.longitudinal = 200e9, .transverse = 200e9, .shear = 200e9 / 2.6, .poisson = 0.3};
  const std::array<PlyGroup, 4> plies = {
      {{0.0, 1.0}, {90.0 * kDegree, 1.0}, {45.0 * kDegree, 1.0}, {-45.0 * kDegree, 1.0}}};
  const WallModuli wall = *laminate_moduli(steel, plies);
  EXPECT_NEAR(wall.axial, 200e9, 1.0);
  EXPECT_NEAR(wall.shear, 200e9 / 2.6, 1.0);
  // Four directions in equal numbers make every laminate isotropic in its plane: E = 2 G (1 + nu) for some nu,
  // and the same moduli in any direction.
  std::array<PlyGroup, 4> turned = plies;
  for (PlyGroup& group : turned) group.angle += 0.37;
  const WallModuli here = *laminate_moduli(kM55j, plies), there = *laminate_moduli(kM55j, turned);
  EXPECT_NEAR(here.axial / here.transverse, 1.0, 1e-12);
  EXPECT_NEAR(here.axial / there.axial, 1.0, 1e-12);
  EXPECT_NEAR(here.shear / there.shear, 1.0, 1e-12);
  // The mean of the moduli is no such thing.
  EXPECT_GT(std::abs(mean_moduli(kM55j, plies)->axial / mean_moduli(kM55j, turned)->axial - 1.0), 0.01);
}

TEST(LaminateModuli, CrossPlyHasTheTextbookFormula) {
  const std::array<PlyGroup, 2> plies = {{{0.0, 3.0}, {90.0 * kDegree, 1.0}}};
  const double nu21 = 0.3 * 12.0 / 300.0, rigid = 1.0 / (1.0 - 0.3 * nu21);
  const double A11 = rigid * (0.75 * 300e9 + 0.25 * 12e9), A22 = rigid * (0.25 * 300e9 + 0.75 * 12e9),
               A12 = rigid * nu21 * 300e9;
  const WallModuli wall = *laminate_moduli(kM55j, plies);
  EXPECT_NEAR(wall.axial / (A11 - A12 * A12 / A22), 1.0, 1e-12);
  EXPECT_NEAR(wall.transverse / (A22 - A12 * A12 / A11), 1.0, 1e-12);
  EXPECT_NEAR(wall.shear, 5e9, 1.0);
}

TEST(LaminateModuli, RefusesWhatIsNoLaminate) {
  const std::array<PlyGroup, 1> one = {{{0.0, 1.0}}}, none = {{{0.0, 0.0}}}, negative = {{{0.0, -1.0}}};
  EXPECT_TRUE(laminate_moduli(kM55j, one));
  for (const auto& plies : {none, negative}) {
    EXPECT_FALSE(laminate_moduli(kM55j, plies));
    EXPECT_FALSE(mean_moduli(kM55j, plies));
  }
  EXPECT_FALSE(laminate_moduli(kM55j, {}));
  PlyModuli soft = kM55j;
  soft.transverse = 0.0;
  EXPECT_FALSE(mean_moduli(soft, one));
  PlyModuli impossible = kM55j;
  impossible.poisson = 5.1;  // nu12^2 >= E1/E2 = 25
  EXPECT_FALSE(laminate_moduli(impossible, one));
}

TEST(PlyOf, LiesBetweenFibreAndMatrix) {
  const Constituent fibre{.elastic_modulus = 540e9, .shear_modulus = 30e9, .poisson_ratio = 0.2},
      matrix{.elastic_modulus = 3e9, .shear_modulus = 1.1e9, .poisson_ratio = 0.35};
  const PlyModuli ply = *ply_of(fibre, matrix, 0.6);
  EXPECT_NEAR(ply.longitudinal, 0.6 * 540e9 + 0.4 * 3e9, 1.0);
  EXPECT_NEAR(ply.transverse, 540e9 * 3e9 / (0.4 * 540e9 + 0.6 * 3e9), 1.0);
  EXPECT_NEAR(ply.shear, 1.1e9 / (0.4 + 0.6 * 1.1 / 30.0), 1.0);
  EXPECT_EQ(ply_of(fibre, matrix, 0.0)->transverse, 3e9);
  EXPECT_FALSE(ply_of(fibre, matrix, 1.1));
  EXPECT_NEAR(ply.poisson_transverse(), ply.poisson * ply.transverse / ply.longitudinal, 1e-15);
}

}  // namespace
}  // namespace zwidth
