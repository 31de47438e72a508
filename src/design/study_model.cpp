#include "zwidth/design/study_model.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <random>
#include <set>

#include "zwidth/analysis/workspace.h"
#include "zwidth/description/keys.h"
#include "zwidth/description/names.h"
#include "zwidth/design/expression.h"
#include "zwidth/design/expression_unit.h"
#include "zwidth/design/internal/study_plan.h"

namespace zwidth {
namespace {

using Use = internal::StudyUse;

constexpr const char* kBuildable = "can be built";
constexpr const char* kReachedShare = "reached_share";

// What a name in an expression stands for.
enum class NameKind { variable, derived, measure, key };

bool same_place(const StudyMeasure& a, const StudyMeasure& b) {
  return a.place == b.place && a.posture == b.posture && a.joints == b.joints && a.position == b.position &&
         a.size == b.size && a.spacing == b.spacing && a.samples == b.samples &&
         (a.place < StudyPlace::joint_ranges || a.points == b.points);
}

bool over_many(const StudyMeasure& measure) {
  return measure.place >= StudyPlace::joint_ranges;
}

}  // namespace

namespace {

// Reads a study, its device in hand, into a plan, and notes what is wrong.
class Planner {
 public:
  Planner(const Study& study, const Description& device, const Catalogue& catalogue) {
    plan_.study = study;
    plan_.device = device;
    plan_.catalogue = &catalogue;
    device_ = device;
    name_values();
    look_up_keys();
    look_up_figures();
    look_up_algorithm();
    parse_everything();
    check_ends();
    if (problems_.empty()) order();
    if (problems_.empty()) check_units();
    if (problems_.empty()) check_defined();
    if (problems_.empty()) {
      note_units();
      for (const StudyConstraint& one : study.constraints) {
        plan_.constraint_use.push_back(use_of({one.value, one.min, one.max}));
      }
      for (const StudyObjective& one : study.objectives) plan_.objective_use.push_back(use_of({one.value}));
    }
  }

  std::vector<Problem> problems() const { return problems_; }
  StudyModel::Plan plan() { return std::move(plan_); }

 private:
  static std::string at(const char* table, std::size_t index, const std::string& key) {
    return fmt::format("{}[{}].{}", table, index, key);
  }
  void wrong(std::string key, std::string value, std::string rule, std::string advice) {
    problems_.push_back({.key = std::move(key),
                         .value = std::move(value),
                         .rule = std::move(rule),
                         .advice = std::move(advice)});
  }
  std::size_t add_name(const std::string& name, NameKind kind) {
    const auto [found, added] = plan_.index.emplace(name, plan_.names.size());
    if (added) {
      plan_.names.push_back(name);
      kinds_.push_back(kind);
    }
    return found->second;
  }

  void name_values() {
    for (const StudyVariable& one : plan_.study.variables) {
      plan_.variable_value.push_back(add_name(one.name, NameKind::variable));
    }
    std::size_t nameless = 0;
    for (const StudyDerived& one : plan_.study.derived) {
      // A value without a name gets one that nobody can write.
      const std::string name = one.name.empty() ? fmt::format("#{}", nameless++) : one.name;
      plan_.derived_value.push_back(add_name(name, NameKind::derived));
    }
    for (const StudyMeasure& one : plan_.study.measures) {
      plan_.measure_value.push_back(add_name(one.name, NameKind::measure));
    }
  }

  std::vector<std::string> number_keys() {
    std::vector<std::string> keys;
    for (const NumberSlot& slot : number_slots(device_)) keys.push_back(slot.key);
    return keys;
  }

  void no_number(const std::vector<std::string>& keys, const std::string& key, const std::string& place) {
    const bool part = !find_parts(device_, key).empty();
    const std::string which = keys.size() > 1 ? fmt::format("has {}, which ", key) : "";
    wrong(place, fmt::format("\"{}\"", key),
          which + (part ? "is a part of the device, not a number" : "is no number of the device"),
          part ? "list the parts to choose from with parts = [...]" : suggest(key, number_keys()));
  }

