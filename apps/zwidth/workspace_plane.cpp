#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "gnuplot.h"
#include "interrupt.h"
#include "mechanics.h"
#include "statistic_text.h"
#include "workspace_verb.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/description/units.h"

namespace zwidth {

namespace {

/// A figure over the plane, with the largest circle and square, the condition number with the lines of K = 5,
/// 10 and 100.
void draw(const WorkspaceArguments& arguments, const Model& model, const Extents& extents,
          const InscribedShapes& inscribed, const MechanicalSweep& mechanics) {
  const Drawn drawn = drawn_of(arguments, model);
  const bool condition = !drawn.mechanical && static_cast<Figure>(drawn.index) == Figure::condition_number;
  const SliceMap map =
      map_slice(model.mechanism, extents, 2, 0.0, condition ? 321 : 161, drive_limits(model.drives, false));
  const std::vector<double> values = drawn_values(drawn, model, map);
  refuse_unknown_figure(arguments, drawn, model, {values}, map, mechanics);
  const double width = map.u_range.width(), height = map.v_range.width();
  const double sheet_width = 760.0;
  std::string script = gnuplot_terminal(arguments.figure, sheet_width,
                                        std::round((sheet_width - 190.0) * height / width + 110.0));
  script += gnuplot_block(values, map.nu, "map");
  script += gnuplot_outlines(map.slice, "edge");
  std::string lines;
  for (const double limit : condition ? std::vector{5.0, 10.0, 100.0} : std::vector<double>{}) {
    const std::string name = fmt::format("k{:.0f}", limit);
    script += gnuplot_outlines(condition_region(model.mechanism, map, limit), name);
    lines += fmt::format(", ${} using 1:2 with lines lc rgb '#ffffff' lw 0.8 notitle", name);
  }
  const InscribedShape &circle = inscribed.circle(), &square = inscribed.square();
  script += "$circle << EOD\n";
  for (int n = 0; n <= 120; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / 120.0;
    script += fmt::format("{:.3f} {:.3f}\n", (circle.centre.x() + circle.size * std::cos(angle)) * kMilli,
                          (circle.centre.y() + circle.size * std::sin(angle)) * kMilli);
  }
  script += "EOD\n$square << EOD\n";
  for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}) {
    script += fmt::format("{:.3f} {:.3f}\n", (square.centre.x() + 0.5 * sx * square.size) * kMilli,
                          (square.centre.y() + 0.5 * sy * square.size) * kMilli);
  }
  script += "EOD\n";
  const double du = width / (map.nu - 1) * kMilli, dv = height / (map.nv - 1) * kMilli;
  script += gnuplot_palette();
  if (condition) {
    script +=
        "set logscale cb\nset cbrange [1:100]\nset cbtics (1, 2, 5, 10, 20, 50, 100)\nset cblabel 'condition "
        "number, lines at 5, 10 and 100'\n";
  } else {
    const Interval range = drawn_range({values});
    script += fmt::format("set cbrange [{:g}:{:g}]\nset cblabel '{}'\n", range.min, range.max, drawn.title);
  }
  script += fmt::format(
      "set size ratio -1\nset grid front lc rgb '#dddddd'\nset border lc rgb '#888888'\nset tics textcolor rgb "
      "'#444444'\nunset key\nset title 'Workspace of {}'\nset xlabel 'x [mm]'\nset ylabel 'y [mm]'\n"
      "set xrange [{:g}:{:g}]\nset yrange [{:g}:{:g}]\n"
      "plot $map matrix using ({:g}+$1*{:g}):({:g}+$2*{:g}):3 with image, $edge using 1:2 with lines lc rgb "
      "'#222222' lw 1.2{}, $circle using 1:2 with lines lc rgb '#222222' lw 1 dt 2, $square using 1:2 with "
      "lines "
      "lc rgb '#222222' lw 1 dt 2\n",
      model.description.name, map.u_range.min * kMilli, map.u_range.max * kMilli, map.v_range.min * kMilli,
      map.v_range.max * kMilli, map.u_range.min * kMilli, du, map.v_range.min * kMilli, dv, lines);
  run_gnuplot(script);
}

}  // namespace

