#pragma once

#include <optional>
#include <string>
#include <vector>

#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth::internal {

/// Coordinates of poses that differ in some components only: positions with one orientation, or orientations at
/// one position.
struct PoseChart {
  Pose origin;            ///< what the coordinates leave as it is
  std::vector<int> axes;  ///< of the twist (0..5), ascending: all below 3, or none

  int dimension() const { return static_cast<int>(axes.size()); }
  bool turns() const { return axes.front() >= 3; }
  /// Coordinates are those of the position in the base frame [m], or of the rotation vector that turns the
  /// origin's orientation, in the base frame [rad]. REQUIRES: axes.
  Pose at(const Vector3& coordinates) const;
  /// Coordinates of a position. REQUIRES: !turns().
  Vector3 coordinates(const Vector3& position) const;
};

/// Leads a mechanism of legs whose tool turns from posture to posture, with every joint in its range and
/// without passing a singularity.
class PoseGuide {
 public:
  /// Why it cannot, as a phrase; nothing if it can.
  static std::optional<std::string> obstacle(const Mechanism& mechanism);
  /// REQUIRES: !obstacle(mechanism). The mechanism must outlive the guide.
  explicit PoseGuide(const Mechanism& mechanism);

  const Mechanism& mechanism() const { return *mechanism_; }
  const Posture& home() const { return home_; }
  /// Axes that the tool can move along without turning, and (3..5) turn about without moving; of one with fewer
  /// freedoms than components, as many as it has freedoms, those first that it can follow alone.
  const std::vector<int>& moves() const { return moves_; }
  const std::vector<int>& turns() const { return turns_; }
  /// Rows of a Jacobian that mean those: moves, then turns.
  Jacobian rows(const Jacobian& jacobian) const;

  struct Step {
    bool reached = false;                           ///< the loops close there, on the same branch
    bool inside = false;                            ///< with every joint in its range
    std::optional<Posture> posture = std::nullopt;  ///< if reached
    Rates rates = {};                               ///< if inside
  };
  /// The short way from a posture. Of a tool with fewer freedoms than components, what it neither moves along
  /// nor turns about comes as it does.
  Step step(const Posture& from, const Pose& to) const;
  /// How far the joint that is nearest to the end of its range is from it, sliding joints in characteristic
  /// lengths; below zero beyond. `nearest` is that joint, `upper` whether its upper end.
  double margin(const Posture& posture, int* nearest = nullptr, bool* upper = nullptr) const;

 private:
  double handedness(const Jacobian& jacobian) const;
  std::optional<Solution> lead(const Posture& from, const Pose& to) const;

  const Mechanism* mechanism_;
  Posture home_;
  std::vector<int> moves_, turns_;
  std::vector<Eigen::Index> rows_;
  double branch_ = 0.0;  // sign of det J at home; 0 where J is not square
};

}  // namespace zwidth::internal
