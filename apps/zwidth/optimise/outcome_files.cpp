#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <sstream>

#include "figure/parallel.h"
#include "figure/plot.h"
#include "optimise/outcome.h"
#include "sheet_figures.h"
#include "sheet_html.h"

#include "zwidth/description/write.h"
#include "zwidth/design/pareto.h"

namespace zwidth {

namespace {

constexpr double kWidth = 460.0, kHeight = 320.0;
constexpr std::size_t kMostLines = 250;  // in parallel coordinates

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string pareto_csv(const StudyOutcome& outcome, const Study& study) {
  std::string text;
  const auto cell = [&](const std::string& value, bool last) {
    text += csv_field(value) + (last ? "\n" : ",");
  };
  for (const StudyVariable& one : study.variables) cell(one.name, false);
  for (const StudyObjective& one : study.objectives)
    cell(one.name, study.constraints.empty() && &one == &study.objectives.back());
  for (const StudyConstraint& one : study.constraints) cell(one.name, &one == &study.constraints.back());
  for (const DesignSheet& sheet : outcome.front) {
    std::vector<std::string> row;
    for (const DesignValue& one : sheet.variables) {
      row.push_back(one.part.empty() ? fmt::format("{}", one.value) : one.part);
    }
    for (const double value : sheet.objectives) row.push_back(fmt::format("{}", value));
    for (const double value : sheet.constraints) row.push_back(fmt::format("{}", value));
    for (std::size_t i = 0; i < row.size(); ++i) cell(row[i], i + 1 == row.size());
  }
  return text;
}

std::string history_csv(const StudyOutcome& outcome) {
  std::string text =
      "generation,evaluations,feasible_share,front,hypervolume,seconds_evaluating,seconds_in_algorithm\n";
  for (const Generation& one : outcome.result.history) {
    text += fmt::format("{},{},{},{},{},{:.6f},{:.6f}\n", one.number, one.evaluations, one.feasible_share,
                        one.front, std::isnan(one.hypervolume) ? "" : fmt::format("{}", one.hypervolume),
                        one.seconds_evaluating, one.seconds_in_algorithm);
  }
  return text;
}

// A range with a little room, and whether it is better seen on a logarithmic axis.
Axis axis_of(const std::string& label, double low, double high) {
  Axis axis{.label = label, .range = {low, high}};
  constexpr double kManyTimes = 30.0;
  if (low > 0.0 && high > kManyTimes * low) {
    axis.logarithmic = true;
    axis.range = {low / 1.2, high * 1.2};
  } else {
    const double room = high > low ? 0.05 * (high - low) : std::max(1e-12, 0.05 * std::abs(low));
    axis.range = {low - room, high + room};
  }
  return axis;
}

std::string label_of(const StudyObjective& objective) {
  return fmt::format("{} (to be {})", objective.name, objective.maximise ? "large" : "small");
}

std::vector<SheetFigure> drawn_figures(const StudyOutcome& outcome, const Study& study) {
  std::vector<SheetFigure> figures;
  const std::size_t n = study.objectives.size();
  const auto range_of = [&](std::size_t o) {
    Interval range{HUGE_VAL, -HUGE_VAL};
    for (const DesignSheet& sheet : outcome.front) {
      range = {std::min(range.min, sheet.objectives[o]), std::max(range.max, sheet.objectives[o])};
    }
    return range;
  };
  if (!outcome.front.empty() && n > 1) {
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) {
        const Interval x = range_of(a), y = range_of(b);
        Plot plot(kWidth, kHeight, axis_of(label_of(study.objectives[a]), x.min, x.max),
                  axis_of(label_of(study.objectives[b]), y.min, y.max));
        std::vector<Point2> points;
        for (const DesignSheet& sheet : outcome.front)
          points.push_back({sheet.objectives[a], sheet.objectives[b]});
        plot.dots(points, 1);
        if (outcome.chosen) {
          const DesignSheet& chosen = outcome.front[*outcome.chosen];
          plot.mark({chosen.objectives[a], chosen.objectives[b]}, "chosen");
        }
        const std::string title =
            fmt::format("{} against {}", study.objectives[b].name, study.objectives[a].name);
        figures.push_back({.id = fmt::format("front-{}-{}", a + 1, b + 1),
                           .section = "front",
                           .title = title,
                           .caption = n > 2 ? "All objectives together decide what belongs to the set, so its "
                                              "shadow on two of them is no line."
                                            : "",
                           .svg = plot.svg(title)});
      }
    }
  }
  if (outcome.front.size() > 1) {
    // Every figure over its own range along the set, the better end of an objective up.
    std::vector<std::size_t> rows;
    const std::size_t step = outcome.front.size() / kMostLines + 1;
    for (std::size_t row = 0; row < outcome.front.size(); ++row) {
      if (row % step == 0 || row == outcome.chosen) rows.push_back(row);
    }
    std::vector<ParallelAxis> axes;
    const auto add = [&](const std::string& name, bool strong, bool small_is_better, auto value, auto text) {
      double least = HUGE_VAL, most = -HUGE_VAL;
      for (const DesignSheet& sheet : outcome.front) {
        least = std::min(least, value(sheet));
        most = std::max(most, value(sheet));
      }
      ParallelAxis axis{.name = name, .low = text(least), .high = text(most), .shares = {}, .strong = strong};
      if (small_is_better) std::swap(axis.low, axis.high);
      for (const std::size_t row : rows) {
        const double share = most > least ? (value(outcome.front[row]) - least) / (most - least) : 0.5;
        axis.shares.push_back(small_is_better ? 1.0 - share : share);
      }
      axes.push_back(std::move(axis));
    };
    for (std::size_t v = 0; v < study.variables.size(); ++v) {
      add(
          study.variables[v].name, false, false,
          [v](const DesignSheet& sheet) { return sheet.variables[v].value; },
          [&](double value) {
            DesignValue shown = outcome.front.front().variables[v];
            shown.value = value;
            if (!shown.part.empty()) shown.part = study.variables[v].parts[static_cast<std::size_t>(value)];
            return value_text(shown);
          });
    }
    for (std::size_t o = 0; o < n; ++o) {
      add(
          study.objectives[o].name, true, !study.objectives[o].maximise,
          [o](const DesignSheet& sheet) { return sheet.objectives[o]; },
          [](double value) { return number(value, 3); });
    }
    std::optional<std::size_t> marked;
    if (outcome.chosen) {
      marked = static_cast<std::size_t>(std::find(rows.begin(), rows.end(), *outcome.chosen) - rows.begin());
    }
    if (axes.size() > 1) {
      const double width = std::max(2.0 * kWidth, 96.0 * static_cast<double>(axes.size()));
      const std::string title = "Parallel coordinates";
      figures.push_back(
          {.id = "parallel-coordinates",
           .section = "parallel",
           .title = title,
           .caption = "One line per design of the set, the chosen one thick. Objectives stand at the right, "
                      "their better end up: lines that cross there are a trade-off.",
           .svg = parallel_coordinates(width, kHeight, axes, marked, title)});
    }
  }
  std::vector<Point2> growth;
  for (const Generation& one : outcome.result.history) {
    if (std::isfinite(one.hypervolume)) growth.push_back({static_cast<double>(one.number), one.hypervolume});
  }
  if (growth.size() > 1) {
    const auto [low, high] = std::minmax_element(growth.begin(), growth.end(),
                                                 [](const Point2& a, const Point2& b) { return a.y < b.y; });
    Axis y = axis_of(n > 1 ? "hypervolume" : "gain", low->y, high->y);
    Plot plot(kWidth, kHeight, {.label = "generation", .range = {0.0, growth.back().x}}, y);
    plot.line(growth, 1);
    figures.push_back({.id = "hypervolume",
                       .section = "search",
                       .title = n > 1 ? "Hypervolume" : "Gain of the best design",
                       .caption = "Flat at the end: more generations would find little.",
                       .svg = plot.svg("Progress of the search over its generations")});
  }
  return figures;
}

