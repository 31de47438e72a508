#include "sheet_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "efforts.h"
#include "mechanics.h"
#include "model.h"
#include "sheet_arm.h"
#include "sheet_stiffness.h"
#include "statistic_text.h"

#include "zwidth/description/units.h"
#include "zwidth/description/values.h"

namespace zwidth {

namespace {

/// A slice of the workspace as a picture of characters.
class Silhouette {
 public:
  Silhouette(const SliceMap& map, double metres_per_dot, bool unicode)
      : columns_(
            std::max(1, static_cast<int>(std::ceil(map.u_range.width() / metres_per_dot / (unicode ? 2 : 1))))),
        rows_(std::max(1,
                       static_cast<int>(std::ceil(map.v_range.width() / metres_per_dot / (unicode ? 4 : 2))))) {
    const int across = unicode ? 2 : 1;
    const int down = unicode ? 4 : 1;
    const auto& values = map.values[static_cast<size_t>(Figure::condition_number)];
    for (int row = 0; row < rows_; ++row) {
      std::string line;
      for (int column = 0; column < columns_; ++column) {
        unsigned bits = 0;
        for (int dy = 0; dy < down; ++dy) {
          for (int dx = 0; dx < across; ++dx) {
            const double u = (column * across + dx + 0.5) / (columns_ * across);
            const double v = 1.0 - (row * down + dy + 0.5) / (rows_ * down);
            const int iu = std::clamp(static_cast<int>(u * map.nu), 0, map.nu - 1);
            const int iv = std::clamp(static_cast<int>(v * map.nv), 0, map.nv - 1);
            const double value =
                values[static_cast<size_t>(iv) * static_cast<size_t>(map.nu) + static_cast<size_t>(iu)];
            // Dots of a braille cell: 1 2 3 7 down the left, 4 5 6 8 down the right.
            static constexpr unsigned kDots[2][4] = {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}};
            if (std::isfinite(value)) bits |= kDots[dx][dy];
          }
        }
        if (unicode) {
          const unsigned code = 0x2800 + bits;
          line += static_cast<char>(0xE0 | (code >> 12));
          line += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
          line += static_cast<char>(0x80 | (code & 0x3F));
        } else {
          line += bits != 0 ? '#' : ' ';
        }
      }
      lines_.push_back(line);
    }
  }

  int width() const { return columns_; }
  int height() const { return rows_; }
  std::string line(int row) const {
    return row < rows_ ? lines_[static_cast<size_t>(row)] : std::string(static_cast<size_t>(columns_), ' ');
  }

 private:
  int columns_;
  int rows_;
  std::vector<std::string> lines_;
};

class SheetText {
 public:
  SheetText(const DataSheet& sheet, const Description& description, const Terminal& terminal)
      : sheet_(sheet), description_(description), text_(terminal) {}

  std::string write() {
    identity();
    if (sheet_.arm) arm(*sheet_.arm);
    if (sheet_.workspace) workspace(*sheet_.workspace);
    if (sheet_.plane) plane(*sheet_.plane);
    if (sheet_.workspace) dexterity(sheet_.workspace->sweep, 3);
    if (sheet_.plane) dexterity(sheet_.plane->sweep, 2);
    if (sheet_.continuous && sheet_.peak) forces();
    if (sheet_.mechanics && knows_inertia(sheet_.mechanics->sweep)) inertia(sheet_.mechanics->sweep);
    stiffness();
    resolution();
    for (const DriveSheet& drive : sheet_.drives) drive_section(drive);
    for (const PneumaticDriveSheet& drive : sheet_.pneumatic_drives) cylinder_section(drive);
    notes();
    return text_.text();
  }

 private:
  const Terminal& terminal() const { return text_.terminal(); }
  double lattice_spacing() const {
    return (sheet_.plane ? sheet_.plane->sweep : sheet_.workspace->sweep).spacing;
  }
  size_t axis_count() const { return sheet_.plane ? 2 : 3; }
  bool wide() const { return terminal().width >= 110; }

