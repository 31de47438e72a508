#pragma once

#include <cstdint>

#include "zwidth/design/search.h"

/// Improves one design by a local search: after a population has found where good designs lie, before one is
/// built.

namespace zwidth {

enum class RefineMethod {
  sbplx,   ///< simplices in subspaces (Rowan 1990), by order alone: for figures with steps and kinks, and such
           ///< as are undefined where a constraint is broken
  slsqp,   ///< quadratic programs of finite differences (Kraft 1988): the fastest where figures are smooth
  cobyla,  ///< linear models of objective and constraints (Powell 1994): where they have a meaning beyond the
           ///< constraints too
};
/// As users write it; nothing if there is none of that name.
std::optional<RefineMethod> refine_method(std::string_view name);
std::string_view to_string(RefineMethod method);

struct RefineOptions {
  RefineMethod method = RefineMethod::sbplx;
  std::int64_t evaluations = 1000;  ///< about that many
  double tolerance = 1e-6;          ///< of variables, as a share of their ranges
  double first_step = 0.05;         ///< the same, of the first step of cobyla and sbplx
  /// What several objectives are measured in: of a front, its `objective_range`. Empty: 0 and 1.
  std::vector<double> ideal, nadir;
  /// How much each objective matters, positive. Empty: all are to improve by the same share of nadir - ideal,
  /// so that what comes out, if anything does, beats a feasible start in every objective.
  std::vector<double> weights;
};

struct Refinement {
  bool improved = false;         ///< constraint-dominates the start, or has a better compromise
  bool stopped = false;          ///< `evaluate` was told to stop; the best so far is here
  std::vector<double> design;    ///< the start if nothing better was found
  std::vector<double> outcomes;  ///< of it
  std::int64_t evaluations = 0;
  std::string reason;  ///< why it ended, for people
};

/// A better design near `start`, by NLopt. Whole numbers stay as they are. One objective is minimised itself,
/// of several their compromise max_k w_k p_k + 1e-3 sum_k w_k p_k (the augmented Chebyshev distance to the
/// ideal, Steuer & Choo 1983), with p = (f - ideal)/(nadir - ideal); without weights the largest change since
/// the start. Constraints are met, or if the start breaks some, broken less. What comes back is never worse
/// than the start. The differences of `slsqp` are evaluated in one batch each; the others evaluate one by one.
/// The same start gives the same design.
///
/// Throws std::invalid_argument if `start` is no design of the problem, or the options do not fit it.
Refinement refine(const SearchProblem& problem, std::span<const double> start,
                  const RefineOptions& options = {});

}  // namespace zwidth
