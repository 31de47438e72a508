#include "reproduce_r_cube_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "r_cube_tables.h"
#include "study.h"

#include "zwidth/design/pareto.h"

namespace zwidth {
namespace {

using r_cube_tables::Choice;
using r_cube_tables::Design;

constexpr std::size_t kObjectives = 3;
constexpr double kHalfWorkspace = 0.060;        // of the 120 mm cube [m]
constexpr double kPublishedTolerance = 0.0111;  // that the constraints of table 7.2 need

// Table 7.1: the largest l2 and l3.
struct Bounds {
  const char* inner;
  const char* outer;
};
constexpr std::array<Bounds, 3> kBounds = {{{"500 mm", "500 mm"}, {"250 mm", "250 mm"}, {"100 mm", "150 mm"}}};

// Enough for a front that has converged, in a few seconds, whatever the seed.
constexpr int kPopulation = 300, kGenerations = 200;

StudyRun within(const Bounds& bounds) {
  return search_study(
      "r-cube-kinematics",
      {fmt::format("variable[1].max=\"{}\"", bounds.inner), fmt::format("variable[2].max=\"{}\"", bounds.outer),
       fmt::format("search.population={}", kPopulation), fmt::format("search.generations={}", kGenerations)});
}

// Designs by qmax, l2, l3 and by O1, log10 O2 and log10 O3.
struct Designs {
  std::vector<double> lengths, objectives;

  std::size_t size() const { return objectives.size() / kObjectives; }
  std::span<const double> lengths_of(std::size_t i) const { return std::span(lengths).subspan(3 * i, 3); }
  std::span<const double> objectives_of(std::size_t i) const {
    return std::span(objectives).subspan(kObjectives * i, kObjectives);
  }
  void add(std::span<const double> design, std::span<const double> values) {
    lengths.insert(lengths.end(), design.begin(), design.end());
    objectives.insert(objectives.end(), values.begin(), values.end());
  }
};

// Of three fronts, what remains when they are held against each other.
Designs our_front() {
  Designs all, front;
  for (const Bounds& bounds : kBounds) {
    const StudyRun found = within(bounds);
    for (std::size_t i = 0; i < found.size(); ++i) all.add(found.design(i), found.objectives(i));
  }
  for (const std::size_t i : non_dominated(all.objectives, kObjectives)) {
    front.add(all.lengths_of(i), all.objectives_of(i));
  }
  return front;
}

struct Published {
  Designs designs;
  std::vector<double> violation;  // of the worst constraint, 0 if all hold
};

Published published() {
  const std::unique_ptr<StudyModel> model = read_study_model("r-cube-kinematics", {});
  StudyEvaluator evaluator(*model);
  Published table;
  for (const Design& design : r_cube_tables::kDesigns) {
    const std::array<double, 3> row = {std::asin(kHalfWorkspace / (design.l1 * 1e-3)), design.l2 * 1e-3,
                                       design.l3 * 1e-3};
    const DesignSheet sheet = evaluator.sheet(row);
    table.designs.add(row, sheet.objectives);
    table.violation.push_back(*std::max_element(sheet.violations.begin(), sheet.violations.end()));
  }
  return table;
}

// Largest O_j/O_j,published of one of our designs.
double worst_ratio(std::span<const double> ours, std::span<const double> theirs) {
  return std::max(
      {ours[0] / theirs[0], std::pow(10.0, ours[1] - theirs[1]), std::pow(10.0, ours[2] - theirs[2])});
}

// Our design that comes nearest to a published one, or leaves it farthest behind.
struct Nearest {
  std::size_t design = 0;
  double ratio = HUGE_VAL;
};
Nearest nearest(const Designs& ours, std::span<const double> theirs) {
  Nearest best;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double ratio = worst_ratio(ours.objectives_of(i), theirs);
    if (ratio < best.ratio) best = {i, ratio};
  }
  return best;
}

// A little beyond the worst of the published designs in each objective.
std::vector<double> reference_point(const Designs& designs) {
  const ObjectiveRange range = objective_range(designs.objectives, kObjectives);
  std::vector<double> reference;
  for (std::size_t o = 0; o < kObjectives; ++o) {
    reference.push_back(range.max[o] + 0.1 * (range.max[o] - range.min[o]));
  }
  return reference;
}

class Findings {
 public:
  void under(std::string heading) { heading_ = std::move(heading); }
  SearchFinding& add(const std::string& id, std::string what, int decimals, double value) {
    list_.push_back({.id = "r-cube.search." + id,
                     .source = heading_,
                     .what = std::move(what),
                     .decimals = decimals,
                     .value = value});
    return list_.back();
  }
  std::vector<SearchFinding> take() { return std::move(list_); }

