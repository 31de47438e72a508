#pragma once

#include <Eigen/Core>

#include "zwidth/description/limits.h"

/// Run-time numbers of joints with a compile-time maximum and storage inside the object: no heap in a tick.

namespace zwidth {

/// Values of the active joints, in the order of `Mechanism::active_names()` [rad] or [m].
using ActiveVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxActive, 1>;
using ActiveMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxActive, kMaxActive>;
/// Values of all joints, leg after leg, from the base outwards [rad] or [m].
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
/// Rates of all joints per rate of each active joint.
using RateMap = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxActive>;
/// Tool velocity or force: 3 rows for a platform that only translates, 6 (linear over angular) otherwise.
using ToolVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
/// Square in the tool's rows.
using ToolMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
/// Tool velocity per rate of each active joint (tool rows x active columns).
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, kMaxActive>;

}  // namespace zwidth
