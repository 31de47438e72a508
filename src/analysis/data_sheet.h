#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/analysis/arm_sheet.h"
#include "zwidth/analysis/conditioning.h"
#include "zwidth/analysis/five_bar_curves.h"
#include "zwidth/analysis/force.h"
#include "zwidth/analysis/inertia.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/analysis/stiffness_sheet.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/description/description.h"

/// Everything that can be said about a device from its description: plain structs, to be printed, drawn or
/// written as JSON elsewhere.

namespace zwidth {

struct DataSheetOptions {
  double spacing = 0.0;  ///< of the workspace lattice [m]; 0: `suitable_spacing`
  double most_mechanical_points =
      kMechanicalPoints;       ///< of the lattice for masses and stiffness, whose points cost more
  int slice_points = 121;      ///< grid points along the longer side of a map on a plane; 0 leaves the maps out
  int surface_divisions = 24;  ///< of each edge of the joint ranges in the surface mesh; 0 leaves it out
  double max_frequency =
      2000.0;                   ///< of the sampled frequency response, and of the search for its resonance [Hz]
  int frequency_points = 400;   ///< spaced by equal ratios; 0 leaves the sampled responses out
  double step_duration = 0.05;  ///< of the sampled step response [s]
  double step_current = 1.0;    ///< [A]
  Effort effort;
};

/// Axis forces and force polytopes over the workspace, with one set of torque limits.
struct ForceSheet {
  ActiveVector torque;            ///< limit of each active joint [N m]
  std::array<Statistic, 3> axes;  ///< largest pure force along x, y, z [N]
  Statistic weakest;              ///< force available in every direction [N]
  Statistic strongest;            ///< largest force in any direction [N]
  std::string limited_by;         ///< "motor", "slip", ...; "various" if the joints differ
};

/// The posture in the middle of the joint ranges, looked at closely.
struct PostureSheet {
  ActiveVector active;                 ///< [rad]
  Vector3 position = Vector3::Zero();  ///< [m]
  Jacobian jacobian;                   ///< linear rows [m/rad]
  double condition_number = 0.0;
  double manipulability = 0.0;  ///< [m^3/rad^3], in a plane [m^2/rad^2]
  std::optional<ForcePolytope> continuous_forces;
  std::optional<ForcePolytope> peak_forces;
  ActiveVector gravity_torques;               ///< [N m]; zero without bodies
  std::optional<ApparentMass> apparent_mass;  ///< empty if nothing has mass
  std::optional<ToolVector> tool_resolution;  ///< worst-case step per axis [m]
  std::optional<ToolVector>
      force_resolution;  ///< worst-case step per axis [N]; empty if a drive's is not given
};

/// Sampled responses of the two-mass actuator model, tip force to motor current.
struct ActuatorResponse {
  double dc_gain = 0.0;             ///< [N/A]
  GainPeak resonance;               ///< [Hz], [N/A]
  double resonance_peak = 0.0;      ///< over the static gain [dB]
  std::optional<double> bandwidth;  ///< -3 dB, above the resonance [Hz]
  double cable_stiffness = 0.0;     ///< k1 [N/m]
  std::vector<double> frequency;    ///< [Hz]
  std::vector<double> magnitude;    ///< [N/A]
  std::vector<double> phase;        ///< unwrapped, from 0 downwards [rad]
  double step_current = 0.0;        ///< [A]
  std::vector<double> step_time;    ///< [s]
  std::vector<double> step_force;   ///< [N]
  StepMetrics step;                 ///< of the sampled step, in samples
};

/// One drive of the device, and all joints that have it.
struct DriveSheet {
  std::vector<std::string> joints;  ///< active joints that it moves
  Drive drive;                      ///< torque limits, speed, margins, figures: ask it
  std::vector<Margin> margins;
  std::vector<DriveFigure> figures;
  TorqueLimit continuous, peak, stall;
  SpeedLimit speed;
  std::optional<double> current_loop_bandwidth;  ///< -3 dB [Hz]
  std::vector<double> current_step;              ///< unit step samples of the current loop
  double current_step_period = 0.0;              ///< [s]
  std::optional<ActuatorResponse> response;      ///< joint angle zero; empty without a capstan or an output
};

/// One cylinder of the device, and the joint that it moves: margins and figures, ask it.
struct PneumaticDriveSheet {
  std::string joint;
  PneumaticDrive drive;
};

struct GeometryEntry {
  std::string key;     ///< "base_radius"
  std::string name;    ///< "base radius"
  std::string symbol;  ///< of the source, may be empty
  double value = 0.0;
  std::string unit;  ///< SI
};

/// What a mechanism with three translations can reach and do.
struct WorkspaceSheet {
  LatticeSweep sweep;  ///< with the continuous torque limits, all figures
  Extents extents;
  WorkspaceVolume volume;
  InscribedShapes inscribed;
  std::array<SliceMap, 3> slices;  ///< planes normal to x, y and z through the middle of the extents
  SurfaceMesh surface;
};

/// What a tool that moves in a plane can reach and do.
struct PlaneSheet {
  LatticeSweep sweep;  ///< with the continuous torque limits, all figures
  Extents extents;
  WorkspaceVolume area;
  InscribedShapes inscribed;             ///< circle and square
  SliceMap map;                          ///< of the whole plane
  std::vector<Slice> condition_regions;  ///< where the condition number is below 5, 10 and 100
  DexterousRegion dexterous;
  std::vector<FiveBarCurve> singular_curves;  ///< of a five-bar in its own working mode, at any crank angles
};

/// How stiff and how heavy a tool that does not turn feels over its workspace.
struct MechanicsSheet {
  MechanicalSweep sweep;
  std::vector<MechanicalCut>
      cuts;  ///< those of the workspace's maps: normal to x, y and z; the plane of a plane
};

struct DataSheet {
  // Identity
  std::string name;
  std::string title;
  std::string source;
  std::string mechanism_type;  ///< "delta", "legs"
  int active_joints = 0;
  int tool_freedoms = 0;                 ///< of the tool's components, those that it can be moved along
  std::vector<std::string> joint_names;  ///< of the active joints
  std::vector<Interval> joint_ranges;    ///< [rad] or [m]
  std::vector<bool> joint_slides;        ///< whether each of them is prismatic
  std::vector<GeometryEntry> geometry;
  double moving_mass = 0.0;  ///< of all bodies [kg]