  // The slots that take a value; notes keys that are none, or are set twice.
  std::vector<NumberSlot> claim_numbers(const std::vector<std::string>& keys, const std::string& place) {
    std::vector<NumberSlot> all;
    for (const std::string& key : keys) {
      std::vector<NumberSlot> slots = find_numbers(device_, key);
      if (slots.empty()) no_number(keys, key, place);
      for (NumberSlot& slot : slots) {
        if (!claimed_.insert(slot.key).second) {
          wrong(place, fmt::format("\"{}\"", key), fmt::format("sets {} a second time", slot.key),
                "let one variable or derived value decide it");
        }
        all.push_back(std::move(slot));
      }
    }
    return all;
  }

  void look_up_keys() {
    const Study& study = plan_.study;
    for (std::size_t i = 0; i < study.variables.size(); ++i) {
      const StudyVariable& variable = study.variables[i];
      const std::string place = at("variable", i, "key");
      if (!variable.parts.empty()) {
        look_up_parts(variable, i);
        continue;
      }
      for (const NumberSlot& slot : claim_numbers(variable.keys, place)) {
        check_dimension(slot, variable.dimension, at("variable", i, "min"));
        if (slot.whole() && !variable.integer && variable.step != std::floor(variable.step)) {
          wrong(at("variable", i, "integer"), "", fmt::format("is needed: {} is a whole number", slot.key),
                "write integer = true");
        }
      }
    }
    for (std::size_t i = 0; i < study.derived.size(); ++i) {
      claim_numbers(study.derived[i].keys, at("derived", i, "key"));
    }
    for (std::size_t i = 0; i < study.tolerances.size(); ++i) {
      const StudyTolerance& tolerance = study.tolerances[i];
      for (const std::string& key : tolerance.keys) {
        const std::vector<NumberSlot> slots = find_numbers(device_, key);
        if (slots.empty()) no_number(tolerance.keys, key, at("tolerance", i, "key"));
        for (const NumberSlot& slot : slots) {
          check_dimension(slot, tolerance.dimension, at("tolerance", i, "half_width"));
        }
      }
    }
  }

  void check_dimension(const NumberSlot& slot, const std::optional<Dimension>& given,
                       const std::string& place) {
    if (!given || *given == slot.dimension) return;
    wrong(place, "",
          fmt::format("is {}, but {} is {}", dimension_name(*given), slot.key, dimension_name(slot.dimension)),
          "give it in units of that kind");
  }

  void look_up_parts(const StudyVariable& variable, std::size_t i) {
    std::set<std::pair<std::size_t, std::string_view>> said;
    for (const std::string& key : variable.keys) {
      const std::vector<PartSlot> slots = find_parts(device_, key);
      if (slots.empty()) {
        std::vector<std::string> known;
        for (const PartSlot& slot : part_slots(device_)) known.push_back(slot.key);
        wrong(at("variable", i, "key"), fmt::format("\"{}\"", key), "is no part of the device",
              suggest(key, known));
      }
      for (const PartSlot& slot : slots) {
        if (!claimed_.insert(slot.key).second) {
          wrong(at("variable", i, "key"), fmt::format("\"{}\"", key),
                fmt::format("chooses {} a second time", slot.key), "let one variable decide it");
        }
        const std::vector<std::string> names = part_names(slot, *plan_.catalogue);
        for (std::size_t p = 0; p < variable.parts.size(); ++p) {
          if (std::find(names.begin(), names.end(), variable.parts[p]) != names.end()) continue;
          // Said once, however many parts of the device take it.
          if (!said.insert({p, slot.kind()}).second) continue;
          wrong(fmt::format("variable[{}].parts[{}]", i, p), fmt::format("\"{}\"", variable.parts[p]),
                fmt::format("is no {} of the catalogue", slot.kind()), suggest(variable.parts[p], names));
        }
      }
    }
  }

