#pragma once

#include "zwidth/analysis/force.h"
#include "zwidth/description/description.h"
#include "zwidth/mechanism/posture.h"

/// Loads on the tool as people state them, and the torques that hold them.

namespace zwidth {

/// The wrench in base components about the tool point, from a force in the base frame and a moment in `frame`;
/// `tool` has the tool's axes as columns. REQUIRES: finite.
Wrench wrench_in_base(const Vector3& force, const Vector3& moment, MomentFrame frame,
                      const Matrix3& tool) noexcept;

/// A wrench as the rows of the Jacobian have it (`Mechanism::tool_axes`): what the tool's freedoms feel of it.
/// The rest is carried by the structure.
ToolVector tool_load(const Mechanism& mechanism, const Wrench& wrench) noexcept;

/// Torques Q [N m, N] that hold a wrench R of the environment on the tool, Q = -J^T R (Baser 2006, eq 5.2). A
/// load of the tool on its environment is the negative: `torques_for_load`.
inline ActiveVector torques_against(const Jacobian& jacobian, const ToolVector& environment) {
  return torques_for_load(jacobian, -environment);
}

/// Torques that hold a load of the tool on its environment in a posture, beside the weight of the links.
ActiveVector load_torques(const Posture& posture, const LoadDescription& load) noexcept;

/// Stiffness [N/m] from the deflection [m] under a mass [kg] hung on the tool. Throws std::invalid_argument
/// unless all are positive and finite.
double stiffness_under_weight(double mass, double deflection, double gravity = kStandardGravity);

}  // namespace zwidth
