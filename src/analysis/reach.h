#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/mechanism.h"

/// Where the tool point of a serial arm can be, whatever the orientation of the tool: for arms with any number
/// of joints, redundant ones too. All coordinates in the base frame.

namespace zwidth {

/// Why the functions below cannot answer for this mechanism, as a phrase; nothing if they can.
std::optional<std::string> reach_obstacle(const Mechanism& mechanism);

struct ReachOptions {
  /// Decide each cube exactly where the arm allows it (point_reach.h); false draws postures for any arm.
  bool closed_form = true;
  std::int64_t samples = 10'000'000;  ///< postures drawn, spread evenly over the joint ranges
  double spacing =
      0.0;  ///< edge of the cubes [m]; 0: so that the box round the reach has a tenth as many cubes as samples
};

/// The box round the reach cut into cubes of one size, and of each whether the arm reaches its middle. Cube (i,
/// j, k) extends from (i h, j h, k h) to ((i + 1) h, ...) of the base frame, so that maps of one spacing can be
/// compared.
struct ReachMap {
  bool complete = true;                 ///< false if it was cancelled
  double spacing = 0.0;                 ///< h [m]
  std::array<std::int64_t, 3> first{};  ///< smallest index per axis
  std::array<std::int64_t, 3> count{};  ///< cubes per axis
  std::vector<std::uint8_t> inside;     ///< 1 or 0 of each cube, z fastest

  /// False outside the box.
  bool at(std::int64_t i, std::int64_t j, std::int64_t k) const;
  bool contains(const Vector3& point) const;  ///< of the cube round it
  std::int64_t cubes_inside() const;
};
/// Of an arm whose reach is known in closed form the middle of every cube is tested. Of others, postures are
/// drawn; from the one nearest to the middle of each cube Newton's method leads the tool there
/// with the joints in their ranges, and from every cube found on to its neighbours. The same for any number of
/// threads. REQUIRES: !reach_obstacle(mechanism), samples > 0, spacing >= 0. Throws std::length_error if a
/// spacing asks for more than 10^9 cubes.
ReachMap reach_map(const Mechanism& mechanism, const ReachOptions& options = {}, const Effort& effort = {});

struct ReachableVolume {
  double value = 0.0;           ///< cubes reached times their volume [m^3]
  double error_estimate = 0.0;  ///< what flat sides may err between two layers of cubes, and half of how far
                                ///< the sublattices of every second cube are off: the larger [m^3]
  std::array<Interval, 3> bounds{};  ///< of the cubes reached [m]
  double spacing = 0.0;              ///< [m]
  bool complete = true;
};
ReachableVolume reachable_volume(const ReachMap& map);
ReachableVolume reachable_volume(const Mechanism& mechanism, const ReachOptions& options = {},
                                 const Effort& effort = {});

}  // namespace zwidth
