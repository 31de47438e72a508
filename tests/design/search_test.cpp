#include "zwidth/design/search.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "design/problems.h"

#include "zwidth/design/pareto.h"
#include "zwidth/design/workers.h"

namespace zwidth {
namespace {

std::vector<double> front_values(const SearchProblem& problem, const SearchResult& result) {
  std::vector<double> values;
  const std::size_t width = problem.outcome_size(), objectives = problem.objectives.size();
  for (const std::size_t row : result.front) {
    const auto first = result.outcomes.begin() + static_cast<std::ptrdiff_t>(row * width);
    values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(objectives));
  }
  return values;
}

double best(const SearchProblem& problem, const SearchResult& result) {
  const std::vector<double> values = front_values(problem, result);
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : values.front();
}

class SeveralObjectives : public testing::TestWithParam<SearchAlgorithm> {};
class OneObjective : public testing::TestWithParam<SearchAlgorithm> {};

std::string name_of(const testing::TestParamInfo<SearchAlgorithm>& algorithm) {
  std::string name(info(algorithm.param).name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Search, SeveralObjectives,
                         testing::Values(SearchAlgorithm::nsga2, SearchAlgorithm::nspso,
                                         SearchAlgorithm::moead),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Search, OneObjective,
                         testing::Values(SearchAlgorithm::cmaes, SearchAlgorithm::de, SearchAlgorithm::de1220,
                                         SearchAlgorithm::sade, SearchAlgorithm::self_adaptive_constraints),
                         name_of);

// The swarm spreads its designs less well than the others.
double slack(SearchAlgorithm algorithm) {
  return algorithm == SearchAlgorithm::nspso ? 5.0 : 1.0;
}

// The same number of evaluations, whatever an algorithm does in one of its generations.
std::int64_t steps(SearchAlgorithm algorithm, std::int64_t populations) {
  return populations / info(algorithm).populations_per_step;
}

// A front of n points misses of the area under f2(f1) at least some 1/(2 n) of its box.
TEST_P(SeveralObjectives, FindTheFrontOfZdt1) {
  const SearchProblem problem = test::zdt1(6);
  const SearchResult result = search(problem, {.algorithm = GetParam(),
                                               .population = 100,
                                               .generations = steps(GetParam(), 250),
                                               .seed = 3,
                                               .reference = {1.1, 1.1}});
  EXPECT_EQ(result.end, SearchEnd::generations);
  const double exact = 1.21 - 1.0 / 3.0;  // below (1.1, 1.1): 1.1^2 - integral of 1 - sqrt f1
  EXPECT_NEAR(result.history.back().hypervolume, exact, 0.012 * slack(GetParam()));
  EXPECT_LT(result.history.back().hypervolume, exact);
  EXPECT_EQ(result.history.back().number, steps(GetParam(), 250));
}

TEST_P(SeveralObjectives, FindTheFrontOnTheEdgeOfWhatIsFeasible) {
  const SearchProblem problem = test::two_lengths();
  const SearchResult result = search(problem, {.algorithm = GetParam(),
                                               .population = 60,
                                               .generations = steps(GetParam(), 100),
                                               .seed = 5,
                                               .reference = {4.0, 4.0}});
  // Integral of 4 - 1/x over 1/4..4.
  const double exact = 15.0 - std::log(16.0);
  EXPECT_NEAR(result.history.back().hypervolume, exact, 0.03 * exact * slack(GetParam()));
  EXPECT_LT(result.history.back().hypervolume, exact);
  EXPECT_GT(static_cast<double>(result.front.size()), 20.0 / slack(GetParam()));
  for (const std::size_t row : result.front) EXPECT_LE(result.outcomes[row * 3 + 2], 0.0);
  EXPECT_EQ(result.constraints[0].least_violation, 0.0);
  EXPECT_EQ(result.failures, 0);
}

TEST_P(SeveralObjectives, FindTheFrontOfBinhAndKorn) {
  const SearchProblem problem = test::bnh();
  const SearchResult result = search(
      problem,
      {.algorithm = GetParam(), .population = 100, .generations = 60, .seed = 2, .reference = {140.0, 50.0}});
  // The closed form of the front in 10^5 steps of f1.
  double exact = 0.0;
  constexpr int kSteps = 100'000;
  for (int i = 0; i < kSteps; ++i) {
    const double f1 = 136.0 * (i + 0.5) / kSteps;
    const double f2 = f1 < 72.0 ? 2.0 * std::pow(std::sqrt(f1 / 8.0) - 5.0, 2)
                                : std::pow(std::sqrt((f1 - 36.0) / 4.0) - 5.0, 2) + 4.0;
    exact += (50.0 - f2) * 136.0 / kSteps;
  }
  exact += 4.0 * (50.0 - 4.0);
  EXPECT_NEAR(result.history.back().hypervolume, exact, 0.01 * exact * slack(GetParam()));
  EXPECT_LT(result.history.back().hypervolume, exact);
}

TEST_P(OneObjective, FindTheLeastMaterialThatCarries) {
  const SearchProblem problem = test::hyperbola();
  const SearchResult result =
      search(problem, {.algorithm = GetParam(), .population = 20, .generations = 60, .seed = 7});
  EXPECT_NEAR(best(problem, result), 2.0, 2e-3);
  EXPECT_GE(best(problem, result), 2.0);
}

TEST(Search, WholeNumbersStayWholeAndFixedOnesStayFixed) {
  for (const SearchAlgorithm algorithm :
       {SearchAlgorithm::nsga2, SearchAlgorithm::nspso, SearchAlgorithm::moead, SearchAlgorithm::grid}) {
    // The whole number stands first and the fixed one between, so the order within the algorithm is another.
    SearchProblem problem{.variables = {{"n", -2.0, 6.0, true}, {"c", 1.5, 1.5}, {"x", 0.0, 1.0}},
                          .objectives = {"f1", "f2"}};
    if (algorithm == SearchAlgorithm::grid) {
      problem.variables[1] = {"c", 2.0, 2.0, true};
      problem.variables[2] = {"x", 0.0, 1.0, true};
    }
    std::set<double> numbers;
    problem.evaluate = test::row_by_row(3, 2, [&](std::span<const double> x, std::span<double> f) {
      numbers.insert(x[0]);
      EXPECT_EQ(x[0], std::round(x[0]));
      EXPECT_GE(x[0], -2.0);
      EXPECT_LE(x[0], 6.0);
      EXPECT_EQ(x[1], problem.variables[1].min);
      f[0] = std::abs(x[0] - 3.0) + x[2];
      f[1] = std::abs(x[0] - 5.0) + x[2];
    });
    const SearchResult result =
        search(problem, {.algorithm = algorithm, .population = 40, .generations = 30, .seed = 1});
    EXPECT_EQ(numbers.size(), 9u);
    std::set<double> chosen;
    for (const std::size_t row : result.front) {
      chosen.insert(result.designs[row * 3]);
      EXPECT_NEAR(result.designs[row * 3 + 2], 0.0, 0.05);
    }
    EXPECT_EQ(chosen, (std::set<double>{3.0, 4.0, 5.0})) << info(algorithm).name;
  }
}

TEST(Search, AGridSeesEveryDesignOnceAndKeepsTheFront) {
  SearchProblem problem{.variables = {{"a", 1.0, 40.0, true}, {"b", 1.0, 75.0, true}},
                        .objectives = {"a", "b"},
                        .constraints = {"product"}};
  std::multiset<std::pair<double, double>> seen;
  problem.evaluate = test::row_by_row(2, 3, [&](std::span<const double> x, std::span<double> f) {
    seen.insert({x[0], x[1]});
    f[0] = x[0];
    f[1] = x[1];
    f[2] = 60.0 - x[0] * x[1];
  });
  const SearchResult result = search(problem, {.algorithm = SearchAlgorithm::grid});
  EXPECT_EQ(result.end, SearchEnd::grid);
  EXPECT_EQ(seen.size(), 3000u);
  EXPECT_EQ(std::set(seen.begin(), seen.end()).size(), 3000u);
  EXPECT_EQ(result.evaluations, 3000);
  // For each a the least b with a b >= 60, unless a smaller a does with the same.
  std::vector<double> expected;
  double least = 100.0;
  for (double a = 1.0; a <= 40.0; ++a) {
    const double b = std::ceil(60.0 / a);
    if (b <= 75.0 && b < least) {
      expected.insert(expected.end(), {a, b});
      least = b;
    }
  }
  EXPECT_EQ(front_values(problem, result), expected);
}

TEST(Search, AGridOfWhichNothingIsFeasibleTellsTheNearest) {
  SearchProblem problem{.variables = {{"a", 1.0, 9.0, true}},
                        .objectives = {"a"},
                        .constraints = {"above twelve", "never", "sometimes"}};
  problem.evaluate = test::row_by_row(1, 4, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0];
    f[1] = 12.0 - x[0];
    f[2] = std::numeric_limits<double>::quiet_NaN();
    f[3] = x[0] - 4.0;
  });
  const SearchResult result = search(problem, {.algorithm = SearchAlgorithm::grid});
  EXPECT_TRUE(result.front.empty());
  EXPECT_EQ(result.designs, std::vector<double>{4.0});  // 8 broken there, more elsewhere
  EXPECT_EQ(result.constraints[0].held, 0);
  EXPECT_EQ(result.constraints[0].least_violation, 3.0);
  EXPECT_EQ(result.constraints[1].undefined, 9);
  EXPECT_TRUE(std::isinf(result.constraints[1].least_violation));
  EXPECT_EQ(result.constraints[2].held, 4);
  EXPECT_EQ(result.constraints[2].least_violation, 0.0);
  EXPECT_TRUE(std::isnan(result.history.back().hypervolume));
}

