#include "zwidth/mechanism/delta_dynamics.h"

#include <cmath>

#include "zwidth/math/lanes.h"
#include "zwidth/math/trigonometry.h"

namespace zwidth {
namespace {

constexpr double kSame = 1e-9;  // relative: of a body that counts as symmetric about a line

struct Azimuth {
  double cosine, sine;
};
constexpr double kHalfSqrt3 = 0.86602540378443864676;
constexpr std::array<Azimuth, 3> kAzimuth = {{{0.0, 1.0}, {-kHalfSqrt3, -0.5}, {kHalfSqrt3, -0.5}}};

bool usable(SolveStatus status) {
  return status == SolveStatus::reached || status == SolveStatus::degraded;
}

}  // namespace

std::optional<DeltaDynamics> DeltaDynamics::of(const Mechanism& mechanism) {
  if (!mechanism.delta()) return std::nullopt;
  DeltaDynamics result;
  result.geometry_ = *mechanism.delta();
  result.gravity_ = mechanism.gravity();
  const double d3 = result.geometry_.forearm;
  for (int i = 0; i < 3; ++i) result.arms_[i].inertia = mechanism.drive_inertia()[i];
  for (const BodyModel& body : mechanism.bodies()) {
    if (body.joint < 0) {
      result.platform_ += body.mass;
      continue;
    }
    const int leg = body.joint / 3, link = body.joint % 3;
    const Vector3 outwards(kAzimuth[leg].cosine, kAzimuth[leg].sine, 0.0);
    if (body.turns_with != body.joint) return std::nullopt;
    if (link == 0) {
      Arm& arm = result.arms_[leg];
      const Vector3 axis(outwards.y(), -outwards.x(), 0.0);
      arm.inertia += axis.dot(body.inertia * axis) + body.mass * body.centre.cross(axis).squaredNorm();
      arm.outward += body.mass * outwards.dot(body.centre);
      arm.up += body.mass * body.centre.z();
    } else if (link == 2) {
      // At the zero posture the forearm points up, from the elbow.
      const Matrix3& I = body.inertia;
      const double across = 0.5 * (I(0, 0) + I(1, 1)), size = across + I(2, 2);
      const bool symmetric = std::abs(I(0, 0) - I(1, 1)) <= kSame * size && std::abs(I(0, 1)) <= kSame * size &&
                             std::abs(I(0, 2)) <= kSame * size && std::abs(I(1, 2)) <= kSame * size;
      if (!symmetric || std::hypot(body.centre.x(), body.centre.y()) > kSame * d3) return std::nullopt;
      const double at = body.centre.z() / d3, m = body.mass, swing = across / (d3 * d3);
      Rod& rod = result.rods_[leg];
      rod.elbow += m * (1.0 - at) * (1.0 - at) + swing;
      rod.both += m * at * (1.0 - at) - swing;
      rod.platform += m * at * at + swing;
      rod.weight_elbow += m * (1.0 - at);
      rod.weight_platform += m * at;
      rod.spin += I(2, 2);
    } else {
      return std::nullopt;
    }
  }
  result.forearms_at_platform_ = result.platform_;
  result.weight_ = result.platform_;
  for (const Rod& rod : result.rods_) {
    result.forearms_at_platform_ += rod.platform;
    result.weight_ += rod.weight_platform;
    result.spins_ = result.spins_ || rod.spin > 0.0;
  }
  return result;
}

ZWIDTH_WIDE void DeltaDynamics::write(const DeltaMotion& motion, const Vector3& push,
                                      Equations& result) const noexcept {
  const DeltaForward posture = delta_forward(geometry_, motion.theta);
  result.status = posture.status;
  if (!usable(posture.status)) return;
  const double d2 = geometry_.upper_arm, d3 = geometry_.forearm, d5 = geometry_.offset();
  const Matrix3& J = posture.jacobian;
  const Vector3& p = posture.position;
  const Vector3& w = motion.rate;
  const Vector3 velocity = J * w;

  // Of each leg: u from elbow to platform joint (the elbow shifted inwards by d4), the elbow's first and second
  // derivative e and f with respect to its angle.
  std::array<Vector3, 3> u, e, f, du;
  Vector3 closing;  // what the tool's acceleration must make up for, along u
  std::array<double, 3> weight_torque;
  for (int i = 0; i < 3; ++i) {
    const auto [s, c] = sine_cosine(motion.theta[i]);
    const auto [ca, sa] = kAzimuth[i];
    const double outward = d5 + d2 * c;
    u[i] = {p.x() - outward * ca, p.y() - outward * sa, p.z() - d2 * s};
    e[i] = {-d2 * s * ca, -d2 * s * sa, d2 * c};
    f[i] = {-d2 * c * ca, -d2 * c * sa, -d2 * s};
    du[i] = velocity - e[i] * w[i];
    closing[i] = u[i].dot(f[i]) * (w[i] * w[i]) - du[i].squaredNorm();
    const double gravity_outward = ca * gravity_.x() + sa * gravity_.y(), gravity_up = gravity_.z();
    const Arm& arm = arms_[i];
    weight_torque[i] =
        (arm.outward * s + arm.up * c) * gravity_outward - (arm.outward * c - arm.up * s) * gravity_up;
  }
  const std::array<Vector3, 3> normal = {u[1].cross(u[2]), u[2].cross(u[0]), u[0].cross(u[1])};
  const double determinant = u[0].dot(normal[0]);
  if (determinant == 0.0) {
    result.status = SolveStatus::degenerate;
    return;
  }
  // Acceleration of the tool while the driven angles keep their rates.
  const Vector3 coasting =
      (normal[0] * closing[0] + normal[1] * closing[1] + normal[2] * closing[2]) * (1.0 / determinant);

  Vector3 at_tool = forearms_at_platform_ * coasting - weight_ * gravity_ - push;
  for (int i = 0; i < 3; ++i) at_tool += rods_[i].both * (w[i] * w[i]) * f[i];
  Matrix3& M = result.mass;
  std::array<Vector3, 3> column = {J.col(0), J.col(1), J.col(2)};
  for (int j = 0; j < 3; ++j) {
    const Rod& rod = rods_[j];
    result.bias[j] =
        column[j].dot(at_tool) + e[j].dot(rod.both * coasting - rod.weight_elbow * gravity_) + weight_torque[j];
    for (int k = 0; k <= j; ++k) {
      M(j, k) = forearms_at_platform_ * column[j].dot(column[k]) + rod.both * e[j].dot(column[k]) +
                rods_[k].both * column[j].dot(e[k]);
    }
    M(j, j) += arms_[j].inertia + rod.elbow * d2 * d2;
  }
  for (int i = 0; i < 3 && spins_; ++i) {
    // The elbow's universal joint turns a rod about its own line at k.du, where k, across the plane of the
    // leg, is ut / (d3 rho^2) (uz, 0, -ur) in outward, tangential and vertical parts.
    const auto [ca, sa] = kAzimuth[i];
    const Vector3 out(ca, sa, 0.0), across(-sa, ca, 0.0);
    const double ur = out.dot(u[i]), ut = across.dot(u[i]), uz = u[i].z();
    const double vr = out.dot(du[i]), vt = across.dot(du[i]), vz = du[i].z();
    const double rho2 = ur * ur + uz * uz;
    if (!(rho2 > 0.0)) continue;
    const double share = ut / (d3 * rho2);
    const double share_rate = vt / (d3 * rho2) - 2.0 * share * (ur * vr + uz * vz) / rho2;
    const double turning = uz * vr - ur * vz, spin = share * turning;
    const Vector3 k = share * (uz * out - ur * Vector3::UnitZ());
    const double spin_rate = k.dot(coasting - f[i] * (w[i] * w[i])) + share_rate * turning;
    const Vector3 gyroscopic = du[i].cross(u[i]) * (spin / (d3 * d3 * d3));
    std::array<double, 3> by;
    for (int j = 0; j < 3; ++j) {
      const Vector3 change = j == i ? Vector3(column[j] - e[i]) : column[j];
      by[j] = k.dot(change);
      result.bias[j] += rods_[i].spin * (spin_rate * by[j] + gyroscopic.dot(change));
    }
    for (int j = 0; j < 3; ++j) {
      for (int l = 0; l <= j; ++l) M(j, l) += rods_[i].spin * by[j] * by[l];
    }
  }
  M(0, 1) = M(1, 0), M(0, 2) = M(2, 0), M(1, 2) = M(2, 1);
}

DeltaAcceleration DeltaDynamics::forward(const DeltaMotion& motion, const Vector3& torque,
                                         const Vector3& push) const noexcept {
  Equations equations;
  write(motion, push, equations);
  DeltaAcceleration result;
  result.status = equations.status;
  if (!usable(equations.status)) return result;
  // By cofactors of the symmetric M.
  const Matrix3& M = equations.mass;
  const Vector3 r = torque - equations.bias;
  const Vector3 a = M.col(1).cross(M.col(2)), b = M.col(2).cross(M.col(0)), c = M.col(0).cross(M.col(1));
  const double determinant = M.col(0).dot(a);
  if (!(determinant > 0.0)) {  // a joint that moves no mass
    result.status = SolveStatus::degenerate;
    return result;
  }
  result.theta = Vector3(a.dot(r), b.dot(r), c.dot(r)) * (1.0 / determinant);
  return result;
}

Vector3 DeltaDynamics::inverse(const DeltaMotion& motion, const Vector3& acceleration,
                               const Vector3& push) const noexcept {
  Equations equations;
  write(motion, push, equations);
  if (!usable(equations.status)) return Vector3::Zero();
  return equations.mass * acceleration + equations.bias;
}

SolveStatus DeltaDynamics::step(DeltaMotion& motion, const Vector3& torque, const Vector3& push,
                                double dt) const noexcept {
  const DeltaAcceleration acceleration = forward(motion, torque, push);
  if (!usable(acceleration.status)) return acceleration.status;
  motion.rate += dt * acceleration.theta;
  motion.theta += dt * motion.rate;
  return acceleration.status;
}

}  // namespace zwidth
