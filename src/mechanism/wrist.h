#pragma once

#include <array>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/solve_status.h"

namespace zwidth {

/// Up to three revolute joints, one after the other, whose axes meet in a point: they turn the tool about it.
/// The wrists of the pneumatic prototypes are of this kind, with two joints (Akhoondi Asadi 2017, table 3) or,
/// with the turning handle, three. Axes may stand at any angle but 0 to the next.
class Wrist {
 public:
  static constexpr int kMostJoints = 3;
  using Angles =
      std::array<double, kMostJoints>;  ///< of the joints, in order [rad]; those beyond `count` are 0

  struct Solutions {
    SolveStatus status = SolveStatus::unreachable;  ///< reached or unreachable
    int count = 0;                                  ///< 1 with up to two joints, 2 with three
    std::array<Angles, 2> angles{};                 ///< in (-pi, pi]
  };

  /// Of the joints of a leg from number `first` on; empty unless they are of this kind.
  static std::optional<Wrist> of(const LegDescription& leg, std::size_t first);

  int joint_count() const noexcept { return count_; }
  int branch_count() const noexcept { return count_ == kMostJoints ? 2 : 1; }
  /// Where the axes meet, at the leg's zero posture [m]; of one axis its point nearest to the tip, of none the
  /// tip.
  const Vector3& centre() const noexcept { return centre_; }

  /// The angles whose turns, about the axes as they lie at the zero posture, come to `turn`: Rot(a1) Rot(a2)
  /// Rot(a3). Fewer than three joints give only some turns: others, by more than 1e-7, are unreachable. Where
  /// the outer axes coincide the first joint is at `near`. REQUIRES: `turn` is a rotation.
  Solutions inverse(const Matrix3& turn, const Angles& near) const noexcept;

 private:
  int count_ = 0;
  std::array<Vector3, kMostJoints> axis_;
  Vector3 centre_;
};

}  // namespace zwidth
