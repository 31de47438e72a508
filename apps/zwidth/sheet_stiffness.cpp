#include "sheet_stiffness.h"

#include <algorithm>
#include <fmt/format.h>

#include "mechanics.h"
#include "sheet_json.h"
#include "statistic_text.h"
#include "terminal.h"

#include "zwidth/mechanism/beam_link.h"

namespace zwidth {
namespace {}  // namespace

namespace {

template <class Sweep>
std::vector<std::vector<std::string>> rows_over(const Sweep& sweep) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* label, MechanicalFigure which) {
    const ShownUnit shown = shown_unit(which);
    if (sweep[which].count > 0)
      rows.push_back(statistic_cells(label, sweep[which], shown.factor, shown.unit, true));
  };
  add("stiffness along x", MechanicalFigure::stiffness_x);
  add("stiffness along y", MechanicalFigure::stiffness_y);
  add("stiffness along z", MechanicalFigure::stiffness_z);
  add("in the softest direction", MechanicalFigure::softest);
  add("in the stiffest direction", MechanicalFigure::stiffest);
  add("lowest natural frequency, motors held", MechanicalFigure::frequency_held);
  add("the same, motors free", MechanicalFigure::frequency_free);
  return rows;
}

}  // namespace

std::vector<std::vector<std::string>> stiffness_rows(const DataSheet& sheet) {
  if (sheet.mechanics) return rows_over(sheet.mechanics->sweep);
  if (sheet.mechanics_of_postures) return rows_over(*sheet.mechanics_of_postures);
  return {};
}

std::string stiffness_over(const DataSheet& sheet) {
  if (sheet.mechanics)
    return fmt::format("over a lattice of {}", readable(sheet.mechanics->sweep.spacing, "m", 3));
  return sheet.mechanics_of_postures ? fmt::format("over {} postures", sheet.mechanics_of_postures->solved)
                                     : "";
}

std::string give_text(const StiffnessSheet& stiffness) {
  constexpr std::size_t kMost = 6;
  constexpr double kWorthNaming = 0.02;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, stiffness.shares.size()); ++i) {
    const GiveShare& one = stiffness.shares[i];
    if (one.share < kWorthNaming) break;
    text += fmt::format("{}{:.0f} % {}{}", text.empty() ? "" : ", ", 100.0 * one.share,
                        one.drive ? "drive of " : "", one.name);
  }
  return text;
}

std::string stiffness_how(const StiffnessSheet& stiffness) {
  return fmt::format(
      "Force per displacement of the tool under a pure force, motors standing still; {} give way{}.",
      to_string(stiffness.of),
      stiffness.of == Elasticity::links    ? ", the drives count as rigid"
      : stiffness.of == Elasticity::drives ? ", the links count as rigid"
                                           : "");
}

std::vector<std::string> not_given(const DataSheet& sheet) {
  std::vector<std::string> missing;
  if (!(sheet.moving_mass > 0.0))
    missing.emplace_back("Inertia: not given by the source; no link or platform has a mass.");
  if (!sheet.stiffness) {
    missing.emplace_back(
        "Stiffness: not given by the source; neither sections of the links nor the stiffness of every drive.");
  } else if (sheet.stiffness->lowest_held.count == 0) {
    missing.emplace_back("Natural frequencies: not given by the source; the mass that some joint moves.");
  }
  return missing;
}

std::vector<std::string> laminate_texts(const Description& description) {
  std::vector<std::string> texts;
  for (const LaminateComparison& one : laminate_comparisons(description)) {
    const bool theory = one.rule == LaminateRule::lamination;
    const WallModuli &used = theory ? one.lamination : one.mean, &other = theory ? one.mean : one.lamination;
    const auto change = [](double a, double b) { return fmt::format("{:+.0f} %", 100.0 * (b / a - 1.0)); };
    texts.push_back(fmt::format("{}, {} plies: {} GPa along, {} GPa in shear by {}; by {} {} and {} ({}, {}).",
                                one.on, one.plies, number(used.axial * 1e-9), number(used.shear * 1e-9),
                                theory ? "lamination theory" : "the mean of the plies",
                                theory ? "the mean of the plies" : "lamination theory",
                                number(other.axial * 1e-9), number(other.shear * 1e-9),
                                change(used.axial, other.axial), change(used.shear, other.shear)));
  }
  return texts;
}

Json laminates_json(const Description& description) {
  const auto moduli = [](const WallModuli& of) {
    return Json{{"axial", json_number(of.axial)},
                {"transverse", json_number(of.transverse)},
                {"shear", json_number(of.shear)}};
  };
  Json list = Json::array();
  for (const LaminateComparison& one : laminate_comparisons(description)) {
    list.push_back({{"on", one.on},
                    {"plies", one.plies},
                    {"rule", one.rule == LaminateRule::mean ? "mean" : "lamination"},
                    {"mean", moduli(one.mean)},
                    {"lamination", moduli(one.lamination)}});
  }
  return list;
}

Json stiffness_json(const StiffnessSheet& stiffness) {
  Json document;
  document["of"] = to_string(stiffness.of);
  document["postures"] = stiffness.postures;
  Json axis;
  const char* names[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) axis[names[k]] = statistic_json(stiffness.along[k]);
  document["axis"] = axis;
  document["softest"] = statistic_json(stiffness.softest);
  document["stiffest"] = statistic_json(stiffness.stiffest);
  document["lowest_frequency"] = {{"held", statistic_json(stiffness.lowest_held)},
                                  {"free", statistic_json(stiffness.lowest_free)}};
  Json shares = Json::array();
  for (const GiveShare& one : stiffness.shares) {
    shares.push_back(
        {{"kind", one.drive ? "drive" : "link"}, {"name", one.name}, {"share", json_number(one.share)}});
  }
  document["shares"] = shares;
  return document;
}

}  // namespace zwidth