  void look_up_figures() {
    std::vector<std::string> names{kReachedShare};
    for (const FigureDefinition& figure : figure_definitions()) names.emplace_back(figure.name);
    const std::vector<std::string> joints = active_joint_names(device_.mechanism);
    for (std::size_t i = 0; i < plan_.study.measures.size(); ++i) {
      const StudyMeasure& measure = plan_.study.measures[i];
      const FigureDefinition* figure = find_figure(measure.figure);
      plan_.figures.push_back(figure);
      if (figure == nullptr) {
        if (measure.figure != kReachedShare) {
          wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure), "is no figure",
                suggest(measure.figure, names) + "; `zwidth figures` lists them");
        } else if (!over_many(measure)) {
          wrong(at("measure", i, "figure"), "", "is a share of many postures",
                "write over = \"box\", \"postures\" or \"joint_ranges\"");
        }
      } else {
        check_measure(measure, *figure, i);
        plan_.with_drives = plan_.with_drives || figure->needs_drives;
      }
      if (!measure.joints.empty() && measure.joints.size() != joints.size()) {
        wrong(at("measure", i, "joints"), fmt::format("{} values", measure.joints.size()),
              fmt::format("must be {}, one for each active joint", joints.size()), "");
      }
      if (measure.place == StudyPlace::posture) {
        std::vector<std::string> known{"home"};
        for (const PostureDescription& one : device_.postures) known.push_back(one.name);
        if (std::find(known.begin(), known.end(), measure.posture) == known.end()) {
          wrong(at("measure", i, "at"), fmt::format("\"{}\"", measure.posture), "is no posture of the device",
                suggest(measure.posture, known));
        }
      }
      group(i);
    }
  }

  void look_up_algorithm() {
    const std::string& name = plan_.study.search.algorithm;
    if (name.empty()) return;
    const std::optional<SearchAlgorithm> algorithm = search_algorithm(name);
    if (!algorithm) {
      std::vector<std::string> known;
      for (const SearchAlgorithmInfo& one : search_algorithms()) known.emplace_back(one.name);
      wrong("search.algorithm", fmt::format("\"{}\"", name), "is not known", suggest(name, known));
      return;
    }
    const bool several = plan_.study.objectives.size() > 1;
    if (several ? info(*algorithm).several_objectives : info(*algorithm).one_objective) return;
    wrong("search.algorithm", fmt::format("\"{}\"", name),
          fmt::format("cannot search for {}", several ? "several objectives" : "one objective"),
          several ? "take nsga2, or join them in one expression" : "take de or cmaes");
  }

