#pragma once

#include <array>

#include "zwidth/math/small_qr.h"
#include "zwidth/mechanism/internal/posture_builder.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth::internal {

/// One right-hand side of the closure equations: `rows` values for each leg.
using ClosureVector = std::array<std::array<double, 6>, kMaxLegs>;

/// The linearised loop closure of a posture, factored once for any number of right-hand sides.
///
/// For each leg, with passive rates q_p, platform twist x (angular part times the characteristic length) and
/// any known velocity w of its tip:  A q_p + w - B x = 0.  A QR of each leg's A eliminates q_p; what remains of
/// all legs, K x = k, is solved for x by a second one. Rows may outnumber unknowns (overconstrained
/// mechanisms): the least-squares answer is exact whenever the equations agree. No heap.
class Closure {
 public:
  Closure() = default;
  explicit Closure(const Posture& posture) noexcept { factor(posture); }

  /// The passive joints' frames, legs and platform of `posture` are taken as they are, closed or not.
  void factor(const Posture& posture) noexcept;

  /// Platform twist and passive rates (active entries of `rates` are left as they are) for tip velocities `w`.
  template <class ToolRates, class JointRates>
  void solve(const ClosureVector& w, ToolRates&& twist, JointRates&& rates) const noexcept {
    std::array<double, 6 * kMaxLegs> k;
    ClosureVector y = w;
    int row = 0;
    for (int l = 0; l < leg_count_; ++l) {
      legs_[l].passive.apply_q_transposed(y[l]);
      for (int i = legs_[l].passive.rank(); i < legs_[l].rows; ++i) k[row++] = y[l][i];
    }
    std::array<double, 6> x;
    platform_.apply_q_transposed(k);
    platform_.back_substitute(k, x);
    for (int l = 0; l < leg_count_; ++l) {
      const Leg& leg = legs_[l];
      for (int i = 0; i < leg.passive.rank(); ++i) {
        double sum = -y[l][i];
        for (int c = 0; c < tool_rows_; ++c) sum += leg.platform[c][i] * x[c];
        y[l][i] = sum;
      }
      std::array<double, kMaxLegJoints> passive;
      leg.passive.back_substitute(y[l], passive);
      for (int c = 0; c < leg.passive.columns(); ++c) rates[leg.joints[c]] = passive[c];
    }
    for (int c = 0; c < tool_rows_; ++c) twist[c] = c < linear_rows_ ? x[c] : x[c] / length_;
  }

  /// Reciprocal condition of K: 0 where the platform keeps a freedom with all active joints locked.
  double reciprocal_condition() const noexcept { return platform_.reciprocal_condition(); }

  /// Smallest singular value of H in K x = H qdot, with qdot the active rates, over the longest lever of an
  /// active joint: 0 where some of them do not move the platform, however equal the others are. REQUIRES: the
  /// posture that was factored, or one next to it.
  double drive_condition(const Posture& posture) const noexcept;

 private:
  struct Leg {
    int rows = 0;
    SmallQr<6, kMaxLegJoints> passive;              // A
    std::array<int, kMaxLegJoints> joints;          // of A's columns
    std::array<std::array<double, 6>, 6> platform;  // Q^T B, by columns
  };

  int leg_count_ = 0;
  int tool_rows_ = 0;
  int linear_rows_ = 0;  // of them
  double length_ = 1.0;
  std::array<Leg, kMaxLegs> legs_;
  SmallQr<6 * kMaxLegs, 6> platform_;  // K
};

/// Rates from a factored closure.
Rates rates_of(const Posture& posture, const Closure& closure) noexcept;

}  // namespace zwidth::internal
