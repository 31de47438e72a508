#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/analysis/contour.h"
#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/force.h"
#include "zwidth/analysis/reach_shapes.h"
#include "zwidth/analysis/workspace.h"

/// The workspace of a mechanism of several legs whose tool also turns, a hexapod or a planar 3-RRR: where the
/// tool can be in one orientation (its constant-orientation workspace), and how it can be turned at one place
/// (its orientation workspace; Merlet 2006). Both hold what can be reached from the home posture without
/// leaving them: no joint beyond its range, no singularity passed. All coordinates in the base frame.

namespace zwidth {

/// Why the function below cannot answer for this mechanism, as a phrase; nothing if it can.
std::optional<std::string> pose_workspace_obstacle(const Mechanism& mechanism);

struct PoseWorkspaceOptions {
  double spacing = 0.0;          ///< of the lattice of positions [m]; 0: so that about `places` lie inside
  std::int64_t places = 30'000;  ///< a quarter of them in a plane
  std::optional<Matrix3> orientation;  ///< of the tool; without, that of the home posture
  bool shapes = true;   ///< find the largest sphere and cube, and the ends of the ranges more closely
  bool turning = true;  ///< find how the tool turns
  std::optional<Vector3> position;  ///< where it is turned [m]; without, the home position
  std::int64_t any_places =
      0;  ///< find about as many in any orientation, a quarter in a plane; 0 leaves that out
  /// What the drives may give in a posture; without it forces and moments are left out.
  std::function<TorqueRange(const Posture&)> torque;
  int slice_points = 101;  ///< along the longer side of a cut; 0 leaves the cuts out
};

/// How well conditioned the Jacobian is over the places; each stands for an equal volume or area.
struct PoseConditioning {
  GlobalConditioning of_all;
  Statistic figure;  ///< 1/(condition number), with the tool positions of least and largest
};

/// Where the tool can be led to in whatever orientation, turning on the way as it needs to, and how it can be
/// turned there.
struct AnyOrientation {
  double spacing = 0.0;             ///< of the lattice [m]
  std::int64_t inside = 0;          ///< lattice points
  double measure = 0.0;             ///< as the workspace's [m^3, m^2, m]
  double error_estimate = 0.0;      ///< of `measure`
  std::array<Interval, 3> range{};  ///< of the lattice points [m]
  int places = 0;                   ///< of them, evenly spread, where the tool was turned
  /// Of all orientations (in a plane of all angles), those that it can be turned to there; empty if it turns in
  /// two ways.
  struct Spread {
    double mean = 0.0, least = 0.0, most = 0.0;
  };
  std::optional<Spread> share;
  /// Where it can be turned this far about every axis, away from the home orientation.
  struct Turned {
    double angle = 0.0;    ///< [rad]
    double measure = 0.0;  ///< [m^3, m^2, m]
    double error = 0.0;    ///< standard, of the places drawn
  };
  std::array<Turned, 4> turned{};
};

/// How the tool can be turned at one place, away from one orientation.
struct TurningRange {
  Vector3 position = Vector3::Zero();            ///< [m]
  Matrix3 orientation = Matrix3::Identity();     ///< that it is turned from
  bool reached = false;                          ///< that orientation, at this place
  std::array<std::optional<Interval>, 3> about;  ///< turned about x, y or z alone [rad]; empty: it cannot
  /// Of all orientations, those that can be reached from there; of a tool in a plane of all angles; of one that
  /// turns in two ways, of all directions of the axis that is left.
  std::optional<double> share;
  double share_error = 0.0;  ///< estimate
};

struct PoseWorkspace {
  bool complete = true;    ///< false if it was cancelled
  bool reached = false;    ///< some place was found in this orientation; the rest means nothing otherwise
  bool unbounded = false;  ///< it does not end within a thousand times the mechanism's length; likewise
  Matrix3 orientation = Matrix3::Identity();
  Vector3 from = Vector3::Zero();   ///< the place that the search began at [m]
  std::vector<int> axes;            ///< that the tool can move along without turning: 0 x, 1 y, 2 z
  double spacing = 0.0;             ///< of the lattice [m]
  std::int64_t inside = 0;          ///< lattice points
  double measure = 0.0;             ///< volume [m^3], of two axes area [m^2], of one length [m]
  double error_estimate = 0.0;      ///< of `measure`
  std::array<Interval, 3> range{};  ///< ends along each axis, to some 1e-4 of the size [m]
  InscribedShapes inscribed;        ///< of three axes sphere and cube, of two circle and square
  PoseConditioning translation;     ///< of the linear rows
  PoseConditioning rotation;        ///< of the angular rows; empty if there are fewer than two
  PoseConditioning homogeneous;     ///< of all, angular rows times the characteristic length
  // Over the places, of the continuous torques; empty without `torque`, or for a tool that does not move, or
  // turn, so.
  std::array<Statistic, 3> force;   ///< largest pure force along x, y, z, whichever way is weaker [N]
  Statistic weakest_force;          ///< available in every direction [N]
  std::array<Statistic, 3> moment;  ///< [N m]
  Statistic weakest_moment;         ///< [N m]
  std::optional<AnyOrientation> any;
  double characteristic_length = 0.0;  ///< of the device, see `jacobian_scale` [m]
  /// Through `from`: of three axes normal to each, of two the plane itself; with the largest 1/(condition
  /// number) of the homogeneous Jacobian.
  std::vector<ReachSlice> slices;
  TurningRange turning;
  std::vector<Vector3> places;       ///< the lattice points inside, by x, then y, then z [m]
  std::vector<double> conditioning;  ///< 1/(condition number) of the homogeneous Jacobian at each

  int dimension() const { return static_cast<int>(axes.size()); }
};

/// The same for any number of threads. REQUIRES: !pose_workspace_obstacle(mechanism), spacing >= 0. Throws
/// std::length_error if a spacing asks for more than some million places.
PoseWorkspace pose_workspace(const Mechanism& mechanism, const PoseWorkspaceOptions& options = {},
                             const Effort& effort = {});

}  // namespace zwidth
