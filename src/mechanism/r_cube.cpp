#include "zwidth/mechanism/r_cube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/math/trigonometry.h"
#include "zwidth/math/vector_trigonometry.h"

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

// Passive angles of all legs from position and levers, and what the posture is worth (eq 5.39-5.45).
void solve_arms(const RCubeGeometry& geometry, const RCubeBranches& branches, RCubeSolution& solution) {
  const double l2 = geometry.inner_link, l3 = geometry.outer_link, longest = l2 + l3,
               shortest = std::abs(l2 - l3);
  // The tool seen from the universal joint, and A = (l2 + l3)^2 - rho^2, B = rho^2 - (l2 - l3)^2 with its
  // distance rho: as sure as the squares, whose rounding is no larger than that of rho itself.
  std::array<double, 3> X, Y, A, B;
  for (int i = 0; i < 3; ++i) {
    X[i] = solution.position[r_cube_axis(i, 2)] - solution.lever[i];
    Y[i] = -solution.position[r_cube_axis(i, 1)];
    const double rho2 = X[i] * X[i] + Y[i] * Y[i];
    A[i] = longest * longest - rho2;
    B[i] = rho2 - shortest * shortest;
  }
  const double slack = -kReachTolerance * longest * longest;
  for (int i = 0; i < 3; ++i) {
    if (!(A[i] >= slack && B[i] >= slack)) {
      solution.status = SolveStatus::unreachable;
      solution.joint = 5 * i + 3;
      return;
    }
  }

  // Directions of q3 in the first three places, of q2 in the last three, so that one call makes all. With
  // A + B = 4 l2 l3: cos q3 = (B - A)/(A + B), |sin q3| = 2 sqrt(A B)/(A + B).
  const double scale = 0.25 / (l2 * l3);
  std::array<double, 8> cosine{}, sine{}, angle;
  for (int i = 0; i < 3; ++i) {
    const double product = A[i] * B[i], root = product > 0.0 ? std::sqrt(product) : 0.0;
    const double c3 = (B[i] - A[i]) * scale, s3 = branches[i].elbow * (2.0 * root * scale);
    const double along = l2 + l3 * c3, across = l3 * s3;
    cosine[i] = c3;
    sine[i] = s3;
    cosine[3 + i] = along * X[i] + across * Y[i];
    sine[3 + i] = along * Y[i] - across * X[i];
  }
  angles_of(cosine, sine, angle);

  solution.status = SolveStatus::reached;
  for (int i = 0; i < 3; ++i) {
    solution.elbow[i] = angle[i];
    solution.swing[i] = angle[3 + i];
    if (std::abs(sine[i]) < kDegraded || std::abs(solution.lever[i]) < kDegraded * geometry.drive_link) {
      solution.status = SolveStatus::degraded;
    }
  }
  const double together = kDegenerate * longest;
  for (int i = 2; i >= 0 && shortest <= together; --i) {
    if (X[i] * X[i] + Y[i] * Y[i] <= together * together) {
      solution.status = SolveStatus::degenerate;
      solution.joint = 5 * i + 2;
    }
  }
}

}  // namespace

bool RCubeGeometry::valid() const {
  const auto length = [](double l) { return std::isfinite(l) && l > 0.0; };
  return length(drive_link) && length(inner_link) && length(outer_link) && std::isfinite(base_offset);
}

RCubeGeometry r_cube_geometry(const RCubeDescription& description) {
  return {.drive_link = description.drive_link,
          .inner_link = description.inner_link,
          .outer_link = description.outer_link,
          .base_offset = description.base_offset};
}

Eigen::Matrix<double, 5, 1> r_cube_leg_joints(const RCubeSolution& solution, int leg) noexcept {
  Eigen::Matrix<double, 5, 1> joints;
  const double q2 = solution.swing[leg], q3 = solution.elbow[leg];
  // The wrist within half a turn, as the others.
  joints << solution.theta[leg], -solution.theta[leg], q2, q3,
      std::remainder(-(q2 + q3), 2.0 * std::numbers::pi);
  return joints;
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
