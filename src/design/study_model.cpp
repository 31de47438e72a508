#include "zwidth/design/study_model.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <set>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/description/keys.h"
#include "zwidth/description/names.h"
#include "zwidth/design/expression.h"
#include "zwidth/design/figures.h"

namespace zwidth {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kBuildable = "can be built";
constexpr const char* kReachedShare = "reached_share";

// What a name in an expression stands for.
enum class NameKind { variable, derived, measure, key };

// Measures that are taken in the same postures.
struct PlaceGroup {
  std::vector<std::size_t> measures;
};

bool same_place(const StudyMeasure& a, const StudyMeasure& b) {
  return a.place == b.place && a.posture == b.posture && a.joints == b.joints && a.position == b.position &&
         a.size == b.size && (a.place < StudyPlace::joint_ranges || a.points == b.points);
}

bool over_many(const StudyMeasure& measure) {
  return measure.place == StudyPlace::joint_ranges || measure.place == StudyPlace::box;
}

// What an expression needs before it has a value.
struct Use {
  std::vector<std::size_t> groups;  // of measures
  std::vector<std::size_t> after;   // derived values that follow from measures, in order
  bool of_figures() const { return !groups.empty(); }
};

}  // namespace

struct StudyModel::Plan {
  Study study;
  Description device;
  const Catalogue* catalogue = nullptr;

  std::vector<std::string> names;  // whose values are kept: variables, derived, measures, keys
  std::map<std::string, std::size_t> index;
  std::vector<std::size_t> variable_value, derived_value, measure_value;  // of each, in `names`
  std::vector<std::string> keys;                                          // read by expressions
  std::vector<std::size_t> key_value;

