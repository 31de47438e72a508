#include "zwidth/analysis/force.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ActiveVector torques_for_load(const Jacobian& jacobian, const ToolVector& load) {
  assert(load.size() == jacobian.rows());
  return jacobian.transpose() * load;
}

double force_limit_along(const Jacobian& jacobian, const ActiveVector& torque_limit,
                         const ToolVector& direction) {
  assert(direction.size() == jacobian.rows() && torque_limit.size() == jacobian.cols());
  const ActiveVector torque = jacobian.transpose() * direction.normalized();
  double limit = kInfinity;
  for (int j = 0; j < torque.size(); ++j) {
    if (torque[j] != 0.0) limit = std::min(limit, torque_limit[j] / std::abs(torque[j]));
  }
  return limit;
}

ToolVector axis_force_limits(const Jacobian& jacobian, const ActiveVector& torque_limit) {
  ToolVector limits(jacobian.rows());
  for (int k = 0; k < limits.size(); ++k) {
    limits[k] = force_limit_along(jacobian, torque_limit, ToolVector::Unit(jacobian.rows(), k));
  }
  return limits;
}

ForcePolytope force_polytope(const Jacobian& jacobian, const ActiveVector& torque_limit) {
  const int n = static_cast<int>(jacobian.cols());
  assert(jacobian.rows() == n && torque_limit.size() == n);
  ForcePolytope polytope;

  // A face for every joint, limit_j/|J_j| away from the origin along its column J_j.
  polytope.weakest = kInfinity;
  polytope.weakest_direction = ToolVector::Unit(n, 0);
  for (int j = 0; j < n; ++j) {
    const double length = jacobian.col(j).norm();
    if (length > 0.0 && torque_limit[j] / length < polytope.weakest) {
      polytope.weakest = torque_limit[j] / length;
      polytope.weakest_direction = jacobian.col(j) / length;
    }
  }

  const Eigen::FullPivLU<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>> transposed(
      jacobian.transpose());
  if (!transposed.isInvertible()) {
    polytope.strongest = polytope.volume = kInfinity;
    polytope.strongest_direction = transposed.kernel().col(0).normalized();
    return polytope;
  }
  polytope.volume = std::abs(1.0 / transposed.determinant());
  for (int j = 0; j < n; ++j) polytope.volume *= 2.0 * torque_limit[j];
  for (int corner = 0; corner < 1 << n; ++corner) {
    ToolVector torque(n);
    for (int j = 0; j < n; ++j) torque[j] = (corner >> j & 1) != 0 ? torque_limit[j] : -torque_limit[j];
    const ToolVector vertex = transposed.solve(torque);
    const double length = vertex.norm();
    if (length > polytope.strongest) {
      polytope.strongest = length;
      polytope.strongest_direction = vertex / length;
    }
    polytope.vertices.push_back(vertex);
  }
  return polytope;
}

}  // namespace zwidth
