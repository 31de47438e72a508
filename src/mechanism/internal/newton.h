#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "zwidth/mechanism/posture.h"

/// What the general solver's two iterations share: that over all legs and that over one.

namespace zwidth::internal {

inline constexpr double kLongestStep =
    0.4;  // of what leads the way: active joints [rad, characteristic lengths]
inline constexpr double kShortestStep = 1e-4;  // share of the way; a shorter step that fails ends the search
inline constexpr double kLargestCorrection =
    1.5;                                // of a joint within one step; more is a jump to another branch
inline constexpr double kLoose = 1e-5;  // closure on the way, relative to the characteristic length

struct Newton {
  bool converged = false;
  double residual = -1.0;
  int iterations = 0;
  double contraction = 0.0;  // of the second correction against the first
  double moved = 0.0;        // by the corrections since the closure was factored [rad, characteristic lengths]
};

struct Budget {
  int left;
  int used = 0;
};

// Says when Newton no longer gets nearer: near a singularity it still halves the gap, without a solution it
// does not.
class Stagnation {
 public:
  bool reached(double residual) {
    if (residual < 0.5 * best_) {
      best_ = residual;
      since_ = 0;
    }
    return ++since_ > kPatience;
  }

 private:
  static constexpr int kPatience = 12;
  double best_ = std::numeric_limits<double>::infinity();
  int since_ = 0;
};

// Says when the factors of the last Newton step will do for the next one too. Their step leaves of the residual
// about twice what the last one left; if that meets the tolerance with much to spare, there is no need to
// factor again for it.
class Reuse {
 public:
  bool allowed(double residual, double tolerance) {
    constexpr double kSpare = 5.0;
    const bool reuse = residual * residual * 2.0 * kSpare < tolerance * before_;
    before_ = reuse ? 0.0 : residual;
    return reuse;
  }

 private:
  double before_ = 0.0;  // the residual that the factors were made for; 0 if there are none
};

inline double scaled(const JointModel& joint, double change, double length) {
  return std::abs(joint.type == JointType::prismatic ? change / length : change);
}

// Lets go of a correction that would leave the branch: all components shrink together.
inline double damping(double largest) {
  constexpr double kTrust = 0.6;
  return largest > kTrust ? kTrust / largest : 1.0;
}

inline bool jumped(const Posture& posture, const JointVector& before) {
  const Mechanism& mechanism = posture.mechanism();
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    if (scaled(mechanism.joints()[j], posture.joints()[j] - before[j], mechanism.characteristic_length()) >
        kLargestCorrection) {
      return true;
    }
  }
  return false;
}

}  // namespace zwidth::internal