TEST(Search, SameSeedSameSearchForAnyNumberOfWorkers) {
  for (const SearchAlgorithmInfo& algorithm : search_algorithms()) {
    if (!algorithm.batches || algorithm.algorithm == SearchAlgorithm::grid) continue;
    std::vector<SearchResult> results;
    for (const int threads : {1, 2, 3}) {
      SearchProblem problem = test::bnh();
      const BatchEvaluation serial = problem.evaluate;
      problem.evaluate =
          on_workers(2, 4,
                     [&]() -> DesignEvaluation {
                       return [&](std::span<const double> x, std::span<double> f) { serial(x, f); };
                     },
                     {.threads = threads});
      results.push_back(
          search(problem, {.algorithm = algorithm.algorithm, .population = 40, .generations = 10}));
    }
    EXPECT_EQ(results[0].designs, results[1].designs);
    EXPECT_EQ(results[0].designs, results[2].designs);
    EXPECT_EQ(results[0].front, results[2].front);
    EXPECT_EQ(results[0].history.back().hypervolume, results[2].history.back().hypervolume);
  }
}

TEST(Search, AnotherSeedIsAnotherSearch) {
  const SearchProblem problem = test::zdt1(4);
  const SearchResult a = search(problem, {.population = 20, .generations = 5, .seed = 1});
  const SearchResult b = search(problem, {.population = 20, .generations = 5, .seed = 1});
  const SearchResult c = search(problem, {.population = 20, .generations = 5, .seed = 2});
  EXPECT_EQ(a.designs, b.designs);
  EXPECT_NE(a.designs, c.designs);
}

