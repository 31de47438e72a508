#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "figure/parallel.h"
#include "figure/plot.h"
#include "figure/tornado.h"
#include "optimise/outcome_page.h"

namespace zwidth {

namespace {

constexpr double kWidth = 460.0, kHeight = 320.0;
constexpr std::size_t kMostLines = 250;  // in parallel coordinates
constexpr std::size_t kMostBars = 12;

std::string power_of_ten(int exponent) {
  static constexpr const char* kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : fmt::format("{}", std::abs(exponent))) text += kRaised[digit - '0'];
  return text;
}

// An axis for SI values, in a unit that gives them few digits.
struct ScaledAxis {
  Axis axis;
  double factor = 1.0;
};

ScaledAxis axis_of(const std::string& name, const std::string& unit, Interval range) {
  const double most = std::max(std::abs(range.min), std::abs(range.max));
  const ReadableUnit readable = readable_unit(most, unit);
  ScaledAxis scaled{.axis = {.label = name, .range = {}}, .factor = readable.factor};
  std::string text = readable.text;
  constexpr double kManyTimes = 30.0;
  const bool logarithmic = range.min > 0.0 && range.max > kManyTimes * range.min;
  const double size = most * readable.factor;
  if (!logarithmic && size > 0.0 && (size < 1e-2 || size >= 1e5)) {
    const int exponent = 3 * static_cast<int>(std::floor(std::log10(size) / 3.0));
    scaled.factor *= std::pow(10.0, -exponent);
    text = power_of_ten(exponent) + (text.empty() ? std::string() : fmt::format(" {}", text));
  }
  if (!text.empty()) scaled.axis.label += fmt::format(" [{}]", text);
  const double low = range.min * scaled.factor, high = range.max * scaled.factor;
  scaled.axis.logarithmic = logarithmic;
  if (logarithmic) {
    scaled.axis.range = {low / 1.2, high * 1.2};
  } else {
    // Values that differ by rounding alone are one.
    const double same = std::max(1e-12, 1e-9 * std::abs(high));
    const double room = high - low > same ? 0.06 * (high - low) : std::max(same, 0.05 * std::abs(low));
    scaled.axis.range = {low - room, high + room};
  }
  return scaled;
}

class Drawings {
 public:
  Drawings(const StudyOutcome& outcome, const StudyModel& model)
      : outcome_(outcome), model_(model), study_(model.study()) {}

  std::vector<SheetFigure> all() {
    fronts();
    parallel();
    if (outcome_.sensitivity) tornados();
    progress();
    return std::move(figures_);
  }

 private:
  Interval range_of(std::size_t objective) const {
    Interval range{HUGE_VAL, -HUGE_VAL};
    for (const DesignSheet& sheet : outcome_.front) {
      range = {std::min(range.min, sheet.objectives[objective]),
               std::max(range.max, sheet.objectives[objective])};
    }
    return range;
  }

  // Whether the device itself is near enough to the front to be drawn with it.
  static bool joins(double value, Interval& range) {
    constexpr double kFar = 2.0;  // widths of the front
    const Interval with{std::min(range.min, value), std::max(range.max, value)};
    if (!std::isfinite(value) || with.width() > (1.0 + kFar) * range.width()) return false;
    range = with;
    return true;
  }

