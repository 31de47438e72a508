#pragma once

#include <array>
#include <string_view>

#include "zwidth/math/spatial.h"

/// An arm of seven revolute joints in closed form: a spherical shoulder (axes 1, 2, 3 meet in one point), an
/// elbow, a spherical wrist (axes 5, 6, 7 meet in one point), S-R-S for short, after Başer 2006, chapters 3 and
/// 5, with the misprints put right that docs/devices/seven-dof.md lists.
///
/// Base frame: origin in the shoulder, z along axis 1. With all angles zero the arm is stretched along z, axes
/// 1, 3, 5, 7 lie along it and axes 2, 4, 6 along y:  C = Rz(t1) Ry(t2) Rz(t3) Ry(t4) Rz(t5) Ry(t6) Rz(t7). Any
/// lengths; everything here is noexcept and allocates nothing. Arms that differ by where base, tool and the
/// zeros of the joints lie are brought to this form by the closed form of their `Mechanism`.

namespace zwidth {

struct SrsLengths {
  double upper_arm = 0.0;  ///< d3, shoulder to elbow [m]
  double forearm = 0.0;    ///< d4, elbow to wrist [m]
};

using SrsAngles = std::array<double, 7>;  ///< theta1..theta7 [rad]

/// Wrist point and tool orientation of seven angles, and their Jacobian.
struct SrsForward {
  Pose wrist;                            ///< r and C
  Eigen::Matrix<double, 6, 7> jacobian;  ///< of the wrist point, linear over angular, base frame [m/rad, 1]
};
SrsForward srs_forward(const SrsLengths& lengths, const SrsAngles& theta) noexcept;

// ----------------------------------------------------------------------------------------------------- inverse

/// The joint of the shoulder whose angle is given, since seven joints leave one of them open.
enum class SrsGiven { theta1 = 1, theta2 = 2, theta3 = 3 };

/// What an inverse came to. The tests are made in this order.
enum class SrsStatus {
  solved,
  invalid_argument,        ///< not finite, a length not positive, or no rotation (to 1e-6)
  unreachable,             ///< nearer than |d3 - d4| or farther than d3 + d4
  singular_elbow,          ///< stretched or folded: theta3 and theta5 turn about one line (|sin theta4| < 1e-9)
  theta1_undefined,        ///< theta2 or theta3 given, and the wrist on axis 1, or axis 3 too (1e-10 m)
  theta2_undefined,        ///< the wrist on axis 2 (1e-10 m)
  no_solution_for_theta1,  ///< not with this theta1
  no_solution_for_theta2,
  no_solution_for_theta3,
  singular_wrist,  ///< theta6 is 0 or 180 deg for one of the arm's solutions: theta5 and theta7 turn about one
                   ///< line
};
std::string_view to_string(SrsStatus status);

/// Every (theta1..theta4) that brings the wrist to a point: theta4 of either sign times two. Angles in (-pi,
/// pi]. (theta3, theta4) and (theta3 + pi, -theta4) are the same posture of the links.
struct SrsArmSolutions {
  SrsStatus status = SrsStatus::unreachable;
  int count = 0;  ///< 4 if solved, else 0; where two coincide both are listed
  std::array<std::array<double, 4>, 4> theta{};
};
SrsArmSolutions srs_arm_inverse(const SrsLengths& lengths, const Vector3& wrist, SrsGiven given,
                                double angle) noexcept;

/// Every (theta1..theta7) that brings the wrist to a pose: the arm's four solutions times two of the wrist.
struct SrsSolutions {
  SrsStatus status = SrsStatus::unreachable;
  int count = 0;  ///< 8 if solved or singular_wrist, else 0
  std::array<SrsAngles, 8> theta{};
};
/// Where theta6 is 0 or 180 deg only theta5 + theta7 or theta5 - theta7 is defined; theta5 is then
/// `open_theta5`.
SrsSolutions srs_inverse(const SrsLengths& lengths, const Pose& wrist, SrsGiven given, double angle,
                         double open_theta5 = 0.0) noexcept;

/// Where the elbow may be with the wrist held: a circle about the line from shoulder to wrist.
struct SrsElbowCircle {
  SrsStatus status =
      SrsStatus::unreachable;        ///< solved, or one of the next three; a singular elbow has a circle too
  Vector3 centre = Vector3::Zero();  ///< [m]
  Vector3 cosine_arm =
      Vector3::Zero();  ///< from the centre to the elbow at angle 0 [m]: towards z, or x if the line is z
  Vector3 sine_arm = Vector3::Zero();  ///< from the centre to the elbow at 90 deg [m]
  double bend = 0.0;                   ///< |theta4| [rad]

