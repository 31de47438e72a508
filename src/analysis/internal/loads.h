#pragma once

#include <algorithm>
#include <limits>

#include "zwidth/analysis/force.h"

namespace zwidth::internal {

/// Largest load available in every direction: the nearest face of min_j <= J_j . w <= max_j, for rows of one
/// kind. Joints that feel no load of these rows do not count.
inline double weakest_load(const Jacobian& rows, const TorqueRange& range) {
  constexpr double kSilent = 1e-12;  // a column of J that small against the largest feels no load
  const double loudest = rows.colwise().norm().maxCoeff();
  double weakest = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    const double norm = rows.col(j).norm();
    if (norm <= kSilent * loudest) continue;
    weakest = std::min(weakest, std::max(0.0, std::min(range.max[j], -range.min[j])) / norm);
  }
  return weakest;
}

/// Largest pure load along an axis of these rows, whichever way is weaker.
inline double axis_load(const Jacobian& rows, const TorqueRange& range, Eigen::Index axis) {
  ToolVector direction = ToolVector::Unit(rows.rows(), axis);
  const double forwards = load_limit(rows, range, direction).value;
  direction = -direction;
  return std::min(forwards, load_limit(rows, range, direction).value);
}

}  // namespace zwidth::internal
