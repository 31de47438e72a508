#include "zwidth/analysis/force.h"

#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/math/linear_programme.h"
#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double longest_column(const Jacobian& jacobian) {
  return jacobian.colwise().norm().maxCoeff();
}

bool feels_nothing(const Jacobian& jacobian, int j, double longest) {
  return jacobian.col(j).norm() <= kZeroRow * longest;
}

}  // namespace

const char* to_string(LoadStatus status) {
  switch (status) {
    case LoadStatus::limited:
      return "limited";
    case LoadStatus::unlimited:
      return "unlimited";
    case LoadStatus::none:
      return "none";
  }
  return "";
}

ActiveVector torques_for_load(const Jacobian& jacobian, const ToolVector& load) {
  assert(load.size() == jacobian.rows());
  return jacobian.transpose() * load;
}

LoadLimit load_limit(const Jacobian& jacobian, const TorqueRange& range, const ToolVector& direction) noexcept {
  assert(direction.size() == jacobian.rows() && range.min.size() == jacobian.cols());
  LoadLimit limit;
  if (!range.holds()) return limit;
  const ToolVector unit = direction.normalized();
  const ActiveVector torque = jacobian.transpose() * unit;
  const double longest = longest_column(jacobian);
  limit.value = kInfinity;
  for (int j = 0; j < torque.size(); ++j) {
    if (feels_nothing(jacobian, j, longest)) continue;
    // A direction at right angles to the column, but for rounding, does not load the joint.
    if (std::abs(torque[j]) <= kZeroRow * jacobian.col(j).norm()) continue;
    const double value = (torque[j] > 0.0 ? range.max[j] : range.min[j]) / torque[j];
    if (value < limit.value) {
      limit.value = value;
      limit.joint = j;
    }
  }
  limit.status = limit.joint < 0 ? LoadStatus::unlimited : LoadStatus::limited;
  if (limit.joint >= 0) limit.load = limit.value * unit;
  return limit;
}

LoadLimit load_limit(const Jacobian& jacobian, const TorqueRange& range, const ToolVector& direction,
                     const ToolMatrix& free) noexcept {
  const auto n = jacobian.cols(), k = free.cols();
  assert(direction.size() == jacobian.rows() && free.rows() == jacobian.rows() && range.min.size() == n);
  const ToolVector unit = direction.normalized();
  LinearProgramme programme;
  programme.rows.resize(n, k + 1);
  programme.rows.col(0) = jacobian.transpose() * unit;
  programme.rows.rightCols(k) = jacobian.transpose() * free;
  programme.lower = range.min;
  programme.upper = range.max;
  programme.objective = LinearProgramme::Point::Unit(k + 1, 0);
  // What is free may have a share along the direction, which counts.
  for (Eigen::Index i = 0; i < k; ++i) programme.objective[i + 1] = unit.dot(free.col(i));
  const double longest = longest_column(jacobian);
  for (int j = 0; j < n; ++j) {
    if (feels_nothing(jacobian, j, longest)) programme.rows.row(j).setZero();
  }
  const ProgrammeSolution solution = maximise(programme);
  LoadLimit limit;
  if (solution.status == ProgrammeStatus::infeasible) return limit;
  if (solution.status == ProgrammeStatus::unbounded) {
    limit.status = LoadStatus::unlimited;
    limit.value = kInfinity;
    return limit;
  }
  limit.status = LoadStatus::limited;
  limit.value = solution.value;
  limit.load = solution.point[0] * unit;
  for (Eigen::Index i = 0; i < k; ++i) limit.load += solution.point[i + 1] * free.col(i);
  double steepest = 0.0;
  for (int j = 0; j < n; ++j) {
    if (std::abs(solution.multipliers[j]) > steepest) {
      steepest = std::abs(solution.multipliers[j]);
      limit.joint = j;
    }
  }
  return limit;
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
  const TorqueRange range = TorqueRange::symmetric(torque_limit);
  for (int k = 0; k < limits.size(); ++k) {
    limits[k] = load_limit(jacobian, range, ToolVector::Unit(jacobian.rows(), k)).value;
  }
  return limits;
}

