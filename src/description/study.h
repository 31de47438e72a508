#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"
#include "zwidth/description/units.h"

/// A study, the search for better designs of a device, as data: what `studies/*.toml` says (format in
/// docs/study_file.md). Expressions are kept as text; `StudyModel` (design/study_model.h) makes sense of them.

namespace zwidth {

/// What a search may choose: a number between two, or one part of several.
struct StudyVariable {
  std::string name;               ///< in expressions and tables
  std::vector<std::string> keys;  ///< of the device, that take its value; none for one that others follow from
  double min = 0.0;               ///< SI
  double max = 0.0;               ///< SI
  std::optional<Dimension> dimension;  ///< of the two, if they had a unit
  double step = 0.0;                   ///< 0: any value; else min, min + step, ... up to max
  bool integer = false;                ///< whole numbers only
  std::vector<std::string> parts;      ///< names of the catalogue to choose from, instead of the two ends

  bool operator==(const StudyVariable&) const = default;
};

/// A number that follows from others.
struct StudyDerived {
  std::string name;               ///< in expressions; may be empty
  std::vector<std::string> keys;  ///< of the device, that take its value
  std::string value;              ///< expression

  bool operator==(const StudyDerived&) const = default;
};

/// Where a figure is taken.
enum class StudyPlace {
  device,        ///< it belongs to the device as a whole
  home,          ///< the home posture
  middle,        ///< the middle of the joint ranges
  posture,       ///< a posture of the device file
  joints,        ///< active joint values
  position,      ///< a tool position, base frame
  joint_ranges,  ///< a lattice over the ranges of the active joints
  box,           ///< a lattice of tool positions in a box
  workspace,     ///< a lattice of tool positions in the workspace, as in data sheets
  postures,      ///< postures spread evenly over the joint ranges, as in data sheets
};

/// What becomes of a figure over many postures; `deviation`: the standard one.
enum class StudyStatistic { min, mean, max, deviation };

/// A figure of the design at a place, with a name for expressions.
struct StudyMeasure {
  std::string name;
  std::string figure;  ///< as `zwidth figures` lists them
  StudyPlace place = StudyPlace::device;
  std::string posture;                ///< its name
  std::vector<std::string> joints;    ///< expressions [rad] or [m]
  std::vector<std::string> position;  ///< expressions [m]
  std::vector<std::string> size;      ///< of the box, along x, y, z; expressions [m]
  int points = 5;                     ///< of a lattice, along each axis
  double spacing = 0.0;               ///< of the lattice in the workspace [m]
  int samples = 1000;                 ///< how many postures
  StudyStatistic statistic = StudyStatistic::mean;
  std::vector<std::string> force;              ///< on the tool, for figures under a load; expressions [N]
  std::vector<std::string> moment;             ///< expressions [N m]
  std::map<std::string, std::string> options;  ///< further ones of the figure; expressions

  bool operator==(const StudyMeasure&) const = default;
};

struct StudyObjective {
  std::string name;
  std::string value;  ///< expression
  bool maximise = false;

  bool operator==(const StudyObjective&) const = default;
};

struct StudyConstraint {
  std::string name;
  std::string value;   ///< expression
  std::string min;     ///< expression; empty without one
  std::string max;     ///< expression; empty without one
  double scale = 1.0;  ///< a violation as large as this weighs 1 beside those of other constraints

  bool operator==(const StudyConstraint&) const = default;
};

/// How far a number strays from what was designed when the device is built.
struct StudyTolerance {
  std::string name;
  std::vector<std::string> keys;  ///< of the device
  double half_width = 0.0;        ///< SI, or of the value if `relative`
  std::optional<Dimension> dimension;
  bool relative = false;

  bool operator==(const StudyTolerance&) const = default;
};

struct StudySearch {
  std::string algorithm = {};  ///< as `search_algorithms` (design/search.h) names them; empty: one that fits
  int population = 100;
  int generations = 200;
  std::uint64_t seed = 1;
  bool refine = false;  ///< improve the chosen design by a local search

  bool operator==(const StudySearch&) const = default;
};

/// How one design of the Pareto set is chosen.
enum class ChoiceRule { knee, weights, topsis };

struct StudyChoice {
  ChoiceRule rule = ChoiceRule::knee;
  std::map<std::string, double> weights;  ///< by objective; 1 where none is given

  bool operator==(const StudyChoice&) const = default;
};

struct Study {
  std::string name;
  std::string title;
  std::string source;
  std::string device;                  ///< built-in or file, as commands take it
  std::vector<std::string> overrides;  ///< of it, "KEY=VALUE" as after `--set`
  std::vector<StudyVariable> variables;
  std::vector<StudyDerived> derived;
  std::vector<StudyMeasure> measures;
  std::vector<StudyObjective> objectives;
  std::vector<StudyConstraint> constraints;
  std::vector<StudyTolerance> tolerances;
  StudySearch search;
  StudyChoice choice;

  bool operator==(const Study&) const = default;
};

/// As files call them.
const std::vector<std::pair<std::string, ChoiceRule>>& choice_rule_names();
const std::vector<std::pair<std::string, StudyStatistic>>& study_statistic_names();

/// Further rules; the problems have keys of the study file, and get their places here.
using StudyCheck = std::function<std::vector<Problem>(const Study&)>;

/// Reads the text of a study file, which `file` is the name of, with overrides as after `--set`. Throws
/// DescriptionError with everything that is wrong.
Study parse_study(std::string_view text, std::string_view file, const std::vector<std::string>& overrides = {},
                  const StudyCheck& check = {});

/// Reads `studies/NAME.toml` of the data directory, or the file that `study` names; "-" is the standard input.
/// A device file that the study names by a path is looked for beside the study file.
Study read_study(std::string_view study, const std::vector<std::string>& overrides, const Catalogue& catalogue,
                 const StudyCheck& check = {});

}  // namespace zwidth
