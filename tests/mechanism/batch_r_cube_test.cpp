#include "zwidth/mechanism/batch_r_cube.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "support/r_cubes.h"

namespace zwidth {
namespace {

TEST(RCubeStiffnessBatch, IsTheStiffnessOfEachPosture) {
  std::mt19937_64 random(41);
  for (const int elbow : {-1, 1}) {
    RCubeLinks links{.geometry = test::published_r_cube(), .rigidity = {}};
    const double tubes[3][2] = {{0.03, 0.0225}, {0.024, 0.018}, {0.0144, 0.0108}};
    for (std::size_t k = 0; k < 3; ++k)
      links.rigidity[k] = beam_rigidity(*tube_section(tubes[k][0], tubes[k][1]), 200e9, 200e9 / 2.6);
    constexpr std::size_t n = 203;  // no multiple of the lanes
    std::vector<double> x(n), y(n), z(n), K(21 * n), figures(kRCubeElasticFigures * n);
    for (std::size_t p = 0; p < n; ++p) {
      x[p] = 0.1117 + test::uniform(random, -0.06, 0.06);
      y[p] = 0.1117 + test::uniform(random, -0.06, 0.06);
      z[p] = 0.1117 + test::uniform(random, -0.06, 0.06);
    }
    const RCubeStiffnessBatch batch(links, elbow);
    batch.stiffness(x, y, z, K);
    batch.figures(x, y, z, figures);
    for (std::size_t p = 0; p < n; ++p) {
      const RCubeSolution at =
          r_cube_inverse(links.geometry, {x[p], y[p], z[p]}, {-1.5, 1.5}, r_cube_branches(0, elbow));
      ASSERT_TRUE(at.closed());
      const Matrix6 expected = r_cube_stiffness(links, at);
      const double size = expected.cwiseAbs().maxCoeff();
      std::size_t e = 0;
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c <= r; ++c) EXPECT_NEAR(K[e++ * n + p], expected(r, c), 1e-9 * size) << r << c;
      }
      Matrix3 give;
      for (int a = 0; a < 3; ++a) give.col(a) = r_cube_deflection(links, at, Vector6::Unit(a)).head<3>();
      const int rows[] = {0, 1, 2, 0, 0, 1}, columns[] = {0, 1, 2, 1, 2, 2};
      for (std::size_t f = 0; f < 6; ++f)
        EXPECT_NEAR(figures[f * n + p], give(rows[f], columns[f]), 1e-9 * give.cwiseAbs().maxCoeff()) << f;
      const Vector3 ends = Eigen::SelfAdjointEigenSolver<Matrix3>(give).eigenvalues();
      EXPECT_NEAR(figures[6 * n + p] * ends[2], 1.0, 1e-9);
      EXPECT_NEAR(figures[7 * n + p] * ends[0], 1.0, 1e-7);
    }
  }
}

TEST(RCubeStiffnessBatch, HasNoNumberWhereALegDoesNotReachOrIsSingular) {
  RCubeLinks links{.geometry = {.drive_link = 0.1, .inner_link = 0.06, .outer_link = 0.04, .base_offset = 0.1},
                   .rigidity = {}};
  links.rigidity.fill(beam_rigidity(*tube_section(0.02, 0.01), 200e9, 77e9));
  const std::vector<double> x = {0.1, 0.15, 0.5}, y = {0.1, 0.15, 0.1}, z = {0.1, 0.15, 0.1};
  std::vector<double> K(21 * 3), figures(kRCubeElasticFigures * 3);
  const RCubeStiffnessBatch batch(links);
  batch.stiffness(x, y, z, K);
  batch.figures(x, y, z, figures);
  for (std::size_t p = 0; p < 3; ++p) {  // stretched, out of reach, beyond the drive link
    EXPECT_TRUE(std::isnan(K[p])) << p;
    EXPECT_TRUE(std::isnan(figures[p])) << p;
    EXPECT_TRUE(std::isnan(figures[6 * 3 + p])) << p;
  }
}

}  // namespace
}  // namespace zwidth
