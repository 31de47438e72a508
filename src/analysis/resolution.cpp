#include "zwidth/analysis/resolution.h"

#include <Eigen/LU>
#include <cassert>
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
