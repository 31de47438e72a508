#include "zwidth/design/pareto.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <pagmo/utils/hypervolume.hpp>

namespace zwidth {
namespace {

constexpr double kLargestObjective = 1e29;
constexpr double kBroken = 1e30;       // an infeasible design, above every feasible one
constexpr double kMostBroken = 1e100;  // violations beyond count as equal, to stay below
constexpr double kUndefined = 1e140;   // an undefined one, above every infeasible one

std::span<const double> row(std::span<const double> values, std::size_t objectives, std::size_t index) {
  return values.subspan(index * objectives, objectives);
}

[[maybe_unused]] bool none_is_nan(std::span<const double> values) {
  return std::none_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
}

std::size_t rows_of(std::span<const double> values, std::size_t objectives) {
  assert(objectives > 0 && values.size() % objectives == 0);
  return values.size() / objectives;
}

}  // namespace

// ------------------------------------------------------------------------------------------------ domination

bool dominates(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  bool better = false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(a[k] <= b[k])) return false;
    better = better || a[k] < b[k];
  }
  return better;
}

std::vector<std::size_t> non_dominated(std::span<const double> values, std::size_t objectives) {
  const std::size_t count = rows_of(values, objectives);
  assert(none_is_nan(values));
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  // In lexicographic order a row can only be dominated by one before it, and then by one that is kept.
  const auto at = [&](std::size_t index) { return row(values, objectives, index); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto first = at(a), second = at(b);
    const auto [p, q] = std::mismatch(first.begin(), first.end(), second.begin());
    return p == first.end() ? a < b : *p < *q;
  });
  std::vector<std::size_t> kept;
  for (const std::size_t index : order) {
    // The latest ones are the nearest in the first objective, hence tried first.
    const bool beaten = std::any_of(kept.rbegin(), kept.rend(),
                                    [&](std::size_t other) { return dominates(at(other), at(index)); });
    if (!beaten) kept.push_back(index);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

Standing standing(std::span<const double> outcomes, std::size_t objectives) {
  assert(objectives > 0 && objectives <= outcomes.size());
  Standing result;
  for (const double constraint : outcomes.subspan(objectives)) {
    if (std::isnan(constraint)) {
      ++result.undefined;
    } else {
      result.violation += std::max(0.0, constraint);
    }
  }
  if (result.feasible()) {
    for (const double objective : outcomes.first(objectives)) result.undefined += std::isnan(objective) ? 1 : 0;
  }
  return result;
}

bool constraint_dominates(std::span<const double> a, std::span<const double> b, std::size_t objectives) {
  const Standing first = standing(a, objectives), second = standing(b, objectives);
  if (first.feasible() && second.feasible()) return dominates(a.first(objectives), b.first(objectives));
  return first.better_than(second);
}

void unconstrained_image(std::span<const double> outcomes, std::span<double> image) {
  const std::size_t objectives = image.size();
  const Standing place = standing(outcomes, objectives);
  if (place.feasible()) {
    for (std::size_t k = 0; k < objectives; ++k) {
      image[k] = std::clamp(outcomes[k], -kLargestObjective, kLargestObjective);
    }
    return;
  }
  const double violation = std::min(place.violation, kMostBroken);
  const double value =
      place.undefined == 0
          ? kBroken * (1.0 + violation)
          : kUndefined * (2.0 * static_cast<double>(place.undefined) + violation / (1.0 + violation));
  std::fill(image.begin(), image.end(), value);
}

std::vector<std::vector<std::size_t>> pareto_fronts(std::span<const double> values, std::size_t objectives,
                                                    std::span<const double> violations) {
  const std::size_t count = rows_of(values, objectives);
  assert(violations.empty() || violations.size() == count);
  assert(none_is_nan(values) && none_is_nan(violations));
  const auto beats = [&](std::size_t a, std::size_t b) {
    const double first = violations.empty() ? 0.0 : std::max(0.0, violations[a]);
    const double second = violations.empty() ? 0.0 : std::max(0.0, violations[b]);
    if (first > 0.0 || second > 0.0) return first < second;
    return dominates(row(values, objectives, a), row(values, objectives, b));
  };
  std::vector<std::vector<std::size_t>> beaten(count);  // S_p of the paper
  std::vector<std::size_t> beaters(count, 0);           // n_p
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (beats(a, b)) {
        beaten[a].push_back(b);
        ++beaters[b];
      } else if (beats(b, a)) {
        beaten[b].push_back(a);
        ++beaters[a];
      }
    }
  }
  std::vector<std::vector<std::size_t>> fronts;
  std::vector<std::size_t> front;
  for (std::size_t index = 0; index < count; ++index) {
    if (beaters[index] == 0) front.push_back(index);
  }
  while (!front.empty()) {
    std::vector<std::size_t> next;
    for (const std::size_t index : front) {
      for (const std::size_t other : beaten[index]) {
        if (--beaters[other] == 0) next.push_back(other);
      }
    }
    std::sort(next.begin(), next.end());
    fronts.push_back(std::move(front));
    front = std::move(next);
  }
  return fronts;
}

