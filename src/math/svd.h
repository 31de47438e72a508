#pragma once

#include <Eigen/Core>

namespace zwidth {

/// A matrix of at most 8 x 8 with storage inside the object.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;

/// A = U diag(sigma) V^T: U is rows x rows, sigma has min(rows, columns) values, largest first.
struct Svd {
  SmallMatrix u;
  SmallVector sigma;
  SmallMatrix v;
};

/// Singular value decomposition (two-sided Jacobi, accurate for small singular values too).
Svd svd(const SmallMatrix& a);

/// Moore-Penrose inverse; singular values below `tolerance` times the largest count as zero.
SmallMatrix pseudo_inverse(const SmallMatrix& a, double tolerance = 1e-12);

}  // namespace zwidth
