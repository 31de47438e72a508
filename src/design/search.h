#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Searches a space of designs for those that no other beats. What a design means is left to `evaluate`.

namespace zwidth {

/// One number that a search may choose.
struct SearchVariable {
  std::string name;
  double min = 0.0;
  double max = 0.0;
  bool integer = false;  ///< whole numbers only; min and max are whole then

  bool operator==(const SearchVariable&) const = default;
};

/// Evaluates designs, one row of `designs` each (a value per variable), into rows of `outcomes`: the
/// objectives, all to be minimised, then the violation of each constraint, which is 0 where it holds and
/// positive otherwise. Objectives of a design that breaks a constraint, and whatever cannot be computed, are
/// NaN; a NaN violation counts as worse than any number. A row depends on its design alone. Returns false if it
/// was told to stop.
using BatchEvaluation = std::function<bool(std::span<const double> designs, std::span<double> outcomes)>;

struct SearchProblem {
  std::vector<SearchVariable> variables;
  std::vector<std::string> objectives;   ///< names, at least one
  std::vector<std::string> constraints;  ///< names
  BatchEvaluation evaluate;

  std::size_t outcome_size() const { return objectives.size() + constraints.size(); }
};

}  // namespace zwidth
