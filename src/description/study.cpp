#include "zwidth/description/study.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>

#include "zwidth/description/internal/table_reader.h"

namespace zwidth {
namespace {

constexpr double kLargestBudget = 1e7;   // generations, population
constexpr int kMostLatticePoints = 200;  // along an axis
constexpr int kMostSamples = 1000000;

// "mechanism.inner_link" is called inner_link, "mechanism.joint_range[1]" joint_range.
std::string name_of_key(const std::string& key) {
  std::string name = key.substr(key.rfind('.') + 1);
  return name.substr(0, name.find('['));
}

bool is_identifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

// Reads one study and remembers which names are taken.
class StudyReader {
 public:
  explicit StudyReader(Input& input) : file_(input, input.root(), "") {}

  Study read() {
    if (auto table = file_.table("study", Need::required, "start the file with [study] and name = \"...\"")) {
      study_.name = table->text("name", Need::required, "give the study a short name").value_or("");
      study_.title = table->text("title", Need::optional).value_or(study_.name);
      study_.source = table->text("source", Need::optional).value_or("");
      study_.device =
          table->text("device", Need::required, "name a built-in device, or the path of a device file")
              .value_or("");
      if (auto overrides = table->texts("set", "write set = [\"mechanism.forearm = '170 mm'\", ...]")) {
        study_.overrides = std::move(*overrides);
      }
      table->finish();
    }
    if (auto table = file_.table("search", Need::optional, "")) read_search(*table);
    if (auto table = file_.table("choice", Need::optional, "")) read_choice(*table);
    for (TableReader& table : file_.tables("variable")) read_variable(table);
    for (TableReader& table : file_.tables("derived")) read_derived(table);
    for (TableReader& table : file_.tables("measure")) read_measure(table);
    for (TableReader& table : file_.tables("objective")) read_objective(table);
    for (TableReader& table : file_.tables("constraint")) read_constraint(table);
    for (TableReader& table : file_.tables("tolerance")) read_tolerance(table);
    if (study_.variables.empty() && !file_.input().faulty("variable")) {
      file_.report("variable", "is missing: nothing may be chosen",
                   "add [[variable]] with key = \"mechanism.forearm\", min and max");
    }
    if (study_.objectives.empty() && !file_.input().faulty("objective")) {
      file_.report("objective", "is missing: nothing says which design is better",
                   "add [[objective]] with name = \"...\" and minimise = \"...\"");
    }
    file_.finish();
    return study_;
  }

 private:
  // A name that expressions may use; of all variables, derived values and measures no two have the same.
  void claim(TableReader& table, const std::string& name) {
    if (!is_identifier(name)) {
      table.report("name", "must be letters, digits and _, and not start with a digit", "rename it");
    } else if (!names_.insert(name).second) {
      table.report("name", "is used twice", "rename one of the two");
    }
  }

  // Of all variables, objectives and constraints no two have the same: they are columns of one table.
  void claim_column(TableReader& table, const std::string& name, const char* what) {
    const auto [found, added] = columns_.emplace(name, what);
    if (added) return;
    const std::string other = found->second;
    table.report("name", other == what ? "is used twice" : fmt::format("is the name of {} too", other),
                 "rename one of the two");
  }

  std::optional<int> whole(TableReader& table, std::string_view key, double min, double max) {
    const std::optional<double> value = table.quantity(key, Dimension::number, Need::optional);
    if (!value) return std::nullopt;
    if (*value != std::floor(*value) || *value < min || *value > max) {
      table.report(key, fmt::format("must be a whole number from {:.0f} to {:.0f}", min, max), "");
      return std::nullopt;
    }
    return static_cast<int>(*value);
  }

  void read_search(TableReader& table) {
    StudySearch& search = study_.search;
    if (const auto algorithm = table.text("algorithm", Need::optional, "such as \"nsga2\"")) {
      search.algorithm = *algorithm;
    }
    if (const auto value = whole(table, "population", 4, kLargestBudget)) search.population = *value;
    if (const auto value = whole(table, "generations", 1, kLargestBudget)) search.generations = *value;
    if (const auto value = whole(table, "seed", 0, 1e9)) search.seed = static_cast<std::uint64_t>(*value);
    search.refine = table.flag("refine", Need::optional).value_or(false);
    table.finish();
  }

