#include "zwidth/mechanism/r_cube_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/math/elimination.h"

namespace zwidth {
namespace {

using Springs = std::array<Vector6, 3>;  // theta_i1, theta_i2, theta_i3

// Columns of the Jacobians of one leg at given deflections of its springs (eq 5.77-5.81).
struct Chain {
  std::array<Matrix6, 3> J_theta;
  Eigen::Matrix<double, 6, 4> J_p;  // phi_i2 to phi_i5
};

Matrix3 turn(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Vector3::Unit(axis)).toRotationMatrix();
}

Chain chain_of(const RCubeGeometry& geometry, int leg, const Vector3& q, const Springs& theta) {
  // A line or axis through a point, whose lever about P is known only when P is.
  struct Axis {
    Vector3 point, direction;
    bool slides = false;
  };
  std::array<std::array<Axis, 6>, 3> springs;
  std::array<Axis, 4> joints;

  const Vector3 e_a = Vector3::Unit(r_cube_axis(leg, 0)), e_b = Vector3::Unit(r_cube_axis(leg, 1)),
                e_c = Vector3::Unit(r_cube_axis(leg, 2));
  Matrix3 R;  // of H(0,i0): axis 1 along the drive link at zero, axis 3 the motor's
  R << e_c, e_a, e_b;
  Vector3 o = geometry.base_offset * e_a;
  const double lengths[] = {geometry.drive_link, geometry.inner_link, geometry.outer_link};
  const auto link = [&](int k) {
    o += lengths[k] * R.col(0);
    for (int i = 0; i < 3; ++i) springs[k][i] = {o, R.col(i), true};
    o += R * theta[k].head<3>();
    for (int i = 0; i < 3; ++i) {
      springs[k][3 + i] = {o, R.col(i), false};
      R = R * turn(i, theta[k][3 + i]);
    }
  };
  const auto joint = [&](int p, double angle) {
    joints[p] = {o, R.col(2), false};
    R = R * turn(2, angle);
  };
  R = R * turn(2, q[0]);
  link(0);
  joint(0, -q[0]);
  R = R * turn(0, -0.5 * std::numbers::pi);
  joint(1, q[1]);
  link(1);
  joint(2, q[2]);
  link(2);
  joint(3, -q[1] - q[2]);

  const auto column = [&](const Axis& axis) {
    Vector6 c;
    if (axis.slides) {
      c << axis.direction, Vector3::Zero();
    } else {
      c << axis.direction.cross(o - axis.point), axis.direction;
    }
    return c;
  };
  Chain chain;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 6; ++i) chain.J_theta[k].col(i) = column(springs[k][i]);
  }
  for (int p = 0; p < 4; ++p) chain.J_p.col(p) = column(joints[p]);
  return chain;
}

std::array<Matrix6, 3> spring_compliances(const RCubeLinks& links) {
  const RCubeGeometry& g = links.geometry;
  const Vector3 lengths = links.stiffness_lengths.value_or(Vector3(g.drive_link, g.inner_link, g.outer_link));
  std::array<Matrix6, 3> compliances;
  for (int k = 0; k < 3; ++k) compliances[k] = beam_compliance(links.rigidity[k], lengths[k]);
  return compliances;
}

RCubeLegElasticity elasticity(const RCubeLinks& links, const Chain& chain,
                              const std::array<Matrix6, 3>& springs) {
  RCubeLegElasticity result;
  result.compliance.setZero();
  for (int k = 0; k < 3; ++k) result.compliance += chain.J_theta[k] * springs[k] * chain.J_theta[k].transpose();

  // N: wrenches that no passive joint feels, with moments over a length so that all rows are of one kind.
  const double length = links.geometry.total_length();
  Elimination passive;
  passive.resize(6, 4);
  for (int p = 0; p < 4; ++p) {
    for (int i = 0; i < 6; ++i) passive.at(i, p) = chain.J_p(i, p) * (i < 3 ? 1.0 : length);
  }
  while (passive.step()) {
  }
  const int count = 6 - passive.rank();
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> N(6, count);
  for (int w = 0; w < count; ++w) {
    for (int i = 0; i < 6; ++i) N(i, w) = passive.left_over(w)[i] * (i < 3 ? 1.0 : length);
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> D =
      N.transpose() * result.compliance * N;
  result.stiffness = N * D.inverse() * N.transpose();
  return result;
}

}  // namespace

Matrix6 RCubeLegElasticity::locked_stiffness() const noexcept {
  // Metres and radians differ by orders of magnitude: one on the whole diagonal.
  const Vector6 scale = compliance.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 scaled = scale.asDiagonal() * compliance * scale.asDiagonal();
  return scale.asDiagonal() * Matrix6(scaled.ldlt().solve(Matrix6::Identity())) * scale.asDiagonal();
}

