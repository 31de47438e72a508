#pragma once

#include "zwidth/analysis/internal/pose_flood.h"
#include "zwidth/analysis/internal/pose_guide.h"

namespace zwidth::internal {

/// The short way to a position, the tool turning as the joints need: as it was turned, else turned until every
/// joint is back in its range. `inside` false where neither was found.
PoseGuide::Step lead_anyhow(const PoseGuide& guide, const Posture& from, const Vector3& position);

/// The places that the tool can be led to in whatever orientation, from home. `spacing`, `most`, `figures`,
/// `figure` and `offset` of the options count.
PoseFlood flood_places(const PoseGuide& guide, const PoseFloodOptions& options, const Effort& effort);

/// How the tool can be turned at the place of a posture.
struct TurnedPlace {
  double share = 0.0;  ///< of all orientations, of a tool in a plane of all angles; NaN if it turns in two ways
  double every_way =
      0.0;  ///< away from `upright` about any axis that it turns about [rad]; 0 if that is not reached
};
TurnedPlace turn_at(const PoseGuide& guide, const Posture& place, const Matrix3& upright);

/// Of all orientations, per rotation vector: those within a turn of pi add up to 1.
double orientation_density(const Vector3& turn);

}  // namespace zwidth::internal