std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string text = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& one : head) text += fmt::format("<th>{}</th>", escaped(one));
  text += "</tr></thead><tbody>";
  for (const std::vector<std::string>& row : rows) {
    text += "<tr>";
    for (const std::string& one : row) text += fmt::format("<td>{}</td>", escaped(one));
    text += "</tr>";
  }
  return text + "</tbody></table></div>\n";
}

std::string times(double factor) {
  return factor >= 1.0 ? fmt::format("{} times", number(factor, 3))
                       : fmt::format("{} times", number(factor, 2));
}

// What the front costs at one end and gives at the other.
std::string trade_off(const StudyOutcome& outcome, const Study& study) {
  std::string text;
  const std::size_t n = study.objectives.size();
  for (std::size_t a = 0; a < n; ++a) {
    const DesignSheet& best = outcome.front[outcome.best(a)];
    const DesignSheet& chosen = outcome.front[*outcome.chosen];
    std::string costs;
    for (std::size_t b = 0; b < n; ++b) {
      if (b == a) continue;
      const double factor = chosen.objectives[b] / best.objectives[b];
      costs += fmt::format("{}{} from {} to {}{}", costs.empty() ? "" : ", ", study.objectives[b].name,
                           number(best.objectives[b]), number(chosen.objectives[b]),
                           std::isfinite(factor) && factor > 0.0 ? fmt::format(" ({})", times(factor)) : "");
    }
    text += fmt::format("<p>The best <b>{0}</b> is {1}. The chosen design has {2}, and brings {3}.</p>\n",
                        escaped(study.objectives[a].name), number(best.objectives[a]),
                        number(chosen.objectives[a]), escaped(costs));
  }
  return text;
}

