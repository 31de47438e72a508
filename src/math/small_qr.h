#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <type_traits>
#include <utility>

#include "zwidth/math/lanes.h"

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

  /// Starts a rows x columns matrix of zeros, whose elements the caller then writes through `at`. REQUIRES:
  /// within the maxima.
  void resize(int rows, int columns) noexcept {
    assert(rows >= 0 && rows <= MaxRows && columns >= 0 && columns <= MaxColumns);
    rows_ = rows;
    columns_ = columns;
    rank_ = 0;
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; j += kLanes) lanes_at(&a_[i][j]) = Lanes{};
    }
  }
  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }

  /// Element before `factor`.
  double& at(int row, int column) noexcept { return a_[row][column]; }

  /// Factors what `at` wrote, in place.
  void factor() noexcept {
    with_sizes([this](auto rows, auto width) { this->factor_sizes(rows, width); });
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

  /// 1 or -1 as det(A); 0 if A is not square or its rank not full.
  double determinant_sign() const noexcept {
    if (rows_ != columns_ || rank_ < columns_) return 0.0;
    double sign = 1.0;
    std::array<int, MaxColumns> place = pivot_;
    for (int k = 0; k < columns_; ++k) {
      if (diagonal_[k] > 0.0) sign = -sign;  // a reflection counts -1
      for (; place[k] != k; sign = -sign) std::swap(place[k], place[place[k]]);
    }
    return sign;
  }

  /// b <- Q^T b; b has `rows` elements, numbers or `Lanes` of numbers.
  template <class Vector>
  void apply_q_transposed(Vector& b) const noexcept {
    with_rows([&](auto rows) {
      for (int k = 0; k < rank_; ++k) reflect(rows, k, b);
    });
  }

  /// Given y = Q^T b, the x with `columns` elements that minimises |A x - b|; columns left out of the rank get
  /// 0. Numbers or `Lanes` of numbers.
  template <class Y, class X>
  void back_substitute(const Y& y, X& x) const noexcept {
    using Element = std::remove_cvref_t<decltype(x[0])>;
    for (int j = rank_; j < columns_; ++j) x[pivot_[j]] = Element{};
    for (int i = rank_ - 1; i >= 0; --i) {
      Element sum = y[i];
      for (int j = i + 1; j < rank_; ++j) sum -= r_[i][pivot_[j]] * x[pivot_[j]];
      x[pivot_[i]] = reciprocal_[i] * sum;
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
      for (int j = 0; j < i; ++j) sum -= r_[j][pivot_[i]] * x[j];
      x[i] = sum * reciprocal_[i];
    }
    with_rows([&](auto rows) {
      for (int k = rank_ - 1; k >= 0; --k) reflect(rows, k, x);
    });
  }

 private:
  // Calls `work` with the number of rows and of columns in whole lanes: as constants where they are those of
  // most closures, so that loops unroll.
  template <class Work>
  void with_sizes(Work&& work) const noexcept {
    with_rows([&](auto rows) {
      if (columns_ <= kLanes) return work(rows, std::integral_constant<int, kLanes>());
      work(rows, whole_lanes(columns_));
    });
  }
  template <class Work>
  void with_rows(Work&& work) const noexcept {
    if constexpr (MaxRows >= 3) {
      if (rows_ == 3) return work(std::integral_constant<int, 3>());
    }
    if constexpr (MaxRows >= 6) {
      if (rows_ == 6) return work(std::integral_constant<int, 6>());
    }
    work(rows_);
  }

  template <class Rows, class Width>
  void factor_sizes(Rows rows, Width width) noexcept {
    std::array<bool, MaxColumns> used{};
    const int steps = rows < columns_ ? rows : columns_;
    double largest = 0.0;
    for (rank_ = 0; rank_ < steps; ++rank_) {
      const int k = rank_;
      // Rows above k have moved to R and are zero, and so are columns that are done, but for rounding.
      std::array<double, kWidth> norms2{};
      for (int j = 0; j < width; j += kLanes) {
        Lanes even{}, odd{};
        for (int i = 0; i < rows; ++i) {
          const Lanes x = lanes_at(&a_[i][j]);
          (i % 2 == 0 ? even : odd) += x * x;
        }
        lanes_at(&norms2[j]) = even + odd;
      }
      int best = 0;
      for (int j = 1; j < columns_; ++j) best = norms2[j] > norms2[best] ? j : best;
      if (k == 0) largest = norms2[best];
      if (!(norms2[best] > kRankTolerance * kRankTolerance * largest)) break;
      pivot_[k] = best;
      used[best] = true;

      // Reflect that column onto the axis k: v = x - alpha e_k with alpha of the sign opposite to x_k.
      std::array<double, MaxRows>& v = v_[k];
      for (int i = 0; i < rows; ++i) v[i] = a_[i][best];
      const double norm = std::sqrt(norms2[best]);
      const double alpha = v[k] > 0.0 ? -norm : norm;
      scale_[k] = 1.0 / (norms2[best] + norm * std::abs(v[k]));  // 2 / (v.v)
      diagonal_[k] = alpha;
      reciprocal_[k] = 1.0 / alpha;
      v[k] -= alpha;
      for (int j = 0; j < width; j += kLanes) {
        Lanes even{}, odd{};
        for (int i = 0; i < rows; ++i) (i % 2 == 0 ? even : odd) += v[i] * lanes_at(&a_[i][j]);
        const Lanes factor = scale_[k] * (even + odd);
        for (int i = 0; i < rows; ++i) lanes_at(&a_[i][j]) -= v[i] * factor;
        lanes_at(&r_[k][j]) = lanes_at(&a_[k][j]);
        lanes_at(&a_[k][j]) = Lanes{};
      }
    }
    for (int j = 0, next = rank_; j < columns_; ++j) {
      if (!used[j]) pivot_[next++] = j;
    }
  }

  template <class Rows, class Vector>
  void reflect(Rows rows, int k, Vector& b) const noexcept {
    std::remove_cvref_t<decltype(b[0])> even{}, odd{};
    for (int i = 0; i < rows; ++i) (i % 2 == 0 ? even : odd) += v_[k][i] * b[i];
    even += odd;
    even *= scale_[k];
    for (int i = 0; i < rows; ++i) b[i] -= v_[k][i] * even;
  }

  static constexpr int whole_lanes(int columns) { return (columns + kLanes - 1) / kLanes * kLanes; }
  static constexpr int kWidth = whole_lanes(MaxColumns);
  static constexpr int kSteps = MaxRows < MaxColumns ? MaxRows : MaxColumns;

  int rows_ = 0;
  int columns_ = 0;
  int rank_ = 0;
  std::array<std::array<double, kWidth>, MaxRows> a_;  // what is left to factor, by rows
  std::array<std::array<double, kWidth>, kSteps> r_;   // rows of R above its diagonal, columns as given
  std::array<std::array<double, MaxRows>, kSteps> v_;  // Householder vectors, zero above the diagonal
  std::array<double, kSteps> diagonal_;
  std::array<double, kSteps> reciprocal_;  // of the diagonal
  std::array<double, kSteps> scale_;
  std::array<int, MaxColumns> pivot_;  // columns in the order of their steps, then those left out
};

}  // namespace zwidth
