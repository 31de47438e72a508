#include "zwidth/mechanism/internal/closure.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zwidth::internal {

ZWIDTH_WIDE void Closure::factor(const Posture& posture) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  leg_count_ = static_cast<int>(mechanism.legs().size());
  tool_rows_ = mechanism.tool_rows();
  linear_rows_ = mechanism.linear_rows();
  length_ = mechanism.characteristic_length();

  for (int l = 0; l < leg_count_; ++l) {
    const LegModel& model = mechanism.legs()[l];
    Leg& leg = legs_[l];
    int columns = 0;
    for (int j = model.first; j < model.first + model.count; ++j) {
      if (mechanism.joints()[j].active < 0) leg.joints[columns++] = j;
    }
    leg.passive.resize(closure_rows(model), columns);
    std::array<double, 6> column;
    for (int c = 0; c < columns; ++c) {
      closure_column(posture, l, leg.joints[c], column);
      for (int i = 0; i < leg.passive.rows(); ++i) leg.passive.at(i, c) = column[i];
    }
    platform_columns(posture, l, leg.platform);
  }

  for (bool more = true; more;) {
    more = false;
    for (int l = 0; l < leg_count_; ++l) more |= legs_[l].passive.step();
  }
  int left_over = 0;
  for (int l = 0; l < leg_count_; ++l) {
    legs_[l].passive.finish();
    left_over += legs_[l].left_over();
  }

  platform_.resize(left_over, tool_rows_);
  int row = 0;
  for (int l = 0; l < leg_count_; ++l) {
    const Leg& leg = legs_[l];
    for (int i = 0; i < leg.left_over(); ++i, ++row) {
      for (int c = 0; c < tool_rows_; ++c)
        leg.passive.product(leg.passive.left_over(i), leg.platform[c], platform_.at(row, c));
    }
  }
  platform_.factor();
}

int Closure::sign() const noexcept {
  if (direct_condition() <= kSingular) return 0;
  double sign = platform_.determinant_sign();
  for (int l = 0; l < leg_count_; ++l) sign *= legs_[l].passive.orientation();
  return static_cast<int>(sign);
}

namespace {

// The sign of the determinant of the first n rows and columns, by elimination with partial pivoting.
template <std::size_t Size>
double determinant_sign(std::array<std::array<double, Size>, Size>& a, int n) {
  double sign = 1.0;
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int i = k + 1; i < n; ++i) best = std::abs(a[i][k]) > std::abs(a[best][k]) ? i : best;
    if (a[best][k] == 0.0) return 0.0;
    if (best != k) {
      std::swap(a[k], a[best]);
      sign = -sign;
    }
    if (a[k][k] < 0.0) sign = -sign;
    for (int i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (int j = k + 1; j < n; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  return sign;
}

}  // namespace

int Closure::sign_against(const Closure& other) const noexcept {
  if (sign() != 0 && other.sign() != 0) return sign() * other.sign();
  // With U R the passive columns of a leg and C = N N^T B what they leave of the platform's, det(M^T M') is
  // next to det(sum C^T C') times each leg's det(R) det(U^T U') det(R').
  double product = 1.0;
  std::array<std::array<double, 6>, 6> platform{};
  for (int l = 0; l < leg_count_; ++l) {
    const Leg &a = legs_[l], &b = other.legs_[l];
    const int rank = a.passive.rank();
    if (rank != b.passive.rank()) return 0;
    std::array<std::array<double, 6>, 6> range;
    for (int i = 0; i < rank; ++i) {
      for (int j = 0; j < rank; ++j) a.passive.product(a.passive.range(i), b.passive.range(j), range[i][j]);
    }
    product *= determinant_sign(range, rank) * a.passive.orientation() * b.passive.orientation();
    for (int i = 0; i < a.left_over(); ++i) {
      for (int j = 0; j < b.left_over(); ++j) {
        double across;
        a.passive.product(a.passive.left_over(i), b.passive.left_over(j), across);
        for (int c = 0; c < tool_rows_; ++c) {
          double left;
          a.passive.product(a.passive.left_over(i), a.platform[c], left);
          for (int d = 0; d < tool_rows_; ++d) {
            double right;
            b.passive.product(b.passive.left_over(j), b.platform[d], right);
            platform[c][d] += left * across * right;
          }
        }
      }
    }
  }
  return static_cast<int>(product * determinant_sign(platform, tool_rows_));
}

ZWIDTH_WIDE double Closure::drive_condition(const Posture& posture) const noexcept {
  const Mechanism& mechanism = posture.mechanism();
  SmallQr<6 * kMaxLegs, kMaxActive> drive;
  drive.resize(platform_.rows(), mechanism.active_count());
  int first = 0;
  double longest = 0.0;  // lever of an active joint, squared
  for (int l = 0; l < leg_count_; ++l) {
    const Leg& leg = legs_[l];
    const LegModel& model = mechanism.legs()[l];
    for (int j = model.first; j < model.first + model.count; ++j) {
      const int a = mechanism.joints()[j].active;
      if (a < 0) continue;
      std::array<double, 6> column;
      closure_column(posture, l, j, column);
      double lever = 0.0;
      for (int i = 0; i < leg.passive.rows(); ++i) lever += column[i] * column[i];
      longest = std::max(longest, lever);
      for (int i = 0; i < leg.left_over(); ++i)
        leg.passive.product(leg.passive.left_over(i), column, drive.at(first + i, a));
    }
    first += leg.left_over();
  }
  drive.factor();
  return longest > 0.0 ? drive.smallest_pivot() / std::sqrt(longest) : 0.0;
}

ZWIDTH_WIDE Rates rates_of(const Posture& posture, const Closure& closure) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  Rates result;
  result.tool.setZero(mechanism.tool_rows(), mechanism.active_count());
  result.joints.setZero(mechanism.joint_count(), mechanism.active_count());
  result.closure = closure.reciprocal_condition();
  // Four active joints at a time, each in a lane of its own.
  for (int first = 0; first < mechanism.active_count(); first += kLanes) {
    const int count = std::min(kLanes, mechanism.active_count() - first);
    ClosureRows<Lanes> w{};
    for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
      const LegModel& leg = mechanism.legs()[l];
      for (int j = leg.first; j < leg.first + leg.count; ++j) {
        const int a = mechanism.joints()[j].active, lane = a - first;
        if (a < first || lane >= count) continue;
        std::array<double, 6> column;
        closure_column(posture, l, j, column);
        for (int i = 0; i < closure_rows(leg); ++i) w[l][i][lane] = column[i];
        result.joints(j, a) = 1.0;
      }
    }
    std::array<Lanes, 6> twist;
    closure.solve(w, twist, [&](int j, const Lanes& rate) {
      for (int lane = 0; lane < count; ++lane) result.joints(j, first + lane) = rate[lane];
    });
    for (int r = 0; r < mechanism.tool_rows(); ++r) {
      for (int lane = 0; lane < count; ++lane) result.tool(r, first + lane) = twist[r][lane];
    }
  }
  return result;
}

}  // namespace zwidth::internal