 private:
  std::string heading_;
  std::vector<SearchFinding> list_;
};

void compare_sets(Findings& findings, const Designs& ours, const Published& table) {
  const std::size_t count = table.designs.size();
  const auto within_limit = [&](double limit) {
    return static_cast<double>(std::count_if(table.violation.begin(), table.violation.end(),
                                             [limit](double violation) { return violation <= limit; }));
  };
  std::size_t beaten = 0, beaten_of_ours = 0;
  for (std::size_t p = 0; p < count; ++p) {
    bool by_ours = false;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      by_ours = by_ours || dominates(ours.objectives_of(i), table.designs.objectives_of(p));
    }
    beaten += by_ours ? 1 : 0;
  }
  for (std::size_t i = 0; i < ours.size(); ++i) {
    bool by_theirs = false;
    for (std::size_t p = 0; p < count; ++p) {
      by_theirs = by_theirs || dominates(table.designs.objectives_of(p), ours.objectives_of(i));
    }
    beaten_of_ours += by_theirs ? 1 : 0;
  }
  findings.under("Section 7.1, tables 7.1 and 7.2: the kinematic search, by the study r-cube-kinematics");
  findings.add("feasible", "designs of table 7.2 that meet the constraints", 0, within_limit(0.0));
  SearchFinding& nearly =
      findings.add("nearly_feasible", fmt::format("and within {} of them", kPublishedTolerance), 0,
                   within_limit(kPublishedTolerance));
  nearly.at_least = nearly.at_most = 40.0;
  findings.add("remaining", "of the 40, dominated by none of the 40", 0,
               static_cast<double>(non_dominated(table.designs.objectives, kObjectives).size()));
  findings.add("front", "our designs, of all three sets of bounds, all feasible", 0,
               static_cast<double>(ours.size()));
  // An independent search reached 38.
  findings.add("dominated", "designs of table 7.2 that ours dominate", 0, static_cast<double>(beaten))
      .at_least = 38.0;
  SearchFinding& none = findings.add("dominated_of_ours", "our designs that one of table 7.2 dominates", 0,
                                     static_cast<double>(beaten_of_ours));
  none.at_least = none.at_most = 0.0;
  const std::vector<double> reference = reference_point(table.designs);
  const double theirs_volume = hypervolume(table.designs.objectives, reference),
               ours_volume = hypervolume(ours.objectives, reference);
  findings.add("hypervolume_published", "hypervolume of table 7.2, in O1, log10 O2 and log10 O3", 5,
               theirs_volume);
  findings.add("hypervolume", "hypervolume of ours, up to the same reference", 5, ours_volume);
  findings.add("hypervolume_ratio", "their ratio", 3, ours_volume / theirs_volume).at_least = 1.0;
}

void compare_designs(Findings& findings, const Designs& ours, const Designs& table) {
  std::vector<double> ratios;
  for (std::size_t p = 0; p < table.size(); ++p) ratios.push_back(nearest(ours, table.objectives_of(p)).ratio);
  std::vector<double> sorted = ratios;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  findings.under("Section 7.1: smallest max_j(O_j/O_j,published) over our designs");
  // Beyond these a front has not converged.
  findings.add("ratio_median", "median of the 40 designs", 3, 0.5 * (sorted[half - 1] + sorted[half])).at_most =
      0.99;
  findings.add("ratio_worst", "worst of them", 3, sorted.back()).at_most = 1.06;
  for (std::size_t p = 0; p < ratios.size(); ++p) {
    findings.add(fmt::format("ratio.{:02}", p + 1), fmt::format("design {}", p + 1), 3, ratios[p]);
  }
}

// What the source would have had under its own weights.
void compare_choices(Findings& findings, const Designs& ours, const Designs& table) {
  findings.under("Section 7.2: in place of the published choices");
  for (const Choice& choice : r_cube_tables::kChoices) {
    const auto row = static_cast<std::size_t>(choice.design - 1);
    const Nearest best = nearest(ours, table.objectives_of(row));
    const std::span<const double> of_ours = ours.lengths_of(best.design),
                                  objectives = ours.objectives_of(best.design);
    const std::span<const double> theirs = table.objectives_of(row);
    const double l1 = kHalfWorkspace / std::sin(of_ours[0]);
    const std::string id = fmt::format("choice.weight_{:g}", choice.weight);
    findings.add(id + ".O1",
                 fmt::format("weight {:g}, design {}: {:.1f}/{:.1f}/{:.1f} mm of ours has O1 times",
                             choice.weight, choice.design, l1 * 1e3, of_ours[1] * 1e3, of_ours[2] * 1e3),
                 3, objectives[0] / theirs[0]);
    findings.add(id + ".O2", "O2 times", 3, std::pow(10.0, objectives[1] - theirs[1]));
    findings.add(id + ".O3", "O3 times", 3, std::pow(10.0, objectives[2] - theirs[2]));
  }
}

}  // namespace

std::vector<SearchFinding> r_cube_search_findings() {
  const Designs ours = our_front();
  const Published table = published();
  Findings findings;
  compare_sets(findings, ours, table);
  compare_designs(findings, ours, table.designs);
  compare_choices(findings, ours, table.designs);
  return findings.take();
}

void r_cube_section_study(Figures& figures) {
  const auto ratio = [](double range) {
    const StudyRun found = search_study("r-cube-section", {fmt::format("variable[0].max={}", range),
                                                           fmt::format("derived[0].value={}", range)});
    return found.design(0)[0];
  };
  figures.under("Section 7.3: the ratio by the study r-cube-section");
  ReproducedFigure& found = figures.add("E7.5.study", "d/D (7.5)", {"", "1", 1.0}, 3, 0.768, ratio(0.9));
  found.tolerance = 5e-3;
  read_otherwise(found, "normalised over 0..0.9", "over 0..0.9034", ratio(0.9034),
                 "the range that gives the printed digits");
}

}  // namespace zwidth
