#pragma once

#include <vector>

#include "zwidth/mechanism/jacobian.h"

/// Static forces at the tool within torque limits, from one Jacobian: tau = J^T f (Neal 2015, B.12).

namespace zwidth {

/// Active torques [N m, N] that hold a tool force or wrench (as many rows as J has) pushed on the environment:
/// J^T f.
ActiveVector torques_for_load(const Jacobian& jacobian, const ToolVector& load);

/// Largest pure force along each tool axis with every |tau_j| <= limit_j [N, N m]. Infinite along an axis that
/// loads no joint.
ToolVector axis_force_limits(const Jacobian& jacobian, const ActiveVector& torque_limit);

inline Vector3 axis_force_limits(const Matrix3& jacobian, const Vector3& torque_limit) {
  const Matrix3 load = jacobian.cwiseAbs() * torque_limit.cwiseInverse().asDiagonal();
  return load.rowwise().maxCoeff().cwiseInverse();
}

/// Largest force in the direction of `direction` (need not be a unit vector) [N].
double force_limit_along(const Jacobian& jacobian, const ActiveVector& torque_limit,
                         const ToolVector& direction);

/// All static forces within the torque limits, { f : |J^T f|_j <= limit_j }: exactly, for a square J.
struct ForcePolytope {
  std::vector<ToolVector>
      vertices;          ///< 2^n, vertex m has torque +limit_j where bit j of m is set, -limit_j elsewhere [N]
  double weakest = 0.0;  ///< available in every direction: radius of the inscribed ball [N]
  ToolVector weakest_direction;    ///< unit; its negative is as weak
  double strongest = 0.0;          ///< the farthest vertex [N]
  ToolVector strongest_direction;  ///< unit; its negative is as strong
  double volume = 0.0;             ///< [N^n]
};
/// REQUIRES: square J. At a singularity of J no vertex is finite: the vertices stay empty, strongest and volume
/// are infinite.
ForcePolytope force_polytope(const Jacobian& jacobian, const ActiveVector& torque_limit);

}  // namespace zwidth
