#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <mutex>

#include "gnuplot.h"
#include "interrupt.h"
#include "mechanics.h"
#include "sheet_arm.h"
#include "workspace_verb.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/description/units.h"

namespace zwidth {

namespace {

/// Three cuts through the reach with the conditioning of the best posture at each point, and the outlines.
void draw(const Model& model, const ReachSheet& reach, const std::string& path) {
  std::string script = gnuplot_terminal(path, 1000.0, 860.0);
  script += fmt::format(
      "set multiplot layout 2,2 margins 0.08,0.95,0.08,0.92 spacing 0.13,0.12 title 'Reach of {}: best "
      "conditioning of translation on three cuts'\n"
      "{}set cbrange [0:1]\nset size ratio -1\nset grid front lc rgb '#dddddd'\nset border lc rgb "
      "'#888888'\nset tics textcolor rgb '#444444'\nunset key\n",
      model.description.name, gnuplot_palette());
  for (const int normal : {2, 1, 0}) script += gnuplot_cut(reach.slices[static_cast<size_t>(normal)], normal);
  run_gnuplot(script + "unset multiplot\n");
}

/// Middles of the cubes that the arm reaches, by x, then y, then z.
WorkspaceMap map_of(const ReachMap& reach) {
  WorkspaceMap map{.spacing = reach.spacing, .complete = reach.complete};
  for (std::int64_t i = reach.first[0]; i < reach.first[0] + reach.count[0]; ++i) {
    for (std::int64_t j = reach.first[1]; j < reach.first[1] + reach.count[1]; ++j) {
      for (std::int64_t k = reach.first[2]; k < reach.first[2] + reach.count[2]; ++k) {
        if (!reach.at(i, j, k)) continue;
        map.positions.push_back(reach.spacing * Vector3(static_cast<double>(i) + 0.5,
                                                        static_cast<double>(j) + 0.5,
                                                        static_cast<double>(k) + 0.5));
      }
    }
  }
  return map;
}

}  // namespace

std::string gnuplot_cut(const ReachSlice& cut, int number) {
  const char* axes = "xyz";
  const Slice& slice = cut.slice;
  const PlaneGrid& grid = cut.conditioning;
  return gnuplot_block(grid.values, grid.nu, fmt::format("map{}", number)) +
         gnuplot_outlines(slice, fmt::format("edge{}", number)) +
         fmt::format(
             "set title '{} = {:.1f} mm'\nset xlabel '{} [mm]'\nset ylabel '{} [mm]'\nset xrange "
             "[{:g}:{:g}]\nset yrange [{:g}:{:g}]\n"
             "plot $map{} matrix using ({:g}+$1*{:g}):({:g}+$2*{:g}):3 with image, $edge{} using 1:2 with "
             "lines "
             "lc rgb '#222222' lw 1.2\n",
             axes[slice.axis], slice.at * kMilli, axes[slice.u], axes[slice.v], grid.u.min * kMilli,
             grid.u.max * kMilli, grid.v.min * kMilli, grid.v.max * kMilli, number, grid.u.min * kMilli,
             grid.u.width() / std::max(1, grid.nu - 1) * kMilli, grid.v.min * kMilli,
             grid.v.width() / std::max(1, grid.nv - 1) * kMilli, number);
}

Turning turning_of(const WorkspaceArguments& arguments, const Mechanism& mechanism,
                   std::optional<OrientationWorkspace> orientations) {
  Turning turning{.orientations = std::move(orientations)};
  const auto obstacle = orientation_obstacle(mechanism);
  if (!arguments.position.empty()) {
    const ParsedQuantities at =
        parse_quantity_list(arguments.position, std::vector<Dimension>(3, Dimension::length));
    if (!at) throw InputError(fmt::format("--position \"{}\": {}; {}", arguments.position, at.rule, at.advice));
    if (obstacle) {
      throw InputError(
          fmt::format("--position asks how the tool of {} can be turned: {}", mechanism.name(), *obstacle));
    }
    const Vector3 position(at.values[0], at.values[1], at.values[2]);
    turning.place = {position, orientations_at(mechanism, position)};
  } else if (!obstacle) {
    ActiveVector home(mechanism.active_count());
    for (int i = 0; i < home.size(); ++i) home[i] = mechanism.home_guess()[mechanism.active_joint(i)];
    const Vector3 position = mechanism.serial()->pose(home).position;
    turning.place = {position, orientations_at(mechanism, position)};
  }
  return turning;
}

void write_turning(const Turning& turning, Json& document) {
  document["orientations"] = orientations_json(turning.orientations);
  document["place"] = turning.place ? place_json(*turning.place) : Json(nullptr);
}

void print_turning(const Turning& turning, Sheet& sheet) {
  const std::vector<ArmFact> facts = orientation_facts(turning.orientations, turning.place);
  if (!facts.empty()) sheet.heading("Orientations of the tool");
  for (const ArmFact& fact : facts) sheet.row(fact.name, fact.value, fact.note);
}

int arm_workspace(const WorkspaceArguments& arguments, const Model& model, double spacing,
                  const Terminal& terminal) {
  if (arguments.of != "condition_number")
    throw InputError(fmt::format("--of {}: is for tools that do not turn; leave it out", arguments.of));
  const Mechanism& mechanism = model.mechanism;
  ArmSheetOptions options{.reach_postures = 10'000'000, .reach_spacing = spacing};
  if (arguments.figure.empty()) options.slice_postures = 0;
  options.effort.cancel = &stop_on_interrupt();
  ArmSheet arm;
  {
    Progress progress("workspace", "%");
    std::mutex mutex;
    options.effort.progress = [&](double fraction) {
      const std::lock_guard lock(mutex);
      progress.update(100.0 * fraction, 100.0);
    };
    try {
      arm = arm_sheet(mechanism, {}, {}, {}, options);
    } catch (const std::length_error& error) {
      throw InputError(fmt::format("--grid {}: {}; take a coarser grid", arguments.grid, error.what()));
    }
  }
  if (!arm.complete) {
    complain("stopped before the end");
    return kNo;
  }
  const ReachSheet& reach = *arm.reach;
  // A flat reach may have no volume.
  const double widest = std::max({arm.ends[0][1].distance - arm.ends[0][0].distance,
                                  arm.ends[1][1].distance - arm.ends[1][0].distance,
                                  arm.ends[2][1].distance - arm.ends[2][0].distance});
  if (spacing > widest && !(reach.volume.value > 0.0)) {
    throw InputError(fmt::format(
        "--grid {}: no cube of this size has its middle in the workspace, which goes {} far; take a finer grid",
        arguments.grid, quantity(arm.farthest.distance, kMilli, "mm")));
  }
  if (!arguments.map.empty()) {
    const ReachMap cubes = reach_map(mechanism, {.samples = options.reach_postures, .spacing = spacing},
                                     {.cancel = options.effort.cancel});
    write_map(map_of(cubes), arguments.map);
  }
  if (!arguments.figure.empty()) draw(model, reach, arguments.figure);
  const Turning turning = turning_of(arguments, mechanism, std::move(arm.orientations));
  const MechanicalPostures mechanics = sweep_mechanics_of_postures(mechanism, model.drives);

  if (arguments.json) {
    Json document;
    document["device"] = model.description.name;
    document["grid"] = json_number(reach.volume.spacing);
    document["complete"] = true;
    document.update(reach_json(arm));
    document["mechanics"] = mechanics_json(mechanics);
    write_turning(turning, document);
    print_json(document);
    return kDone;
  }
  Sheet sheet(terminal);
  sheet.title(fmt::format("{}: workspace", model.description.name),
              fmt::format("of the tool point in any orientation, cubes of {}, device frame",
                          readable(reach.volume.spacing, "m", 3)));
  for (const ArmFact& fact : reach_facts(arm, mechanism)) sheet.row(fact.name, fact.value, fact.note);
  print_turning(turning, sheet);
  print_mechanics(mechanics, sheet);
  if (!arguments.map.empty()) sheet.paragraph("map: " + arguments.map, 2, Tint::dim);
  if (!arguments.figure.empty()) sheet.paragraph("figure: " + arguments.figure, 2, Tint::dim);
  print(sheet.text());
  return kDone;
}

}  // namespace zwidth
