#include "zwidth/mechanism/batch_five_bar.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

// Written once, compiled for every instruction set; see batch_delta.cpp for the targets left out.
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "zwidth/mechanism/batch_five_bar.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using Parameters = FiveBarBatch::Parameters;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNearLimit = 2e-9 - 1e-18;  // square of the sine where | |cos alpha| - 1 | = 1e-9

HWY_INLINE V set(double value) {
  return hn::Set(D(), value);
}

HWY_INLINE V load(const double* from, std::size_t count) {
  const D d;
  if (count >= hn::Lanes(d)) return hn::LoadU(d, from);
  HWY_ALIGN double buffer[hn::MaxLanes(D())];
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) buffer[lane] = from[lane < count ? lane : 0];
  return hn::Load(d, buffer);
}

HWY_INLINE void store(V value, double* to, std::size_t count) {
  const D d;
  if (count >= hn::Lanes(d)) {
    hn::StoreU(value, d, to);
    return;
  }
  HWY_ALIGN double buffer[hn::MaxLanes(D())];
  hn::Store(value, d, buffer);
  for (std::size_t lane = 0; lane < count; ++lane) to[lane] = buffer[lane];
}

// One leg at a point: d = C - O, D2 = |d|^2, k = r1 D cos(alpha), q = (r1 D sin(alpha))^2 and its root with the
// sign of the mode, so that D2 (B - O) = k d + rho d' with d' = d turned left. det Jtheta_ii = -rho.
struct Leg {
  V dx, D2, k, q, rho;
  M reached;
};

HWY_INLINE Leg leg_at(const Parameters& p, int i, V x, V y) {
  const V zero = hn::Zero(D());
  Leg leg;
  leg.dx = x + set(i == 0 ? p.r3 : -p.r3);
  leg.D2 = hn::MulAdd(leg.dx, leg.dx, y * y);
  leg.k = hn::MulAdd(set(0.5), leg.D2, set(0.5 * (p.r1 - p.r2) * (p.r1 + p.r2)));
  // (2 r1 D sin(alpha))^2 = 16 times the squared area of the triangle of r1, r2 and D.
  const V outer = set(p.outer2) - leg.D2, inner = leg.D2 - set(p.inner2);
  const M bent = hn::And(outer > set(p.outer_rounding), inner > set(p.inner_rounding));
  leg.q = hn::IfThenElse(bent, outer * inner * set(0.25), zero);
  leg.rho = hn::Sqrt(leg.q) * set(p.sign[i]);
  leg.reached = hn::And(leg.D2 <= set(p.reach2), leg.D2 >= set(p.core2));
  // cos(theta - middle) >= cos_half, times r1 D2.
  const V cm = set(p.cos_middle[i]), sm = set(p.sin_middle[i]);
  const V along = hn::MulAdd(leg.dx, cm, y * sm), across = hn::MulSub(leg.dx, sm, y * cm);
  const V window = hn::MulAdd(leg.k, along, leg.rho * across);
  leg.reached = hn::And(leg.reached, window >= set(p.r1 * p.cos_half[i]) * leg.D2);
  return leg;
}

// What the condition number is made of, all times D1^2 D2^2: the squared norm and the determinant of
// M = [Jp row 1 Jtheta_22; Jp row 2 Jtheta_11].
struct Condition {
  M reached, regular;
  V S, delta;
};

HWY_INLINE Condition condition_at(const Parameters& p, V x, V y) {
  const Leg a = leg_at(p, 0, x, y), b = leg_at(p, 1, x, y);
  const V DD = a.D2 * b.D2;
  // Couplers: D2 (C - B) = (D2 - k) d - rho d'.
  const V ka = a.D2 - a.k, kb = b.D2 - b.k;
  const V cross = y * set(2.0 * p.r3), dot = hn::MulAdd(a.dx, b.dx, y * y);
  const V det = hn::MulAdd(hn::MulAdd(ka, kb, a.rho * b.rho), cross, hn::MulSub(a.rho, kb, b.rho * ka) * dot);
  Condition c;
  c.S = set(p.r2 * p.r2) * (a.q + b.q) * DD;
  c.delta = hn::Abs(a.rho * b.rho * det);
  c.reached = hn::And(a.reached, b.reached);
  const V near = set(kNearLimit * p.r1 * p.r1);
  c.regular = hn::And(hn::And(a.q > near * a.D2, b.q > near * b.D2), c.delta > set(1e-12) * c.S);
  c.regular = hn::And(c.regular, c.reached);
  return c;
}

FiveBarBatch::Count count_above(const Parameters& p, std::size_t n, const double* x, const double* y,
                                double limit) {
  const D d;
  // K + 1/K = S/delta grows with K from 1 on. Symmetric lengths make K a round number at symmetric points, and
  // rounding must not decide there.
  const double least = limit * (1.0 + 1e-12);
  const V bound = set(least >= 1.0 ? least + 1.0 / least : 0.0);
  FiveBarBatch::Count count;
  std::size_t reachable = 0, above = 0, regular = 0;
  for (std::size_t at = 0; at < n; at += hn::Lanes(d)) {
    const std::size_t rest = n - at;
    const Condition c = condition_at(p, load(x + at, rest), load(y + at, rest));
    const M here = hn::FirstN(d, HWY_MIN(rest, hn::Lanes(d)));
    reachable += hn::CountTrue(d, hn::And(c.reached, here));
    regular += hn::CountTrue(d, hn::And(c.regular, here));
    above += hn::CountTrue(d, hn::And(hn::And(c.regular, c.S > bound * c.delta), here));
  }
  count.reachable = static_cast<std::int64_t>(reachable);
  count.above = static_cast<std::int64_t>(above);
  count.singular = static_cast<std::int64_t>(reachable - regular);
  return count;
}

