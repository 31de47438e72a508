#pragma once

#include <optional>
#include <vector>

#include "zwidth/analysis/orientation.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/reach_shapes.h"

/// What can be said about a device whose tool turns as well as moves: figures over postures, and where the tool
/// point can be whatever the orientation.

namespace zwidth {

struct ArmSheetOptions {
  std::int64_t postures = 20'000;           ///< of the figures
  std::int64_t reach_postures = 4'000'000;  ///< for the reach, whose box then has a tenth as many cubes
  double reach_spacing = 0.0;               ///< of those cubes instead, if above zero [m]
  std::int64_t slice_postures = 400'000;    ///< for the conditioning on the cuts; 0 leaves the cuts out
  OrientationOptions orientation;           ///< `places` 0 leaves the orientations out
  PoseWorkspaceOptions pose;                ///< `places` 0 leaves the workspace in one orientation out
  /// Of an arm whose tool counts as a point `with_turning_tool`, for reach and orientations; else null.
  const Mechanism* turning = nullptr;
  Effort effort;
};

/// The home posture, looked at closely. Forces are pure forces, moments pure moments.
struct HomePosture {
  ActiveVector active;  ///< [rad] or [m]
  Pose tool;
  Jacobian jacobian;
  Dexterity translation;              ///< of the linear rows
  std::optional<Dexterity> rotation;  ///< of the angular rows
  ActiveVector gravity_torques;       ///< [N m, N]
  ToolVector continuous_loads;  ///< largest load along each tool axis, whichever way is weaker [N, N m]; empty
                                ///< without drives
  ToolVector peak_loads;
  std::optional<OrientationsAt> turning;  ///< how the tool can be turned there; empty as `orientations` below
};

struct ReachSheet {
  ReachableVolume volume;
  InscribedShapes inscribed;
  std::array<ReachSlice, 3>
      slices;  ///< through the home position, or the middle of the reach if that is outside
};

struct ArmSheet {
  PostureSweep continuous;           ///< with the continuous torque limits
  std::optional<PostureSweep> peak;  ///< with the short-time torque limits; empty without drives
  std::array<std::array<FarthestPosture, 2>, 3> ends;  ///< [axis][0 min, 1 max] of the tool position
  FarthestPosture farthest;                            ///< from the base origin
  std::optional<HomePosture> home;                     ///< empty if the loops do not close there
  std::optional<ReachSheet> reach;                     ///< empty for mechanisms that `reach_obstacle` refuses
  std::optional<OrientationWorkspace> orientations;    ///< the same of `orientation_obstacle`
  std::optional<PoseWorkspace> pose;                   ///< the same of `pose_workspace_obstacle`
  bool complete = true;
};

/// `continuous` and `peak` tell what the drives give in a posture; both empty without drives on every driven
/// joint. `joint_step` is the resolution of each active joint, empty if not known.
using TorqueSource = std::function<TorqueRange(const Posture&)>;
ArmSheet arm_sheet(const Mechanism& mechanism, const TorqueSource& continuous, const TorqueSource& peak,
                   const ActiveVector& joint_step, const ArmSheetOptions& options = {});

}  // namespace zwidth
