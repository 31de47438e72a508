#include "zwidth/design/sensitivity.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "design/problems.h"

namespace zwidth {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A linear figure and a curved one.
BatchEvaluation two_figures() {
  return test::row_by_row(2, 2, [](std::span<const double> x, std::span<double> f) {
    f[0] = 3.0 * x[0] - 2.0 * x[1] + 1.0;
    f[1] = x[0] * x[0] * x[1];
  });
}

TEST(Sensitivity, SlopesAreDerivativesAndTheBendIsWhatALineMisses) {
  const std::vector<double> design = {2.0, 5.0}, steps = {1e-3, 1e-3};
  const Sensitivity s = sensitivity(two_figures(), design, steps, 2);
  EXPECT_TRUE(s.complete);
  EXPECT_EQ(s.nominal, (std::vector<double>{-3.0, 20.0}));
  EXPECT_NEAR(s.slope[0], 3.0, 1e-10);
  EXPECT_NEAR(s.slope[1], -2.0, 1e-10);
  EXPECT_NEAR(s.slope[2], 20.0, 1e-9);  // 2 x y
  EXPECT_NEAR(s.slope[3], 4.0, 1e-9);   // x^2
  // f'' h^2 / 2 over f' h, f'' = 2 y.
  EXPECT_NEAR(s.bend[2], 10.0 * 1e-3 / 2.0 / 20.0, 1e-8);
  EXPECT_NEAR(s.bend[0], 0.0, 1e-9);
}

TEST(Sensitivity, OneSideIsEnoughAndNoneIsNaN) {
  const BatchEvaluation root = test::row_by_row(1, 2, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0] > 1.0 ? kNaN : 2.0 * x[0];
    f[1] = x[0] == 1.0 ? 0.0 : kNaN;
  });
  const Sensitivity s = sensitivity(root, std::vector<double>{1.0}, std::vector<double>{0.25}, 2);
  EXPECT_DOUBLE_EQ(s.slope[0], 2.0);
  EXPECT_TRUE(std::isnan(s.bend[0]));
  EXPECT_TRUE(std::isnan(s.slope[1]));
}

TEST(Sensitivity, WorstCornerIsTheWorstOfAll) {
  const std::vector<double> slope = {1.0, -2.0, 0.5, 3.0, 1.0, -1.0}, size = {0.1, 0.2, 0.3};
  const LinearSpread spread = linear_spread(slope, size);
  EXPECT_NEAR(spread.deviation[0], std::sqrt(0.01 + 0.16 + 0.0225), 1e-15);
  EXPECT_NEAR(spread.deviation[1], std::sqrt(0.09 + 0.04 + 0.09), 1e-15);
  double worst = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double error[2] = {0.0, 0.0};
    for (std::size_t v = 0; v < 3; ++v) {
      const double by = (corner >> v & 1) != 0 ? size[v] : -size[v];
      error[0] += slope[v] * by;
      error[1] += slope[3 + v] * by;
    }
    worst = std::max(worst, std::hypot(error[0], error[1]));
  }
  EXPECT_NEAR(spread.worst, worst, 1e-15);
  EXPECT_EQ(spread.worst_sign[0], 1.0);
}

TEST(Sensitivity, SpreadOfALinearFigureIsThatOfItsSlopes) {
  const std::vector<double> design = {2.0, 5.0};
  const std::vector<Tolerance> tolerances = {
      {.size = 0.1},  // uniform +-0.1
      {.spread = Tolerance::Spread::normal, .size = 0.02, .relative = true}};
  const ToleranceStudy study = tolerance_study(two_figures(), design, tolerances, 2);
  ASSERT_TRUE(study.complete);
  const double deviation = std::hypot(3.0 * 0.1 / std::sqrt(3.0), 2.0 * 0.1);
  const OutcomeSpread& linear = study.outcomes[0];
  EXPECT_EQ(linear.nominal, -3.0);
  EXPECT_EQ(linear.undefined, 0);
  EXPECT_NEAR(linear.linear_deviation, deviation, 1e-9);
  // 10^4 samples give the deviation to 1/sqrt(2 n) = 0.7 %; four of those.
  EXPECT_NEAR(linear.standard_deviation, deviation, 0.028 * deviation);
  EXPECT_LT(linear.mean.low, -3.0);
  EXPECT_GT(linear.mean.high, -3.0);
  EXPECT_NEAR(linear.mean.high - linear.mean.value, 1.96 * linear.standard_deviation / 100.0, 1e-5);
}

