#include "zwidth/mechanism/dynamics.h"

#include <Eigen/Cholesky>
#include <array>
#include <cassert>

#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

// Motion of one link's frame: of the point of the joint that moves it, and of the link itself.
struct LinkMotion {
  Vector3 velocity, acceleration;  // of the joint's point
  Vector3 omega, alpha;            // of the link
};
using Motions = std::array<LinkMotion, kMaxJoints>;

// Motion of every link for all joint rates and accelerations; the base accelerates by `base` (-gravity makes
// weights appear as inertia forces).
void move_links(const Posture& posture, const JointVector& rate, const JointVector& acceleration,
                const Vector3& base, Motions& motions) {
  const Mechanism& mechanism = posture.mechanism();
  for (const LegModel& leg : mechanism.legs()) {
    Vector3 omega = Vector3::Zero(), alpha = Vector3::Zero();  // of what carries the next joint's axis
    Vector3 v = Vector3::Zero(), a = base;                     // of the next joint's point
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const JointModel& joint = mechanism.joints()[j];
      const Vector3 spin = posture.joint_axis(j) * rate[j];
      const Vector3 spin_rate = omega.cross(spin) + posture.joint_axis(j) * acceleration[j];
      LinkMotion& link = motions[j];
      if (joint.type == JointType::prismatic) {
        const Vector3 extension = posture.joint_axis(j) * posture.joints()[j];
        a += alpha.cross(extension) + omega.cross(omega.cross(extension)) + omega.cross(spin) + spin_rate;
        v += omega.cross(extension) + spin;
        link = {v, a, omega, alpha};
      } else {
        link = {v, a, omega + spin, alpha + spin_rate};
      }
      if (j + 1 < leg.first + leg.count) {
        const Vector3 arm = posture.link_rotation(j) * mechanism.joints()[j + 1].offset;
        v += link.omega.cross(arm);
        a += link.alpha.cross(arm) + link.omega.cross(link.omega.cross(arm));
      }
      if (joint.type == JointType::revolute) {
        omega = link.omega;
        alpha = link.alpha;
      }
    }
  }
}

Matrix3 world_inertia(const BodyModel& body, const Matrix3& R) {
  return R * body.inertia * R.transpose();
}

const Matrix3& body_rotation(const Posture& posture, const BodyModel& body) {
  return body.joint < 0 ? posture.tool().rotation : posture.link_rotation(body.turns_with);
}

// From the joint's point to the pin that a body hangs on; zero for one fixed to its link.
Vector3 pin_arm(const Posture& posture, const BodyModel& body) {
  return body.joint < 0 ? Vector3::Zero() : Vector3(posture.link_rotation(body.joint) * body.pivot);
}

Vector3 body_centre(const Posture& posture, const BodyModel& body) {
  const Vector3& point = body.joint < 0 ? posture.tool().position : posture.joint_point(body.joint);
  return point + pin_arm(posture, body) + body_rotation(posture, body) * body.centre;
}

// Force on the centre and moment about it that move a body, as the bodies' Newton-Euler equations say.
struct BodyLoad {
  Vector3 force, moment;
};
BodyLoad body_load(const BodyModel& body, const Matrix3& R, const Vector3& point_acceleration,
                   const Vector3& omega, const Vector3& alpha) {
  const Vector3 c = R * body.centre;
  const Matrix3 inertia = world_inertia(body, R);
  const Vector3 acceleration = point_acceleration + alpha.cross(c) + omega.cross(omega.cross(c));
  return {body.mass * acceleration, inertia * alpha + omega.cross(inertia * omega)};
}

