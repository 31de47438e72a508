#include "zwidth/math/section.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace zwidth {
namespace {

TEST(TubeSection, IsTheDifferenceOfTwoDiscs) {
  const Section tube = *tube_section(0.02, 0.01), outer = *tube_section(0.02, 0.0),
                inner = *tube_section(0.01, 0.0);
  EXPECT_NEAR(outer.area, std::numbers::pi * 1e-4, 1e-18);
  EXPECT_NEAR(outer.second_moment_y, std::numbers::pi / 4.0 * 1e-8, 1e-22);
  EXPECT_NEAR(tube.area, outer.area - inner.area, 1e-18);
  EXPECT_NEAR(tube.second_moment_y, outer.second_moment_y - inner.second_moment_y, 1e-22);
  EXPECT_EQ(tube.second_moment_z, tube.second_moment_y);
  EXPECT_EQ(tube.torsion_constant, 2.0 * tube.second_moment_y);
}

TEST(TubeSection, ThinWallsKeepTheirDigits) {
  const double wall = 1e-9, mean = 0.01;
  const Section tube = *tube_section(mean + wall, mean - wall);
  EXPECT_NEAR(tube.area / (std::numbers::pi * mean * wall), 1.0, 1e-7);
}

TEST(TubeSection, RefusesImpossibleDiameters) {
  EXPECT_FALSE(tube_section(0.01, 0.01));
  EXPECT_FALSE(tube_section(0.01, -0.001));
  EXPECT_FALSE(tube_section(0.0, 0.0));
  EXPECT_FALSE(tube_section(HUGE_VAL, 0.0));
  EXPECT_FALSE(tube_section(0.01, NAN));
  EXPECT_TRUE(tube_section(0.01, 0.0));
}

TEST(BarSection, HasTheTabulatedTorsionConstants) {
  // k in J = k a b^3 (Timoshenko & Goodier 1970, section 109, table).
  const std::pair<double, double> table[] = {
      {1.0, 0.1406}, {1.5, 0.196}, {2.0, 0.229}, {3.0, 0.263}, {10.0, 0.312}};
  for (const auto& [ratio, k] : table) {
    const Section wide = *bar_section(ratio * 0.01, 0.01), high = *bar_section(0.01, ratio * 0.01);
    EXPECT_NEAR(wide.torsion_constant / (ratio * 1e-8), k, 6e-4) << ratio;
    EXPECT_EQ(wide.torsion_constant, high.torsion_constant);
    EXPECT_DOUBLE_EQ(wide.second_moment_y, high.second_moment_z);
    EXPECT_GT(wide.second_moment_z + 1e-20, wide.second_moment_y);  // wide: stiffer about z
  }
  EXPECT_FALSE(bar_section(0.0, 0.01));
  EXPECT_FALSE(bar_section(0.01, -0.01));
}

TEST(LinkMass, IsTheSumOfItsSlices) {
  // Discs of a tube, with their own inertia and the parallel axis.
  const double L = 0.12, rho = 1800.0, D = 0.015, d = 0.011;
  const Section tube = *tube_section(D, d);
  const LinkMass link = link_mass(tube, L, rho);
  double mass = 0.0, transverse = 0.0, axial = 0.0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double x = ((k + 0.5) / n - 0.5) * L, slice = rho * tube.area * L / n;
    mass += slice;
    axial += slice * (D * D + d * d) / 8.0;
    transverse += slice * ((D * D + d * d) / 16.0 + x * x);
  }
  EXPECT_NEAR(link.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(link.about_axis, axial, 1e-12 * axial);
  EXPECT_NEAR(link.about_y, transverse, 1e-8 * transverse);
  EXPECT_EQ(link.about_z, link.about_y);
}

TEST(LaminatedTube, HasTheWallOfItsPlies) {
  const TubeDiameters tube = *laminated_tube(36, 0.15e-3, 0.75);
  EXPECT_NEAR((tube.outer - tube.inner) / 2.0, 36 * 0.15e-3, 1e-15);
  EXPECT_NEAR(tube.inner / tube.outer, 0.75, 1e-15);
  EXPECT_NEAR(tube.outer, 2.0 * 0.0216, 1e-15);  // Görgülü 2018, table 7.7, solution 1: printed as a diameter
  EXPECT_FALSE(laminated_tube(0, 0.15e-3, 0.75));
  EXPECT_FALSE(laminated_tube(5, 0.0, 0.75));
  EXPECT_FALSE(laminated_tube(5, 0.15e-3, 1.0));
  EXPECT_FALSE(laminated_tube(5, 0.15e-3, -0.1));
}

}  // namespace
}  // namespace zwidth
