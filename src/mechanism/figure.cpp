#include "zwidth/mechanism/figure.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace zwidth {
namespace {

constexpr std::array<FigureInfo, kFigureCount> kInfo = {{
    {"condition_number", "1", "condition number of the Jacobian"},
    {"manipulability", "m^3/rad^3", "manipulability |det J|"},
    {"force_x", "N", "largest force along x"},
    {"force_y", "N", "largest force along y"},
    {"force_z", "N", "largest force along z"},
    {"weakest_force", "N", "force available in every direction"},
    {"strongest_force", "N", "largest force in any direction"},
    {"step_x", "m", "worst tool step along x"},
    {"step_y", "m", "worst tool step along y"},
    {"step_z", "m", "worst tool step along z"},
    {"leg_singularity", "1", "distance of the legs from stretched or folded"},
    {"platform_singularity", "1", "distance of the forearms from coplanar"},
}};

// Largest and smallest. The roots of the characteristic polynomial of J^T J (Smith 1961) lose digits with the
// square of the condition number: where that is large, they come by iteration.
std::pair<double, double> extreme_singular_values(const Matrix3& jacobian) {
  constexpr double kFew = 1e-3;  // of the eigenvalues: 13 digits are left
  const Matrix3 A = jacobian.transpose() * jacobian;
  const double mean = A.trace() / 3.0;
  const double a = A(0, 0) - mean, b = A(1, 1) - mean, c = A(2, 2) - mean;
  const double across = A(0, 1) * A(0, 1) + A(0, 2) * A(0, 2) + A(1, 2) * A(1, 2);
  const double square = (a * a + b * b + c * c + 2.0 * across) / 6.0, p = std::sqrt(square);
  if (!(p > 0.0)) return {std::sqrt(mean), std::sqrt(mean)};
  const double det = a * (b * c - A(1, 2) * A(1, 2)) - A(0, 1) * (A(0, 1) * c - A(1, 2) * A(0, 2)) +
                     A(0, 2) * (A(0, 1) * A(1, 2) - b * A(0, 2));
  constexpr double kThird = 2.0943951023931953;
  const double r = 0.5 * det / (p * square), phi = std::acos(std::clamp(r, -1.0, 1.0)) / 3.0;
  const double most = mean + 2.0 * p * std::cos(phi), least = mean + 2.0 * p * std::cos(phi + kThird);
  // Where two of them are equal the angle is known to half the digits.
  constexpr double kApart = 1e-6;
  if (least > kFew * most && std::abs(r) < 1.0 - kApart) return {std::sqrt(most), std::sqrt(least)};
  const Vector3 sigma = Eigen::JacobiSVD<Matrix3>(jacobian).singularValues();
  return {sigma[0], sigma[2]};
}

}  // namespace

const FigureInfo& figure_info(int index) {
  assert(index >= 0 && index < kFigureCount);
  return kInfo[index];
}

FigureValues jacobian_figures(const Matrix3& jacobian, const DriveLimits& limits) {
  FigureValues values{};
  const auto set = [&values](Figure which, double value) { values[static_cast<int>(which)] = value; };

  const auto [sigma_max, sigma_min] = extreme_singular_values(jacobian);
  set(Figure::condition_number,
      sigma_min > 0.0 ? sigma_max / sigma_min : std::numeric_limits<double>::infinity());
  set(Figure::manipulability, std::abs(jacobian.determinant()));

  // |J_kj| f_k <= limit_j for every joint j.
  const Matrix3 load = jacobian.cwiseAbs() * limits.torque.cwiseInverse().asDiagonal();
  for (int k = 0; k < 3; ++k) values[static_cast<int>(Figure::force_x) + k] = 1.0 / load.row(k).maxCoeff();

  // The polytope |J_j . f| <= limit_j: its faces lie limit_j/|J_j| from the origin, its vertices at J^-T
  // (+-limit).
  set(Figure::weakest_force,
      (limits.torque.array() / jacobian.colwise().norm().transpose().array()).minCoeff());
  const Matrix3 edges = jacobian.inverse().transpose() * limits.torque.asDiagonal();
  double strongest = 0.0;
  for (int signs = 0; signs < 4; ++signs) {
    const Vector3 vertex =
        edges.col(0) + (signs & 1 ? 1.0 : -1.0) * edges.col(1) + (signs & 2 ? 1.0 : -1.0) * edges.col(2);
    strongest = std::max(strongest, vertex.norm());
  }
  set(Figure::strongest_force, sigma_min > 0.0 ? strongest : std::numeric_limits<double>::infinity());

  const Vector3 step = jacobian.cwiseAbs() * limits.step;
  for (int k = 0; k < 3; ++k) values[static_cast<int>(Figure::step_x) + k] = step[k];
  return values;
}

}  // namespace zwidth