  void identity() {
    text_.title(sheet_.name, sheet_.title);
    text_.paragraph("source: " + sheet_.source, 0, Tint::dim);
    text_.heading("Mechanism");
    text_.row("type", sheet_.mechanism_type,
              fmt::format("{} active joints, {} tool freedoms", sheet_.active_joints, sheet_.tool_freedoms));
    for (const GeometryEntry& entry : sheet_.geometry) {
      if (entry.key.starts_with("joint_range")) continue;  // said below
      std::string note = entry.symbol;
      for (const DescribedValue& value : described_values(description_)) {
        if (value.table == "mechanism" && value.key == entry.key && value.chosen())
          note += (note.empty() ? "" : ", ") + value.source;
      }
      text_.row(entry.name, entry.unit.empty() ? trimmed(entry.value) : readable(entry.value, entry.unit),
                note);
    }
    if (!sheet_.joint_ranges.empty()) {
      const auto& slides = sheet_.joint_slides;
      const bool same =
          std::all_of(sheet_.joint_ranges.begin(), sheet_.joint_ranges.end(),
                      [&](const Interval& range) { return range == sheet_.joint_ranges.front(); }) &&
          std::equal(slides.begin() + 1, slides.end(), slides.begin());
      for (size_t i = 0; i < (same ? 1 : sheet_.joint_ranges.size()); ++i) {
        const Interval& range = sheet_.joint_ranges[i];
        text_.row(same ? "range of every joint" : "range of " + sheet_.joint_names[i],
                  slides[i]
                      ? interval(range.min, range.max, kMilli, "mm")
                      : fmt::format("{}° … {}°", number(range.min * kDegrees), number(range.max * kDegrees)));
      }
    }
    if (sheet_.moving_mass > 0.0)
      text_.row("moving mass", readable(sheet_.moving_mass, "kg"), "of all bodies, drives not counted");
  }

  void workspace(const WorkspaceSheet& workspace) {
    text_.heading("Workspace");
    const bool integral = workspace.volume.method == WorkspaceVolume::Method::integral;
    text_.row("volume", quantity(workspace.volume.value, 1e6, "cm³", 5),
              fmt::format("{}, within {}", integral ? "integral of |det J|" : "counted on a lattice",
                          quantity(workspace.volume.error_estimate, 1e6, "cm³", 1)));
    text_.row("", quantity(workspace.sweep.volume, 1e6, "cm³", 5),
              fmt::format("{} points of a {} lattice, within {}", workspace.sweep.inside,
                          format_quantity(workspace.sweep.spacing, Dimension::length),
                          quantity(counting_error(workspace.volume, workspace.sweep), 1e6, "cm³", 1)));
    for (size_t k = 0; k < 3; ++k) {
      const Interval& range = workspace.extents.range[k];
      text_.row(fmt::format("range of {}", static_cast<char>('x' + k)),
                interval(range.min, range.max, kMilli, "mm"), quantity(range.width(), kMilli, "mm wide"));
    }
    const InscribedShapes& inscribed = workspace.inscribed;
    text_.row("largest sphere", fmt::format("{} diameter", quantity(2.0 * inscribed.sphere.size, kMilli, "mm")),
              "centre " + point_text(inscribed.sphere.centre));
    text_.row("largest cube", fmt::format("{} edge", quantity(inscribed.cube.size, kMilli, "mm")),
              "centre " + point_text(inscribed.cube.centre));
    silhouettes(workspace);
  }