std::vector<double> crowding_distances(std::span<const double> values, std::size_t objectives) {
  const std::size_t count = rows_of(values, objectives);
  assert(none_is_nan(values));
  std::vector<double> distance(count, 0.0);
  std::vector<std::size_t> order(count);
  for (std::size_t k = 0; k < objectives && count > 0; ++k) {
    const auto value = [&](std::size_t index) { return values[index * objectives + k]; };
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return value(a) < value(b); });
    distance[order.front()] = distance[order.back()] = std::numeric_limits<double>::infinity();
    const double range = value(order.back()) - value(order.front());
    if (!(range > 0.0)) continue;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      distance[order[i]] += (value(order[i + 1]) - value(order[i - 1])) / range;
    }
  }
  return distance;
}

double hypervolume(std::span<const double> values, std::span<const double> reference) {
  const std::size_t objectives = reference.size();
  const std::size_t count = rows_of(values, objectives);
  assert(none_is_nan(values) && none_is_nan(reference));
  std::vector<std::vector<double>> points;
  for (std::size_t index = 0; index < count; ++index) {
    const auto point = row(values, objectives, index);
    if (std::equal(point.begin(), point.end(), reference.begin(), std::less<>())) {
      points.emplace_back(point.begin(), point.end());
    }
  }
  if (points.empty()) return 0.0;
  if (objectives == 1) return reference[0] - std::min_element(points.begin(), points.end())->front();
  // Not verified: that costs as much again, and the points were just looked at.
  pagmo::hypervolume volume(points, false);
  volume.set_copy_points(false);
  return volume.compute({reference.begin(), reference.end()});
}

// -------------------------------------------------------------------------------------------------- choosing

ObjectiveRange objective_range(std::span<const double> values, std::size_t objectives) {
  const std::size_t count = rows_of(values, objectives);
  assert(none_is_nan(values));
  ObjectiveRange range{std::vector<double>(objectives, std::numeric_limits<double>::infinity()),
                       std::vector<double>(objectives, -std::numeric_limits<double>::infinity())};
  for (std::size_t index = 0; index < count; ++index) {
    for (std::size_t k = 0; k < objectives; ++k) {
      range.min[k] = std::min(range.min[k], values[index * objectives + k]);
      range.max[k] = std::max(range.max[k], values[index * objectives + k]);
    }
  }
  return range;
}

std::vector<double> normalised(std::span<const double> values, std::size_t objectives) {
  const ObjectiveRange range = objective_range(values, objectives);
  std::vector<double> result(values.begin(), values.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double min = range.min[i % objectives], width = range.max[i % objectives] - min;
    result[i] = width > 0.0 ? (result[i] - min) / width : 0.0;
  }
  return result;
}

