#include "zwidth/analysis/workspace.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>

#include "efforts.h"
#include "figure/svg.h"
#include "gnuplot.h"
#include "interrupt.h"
#include "mechanics.h"
#include "model.h"
#include "sheet_json.h"
#include "sheet_text.h"
#include "statistic_text.h"
#include "verbs.h"
#include "workspace_verb.h"

#include "zwidth/analysis/comparison.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {

namespace {

std::string statistics_factor(std::string_view unit, double& factor) {
  factor = 1.0;
  if (unit == "m") {
    factor = 1e6;
    return "µm";
  }
  return unit == "1" ? "" : std::string(unit);
}

}  // namespace

std::string gnuplot_block(const std::vector<double>& values, int columns, const std::string& name) {
  std::string text = "$" + name + " << EOD\n";
  int column = 0;
  for (const double value : values) {
    text += std::isfinite(value) ? fmt::format("{:.5g} ", value) : "NaN ";
    if (++column % columns == 0) text += "\n";
  }
  return text + "EOD\n";
}

std::string gnuplot_outlines(const Slice& slice, const std::string& name) {
  std::string text = "$" + name + " << EOD\n";
  for (const Outline& outline : slice.outlines) {
    for (const auto& point : outline)
      text += fmt::format("{:.3f} {:.3f}\n", point[0] * kMilli, point[1] * kMilli);
    if (!outline.empty())
      text += fmt::format("{:.3f} {:.3f}\n\n\n", outline[0][0] * kMilli, outline[0][1] * kMilli);
  }
  return text + "EOD\n";
}

std::string gnuplot_terminal(const std::string& path, double width, double height) {
  const std::string extension = path.substr(std::min(path.size(), path.rfind('.')));
  std::string terminal;
  if (extension == ".svg")
    terminal = fmt::format("svg size {:.0f},{:.0f} font 'sans,13' background 'white'", width, height);
  if (extension == ".png") {
    terminal = fmt::format("pngcairo size {:.0f},{:.0f} fontscale 1.6 linewidth 2 background 'white'",
                           2.0 * width, 2.0 * height);
  }
  if (extension == ".pdf") {
    terminal = fmt::format("pdfcairo size {:.1f}cm,{:.1f}cm font 'sans,10' background 'white'", 0.02 * width,
                           0.02 * height);
  }
  // gnuplot opens the file itself, and says little when it cannot.
  write_file(path, "");
  std::string quoted;
  for (const char c : path) quoted += c == '\'' ? "''" : std::string(1, c);
  return fmt::format("set terminal {}\nset output '{}'\n", terminal, quoted);
}

std::string gnuplot_palette() {
  std::string stops;
  for (int i = 0; i <= 12; ++i) stops += fmt::format("{}{} '{}'", i > 0 ? ", " : "", i, map_colour(i / 12.0));
  return fmt::format("set palette defined ({})\n", stops);
}

Drawn drawn_of(const WorkspaceArguments& arguments, const Model& model) {
  const bool plane = in_plane(model.mechanism);
  Drawn drawn;
  std::vector<std::string> known;
  for (int k = 0; k < kFigureCount; ++k) {
    const FigureInfo& info = plane ? plane_figure_info(k) : figure_info(k);
    if (plane && info.name.ends_with("_z")) continue;
    known.emplace_back(info.name);
    if (info.name != arguments.of) continue;
    const std::string unit = statistics_factor(info.unit, drawn.factor);
    drawn.index = k;
    drawn.title = std::string(info.name) + (unit.empty() ? "" : " [" + unit + "]");
    std::replace(drawn.title.begin(), drawn.title.end(), '_', ' ');
    return drawn;
  }
  for (int k = 0; k < kMechanicalFigureCount; ++k) {
    const FigureInfo& info = mechanical_figure_info(k);
    known.emplace_back(info.name);
    if (info.name != arguments.of) continue;
    bool slides = true;
    for (int i = 0; i < model.mechanism.active_count(); ++i)
      slides = slides && joint_slides(model.mechanism, i);
    const ShownUnit shown = shown_unit(static_cast<MechanicalFigure>(k), slides);
    return {true, k, fmt::format("{} [{}]", info.meaning, shown.unit), shown.factor};
  }
  throw InputError(
      fmt::format("--of {}: there is no such figure; {}", arguments.of, suggest(arguments.of, known)));
}

