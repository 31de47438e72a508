#pragma once

#include <array>

#include "zwidth/description/description.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/solve_status.h"

/// The delta in closed form (Neal 2015, appendices A and B, as corrected in docs/devices/delta.md).
///
/// Base frame {B}: z up, origin in the plane of the actuator axes, y towards leg 1; legs at 90, 210, 330 deg.
/// theta_i = 0 is horizontal outwards, positive lifts the elbow. Of the two assembly modes the device uses the
/// one with the larger z. Everything here is noexcept, allocates nothing and works on any lengths.

namespace zwidth {

/// The lengths that kinematics needs.
struct DeltaGeometry {
  double base_radius = 0.0;      ///< d1 [m]
  double upper_arm = 0.0;        ///< d2 [m]
  double forearm = 0.0;          ///< d3 [m]
  double platform_radius = 0.0;  ///< d4 [m]

  double offset() const { return base_radius - platform_radius; }  ///< d5, the only way d1 and d4 enter (A.1)
  double scale() const;                                            ///< d2 + d3 + |d5|
};

DeltaGeometry delta_geometry(const DeltaDescription& description);

/// Azimuth of leg i in 0..2 [rad].
double delta_azimuth(int leg);

/// Which root of a leg's inverse kinematics: the elbow away from the middle, or towards it.
enum class Knee { outwards, inwards };

struct DeltaForward {
  SolveStatus status =
      SolveStatus::unreachable;        ///< reached, unreachable (no closure) or degenerate (centres collinear)
  Vector3 position = Vector3::Zero();  ///< platform point p; zero unless reached [m]
  Matrix3 jacobian = Matrix3::Zero();  ///< J with pdot = J thetadot; zero unless reached [m/rad]
};

/// Tool position of three driven angles [rad], and its Jacobian.
DeltaForward delta_forward(const DeltaGeometry& geometry, const Vector3& theta) noexcept;

struct DeltaInverse {
  SolveStatus status = SolveStatus::unreachable;  ///< reached, unreachable, degenerate or joint_limit
  int joint = -1;                                 ///< first leg at fault, -1 if none
  Vector3 theta = Vector3::Zero();     ///< driven angles in (-pi, pi], also when one is beyond its limit [rad]
  Matrix3 jacobian = Matrix3::Zero();  ///< J with pdot = J thetadot [m/rad]
};

/// Driven angles [rad] of a tool position [m], per leg on the given root. `limits` is checked with 1e-9 rad.
/// Tests come in the order unreachable, degenerate, joint_limit.
DeltaInverse delta_inverse(const DeltaGeometry& geometry, const Vector3& position, const Interval& limits,
                           const std::array<Knee, 3>& knees = {Knee::outwards, Knee::outwards,
                                                               Knee::outwards}) noexcept;

/// One solved state of the delta, from which its rates, singularities and dynamics follow.
class DeltaState {
 public:
  /// REQUIRES: theta and position close the loops (from delta_forward or delta_inverse).
  DeltaState(const DeltaGeometry& geometry, const Vector3& theta, const Vector3& position) noexcept;

  const Vector3& theta() const { return theta_; }
  const Vector3& position() const { return p_; }
  const Matrix3& jacobian() const { return J_; }  ///< (A.32) [m/rad]; zero where det R = 0

  /// Time derivative of the Jacobian at driven rates [rad/s] (A.38) [m/(rad s)].
  Matrix3 jacobian_rate(const Vector3& theta_rate) const;
  Vector3 velocity(const Vector3& theta_rate) const;  ///< [m/s]
  /// pddot = Jdot thetadot + J thetaddot (A.37) [m/s^2].
  Vector3 acceleration(const Vector3& theta_rate, const Vector3& theta_acceleration) const;

  /// r_i . b_i / (d2 d3) of each leg, -1..1: zero where the leg is stretched or folded and the tool loses a
  /// freedom.
  Vector3 inverse_singularity() const;
  /// det R / d3^3, -1..1: zero where the forearms are coplanar and the tool gains a freedom.
  double direct_singularity() const;

 private:
  DeltaGeometry geometry_;
  Vector3 theta_;
  Vector3 p_;
  Matrix3 R_;     // rows r_i, forearm vectors from elbow to platform joint
  Matrix3 b_;     // rows b_i, elbow velocity per driven rate
  Matrix3 Rinv_;  // zero where det R = 0
  Matrix3 J_;
};

/// Masses of the delta as appendix B has them: forearms as point masses at both ends.
struct DeltaMasses {
  double upper_arm = 0.0;              ///< m2 [kg]
  Vector3 forearms = Vector3::Zero();  ///< m3 of each leg [kg]
  double platform = 0.0;               ///< m4 [kg]
  double payload = 0.0;                ///< mp [kg]
  double centre_along = 0.0;           ///< c_x, of the upper arm's centroid along the link [m]
  double centre_normal = 0.0;          ///< c_n, normal to the link, positive towards decreasing theta [m]
  Vector3 upper_arm_inertia = Vector3::Zero();  ///< I2 about the driven axis, of each leg [kg m^2]
  Vector3 motor_inertia = Vector3::Zero();      ///< Im on the motor side [kg m^2]
  double gear_ratio = 1.0;                      ///< k_g [-]
  double mass_split = 2.0 / 3.0;                ///< r, share of a forearm's mass at the elbow [-]
  double gravity = kStandardGravity;            ///< g along -z [m/s^2]
};

/// Equations of motion M thetaddot + C thetadot - tau_g = tau_u + J^T f_e (Neal 2015, B.1-B.29).
class DeltaPointMassDynamics {
 public:
  DeltaPointMassDynamics(const DeltaGeometry& geometry, const DeltaMasses& masses);

  Matrix3 mass_matrix(const DeltaState& state) const;                                 ///< M [kg m^2]
  Matrix3 coriolis_matrix(const DeltaState& state, const Vector3& theta_rate) const;  ///< C [N m s/rad]
  Vector3 gravity_torque(const DeltaState& state) const;   ///< tau_g = -dV/dtheta [N m]
  double potential_energy(const DeltaState& state) const;  ///< V [J]
  /// Driven torques [N m] for an acceleration [rad/s^2] while the user pushes the tool with `force` [N].
  Vector3 inverse(const DeltaState& state, const Vector3& theta_rate, const Vector3& theta_acceleration,
                  const Vector3& force = Vector3::Zero()) const;
  /// Driven accelerations [rad/s^2] under torques [N m] and the user's force [N].
  Vector3 forward(const DeltaState& state, const Vector3& theta_rate, const Vector3& torque,
                  const Vector3& force = Vector3::Zero()) const;

 private:
  double m4e_;     // (B.2)
  Vector3 m2e_;    // (B.3)
  Vector3 cbar_;   // (B.7)
  Vector3 gamma_;  // (B.6)
  Vector3 I2e_;    // (B.8)
  double g_;
};

/// Bodies as the delta's legs form has them (driven revolute, two passive revolutes at the elbow, spherical
/// attachment): those on upper_arm and forearm come back as one body per leg.
std::vector<BodyDescription> delta_leg_bodies(const DeltaDescription& delta,
                                              const std::vector<BodyDescription>& bodies);

/// Driven, elbow and swing angle of one leg of the legs form [rad], for a closed posture.
Vector3 delta_leg_joints(const DeltaGeometry& geometry, int leg, double theta,
                         const Vector3& position) noexcept;

/// What appendix B makes of a delta's bodies: all of them on the platform count as m4, motor and sector inertia
/// are left zero. REQUIRES: a delta description with gravity along z.
DeltaMasses delta_masses(const Description& description);

}  // namespace zwidth
