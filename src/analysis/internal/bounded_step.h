#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <vector>

#include "zwidth/mechanism/mechanism.h"

namespace zwidth::internal {

/// Newton steps of an arm with its joints in their ranges.
class BoundedStep {
 public:
  explicit BoundedStep(const Mechanism& mechanism) {
    for (int j = 0; j < mechanism.active_count(); ++j) {
      ranges_.push_back(mechanism.active_range(j));
      weights_.push_back(ranges_.back().width() * ranges_.back().width());
    }
  }

  /// Moves the joints by the step dq of least weighted length for which the first kRows rows of J dq are `gap`.
  /// Joints that would leave their ranges stay at the end, and the others do their share. False where no joint
  /// can help. REQUIRES: rows of one unit.
  template <int kRows>
  bool take(const Jacobian& J, Eigen::Matrix<double, kRows, 1> gap, ActiveVector& q) const noexcept {
    using Column = Eigen::Matrix<double, kRows, 1>;
    const auto n = static_cast<int>(ranges_.size());
    const auto column = [&J](int j) { return J.col(j).template head<kRows>(); };
    unsigned held = 0;
    for (int pass = 0; pass < n; ++pass) {
      Eigen::Matrix<double, kRows, kRows> A = Eigen::Matrix<double, kRows, kRows>::Zero();
      for (int j = 0; j < n; ++j) {
        if ((held >> j & 1U) != 0) continue;
        A.noalias() += weights_[static_cast<std::size_t>(j)] * column(j) * column(j).transpose();
      }
      const double scale = A.trace();
      if (!(scale > 0.0)) return false;
      A.diagonal().array() += 1e-9 * scale;
      Column pull;
      if constexpr (kRows <= 3) {
        pull.noalias() = A.inverse() * gap;
      } else {
        pull = A.llt().solve(gap);
      }
      // The first joints that would leave their ranges are put at the end, and the step is asked for anew.
      unsigned leaving = 0;
      std::array<double, kMaxActive> change{};
      for (int j = 0; j < n; ++j) {
        if ((held >> j & 1U) != 0) continue;
        change[j] = weights_[static_cast<std::size_t>(j)] * column(j).dot(pull);
        const Interval& range = ranges_[static_cast<std::size_t>(j)];
        if (q[j] + change[j] < range.min || q[j] + change[j] > range.max) leaving |= 1U << j;
      }
      for (int j = 0; j < n; ++j) {
        const Interval& range = ranges_[static_cast<std::size_t>(j)];
        if (leaving == 0) {
          q[j] = std::clamp(q[j] + change[j], range.min, range.max);
        } else if ((leaving >> j & 1U) != 0) {
          const double end = q[j] + change[j] < range.min ? range.min : range.max;
          gap -= column(j) * (end - q[j]);
          q[j] = end;
        }
      }
      if (leaving == 0) return true;
      held |= leaving;
    }
    return true;
  }

 private:
  std::vector<Interval> ranges_;
  std::vector<double> weights_;  // squared widths of the ranges: joints of either kind then compare
};

}  // namespace zwidth::internal