  void read_choice(TableReader& table) {
    if (const auto rule = table.choice<ChoiceRule>("rule", choice_rule_names(), Need::optional)) {
      study_.choice.rule = *rule;
    }
    if (auto weights = table.table("weights", Need::optional, "write weights = { NAME = 1, ... }")) {
      weight_table_ = weights;
    }
    table.finish();
  }

  void read_variable(TableReader& table) {
    StudyVariable variable;
    variable.keys = table.texts("key", "name a key of the device, such as \"mechanism.forearm\"")
                        .value_or(std::vector<std::string>{});
    variable.name = table
                        .text("name", variable.keys.empty() ? Need::required : Need::optional,
                              "name the variable, or the key that it sets")
                        .value_or(variable.keys.empty() ? "" : name_of_key(variable.keys.front()));
    claim(table, variable.name);
    columns_.emplace(variable.name, "a variable");
    if (table.has("parts")) {
      variable.parts = table.texts("parts", "list parts of the catalogue").value_or(std::vector<std::string>{});
      variable.integer = true;
      variable.max = static_cast<double>(variable.parts.size()) - 1.0;
      for (const char* key : {"min", "max", "step", "integer"}) {
        if (table.has(key)) table.report(key, "stands beside a list of parts", "leave it out");
      }
      if (variable.parts.size() < 2) table.report("parts", "leaves no choice", "name at least two");
      if (variable.keys.empty()) table.report("key", "is missing", "name the part that is chosen");
      table.finish();
      study_.variables.push_back(std::move(variable));
      return;
    }
    const std::string_view advice = "give a number, such as \"50 mm\"";
    const auto min = table.any_quantity("min", Need::required, advice);
    const auto max = table.any_quantity("max", Need::required, advice);
    const auto step = table.any_quantity("step", Need::optional, advice);
    variable.integer = table.flag("integer", Need::optional).value_or(false);
    if (min && max) {
      variable.min = min->value;
      variable.max = max->value;
      variable.dimension = min->dimension ? min->dimension : max->dimension;
      if (min->dimension && max->dimension && min->dimension != max->dimension) {
        table.report("max",
                     fmt::format("is {}, but min is {}", dimension_name(*max->dimension),
                                 dimension_name(*min->dimension)),
                     "give both in units of one kind");
      } else if (!(variable.min < variable.max)) {
        table.report("max", "must be more than min", "leave the variable out to keep the device's value");
      }
    }
    if (step) {
      variable.step = step->value;
      if (!(variable.step > 0.0)) table.report("step", "must be positive", std::string(advice));
      if (variable.integer) table.report("step", "stands beside integer", "leave out one of the two");
      constexpr double kMostSteps = 1e6;
      if (variable.step > 0.0 && (variable.max - variable.min) / variable.step > kMostSteps) {
        table.report("step", "makes more than a million values", "leave it out to allow any value");
      }
    }
    if (variable.integer &&
        (variable.min != std::floor(variable.min) || variable.max != std::floor(variable.max))) {
      table.report("integer", "needs whole numbers at both ends", "round min and max");
    }
    table.finish();
    study_.variables.push_back(std::move(variable));
  }

  void read_derived(TableReader& table) {
    StudyDerived derived;
    derived.keys = table.texts("key", "name a key of the device").value_or(std::vector<std::string>{});
    derived.name = table
                       .text("name", derived.keys.empty() ? Need::required : Need::optional,
                             "name the value, or the key that it sets")
                       .value_or("");
    if (!derived.name.empty()) claim(table, derived.name);
    derived.value =
        table.expression("value", Need::required, "write an expression, such as \"60 mm / sin(qmax)\"")
            .value_or("0");
    table.finish();
    study_.derived.push_back(std::move(derived));
  }

  std::vector<std::string> three(TableReader& table, std::string_view key, std::string_view advice) {
    std::vector<std::string> values = table.expressions(key, advice);
    if (!values.empty() && values.size() != 3) {
      table.report(key, fmt::format("must have 3 entries, not {}", values.size()), std::string(advice));
      values.assign(3, "0");
    }
    return values;
  }