  void plane(const PlaneSheet& plane) {
    text_.heading("Workspace");
    const bool integral = plane.area.method == WorkspaceVolume::Method::integral;
    text_.row("area", quantity(plane.area.value, 1e4, "cm²", 5),
              fmt::format("{}, within {}", integral ? "integral of |det J|" : "enclosed by its boundary",
                          quantity(plane.area.error_estimate, 1e4, "cm²", 1)));
    text_.row("", quantity(plane.sweep.area, 1e4, "cm²", 5),
              fmt::format("{} points of a {} lattice", plane.sweep.inside,
                          format_quantity(plane.sweep.spacing, Dimension::length)));
    for (size_t k = 0; k < 2; ++k) {
      const Interval& range = plane.extents.range[k];
      text_.row(fmt::format("range of {}", static_cast<char>('x' + k)),
                interval(range.min, range.max, kMilli, "mm"), quantity(range.width(), kMilli, "mm wide"));
    }
    const InscribedShape &circle = plane.inscribed.circle(), &square = plane.inscribed.square();
    text_.row("largest circle", fmt::format("{} diameter", quantity(2.0 * circle.size, kMilli, "mm")),
              "centre " + plane_point_text(circle.centre));
    text_.row("largest square", fmt::format("{} edge", quantity(square.size, kMilli, "mm")),
              "centre " + plane_point_text(square.centre));
    const DexterousRegion& dexterous = plane.dexterous;
    text_.row(fmt::format("condition number < {:g}", dexterous.limit), quantity(dexterous.area, 1e4, "cm²", 4),
              plane.area.value > 0.0 ? fmt::format("{} % of the area, within {}",
                                                   number(100.0 * dexterous.area / plane.area.value, 3),
                                                   quantity(dexterous.error_estimate, 1e4, "cm²", 1))
                                     : "");
    if (dexterous.annulus) {
      text_.row("on every full circle", interval(dexterous.annulus->min, dexterous.annulus->max, kMilli, "mm"),
                "radius about the origin");
    }
    if (plane.map.nu == 0) return;
    text_.gap();
    const int room = wide() ? 56 : 44;
    const Silhouette picture(plane.map, plane.map.u_range.width() / room / (terminal().unicode ? 2.0 : 1.0),
                             terminal().unicode);
    for (int row = 0; row < picture.height(); ++row) {
      text_.line("  " + tinted(terminal(), Tint::accent, picture.line(row)));
    }
    text_.line(tinted(terminal(), Tint::dim, "  the plane of x (right) and y (up)"));
  }

