#include "mechanics.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "efforts.h"
#include "figure/plot.h"
#include "statistic_text.h"

namespace zwidth {

namespace {

constexpr double kMapWidth = 350.0;  // three beside each other, as the other maps

template <class Sweep>
bool known(const Sweep& sweep, MechanicalFigure which) {
  return sweep[which].count > 0;
}

template <class Sweep>
std::vector<std::vector<std::string>> rows_of(const Sweep& sweep) {
  std::vector<std::vector<std::string>> rows;
  for (int f = 0; f < kMechanicalFigureCount; ++f) {
    const auto which = static_cast<MechanicalFigure>(f);
    if (!known(sweep, which)) continue;
    if (which == MechanicalFigure::gravity_torque) continue;  // of the joints, not of the tool
    const ShownUnit shown = shown_unit(which);
    rows.push_back(statistic_cells(std::string(mechanical_figure_info(f).meaning), sweep[which], shown.factor,
                                   shown.unit, true));
  }
  return rows;
}

template <class Sweep, class Entry>
Json json_of(const Sweep& sweep, Entry entry) {
  Json document, notes;
  document["of"] = sweep.of ? Json(to_string(*sweep.of)) : Json(nullptr);
  for (int f = 0; f < kMechanicalFigureCount; ++f) {
    const auto which = static_cast<MechanicalFigure>(f);
    document["figures"][std::string(mechanical_figure_info(f).name)] =
        known(sweep, which) ? entry(sweep[which]) : Json(nullptr);
  }
  for (const std::string& note : mechanics_notes(sweep.of, known(sweep, MechanicalFigure::lightest),
                                                 known(sweep, MechanicalFigure::frequency_held),
                                                 known(sweep, MechanicalFigure::acceleration)))
    notes.push_back(note);
  document["notes"] = notes;
  return document;
}

template <class Sweep>
void print_notes(const Sweep& sweep, Sheet& sheet) {
  for (const std::string& note : mechanics_notes(sweep.of, known(sweep, MechanicalFigure::lightest),
                                                 known(sweep, MechanicalFigure::frequency_held),
                                                 known(sweep, MechanicalFigure::acceleration)))
    sheet.paragraph(note, 2, Tint::dim);
}

std::vector<std::vector<Point2>> curves_of(const Slice& slice) {
  std::vector<std::vector<Point2>> curves;
  for (const Outline& outline : slice.outlines) {
    curves.emplace_back();
    for (const auto& point : outline) curves.back().push_back({point[0] * kMilli, point[1] * kMilli});
  }
  return curves;
}

/// Without the few values near singularities, so that the rest can be told apart.
Interval common_range(const std::vector<MechanicalCut>& cuts, MechanicalFigure which, double factor) {
  std::vector<double> values;
  for (const MechanicalCut& cut : cuts) {
    for (const double value : cut[which]) {
      if (std::isfinite(value)) values.push_back(value * factor);
    }
  }
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) {
    return values[static_cast<size_t>(q * static_cast<double>(values.size() - 1))];
  };
  const Interval range{quantile(0.02), quantile(0.95)};
  const double middle = range.middle();
  return range.width() < 1e-2 * std::abs(middle) ? Interval{0.9 * middle, 1.1 * middle} : range;
}

SheetFigure map_of(const MechanicalCut& cut, MechanicalFigure which, const Interval& range, const char* section,
                   const char* name, const char* caption) {
  const ShownUnit shown = shown_unit(which);
  const Slice& slice = cut.slice;
  const auto axis = [](int a) { return static_cast<char>('x' + a); };
  Field field{{cut.u_range.min * kMilli, cut.u_range.max * kMilli},
              {cut.v_range.min * kMilli, cut.v_range.max * kMilli},
              cut.nu,
              cut.nv,
              cut[which]};
  for (double& value : field.values) value *= shown.factor;
  const auto around = [](const Interval& of) {
    const double extra = 0.04 * of.width();
    return Interval{(of.min - extra) * kMilli, (of.max + extra) * kMilli};
  };
  Plot plot(kMapWidth, kMapWidth, {fmt::format("{} [mm]", axis(slice.u)), around(cut.u_range)},
            {fmt::format("{} [mm]", axis(slice.v)), around(cut.v_range)});
  plot.keep_shape();
  plot.map(field, curves_of(slice), shown.unit, range);
  const std::string title = fmt::format("{}, {} = {} mm", name, axis(slice.axis),
                                        trimmed(std::abs(slice.at) < 5e-7 ? 0.0 : slice.at * kMilli, 3));
  return {fmt::format("{}-{}{}", mechanical_figure_info(static_cast<int>(which)).name, axis(slice.u),
                      axis(slice.v)),
          section, title, caption, plot.svg(fmt::format("{}, cut normal to {}", name, axis(slice.axis)))};
}

}  // namespace

