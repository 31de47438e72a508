#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "zwidth/mechanism/mechanism.h"

/// Where a figure is largest and least not among points of a lattice or among drawn postures, but near them.

namespace zwidth::internal {

/// A figure of the active joints; NaN where the mechanism cannot be.
using JointFigure = std::function<double(const ActiveVector&)>;

struct Summit {
  double value = 0.0;
  ActiveVector at;
  bool unbounded = false;  ///< it grows without end: tenfold at the least while steps shrink ten-thousandfold
};
/// Climbs from a posture within the joint ranges, by steps in ever other directions, for as long as they gain,
/// then by ever shorter ones. `figure` is positive, or NaN.
Summit climb(const Mechanism& mechanism, const ActiveVector& start, const JointFigure& figure);

/// Some hundred postures over the joint ranges, their ends and corners among them: where to climb from too, as
/// the highest summit need not be the one next to the best of a lattice.
std::vector<ActiveVector> joint_raster(const Mechanism& mechanism);

/// The highest of the summits next to a posture and next to the best few of a raster.
Summit highest(const Mechanism& mechanism, const ActiveVector& start, const std::vector<ActiveVector>& raster,
               const JointFigure& figure);

/// Moves the extremes of a statistic from the postures they were found in to the summits. A least value that
/// shrinks without end is 0; a largest one that grows without end is marked, and left as found. `place` turns
/// joints into what the statistic has as its places.
template <class Statistic, class Place>
void refine(Statistic& statistic, const Mechanism& mechanism, const ActiveVector& least,
            const ActiveVector& largest, const JointFigure& figure, const Place& place) {
  if (statistic.count == 0) return;
  const std::vector<ActiveVector> raster = joint_raster(mechanism);
  if (!std::isfinite(statistic.max)) {
    statistic.unbounded = true;
  } else if (statistic.max > 0.0) {
    const Summit summit = highest(mechanism, largest, raster, figure);
    if (summit.unbounded) {
      statistic.unbounded = true;
    } else if (summit.value > statistic.max) {
      statistic.max = summit.value;
      statistic.max_at = place(summit.at);
    }
  }
  if (!(statistic.min > 0.0)) return;
  const Summit summit =
      highest(mechanism, least, raster, [&](const ActiveVector& joints) { return 1.0 / figure(joints); });
  if (!(1.0 / summit.value < statistic.min)) return;
  statistic.min = summit.unbounded ? 0.0 : 1.0 / summit.value;
  statistic.min_at = place(summit.at);
}

}  // namespace zwidth::internal
