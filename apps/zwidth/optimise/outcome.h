#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "context.h"

#include "zwidth/design/search.h"
#include "zwidth/design/sensitivity.h"
#include "zwidth/design/study_model.h"

/// What came out of a study: its Pareto set, the design that was chosen from it, and how firm that is.

namespace zwidth {

/// How much each figure changes with each number that was chosen freely.
struct ChosenSlopes {
  std::vector<std::size_t> variables;  ///< of the study, those that are no whole numbers
  Sensitivity slopes;                  ///< of the objectives, not negated
};

/// Something that is undefined in some designs, and why.
struct CountedObstacle {
  DesignObstacle first;
  std::string example;  ///< a design where it is so: "a = 12 mm, b = ..."
  int count = 0;
};

struct StudyOutcome {
  SearchProblem problem;
  SearchOptions options;
  SearchResult result;
  std::vector<DesignSheet> front;     ///< of `SearchResult::front`
  std::optional<std::size_t> chosen;  ///< in `front`; nothing if no design is feasible
  std::string choice;                 ///< how it was chosen, in words
  std::optional<ChosenSlopes> slopes;
  std::optional<ToleranceStudy> tolerances;  ///< of objectives, then violations
  std::vector<CountedObstacle> obstacles;    ///< most frequent first
  int looked_at = 0;                         ///< how many designs, drawn at random, those are counted in
  int workers = 1;                           ///< threads, or ranks, that evaluated
  bool ranks = false;                        ///< the latter

  /// Row of `SearchResult::designs` of a design of the front.
  std::span<const double> design(std::size_t front_row) const;
  /// Its objectives as the search had them, all to be small.
  std::vector<double> minimised() const;
  /// Row of the front that is best in one objective.
  std::size_t best(std::size_t objective) const;
};

/// "12.3 mm", "maxon-...", "0.571 rad": a variable for people.
std::string value_text(const DesignValue& value);

/// Pages, tables and figures of the outcome, written into `directory`; what was written, by purpose.
std::vector<std::pair<std::string, std::string>> write_outcome(const StudyOutcome& outcome,
                                                               const StudyModel& model,
                                                               const std::string& directory);

/// "measure "force" asks for a box that is not reached all over: in 12 of 256 designs drawn, such as ...".
std::string obstacle_text(const CountedObstacle& one, int looked_at);

/// The outcome as one document (docs/json.md, optimise).
Json outcome_json(const StudyOutcome& outcome, const StudyModel& model);

/// The outcome as text.
std::string outcome_text(const StudyOutcome& outcome, const StudyModel& model, const Terminal& terminal,
                         const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace zwidth
