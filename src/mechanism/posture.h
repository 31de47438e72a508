#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/redundancy.h"
#include "zwidth/mechanism/sizes.h"
#include "zwidth/mechanism/solve_status.h"

namespace zwidth {

namespace internal {
class PostureBuilder;
}

/// A mechanism with every joint, active and passive, solved: the only door to Jacobian, statics and dynamics.
/// Only the solvers make one, so nothing can be asked before the loops are closed. The mechanism must outlive
/// it.
class Posture {
 public:
  const Mechanism& mechanism() const { return *mechanism_; }
  const JointVector& joints() const { return joints_; }  ///< all joints, leg after leg [rad] or [m]
  ActiveVector active() const;                           ///< the active ones [rad] or [m]
  const Pose& tool() const { return tool_; }             ///< platform frame in the base frame

  /// Origin of the link that joint j moves (a point on the joint's axis), and the axis' direction, in the base
  /// frame.
  const Vector3& joint_point(int j) const { return links_[j].point; }
  const Vector3& joint_axis(int j) const { return links_[j].axis; }
  /// Orientation of the link that joint j moves.
  const Matrix3& link_rotation(int j) const { return links_[j].rotation; }
  /// Where leg l meets the platform, base frame [m].
  const Vector3& leg_tip(int l) const { return tips_[l].point; }
  /// Orientation that leg l gives the platform: of what follows its last joint (of its last link, unless that
  /// is a parallelogram's bars), times `LegModel::platform_rotation`.
  const Matrix3& leg_tip_rotation(int l) const { return tips_[l].rotation; }

  // Copies what is in use: most mechanisms fill a small part of the arrays.
  Posture(const Posture& other) { *this = other; }
  Posture& operator=(const Posture& other);

 private:
  friend class internal::PostureBuilder;
  explicit Posture(const Mechanism& mechanism) : mechanism_(&mechanism) {}

  // The idle numbers let every vector be written as four lanes.
  struct Link {
    Vector3 point, axis;
    Matrix3 rotation;
    double idle;
  };
  struct Tip {
    Vector3 point;
    Matrix3 rotation;
    double idle;
  };

  const Mechanism* mechanism_;
  JointVector joints_;
  Pose tool_;
  std::array<Link, kMaxJoints> links_;
  std::array<Tip, kMaxLegs> tips_;
};

/// How to solve.
struct SolveOptions {
  const Posture* start = nullptr;  ///< follow on from this posture; null starts from the mechanism's home guess
  bool closed_form = true;         ///< use a closed form where there is one; false forces the general solver
  bool restart = true;        ///< where the way from the start is lost, look for another: slow if there is none
  double tolerance = 1e-12;   ///< on the loop closure, relative to the characteristic length
  int max_iterations = 200;   ///< Newton steps in all, over every step of the way from the start
  Match match = Match::pose;  ///< what an inverse has to meet; `position` alone only of a serial arm
  Redundancy redundancy = {};  ///< which of its postures an arm with joints to spare takes
};

/// Reciprocal conditions of the closure below this make a posture degraded.
inline constexpr double kNearSingularity = 1e-4;

/// What solving came to.
struct Solution {
  SolveStatus status = SolveStatus::unreachable;
  int joint = -1;      ///< joint at fault (index among all joints), -1 if none
  int iterations = 0;  ///< Newton steps; 0 for a closed form
  double residual =
      -1.0;  ///< closure error left where solving stopped [m, rad x characteristic length]; -1 if none
  double conditioning = 0.0;       ///< reciprocal condition of the closure at the answer, 0 singular .. 1
  bool other_assembly = false;     ///< the joints, driven to these values, would take the tool elsewhere: the
                                   ///< posture is of another assembly mode than the mechanism's own
  std::optional<Posture> posture;  ///< present unless unreachable or degenerate

  explicit operator bool() const { return posture.has_value(); }
  /// Near a singularity, as the status degraded says, also where the status is joint_limit.
  bool near_singularity() const { return posture.has_value() && conditioning < kNearSingularity; }
};

/// The posture of given active joint values [rad] or [m].
/// Active values outside their range answer joint_limit, with the posture.
/// REQUIRES: active.size() == mechanism.active_count(), all finite.
Solution solve_forward(const Mechanism& mechanism, const ActiveVector& active,
                       const SolveOptions& options = {});

/// The posture that brings the tool to a pose, nearest to the start (closed form: the device's own branch); of
/// an arm with joints to spare, as `SolveOptions::redundancy` says. A mechanism that only translates ignores
/// the rotation. A pose that only another assembly mode reaches is unreachable, unless a joint would be beyond
/// its range anyway: that is joint_limit; with a start the posture follows that, and its mode is not looked at.
/// REQUIRES: all finite; `match` is pose unless mechanism.serial(); a joint to keep is one of the active ones.
Solution solve_inverse(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options = {});

/// Every posture that brings the tool to a pose, one per combination of the legs' roots, other assembly modes
/// included; first those of the mechanism's own within the joint ranges. Of an arm with joints to spare every
/// one that the rule singles out: with a joint kept every posture, else the best of each branch. Empty if
/// unreachable. The general solver searches from seeded starts, so it may miss a root of a leg with more than
/// three joints. Allocates.
std::vector<Solution> solve_inverse_all(const Mechanism& mechanism, const Pose& tool,
                                        const SolveOptions& options = {});

}  // namespace zwidth