TEST(Search, WhatFailsToEvaluateIsUndefinedAndEndsNothing) {
  for (const SearchAlgorithmInfo& algorithm : search_algorithms()) {
    if (algorithm.algorithm == SearchAlgorithm::grid) continue;
    SearchProblem problem = algorithm.several_objectives ? test::two_lengths() : test::hyperbola();
    const BatchEvaluation evaluate = problem.evaluate;
    const std::size_t width = problem.outcome_size();
    problem.evaluate = [=](std::span<const double> x, std::span<double> f) {
      evaluate(x, f);
      for (std::size_t row = 0; row < f.size() / width; ++row) {
        if (x[2 * row] > 1.4) throw std::runtime_error("too long");                            // some throw
        if (x[2 * row + 1] > 1.45) f[row * width] = std::numeric_limits<double>::quiet_NaN();  // some are NaN
        if (x[2 * row + 1] < 0.1) f[row * width + width - 1] = std::numeric_limits<double>::infinity();
      }
      return true;
    };
    const SearchResult result =
        search(problem, {.algorithm = algorithm.algorithm, .population = 40, .generations = 15, .seed = 4});
    EXPECT_EQ(result.end, SearchEnd::generations)
        << algorithm.name << (result.notes.empty() ? "" : result.notes[0]);
    EXPECT_GT(result.failures, 0);
    EXPECT_EQ(result.first_failure, "too long");
    EXPECT_FALSE(result.front.empty()) << algorithm.name;
    for (const std::size_t row : result.front) EXPECT_LE(result.designs[2 * row], 1.4);
  }
}

