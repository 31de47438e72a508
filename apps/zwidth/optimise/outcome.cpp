#include "optimise/outcome.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

#include "zwidth/design/pareto.h"

namespace zwidth {

std::span<const double> StudyOutcome::design(std::size_t front_row) const {
  const std::size_t width = problem.variables.size();
  return std::span(result.designs).subspan(result.front[front_row] * width, width);
}

std::vector<double> StudyOutcome::minimised() const {
  std::vector<double> values;
  for (const std::size_t row : result.front) {
    const auto first = result.outcomes.begin() + static_cast<std::ptrdiff_t>(row * problem.outcome_size());
    values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(problem.objectives.size()));
  }
  return values;
}

std::size_t StudyOutcome::best(std::size_t objective) const {
  const std::vector<double> values = minimised();
  const std::size_t n = problem.objectives.size();
  std::size_t best = 0;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (values[i * n + objective] < values[best * n + objective]) best = i;
  }
  return best;
}

std::optional<std::size_t> StudyOutcome::knee_row() const {
  const std::size_t n = problem.objectives.size();
  return n > 1 && !front.empty() ? knee(minimised(), n) : std::nullopt;
}

std::string value_text(const DesignValue& value) {
  if (!value.part.empty()) return value.part;
  if (std::isnan(value.value)) return "undefined";
  if (value.dimension == Dimension::angle) return quantity(value.value, kDegrees, "deg");
  const std::string unit = value.unit.empty() ? std::string(si_unit(value.dimension)) : value.unit;
  return unit == "1" ? trimmed(value.value, 6) : readable(value.value, unit);
}

std::string step_text(DesignValue value, double step) {
  value.value = std::abs(step);
  std::string text = value_text(value);
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string digits = text.substr(0, end);
  if (digits.find('.') != digits.npos && digits.find('e') == digits.npos) {
    const std::size_t last = digits.find_last_not_of('0');
    text.replace(0, end, digits.substr(0, digits[last] == '.' ? last : last + 1));
  }
  return fmt::format("{}{}", step < 0.0 ? "−" : "+", text);
}

std::string amount(double value, const std::string& unit) {
  return std::isnan(value) ? "undefined" : readable(value, unit);
}

bool is_logarithm(const std::string& expression) {
  const std::size_t first = expression.find_first_not_of(" -(");
  return first != expression.npos &&
         (expression.compare(first, 4, "log(") == 0 || expression.compare(first, 6, "log10(") == 0);
}

std::vector<OutcomeFigure> outcome_figures(const StudyModel& model) {
  const Study& study = model.study();
  std::vector<OutcomeFigure> list;
  using Kind = OutcomeFigure::Kind;
  for (std::size_t o = 0; o < study.objectives.size(); ++o) {
    list.push_back({study.objectives[o].name, model.objective_units()[o], Kind::objective,
                    is_logarithm(study.objectives[o].value)});
  }
  for (std::size_t c = 0; c < study.constraints.size(); ++c) {
    list.push_back({study.constraints[c].name, model.constraint_units()[c], Kind::constraint,
                    is_logarithm(study.constraints[c].value)});
  }
  for (const StudyDerived& one : study.derived) {
    if (!one.name.empty()) list.push_back({one.name, "", Kind::further, is_logarithm(one.value)});
  }
  for (const StudyMeasure& one : study.measures) list.push_back({one.name, "", Kind::further, false});
  // Units of the last ones come with their values.
  const DesignSheet sheet = StudyEvaluator(model).sheet(model.device_design());
  for (OutcomeFigure& figure : list) {
    for (const DesignValue& one : sheet.derived) {
      if (figure.kind == Kind::further && one.name == figure.name) figure.unit = one.unit;
    }
  }
  return list;
}

std::vector<double> figure_values(const DesignSheet& sheet, const Study& study) {
  std::vector<double> values = sheet.objectives;
  values.insert(values.end(), sheet.constraints.begin(), sheet.constraints.end());
  for (std::size_t d = 0; d < study.derived.size(); ++d) {
    if (!study.derived[d].name.empty()) values.push_back(sheet.derived[d].value);
  }
  for (std::size_t m = 0; m < study.measures.size(); ++m) {
    values.push_back(sheet.derived[study.derived.size() + m].value);
  }
  return values;
}

