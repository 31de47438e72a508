#include "zwidth/analysis/stiffness_sheet.h"

#include <gtest/gtest.h>

#include "support/r_cubes.h"

#include "zwidth/mechanism/stiffness.h"

namespace zwidth {
namespace {

const Material kSteel{.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = 7850.0};

Description tubes() {
  Description device = test::r_cube_device();
  for (const char* link : {"drive_link", "inner_link", "outer_link"}) {
    device.bodies.push_back({.on = link, .beam = TubeDescription{0.01, 0.006, kSteel}});
  }
  return device;
}

TEST(StiffnessSheet, HasTheExtremesOfItsPostures) {
  const Mechanism mechanism(tubes());
  const std::vector<std::optional<Drive>> none(3);
  const auto sheet = stiffness_sheet(mechanism, none, 200);
  ASSERT_TRUE(sheet);
  EXPECT_EQ(sheet->of, Elasticity::links);
  EXPECT_EQ(sheet->postures, 200);
  EXPECT_EQ(sheet->lowest_free.count, 0);  // no rotors
  EXPECT_EQ(sheet->lowest_held.count, 200);
  double least = 1e99, sum = 0.0;
  for (std::int64_t i = 0; i < 200; ++i) {
    const Solution solution = solve_forward(mechanism, spread_posture(mechanism, i));
    const double k = 1.0 / compliance(stiffness(*solution.posture), 0.1).matrix(0, 0);
    least = std::min(least, k);
    sum += k;
  }
  EXPECT_NEAR(sheet->along[0].min, least, 1e-12 * least);
  EXPECT_NEAR(sheet->along[0].mean, sum / 200.0, 1e-9 * sum);
  const Solution softest = solve_forward(mechanism, sheet->along[0].min_at);
  EXPECT_NEAR(1.0 / compliance(stiffness(*softest.posture), 0.1).matrix(0, 0), least, 1e-9 * least);
  EXPECT_LE(sheet->softest.min, sheet->along[0].min);
  EXPECT_GE(sheet->stiffest.max, sheet->along[0].max);
}

TEST(StiffnessSheet, SharesAddUpLargestFirst) {
  const Mechanism mechanism(tubes());
  const auto sheet = stiffness_sheet(mechanism, std::vector<std::optional<Drive>>(3), 100);
  double sum = 0.0, before = 1.0;
  ASSERT_EQ(sheet->shares.size(), 9u);
  for (const GiveShare& one : sheet->shares) {
    EXPECT_LE(one.share, before);
    before = one.share;
    sum += one.share;
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(StiffnessSheet, IsNotThereForRigidLinks) {
  const Mechanism rigid(test::r_cube_device());
  EXPECT_FALSE(stiffness_sheet(rigid, std::vector<std::optional<Drive>>(3), 100));
}

}  // namespace
}  // namespace zwidth
