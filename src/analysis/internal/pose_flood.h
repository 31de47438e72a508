#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "zwidth/analysis/internal/pose_guide.h"
#include "zwidth/analysis/workspace.h"

namespace zwidth::internal {

using LatticeIndex = std::array<std::int32_t, 3>;

struct LatticeIndexHash {
  std::size_t operator()(const LatticeIndex& at) const {
    std::uint64_t key = 0;
    for (const std::int32_t i : at) key = (key ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15ULL;
    return static_cast<std::size_t>(key ^ (key >> 32U));
  }
};

/// Lattice points of a chart, the integer multiples of `spacing` moved by `offset` of it, that a mechanism can
/// be led to from a posture, from neighbour to neighbour without leaving its joint ranges or its branch.
struct PoseFlood {
  struct Point {
    LatticeIndex at{};
    /// Where the boundary lies on the way to each neighbour, as a share of the spacing: axis by axis, first
    /// down, then up; NaN where the neighbour belongs to the flood.
    std::array<float, 6> exit{};
  };

  int dimension = 3;
  double spacing = 0.0;
  Vector3 offset = Vector3::Zero();  ///< [spacing]
  bool complete = true;              ///< false if it was cancelled
  bool full = false;                 ///< it came to `most` points and went no further
  std::vector<Point> points;
  std::vector<std::vector<double>> values;                                ///< of each figure at every point
  std::unordered_map<LatticeIndex, std::size_t, LatticeIndexHash> place;  ///< in `points`

  Vector3 coordinates(const Point& point) const {
    return spacing * (Vector3(point.at[0], point.at[1], point.at[2]) + offset);
  }
};

struct PoseFloodOptions {
  double spacing = 0.0;
  Vector3 offset = Vector3::Zero();  ///< [spacing]
  /// The short way from a posture to a pose; without, the guide's.
  std::function<PoseGuide::Step(const Posture&, const Pose&)> lead;
  std::size_t most = std::numeric_limits<std::size_t>::max();
  bool exits = true;  ///< look for the boundary
  /// Coordinates farther than this from zero are left out.
  double most_radius = std::numeric_limits<double>::infinity();
  int figures = 0;
  /// Fills a value per figure.
  std::function<void(const Posture&, const Rates&, std::span<double>)> figure;
  std::size_t expected = 0;  ///< points, for progress; 0: not known
};

/// From `seed`, whose coordinates are `from`. The same for any number of threads. REQUIRES: spacing > 0.
PoseFlood flood_poses(const PoseGuide& guide, const PoseChart& chart, const Posture& seed, const Vector3& from,
                      const PoseFloodOptions& options, const Effort& effort);

/// Integral of a weight over what the flood found: the mean over the axes of summing up the lines along each
/// one between their exits; with an error estimate, the larger of how those differ, and half of how every
/// second line alone does. Without `weight` it is 1.
struct FloodMeasure {
  double value = 0.0;
  double error_estimate = 0.0;
};
FloodMeasure measure(const PoseFlood& flood, const std::function<double(const Vector3&)>& weight = {});

}  // namespace zwidth::internal
