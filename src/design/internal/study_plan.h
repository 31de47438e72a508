#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "zwidth/design/figures.h"
#include "zwidth/design/study_model.h"

/// What a study means, ready to be evaluated.

namespace zwidth {
namespace internal {

// Measures that are taken in the same postures.
struct PlaceGroup {
  std::vector<std::size_t> measures;
};

// What an expression needs before it has a value.
struct StudyUse {
  std::vector<std::size_t> groups;  // of measures
  std::vector<std::size_t> after;   // derived values that follow from measures, in order
  bool of_figures() const { return !groups.empty(); }
};

// The value of a variable [SI] from a search value.
inline double value_of(const StudyVariable& variable, double searched) {
  if (variable.step <= 0.0) return searched;
  return std::min(variable.min + searched * variable.step, variable.max);
}

}  // namespace internal

struct StudyModel::Plan {
  Study study;
  Description device;
  const Catalogue* catalogue = nullptr;

  std::vector<std::string> names;  // whose values are kept: variables, derived, measures, keys
  std::vector<std::string> units;  // of each, SI, for people; empty where it depends on the device
  std::vector<std::string> objective_units, constraint_units;
  std::map<std::string, std::size_t> index;
  std::vector<std::size_t> variable_value, derived_value, measure_value;  // of each, in `names`
  std::vector<std::string> keys;                                          // read by expressions
  std::vector<std::size_t> key_value;

  std::vector<std::size_t> before;              // derived values that no measure decides, in order
  std::vector<internal::StudyUse> derived_use;  // of each derived value
  std::vector<internal::PlaceGroup> groups;
  std::vector<std::size_t> group_of;  // of each measure
  std::vector<const FigureDefinition*> figures;
  std::vector<internal::StudyUse> constraint_use, objective_use;
  bool with_drives = false;
};

}  // namespace zwidth