  void check_measure(const StudyMeasure& measure, const FigureDefinition& figure, std::size_t i) {
    if (figure.of_posture && measure.place == StudyPlace::device) {
      wrong(
          at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure), "is a figure of a posture",
          "say where: at = \"home\", joints = [...], position = [...], over = \"box\" or over = \"workspace\"");
    }
    if (!figure.of_posture && measure.place != StudyPlace::device) {
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure),
            "is a figure of the device as a whole", "leave the posture out");
    }
    const std::span<const int> axes = mechanism().tool_axes();
    if (figure.axis >= 0 && std::find(axes.begin(), axes.end(), figure.axis) == axes.end()) {
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure),
            fmt::format("does not concern this device: its tool does not {} {}",
                        figure.axis < 3 ? "move along" : "turn about", "xyz"[figure.axis % 3]),
            "take another axis");
    }
    if (const auto obstacle = workspace_obstacle(mechanism());
        measure.place == StudyPlace::workspace && obstacle) {
      wrong(at("measure", i, "over"), "", fmt::format("cannot be asked of this device: {}", *obstacle),
            "write over = \"postures\", or over = \"box\"");
    }
    const bool load = !measure.force.empty() || !measure.moment.empty();
    if (figure.load == FigureLoad::needed && !load) {
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure), "is a figure under a load",
            "add force = [\"20 N\", 0, 0], say");
    } else if (figure.load == FigureLoad::none && load) {
      wrong(at("measure", i, "force"), "", fmt::format("means nothing for {}", measure.figure), "leave it out");
    }
    std::vector<std::string> known;
    for (const FigureOption& option : figure.options) known.emplace_back(option.name);
    for (const auto& [key, text] : measure.options) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      wrong(at("measure", i, "options." + key), "", fmt::format("is no option of {}", measure.figure),
            known.empty() ? "leave it out" : suggest(key, known));
    }
  }

  void group(std::size_t measure) {
    const std::vector<StudyMeasure>& measures = plan_.study.measures;
    for (std::size_t g = 0; g < plan_.groups.size(); ++g) {
      if (same_place(measures[plan_.groups[g].measures.front()], measures[measure])) {
        plan_.groups[g].measures.push_back(measure);
        plan_.group_of.push_back(g);
        return;
      }
    }
    plan_.group_of.push_back(plan_.groups.size());
    plan_.groups.push_back({{measure}});
  }

  // Names in the expression at `place`; keys of the device are added to the names on the way.
  void parse(const std::string& text, const std::string& place, bool before_measures = false) {
    if (text.empty()) return;
    const ParsedExpression parsed = parse_expression(text);
    if (!parsed) {
      wrong(place, fmt::format("\"{}\"", text), parsed.rule, parsed.advice);
      return;
    }
    if (parsed.names.empty() && std::isnan(Expression(text, {})())) {
      wrong(place, fmt::format("\"{}\"", text), "has no value: it divides by zero, or the like",
            "change its numbers");
      return;
    }
    std::vector<std::size_t> used;
    for (const std::string& name : parsed.names) {
      const auto found = plan_.index.find(name);
      if (found != plan_.index.end()) {
        used.push_back(found->second);
        if (before_measures && kinds_[found->second] == NameKind::measure) {
          wrong(place, fmt::format("\"{}\"", text),
                fmt::format("uses {}, which is measured only when the design stands", name),
                "leave measures to objectives and constraints");
        }
        continue;
      }
      if (find_numbers(device_, name).empty()) {
        std::vector<std::string> known = plan_.names;
        std::erase_if(known, [](const std::string& one) { return one.starts_with('#'); });
        for (const std::string& key : number_keys()) known.push_back(key);
        wrong(place, fmt::format("\"{}\"", text), fmt::format("uses {}, which is nothing known", name),
              suggest(name, known));
        continue;
      }
      used.push_back(add_name(name, NameKind::key));
      plan_.keys.push_back(name);
      plan_.key_value.push_back(used.back());
    }
    names_of_[text] = used;
  }

  void parse_everything() {
    const Study& study = plan_.study;
    for (std::size_t i = 0; i < study.derived.size(); ++i) {
      parse(study.derived[i].value, at("derived", i, "value"), !study.derived[i].keys.empty());
    }
    for (std::size_t i = 0; i < study.measures.size(); ++i) {
      const StudyMeasure& measure = study.measures[i];
      const auto all = [&](const std::vector<std::string>& texts, const char* key) {
        for (std::size_t j = 0; j < texts.size(); ++j) {
          parse(texts[j], at("measure", i, fmt::format("{}[{}]", key, j)), true);
        }
      };
      all(measure.joints, "joints");
      all(measure.position, "position");
      all(measure.size, "size");
      all(measure.force, "force");
      all(measure.moment, "moment");
      for (const auto& [key, text] : measure.options) parse(text, at("measure", i, "options." + key), true);
    }
    for (std::size_t i = 0; i < study.objectives.size(); ++i) {
      const StudyObjective& one = study.objectives[i];
      parse(one.value, at("objective", i, one.maximise ? "maximise" : "minimise"));
    }
    for (std::size_t i = 0; i < study.constraints.size(); ++i) {
      parse(study.constraints[i].value, at("constraint", i, "value"));
      parse(study.constraints[i].min, at("constraint", i, "min"));
      parse(study.constraints[i].max, at("constraint", i, "max"));
    }
  }

  // What a name measures; nothing where it may be anything.
  std::optional<UnitPowers> unit_of(std::size_t name, BareNumber bare) {
    const Study& study = plan_.study;
    const auto place_in = [name](const std::vector<std::size_t>& list) {
      return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin());
    };
    switch (kinds_[name]) {
      case NameKind::variable: {
        const StudyVariable& one = study.variables[place_in(plan_.variable_value)];
        if (!one.parts.empty()) return std::nullopt;
        if (!one.keys.empty()) return unit_powers(find_numbers(device_, one.keys.front()).front().dimension);
        return one.dimension ? std::optional(unit_powers(*one.dimension)) : std::nullopt;
      }
      case NameKind::key:
        return unit_powers(find_numbers(device_, plan_.names[name]).front().dimension);
      case NameKind::measure: {
        const FigureDefinition* figure = plan_.figures[place_in(plan_.measure_value)];
        if (figure == nullptr) return UnitPowers{};
        if (figure->unit == "J") return unit_powers(Dimension::torque);
        const std::optional<Dimension> dimension = figure->dimension();
        return dimension ? std::optional(unit_powers(*dimension)) : std::nullopt;
      }
      default: {
        const StudyDerived& one = study.derived[place_in(plan_.derived_value)];
        if (!one.keys.empty()) return unit_powers(find_numbers(device_, one.keys.front()).front().dimension);
        return unit_of(one.value, bare).unit;
      }
    }
  }
  // REQUIRES: no derived value follows from itself.
  ExpressionUnit unit_of(const std::string& text, BareNumber bare) {
    return expression_unit(
        text, [&](const std::string& name) { return unit_of(plan_.index.at(name), bare); }, bare);
  }

  // An expression has to add up, and to be of the kind that is wanted.
  std::optional<UnitPowers> check_unit(const std::string& text, const std::string& place,
                                       const std::optional<UnitPowers>& wanted = {},
                                       const std::string& of = "") {
    if (text.empty()) return std::nullopt;
    const ExpressionUnit found = unit_of(text, BareNumber::any);
    if (!found.rule.empty()) {
      wrong(place, fmt::format("\"{}\"", text), found.rule, "give both the same kind of unit");
    } else if (found.unit && wanted && !(*found.unit == *wanted)) {
      wrong(place, fmt::format("\"{}\"", text),
            fmt::format("is {}, but {} is {}", unit_words(*found.unit), of, unit_words(*wanted)),
            "give it in units of that kind");
    }
    return found.unit;
  }

  void check_units() {
    const Study& study = plan_.study;
    for (std::size_t i = 0; i < study.derived.size(); ++i) {
      const StudyDerived& one = study.derived[i];
      if (one.keys.empty()) check_unit(one.value, at("derived", i, "value"));
      for (const std::string& key : one.keys) {
        const std::size_t before = problems_.size();
        check_unit(one.value, at("derived", i, "value"),
                   unit_powers(find_numbers(device_, key).front().dimension), key);
        if (problems_.size() > before) break;
      }
    }
    const std::vector<Dimension> joints = active_joint_dimensions(device_.mechanism);
    for (std::size_t i = 0; i < study.measures.size(); ++i) {
      const StudyMeasure& one = study.measures[i];
      const auto each = [&](const std::vector<std::string>& texts, const char* key, Dimension dimension,
                            const char* of) {
        for (std::size_t j = 0; j < texts.size(); ++j) {
          check_unit(texts[j], at("measure", i, fmt::format("{}[{}]", key, j)), unit_powers(dimension), of);
        }
      };
      for (std::size_t j = 0; j < one.joints.size(); ++j) {
        check_unit(one.joints[j], at("measure", i, fmt::format("joints[{}]", j)), unit_powers(joints[j]),
                   "that joint's value");
      }
      each(one.position, "position", Dimension::length, "a position");
      each(one.size, "size", Dimension::length, "an edge");
      each(one.force, "force", Dimension::force, "a force");
      each(one.moment, "moment", Dimension::torque, "a moment");
      for (const auto& [key, text] : one.options) {
        if (plan_.figures[i] == nullptr) continue;
        for (const FigureOption& option : plan_.figures[i]->options) {
          if (option.name == key) {
            check_unit(text, at("measure", i, "options." + key), unit_powers(option.dimension), key);
          }
        }
      }
    }
    for (std::size_t i = 0; i < study.objectives.size(); ++i) {
      const StudyObjective& one = study.objectives[i];
      check_unit(one.value, at("objective", i, one.maximise ? "maximise" : "minimise"));
    }
    for (std::size_t i = 0; i < study.constraints.size(); ++i) {
      const StudyConstraint& one = study.constraints[i];
      const std::optional<UnitPowers> value = check_unit(one.value, at("constraint", i, "value"));
      check_unit(one.min, at("constraint", i, "min"), value, one.value);
      check_unit(one.max, at("constraint", i, "max"), value, one.value);
    }
  }

  // Limits that exclude each other, where both are plain numbers.
  void check_ends() {
    for (std::size_t i = 0; i < plan_.study.constraints.size(); ++i) {
      const StudyConstraint& one = plan_.study.constraints[i];
      if (one.min.empty() || one.max.empty()) continue;
      const ParsedExpression low = parse_expression(one.min), high = parse_expression(one.max);
      if (!low || !high || !low.names.empty() || !high.names.empty()) continue;
      if (Expression(one.min, {})() > Expression(one.max, {})()) {
        wrong(at("constraint", i, "max"), fmt::format("\"{}\"", one.max),
              fmt::format("is less than min, {}: nothing is between them", one.min), "exchange the two");
      }
    }
  }

  // Whether an expression has a value at all, for some values of its names: tried, not proven.
  bool ever_defined(const std::string& text) {
    std::map<std::string, double> values;
    const std::vector<std::size_t>& names = names_of_.at(text);
    for (const std::size_t name : names) values[plan_.names[name]] = 0.0;
    const Expression expression(text, [&](const std::string& name) { return &values.at(name); });
    std::minstd_rand random(1);
    std::uniform_real_distribution<double> share(0.0, 1.0), decades(-6.0, 6.0);
    constexpr int kTries = 500;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      for (const std::size_t name : names) {
        double& value = values[plan_.names[name]];
        value = std::pow(10.0, decades(random)) * (share(random) < 0.2 ? -1.0 : 1.0);
        if (attempt % 3 == 0) value = share(random);
        if (kinds_[name] == NameKind::key && attempt % 2 == 0) {
          value = find_numbers(device_, plan_.names[name]).front().get();
        }
        if (kinds_[name] != NameKind::variable || attempt % 4 == 3) continue;
        for (std::size_t v = 0; v < plan_.study.variables.size(); ++v) {
          const StudyVariable& one = plan_.study.variables[v];
          if (plan_.variable_value[v] == name) value = one.min + share(random) * (one.max - one.min);
        }
      }
      if (!std::isnan(expression())) return true;
    }
    return false;
  }

  void check_defined() {
    const auto check = [&](const std::string& text, const std::string& place) {
      if (text.empty() || names_of_.at(text).empty() || ever_defined(text)) return;
      std::string names;
      for (const std::size_t name : names_of_.at(text))
        names += (names.empty() ? "" : ", ") + plan_.names[name];
      wrong(place, fmt::format("\"{}\"", text),
            fmt::format("has no value, whatever {} may be: it divides by zero, or the like", names),
            "change it");
    };
    const Study& study = plan_.study;
    for (std::size_t i = 0; i < study.derived.size(); ++i)
      check(study.derived[i].value, at("derived", i, "value"));
    for (std::size_t i = 0; i < study.objectives.size(); ++i) {
      const StudyObjective& one = study.objectives[i];
      check(one.value, at("objective", i, one.maximise ? "maximise" : "minimise"));
    }
    for (std::size_t i = 0; i < study.constraints.size(); ++i) {
      check(study.constraints[i].value, at("constraint", i, "value"));
      check(study.constraints[i].min, at("constraint", i, "min"));
      check(study.constraints[i].max, at("constraint", i, "max"));
    }
  }

  // The unit of an expression's value for people; empty where it cannot be told.
  std::string shown_unit(const std::string& text) {
    const auto known = plan_.index.find(text);
    if (known != plan_.index.end()) return shown_unit(known->second);
    const ExpressionUnit found = unit_of(text, BareNumber::pure);
    return found.unit ? unit_text(*found.unit) : "";
  }
  std::string shown_unit(std::size_t name) {
    const auto place_in = [name](const std::vector<std::size_t>& list) {
      return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin());
    };
    const auto of_key = [&](const std::string& key) {
      return std::string(si_unit(find_numbers(device_, key).front().dimension));
    };
    switch (kinds_[name]) {
      case NameKind::variable: {
        const StudyVariable& one = plan_.study.variables[place_in(plan_.variable_value)];
        if (!one.parts.empty()) return "";
        if (!one.keys.empty()) return of_key(one.keys.front());
        return std::string(si_unit(one.dimension.value_or(Dimension::number)));
      }
      case NameKind::key:
        return of_key(plan_.names[name]);
      case NameKind::measure: {
        const FigureDefinition* figure = plan_.figures[place_in(plan_.measure_value)];
        if (figure == nullptr) return "1";
        const bool varies = figure->unit == "SI" || figure->unit.ends_with("^n");
        return varies ? "" : figure->unit;
      }
      default: {
        const StudyDerived& one = plan_.study.derived[place_in(plan_.derived_value)];
        return one.keys.empty() ? shown_unit(one.value) : of_key(one.keys.front());
      }
    }
  }
  void note_units() {
    for (std::size_t name = 0; name < plan_.names.size(); ++name) plan_.units.push_back(shown_unit(name));
    for (const StudyObjective& one : plan_.study.objectives)
      plan_.objective_units.push_back(shown_unit(one.value));
    for (const StudyConstraint& one : plan_.study.constraints) {
      plan_.constraint_units.push_back(shown_unit(one.value));
    }
  }

  // Derived values that decide what `name` is.
  std::vector<std::size_t> deciders(std::size_t name) {
    std::vector<std::size_t> result;
    const std::vector<StudyDerived>& derived = plan_.study.derived;
    for (std::size_t d = 0; d < derived.size(); ++d) {
      if (kinds_[name] == NameKind::derived) {
        if (plan_.derived_value[d] == name) result.push_back(d);
      } else if (kinds_[name] == NameKind::key) {
        const std::vector<NumberSlot> wanted = find_numbers(device_, plan_.names[name]);
        for (const std::string& key : derived[d].keys) {
          for (const NumberSlot& slot : find_numbers(device_, key)) {
            if (slot.key == wanted.front().key) result.push_back(d);
          }
        }
      }
    }
    return result;
  }

  // Depth first; a value is put down when all that it follows from is.
  void visit(std::size_t derived, std::vector<std::size_t>& path) {
    if (state_[derived] == 2) return;
    path.push_back(derived);
    if (state_[derived] == 1) {
      std::string loop;
      for (auto from = std::find(path.begin(), path.end(), derived); from != path.end(); ++from) {
        const StudyDerived& one = plan_.study.derived[*from];
        loop += (loop.empty() ? "" : " -> ") + (one.name.empty() ? one.keys.front() : one.name);
      }
      if (!looped_) {
        wrong(at("derived", derived, "value"), fmt::format("\"{}\"", plan_.study.derived[derived].value),
              fmt::format("follows from itself: {}", loop), "break the circle at one of them");
      }
      looped_ = true;
      path.pop_back();
      return;
    }
    state_[derived] = 1;
    Use& use = plan_.derived_use[derived];
    for (const std::size_t name : names_of_[plan_.study.derived[derived].value]) {
      if (kinds_[name] == NameKind::measure) add_group(use, name);
      for (const std::size_t other : deciders(name)) {
        visit(other, path);
        for (const std::size_t g : plan_.derived_use[other].groups) add(use.groups, g);
      }
    }
    state_[derived] = 2;
    path.pop_back();
    if (use.of_figures() && !plan_.study.derived[derived].keys.empty()) {
      wrong(at("derived", derived, "value"), fmt::format("\"{}\"", plan_.study.derived[derived].value),
            "sets a key of the device, so it cannot follow from a measure",
            "measures need the finished device");
    }
    (use.of_figures() ? after_ : plan_.before).push_back(derived);
  }

  void order() {
    plan_.derived_use.resize(plan_.study.derived.size());
    state_.assign(plan_.study.derived.size(), 0);
    std::vector<std::size_t> path;
    for (std::size_t d = 0; d < state_.size(); ++d) visit(d, path);
  }

  static void add(std::vector<std::size_t>& list, std::size_t value) {
    if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
  }
  void add_group(Use& use, std::size_t name) {
    for (std::size_t m = 0; m < plan_.measure_value.size(); ++m) {
      if (plan_.measure_value[m] == name) add(use.groups, plan_.group_of[m]);
    }
  }

  Use use_of(const std::vector<std::string>& texts) {
    Use use;
    std::vector<bool> needed(plan_.study.derived.size(), false);
    const auto need = [&](const auto& self, std::size_t name) -> void {
      if (kinds_[name] == NameKind::measure) add_group(use, name);
      for (const std::size_t d : deciders(name)) {
        if (needed[d]) continue;
        needed[d] = true;
        for (const std::size_t g : plan_.derived_use[d].groups) add(use.groups, g);
        for (const std::size_t other : names_of_[plan_.study.derived[d].value]) self(self, other);
      }
    };
    for (const std::string& text : texts) {
      for (const std::size_t name : names_of_[text]) need(need, name);
    }
    for (const std::size_t d : after_) {
      if (needed[d]) use.after.push_back(d);
    }
    return use;
  }

  // Of the device as its file has it.
  const Mechanism& mechanism() {
    if (!mechanism_) mechanism_.emplace(plan_.device);
    return *mechanism_;
  }

  StudyModel::Plan plan_;
  Description device_;  // whose slots are looked at
  std::optional<Mechanism> mechanism_;
  std::vector<NameKind> kinds_;
  std::set<std::string> claimed_;                             // keys that are set
  std::map<std::string, std::vector<std::size_t>> names_of_;  // of each expression's text
  std::vector<int> state_;
  std::vector<std::size_t> after_;
  bool looped_ = false;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> study_problems(const Study& study, const Description& device, const Catalogue& catalogue) {
  return Planner(study, device, catalogue).problems();
}

