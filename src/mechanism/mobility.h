#pragma once

#include "zwidth/mechanism/posture.h"

namespace zwidth {

/// How many degrees of freedom a mechanism has, and whether its active joints are the right number of them.
struct Mobility {
  int gruebler = 0;  ///< freedoms of joints and platform less closure equations; too low if equations repeat
  int freedoms = 0;  ///< from the rank of the closure at this posture: the true local number
  int tool_freedoms = 0;        ///< of the platform, with the joints free to follow
  int redundant_equations = 0;  ///< closure equations that repeat others: an overconstrained mechanism
  int active = 0;               ///< active joints
};

/// Counted at one posture by singular values (tolerance 1e-8 of the largest); a singular posture counts more
/// freedoms.
Mobility mobility(const Posture& posture);

}  // namespace zwidth
