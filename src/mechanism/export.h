#pragma once

#include <string>
#include <vector>

#include "zwidth/mechanism/posture.h"

/// A mechanism for other programs: as MJCF for MuJoCo, closed loops and all, and as URDF, which only knows
/// trees.

namespace zwidth {

struct ExportedModel {
  std::string text;                  ///< the XML document
  std::vector<std::string> notices;  ///< what the format cannot say, in sentences; also in the document
};

struct MjcfOptions {
  /// Of the equality constraints that close the loops, 0 to 1: MuJoCo's own give way by what is missing to 1,
  /// and it takes at most 0.9999.
  double impedance = 0.9999;
};

/// The model stands in `home`, a posture that closes the loops; joint positions read as they do here. Links
/// without a mass have one of 1e-9 kg, as MuJoCo needs some. Joints are called LEG_JOINT; those that drives
/// move have a motor of that name, drive inertia is armature. Allocates.
ExportedModel export_mjcf(const Posture& home, const MjcfOptions& options = {});

/// Every leg as a branch in its zero posture, where all link frames are parallel to the base frame; the
/// platform on the first leg. Links without a mass have one of 1e-9 kg. `effort` and `speed` of the active
/// joints [N m, N; rad/s, m/s] fill the limits that URDF asks for; where they are not finite or missing, zero,
/// which says nothing. Allocates.
ExportedModel export_urdf(const Mechanism& mechanism, const ActiveVector& effort = {},
                          const ActiveVector& speed = {});

}  // namespace zwidth