std::vector<double> margins_of(const DesignSheet& sheet) {
  std::vector<double> margins;
  for (std::size_t c = 0; c < sheet.constraints.size(); ++c) {
    const double value = sheet.constraints[c];
    margins.push_back(std::isnan(value) ? value
                                        : std::min(value - sheet.limits[c].min, sheet.limits[c].max - value));
  }
  return margins;
}

bool ChosenSensitivity::slides(std::size_t figure) const {
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (slopes.slope[figure * smooth.size() + i] != 0.0) return true;
    if (grown[i][figure] != values[figure]) return true;
  }
  return false;
}

bool ChosenSensitivity::moves(std::size_t figure) const {
  return slides(figure) || std::any_of(steps.begin(), steps.end(), [&](const Step& step) {
           return std::any_of(step.figures.begin(), step.figures.end(), [&](const std::vector<double>& there) {
             return there[figure] != values[figure] && !std::isnan(there[figure]);
           });
         });
}

std::vector<std::size_t> ChosenSensitivity::told() const {
  std::vector<std::size_t> list;
  for (std::size_t f = 0; f < figures.size(); ++f) {
    const bool said = std::any_of(list.begin(), list.end(), [&](std::size_t other) { return same(f, other); });
    if (moves(f) && !said) list.push_back(f);
  }
  return list;
}

bool ChosenSensitivity::same(std::size_t a, std::size_t b) const {
  if (values[a] != values[b]) return false;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (slopes.slope[a * smooth.size() + i] != slopes.slope[b * smooth.size() + i]) return false;
    if (grown[i][a] != grown[i][b]) return false;
  }
  return true;
}

namespace {

Json value_json(const DesignValue& value) {
  return value.part.empty() ? json_number(value.value) : Json(value.part);
}

Json sheet_json(const DesignSheet& sheet, const Study& study) {
  Json entry;
  for (const DesignValue& one : sheet.variables) entry["variables"][one.name] = value_json(one);
  for (std::size_t o = 0; o < study.objectives.size(); ++o) {
    entry["objectives"][study.objectives[o].name] = json_number(sheet.objectives[o]);
  }
  entry["constraints"] = Json::object();
  for (std::size_t c = 0; c < study.constraints.size(); ++c) {
    entry["constraints"][study.constraints[c].name] = json_number(sheet.constraints[c]);
  }
  entry["derived"] = Json::object();
  for (const DesignValue& one : sheet.derived) entry["derived"][one.name] = json_number(one.value);
  return entry;
}

Json estimate_json(const Estimate& estimate) {
  Json entry;
  entry["value"] = json_number(estimate.value);
  entry["interval"] = {json_number(estimate.low), json_number(estimate.high)};
  return entry;
}

Json tolerances_json(const ToleranceStudy& tolerances, const Study& study) {
  Json entry;
  entry["samples"] = tolerances.samples;
  entry["broken_share"] = estimate_json(tolerances.broken);
  for (std::size_t o = 0; o < study.objectives.size(); ++o) {
    const OutcomeSpread& spread = tolerances.outcomes[o];
    Json one;
    one["nominal"] = json_number(spread.nominal);
    one["mean"] = estimate_json(spread.mean);
    one["standard_deviation"] = json_number(spread.standard_deviation);
    one["percentile_5"] = estimate_json(spread.percentile_5);
    one["median"] = estimate_json(spread.median);
    one["percentile_95"] = estimate_json(spread.percentile_95);
    one["undefined"] = spread.undefined;
    entry["objectives"][study.objectives[o].name] = one;
  }
  return entry;
}

std::string never_met(const StudyOutcome& outcome) {
  std::string text;
  for (std::size_t c = 0; c < outcome.problem.constraints.size(); ++c) {
    const ConstraintRecord& record = outcome.result.constraints[c];
    if (record.held > 0) continue;
    text += fmt::format("\"{}\" was never met", outcome.problem.constraints[c]);
    if (c == 0) {  // "can be built" is yes or no; what is in the way is said below
      text += "\n";
      continue;
    }
    text += std::isfinite(record.least_violation)
                ? fmt::format("; the least violation found is {}\n", number(record.least_violation))
                : ", and never defined\n";
  }
  return text;
}

}  // namespace

