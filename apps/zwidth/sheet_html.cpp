#include "sheet_html.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "efforts.h"
#include "figure/svg.h"
#include "mechanics.h"
#include "model.h"
#include "sheet_page.h"
#include "sheet_text.h"
#include "terminal.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/units.h"
#include "zwidth/description/values.h"

namespace zwidth {

namespace {

constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--text:#1c2430;--muted:#5b6675;--grid:#e7eaef;--axis:#9aa4b2;--card:#fff;--page:#f5f6f8;--line:#dfe3e9;
--s1:#2563c9;--s2:#d9631e;--s3:#23906b;--s4:#8b4fc6;--bad:#c9302c;--good:#23906b;--note:#fff6e0;--noteline:#e6b84c}
@media (prefers-color-scheme:dark){:root{--text:#e6e9ee;--muted:#9aa5b4;--grid:#2b323c;--axis:#616c7b;--card:#1b2027;--page:#13171c;--line:#2c343e;
--s1:#6ea2f5;--s2:#f08b4d;--s3:#4fc29a;--s4:#b48cf0;--bad:#f0706b;--good:#4fc29a;--note:#2d2615;--noteline:#8a6d23}}
*{box-sizing:border-box}
html{scroll-behavior:smooth;-webkit-text-size-adjust:100%}
body{margin:0;background:var(--page);color:var(--text);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue","DejaVu Sans",Arial,sans-serif}
.page{max-width:1240px;margin:0 auto;padding:28px 24px 64px;display:grid;grid-template-columns:minmax(0,1fr);gap:0 40px}
@media (min-width:1100px){.page{grid-template-columns:188px minmax(0,1fr)}nav{position:sticky;top:28px;align-self:start}}
nav{font-size:14px;margin-bottom:20px}
nav b{display:block;font-size:12px;letter-spacing:.06em;text-transform:uppercase;color:var(--muted);margin-bottom:6px}
nav ol{list-style:none;margin:0;padding:0;display:flex;flex-wrap:wrap;gap:2px 18px}
@media (min-width:1100px){nav ol{display:block}nav li{margin:5px 0}}
a{color:var(--s1);text-decoration:none}a:hover{text-decoration:underline}
header{grid-column:1/-1;border-bottom:1px solid var(--line);padding-bottom:18px;margin-bottom:24px}
h1{font-size:clamp(26px,4.5vw,36px);line-height:1.2;margin:0 0 6px;letter-spacing:-.01em}
header p{margin:2px 0;color:var(--muted)}
h2{font-size:22px;margin:44px 0 12px;line-height:1.25;letter-spacing:-.005em;scroll-margin-top:16px}
section:first-of-type h2{margin-top:0}
h3{font-size:16px;margin:24px 0 8px}
p{margin:8px 0;max-width:74ch}
.how{color:var(--muted);font-size:14px}
.card{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:14px 16px;margin:0}
figure.card{break-inside:avoid;display:flex;flex-direction:column}
figure.card svg{margin:4px 0}
figcaption{font-size:13.5px;color:var(--muted);margin-top:auto;line-height:1.45}
figure b{font-size:14.5px}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,330px),1fr));gap:16px;margin:16px 0;align-items:stretch}
.figures.one{grid-template-columns:minmax(0,560px)}
.figures.three{grid-template-columns:repeat(auto-fit,minmax(min(100%,280px),1fr))}
.tiles{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(46%,200px),1fr));gap:12px;margin:16px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:12px 14px}
.tile b{display:block;font-size:23px;line-height:1.25;font-variant-numeric:tabular-nums;letter-spacing:-.01em}
.tile b small{font-size:14px;font-weight:500;color:var(--muted);letter-spacing:0}
.tile span{font-size:13px;color:var(--muted);line-height:1.35;display:block;margin-top:2px}
.scroll{overflow-x:auto;margin:12px 0;border:1px solid var(--line);border-radius:10px;background:var(--card)}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums}
th,td{padding:7px 14px;text-align:left;vertical-align:top;border-bottom:1px solid var(--grid)}
tr:last-child td{border-bottom:0}
.wide{grid-column:1/-1}
.pair{columns:2;column-gap:24px}@media (max-width:760px){.pair{columns:1}}.pair dl{display:flex;justify-content:space-between;gap:16px;margin:0;padding:6px 0;border-bottom:1px solid var(--grid);break-inside:avoid;font-size:14.5px}
.pair dt{margin:0}.pair dd{margin:0;white-space:nowrap;font-variant-numeric:tabular-nums}
th{white-space:nowrap;font-weight:600;font-size:13px;color:var(--muted)}
td.n,th.n{text-align:right;white-space:nowrap}
td.w{white-space:nowrap}
td.source{color:var(--muted);font-size:13.5px;min-width:180px}
tr.group td{font-weight:600;background:color-mix(in srgb,var(--grid) 45%,transparent)}
.tag{display:inline-block;font-size:11.5px;line-height:1.5;padding:0 7px;border-radius:9px;border:1px solid var(--noteline);background:var(--note);color:var(--text);white-space:nowrap}
.ok{color:var(--good);font-weight:600}.no{color:var(--bad);font-weight:600}
.note{background:var(--note);border:1px solid var(--noteline);border-radius:10px;padding:10px 16px;margin:12px 0}
.note p{margin:4px 0}
details summary{cursor:pointer;font-weight:600;margin:14px 0 6px}
footer{grid-column:1/-1;margin-top:48px;padding-top:16px;border-top:1px solid var(--line);color:var(--muted);font-size:13.5px}
code{font:13.5px/1.5 ui-monospace,SFMono-Regular,Menlo,"DejaVu Sans Mono",monospace;background:color-mix(in srgb,var(--grid) 60%,transparent);padding:1px 5px;border-radius:4px;overflow-wrap:anywhere}
@media (max-width:520px){.page{padding:18px 14px 40px}th,td{padding:6px 10px}.tile b{font-size:20px}}
@media print{:root{color-scheme:light;--text:#111;--muted:#444;--card:#fff;--page:#fff;--grid:#e4e4e4;--axis:#888;--line:#ccc}
body{font-size:10.5pt}.page{display:block;max-width:none;padding:0}nav{display:none}h2{break-after:avoid}.figures{grid-template-columns:1fr 1fr}.scroll{overflow:visible}tr{break-inside:avoid}}
)css";