TEST(Search, StopsWhereItsListenerSaysWithAllOfThatGeneration) {
  const SearchProblem problem = test::bnh();
  const SearchResult whole = search(problem, {.population = 40, .generations = 4});
  const SearchResult stopped = search(
      problem,
      {.population = 40, .generations = 100, .progress = [](const Generation& g) { return g.number < 4; }});
  EXPECT_EQ(stopped.end, SearchEnd::stopped);
  EXPECT_EQ(stopped.designs, whole.designs);
  EXPECT_EQ(stopped.outcomes, whole.outcomes);
  EXPECT_EQ(stopped.front, whole.front);
}

TEST(Search, StopInTheMiddleOfAGenerationLeavesTheOneBefore) {
  SearchProblem problem = test::bnh();
  const SearchResult whole = search(problem, {.population = 40, .generations = 2});
  const BatchEvaluation evaluate = problem.evaluate;
  int calls = 0;
  problem.evaluate = [&](std::span<const double> x, std::span<double> f) {
    return ++calls <= 3 && evaluate(x, f);
  };
  const SearchResult stopped = search(problem, {.population = 40, .generations = 100});
  EXPECT_EQ(stopped.end, SearchEnd::stopped);
  EXPECT_EQ(stopped.history.size(), 3u);
  EXPECT_EQ(stopped.designs, whole.designs);
  // And before there is any generation: nothing, but no harm.
  problem.evaluate = [](std::span<const double>, std::span<double>) { return false; };
  const SearchResult nothing = search(problem, {.population = 40});
  EXPECT_EQ(nothing.end, SearchEnd::stopped);
  EXPECT_TRUE(nothing.front.empty());
}

TEST(Search, EndsWithinItsBudgetOfEvaluations) {
  SearchProblem problem = test::zdt1(3);
  const SearchResult result = search(problem, {.population = 40, .generations = 1000, .evaluations = 500});
  EXPECT_EQ(result.end, SearchEnd::evaluations);
  EXPECT_LE(result.evaluations, 500);
  EXPECT_GT(result.evaluations, 440);
}

TEST(Search, EndsWhenTheHypervolumeNoLongerGrows) {
  const SearchResult result = search(test::zdt1(2), {.population = 40,
                                                     .generations = 10'000,
                                                     .stagnation = 1e-3,
                                                     .stagnation_generations = 10,
                                                     .reference = {1.1, 1.1}});
  EXPECT_EQ(result.end, SearchEnd::stagnation);
  const std::size_t last = result.history.size() - 1;
  EXPECT_LT(result.history[last].hypervolume, 1.001 * result.history[last - 10].hypervolume);
  EXPECT_GT(result.history[last].hypervolume, 0.8);
}

TEST(Search, BeginsWithTheDesignsThatItIsGiven) {
  SearchProblem problem = test::zdt1(3);
  std::vector<double> first;
  const BatchEvaluation evaluate = problem.evaluate;
  problem.evaluate = [&](std::span<const double> x, std::span<double> f) {
    if (first.empty()) first.assign(x.begin(), x.end());
    return evaluate(x, f);
  };
  const SearchResult result =
      search(problem, {.population = 8, .generations = 0, .start = {0.5, 0.0, 0.0, 0.25, 0.125, 1.0}});
  EXPECT_EQ(std::vector<double>(first.begin(), first.begin() + 6),
            (std::vector<double>{0.5, 0.0, 0.0, 0.25, 0.125, 1.0}));
  EXPECT_EQ(result.history.size(), 1u);
}

