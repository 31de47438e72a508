#include "zwidth/mechanism/batch_delta.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

// The kernels are written once and compiled for every instruction set; Highway picks one at run time.
// Vectors without a fixed size (SVE, RVV) cannot be members of a struct, so those processors use their
// fixed-size set.
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "zwidth/mechanism/batch_delta.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "zwidth/mechanism/internal/delta_kernels-inl.h"
#include "zwidth/mechanism/internal/delta_sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

// ------------------------------------------------------------------------------------------ arrays of points

// Up to Lanes(d) values; the lanes beyond repeat the first one.
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

HWY_INLINE void store(M mask, std::uint8_t* to, std::size_t count) {
  const D d;
  HWY_ALIGN double buffer[hn::MaxLanes(D())];
  hn::Store(hn::IfThenElseZero(mask, set(1.0)), d, buffer);
  for (std::size_t lane = 0; lane < HWY_MIN(count, hn::Lanes(d)); ++lane) to[lane] = buffer[lane] != 0.0;
}

void inside(const Parameters& p, std::size_t n, const double* x, const double* y, const double* z,
            std::uint8_t* out) {
  const Constants c(p);
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    Legs legs;
    solve(c, column_at(c, load(x + at, rest), load(y + at, rest)), load(z + at, rest), legs);
    store(legs.inside, out + at, rest);
  }
}

void inverse(const Parameters& p, std::size_t n, const double* x, const double* y, const double* z,
             double* cosine, double* sine, std::uint8_t* out) {
  const Constants c(p);
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    Legs legs;
    solve(c, column_at(c, load(x + at, rest), load(y + at, rest)), load(z + at, rest), legs);
    for (std::size_t i = 0; i < 3; ++i) {
      store(hn::IfThenElse(legs.reached[i], legs.cosine[i], set(kNan)), cosine + i * n + at, rest);
      store(hn::IfThenElse(legs.reached[i], legs.sine[i], set(kNan)), sine + i * n + at, rest);
    }
    store(legs.inside, out + at, rest);
  }
}

void figures(const Parameters& p, std::size_t n, const double* x, const double* y, const double* z,
             double* out) {
  const Constants c(p);
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    Legs legs;
    solve(c, column_at(c, load(x + at, rest), load(y + at, rest)), load(z + at, rest), legs);
    V values[kFigureCount];
    Gram gram;
    figures_of<true>(c, legs, values, gram);
    values[0] = condition_number(gram);
    for (std::size_t f = 0; f < kFigureCount; ++f) {
      store(hn::IfThenElse(legs.inside, values[f], set(kNan)), out + f * n + at, rest);
    }
  }
}

// Forward kinematics as delta_forward: circumcentre of the three (shifted) elbows, and up along their normal.
void forward(const Parameters& p, std::size_t n, const double* cosine, const double* sine, double* x, double* y,
             double* z, double* det) {
  const V zero = hn::Zero(D()), one = set(1.0);
  const V d2 = set(p.d2), d5 = set(p.d5), half = set(0.5), h = set(kHalfSqrt3);
  const double scale = p.d2 + p.d3 + std::abs(p.d5), degenerate = 1e-12 * scale * scale;
  const double boundary = 2e-12 * p.d3 * p.d3;  // as delta_forward has it
  for (std::size_t at = 0; at < n; at += hn::Lanes(D())) {
    const std::size_t rest = n - at;
    V cos_i[3], sin_i[3], radius[3], up[3];
    for (std::size_t i = 0; i < 3; ++i) {
      cos_i[i] = load(cosine + i * n + at, rest);
      sin_i[i] = load(sine + i * n + at, rest);
      radius[i] = hn::MulAdd(d2, cos_i[i], d5);
      up[i] = d2 * sin_i[i];
    }
    const V cx[3] = {zero, hn::Neg(h * radius[1]), h * radius[2]};
    const V cy[3] = {radius[0], hn::Neg(half * radius[1]), hn::Neg(half * radius[2])};
    const V ux = cx[1], uy = cy[1] - cy[0], uz = up[1] - up[0];
    const V vx = cx[2], vy = cy[2] - cy[0], vz = up[2] - up[0];
    const V nx = hn::MulSub(uy, vz, uz * vy), ny = hn::MulSub(uz, vx, ux * vz),
            nz = hn::MulSub(ux, vy, uy * vx);
    const V N = dot(nx, ny, nz, nx, ny, nz);
    const V uu = dot(ux, uy, uz, ux, uy, uz), vv = dot(vx, vy, vz, vx, vy, vz);
    const V inverse_N = one / N, f = half * inverse_N;
    // ((n x u) v.v + (v x n) u.u)/(2 N)
    const V sx = (hn::MulSub(ny, uz, nz * uy) * vv + hn::MulSub(vy, nz, vz * ny) * uu) * f;
    const V sy = (hn::MulSub(nz, ux, nx * uz) * vv + hn::MulSub(vz, nx, vx * nz) * uu) * f;
    const V sz = (hn::MulSub(nx, uy, ny * ux) * vv + hn::MulSub(vx, ny, vy * nx) * uu) * f;
    const V h2 = set(p.d3 * p.d3) - dot(sx, sy, sz, sx, sy, sz);
    const M closes = hn::And(h2 >= set(-boundary), N > set(degenerate * degenerate));
    const V along = hn::CopySign(hn::Sqrt(hn::Max(h2, zero) * inverse_N), nz);
    const V px = hn::MulAdd(along, nx, sx), py = hn::MulAdd(along, ny, sy + cy[0]),
            pz = hn::MulAdd(along, nz, sz + up[0]);
    // det J = (r_1.b_1)(r_2.b_2)(r_3.b_3)/det R, with det R = r_1 . n as r_j - r_k are differences of the
    // centres.
    const V det_R = dot(px, py - cy[0], pz - up[0], nx, ny, nz);
    V product = one;
    const V s_i[3] = {py, hn::MulAdd(px, hn::Neg(h), hn::Neg(half * py)), hn::MulSub(px, h, half * py)};
    for (int i = 0; i < 3; ++i) {
      product = product * d2 * hn::MulSub(cos_i[i], pz, sin_i[i] * (s_i[i] - d5));
    }
    const V nan = set(kNan);
    store(hn::IfThenElse(closes, px, nan), x + at, rest);
    store(hn::IfThenElse(closes, py, nan), y + at, rest);
    store(hn::IfThenElse(closes, pz, nan), z + at, rest);
    store(hn::IfThenElse(closes, product / det_R, nan), det + at, rest);
  }
}

