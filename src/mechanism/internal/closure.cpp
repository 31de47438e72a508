#include "zwidth/mechanism/internal/closure.h"

#include <algorithm>
#include <cmath>

namespace zwidth::internal {

void Closure::factor(const Posture& posture) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  leg_count_ = static_cast<int>(mechanism.legs().size());
  tool_rows_ = mechanism.tool_rows();
  linear_rows_ = mechanism.linear_rows();
  length_ = mechanism.characteristic_length();

  int left_over = 0;
  for (int l = 0; l < leg_count_; ++l) {
    const LegModel& model = mechanism.legs()[l];
    Leg& leg = legs_[l];
    leg.rows = closure_rows(model);
    int columns = 0;
    for (int j = model.first; j < model.first + model.count; ++j) {
      if (mechanism.joints()[j].active < 0) leg.joints[columns++] = j;
    }
    leg.passive.resize(leg.rows, columns);
    std::array<double, 6> column;
    for (int c = 0; c < columns; ++c) {
      closure_column(posture, l, leg.joints[c], column);
      for (int i = 0; i < leg.rows; ++i) leg.passive.at(i, c) = column[i];
    }
    leg.passive.factor();
    platform_columns(posture, l, leg.platform);
    for (int c = 0; c < tool_rows_; ++c) leg.passive.apply_q_transposed(leg.platform[c]);
    left_over += leg.rows - leg.passive.rank();
  }

  platform_.resize(left_over, tool_rows_);
  int row = 0;
  for (int l = 0; l < leg_count_; ++l) {
    for (int i = legs_[l].passive.rank(); i < legs_[l].rows; ++i, ++row) {
      for (int c = 0; c < tool_rows_; ++c) platform_.at(row, c) = legs_[l].platform[c][i];
    }
  }
  platform_.factor();
}

double Closure::drive_condition(const Posture& posture) const noexcept {
  const Mechanism& mechanism = posture.mechanism();
  SmallQr<6 * kMaxLegs, kMaxActive> drive;
  drive.resize(platform_.rows(), mechanism.active_count());
  int first = 0;
  double longest = 0.0;  // lever of an active joint, squared
  for (int l = 0; l < leg_count_; ++l) {
    const Leg& leg = legs_[l];
    const int rank = leg.passive.rank(), left_over = leg.rows - rank;
    const LegModel& model = mechanism.legs()[l];
    for (int j = model.first; j < model.first + model.count; ++j) {
      const int a = mechanism.joints()[j].active;
      if (a < 0) continue;
      std::array<double, 6> column;
      closure_column(posture, l, j, column);
      double lever = 0.0;
      for (int i = 0; i < leg.rows; ++i) lever += column[i] * column[i];
      longest = std::max(longest, lever);
      leg.passive.apply_q_transposed(column);
      for (int i = 0; i < platform_.rows(); ++i) drive.at(i, a) = 0.0;
      for (int i = 0; i < left_over; ++i) drive.at(first + i, a) = column[rank + i];
    }
    first += left_over;
  }
  drive.factor();
  return longest > 0.0 ? drive.smallest_pivot() / std::sqrt(longest) : 0.0;
}

Rates rates_of(const Posture& posture, const Closure& closure) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  Rates result;
  result.tool.setZero(mechanism.tool_rows(), mechanism.active_count());
  result.joints.setZero(mechanism.joint_count(), mechanism.active_count());
  result.closure = closure.reciprocal_condition();
  ClosureVector w{};
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const int a = mechanism.joints()[j].active;
      if (a < 0) continue;
      closure_column(posture, l, j, w[l]);
      result.joints(j, a) = 1.0;
      closure.solve(w, result.tool.col(a), result.joints.col(a));
      w[l].fill(0.0);
    }
  }
  return result;
}

}  // namespace zwidth::internal