std::string change_text(double before, double after, bool logarithm) {
  if (std::isnan(after)) return "–";
  const double change = after - before;
  if (logarithm || before == 0.0) return change == 0.0 ? "0" : fmt::format("{:+.3g}", change);
  const double percent = 100.0 * change / std::abs(before);
  return std::abs(percent) < 0.005 ? "0 %"
                                   : fmt::format("{:+.{}f} %", percent, std::abs(percent) < 1.0 ? 2 : 1);
}

std::string tolerance_words(const Study& study) {
  std::string text;
  for (const StudyTolerance& one : study.tolerances) {
    text += fmt::format("{}{} ±{}", text.empty() ? "" : ", ", one.name,
                        one.relative ? trimmed(100.0 * one.half_width, 4) + " %"
                                     : value_text({.name = "",
                                                   .value = one.half_width,
                                                   .part = "",
                                                   .dimension = one.dimension.value_or(Dimension::number)}));
  }
  return text;
}

double deviation_of(const OutcomeSpread& spread) {
  constexpr double kRounding = 1e-12;  // of the value: sums of some thousand samples lose no more
  return spread.standard_deviation <= kRounding * std::abs(spread.nominal) ? 0.0 : spread.standard_deviation;
}

std::vector<ConstraintActivity> constraint_activity(const StudyOutcome& outcome, const StudyModel& model) {
  const Study& study = model.study();
  const DesignSheet& chosen = outcome.front[*outcome.chosen];
  const std::vector<double> margins = margins_of(chosen);
  std::vector<ConstraintActivity> list;
  for (std::size_t c = 0; c < study.constraints.size(); ++c) {
    ConstraintActivity one{.name = study.constraints[c].name};
    const std::string& unit = model.constraint_units()[c];
    const double value = chosen.constraints[c];
    const Interval& limits = chosen.limits[c];
    one.value = amount(value, unit);
    const std::string low =
        std::isfinite(limits.min) ? fmt::format("at least {}", amount(limits.min, unit)) : "";
    const std::string high =
        std::isfinite(limits.max) ? fmt::format("at most {}", amount(limits.max, unit)) : "";
    one.limit = fmt::format("{}{}{}", low, low.empty() || high.empty() ? "" : ", ", high);
    const double nearest = value - limits.min < limits.max - value ? limits.min : limits.max;
    constexpr double kActive = 0.005;  // of the limit
    const double size = std::max(std::abs(nearest), nearest == 0.0 ? study.constraints[c].scale : 0.0);
    one.share = margins[c] / size;
    one.active = one.share <= kActive;
    one.margin = amount(margins[c], unit);
    if (nearest != 0.0) one.margin += fmt::format(" ({} %)", trimmed(100.0 * one.share, 3));
    // Which variable alone uses up the margin first, as far as a straight line tells.
    double soonest = 1.0;
    const auto& found = outcome.sensitivity;
    for (std::size_t i = 0; found && i < found->smooth.size(); ++i) {
      const SearchVariable& variable = outcome.problem.variables[found->smooth[i]];
      const double slope = found->slopes.slope[(found->figures.size() + c) * found->smooth.size() + i];
      const double step = -margins[c] / slope, range = variable.max - variable.min;
      const double there = chosen.variables[found->smooth[i]].value + step;
      if (!(there >= variable.min && there <= variable.max) || std::abs(step) >= soonest * range) continue;
      soonest = std::abs(step) / range;
      one.broken_by = fmt::format("{} {}", variable.name, step_text(chosen.variables[found->smooth[i]], step));
    }
    list.push_back(std::move(one));
  }
  return list;
}

