#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/study.h"
#include "zwidth/design/search.h"

/// A study made sense of: its keys found in the device, its expressions parsed and put in order, its figures
/// looked up; and the designs that it asks about, evaluated.

namespace zwidth {

/// What is wrong with a study, for this device: keys, figures and names that are unknown, values of the wrong
/// dimension, expressions that are none or depend on themselves. Keys are those of the study file. A
/// `StudyCheck`, once device and catalogue are bound. REQUIRES: `validate(device)` finds nothing.
std::vector<Problem> study_problems(const Study& study, const Description& device, const Catalogue& catalogue);

/// One variable's value in a design, for people.
struct DesignValue {
  std::string name;
  double value = 0.0;  ///< SI; index of the part
  std::string part;    ///< name of the part; empty for a number
  Dimension dimension = Dimension::number;
  std::string unit;  ///< SI; empty where it depends on the device
};

/// Why a design is not defined as the study asks: a rule of device files, an expression, or a figure.
struct DesignObstacle {
  std::string place;  ///< key of the study file, such as "derived[2].value"; empty for a rule of device files
  std::string what;   ///< the expression, the measure by its name, or the key of the device
  std::string rule;   ///< "has no value: it divides by zero, or the like"
  std::string with;   ///< the values of its names here: "D = 0.1, x = 2"

  bool operator==(const DesignObstacle&) const = default;
};

/// Everything that a study can say about one design.
struct DesignSheet {
  bool built = false;  ///< no rule of descriptions is broken; measures are undefined otherwise
  std::vector<DesignValue> variables;
  std::vector<DesignValue> derived;  ///< with names, and the measures; NaN where undefined
  std::vector<double> objectives;    ///< as the study has them, not negated; NaN where undefined
  std::vector<double> constraints;   ///< values; NaN where undefined
  std::vector<Interval> limits;      ///< of the constraints; infinite where there is none
  std::vector<double> violations;    ///< 0 where a constraint holds, NaN where it is undefined
  bool feasible = false;
};

/// Never changes, so threads may share it.
class StudyModel {
 public:
  /// REQUIRES: `study_problems` finds nothing. `catalogue` must outlive the model.
  StudyModel(const Study& study, const Description& device, const Catalogue& catalogue);
  ~StudyModel();
  StudyModel(const StudyModel&) = delete;
  StudyModel& operator=(const StudyModel&) = delete;

  const Study& study() const;
  const Description& device() const;  ///< as the file has it, before anything is chosen

  /// The study's, or where it names none nsga2 for several objectives and de for one.
  SearchAlgorithm algorithm() const;

  /// The search space and the names of outcomes; `evaluate` is left to the caller. Stepped variables and
  /// choices of parts are whole numbers, counted from 0. The first constraint is that a design can be built and
  /// all that is asked of it is defined.
  SearchProblem search_problem() const;

  /// SI units of objectives and constraints, for people; empty where they cannot be told.
  const std::vector<std::string>& objective_units() const;
  const std::vector<std::string>& constraint_units() const;

  /// How close the device itself comes to a design: each variable's value in its file, within the bounds; the
  /// middle where it has none.
  std::vector<double> device_design() const;
  /// Whether that is the device as its file has it: no variable had to be moved, and each has a key.
  bool starts_at_device() const;

  struct Plan;
  const Plan& plan() const { return *plan_; }

 private:
  std::unique_ptr<Plan> plan_;
};

/// Evaluates designs. Has scratch memory: one for each thread.
class StudyEvaluator {
 public:
  explicit StudyEvaluator(const StudyModel& model);
  ~StudyEvaluator();
  StudyEvaluator(StudyEvaluator&&) noexcept;
  StudyEvaluator& operator=(StudyEvaluator&&) noexcept;

  /// A row of outcomes (`BatchEvaluation`) of a row of the search space. Constraints that depend on no figure
  /// come first: a design that breaks one is not built, and its other constraints stay undefined. Objectives
  /// are asked for only of designs that meet all constraints.
  void evaluate(std::span<const double> design, std::span<double> outcome);

  /// All of it, whatever is broken. `tolerance`: how far each tolerance of the study strays, from -1 to 1;
  /// empty for not at all.
  DesignSheet sheet(std::span<const double> design, std::span<const double> tolerance = {});

  /// Why it is not `built`, or not all that `evaluate` asks of it is defined: the first cause alone of each
  /// that follows from another. Empty where nothing is the matter, or a constraint without figures is broken.
  std::vector<DesignObstacle> obstacles(std::span<const double> design);

  /// The design as a description, which may break rules (`sheet().built`). `source` is noted for all that the
  /// study decides.
  Description description(std::span<const double> design, const std::string& source);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace zwidth
