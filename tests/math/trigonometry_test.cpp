#include "zwidth/math/trigonometry.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "support/storm.h"

namespace zwidth {
namespace {

TEST(Trigonometry, SineAndCosineAreThoseOfTheLibrary) {
  std::mt19937_64 random(1);
  const int count = test::storm_size(200000);
  double worst = 0.0;
  for (int n = 0; n < count; ++n) {
    const double size = n % 3 == 0 ? 4.0 : n % 3 == 1 ? 1e3 : 9.9e4;
    const double angle = std::uniform_real_distribution<double>(-size, size)(random);
    const SineCosine both = sine_cosine(angle);
    worst = std::max({worst, std::abs(both.sine - std::sin(angle)), std::abs(both.cosine - std::cos(angle))});
  }
  EXPECT_LT(worst, 2.5e-16);
}

TEST(Trigonometry, SineAndCosineHoldAtTheQuartersAndFarOut) {
  for (int quarter = -9; quarter <= 9; ++quarter) {
    for (const double off : {-1e-9, 0.0, 1e-9, std::numbers::pi / 4}) {
      const double angle = 0.5 * std::numbers::pi * quarter + off;
      EXPECT_NEAR(sine_cosine(angle).sine, std::sin(angle), 2.5e-16);
      EXPECT_NEAR(sine_cosine(angle).cosine, std::cos(angle), 2.5e-16);
    }
  }
  for (const double angle : {1e5, -3e7, 1e22}) {
    EXPECT_EQ(sine_cosine(angle).sine, std::sin(angle));
    EXPECT_EQ(sine_cosine(angle).cosine, std::cos(angle));
  }
  EXPECT_EQ(sine_cosine(0.0).sine, 0.0);
  EXPECT_EQ(sine_cosine(0.0).cosine, 1.0);
  for (const double none :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(std::isnan(sine_cosine(none).sine));
    EXPECT_TRUE(std::isnan(sine_cosine(none).cosine));
  }
}

TEST(Trigonometry, AngleIsThatOfTheLibrary) {
  std::mt19937_64 random(2);
  const int count = test::storm_size(200000);
  double worst = 0.0;
  for (int n = 0; n < count; ++n) {
    const double angle = std::uniform_real_distribution<double>(-std::numbers::pi, std::numbers::pi)(random);
    const double length = std::exp(std::uniform_real_distribution<double>(-20.0, 20.0)(random));
    const double c = length * std::cos(angle), s = length * std::sin(angle);
    worst = std::max(worst, std::abs(angle_of(c, s) - std::atan2(s, c)));
  }
  EXPECT_LT(worst, 5e-16);
}

TEST(Trigonometry, AngleHoldsOnTheAxesAndKeepsTheSideOfACut) {
  for (const double c : {-1.0, -0.0, 0.0, 1.0}) {
    for (const double s : {-1.0, -0.0, 0.0, 1.0}) {
      if (c == 0.0 && s == 0.0) continue;
      EXPECT_EQ(angle_of(c, s), std::atan2(s, c)) << c << ' ' << s;
    }
  }
  EXPECT_EQ(angle_of(0.0, 0.0), 0.0);
  EXPECT_TRUE(std::isnan(angle_of(std::numeric_limits<double>::quiet_NaN(), 1.0)));
  EXPECT_TRUE(std::isnan(angle_of(1.0, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace zwidth
