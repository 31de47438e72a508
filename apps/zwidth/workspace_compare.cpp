#include <array>
#include <fmt/format.h>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "at/goal.h"
#include "interrupt.h"
#include "sheet_arm.h"
#include "workspace_verb.h"

#include "zwidth/analysis/comparison.h"
#include "zwidth/analysis/reach.h"
#include "zwidth/description/units.h"

namespace zwidth {

namespace {

/// "x, y and z".
std::string axes_text(const std::vector<int>& axes) {
  std::string text;
  for (size_t k = 0; k < axes.size(); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : k + 1 == axes.size() ? " and " : ", ", "xyz"[axes[k]]);
  return text;
}

/// What counts as reached, for tools that turn; empty for others.
std::string orientation_rule(const Mechanism& mechanism, const std::string& name,
                             const std::optional<Matrix3>& orientation) {
  if (!workspace_obstacle(mechanism)) return {};
  const bool platform = reach_obstacle(mechanism).has_value();
  if (platform && orientation)
    return fmt::format("{}: in one orientation ({}).", name, orientation_text(*orientation));
  return fmt::format("{}: in any orientation of its tool{}.", name,
                     platform ? " that it can be led to from home" : "");
}

}  // namespace

int compare(const WorkspaceArguments& arguments, const Model& model, double spacing, const Terminal& terminal) {
  DeviceArguments wanted;
  wanted.device = arguments.against;
  const Model other(without_hand_joints(read_device(wanted)));
  const std::string first = model.description.name, second = other.description.name == first
                                                                 ? other.description.name + " (as it comes)"
                                                                 : other.description.name;
  if (const auto obstacle = comparison_obstacle(model.mechanism))
    throw InputError(fmt::format("{}: {}", arguments.device, *obstacle));
  if (const auto obstacle = comparison_obstacle(other.mechanism))
    throw InputError(fmt::format("--against {}: {}", arguments.against, *obstacle));
  const std::vector<int> axes = comparison_axes(model.mechanism), others = comparison_axes(other.mechanism);
  if (axes != others) {
    throw InputError(
        fmt::format("--against {}: the tool of {} moves along {}, that of {} along {}; compare two "
                    "whose tools move along the same axes",
                    arguments.against, first, axes_text(axes), second, axes_text(others)));
  }
  ComparisonOptions options{.spacing = spacing};
  if (!arguments.orientation.empty() || !arguments.rotation.empty())
    options.orientation = at::orientation_given(arguments.orientation, arguments.rotation);
  const bool plane = axes.size() == 2;
  WorkspaceComparison comparison;
  try {
    StagedProgress progress(&stop_on_interrupt());
    comparison = compare_workspaces(model.mechanism, other.mechanism, options, progress.next(1.0));
  } catch (const std::length_error& error) {
    throw InputError(fmt::format("--grid {}: {}; take a coarser grid", arguments.grid, error.what()));
  }
  const std::array<std::pair<const char*, Measure>, 5> figures = {{{"first", comparison.first},
                                                                   {"second", comparison.second},
                                                                   {"both", comparison.both},
                                                                   {"only_first", comparison.only_first},
                                                                   {"only_second", comparison.only_second}}};
  if (!comparison.complete) complain("stopped before the end: the figures cover a part of the workspace only");
  const int exit = comparison.complete ? kDone : kNo;
  if (arguments.json) {
    Json document;
    document["device"] = first;
    document["against"] = other.description.name;
    document["grid"] = json_number(comparison.spacing);
    document["complete"] = comparison.complete;
    document["measure"] = plane ? "area" : "volume";
    for (const auto& [key, measure] : figures)
      document[key] = {{"value", json_number(measure.value)}, {"error", json_number(measure.error)}};
    document["gain"] = json_number(comparison.gain());
    print_json(document);
    return exit;
  }
  Sheet sheet(terminal);
  sheet.title(fmt::format("{} against {}", first, second),
              fmt::format("common cells of {}", format_quantity(comparison.spacing, Dimension::length)));
  const double factor = plane ? 1e4 : 1e6;
  const char* unit = plane ? "cm²" : "cm³";
  const std::array<std::string, 5> names = {first, second, "both", "only " + first, "only " + second};
  std::vector<std::vector<std::string>> rows;
  for (size_t f = 0; f < figures.size(); ++f) {
    const Measure& measure = figures[f].second;
    rows.push_back({names[f], quantity(measure.value, factor, unit, 5),
                    "± " + quantity(measure.error, factor, unit, 2),
                    comparison.second.value > 0.0
                        ? fmt::format("{} %", number(100.0 * measure.value / comparison.second.value, 4))
                        : "–"});
  }
  sheet.table({plane ? "reachable area" : "reachable volume", "", "", "of " + second}, rows);
  for (const std::string& rule : {orientation_rule(model.mechanism, first, options.orientation),
                                  orientation_rule(other.mechanism, second, options.orientation)}) {
    if (!rule.empty()) sheet.paragraph(rule, 2, Tint::dim);
  }
  print(sheet.text());
  return exit;
}

}  // namespace zwidth
