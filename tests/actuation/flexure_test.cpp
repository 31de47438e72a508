#include "zwidth/actuation/flexure.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace zwidth {
namespace {

Flexure published() {
  return *Flexure::make(55e-3, 15e-3, 4e-3, 2.5e-3, 68.98e9);
}

Flexure random_flexure(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.5, 2.0);
  return *Flexure::make(0.05 * uniform(random), 0.02 * uniform(random), 4e-3 * uniform(random),
                        2e-3 * uniform(random), 7e10 * uniform(random));
}

TEST(Flexure, AsPublished) {  // Neal 2015, table 4.10 and section 4.5.2
  EXPECT_NEAR(published().area_moment(), 5.208e-12, 5e-16);
  EXPECT_NEAR(published().section_modulus(), 4.167e-9, 5e-13);
  EXPECT_NEAR(published().stiffness(), 3173.537, 1e-3);
  EXPECT_NEAR(*published().moment(9.5, 0.0), -0.665, 1e-15);
  EXPECT_NEAR(published().bending_stress(9.5), 159.6e6, 1e3);
  EXPECT_NEAR(*published().safety_factor(9.5, 276e6), 1.73, 5e-3);
  EXPECT_NEAR(*published().deflection(9.5, 70e-3), -2.9935e-3, 5e-8) << "the source prints 3.016 mm";
}

TEST(Flexure, OfOtherDimensions) {
  const Flexure flexure = *Flexure::make(0.04, 0.012, 0.005, 0.002, 7.1e10);
  EXPECT_NEAR(*flexure.deflection(14.0, 0.025), -0.0008072183098591549, 1e-17);
}

TEST(Flexure, StiffnessIsForcePerEndDeflection) {
  std::mt19937 random(1);
  for (int storm = 0; storm < 100; ++storm) {
    const Flexure flexure = random_flexure(random);
    EXPECT_NEAR(flexure.stiffness() * *flexure.deflection(7.0, flexure.length()), -7.0, 1e-13);
  }
}

TEST(Flexure, DeflectionIntegratesTheSlope) {
  std::mt19937 random(2);
  for (int storm = 0; storm < 20; ++storm) {
    const Flexure flexure = random_flexure(random);
    const int steps = 2000;
    const double h = flexure.length() / steps;
    // Midpoint rule; the panel that holds the end of the flexible part errs most, by h^2/8 of the curvature.
    const double curvature = std::abs(*flexure.slope(5.0, h)) / h;
    for (int i = 0; i < steps; ++i) {
      const double a = i * h, b = std::min((i + 1) * h, flexure.length());
      EXPECT_NEAR(*flexure.deflection(5.0, b) - *flexure.deflection(5.0, a),
                  (b - a) * *flexure.slope(5.0, 0.5 * (a + b)), 0.13 * h * h * curvature);
    }
  }
}

TEST(Flexure, SlopeChangesByMomentOverRigidityAndIsConstantInTheRigidPart) {
  const double l1 = 0.03, l2 = 0.02, w = 3e-3, h = 2e-3, E = 7e10, F = 5.0;
  const Flexure flexure = *Flexure::make(l1, l2, w, h, E);
  const double EI = E * w * h * h * h / 12.0;
  for (double x : {0.002, 0.01, 0.028}) {
    const double step = 1e-4;  // the slope is a parabola: the central difference is exact
    const double curvature = (*flexure.slope(F, x + step) - *flexure.slope(F, x - step)) / (2.0 * step);
    EXPECT_NEAR(curvature, *flexure.moment(F, x) / EI, 1e-10 * std::abs(curvature));
  }
  EXPECT_DOUBLE_EQ(*flexure.slope(F, l1 + 1e-9), *flexure.slope(F, l1 + l2));
  EXPECT_NEAR(*flexure.slope(F, l1), *flexure.slope(F, l1 + l2), 1e-16);
  EXPECT_NEAR(*flexure.deflection(F, l1), *flexure.deflection(F, std::nextafter(l1, 1.0)), 1e-15);
}

TEST(Flexure, IsEmptyBeyondItsEnds) {
  for (double x : {-1e-9, 0.0701, std::nan("")}) {
    EXPECT_FALSE(published().deflection(1.0, x).has_value());
    EXPECT_FALSE(published().slope(1.0, x).has_value());
    EXPECT_FALSE(published().moment(1.0, x).has_value());
  }
}

TEST(Flexure, NeedsPositiveDimensions) {
  EXPECT_FALSE(Flexure::make(0.0, 0.01, 1e-3, 1e-3, 1e9).has_value());
  EXPECT_FALSE(Flexure::make(0.01, -0.01, 1e-3, 1e-3, 1e9).has_value());
  EXPECT_FALSE(Flexure::make(0.01, 0.01, 0.0, 1e-3, 1e9).has_value());
  EXPECT_FALSE(Flexure::make(0.01, 0.01, 1e-3, std::nan(""), 1e9).has_value());
  EXPECT_FALSE(Flexure::make(FlexureDescription{}).has_value());
}

TEST(Flexure, HasNoSafetyFactorWithoutAYieldStrengthOrALoad) {
  EXPECT_FALSE(published().safety_factor(9.5, std::nan("")).has_value());
  EXPECT_FALSE(published().safety_factor(0.0, 276e6).has_value());
}

}  // namespace
}  // namespace zwidth