  /// Angle of the elbow of a posture [rad].
  double angle_of_elbow(const SrsLengths& lengths, const SrsAngles& theta) const noexcept;
};
SrsElbowCircle srs_elbow_circle(const SrsLengths& lengths, const Vector3& wrist) noexcept;

/// The joint angles with the elbow at an angle [rad] of its circle, on one of eight branches: bit 0 is the sign
/// of theta6, bit 1 that of theta4, bit 2 that of theta2. Along the circle a branch is continuous except where
/// theta2 or theta6 passes 0 or pi. An angle that a singularity leaves open (theta1 with theta2 = 0, theta3
/// with theta4 = 0, theta5 with theta6 = 0) is that of `near`. REQUIRES: `circle` is solved or singular_elbow.
SrsAngles srs_on_circle(const SrsLengths& lengths, const Pose& wrist, const SrsElbowCircle& circle,
                        double elbow, int branch, const SrsAngles& near) noexcept;

/// Where on its circle the elbow is if a joint has a given angle.
struct SrsElbows {
  int count = 0;                  ///< 0, 1 or 2
  std::array<double, 2> elbow{};  ///< angles on the circle [rad]
};
/// `joint` is 0..6 for theta1..theta7, without theta4, which is the same everywhere on the circle. The joint
/// has the angle on some of the eight branches there, on the others the angle's other reading (theta + pi, or
/// -theta of theta2 and theta6). Nothing where the joint does not change along the circle. REQUIRES: as above;
/// joint is not 3.
SrsElbows srs_elbows_with(const SrsLengths& lengths, const Pose& wrist, const SrsElbowCircle& circle, int joint,
                          double angle) noexcept;

// ------------------------------------------------------------------------------------------------------- reach

/// Distances of the wrist from the shoulder that an elbow within a range allows [m].
Interval srs_reach(const SrsLengths& lengths, const Interval& theta4) noexcept;

/// Where the wrist can be with theta1..theta4 within ranges, whatever the tool's orientation: decided exactly,
/// without a search. If any elbow is possible then one is with one of the joints at an end of its range, or all
/// are.
class SrsReach {
 public:
  /// Ranges [rad] of theta1..theta4, modulo a turn; one of width 0 is a locked joint. REQUIRES: min <= max.
  SrsReach(const SrsLengths& lengths, const std::array<Interval, 4>& ranges) noexcept;

  bool contains(const Vector3& wrist) const noexcept;

 private:
  // A range of angles as cos(angle - middle) >= cos(half the width).
  struct Window {
    double cos_middle = 1.0, sin_middle = 0.0, cos_half = -2.0;
    std::array<std::array<double, 2>, 2> end{};  // sine and cosine of both ends
    bool bounded = false;                        // narrower than a turn
    bool locked = false;
  };
  template <class Root>
  bool within(const Root& root, int given) const noexcept;
  bool off_axis_contains(const Vector3& wrist) const noexcept;

  SrsLengths lengths_;
  std::array<Window, 4> window_;
};

// ----------------------------------------------------------------------------------------------- singularities

/// A set of postures in which the Jacobian loses rank.
struct SrsSingularity {
  std::string_view name;   ///< "elbow", "shoulder", "wrist" or "shoulder and wrist"
  std::string_view what;   ///< the same in words, whatever zeros the joints have
  std::string_view where;  ///< "theta4 = 0 or 180 deg"
  std::string_view
      carried;            ///< load that the links then carry without any torque: the tool cannot move along it
  double distance = 0.0;  ///< of the joint angles from the nearest posture of the set [rad]
};

/// The four sets whose union is where rank J < 6; elsewhere J has full rank, also where one of the
/// parameterisations above breaks (theta2 = 0 alone, x = y = 0, theta6 = 0 alone).
std::array<SrsSingularity, 4> srs_singularities(const SrsAngles& theta) noexcept;

/// det [Jr2 Jr3 Jr4] = -d3 d4^2 s4^2 c3 and det [Jr1 Jr3 Jr4] = -d3 d4^2 s4^2 s2 s3: the wrist's position loses
/// a freedom where both are zero [m^3].
std::array<double, 2> srs_position_minors(const SrsLengths& lengths, const SrsAngles& theta) noexcept;

/// sqrt(det(Jr Jr^T)) of the wrist's position (Yoshikawa 1985) [m^3].
double srs_position_manipulability(const SrsLengths& lengths, const SrsAngles& theta) noexcept;

/// Rank of the Jacobian: singular values above 1e-9, with the wrist's velocity divided by d3 + d4.
int srs_jacobian_rank(const SrsLengths& lengths, const SrsAngles& theta);

}  // namespace zwidth