namespace {

void write_sensitivity(const StudyOutcome& outcome, const StudyModel& model, Sheet& sheet) {
  const ChosenSensitivity& found = *outcome.sensitivity;
  const Study& study = model.study();
  sheet.heading("Sensitivity");
  const std::vector<ConstraintActivity> activity = constraint_activity(outcome, model);
  if (!activity.empty()) {
    std::vector<std::vector<std::string>> rows;
    for (const ConstraintActivity& one : activity) {
      rows.push_back({one.name, one.value, one.limit, one.active ? "at its limit" : one.margin, one.broken_by});
    }
    sheet.table({"constraint", "value", "limit", "to spare", "used up first by"}, rows);
    sheet.gap();
  }
  const std::vector<std::size_t> told = found.told();
  constexpr std::size_t kColumns = 4;
  for (std::size_t first = 0; first < found.smooth.size(); first += kColumns) {
    if (first == 0) {
      sheet.paragraph(
          "Change of every figure when a variable grows by 1 % of its range: in percent, of logarithms as it "
          "is.",
          2, Tint::dim);
    }
    const std::size_t last = std::min(first + kColumns, found.smooth.size());
    std::vector<std::string> head{"figure"}, steps{""};
    for (std::size_t i = first; i < last; ++i) {
      const SearchVariable& variable = outcome.problem.variables[found.smooth[i]];
      head.push_back(variable.name);
      steps.push_back(step_text(outcome.front[*outcome.chosen].variables[found.smooth[i]],
                                ChosenSensitivity::kPart * (variable.max - variable.min)));
    }
    std::vector<std::vector<std::string>> rows{steps};
    for (const std::size_t f : told) {
      if (!found.slides(f)) continue;
      std::vector<std::string> row{found.figures[f].name};
      for (std::size_t i = first; i < last; ++i) {
        row.push_back(change_text(found.values[f], found.grown[i][f], found.figures[f].logarithm));
      }
      rows.push_back(std::move(row));
    }
    sheet.table(head, rows);
  }
  for (const ChosenSensitivity::Step& step : found.steps) {
    sheet.gap();
    const std::string& name = study.variables[step.variable].name;
    std::vector<std::string> head{"figure"};
    std::string said = fmt::format("{}, {}:", name,
                                   outcome.front[*outcome.chosen].variables[step.variable].part.empty()
                                       ? "one step"
                                       : "the parts beside it");
    for (std::size_t side = 0; side < 2; ++side) {
      if (step.value[side].empty()) continue;
      const char* way = side == 0 ? "down" : "up";
      head.emplace_back(way);
      said += fmt::format(" {} is {}{};", way, step.value[side],
                          step.feasible[side] ? "" : ", which breaks a constraint");
    }
    said.back() = '.';
    sheet.paragraph(said, 2, Tint::dim);
    std::vector<std::vector<std::string>> rows;
    for (const std::size_t f : told) {
      std::vector<std::string> row{found.figures[f].name};
      for (std::size_t side = 0; side < 2; ++side) {
        if (step.value[side].empty()) continue;
        row.push_back(change_text(found.values[f], step.figures[side][f], found.figures[f].logarithm));
      }
      rows.push_back(std::move(row));
    }
    sheet.table(head, rows);
  }
  std::string still;
  for (std::size_t f = 0; f < found.figures.size(); ++f) {
    if (found.moves(f)) continue;
    still += fmt::format("{}\"{}\"", still.empty() ? "" : ", ", found.figures[f].name);
  }
  if (!still.empty()) sheet.paragraph(fmt::format("Nothing of this changes {}.", still), 2, Tint::dim);
}

}  // namespace

std::string obstacle_text(const CountedObstacle& one, int looked_at) {
  const DesignObstacle& first = one.first;
  const std::string table = first.place.substr(0, first.place.find('['));
  const std::string what = first.place.empty()  ? fmt::format("the rule of device files that {}", first.what)
                           : table == "measure" ? fmt::format("measure \"{}\"", first.what)
                                                : fmt::format("{} \"{}\"", first.place, first.what);
  return fmt::format("{} {}: in {} of {} designs drawn, such as {}{}", what, first.rule, one.count, looked_at,
                     one.example, first.with.empty() ? "" : fmt::format(", where {}", first.with));
}

