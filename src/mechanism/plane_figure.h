#pragma once

#include <Eigen/Core>

#include "zwidth/mechanism/figure.h"

namespace zwidth {

/// `figure_info` for a tool that translates in a plane: manipulability has another unit.
const FigureInfo& plane_figure_info(int index);

/// Figures of a 2 x 2 Jacobian [m/rad] of a tool in a plane, from the first two drives: NaN where they are not
/// defined, along z, and for the two singularity measures. Those are defined for planar mechanisms of two legs
/// that have a crank and a coupler each: the smaller sine of crank to coupler, and the sine of coupler to
/// coupler.
FigureValues plane_figures(const Eigen::Matrix2d& jacobian, const DriveLimits& limits);

}  // namespace zwidth
