#include "sheet_stiffness.h"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

#include "terminal.h"

#include "zwidth/mechanism/beam_link.h"

namespace zwidth {
namespace {

constexpr double kHertz = 0.5 / std::numbers::pi;

std::vector<std::string> row(const std::string& name, const PostureStatistic& statistic, double factor,
                             const std::string& unit) {
  return {name, number(statistic.min * factor), number(statistic.mean * factor), number(statistic.max * factor),
          unit};
}

Json statistic_entry(const PostureStatistic& statistic) {
  if (statistic.count == 0) return nullptr;
  Json entry;
  entry["min"] = json_number(statistic.min);
  entry["max"] = json_number(statistic.max);
  entry["mean"] = json_number(statistic.mean);
  entry["min_at"] = json_array(statistic.min_at);
  entry["max_at"] = json_array(statistic.max_at);
  return entry;
}

}  // namespace

std::vector<std::vector<std::string>> stiffness_rows(const DataSheet& sheet) {
  std::vector<std::vector<std::string>> rows;
  if (!sheet.stiffness) return rows;
  const StiffnessSheet& stiffness = *sheet.stiffness;
  const char* axes = "xyz";
  for (std::size_t k = 0; k < 3; ++k) {
    if (stiffness.along[k].count > 0)
      rows.push_back(row(fmt::format("stiffness along {}", axes[k]), stiffness.along[k], 1e-3, "N/mm"));
  }
  rows.push_back(row("in the softest direction", stiffness.softest, 1e-3, "N/mm"));
  rows.push_back(row("in the stiffest direction", stiffness.stiffest, 1e-3, "N/mm"));
  if (stiffness.lowest_held.count > 0)
    rows.push_back(row("lowest natural frequency, motors held", stiffness.lowest_held, kHertz, "Hz"));
  if (stiffness.lowest_free.count > 0)
    rows.push_back(row("the same, motors free", stiffness.lowest_free, kHertz, "Hz"));
  return rows;
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
      "Force per displacement of the tool under a pure force, motors standing still; {} give way{}. Over {} "
      "postures, "
      "spread evenly over the joint ranges.",
      to_string(stiffness.of),
      stiffness.of == Elasticity::links    ? ", the drives count as rigid"
      : stiffness.of == Elasticity::drives ? ", the links count as rigid"
                                           : "",
      stiffness.postures);
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
  for (std::size_t k = 0; k < 3; ++k) axis[names[k]] = statistic_entry(stiffness.along[k]);
  document["axis"] = axis;
  document["softest"] = statistic_entry(stiffness.softest);
  document["stiffest"] = statistic_entry(stiffness.stiffest);
  document["lowest_frequency"] = {{"held", statistic_entry(stiffness.lowest_held)},
                                  {"free", statistic_entry(stiffness.lowest_free)}};
  Json shares = Json::array();
  for (const GiveShare& one : stiffness.shares) {
    shares.push_back(
        {{"kind", one.drive ? "drive" : "link"}, {"name", one.name}, {"share", json_number(one.share)}});
  }
  document["shares"] = shares;
  return document;
}

}  // namespace zwidth