  std::vector<std::size_t> before;  // derived values that no measure decides, in order
  std::vector<Use> derived_use;     // of each derived value
  std::vector<PlaceGroup> groups;
  std::vector<std::size_t> group_of;  // of each measure
  std::vector<const FigureDefinition*> figures;
  std::vector<Use> constraint_use, objective_use;
  bool with_drives = false;
};

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
    if (problems_.empty()) order();
    if (problems_.empty()) {
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

  // The slots that take a value; notes keys that are none, or are set twice.
  std::vector<NumberSlot> claim_numbers(const std::vector<std::string>& keys, const std::string& place) {
    std::vector<NumberSlot> all;
    for (const std::string& key : keys) {
      std::vector<NumberSlot> slots = find_numbers(device_, key);
      if (slots.empty()) {
        const bool part = !find_parts(device_, key).empty();
        wrong(place, fmt::format("\"{}\"", key),
              part ? "is a part of the device, not a number" : "is no number of the device",
              part ? "list the parts to choose from with parts = [...]" : suggest(key, number_keys()));
      }
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
      setters_.push_back(variable.keys);
    }
    for (std::size_t i = 0; i < study.derived.size(); ++i) {
      claim_numbers(study.derived[i].keys, at("derived", i, "key"));
    }
    for (std::size_t i = 0; i < study.tolerances.size(); ++i) {
      const StudyTolerance& tolerance = study.tolerances[i];
      for (const std::string& key : tolerance.keys) {
        const std::vector<NumberSlot> slots = find_numbers(device_, key);
        if (slots.empty()) {
          wrong(at("tolerance", i, "key"), fmt::format("\"{}\"", key), "is no number of the device",
                suggest(key, number_keys()));
        }
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
                "write over = \"box\" or \"joint_ranges\"");
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
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure), "is a figure of a posture",
            "say where: at = \"home\", joints = [...], position = [...] or over = \"box\"");
    }
    if (!figure.of_posture && measure.place != StudyPlace::device) {
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure),
            "is a figure of the device as a whole", "leave the posture out");
    }
    const bool load = !measure.force.empty() || !measure.moment.empty();
    if (figure.needs_load && !load) {
      wrong(at("measure", i, "figure"), fmt::format("\"{}\"", measure.figure), "is a figure under a load",
            "add force = [\"20 N\", 0, 0], say");
    } else if (!figure.needs_load && load) {
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

  StudyModel::Plan plan_;
  Description device_;  // whose slots are looked at
  std::vector<NameKind> kinds_;
  std::set<std::string> claimed_;  // keys that are set
  std::vector<std::vector<std::string>> setters_;
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

namespace {

// How many values a stepped variable has, less one.
double last_step(const StudyVariable& variable) {
  constexpr double kRounding = 1e-9;  // 0.3 / 0.1 is a little less than 3
  return std::floor((variable.max - variable.min) / variable.step + kRounding);
}

// The value of a variable [SI] from a search value.
double value_of(const StudyVariable& variable, double searched) {
  if (variable.step <= 0.0) return searched;
  return std::min(variable.min + searched * variable.step, variable.max);
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

// ------------------------------------------------------------------------------------------------ evaluator

struct StudyEvaluator::Scratch {
  explicit Scratch(const StudyModel::Plan& of)
      : plan(&of), device(of.device), values(of.names.size(), kUndefined) {
    const Study& study = plan->study;
    for (const StudyVariable& one : study.variables) {
      variable_slots.emplace_back();
      variable_parts.emplace_back();
      chosen.push_back(-1);
      for (const std::string& key : one.keys) {
        if (one.parts.empty()) {
          append(variable_slots.back(), find_numbers(device, key));
        } else {
          append(variable_parts.back(), find_parts(device, key));
        }
      }
    }
    for (const StudyDerived& one : study.derived) {
      derived_slots.emplace_back();
      for (const std::string& key : one.keys) append(derived_slots.back(), find_numbers(device, key));
      derived.push_back(expression(one.value));
    }
    for (const StudyTolerance& one : study.tolerances) {
      tolerance_slots.emplace_back();
      for (const std::string& key : one.keys) append(tolerance_slots.back(), find_numbers(device, key));
    }
    for (const std::string& key : plan->keys) key_slots.push_back(find_numbers(device, key).front());
    for (const StudyMeasure& one : study.measures) {
      joints.push_back(expressions(one.joints));
      position.push_back(expressions(one.position));
      size.push_back(expressions(one.size));
      force.push_back(expressions(one.force));
      moment.push_back(expressions(one.moment));
      options.emplace_back();
      for (const auto& [key, text] : one.options) options.back().emplace_back(key, expression(text));
    }
    for (const StudyObjective& one : study.objectives) objectives.push_back(expression(one.value));
    for (const StudyConstraint& one : study.constraints) {
      constraints.push_back(expression(one.value));
      low.push_back(one.min.empty() ? std::nullopt : std::optional(expression(one.min)));
      high.push_back(one.max.empty() ? std::nullopt : std::optional(expression(one.max)));
    }
  }

  template <class Slot>
  static void append(std::vector<Slot>& list, std::vector<Slot> more) {
    list.insert(list.end(), more.begin(), more.end());
  }
  Expression expression(const std::string& text) {
    return Expression(text, [this](const std::string& name) { return &values[plan->index.at(name)]; });
  }
  std::vector<Expression> expressions(const std::vector<std::string>& texts) {
    std::vector<Expression> list;
    for (const std::string& text : texts) list.push_back(expression(text));
    return list;
  }

  // ---- the design

  void read_keys() {
    for (std::size_t k = 0; k < key_slots.size(); ++k) values[plan->key_value[k]] = key_slots[k].get();
  }

  // Puts a design into the description. False where a derived value that sets a key is undefined.
  bool set(std::span<const double> design, std::span<const double> tolerance) {
    const Study& study = plan->study;
    for (std::size_t v = 0; v < study.variables.size(); ++v) {
      const StudyVariable& variable = study.variables[v];
      const double value = value_of(variable, design[v]);
      values[plan->variable_value[v]] = value;
      for (const NumberSlot& slot : variable_slots[v]) slot.set(value);
      if (variable.parts.empty()) continue;
      const auto part = static_cast<int>(std::lround(value));
      if (part == chosen[v]) continue;
      for (const PartSlot& slot : variable_parts[v]) {
        choose_part(slot, variable.parts[static_cast<std::size_t>(part)], *plan->catalogue);
      }
      chosen[v] = part;
    }
    read_keys();
    bool defined = true;
    for (const std::size_t d : plan->before) {
      const double value = derived[d]();
      values[plan->derived_value[d]] = value;
      if (derived_slots[d].empty()) continue;
      defined = defined && !std::isnan(value);
      for (const NumberSlot& slot : derived_slots[d]) slot.set(value);
      read_keys();
    }
    for (std::size_t t = 0; t < tolerance.size(); ++t) {
      const StudyTolerance& one = study.tolerances[t];
      for (const NumberSlot& slot : tolerance_slots[t]) {
        const double value = slot.get();
        slot.set(value + tolerance[t] * one.half_width * (one.relative ? value : 1.0));
      }
    }
    if (!tolerance.empty()) read_keys();
    for (std::size_t m = 0; m < plan->measure_value.size(); ++m) values[plan->measure_value[m]] = kUndefined;
    group_done.assign(plan->groups.size(), false);
    built.reset();
    tried = false;
    return defined;
  }

  // What tolerances changed is the design's again only when it is set from the device's own values.
  void restore_tolerances() {
    Description original = plan->device;
    for (std::size_t t = 0; t < tolerance_slots.size(); ++t) {
      std::size_t i = 0;
      for (const std::string& key : plan->study.tolerances[t].keys) {
        for (const NumberSlot& slot : find_numbers(original, key)) tolerance_slots[t][i++].set(slot.get());
      }
    }
    // Parts are chosen again, with their own values.
    std::fill(chosen.begin(), chosen.end(), -1);
  }

  const BuiltDevice* build() {
    if (!tried) {
      tried = true;
      try {
        built = BuiltDevice::try_make(device, plan->with_drives);
      } catch (const std::invalid_argument&) {  // a drive that cannot be
        built.reset();
      }
    }
    return built ? &*built : nullptr;
  }

  // ---- measures

  void take(std::size_t group) {
    if (group_done[group]) return;
    group_done[group] = true;
    const BuiltDevice* at = build();
    if (at == nullptr) return;
    const std::vector<std::size_t>& measures = plan->groups[group].measures;
    const StudyMeasure& first = plan->study.measures[measures.front()];
    read_options(measures);
    switch (first.place) {
      case StudyPlace::device:
        for (const std::size_t m : measures) {
          put(m, figure_value(*plan->figures[m], *at, figure_options[m]));
        }
        return;
      case StudyPlace::joint_ranges:
      case StudyPlace::box:
        take_many(*at, measures);
        return;
      default:
        if (const Solution solution = solve(*at, first, measures.front())) {
          PostureFigures posture(*at, *solution.posture);
          for (const std::size_t m : measures) {
            put(m, figure_value(*plan->figures[m], posture, figure_options[m]));
          }
        }
    }
  }

  void put(std::size_t measure, double value) {
    values[plan->measure_value[measure]] = std::isfinite(value) ? value : kUndefined;
  }

  void read_options(const std::vector<std::size_t>& measures) {
    figure_options.resize(plan->study.measures.size());
    for (const std::size_t m : measures) {
      FigureOptions& into = figure_options[m];
      for (std::size_t i = 0; i < force[m].size(); ++i) into.load[static_cast<int>(i)] = force[m][i]();
      for (std::size_t i = 0; i < moment[m].size(); ++i) into.load[static_cast<int>(i) + 3] = moment[m][i]();
      for (const auto& [key, value] : options[m]) into.further[key] = value();
    }
  }

  static ActiveVector home(const Mechanism& mechanism) {
    ActiveVector active(mechanism.active_count());
    for (int i = 0; i < active.size(); ++i) active[i] = mechanism.home_guess()[mechanism.active_joint(i)];
    return active;
  }

  Solution solve(const BuiltDevice& at, const StudyMeasure& measure, std::size_t m) {
    const Mechanism& mechanism = at.mechanism();
    if (measure.place == StudyPlace::position) {
      const Vector3 point{position[m][0](), position[m][1](), position[m][2]()};
      return reach(mechanism, point);
    }
    ActiveVector active = home(mechanism);
    if (measure.place == StudyPlace::joints) {
      for (int i = 0; i < active.size(); ++i) active[i] = joints[m][static_cast<std::size_t>(i)]();
    } else if (measure.place == StudyPlace::posture) {
      for (const PostureDescription& one : at.description().postures) {
        if (one.name != measure.posture) continue;
        for (int i = 0; i < active.size(); ++i) active[i] = one.joints[static_cast<std::size_t>(i)];
      }
    }
    if (!active.allFinite()) return {};
    return solve_forward(mechanism, active);
  }

  // A tool position within the joint ranges, the tool turned as in the home posture.
  static Solution reach(const Mechanism& mechanism, const Vector3& point) {
    if (!point.allFinite()) return {};
    Pose pose{.position = point};
    SolveOptions how;
    if (mechanism.serial() != nullptr && mechanism.tool_turns()) {
      how.match = Match::position;
    } else if (mechanism.tool_turns()) {
      const Solution at_home = solve_forward(mechanism, home(mechanism));
      if (!at_home) return {};
      pose.rotation = at_home.posture->tool().rotation;
    }
    Solution solution = solve_inverse(mechanism, pose, how);
    if (solution.status == SolveStatus::joint_limit) solution.posture.reset();
    return solution;
  }

  void take_many(const BuiltDevice& at, const std::vector<std::size_t>& measures) {
    const Mechanism& mechanism = at.mechanism();
    const std::size_t first = measures.front();
    const StudyMeasure& place = plan->study.measures[first];
    const bool box = place.place == StudyPlace::box;
    std::vector<Interval> axes;
    for (int i = 0; i < (box ? 3 : mechanism.active_count()); ++i) {
      const auto j = static_cast<std::size_t>(i);
      axes.push_back(box ? Interval{position[first][j]() - 0.5 * size[first][j](),
                                    position[first][j]() + 0.5 * size[first][j]()}
                         : mechanism.active_range(i));
    }
    std::vector<int> count;
    std::int64_t total = 1;
    for (const Interval& axis : axes) {
      count.push_back(axis.width() > 0.0 ? place.points : 1);
      total *= count.back();
    }
    constexpr std::int64_t kMostPostures = 1000000;
    if (total > kMostPostures) return;
    struct Sum {
      double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
      double weighted = 0.0, weight = 0.0;
      bool defined = true;
    };
    std::vector<Sum> sums(measures.size());
    std::int64_t reached = 0;
    for (std::int64_t p = 0; p < total; ++p) {
      Eigen::VectorXd at_axes(static_cast<Eigen::Index>(axes.size()));
      std::int64_t rest = p;
      for (std::size_t a = 0; a < axes.size(); ++a) {
        const auto k = static_cast<double>(rest % count[a]);
        rest /= count[a];
        at_axes[static_cast<Eigen::Index>(a)] =
            count[a] > 1 ? axes[a].min + axes[a].width() * k / (count[a] - 1) : axes[a].middle();
      }
      const Solution solution = box ? reach(mechanism, Vector3(at_axes)) : solve_forward(mechanism, at_axes);
      if (!solution) continue;
      ++reached;
      PostureFigures posture(at, *solution.posture);
      // Postures spread evenly over the joint ranges stand for more of the workspace where the tool moves far.
      const double weight = box ? 1.0 : task_volume(posture.rates().tool);
      for (std::size_t i = 0; i < measures.size(); ++i) {
        if (plan->figures[measures[i]] == nullptr) continue;
        const double value = figure_value(*plan->figures[measures[i]], posture, figure_options[measures[i]]);
        Sum& sum = sums[i];
        sum.defined = sum.defined && std::isfinite(value);
        sum.least = std::min(sum.least, value);
        sum.most = std::max(sum.most, value);
        sum.weighted += weight * value;
        sum.weight += weight;
      }
    }
    const double share = static_cast<double>(reached) / static_cast<double>(total);
    for (std::size_t i = 0; i < measures.size(); ++i) {
      const Sum& sum = sums[i];
      if (plan->figures[measures[i]] == nullptr) {
        put(measures[i], share);
        continue;
      }
      // A box has to be reached all over.
      if (!sum.defined || reached == 0 || (box && reached < total)) continue;
      const StudyStatistic statistic = plan->study.measures[measures[i]].statistic;
      put(measures[i], statistic == StudyStatistic::min   ? sum.least
                       : statistic == StudyStatistic::max ? sum.most
                                                          : sum.weighted / sum.weight);
    }
  }

  void prepare(const Use& use) {
    for (const std::size_t group : use.groups) take(group);
    for (const std::size_t d : use.after) values[plan->derived_value[d]] = derived[d]();
  }

  // ---- outcomes

  // A limit that is met exactly may be missed by rounding.
  double violation(std::size_t c, double value) const {
    const double scale = plan->study.constraints[c].scale;
    const auto by = [&](double excess, double limit) {
      constexpr double kRounding = 1e-9;
      return excess > kRounding * std::max(std::abs(limit), scale) || std::isnan(excess) ? excess / scale : 0.0;
    };
    double worst = std::isnan(value) ? kUndefined : 0.0;
    if (low[c]) worst = worse(worst, by((*low[c])() - value, (*low[c])()));
    if (high[c]) worst = worse(worst, by(value - (*high[c])(), (*high[c])()));
    return worst;
  }
  static double worse(double a, double b) {
    return std::isnan(a) || std::isnan(b) ? kUndefined : std::max(a, b);
  }

  const StudyModel::Plan* plan;
  Description device;
  std::vector<double> values;
  std::vector<std::vector<NumberSlot>> variable_slots, derived_slots, tolerance_slots;
  std::vector<std::vector<PartSlot>> variable_parts;
  std::vector<int> chosen;  // part of each variable, -1 none yet
  std::vector<NumberSlot> key_slots;
  std::vector<Expression> derived, objectives, constraints;
  std::vector<std::optional<Expression>> low, high;
  std::vector<std::vector<Expression>> joints, position, size, force, moment;
  std::vector<std::vector<std::pair<std::string, Expression>>> options;
  std::vector<FigureOptions> figure_options;
  std::vector<bool> group_done;
  std::optional<BuiltDevice> built;
  bool tried = false;
};

StudyEvaluator::StudyEvaluator(const StudyModel& model) : scratch_(std::make_unique<Scratch>(model.plan())) {}
StudyEvaluator::~StudyEvaluator() = default;
StudyEvaluator::StudyEvaluator(StudyEvaluator&&) noexcept = default;
StudyEvaluator& StudyEvaluator::operator=(StudyEvaluator&&) noexcept = default;

void StudyEvaluator::evaluate(std::span<const double> design, std::span<double> outcome) {
  Scratch& s = *scratch_;
  const StudyModel::Plan& plan = *s.plan;
  const std::size_t objectives = plan.study.objectives.size();
  std::fill(outcome.begin(), outcome.end(), kUndefined);
  const std::span<double> violations = outcome.subspan(objectives);
  const bool defined = s.set(design, {});
  bool holds = true;
  for (std::size_t c = 0; c < plan.study.constraints.size(); ++c) {
    if (plan.constraint_use[c].of_figures()) continue;
    violations[c + 1] = s.violation(c, s.constraints[c]());
    holds = holds && violations[c + 1] == 0.0;
  }
  if (!defined) {
    violations[0] = 1.0;
    return;
  }
  violations[0] = 0.0;
  if (!holds) return;
  for (std::size_t c = 0; c < plan.study.constraints.size(); ++c) {
    const Use& use = plan.constraint_use[c];
    if (!use.of_figures()) continue;
    s.prepare(use);
    violations[c + 1] = s.violation(c, s.constraints[c]());
    holds = holds && violations[c + 1] == 0.0;
  }
  if (!holds) {
    if (s.tried && s.build() == nullptr) violations[0] = 1.0;
    return;
  }
  bool all = true;
  for (std::size_t o = 0; o < objectives; ++o) {
    s.prepare(plan.objective_use[o]);
    const double value = s.objectives[o]();
    outcome[o] = plan.study.objectives[o].maximise ? -value : value;
    all = all && !std::isnan(value);
  }
  if (all && s.build() != nullptr) return;
  violations[0] = 1.0;
  std::fill_n(outcome.begin(), objectives, kUndefined);
}

DesignSheet StudyEvaluator::sheet(std::span<const double> design, std::span<const double> tolerance) {
  Scratch& s = *scratch_;
  const StudyModel::Plan& plan = *s.plan;
  DesignSheet sheet;
  const bool defined = s.set(design, tolerance);
  sheet.built = defined && s.build() != nullptr;
  for (std::size_t v = 0; v < plan.study.variables.size(); ++v) {
    const StudyVariable& variable = plan.study.variables[v];
    DesignValue value{.name = variable.name, .value = s.values[plan.variable_value[v]]};
    if (!variable.parts.empty()) {
      value.part = variable.parts[static_cast<std::size_t>(std::lround(value.value))];
    } else if (!s.variable_slots[v].empty()) {
      value.dimension = s.variable_slots[v].front().dimension;
    } else {
      value.dimension = variable.dimension.value_or(Dimension::number);
    }
    sheet.variables.push_back(std::move(value));
  }
  for (std::size_t g = 0; g < plan.groups.size(); ++g) s.take(g);
  bool holds = sheet.built;
  for (std::size_t c = 0; c < plan.study.constraints.size(); ++c) {
    s.prepare(plan.constraint_use[c]);
    sheet.constraints.push_back(s.constraints[c]());
    sheet.violations.push_back(s.violation(c, sheet.constraints.back()));
    holds = holds && sheet.violations.back() == 0.0;
  }
  for (std::size_t o = 0; o < plan.study.objectives.size(); ++o) {
    s.prepare(plan.objective_use[o]);
    sheet.objectives.push_back(s.objectives[o]());
    holds = holds && !std::isnan(sheet.objectives.back());
  }
  for (std::size_t d = 0; d < plan.study.derived.size(); ++d) {
    const StudyDerived& one = plan.study.derived[d];
    const std::string name = one.name.empty() ? one.keys.front() : one.name;
    DesignValue value{.name = name, .value = s.values[plan.derived_value[d]]};
    if (!s.derived_slots[d].empty()) value.dimension = s.derived_slots[d].front().dimension;
    sheet.derived.push_back(std::move(value));
  }
  for (std::size_t m = 0; m < plan.study.measures.size(); ++m) {
    sheet.derived.push_back({.name = plan.study.measures[m].name, .value = s.values[plan.measure_value[m]]});
  }
  sheet.feasible = holds;
  if (!tolerance.empty()) s.restore_tolerances();
  return sheet;
}

Description StudyEvaluator::description(std::span<const double> design, const std::string& source) {
  Scratch& s = *scratch_;
  s.set(design, {});
  Description result = s.device;
  const auto note = [&](const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
      for (const NumberSlot& slot : find_numbers(result, key)) slot.set_source(source);
    }
  };
  for (const StudyVariable& one : s.plan->study.variables) note(one.keys);
  for (const StudyDerived& one : s.plan->study.derived) note(one.keys);
  return result;
}

}  // namespace zwidth