std::vector<double> drawn_values(const Drawn& drawn, const Model& model, const SliceMap& map) {
  std::vector<double> values = drawn.mechanical ? cut_mechanics(model.mechanism, model.drives, map,
                                                                1)[static_cast<MechanicalFigure>(drawn.index)]
                                                : map.values[static_cast<size_t>(drawn.index)];
  for (double& value : values) value *= drawn.factor;
  return values;
}

Interval drawn_range(const std::vector<std::vector<double>>& cuts) {
  std::vector<double> values;
  for (const std::vector<double>& cut : cuts)
    std::copy_if(cut.begin(), cut.end(), std::back_inserter(values), [](double v) { return std::isfinite(v); });
  if (values.empty()) return {0.0, 1.0};
  std::sort(values.begin(), values.end());
  const Interval range{values.front(),
                       values[static_cast<size_t>(0.98 * static_cast<double>(values.size() - 1))]};
  return range.width() > 1e-6 * std::abs(range.max) ? range : Interval{0.9 * range.max, 1.1 * range.max};
}

void refuse_unknown_figure(const WorkspaceArguments& arguments, const Drawn& drawn, const Model& model,
                           const std::vector<std::vector<double>>& cuts, const SliceMap& map,
                           const MechanicalSweep& mechanics) {
  const auto any = [](const std::vector<double>& values) {
    return std::ranges::any_of(values, [](double value) { return std::isfinite(value); });
  };
  const auto of_drives = [](int k) { return figure_info(k).unit == "N" || figure_info(k).unit == "m"; };
  const bool undriven = !drawn.mechanical && of_drives(drawn.index) && !model.driven();
  if (!undriven && std::ranges::any_of(cuts, any)) return;
  std::string known;
  const auto add = [&known](std::string_view name) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
  };
  for (int k = 0; k < kFigureCount; ++k) {
    if (any(map.values[static_cast<size_t>(k)]) && (model.driven() || !of_drives(k))) add(figure_info(k).name);
  }
  for (int k = 0; k < kMechanicalFigureCount; ++k) {
    if (mechanics.figures[static_cast<size_t>(k)].count > 0) add(mechanical_figure_info(k).name);
  }
  const bool elastic = drawn.mechanical && drawn.index <= static_cast<int>(MechanicalFigure::stiffest);
  const char* why = undriven ? ", some joints of which have no drive"
                    : elastic && !mechanics.of
                        ? ", whose file gives neither sections of the links nor the stiffness of every drive"
                        : "";
  throw InputError(fmt::format("--of {}: is not known of {}{}; known are {}", arguments.of,
                               model.description.name, why, known));
}

MechanicalSweep mechanics_of(const Model& model, const Extents& extents, double spacing, const Effort& effort) {
  return sweep_mechanics(model.mechanism, model.drives, fitting_spacing(extents, spacing, kMechanicalPoints),
                         effort);
}

void read_figures(const LatticeSweep& sweep, const Mechanism& mechanism, bool all, bool driven, Json& document,
                  std::vector<std::vector<std::string>>& rows) {
  const int dimension = in_plane(mechanism) ? 2 : 3;
  Json figures;
  Json notes;
  for (int k = 0; k < (all ? kFigureCount : kCoreFigureCount); ++k) {
    const FigureInfo& info = dimension == 2 ? plane_figure_info(k) : figure_info(k);
    if (dimension == 2 && info.name.ends_with("_z")) continue;
    const bool needs_drives = info.unit == "N" || info.unit == "m";
    const Statistic& statistic = sweep.figures[static_cast<size_t>(k)];
    const std::string key(info.name);
    if (needs_drives && !driven) {
      figures[key] = nullptr;
      notes[key] = "some joints have no drive";
      continue;
    }
    figures[key] = statistic_json(statistic);
    if (statistic.count == 0) {
      notes[key] = "not defined for this mechanism";
      continue;
    }
    double factor = 1.0;
    const std::string unit = key == "manipulability" ? manipulability_unit(mechanism, dimension, factor)
                                                     : statistics_factor(info.unit, factor);
    rows.push_back(statistic_cells(std::string(info.name), statistic, factor, unit));
    std::replace(rows.back()[0].begin(), rows.back()[0].end(), '_', ' ');
  }
  document["figures"] = figures;
  if (!notes.empty()) document["notes"] = notes;
}

