#include "zwidth/mechanism/vibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace zwidth {
namespace {

bool symmetric(const ToolMatrix& a) {
  constexpr double kRounding = 1e-9;
  return a.rows() == a.cols() && a.rows() > 0 && a.allFinite() &&
         (a - a.transpose()).cwiseAbs().maxCoeff() <= kRounding * a.cwiseAbs().maxCoeff();
}

// Unit columns, each with the largest of its entries positive, so that equal inputs give equal signs.
void normalise(ToolMatrix& shapes) {
  for (Eigen::Index c = 0; c < shapes.cols(); ++c) {
    Eigen::Index largest = 0;
    shapes.col(c).cwiseAbs().maxCoeff(&largest);
    const double sign = shapes(largest, c) < 0.0 ? -1.0 : 1.0;
    const double norm = shapes.col(c).norm();
    if (norm > 0.0) shapes.col(c) *= sign / norm;
  }
}

}  // namespace

std::optional<Modes> modes(const ToolMatrix& stiffness, const ToolMatrix& mass) noexcept {
  if (!symmetric(stiffness) || !symmetric(mass) || stiffness.rows() != mass.rows()) return std::nullopt;
  const Eigen::LLT<ToolMatrix> factored(mass);
  if (factored.info() != Eigen::Success) return std::nullopt;
  const Eigen::Index n = mass.rows();
  return modes_by_mobility(stiffness, factored.solve(ToolMatrix::Identity(n, n)));
}

std::optional<Modes> modes_by_mobility(const ToolMatrix& stiffness, const ToolMatrix& mobility) noexcept {
  if (!symmetric(stiffness) || !symmetric(mobility) || stiffness.rows() != mobility.rows()) return std::nullopt;
  // With K = L L^T the problem is that of the symmetric L^T W L.
  const Eigen::LLT<ToolMatrix> factored(stiffness);
  if (factored.info() != Eigen::Success) return std::nullopt;
  const ToolMatrix L = factored.matrixL();
  ToolMatrix A = L.transpose() * mobility * L;
  A = 0.5 * (A + A.transpose()).eval();
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(A);
  constexpr double kRounding = 1e-12;
  const double largest = eigen.eigenvalues().maxCoeff();
  if (eigen.info() != Eigen::Success || !(largest > 0.0) || eigen.eigenvalues()[0] < -kRounding * largest)
    return std::nullopt;
  Modes result;
  result.frequencies = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  // phi = L^-T y
  result.shapes = L.transpose().template triangularView<Eigen::Upper>().solve(eigen.eigenvectors());
  normalise(result.shapes);
  return result;
}

ToolMatrix dynamic_matrix(const ToolMatrix& stiffness, const ToolMatrix& mass) noexcept {
  return mass.ldlt().solve(stiffness);
}

ToolMatrix tool_mobility(const Jacobian& jacobian, const ActiveMatrix& mass) noexcept {
  const Jacobian moved = mass.ldlt().solve(jacobian.transpose()).transpose();
  const ToolMatrix W = moved.lazyProduct(jacobian.transpose());
  return 0.5 * (W + W.transpose());
}

}  // namespace zwidth