ShownUnit shown_unit(MechanicalFigure which, bool slides) {
  if (which == MechanicalFigure::gravity_torque)
    return slides ? ShownUnit{"N", 1.0} : ShownUnit{"mN m", kMilli};
  if (which <= MechanicalFigure::stiffest) return {"N/mm", 1e-3};
  if (which <= MechanicalFigure::heaviest) return {"g", kMilli};
  if (which == MechanicalFigure::acceleration) return {"m/s²", 1.0};
  return {"Hz", 0.5 / std::numbers::pi};
}

std::vector<std::vector<std::string>> mechanics_rows(const MechanicalSweep& sweep) {
  return rows_of(sweep);
}
std::vector<std::vector<std::string>> mechanics_rows(const MechanicalPostures& sweep) {
  return rows_of(sweep);
}

ShownUnit gravity_unit(const std::vector<bool>& joint_slides) {
  const bool any = std::ranges::any_of(joint_slides, [](bool slides) { return slides; });
  if (any && !all_slide(joint_slides)) return {"N m or N", 1.0};
  return shown_unit(MechanicalFigure::gravity_torque, any);
}

std::string gravity_label(const std::vector<bool>& joint_slides) {
  return fmt::format("{} against gravity", effort_word(joint_slides));
}

bool knows_inertia(const MechanicalSweep& sweep) {
  return known(sweep, MechanicalFigure::lightest) || known(sweep, MechanicalFigure::gravity_torque);
}

std::vector<std::vector<std::string>> inertia_rows(const MechanicalSweep& sweep,
                                                   const std::vector<bool>& joint_slides) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& label, MechanicalFigure which) {
    const ShownUnit shown =
        which == MechanicalFigure::gravity_torque ? gravity_unit(joint_slides) : shown_unit(which);
    if (known(sweep, which))
      rows.push_back(statistic_cells(label, sweep[which], shown.factor, shown.unit, true));
  };
  add("apparent mass along x", MechanicalFigure::mass_x);
  add("apparent mass along y", MechanicalFigure::mass_y);
  add("apparent mass along z", MechanicalFigure::mass_z);
  add("in the lightest direction", MechanicalFigure::lightest);
  add("in the heaviest direction", MechanicalFigure::heaviest);
  add(gravity_label(joint_slides), MechanicalFigure::gravity_torque);
  return rows;
}

std::vector<MechanicsPlace> mechanics_places(const MechanicalSweep& sweep, bool in_plane) {
  std::vector<MechanicsPlace> places;
  const auto add = [&](const char* name, MechanicalFigure which, bool least) {
    if (!known(sweep, which)) return;
    const Statistic& statistic = sweep[which];
    const ShownUnit shown = shown_unit(which);
    const Vector3& at = least ? statistic.min_at : statistic.max_at;
    const bool endless = !least && statistic.unbounded;
    places.push_back(
        {name, endless ? "no bound" : quantity(least ? statistic.min : statistic.max, shown.factor, shown.unit),
         (endless ? "towards " : "at ") + (in_plane ? plane_point_text(at) : point_text(at))});
  };
  add("softest", MechanicalFigure::softest, true);
  add("stiffest", MechanicalFigure::stiffest, false);
  add("lightest", MechanicalFigure::lightest, true);
  add("heaviest", MechanicalFigure::heaviest, false);
  add("slowest, motors held", MechanicalFigure::frequency_held, true);
  add("fastest, motors held", MechanicalFigure::frequency_held, false);
  add("least acceleration", MechanicalFigure::acceleration, true);
  return places;
}