TEST(Search, ReferenceIsFixedOnceAndTheHypervolumeOfElitistsNeverFallsMuch) {
  const SearchProblem problem = test::bnh();
  const SearchResult result = search(problem, {.population = 40, .generations = 30});
  ASSERT_EQ(result.reference.size(), 2u);
  EXPECT_EQ(result.history.back().hypervolume, hypervolume(front_values(problem, result), result.reference));
  EXPECT_GT(result.history.back().hypervolume, result.history.front().hypervolume);
  EXPECT_NEAR(result.seconds_evaluating, result.history.back().seconds_evaluating, 1e-2);
}

TEST(Search, DesignsMetAgainAreNotEvaluatedAgain) {
  SearchProblem problem{.variables = {{"n", 0.0, 3.0, true}, {"m", 0.0, 2.0, true}},
                        .objectives = {"f1", "f2"}};
  std::int64_t calls = 0;
  problem.evaluate = test::row_by_row(2, 2, [&](std::span<const double> x, std::span<double> f) {
    ++calls;
    f[0] = x[0];
    f[1] = x[1] - x[0];
  });
  const SearchResult result = search(problem, {.population = 40, .generations = 20});
  EXPECT_EQ(result.evaluations, calls);
  EXPECT_LT(calls, 40 * 21 / 3);
  EXPECT_EQ(result.front.size(), 4u);  // m = 0 for each n, each once
}

TEST(Search, TellsAllThatIsWrongWithAProblemAtOnce) {
  SearchProblem problem{.variables = {{"a", 2.0, 1.0}, {"b", 0.5, 3.0, true}, {"b", 0.0, 1.0}},
                        .objectives = {"mass"}};
  const std::vector<std::string> problems = search_problems(
      problem, {.algorithm = SearchAlgorithm::nsga2, .population = 42, .generations = -1, .resume = true});
  const auto tells = [&](const std::string& words) {
    return std::any_of(problems.begin(), problems.end(),
                       [&](const std::string& one) { return one.find(words) != std::string::npos; });
  };
  EXPECT_TRUE(tells("'a' has its bounds the wrong way round: [2, 1]"));
  EXPECT_TRUE(tells("'b' takes whole numbers, so its bounds must be whole: [0.5, 3]"));
  EXPECT_TRUE(tells("'b' is there twice"));
  EXPECT_TRUE(tells("nsga2 needs two objectives or more; for one take cmaes"));
  EXPECT_TRUE(tells("a multiple of 4, not 42"));
  EXPECT_TRUE(tells("generations must not be negative"));
  EXPECT_TRUE(tells("to resume, name the checkpoint"));
  EXPECT_TRUE(tells("nothing to evaluate designs with"));
  EXPECT_THROW(search(problem, {}), std::invalid_argument);
}

TEST(Search, RefusesGridsThatAreNoneOrNeverEnd) {
  SearchProblem problem = test::zdt1(2);
  EXPECT_EQ(search_problems(problem, {.algorithm = SearchAlgorithm::grid}).size(), 2u);
  problem.variables = {{"a", 0.0, 99'999.0, true}, {"b", 0.0, 99'999.0, true}};
  const std::vector<std::string> problems = search_problems(problem, {.algorithm = SearchAlgorithm::grid});
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find("the grid has 10000000000 designs"), std::string::npos) << problems[0];
}

TEST(Search, AlgorithmsAreFoundByTheirNames) {
  for (const SearchAlgorithmInfo& one : search_algorithms()) {
    EXPECT_EQ(search_algorithm(one.name), one.algorithm);
    EXPECT_EQ(info(one.algorithm).name, one.name);
  }
  EXPECT_FALSE(search_algorithm("simplex"));
}

}  // namespace
}  // namespace zwidth
