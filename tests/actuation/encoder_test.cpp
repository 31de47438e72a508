#include "zwidth/actuation/encoder.h"

#include <gtest/gtest.h>
#include <numbers>
#include <stdexcept>

namespace zwidth {
namespace {

using std::numbers::pi;

TEST(Encoder, AsPublished) {  // Neal 2015, table 4.3
  EXPECT_EQ(counts_per_turn(1000.0), 4000.0);
  EXPECT_NEAR(encoder_max_speed(200e3, 1000.0), 12000.0 * 2.0 * pi / 60.0, 1e-10);
  EXPECT_DOUBLE_EQ(encoder_resolution(1000.0), 2.0 * pi / 4000.0);
}

TEST(Encoder, RefusesWhatIsNotPositive) {
  EXPECT_THROW(counts_per_turn(0.0), std::invalid_argument);
  EXPECT_THROW(encoder_resolution(-1.0), std::invalid_argument);
  EXPECT_THROW(encoder_max_speed(0.0, 1000.0), std::invalid_argument);
  EXPECT_THROW(encoder_max_speed(Encoder{}), std::invalid_argument);
}

}  // namespace
}  // namespace zwidth