  void silhouettes(const WorkspaceSheet& workspace) {
    const auto& slices = workspace.slices;
    if (slices[0].nu == 0 || slices[1].nu == 0 || slices[2].nu == 0) return;
    const int room = wide() ? 96 : 70;
    double across = 0.0;
    for (const SliceMap& slice : slices) across += slice.u_range.width();
    const double metres_per_dot = across / (room - 8) / (terminal().unicode ? 2.0 : 1.0);
    const std::array<int, 3> order{2, 1, 0};
    std::vector<Silhouette> pictures;
    int height = 0;
    std::string captions = "  ";
    for (const int axis : order) {
      const SliceMap& slice = slices[static_cast<size_t>(axis)];
      pictures.emplace_back(slice, metres_per_dot, terminal().unicode);
      height = std::max(height, pictures.back().height());
      std::string caption = fmt::format("{}{} at {} = {:.0f} mm", static_cast<char>('x' + slice.slice.u),
                                        static_cast<char>('x' + slice.slice.v), static_cast<char>('x' + axis),
                                        slice.slice.at * kMilli);
      caption.resize(
          static_cast<size_t>(std::max(pictures.back().width() + 4, static_cast<int>(caption.size()))), ' ');
      captions += caption;
    }
    text_.gap();
    for (int row = 0; row < height; ++row) {
      std::string line = "  ";
      for (const Silhouette& picture : pictures) {
        // Pictures stand on a common floor.
        const int from_top = row - (height - picture.height());
        line += (from_top < 0 ? std::string(static_cast<size_t>(picture.width()), ' ')
                              : tinted(terminal(), Tint::accent, picture.line(from_top))) +
                "    ";
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text_.line(line);
    }
    captions.erase(captions.find_last_not_of(' ') + 1);
    text_.line(tinted(terminal(), Tint::dim, captions));
  }

  void arm(const ArmSheet& arm) {
    const auto facts = [&](const char* heading, const std::vector<ArmFact>& lines) {
      if (lines.empty()) return;
      text_.heading(heading);
      for (const ArmFact& fact : lines) text_.row(fact.name, fact.value, fact.note);
    };
    if (arm.pose) {
      facts(arm.pose->dimension() > 0 ? "Workspace in one orientation" : "Orientations", pose_facts(*arm.pose));
      facts("Forces in one orientation, continuous", pose_load_facts(*arm.pose));
      facts("Workspace in any orientation", any_orientation_facts(*arm.pose));
      if (arm.pose->reached) facts("Turned at home", turning_facts(arm.pose->turning));
    }
    if (arm.continuous.translation.weight() > 0.0) {
      facts(arm.pose ? "Reach of the tool point in any orientation" : "Reach of the tool point",
            reach_facts(arm, Mechanism(description_)));
    }
    facts("Orientations of the tool", orientation_facts(arm.orientations, home_turning(arm)));
    facts("Home posture", home_facts(arm, Mechanism(description_)));
    for (const PostureTable& table : arm_tables(sheet_, Mechanism(description_))) {
      text_.heading(table.title);
      std::vector<std::vector<std::string>> rows;
      for (const PostureRow& row : table.rows)
        rows.push_back(statistic_cells(row.name, *row.statistic, row.factor, row.unit, table.quantiles));
      text_.table(statistic_heads("", table.quantiles), rows);
      text_.paragraph(table.how, 2, Tint::dim);
      const std::string note = rows_note(rows, table.quantiles);
      if (!note.empty()) text_.paragraph(note, 2, Tint::dim);
    }
  }

  void statistics(const std::vector<std::vector<std::string>>& rows, double spacing, bool quantiles = false) {
    text_.table(
        statistic_heads(fmt::format("over a lattice of {}", format_quantity(spacing, Dimension::length)),
                        quantiles),
        rows);
    const std::string note = rows_note(rows, quantiles);
    if (!note.empty()) text_.paragraph(note, 2, Tint::dim);
  }

  void dexterity(const LatticeSweep& sweep, int dimension) {
    text_.heading("Dexterity over the workspace");
    std::vector<std::vector<std::string>> rows;
    rows.push_back(statistic_cells("condition number", sweep[Figure::condition_number], 1.0, ""));
    double factor = 1.0;
    const std::string unit = manipulability_unit(Mechanism(description_), dimension, factor);
    rows.push_back(statistic_cells("manipulability", sweep[Figure::manipulability], factor, unit));
    if (sweep[Figure::leg_singularity].count > 0)
      rows.push_back(
          statistic_cells("leg singularity (0 = singular)", sweep[Figure::leg_singularity], 1.0, ""));
    if (sweep[Figure::platform_singularity].count > 0) {
      rows.push_back(statistic_cells(dimension == 2 ? "coupler singularity" : "platform singularity",
                                     sweep[Figure::platform_singularity], 1.0, ""));
    }
    statistics(rows, sweep.spacing);
    if (!sheet_.conditioning) return;
    const GlobalConditioning& conditioning = sheet_.conditioning->of_all;
    text_.row("global conditioning", number(conditioning.index(), 4),
              "mean of 1/(condition number); 1 is isotropic everywhere");
    const Statistic& K = sweep[Figure::condition_number];
    if (K.count > 0) {
      text_.row("nearest to isotropic", fmt::format("K = {}", number(K.min)),
                "at " + (dimension == 2 ? plane_point_text(K.min_at) : point_text(K.min_at)));
      text_.row(fmt::format("near isotropic, K < {:g}", kNearIsotropic), near_isotropic_share(conditioning),
                dimension == 2 ? "of the area" : "of the volume");
    }
    text_.paragraph(fmt::format("Share of the {} by condition number K: {}.",
                                dimension == 2 ? "area" : "volume", shares_by_class(conditioning)),
                    2, Tint::dim);
  }

  void forces() {
    text_.heading("Force over the workspace");
    std::vector<std::vector<std::string>> rows;
    for (const auto& [name, forces] :
         {std::pair{"continuous", &*sheet_.continuous}, std::pair{"peak", &*sheet_.peak}}) {
      const char* axes = "xyz";
      for (size_t k = 0; k < axis_count(); ++k) {
        rows.push_back(statistic_cells(fmt::format("{}, along {}", name, axes[k]), forces->axes[k], 1.0, "N"));
      }
      rows.push_back(statistic_cells(fmt::format("{}, in every direction", name), forces->weakest, 1.0, "N"));
      rows.push_back(
          statistic_cells(fmt::format("{}, in the best direction", name), forces->strongest, 1.0, "N"));
    }
    statistics(rows, lattice_spacing());
    const auto torque = [this](const ForceSheet& forces) {
      return efforts_text(forces.torque, sheet_.joint_slides);
    };
    text_.paragraph(
        fmt::format("Joint {} {} continuous (limited by the {}), {} peak ({}). Device's weight not taken off.",
                    effort_word(sheet_.joint_slides), torque(*sheet_.continuous), sheet_.continuous->limited_by,
                    torque(*sheet_.peak), sheet_.peak->limited_by),
        2, Tint::dim);
  }

  void inertia(const MechanicalSweep& sweep) {
    text_.heading("Inertia felt at the tool");
    statistics(inertia_rows(sweep, sheet_.joint_slides), sweep.spacing, true);
    const std::string text = acceleration_text(sweep, sheet_.plane.has_value());
    if (!text.empty()) text_.paragraph(text, 2);
  }

  void stiffness() {
    text_.heading("Stiffness at the tool");
    if (sheet_.stiffness) {
      text_.table(statistic_heads(stiffness_over(sheet_), true), stiffness_rows(sheet_));
      text_.paragraph(stiffness_how(*sheet_.stiffness), 2, Tint::dim);
      text_.paragraph("What gives way: " + give_text(*sheet_.stiffness) + ".", 2);
    }
    if (sheet_.mechanics && sheet_.mechanics->sweep.of) {
      for (const MechanicsPlace& place : mechanics_places(sheet_.mechanics->sweep, sheet_.plane.has_value()))
        text_.row(place.name, place.value, place.place);
    }
    for (const std::string& laminate : laminate_texts(description_)) text_.paragraph(laminate, 2);
    for (const std::string& missing : not_given(sheet_)) text_.paragraph(missing, 2);
  }

  void resolution() {
    if (sheet_.resolution[0].count == 0) return;
    text_.heading("Resolution at the tool");
    std::vector<std::vector<std::string>> rows;
    const char* axes = "xyz";
    for (size_t k = 0; k < axis_count(); ++k)
      rows.push_back(
          statistic_cells(fmt::format("smallest step along {}", axes[k]), sheet_.resolution[k], 1e6, "µm"));
    statistics(rows, lattice_spacing());
    if (sheet_.middle && sheet_.middle->force_resolution) {
      std::string steps;
      for (const double step : *sheet_.middle->force_resolution) steps += number(step * kMilli, 3) + " ";
      text_.row("force step, mid-range", steps + "mN", "one current step in every motor");
    }
  }

  void cylinder_section(const PneumaticDriveSheet& sheet) {
    const PneumaticDriveDescription& description = sheet.drive.description();
    text_.heading("Cylinder of " + sheet.joint);
    text_.row("cylinder", description.cylinder.info.title);
    text_.row("regulators", description.regulator.info.title);
    text_.row("angle sensor",
              description.potentiometer ? description.potentiometer->info.title : std::string("not given"));
    text_.row("pressure", readable(sheet.drive.usable_pressure(), "Pa"),
              fmt::format("set by the {}", to_string(sheet.drive.limited_by())));
    text_.gap();
    for (const DriveFigure& figure : sheet.drive.figures()) {
      text_.line(fmt::format("  {}{} {}", figure.name,
                             std::string(static_cast<size_t>(std::max(1, 48 - columns(figure.name))), ' '),
                             readable(figure.value, figure.unit)));
    }
    text_.gap();
    std::vector<std::vector<std::string>> rows;
    for (const Margin& margin : sheet.drive.margins()) {
      rows.push_back({margin.name, readable(margin.demand, margin.unit),
                      readable(margin.capability, margin.unit), margin.ok ? "✓" : "✗"});
    }
    text_.table({"", "demand", "limit", ""}, rows);
  }

  void drive_section(const DriveSheet& drive) {
    const DriveDescription& description = drive.drive.description();
    std::string joints;
    for (const std::string& joint : drive.joints) joints += (joints.empty() ? "" : ", ") + joint;
    text_.heading("Drive of " + joints);
    text_.row("motor", description.motor.info.title);
    text_.row("encoder", description.encoder.info.title);
    text_.row("amplifier", description.amplifier.info.title);
    const TransmissionText transmission = transmission_text(description.transmission);
    text_.row("transmission", transmission.kind, transmission.detail);
    std::vector<std::vector<std::string>> rows;
    const auto& figures = drive.figures;
    const size_t half = (figures.size() + 1) / 2;
    if (wide()) {
      for (size_t i = 0; i < half; ++i) {
        const DriveFigure& left = figures[i];
        std::vector<std::string> row{left.name, readable(left.value, left.unit)};
        if (i + half < figures.size()) {
          row.push_back(figures[i + half].name);
          row.push_back(readable(figures[i + half].value, figures[i + half].unit));
        }
        rows.push_back(row);
      }
      text_.gap();
      for (const auto& row : rows) {
        std::string line =
            fmt::format("  {}{}{}", row[0],
                        std::string(static_cast<size_t>(std::max(1, 40 - columns(row[0]))), ' '), row[1]);
        if (row.size() > 2) {
          line += std::string(static_cast<size_t>(std::max(2, 60 - columns(line))), ' ') + row[2];
          line += std::string(static_cast<size_t>(std::max(2, 102 - columns(line))), ' ') + row[3];
        }
        text_.line(line);
      }
    } else {
      text_.gap();
      for (const DriveFigure& figure : figures) {
        text_.line(fmt::format("  {}{} {}", figure.name,
                               std::string(static_cast<size_t>(std::max(1, 48 - columns(figure.name))), ' '),
                               readable(figure.value, figure.unit)));
      }
    }
    text_.gap();
    rows.clear();
    for (const Margin& margin : drive.margins) {
      const double share = margin.utilisation.value_or(1.0);
      const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * 10));
      std::string bar;
      for (int i = 0; i < 10; ++i) bar += i < full ? "█" : "░";
      rows.push_back({margin.name, readable(margin.demand, margin.unit),
                      readable(margin.capability, margin.unit),
                      margin.utilisation ? fmt::format("{} %", number(100.0 * share, 3)) : "–",
                      tinted(terminal(), margin.ok ? Tint::good : Tint::bad, bar),
                      tinted(terminal(), margin.ok ? Tint::good : Tint::bad, margin.ok ? "✓" : "✗")});
    }
    text_.table({"margin", "demand", "limit", "used", "", ""}, rows);
  }

