#include "zwidth/analysis/resolution.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace zwidth {

Jacobian tool_steps(const Jacobian& jacobian, const ActiveVector& joint_step) {
  assert(joint_step.size() == jacobian.cols());
  return jacobian.cwiseAbs() * joint_step.asDiagonal();
}

ToolVector tool_resolution(const Jacobian& jacobian, const ActiveVector& joint_step) {
  assert(joint_step.size() == jacobian.cols());
  return jacobian.cwiseAbs() * joint_step;
}

ToolStep tool_step(const Posture& posture, int joint, double step) {
  const Mechanism& mechanism = posture.mechanism();
  assert(joint >= 0 && joint < mechanism.active_count());
  ActiveVector active = posture.active();
  active[joint] += step;
  const Solution moved = solve_forward(mechanism, active, {.start = &posture});
  if (!moved) return {};
  ToolStep result;
  const Pose& from = posture.tool();
  const Pose& to = moved.posture->tool();
  if (mechanism.linear_rows() > 0) result.distance = (to.position - from.position).norm();
  if (mechanism.tool_turns()) {
    // 2 asin of half the chord keeps its digits for small turns: |R - I|_F = sqrt(8) sin(angle/2).
    const double chord = (from.rotation.transpose() * to.rotation - Matrix3::Identity()).norm();
    result.angle = 2.0 * std::asin(std::min(1.0, chord / std::sqrt(8.0)));
  }
  return result;
}

PostureResolution posture_resolution(const Posture& posture, const ActiveVector& joint_step) {
  const Mechanism& mechanism = posture.mechanism();
  const int n = mechanism.active_count(), linear = mechanism.linear_rows();
  assert(joint_step.size() == n);
  const Jacobian steps = jacobian(posture) * joint_step.asDiagonal();
  const auto size_of = [&](const ToolVector& tool) {
    return ToolStep{tool.head(linear).norm(), tool.tail(tool.size() - linear).norm()};
  };
  PostureResolution resolution;
  for (int j = 0; j < n; ++j) {
    resolution.joints.push_back(size_of(steps.col(j)));
    resolution.worst.distance = std::max(resolution.worst.distance, resolution.joints.back().distance);
    resolution.worst.angle = std::max(resolution.worst.angle, resolution.joints.back().angle);
  }
  // Every choice of signs but for turning all of them round.
  for (unsigned signs = 0; signs < 1U << (n - 1); ++signs) {
    ToolVector sum = steps.col(n - 1);
    for (int j = 0; j + 1 < n; ++j) sum += ((signs >> j & 1U) != 0 ? 1.0 : -1.0) * steps.col(j);
    const ToolStep one = size_of(sum);
    resolution.together.distance = std::max(resolution.together.distance, one.distance);
    resolution.together.angle = std::max(resolution.together.angle, one.angle);
  }
  return resolution;
}

ToolVector force_resolution(const Jacobian& jacobian, const ActiveVector& torque_step) {
  assert(jacobian.rows() == jacobian.cols() && torque_step.size() == jacobian.cols());
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const Eigen::FullPivLU<Square> transposed(jacobian.transpose());
  if (!transposed.isInvertible()) {
    return ToolVector::Constant(jacobian.rows(), std::numeric_limits<double>::infinity());
  }
  const Square inverse = transposed.inverse();
  return inverse.cwiseAbs() * torque_step;
}

}  // namespace zwidth
