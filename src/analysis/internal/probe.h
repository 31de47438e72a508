#pragma once

#include <optional>

#include "zwidth/mechanism/posture.h"

namespace zwidth::internal {

/// Asks a mechanism of three active joints whose tool translates, posture after posture. Follows on from the
/// last answer where there is no closed form, so each thread has its own, and the same questions in the same
/// order get the same answers.
class Probe {
 public:
  /// REQUIRES: !workspace_obstacle(mechanism). The mechanism must outlive the probe.
  explicit Probe(const Mechanism& mechanism);

  struct Answer {
    bool reached = false;              ///< the loops close; the rest means nothing otherwise
    bool on_branch = false;            ///< with the device's assembly and working modes
    bool inside = false;               ///< on the branch, with the joints within their ranges
    Vector3 joints = Vector3::Zero();  ///< active joints [rad]
    Vector3 position = Vector3::Zero();
    Matrix3 jacobian = Matrix3::Zero();
  };

  Answer inverse(const Vector3& position);
  /// The joint ranges are not looked at for `reached`.
  Answer forward(const Vector3& joints);
  /// Posture of the last inverse question that was reached, for what needs more than the Jacobian.
  std::optional<Posture> posture(const Vector3& position);

  /// Forgets the last answer.
  void restart() { last_.reset(); }

  const Mechanism& mechanism() const { return *mechanism_; }
  Interval range(int joint) const { return mechanism_->active_range(joint); }
  Vector3 middle() const;  ///< of the joint ranges

 private:
  Solution solve_at(const Vector3& position);
  SolveOptions follow() const;
  bool within_ranges(const Vector3& joints) const;
  Answer answer_from(const Posture& posture) const;

  const Mechanism* mechanism_;
  Matrix3 rotation_ = Matrix3::Identity();
  // Sign of det J in the middle of the joint ranges; 0 for a mechanism of one leg, which has no loops that a
  // singularity could reassemble: all its postures are its own.
  double branch_ = 1.0;
  std::optional<Posture> middle_;  // in the middle of the joint ranges
  std::optional<Posture> last_;    // that was inside
};

}  // namespace zwidth::internal
