#pragma once

#include "zwidth/analysis/contour.h"
#include "zwidth/analysis/reach.h"

/// What a reach looks like: shapes that fit into it, and cuts through it.

namespace zwidth {

/// The largest ball and the largest axis-aligned cube that fit into a reach. Sizes are those of whole cubes of
/// the map: the ball's radius is short by at most a cube's diagonal, the cube's edge by less than two cubes.
InscribedShapes inscribed_shapes(const ReachMap& map);

/// The reach cut by a plane, and how well conditioned the best posture is there.
struct ReachSlice {
  Slice slice;             ///< outlines follow the cubes of the map, smoothed over one of them
  PlaneGrid conditioning;  ///< largest 1/(condition number) of the linear rows found at each point, NaN outside
};

/// Cuts normal to x, y and z through a point. `samples` postures are drawn for the conditioning. The same for
/// any number of threads. REQUIRES: a map of this mechanism.
std::array<ReachSlice, 3> slice_reach(const Mechanism& mechanism, const ReachMap& map, const Vector3& through,
                                      std::int64_t samples, const Effort& effort = {});

}  // namespace zwidth
