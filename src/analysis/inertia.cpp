#include "zwidth/analysis/inertia.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cassert>

namespace zwidth {

double apparent_mass(const ToolMatrix& cartesian_mass, const ToolVector& direction) {
  assert(direction.size() == cartesian_mass.rows());
  const ToolVector u = direction.normalized();
  return 1.0 / u.dot(cartesian_mass.ldlt().solve(u));
}

ApparentMass apparent_mass(const ToolMatrix& cartesian_mass) {
  const auto n = cartesian_mass.rows();
  ApparentMass mass;
  mass.along_axes.resize(n);
  const Eigen::LDLT<ToolMatrix> factors(cartesian_mass);
  for (Eigen::Index k = 0; k < n; ++k) {
    const ToolVector u = ToolVector::Unit(n, k);
    mass.along_axes[k] = 1.0 / u.dot(factors.solve(u));
  }
  // 1/(u^T Lambda^-1 u) is extreme along the eigenvectors, where it is the eigenvalue.
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(cartesian_mass);
  mass.lightest = eigen.eigenvalues()[0];
  mass.heaviest = eigen.eigenvalues()[n - 1];
  mass.lightest_direction = eigen.eigenvectors().col(0);
  mass.heaviest_direction = eigen.eigenvectors().col(n - 1);
  return mass;
}

}  // namespace zwidth