RCubeLegElasticity r_cube_leg_elasticity(const RCubeLinks& links, int leg, const Vector3& angles) noexcept {
  const Springs still = {Vector6::Zero(), Vector6::Zero(), Vector6::Zero()};
  return elasticity(links, chain_of(links.geometry, leg, angles, still), spring_compliances(links));
}

RCubeLegElasticity r_cube_leg_elasticity(const RCubeLinks& links, int leg, const Vector3& angles,
                                         const Vector6& wrench) noexcept {
  Springs theta = {Vector6::Zero(), Vector6::Zero(), Vector6::Zero()};
  const std::array<Matrix6, 3> springs = spring_compliances(links);
  const Chain straight = chain_of(links.geometry, leg, angles, theta);
  for (int k = 0; k < 3; ++k) theta[k] = springs[k] * straight.J_theta[k].transpose() * wrench;  // (5.117)
  return elasticity(links, chain_of(links.geometry, leg, angles, theta), springs);
}

RCubeLoadedLeg r_cube_loaded_leg(const RCubeLinks& links, int leg, const Vector3& angles, const Vector6& wrench,
                                 double tolerance, int max_iterations) noexcept {
  RCubeLoadedLeg result;
  Springs theta = {Vector6::Zero(), Vector6::Zero(), Vector6::Zero()};
  const std::array<Matrix6, 3> springs = spring_compliances(links);
  Chain chain = chain_of(links.geometry, leg, angles, theta);
  const double length = links.geometry.total_length();
  while (!result.converged && result.iterations < max_iterations) {
    ++result.iterations;
    result.residual = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vector6 next = springs[k] * chain.J_theta[k].transpose() * wrench;
      Vector6 change = (next - theta[k]).cwiseAbs();
      change.head<3>() /= length;
      result.residual = std::max(result.residual, change.maxCoeff());
      theta[k] = next;
    }
    constexpr double kOutOfHand = 10.0;  // no link turns so far
    if (!(result.residual < kOutOfHand)) break;
    chain = chain_of(links.geometry, leg, angles, theta);
    result.converged = result.residual <= tolerance;
  }
  result.elasticity = elasticity(links, chain, springs);
  return result;
}

Matrix6 r_cube_stiffness(const RCubeLinks& links, const RCubeSolution& solution) noexcept {
  Matrix6 K = Matrix6::Zero();
  for (int leg = 0; leg < 3; ++leg) {
    const Vector3 angles(solution.theta[leg], solution.swing[leg], solution.elbow[leg]);
    K += r_cube_leg_elasticity(links, leg, angles).stiffness;
  }
  return K;
}

Vector6 r_cube_deflection(const RCubeLinks& links, const RCubeSolution& solution,
                          const Vector6& load) noexcept {
  // Leg i carries a force f_i along e_a, with the moment -z_i f_i about e_b, and a moment m_i about e_c.
  std::array<Eigen::Matrix2d, 3> C;  // displacement along each per each
  Vector3 z;
  for (int leg = 0; leg < 3; ++leg) {
    const Vector3 q(solution.theta[leg], solution.swing[leg], solution.elbow[leg]);
    z[leg] = links.geometry.inner_link * std::cos(q[1]) + links.geometry.outer_link * std::cos(q[1] + q[2]);
    Eigen::Matrix<double, 6, 2> N = Eigen::Matrix<double, 6, 2>::Zero();
    N(r_cube_axis(leg, 0), 0) = 1.0;
    N(3 + r_cube_axis(leg, 1), 0) = -z[leg];
    N(3 + r_cube_axis(leg, 2), 1) = 1.0;
    C[leg] = N.transpose() * r_cube_leg_elasticity(links, leg, q).compliance * N;
  }
  Vector6 u;
  for (int leg = 0; leg < 3; ++leg) {
    const int a = r_cube_axis(leg, 0), b = r_cube_axis(leg, 1), c = r_cube_axis(leg, 2);
    // Leg b pushes along its own axis, e_b, and so turns about e_c.
    u[3 + c] = C[leg](1, 0) * load[a] + C[leg](1, 1) * (load[3 + c] + z[b] * load[b]);
  }
  for (int leg = 0; leg < 3; ++leg) {
    const int a = r_cube_axis(leg, 0), b = r_cube_axis(leg, 1), c = r_cube_axis(leg, 2);
    u[a] = C[leg](0, 0) * load[a] + C[leg](0, 1) * (load[3 + c] + z[b] * load[b]) + z[leg] * u[3 + b];
  }
  return u;
}

}  // namespace zwidth