std::vector<double> weighted_rms(std::span<const double> values, std::size_t objectives,
                                 std::span<const double> weights) {
  assert(weights.size() == objectives);
  const std::vector<double> p = normalised(values, objectives);
  std::vector<double> result(rows_of(values, objectives), 0.0);
  for (std::size_t i = 0; i < p.size(); ++i) result[i / objectives] += weights[i % objectives] * p[i] * p[i];
  for (double& value : result) value = std::sqrt(value / static_cast<double>(objectives));
  return result;
}

std::vector<double> topsis(std::span<const double> values, std::size_t objectives,
                           std::span<const double> weights) {
  assert(weights.size() == objectives);
  const std::size_t count = rows_of(values, objectives);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> scale(objectives, 0.0);  // w_k / |column k|
  for (std::size_t k = 0; k < objectives; ++k) {
    double squares = 0.0;
    for (std::size_t index = 0; index < count; ++index) {
      squares += values[index * objectives + k] * values[index * objectives + k];
    }
    scale[k] = squares > 0.0 ? weights[k] / total / std::sqrt(squares) : 0.0;
  }
  const ObjectiveRange range = objective_range(values, objectives);
  std::vector<double> closeness(count);
  for (std::size_t index = 0; index < count; ++index) {
    double to_best = 0.0, to_worst = 0.0;  // squares of S* and S-
    for (std::size_t k = 0; k < objectives; ++k) {
      const double value = values[index * objectives + k];
      to_best += std::pow(scale[k] * (value - range.min[k]), 2);
      to_worst += std::pow(scale[k] * (range.max[k] - value), 2);
    }
    const double best = std::sqrt(to_best), worst = std::sqrt(to_worst);
    closeness[index] = best + worst > 0.0 ? worst / (best + worst) : 1.0;  // all rows the same
  }
  return closeness;
}

std::optional<std::size_t> knee(std::span<const double> values, std::size_t objectives) {
  const std::size_t count = rows_of(values, objectives);
  const std::vector<double> all = normalised(values, objectives);
  // Objectives that are the same everywhere have no extreme rows of their own.
  std::vector<std::size_t> varying;
  for (std::size_t k = 0; k < objectives; ++k) {
    for (std::size_t index = 0; index < count; ++index) {
      if (all[index * objectives + k] == 0.0) continue;
      varying.push_back(k);
      break;
    }
  }
  const auto n = static_cast<Eigen::Index>(varying.size());
  if (n < 2) return std::nullopt;
  Eigen::MatrixXd p(n, static_cast<Eigen::Index>(count));
  for (Eigen::Index index = 0; index < p.cols(); ++index) {
    for (Eigen::Index k = 0; k < n; ++k) {
      p(k, index) = all[static_cast<std::size_t>(index) * objectives + varying[static_cast<std::size_t>(k)]];
    }
  }
  // The extreme row of an objective: the best in it, and of those the nearest to the ideal in the others.
  Eigen::MatrixXd extremes(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index best = 0;
    for (Eigen::Index index = 1; index < p.cols(); ++index) {
      const double difference = p(k, index) - p(k, best);
      if (difference < 0.0 || (difference == 0.0 && p.col(index).sum() < p.col(best).sum())) best = index;
    }
    extremes.row(k) = p.col(best).transpose();
  }
  // The hyperplane a . p = 1 through them; the ideal point lies at a . p = 0.
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(extremes);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::VectorXd a = lu.solve(Eigen::VectorXd::Ones(n));
  std::optional<std::size_t> farthest;
  double distance = 1e-12 * std::max(1.0, a.norm());  // beyond rounding
  for (Eigen::Index index = 0; index < p.cols(); ++index) {
    const double beyond = 1.0 - a.dot(p.col(index));
    if (beyond > distance) {
      distance = beyond;
      farthest = static_cast<std::size_t>(index);
    }
  }
  return farthest;
}

}  // namespace zwidth
