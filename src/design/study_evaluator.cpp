#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "zwidth/actuation/drive_problems.h"
#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/description/keys.h"
#include "zwidth/description/validate.h"
#include "zwidth/design/expression.h"
#include "zwidth/design/figures.h"
#include "zwidth/design/internal/study_plan.h"
#include "zwidth/mechanism/beam_link.h"

/// Designs of a study, evaluated.

namespace zwidth {
namespace {

using Use = internal::StudyUse;
using internal::value_of;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

}  // namespace

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
      case StudyPlace::workspace:
      case StudyPlace::postures:
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
    if (measure.place == StudyPlace::middle) {
      for (int i = 0; i < active.size(); ++i) active[i] = mechanism.active_range(i).middle();
    } else if (measure.place == StudyPlace::joints) {
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

  // Calls `use` with every posture of a place, or with an empty solution where none is reached. False if there
  // are too many.
  template <class Function>
  bool each_posture(const Mechanism& mechanism, std::size_t measure, Function use) const {
    const StudyMeasure& place = plan->study.measures[measure];
    constexpr double kMostPostures = 1e6;
    if (place.place == StudyPlace::postures) {
      for (std::int64_t i = 0; i < place.samples; ++i) {
        Solution solution = solve_forward(mechanism, spread_posture(mechanism, i));
        if (solution.status == SolveStatus::joint_limit) solution.posture.reset();
        use(solution);
      }
      return true;
    }
    if (place.place == StudyPlace::workspace) {
      if (workspace_obstacle(mechanism)) return false;
      const Vector3 edges = workspace_extents(mechanism).size();
      double points = 1.0;
      for (const double edge : edges) points *= edge / place.spacing + 1.0;
      if (!(points <= kMostPostures)) return false;
      const WorkspaceMap map = map_workspace(mechanism, {.spacing = place.spacing}, {.threads = 1});
      for (const Vector3& point : map.positions) use(reach(mechanism, point));
      return true;
    }
    const bool box = place.place == StudyPlace::box;
    std::vector<Interval> axes;
    for (int i = 0; i < (box ? 3 : mechanism.active_count()); ++i) {
      const auto j = static_cast<std::size_t>(i);
      axes.push_back(box ? Interval{position[measure][j]() - 0.5 * size[measure][j](),
                                    position[measure][j]() + 0.5 * size[measure][j]()}
                         : mechanism.active_range(i));
    }
    std::vector<int> count;
    double total = 1.0;
    for (const Interval& axis : axes) {
      count.push_back(axis.width() > 0.0 ? place.points : 1);
      total *= count.back();
    }
    if (total > kMostPostures) return false;
    for (std::int64_t p = 0; p < static_cast<std::int64_t>(total); ++p) {
      Eigen::VectorXd at_axes(static_cast<Eigen::Index>(axes.size()));
      std::int64_t rest = p;
      for (std::size_t a = 0; a < axes.size(); ++a) {
        const auto k = static_cast<double>(rest % count[a]);
        rest /= count[a];
        at_axes[static_cast<Eigen::Index>(a)] =
            count[a] > 1 ? axes[a].min + axes[a].width() * k / (count[a] - 1) : axes[a].middle();
      }
      use(box ? reach(mechanism, Vector3(at_axes)) : solve_forward(mechanism, at_axes));
    }
    return true;
  }

  // Of one figure over many postures; mean and spread by Welford's recurrence with weights (West 1979).
  struct Sum {
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
    double mean = 0.0, squares = 0.0, weight = 0.0;
    bool defined = true;

    void add(double value, double share) {
      defined = defined && std::isfinite(value);
      least = std::min(least, value);
      most = std::max(most, value);
      if (!(share > 0.0)) return;
      weight += share;
      const double step = value - mean;
      mean += step * share / weight;
      squares += share * step * (value - mean);
    }
    double statistic(StudyStatistic which) const {
      switch (which) {
        case StudyStatistic::min:
          return least;
        case StudyStatistic::max:
          return most;
        case StudyStatistic::deviation:
          return std::sqrt(squares / weight);
        default:
          return weight > 0.0 ? mean : kUndefined;
      }
    }
  };

  void take_many(const BuiltDevice& at, const std::vector<std::size_t>& measures) {
    const StudyPlace place = plan->study.measures[measures.front()].place;
    std::vector<Sum> sums(measures.size());
    std::int64_t reached = 0, total = 0;
    const bool possible = each_posture(at.mechanism(), measures.front(), [&](const Solution& solution) {
      ++total;
      if (!solution) return;
      ++reached;
      PostureFigures posture(at, *solution.posture);
      // Postures on a lattice over the joint ranges stand for more of the workspace where the tool moves far.
      const double weight = place == StudyPlace::joint_ranges ? task_volume(posture.rates().tool) : 1.0;
      for (std::size_t i = 0; i < measures.size(); ++i) {
        if (plan->figures[measures[i]] == nullptr) continue;
        sums[i].add(figure_value(*plan->figures[measures[i]], posture, figure_options[measures[i]]), weight);
      }
    });
    if (!possible) return;
    for (std::size_t i = 0; i < measures.size(); ++i) {
      if (plan->figures[measures[i]] == nullptr) {
        put(measures[i], static_cast<double>(reached) / static_cast<double>(total));
        continue;
      }
      // A box has to be reached all over.
      if (!sums[i].defined || reached == 0 || (place == StudyPlace::box && reached < total)) continue;
      put(measures[i], sums[i].statistic(plan->study.measures[measures[i]].statistic));
    }
  }

  // REQUIRES: the device is built, and the measure was taken and is undefined.
  std::string undefined_because(std::size_t m) {
    const BuiltDevice& at = *build();
    const StudyMeasure& measure = plan->study.measures[m];
    const auto no_figure = [&] {
      return fmt::format("{} has no value {}", measure.figure,
                         measure.place == StudyPlace::device ? "for this device" : "in that posture");
    };
    if (measure.place == StudyPlace::device) return no_figure();
    if (measure.place < StudyPlace::joint_ranges) {
      return solve(at, measure, m) ? no_figure() : "asks for a posture that the device cannot take";
    }
    std::int64_t reached = 0, total = 0;
    const bool possible = each_posture(at.mechanism(), m, [&](const Solution& solution) {
      ++total;
      reached += solution ? 1 : 0;
    });
    if (!possible) return "asks for more than a million postures, or a workspace that cannot be had";
    if (reached == 0) return "asks for postures of which the device takes none";
    if (measure.place == StudyPlace::box && reached < total)
      return "asks for a box that is not reached all over";
    return fmt::format("{} has no value in some of its postures", measure.figure);
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
    value.unit = plan.units[plan.variable_value[v]];
    sheet.variables.push_back(std::move(value));
  }
  for (std::size_t g = 0; g < plan.groups.size(); ++g) s.take(g);
  bool holds = sheet.built;
  for (std::size_t c = 0; c < plan.study.constraints.size(); ++c) {
    s.prepare(plan.constraint_use[c]);
    sheet.constraints.push_back(s.constraints[c]());
    sheet.violations.push_back(s.violation(c, sheet.constraints.back()));
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    sheet.limits.push_back({s.low[c] ? (*s.low[c])() : -kNoLimit, s.high[c] ? (*s.high[c])() : kNoLimit});
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
    value.unit = plan.units[plan.derived_value[d]];
    sheet.derived.push_back(std::move(value));
  }
  for (std::size_t m = 0; m < plan.study.measures.size(); ++m) {
    sheet.derived.push_back({.name = plan.study.measures[m].name,
                             .value = s.values[plan.measure_value[m]],
                             .unit = plan.units[plan.measure_value[m]]});
  }
  sheet.feasible = holds;
  if (!tolerance.empty()) s.restore_tolerances();
  return sheet;
}

std::vector<DesignObstacle> StudyEvaluator::obstacles(std::span<const double> design) {
  Scratch& s = *scratch_;
  const StudyModel::Plan& plan = *s.plan;
  const Study& study = plan.study;
  std::vector<DesignObstacle> found;
  const auto place = [](const char* table, std::size_t i, const char* key) {
    return fmt::format("{}[{}].{}", table, i, key);
  };
  // An expression without a value whose names all have one.
  const auto look_at = [&](const std::string& text, double value, std::string where) {
    if (!std::isnan(value) || text.empty()) return;
    std::string with;
    for (const std::string& name : parse_expression(text).names) {
      const double one = s.values[plan.index.at(name)];
      if (std::isnan(one)) return;
      with += fmt::format("{}{} = {:.6g}", with.empty() ? "" : ", ", name, one);
    }
    found.push_back({std::move(where), text, "has no value: it divides by zero, or the like", std::move(with)});
  };
  const bool defined = s.set(design, {});
  for (const std::size_t d : plan.before) {
    if (plan.derived_use[d].of_figures()) continue;
    look_at(study.derived[d].value, s.values[plan.derived_value[d]], place("derived", d, "value"));
  }
  bool holds = true;
  for (std::size_t c = 0; c < study.constraints.size(); ++c) {
    if (plan.constraint_use[c].of_figures()) continue;
    const double value = s.constraints[c](), violation = s.violation(c, value);
    look_at(study.constraints[c].value, value, place("constraint", c, "value"));
    if (s.low[c]) look_at(study.constraints[c].min, (*s.low[c])(), place("constraint", c, "min"));
    if (s.high[c]) look_at(study.constraints[c].max, (*s.high[c])(), place("constraint", c, "max"));
    holds = holds && violation == 0.0;
  }
  if (!found.empty() || !defined || !holds) return found;
  if (const BuiltDevice* at = s.build(); at == nullptr) {
    std::vector<Problem> problems = value_problems(s.device);
    if (problems.empty()) problems = beam_problems(s.device);
    if (problems.empty() && plan.with_drives) problems = drive_problems(s.device);
    if (problems.empty()) problems.push_back({.key = "device", .rule = "cannot be built"});
    const Problem& first = problems.front();
    std::string with;
    if (const auto slots = find_numbers(s.device, first.key); !slots.empty()) {
      with = fmt::format("{} = {:.6g}", first.key, slots.front().get());
    }
    return {{"", first.key, first.rule, with}};
  }
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    s.take(g);
    for (const std::size_t m : plan.groups[g].measures) {
      if (std::isnan(s.values[plan.measure_value[m]])) {
        found.push_back({place("measure", m, "figure"), study.measures[m].name, s.undefined_because(m), ""});
      }
    }
  }
  const auto look_after = [&](const Use& use) {
    s.prepare(use);
    for (const std::size_t d : use.after) {
      look_at(study.derived[d].value, s.values[plan.derived_value[d]], place("derived", d, "value"));
    }
  };
  for (std::size_t c = 0; c < study.constraints.size(); ++c) {
    look_after(plan.constraint_use[c]);
    look_at(study.constraints[c].value, s.constraints[c](), place("constraint", c, "value"));
    if (s.low[c]) look_at(study.constraints[c].min, (*s.low[c])(), place("constraint", c, "min"));
    if (s.high[c]) look_at(study.constraints[c].max, (*s.high[c])(), place("constraint", c, "max"));
  }
  for (std::size_t o = 0; o < study.objectives.size(); ++o) {
    look_after(plan.objective_use[o]);
    const StudyObjective& one = study.objectives[o];
    look_at(one.value, s.objectives[o](), place("objective", o, one.maximise ? "maximise" : "minimise"));
  }
  // What several ask for is said once.
  std::vector<DesignObstacle> once;
  for (DesignObstacle& one : found) {
    if (std::find(once.begin(), once.end(), one) == once.end()) once.push_back(std::move(one));
  }
  return once;
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
