#include "zwidth/analysis/internal/pose_flood.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "zwidth/analysis/internal/parallel.h"

namespace zwidth::internal {
namespace {

constexpr float kInside = std::numeric_limits<float>::quiet_NaN();
constexpr int kHalvings = 11;      // of the way to a neighbour outside
constexpr std::size_t kChunk = 8;  // candidates of one task

// A point next to the flood, and the fresh points that it can be reached from.
struct Candidate {
  LatticeIndex at{};
  struct From {
    std::size_t fresh;  // among the fresh ones
    int edge;           // of `Point::exit`
  };
  std::array<From, 6> from{};
  int count = 0;
  std::optional<Posture> posture = std::nullopt;
  std::array<float, 6> exit{};  // from each of `from`, if it is outside
};

}  // namespace

PoseFlood flood_poses(const PoseGuide& guide, const PoseChart& chart, const Posture& seed, const Vector3& from,
                      const PoseFloodOptions& options, const Effort& effort) {
  assert(options.spacing > 0.0);
  const double h = options.spacing;
  const int dimension = chart.dimension();
  const auto figures = static_cast<std::size_t>(options.figures);
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  PoseFlood flood{.dimension = dimension, .spacing = h};
  flood.offset.head(dimension) = options.offset.head(dimension);
  flood.values.resize(figures);
  const auto coordinates = [&flood](const LatticeIndex& at) { return flood.coordinates({.at = at}); };
  const auto lead = [&](const Posture& start, const Pose& to) {
    return options.lead ? options.lead(start, to) : guide.step(start, to);
  };

  // The points of the last round with their postures; those of earlier rounds are not needed any more.
  std::vector<std::size_t> fresh;
  std::vector<Posture> postures;
  const auto add = [&](const LatticeIndex& at, Posture posture, std::span<const double> values) {
    flood.place.emplace(at, flood.points.size());
    fresh.push_back(flood.points.size());
    flood.points.push_back({.at = at});
    flood.points.back().exit.fill(kInside);
    postures.push_back(std::move(posture));
    for (std::size_t f = 0; f < figures; ++f) flood.values[f].push_back(values[f]);
  };

  // The lattice points round the seed come first.
  std::vector<double> row(figures);
  for (int corner = 0; corner < 1 << dimension; ++corner) {
    LatticeIndex at{};
    for (int k = 0; k < dimension; ++k) {
      const double low = std::floor(from[k] / h - flood.offset[k]);
      at[k] = static_cast<std::int32_t>(low) + (corner >> k & 1);
    }
    if (flood.place.contains(at) || coordinates(at).norm() > options.most_radius) continue;
    PoseGuide::Step step = lead(seed, chart.at(coordinates(at)));
    if (!step.inside) continue;
    if (options.figure) options.figure(*step.posture, step.rates, row);
    add(at, *step.posture, row);
  }

  std::unordered_map<LatticeIndex, std::size_t, LatticeIndexHash> asked;
  std::vector<Candidate> candidates;
  std::vector<double> values;
  while (!fresh.empty() && flood.complete) {
    if (flood.points.size() >= options.most) {
      flood.full = true;
      break;
    }
    asked.clear();
    candidates.clear();
    for (std::size_t f = 0; f < fresh.size(); ++f) {
      for (int edge = 0; edge < 2 * dimension; ++edge) {
        LatticeIndex at = flood.points[fresh[f]].at;
        at[static_cast<std::size_t>(edge / 2)] += edge % 2 == 0 ? -1 : 1;
        if (flood.place.contains(at)) continue;
        const auto [place, added] = asked.emplace(at, candidates.size());
        if (added) candidates.push_back({.at = at});
        Candidate& candidate = candidates[place->second];
        candidate.from[static_cast<std::size_t>(candidate.count++)] = {f, edge};
      }
    }
    values.assign(candidates.size() * figures, 0.0);
    flood.complete = for_each_index((candidates.size() + kChunk - 1) / kChunk, quiet, [&](std::size_t chunk) {
      for (std::size_t c = chunk * kChunk; c < std::min(candidates.size(), (chunk + 1) * kChunk); ++c) {
        Candidate& candidate = candidates[c];
        const Vector3 goal = coordinates(candidate.at);
        const bool allowed = goal.norm() <= options.most_radius;
        for (int n = 0; n < candidate.count && allowed; ++n) {
          PoseGuide::Step step =
              lead(postures[candidate.from[static_cast<std::size_t>(n)].fresh], chart.at(goal));
          if (!step.inside) continue;
          if (options.figure)
            options.figure(*step.posture, step.rates, std::span(values).subspan(c * figures, figures));
          candidate.posture = std::move(step.posture);
          break;
        }
        for (int n = 0; n < candidate.count && options.exits && !candidate.posture; ++n) {
          const Candidate::From& edge = candidate.from[static_cast<std::size_t>(n)];
          Posture last = postures[edge.fresh];
          const Vector3 start = coordinates(flood.points[fresh[edge.fresh]].at);
          double in = 0.0, out = 1.0;
          for (int halving = 0; halving < kHalvings; ++halving) {
            const double middle = 0.5 * (in + out);
            const Vector3 between = start + middle * (goal - start);
            PoseGuide::Step step;
            if (between.norm() <= options.most_radius) step = lead(last, chart.at(between));
            if (step.inside) last = *step.posture;
            (step.inside ? in : out) = middle;
          }
          candidate.exit[static_cast<std::size_t>(n)] = static_cast<float>(0.5 * (in + out));
        }
      }
    });
    for (const Candidate& candidate : candidates) {
      if (candidate.posture || !options.exits) continue;
      for (int n = 0; n < candidate.count; ++n) {
        const Candidate::From& edge = candidate.from[static_cast<std::size_t>(n)];
        flood.points[fresh[edge.fresh]].exit[static_cast<std::size_t>(edge.edge)] =
            candidate.exit[static_cast<std::size_t>(n)];
      }
    }
    fresh.clear();
    postures.clear();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      Candidate& candidate = candidates[c];
      if (!candidate.posture) continue;
      add(candidate.at, *candidate.posture, std::span(values).subspan(c * figures, figures));
    }
    if (effort.progress && options.expected > 0) {
      effort.progress(
          std::min(1.0, static_cast<double>(flood.points.size()) / static_cast<double>(options.expected)));
    }
  }
  // A point that one neighbour does not lead to, another may.
  for (PoseFlood::Point& point : flood.points) {
    for (int edge = 0; edge < 2 * dimension; ++edge) {
      LatticeIndex next = point.at;
      next[static_cast<std::size_t>(edge / 2)] += edge % 2 == 0 ? -1 : 1;
      if (flood.place.contains(next)) point.exit[static_cast<std::size_t>(edge)] = kInside;
    }
  }
  return flood;
}