const char* target_name() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace zwidth {
namespace {

HWY_EXPORT(sweep_plane);
HWY_EXPORT(inside);
HWY_EXPORT(inverse);
HWY_EXPORT(figures);
HWY_EXPORT(forward);
HWY_EXPORT(target_name);

constexpr double kLimitTolerance = 1e-9;  // [rad], as delta_inverse

}  // namespace

DeltaBatch::DeltaBatch(const DeltaGeometry& geometry, const Interval& joint_range, const DriveLimits& limits) {
  parameters_.d2 = geometry.upper_arm;
  parameters_.d3 = geometry.forearm;
  parameters_.d5 = geometry.offset();
  const double half = 0.5 * joint_range.width() + kLimitTolerance;
  parameters_.cos_middle = std::cos(joint_range.middle());
  parameters_.sin_middle = std::sin(joint_range.middle());
  parameters_.cos_half = half < std::numbers::pi ? std::cos(half) : -2.0;
  for (int end = 0; end < 2; ++end) {
    const double angle = joint_range.middle() + (end == 0 ? -half : half);
    parameters_.cos_end[end] = std::cos(angle);
    parameters_.sin_end[end] = std::sin(angle);
  }
  for (int j = 0; j < 3; ++j) {
    parameters_.torque[j] = limits.torque[j];
    parameters_.inverse_torque[j] = 1.0 / limits.torque[j];
    parameters_.step[j] = limits.step[j];
  }
}

DeltaBatch::PlaneSummary DeltaBatch::sweep_plane(std::int64_t i, IndexRange j, IndexRange k, double spacing,
                                                 bool all) const {
  return HWY_DYNAMIC_DISPATCH(sweep_plane)(parameters_, i, j, k, spacing, all);
}

void DeltaBatch::inside(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                        std::span<std::uint8_t> out) const {
  assert(y.size() == x.size() && z.size() == x.size() && out.size() == x.size());
  HWY_DYNAMIC_DISPATCH(inside)(parameters_, x.size(), x.data(), y.data(), z.data(), out.data());
}

void DeltaBatch::inverse(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                         std::span<double> cosine, std::span<double> sine, std::span<std::uint8_t> out) const {
  assert(y.size() == x.size() && z.size() == x.size() && out.size() == x.size());
  assert(cosine.size() == 3 * x.size() && sine.size() == 3 * x.size());
  HWY_DYNAMIC_DISPATCH(inverse)
  (parameters_, x.size(), x.data(), y.data(), z.data(), cosine.data(), sine.data(), out.data());
}

void DeltaBatch::figures(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                         std::span<double> out) const {
  assert(y.size() == x.size() && z.size() == x.size() && out.size() == kFigureCount * x.size());
  HWY_DYNAMIC_DISPATCH(figures)(parameters_, x.size(), x.data(), y.data(), z.data(), out.data());
}

void DeltaBatch::forward(std::span<const double> cosine, std::span<const double> sine, std::span<double> x,
                         std::span<double> y, std::span<double> z, std::span<double> det) const {
  assert(y.size() == x.size() && z.size() == x.size() && det.size() == x.size());
  assert(cosine.size() == 3 * x.size() && sine.size() == 3 * x.size());
  HWY_DYNAMIC_DISPATCH(forward)
  (parameters_, x.size(), cosine.data(), sine.data(), x.data(), y.data(), z.data(), det.data());
}

std::array<Interval, 3> DeltaBatch::reach_box() const {
  // Every leg reaches d2 + d3 from its (shifted) axis, which passes within |d5| of the centre.
  const double reach = parameters_.d2 + parameters_.d3, across = reach + std::abs(parameters_.d5);
  return {Interval{-across, across}, Interval{-across, across}, Interval{-reach, reach}};
}

const char* batch_target_name() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace zwidth
#endif  // HWY_ONCE
