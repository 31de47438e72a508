#include "zwidth/mechanism/r_cube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/math/trigonometry.h"

namespace zwidth {
namespace {

constexpr double kReachTolerance = 1e-12;  // relative overshoot of a length that still counts as the boundary
constexpr double kLimitTolerance = 1e-9;   // [rad]
constexpr double kDegraded = 1e-4;         // |cos q_i1| or |sin q_i3| below this make a posture degraded
constexpr double kSingular = 1e-6;         // and below this its rates mean nothing
constexpr double kDegenerate = 1e-12;      // distance of the outer links' ends, relative, that counts as none

bool within(const Interval& limits, double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  return limits.contains(angle, kLimitTolerance) || limits.contains(angle + turn, kLimitTolerance) ||
         limits.contains(angle - turn, kLimitTolerance);
}

// What the two outer links of a leg make of the tool's place (y, z), along e_b and e_c from the universal joint
// (eq 5.39-5.45).
struct Arm {
  bool reaches = false;
  bool free = false;  // both ends in one place: q2 is left open
  double q2 = 0.0, q3 = 0.0;
  double sine = 0.0;  // |sin q3|
};

Arm solve_arm(const RCubeGeometry& geometry, double y, double z, int sigma) {
  const double l2 = geometry.inner_link, l3 = geometry.outer_link;
  const double rho = std::sqrt(y * y + z * z), longest = l2 + l3, shortest = std::abs(l2 - l3);
  // (l2 + l3)^2 - rho^2 and rho^2 - (l2 - l3)^2 as products of sums: no loss near the limits.
  const double outer = (longest - rho) * (longest + rho), inner = (rho - shortest) * (rho + shortest);
  const double slack = -kReachTolerance * longest * longest;
  Arm arm;
  if (!(outer >= slack && inner >= slack)) return arm;
  arm.reaches = true;
  arm.free = rho <= kDegenerate * longest;
  const double A = std::max(outer, 0.0), B = std::max(inner, 0.0), root = std::sqrt(A * B);
  // With A + B = 4 l2 l3, but for what was cut off: cos q3 = (B - A)/(A + B), |sin q3| = 2 sqrt(A B)/(A + B).
  const double scale = 1.0 / (A + B), cosine = (B - A) * scale;
  arm.sine = 2.0 * root * scale;
  const double sine = sigma < 0 ? -arm.sine : arm.sine;
  const double X = z, Y = -y, along = l2 + l3 * cosine, across = l3 * sine;
  arm.q3 = angle_of(cosine, sine);
  arm.q2 = angle_of(along * X + across * Y, along * Y - across * X);
  return arm;
}

// Passive angles of all legs from position and levers, and what the posture is worth.
void solve_arms(const RCubeGeometry& geometry, const RCubeBranches& branches, RCubeSolution& solution) {
  std::array<Arm, 3> arms;
  for (int i = 0; i < 3; ++i) {
    const double y = solution.position[r_cube_axis(i, 1)];
    const double z = solution.position[r_cube_axis(i, 2)] - solution.lever[i];
    arms[i] = solve_arm(geometry, y, z, branches[i].elbow);
  }
  bool degraded = false;
  int free = -1;
  for (int i = 0; i < 3; ++i) {
    if (!arms[i].reaches) {
      solution.status = SolveStatus::unreachable;
      solution.joint = 5 * i + 3;
      return;
    }
    solution.swing[i] = arms[i].q2;
    solution.elbow[i] = arms[i].q3;
    if (arms[i].free && free < 0) free = i;
    degraded |= arms[i].sine < kDegraded || std::abs(solution.lever[i]) < kDegraded * geometry.drive_link;
  }
  if (free >= 0) {
    solution.status = SolveStatus::degenerate;
    solution.joint = 5 * free + 2;
    return;
  }
  solution.status = degraded ? SolveStatus::degraded : SolveStatus::reached;
}

}  // namespace

bool RCubeGeometry::valid() const {
  const auto length = [](double l) { return std::isfinite(l) && l > 0.0; };
  return length(drive_link) && length(inner_link) && length(outer_link) && std::isfinite(base_offset);
}

RCubeBranches r_cube_branches(int number, int elbow) noexcept {
  RCubeBranches branches;
  for (int i = 0; i < 3; ++i) {
    branches[i].turned_over = (number >> (2 * i) & 1) != 0;
    branches[i].elbow = (number >> (2 * i + 1) & 1) != 0 ? -elbow : elbow;
  }
  return branches;
}

RCubeSolution r_cube_forward(const RCubeGeometry& geometry, const Vector3& theta,
                             const RCubeBranches& branches) noexcept {
  RCubeSolution solution;
  solution.theta = theta;
  for (int i = 0; i < 3; ++i) {
    const auto [sine, cosine] = sine_cosine(theta[i]);
    solution.position[i] = geometry.base_offset + geometry.drive_link * sine;  // (5.28)
    solution.lever[i] = geometry.drive_link * cosine;
  }
  solve_arms(geometry, branches, solution);
  return solution;
}

RCubeSolution r_cube_inverse(const RCubeGeometry& geometry, const Vector3& position, const Interval& limits,
                             const RCubeBranches& branches) noexcept {
  RCubeSolution solution;
  solution.position = position;
  for (int i = 0; i < 3; ++i) {
    const double height = position[i] - geometry.base_offset, l1 = geometry.drive_link;
    if (!(std::abs(height) <= (1.0 + kReachTolerance) * l1)) {
      solution.joint = 5 * i;
      return solution;
    }
    const double across = std::sqrt(std::max((l1 - height) * (l1 + height), 0.0));
    solution.lever[i] = branches[i].turned_over ? -across : across;
    solution.theta[i] = angle_of(solution.lever[i], height);  // (5.30)
  }
  solve_arms(geometry, branches, solution);
  if (!solution.closed()) return solution;
  for (int i = 0; i < 3; ++i) {
    if (!within(limits, solution.theta[i])) {
      solution.status = SolveStatus::joint_limit;
      solution.joint = 5 * i;
      break;
    }
  }
  return solution;
}

const char* to_string(RCubeSingularity::Kind kind) noexcept {
  switch (kind) {
    case RCubeSingularity::Kind::drive_across:
      return "drive across";
    case RCubeSingularity::Kind::arm_stretched:
      return "arm stretched";
    case RCubeSingularity::Kind::arm_folded:
      return "arm folded";
  }
  return "";
}

RCubeState::RCubeState(const RCubeGeometry& geometry, const RCubeSolution& solution) noexcept
    : geometry_(geometry), r_(solution.position), q3_(solution.elbow) {
  for (int i = 0; i < 3; ++i) {
    const SineCosine drive = sine_cosine(solution.theta[i]), swing = sine_cosine(solution.swing[i]),
                     both = sine_cosine(solution.swing[i] + solution.elbow[i]);
    s1_[i] = drive.sine;
    c1_[i] = drive.cosine;
    s2_[i] = swing.sine;
    c2_[i] = swing.cosine;
    s23_[i] = both.sine;
    c23_[i] = both.cosine;
    s3_[i] = sine_cosine(solution.elbow[i]).sine;
  }
}

Matrix3 RCubeState::jacobian() const {
  return (geometry_.drive_link * c1_).asDiagonal();
}

Matrix3 RCubeState::jacobian_rate(const Vector3& theta_rate) const {
  return (-geometry_.drive_link * s1_.cwiseProduct(theta_rate)).asDiagonal();
}

Vector3 RCubeState::velocity(const Vector3& theta_rate) const {
  return geometry_.drive_link * c1_.cwiseProduct(theta_rate);
}

Vector3 RCubeState::acceleration(const Vector3& theta_rate, const Vector3& theta_acceleration) const {
  return geometry_.drive_link *
         (c1_.cwiseProduct(theta_acceleration) - s1_.cwiseProduct(theta_rate.cwiseProduct(theta_rate)));
}

Matrix3 RCubeState::leg_jacobian(int leg) const {
  const int i = leg, a = r_cube_axis(leg, 0), b = r_cube_axis(leg, 1), c = r_cube_axis(leg, 2);
  const double l1 = geometry_.drive_link, l2 = geometry_.inner_link, l3 = geometry_.outer_link;
  Matrix3 J = Matrix3::Zero();
  J(a, 0) = l1 * c1_[i];
  J(c, 0) = -l1 * s1_[i];
  J(b, 1) = -l2 * c2_[i] - l3 * c23_[i];
  J(b, 2) = -l3 * c23_[i];
  J(c, 1) = -l2 * s2_[i] - l3 * s23_[i];
  J(c, 2) = -l3 * s23_[i];
  return J;
}

Matrix3 RCubeState::leg_jacobian_rate(int leg, const Vector3& leg_rate) const {
  const int i = leg, a = r_cube_axis(leg, 0), b = r_cube_axis(leg, 1), c = r_cube_axis(leg, 2);
  const double l1 = geometry_.drive_link, l2 = geometry_.inner_link, l3 = geometry_.outer_link;
  const double w1 = leg_rate[0], w2 = leg_rate[1], w23 = leg_rate[1] + leg_rate[2];
  Matrix3 J = Matrix3::Zero();
  J(a, 0) = -l1 * s1_[i] * w1;
  J(c, 0) = -l1 * c1_[i] * w1;
  J(b, 1) = l2 * s2_[i] * w2 + l3 * s23_[i] * w23;
  J(b, 2) = l3 * s23_[i] * w23;
  J(c, 1) = -l2 * c2_[i] * w2 - l3 * c23_[i] * w23;
  J(c, 2) = -l3 * c23_[i] * w23;
  return J;
}

double RCubeState::leg_determinant(int leg) const {
  return geometry_.drive_link * geometry_.inner_link * geometry_.outer_link * c1_[leg] * s3_[leg];
}

bool RCubeState::singular() const {
  return !(c1_.cwiseAbs().minCoeff() >= kSingular && s3_.cwiseAbs().minCoeff() >= kSingular);
}

Vector3 RCubeState::solve_leg(int leg, const Vector3& v) const {
  const int i = leg;
  const double l1 = geometry_.drive_link, l2 = geometry_.inner_link, l3 = geometry_.outer_link;
  const double w1 = v[r_cube_axis(leg, 0)] / (l1 * c1_[i]);
  const double vb = v[r_cube_axis(leg, 1)], vc = v[r_cube_axis(leg, 2)] + l1 * s1_[i] * w1;
  const double inverse = 1.0 / (l2 * l3 * s3_[i]);
  const double w2 = l3 * (c23_[i] * vc - s23_[i] * vb) * inverse;
  const double w23 = l2 * (s2_[i] * vb - c2_[i] * vc) * inverse;  // q_i2 and q_i3 together
  return {w1, w2, w23 - w2};
}

std::optional<Vector3> RCubeState::leg_rates(int leg, const Vector3& theta_rate) const {
  if (singular()) return std::nullopt;
  return solve_leg(leg, velocity(theta_rate));
}

std::optional<Vector3> RCubeState::leg_accelerations(int leg, const Vector3& theta_rate,
                                                     const Vector3& theta_acceleration) const {
  const std::optional<Vector3> rate = leg_rates(leg, theta_rate);
  if (!rate) return std::nullopt;
  return solve_leg(leg, acceleration(theta_rate, theta_acceleration) - leg_jacobian_rate(leg, *rate) * *rate);
}

std::array<RCubeSingularity, 6> RCubeState::singularities() const {
  using Kind = RCubeSingularity::Kind;
  const double l1 = geometry_.drive_link, l2 = geometry_.inner_link, l3 = geometry_.outer_link;
  std::array<RCubeSingularity, 6> all;
  for (int i = 0; i < 3; ++i) {
    const int a = r_cube_axis(i, 0), b = r_cube_axis(i, 1), c = r_cube_axis(i, 2);
    // 1 - |sin q| = cos^2 q/(1 + |sin q|)
    all[2 * i] = {.kind = Kind::drive_across,
                  .leg = i,
                  .measure = std::abs(c1_[i]),
                  .distance = l1 * c1_[i] * c1_[i] / (1.0 + std::abs(s1_[i])),
                  .direction = std::copysign(1.0, s1_[i]) * Vector3::Unit(a)};
    const Vector3 out = r_[b] * Vector3::Unit(b) + (r_[c] - l1 * c1_[i]) * Vector3::Unit(c);
    const double rho = out.norm();
    const bool stretched = std::abs(q3_[i]) <= 0.5 * std::numbers::pi;
    const Vector3 outwards = rho > 0.0 ? Vector3(out / rho) : Vector3(Vector3::Unit(c));
    all[2 * i + 1] = {.kind = stretched ? Kind::arm_stretched : Kind::arm_folded,
                      .leg = i,
                      .measure = std::abs(s3_[i]),
                      .distance = std::max(stretched ? l2 + l3 - rho : rho - std::abs(l2 - l3), 0.0),
                      .direction = stretched ? outwards : Vector3(-outwards)};
  }
  return all;
}

RCubeSingularity RCubeState::nearest_singularity() const {
  const std::array<RCubeSingularity, 6> all = singularities();
  return *std::min_element(all.begin(), all.end(),
                           [](const auto& one, const auto& other) { return one.measure < other.measure; });
}

}  // namespace zwidth