  void notes() {
    std::vector<std::string> chosen;
    for (const DescribedValue& value : described_values(description_)) {
      if (value.chosen()) chosen.push_back(value.table + "." + value.key);
    }
    if (sheet_.warnings.empty() && chosen.empty()) return;
    text_.heading("Notes");
    for (const std::string& warning : sheet_.warnings) text_.paragraph("▲ " + warning, 2, Tint::warning);
    if (!chosen.empty()) {
      text_.paragraph(fmt::format("{} values are chosen, because no source gives them: {}.", chosen.size(),
                                  fmt::join(chosen, ", ")),
                      2, Tint::dim);
    }
  }

  const DataSheet& sheet_;
  const Description& description_;
  Sheet text_;
};

}  // namespace

std::string shares_by_class(const GlobalConditioning& conditioning) {
  std::string text;
  for (const ConditionClass k : kConditionClasses) {
    if (conditioning.share(k) == 0.0) continue;
    text += fmt::format("{}{}: {} %", text.empty() ? "" : ", ", to_string(k),
                        number(100.0 * conditioning.share(k), 3));
  }
  return text;
}

std::string near_isotropic_share(const GlobalConditioning& conditioning) {
  return fmt::format("{} %", number(100.0 * conditioning.near_isotropic(), 3));
}

std::string manipulability_unit(const Mechanism& mechanism, int rows, double& factor) {
  const JacobianUnits units = jacobian_units(mechanism);
  int sliding = 0;
  for (int j = 0; j < mechanism.active_count(); ++j) sliding += units.slides(j) ? 1 : 0;
  factor = 1.0;
  // With joints to spare of both kinds, its square is a sum of terms of different units.
  if (sliding > 0 && sliding < mechanism.active_count() && mechanism.active_count() > rows) return "SI";
  const int power = sliding == mechanism.active_count() ? 0 : rows - sliding;
  const char* exponents[] = {"", "", "²", "³"};
  if (power <= 0 || power > 3) return "";
  factor = std::pow(100.0, power);
  return fmt::format("cm{}/rad{}", exponents[power], exponents[power]);
}

std::string in_words(std::string_view key) {
  std::string words(key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string data_sheet_text(const DataSheet& sheet, const Description& description, const Terminal& terminal) {
  return SheetText(sheet, description, terminal).write();
}

}  // namespace zwidth
