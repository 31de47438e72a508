#include "zwidth/math/statistics.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace zwidth {
namespace {

TEST(Statistics, OfTheCurrentNoiseAsPublished) {  // Neal 2015, table 4.7
  EXPECT_NEAR(*standard_deviation(120.271), 10.967, 5e-4);
  EXPECT_NEAR(*average_power(120.271, 0.00391, 256), 119.801, 5e-4);
}

TEST(Statistics, PowerIsTheMeanSquareOfTheSamples) {
  const std::array samples{1.0, -2.0, 4.0, 0.5};
  double sum = 0.0, squares = 0.0;
  for (double x : samples) {
    sum += x;
    squares += x * x;
  }
  const double mean = sum / 4.0;
  const double variance = (squares - 4.0 * mean * mean) / 3.0;
  EXPECT_NEAR(*average_power(variance, mean, 4), squares / 4.0, 1e-15);
}

TEST(Statistics, AreEmptyForBadInput) {
  EXPECT_FALSE(standard_deviation(-1.0).has_value());
  EXPECT_FALSE(standard_deviation(std::nan("")).has_value());
  EXPECT_FALSE(average_power(-1.0, 0.0, 4).has_value());
  EXPECT_FALSE(average_power(1.0, std::nan(""), 4).has_value());
  EXPECT_FALSE(average_power(1.0, 0.0, 0).has_value());
  EXPECT_FALSE(frequency_resolution(0.0, 16, 2).has_value());
  EXPECT_FALSE(frequency_resolution(1.0, 16, 0).has_value());
  EXPECT_FALSE(frequency_resolution(1.0, 16, 17).has_value());
}

TEST(Statistics, FrequencyStepOfTheIdentificationAsPublished) {  // Neal 2015, section 6.1
  EXPECT_DOUBLE_EQ(*frequency_resolution(420.0, 16384, 32), 0.8203125);
}

}  // namespace
}  // namespace zwidth