void write_map(const WorkspaceMap& map, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  path.ends_with(".npy") ? write_npy(map, out) : write_csv(map, out);
  out.close();
  if (!out) throw MachineError(fmt::format("cannot write {}", path));
}

void print_conditioning(const GlobalConditioning& conditioning, const Statistic& condition_number, bool plane,
                        Sheet& sheet) {
  const char* whole = plane ? "area" : "volume";
  sheet.row("global conditioning", number(conditioning.index(), 4),
            "mean of 1/(condition number K), 1 is best");
  if (condition_number.count > 0) {
    const Vector3& at = condition_number.min_at;
    sheet.row("nearest to isotropic", "K = " + number(condition_number.min),
              "at " + (plane ? plane_point_text(at) : point_text(at)));
    sheet.row(fmt::format("near isotropic, K < {:g}", kNearIsotropic), near_isotropic_share(conditioning),
              fmt::format("of the {}", whole));
  }
  sheet.paragraph(fmt::format("Share of the {} by K: {}.", whole, shares_by_class(conditioning)), 2, Tint::dim);
}

void refuse_wide_lattice(const WorkspaceArguments& arguments, const LatticeSweep& sweep, const Extents& extents,
                         bool plane) {
  if (!sweep.complete || sweep.inside > 0) return;
  std::string widths;
  double narrowest = extents.range[0].width();
  for (size_t k = 0; k < (plane ? 2U : 3U); ++k) {
    widths += fmt::format("{}{}", k > 0 ? " x " : "", quantity(extents.range[k].width(), kMilli, "mm"));
    narrowest = std::min(narrowest, extents.range[k].width());
  }
  if (!(narrowest > 0.0))
    throw InputError("no posture within the joint ranges closes the loops: the workspace is empty");
  const double fine = 0.05 * narrowest * kMilli, power = std::pow(10.0, std::floor(std::log10(fine)));
  const double rounded = std::floor(fine / power) * power;
  throw InputError(fmt::format(
      "--grid {}: no point of this lattice lies in the workspace, which is {} wide; take a finer grid, such as "
      "--grid {}mm",
      arguments.grid, widths, trimmed(rounded, 1)));
}

Effort StagedProgress::next(double share) {
  const double from = done_;
  done_ += share;
  Effort effort;
  effort.cancel = cancel_;
  effort.progress = [this, from, share](double fraction) {
    const std::lock_guard lock(mutex_);
    progress_.update(100.0 * (from + share * fraction), 100.0);
  };
  return effort;
}

Description without_hand_joints(const Description& description) {
  const auto* arm = std::get_if<SerialDescription>(&description.mechanism);
  const bool point = arm != nullptr && arm->platform == PlatformFreedom::point;
  return point ? without_free_joints(description) : description;
}

