#include "zwidth/mechanism/delta.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/math/trigonometry.h"

namespace zwidth {
namespace {

constexpr double kDegenerate = 1e-12;      // relative to the squared scale, for lengths that count as zero
constexpr double kReachTolerance = 1e-12;  // relative overshoot of a length that still counts as the boundary
constexpr double kLimitTolerance = 1e-9;   // [rad]
constexpr double kSingular = 1e-4;         // scale-free singularity measures below this make a pose degraded

// Cosine and sine of the legs' azimuths 90, 210, 330 deg.
constexpr double kHalfSqrt3 = 0.86602540378443864676;
constexpr std::array<double, 3> kCosAlpha = {0.0, -kHalfSqrt3, kHalfSqrt3};
constexpr std::array<double, 3> kSinAlpha = {1.0, -0.5, -0.5};

// A vector given by its outward and upward parts in the plane of leg i.
Vector3 in_leg_plane(int i, double outward, double up) {
  return {outward * kCosAlpha[i], outward * kSinAlpha[i], up};
}

bool near_singular(const DeltaGeometry& geometry, const std::array<double, 3>& rb, double determinant) {
  const double leg_scale = kSingular * geometry.upper_arm * geometry.forearm;
  const double cube = geometry.forearm * geometry.forearm * geometry.forearm;
  return std::abs(rb[0]) < leg_scale || std::abs(rb[1]) < leg_scale || std::abs(rb[2]) < leg_scale ||
         std::abs(determinant) < kSingular * cube;
}

// J = R^-1 D with D = diag(r_i.b_i) (A.32) from the normals r_2 x r_3, r_3 x r_1, r_1 x r_2, and whether a
// singularity is near; J is zero where det R = 0.
bool jacobian_from_normals(const DeltaGeometry& geometry, const std::array<Vector3, 3>& normal,
                           double determinant, const std::array<double, 3>& rb, Matrix3& J) {
  if (determinant == 0.0) {
    J.setZero();
    return true;
  }
  const double inverse = 1.0 / determinant;
  for (int i = 0; i < 3; ++i) J.col(i) = normal[i] * (rb[i] * inverse);
  return near_singular(geometry, rb, determinant);
}

bool within(const Interval& limits, double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  return limits.contains(angle, kLimitTolerance) || limits.contains(angle + turn, kLimitTolerance) ||
         limits.contains(angle - turn, kLimitTolerance);
}

}  // namespace

double DeltaGeometry::scale() const {
  return upper_arm + forearm + std::abs(offset());
}

DeltaGeometry delta_geometry(const DeltaDescription& description) {
  return {.base_radius = description.base_radius,
          .upper_arm = description.upper_arm,
          .forearm = description.forearm,
          .platform_radius = description.platform_radius};
}

double delta_azimuth(int leg) {
  return std::numbers::pi * (0.5 + 2.0 / 3.0 * leg);
}

DeltaForward delta_forward(const DeltaGeometry& geometry, const Vector3& theta) noexcept {
  DeltaForward result;
  const double d2 = geometry.upper_arm, d3 = geometry.forearm, d5 = geometry.offset();

  // Sphere centres c_i, the elbows shifted inwards by d4 (A.4-A.9).
  std::array<SineCosine, 3> angle;
  std::array<Vector3, 3> c;
  for (int i = 0; i < 3; ++i) angle[i] = sine_cosine(theta[i]);
  for (int i = 0; i < 3; ++i) c[i] = in_leg_plane(i, d5 + d2 * angle[i].cosine, d2 * angle[i].sine);

  // Intersection of the three spheres from the circumcentre m of their centres: no division by the plane's
  // slope.
  const Vector3 u = c[1] - c[0], v = c[2] - c[0], n = u.cross(v);
  const double N = n.squaredNorm();
  const double scale = geometry.scale(), zero = kDegenerate * scale * scale;
  if (!(N > zero * zero)) {
    result.status = SolveStatus::degenerate;
    return result;
  }
  const double inverse_N = 1.0 / N;
  const Vector3 from_c1 = n.cross(u * v.squaredNorm() - v * u.squaredNorm()) * (0.5 * inverse_N);
  const double h2 = d3 * d3 - from_c1.squaredNorm();
  if (!(h2 >= -2.0 * kReachTolerance * d3 * d3)) return result;
  // det R = r_1.n = +-h |n|; upper assembly mode: larger z.
  const double determinant = std::copysign(std::sqrt(h2 > 0.0 ? h2 * N : 0.0), n.z());
  const Vector3 r1 = from_c1 + n * (determinant * inverse_N);
  result.position = c[0] + r1;

  // With r_2 = r_1 - u and r_3 = r_1 - v two products make the three normals.
  const Vector3 r1_u = r1.cross(u), r1_v = r1.cross(v);
  const std::array<Vector3, 3> normal = {n + r1_u - r1_v, r1_v, -r1_u};
  std::array<double, 3> rb;  // with elbow velocities b_i (A.26)
  for (int i = 0; i < 3; ++i) {
    const double outward = result.position.x() * kCosAlpha[i] + result.position.y() * kSinAlpha[i] - d5;
    rb[i] = d2 * (result.position.z() * angle[i].cosine - outward * angle[i].sine);
  }
  const bool singular = jacobian_from_normals(geometry, normal, determinant, rb, result.jacobian);
  result.status = singular ? SolveStatus::degraded : SolveStatus::reached;
  return result;
}

DeltaInverse delta_inverse(const DeltaGeometry& geometry, const Vector3& position, const Interval& limits,
                           const std::array<Knee, 3>& knees) noexcept {
  DeltaInverse result;
  const double d2 = geometry.upper_arm, d3 = geometry.forearm, d5 = geometry.offset();
  const double scale = geometry.scale(), zero = kDegenerate * scale * scale;
  const double x = position.x(), y = position.y(), z = position.z();
  const double constant = position.squaredNorm() + d2 * d2 - d3 * d3 + d5 * d5;

  // Per leg a cos(theta) ... = c' with A = hypot(a, b) (A.41-A.45), its root as cosine and sine. The other
  // factor of the quadratic is r.b: rb = +-sqrt(A^2 - c'^2)/2.
  std::array<double, 3> cosine, sine, rb;
  int degenerate = -1;
  for (int i = 0; i < 3; ++i) {
    const double s = x * kCosAlpha[i] + y * kSinAlpha[i];
    const double a = 2.0 * d2 * z, b = 2.0 * d2 * (d5 - s), c = constant - 2.0 * d5 * s;
    const double A2 = a * a + b * b;
    if (!(A2 > zero * zero)) {  // on the actuator axis: any angle or none
      if (std::abs(c) > zero) {
        result.joint = i;
        return result;
      }
      if (degenerate < 0) degenerate = i;
      continue;
    }
    const double difference = A2 - c * c;
    if (!(difference >= -2.0 * kReachTolerance * A2)) {
      result.joint = i;
      return result;
    }
    const double root = std::sqrt(difference > 0.0 ? difference : 0.0);
    const double signed_root = knees[i] == Knee::outwards ? root : -root;
    const double inverse_A2 = 1.0 / A2;
    cosine[i] = (signed_root * a - c * b) * inverse_A2;
    sine[i] = (c * a + signed_root * b) * inverse_A2;
    rb[i] = 0.5 * signed_root;
  }
  if (degenerate >= 0) {
    result.status = SolveStatus::degenerate;
    result.joint = degenerate;
    return result;
  }

  std::array<Vector3, 3> r;
  for (int i = 0; i < 3; ++i) {
    r[i] = position - in_leg_plane(i, d5 + d2 * cosine[i], d2 * sine[i]);
    result.theta[i] = angle_of(cosine[i], sine[i]);
  }
  const std::array<Vector3, 3> normal = {r[1].cross(r[2]), r[2].cross(r[0]), r[0].cross(r[1])};
  const double determinant = r[0].dot(normal[0]);
  const bool singular = jacobian_from_normals(geometry, normal, determinant, rb, result.jacobian);
  for (int i = 0; i < 3; ++i) {
    if (!within(limits, result.theta[i])) {
      result.status = SolveStatus::joint_limit;
      result.joint = i;
      return result;
    }
  }
  result.status = singular ? SolveStatus::degraded : SolveStatus::reached;
  return result;
}

DeltaState::DeltaState(const DeltaGeometry& geometry, const Vector3& theta, const Vector3& position) noexcept
    : geometry_(geometry), theta_(theta), p_(position) {
  const double d2 = geometry.upper_arm, d5 = geometry.offset();
  for (int i = 0; i < 3; ++i) {
    const auto [sine, cosine] = sine_cosine(theta[i]);
    R_.row(i) = p_ - in_leg_plane(i, d5 + d2 * cosine, d2 * sine);
    b_.row(i) = in_leg_plane(i, -d2 * sine, d2 * cosine);
  }
  const Vector3 r0 = R_.row(0), r1 = R_.row(1), r2 = R_.row(2);
  const double determinant = r0.dot(r1.cross(r2));
  if (determinant == 0.0) {
    Rinv_.setZero();
  } else {
    Rinv_.col(0) = r1.cross(r2) / determinant;
    Rinv_.col(1) = r2.cross(r0) / determinant;
    Rinv_.col(2) = r0.cross(r1) / determinant;
  }
  const Vector3 rb = R_.cwiseProduct(b_).rowwise().sum();
  J_ = Rinv_ * rb.asDiagonal();
}

Matrix3 DeltaState::jacobian_rate(const Vector3& theta_rate) const {
  const Vector3 pdot = J_ * theta_rate;
  Matrix3 Rdot;
  Vector3 diagonal;
  for (int i = 0; i < 3; ++i) {
    const Vector3 b = b_.row(i), r = R_.row(i);
    const Vector3 rdot = pdot - b * theta_rate[i];  // (A.25)
    const auto [sine, cosine] = sine_cosine(theta_[i]);
    const Vector3 bdot =
        in_leg_plane(i, -geometry_.upper_arm * cosine, -geometry_.upper_arm * sine) * theta_rate[i];
    Rdot.row(i) = rdot;
    diagonal[i] = rdot.dot(b) + r.dot(bdot);
  }
  return Rinv_ * (Matrix3(diagonal.asDiagonal()) - Rdot * J_);  // (A.38)
}

Vector3 DeltaState::velocity(const Vector3& theta_rate) const {
  return J_ * theta_rate;
}

Vector3 DeltaState::acceleration(const Vector3& theta_rate, const Vector3& theta_acceleration) const {
  return jacobian_rate(theta_rate) * theta_rate + J_ * theta_acceleration;
}

Vector3 DeltaState::inverse_singularity() const {
  return R_.cwiseProduct(b_).rowwise().sum() / (geometry_.upper_arm * geometry_.forearm);
}

double DeltaState::direct_singularity() const {
  return R_.determinant() / (geometry_.forearm * geometry_.forearm * geometry_.forearm);
}

DeltaPointMassDynamics::DeltaPointMassDynamics(const DeltaGeometry& geometry, const DeltaMasses& masses)
    : g_(masses.gravity) {
  const double d2 = geometry.upper_arm, r = masses.mass_split, kg = masses.gear_ratio;
  m4e_ = masses.platform + (1.0 - r) * masses.forearms.sum() + masses.payload;  // (B.2)
  for (int i = 0; i < 3; ++i) {
    m2e_[i] = masses.upper_arm + r * masses.forearms[i];  // (B.3)
    const bool weightless = m2e_[i] == 0.0;
    const double cx =
        weightless ? 0.0 : (masses.upper_arm * masses.centre_along + r * masses.forearms[i] * d2) / m2e_[i];
    const double cn = weightless ? 0.0 : masses.upper_arm * masses.centre_normal / m2e_[i];  // (B.4, B.5)
    gamma_[i] = std::atan2(cn, cx);                                                          // (B.6)
    cbar_[i] = std::hypot(cx, cn);                                                           // (B.7)
    I2e_[i] = masses.upper_arm_inertia[i] + masses.motor_inertia[i] * kg * kg +
              r * masses.forearms[i] * d2 * d2;  // (B.8)
  }
}

Matrix3 DeltaPointMassDynamics::mass_matrix(const DeltaState& state) const {
  return Matrix3(I2e_.asDiagonal()) + m4e_ * state.jacobian().transpose() * state.jacobian();  // (B.29)
}

Matrix3 DeltaPointMassDynamics::coriolis_matrix(const DeltaState& state, const Vector3& theta_rate) const {
  return m4e_ * state.jacobian().transpose() * state.jacobian_rate(theta_rate);  // (B.29)
}

Vector3 DeltaPointMassDynamics::gravity_torque(const DeltaState& state) const {
  // (B.20-B.22) with the sign of the link term corrected.
  Vector3 tau = state.jacobian().transpose() * Vector3(0.0, 0.0, -m4e_ * g_);
  for (int i = 0; i < 3; ++i) tau[i] -= m2e_[i] * g_ * cbar_[i] * std::cos(state.theta()[i] - gamma_[i]);
  return tau;
}

double DeltaPointMassDynamics::potential_energy(const DeltaState& state) const {
  double V = m4e_ * g_ * state.position().z();
  for (int i = 0; i < 3; ++i) V += m2e_[i] * g_ * cbar_[i] * std::sin(state.theta()[i] - gamma_[i]);
  return V;
}

Vector3 DeltaPointMassDynamics::inverse(const DeltaState& state, const Vector3& theta_rate,
                                        const Vector3& theta_acceleration, const Vector3& force) const {
  return mass_matrix(state) * theta_acceleration + coriolis_matrix(state, theta_rate) * theta_rate -
         gravity_torque(state) - state.jacobian().transpose() * force;  // (B.28)
}

Vector3 DeltaPointMassDynamics::forward(const DeltaState& state, const Vector3& theta_rate,
                                        const Vector3& torque, const Vector3& force) const {
  const Vector3 driving = torque - coriolis_matrix(state, theta_rate) * theta_rate + gravity_torque(state) +
                          state.jacobian().transpose() * force;
  return mass_matrix(state).ldlt().solve(driving);
}

}  // namespace zwidth
