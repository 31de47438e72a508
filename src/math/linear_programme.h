#pragma once

#include <Eigen/Core>

/// Small linear programmes, with storage inside the object: no heap, no lock, for use in a control tick.

namespace zwidth {

enum class ProgrammeStatus {
  optimal,     ///< the largest value, and where
  unbounded,   ///< the objective grows without end
  infeasible,  ///< no point keeps every row within its bounds
  stalled,     ///< rounding kept the search from ending: the best point found so far
};

const char* to_string(ProgrammeStatus status);

/// maximise c . x  with  lower_i <= a_i . x <= upper_i, the x_k free. Bounds may be infinite on either side,
/// and equal.
struct LinearProgramme {
  static constexpr int kMaxVariables = 8;
  static constexpr int kMaxRows = 16;

  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxVariables>;
  using Bounds = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Point = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxVariables, 1>;

  Rows rows;        ///< a_i
  Bounds lower;     ///< as many as rows
  Bounds upper;     ///< as many as rows, none below lower
  Point objective;  ///< c
};

struct ProgrammeSolution {
  ProgrammeStatus status = ProgrammeStatus::infeasible;
  double value = 0.0;            ///< c . x
  LinearProgramme::Point point;  ///< x; not unique where several points are as good
  /// Gain of value per unit that a row's bound is moved outwards: positive at an upper bound, negative at a
  /// lower one, zero where the row does not hold the value down. Zero unless optimal.
  LinearProgramme::Bounds multipliers;
};

/// A primal active-set search from a point that keeps the rows (found by a first programme where the origin
/// does not), with the rule of lowest indices against cycling (Bland 1977; Nocedal & Wright 2006, sections 13.3
/// and 16.5). REQUIRES: sizes that agree, finite rows and objective, lower <= upper.
ProgrammeSolution maximise(const LinearProgramme& programme) noexcept;

}  // namespace zwidth
