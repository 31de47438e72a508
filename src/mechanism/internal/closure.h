#pragma once

#include <algorithm>
#include <array>

#include "zwidth/math/elimination.h"
#include "zwidth/math/small_qr.h"
#include "zwidth/mechanism/internal/posture_builder.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth::internal {

/// A right-hand side of the closure equations, `rows` values for each leg; or several, in the lanes of `Lanes`.
template <class Number>
using ClosureRows = std::array<std::array<Number, 6>, kMaxLegs>;
using ClosureVector = ClosureRows<double>;

/// The linearised loop closure of a posture, factored once for any number of right-hand sides.
///
/// For each leg, with passive rates q_p, platform twist x (angular part times the characteristic length) and
/// any known velocity w of its tip:  A q_p + w - B x = 0.  A QR of each leg's A eliminates q_p: with N the
/// wrenches that no passive joint feels (N^T A = 0),  N^T B x = N^T w.  Of all legs together, K x = k, that is
/// solved for x by a second QR. Rows may outnumber unknowns (overconstrained mechanisms): the least-squares
/// answer is exact whenever the equations agree. No heap.
class Closure {
 public:
  Closure() = default;
  explicit Closure(const Posture& posture) noexcept { factor(posture); }

  /// The passive joints' frames, legs and platform of `posture` are taken as they are, closed or not.
  void factor(const Posture& posture) noexcept;

  /// Platform twist and passive rates for tip velocities `w`; `passive(j, rate)` is called with each passive
  /// joint's.
  template <class Number, class Passive>
  void solve(const ClosureRows<Number>& w, std::array<Number, 6>& twist, Passive&& passive) const noexcept {
    std::array<Number, 6 * kMaxLegs> k;
    int row = 0;
    for (int l = 0; l < leg_count_; ++l) {
      const Leg& leg = legs_[l];
      for (int i = 0; i < leg.left_over(); ++i) leg.passive.product(leg.passive.left_over(i), w[l], k[row++]);
    }
    std::array<Number, 6>& x = twist;
    platform_.apply_q_transposed(k);
    platform_.back_substitute(k, x);
    for (int l = 0; l < leg_count_; ++l) {
      const Leg& leg = legs_[l];
      std::array<Number, 6> y{};
      for (int i = 0; i < leg.passive.rows(); ++i) y[i] = -w[l][i];
      for (int c = 0; c < tool_rows_; ++c) {
        for (int i = 0; i < leg.passive.rows(); ++i) y[i] += leg.platform[c][i] * x[c];
      }
      for (int c = 0; c < leg.passive.columns(); ++c) {
        Number rate;
        leg.passive.product(leg.passive.inverse(c), y, rate);
        passive(leg.joints[c], rate);
      }
    }
    for (int c = linear_rows_; c < tool_rows_; ++c) x[c] /= length_;
  }

  /// Reciprocal condition of K: 0 where the platform keeps a freedom with all active joints locked.
  double reciprocal_condition() const noexcept { return platform_.reciprocal_condition(); }

  /// The least of the legs' independence of passive joints: 0 where those of one leg depend on each other, as
  /// when it is stretched out, so that the leg bars the platform one way.
  double passive_condition() const noexcept {
    double least = 1.0;
    for (int l = 0; l < leg_count_; ++l) least = std::min(least, legs_[l].passive.independence());
    return least;
  }

  /// 1 or -1 as the determinant of the equations in passive rates and platform twist, which changes its sign
  /// where the mechanism passes a direct singularity; 0 at one, as far as Newton can tell, and where equations
  /// outnumber the unknowns.
  int sign() const noexcept;
  /// The smaller of the two conditions, of which that determinant is zero where either is.
  double direct_condition() const noexcept { return std::min(reciprocal_condition(), passive_condition()); }
  static constexpr double kSingular = 1e-5;  ///< a direct condition that Newton cannot tell from zero: it meets
                                             ///< x^2 = 0 to 1e-12 with x = 1e-6

  /// 1 or -1 as the product of that determinant with `other`'s, of a posture close by; where equations
  /// outnumber the unknowns, as det(M^T M') of the two matrices. 0 if they do not compare.
  int sign_against(const Closure& other) const noexcept;

  /// Smallest singular value of H in K x = H qdot, with qdot the active rates, over the longest lever of an
  /// active joint: 0 where some of them do not move the platform, however equal the others are. REQUIRES: the
  /// posture that was factored, or one next to it.
  double drive_condition(const Posture& posture) const noexcept;

 private:
  struct Leg {
    Elimination passive;                            // of A
    std::array<int, kMaxLegJoints> joints;          // of A's columns
    std::array<std::array<double, 6>, 6> platform;  // B, by columns

    int left_over() const { return passive.rows() - passive.rank(); }
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