namespace {

/// Three cuts with their condition number, and the surface, on one sheet.
void draw(const WorkspaceArguments& arguments, const Model& model, const Extents& extents,
          const DriveLimits& limits, const Drawn& drawn, const MechanicalSweep& mechanics) {
  const char* axes = "xyz";
  std::vector<SliceMap> maps;
  std::vector<std::vector<double>> values;
  for (const int normal : {2, 1, 0}) {
    maps.push_back(map_slice(model.mechanism, extents, normal,
                             extents.range[static_cast<size_t>(normal)].middle(), 161, limits));
    values.push_back(drawn_values(drawn, model, maps.back()));
  }
  refuse_unknown_figure(arguments, drawn, model, values, maps.front(), mechanics);
  const Interval range = drawn_range(values);
  std::string script = gnuplot_terminal(arguments.figure, 1000.0, 860.0);
  for (size_t i = 0; i < maps.size(); ++i) {
    script += gnuplot_block(values[i], maps[i].nu, fmt::format("map{}", i));
    script += gnuplot_outlines(maps[i].slice, fmt::format("edge{}", i));
  }
  const SurfaceMesh mesh = workspace_surface(model.mechanism, 16);
  script += "$mesh << EOD\n";
  Vector3 centre = Vector3::Zero();
  for (const Vector3& vertex : mesh.vertices) centre += vertex / static_cast<double>(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    // Shaded here, seen from outside: gnuplot's own lighting takes triangles from behind for dark.
    const Vector3& a = mesh.vertices[static_cast<size_t>(triangle[0])];
    const Vector3& b = mesh.vertices[static_cast<size_t>(triangle[1])];
    const Vector3& c = mesh.vertices[static_cast<size_t>(triangle[2])];
    Vector3 normal = (b - a).cross(c - a).normalized();
    if (normal.dot(a - centre) < 0.0) normal = -normal;
    const double shade = 0.62 + 0.38 * std::max(0.0, normal.dot(Vector3(-0.2, -0.6, 0.77)));
    const auto channel = [&](double full) { return static_cast<int>(std::lround(full * shade)); };
    const int colour = (channel(120.0) << 16) | (channel(166.0) << 8) | channel(245.0);
    // A quadrilateral of two scans, of which the second is one point twice.
    for (const int k : {0, 1, 2, 2}) {
      const Vector3 p = mesh.vertices[static_cast<size_t>(triangle[static_cast<size_t>(k)])] * kMilli;
      script += fmt::format("{:.2f} {:.2f} {:.2f} {}\n{}", p.x(), p.y(), p.z(), colour, k == 1 ? "\n" : "");
    }
    script += "\n\n";
  }
  script += "EOD\n";
  script += fmt::format(
      "set multiplot layout 2,2 margins 0.08,0.95,0.08,0.92 spacing 0.13,0.12 title 'Workspace of {}: "
      "{} on three cuts'\n"
      "{}set cbrange [{:g}:{:g}]\nset size ratio -1\nset grid front lc rgb '#dddddd'\nset "
      "border lc rgb '#888888'\nset tics textcolor rgb '#444444'\nunset key\n",
      model.description.name, drawn.title, gnuplot_palette(), range.min, range.max);
  for (size_t i = 0; i < maps.size(); ++i) {
    const SliceMap& map = maps[i];
    const double du = map.u_range.width() / std::max(1, map.nu - 1) * kMilli;
    const double dv = map.v_range.width() / std::max(1, map.nv - 1) * kMilli;
    script += fmt::format(
        "set title '{} = {:.1f} mm'\nset xlabel '{} [mm]'\nset ylabel '{} [mm]'\nset xrange [{:g}:{:g}]\nset "
        "yrange [{:g}:{:g}]\n"
        "plot $map{} matrix using ({:g}+$1*{:g}):({:g}+$2*{:g}):3 with image, $edge{} using 1:2 with lines lc "
        "rgb '#222222' lw 1.2\n",
        axes[map.slice.axis], map.slice.at * kMilli, axes[map.slice.u], axes[map.slice.v],
        map.u_range.min * kMilli, map.u_range.max * kMilli, map.v_range.min * kMilli, map.v_range.max * kMilli,
        i, map.u_range.min * kMilli, du, map.v_range.min * kMilli, dv, i);
  }
  script +=
      "unset colorbox\nset title 'surface'\nset xlabel 'x'\nset ylabel 'y'\nunset zlabel\nunset "
      "grid\nset autoscale\nset view 62,35\nset view equal xyz\n"
      "set xyplane relative 0.1\nset xtics 100\nset ytics 100\nset ztics 50\nset pm3d depthorder\n"
      "splot $mesh using 1:2:3:4 with pm3d fillcolor rgb variable\n"
      "unset multiplot\n";
  run_gnuplot(script);
}

int workspace(const WorkspaceArguments& arguments, const Terminal& terminal) {
  double asked = 0.0;
  if (!arguments.grid.empty()) {
    const ParsedQuantity grid = parse_quantity(arguments.grid, Dimension::length);
    if (!grid) throw InputError(fmt::format("--grid \"{}\": {}; {}", arguments.grid, grid.rule, grid.advice));
    if (*grid.value <= 0.0)
      throw InputError(fmt::format("--grid \"{}\": must be positive; for example --grid 1mm", arguments.grid));
    asked = *grid.value;
  }
  if (!arguments.map.empty() && !arguments.map.ends_with(".npy") && !arguments.map.ends_with(".csv")) {
    throw InputError(fmt::format("--map {}: must end in .csv or .npy", arguments.map));
  }
  if (!arguments.figure.empty() && !arguments.figure.ends_with(".svg") && !arguments.figure.ends_with(".png") &&
      !arguments.figure.ends_with(".pdf")) {
    throw InputError(fmt::format("--figure {}: must end in .svg, .png or .pdf", arguments.figure));
  }
  const Description described = read_device(arguments);
  const Model model(without_hand_joints(described));
  const Drawn drawn = drawn_of(arguments, model);
  if (!arguments.against.empty()) return compare(arguments, model, asked, terminal);
  const bool orientation = !arguments.orientation.empty() || !arguments.rotation.empty();
  if (orientation && pose_workspace_obstacle(model.mechanism)) {
    throw InputError(fmt::format(
        "{}: asks for the places that a platform on several legs reaches in one orientation, and {} has none; "
        "leave it out",
        arguments.orientation.empty() ? "--rotation" : "--orientation", model.description.name));
  }
  if (const auto obstacle = workspace_obstacle(model.mechanism)) {
    if (!reach_obstacle(model.mechanism)) return arm_workspace(arguments, model, asked, terminal);
    if (const auto why = pose_workspace_obstacle(model.mechanism); !why) {
      return platform_workspace(arguments, model, asked, terminal);
    } else if (model.mechanism.tool_turns()) {
      throw InputError(fmt::format("{}: its workspace is not known: {}", model.description.name, *why));
    }
    throw InputError(fmt::format("{}: {}", model.description.name, *obstacle));
  }
  if (in_plane(model.mechanism) && !arguments.position.empty())
    throw InputError("--position tells how a tool can be turned, and that of a plane cannot");
  if (in_plane(model.mechanism)) return plane_workspace(arguments, model, asked, terminal);
  const bool driven = model.driven();
  StagedProgress progress(&stop_on_interrupt());
  const Extents extents = workspace_extents(model.mechanism);
  LatticeOptions options;
  options.spacing = asked > 0.0 ? asked : suitable_spacing(model.mechanism, extents);
  options.all_figures = arguments.all;
  options.limits = drive_limits(model.drives, false);
  LatticeSweep sweep;
  try {
    sweep = sweep_workspace(model.mechanism, options, progress.next(0.4));
  } catch (const std::length_error& error) {
    throw InputError(fmt::format("--grid {}: {}; take a coarser grid", arguments.grid, error.what()));
  }
  refuse_wide_lattice(arguments, sweep, extents, false);
  if (sweep.complete) refine_extremes(model.mechanism, options, sweep, progress.next(0.05));
  if (!arguments.map.empty() && sweep.complete) {
    WorkspaceMap map = map_workspace(model.mechanism, options, progress.next(0.0));
    if (arguments.all && map.complete) add_mechanics(model.mechanism, model.drives, map, progress.next(0.0));
    if (map.complete) write_map(map, arguments.map);
    sweep.complete = map.complete;
  }
  std::optional<MechanicalSweep> mechanics;
  if (sweep.complete) mechanics = mechanics_of(model, extents, options.spacing, progress.next(0.2));
  if (!arguments.figure.empty() && sweep.complete)
    draw(arguments, model, extents, options.limits, drawn, *mechanics);
  const WorkspaceVolume volume =
      sweep.complete ? finer_count(workspace_volume(model.mechanism, progress.next(0.15)), sweep)
                     : WorkspaceVolume{};
  const InscribedShapes inscribed = sweep.complete ? inscribed_shapes(model.mechanism) : InscribedShapes{};

  const bool integral = volume.method == WorkspaceVolume::Method::integral;
  const double miscounted = counting_error(volume, sweep);

  Json document;
  document["device"] = model.description.name;
  document["grid"] = json_number(sweep.spacing);
  document["complete"] = sweep.complete;
  document["lattice_points"] = sweep.lattice_points;
  document["inside"] = sweep.inside;
  document["lattice_volume"] = json_number(sweep.volume);
  if (sweep.complete) {
    document["volume"] = json_number(volume.value);
    document["volume_method"] = to_string(volume.method);
    document["volume_error"] = json_number(volume.error_estimate);
    document["lattice_volume_error"] = json_number(miscounted);
  }
  Json ranges;
  for (size_t k = 0; k < 3; ++k)
    ranges[std::string(1, static_cast<char>('x' + k))] = json_interval(extents.range[k]);
  document["ranges"] = ranges;
  if (sweep.complete) {
    document["inscribed_sphere"] = {{"centre", json_array(inscribed.sphere.centre)},
                                    {"radius", json_number(inscribed.sphere.size)}};
    document["inscribed_cube"] = {{"centre", json_array(inscribed.cube.centre)},
                                  {"edge", json_number(inscribed.cube.size)}};
  }
  // With the joints that the hand moves.
  const Mechanism whole(with_turning_tool(described));
  std::optional<OrientationWorkspace> orientations;
  if (sweep.complete && !orientation_obstacle(whole)) {
    const ReachMap reach = reach_map(whole, {.samples = 2'000'000}, progress.next(0.0));
    orientations = orientation_workspace(whole, reach, {}, progress.next(0.0));
  }
  const Turning turning = turning_of(arguments, whole, std::move(orientations));
  if (turning.orientations || turning.place) write_turning(turning, document);
  const WorkspaceConditioning conditioning =
      sweep.complete ? sweep_conditioning(model.mechanism, 2.0 * options.spacing, progress.next(0.2))
                     : WorkspaceConditioning{};
  if (sweep.complete) {
    document["conditioning"] = conditioning_json(conditioning);
    document["mechanics"] = mechanics_json(*mechanics);
  }
  Sheet sheet(terminal);
  std::vector<std::vector<std::string>> rows;
  read_figures(sweep, model.mechanism, arguments.all, driven, document, rows);
  if (!sweep.complete) complain("stopped before the end: the figures cover a part of the workspace only");
  if (arguments.json) {
    print_json(document);
    return sweep.complete ? kDone : kNo;
  }
  sheet.title(fmt::format("{}: workspace", model.description.name),
              fmt::format("lattice of {}, device frame", format_quantity(sweep.spacing, Dimension::length)));
  if (sweep.complete) {
    sheet.row("volume", quantity(volume.value, 1e6, "cm³", 6),
              fmt::format("{}, within {}", integral ? "integral of |det J| over the joint ranges" : "counted",
                          quantity(volume.error_estimate, 1e6, "cm³", 1)));
  }
  sheet.row("points inside", fmt::format("{}", sweep.inside),
            fmt::format("of {} in the box; {}{} by counting", sweep.lattice_points,
                        quantity(sweep.volume, 1e6, "cm³", 6),
                        sweep.complete ? " ± " + quantity(miscounted, 1e6, "cm³", 1) : ""));
  for (size_t k = 0; k < 3; ++k) {
    sheet.row(fmt::format("range of {}", static_cast<char>('x' + k)),
              interval(extents.range[k].min, extents.range[k].max, kMilli, "mm"),
              quantity(extents.range[k].width(), kMilli, "mm wide"));
  }
  if (sweep.complete) {
    sheet.row("largest sphere", quantity(2.0 * inscribed.sphere.size, kMilli, "mm diameter"),
              "centre " + point_text(inscribed.sphere.centre));
    sheet.row("largest cube", quantity(inscribed.cube.size, kMilli, "mm edge"),
              "centre " + point_text(inscribed.cube.centre));
  }
  print_turning(turning, sheet);
  sheet.heading("Figures over the workspace");
  sheet.table(statistic_heads(""), rows);
  if (any_unbounded(rows)) sheet.paragraph(rows_note(rows, false), 2, Tint::dim);
  if (sweep.complete) {
    print_conditioning(conditioning.of_all, sweep[Figure::condition_number], false, sheet);
  }
  if (driven) sheet.paragraph("Forces with the continuous torque of the drives.", 2, Tint::dim);
  if (mechanics) print_mechanics(*mechanics, false, sheet);
  if (!arguments.map.empty() && sweep.complete) sheet.paragraph("map: " + arguments.map, 2, Tint::dim);
  if (!arguments.figure.empty() && sweep.complete) sheet.paragraph("figure: " + arguments.figure, 2, Tint::dim);
  print(sheet.text());
  return sweep.complete ? kDone : kNo;
}

}  // namespace

