#pragma once

#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

/// Dynamics of any mechanism of legs, from its bodies: links move as rigid bodies, nothing is lumped.
/// M thetaddot + h(theta, thetadot) + g(theta) = tau + J^T w, with drive inertia on M's diagonal. For a control
/// cycle: no heap. Straight from joint values: serial_dynamics.h for arms, delta_dynamics.h for the delta.

namespace zwidth {

/// Mass matrix in the active joints (active x active), with drive inertia [kg m^2, kg].
ActiveMatrix mass_matrix(const Posture& posture) noexcept;
ActiveMatrix mass_matrix(const Posture& posture, const Rates& rates) noexcept;

/// Active torques that hold the posture against gravity [N m, N].
ActiveVector gravity_torques(const Posture& posture) noexcept;
ActiveVector gravity_torques(const Posture& posture, const Rates& rates) noexcept;

/// Active torques [N m, N] that produce `acceleration` at `rate`, with tool wrench `push` exerted by the user
/// on the tool (3 or 6 rows; empty means none).
ActiveVector inverse_dynamics(const Posture& posture, const ActiveVector& rate,
                              const ActiveVector& acceleration, const ToolVector& push = {}) noexcept;

/// Active accelerations under `torque` and the user's `push`.
ActiveVector forward_dynamics(const Posture& posture, const ActiveVector& rate, const ActiveVector& torque,
                              const ToolVector& push = {}) noexcept;

/// Mass the user feels at the tool: Lambda = (J M^-1 J^T)^-1 (tool x tool) (Khatib 1987); at a singularity the
/// pseudo-inverse. [kg]
ToolMatrix cartesian_mass(const Jacobian& jacobian, const ActiveMatrix& mass) noexcept;

double kinetic_energy(const Posture& posture, const ActiveVector& rate) noexcept;  ///< [J], with drive inertia
double potential_energy(const Posture& posture) noexcept;  ///< against gravity, zero at the origin [J]

double moving_mass(const Mechanism& mechanism) noexcept;  ///< of all bodies [kg]
/// Common centre of mass of all bodies [m], base frame; the origin if nothing has mass.
Vector3 mass_centre(const Posture& posture) noexcept;

}  // namespace zwidth