TEST(Sensitivity, PercentilesOfAUniformFigureAreItsShares) {
  const BatchEvaluation same =
      test::row_by_row(1, 1, [](std::span<const double> x, std::span<double> f) { f[0] = std::exp(x[0]); });
  const std::vector<Tolerance> tolerances = {{.size = 1.0}};
  int held = 0;
  constexpr int kSeeds = 40;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const ToleranceStudy study = tolerance_study(same, std::vector<double>{0.0}, tolerances, 1,
                                                 {.samples = 2000, .seed = static_cast<std::uint64_t>(seed)});
    const OutcomeSpread& spread = study.outcomes[0];
    // x is uniform in -1..1, so the p-th percentile of exp(x) is exp(2 p - 1).
    for (const auto& [estimate, p] : {std::pair(spread.percentile_5, 0.05), std::pair(spread.median, 0.5),
                                      std::pair(spread.percentile_95, 0.95)}) {
      const double exact = std::exp(2.0 * p - 1.0);
      EXPECT_NEAR(estimate.value, exact, 0.03 * 2.0 * exact);
      EXPECT_LE(estimate.low, estimate.value);
      EXPECT_GE(estimate.high, estimate.value);
      held += estimate.low <= exact && exact <= estimate.high ? 1 : 0;
    }
  }
  // 95 % of 120 is 114 +- 2.4.
  EXPECT_GE(held, 105);
  EXPECT_LT(held, 120);
}

TEST(Sensitivity, ShareOfBrokenSamplesIsTheChanceOfIt) {
  // One constraint is broken above 0.5 of -1..1, that is in a quarter; the other in places undefined.
  const BatchEvaluation limits = test::row_by_row(1, 3, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0];
    f[1] = x[0] - 0.5;
    f[2] = x[0] < -0.9 ? kNaN : -1.0;
  });
  const std::vector<Tolerance> tolerances = {{.size = 1.0}};
  const ToleranceStudy study =
      tolerance_study(limits, std::vector<double>{0.0}, tolerances, 3, {.constraints = 2});
  EXPECT_NEAR(study.broken_by[0], 0.25, 0.02);
  EXPECT_NEAR(study.broken_by[1], 0.05, 0.01);
  EXPECT_NEAR(study.broken.value, 0.30, 0.02);
  EXPECT_LT(study.broken.low, 0.30);
  EXPECT_GT(study.broken.high, 0.30);
  EXPECT_NEAR(static_cast<double>(study.outcomes[2].undefined), 500.0, 100.0);
}

TEST(Sensitivity, TwoDesignsMeetTheSameDeviations) {
  const std::vector<Tolerance> tolerances = {{.size = 0.1}, {.size = 0.1}};
  const ToleranceStudy a =
      tolerance_study(two_figures(), std::vector<double>{2.0, 5.0}, tolerances, 2, {.samples = 100});
  const ToleranceStudy b =
      tolerance_study(two_figures(), std::vector<double>{3.0, 5.0}, tolerances, 2, {.samples = 100});
  // The linear figure is 3 larger in every sample, not only in the mean.
  EXPECT_NEAR(b.outcomes[0].mean.value - a.outcomes[0].mean.value, 3.0, 1e-12);
  EXPECT_NEAR(b.outcomes[0].percentile_95.value - a.outcomes[0].percentile_95.value, 3.0, 1e-12);
}

TEST(Sensitivity, WhatIsExactlyAsDrawnDoesNotSpread) {
  const std::vector<Tolerance> tolerances = {{.size = 0.0}, {.size = 0.0}};
  const ToleranceStudy study =
      tolerance_study(two_figures(), std::vector<double>{2.0, 5.0}, tolerances, 2, {.samples = 50});
  EXPECT_EQ(study.outcomes[1].standard_deviation, 0.0);
  EXPECT_EQ(study.outcomes[1].linear_deviation, 0.0);
  EXPECT_EQ(study.outcomes[1].median.value, 20.0);
}

TEST(Sensitivity, AStopLeavesItIncomplete) {
  int calls = 0;
  const BatchEvaluation stops = [&](std::span<const double>, std::span<double> rows) {
    std::fill(rows.begin(), rows.end(), 0.0);
    return ++calls < 3;
  };
  const std::vector<Tolerance> tolerances = {{.size = 1.0}};
  EXPECT_FALSE(tolerance_study(stops, std::vector<double>{0.0}, tolerances, 1).complete);
}

}  // namespace
}  // namespace zwidth
