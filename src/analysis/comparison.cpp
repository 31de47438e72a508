#include "zwidth/analysis/comparison.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "zwidth/analysis/internal/any_orientation.h"
#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/reach.h"

namespace zwidth {
namespace {

using internal::PoseFlood;
using internal::Probe;
using IndexRange = DeltaBatch::IndexRange;
using Box = std::array<IndexRange, 3>;

// The smallest of 1, 2 and 5 times a power of ten that is no smaller.
double rounded_up(double spacing) {
  const double power = std::pow(10.0, std::floor(std::log10(spacing)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= spacing * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

// How the places of a tool are found.
enum class Kind {
  probe,  // it does not turn
  map,    // of an arm
  flood,  // of a platform that turns
};

Kind kind_of(const Mechanism& mechanism) {
  if (!workspace_obstacle(mechanism)) return Kind::probe;
  return reach_obstacle(mechanism) ? Kind::flood : Kind::map;
}

// A first look at a platform.
PoseWorkspace glance(const Mechanism& mechanism) {
  PoseWorkspaceOptions options{.places = 500, .shapes = false, .turning = false};
  options.slice_points = 0;
  return pose_workspace(mechanism, options);
}

double longest_side(const Mechanism& mechanism) {
  if (kind_of(mechanism) == Kind::probe) return workspace_extents(mechanism).size().maxCoeff();
  double longest = 0.0;
  if (kind_of(mechanism) == Kind::flood) {
    for (const Interval& range : glance(mechanism).range) longest = std::max(longest, range.width());
    return longest;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 along = Vector3::Unit(axis);
    longest = std::max(longest,
                       farthest_along(mechanism, along).distance + farthest_along(mechanism, -along).distance);
  }
  return longest;
}

// Cells along the longest side that cost some seconds at most.
double affordable_cells(const Mechanism& mechanism) {
  const Kind kind = kind_of(mechanism);
  if (kind == Kind::flood) return comparison_axes(mechanism).size() == 3 ? 25.0 : 100.0;
  if (kind == Kind::map) return 100.0;
  const bool fast = Probe(mechanism).fast();
  if (internal::tool_dimension(mechanism) == 2) return fast ? 400.0 : 200.0;
  return fast ? 150.0 : 40.0;
}

// The places of a platform as the middles of cells.
PoseFlood flood_cells(const Mechanism& mechanism, double spacing, const ComparisonOptions& options,
                      const Effort& effort) {
  constexpr std::size_t kMost = 2'000'000;
  const internal::PoseGuide guide(mechanism);
  internal::PoseFloodOptions flood{
      .spacing = spacing, .offset = Vector3::Constant(0.5), .most = kMost, .exits = false};
  PoseFlood found;
  if (options.orientation) {
    const internal::PoseGuide::Step seed =
        guide.step(guide.home(), {guide.home().tool().position, *options.orientation});
    if (!seed.inside) return found;
    const internal::PoseChart chart{.origin = seed.posture->tool(), .axes = guide.moves()};
    found = flood_poses(guide, chart, *seed.posture, chart.coordinates(chart.origin.position), flood, effort);
  } else {
    found = flood_places(guide, flood, effort);
  }
  if (found.full) throw std::length_error("more than two million cells");
  return found;
}

// One device's workspace as cells: whether the middle of each is reached.
class Cells {
 public:
  Cells(const Mechanism& mechanism, const ComparisonOptions& options, double spacing, const Effort& effort)
      : spacing_(spacing) {
    if (kind_of(mechanism) == Kind::flood) {
      flood_ = flood_cells(mechanism, spacing, options, effort);
      for (std::size_t axis = 0; axis < 3; ++axis)
        box_[axis] = {0, axis == 2 && flood_->dimension == 2 ? 0 : -1};
      for (const PoseFlood::Point& point : flood_->points) {
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(flood_->dimension); ++axis) {
          const std::int64_t at = point.at[axis];
          const bool empty = internal::size(box_[axis]) == 0;
          box_[axis] = {empty ? at : std::min(box_[axis].first, at),
                        empty ? at : std::max(box_[axis].last, at)};
        }
      }
      return;
    }
    if (kind_of(mechanism) == Kind::map) {
      map_ = reach_map(mechanism, {.samples = options.reach_postures, .spacing = spacing}, effort);
      for (std::size_t axis = 0; axis < 3; ++axis)
        box_[axis] = {map_->first[axis], map_->first[axis] + map_->count[axis] - 1};
      return;
    }
    fresh_.emplace(mechanism);
    box_ = internal::lattice_box(mechanism, spacing);
    for (int axis = 0; axis < internal::tool_dimension(mechanism); ++axis) --box_[axis].first;
  }

  const Box& box() const { return box_; }
  bool complete() const { return (!map_ || map_->complete) && (!flood_ || flood_->complete); }

  // Asks cell after cell; every thread has its own.
  class Reader {
   public:
    explicit Reader(const Cells& cells) : cells_(cells) {
      if (cells.fresh_) probe_ = cells.fresh_;
    }
    void start_column() {
      if (probe_ && probe_->dimension() == 3) probe_->restart();
    }
    bool reached(std::int64_t i, std::int64_t j, std::int64_t k) {
      if (cells_.map_) return cells_.map_->at(i, j, k);
      if (cells_.flood_) {
        return cells_.flood_->place.contains(
            {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), static_cast<std::int32_t>(k)});
      }
      if (!holds(0, i) || !holds(1, j) || !holds(2, k)) return false;
      const auto middle = [this](std::int64_t index) {
        return (static_cast<double>(index) + 0.5) * cells_.spacing_;
      };
      return probe_->inverse({middle(i), middle(j), middle(k)}).inside;
    }

   private:
    bool holds(std::size_t axis, std::int64_t index) const {
      return index >= cells_.box_[axis].first && index <= cells_.box_[axis].last;
    }

    const Cells& cells_;
    std::optional<Probe> probe_;
  };

 private:
  double spacing_;
  Box box_{};
  std::optional<ReachMap> map_;
  std::optional<PoseFlood> flood_;
  std::optional<Probe> fresh_;
};

}  // namespace

std::optional<std::string> comparison_obstacle(const Mechanism& mechanism) {
  const std::optional<std::string> obstacle = workspace_obstacle(mechanism);
  if (!obstacle || !reach_obstacle(mechanism)) return std::nullopt;
  if (const auto why = pose_workspace_obstacle(mechanism)) return mechanism.tool_turns() ? why : obstacle;
  const std::size_t axes = internal::PoseGuide(mechanism).moves().size();
  if (axes < 2) return "its tool moves along fewer than two axes without turning";
  if (glance(mechanism).unbounded) return "nothing ends its workspace: give the sliding joints ranges";
  return std::nullopt;
}

std::vector<int> comparison_axes(const Mechanism& mechanism) {
  if (kind_of(mechanism) == Kind::flood) return internal::PoseGuide(mechanism).moves();
  if (kind_of(mechanism) == Kind::probe && internal::tool_dimension(mechanism) == 2) return {0, 1};
  return {0, 1, 2};
}

WorkspaceComparison compare_workspaces(const Mechanism& first, const Mechanism& second,
                                       const ComparisonOptions& options, const Effort& effort) {
  assert(!comparison_obstacle(first) && !comparison_obstacle(second) && options.spacing >= 0.0);
  assert(comparison_axes(first) == comparison_axes(second));
  WorkspaceComparison result{.dimension = static_cast<int>(comparison_axes(first).size()),
                             .spacing = options.spacing};
  if (result.spacing == 0.0) {
    // The finest that both can afford in their own boxes.
    double finest = 0.0;
    for (const Mechanism* device : {&first, &second})
      finest = std::max(finest, longest_side(*device) / affordable_cells(*device));
    if (!(finest > 0.0)) return result;
    result.spacing = rounded_up(finest);
  }
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  const Cells a(first, options, result.spacing, quiet), b(second, options, result.spacing, quiet);
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box[axis] = {std::min(a.box()[axis].first, b.box()[axis].first),
                 std::max(a.box()[axis].last, b.box()[axis].last)};
  }