  void read_measure(TableReader& table) {
    StudyMeasure measure;
    measure.name = table.text("name", Need::required, "name the measure").value_or("");
    claim(table, measure.name);
    measure.figure =
        table.text("figure", Need::required, "name a figure; `zwidth figures` lists them").value_or("");
    int places = 0;
    if (const auto at =
            table.text("at", Need::optional, "write \"home\", \"middle\" or the name of a [[posture]]")) {
      measure.place = *at == "home"     ? StudyPlace::home
                      : *at == "middle" ? StudyPlace::middle
                                        : StudyPlace::posture;
      measure.posture = *at;
      ++places;
    }
    if (table.has("joints")) {
      measure.place = StudyPlace::joints;
      measure.joints = table.expressions("joints", "give a value for each active joint");
      ++places;
    }
    const auto over = table.choice<StudyPlace>("over",
                                               {{"box", StudyPlace::box},
                                                {"workspace", StudyPlace::workspace},
                                                {"postures", StudyPlace::postures},
                                                {"joint_ranges", StudyPlace::joint_ranges}},
                                               Need::optional);
    if (over) {
      measure.place = *over;
      ++places;
    }
    const std::string_view point = "give three coordinates, such as [0, 0, \"100 mm\"]";
    if (table.has("position")) {
      measure.position = three(table, "position", point);
      if (!over) {
        measure.place = StudyPlace::position;
        ++places;
      } else if (*over != StudyPlace::box) {
        table.report("position", "means nothing there", "leave it out, or write over = \"box\"");
      }
    }
    if (places > 1) {
      table.report("figure", "is asked for at more than one place", "give one of at, joints, position, over");
    }
    measure.size = three(table, "size", "give the three edges of the box");
    if (over == StudyPlace::box && (measure.size.empty() || measure.position.empty())) {
      table.report("over", "needs the box", "give its centre as position, and its edges as size");
    }
    if (const auto points = whole(table, "points", 1, kMostLatticePoints)) measure.points = *points;
    if (const auto samples = whole(table, "samples", 1, kMostSamples)) measure.samples = *samples;
    const bool lattice = over == StudyPlace::workspace;
    if (const auto spacing =
            table.quantity("spacing", Dimension::length, lattice ? Need::required : Need::optional,
                           "give the distance of the lattice's points, such as \"10 mm\"")) {
      measure.spacing = *spacing;
      if (!(*spacing > 0.0)) table.report("spacing", "must be positive", "give a length, such as \"10 mm\"");
    }
    const auto only_for = [&](const char* key, bool fits, const char* place) {
      if (table.has(key) && !fits) {
        table.report(key, fmt::format("goes with over = \"{}\"", place), "leave it out");
      }
    };
    only_for("spacing", lattice, "workspace");
    only_for("samples", over == StudyPlace::postures, "postures");
    only_for("points", over == StudyPlace::box || over == StudyPlace::joint_ranges, "box");
    only_for("size", over == StudyPlace::box, "box");
    if (const auto statistic = table.choice<StudyStatistic>("statistic", study_statistic_names(),
                                                            over ? Need::required : Need::optional)) {
      measure.statistic = *statistic;
    }
    measure.force = three(table, "force", "give three components, such as [\"20 N\", 0, 0]");
    measure.moment = three(table, "moment", "give three components, such as [0, 0, \"0.1 N m\"]");
    if (auto options = table.table("options", Need::optional, "")) {
      for (const std::string& key : options->keys()) {
        measure.options[key] = options->expression(key, Need::required).value_or("0");
      }
      options->finish();
    }
    table.finish();
    study_.measures.push_back(std::move(measure));
  }

  void read_objective(TableReader& table) {
    StudyObjective objective;
    objective.name = table.text("name", Need::required, "name the objective").value_or("");
    claim_column(table, objective.name, "an objective");
    const auto minimise = table.expression("minimise", Need::optional);
    const auto maximise = table.expression("maximise", Need::optional);
    if (minimise.has_value() == maximise.has_value()) {
      table.report("name", "has to be either minimised or maximised",
                   "write minimise = \"...\" or maximise = \"...\"");
    }
    objective.maximise = maximise.has_value();
    objective.value = maximise ? *maximise : minimise.value_or("0");
    table.finish();
    study_.objectives.push_back(std::move(objective));
  }

  void read_constraint(TableReader& table) {
    StudyConstraint constraint;
    constraint.name = table.text("name", Need::required, "name the constraint").value_or("");
    claim_column(table, constraint.name, "a constraint");
    constraint.value = table.expression("value", Need::required, "write an expression").value_or("0");
    constraint.min = table.expression("min", Need::optional).value_or("");
    constraint.max = table.expression("max", Need::optional).value_or("");
    if (constraint.min.empty() && constraint.max.empty()) {
      table.report("value", "has no limit", "give min, max, or both");
    }
    if (const auto scale = table.any_quantity("scale", Need::optional, "give a size")) {
      constraint.scale = scale->value;
      if (!(scale->value > 0.0)) table.report("scale", "must be positive", "give a size");
    }
    table.finish();
    study_.constraints.push_back(std::move(constraint));
  }