FloodMeasure measure(const PoseFlood& flood, const std::function<double(const Vector3&)>& weight) {
  FloodMeasure result;
  const int dimension = flood.dimension;
  const double cell = std::pow(flood.spacing, dimension);
  // Lines along each axis: all of them, and by whether their two other indices are even or odd.
  std::array<double, 3> whole{};
  std::array<std::array<double, 4>, 3> parts{};
  for (const PoseFlood::Point& point : flood.points) {
    const double value = weight ? weight(flood.coordinates(point)) : 1.0;
    for (int axis = 0; axis < dimension; ++axis) {
      double length = 0.0;
      for (const int edge : {2 * axis, 2 * axis + 1}) {
        const float exit = point.exit[static_cast<std::size_t>(edge)];
        length += std::isnan(exit) ? 0.5 : static_cast<double>(exit);
      }
      const auto odd = [&](int k) {
        return static_cast<std::size_t>(point.at[static_cast<std::size_t>((axis + k) % 3)] & 1);
      };
      whole[axis] += value * length * cell;
      parts[axis][2 * odd(1) + odd(2)] += value * length * cell;
    }
  }
  for (int axis = 0; axis < dimension; ++axis) result.value += whole[axis] / dimension;
  double squares = 0.0, spread = 0.0;
  int count = 0;
  for (int axis = 0; axis < dimension; ++axis) {
    spread = std::max(spread, std::abs(whole[axis] - result.value));
    // In a plane one of the two other indices is always 0: which, depends on the axis.
    std::array<double, 4> values = parts[axis];
    double share = 4.0;
    if (dimension == 2) share = 2.0;
    if (dimension == 1) share = 1.0;
    for (const double value : values) {
      if (value == 0.0 && dimension < 3) continue;
      squares += std::pow(share * value - whole[axis], 2);
      ++count;
    }
  }
  if (count > 0 && dimension > 1) squares /= count;
  result.error_estimate = std::max(spread, 0.5 * std::sqrt(squares));
  if (dimension == 1) result.error_estimate = flood.spacing / (1 << kHalvings);
  return result;
}

}  // namespace zwidth::internal