std::vector<std::string> mechanics_notes(const std::optional<Elasticity>& of, bool masses, bool frequencies,
                                         bool accelerations) {
  std::vector<std::string> notes;
  if (of) {
    notes.push_back(fmt::format("Under pure forces, motors standing still; {} give way{}.", to_string(*of),
                                *of == Elasticity::links    ? ", the drives count as rigid"
                                : *of == Elasticity::drives ? ", the links count as rigid"
                                                            : ""));
  } else {
    notes.emplace_back(
        "Stiffness: not given by the source; neither sections of the links nor the stiffness of every drive.");
  }
  if (accelerations)
    notes.emplace_back(
        "Accelerations by the continuous torques, from rest, the device's own weight taken off.");
  if (!masses) notes.emplace_back("Apparent mass: not given by the source; some joint moves no mass.");
  if (of && !frequencies)
    notes.emplace_back("Natural frequencies: not given by the source; the mass that some joint moves.");
  return notes;
}

void print_mechanics(const MechanicalSweep& sweep, bool in_plane, Sheet& sheet) {
  sheet.heading("Stiffness and mass over the workspace");
  const auto rows = rows_of(sweep);
  if (!rows.empty()) {
    sheet.table(statistic_heads(fmt::format("lattice of {}", readable(sweep.spacing, "m", 3)), true), rows);
    sheet.paragraph(rows_note(rows, true), 2, Tint::dim);
    for (const MechanicsPlace& place : mechanics_places(sweep, in_plane))
      sheet.row(place.name, place.value, place.place);
  }
  print_notes(sweep, sheet);
}

void print_mechanics(const MechanicalPostures& sweep, Sheet& sheet) {
  sheet.heading("Stiffness and mass over postures");
  const auto rows = rows_of(sweep);
  if (!rows.empty()) {
    sheet.table(statistic_heads(fmt::format("{} postures", sweep.solved), true), rows);
    sheet.paragraph(rows_note(rows, true), 2, Tint::dim);
  }
  print_notes(sweep, sheet);
}

Json mechanics_json(const MechanicalSweep& sweep) {
  Json document = json_of(sweep, [](const Statistic& one) { return statistic_json(one); });
  document["spacing"] = json_number(sweep.spacing);
  document["inside"] = sweep.inside;
  return document;
}

Json mechanics_json(const MechanicalPostures& sweep) {
  Json document = json_of(sweep, [](const PostureStatistic& one) { return statistic_json(one); });
  document["postures"] = sweep.solved;
  return document;
}

std::string acceleration_text(const MechanicalSweep& sweep, bool in_plane) {
  const Statistic& a = sweep[MechanicalFigure::acceleration];
  if (a.count == 0) return {};
  return fmt::format(
      "The continuous torques accelerate the tool in every direction by {} to {} m/s² (median {}), the "
      "device's "
      "own weight taken off; least at {}.",
      number(a.min), largest_text(a, 1.0), number(a.median.value_or(a.mean)),
      in_plane ? plane_point_text(a.min_at) : point_text(a.min_at));
}

std::vector<SheetFigure> mechanics_figures(const std::vector<MechanicalCut>& cuts) {
  std::vector<SheetFigure> figures;
  const auto add = [&](MechanicalFigure which, const char* section, const char* name, const char* caption) {
    const Interval range = common_range(cuts, which, shown_unit(which).factor);
    if (!(range.width() > 0.0)) return;
    for (auto cut = cuts.rbegin(); cut != cuts.rend(); ++cut)  // normal to z first
      figures.push_back(map_of(*cut, which, range, section, name, caption));
  };
  add(MechanicalFigure::heaviest, "inertia", "Apparent mass", "In the heaviest direction.");
  add(MechanicalFigure::acceleration, "inertia", "Acceleration",
      "In every direction, continuous, the weight taken off.");
  add(MechanicalFigure::softest, "stiffness", "Stiffness", "In the softest direction, motors held.");
  add(MechanicalFigure::frequency_held, "stiffness", "Natural frequency", "The lowest, motors held.");
  return figures;
}

}  // namespace zwidth
