#pragma once

#include "zwidth/mechanism/posture.h"

namespace zwidth {

/// Rates of everything per rate of each active joint.
struct Rates {
  Jacobian tool;         ///< J: tool velocity (rows as `Mechanism::tool_rows`) per active rate
  RateMap joints;        ///< Gamma: rate of every joint per active rate
  double closure = 0.0;  ///< reciprocal condition of the loop-closure equations for the tool's velocity; 0: the
                         ///< tool has gained a freedom
};

/// Where the closure leaves the tool a freedom (`closure` is 0), that freedom counts as at rest.
Rates rates(const Posture& posture) noexcept;

/// J alone.
Jacobian jacobian(const Posture& posture) noexcept;

/// Acceleration of everything when the active joints keep their rates (the Jdot qdot terms).
struct BiasAcceleration {
  ToolVector tool;     ///< Jdot thetadot
  JointVector joints;  ///< Gammadot thetadot
};
BiasAcceleration bias_acceleration(const Posture& posture, const Rates& rates,
                                   const ActiveVector& active_rate) noexcept;

/// Of singular values (2-norm) of a tool that only translates or rotates: as many as rows or, if fewer, joints.
struct Dexterity {
  double condition_number = 0.0;  ///< largest over smallest singular value; infinity at a singularity
  double manipulability = 0.0;    ///< their product, sqrt(det(J J^T)) or sqrt(det(J^T J)) (Yoshikawa 1985)
  double min_singular_value = 0.0;
  double max_singular_value = 0.0;
  ToolVector weak_direction;  ///< unit tool direction of the smallest singular value: what a singularity loses
};
Dexterity dexterity(const Jacobian& jacobian);

}  // namespace zwidth