StudyModel::StudyModel(const Study& study, const Description& device, const Catalogue& catalogue)
    : plan_(std::make_unique<Plan>(Planner(study, device, catalogue).plan())) {}

StudyModel::~StudyModel() = default;

const Study& StudyModel::study() const {
  return plan_->study;
}
const Description& StudyModel::device() const {
  return plan_->device;
}

const std::vector<std::string>& StudyModel::objective_units() const {
  return plan_->objective_units;
}
const std::vector<std::string>& StudyModel::constraint_units() const {
  return plan_->constraint_units;
}

namespace {

// How many values a stepped variable has, less one.
double last_step(const StudyVariable& variable) {
  constexpr double kRounding = 1e-9;  // 0.3 / 0.1 is a little less than 3
  return std::floor((variable.max - variable.min) / variable.step + kRounding);
}

}  // namespace

SearchAlgorithm StudyModel::algorithm() const {
  const SearchAlgorithm fitting = study().objectives.size() > 1 ? SearchAlgorithm::nsga2 : SearchAlgorithm::de;
  return search_algorithm(study().search.algorithm).value_or(fitting);
}

SearchProblem StudyModel::search_problem() const {
  SearchProblem problem;
  for (const StudyVariable& one : study().variables) {
    if (one.step > 0.0) {
      problem.variables.push_back({one.name, 0.0, last_step(one), true});
    } else {
      problem.variables.push_back({one.name, one.min, one.max, one.integer});
    }
  }
  for (const StudyObjective& one : study().objectives) problem.objectives.push_back(one.name);
  problem.constraints.emplace_back(kBuildable);
  for (const StudyConstraint& one : study().constraints) problem.constraints.push_back(one.name);
  return problem;
}

