#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "zwidth/design/search.h"

/// What small changes of a design do to its outcomes: slopes, and what tolerances of manufacture make of them.
///
/// `evaluate` is a `BatchEvaluation` whose outcomes may be any figures; NaN where one cannot be computed.

namespace zwidth {

/// Slopes of every outcome along every variable.
struct Sensitivity {
  bool complete = true;         ///< false if `evaluate` was told to stop; nothing else then holds
  std::vector<double> nominal;  ///< outcomes of the design itself
  std::vector<double> slope;    ///< d outcome o / d variable v at [o * variables + v]
  /// How far a straight line errs at one step, as a share of the change by that step: |second difference| over
  /// twice |first difference|. NaN where only one side could be computed, or the outcome does not change.
  std::vector<double> bend;
};

/// By central differences of half-width `steps`, one per variable, all evaluated together; by a one-sided one
/// where the other side cannot be computed, NaN where neither can. Error of a central one: step^2/6 times the
/// third derivative. REQUIRES: steps > 0, as many as there are variables, and outcomes > 0.
Sensitivity sensitivity(const BatchEvaluation& evaluate, std::span<const double> design,
                        std::span<const double> steps, std::size_t outcomes);

/// What errors of the variables do to outcomes that follow their slopes.
struct LinearSpread {
  std::vector<double> deviation;  ///< standard deviation of each outcome, for independent errors
  double worst = 0.0;  ///< largest Euclidean norm of the outcomes' errors, each variable off by its size
  std::vector<double> worst_sign;  ///< +1 or -1 of each variable there, the first +1
};
/// S Sigma S^T and the worst corner of the box of errors, for `slope` as `Sensitivity` has it and an error
/// `size` per variable: the standard deviation of the one, half the width of the other. REQUIRES: 24 variables
/// at most (all 2^(n-1) corners are tried), slope.size() a multiple of their number.
LinearSpread linear_spread(std::span<const double> slope, std::span<const double> size);

/// How a quantity of a made part lies about its nominal value.
struct Tolerance {
  enum class Spread { uniform, normal };
  Spread spread = Spread::uniform;
  double size =
      0.0;  ///< uniform: half the width of the range; normal: standard deviation; 0 for exactly as drawn
  bool relative = false;  ///< `size` is a share of the nominal value's magnitude

  /// Standard deviation about a nominal value.
  double deviation(double nominal) const;
};

/// An estimate and the interval that holds the true value with 95 % confidence.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct OutcomeSpread {
  double nominal = 0.0;
  std::int64_t undefined = 0;  ///< samples in which it could not be computed; the rest is of the others
  Estimate mean;               ///< interval by the normal law of means
  double standard_deviation = 0.0;
  Estimate percentile_5, median, percentile_95;  ///< intervals by order statistics, whatever the distribution
  /// Standard deviation if the outcome followed its slopes; NaN if one is not known. Where it differs from
  /// `standard_deviation` by more than 5 %, do not trust slopes.
  double linear_deviation = 0.0;
};

struct ToleranceStudy {
  bool complete = true;  ///< false if `evaluate` was told to stop; nothing else then holds
  std::int64_t samples = 0;
  std::vector<OutcomeSpread> outcomes;
  Estimate broken;  ///< share of samples in which a constraint is broken or undefined (Wilson 1927)
  std::vector<double> broken_by;  ///< the same, of each constraint alone
};

struct ToleranceOptions {
  std::int64_t samples = 10'000;
  std::uint64_t seed = 1;
  /// Which outcomes are constraints: the last ones, so many; they hold where they are not positive.
  std::size_t constraints = 0;
};

/// Monte Carlo over tolerances, one per variable. Sample k deviates from the nominal value by the same number
/// of standard deviations in every study of the same seed (common random numbers), so differences between two
/// designs are not those of the draw. REQUIRES: a tolerance of size >= 0 per variable, samples > 0, outcomes >
/// 0, constraints <= outcomes.
ToleranceStudy tolerance_study(const BatchEvaluation& evaluate, std::span<const double> design,
                               std::span<const Tolerance> tolerances, std::size_t outcomes,
                               const ToleranceOptions& options = {});

}  // namespace zwidth
