#pragma once

#include <array>
#include <cassert>
#include <cmath>

namespace zwidth {

/// Column-pivoted Householder QR of a small matrix, A P = Q R, with storage inside the object (no heap,
/// noexcept).
///
/// For the loop closures of mechanisms: a few rows and columns, rank that may drop at a singularity.
/// Columns whose remainder is below `kRankTolerance` of the largest are left out of the rank.
/// Golub & Van Loan 2013, algorithms 5.1.1 and 5.4.1.
template <int MaxRows, int MaxColumns>
class SmallQr {
 public:
  static constexpr double kRankTolerance = 1e-10;

  /// Starts a rows x columns matrix, whose elements the caller then writes through `at`. REQUIRES: within the
  /// maxima.
  void resize(int rows, int columns) noexcept {
    assert(rows >= 0 && rows <= MaxRows && columns >= 0 && columns <= MaxColumns);
    rows_ = rows;
    columns_ = columns;
    rank_ = 0;
  }
  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }

  /// Element before `factor`.
  double& at(int row, int column) noexcept { return a_[column][row]; }

  /// Factors what `at` wrote, in place.
  void factor() noexcept {
    for (int j = 0; j < columns_; ++j) pivot_[j] = j;
    const int steps = rows_ < columns_ ? rows_ : columns_;
    double largest = 0.0;
    rank_ = 0;
    for (int k = 0; k < steps; ++k) {
      int best = k;
      double best_norm2 = -1.0;
      for (int j = k; j < columns_; ++j) {
        const double norm2 = dot(a_[j], a_[j], k);
        if (norm2 > best_norm2) {
          best_norm2 = norm2;
          best = j;
        }
      }
      if (k == 0) largest = best_norm2;
      if (!(best_norm2 > kRankTolerance * kRankTolerance * largest)) break;
      if (best != k) {
        std::swap(a_[k], a_[best]);
        std::swap(pivot_[k], pivot_[best]);
      }
      // Reflect column k onto the axis k: v = x - alpha e_k with alpha of the sign opposite to x_k.
      std::array<double, MaxRows>& v = a_[k];
      const double norm = std::sqrt(best_norm2);
      const double alpha = v[k] > 0.0 ? -norm : norm;
      v[k] -= alpha;
      scale_[k] = -1.0 / (alpha * v[k]);  // 2 / (v.v)
      diagonal_[k] = alpha;
      for (int j = k + 1; j < columns_; ++j) reflect(k, a_[j]);
      ++rank_;
    }
  }

  /// Rank found.
  int rank() const noexcept { return rank_; }
  /// Smallest over largest pivot, an estimate of 1/cond(A); 0 if the rank is not full, 1 if there is no column.
  double reciprocal_condition() const noexcept {
    const int full = rows_ < columns_ ? rows_ : columns_;
    if (rank_ < full) return 0.0;
    return full == 0 ? 1.0 : std::abs(diagonal_[full - 1] / diagonal_[0]);
  }

  /// Smallest pivot, about the smallest singular value; 0 if the rank is not full.
  double smallest_pivot() const noexcept {
    const int full = rows_ < columns_ ? rows_ : columns_;
    return rank_ < full || full == 0 ? 0.0 : std::abs(diagonal_[full - 1]);
  }

  /// b <- Q^T b; b has `rows` elements.
  template <class Vector>
  void apply_q_transposed(Vector& b) const noexcept {
    for (int k = 0; k < rank_; ++k) reflect(k, b);
  }

  /// Given y = Q^T b, the x with `columns` elements that minimises |A x - b|; columns left out of the rank get
  /// 0.
  template <class Y, class X>
  void back_substitute(const Y& y, X& x) const noexcept {
    for (int j = rank_; j < columns_; ++j) x[pivot_[j]] = 0.0;
    std::array<double, MaxColumns> z;
    for (int i = rank_ - 1; i >= 0; --i) {
      double sum = y[i];
      for (int j = i + 1; j < rank_; ++j) sum -= a_[j][i] * z[j];
      z[i] = sum / diagonal_[i];
      x[pivot_[i]] = z[i];
    }
  }

  /// The shortest x (`rows` elements) with A^T x = b (`columns` elements), if A has full column rank;
  /// with a lower rank, the equations left out of it are not met.
  template <class B, class X>
  void solve_transposed(const B& b, X& x) const noexcept {
    // A^T = P R^T Q^T: forward-substitute R^T z = P^T b, then x = Q [z; 0].
    for (int i = 0; i < rows_; ++i) x[i] = 0.0;
    for (int i = 0; i < rank_; ++i) {
      double sum = b[pivot_[i]];
      for (int j = 0; j < i; ++j) sum -= a_[i][j] * x[j];
      x[i] = sum / diagonal_[i];
    }
    for (int k = rank_ - 1; k >= 0; --k) reflect(k, x);
  }

 private:
  template <class Left, class Right>
  double dot(const Left& left, const Right& right, int from) const noexcept {
    double sum = 0.0;
    for (int i = from; i < rows_; ++i) sum += left[i] * right[i];
    return sum;
  }
  template <class Vector>
  void reflect(int k, Vector& b) const noexcept {
    const double factor = scale_[k] * dot(a_[k], b, k);
    for (int i = k; i < rows_; ++i) b[i] -= factor * a_[k][i];
  }

  int rows_ = 0;
  int columns_ = 0;
  int rank_ = 0;
  // Column j holds R above the diagonal and Householder vector j from the diagonal down.
  std::array<std::array<double, MaxRows>, MaxColumns> a_;
  std::array<double, MaxColumns> diagonal_;
  std::array<double, MaxColumns> scale_;
  std::array<int, MaxColumns> pivot_;
};

}  // namespace zwidth
