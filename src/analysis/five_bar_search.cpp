#include "zwidth/analysis/five_bar_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>

#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/mechanism/batch_five_bar.h"

namespace zwidth {
namespace {

constexpr double kStepSlack = 1e-9;  // share of a step by which an end may be missed and still count
constexpr double kMostPoints = 2e7;
constexpr double kMostDesigns = 1e8;

std::int64_t angle_count(const PolarSampling& sampling) {
  const double steps = sampling.angle_span / sampling.angle_step;
  const bool full = sampling.angle_span > 2.0 * std::numbers::pi - 1e-9;
  // Half open for a full turn: its end is its beginning.
  return full ? static_cast<std::int64_t>(std::ceil(steps - kStepSlack))
              : static_cast<std::int64_t>(std::floor(steps + kStepSlack)) + 1;
}

std::int64_t circle_count(const PolarSampling& sampling, double reach) {
  return static_cast<std::int64_t>(std::floor(reach / sampling.radius_step + kStepSlack));
}

std::vector<double> values_of(const LengthRange& range) {
  const double width = range.last - range.first;
  if (!std::isfinite(width) || width < 0.0 || (width > 0.0 && !(range.step > 0.0))) {
    throw std::invalid_argument("a range of lengths goes from small to large in positive steps");
  }
  const double steps = width > 0.0 ? std::floor(width / range.step + kStepSlack) : 0.0;
  if (steps > kMostDesigns) throw std::length_error("a range of lengths has more than 10^8 values");
  std::vector<double> values;
  for (double i = 0.0; i <= steps; ++i) values.push_back(range.first + i * range.step);
  return values;
}

}  // namespace

PolarPoints polar_points(const PolarSampling& sampling, double reach) {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!positive(sampling.radius_step) || !positive(sampling.angle_step) || !positive(sampling.angle_span) ||
      sampling.angle_span > 2.0 * std::numbers::pi + 1e-9) {
    throw std::invalid_argument("a polar sampling has positive steps and spans at most a full turn");
  }
  const double most =
      std::max(reach, 0.0) / sampling.radius_step * (sampling.angle_span / sampling.angle_step + 1.0);
  if (!(most <= kMostPoints)) throw std::length_error("a polar sampling has more than 2 10^7 points");
  PolarPoints points;
  points.radius_step = sampling.radius_step;
  points.per_circle = angle_count(sampling);
  std::vector<double> cosine, sine;
  for (std::int64_t j = 0; j < points.per_circle; ++j) {
    cosine.push_back(std::cos(static_cast<double>(j) * sampling.angle_step));
    sine.push_back(std::sin(static_cast<double>(j) * sampling.angle_step));
  }
  const std::int64_t circles = circle_count(sampling, reach);
  for (std::int64_t k = 1; k <= circles; ++k) {
    const double radius = static_cast<double>(k) * sampling.radius_step;
    for (std::size_t j = 0; j < cosine.size(); ++j) {
      points.x.push_back(radius * cosine[j]);
      points.y.push_back(radius * sine[j]);
    }
  }
  return points;
}

std::size_t PolarPoints::within(double reach) const {
  const auto circles = static_cast<std::int64_t>(std::floor(reach / radius_step + kStepSlack));
  return std::min(size(), static_cast<std::size_t>(std::max<std::int64_t>(circles, 0) * per_circle));
}

const char* symbol(ConditionClass condition_class) {
  switch (condition_class) {
    case ConditionClass::below_5:
      return "plus";
    case ConditionClass::from_5_to_10:
      return "asterisk";
    case ConditionClass::from_10_to_100:
      return "square";
    case ConditionClass::above_100:
      break;
  }
  return "diamond";
}

ConditionCensus condition_census(const FiveBarGeometry& geometry, WorkingMode mode,
                                 const PolarSampling& sampling) {
  const PolarPoints points = polar_points(sampling, geometry.crank + geometry.coupler);
  std::vector<double> K(points.size());
  FiveBarBatch(geometry, mode).condition_numbers(points.x, points.y, K);
  ConditionCensus census;
  census.points = static_cast<std::int64_t>(K.size());
  for (std::size_t p = 0; p < K.size(); ++p) {
    if (std::isnan(K[p])) continue;
    ++census.reachable;
    if (std::isinf(K[p])) {
      ++census.singular;
      continue;
    }
    ++census.count[static_cast<std::size_t>(condition_class(K[p]))];
    if (K[p] > census.largest) {
      census.largest = K[p];
      census.largest_at = {points.x[p], points.y[p]};
    }
  }
  return census;
}