Json outcome_json(const StudyOutcome& outcome, const StudyModel& model) {
  const Study& study = model.study();
  const SearchResult& result = outcome.result;
  Json document;
  document["study"] = study.name;
  document["device"] = study.device;
  document["status"] = outcome.chosen ? "found" : "infeasible";
  Json search;
  search["algorithm"] = info(outcome.options.algorithm).name;
  search["population"] = outcome.options.population;
  search["seed"] = outcome.options.seed;
  search["generations"] = result.history.empty() ? 0 : result.history.back().number;
  search["evaluations"] = result.evaluations;
  search["end"] = to_words(result.end);
  search["feasible_share"] =
      result.history.empty() ? Json(nullptr) : json_number(result.history.back().feasible_share);
  search["hypervolume"] =
      result.history.empty() ? Json(nullptr) : json_number(result.history.back().hypervolume);
  search["reference"] = Json::array();
  for (const double one : result.reference) search["reference"].push_back(json_number(one));
  search["seconds_evaluating"] = result.seconds_evaluating;
  search["seconds_in_algorithm"] = result.seconds_in_algorithm;
  search["workers"] = outcome.workers;
  document["search"] = search;
  document["objectives"] = Json::array();
  for (const StudyObjective& one : study.objectives) {
    Json entry;
    entry["name"] = one.name;
    entry["goal"] = one.maximise ? "maximise" : "minimise";
    entry["value"] = one.value;
    entry["unit"] = model.objective_units()[document["objectives"].size()];
    document["objectives"].push_back(entry);
  }
  document["constraints"] = Json::array();
  for (std::size_t c = 0; c < result.constraints.size(); ++c) {
    const ConstraintRecord& record = result.constraints[c];
    Json entry;
    entry["name"] = outcome.problem.constraints[c];
    entry["held"] = record.held;
    entry["undefined"] = record.undefined;
    entry["least_violation"] = json_number(record.least_violation);
    document["constraints"].push_back(entry);
  }
  document["undefined"] = Json::array();
  for (const CountedObstacle& one : outcome.obstacles) {
    document["undefined"].push_back({{"key", one.first.place},
                                     {"what", one.first.what},
                                     {"rule", one.first.rule},
                                     {"count", one.count},
                                     {"of", outcome.looked_at},
                                     {"example", one.example}});
  }
  document["start"] = nullptr;
  if (outcome.start) {
    document["start"] = sheet_json(*outcome.start, study);
    document["start"]["feasible"] = outcome.start->feasible;
    document["start"]["moved"] = outcome.start_moved;
  }
  document["pareto"] = Json::array();
  for (const DesignSheet& sheet : outcome.front) document["pareto"].push_back(sheet_json(sheet, study));
  document["chosen"] = nullptr;
  if (!outcome.chosen) return document;
  Json chosen = sheet_json(outcome.front[*outcome.chosen], study);
  chosen["row"] = *outcome.chosen;
  chosen["rule"] = outcome.choice;
  if (outcome.sensitivity) {
    const ChosenSensitivity& found = *outcome.sensitivity;
    chosen["slopes"] = Json::object();
    for (std::size_t i = 0; i < found.smooth.size(); ++i) {
      Json& slopes = chosen["slopes"][study.variables[found.smooth[i]].name];
      for (std::size_t f = 0; f < found.figures.size(); ++f) {
        slopes[found.figures[f].name] = json_number(found.slopes.slope[f * found.smooth.size() + i]);
      }
    }
    chosen["steps"] = Json::object();
    for (const ChosenSensitivity::Step& step : found.steps) {
      Json& entry = chosen["steps"][study.variables[step.variable].name];
      for (const bool up : {false, true}) {
        const auto side = static_cast<std::size_t>(up);
        Json& one = entry[up ? "up" : "down"];
        if (step.value[side].empty()) continue;
        one["value"] = step.value[side];
        one["feasible"] = step.feasible[side];
        for (std::size_t f = 0; f < found.figures.size(); ++f) {
          one["figures"][found.figures[f].name] = json_number(step.figures[side][f]);
        }
      }
    }
    chosen["margins"] = Json::object();
    for (std::size_t c = 0; c < found.margins.size(); ++c) {
      chosen["margins"][study.constraints[c].name] = json_number(found.margins[c]);
    }
  }
  if (outcome.tolerances) chosen["tolerances"] = tolerances_json(*outcome.tolerances, study);
  document["chosen"] = chosen;
  return document;
}

