#include "zwidth/mechanism/r_cube_dynamics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace zwidth {
namespace {

// A leg's mass matrix and its derivatives by q_i1, q_i2, q_i3.
struct LegMass {
  Matrix3 M;
  std::array<Matrix3, 3> dM;
};

LegMass leg_mass(const RCubeMasses& masses, const Vector3& q, double mu) {
  const double l1 = masses.geometry.drive_link, l2 = masses.geometry.inner_link,
               l3 = masses.geometry.outer_link;
  const double m1 = masses.mass[0], m2 = masses.mass[1], m3 = masses.mass[2];
  const double lg1 = 0.5 * l1, lg2 = 0.5 * l2, lg3 = 0.5 * l3;
  const double A = m2 * lg2 + (m3 + mu) * l2, B = m3 * lg3 + mu * l3;
  const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]),
               s3 = std::sin(q[2]), c3 = std::cos(q[2]), s23 = std::sin(q[1] + q[2]),
               c23 = std::cos(q[1] + q[2]);
  LegMass leg;
  Matrix3& M = leg.M;
  M(2, 2) = m3 * lg3 * lg3 + masses.inertia[2] + mu * l3 * l3;
  M(1, 2) = M(2, 1) = M(2, 2) + B * l2 * c3;
  M(1, 1) = m2 * lg2 * lg2 + masses.inertia[1] + (m3 + mu) * l2 * l2 + M(2, 2) + 2.0 * B * l2 * c3;
  M(0, 0) = m1 * lg1 * lg1 + masses.inertia[0] + (m2 + m3 + mu) * l1 * l1;
  M(0, 1) = M(1, 0) = l1 * s1 * (A * s2 + B * s23);
  M(0, 2) = M(2, 0) = l1 * s1 * B * s23;
  const auto symmetric = [](double d01, double d02, double d11, double d12) {
    Matrix3 d = Matrix3::Zero();
    d(0, 1) = d(1, 0) = d01;
    d(0, 2) = d(2, 0) = d02;
    d(1, 1) = d11;
    d(1, 2) = d(2, 1) = d12;
    return d;
  };
  leg.dM[0] = symmetric(l1 * c1 * (A * s2 + B * s23), l1 * c1 * B * s23, 0.0, 0.0);
  leg.dM[1] = symmetric(l1 * s1 * (A * c2 + B * c23), l1 * s1 * B * c23, 0.0, 0.0);
  leg.dM[2] = symmetric(l1 * s1 * B * c23, l1 * s1 * B * c23, -2.0 * B * l2 * s3, -B * l2 * s3);
  return leg;
}

// Torques in q_i1, q_i2, q_i3 of what gravity exerts on the links.
Vector3 weight(const RCubeMasses& masses, int leg, const Vector3& q) {
  const RCubeGeometry& l = masses.geometry;
  const Vector3 e_a = Vector3::Unit(r_cube_axis(leg, 0)), e_b = Vector3::Unit(r_cube_axis(leg, 1)),
                e_c = Vector3::Unit(r_cube_axis(leg, 2));
  // Velocities of the links' ends per rate.
  const Vector3 drive = l.drive_link * (std::cos(q[0]) * e_a - std::sin(q[0]) * e_c);
  const Vector3 inner = -l.inner_link * (std::cos(q[1]) * e_b + std::sin(q[1]) * e_c);
  const Vector3 outer = -l.outer_link * (std::cos(q[1] + q[2]) * e_b + std::sin(q[1] + q[2]) * e_c);
  const Vector3& m = masses.mass;
  const Vector3& g = masses.gravity;
  return {drive.dot(g) * (0.5 * m[0] + m[1] + m[2]),
          inner.dot(g) * (0.5 * m[1] + m[2]) + outer.dot(g) * 0.5 * m[2], outer.dot(g) * 0.5 * m[2]};
}

Vector3 angles_of(const RCubeSolution& at, int leg) {
  return {at.theta[leg], at.swing[leg], at.elbow[leg]};
}

}  // namespace

RCubeMasses r_cube_masses(const RCubeGeometry& geometry, const std::array<Section, 3>& sections, double density,
                          RCubeInertia inertia) noexcept {
  RCubeMasses masses{.geometry = geometry};
  const double lengths[] = {geometry.drive_link, geometry.inner_link, geometry.outer_link};
  for (int k = 0; k < 3; ++k) {
    const LinkMass link = link_mass(sections[k], lengths[k], density);
    masses.mass[k] = link.mass;
    masses.inertia[k] = link.about_y;
    if (inertia == RCubeInertia::published) masses.inertia[k] += 0.25 * link.mass * lengths[k] * lengths[k];
  }
  return masses;
}

Matrix3 r_cube_leg_mass_matrix(const RCubeMasses& masses, const Vector3& angles, double tip_mass) noexcept {
  return leg_mass(masses, angles, tip_mass).M;
}

Matrix3 r_cube_leg_cartesian_mass(const RCubeMasses& masses, int leg, const Vector3& angles,
                                  double tip_mass) noexcept {
  RCubeSolution own;
  own.theta[leg] = angles[0];
  own.swing[leg] = angles[1];
  own.elbow[leg] = angles[2];
  const Matrix3 back = RCubeState(masses.geometry, own).leg_jacobian(leg).inverse();
  return back.transpose() * leg_mass(masses, angles, tip_mass).M * back;
}

std::optional<Matrix3> r_cube_cartesian_mass(const RCubeMasses& masses, const RCubeSolution& at) noexcept {
  const RCubeState state(masses.geometry, at);
  if (state.singular()) return std::nullopt;
  Matrix3 mass = masses.platform * Matrix3::Identity();
  for (int leg = 0; leg < 3; ++leg) mass += r_cube_leg_cartesian_mass(masses, leg, angles_of(at, leg), 0.0);
  return mass;
}

RCubeMassIndices r_cube_mass_indices(const Matrix3& mass) noexcept {
  const Vector3 principal = Eigen::SelfAdjointEigenSolver<Matrix3>(mass, Eigen::EigenvaluesOnly).eigenvalues();
  return {
      .determinant = mass.determinant(), .condition = principal[2] / principal[0], .frobenius = mass.norm()};
}

std::optional<RCubeEffort> r_cube_inverse_dynamics(const RCubeMasses& masses, const RCubeSolution& at,
                                                   const Vector3& rate, const Vector3& acceleration) noexcept {
  const RCubeState state(masses.geometry, at);
  if (state.singular()) return std::nullopt;
  Vector3 force = masses.platform * (state.acceleration(rate, acceleration) - masses.gravity);
  for (int leg = 0; leg < 3; ++leg) {
    const Vector3 q = angles_of(at, leg), qd = *state.leg_rates(leg, rate),
                  qdd = *state.leg_accelerations(leg, rate, acceleration);
    const LegMass own = leg_mass(masses, q, 0.0);
    Vector3 tau = own.M * qdd - weight(masses, leg, q);
    for (int k = 0; k < 3; ++k) {
      tau += qd[k] * (own.dM[k] * qd);
      tau[k] -= 0.5 * qd.dot(own.dM[k] * qd);
    }
    force += state.leg_jacobian(leg).transpose().inverse() * tau;
  }
  return RCubeEffort{force, state.jacobian().transpose() * force};
}

}  // namespace zwidth