void add_workspace(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, "workspace", "Reachable volume or area, ranges, inscribed shapes, maps, comparison",
      "  zwidth workspace delta\n"
      "  zwidth workspace delta --grid 0.5mm --all-figures\n"
      "  zwidth workspace delta --grid 2mm --map delta.csv         one row per point\n"
      "  zwidth workspace delta --figure delta.pdf                 cuts and surface (needs gnuplot)\n"
      "  zwidth workspace r-cube --figure r-cube.svg --of softest  the same with the stiffness\n"
      "  zwidth workspace seven-dof --position 0.3,0,0.1           also how the tool can be turned there\n"
      "  zwidth workspace hexapod.toml --orientation 0,20deg,0      a platform's, turned\n"
      "  zwidth workspace delta --set mechanism.forearm=\"170 mm\" --against delta\n"
      "\nCtrl-C stops with what there is, and exits 1.");
  auto arguments = std::make_shared<WorkspaceArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--grid", arguments->grid,
                   "spacing of the lattice; if not given, a round one that suits the device and takes seconds")
      ->type_name("LENGTH");
  verb->add_option(
          "--against", arguments->against,
          "compare with another device: what both reach, and what only one does; --set does not change it")
      ->type_name("DEVICE");
  verb->add_option(
          "--position", arguments->position,
          "where to tell how the tool of an arm or a platform can be turned; its home posture if not given")
      ->type_name("X,Y,Z");
  verb->add_option("--orientation", arguments->orientation,
                   "of a platform, in which its places are asked for, that of its home posture if not given: "
                   "ROLL,PITCH,YAW about the fixed axes, or a quaternion W,X,Y,Z")
      ->type_name("A,B,C");
  verb->add_option("--rotation", arguments->rotation, "the same as a matrix: nine numbers, row by row")
      ->type_name("R11,...");
  verb->add_option("--map", arguments->map, "write figures at every point inside: FILE.csv or FILE.npy")
      ->type_name("FILE");
  verb->add_option("--figure", arguments->figure, "draw cuts and surface: FILE.svg, .png or .pdf")
      ->type_name("FILE");
  verb->add_option("--of", arguments->of,
                   "what --figure draws on the cuts: condition_number if not given, or another figure, such as "
                   "softest, heaviest or frequency_held")
      ->type_name("FIGURE");
  verb->add_flag(
      "--all-figures", arguments->all,
      "also polytope forces, resolution and distances to singularities; in --map stiffness, apparent "
      "mass and natural frequencies too, which take some 10 µs a point");
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return workspace(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
