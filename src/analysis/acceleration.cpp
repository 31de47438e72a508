#include "zwidth/analysis/acceleration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

constexpr double kSingular = 1e-12;  // of the largest principal mobility: none at all

Segments segments_of(const ToolMotion& motion, const TorqueRange& range) {
  const TorqueRange left = range.beside(motion.needed);
  Segments segments{motion.response, left.min, left.max};
  if (motion.turning.isZero(0.0)) return segments;
  // The velocity's own share is moved into the bounds of the torques that would give it.
  const auto [u, sigma, v] = svd(motion.response);
  ToolVector share = u.transpose() * motion.turning;
  for (Eigen::Index k = 0; k < sigma.size(); ++k)
    share[k] = sigma[k] > kSingular * sigma[0] ? share[k] / sigma[k] : 0.0;
  const ActiveVector torque = v.leftCols(sigma.size()) * share.head(sigma.size());
  segments.lower += torque;
  segments.upper += torque;
  return segments;
}

}  // namespace

ToolMotion ToolMotion::rows(int first, int count) const {
  return {response.middleRows(first, count), mobility.block(first, first, count, count), needed,
          turning.segment(first, count), coasting.segment(first, count)};
}

ToolMotion tool_motion(const Posture& posture, const Rates& rates, const ActiveVector& rate) noexcept {
  ToolMotion motion;
  const ActiveMatrix M = mass_matrix(posture, rates);
  motion.response = M.ldlt().solve(rates.tool.transpose()).transpose();
  motion.mobility = motion.response.lazyProduct(rates.tool.transpose());
  motion.needed = inverse_dynamics(posture, rate, ActiveVector::Zero(rate.size()));
  motion.turning = bias_acceleration(posture, rates, rate).tool;
  motion.coasting = motion.turning - motion.response * motion.needed;
  return motion;
}

ToolVector tool_acceleration(const ToolMotion& motion, const ActiveVector& torque, const ToolVector& push) {
  ToolVector acceleration = motion.response * torque + motion.coasting;
  if (push.size() > 0) acceleration += motion.mobility * push;
  return acceleration;
}

std::optional<ActiveVector> torques_for_tool_acceleration(const Posture& posture, const Rates& rates,
                                                          const ActiveVector& rate,
                                                          const ToolVector& acceleration,
                                                          const ToolVector& push) {
  assert(acceleration.size() == rates.tool.rows());
  const ActiveMatrix M = mass_matrix(posture, rates);
  const Jacobian response = M.ldlt().solve(rates.tool.transpose()).transpose();
  const ToolMatrix mobility = response.lazyProduct(rates.tool.transpose());
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(mobility);
  const ToolVector& principal = eigen.eigenvalues();
  if (!(principal[0] > kSingular * principal[principal.size() - 1])) return std::nullopt;
  const ToolVector missing = acceleration - bias_acceleration(posture, rates, rate).tool;
  const ToolVector force =
      eigen.eigenvectors() * (eigen.eigenvectors().transpose() * missing).cwiseQuotient(principal);
  return inverse_dynamics(posture, rate, response.transpose() * force, push);
}

Ellipsoid inertia_ellipsoid(const ToolMatrix& mobility) {
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(mobility);
  const auto n = mobility.rows();
  Ellipsoid ellipsoid{ToolMatrix(n, n), ToolVector(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    ellipsoid.axes.col(k) = eigen.eigenvectors().col(n - 1 - k);
    ellipsoid.lengths[k] = std::sqrt(std::max(0.0, eigen.eigenvalues()[n - 1 - k]));
  }
  return ellipsoid;
}

Ellipsoid acceleration_ellipsoid(const ToolMotion& motion, const ActiveVector& torque_limit) {
  // The map from torques to accelerations takes the place of the Jacobian.
  return velocity_ellipsoid(motion.response, torque_limit);
}

double dynamic_manipulability(const ToolMotion& motion) {
  return dexterity(motion.response).manipulability;
}

Zonotope acceleration_polytope(const ToolMotion& motion, const TorqueRange& range) {
  Zonotope polytope = zonotope(segments_of(motion, range));
  if (polytope.inner_radius <= kSingular * polytope.outer_radius) polytope.inner_radius = 0.0;
  return polytope;
}

MotionPower motion_power(const Mechanism& mechanism, std::span<const MotionSample> motion) {
  const int n = mechanism.active_count();
  MotionPower power;
  power.torque = power.rms = power.peak = power.braking = ActiveVector::Zero(n);
  std::optional<Posture> last;
  for (std::size_t s = 0; s < motion.size(); ++s) {
    const MotionSample& sample = motion[s];
    Solution solution = solve_forward(mechanism, sample.joints, {.start = last ? &*last : nullptr});
    if (!solution) continue;
    last = solution.posture;
    const ActiveVector torque = inverse_dynamics(*last, sample.rate, sample.acceleration, sample.push);
    const ActiveVector given = torque.cwiseProduct(sample.rate);
    ++power.samples;
    power.torque = power.torque.cwiseMax(torque.cwiseAbs());
    power.rms += torque.cwiseAbs2();
    power.peak = power.peak.cwiseMax(given);
    power.braking = power.braking.cwiseMax(-given);
    if (given.sum() > power.total_peak) {
      power.total_peak = given.sum();
      power.total_peak_at = static_cast<int>(s);
    }
  }
  if (power.samples > 0) power.rms = (power.rms / power.samples).cwiseSqrt();
  return power;
}

}  // namespace zwidth
