#pragma once

#include <optional>

#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth {

/// Whether the tool point of an arm can be at a point with all joints in their ranges, whatever the orientation
/// of the tool: decided exactly, without a search.
class PointReach {
 public:
  /// Nothing unless the arm is of the S-R-S form (srs_arm.h) and its tool point is the wrist.
  static std::optional<PointReach> of(const Mechanism& mechanism);

  /// `point` in the base frame [m].
  bool contains(const Vector3& point) const noexcept {
    return reach_.contains(base_.rotation.transpose() * (point - base_.position));
  }

 private:
  PointReach(const Pose& base, const SrsReach& reach) : base_(base), reach_(reach) {}

  Pose base_;  // of the shoulder
  SrsReach reach_;
};

}  // namespace zwidth
