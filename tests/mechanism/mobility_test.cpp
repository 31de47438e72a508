#include "zwidth/mechanism/mobility.h"

#include <gtest/gtest.h>

#include "support/deltas.h"

namespace zwidth {
namespace {

TEST(Mobility, OfTheDeltaIsThree) {
  const Mechanism delta(test::with_bodies(test::published_delta()));
  const Mobility count = mobility(*solve_forward(delta, Vector3(0.1, 0.2, 0.3)).posture);
  EXPECT_EQ(count.gruebler, 3);
  EXPECT_EQ(count.freedoms, 3);
  EXPECT_EQ(count.tool_freedoms, 3);
  EXPECT_EQ(count.redundant_equations, 0);
  EXPECT_EQ(count.active, 3);
}

TEST(Mobility, OfParallelogramsOnAFreePlatformNeedsTheRank) {
  const Mechanism delta(test::with_parallelograms(test::published_delta()));
  const Mobility count = mobility(*solve_forward(delta, Vector3(0.1, 0.2, 0.3)).posture);
  EXPECT_EQ(count.gruebler, 0);  // three equations say again that the platform does not turn
  EXPECT_EQ(count.redundant_equations, 3);
  EXPECT_EQ(count.freedoms, 3);
  EXPECT_EQ(count.tool_freedoms, 3);
}

}  // namespace
}  // namespace zwidth