std::string outcome_text(const StudyOutcome& outcome, const StudyModel& model, const Terminal& terminal,
                         const std::vector<std::pair<std::string, std::string>>& files) {
  const Study& study = model.study();
  const SearchResult& result = outcome.result;
  Sheet sheet(terminal);
  sheet.title(study.name, study.title);
  if (!study.source.empty()) sheet.paragraph("Source: " + study.source, 2, Tint::dim);

  sheet.heading("Search");
  sheet.row("algorithm", std::string(info(outcome.options.algorithm).name),
            std::string(info(outcome.options.algorithm).what));
  const std::int64_t generations = result.history.empty() ? 0 : result.history.back().number;
  sheet.row("designs", fmt::format("{}", result.evaluations),
            outcome.options.algorithm == SearchAlgorithm::grid
                ? std::string(to_words(result.end))
                : fmt::format("{} generations, {}", generations, to_words(result.end)));
  const double total = result.seconds_evaluating + result.seconds_in_algorithm;
  if (total > 0.0) {
    sheet.row("time", quantity(total, 1.0, "s", 3),
              fmt::format("{:.0f} % evaluating on {} {}, {:.0f} % in the algorithm; {} designs/s",
                          100.0 * result.seconds_evaluating / total, outcome.workers,
                          outcome.ranks          ? "ranks"
                          : outcome.workers == 1 ? "thread"
                                                 : "threads",
                          100.0 * result.seconds_in_algorithm / total,
                          number(static_cast<double>(result.evaluations) / total, 3)));
  }
  if (!result.history.empty()) {
    const Generation& last = result.history.back();
    if (outcome.options.algorithm != SearchAlgorithm::grid) {
      sheet.row("feasible", quantity(last.feasible_share, 100.0, "%", 3), "of the last population");
    }
    if (std::isfinite(last.hypervolume) && study.objectives.size() > 1) {
      std::string reference;
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        const double sign = study.objectives[o].maximise ? -1.0 : 1.0;
        reference += fmt::format("{}{} {}", reference.empty() ? "" : ", ", study.objectives[o].name,
                                 amount(sign * result.reference[o], model.objective_units()[o]));
      }
      sheet.row("hypervolume", number(last.hypervolume), fmt::format("SI, up to {}", reference));
    }
  }
  if (result.failures > 0) {
    sheet.row("failed", fmt::format("{}", result.failures),
              "evaluations" + (result.first_failure.empty() ? "" : "; the first: " + result.first_failure));
  }

  if (outcome.chosen && !outcome.obstacles.empty()) {
    const CountedObstacle& most = outcome.obstacles.front();
    sheet.row("undefined", fmt::format("{} of {}", most.count, outcome.looked_at),
              obstacle_text(most, outcome.looked_at));
  }
  if (!outcome.chosen) {
    sheet.heading("No design meets all constraints");
    const std::string text = never_met(outcome);
    if (text.empty()) {
      sheet.paragraph("Each constraint was met by some design, but never all by one.");
      for (std::size_t c = 0; c < outcome.result.constraints.size(); ++c) {
        sheet.paragraph(fmt::format("\"{}\" was met by {} of {}", outcome.problem.constraints[c],
                                    outcome.result.constraints[c].held, outcome.result.evaluations));
      }
    }
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t end = text.find('\n', from);
      sheet.paragraph(text.substr(from, end - from), 2, Tint::bad);
      from = end + 1;
    }
    for (const CountedObstacle& one : outcome.obstacles) {
      sheet.paragraph(obstacle_text(one, outcome.looked_at), 2, Tint::bad);
    }
  } else {
    const DesignSheet& chosen = outcome.front[*outcome.chosen];
    sheet.heading(study.objectives.size() > 1 ? "Pareto set" : "Best design");
    if (study.objectives.size() > 1) {
      sheet.row("designs", fmt::format("{}", outcome.front.size()), "that no other beats in everything");
      std::vector<std::string> head{""};
      for (const StudyObjective& one : study.objectives) {
        head.push_back(fmt::format("{} ({})", one.name, one.maximise ? "large" : "small"));
      }
      std::vector<std::vector<std::string>> rows;
      const auto add = [&](const std::string& label, const DesignSheet& design) {
        std::vector<std::string> row{label};
        for (std::size_t o = 0; o < design.objectives.size(); ++o)
          row.push_back(amount(design.objectives[o], model.objective_units()[o]));
        rows.push_back(std::move(row));
      };
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        add("best " + study.objectives[o].name, outcome.front[outcome.best(o)]);
      }
      add("chosen", chosen);
      if (outcome.start) add(outcome.start_moved ? "nearest to the device" : "the device", *outcome.start);
      sheet.table(head, rows);
    }
    if (outcome.start) {
      std::string said = outcome.start_moved ? "the nearest design within the bounds " : "";
      said += outcome.start->feasible ? "meets all constraints" : "breaks constraints";
      sheet.row("the device",
                study.objectives.size() > 1
                    ? ""
                    : amount(outcome.start->objectives.front(), model.objective_units().front()),
                said);
    }
    sheet.heading("Chosen design");
    sheet.paragraph(outcome.choice, 2, Tint::dim);
    for (const DesignValue& one : chosen.variables) sheet.row(one.name, value_text(one));
    for (const DesignValue& one : chosen.derived) sheet.row(one.name, value_text(one), "follows");
    for (std::size_t o = 0; o < study.objectives.size(); ++o) {
      sheet.row(study.objectives[o].name, amount(chosen.objectives[o], model.objective_units()[o]),
                study.objectives[o].maximise ? "objective, to be large" : "objective, to be small");
    }
    for (std::size_t c = 0; c < study.constraints.size(); ++c) {
      const StudyConstraint& one = study.constraints[c];
      sheet.row(one.name, amount(chosen.constraints[c], model.constraint_units()[c]),
                fmt::format("{}{}{}", one.min.empty() ? "" : "at least " + one.min,
                            one.min.empty() || one.max.empty() ? "" : ", ",
                            one.max.empty() ? "" : "at most " + one.max));
    }
    if (outcome.sensitivity) write_sensitivity(outcome, model, sheet);
    if (outcome.tolerances) {
      sheet.heading("Tolerances");
      sheet.paragraph(fmt::format("{} samples of {}.", outcome.tolerances->samples, tolerance_words(study)), 2,
                      Tint::dim);
      std::vector<std::vector<std::string>> rows;
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        const OutcomeSpread& spread = outcome.tolerances->outcomes[o];
        const std::string& unit = model.objective_units()[o];
        rows.push_back({study.objectives[o].name, amount(spread.nominal, unit), amount(spread.mean.value, unit),
                        amount(deviation_of(spread), unit), amount(spread.percentile_5.value, unit),
                        amount(spread.percentile_95.value, unit)});
      }
      sheet.table({"objective", "designed", "mean", "deviation", "5 %", "95 %"}, rows);
      if (!study.constraints.empty()) {
        const Estimate& broken = outcome.tolerances->broken;
        sheet.row("break a constraint", quantity(broken.value, 100.0, "%", 3),
                  fmt::format("of the devices made; {} to {} with 95 % confidence",
                              quantity(broken.low, 100.0, "%", 2), quantity(broken.high, 100.0, "%", 2)));
      }
    }
  }
  sheet.heading("Files");
  for (const auto& [what, path] : files) sheet.row(what, path);
  return sheet.text();
}

}  // namespace zwidth
