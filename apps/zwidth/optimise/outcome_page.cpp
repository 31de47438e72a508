#include "optimise/outcome_page.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <string_view>

#include "figure/svg.h"
#include "sheet_html.h"

namespace zwidth {

namespace {

// A cell of a table: text, set apart by a class of the page's style.
struct Cell {
  std::string text;
  const char* kind = "";
  std::string tag = {};  // a short word behind it
};

std::string table(const std::vector<Cell>& head, const std::vector<std::vector<Cell>>& rows) {
  const auto write = [](const char* element, const Cell& cell) {
    const std::string tag =
        cell.tag.empty() ? "" : fmt::format(" <span class=\"tag\">{}</span>", escaped(cell.tag));
    return fmt::format("<{0}{1}>{2}{3}</{0}>", element,
                       *cell.kind != '\0' ? fmt::format(" class=\"{}\"", cell.kind) : "", escaped(cell.text),
                       tag);
  };
  std::string text = "<div class=\"scroll\"><table><thead><tr>";
  for (const Cell& one : head) text += write("th", one);
  text += "</tr></thead><tbody>";
  for (const std::vector<Cell>& row : rows) {
    // A row of one cell is a heading for those below.
    if (row.size() == 1) {
      text += fmt::format("<tr class=\"group\"><td colspan=\"{}\">{}</td></tr>", head.size(),
                          escaped(row.front().text));
      continue;
    }
    text += "<tr>";
    for (const Cell& one : row) text += write("td", one);
    text += "</tr>";
  }
  return text + "</tbody></table></div>\n";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
  }
  return text;
}

// Beside the style of all pages: designs stand in columns that are narrow enough for several.
constexpr std::string_view kStyle = R"css(
td.r,th.r{text-align:right;white-space:normal;min-width:96px}th.r{vertical-align:bottom}
td:first-child{min-width:150px}
.tile .ok{color:var(--good)}.tile .no{color:var(--bad)}
li{margin:4px 0;max-width:74ch}
)css";

class OutcomePage {
 public:
  OutcomePage(const StudyOutcome& outcome, const StudyModel& model, const std::vector<SheetFigure>& figures)
      : outcome_(outcome), model_(model), study_(model.study()), figures_(figures) {}

