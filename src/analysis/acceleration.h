#pragma once

#include <optional>
#include <span>

#include "zwidth/analysis/force.h"
#include "zwidth/mechanism/dynamics.h"

/// The equations of motion at the tool, and what the drives can do with the device's own mass in one posture.
/// Vectors of the tool have the rows of the Jacobian; lengths and volumes mean something only of rows of one
/// kind: of a tool that also turns take `ToolMotion::rows`.

namespace zwidth {

/// How the tool of one posture answers torques and forces, while its joints move at given rates:
/// acceleration = response torque + mobility push + coasting.
struct ToolMotion {
  Jacobian response;    ///< J M^-1: tool acceleration per active torque [1/(kg m) or 1/kg, ...]
  ToolMatrix mobility;  ///< J M^-1 J^T: tool acceleration per push of the user [1/kg, ...]
  ActiveVector needed;  ///< torques that keep the rates: weight, Coriolis and centrifugal effects [N m, N]
  ToolVector turning;   ///< Jdot thetadot: acceleration of the tool while the rates are kept [m/s^2, rad/s^2]
  ToolVector coasting;  ///< acceleration without torque or push [m/s^2, rad/s^2]

  /// Those of rows first .. first + count - 1 alone, while the tool may move as it likes in the others.
  ToolMotion rows(int first, int count) const;
};
/// REQUIRES: the mass matrix is positive definite: every joint moves some mass or rotor.
ToolMotion tool_motion(const Posture& posture, const Rates& rates, const ActiveVector& rate) noexcept;

/// Forward dynamics of the tool: its acceleration under `torque` and the user's `push` (empty: none).
ToolVector tool_acceleration(const ToolMotion& motion, const ActiveVector& torque, const ToolVector& push = {});

/// Inverse dynamics of the tool: active torques that give it `acceleration` against weight, motion and the
/// user's `push`. Of the joint accelerations that do, those that cost least energy of acceleration
/// (qddot^T M qddot, as a tool force alone would give; Khatib 1987): it matters with joints to spare. Nothing
/// where the tool cannot be accelerated that way: at a singularity, or with too few joints.
std::optional<ActiveVector> torques_for_tool_acceleration(const Posture& posture, const Rates& rates,
                                                          const ActiveVector& rate,
                                                          const ToolVector& acceleration,
                                                          const ToolVector& push = {});

/// Tool velocities v with v^T Lambda v = 1: the generalised inertia ellipsoid (Asada 1983). Half-axes are
/// 1/sqrt(principal mass) [m/s per sqrt(2 J)]: long where the tool is light. `mobility` as in `ToolMotion`.
Ellipsoid inertia_ellipsoid(const ToolMatrix& mobility);

/// Tool accelerations, beside the coasting one, under torques with |tau/limit| <= 1 (2-norm): half-axes are the
/// singular values of J M^-1 diag(limit) (Yoshikawa 1985).
Ellipsoid acceleration_ellipsoid(const ToolMotion& motion, const ActiveVector& torque_limit);

/// sqrt(det(J M^-2 J^T)), the dynamic manipulability: the volume of the ellipsoid of unit torques but for a
/// constant (Yoshikawa 1985). 0 at a singularity.
double dynamic_manipulability(const ToolMotion& motion);

/// All tool accelerations within the torque range, exactly, from the posture and rates of `motion`: the
/// polytope is shifted by weight and coasting, so that `inner_radius` is what is there in every direction, 0
/// where even rest cannot be kept. Allocates.
Zonotope acceleration_polytope(const ToolMotion& motion, const TorqueRange& range);

/// One instant of a motion.
struct MotionSample {
  ActiveVector joints, rate, acceleration;
  ToolVector push = {};  ///< of the user; empty: none
};

/// What a motion asks of the drives.
struct MotionPower {
  int samples = 0;          ///< whose loops closed
  ActiveVector torque;      ///< largest |torque| of each joint [N m, N]
  ActiveVector rms;         ///< root of the mean square of the torque [N m, N]
  ActiveVector peak;        ///< most power that a joint gives, 0 if it only takes [W]
  ActiveVector braking;     ///< most that it takes [W]
  double total_peak = 0.0;  ///< most that all give together at one instant [W]
  int total_peak_at = -1;   ///< index of that sample, -1 if they never give any
};
/// Samples count alike; those whose posture cannot be reached are left out.
MotionPower motion_power(const Mechanism& mechanism, std::span<const MotionSample> motion);

}  // namespace zwidth