  void read_tolerance(TableReader& table) {
    StudyTolerance tolerance;
    tolerance.keys = table.texts("key", "name a key of the device").value_or(std::vector<std::string>{});
    if (tolerance.keys.empty()) table.report("key", "is missing", "name what strays");
    tolerance.name = table.text("name", Need::optional)
                         .value_or(tolerance.keys.empty() ? "" : name_of_key(tolerance.keys.front()));
    const std::string_view advice = "write half_width = \"0.1 mm\", or relative = 0.08";
    const auto half_width = table.any_quantity("half_width", Need::optional, advice);
    const auto relative = table.quantity("relative", Dimension::number, Need::optional, advice);
    if (half_width.has_value() == relative.has_value()) {
      table.report("key", "strays by an unknown amount", std::string(advice));
    }
    tolerance.relative = relative.has_value();
    tolerance.half_width = relative ? *relative : (half_width ? half_width->value : 0.0);
    if (half_width) tolerance.dimension = half_width->dimension;
    if (!(tolerance.half_width > 0.0)) {
      table.report(relative ? "relative" : "half_width", "must be positive", std::string(advice));
    }
    table.finish();
    study_.tolerances.push_back(std::move(tolerance));
  }

 public:
  // After all objectives are known.
  void read_weights() {
    if (!weight_table_) return;
    std::vector<std::string> known;
    for (const StudyObjective& objective : study_.objectives) known.push_back(objective.name);
    for (const std::string& key : weight_table_->keys()) {
      const auto weight = weight_table_->quantity(key, Dimension::number, Need::required);
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        weight_table_->report(key, "is no objective", suggest(key, known));
      } else if (weight && *weight < 0.0) {
        weight_table_->report(key, "must not be negative", "0 leaves an objective out");
      } else if (weight) {
        study_.choice.weights[key] = *weight;
      }
    }
  }
  const Study& study() const { return study_; }

 private:
  TableReader file_;
  Study study_;
  std::optional<TableReader> weight_table_;
  std::set<std::string> names_;
  std::map<std::string, std::string> columns_;  // name -> "a variable", ...
};

}  // namespace

const std::vector<std::pair<std::string, ChoiceRule>>& choice_rule_names() {
  static const std::vector<std::pair<std::string, ChoiceRule>> names = {
      {"knee", ChoiceRule::knee}, {"weights", ChoiceRule::weights}, {"topsis", ChoiceRule::topsis}};
  return names;
}

const std::vector<std::pair<std::string, StudyStatistic>>& study_statistic_names() {
  static const std::vector<std::pair<std::string, StudyStatistic>> names = {
      {"min", StudyStatistic::min},
      {"mean", StudyStatistic::mean},
      {"max", StudyStatistic::max},
      {"deviation", StudyStatistic::deviation}};
  return names;
}

Study parse_study(std::string_view text, std::string_view file, const std::vector<std::string>& overrides,
                  const StudyCheck& check) {
  Input input(text, file);
  for (const std::string& one : overrides) input.set(one);
  StudyReader reader(input);
  reader.read();
  reader.read_weights();
  if (check && !reader.study().device.empty()) {
    std::vector<Problem> further = check(reader.study());
    if (input.has_problems()) {
      // Names that could not be read are missed elsewhere: that is no mistake of its own.
      std::erase_if(further, [](const Problem& one) { return one.rule.starts_with("uses "); });
    }
    input.add_value_problems(further);
  }
  input.throw_problems();
  return reader.study();
}

Study read_study(std::string_view study, const std::vector<std::string>& overrides, const Catalogue& catalogue,
                 const StudyCheck& check) {
  if (study == "-") return parse_study(read_text("-"), "<stdin>", overrides, check);
  const std::filesystem::path path = resolve_study(study, catalogue);
  const auto beside_it = [&](const Study& one) -> Study {
    Study moved = one;
    if (one.device.ends_with(".toml") && std::filesystem::path(one.device).is_relative()) {
      moved.device = (path.parent_path() / one.device).lexically_normal().string();
    }
    return moved;
  };
  return beside_it(parse_study(read_text(path.string()), path.string(), overrides, [&](const Study& one) {
    return check ? check(beside_it(one)) : std::vector<Problem>{};
  }));
}

}  // namespace zwidth
