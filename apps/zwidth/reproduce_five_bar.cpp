#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "reproduction.h"
#include "study.h"

#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/five_bar.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/mobility.h"

/// The figures of Singh, Saha and Manivannan, in the order of the paper. It prints few numbers, and gives
/// neither working mode nor sampling, so most of them need a reading.

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kCentimetre = 0.01;
const PrintedUnit kCount{"", "1", 1.0}, kCentimetreUnit{"cm", "m", kCentimetre};

// Table 1, on a sampling of its workspace.
FiveBarSearchResult table_1(double radius_step, double angle_step_degrees) {
  const double cm = kCentimetre;
  return search_five_bars(
      {.crank = {9.0 * cm, 12.0 * cm, cm},
       .coupler = {11.0 * cm, 15.0 * cm, cm},
       .base = {3.0 * cm, 5.0 * cm, cm},
       .sampling = {.radius_step = radius_step, .angle_step = angle_step_degrees * kDegree}});
}

std::string in_centimetres(const FiveBarScore& design) {
  return fmt::format("({:.0f}, {:.0f}, {:.0f})", design.lengths[0] / kCentimetre,
                     design.lengths[1] / kCentimetre, design.lengths[2] / kCentimetre);
}

std::string winners(const FiveBarSearchResult& result) {
  std::string all;
  for (const std::size_t d : result.optimum) {
    all += (all.empty() ? "" : " and ") + in_centimetres(result.designs[d]);
  }
  return fmt::format("{} with {} points", all, result.designs[result.optimum.front()].bad);
}

double condition_number(const FiveBarGeometry& geometry, const Vector2& position) {
  const FiveBarInverse pose = five_bar_inverse(geometry, position);
  if (pose.status != SolveStatus::reached && pose.status != SolveStatus::degraded) return std::nan("");
  return FiveBarState(geometry, pose.theta, position).condition_number();
}

// Mean condition number along a line of constant y, over the points in reach and the x that are asked for.
double mean_condition(const FiveBarGeometry& geometry, double y, double step, double limit) {
  double sum = 0.0;
  int count = 0;
  const int most = static_cast<int>(std::floor(limit / step + 1e-9));
  for (int i = -most; i <= most; ++i) {
    const double K = condition_number(geometry, {i * step, y});
    if (!std::isfinite(K)) continue;
    sum += K;
    ++count;
  }
  return sum / count;
}

double condition_ratio(const FiveBarGeometry& geometry, double step, double upper_limit) {
  const double all = geometry.crank + geometry.coupler;
  return mean_condition(geometry, 0.03, step, all) / mean_condition(geometry, 0.18, step, upper_limit);
}

// The mean over all x in reach, as an integral. K grows as 1/sqrt towards the ends; in t, with x = middle -
// half width cos(pi t), its integrand is smooth.
double mean_condition(const FiveBarGeometry& geometry, double y) {
  const double core = std::abs(geometry.crank - geometry.coupler), reach = geometry.crank + geometry.coupler;
  const double first = y < core ? std::sqrt((core - y) * (core + y)) + geometry.half_base : 0.0;
  const double last = std::sqrt((reach - y) * (reach + y)) - geometry.half_base;
  constexpr int kPoints = 2000;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double t = std::numbers::pi * (i + 0.5) / kPoints;
    const double x = 0.5 * (first + last) - 0.5 * (last - first) * std::cos(t);
    sum += condition_number(geometry, {x, y}) * std::sin(t);
  }
  return sum * 0.5 * std::numbers::pi / kPoints;
}

void kinematic_figures(Figures& figures, const Description& description, const FiveBarGeometry& g) {
  const Vector2 somewhere(0.02, 0.14);
  const Vector2 theta = five_bar_inverse(g, somewhere).theta;
  figures.under("Section 3: kinematics");
  const Mechanism mechanism(description);
  const Solution posture = solve_forward(mechanism, ActiveVector(theta));
  figures.add("S2.freedoms", "degrees of freedom", kCount, 0, 2, mobility(*posture.posture).freedoms);
  figures.add("S3.1.solutions", "inverse kinematics, solutions", kCount, 0, 4,
              five_bar_inverse_all(g, somewhere).count);
  figures.add("S3.2.solutions", "forward kinematics, solutions", kCount, 0, 2,
              five_bar_forward_count(g, theta).value_or(-1));

  // det Jtheta on the circles (6)-(9), as the sine of the straight leg's elbow, at a crank angle of 0.7 rad.
  constexpr double kCrank = 0.7;
  const Vector2 along(std::cos(kCrank), std::sin(kCrank));
  for (int equation = 6; equation <= 9; ++equation) {
    const int leg = equation % 2 == 0 ? 0 : 1;
    const double reach = equation < 8 ? g.crank + g.coupler : g.crank - g.coupler;
    const Vector2 C = Vector2(leg == 0 ? -g.half_base : g.half_base, 0.0) + reach * along;
    const FiveBarState state(g, {kCrank, kCrank}, C);
    figures
        .add(fmt::format("E{}", equation),
             fmt::format("({}): J_theta of the {} leg, over r1 r2", equation, leg == 0 ? "left" : "right"),
             kCount, 0, 0, std::abs(state.inverse_singularity()[leg]))
        .tolerance = 1e-12;
  }
  // Section 3.4.2 with lengths at which both cases exist.
  const FiveBarGeometry sample{.crank = 1.2, .coupler = 1.0, .half_base = 0.8};
  const double together = std::acos(sample.half_base / sample.crank);
  const Vector2 meet(together, std::numbers::pi - together);
  const Vector2 B(0.0, sample.crank * std::sin(together));
  figures
      .add("S3.4.2.case1", "case 1, B1 = B2: det J_p, over r2^2", kCount, 0, 0,
           std::abs(FiveBarState(sample, meet, B + sample.coupler * along).direct_singularity()))
      .tolerance = 1e-12;
  const Vector2 cranks(0.4, 2.0);
  const Vector2 middle =
      0.5 * sample.crank *
      Vector2(std::cos(cranks[0]) + std::cos(cranks[1]), std::sin(cranks[0]) + std::sin(cranks[1]));
  figures
      .add("S3.4.2.case2", "case 2, B1-C-B2 straight: det J_p, over r2^2", kCount, 0, 0,
           std::abs(FiveBarState(sample, cranks, middle).direct_singularity()))
      .tolerance = 1e-12;
}

