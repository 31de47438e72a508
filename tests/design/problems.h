#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "zwidth/design/search.h"

/// Search problems whose answers are known in closed form.

namespace zwidth::test {

/// A batch evaluation of a function of one design.
inline BatchEvaluation row_by_row(std::size_t variables, std::size_t outcomes,
                                  std::function<void(std::span<const double>, std::span<double>)> one) {
  return [=](std::span<const double> designs, std::span<double> rows) {
    for (std::size_t row = 0; row < rows.size() / outcomes; ++row) {
      one(designs.subspan(row * variables, variables), rows.subspan(row * outcomes, outcomes));
    }
    return true;
  };
}

/// Zitzler, Deb & Thiele 2000, T1, in `count` variables: the front is f2 = 1 - sqrt(f1).
inline SearchProblem zdt1(std::size_t count) {
  SearchProblem problem{.objectives = {"f1", "f2"}};
  for (std::size_t v = 0; v < count; ++v) problem.variables.push_back({"x" + std::to_string(v), 0.0, 1.0});
  problem.evaluate = row_by_row(count, 2, [](std::span<const double> x, std::span<double> f) {
    double sum = 0.0;
    for (const double value : x.subspan(1)) sum += value;
    const double g = 1.0 + 9.0 * sum / static_cast<double>(x.size() - 1);
    f[0] = x[0];
    f[1] = g * (1.0 - std::sqrt(x[0] / g));
  });
  return problem;
}

/// Binh & Korn 1997: the front is x = y in 0..3, then y = 3 with x in 3..5. The first constraint is broken in a
/// corner, the second nowhere. Broken constraints leave the objectives undefined.
inline SearchProblem bnh() {
  SearchProblem problem{.variables = {{"x", 0.0, 5.0}, {"y", 0.0, 3.0}},
                        .objectives = {"f1", "f2"},
                        .constraints = {"near", "far"}};
  problem.evaluate = row_by_row(2, 4, [](std::span<const double> x, std::span<double> f) {
    f[0] = 4.0 * x[0] * x[0] + 4.0 * x[1] * x[1];
    f[1] = std::pow(x[0] - 5.0, 2) + std::pow(x[1] - 5.0, 2);
    f[2] = std::pow(x[0] - 5.0, 2) + x[1] * x[1] - 25.0;
    f[3] = 7.7 - std::pow(x[0] - 8.0, 2) - std::pow(x[1] + 3.0, 2);
    if (f[2] > 0.0 || f[3] > 0.0) f[0] = f[1] = std::numeric_limits<double>::quiet_NaN();
  });
  return problem;
}

/// Two lengths, both to be small, whose product must be 1 at least: the front is x y = 1, on the edge of what
/// is feasible. A broken constraint leaves the objectives undefined.
inline SearchProblem two_lengths() {
  SearchProblem problem{
      .variables = {{"x", 0.0, 4.0}, {"y", 0.0, 4.0}}, .objectives = {"x", "y"}, .constraints = {"product"}};
  problem.evaluate = row_by_row(2, 3, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0];
    f[1] = x[1];
    f[2] = 1.0 - x[0] * x[1];
    if (f[2] > 0.0) f[0] = f[1] = std::numeric_limits<double>::quiet_NaN();
  });
  return problem;
}

/// A volume of material (x + y, to be small) that must carry something (x y >= 1): x = y = 1. Away from the
/// answer the constraint is broken in most of the box.
inline SearchProblem hyperbola() {
  SearchProblem problem{
      .variables = {{"x", 0.0, 1.5}, {"y", 0.0, 1.5}}, .objectives = {"material"}, .constraints = {"strength"}};
  problem.evaluate = row_by_row(2, 2, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0] + x[1];
    f[1] = 1.0 - x[0] * x[1];
    if (f[1] > 0.0) f[0] = std::numeric_limits<double>::quiet_NaN();
  });
  return problem;
}

}  // namespace zwidth::test
