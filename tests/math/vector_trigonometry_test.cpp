#include "zwidth/math/vector_trigonometry.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "support/storm.h"

namespace zwidth {
namespace {

TEST(VectorTrigonometry, SinesAndCosinesAreThoseOfTheLibrary) {
  std::mt19937_64 random(1);
  for (const double size : {4.0, 1e3, 9.9e4, 1e9}) {  // the last one leaves the vector form
    std::vector<double> angle(test::storm_size(50000) | 1), sine(angle.size()), cosine(angle.size());
    for (double& a : angle) a = std::uniform_real_distribution<double>(-size, size)(random);
    sine_cosines(angle, sine, cosine);
    double worst = 0.0;
    for (std::size_t n = 0; n < angle.size(); ++n) {
      worst =
          std::max({worst, std::abs(sine[n] - std::sin(angle[n])), std::abs(cosine[n] - std::cos(angle[n]))});
    }
    EXPECT_LT(worst, 2.5e-16) << size;
  }
}

TEST(VectorTrigonometry, EveryCountIsServed) {
  for (std::size_t count = 0; count < 20; ++count) {
    std::vector<double> angle(count), sine(count + 1, 7.0), cosine(count + 1, 7.0), back(count + 1, 7.0);
    for (std::size_t n = 0; n < count; ++n) angle[n] = 0.3 * static_cast<double>(n) - 2.0;
    sine_cosines(angle, std::span(sine).first(count), std::span(cosine).first(count));
    angles_of(std::span(cosine).first(count), std::span(sine).first(count), std::span(back).first(count));
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_NEAR(sine[n], std::sin(angle[n]), 2.5e-16);
      EXPECT_NEAR(std::remainder(back[n] - angle[n], 2.0 * std::numbers::pi), 0.0, 2e-15);
    }
    for (const double untouched : {sine[count], cosine[count], back[count]}) EXPECT_EQ(untouched, 7.0);
  }
}

TEST(VectorTrigonometry, WhatIsNoAngleGivesNoNumberAndSpoilsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const double odd : {nan, infinity, -infinity}) {
    std::vector<double> angle(9, 0.5), sine(9), cosine(9);
    angle[3] = odd;
    sine_cosines(angle, sine, cosine);
    for (std::size_t n = 0; n < angle.size(); ++n) {
      if (n == 3) {
        EXPECT_TRUE(std::isnan(sine[n]) && std::isnan(cosine[n]));
      } else {
        EXPECT_NEAR(sine[n], std::sin(0.5), 2.5e-16);
      }
    }
  }
}

TEST(VectorTrigonometry, AnglesAreThoseOfTheLibrary) {
  std::mt19937_64 random(2);
  std::vector<double> cosine(test::storm_size(100000)), sine(cosine.size()), angle(cosine.size());
  for (std::size_t n = 0; n < cosine.size(); ++n) {
    const double a = std::uniform_real_distribution<double>(-std::numbers::pi, std::numbers::pi)(random);
    const double length = std::exp(std::uniform_real_distribution<double>(-20.0, 20.0)(random));
    cosine[n] = length * std::cos(a);
    sine[n] = length * std::sin(a);
  }
  angles_of(cosine, sine, angle);
  double worst = 0.0;
  for (std::size_t n = 0; n < cosine.size(); ++n) {
    worst = std::max(worst, std::abs(angle[n] - std::atan2(sine[n], cosine[n])));
  }
  EXPECT_LT(worst, 5e-16);
}

TEST(VectorTrigonometry, AnglesHoldOnTheAxesAndKeepTheSideOfACut) {
  std::vector<double> cosine, sine;
  for (const double c : {-1.0, 0.0, 1.0}) {
    for (const double s : {-1.0, -0.0, 0.0, 1.0}) {
      cosine.push_back(c);
      sine.push_back(s);
    }
  }
  std::vector<double> angle(cosine.size());
  angles_of(cosine, sine, angle);
  for (std::size_t n = 0; n < cosine.size(); ++n) {
    EXPECT_EQ(angle[n], std::atan2(sine[n], cosine[n])) << cosine[n] << ' ' << sine[n];
  }
}

}  // namespace
}  // namespace zwidth
