#pragma once

#include <array>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/solve_status.h"

/// The modified R-CUBE in closed form (Görgülü 2018, chapter 5, as corrected in docs/devices/r-cube.md).
///
/// Base frame: axes e1, e2, e3. Leg i moves the tool along its own axis a, with (a, b, c) = (1, 2, 3), (2, 3,
/// 1), (3, 1, 2) for legs 1, 2, 3. Its motor axis passes through S e_a along e_b; at q_i1 = 0 the drive link
/// points along e_c, and positive angles turn e_c towards e_a. A universal joint undoes that turn and lets the
/// two outer links swing about e_a: q_i2 between e_c and the inner link, q_i3 at the elbow between the two.
/// Everything here is noexcept, allocates nothing and works on any lengths, but for the bodies at the end.

namespace zwidth {

/// The lengths that kinematics needs, equal in all legs.
struct RCubeGeometry {
  double drive_link = 0.0;   ///< l1, from the motor axis to the universal joint [m]
  double inner_link = 0.0;   ///< l2, from the universal joint to the elbow [m]
  double outer_link = 0.0;   ///< l3, from the elbow to the platform [m]
  double base_offset = 0.0;  ///< S, of each motor axis from the base origin [m]

  double total_length() const { return drive_link + inner_link + outer_link; }  ///< l1 + l2 + l3 [m]
  /// Links finite and longer than zero, offset finite.
  bool valid() const;
};

RCubeGeometry r_cube_geometry(const RCubeDescription& description);

/// Base axis (0, 1, 2) that leg i in 0..2 calls a (step 0), b (1) and c (2) (eq 5.35-5.37).
constexpr int r_cube_axis(int leg, int step) {
  return (leg + step) % 3;
}

/// Which of its four ways a leg takes to a tool position.
struct RCubeBranch {
  bool turned_over = false;  ///< the drive link beyond a right angle: pi - q_i1 instead of q_i1
  int elbow = -1;            ///< sigma, the sign of q_i3
};
using RCubeBranches = std::array<RCubeBranch, 3>;

inline constexpr int kRCubeBranches = 64;

/// Branches numbered 0..63: bits 2i and 2i + 1 turn leg i's drive link over and take its other elbow. Number 0
/// is the device's own, with every elbow on side `elbow`.
RCubeBranches r_cube_branches(int number, int elbow = -1) noexcept;

/// Every angle of a posture, and the Jacobian.
struct RCubeSolution {
  SolveStatus status = SolveStatus::unreachable;  ///< reached, degraded, joint_limit, degenerate (a swing is
                                                  ///< free: equal links folded onto each other) or unreachable
  /// Joint at fault, counted leg after leg in the order of `r_cube_leg_joints`; -1 if none.
  int joint = -1;
  Vector3 position = Vector3::Zero();  ///< platform point r [m]
  Vector3 theta = Vector3::Zero();     ///< driven angles q_i1 [rad]
  Vector3 swing = Vector3::Zero();     ///< q_i2 [rad]
  Vector3 elbow = Vector3::Zero();     ///< q_i3 [rad]
  Vector3 lever = Vector3::Zero();     ///< diagonal of J_m, l1 cos q_i1; the rest is zero (eq 5.49) [m/rad]