ForcePolytope force_polytope(const Jacobian& jacobian, const TorqueRange& range) {
  const int m = static_cast<int>(jacobian.rows()), n = static_cast<int>(jacobian.cols());
  assert(range.min.size() == n && range.max.size() == n);
  const Polytope shape = polytope({.rows = jacobian.transpose(), .lower = range.min, .upper = range.max});
  ForcePolytope forces;
  forces.status = shape.status;
  forces.dimension = shape.dimension;
  forces.faces = shape.faces;
  forces.volume = shape.volume;
  forces.vertices.assign(shape.vertices.begin(), shape.vertices.end());
  forces.weakest_direction = forces.strongest_direction = ToolVector::Unit(m, 0);
  if (shape.status == PolytopeStatus::empty) return forces;

  // The ball touches the plane that is nearest, bound_j/|J_j| away along the column J_j.
  const double longest = longest_column(jacobian);
  forces.weakest = range.holds() ? kInfinity : 0.0;
  for (int j = 0; j < n && range.holds(); ++j) {
    if (feels_nothing(jacobian, j, longest)) continue;
    const double length = jacobian.col(j).norm();
    for (const double sign : {1.0, -1.0}) {
      const double distance = (sign > 0.0 ? range.max[j] : -range.min[j]) / length;
      if (distance < forces.weakest) {
        forces.weakest = distance;
        forces.weakest_direction = sign * jacobian.col(j) / length;
      }
    }
  }
  if (shape.status == PolytopeStatus::unbounded) {
    forces.strongest = kInfinity;
    const Eigen::FullPivLU<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>> transposed(
        jacobian.transpose());
    forces.strongest_direction = transposed.kernel().col(0).normalized();
    return forces;
  }
  for (const ToolVector& vertex : forces.vertices) {
    const double length = vertex.norm();
    if (length > forces.strongest) {
      forces.strongest = length;
      forces.strongest_direction = vertex / length;
    }
  }
  return forces;
}

ForcePolytope force_polytope(const Jacobian& jacobian, const ActiveVector& torque_limit) {
  return force_polytope(jacobian, TorqueRange::symmetric(torque_limit));
}

Ellipsoid velocity_ellipsoid(const Jacobian& jacobian, const ActiveVector& rate_limit) {
  assert(rate_limit.size() == jacobian.cols());
  const auto m = jacobian.rows();
  const Svd parts = svd(jacobian * rate_limit.asDiagonal());
  Ellipsoid ellipsoid{parts.u, ToolVector::Zero(m)};
  ellipsoid.lengths.head(parts.sigma.size()) = parts.sigma;
  return ellipsoid;
}

Ellipsoid force_ellipsoid(const Jacobian& jacobian, const ActiveVector& torque_limit) {
  assert(torque_limit.size() == jacobian.cols());
  const auto m = jacobian.rows();
  // Directions that joints without a drive feel carry nothing; the others span `carried`.
  SmallMatrix undriven(m, 0), driven(m, 0);
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    SmallMatrix& part = torque_limit[j] > 0.0 ? driven : undriven;
    part.conservativeResize(m, part.cols() + 1);
    part.rightCols(1) = jacobian.col(j);
    if (torque_limit[j] > 0.0) part.rightCols(1) /= torque_limit[j];
  }
  const double longest = longest_column(jacobian);
  SmallMatrix carried = SmallMatrix::Identity(m, m), barred(m, 0);
  if (undriven.cols() > 0) {
    const Svd parts = svd(undriven);
    Eigen::Index rank = 0;
    while (rank < parts.sigma.size() && parts.sigma[rank] > kZeroRow * longest) ++rank;
    barred = parts.u.leftCols(rank);
    carried = parts.u.rightCols(m - rank);
  }
  Ellipsoid ellipsoid{ToolMatrix::Identity(m, m), ToolVector::Zero(m)};
  const auto k = carried.cols();
  if (k > 0 && driven.cols() > 0) {
    const SmallMatrix within = carried.transpose() * driven;
    const Svd parts = svd(within);
    // The weakest direction of the map to the torques is the strongest of the forces.
    for (Eigen::Index i = 0; i < k; ++i) {
      const Eigen::Index from = k - 1 - i;
      const double sigma = from < parts.sigma.size() ? parts.sigma[from] : 0.0;
      ellipsoid.axes.col(i) = carried * parts.u.col(from);
      // What rounding leaves of a direction that loads no joint is no figure.
      ellipsoid.lengths[i] = sigma > kZeroRow * parts.sigma[0] ? 1.0 / sigma : kInfinity;
    }
  } else if (k > 0) {
    ellipsoid.axes.leftCols(k) = carried;
    ellipsoid.lengths.head(k).setConstant(kInfinity);
  }
  ellipsoid.axes.rightCols(m - k) = barred;
  return ellipsoid;
}

Zonotope velocity_polytope(const Jacobian& jacobian, const ActiveVector& rate_limit) {
  assert(rate_limit.size() == jacobian.cols());
  return zonotope({.columns = jacobian, .lower = -rate_limit, .upper = rate_limit});
}

}  // namespace zwidth
