#pragma once

#include <array>
#include <optional>

#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/mechanism.h"

/// The delta's motion in its three driven angles, in closed form: what a simulation of the device or a control
/// cycle asks a thousand times a second. The loops are closed by construction, at every instant.

namespace zwidth {

/// Driven angles [rad] and their rates [rad/s].
struct DeltaMotion {
  Vector3 theta = Vector3::Zero();
  Vector3 rate = Vector3::Zero();
};

struct DeltaAcceleration {
  SolveStatus status = SolveStatus::unreachable;  ///< of the posture, as `delta_forward`; degenerate if the
                                                  ///< forearms are coplanar, so that nothing holds the tool
  Vector3 theta = Vector3::Zero();                ///< [rad/s^2]; zero unless reached or degraded
};

/// Exact rigid-body dynamics with forearms that are rods: bodies symmetric about the line from elbow to
/// platform joint, with any centre on it. (Between elbow and platform joint a rod's kinetic energy is a
/// quadratic form of its two ends' velocities.) `inverse_dynamics` and `forward_dynamics` of a posture give the
/// same, of any bodies; `DeltaPointMassDynamics` what the source makes of it.
class DeltaDynamics {
 public:
  /// Nothing unless `mechanism` is a delta whose forearms are such rods. What is made of it does not follow
  /// later changes of the mechanism.
  static std::optional<DeltaDynamics> of(const Mechanism& mechanism);

  /// Driven accelerations under `torque` [N m] and the force `push` [N] of the user on the tool.
  DeltaAcceleration forward(const DeltaMotion& motion, const Vector3& torque,
                            const Vector3& push = Vector3::Zero()) const noexcept;

  /// Driven torques [N m] for an acceleration [rad/s^2]; zero where `forward` has no answer.
  Vector3 inverse(const DeltaMotion& motion, const Vector3& acceleration,
                  const Vector3& push = Vector3::Zero()) const noexcept;

  /// Moves on by `dt` [s] with torque and push constant: symplectic Euler, first order, rates before angles.
  /// The motion is left as it is unless the status, that of the posture it starts from, is reached or degraded.
  SolveStatus step(DeltaMotion& motion, const Vector3& torque, const Vector3& push, double dt) const noexcept;

 private:
  /// M thetaddot + bias = torque.
  struct Equations {
    SolveStatus status = SolveStatus::unreachable;
    Matrix3 mass;
    Vector3 bias;
  };
  struct Arm {  ///< upper arm, about its driven axis
    double inertia = 0.0;
    double outward = 0.0, up = 0.0;  ///< mass times centre at theta = 0
  };
  struct Rod {
    double elbow = 0.0, both = 0.0, platform = 0.0;    ///< E/2 |cdot|^2 + B cdot.pdot + P/2 |pdot|^2
    double weight_elbow = 0.0, weight_platform = 0.0;  ///< shares of its mass by its centre [kg]
    double spin = 0.0;                                 ///< inertia about its line
  };
  void write(const DeltaMotion& motion, const Vector3& push, Equations& equations) const noexcept;

  DeltaGeometry geometry_;
  std::array<Arm, 3> arms_;
  std::array<Rod, 3> rods_;
  double platform_ = 0.0, forearms_at_platform_ = 0.0, weight_ = 0.0;
  bool spins_ = false;
  Vector3 gravity_ = Vector3::Zero();
};

}  // namespace zwidth
