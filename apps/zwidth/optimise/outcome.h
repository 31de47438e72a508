#pragma once

#include <array>
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

/// One number that a study says of every design.
struct OutcomeFigure {
  enum class Kind { objective, constraint, further };
  std::string name;
  std::string unit;  ///< SI; empty where it is not known
  Kind kind = Kind::further;
  bool logarithm = false;  ///< its changes are told as they are, not in percent
};
/// Objectives, values of constraints, then derived values and measures with names: as `figure_values` has them.
std::vector<OutcomeFigure> outcome_figures(const StudyModel& model);
std::vector<double> figure_values(const DesignSheet& sheet, const Study& study);
/// How far each constraint is from its nearest limit, below zero where it is broken.
std::vector<double> margins_of(const DesignSheet& sheet);

/// How much each figure changes with each variable, at the chosen design.
struct ChosenSensitivity {
  std::vector<OutcomeFigure> figures;
  std::vector<double> values;   ///< of the figures
  std::vector<double> margins;  ///< of the constraints

  std::vector<std::size_t> smooth;  ///< variables that may have any value
  /// Of figures and margins, along those; empty if there are none.
  Sensitivity slopes;
  /// The figures when one of those has grown by `kPart` of its range, which its limits may forbid.
  std::vector<std::vector<double>> grown;

  /// A variable with steps, whole numbers or parts, one step down and one up.
  struct Step {
    std::size_t variable = 0;
    std::array<std::string, 2> value;            ///< in words; empty where there is no such step
    std::array<std::vector<double>, 2> figures;  ///< then
    std::array<bool, 2> feasible{};
  };
  std::vector<Step> steps;

  /// Whether any smooth variable changes a figure.
  bool slides(std::size_t figure) const;
  /// Whether any variable does.
  bool moves(std::size_t figure) const;
  /// Figures worth a line: not those that nothing moves, nor those that another line says already.
  std::vector<std::size_t> told() const;
  /// Whether two figures are one number by two names.
  bool same(std::size_t a, std::size_t b) const;
  static constexpr double kPart = 0.01;
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
  std::optional<ChosenSensitivity> sensitivity;
  std::optional<DesignSheet> start;          ///< the device itself, moved into the bounds
  bool start_moved = false;                  ///< it had to be
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
  /// Row of the front that is its knee; nothing with one objective, or if it has none.
  std::optional<std::size_t> knee_row() const;
};

/// "12.3 mm", "maxon-...", "0.571 rad": a variable for people.
std::string value_text(const DesignValue& value);

/// What a variable changes by: "+0.7 mm".
std::string step_text(DesignValue value, double step);

/// A number with its SI unit, for people.
std::string amount(double value, const std::string& unit);

/// Whether an expression is a logarithm: what it is taken of was multiplied where it changed by a difference.
bool is_logarithm(const std::string& expression);

/// "+1.2 %", of logarithms "+0.034"; "–" where there is no value after the change.
std::string change_text(double before, double after, bool logarithm);

/// "upper_arm ±0.1 mm, forearm ±0.1 mm".
std::string tolerance_words(const Study& study);
/// Standard deviation, 0 where it is rounding alone.
double deviation_of(const OutcomeSpread& spread);

/// How a constraint of the study stands at the chosen design, in words.
struct ConstraintActivity {
  std::string name, value, limit;
  std::string margin;     ///< how far it is from the limit
  double share = 0.0;     ///< that, of the limit
  bool active = false;    ///< at it
  std::string broken_by;  ///< "crank −1.3 mm": the variable that alone uses up the margin first; may be empty
};
std::vector<ConstraintActivity> constraint_activity(const StudyOutcome& outcome, const StudyModel& model);

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