std::vector<double> StudyModel::device_design() const {
  std::vector<double> design;
  Description device = plan_->device;
  for (const StudyVariable& variable : study().variables) {
    double value = 0.5 * (variable.min + variable.max);
    if (!variable.parts.empty()) {
      const std::string& name = find_parts(device, variable.keys.front()).front().name();
      const auto found = std::find(variable.parts.begin(), variable.parts.end(), name);
      value = found == variable.parts.end() ? 0.0 : static_cast<double>(found - variable.parts.begin());
    } else if (!variable.keys.empty()) {
      value = std::clamp(find_numbers(device, variable.keys.front()).front().get(), variable.min, variable.max);
    }
    if (variable.step > 0.0) value = std::round((value - variable.min) / variable.step);
    design.push_back(variable.integer ? std::round(value) : value);
  }
  return design;
}

bool StudyModel::starts_at_device() const {
  const std::vector<double> design = device_design();
  Description device = plan_->device;
  for (std::size_t v = 0; v < design.size(); ++v) {
    const StudyVariable& variable = study().variables[v];
    if (variable.keys.empty()) return false;
    if (!variable.parts.empty()) {
      const auto part = static_cast<std::size_t>(std::lround(design[v]));
      for (const std::string& key : variable.keys) {
        for (const PartSlot& slot : find_parts(device, key)) {
          if (slot.name() != variable.parts[part]) return false;
        }
      }
      continue;
    }
    constexpr double kRounding = 1e-9;
    const double value = internal::value_of(variable, design[v]);
    for (const std::string& key : variable.keys) {
      for (const NumberSlot& slot : find_numbers(device, key)) {
        if (std::abs(slot.get() - value) > kRounding * std::abs(value)) return false;
      }
    }
  }
  return true;
}

}  // namespace zwidth
