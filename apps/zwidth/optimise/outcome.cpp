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

std::string value_text(const DesignValue& value) {
  if (!value.part.empty()) return value.part;
  if (std::isnan(value.value)) return "undefined";
  if (value.dimension == Dimension::angle) return quantity(value.value, kDegrees, "deg");
  if (value.dimension == Dimension::number) return trimmed(value.value, 6);
  return readable(value.value, si_unit(value.dimension));
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

/// Relative change of an objective per relative change of a variable, at the chosen design.
std::optional<double> elasticity(const StudyOutcome& outcome, std::size_t objective, std::size_t i) {
  const ChosenSlopes& found = *outcome.slopes;
  const double slope = found.slopes.slope[objective * found.variables.size() + i];
  const double value = outcome.front[*outcome.chosen].objectives[objective];
  const double at = outcome.design(*outcome.chosen)[found.variables[i]];
  const double result = slope * at / value;
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
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
  document["pareto"] = Json::array();
  for (const DesignSheet& sheet : outcome.front) document["pareto"].push_back(sheet_json(sheet, study));
  document["chosen"] = nullptr;
  if (!outcome.chosen) return document;
  Json chosen = sheet_json(outcome.front[*outcome.chosen], study);
  chosen["row"] = *outcome.chosen;
  chosen["rule"] = outcome.choice;
  if (outcome.slopes) {
    for (std::size_t i = 0; i < outcome.slopes->variables.size(); ++i) {
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        const double slope = outcome.slopes->slopes.slope[o * outcome.slopes->variables.size() + i];
        chosen["slopes"][study.variables[outcome.slopes->variables[i]].name][study.objectives[o].name] =
            json_number(slope);
      }
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
            fmt::format("{} generations, {}", generations, to_words(result.end)));
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
      for (const double one : result.reference) reference += (reference.empty() ? "" : ", ") + number(one);
      sheet.row("hypervolume", number(last.hypervolume), "up to (" + reference + ")");
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
        for (const double value : design.objectives) row.push_back(number(value));
        rows.push_back(std::move(row));
      };
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        add("best " + study.objectives[o].name, outcome.front[outcome.best(o)]);
      }
      add("chosen", chosen);
      sheet.table(head, rows);
    }
    sheet.heading("Chosen design");
    sheet.paragraph(outcome.choice, 2, Tint::dim);
    for (const DesignValue& one : chosen.variables) sheet.row(one.name, value_text(one));
    for (const DesignValue& one : chosen.derived) sheet.row(one.name, value_text(one), "follows");
    for (std::size_t o = 0; o < study.objectives.size(); ++o) {
      sheet.row(study.objectives[o].name, number(chosen.objectives[o]),
                study.objectives[o].maximise ? "objective, to be large" : "objective, to be small");
    }
    for (std::size_t c = 0; c < study.constraints.size(); ++c) {
      const StudyConstraint& one = study.constraints[c];
      sheet.row(one.name, number(chosen.constraints[c]),
                fmt::format("{}{}{}", one.min.empty() ? "" : "at least " + one.min,
                            one.min.empty() || one.max.empty() ? "" : ", ",
                            one.max.empty() ? "" : "at most " + one.max));
    }
    if (outcome.slopes) {
      sheet.heading("Sensitivity");
      sheet.paragraph("Change of each objective in %, when a variable grows by 1 % of itself.", 2, Tint::dim);
      std::vector<std::string> head{"variable"};
      for (const StudyObjective& one : study.objectives) head.push_back(one.name);
      std::vector<std::vector<std::string>> rows;
      for (std::size_t i = 0; i < outcome.slopes->variables.size(); ++i) {
        std::vector<std::string> row{study.variables[outcome.slopes->variables[i]].name};
        for (std::size_t o = 0; o < study.objectives.size(); ++o) {
          const auto change = elasticity(outcome, o, i);
          row.push_back(change ? fmt::format("{:+.2f}", *change) : "–");
        }
        rows.push_back(std::move(row));
      }
      sheet.table(head, rows);
    }
    if (outcome.tolerances) {
      sheet.heading("Tolerances");
      std::string strays;
      for (const StudyTolerance& one : study.tolerances) {
        strays +=
            fmt::format("{}{} ±{}", strays.empty() ? "" : ", ", one.name,
                        one.relative ? quantity(one.half_width, 100.0, "%")
                                     : value_text({.name = "",
                                                   .value = one.half_width,
                                                   .part = "",
                                                   .dimension = one.dimension.value_or(Dimension::number)}));
      }
      sheet.paragraph(fmt::format("{} samples of {}.", outcome.tolerances->samples, strays), 2, Tint::dim);
      std::vector<std::vector<std::string>> rows;
      for (std::size_t o = 0; o < study.objectives.size(); ++o) {
        const OutcomeSpread& spread = outcome.tolerances->outcomes[o];
        rows.push_back({study.objectives[o].name, number(spread.nominal), number(spread.mean.value),
                        number(spread.standard_deviation, 3), number(spread.percentile_5.value),
                        number(spread.percentile_95.value)});
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