std::string page(const StudyOutcome& outcome, const StudyModel& model,
                 const std::vector<SheetFigure>& figures) {
  const Study& study = model.study();
  std::string body;
  const auto show = [&](const std::string& section, const char* kind = "") {
    std::string cards;
    for (const SheetFigure& figure : figures) {
      if (figure.section != section) continue;
      cards += fmt::format("<figure class=\"card\" id=\"{}\"><b>{}</b>{}<figcaption>{}</figcaption></figure>\n",
                           figure.id, escaped(figure.title), figure.svg, escaped(figure.caption));
    }
    if (!cards.empty()) body += fmt::format("<div class=\"figures {}\">{}</div>\n", kind, cards);
  };
  // A figure by itself would grow as wide as the page.
  const auto show_few = [&](const std::string& of_section) {
    const auto count = std::count_if(figures.begin(), figures.end(),
                                     [&](const SheetFigure& figure) { return figure.section == of_section; });
    show(of_section, count == 1 ? "one" : "");
  };
  const auto section = [&](const char* id, const std::string& title) {
    body += fmt::format("<section><h2 id=\"{}\">{}</h2>\n", id, escaped(title));
  };
  section("chosen", outcome.chosen ? "The chosen design" : "No design meets all constraints");
  if (outcome.chosen) {
    const DesignSheet& chosen = outcome.front[*outcome.chosen];
    body += "<div class=\"tiles\">";
    for (std::size_t o = 0; o < study.objectives.size(); ++o) {
      body += fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>", number(chosen.objectives[o]),
                          escaped(label_of(study.objectives[o])));
    }
    body += fmt::format("</div>\n<p class=\"how\">Chosen as {}.</p>\n", escaped(outcome.choice));
    std::vector<std::vector<std::string>> rows;
    for (const DesignValue& one : chosen.variables)
      rows.push_back({one.name, value_text(one), "chosen freely"});
    for (const DesignValue& one : chosen.derived) rows.push_back({one.name, value_text(one), "follows"});
    for (std::size_t c = 0; c < study.constraints.size(); ++c) {
      const StudyConstraint& one = study.constraints[c];
      rows.push_back({one.name, number(chosen.constraints[c]),
                      fmt::format("constraint: {} {}", one.min.empty() ? "" : "at least " + one.min,
                                  one.max.empty() ? "" : "at most " + one.max)});
    }
    body += table({"", "value", ""}, rows);
  } else {
    std::vector<std::vector<std::string>> rows;
    for (std::size_t c = 0; c < outcome.result.constraints.size(); ++c) {
      const ConstraintRecord& record = outcome.result.constraints[c];
      rows.push_back({outcome.problem.constraints[c], fmt::format("{}", record.held),
                      std::isfinite(record.least_violation) ? number(record.least_violation) : "undefined"});
    }
    body += table({"constraint", "designs that meet it", "least violation"}, rows);
  }
  body += "</section>\n";
  if (outcome.chosen && study.objectives.size() > 1) {
    section("front", "The trade-off");
    body += fmt::format("<p>{} designs remain that no other beats in all objectives at once.</p>\n",
                        outcome.front.size());
    body += trade_off(outcome, study);
    show_few("front");
    show("parallel");
    body += "</section>\n";
  }
  if (outcome.tolerances) {
    section("tolerances", "What tolerances do");
    std::vector<std::vector<std::string>> rows;
    for (std::size_t o = 0; o < study.objectives.size(); ++o) {
      const OutcomeSpread& spread = outcome.tolerances->outcomes[o];
      rows.push_back({study.objectives[o].name, number(spread.nominal), number(spread.mean.value),
                      number(spread.standard_deviation, 3), number(spread.percentile_5.value),
                      number(spread.percentile_95.value)});
    }
    body += table({"objective", "designed", "mean", "standard deviation", "5 %", "95 %"}, rows);
    body += "</section>\n";
  }
  section("search", "The search");
  std::string said = fmt::format("<p>{} ({}): {} designs", info(outcome.options.algorithm).name,
                                 escaped(info(outcome.options.algorithm).what), outcome.result.evaluations);
  if (outcome.options.algorithm != SearchAlgorithm::grid) {
    said += fmt::format(" in {} generations of {}, seed {}",
                        outcome.result.history.empty() ? 0 : outcome.result.history.back().number,
                        outcome.options.population, outcome.options.seed);
  }
  body += said + ".</p>\n";
  show_few("search");
  body += "</section>\n";
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">\n<title>{0} – "
      "study</title>\n<style>{1}{2}</style>\n</head>\n"
      "<body>\n<div class=\"page\">\n<header><h1>{3}</h1><p>Study <code>{0}</code> of <code>{4}</code></p>{5}"
      "</header>\n<nav aria-label=\"Contents\"><b>Contents</b><ol><li><a href=\"#chosen\">Chosen "
      "design</a></li>{6}"
      "{9}<li><a href=\"#search\">Search</a></li></ol></nav>\n<main>\n{7}</main>\n<footer>Computed by zwidth "
      "{8}. {10}Every "
      "number is in <a href=\"pareto.json\">pareto.json</a>.</footer>\n</div>\n</body>\n</html>\n",
      escaped(study.name), page_style(), figure_style(), escaped(study.title), escaped(study.device),
      study.source.empty() ? "" : fmt::format("<p>Source: {}</p>", escaped(study.source)),
      outcome.chosen && study.objectives.size() > 1 ? "<li><a href=\"#front\">Trade-off</a></li>" : "", body,
      ZWIDTH_VERSION, outcome.tolerances ? "<li><a href=\"#tolerances\">Tolerances</a></li>" : "",
      outcome.front.empty() ? "" : "All designs are in <a href=\"pareto.csv\">pareto.csv</a>. ");
}

