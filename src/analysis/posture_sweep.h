#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/force.h"
#include "zwidth/analysis/workspace.h"

/// Figures over the joint ranges of a mechanism, whatever freedoms its tool has: the counterpart of
/// `sweep_workspace` for arms, whose tool position does not decide the posture. Postures are spread evenly over
/// the joint ranges, so that means are means over postures, not over places.

namespace zwidth {

/// Minimum, maximum and mean over postures. `count` 0: not computed, or not defined for this mechanism.
struct PostureStatistic {
  std::int64_t count = 0;
  double min = 0.0;
  double max = 0.0;
  double mean = 0.0;
  ActiveVector min_at;  ///< active joints of the minimum [rad] or [m]
  ActiveVector max_at;
  bool unbounded = false;  ///< the figure grows without end towards a singular posture: `max` is what was found
  // Where asked for: half of them stay below the median, 5 of 100 and 95 of 100 below the percentiles.
  std::optional<double> median, percentile_5, percentile_95;
};

struct PostureSweepOptions {
  std::int64_t samples = 20'000;
  /// What the drives may give in a posture; without it forces and moments are left out.
  std::function<TorqueRange(const Posture&)> torque;
  ActiveVector joint_step;  ///< resolution of each active joint [rad] or [m]; empty leaves the tool's out
};

/// Forces are pure forces (no moment), moments pure moments. Extremes are led from the postures drawn to the
/// summits next to them. Statistics of moments and turning are empty for a
/// tool that does not turn, those of forces for one that only turns.
struct PostureSweep {
  std::int64_t samples = 0;
  std::int64_t solved = 0;  ///< of them the loops closed
  bool complete = true;     ///< false if it was cancelled

  // Of the homogeneous Jacobian, see `jacobian_scale`.
  GlobalConditioning translation;      ///< of its linear rows
  GlobalConditioning rotation;         ///< of its angular rows
  GlobalConditioning homogeneous;      ///< of all rows of a tool that moves and turns
  double characteristic_length = 0.0;  ///< of the device [m]; 0 if nothing needs it

  PostureStatistic translation_conditioning;  ///< 1/(condition number) of the linear rows [-]
  PostureStatistic rotation_conditioning;     ///< of the angular rows [-]
  PostureStatistic manipulability;            ///< sqrt det(J J^T) of the linear rows [m^r/rad^r]
  std::array<PostureStatistic, 3> force;      ///< largest along x, y, z, whichever way is weaker [N]
  std::array<PostureStatistic, 3> moment;     ///< [N m]
  PostureStatistic weakest_force;             ///< available in every direction [N]
  PostureStatistic weakest_moment;            ///< [N m]
  std::array<PostureStatistic, 3> step;       ///< worst tool step along x, y, z [m]
  PostureStatistic turn_step;                 ///< worst turn of the tool about any base axis [rad]
  PostureStatistic gravity_torque;            ///< largest |gravity torque| of the joints [N m]
};

/// The same for any number of threads. REQUIRES: samples > 0.
PostureSweep sweep_postures(const Mechanism& mechanism, const PostureSweepOptions& options,
                            const Effort& effort = {});

/// Active joints of sample `index` of any sweep: an additive sequence that fills the joint ranges evenly
/// (Roberts 2018: multiples of the powers of a generalised golden ratio).
ActiveVector spread_posture(const Mechanism& mechanism, std::int64_t index);

/// `count` of them from `first` on, joint after joint: out[j count + p]. REQUIRES: out has count active_count()
/// elements.
void spread_postures(const Mechanism& mechanism, std::int64_t first, std::size_t count, std::span<double> out);

/// Coordinate `k` of `n` of sample `index` of that sequence, in [0, 1).
double spread_coordinate(int n, int k, std::int64_t index);

/// How far the tool goes along a direction of the base frame, with the joints in their ranges: by projected
/// gradient ascent from the best of many postures. [m]
struct FarthestPosture {
  double distance = 0.0;               ///< direction . position, or |position| for no direction [m]
  Vector3 position = Vector3::Zero();  ///< [m]
  ActiveVector active;                 ///< [rad] or [m]
};
FarthestPosture farthest_along(const Mechanism& mechanism, const Vector3& direction);
/// The farthest that the tool gets from a point of the base frame [m].
FarthestPosture farthest_from(const Mechanism& mechanism, const Vector3& point);

}  // namespace zwidth
