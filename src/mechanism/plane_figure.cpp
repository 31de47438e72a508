#include "zwidth/mechanism/plane_figure.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace zwidth {

const FigureInfo& plane_figure_info(int index) {
  static const std::array<FigureInfo, kFigureCount> info = [] {
    std::array<FigureInfo, kFigureCount> result;
    for (int f = 0; f < kFigureCount; ++f) result[f] = figure_info(f);
    result[static_cast<int>(Figure::manipulability)].unit = "m^2/rad^2";
    result[static_cast<int>(Figure::platform_singularity)].meaning = "distance of the couplers from aligned";
    return result;
  }();
  assert(index >= 0 && index < kFigureCount);
  return info[index];
}

FigureValues plane_figures(const Eigen::Matrix2d& jacobian, const DriveLimits& limits) {
  using Eigen::Vector2d;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  FigureValues values;
  values.fill(std::numeric_limits<double>::quiet_NaN());
  const auto set = [&values](Figure which, double value) { values[static_cast<int>(which)] = value; };

  // K + 1/K = |J|_F^2/|det J|; the root of the difference of squares, taken apart, keeps its digits near K = 1.
  const double S = jacobian.squaredNorm(), det = jacobian.determinant(), delta = std::abs(det);
  const double root = std::sqrt(std::max(0.0, S - 2.0 * delta) * (S + 2.0 * delta));
  set(Figure::condition_number, delta > 0.0 ? std::max(1.0, (S + root) / (2.0 * delta)) : kInfinity);
  set(Figure::manipulability, delta);

  const Vector2d torque = limits.torque.head<2>();
  for (int k = 0; k < 2; ++k) {
    const double force =
        1.0 / std::max(std::abs(jacobian(k, 0)) / torque[0], std::abs(jacobian(k, 1)) / torque[1]);
    const double step = std::abs(jacobian(k, 0)) * limits.step[0] + std::abs(jacobian(k, 1)) * limits.step[1];
    values[static_cast<int>(Figure::force_x) + k] = force;
    values[static_cast<int>(Figure::step_x) + k] = step;
  }

  // The parallelogram |J_j . f| <= torque_j: sides torque_j/|J_j| from the origin, vertices J^-T (+-torque).
  set(Figure::weakest_force, std::min(torque[0] / jacobian.col(0).norm(), torque[1] / jacobian.col(1).norm()));
  const Vector2d a = torque[0] * Vector2d(jacobian(1, 1), -jacobian(0, 1));
  const Vector2d b = torque[1] * Vector2d(-jacobian(1, 0), jacobian(0, 0));
  const double farthest = std::sqrt(a.squaredNorm() + b.squaredNorm() + 2.0 * std::abs(a.dot(b)));
  set(Figure::strongest_force, delta > 0.0 ? farthest / delta : kInfinity);
  return values;
}

}  // namespace zwidth