  bool closed() const { return status < SolveStatus::degenerate; }
  /// Unreachable because a driven link does not reach, rather than the two links that follow it.
  bool drive_too_short() const { return status == SolveStatus::unreachable && joint >= 0 && joint % 5 == 0; }
};

/// All joints of one leg in 0..2, from the base outwards: theta, tilt, swing, elbow, wrist (eq 5.10-5.14)
/// [rad].
Eigen::Matrix<double, 5, 1> r_cube_leg_joints(const RCubeSolution& solution, int leg) noexcept;

/// Posture of three driven angles [rad], with the elbows on side `branches[i].elbow` (eq 5.28, 5.39-5.45).
/// Where the outer links of a leg do not reach: unreachable, with position and lever nevertheless.
RCubeSolution r_cube_forward(const RCubeGeometry& geometry, const Vector3& theta,
                             const RCubeBranches& branches = {}) noexcept;

/// Posture of a tool position [m] on given branches (eq 5.30, 5.39-5.45). Driven angles lie in (-pi, pi] and
/// are held against `limits` with 1e-9 rad. Tests come in the order unreachable, degenerate, joint_limit.
RCubeSolution r_cube_inverse(const RCubeGeometry& geometry, const Vector3& position, const Interval& limits,
                             const RCubeBranches& branches = {}) noexcept;

/// A posture in which the tool loses a freedom. All of the R-CUBE's are of this kind (eq 5.72).
struct RCubeSingularity {
  enum class Kind {
    drive_across,   ///< cos q_i1 = 0: the drive link points along the axis that it should move the tool along
    arm_stretched,  ///< q_i3 = 0: inner and outer link in one line
    arm_folded,     ///< q_i3 = +-pi: outer link back on the inner one
  };
  Kind kind = Kind::drive_across;
  int leg = 0;                          ///< 0..2
  double measure = 0.0;                 ///< |cos q_i1| or |sin q_i3|: 0 singular, 1 farthest
  double distance = 0.0;                ///< of the tool, along `direction`, from where it is singular [m]
  Vector3 direction = Vector3::Zero();  ///< unit: the velocity that is lost there, pointing towards it
};

/// "drive across", "arm stretched", "arm folded".
const char* to_string(RCubeSingularity::Kind kind) noexcept;

/// One solved posture of the R-CUBE, from which rates and singularities follow.
class RCubeState {
 public:
  /// Takes the angles of `solution`. One leg's Jacobian needs no more than its own; everything else REQUIRES
  /// solution.closed().
  RCubeState(const RCubeGeometry& geometry, const RCubeSolution& solution) noexcept;

  Matrix3 jacobian() const;                                ///< J_m, diagonal (eq 5.49) [m/rad]
  Matrix3 jacobian_rate(const Vector3& theta_rate) const;  ///< [m/(rad s)]
  Vector3 velocity(const Vector3& theta_rate) const;       ///< of the tool [m/s]
  /// J_m thetaddot + Jdot_m thetadot [m/s^2].
  Vector3 acceleration(const Vector3& theta_rate, const Vector3& theta_acceleration) const;

  /// J_i of leg i: tool velocity, base axes, per rate of q_i1, q_i2, q_i3 (eq 5.53-5.55) [m/rad].
  Matrix3 leg_jacobian(int leg) const;
  /// Its time derivative at the rates of q_i1, q_i2, q_i3 [m/(rad s)].
  Matrix3 leg_jacobian_rate(int leg, const Vector3& leg_rate) const;
  double leg_determinant(int leg) const;  ///< l1 l2 l3 cos q_i1 sin q_i3 (eq 5.71) [m^3]

  /// Whether a rate of some leg has no bound: |cos q_i1| or |sin q_i3| below 1e-6.
  bool singular() const;
  /// Rates of q_i1, q_i2, q_i3 for driven rates [rad/s] (eq 5.57); nothing if `singular()`.
  std::optional<Vector3> leg_rates(int leg, const Vector3& theta_rate) const;
  /// Their accelerations [rad/s^2] (eq 5.60); nothing if `singular()`.
  std::optional<Vector3> leg_accelerations(int leg, const Vector3& theta_rate,
                                           const Vector3& theta_acceleration) const;

  /// Two of every leg: that of its drive, and the nearer of its arm's two.
  std::array<RCubeSingularity, 6> singularities() const;
  /// The one of the smallest measure.
  RCubeSingularity nearest_singularity() const;

 private:
  // Solves J_i qdot_i = v.
  Vector3 solve_leg(int leg, const Vector3& v) const;

  RCubeGeometry geometry_;
  Vector3 r_;
  Vector3 q3_;
  Vector3 s1_, c1_, s2_, c2_, s23_, c23_,
      s3_;  // sines and cosines of q_i1, q_i2, q_i2 + q_i3, q_i3 of each leg
};

/// Bodies of the spelled-out R-CUBE: "drive_link", "inner_link" and "outer_link" become one body per leg.
std::vector<BodyDescription> r_cube_leg_bodies(const RCubeDescription& r_cube,
                                               const std::vector<BodyDescription>& bodies);

}  // namespace zwidth