int plane_workspace(const WorkspaceArguments& arguments, const Model& model, double asked,
                    const Terminal& terminal) {
  const Mechanism& mechanism = model.mechanism;
  StagedProgress progress(&stop_on_interrupt());
  const Extents extents = workspace_extents(mechanism);
  const double spacing = asked > 0.0 ? asked : suitable_spacing(mechanism, extents);
  const LatticeOptions options{
      .spacing = spacing, .limits = drive_limits(model.drives, false), .all_figures = arguments.all};
  LatticeSweep sweep;
  try {
    sweep = sweep_workspace(mechanism, options, progress.next(0.3));
  } catch (const std::length_error& error) {
    throw InputError(fmt::format("--grid {}: {}; take a coarser grid", arguments.grid, error.what()));
  }
  refuse_wide_lattice(arguments, sweep, extents, true);
  Json document;
  document["device"] = model.description.name;
  document["grid"] = json_number(spacing);
  document["complete"] = sweep.complete;
  document["lattice_points"] = sweep.lattice_points;
  document["inside"] = sweep.inside;
  document["lattice_area"] = json_number(sweep.area);
  WorkspaceVolume area;
  InscribedShapes inscribed;
  DexterousRegion dexterous;
  WorkspaceConditioning conditioning;
  std::optional<MechanicalSweep> mechanics;
  if (sweep.complete) {
    refine_extremes(mechanism, options, sweep, progress.next(0.05));
    if (!arguments.map.empty()) {
      WorkspaceMap map = map_workspace(mechanism, options, progress.next(0.0));
      if (arguments.all && map.complete) add_mechanics(mechanism, model.drives, map, progress.next(0.0));
      if (map.complete) write_map(map, arguments.map);
    }
    area = workspace_volume(mechanism, progress.next(0.1));
    inscribed = inscribed_shapes(mechanism);
    dexterous = dexterous_region(mechanism, extents);
    conditioning = sweep_conditioning(mechanism, spacing, progress.next(0.2));
    mechanics = mechanics_of(model, extents, spacing, progress.next(0.35));
    document["mechanics"] = mechanics_json(*mechanics);
    if (!arguments.figure.empty()) draw(arguments, model, extents, inscribed, *mechanics);
    document["area"] = json_number(area.value);
    document["area_method"] = to_string(area.method);
    document["area_error"] = json_number(area.error_estimate);
    document["lattice_area_error"] = json_number(counting_error(area, sweep));
  }
  document["ranges"] = {{"x", json_interval(extents.range[0])}, {"y", json_interval(extents.range[1])}};
  const InscribedShape &circle = inscribed.circle(), &square = inscribed.square();
  if (sweep.complete) {
    document["inscribed_circle"] = {{"centre", json_array(circle.centre.head<2>())},
                                    {"radius", json_number(circle.size)}};
    document["inscribed_square"] = {{"centre", json_array(square.centre.head<2>())},
                                    {"edge", json_number(square.size)}};
    document["dexterous"] = dexterous_json(dexterous);
    document["conditioning"] = conditioning_json(conditioning);
  }
  std::vector<std::vector<std::string>> rows;
  read_figures(sweep, mechanism, arguments.all, model.driven(), document, rows);
  if (!sweep.complete) complain("stopped before the end: the figures cover a part of the workspace only");
  if (arguments.json) {
    print_json(document);
    return sweep.complete ? kDone : kNo;
  }

  Sheet sheet(terminal);
  sheet.title(fmt::format("{}: workspace", model.description.name),
              fmt::format("lattice of {}, device frame", format_quantity(spacing, Dimension::length)));
  if (sweep.complete) {
    sheet.row("area", quantity(area.value, 1e4, "cm²", 5),
              fmt::format("{}, within {}",
                          area.method == WorkspaceVolume::Method::integral
                              ? "integral of |det J| over the joint ranges"
                              : "enclosed by its boundary",
                          quantity(area.error_estimate, 1e4, "cm²", 1)));
  }
  sheet.row("points inside", fmt::format("{}", sweep.inside),
            fmt::format("of {} in the box; {} by counting", sweep.lattice_points,
                        quantity(sweep.area, 1e4, "cm²", 5)) +
                (sweep.complete ? " ± " + quantity(counting_error(area, sweep), 1e4, "cm²", 1) : ""));
  for (size_t k = 0; k < 2; ++k) {
    sheet.row(fmt::format("range of {}", static_cast<char>('x' + k)),
              interval(extents.range[k].min, extents.range[k].max, kMilli, "mm"),
              quantity(extents.range[k].width(), kMilli, "mm wide"));
  }
  if (sweep.complete) {
    sheet.row("largest circle", quantity(2.0 * circle.size, kMilli, "mm diameter"),
              "centre " + plane_point_text(circle.centre));
    sheet.row("largest square", quantity(square.size, kMilli, "mm edge"),
              "centre " + plane_point_text(square.centre));
    sheet.row(fmt::format("condition number < {:g}", dexterous.limit), quantity(dexterous.area, 1e4, "cm²", 5),
              area.value > 0.0
                  ? fmt::format("{} % of the area, within {}", number(100.0 * dexterous.area / area.value, 3),
                                quantity(dexterous.error_estimate, 1e4, "cm²", 1))
                  : "");
    if (dexterous.annulus) {
      sheet.row("on every full circle", interval(dexterous.annulus->min, dexterous.annulus->max, kMilli, "mm"),
                "radius about the origin");
    }
  }
  sheet.heading("Figures over the workspace");
  sheet.table(statistic_heads(""), rows);
  if (any_unbounded(rows)) sheet.paragraph(rows_note(rows, false), 2, Tint::dim);
  if (sweep.complete) {
    print_conditioning(conditioning.of_all, sweep[Figure::condition_number], true, sheet);
  }
  if (model.driven()) sheet.paragraph("Forces with the continuous torque of the drives.", 2, Tint::dim);
  if (mechanics) print_mechanics(*mechanics, true, sheet);
  if (!arguments.map.empty() && sweep.complete) sheet.paragraph("map: " + arguments.map, 2, Tint::dim);
  if (!arguments.figure.empty() && sweep.complete) sheet.paragraph("figure: " + arguments.figure, 2, Tint::dim);
  print(sheet.text());
  return sweep.complete ? kDone : kNo;
}

}  // namespace zwidth