  std::optional<WorkspaceSheet> workspace;  ///< empty for mechanisms that `workspace_obstacle` refuses
  std::optional<PlaneSheet> plane;          ///< instead, if the tool moves in a plane
  std::optional<ArmSheet> arm;              ///< of a tool that also turns; empty for all others
  std::optional<WorkspaceConditioning> conditioning;  ///< with either
  std::optional<ForceSheet> continuous;  ///< empty without drives on every joint, or without workspace
  std::optional<ForceSheet> peak;
  std::optional<PostureSheet> middle;  ///< empty if the middle of the joint ranges does not close
  /// Worst-case tool step per axis over the workspace [m]; counts are 0 without encoders.
  std::array<Statistic, 3> resolution;
  ActiveVector joint_resolution;   ///< angle of one count, per active joint [rad]; 0 without a drive
  ActiveVector torque_resolution;  ///< torque of one current step, per active joint [N m]; 0 if not given

  std::optional<StiffnessSheet> stiffness;                  ///< empty where the source does not give enough
  std::optional<MechanicsSheet> mechanics;                  ///< with a workspace, where that or a mass is known
  std::optional<MechanicalPostures> mechanics_of_postures;  ///< instead, of a tool that also turns
  std::vector<DriveSheet> drives;                           ///< in the order of the description
  std::vector<PneumaticDriveSheet> pneumatic_drives;        ///< in the order of the joints
  std::vector<std::string> warnings;  ///< sentences for a person: failed margins, what could not be computed
  bool complete = true;               ///< false if it was cancelled
};

/// REQUIRES: `validate(description)` finds nothing. Throws InvalidDrive as `Drive` does.
DataSheet data_sheet(const Description& description, const DataSheetOptions& options = {});

/// The mechanism of a description with the inertia of its drives on it, as every dynamic figure needs it.
/// Throws InvalidDrive.
Mechanism mechanism_with_drives(const Description& description);

/// One drive per active joint, in order, where the description gives one. Throws InvalidDrive.
std::vector<std::optional<Drive>> joint_drives(const Description& description, const Mechanism& mechanism);

/// Torque limits and joint resolutions for the figures; `peak` takes the short-time torque. Joints without a
/// drive get torque 1 and step 0. REQUIRES: three active joints.
DriveLimits drive_limits(const std::vector<std::optional<Drive>>& drives, bool peak);

}  // namespace zwidth