void search_figures(Figures& figures, const FiveBarSearchResult& published, const FiveBarSearchResult& fine) {
  const std::string reading =
      "circles 1 cm apart with a point every 2 deg, elbows outwards, a3 half the base, singular points not "
      "counted; of equal designs the one with the larger r_MIC";
  const std::string how = "points every 0.1 cm and 0.5 deg";
  const FiveBarScore& selected = published.designs[*published.selected];
  const FiveBarScore& finest = fine.designs[*fine.selected];
  figures.under("Table 1 and section 5.1: the search");
  read_otherwise(figures.add("T1.architectures", "designs with the fewest points", kCount, 0, 2,
                             static_cast<double>(published.optimum.size())),
                 reading, "finer", static_cast<double>(fine.optimum.size()), how);
  const FiveBarScore& first = published.designs[published.optimum.front()];
  const std::array<std::string, 3> names = {"a1", "a2", "a3"};
  constexpr std::array<double, 3> kOther = {9, 14, 3}, kSelected = {10, 15, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    figures.add("S5.1.other_" + names[i], names[i] + " of the other one", kCentimetreUnit, 0, kOther[i],
                first.lengths[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    read_otherwise(figures.add("T1." + names[i], names[i] + " of the optimum", kCentimetreUnit, 0, kSelected[i],
                               selected.lengths[i]),
                   reading, "finer", finest.lengths[i], how);
  }
  const auto fewest = published.fewest_by_base();
  const auto best = std::min_element(fewest.begin(), fewest.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  figures.add("F6.a3", "a3 with the fewest points", kCentimetreUnit, 0, 3, best->first);
}

// The same by the study, whose search knows nothing of five-bars.
void study_figures(Figures& figures) {
  const StudyRun found = search_study("five-bar-grid", {});
  const DesignSheet best = StudyEvaluator(*found.model).sheet(found.design(0));  // the fewest points
  figures.under("Section 5.1: the search, by the study five-bar-grid");
  constexpr std::array<double, 3> kSelected = {10, 15, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    figures.add("S5.1.study_" + best.variables[i].name, best.variables[i].name + " of the optimum",
                kCentimetreUnit, 0, kSelected[i], best.variables[i].value);
  }
}

std::vector<Erratum> not_reproduced(const FiveBarGeometry& g, const ConditionCensus& census) {
  const PolarSampling circles{.radius_step = 0.005, .angle_step = kDegree};
  PolarSampling upper_halves = circles;
  upper_halves.angle_span = std::numbers::pi;
  const auto selected = dexterous_annulus(normalised_lengths(g), {}, 5.0, circles);
  const auto nearest =
      dexterous_annulus(normalised_lengths({1.15, 1.20, 0.65}), {.left = -1, .right = 1}, 5.0, upper_halves);
  const double all = g.crank + g.coupler;
  return {
      {"Section 4.1, figure 5", "dexterous annulus from 0.9 to 1.7",
       fmt::format("{:.2f} to {:.2f} for the selected design", selected->min, selected->max),
       fmt::format(
           "the lengths behind the figure are not given. Of all lengths in steps of 0.05, 1.15/1.20/0.65 "
           "comes nearest, above the base and with the elbows inwards: {:.2f} to {:.2f}.",
           nearest->min, nearest->max)},
      {"Section 5", "K rises from 5 to 1000 along the boundaries",
       fmt::format("without bound; largest finite K of the sampled points {:.0f}", census.largest),
       fmt::format(
           "K is infinite on the boundary itself ({} sampled points lie on it), and so large beside it as the "
           "sampling comes near.",
           census.singular)},
      {"Section 6", "K at y = 3 is on average 1.5 times that at y = 18",
       fmt::format("{:.2f} times", mean_condition(g, 0.03) / mean_condition(g, 0.18)),
       fmt::format(
           "means over all x in reach. The step matters, as the ends dominate: {:.2f}, {:.2f} and {:.2f} for "
           "1, 0.5 and 0.1 cm. {:.2f} comes out with 1 cm if y = 18 is followed to |x| = 10 cm only, which the "
           "paper does not say.",
           condition_ratio(g, 0.01, all), condition_ratio(g, 0.005, all), condition_ratio(g, 0.001, all),
           condition_ratio(g, 0.01, 0.10))},
      {"Figures 6, 7 and 9", "curves without numbers", "not compared", "the text gives no values."},
  };
}

std::vector<Erratum> errata(const FiveBarGeometry& g, const FiveBarSearchResult& published,
                            const FiveBarSearchResult& fine) {
  const FiveBarInscribedCircle circle = *inscribed_circle(g);
  // y_MIC as printed: a minus before |a1 - a2|, and a3 halved.
  const double printed_y = std::sqrt(std::pow(g.crank + g.coupler - std::abs(g.crank - g.coupler), 2) / 4.0 -
                                     std::pow(g.half_base / 2.0, 2));
  const double overlap = std::abs(g.crank - g.coupler) - (std::hypot(g.half_base, printed_y) - circle.radius);
  int first = 0, second = 0;
  for (const FiveBarScore& design : published.designs) {
    const FiveBarConditions conditions = avoidance_conditions(design.geometry);
    first += conditions.elbows_can_coincide ? 0 : 1;
    second += conditions.couplers_can_align ? 0 : 1;
  }
  const double meet = std::sqrt((g.crank - g.half_base) * (g.crank + g.half_base));
  const FiveBarSearchResult middle = table_1(kCentimetre, 1.0);
  return {
      {"Section 3.2, (4)", "x = d y + e and what d and e are, lost", "elimination of (1) and (2)",
       "forward after inverse kinematics gives the point back to rounding. The elimination divides by zero "
       "where the "
       "elbows are above each other; zwidth intersects the two circles instead."},
      {"(10), sections 4.1 and 6", "tau = J^T f with the J of (5)", "tau = J^-T f",
       "(5) defines thetadot = J pdot, the inverse of the usual Jacobian; virtual work."},
      {"Section 6", "\"Eq. 13\"; f^T f = tau^T (J J^T)^-1", "(10); f^T f = tau^T J J^T tau",
       "a factor tau is missing, and J is the inverse one."},
      {"Section 4.1", "axes of the ellipse along the eigenvectors of J J^T", "of J^T J",
       "the lengths agree, the directions do not."},
      {"Section 5, y_MIC", fmt::format("minus |a1 - a2|: {:.2f} cm", printed_y * 100.0),
       fmt::format("plus: {:.2f} cm", circle.centre_y * 100.0),
       fmt::format("the printed circle overlaps the inner boundary by {:.1f} cm.", overlap * 100.0)},
      {"Sections 3 and 5", "a3 half the base in (1)-(9), all of it in y_MIC", "half",
       "the equations define it. The search agrees, but so do coarser arcs with the full base."},
      {"Section 3.4.3", "conditions (a)-(e) avoid the singularities",
       fmt::format("the selected design violates (a): its elbows can meet at (0, ±{:.4f}) cm", meet * 100.0),
       fmt::format("{} of the 60 designs meet (a), {} meet (b). With the elbows outwards it happens below the "
                   "base only.",
                   first, second)},
      {"Section 5.1", "an optimum of the mechanism", "one of the sampling",
       fmt::format("1 cm and 1 deg give {}; 0.1 cm and 0.5 deg {}.", winners(middle), winners(fine))},
      {"Section 4.1", "K = 100 belongs to no class", "square", "chosen."},
      {"Section 6", "ellipses at y = 3", fmt::format("none for |x| < {:.0f} cm", std::sqrt(1.0 * 25 - 9) + 3.0),
       "both legs are folded there beyond their reach."},
  };
}

}  // namespace

Reproduction reproduce_five_bar(const Catalogue& catalogue) {
  const Description description = read_description("five-bar", {}, catalogue);
  const FiveBarGeometry g = five_bar_geometry(std::get<FiveBarDescription>(description.mechanism));
  const FiveBarSearchResult published = table_1(kCentimetre, 2.0), fine = table_1(0.1 * kCentimetre, 0.5);
  const ConditionCensus census =
      condition_census(g, {}, {.radius_step = kCentimetre, .angle_step = 2.0 * kDegree});
  Figures figures("five-bar");
  kinematic_figures(figures, description, g);
  search_figures(figures, published, fine);
  study_figures(figures);
  return {
      .device = "five-bar",
      .source = "Singh, Saha & Manivannan, Synthesis of Two Degrees-of-Freedom Haptic Device",
      .figures = figures.take(),
      .not_reproduced = not_reproduced(g, census),
      .errata = errata(g, published, fine),
      .measured_only = {"Figure 10, the prototype: no dimensions, motors, masses or measurements are given"}};
}

}  // namespace zwidth
