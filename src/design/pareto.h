#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Sets of designs by their objectives: which are beaten, how good the rest is together, and which to take.
///
/// Objectives are all to be minimised. `values` holds them row by row, a design each, `objectives` of them in a
/// row. REQUIRES everywhere: objectives > 0 and values.size() a multiple of it. Unless said otherwise, NaN is
/// refused by REQUIRES.

namespace zwidth {

// ------------------------------------------------------------------------------------------------ domination

/// Not worse in any objective and better in one. False for equal rows, so duplicates do not dominate each
/// other; NaN neither dominates nor is dominated.
bool dominates(std::span<const double> a, std::span<const double> b);

/// The rows that no other dominates, in rising order; duplicates are all kept.
std::vector<std::size_t> non_dominated(std::span<const double> values, std::size_t objectives);

/// How much of a design's constraints is broken. An undefined constraint is worse than any number, and so is
/// an undefined objective of a design that breaks none.
struct Standing {
  std::size_t undefined = 0;
  double violation = 0.0;  ///< sum of what is positive of the constraints that are defined

  bool feasible() const { return undefined == 0 && violation == 0.0; }
  /// Fewer undefined, then less violation.
  bool better_than(const Standing& other) const {
    return undefined != other.undefined ? undefined < other.undefined : violation < other.violation;
  }
};
/// Of a row of outcomes: the objectives, then the constraints (see `BatchEvaluation`).
Standing standing(std::span<const double> outcomes, std::size_t objectives);

/// Constraint domination (Deb et al. 2002, definition 1) of rows of outcomes: a feasible design dominates one
/// that is not, of two that are not the one of better standing dominates, of two feasible ones Pareto decides.
bool constraint_dominates(std::span<const double> a, std::span<const double> b, std::size_t objectives);

/// Objectives whose plain Pareto order is the constraint domination of the outcomes, for algorithms that know
/// no constraints: a feasible design keeps its objectives (beyond +-1e29 they count as that), all objectives of
/// another are 1e30 (1 + violation), or with u undefined values 1e140 (2 u + v/(1 + v)). Violations that differ
/// by less than the rounding of 1 + violation count as equal. `image` has `objectives` elements, all finite.
void unconstrained_image(std::span<const double> outcomes, std::span<double> image);

/// Fronts one behind the other, rows in rising order: the first is not dominated, the second only by the first,
/// and so on (Deb et al. 2002, section III-A). `violations`, one per row where constraints are broken, 0 where
/// not, make it constraint domination; empty: all rows are feasible.
std::vector<std::vector<std::size_t>> pareto_fronts(std::span<const double> values, std::size_t objectives,
                                                    std::span<const double> violations = {});

/// Crowding distance of each row among all of them (Deb et al. 2002, section III-B); infinite at the ends of
/// every objective.
std::vector<double> crowding_distances(std::span<const double> values, std::size_t objectives);

/// Volume between the rows and `reference` that at least one row dominates, exactly (Zitzler & Thiele 1999).
/// Rows that do not lie below the reference in every objective add nothing.
double hypervolume(std::span<const double> values, std::span<const double> reference);

// -------------------------------------------------------------------------------------------------- choosing

/// Least and largest of each objective over the rows: of a front, its ideal and its nadir point.
struct ObjectiveRange {
  std::vector<double> min;
  std::vector<double> max;
};
ObjectiveRange objective_range(std::span<const double> values, std::size_t objectives);

/// Rows as (p - min)/(max - min), 0 the best of each objective and 1 the worst (Gorgulu 2018, eq 7.1); an
/// objective that is the same everywhere becomes 0.
std::vector<double> normalised(std::span<const double> values, std::size_t objectives);

/// sqrt(sum_i w_i p_i^2 / n) of each row, p_i normalised: the root mean square by which Gorgulu 2018,
/// section 7.2 chooses (there n = 2, w = (1, weight)). The smallest is the choice. REQUIRES: a weight >= 0 per
/// objective.
std::vector<double> weighted_rms(std::span<const double> values, std::size_t objectives,
                                 std::span<const double> weights);

/// Closeness of each row to the ideal, 0 to 1, with columns scaled by their Euclidean norm (Hwang & Yoon 1981,
/// TOPSIS). The largest is the choice. REQUIRES: a weight >= 0 per objective, not all 0.
std::vector<double> topsis(std::span<const double> values, std::size_t objectives,
                           std::span<const double> weights);

/// The row of a front that lies farthest, towards the ideal point, from the line, plane or hyperplane through
/// the best rows of each objective, in normalised objectives (Das 1999). The first of equals. Nothing if there
/// is no such row: the extreme rows span no hyperplane, or none lies beyond it.
std::optional<std::size_t> knee(std::span<const double> values, std::size_t objectives);

}  // namespace zwidth