/// The chosen design as a device of its own.
std::string chosen_device(const StudyOutcome& outcome, const StudyModel& model) {
  const Study& study = model.study();
  StudyEvaluator evaluator(model);
  const std::string source = fmt::format("chosen: by the study {}", study.name);
  Description device = evaluator.description(outcome.design(*outcome.chosen), source);
  device.source = fmt::format("{}, from the device {} ({})", source, device.name, device.source);
  device.title = study.title;
  device.name = study.name;
  std::ostringstream text;
  write_description(device, text, catalogue());
  return text.str();
}

}  // namespace

std::vector<std::pair<std::string, std::string>> write_outcome(const StudyOutcome& outcome,
                                                               const StudyModel& model,
                                                               const std::string& directory) {
  const Study& study = model.study();
  std::vector<std::pair<std::string, std::string>> files;
  const auto write = [&](const std::string& what, const std::string& name, const std::string& text) {
    const std::string path = (std::filesystem::path(directory) / name).string();
    write_file(path, text);
    files.emplace_back(what, path);
  };
  const std::vector<SheetFigure> figures = drawn_figures(outcome, study);
  write("page with figures", "index.html", page(outcome, model, figures));
  if (outcome.chosen) write("chosen device", "chosen.toml", chosen_device(outcome, model));
  if (!outcome.front.empty()) write("Pareto set", "pareto.csv", pareto_csv(outcome, study));
  write("numbers, SI", "pareto.json", outcome_json(outcome, model).dump(2) + "\n");
  write("history", "history.csv", history_csv(outcome));
  for (const SheetFigure& figure : figures) {
    write_file((std::filesystem::path(directory) / "figures" / (figure.id + ".svg")).string(),
               standalone_svg(figure));
  }
  if (!figures.empty()) files.emplace_back("figures", directory + "/figures/*.svg");
  files.emplace_back("to go on from", (std::filesystem::path(directory) / "checkpoint").string());
  return files;
}

}  // namespace zwidth