  // Counts of each sublattice: reached by the first, the second, both.
  using Counts = std::array<std::array<std::int64_t, 3>, 8>;
  std::vector<Counts> layers(static_cast<std::size_t>(internal::size(box[0])), Counts{});
  const bool counted = internal::for_each_index(layers.size(), effort, [&](std::size_t layer) {
    Cells::Reader in_first(a), in_second(b);
    const std::int64_t i = box[0].first + static_cast<std::int64_t>(layer);
    for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
      in_first.start_column();
      in_second.start_column();
      for (std::int64_t k = box[2].first; k <= box[2].last; ++k) {
        const bool one = in_first.reached(i, j, k), other = in_second.reached(i, j, k);
        auto& counts = layers[layer][static_cast<std::size_t>((i & 1) + 2 * (j & 1) + 4 * (k & 1))];
        counts[0] += one;
        counts[1] += other;
        counts[2] += one && other;
      }
    }
  });
  result.complete = counted && a.complete() && b.complete();

  const std::size_t sublattices = result.dimension == 2 ? 4 : 8;
  const double cell = std::pow(result.spacing, result.dimension) * static_cast<double>(sublattices);
  const std::array<Measure*, 5> measures = {&result.first, &result.second, &result.both, &result.only_first,
                                            &result.only_second};
  std::array<std::array<double, 8>, 5> values{};
  for (std::size_t s = 0; s < sublattices; ++s) {
    std::array<std::int64_t, 3> counts{};
    for (const Counts& layer : layers) {
      for (std::size_t what = 0; what < 3; ++what) counts[what] += layer[s][what];
    }
    const std::array<std::int64_t, 5> each = {counts[0], counts[1], counts[2], counts[0] - counts[2],
                                              counts[1] - counts[2]};
    for (std::size_t f = 0; f < 5; ++f) values[f][s] = cell * static_cast<double>(each[f]);
  }
  const auto n = static_cast<double>(sublattices);
  for (std::size_t f = 0; f < 5; ++f) {
    double squares = 0.0;
    for (std::size_t s = 0; s < sublattices; ++s) measures[f]->value += values[f][s] / n;
    for (std::size_t s = 0; s < sublattices; ++s) squares += std::pow(values[f][s] - measures[f]->value, 2);
    measures[f]->error = std::sqrt(squares / (n - 1.0) / n);
  }
  return result;
}

}  // namespace zwidth