void condition_numbers(const Parameters& p, std::size_t n, const double* x, const double* y, double* out) {
  const V zero = hn::Zero(D());
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    const Condition c = condition_at(p, load(x + at, rest), load(y + at, rest));
    const V twice = c.delta + c.delta;
    const V root = hn::Sqrt(hn::Max(c.S - twice, zero) * (c.S + twice));
    const V K = hn::IfThenElse(c.regular, (c.S + root) / twice, set(kInfinity));
    store(hn::IfThenElse(c.reached, K, set(kNan)), out + at, rest);
  }
}

void inverse(const Parameters& p, std::size_t n, const double* x, const double* y, double* cosine, double* sine,
             double* jacobian) {
  const V one = set(1.0), nan = set(kNan), inverse_r1 = set(1.0 / p.r1);
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    const V px = load(x + at, rest), py = load(y + at, rest);
    const Leg legs[2] = {leg_at(p, 0, px, py), leg_at(p, 1, px, py)};
    const M reached = hn::And(legs[0].reached, legs[1].reached);
    V ux[2], uy[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const Leg& leg = legs[i];
      const V inverse_D2 = one / leg.D2;
      const V bx = hn::MulSub(leg.k, leg.dx, leg.rho * py) * inverse_D2;
      const V by = hn::MulAdd(leg.k, py, leg.rho * leg.dx) * inverse_D2;
      ux[i] = leg.dx - bx;
      uy[i] = py - by;
      store(hn::IfThenElse(reached, bx * inverse_r1, nan), cosine + i * n + at, rest);
      store(hn::IfThenElse(reached, by * inverse_r1, nan), sine + i * n + at, rest);
    }
    // Jp^-1 Jtheta, Jtheta = -diag(rho).
    const V det = hn::MulSub(ux[0], uy[1], uy[0] * ux[1]);
    const V inverse_det = one / det;
    const M defined = hn::And(reached, hn::Abs(det) > hn::Zero(D()));
    const V a = legs[0].rho * inverse_det, b = legs[1].rho * inverse_det;
    const V J[4] = {hn::Neg(uy[1] * a), uy[0] * b, ux[1] * a, hn::Neg(ux[0] * b)};
    for (std::size_t e = 0; e < 4; ++e) store(hn::IfThenElse(defined, J[e], nan), jacobian + e * n + at, rest);
  }
}

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace zwidth {
namespace {

HWY_EXPORT(count_above);
HWY_EXPORT(condition_numbers);
HWY_EXPORT(inverse);

// As in five_bar.cpp.
constexpr double kCoincident = 1e-14, kReachTolerance = 1e-12, kLimitTolerance = 1e-9;
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();

}  // namespace

FiveBarBatch::FiveBarBatch(const FiveBarGeometry& geometry, WorkingMode mode,
                           const std::array<Interval, 2>& ranges) {
  Parameters& p = parameters_;
  p.r1 = geometry.crank;
  p.r2 = geometry.coupler;
  p.r3 = geometry.half_base;
  p.sign = {mode.left < 0 ? -1.0 : 1.0, mode.right < 0 ? -1.0 : 1.0};
  const double outer = p.r1 + p.r2, inner = std::abs(p.r1 - p.r2);
  p.outer2 = outer * outer;
  p.inner2 = inner * inner;
  if (can_assemble(geometry)) {
    const double slack = kReachTolerance * outer, core = std::max(inner - slack, 0.0);
    p.reach2 = (outer + slack) * (outer + slack);
    p.core2 = std::max(core * core, std::pow(kCoincident * geometry.scale(), 2));
  }
  p.outer_rounding = 2.0 * kRounding * p.outer2;
  p.inner_rounding = 2.0 * kRounding * outer * inner;
  for (int i = 0; i < 2; ++i) {
    const double half = 0.5 * ranges[i].width() + kLimitTolerance;
    p.cos_middle[i] = std::cos(ranges[i].middle());
    p.sin_middle[i] = std::sin(ranges[i].middle());
    p.cos_half[i] = half < std::numbers::pi ? std::cos(half) : -2.0;
  }
}

FiveBarBatch::Count FiveBarBatch::count_above(std::span<const double> x, std::span<const double> y,
                                              double limit) const {
  assert(y.size() == x.size());
  return HWY_DYNAMIC_DISPATCH(count_above)(parameters_, x.size(), x.data(), y.data(), limit);
}

void FiveBarBatch::condition_numbers(std::span<const double> x, std::span<const double> y,
                                     std::span<double> out) const {
  assert(y.size() == x.size() && out.size() == x.size());
  HWY_DYNAMIC_DISPATCH(condition_numbers)(parameters_, x.size(), x.data(), y.data(), out.data());
}

void FiveBarBatch::inverse(std::span<const double> x, std::span<const double> y, std::span<double> cosine,
                           std::span<double> sine, std::span<double> jacobian) const {
  assert(y.size() == x.size() && cosine.size() == 2 * x.size() && sine.size() == 2 * x.size() &&
         jacobian.size() == 4 * x.size());
  HWY_DYNAMIC_DISPATCH(inverse)
  (parameters_, x.size(), x.data(), y.data(), cosine.data(), sine.data(), jacobian.data());
}

}  // namespace zwidth
#endif  // HWY_ONCE