class Page : private SheetPage {
 public:
  Page(const DataSheet& sheet, const Description& description, const std::vector<SheetFigure>& figures,
       const std::vector<std::string>& overrides)
      : SheetPage(sheet, description, figures, overrides), sheet_(sheet), description_(description) {}

  std::string write() {
    overview();
    mechanism();
    if (sheet_.arm) write_arm(*this);
    if (sheet_.workspace) workspace(*sheet_.workspace);
    if (sheet_.plane) plane(*sheet_.plane);
    if (sheet_.workspace) dexterity(sheet_.workspace->sweep);
    if (sheet_.plane) dexterity(sheet_.plane->sweep);
    if (sheet_.continuous && sheet_.peak) force();
    write_inertia(*this);
    write_stiffness(*this);
    resolution();
    for (size_t i = 0; i < sheet_.drives.size(); ++i) drive(i);
    for (size_t i = 0; i < sheet_.pneumatic_drives.size(); ++i) cylinder(i);
    parts();
    sources();
    std::string toc;
    for (const auto& [id, title] : contents())
      toc += fmt::format("<li><a href=\"#{}\">{}</a></li>", id, escaped(title));
    const std::string name = escaped(sheet_.title.empty() ? sheet_.name : sheet_.title);
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\">\n"
        "<title>{0} – data sheet</title>\n<style>{1}{2}</style>\n</head>\n<body>\n<div "
        "class=\"page\">\n<header><h1>{0}</h1><p>Data sheet of <code>{3}</code></p><p>Source: "
        "{4}</p>{5}</header>\n"
        "<nav aria-label=\"Contents\"><b>Contents</b><ol>{6}</ol></nav>\n<main>\n{7}</main>\n"
        "<footer>Computed by zwidth {8} from the device file alone. Lengths, angles and forces in the device's "
        "own frame. The same numbers, in SI units, are in <a href=\"report.json\">report.json</a>.</footer>\n"
        "</div>\n</body>\n</html>\n",
        name, kStyle, figure_style(), escaped(sheet_.name), escaped(sheet_.source), changed(), toc, body(),
        ZWIDTH_VERSION);
  }

 private:
  std::string changed() const {
    if (overrides().empty()) return "";
    std::string text = "<p>Changed on the command line: ";
    for (size_t i = 0; i < overrides().size(); ++i)
      text += fmt::format("{}<code>{}</code>", i > 0 ? " " : "", escaped(overrides()[i]));
    return text + "</p>";
  }

  void overview() {
    section("overview", "At a glance");
    add("<div class=\"tiles\">");
    if (sheet_.workspace) {
      tile(readable(sheet_.workspace->volume.value, "m^3", 3), "workspace volume");
      tile(readable(2.0 * sheet_.workspace->inscribed.sphere.size, "m", 3),
           "diameter of the largest sphere inside");
      tile(number(sheet_.workspace->sweep[Figure::condition_number].mean, 3), "mean condition number");
    }
    if (sheet_.arm) {
      if (sheet_.arm->pose && sheet_.arm->pose->inside > 0 && sheet_.arm->pose->dimension() > 1) {
        const PoseWorkspace& pose = *sheet_.arm->pose;
        const bool plane = pose.dimension() == 2;
        tile(plane ? quantity(pose.measure, 1e4, "cm²", 3) : readable(pose.measure, "m^3", 3),
             "workspace in the home orientation");
        tile(readable(2.0 * pose.inscribed.sphere.size, "m", 3),
             plane ? "diameter of the largest circle inside" : "diameter of the largest sphere inside");
      }
      if (sheet_.arm->reach) {
        tile(readable(sheet_.arm->reach->volume.value, "m^3", 3), "reach of the tool point");
        tile(readable(2.0 * sheet_.arm->reach->inscribed.sphere.size, "m", 3),
             "diameter of the largest sphere inside");
      }
      const PostureSweep& sweep = sheet_.arm->continuous;
      if (sweep.translation.weight() > 0.0) {
        tile(readable(sheet_.arm->farthest.distance, "m", 3), "farthest from the base origin");
        tile(number(sweep.translation.index(), 3), "mean conditioning of translation, 1 is best");
      } else {
        tile(number(sweep.rotation.index(), 3), "mean conditioning, 1 is best");
        if (sweep.weakest_moment.count > 0)
          tile(readable(sweep.weakest_moment.mean, "N m", 3),
               "moment in every direction, continuous, mean over postures");
      }
      if (sheet_.arm->continuous.weakest_force.count > 0)
        tile(readable(sheet_.arm->continuous.weakest_force.mean, "N", 3),
             "force in every direction, continuous, mean over postures");
      if (sheet_.arm->peak && sheet_.arm->peak->weakest_force.count > 0)
        tile(readable(sheet_.arm->peak->weakest_force.mean, "N", 3),
             "force in every direction, peak, mean over postures");
    }
    if (sheet_.plane) {
      tile(quantity(sheet_.plane->area.value, 1e4, "cm²", 3), "reachable area");
      tile(readable(2.0 * sheet_.plane->inscribed.circle().size, "m", 3),
           "diameter of the largest circle inside");
    }
    if (sheet_.conditioning)
      tile(number(sheet_.conditioning->of_all.index(), 3), "global conditioning index (1 is best)");
    if (sheet_.continuous)
      tile(readable(sheet_.continuous->weakest.min, "N", 3), "force in every direction and place, continuous");
    if (sheet_.peak)
      tile(readable(sheet_.peak->weakest.min, "N", 3), "force in every direction and place, peak");
    if (sheet_.mechanics) {
      if (const auto& median = sheet_.mechanics->sweep[MechanicalFigure::heaviest].median)
        tile(readable(*median, "kg", 3), "apparent mass in the heaviest direction, median over the workspace");
    }
    if (sheet_.resolution[0].count > 0) {
      double worst = 0.0;
      for (const Statistic& axis : sheet_.resolution) worst = std::max(worst, axis.mean);
      tile(readable(worst, "m", 3), "mean position step at the tool");
    }
    for (const DriveSheet& drive : sheet_.drives) {
      if (drive.response && drive.response->bandwidth) {
        tile(readable(*drive.response->bandwidth, "Hz", 3), "force bandwidth of an actuator");
        break;
      }
    }
    add("</div>\n");
    show_figures("device");
    std::string warnings;
    for (const std::string& warning : sheet_.warnings) warnings += fmt::format("<p>{}</p>", escaped(warning));
    if (!warnings.empty()) add(fmt::format("<div class=\"note\">{}</div>\n", warnings));
  }

  void mechanism() {
    section("mechanism", "Mechanism");
    add(fmt::format("<p>A mechanism of type <b>{}</b> with {} active joints ({}) and {} freedoms of the tool.",
                    escaped(sheet_.mechanism_type), sheet_.active_joints,
                    escaped(fmt::format("{}", fmt::join(sheet_.joint_names, ", "))), sheet_.tool_freedoms));
    if (sheet_.moving_mass > 0.0)
      add(fmt::format(" Its bodies weigh {} together.", escaped(readable(sheet_.moving_mass, "kg"))));
    add("</p>\n");
    values_table(
        [](const DescribedValue& value) {
          return value.table == "mechanism" || value.table.starts_with("joint[");
        },
        !description_is_flat());
  }

  // All values of the mechanism stand in one table.
  bool description_is_flat() const {
    return !std::holds_alternative<SerialDescription>(description_.mechanism);
  }

  void workspace(const WorkspaceSheet& workspace) {
    section("workspace", "Workspace");
    std::string rows = "<tr><th>Quantity</th><th class=\"n\">Value</th><th>Where it comes from</th></tr>";
    const auto row = [&](const std::string& name, const std::string& value, const std::string& from) {
      rows += "<tr>" + cell(name) + cell(value, "n") + cell(from, "source") + "</tr>\n";
    };
    const bool integral = workspace.volume.method == WorkspaceVolume::Method::integral;
    row("Volume", quantity(workspace.volume.value, 1e6, "cm³", 6),
        integral
            ? fmt::format("integral of |det J| over the joint ranges, Gauss–Legendre with {} points per axis; "
                          "within {}",
                          workspace.volume.order, quantity(workspace.volume.error_estimate, 1e6, "cm³", 1))
            : fmt::format("counted on a lattice of {}, because det J changes sign or the legs do not close "
                          "everywhere; within {}",
                          format_quantity(workspace.volume.spacing, Dimension::length),
                          quantity(workspace.volume.error_estimate, 1e6, "cm³", 1)));
    row("Volume by counting", quantity(workspace.sweep.volume, 1e6, "cm³", 6),
        fmt::format("{} points of a {} lattice, {} in its box; within {}", workspace.sweep.inside,
                    format_quantity(workspace.sweep.spacing, Dimension::length), workspace.sweep.lattice_points,
                    quantity(counting_error(workspace.volume, workspace.sweep), 1e6, "cm³", 1)));
    for (size_t k = 0; k < 3; ++k) {
      const Interval& range = workspace.extents.range[k];
      row(fmt::format("Range of {}", axis(k)), interval(range.min, range.max, kMilli, "mm"),
          fmt::format("{} wide; ends of the workspace itself, not of a lattice",
                      quantity(range.width(), kMilli, "mm")));
    }
    const InscribedShapes& inscribed = workspace.inscribed;
    row("Largest sphere inside", quantity(2.0 * inscribed.sphere.size, kMilli, "mm") + " diameter",
        "centre at " + point_text(inscribed.sphere.centre));
    row("Largest cube inside", quantity(inscribed.cube.size, kMilli, "mm") + " edge",
        "sides along the axes, centre at " + point_text(inscribed.cube.centre));
    add(fmt::format("<div class=\"scroll\"><table>{}</table></div>\n", rows));
    show_figures("workspace");
  }

  const LatticeSweep& sweep() const { return sheet_.plane ? sheet_.plane->sweep : sheet_.workspace->sweep; }
  size_t axis_count() const { return sheet_.plane ? 2 : 3; }
  static std::string axis(size_t k) { return std::string(1, static_cast<char>('x' + k)); }

  void plane(const PlaneSheet& plane) {
    section("workspace", "Workspace");
    std::string rows = "<tr><th>Quantity</th><th class=\"n\">Value</th><th>Where it comes from</th></tr>";
    const auto row = [&](const std::string& name, const std::string& value, const std::string& from) {
      rows += "<tr>" + cell(name) + cell(value, "n") + cell(from, "source") + "</tr>\n";
    };
    const std::string within = quantity(plane.area.error_estimate, 1e4, "cm²", 1);
    row("Area", quantity(plane.area.value, 1e4, "cm²", 5),
        plane.area.method == WorkspaceVolume::Method::integral
            ? fmt::format("integral of |det J| over the joint ranges, within {}", within)
            : fmt::format("enclosed by the boundary, found to 1e-7 m at points {} apart, within {}",
                          readable(plane.area.spacing, "m", 3), within));
    row("Area by counting", quantity(plane.sweep.area, 1e4, "cm²", 5),
        fmt::format("{} points of a {} lattice; within {}", plane.sweep.inside,
                    format_quantity(plane.sweep.spacing, Dimension::length),
                    quantity(counting_error(plane.area, plane.sweep), 1e4, "cm²", 1)));
    for (size_t k = 0; k < 2; ++k) {
      const Interval& range = plane.extents.range[k];
      row(fmt::format("Range of {}", axis(k)), interval(range.min, range.max, kMilli, "mm"),
          fmt::format("{} wide; ends of the workspace itself, not of a lattice",
                      quantity(range.width(), kMilli, "mm")));
    }
    const InscribedShape &circle = plane.inscribed.circle(), &square = plane.inscribed.square();
    row("Largest circle inside", quantity(2.0 * circle.size, kMilli, "mm") + " diameter",
        "centre at " + plane_point_text(circle.centre));
    row("Largest square inside", quantity(square.size, kMilli, "mm") + " edge",
        "sides along the axes, centre at " + plane_point_text(square.centre));
    const DexterousRegion& dexterous = plane.dexterous;
    row(fmt::format("Condition number below {:g}", dexterous.limit), quantity(dexterous.area, 1e4, "cm²", 5),
        fmt::format("{} % of the area",
                    plane.area.value > 0.0 ? number(100.0 * dexterous.area / plane.area.value, 3) : "0"));
    if (dexterous.annulus) {
      row("The same on every full circle",
          interval(dexterous.annulus->min, dexterous.annulus->max, kMilli, "mm"),
          "radius of circles about the origin of the base frame");
    }
    add(fmt::format("<div class=\"scroll\"><table>{}</table></div>\n", rows));
    show_figures("workspace");
  }

  void dexterity(const LatticeSweep& sweep) {
    section("dexterity", "Dexterity");
    how(fmt::format("At {} lattice points in the workspace.", sweep.inside));
    statistics_head(sweep.spacing);
    statistics("Condition number of the Jacobian (1 is best)", sweep[Figure::condition_number], 1.0, "");
    double factor = 1.0;
    const std::string unit = manipulability_unit(Mechanism(description_), sheet_.plane ? 2 : 3, factor);
    statistics("Manipulability |det J|", sweep[Figure::manipulability], factor, unit);
    if (sweep[Figure::leg_singularity].count > 0)
      statistics("Distance to a stretched or folded leg (0 is singular)", sweep[Figure::leg_singularity], 1.0,
                 "");
    if (sweep[Figure::platform_singularity].count > 0) {
      statistics(sheet_.plane ? "Distance to aligned couplers (0 is singular)"
                              : "Distance to coplanar forearms (0 is singular)",
                 sweep[Figure::platform_singularity], 1.0, "");
    }
    statistics_end();
    if (sheet_.conditioning) {
      add(fmt::format(
          "<p>Global conditioning index, the mean of 1/K over the {}: <b>{}</b> (Gosselin &amp; Angeles 1991). "
          "By "
          "condition number K: {}.</p>\n",
          sheet_.plane ? "area" : "volume", number(sheet_.conditioning->of_all.index(), 4),
          escaped(shares_by_class(sheet_.conditioning->of_all))));
      const Statistic& K = sweep[Figure::condition_number];
      if (K.count > 0) {
        add(fmt::format(
            "<p>Nearest to isotropic: K = {} at {}. Near isotropic, K &lt; {:g}: {} of the {}.</p>\n",
            number(K.min), escaped(sheet_.plane ? plane_point_text(K.min_at) : point_text(K.min_at)),
            kNearIsotropic, near_isotropic_share(sheet_.conditioning->of_all),
            sheet_.plane ? "area" : "volume"));
      }
    }
    show_figures("dexterity", "three");
  }

  void force() {
    section("force", "Force");
    how("Static forces at the tool within the torque limits of the joints, τ = Jᵀ f; the device's own weight "
        "is not taken off. "
        "“Every direction” is the radius of the largest ball (in a plane, circle) in the force polytope, “best "
        "direction” its "
        "farthest corner.");
    for (const auto& [name, forces] :
         {std::pair{"Continuous", &*sheet_.continuous}, std::pair{"Peak", &*sheet_.peak}}) {
      add(fmt::format("<h3>{}: {} per joint, limited by the {}</h3>\n", name,
                      escaped(efforts_text(forces->torque, sheet_.joint_slides)), escaped(forces->limited_by)));
      statistics_head(sweep().spacing);
      for (size_t k = 0; k < axis_count(); ++k)
        statistics(fmt::format("Pure force along {}", axis(k)), forces->axes[k], 1.0, "N");
      statistics("In every direction", forces->weakest, 1.0, "N");
      statistics("In the best direction", forces->strongest, 1.0, "N");
      statistics_end();
    }
    show_figures("force", "three");
  }

  void resolution() {
    if (sheet_.resolution[0].count == 0) return;
    section("resolution", "Resolution");
    how("Step of the tool when every joint moves by one encoder count, at worst; step of the force when every "
        "motor changes by one current step.");
    statistics_head(sweep().spacing);
    for (size_t k = 0; k < axis_count(); ++k)
      statistics(fmt::format("Position along {}", axis(k)), sheet_.resolution[k], 1e6, "µm");
    statistics_end();
    std::string text;
    for (size_t j = 0; j < sheet_.joint_names.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      text +=
          fmt::format("<tr>{}{}{}</tr>", cell(sheet_.joint_names[j]),
                      cell(readable(sheet_.joint_resolution[i], sheet_.joint_slides[j] ? "m" : "rad"), "n"),
                      cell(readable(sheet_.torque_resolution[i], effort_unit(sheet_.joint_slides[j])), "n"));
    }
    add(
        fmt::format("<div class=\"scroll\"><table><tr><th>Joint</th><th class=\"n\">Step of one count</th><th "
                    "class=\"n\">Torque or force of one current step</th></tr>{}</table></div>\n",
                    text));
    if (sheet_.middle && sheet_.middle->force_resolution) {
      std::string steps;
      for (const double step : *sheet_.middle->force_resolution)
        steps += (steps.empty() ? "" : ", ") + number(step * kMilli, 3);
      how(fmt::format("Force step in the middle of the joint ranges: {} mN along {}.", steps,
                      sheet_.plane ? "x and y" : "x, y and z"));
    }
  }

  void cylinder(size_t i) {
    const PneumaticDrive& drive = sheet_.pneumatic_drives[i].drive;
    const PneumaticDriveDescription& description = drive.description();
    section(fmt::format("cylinder-{}", i), "Cylinder of " + sheet_.pneumatic_drives[i].joint);
    add(fmt::format(
        "<p>Cylinder <b>{}</b>, two regulators <b>{}</b>, angle sensor <b>{}</b>. Highest pressure {}, set by "
        "the "
        "{}.</p>\n",
        escaped(description.cylinder.info.title), escaped(description.regulator.info.title),
        escaped(description.potentiometer ? description.potentiometer->info.title : "not given"),
        readable(drive.usable_pressure(), "Pa"), to_string(drive.limited_by())));
    how("Computed from the values of the drive and its parts. Torques follow the lever over the joint's range, "
        "and "
        "differ with the direction by the area of the rod.");
    add("<div class=\"card pair\">");
    for (const DriveFigure& figure : drive.figures()) {
      std::string name = figure.name;
      name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
      add(fmt::format("<dl><dt>{}</dt><dd>{}</dd></dl>", escaped(name),
                      escaped(readable(figure.value, figure.unit))));
    }
    add("</div>\n");
    std::string rows =
        "<tr><th>Margin</th><th class=\"n\">Demand</th><th class=\"n\">Limit</th><th></th><th>Rule</th></tr>";
    for (const Margin& margin : drive.margins()) {
      rows += "<tr>" + cell(margin.name, "w") + cell(readable(margin.demand, margin.unit), "n") +
              cell(readable(margin.capability, margin.unit), "n") +
              cell(margin.ok ? "✓" : "✗", margin.ok ? "ok" : "no") + cell(margin.rule, "source") + "</tr>\n";
    }
    add(fmt::format(
        "<h3>Margins</h3><div class=\"scroll\"><table>{}</table></div>\n<h3>Values of the drive</h3>\n", rows));
    // Joints with a drive in common have its values in common.
    const auto& all = description_.pneumatic_drives;
    const auto place = std::find(all.begin(), all.end(), description) - all.begin();
    const std::string table = fmt::format("pneumatic_drive[{}]", place);
    values_table(
        [&](const DescribedValue& value) {
          return value.table == table || value.table.starts_with(table + ".");
        },
        true);
  }

  void drive(size_t i) {
    const DriveSheet& drive = sheet_.drives[i];
    const DriveDescription& description = drive.drive.description();
    section(fmt::format("drive-{}", i), sheet_.drives.size() > 1 ? fmt::format("Drive {}", i + 1) : "Drive");
    const TransmissionText transmission = transmission_text(description.transmission);
    add(fmt::format(
        "<p>Moves {}. Motor <b>{}</b>, encoder <b>{}</b>, amplifier <b>{}</b>, transmission <b>{}</b>.</p>\n",
        escaped(fmt::format("{}", fmt::join(drive.joints, ", "))), escaped(description.motor.info.title),
        escaped(description.encoder.info.title), escaped(description.amplifier.info.title),
        escaped(transmission.kind + (transmission.detail.empty() ? "" : ", " + transmission.detail))));
    how("Computed from the values of the drive and its parts, which stand below with their sources.");
    add("<div class=\"card pair\">");
    for (const DriveFigure& figure : drive.figures) {
      std::string name = figure.name;
      name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
      add(fmt::format("<dl><dt>{}</dt><dd>{}</dd></dl>", escaped(name),
                      escaped(readable(figure.value, figure.unit))));
    }
    add("</div>\n");
    show_figures(fmt::format("drive-{}", i));
    std::string rows =
        "<tr><th>Margin</th><th class=\"n\">Demand</th><th class=\"n\">Limit</th><th "
        "class=\"n\">Used</th><th></th><th>Rule</th></tr>";
    for (const Margin& margin : drive.margins) {
      rows +=
          "<tr>" + cell(margin.name, "w") + cell(readable(margin.demand, margin.unit), "n") +
          cell(readable(margin.capability, margin.unit), "n") +
          cell(margin.utilisation ? fmt::format("{} %", number(100.0 * *margin.utilisation, 3)) : "–", "n") +
          cell(margin.ok ? "✓" : "✗", margin.ok ? "ok" : "no") + cell(margin.rule, "source") + "</tr>\n";
    }
    add(fmt::format(
        "<h3>Margins</h3><div class=\"scroll\"><table>{}</table></div>\n<h3>Values of the drive</h3>\n", rows));
    const std::string table = fmt::format("drive[{}]", i);
    values_table(
        [&](const DescribedValue& value) {
          return value.table == table || value.table.starts_with(table + ".");
        },
        true);
  }

  template <class Part>
  void part(const Part& part) {
    if (!seen_.insert(part.info.name).second) return;
    add(fmt::format(
        "<details><summary>{} <span class=\"how\">({})</span></summary><p class=\"how\">Source: {}</p>",
        escaped(part.info.title), part_kind<Part>(), escaped(part.info.source)));
    std::string rows = "<tr><th>Quantity</th><th class=\"n\">Value</th><th>Where it comes from</th></tr>";
    for (const PartValue& value : part_values(part)) {
      std::string meaning = value.meaning;
      if (!meaning.empty())
        meaning[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(meaning[0])));
      rows += fmt::format("<tr><td>{} <code>{}</code></td>{}{}</tr>", escaped(meaning), escaped(value.key),
                          cell(trimmed_quantity(value.value, si_unit(value.dimension)), "n"),
                          given(value.value) ? source_cell(value.source, value.source.starts_with("chosen"))
                                             : "<td class=\"source\">no value in the source</td>");
    }
    add(fmt::format("<div class=\"scroll\"><table>{}</table></div></details>\n", rows));
  }

  void parts() {
    if (description_.drives.empty()) return;
    section("parts", "Parts");
    for (const DriveDescription& drive : description_.drives) {
      part(drive.motor);
      part(drive.encoder);
      part(drive.amplifier);
      if (const auto* capstan = std::get_if<CapstanDescription>(&drive.transmission)) part(capstan->cable);
      if (const auto* gear = std::get_if<GearheadDescription>(&drive.transmission)) part(gear->gearhead);
      if (drive.preloader) part(drive.preloader->material);
    }
  }

  void sources() {
    section("sources", "What is chosen, and what is not given");
    std::string chosen;
    std::string missing;
    for (const DescribedValue& value : values()) {
      const std::string item = fmt::format("<li><code>{}.{}</code> {}</li>", escaped(value.table),
                                           escaped(value.key), escaped(value.meaning));
      if (!value.given()) {
        missing += item;
      } else if (value.chosen() && !overridden(value)) {
        chosen += item;
      }
    }
    add(chosen.empty()
            ? "<p>Every value comes from a source.</p>\n"
            : fmt::format(
                  "<p>No source gives these values; they were chosen by the author of the device file, and "
                  "what follows from them (inertia, for instance) is no better than they are:</p><ul>{}</ul>\n",
                  chosen));
    if (!missing.empty())
      add(fmt::format("<p>Not given, and not needed for the figures above:</p><ul>{}</ul>\n", missing));
    add("</section>\n");
  }

  const DataSheet& sheet_;
  const Description& description_;
  std::set<std::string> seen_;
};

}  // namespace

std::string_view page_style() {
  return kStyle;
}

std::string data_sheet_html(const DataSheet& sheet, const Description& description,
                            const std::vector<SheetFigure>& figures,
                            const std::vector<std::string>& overrides) {
  return Page(sheet, description, figures, overrides).write();
}

}  // namespace zwidth
