#include "zwidth/math/svd.h"

#include <Eigen/SVD>

namespace zwidth {

Svd svd(const SmallMatrix& a) {
  const Eigen::JacobiSVD<SmallMatrix> jacobi(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {jacobi.matrixU(), jacobi.singularValues(), jacobi.matrixV()};
}

SmallMatrix pseudo_inverse(const SmallMatrix& a, double tolerance) {
  const Svd parts = svd(a);
  SmallMatrix inverse = SmallMatrix::Zero(a.cols(), a.rows());
  for (Eigen::Index i = 0; i < parts.sigma.size() && parts.sigma[i] > tolerance * parts.sigma[0]; ++i) {
    inverse += parts.v.col(i).lazyProduct(parts.u.col(i).transpose()) / parts.sigma[i];
  }
  return inverse;
}

}  // namespace zwidth
