#pragma once

#include <array>
#include <memory>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/closed_form.h"
#include "zwidth/mechanism/mechanism.h"

/// Three joints that bring a point anywhere in space, in closed form: two revolute joints with parallel axes,
/// and either a prismatic joint along them or, after them, a revolute one at right angles. The positioning
/// stages of the pneumatic prototypes are of this kind (Akhoondi Asadi 2017, section 3.2). A wrist may follow
/// (wrist.h): of a tool that is a point it is left to the hand, else it turns the tool as it should be.

namespace zwidth {

/// Joint values that bring the point to a position.
struct PositioningSolutions {
  SolveStatus status =
      SolveStatus::unreachable;  ///< reached, unreachable, or degenerate (joint 1 turns freely)
  int count = 0;                 ///< 0 unless reached; 2 or 4, where solutions coincide all of them
  std::array<std::array<double, 3>, 4> joints{};  ///< of the three, in the order of the leg [rad] or [m]
};

/// What one question leaves for the next: along the slide of an arm that has one, only the slide differs.
struct PositioningMemory {
  std::array<double, 2> across{};  ///< of the last position
  PositioningSolutions solutions;  ///< for it; a count below zero: nothing is known
  PositioningMemory() { solutions.count = -1; }
};

class PositioningArm {
 public:
  /// Empty unless the leg is of this kind. Axes count as parallel, at right angles or meeting to 1e-9. Its
  /// first three joints position the tip; the axes of any others must meet in it.
  static std::optional<PositioningArm> of(const LegDescription& leg);

  /// Largest number of solutions: 2 with a prismatic joint, else 4.
  int branch_count() const noexcept { return slide_ >= 0 ? 2 : 4; }

  /// All solutions for a position of the tool point [m], base frame; angles in (-pi, pi].
  PositioningSolutions inverse(const Vector3& position) const noexcept;
  /// The same, quicker where the last position differs along the slide only.
  PositioningSolutions inverse(const Vector3& position, PositioningMemory& memory) const noexcept;

 private:
  // Complex numbers are vectors across the parallel axes.
  struct Planar {
    double x = 0.0;
    double y = 0.0;
  };
  Planar across(const Vector3& v) const noexcept { return {e1_.dot(v), e2_.dot(v)}; }
  void plane(const Planar& r, const Planar& w, double third, PositioningSolutions& solutions) const noexcept;

  double upper_ = 0.0, upper_angle_ = 0.0;  // length and direction of the upper arm, across

  Vector3 n_, e1_, e2_;           // along the axes, and across them
  int slide_ = -1;                // index of the prismatic joint among the three, -1 if there is none
  int first_ = 0, second_ = 1;    // of the parallel revolute joints
  std::array<double, 3> sign_{};  // of each joint's direction along n
  Vector3 p1_, p2_, p3_, tip_;    // points of first, second and third joint, and the tool, zero posture
  Vector3 m_;                     // axis of the third revolute joint
};

/// The arm whose closed form a mechanism has, and its rows; null if its closed form is another, one
/// with a wrist, or none.
struct PositioningForm {
  const PositioningArm* arm = nullptr;
  const SerialChain* chain = nullptr;  ///< with the wrist, if there is one
};
PositioningForm positioning_form_of(const Mechanism& mechanism) noexcept;

/// The closed form of a serial arm of this kind, whose tool is a point or rigid; null if it is none. Of a rigid
/// tool the wrist has up to three joints, and may meet elsewhere than in the tool point.
std::shared_ptr<const ClosedForm> positioning_closed_form(const SerialDescription& arm);

}  // namespace zwidth
