#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "at/goal.h"
#include "gnuplot.h"
#include "interrupt.h"
#include "mechanics.h"
#include "sheet_arm.h"
#include "workspace_verb.h"

#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/description/units.h"

namespace zwidth {

namespace {

/// Cuts through the place where the search began, with their conditioning and outlines.
void draw(const Model& model, const PoseWorkspace& workspace, const std::string& path) {
  double most = 0.0;
  for (const ReachSlice& cut : workspace.slices) {
    for (const double value : cut.conditioning.values)
      if (std::isfinite(value)) most = std::max(most, value);
  }
  const bool plane = workspace.slices.size() == 1;
  double height = 860.0, width = 1000.0;
  if (plane) {
    const PlaneGrid& grid = workspace.slices.front().conditioning;
    width = 760.0;
    height = std::round(570.0 * grid.v.width() / std::max(1e-12, grid.u.width()) + 130.0);
  }
  std::string script = gnuplot_terminal(path, width, height);
  const std::string title =
      fmt::format("{} in one orientation ({}): 1/(condition number){}", model.description.name,
                  orientation_text(workspace.orientation), plane ? "" : " on three cuts");
  if (!plane) {
    script += fmt::format("set multiplot layout 2,2 margins 0.08,0.95,0.08,0.92 spacing 0.13,0.12 title '{}'\n",
                          title);
  }
  script += fmt::format(
      "{}set cbrange [0:{:g}]\nset size ratio -1\nset grid front lc rgb '#dddddd'\nset border lc rgb "
      "'#888888'\nset tics textcolor rgb '#444444'\nunset key\n",
      gnuplot_palette(), most > 0.0 ? most : 1.0);
  for (auto cut = workspace.slices.rbegin(); cut != workspace.slices.rend(); ++cut)
    script += gnuplot_cut(*cut, cut->slice.axis);
  run_gnuplot(script + (plane ? "" : "unset multiplot\n"));
}

WorkspaceMap map_of(const PoseWorkspace& workspace) {
  return {.spacing = workspace.spacing, .complete = workspace.complete, .positions = workspace.places};
}

}  // namespace

int platform_workspace(const WorkspaceArguments& arguments, const Model& model, double spacing,
                       const Terminal& terminal) {
  if (arguments.of != "condition_number")
    throw InputError(fmt::format("--of {}: is for tools that do not turn; leave it out", arguments.of));
  const Mechanism& mechanism = model.mechanism;
  PoseWorkspaceOptions options{.spacing = spacing};
  options.any_places = 4000;
  if (arguments.figure.empty()) options.slice_points = 0;
  if (!arguments.orientation.empty() || !arguments.rotation.empty())
    options.orientation = at::orientation_given(arguments.orientation, arguments.rotation);
  if (!arguments.position.empty()) {
    const ParsedQuantities at =
        parse_quantity_list(arguments.position, std::vector<Dimension>(3, Dimension::length));
    if (!at) throw InputError(fmt::format("--position \"{}\": {}; {}", arguments.position, at.rule, at.advice));
    options.position = Vector3(at.values[0], at.values[1], at.values[2]);
  }
  if (model.has_drives()) {
    options.torque = [&model](const Posture& posture) {
      return torque_range(model.drives, model.pneumatic_drives, posture.active(), false);
    };
  }
  StagedProgress progress(&stop_on_interrupt());
  PoseWorkspace workspace;
  try {
    workspace = pose_workspace(mechanism, options, progress.next(0.95));
  } catch (const std::length_error& error) {
    throw InputError(fmt::format("--grid {}: {}; take a coarser grid", arguments.grid, error.what()));
  }
  if (!workspace.complete) {
    complain("stopped before the end");
    return kNo;
  }
  if (workspace.reached && !workspace.unbounded && workspace.dimension() > 0) {
    bool wide = workspace.inside == 0;
    std::string widths;
    for (const int axis : workspace.axes) {
      const double width = workspace.range[static_cast<size_t>(axis)].width();
      wide = wide || (spacing > 0.0 && width < spacing);
      widths += fmt::format("{}{}", widths.empty() ? "" : " x ", quantity(width, kMilli, "mm"));
    }
    if (wide) {
      throw InputError(
          fmt::format("--grid {}: the lattice must be finer than the workspace is wide{}; take a finer grid",
                      arguments.grid, workspace.inside > 0 ? ", " + widths : ""));
    }
  }
  const bool answered = workspace.reached && !workspace.unbounded;
  if (answered && !arguments.map.empty()) write_map(map_of(workspace), arguments.map);
  if (answered && !arguments.figure.empty() && !workspace.slices.empty())
    draw(model, workspace, arguments.figure);
  std::optional<MechanicalPostures> mechanics;
  if (answered && model.mechanism.linear_rows() > 0)
    mechanics = sweep_mechanics_of_postures(model.mechanism, model.drives, 4000, progress.next(0.05));
  if (arguments.json) {
    Json document;
    document["device"] = model.description.name;
    document["complete"] = true;
    document.update(pose_json(workspace));
    document["mechanics"] = mechanics ? mechanics_json(*mechanics) : Json(nullptr);
    print_json(document);
    return answered ? kDone : kNo;
  }
  Sheet sheet(terminal);
  sheet.title(fmt::format("{}: workspace", model.description.name),
              workspace.dimension() > 0 ? "of the tool in one orientation, device frame"
                                        : "of a tool that only turns, device frame");
  for (const ArmFact& fact : pose_facts(workspace)) sheet.row(fact.name, fact.value, fact.note);
  const std::vector<ArmFact> loads = pose_load_facts(workspace);
  if (!loads.empty()) sheet.heading("Forces, continuous");
  for (const ArmFact& fact : loads) sheet.row(fact.name, fact.value, fact.note);
  if (!loads.empty()) {
    sheet.paragraph(
        "Pure forces and pure moments, whichever way is weaker; the device's own weight is "
        "not taken off.",
        2, Tint::dim);
  }
  const std::vector<ArmFact> anyhow = any_orientation_facts(workspace);
  if (!anyhow.empty()) sheet.heading("In any orientation");
  for (const ArmFact& fact : anyhow) sheet.row(fact.name, fact.value, fact.note);
  if (workspace.reached) {
    sheet.heading("Turned at one place");
    for (const ArmFact& fact : turning_facts(workspace.turning)) sheet.row(fact.name, fact.value, fact.note);
  }
  if (mechanics) print_mechanics(*mechanics, sheet);
  if (!arguments.map.empty() && answered) sheet.paragraph("map: " + arguments.map, 2, Tint::dim);
  if (!arguments.figure.empty() && answered) sheet.paragraph("figure: " + arguments.figure, 2, Tint::dim);
  print(sheet.text());
  return answered ? kDone : kNo;
}

}  // namespace zwidth
