#pragma once

#include "zwidth/mechanism/posture.h"

namespace zwidth::internal {

/// The solvers' hand inside a posture: joints and tool may be set freely while the loops are still open.
class PostureBuilder {
 public:
  static Posture open(const Mechanism& mechanism) { return Posture(mechanism); }

  static JointVector& joints(Posture& posture) { return posture.joints_; }
  static Pose& tool(Posture& posture) { return posture.tool_; }

  /// Recomputes the frames of leg l from its joints.
  static void place_leg(Posture& posture, int l) noexcept;
  static void place_legs(Posture& posture) noexcept;
};

/// Closure error of leg l, tip minus platform point, and for a rigid attachment link against platform
/// orientation (rotation vector times the characteristic length). Returns the number of rows, 3 or 6 [m].
int closure_error(const Posture& posture, int l, std::array<double, 6>& error) noexcept;

/// Velocity of leg l's closure rows per rate of joint j of that leg (rotations times the characteristic
/// length).
void closure_column(const Posture& posture, int l, int j, std::array<double, 6>& column) noexcept;

/// Velocity of leg l's closure rows per component of the platform's twist, whose angular part is scaled by the
/// characteristic length. `columns` is tool_rows() long.
void platform_columns(const Posture& posture, int l, std::array<std::array<double, 6>, 6>& columns) noexcept;

/// Rows of leg l's closure.
inline int closure_rows(const LegModel& leg) {
  return leg.attachment == Attachment::rigid ? 6 : 3;
}

/// Smallest rotation vector of R [rad].
Vector3 rotation_vector(const Matrix3& R) noexcept;

/// Brings a revolute angle into its range if a whole number of turns does, else into (-pi, pi].
double wrapped(const JointModel& joint, double value) noexcept;

}  // namespace zwidth::internal