std::optional<Interval> dexterous_annulus(const FiveBarGeometry& geometry, WorkingMode mode, double limit,
                                          const PolarSampling& sampling) {
  const PolarPoints points = polar_points(sampling, geometry.crank + geometry.coupler);
  std::vector<double> K(points.size());
  FiveBarBatch(geometry, mode).condition_numbers(points.x, points.y, K);
  const std::int64_t circles =
      points.per_circle > 0 ? static_cast<std::int64_t>(K.size()) / points.per_circle : 0;
  std::int64_t best_first = 0, best = 0, first = 0;
  for (std::int64_t k = 0; k < circles; ++k) {
    const auto circle = std::span(K).subspan(static_cast<std::size_t>(k * points.per_circle),
                                             static_cast<std::size_t>(points.per_circle));
    const bool good = std::all_of(circle.begin(), circle.end(), [&](double one) { return one < limit; });
    if (!good) first = k + 1;
    if (k + 1 - first > best) {
      best = k + 1 - first;
      best_first = first;
    }
  }
  if (best == 0) return std::nullopt;
  return Interval{static_cast<double>(best_first + 1) * sampling.radius_step,
                  static_cast<double>(best_first + best) * sampling.radius_step};
}

std::vector<std::pair<double, std::int64_t>> FiveBarSearchResult::fewest_by_base() const {
  std::map<double, std::int64_t> fewest;
  for (const FiveBarScore& design : designs) {
    const auto [at, added] = fewest.emplace(design.lengths[2], design.bad);
    if (!added) at->second = std::min(at->second, design.bad);
  }
  return {fewest.begin(), fewest.end()};
}

FiveBarBatch::Count badly_conditioned(const FiveBarGeometry& geometry, WorkingMode mode,
                                      const PolarPoints& points, double limit) {
  if (!can_assemble(geometry)) return {};
  const std::size_t used = points.within(geometry.crank + geometry.coupler);
  return FiveBarBatch(geometry, mode)
      .count_above(std::span(points.x).first(used), std::span(points.y).first(used), limit);
}

FiveBarSearchResult search_five_bars(const FiveBarSearch& search, const Effort& effort) {
  const std::vector<double> a1 = values_of(search.crank), a2 = values_of(search.coupler),
                            a3 = values_of(search.base);
  const double count =
      static_cast<double>(a1.size()) * static_cast<double>(a2.size()) * static_cast<double>(a3.size());
  if (count > kMostDesigns) throw std::length_error("a search has more than 10^8 designs");
  const PolarPoints points = polar_points(search.sampling, a1.back() + a2.back());

  // One task per pair of crank and coupler; the designs keep their order.
  const std::size_t tasks = a1.size() * a2.size();
  std::vector<FiveBarScore> scores(tasks * a3.size());
  const bool complete = internal::for_each_index(tasks, effort, [&](std::size_t task) {
    const double crank = a1[task / a2.size()], coupler = a2[task % a2.size()];
    for (std::size_t b = 0; b < a3.size(); ++b) {
      FiveBarScore& score = scores[task * a3.size() + b];
      score.lengths = {crank, coupler, a3[b]};
      score.geometry = {
          .crank = crank, .coupler = coupler, .half_base = search.base_is_half ? a3[b] : 0.5 * a3[b]};
      const FiveBarBatch::Count found = badly_conditioned(score.geometry, search.mode, points, search.limit);
      if (found.reachable == 0) continue;
      score.reachable = found.reachable;
      score.singular = found.singular;
      score.bad = found.above + (search.count_singular ? found.singular : 0);
      score.inscribed_radius = std::min(crank, coupler);
    }
  });

  FiveBarSearchResult result;
  result.search = search;
  result.complete = complete;
  for (const FiveBarScore& score : scores) {
    if (score.reachable == 0) continue;
    result.points += static_cast<std::int64_t>(points.within(score.geometry.crank + score.geometry.coupler));
    result.designs.push_back(score);
  }
  for (std::size_t d = 0; d < result.designs.size(); ++d) {
    const FiveBarScore& design = result.designs[d];
    if (!result.optimum.empty()) {
      const std::int64_t fewest = result.designs[result.optimum.front()].bad;
      if (design.bad > fewest) continue;
      if (design.bad < fewest) result.optimum.clear();
    }
    result.optimum.push_back(d);
  }
  for (const std::size_t d : result.optimum) {
    if (!result.selected ||
        result.designs[d].inscribed_radius > result.designs[*result.selected].inscribed_radius) {
      result.selected = d;
    }
  }
  return result;
}

}  // namespace zwidth
