#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <type_traits>

#include "zwidth/math/lanes.h"

namespace zwidth {

/// Splits a small matrix A (3 or 6 rows, at most 8 columns) into what acts and what is left: its
/// pseudo-inverse, for the columns that are independent, and an orthonormal basis N of the rest, N^T A = 0. No
/// heap, noexcept.
///
/// For eliminating the passive joints of a leg many times within one posture: Householder QR of A beside the
/// identity, columns in their own order, so that Q is at hand and later right sides are products only. A column
/// whose remainder is below `kRankTolerance` of the largest column depends on those before it; its unknown is
/// set to 0. Golub & Van Loan 2013, algorithm 5.2.1.
class Elimination {
 public:
  static constexpr int kMaxRows = 6, kMaxColumns = 8;
  static constexpr double kRankTolerance = 1e-10;

  /// Starts a rows x columns matrix of zeros, whose elements the caller then writes through `at`. REQUIRES: 3
  /// or 6 rows, at most 8 columns.
  void resize(int rows, int columns) noexcept {
    assert((rows == 3 || rows == 6) && columns >= 0 && columns <= kMaxColumns);
    rows_ = rows;
    columns_ = columns;
    next_ = 0;
    rank_ = 0;
    with_sizes([this](auto size, auto groups) {
      for (int i = 0; i < size; ++i) {
        for (int g = 0; g < groups; ++g) lanes_at(&a_[i][kLanes * g]) = Lanes{};
        for (int g = 0; kLanes * g < size; ++g) lanes_at(&q_[i][kLanes * g]) = Lanes{};
      }
    });
    for (int i = 0; i < rows; ++i) q_[i][i] = 1.0;
  }
  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  double& at(int row, int column) noexcept { return a_[row][column]; }

  /// Takes in the next column; false if there was none left. Steps of several eliminations taken in turn
  /// overlap, where each alone waits for its own square roots and divisions.
  bool step() noexcept {
    if (next_ == columns_) return false;
    with_sizes([this](auto size, auto groups) { take_in(size, groups); });
    return true;
  }

  /// After the last step: number of independent columns.
  int rank() const noexcept { return rank_; }

  /// After the last step: the least that a column adds to those before it, over the largest column; 0 where one
  /// depends on them, 1 if there is none.
  double independence() const noexcept {
    return columns_ == 0 ? 1.0 : largest_ > 0.0 ? std::sqrt(smallest_ / largest_) : 0.0;
  }

  /// After the last step: finds the pseudo-inverse.
  void finish() noexcept {
    with_sizes([this](auto size, auto) {
      for (int c = 0; c < columns_; ++c) {
        for (int g = 0; kLanes * g < size; ++g) lanes_at(&inverse_[c][kLanes * g]) = Lanes{};
      }
      for (int k = rank_ - 1; k >= 0; --k) {
        for (int g = 0; kLanes * g < size; ++g) {
          Lanes sum = lanes_at(&q_[k][kLanes * g]);
          for (int i = k + 1; i < rank_; ++i)
            sum -= r_[k][column_[i]] * lanes_at(&inverse_[column_[i]][kLanes * g]);
          lanes_at(&inverse_[column_[k]][kLanes * g]) = reciprocal_[k] * sum;
        }
      }
    });
  }
  /// Row of the pseudo-inverse, `rows` long: unknown `column` per right side.
  const std::array<double, 8>& inverse(int column) const noexcept { return inverse_[column]; }

  /// Column i of an orthonormal basis U of A's range, for i < rank.
  const std::array<double, 8>& range(int i) const noexcept { return q_[i]; }

  /// After the last step: 1 or -1 as det[A N], A by its independent columns.
  double orientation() const noexcept {
    double sign = 1.0;  // each reflection counts -1, and -1 over it the sign of its reciprocal
    for (int k = 0; k < rank_; ++k) sign = reciprocal_[k] > 0.0 ? -sign : sign;
    return sign;
  }

  /// Column i of N, for i < rows - rank.
  const std::array<double, 8>& left_over(int i) const noexcept { return q_[rank_ + i]; }

