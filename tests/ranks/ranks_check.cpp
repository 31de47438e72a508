#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "design/problems.h"

#include "zwidth/design/workers.h"
#include "zwidth/ranks/ranks.h"

// Run as `mpirun -np N ranks_check`: a search on N ranks is, to the last bit, the search of this process alone;
// what fails on a rank comes back undefined; a stop ends a batch and no more. Prints what is wrong and exits
// with 1.

namespace {

using namespace zwidth;

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED: %s\n", what);
  ++failures;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

constexpr double kFails = -1.0, kStops = -2.0;

// Binh & Korn's problem at the cost of some 20 us, which also fails and stops for designs that say so.
BatchEvaluation own_evaluation(const SearchProblem& problem) {
  return [evaluate = problem.evaluate](std::span<const double> designs, std::span<double> rows) {
    for (std::size_t i = 0; i < designs.size(); i += 2) {
      if (designs[i] == kFails) throw std::runtime_error("as asked");
      if (designs[i] == kStops) return false;
    }
    volatile double burn = 0.0;
    for (std::size_t i = 0; i < 5'000 * designs.size(); ++i) burn = burn + std::sqrt(static_cast<double>(i));
    return evaluate(designs, rows);
  };
}

void check_searches(const SearchProblem& spread, const SearchProblem& alone) {
  for (const SearchAlgorithm algorithm : {SearchAlgorithm::nsga2, SearchAlgorithm::moead}) {
    const SearchOptions options{.algorithm = algorithm, .population = 40, .generations = 12, .seed = 6};
    const SearchResult a = search(spread, options), b = search(alone, options);
    expect(same_bits(a.designs, b.designs), "designs are those of one process");
    expect(same_bits(a.outcomes, b.outcomes), "outcomes are those of one process");
    expect(a.front == b.front && !a.front.empty(), "the front is that of one process");
    expect(a.evaluations == b.evaluations, "as many evaluations");
  }
}

void check_failures(const BatchEvaluation& spread, const BatchEvaluation& alone) {
  // A batch of every size, and one in many pieces, rows in place.
  for (std::size_t count = 0; count <= 60; ++count) {
    if (count == 60) count = 2000;
    std::vector<double> designs, rows(4 * count), expected(4 * count);
    for (std::size_t i = 0; i < count; ++i) designs.insert(designs.end(), {0.08 * static_cast<double>(i), 1.0});
    expect(spread(designs, rows) && alone(designs, expected), "a batch is whole");
    expect(same_bits(rows, expected), "rows are in their places");
  }
  // What throws, on whatever rank, is an undefined design and nothing else.
  SearchProblem failing{.variables = {{"n", -1.0, 98.0, true}, {"m", 1.0, 1.0, true}},
                        .objectives = {"f1", "f2"},
                        .constraints = {"g1", "g2"},
                        .evaluate = spread};
  const SearchResult result = search(failing, {.algorithm = SearchAlgorithm::grid});
  expect(result.end == SearchEnd::grid && result.evaluations == 100, "a failure ends nothing");
  expect(result.constraints[0].undefined == 1, "a failure costs its own row");
}

void check_stop(const BatchEvaluation& spread) {
  std::vector<double> designs(2 * 200, 1.0), rows(4 * 200);
  for (const std::size_t place : {std::size_t{0}, std::size_t{100}, std::size_t{199}}) {
    designs[2 * place] = kStops;
    expect(!spread(designs, rows), "a stop on any rank stops the batch");
    designs[2 * place] = 1.0;
    expect(spread(designs, rows), "and the next one is whole again");
  }
}

}  // namespace

int main() {
  if (!Ranks::started_by_launcher()) {
    std::printf("run as: mpirun -np N ranks_check\n");
    return 2;
  }
  Ranks ranks;
  const int size = ranks.size();
  expect(ranks.first_that(false) == size, "no rank says yes");
  expect(ranks.first_that(ranks.rank() == size - 1) == size - 1, "the last rank says yes");
  expect(ranks.first_that(true) == 0, "all say yes");
  SearchProblem problem = test::bnh();
  const BatchEvaluation own = own_evaluation(problem);
  if (!ranks.drives()) {
    ranks.serve(2, 4, own);
    return failures == 0 ? 0 : 1;
  }
  problem.evaluate = own;
  SearchProblem spread = problem;
  spread.evaluate = ranks.spread(2, 4, own);
  check_searches(spread, problem);
  check_failures(spread.evaluate, own);
  check_stop(spread.evaluate);
  std::printf("%d ranks: %s\n", ranks.size(), failures == 0 ? "all holds" : "see above");
  return failures == 0 ? 0 : 1;
}
