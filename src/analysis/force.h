#pragma once

#include <vector>

#include "zwidth/math/polytope.h"
#include "zwidth/mechanism/jacobian.h"

/// Static forces at the tool within torque limits, from one Jacobian: tau = J^T w (Neal 2015, B.12), where w is
/// the load that the tool puts on its environment, with the rows of J: forces, moments, or both.
///
/// Any J will do. With fewer joints than rows the structure carries some loads, which are then unlimited. With
/// more (a redundant arm) every joint must still hold its share J_j . w for the arm to rest. A joint without a
/// drive has an empty torque range, and holds nothing. Pure forces are had from the linear rows of J alone (the
/// moment is then zero), pure moments from the others: `J.topRows(mechanism.linear_rows())`.

namespace zwidth {

/// Active torques [N m, N] that hold a tool force or wrench (as many rows as J has) pushed on the environment:
/// J^T f.
ActiveVector torques_for_load(const Jacobian& jacobian, const ToolVector& load);

/// What each active joint may give, min_j <= tau_j <= max_j [N m, N]; both zero where no drive is.
struct TorqueRange {
  ActiveVector min;
  ActiveVector max;

  /// -limit..limit. REQUIRES: no limit is negative.
  static TorqueRange symmetric(const ActiveVector& limit) { return {-limit, limit}; }
  /// What is left beside torques that something else takes, such as the weight of the links.
  TorqueRange beside(const ActiveVector& taken) const { return {min - taken, max - taken}; }
  /// Whether no torque at all is within the range: the posture can be held without a load.
  bool holds() const { return (min.array() <= 0.0).all() && (max.array() >= 0.0).all(); }
};

// ------------------------------------------------------------------------------------------- one direction

enum class LoadStatus {
  limited,
  unlimited,  ///< no joint feels this load: the structure carries any amount of it
  none,       ///< not even a load of zero is within the range
};

const char* to_string(LoadStatus status);

struct LoadLimit {
  LoadStatus status = LoadStatus::none;
  double value = 0.0;  ///< largest load along the direction [N or N m]; infinite if unlimited, 0 if none
  int joint = -1;      ///< the active joint whose range is used up, -1 unless limited
  ToolVector load;     ///< that load with all its rows; empty unless limited
};

/// The largest load along `direction` (of any length) and nothing beside it.
LoadLimit load_limit(const Jacobian& jacobian, const TorqueRange& range, const ToolVector& direction) noexcept;

/// The largest component along `direction` if the load may also contain any amount of the columns of `free`, as
/// they suit: the largest force with whatever moment, say. A linear programme. With `free` the directions at
/// right angles to `direction`, this is how far the force polytope reaches along it.
LoadLimit load_limit(const Jacobian& jacobian, const TorqueRange& range, const ToolVector& direction,
                     const ToolMatrix& free) noexcept;

/// Largest force in the direction of `direction` (need not be a unit vector) [N]; infinite if unlimited.
double force_limit_along(const Jacobian& jacobian, const ActiveVector& torque_limit,
                         const ToolVector& direction);

/// Largest pure force along each tool axis with every |tau_j| <= limit_j [N, N m]. Infinite along an axis that
/// loads no joint.
ToolVector axis_force_limits(const Jacobian& jacobian, const ActiveVector& torque_limit);

inline Vector3 axis_force_limits(const Matrix3& jacobian, const Vector3& torque_limit) {
  const Matrix3 load = jacobian.cwiseAbs() * torque_limit.cwiseInverse().asDiagonal();
  return load.rowwise().maxCoeff().cwiseInverse();
}

// ------------------------------------------------------------------------------------------ all directions

/// All static loads within the torque range, { w : min_j <= J_j . w <= max_j }, exactly.
///
/// Its lengths mean something only if all rows of J are forces, or all are moments; of mixed rows take the one
/// kind, or the homogeneous Jacobian (dexterity.h).
struct ForcePolytope {
  PolytopeStatus status = PolytopeStatus::empty;  ///< unbounded at a singularity, or with too few joints
  int dimension = 0;  ///< less than the rows of J where joints without a drive leave only some directions
  /// Corners [N]; none unless bounded. With a square regular J and no empty range there are 2^n: vertex m has
  /// torque max_j where bit j of m is set, min_j elsewhere.
  std::vector<ToolVector> vertices;
  std::vector<std::vector<int>> faces;  ///< loops of corners, as in `Polytope`
  double weakest = 0.0;  ///< available in every direction: radius of the inscribed ball about no load [N]
  ToolVector weakest_direction;    ///< unit: where no more is to be had
  double strongest = 0.0;          ///< the farthest vertex [N]
  ToolVector strongest_direction;  ///< unit; of an unbounded polytope, a direction without limit
  double volume = 0.0;             ///< [N^rows]
};
ForcePolytope force_polytope(const Jacobian& jacobian, const TorqueRange& range);
/// The same for -limit..limit. At a singularity strongest and volume are infinite.
ForcePolytope force_polytope(const Jacobian& jacobian, const ActiveVector& torque_limit);

/// An ellipsoid about the origin.
struct Ellipsoid {
  ToolMatrix axes;     ///< columns: unit directions, longest half-axis first
  ToolVector lengths;  ///< half-axes; infinite or zero at a singularity
};

/// Tool velocities with |rate/limit| <= 1 (2-norm): half-axes are the singular values of J diag(limit)
/// (Yoshikawa 1985).
Ellipsoid velocity_ellipsoid(const Jacobian& jacobian, const ActiveVector& rate_limit);

/// Loads with |tau/limit| <= 1 (2-norm), which lies within the polytope and touches it or comes within sqrt(n)
/// of it: half-axes are the reciprocals of the singular values of J diag(1/limit). A joint without a drive
/// (limit zero) leaves the directions that it does not feel.
Ellipsoid force_ellipsoid(const Jacobian& jacobian, const ActiveVector& torque_limit);

/// Tool velocities with every rate within its limits, exactly.
Zonotope velocity_polytope(const Jacobian& jacobian, const ActiveVector& rate_limit);

}  // namespace zwidth