  /// Products with `inverse` and `left_over`: sum over the rows of weights[i] b[i]. Numbers or `Lanes` of
  /// numbers.
  template <class Vector, class Number>
  void product(const std::array<double, 8>& weights, const Vector& b, Number& sum) const noexcept {
    sum = weights[0] * b[0] + weights[1] * b[1] + weights[2] * b[2];
    if (rows_ == 6) sum += weights[3] * b[3] + weights[4] * b[4] + weights[5] * b[5];
  }

 private:
  // Calls `work` with the numbers of rows and of groups of columns as constants, so that loops unroll.
  template <class Work>
  void with_sizes(Work&& work) const noexcept {
    const auto with_groups = [&](auto groups) {
      rows_ == 3 ? work(std::integral_constant<int, 3>(), groups)
                 : work(std::integral_constant<int, 6>(), groups);
    };
    columns_ <= kLanes ? with_groups(std::integral_constant<int, 1>())
                       : with_groups(std::integral_constant<int, 2>());
  }

  template <class Size, class Groups>
  void take_in(Size size, Groups groups) noexcept {
    const int c = next_++, k = rank_;
    if (c == 0) find_largest(size, groups);
    // Rows above k have moved to R and are zero.
    std::array<double, kMaxRows> v;
    double norm2 = 0.0;
    for (int i = 0; i < size; ++i) {
      v[i] = a_[i][c];
      norm2 += v[i] * v[i];
    }
    smallest_ = norm2 < smallest_ ? norm2 : smallest_;
    if (k == rows_ || !(norm2 > kRankTolerance * kRankTolerance * largest_)) return;

    // Reflect the column onto the axis k: v = x - alpha e_k with alpha of the sign opposite to x_k.
    const double norm = std::sqrt(norm2), x = v[k];
    const double alpha = x > 0.0 ? -norm : norm;
    const double scale = 1.0 / (norm2 + norm * std::abs(x));  // 2 / (v.v)
    v[k] = x - alpha;
    reciprocal_[k] = 1.0 / alpha;
    column_[k] = c;
    rank_ = k + 1;
    const auto reflect = [&](auto& rows, int j) {
      Lanes even{}, odd{};
      for (int i = 0; i < size; ++i) (i % 2 == 0 ? even : odd) += v[i] * lanes_at(&rows[i][j]);
      const Lanes factor = scale * (even + odd);
      for (int i = 0; i < size; ++i) lanes_at(&rows[i][j]) -= v[i] * factor;
    };
    for (int g = 0; g < groups; ++g) {
      reflect(a_, kLanes * g);
      lanes_at(&r_[k][kLanes * g]) = lanes_at(&a_[k][kLanes * g]);
      lanes_at(&a_[k][kLanes * g]) = Lanes{};
    }
    for (int g = 0; kLanes * g < size; ++g) reflect(q_, kLanes * g);
  }

  template <class Size, class Groups>
  void find_largest(Size size, Groups groups) noexcept {
    largest_ = 0.0;
    for (int g = 0; g < groups; ++g) {
      Lanes norm2{};
      for (int i = 0; i < size; ++i) norm2 += lanes_at(&a_[i][kLanes * g]) * lanes_at(&a_[i][kLanes * g]);
      for (int lane = 0; lane < kLanes; ++lane) largest_ = norm2[lane] > largest_ ? norm2[lane] : largest_;
    }
    smallest_ = largest_;
  }

  int rows_ = 0;
  int columns_ = 0;
  int next_ = 0;
  int rank_ = 0;
  double largest_ = 0.0;                           // squared norm of the largest column
  double smallest_ = 0.0;                          // of what a column adds to those before it
  std::array<std::array<double, 8>, kMaxRows> a_;  // what is left to take in, by rows
  std::array<std::array<double, 8>, kMaxRows> q_;  // Q^T
  std::array<std::array<double, 8>, kMaxRows> r_;  // R by rows, right of its diagonal
  std::array<double, kMaxRows> reciprocal_;        // of the diagonal
  std::array<int, kMaxRows> column_;               // of each row of R
  std::array<std::array<double, 8>, kMaxColumns> inverse_;
};

}  // namespace zwidth