  void fronts() {
    const std::size_t n = study_.objectives.size();
    if (outcome_.front.empty() || n < 2) return;
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) front(a, b);
    }
  }

  void front(std::size_t a, std::size_t b) {
    Interval along = range_of(a), up = range_of(b);
    bool with_start = false;
    if (outcome_.start) {
      Interval along_all = along, up_all = up;
      with_start =
          joins(outcome_.start->objectives[a], along_all) && joins(outcome_.start->objectives[b], up_all);
      if (with_start) along = along_all, up = up_all;
    }
    const StudyObjective &first = study_.objectives[a], &second = study_.objectives[b];
    const ScaledAxis x = axis_of(first.name, model_.objective_units()[a], along);
    const ScaledAxis y = axis_of(second.name, model_.objective_units()[b], up);
    Plot plot(kWidth, kHeight, x.axis, y.axis);
    const auto at = [&](const DesignSheet& sheet) {
      return Point2{sheet.objectives[a] * x.factor, sheet.objectives[b] * y.factor};
    };
    std::vector<Point2> points;
    for (const DesignSheet& sheet : outcome_.front) points.push_back(at(sheet));
    plot.dots(points, 1);
    // One name for marks that coincide.
    const DesignSheet* device = with_start ? &*outcome_.start : nullptr;
    const auto mark = [&](const DesignSheet& sheet, std::string name, int series) {
      const bool is_device = device != nullptr && device->objectives == sheet.objectives;
      if (is_device) {
        name += ", device";
        device = nullptr;
      }
      plot.mark(at(sheet), name, series);
    };
    const auto bend = outcome_.knee_row();
    if (outcome_.chosen) mark(outcome_.front[*outcome_.chosen], "chosen", 2);
    if (bend && bend != outcome_.chosen) mark(outcome_.front[*bend], "knee", 3);
    if (device != nullptr) plot.mark(at(*device), "device", 4);
    std::string caption = fmt::format("Better is to the {} {}.", second.maximise ? "upper" : "lower",
                                      first.maximise ? "right" : "left");
    if (study_.objectives.size() > 2) {
      caption +=
          " All objectives together decide what belongs to the set, so its shadow on two of them is no line.";
    }
    if (with_start && !outcome_.start->feasible) caption += " The device breaks constraints.";
    if (outcome_.start && !with_start) {
      const bool defined =
          std::isfinite(outcome_.start->objectives[a]) && std::isfinite(outcome_.start->objectives[b]);
      caption += defined ? " The device lies far outside." : " The device has no value here.";
    }
    const std::string title = fmt::format("{} against {}", second.name, first.name);
    figures_.push_back({.id = fmt::format("front-{}-{}", a + 1, b + 1),
                        .section = "front",
                        .title = title,
                        .caption = caption,
                        .svg = plot.svg(title)});
  }

  // Every figure over its own range along the set, the better end of an objective up.
  void parallel() {
    if (outcome_.front.size() < 2) return;
    std::vector<std::size_t> rows;
    const std::size_t step = outcome_.front.size() / kMostLines + 1;
    for (std::size_t row = 0; row < outcome_.front.size(); ++row) {
      if (row % step == 0 || row == outcome_.chosen) rows.push_back(row);
    }
    std::vector<ParallelAxis> axes;
    const auto add = [&](const std::string& name, bool strong, bool small_is_better, auto value, auto text) {
      double least = HUGE_VAL, most = -HUGE_VAL;
      for (const DesignSheet& sheet : outcome_.front) {
        least = std::min(least, value(sheet));
        most = std::max(most, value(sheet));
      }
      ParallelAxis axis{.name = name, .low = text(least), .high = text(most), .shares = {}, .strong = strong};
      if (small_is_better) std::swap(axis.low, axis.high);
      if (axis.low == axis.high) axis.low.clear();
      for (const std::size_t row : rows) {
        const double share = most > least ? (value(outcome_.front[row]) - least) / (most - least) : 0.5;
        axis.shares.push_back(small_is_better ? 1.0 - share : share);
      }
      axes.push_back(std::move(axis));
    };
    for (std::size_t v = 0; v < study_.variables.size(); ++v) {
      add(
          study_.variables[v].name, false, false,
          [v](const DesignSheet& sheet) { return sheet.variables[v].value; },
          [&](double value) {
            DesignValue shown = outcome_.front.front().variables[v];
            shown.value = value;
            if (!shown.part.empty()) shown.part = study_.variables[v].parts[static_cast<std::size_t>(value)];
            return value_text(shown);
          });
    }
    for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
      add(
          study_.objectives[o].name, true, !study_.objectives[o].maximise,
          [o](const DesignSheet& sheet) { return sheet.objectives[o]; },
          [&](double value) { return readable(value, model_.objective_units()[o], 3); });
    }
    std::optional<std::size_t> marked;
    if (outcome_.chosen) {
      marked = static_cast<std::size_t>(std::find(rows.begin(), rows.end(), *outcome_.chosen) - rows.begin());
    }
    if (axes.size() < 2) return;
    const double width = std::max(2.0 * kWidth, 104.0 * static_cast<double>(axes.size()));
    const std::string title = "Parallel coordinates";
    figures_.push_back(
        {.id = "parallel-coordinates",
         .section = "parallel",
         .title = title,
         .caption = "One line per design of the set, the chosen one thick. Objectives stand at the right, "
                    "their better end up: lines that cross there are a trade-off.",
         .svg = parallel_coordinates(width, 0.8 * kHeight, axes, marked, title)});
  }

  // What each variable does to each objective: those with any value, then those with steps or parts.
  void tornados() {
    const ChosenSensitivity& found = *outcome_.sensitivity;
    const DesignSheet& chosen = outcome_.front[*outcome_.chosen];
    for (std::size_t o = 0; o < study_.objectives.size(); ++o) {
      const StudyObjective& objective = study_.objectives[o];
      const auto bar = [&](std::string name, std::string note, double after) {
        const double change = after - found.values[o];
        return TornadoBar{.name = std::move(name),
                          .note = std::move(note),
                          .change = change,
                          .text = change_text(found.values[o], after, found.figures[o].logarithm),
                          .better = objective.maximise == (change > 0.0)};
      };
      std::vector<TornadoBar> bars;
      for (std::size_t i = 0; i < found.smooth.size(); ++i) {
        const SearchVariable& variable = outcome_.problem.variables[found.smooth[i]];
        bars.push_back(bar(variable.name,
                           step_text(chosen.variables[found.smooth[i]],
                                     ChosenSensitivity::kPart * (variable.max - variable.min)),
                           found.grown[i][o]));
      }
      add_tornado(o, "sensitivity", "One per cent of its range more of each variable.", std::move(bars));
      bars.clear();
      bool parts = false;
      for (const ChosenSensitivity::Step& step : found.steps) {
        const DesignValue& now = chosen.variables[step.variable];
        parts = parts || !now.part.empty();
        for (const std::size_t side : {0U, 1U}) {
          if (step.value[side].empty()) continue;
          TornadoBar one = bar(fmt::format("{} {}", now.name, step.value[side]), "", step.figures[side][o]);
          if (!step.feasible[side]) one.text += " ✗";
          bars.push_back(std::move(one));
        }
      }
      add_tornado(
          o, "steps",
          fmt::format("One step of each variable{}. ✗ breaks a constraint.", parts ? ", or another part" : ""),
          std::move(bars));
    }
  }

  void add_tornado(std::size_t o, const std::string& section, const std::string& caption,
                   std::vector<TornadoBar> bars) {
    const auto size = [](const TornadoBar& one) {
      return std::isnan(one.change) ? -1.0 : std::abs(one.change);
    };
    std::stable_sort(bars.begin(), bars.end(),
                     [&](const TornadoBar& a, const TornadoBar& b) { return size(a) > size(b); });
    // What does nothing is said, not drawn.
    const auto none =
        std::find_if(bars.begin(), bars.end(), [&](const TornadoBar& one) { return size(one) == 0.0; });
    std::string still;
    for (auto one = none; one != bars.end() && size(*one) == 0.0; ++one) {
      still += fmt::format("{}{}", still.empty() ? "" : ", ", one->name);
    }
    bars.erase(none, std::find_if(none, bars.end(), [&](const TornadoBar& one) { return size(one) < 0.0; }));
    if (bars.empty() || size(bars.front()) < 0.0) return;
    const std::size_t left_out = bars.size() > kMostBars ? bars.size() - kMostBars : 0;
    bars.resize(bars.size() - left_out);
    const StudyObjective& objective = study_.objectives[o];
    const std::string title = fmt::format("{} ({})", objective.name,
                                          amount(outcome_.sensitivity->values[o], model_.objective_units()[o]));
    figures_.push_back({.id = fmt::format("{}-{}", section, o + 1),
                        .section = section,
                        .title = title,
                        .caption = fmt::format("{} Green is better, red is worse.{}{}", caption,
                                               left_out > 0 ? fmt::format(" {} more do less.", left_out) : "",
                                               still.empty() ? "" : fmt::format(" No change by: {}.", still)),
                        .svg = tornado(kWidth, bars, fmt::format("What changes {}", objective.name))});
  }

  void progress() {
    const bool several = study_.objectives.size() > 1;
    const std::vector<Generation>& history = outcome_.result.history;
    std::vector<Point2> growth;
    for (const Generation& one : history) {
      if (std::isfinite(one.hypervolume)) growth.push_back({static_cast<double>(one.number), one.hypervolume});
    }
    if (growth.size() < 2) return;
    ScaledAxis y;
    if (several) {
      const double last = growth.back().y;
      if (!(last > 0.0)) return;
      for (Point2& point : growth) point.y *= 100.0 / last;
      y = axis_of("hypervolume, % of the last", "", {.min = 0.0, .max = 100.0});
    } else {
      // What is kept is how far the best lies below the reference.
      const StudyObjective& objective = study_.objectives.front();
      Interval range{HUGE_VAL, -HUGE_VAL};
      for (Point2& point : growth) {
        point.y = (objective.maximise ? -1.0 : 1.0) * (outcome_.result.reference.front() - point.y);
        range = {std::min(range.min, point.y), std::max(range.max, point.y)};
      }
      y = axis_of(fmt::format("best {}", objective.name), model_.objective_units().front(), range);
      for (Point2& point : growth) point.y *= y.factor;
    }
    if (several) {
      const auto [low, high] = std::minmax_element(growth.begin(), growth.end(),
                                                   [](const Point2& a, const Point2& b) { return a.y < b.y; });
      const double room = std::max(0.5, 0.06 * (high->y - low->y));
      y.axis.range = {low->y - room, high->y + room};
    }
    Plot plot(kWidth, kHeight, {.label = "generation", .range = {0.0, growth.back().x}}, y.axis);
    plot.line(growth, 1);
    figures_.push_back(
        {.id = "hypervolume",
         .section = "search",
         .title = several ? "Growth of the set" : "The best design so far",
         .caption = growth.front().x > 0.0
                        ? fmt::format("From generation {} on, when enough designs met all "
                                      "constraints. Flat at the end: more generations would find "
                                      "little.",
                                      growth.front().x)
                        : "Flat at the end: more generations would find little.",
         .svg = plot.svg("Progress of the search over its generations")});
  }

  const StudyOutcome& outcome_;
  const StudyModel& model_;
  const Study& study_;
  std::vector<SheetFigure> figures_;
};

}  // namespace

std::vector<SheetFigure> outcome_drawings(const StudyOutcome& outcome, const StudyModel& model) {
  return Drawings(outcome, model).all();
}

}  // namespace zwidth
