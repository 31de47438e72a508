#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/analysis/reach.h"

/// How an arm can turn its tool at the places that it reaches: the orientation workspace, and the dexterous
/// volume, where the tool can be turned any way (Kumar & Waldron 1981). All coordinates in the base frame.

namespace zwidth {

/// Why the functions below cannot answer for this mechanism, as a phrase; nothing if they can.
std::optional<std::string> orientation_obstacle(const Mechanism& mechanism);

/// An arm whose tool counts as a point (`PlatformFreedom::point`) with a tool that turns, so that one can ask
/// for its reach and orientations; any other description as it is.
Description with_turning_tool(const Description& description);

/// The z axis of the tool, about which the last joint of most wrists turns it. If five joints are all there are
/// and the last turns about z, then x: nothing would point z but the fourth.
Vector3 tool_axis_of(const Mechanism& mechanism);

struct OrientationOptions {
  int orientations = 400;  ///< asked for at each place, spread evenly over all there are
  int directions = 400;    ///< of the tool's axis, spread evenly over the sphere
  int starts = 48;         ///< postures from which the arm is led to a place
  /// The tool's axis, in its own frame; zero for `tool_axis_of` the mechanism.
  Vector3 tool_axis = Vector3::Zero();
  int places = 250;  ///< about as many are looked at for the volume
};

/// A share of all there are, between 0 and 1, with its standard error: as if those asked for had been drawn at
/// random. They are spread evenly, which errs less.
struct Share {
  double value = 0.0;
  double error = 0.0;
};

/// What the arm can do with its tool at one place, within the joint ranges.
struct OrientationsAt {
  bool reached = false;  ///< the tool can be there in some orientation
  /// Of all orientations; none for fewer than six joints, which have only some of no measure at one place.
  std::optional<Share> orientations;
  Share directions;  ///< of the directions that the tool's axis can have, whatever the turn about it
};
/// REQUIRES: !orientation_obstacle(mechanism), orientations, directions, starts > 0.
OrientationsAt orientations_at(const Mechanism& mechanism, const Vector3& position,
                               const OrientationOptions& options = {});

/// Shares that the volumes below are told for.
inline constexpr std::array<double, 4> kShareLevels = {0.25, 0.5, 0.75, 1.0};

/// The shares over the places that an arm reaches, each of which stands for an equal volume.
struct ShareSpread {
  double mean = 0.0;
  double least = 0.0;
  double most = 0.0;
  std::array<double, kShareLevels.size()>
      volume{};  ///< where the share is at least each of `kShareLevels` [m^3]
  /// Of the volume: the standard error from the number of places, and those places whose share is as near to
  /// the level as its own error, half of whom may be on either side [m^3].
  std::array<double, kShareLevels.size()> volume_error{};

  double dexterous_volume() const { return volume.back(); }  ///< where it is whole [m^3]
};
struct OrientationWorkspace {
  bool complete = true;                 ///< false if it was cancelled
  std::int64_t places = 0;              ///< looked at
  double spacing = 0.0;                 ///< of the places [m]
  Vector3 tool_axis = Vector3::Zero();  ///< that directions are those of, in the tool's frame
  std::optional<ShareSpread> orientations;
  ShareSpread directions;
};
/// At every so many cubes of a map of this mechanism. The same for any number of threads. REQUIRES:
/// !orientation_obstacle(mechanism), the options above, places > 0.
OrientationWorkspace orientation_workspace(const Mechanism& mechanism, const ReachMap& map,
                                           const OrientationOptions& options = {}, const Effort& effort = {});

}  // namespace zwidth
