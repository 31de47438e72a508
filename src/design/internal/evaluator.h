#pragma once

#include <cstdint>
#include <unordered_map>

#include "zwidth/design/search.h"

namespace zwidth::internal {

/// Thrown when `SearchProblem::evaluate` was told to stop; leaves the search through the algorithm's frames.
struct Stopped {};

/// Designs and their outcomes, row by row.
struct Rows {
  std::vector<double> designs;
  std::vector<double> outcomes;
};

/// What an evaluator has seen so far; kept in a checkpoint.
struct EvaluationRecord {
  std::int64_t evaluations = 0;
  std::int64_t failures = 0;
  std::string first_failure;
  double seconds = 0.0;  ///< in `SearchProblem::evaluate`
  std::vector<ConstraintRecord> constraints;
};

/// Evaluates designs for a search: counts, times, and turns whatever goes wrong into undefined outcomes.
class Evaluator {
 public:
  explicit Evaluator(const SearchProblem& problem);

  /// Throws `Stopped`, and nothing else.
  void evaluate(std::span<const double> designs, std::span<double> outcomes);

  /// The same, but asks only for designs that are not remembered, each once, and remembers them.
  void evaluate_once(std::span<const double> designs, std::span<double> outcomes);
  /// Outcomes of a design that is remembered; empty if it is not.
  std::span<const double> find(std::span<const double> design) const;
  /// Forgets everything but these.
  void remember_only(Rows rows);

  const SearchProblem& problem() const { return problem_; }
  const EvaluationRecord& record() const { return record_; }
  void set_record(EvaluationRecord record) { record_ = std::move(record); }

 private:
  void remember(std::span<const double> design, std::span<const double> outcomes);
  void evaluate_one_by_one(std::span<const double> designs, std::span<double> outcomes);

  const SearchProblem& problem_;
  EvaluationRecord record_;
  Rows remembered_;
  std::unordered_multimap<std::uint64_t, std::size_t> places_;  // hash of a design -> row of `remembered_`
};

}  // namespace zwidth::internal