  std::string write() {
    if (outcome_.chosen) {
      answer();
      if (study_.objectives.size() > 1) trade_off();
      constraints();
      if (outcome_.sensitivity) sensitivity();
      if (outcome_.tolerances) tolerances();
    } else {
      nothing();
    }
    search();
    body_ += "</section>\n";
    std::string contents;
    for (const auto& [id, title] : contents_) {
      contents += fmt::format("<li><a href=\"#{}\">{}</a></li>", id, escaped(title));
    }
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\">\n<title>{0} – "
        "study</title>\n<style>{1}{2}{10}</style>\n"
        "</head>\n<body>\n<div class=\"page\">\n<header><h1>{3}</h1><p>Study <code>{0}</code> of "
        "<code>{4}</code></p>{5}</header>\n<nav aria-label=\"Contents\"><b>Contents</b><ol>{6}</ol></nav>\n"
        "<main>\n{7}</main>\n<footer>Computed by zwidth {8}. {9}Every number, in SI units, is in "
        "<a href=\"pareto.json\">pareto.json</a>.</footer>\n</div>\n</body>\n</html>\n",
        escaped(study_.name), page_style(), figure_style(),
        escaped(study_.title.empty() ? study_.name : study_.title), escaped(study_.device),
        study_.source.empty() ? "" : fmt::format("<p>Source: {}</p>", escaped(study_.source)), contents, body_,
        ZWIDTH_VERSION,
        outcome_.front.empty()
            ? ""
            : "The chosen design is <a href=\"chosen.toml\">chosen.toml</a>, all designs of the "
              "set are in <a href=\"pareto.csv\">pareto.csv</a>. ",
        kStyle);
  }

 private:
  const DesignSheet& chosen() const { return outcome_.front[*outcome_.chosen]; }
  const std::string& unit(std::size_t objective) const { return model_.objective_units()[objective]; }
  bool logarithm(std::size_t objective) const { return is_logarithm(study_.objectives[objective].value); }
  std::string changed(std::size_t o, const DesignSheet& from, const DesignSheet& to) const {
    std::string text = change_text(from.objectives[o], to.objectives[o], logarithm(o));
    if (const std::size_t space = text.find(' '); space != text.npos) text.replace(space, 1, "\u00a0");
    return text;
  }
  // Of the first over the second.
  bool better(std::size_t o, const DesignSheet& a, const DesignSheet& b) const {
    return study_.objectives[o].maximise ? a.objectives[o] > b.objectives[o]
                                         : a.objectives[o] < b.objectives[o];
  }
  std::string device_name() const { return outcome_.start_moved ? "nearest to the device" : "device as it is"; }

  void section(const std::string& id, const std::string& title) {
    if (!contents_.empty()) body_ += "</section>\n";
    contents_.emplace_back(id, title);
    body_ += fmt::format("<section><h2 id=\"{}\">{}</h2>\n", id, escaped(title));
  }

  void paragraph(const std::string& text, const char* kind = "") {
    body_ +=
        fmt::format("<p{}>{}</p>\n", *kind != '\0' ? fmt::format(" class=\"{}\"", kind) : "", escaped(text));
  }

  void show(const std::string& of_section) {
    std::string cards;
    int count = 0;
    for (const SheetFigure& figure : figures_) {
      if (figure.section != of_section) continue;
      ++count;
      cards += fmt::format("<figure class=\"card\" id=\"{}\"><b>{}</b>{}<figcaption>{}</figcaption></figure>\n",
                           figure.id, escaped(figure.title), figure.svg, escaped(figure.caption));
    }
    // A figure by itself would grow as wide as the page; parallel coordinates may.
    const bool narrow = count == 1 && of_section != "parallel";
    if (count > 0) body_ += fmt::format("<div class=\"figures{}\">{}</div>\n", narrow ? " one" : "", cards);
  }

  void answer() {
    section("chosen", "The chosen design");
    body_ += "<div class=\"tiles\">";
    for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
      const StudyObjective& objective = study_.objectives[o];
      const std::string value = amount(chosen().objectives[o], unit(o));
      const std::size_t space = value.find(' ');
      body_ += fmt::format(
          "<div class=\"tile\"><b>{}{}</b><span>{}, to be {}</span>", escaped(value.substr(0, space)),
          space == value.npos ? "" : fmt::format(" <small>{}</small>", escaped(value.substr(space + 1))),
          escaped(objective.name), objective.maximise ? "large" : "small");
      if (outcome_.start && !std::isnan(outcome_.start->objectives[o])) {
        const bool same = outcome_.start->objectives[o] == chosen().objectives[o];
        body_ += fmt::format("<span{}>{} than the device: {}</span>",
                             same                                   ? ""
                             : better(o, chosen(), *outcome_.start) ? " class=\"ok\""
                                                                    : " class=\"no\"",
                             same                                   ? "not other"
                             : better(o, chosen(), *outcome_.start) ? "better"
                                                                    : "worse",
                             escaped(fmt::format("{} from {}", changed(o, *outcome_.start, chosen()),
                                                 amount(outcome_.start->objectives[o], unit(o)))));
      }
      body_ += "</div>";
    }
    body_ += "</div>\n";
    paragraph(fmt::format("Chosen as {}.", outcome_.choice), "how");
    if (outcome_.start) device_words();
    designs_beside();
  }

  void device_words() {
    std::vector<std::string> broken;
    for (std::size_t c = 0; c < study_.constraints.size(); ++c) {
      if (!(outcome_.start->violations[c] <= 0.0)) broken.push_back("“" + study_.constraints[c].name + "”");
    }
    std::string text;
    if (outcome_.start_moved) {
      text =
          "The device itself is no design of this study: a variable lies outside its bounds there, or has no "
          "key in "
          "the device and stands in its middle. What stands beside the chosen design is the nearest one. ";
    }
    if (!outcome_.start->built) {
      text += "It cannot be built, or something asked of it is undefined.";
    } else if (!broken.empty()) {
      text += fmt::format("{} breaks {}.", outcome_.start_moved ? "It" : "The device as it is", listed(broken));
    } else if (!study_.constraints.empty()) {
      text += fmt::format("{} meets all constraints.", outcome_.start_moved ? "It" : "The device as it is");
    }
    if (!text.empty()) paragraph(text);
  }

  struct Column {
    std::string title;
    const DesignSheet* sheet;
  };

  // The device, the chosen design, the knee and the best of each objective; one column for designs that
  // coincide.
  std::vector<Column> columns() const {
    std::vector<Column> list;
    const auto add = [&](const std::string& title, std::size_t row) {
      const DesignSheet* sheet = &outcome_.front[row];
      const auto known =
          std::find_if(list.begin(), list.end(), [&](const Column& one) { return one.sheet == sheet; });
      if (known != list.end()) {
        known->title += ", " + title;
      } else {
        list.push_back({title, sheet});
      }
    };
    add("chosen", *outcome_.chosen);
    if (const auto row = outcome_.knee_row()) add("the knee", *row);
    if (study_.objectives.size() > 1) {
      for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
        add("best " + study_.objectives[o].name, outcome_.best(o));
      }
    }
    if (outcome_.start) list.insert(list.begin(), {device_name(), &*outcome_.start});
    return list;
  }

  // Whether a variable stands at an end of its range, where a wider one might give better designs.
  const char* at_bound(std::size_t v) const {
    const SearchVariable& variable = outcome_.problem.variables[v];
    const double value = outcome_.design(*outcome_.chosen)[v], range = variable.max - variable.min;
    constexpr double kAt = 0.002;  // of the range
    if (!study_.variables[v].parts.empty() || !(range > 0.0)) return "";
    if (value - variable.min <= kAt * range) return "at its least";
    return variable.max - value <= kAt * range ? "at its most" : "";
  }

  void designs_beside() {
    const std::vector<Column> beside = columns();
    std::vector<Cell> head{{""}};
    for (const Column& one : beside) head.push_back({one.title, "r"});
    std::vector<std::vector<Cell>> rows;
    rows.push_back({{"Objectives"}});
    for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
      std::vector<Cell> row{{study_.objectives[o].name}};
      for (const Column& one : beside) row.push_back({amount(one.sheet->objectives[o], unit(o)), "n"});
      rows.push_back(std::move(row));
    }
    rows.push_back({{"Variables"}});
    bool any_at_bound = false;
    for (std::size_t v = 0; v < study_.variables.size(); ++v) {
      std::vector<Cell> row{{study_.variables[v].name, "", at_bound(v)}};
      any_at_bound = any_at_bound || !row.front().tag.empty();
      for (const Column& one : beside)
        row.push_back({value_text(one.sheet->variables[v]), study_.variables[v].parts.empty() ? "n" : "r"});
      rows.push_back(std::move(row));
    }
    if (!study_.constraints.empty()) rows.push_back({{"Constraints"}});
    for (std::size_t c = 0; c < study_.constraints.size(); ++c) {
      std::vector<Cell> row{{study_.constraints[c].name}};
      for (const Column& one : beside) {
        const bool holds = one.sheet->violations[c] <= 0.0;
        row.push_back({amount(one.sheet->constraints[c], model_.constraint_units()[c]) + (holds ? "" : " ✗"),
                       holds ? "n" : "n no"});
      }
      rows.push_back(std::move(row));
    }
    body_ += table(head, rows);
    if (any_at_bound) {
      paragraph("A variable at the end of its range asks for a wider one, if the device allows it.", "how");
    }
    if (chosen().derived.empty()) return;
    rows.clear();
    for (std::size_t d = 0; d < chosen().derived.size(); ++d) {
      std::vector<Cell> row{{chosen().derived[d].name}};
      for (const Column& one : beside) row.push_back({value_text(one.sheet->derived[d]), "n"});
      rows.push_back(std::move(row));
    }
    body_ +=
        fmt::format("<details><summary>What follows: derived values and measures ({})</summary>{}</details>\n",
                    chosen().derived.size(), table(head, rows));
  }

  void trade_off() {
    section("front", "The trade-off");
    const std::size_t n = study_.objectives.size();
    if (outcome_.front.size() == 1) {
      paragraph("One design is best in every objective at once: there is nothing to trade.");
      return;
    }
    std::string text =
        fmt::format("{} designs remain that no other beats in all objectives at once.", outcome_.front.size());
    if (outcome_.knee_row() == outcome_.chosen) {
      text += " The chosen one is the knee: beyond it, a little more of one objective costs much of another.";
    }
    paragraph(text);
    std::string items;
    for (std::size_t a = 0; a < n; ++a) {
      const StudyObjective& objective = study_.objectives[a];
      const DesignSheet& best = outcome_.front[outcome_.best(a)];
      std::string item = fmt::format("<b>{}</b> {} at best", escaped(objective.name),
                                     escaped(amount(best.objectives[a], unit(a))));
      if (&best == &chosen()) {
        items += fmt::format("<li>{}: the chosen design.</li>\n", item);
        continue;
      }
      item += fmt::format(", {} beside the chosen design's {}", escaped(changed(a, chosen(), best)),
                          escaped(amount(chosen().objectives[a], unit(a))));
      std::vector<std::string> costs;
      for (std::size_t b = 0; b < n; ++b) {
        if (b == a || !better(b, chosen(), best)) continue;
        costs.push_back(fmt::format("{} {} instead of {} ({})", study_.objectives[b].name,
                                    amount(best.objectives[b], unit(b)),
                                    amount(chosen().objectives[b], unit(b)), changed(b, chosen(), best)));
      }
      items += fmt::format("<li>{}. {}</li>\n", item,
                           costs.empty() ? "It costs nothing." : escaped("It costs: " + listed(costs) + "."));
    }
    body_ += "<ul>" + items + "</ul>\n";
    if (n == 2) along_the_set();
    show("front");
    show("parallel");
  }

  // Which variables go along with the first objective, from one end of the set to the other.
  void along_the_set() {
    constexpr std::size_t kEnough = 8;
    if (outcome_.front.size() < kEnough) return;
    std::vector<std::size_t> order(outcome_.front.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return better(0, outcome_.front[b], outcome_.front[a]);
    });
    std::vector<std::string> moving, still;
    for (std::size_t v = 0; v < study_.variables.size(); ++v) {
      if (!study_.variables[v].parts.empty()) continue;
      const SearchVariable& variable = outcome_.problem.variables[v];
      std::vector<double> values;
      for (const std::size_t row : order) values.push_back(outcome_.design(row)[v]);
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      constexpr double kStill = 0.05;  // of the range
      if (*most - *least <= kStill * (variable.max - variable.min)) {
        still.push_back(fmt::format("{} near {}", variable.name, value_text(chosen().variables[v])));
        continue;
      }
      // Kendall's tau: the share of pairs that rise, less that of those that fall.
      double rising = 0.0, pairs = 0.0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        for (std::size_t j = i + 1; j < values.size(); ++j, pairs += 1.0) {
          rising += values[j] > values[i] ? 1.0 : values[j] < values[i] ? -1.0 : 0.0;
        }
      }
      constexpr double kClear = 0.5;
      if (std::abs(rising) < kClear * pairs) continue;
      moving.push_back(fmt::format("{} {} from {} to {}", variable.name, rising > 0.0 ? "grows" : "shrinks",
                                   value_text(outcome_.front[order.front()].variables[v]),
                                   value_text(outcome_.front[order.back()].variables[v])));
    }
    std::string text;
    if (!moving.empty()) {
      text = fmt::format("From the best {} to the best {}, {}.", study_.objectives[1].name,
                         study_.objectives[0].name, listed(moving));
    }
    if (!still.empty())
      text += fmt::format("{}All along the set stay {}.", text.empty() ? "" : " ", listed(still));
    if (!text.empty()) paragraph(text);
  }

  void constraints() {
    const std::vector<ConstraintActivity> activity = constraint_activity(outcome_, model_);
    if (activity.empty()) return;
    section("constraints", "Which constraints decide");
    std::vector<std::string> active, still;
    std::vector<std::vector<Cell>> rows;
    for (std::size_t c = 0; c < activity.size(); ++c) {
      const ConstraintActivity& one = activity[c];
      // A share that has reached 1, say, is at its limit whatever the design's neighbours are.
      const bool moves = !outcome_.sensitivity || outcome_.sensitivity->moves(study_.objectives.size() + c);
      if (one.active) (moves ? active : still).push_back("“" + one.name + "”");
      rows.push_back({{one.name, "", one.active ? "at its limit" : ""},
                      {one.value, "n"},
                      {one.limit, "n"},
                      {one.active ? "–" : one.margin, "n"},
                      {one.broken_by}});
    }
    std::string text = active.empty()
                           ? "No constraint holds the design back: the objectives alone do."
                           : fmt::format("At {} limit: {}. Whoever can relax {} may find better designs.",
                                         active.size() == 1 ? "its" : "their", listed(active),
                                         active.size() == 1 ? "it" : "one of them");
    if (!still.empty()) {
      text += fmt::format(" {} {} at {} limit{}, but no small change moves {}.", listed(still),
                          still.size() == 1 ? "is" : "are", still.size() == 1 ? "its" : "their",
                          active.empty() ? "" : " too", still.size() == 1 ? "it" : "them");
    }
    paragraph(text);
    body_ +=
        table({{"constraint"}, {"value", "n"}, {"limit", "n"}, {"to spare", "n"}, {"used up first by"}}, rows);
  }

  void sensitivity() {
    const ChosenSensitivity& found = *outcome_.sensitivity;
    const std::vector<std::size_t> told = found.told();
    if (told.empty()) return;
    section("sensitivity", "What small changes do");
    show("sensitivity");
    show("steps");
    if (!found.smooth.empty()) {
      std::vector<Cell> head{{"change of"}, {"from", "n"}};
      std::vector<Cell> grown{{"a variable grows by 1 % of its range"}, {"", "n"}};
      for (const std::size_t v : found.smooth) {
        const SearchVariable& variable = outcome_.problem.variables[v];
        head.push_back({variable.name, "n"});
        grown.push_back(
            {step_text(chosen().variables[v], ChosenSensitivity::kPart * (variable.max - variable.min)), "n"});
      }
      std::vector<std::vector<Cell>> rows{grown};
      for (const std::size_t f : told) {
        if (!found.slides(f)) continue;
        std::vector<Cell> row{{found.figures[f].name}, {amount(found.values[f], found.figures[f].unit), "n"}};
        for (std::size_t i = 0; i < found.smooth.size(); ++i) {
          row.push_back({change_text(found.values[f], found.grown[i][f], found.figures[f].logarithm), "n"});
        }
        rows.push_back(std::move(row));
      }
      body_ += table(head, rows);
    }
    if (!found.steps.empty()) steps(told);
  }

  void steps(const std::vector<std::size_t>& told) {
    const ChosenSensitivity& found = *outcome_.sensitivity;
    std::vector<Cell> head{{"change of"}, {"from", "n"}};
    std::vector<Cell> feasible{{"meets all constraints"}, {"✓", "n ok"}};
    std::vector<std::vector<Cell>> rows;
    for (const ChosenSensitivity::Step& step : found.steps) {
      for (const std::size_t side : {0U, 1U}) {
        if (step.value[side].empty()) continue;
        head.push_back({fmt::format("{} {}", study_.variables[step.variable].name, step.value[side]), "r"});
        feasible.push_back({step.feasible[side] ? "✓" : "✗", step.feasible[side] ? "n ok" : "n no"});
      }
    }
    rows.push_back(feasible);
    for (const std::size_t f : told) {
      std::vector<Cell> row{{found.figures[f].name}, {amount(found.values[f], found.figures[f].unit), "n"}};
      for (const ChosenSensitivity::Step& step : found.steps) {
        for (const std::size_t side : {0U, 1U}) {
          if (step.value[side].empty()) continue;
          row.push_back({change_text(found.values[f], step.figures[side][f], found.figures[f].logarithm), "n"});
        }
      }
      rows.push_back(std::move(row));
    }
    body_ += table(head, rows);
  }

  void tolerances() {
    section("tolerances", "What tolerances do");
    paragraph(fmt::format("{} devices as they might be made, each with {}.", outcome_.tolerances->samples,
                          tolerance_words(study_)));
    std::vector<std::vector<Cell>> rows;
    for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
      const OutcomeSpread& spread = outcome_.tolerances->outcomes[o];
      rows.push_back({{study_.objectives[o].name},
                      {amount(spread.nominal, unit(o)), "n"},
                      {amount(spread.mean.value, unit(o)), "n"},
                      {amount(deviation_of(spread), unit(o)), "n"},
                      {amount(spread.percentile_5.value, unit(o)), "n"},
                      {amount(spread.percentile_95.value, unit(o)), "n"}});
    }
    body_ += table({{"objective"},
                    {"as designed", "n"},
                    {"mean", "n"},
                    {"standard deviation", "n"},
                    {"5 % lie below", "n"},
                    {"5 % lie above", "n"}},
                   rows);
    if (study_.constraints.empty()) return;
    const Estimate& broken = outcome_.tolerances->broken;
    paragraph(fmt::format("Of the devices made, {} break a constraint ({} to {} with 95 % confidence).",
                          quantity(broken.value, 100.0, "%", 3), quantity(broken.low, 100.0, "%", 2),
                          quantity(broken.high, 100.0, "%", 2)));
  }

  void nothing() {
    section("chosen", "No design meets all constraints");
    std::vector<std::vector<Cell>> rows;
    for (std::size_t c = 0; c < outcome_.result.constraints.size(); ++c) {
      const ConstraintRecord& record = outcome_.result.constraints[c];
      const bool yes_or_no = c == 0;  // "can be built"
      rows.push_back({{outcome_.problem.constraints[c], "", record.held == 0 ? "never met" : ""},
                      {fmt::format("{}", record.held), "n"},
                      {yes_or_no || record.held > 0            ? ""
                       : std::isfinite(record.least_violation) ? number(record.least_violation)
                                                               : "undefined",
                       "n"}});
    }
    paragraph(fmt::format("Of {} designs:", outcome_.result.evaluations));
    body_ += table({{"constraint"}, {"met by", "n"}, {"least violation", "n"}}, rows);
  }

  void search() {
    section("search", "The search");
    const SearchAlgorithmInfo& algorithm = info(outcome_.options.algorithm);
    const std::vector<Generation>& history = outcome_.result.history;
    std::string text = fmt::format("{}: {} designs", algorithm.what, outcome_.result.evaluations);
    if (outcome_.options.algorithm != SearchAlgorithm::grid) {
      text += fmt::format(" in {} generations of {}, seed {}; {}", history.empty() ? 0 : history.back().number,
                          outcome_.options.population, outcome_.options.seed, to_words(outcome_.result.end));
    }
    paragraph(text + ".");
    if (!outcome_.obstacles.empty()) {
      std::string items;
      for (const CountedObstacle& one : outcome_.obstacles) {
        items += fmt::format("<li>{}</li>", escaped(obstacle_text(one, outcome_.looked_at)));
      }
      body_ += fmt::format(
          "<details><summary>What was undefined in some designs ({})</summary><ul>{}</ul></details>\n",
          outcome_.obstacles.size(), items);
    }
    show("search");
  }

  const StudyOutcome& outcome_;
  const StudyModel& model_;
  const Study& study_;
  const std::vector<SheetFigure>& figures_;
  std::vector<std::pair<std::string, std::string>> contents_;
  std::string body_;
};

}  // namespace

std::string outcome_page(const StudyOutcome& outcome, const StudyModel& model,
                         const std::vector<SheetFigure>& figures) {
  return OutcomePage(outcome, model, figures).write();
}

}  // namespace zwidth
