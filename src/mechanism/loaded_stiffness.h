#pragma once

#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/stiffness.h"

/// A loaded mechanism: how far its elastic links let the tool go under a load and their own weight, and how
/// stiff it is there (Pashkevich, Klimchik & Chablat 2011). Closed loops, deflected springs and passive joints
/// are in balance at the same time, in the deflected geometry.

namespace zwidth {

/// What acts on the mechanism while its drives are held.
struct Loading {
  Vector6 tool =
      Vector6::Zero();  ///< on the tool, about its point, in fixed directions of the base frame [N, N m]
  bool weights = true;  ///< of all bodies
};

enum class LoadedMethod {
  direct,    ///< one step from the undeflected posture: all that a small load needs
  iterated,  ///< until forces and loops are in balance
};

struct LoadedOptions {
  LoadedMethod method = LoadedMethod::iterated;
  double tolerance = 1e-12;  ///< on the last step, relative to the characteristic length
  int max_iterations = 100;
  StiffnessOptions stiffness = {};  ///< of the drives
};

enum class LoadedStatus {
  balanced,       ///< in balance to the tolerance, or one direct step as asked for
  not_converged,  ///< `max_iterations` were not enough: what stands in the result is not the answer
  unstable,       ///< the steps grow: the load is beyond what the structure bears (it buckles)
  rigid,          ///< some leg cannot give way: see `Stiffness::rigid`
  free,           ///< the tool is not held: see `Compliance::free`
};
/// "balanced", "not converged", ...
const char* to_string(LoadedStatus status) noexcept;

struct LoadedState {
  LoadedStatus status = LoadedStatus::rigid;
  int iterations = 0;
  double residual = 0.0;                   ///< size of the last step, relative to the characteristic length
  Pose tool;                               ///< where it has gone to
  Vector6 displacement = Vector6::Zero();  ///< from where it was: shift [m], and rotation vector [rad]
  /// Load per displacement about this state, with the geometric term: what loaded springs and turned links
  /// change. Not symmetric where the load has a moment. Only when balanced.
  Matrix6 stiffness = Matrix6::Zero();
};

/// REQUIRES: the posture's mechanism has no beam that moves on parallel bars; loads finite.
LoadedState loaded_stiffness(const Posture& posture, const Loading& loading,
                             const LoadedOptions& options = {}) noexcept;

}  // namespace zwidth
