#pragma once

#include <Eigen/Core>
#include <vector>

#include "zwidth/mechanism/posture.h"

/// The linearised loop closure as one matrix: for questions about rank and direction that no tick asks.
/// Allocates.

namespace zwidth::internal {

/// Closure equations A q - B x = 0, in all joint rates q and, after them, the six components of the platform's
/// twist x, its angular part times the characteristic length. Rows leg after leg, as `closure_error`.
Eigen::MatrixXd closure_equations(const Posture& posture);

/// Columns of the closure equations by what they stand for.
struct Unknowns {
  std::vector<int> joints, passive, active;
  std::vector<int> declared;  ///< of the platform, as `Mechanism::tool_axes`
  /// Of the platform, those that count: all six if every leg holds it rigidly, for then the legs see to what it
  /// does.
  std::vector<int> platform;
};
Unknowns unknowns_of(const Mechanism& mechanism);

bool held_rigidly(const Mechanism& mechanism);

}  // namespace zwidth::internal
