#include "zwidth/design/refine.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <stdexcept>

#include "design/problems.h"

#include "zwidth/design/pareto.h"

namespace zwidth {
namespace {

class Refine : public testing::TestWithParam<RefineMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, Refine,
                         testing::Values(RefineMethod::cobyla, RefineMethod::slsqp, RefineMethod::sbplx),
                         [](const auto& method) { return std::string(to_string(method.param)); });

TEST_P(Refine, FindsTheLeastMaterialThatCarries) {
  const Refinement better =
      refine(test::hyperbola(), std::vector<double>{1.3, 1.2}, {.method = GetParam(), .evaluations = 3000});
  EXPECT_TRUE(better.improved);
  EXPECT_LE(better.outcomes[1], 0.0);
  // Linear models lose their way where the objective is undefined.
  EXPECT_NEAR(better.outcomes[0], 2.0, GetParam() == RefineMethod::cobyla ? 0.05 : 2e-3) << better.reason;
  EXPECT_GE(better.outcomes[0], 2.0);
}

// Both shrink alike: (2 + t)(1 + t) = 1.
TEST_P(Refine, WithoutWeightsBeatsTheStartInEveryObjectiveAlike) {
  const Refinement better =
      refine(test::two_lengths(), std::vector<double>{2.0, 1.0}, {.method = GetParam(), .evaluations = 3000});
  EXPECT_TRUE(better.improved);
  EXPECT_NEAR(better.design[0], std::numbers::phi, 5e-3) << better.reason;
  EXPECT_NEAR(better.design[1], std::numbers::phi - 1.0, 5e-3);
  EXPECT_LE(better.outcomes[2], 0.0);
  EXPECT_TRUE(dominates(std::span<const double>(better.outcomes).first(2), std::vector<double>{2.0, 1.0}));
}

// w_x x/4 = w_y y/4 on x y = 1: x = sqrt(w_y/w_x), but for the thousandth of the sum.
TEST_P(Refine, WeightsDecideWhereOnTheFront) {
  const Refinement better = refine(test::two_lengths(), std::vector<double>{2.0, 1.0},
                                   {.method = GetParam(),
                                    .evaluations = 3000,
                                    .ideal = {0.0, 0.0},
                                    .nadir = {4.0, 4.0},
                                    .weights = {1.0, 4.0}});
  EXPECT_TRUE(better.improved);
  EXPECT_NEAR(better.design[0], 2.0, 1e-2) << better.reason;
  EXPECT_NEAR(better.design[1], 0.5, 1e-2);
}

TEST_P(Refine, LeavesWhatIsNotFeasible) {
  const Refinement better =
      refine(test::hyperbola(), std::vector<double>{0.8, 0.7}, {.method = GetParam(), .evaluations = 3000});
  EXPECT_TRUE(better.improved);
  EXPECT_LE(better.outcomes[1], 0.0) << better.reason;
  EXPECT_FALSE(std::isnan(better.outcomes[0]));
}

// Where it is smooth, all the way: the valley of Rosenbrock 1960, whose lowest point is (1, 1).
TEST_P(Refine, FollowsACurvedValley) {
  SearchProblem problem{.variables = {{"x", -2.0, 2.0}, {"y", -1.0, 3.0}}, .objectives = {"f"}};
  problem.evaluate = test::row_by_row(2, 1, [](std::span<const double> x, std::span<double> f) {
    f[0] = 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  });
  const Refinement better = refine(problem, std::vector<double>{-1.2, 1.0},
                                   {.method = GetParam(), .evaluations = 20'000, .tolerance = 1e-9});
  // A linear model follows a valley slowly.
  const double tolerance = GetParam() == RefineMethod::cobyla ? 0.2 : 1e-3;
  EXPECT_NEAR(better.design[0], 1.0, tolerance) << better.reason;
  EXPECT_NEAR(better.design[1], 1.0, 2.0 * tolerance);
  EXPECT_LE(better.evaluations, 20'000 + 10);
}

TEST_P(Refine, NeverComesBackWithWorseAndStaysInItsBounds) {
  SearchProblem problem{.variables = {{"x", 0.0, 1.0}, {"n", 0.0, 5.0, true}, {"c", 2.0, 2.0}},
                        .objectives = {"f"}};
  problem.evaluate = test::row_by_row(3, 1, [](std::span<const double> x, std::span<double> f) {
    EXPECT_TRUE(x[0] >= 0.0 && x[0] <= 1.0 && x[1] == 3.0 && x[2] == 2.0);
    f[0] = x[0] + x[1];
  });
  const Refinement same = refine(problem, std::vector<double>{0.0, 3.0, 2.0}, {.method = GetParam()});
  EXPECT_FALSE(same.improved);
  EXPECT_EQ(same.design, (std::vector<double>{0.0, 3.0, 2.0}));
  EXPECT_EQ(same.outcomes, std::vector<double>{3.0});
  const Refinement better = refine(problem, std::vector<double>{0.6, 3.0, 2.0}, {.method = GetParam()});
  EXPECT_NEAR(better.design[0], 0.0, 1e-5);
  // With nothing free to move it says so.
  problem.variables[0] = {"x", 0.5, 0.5};
  EXPECT_EQ(refine(problem, std::vector<double>{0.5, 3.0, 2.0}, {.method = GetParam()}).reason,
            "no variable is free to move");
}

TEST_P(Refine, SurvivesWhatThrowsAndEndsWhenToldTo) {
  SearchProblem problem = test::hyperbola();
  problem.evaluate = [evaluate = problem.evaluate](std::span<const double> x, std::span<double> f) {
    for (std::size_t i = 0; i < x.size(); i += 2) {
      if (x[i] < 1.1) throw std::runtime_error("too short");
    }
    return evaluate(x, f);
  };
  const Refinement better = refine(problem, std::vector<double>{1.4, 1.3}, {.method = GetParam()});
  EXPECT_TRUE(better.improved);
  EXPECT_GE(better.design[0], 1.1);
  int calls = 0;
  problem.evaluate = [&calls, evaluate = test::hyperbola().evaluate](std::span<const double> x,
                                                                     std::span<double> f) {
    return ++calls < 8 && evaluate(x, f);
  };
  const Refinement stopped = refine(problem, std::vector<double>{1.4, 1.3}, {.method = GetParam()});
  EXPECT_TRUE(stopped.stopped);
  EXPECT_EQ(stopped.reason, "stopped");
  EXPECT_EQ(calls, 8);
  EXPECT_LE(stopped.outcomes[0], 2.7);
}

TEST(RefineOptions, ThatDoNotFitAreRefused) {
  const SearchProblem problem = test::two_lengths();
  const std::vector<double> start = {2.0, 1.0};
  EXPECT_THROW(refine(problem, std::vector<double>{2.0}, {}), std::invalid_argument);
  EXPECT_THROW(refine(problem, std::vector<double>{2.0, 5.0}, {}), std::invalid_argument);
  EXPECT_THROW(refine(problem, start, {.weights = {1.0}}), std::invalid_argument);
  EXPECT_THROW(refine(problem, start, {.weights = {1.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(refine(problem, start, {.ideal = {0.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(refine(problem, start, {.evaluations = 0}), std::invalid_argument);
  EXPECT_EQ(refine_method("slsqp"), RefineMethod::slsqp);
  EXPECT_FALSE(refine_method("newton"));
}

}  // namespace
}  // namespace zwidth