// Forces of all joints, as if each leg were free at its tip, that produce the links' motion; and the wrench at
// the platform's origin that moves the platform, unless that is an arm's last link.
struct FreeForces {
  JointVector joints;
  Wrench platform;
};
FreeForces free_forces(const Posture& posture, const Motions& motions, const LinkMotion& platform) {
  const Mechanism& mechanism = posture.mechanism();
  FreeForces result;
  result.joints.setZero(mechanism.joint_count());

  // Each link's own load, as force and moment about its joint's point.
  const bool serial = mechanism.serial() != nullptr;
  const int last = mechanism.joint_count() - 1;
  std::array<Vector3, kMaxJoints> force, moment;
  for (int j = 0; j < mechanism.joint_count(); ++j) force[j] = moment[j] = Vector3::Zero();
  for (const BodyModel& body : mechanism.bodies()) {
    const Matrix3& R = body_rotation(posture, body);
    const LinkMotion& link = body.joint < 0 ? platform : motions[body.joint];
    const LinkMotion& turn = body.joint < 0 ? platform : motions[body.turns_with];
    const Vector3 pin = pin_arm(posture, body);
    const Vector3 acceleration =
        link.acceleration + link.alpha.cross(pin) + link.omega.cross(link.omega.cross(pin));
    const BodyLoad load = body_load(body, R, acceleration, turn.omega, turn.alpha);
    const Vector3 about_pin = load.moment + (R * body.centre).cross(load.force);
    if (body.joint < 0 && serial) {  // the platform is the last link
      force[last] += load.force;
      moment[last] += about_pin + (posture.tool().position - posture.joint_point(last)).cross(load.force);
    } else if (body.joint < 0) {
      result.platform.force += load.force;
      result.platform.moment += about_pin;
    } else {
      // The pin carries the force; the bars hand the moment to the link that turns the body.
      force[body.joint] += load.force;
      moment[body.joint] += pin.cross(load.force);
      moment[body.turns_with] += about_pin;
    }
  }
  // From the tip inwards: what a joint carries, and the share of it along the joint.
  for (const LegModel& leg : mechanism.legs()) {
    Vector3 carried_force = Vector3::Zero(), carried_moment = Vector3::Zero();  // about the outer joint's point
    for (int j = leg.first + leg.count - 1; j >= leg.first; --j) {
      const JointModel& joint = mechanism.joints()[j];
      const bool outermost = j + 1 == leg.first + leg.count;
      // The outer joint's fixed point, to which its displacement (a prismatic one) has been brought back below.
      const Vector3 arm =
          outermost ? Vector3::Zero() : Vector3(posture.link_rotation(j) * mechanism.joints()[j + 1].offset);
      const Vector3 own = moment[j] + arm.cross(carried_force);  // turns bars about the joint's point
      const Vector3 total_force = force[j] + carried_force;
      const Vector3 total_moment = own + carried_moment;
      const Vector3& axis = posture.joint_axis(j);
      carried_force = total_force;
      carried_moment = total_moment;
      switch (joint.type) {
        case JointType::revolute:
          result.joints[j] = axis.dot(total_moment);
          break;
        case JointType::parallelogram:
          result.joints[j] = axis.dot(own);
          break;
        case JointType::prismatic:
          result.joints[j] = axis.dot(total_force);
          carried_moment += (axis * posture.joints()[j]).cross(total_force);
          break;
      }
    }
  }
  return result;
}

// The closed loops' share: tau = Gamma^T f + J^T w.
ActiveVector closed(const Mechanism& mechanism, const Rates& rates, const FreeForces& forces) {
  ActiveVector tau = rates.joints.transpose() * forces.joints;
  const std::span<const int> axes = mechanism.tool_axes();
  for (std::size_t r = 0; r < axes.size(); ++r) {
    const double w = axes[r] < 3 ? forces.platform.force[axes[r]] : forces.platform.moment[axes[r] - 3];
    tau += rates.tool.row(static_cast<Eigen::Index>(r)).transpose() * w;
  }
  return tau;
}

LinkMotion platform_motion(const Mechanism& mechanism, const ToolVector& velocity,
                           const ToolVector& acceleration, const Vector3& base) {
  const Vector6 v = mechanism.six_components(velocity), a = mechanism.six_components(acceleration);
  return {v.head<3>(), a.head<3>() + base, v.tail<3>(), a.tail<3>()};
}

// Everything but drive inertia and the user's push, of an arm: recursive Newton–Euler, with nothing to close.
ActiveVector arm_torque(const Posture& posture, const ActiveVector& rate, const ActiveVector& acceleration) {
  Motions motions;
  move_links(posture, rate, acceleration, -posture.mechanism().gravity(), motions);
  const int last = posture.mechanism().joint_count() - 1;
  LinkMotion platform = motions[last];
  const Vector3 arm = posture.tool().position - posture.joint_point(last);
  platform.acceleration += platform.alpha.cross(arm) + platform.omega.cross(platform.omega.cross(arm));
  return free_forces(posture, motions, platform).joints;
}

// Everything but drive inertia and the user's push.
ActiveVector bodies_torque(const Posture& posture, const Rates& rates, const ActiveVector& rate,
                           const ActiveVector& acceleration) {
  if (posture.mechanism().serial() != nullptr) return arm_torque(posture, rate, acceleration);
  const Vector3 base = -posture.mechanism().gravity();
  const BiasAcceleration bias = bias_acceleration(posture, rates, rate);
  Motions motions;
  move_links(posture, rates.joints * rate, rates.joints * acceleration + bias.joints, base, motions);
  const Mechanism& mechanism = posture.mechanism();
  const LinkMotion platform =
      platform_motion(mechanism, rates.tool * rate, rates.tool * acceleration + bias.tool, base);
  return closed(mechanism, rates, free_forces(posture, motions, platform));
}

