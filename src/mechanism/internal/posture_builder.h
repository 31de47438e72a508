#pragma once

#include "zwidth/mechanism/posture.h"

namespace zwidth::internal {

/// The solvers' hand inside a posture: joints and tool may be set freely while the loops are still open.
class PostureBuilder {
 public:
  static Posture open(const Mechanism& mechanism) { return Posture(mechanism); }
  /// Joints and tool of another posture; its frames are not placed yet.
  static Posture unplaced(const Posture& other) {
    Posture posture(*other.mechanism_);
    posture.joints_ = other.joints_;
    posture.tool_ = other.tool_;
    return posture;
  }

  static JointVector& joints(Posture& posture) { return posture.joints_; }
  static Pose& tool(Posture& posture) { return posture.tool_; }

  /// Recomputes the frames of leg l from its joints.
  static void place_leg(Posture& posture, int l) noexcept;
  static void place_legs(Posture& posture) noexcept;

 private:
  struct Turns;  // sines and cosines of the joints
  static void place(Posture& posture, int l, const Turns& turns) noexcept;
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

/// Smallest rotation vector that turns `from` into `to`, in the frame that both map to [rad].
Vector3 rotation_between(const Matrix3& from, const Matrix3& to) noexcept;

/// R turned by a rotation vector that is given in the frame R maps to [rad].
Matrix3 turned_by(const Vector3& turn, const Matrix3& R) noexcept;

/// The rotation nearest to R, which is one but for rounding: what a long row of products needs now and then.
inline Matrix3 orthonormal(const Matrix3& R) {
  return R *
         (1.5 * Matrix3::Identity() - 0.5 * R.transpose() * R);  // one step of Newton's for the polar factor
}

/// Brings a revolute angle into its range if a whole number of turns does, else into (-pi, pi].
double wrapped(const JointModel& joint, double value) noexcept;

}  // namespace zwidth::internal
