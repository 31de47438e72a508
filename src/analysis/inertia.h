#pragma once

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/dynamics.h"

/// The mass that the user feels.

namespace zwidth {

using ToolMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

/// Force per acceleration along `direction` while the tool is free to move sideways: 1 / (u^T Lambda^-1 u)
/// [kg]. `direction` need not be a unit vector. REQUIRES: cartesian_mass is symmetric positive definite.
double apparent_mass(const ToolMatrix& cartesian_mass, const ToolVector& direction);

/// Apparent mass along and across the axes of one posture.
struct ApparentMass {
  ToolVector along_axes;          ///< along each tool axis [kg]
  double lightest = 0.0;          ///< over all directions: the smallest eigenvalue of Lambda [kg]
  double heaviest = 0.0;          ///< [kg]
  ToolVector lightest_direction;  ///< unit
  ToolVector heaviest_direction;  ///< unit
};
ApparentMass apparent_mass(const ToolMatrix& cartesian_mass);

}  // namespace zwidth