// Velocity of a body's centre and its angular velocity per active rate.
struct BodyJacobian {
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxActive> linear, angular;
};

}  // namespace

ActiveMatrix mass_matrix(const Posture& posture) noexcept {
  return mass_matrix(posture, rates(posture));
}

ActiveMatrix mass_matrix(const Posture& posture, const Rates& rates) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const int n = mechanism.active_count();
  ActiveMatrix M = mechanism.drive_inertia().asDiagonal();

  std::array<Motions, kMaxActive> motions;
  const JointVector still = JointVector::Zero(mechanism.joint_count());
  for (int a = 0; a < n; ++a) move_links(posture, rates.joints.col(a), still, Vector3::Zero(), motions[a]);

  BodyJacobian J;
  J.linear.resize(3, n);
  J.angular.resize(3, n);
  for (const BodyModel& body : mechanism.bodies()) {
    const Matrix3& R = body_rotation(posture, body);
    const Vector3 c = R * body.centre, pin = pin_arm(posture, body);
    for (int a = 0; a < n; ++a) {
      if (body.joint < 0) {
        const Vector6 twist = mechanism.six_components(rates.tool.col(a));
        J.linear.col(a) = twist.head<3>();
        J.angular.col(a) = twist.tail<3>();
      } else {
        const LinkMotion& link = motions[a][body.joint];
        J.angular.col(a) = motions[a][body.turns_with].omega;
        J.linear.col(a) = link.velocity + link.omega.cross(pin);
      }
      const Vector3 omega = J.angular.col(a);
      J.linear.col(a) += omega.cross(c);
    }
    M.noalias() += body.mass * J.linear.transpose() * J.linear;
    M.noalias() += J.angular.transpose() * world_inertia(body, R) * J.angular;
  }
  return M;
}

ActiveVector gravity_torques(const Posture& posture) noexcept {
  return gravity_torques(posture, rates(posture));
}

ActiveVector gravity_torques(const Posture& posture, const Rates& rates) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const Vector3 base = -mechanism.gravity();
  const JointVector still = JointVector::Zero(mechanism.joint_count());
  const ToolVector rest = ToolVector::Zero(mechanism.tool_rows());
  Motions motions;
  move_links(posture, still, still, base, motions);
  return closed(mechanism, rates, free_forces(posture, motions, platform_motion(mechanism, rest, rest, base)));
}

ActiveVector inverse_dynamics(const Posture& posture, const ActiveVector& rate,
                              const ActiveVector& acceleration, const ToolVector& push) noexcept {
  const Rates all = rates(posture);
  ActiveVector tau = bodies_torque(posture, all, rate, acceleration);
  tau += posture.mechanism().drive_inertia().cwiseProduct(acceleration);
  if (push.size() > 0) tau -= all.tool.transpose() * push;
  return tau;
}

ActiveVector forward_dynamics(const Posture& posture, const ActiveVector& rate, const ActiveVector& torque,
                              const ToolVector& push) noexcept {
  const Rates all = rates(posture);
  ActiveVector driving =
      torque - bodies_torque(posture, all, rate, ActiveVector::Zero(posture.mechanism().active_count()));
  if (push.size() > 0) driving += all.tool.transpose() * push;
  return mass_matrix(posture, all).ldlt().solve(driving);
}

ToolMatrix cartesian_mass(const Jacobian& jacobian, const ActiveMatrix& mass) noexcept {
  // Lambda^-1 = J M^-1 J^T, the mobility of the tool, inverted along the directions in which the tool can move
  // at all.
  const Jacobian moved = mass.ldlt().solve(jacobian.transpose()).transpose();
  return pseudo_inverse(moved.lazyProduct(jacobian.transpose()));
}

double kinetic_energy(const Posture& posture, const ActiveVector& rate) noexcept {
  return 0.5 * rate.dot(mass_matrix(posture) * rate);
}

double potential_energy(const Posture& posture) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  double V = 0.0;
  for (const BodyModel& body : mechanism.bodies()) {
    V -= body.mass * mechanism.gravity().dot(body_centre(posture, body));
  }
  return V;
}

double moving_mass(const Mechanism& mechanism) noexcept {
  double mass = 0.0;
  for (const BodyModel& body : mechanism.bodies()) mass += body.mass;
  return mass;
}

Vector3 mass_centre(const Posture& posture) noexcept {
  Vector3 moment = Vector3::Zero();
  for (const BodyModel& body : posture.mechanism().bodies()) moment += body.mass * body_centre(posture, body);
  const double mass = moving_mass(posture.mechanism());
  return mass > 0.0 ? Vector3(moment / mass) : Vector3(Vector3::Zero());
}

}  // namespace zwidth
