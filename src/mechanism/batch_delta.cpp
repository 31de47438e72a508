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

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using Parameters = DeltaBatch::Parameters;

constexpr double kHalfSqrt3 = 0.86602540378443864676;
constexpr double kReachTolerance = 2e-12;  // relative to rho^2, as delta_inverse
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

HWY_INLINE V set(double value) {
  return hn::Set(D(), value);
}
HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, az * bz));
}

// x cos(azimuth) + y sin(azimuth) of the legs at 90, 210 and 330 deg: how far out a point lies along leg i.
template <int leg>
HWY_INLINE V outward(V x, V y) {
  if constexpr (leg == 0) return y;
  const V half_y = y * set(-0.5);
  return leg == 1 ? hn::NegMulAdd(set(kHalfSqrt3), x, half_y) : hn::MulAdd(set(kHalfSqrt3), x, half_y);
}

// What the points of a column along z have in common, per leg.
struct Column {
  V x, y;
  V X[3];   // outward distance of the point from the (shifted) actuator axis
  V X2[3];  // its square
  V K0[3];  // K = X cos(theta) + z sin(theta), less its share z^2/(2 d2)
};

struct Constants {
  explicit Constants(const Parameters& p)
      : d2(set(p.d2)),
        d3(set(p.d3)),
        d5(set(p.d5)),
        inverse_d3(set(1.0 / p.d3)),
        inverse_2d2(set(0.5 / p.d2)),
        K_constant(set((p.d2 * p.d2 - p.d3 * p.d3) * (0.5 / p.d2))),
        cos_middle(set(p.cos_middle)),
        sin_middle(set(p.sin_middle)),
        cos_half(set(p.cos_half)) {
    for (int j = 0; j < 3; ++j) {
      torque[j] = set(p.torque[j]);
      inverse_torque[j] = set(p.inverse_torque[j]);
      step[j] = set(p.step[j]);
    }
  }
  V d2, d3, d5, inverse_d3, inverse_2d2, K_constant, cos_middle, sin_middle, cos_half;
  V torque[3], inverse_torque[3], step[3];
};

template <int leg>
HWY_INLINE void set_leg(const Constants& c, V xy2, Column& column) {
  const V s = outward<leg>(column.x, column.y);
  const V X = s - c.d5;
  column.X[leg] = X;
  column.X2[leg] = X * X;
  // X^2 + (tangential)^2 = X^2 + x^2 + y^2 - s^2
  column.K0[leg] = hn::MulAdd(hn::MulAdd(X, X, hn::NegMulAdd(s, s, xy2)), c.inverse_2d2, c.K_constant);
}

HWY_INLINE Column column_at(const Constants& c, V x, V y) {
  Column column;
  column.x = x;
  column.y = y;
  const V xy2 = hn::MulAdd(x, x, y * y);
  set_leg<0>(c, xy2, column);
  set_leg<1>(c, xy2, column);
  set_leg<2>(c, xy2, column);
  return column;
}

// Solved legs: angles, forearm vectors r_i and r_i . b_i = d2 D_i.
struct Legs {
  V cosine[3], sine[3];
  V D[3];
  V rx[3], ry[3], rz[3];
  M reached[3];
  M inside;
  V nx[3], ny[3], nz[3];  // r_2 x r_3, r_3 x r_1, r_1 x r_2
  V det;                  // det R
};

template <int leg>
HWY_INLINE void set_forearm(const Constants& c, const Column& column, V z, Legs& legs) {
  const V radius = hn::MulAdd(c.d2, legs.cosine[leg], c.d5);
  if constexpr (leg == 0) {
    legs.rx[0] = column.x;
    legs.ry[0] = column.y - radius;
  } else {
    legs.rx[leg] = hn::MulAdd(set(leg == 1 ? kHalfSqrt3 : -kHalfSqrt3), radius, column.x);
    legs.ry[leg] = hn::MulAdd(set(0.5), radius, column.y);
  }
  legs.rz[leg] = hn::NegMulAdd(c.d2, legs.sine[leg], z);
}

HWY_INLINE void set_normals(Legs& legs) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    legs.nx[i] = hn::MulSub(legs.ry[j], legs.rz[k], legs.rz[j] * legs.ry[k]);
    legs.ny[i] = hn::MulSub(legs.rz[j], legs.rx[k], legs.rx[j] * legs.rz[k]);
    legs.nz[i] = hn::MulSub(legs.rx[j], legs.ry[k], legs.ry[j] * legs.rx[k]);
  }
  legs.det = hn::MulAdd(legs.rx[0], legs.nx[0], hn::MulAdd(legs.ry[0], legs.ny[0], legs.rz[0] * legs.nz[0]));
}

// Inverse kinematics by the outward root: in the plane of a leg K = X cos + z sin with
// K = (X^2 + z^2 + tangential^2 + d2^2 - d3^2)/(2 d2), so with rho^2 = X^2 + z^2 and D^2 = rho^2 - K^2
// (cos, sin) = (K X + z D, K z - X D)/rho^2 and r . b = d2 D.
HWY_INLINE void solve(const Constants& c, const Column& column, V z, Legs& legs) {
  const V zero = hn::Zero(D()), z2 = z * z;
  V rho2[3], K[3];
  for (int i = 0; i < 3; ++i) {
    rho2[i] = column.X2[i] + z2;
    K[i] = hn::MulAdd(z2, c.inverse_2d2, column.K0[i]);
    const V D2 = hn::NegMulAdd(K[i], K[i], rho2[i]);
    legs.reached[i] = D2 >= rho2[i] * set(-kReachTolerance);
    legs.D[i] = hn::Sqrt(hn::Max(D2, zero));
  }
  // One division serves the three legs. A point on an actuator axis makes it infinite and is not inside.
  const V rho01 = rho2[0] * rho2[1];
  const V inverse = set(1.0) / (rho01 * rho2[2]);
  const V inverse_rho2[3] = {inverse * (rho2[1] * rho2[2]), inverse * (rho2[0] * rho2[2]), inverse * rho01};
  legs.inside = hn::And(hn::And(legs.reached[0], legs.reached[1]), legs.reached[2]);
  for (int i = 0; i < 3; ++i) {
    legs.cosine[i] = hn::MulAdd(K[i], column.X[i], z * legs.D[i]) * inverse_rho2[i];
    legs.sine[i] = hn::MulSub(K[i], z, column.X[i] * legs.D[i]) * inverse_rho2[i];
    const V cos_off = hn::MulAdd(legs.cosine[i], c.cos_middle, legs.sine[i] * c.sin_middle);
    legs.inside = hn::And(legs.inside, cos_off >= c.cos_half);
  }
  set_forearm<0>(c, column, z, legs);
  set_forearm<1>(c, column, z, legs);
  set_forearm<2>(c, column, z, legs);
  set_normals(legs);
  // Upper assembly mode: det R has the sign of the z component of (c_2 - c_1) x (c_3 - c_1).
  const V e0 = hn::MulAdd(c.d2, legs.cosine[0], c.d5), e1 = hn::MulAdd(c.d2, legs.cosine[1], c.d5),
          e2 = hn::MulAdd(c.d2, legs.cosine[2], c.d5);
  const V slope = hn::MulAdd(e0, e1 + e2, e1 * e2);
  legs.inside = hn::And(legs.inside, slope * legs.det >= zero);
}

// cos(acos(t)/3) for t in 0..1, to 2e-13: a polynomial and one Newton step on 4 w^3 - 3 w = t, whose slope is
// inverted by a polynomial too. Both are Chebyshev fits.
HWY_INLINE V cos_third(V t) {
  constexpr double kValue[] = {0.8660254053677887,    0.16666639962375235,   -0.04810502173083256,
                               0.024608831953335034,  -0.015124763184433973, 0.009420074598752139,
                               -0.004972568181542556, 0.0017909605628210557, -0.00030932018933526706};
  constexpr double kInverseSlope[] = {0.16665204293112265, -0.0954311782224066, 0.06685063588710843,
                                      -0.03710791865697717, 0.010158165347160625};
  V w = set(kValue[8]);
  for (int i = 7; i >= 0; --i) w = hn::MulAdd(w, t, set(kValue[i]));
  V inverse_slope = set(kInverseSlope[4]);
  for (int i = 3; i >= 0; --i) inverse_slope = hn::MulAdd(inverse_slope, t, set(kInverseSlope[i]));
  const V error = hn::MulSub(hn::MulSub(w * w, set(4.0), set(3.0)), w, t);
  return hn::NegMulAdd(error, inverse_slope, w);
}

// What the condition number is computed from: columns v_j of a multiple of J.
struct Gram {
  V g00, g11, g22, g01, g02, g12;  // v_i . v_j
  V inverse_det;                   // 1/|det (v_1 v_2 v_3)|
};

// With eigenvalues l1 >= l2 >= l3 of the Gram matrix it is sqrt(l1/l3) = l1 sqrt(l2)/|det|, so that the
// smallest one, which rounding hurts most, is never computed. l1 = q + 2 p cos(phi), l2 = q + 2 p cos(phi - 2
// pi/3) with phi = acos(r)/3 (Smith 1961), without the acos: t = cos(acos(r)/2) = sqrt((1 + r)/2) and w =
// cos(acos(t)/3) give cos(phi) = 2 w^2 - 1 and sin(phi) = 2 w sqrt(1 - w^2).
HWY_INLINE V condition_number(const Gram& g) {
  const V one = set(1.0), zero = hn::Zero(D());
  const V q = (g.g00 + g.g11 + g.g22) * set(1.0 / 3.0);
  const V a = g.g00 - q, b = g.g11 - q, c = g.g22 - q;
  const V off = hn::MulAdd(g.g01, g.g01, hn::MulAdd(g.g02, g.g02, g.g12 * g.g12));
  const V squares = hn::MulAdd(a, a, hn::MulAdd(b, b, hn::MulAdd(c, c, off + off)));
  const V p2 = hn::Max(squares * set(1.0 / 6.0), q * q * set(1e-30));  // of equal singular values any r will do
  const V p = hn::Sqrt(p2);
  const V minor = hn::MulSub(b, c, g.g12 * g.g12);
  const V det = hn::MulAdd(
      a, minor,
      hn::MulAdd(g.g02, hn::MulSub(g.g01, g.g12, b * g.g02), g.g01 * hn::MulSub(g.g12, g.g02, g.g01 * c)));
  const V r = det / ((p2 + p2) * p);
  const V t = hn::Sqrt(hn::Min(hn::Max(hn::MulAdd(r, set(0.5), set(0.5)), zero), one));
  const V w = hn::Min(cos_third(t), one);
  const V w2 = w * w;
  const V cosine = hn::MulSub(set(2.0), w2, one);
  const V sine = (w + w) * hn::Sqrt(one - w2);
  const V largest = hn::MulAdd(p + p, cosine, q);
  const V middle = hn::Max(hn::MulAdd(p, hn::MulSub(set(2.0 * kHalfSqrt3), sine, cosine), q), zero);
  return hn::Max(largest * hn::Sqrt(middle) * g.inverse_det, one);
}

// All figures of solved legs in the order of `Figure`, but for the condition number, for which `gram` is made.
// J = R^-1 D (A.32): its columns are v_j/det R with v_j = (r_k x r_l) (r_j . b_j).
template <bool all>
HWY_INLINE void figures_of(const Constants& c, const Legs& legs, V* out, Gram& gram) {
  const V one = set(1.0),
          tiny = set(1e-30);  // keeps exact singularities from spoiling figures that are finite there
  V b[3], vx[3], vy[3], vz[3];
  for (int j = 0; j < 3; ++j) {
    b[j] = c.d2 * hn::Max(legs.D[j], tiny);
    vx[j] = legs.nx[j] * b[j];
    vy[j] = legs.ny[j] * b[j];
    vz[j] = legs.nz[j] * b[j];
  }
  const V det_R = hn::Max(hn::Abs(legs.det), tiny);
  const V bbb = b[0] * b[1] * b[2];
  const auto load = [&](const V* row) {  // largest |torque| per force along the axis, in units of the limits
    return hn::Max(hn::Max(hn::Abs(row[0] * c.inverse_torque[0]), hn::Abs(row[1] * c.inverse_torque[1])),
                   hn::Abs(row[2] * c.inverse_torque[2]));
  };
  const V lx = load(vx), ly = load(vy), lz = load(vz);
  const V lxy = lx * ly, lll = lxy * lz, b_det = bbb * det_R;
  const V inverse = one / (lll * b_det);  // one division for all
  const V force = inverse * b_det * det_R;
  const V inverse_R = inverse * (lll * bbb), inverse_bbb = inverse * (lll * det_R);
  out[1] = bbb * inverse_R;
  out[2] = force * (ly * lz);
  out[3] = force * (lx * lz);
  out[4] = force * lxy;

  const auto product = [&](int i, int j) { return dot(vx[i], vy[i], vz[i], vx[j], vy[j], vz[j]); };
  gram.g00 = product(0, 0);
  gram.g11 = product(1, 1);
  gram.g22 = product(2, 2);
  gram.g01 = product(0, 1);
  gram.g02 = product(0, 2);
  gram.g12 = product(1, 2);
  gram.inverse_det = inverse_bbb * inverse_R * inverse_R;

  if constexpr (all) {
    const auto square = [](V v) { return v * v; };
    out[5] = det_R / hn::Sqrt(hn::Max(hn::Max(gram.g00 * square(c.inverse_torque[0]),
                                              gram.g11 * square(c.inverse_torque[1])),
                                      gram.g22 * square(c.inverse_torque[2])));
    // Edges of the polytope are the columns r_j/(r_j . b_j) of J^-T times the limits: the largest |e1 +- e2 +-
    // e3|^2.
    const V s[3] = {c.torque[0] * inverse_bbb * b[1] * b[2], c.torque[1] * inverse_bbb * b[0] * b[2],
                    c.torque[2] * inverse_bbb * b[0] * b[1]};
    const auto edges = [&](int i, int j) {
      return s[i] * s[j] * dot(legs.rx[i], legs.ry[i], legs.rz[i], legs.rx[j], legs.ry[j], legs.rz[j]);
    };
    const V e01 = edges(0, 1), e02 = edges(0, 2), e12 = edges(1, 2);
    const V cross =
        hn::Max(hn::Max(e01 + e02 + e12, e01 - e02 - e12), hn::Max(e02 - e01 - e12, e12 - e01 - e02));
    const V squares = c.d3 * c.d3 * (hn::MulAdd(s[0], s[0], hn::MulAdd(s[1], s[1], s[2] * s[2])));
    out[6] = hn::Sqrt(squares + cross + cross);
    const auto step = [&](const V* row) {
      return inverse_R * hn::MulAdd(hn::Abs(row[0]), c.step[0],
                                    hn::MulAdd(hn::Abs(row[1]), c.step[1], hn::Abs(row[2]) * c.step[2]));
    };
    out[7] = step(vx);
    out[8] = step(vy);
    out[9] = step(vz);
    out[10] = hn::Min(hn::Min(legs.D[0], legs.D[1]), legs.D[2]) * c.inverse_d3;
    out[11] = hn::Abs(legs.det) * (c.inverse_d3 * c.inverse_d3 * c.inverse_d3);
  }
}

// ------------------------------------------------------------------------------------------- lattice sweep

// Lowest and highest z of the workspace on either side of z = 0, per column: a hull, found in closed form from
// the ends of every leg's reach and of its joint range.
struct Hull {
  V low[2], high[2];  // [0] below zero, [1] above
};

template <int leg>
HWY_INLINE void intersect_leg(const Parameters& p, V x, V y, Hull& hull) {
  const V zero = hn::Zero(D()), infinity = set(kInfinity);
  const double scale = p.d2 + p.d3 + std::abs(p.d5), slack = 1e-9 * scale;
  const V s = outward<leg>(x, y), X = s - set(p.d5);
  const V tangential2 = hn::Max(hn::MulAdd(x, x, hn::NegMulAdd(s, s, y * y)), zero);
  const V q2 = set(p.d3 * p.d3) - tangential2;  // squared length of the forearm in the leg's plane
  const M crosses = q2 >= set(-slack * scale);
  const V q = hn::Sqrt(hn::Max(q2, zero));

  V low = infinity, high = hn::Neg(infinity), low_above = infinity, high_below = hn::Neg(infinity);
  const auto candidate = [&](V z, M valid) {
    low = hn::Min(low, hn::IfThenElse(valid, z, infinity));
    high = hn::Max(high, hn::IfThenElse(valid, z, hn::Neg(infinity)));
    low_above = hn::Min(low_above, hn::IfThenElse(hn::And(valid, z >= zero), z, infinity));
    high_below = hn::Max(high_below, hn::IfThenElse(hn::And(valid, z < zero), z, hn::Neg(infinity)));
  };

  // Ends of reach: the arm stretched (rho = d2 + q) or folded (rho = |d2 - q|), where the angle points along
  // (X, z), or against it if the forearm is the longer one.
  const V X2 = X * X;
  const V outer = set(p.d2) + q, inner = hn::Abs(set(p.d2) - q);
  const V outer_z2 = hn::MulSub(outer, outer, X2), inner_z2 = hn::MulSub(inner, inner, X2);
  const M gap = inner_z2 > zero;
  const V outer_z = hn::Sqrt(hn::Max(outer_z2, zero)), inner_z = hn::Sqrt(hn::Max(inner_z2, zero));
  const auto in_range = [&](V z, V rho, V direction) {
    return direction * hn::MulAdd(X, set(p.cos_middle), z * set(p.sin_middle)) >=
           hn::MulSub(set(p.cos_half), rho, set(slack));
  };
  const V one = set(1.0), folded = hn::IfThenElse(set(p.d2) >= q, one, hn::Neg(one));
  const M reaches = hn::And(crosses, outer_z2 >= set(-slack * scale));
  candidate(outer_z, hn::And(reaches, in_range(outer_z, outer, one)));
  candidate(hn::Neg(outer_z), hn::And(reaches, in_range(hn::Neg(outer_z), outer, one)));
  candidate(inner_z, hn::And(hn::And(reaches, gap), in_range(inner_z, inner, folded)));
  candidate(hn::Neg(inner_z), hn::And(hn::And(reaches, gap), in_range(hn::Neg(inner_z), inner, folded)));

  // Ends of the joint range, on the outward root: r . b >= 0.
  if (p.cos_half >= -1.0) {
    for (int end = 0; end < 2; ++end) {
      const V cosine = set(p.cos_end[end]), sine = set(p.sin_end[end]);
      const V across = hn::NegMulAdd(set(p.d2), cosine, X);
      const V up2 = hn::NegMulAdd(across, across, q2);
      const M meets = hn::And(crosses, up2 >= set(-slack * scale));
      const V up = hn::Sqrt(hn::Max(up2, zero)), elbow = set(p.d2) * sine;
      for (const V z : {elbow + up, elbow - up}) {
        candidate(z, hn::And(meets, hn::MulSub(cosine, z, sine * X) >= set(-slack)));
      }
    }
  }
  hull.low[0] = hn::Max(hull.low[0], low);
  hull.high[0] = hn::Min(hull.high[0], hn::IfThenElse(gap, high_below, hn::Min(high, zero)));
  hull.low[1] = hn::Max(hull.low[1], hn::IfThenElse(gap, low_above, hn::Max(low, zero)));
  hull.high[1] = hn::Min(hull.high[1], high);
}

HWY_INLINE bool empty(const Hull& hull) {
  return hn::AllFalse(D(), hn::Or(hull.low[0] <= hull.high[0], hull.low[1] <= hull.high[1]));
}

template <int count>
struct Accumulators {
  Accumulators() {
    inside = hn::Zero(D());
    for (int f = 0; f < count; ++f) {
      sum[f] = hn::Zero(D());
      min[f] = set(kInfinity);
      max[f] = set(-kInfinity);
      min_j[f] = max_j[f] = hn::Zero(D());
    }
    k_first = set(kInfinity);
    k_last = set(-kInfinity);
  }
  V inside, k_first, k_last;
  V sum[count], min[count], max[count], min_j[count], max_j[count];
};

constexpr int kStage = 8;

template <bool all>
HWY_INLINE void sweep_column(const Constants& c, V x, V y, V j, std::int64_t k_first, std::int64_t k_last,
                             double spacing, Accumulators<all ? kFigureCount : kCoreFigureCount>& total) {
  constexpr int count = all ? kFigureCount : kCoreFigureCount;
  const D d;
  const V infinity = set(kInfinity), last = set(static_cast<double>(k_last));
  const Column column = column_at(c, x, y);
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  V column_min[count], column_max[count];
  for (int f = 0; f < count; ++f) {
    column_min[f] = infinity;
    column_max[f] = hn::Neg(infinity);
  }
  // Stage by stage over a few vectors: each stage is one long chain of divisions and roots, and only so do the
  // chains of several vectors overlap.
  Legs legs[kStage];
  V values[kStage][count];
  Gram gram[kStage];
  for (std::int64_t k0 = k_first; k0 <= k_last; k0 += lanes * kStage) {
    const int stage = static_cast<int>(HWY_MIN((k_last - k0) / lanes + 1, kStage));
    V k = hn::Iota(d, static_cast<double>(k0));
    for (int v = 0; v < stage; ++v) {
      solve(c, column, (k + set(static_cast<double>(v * lanes))) * set(spacing), legs[v]);
    }
    for (int v = 0; v < stage; ++v) figures_of<all>(c, legs[v], values[v], gram[v]);
    for (int v = 0; v < stage; ++v) values[v][0] = condition_number(gram[v]);
    for (int v = 0; v < stage; ++v) {
      const M inside = hn::And(legs[v].inside, k <= last);
      total.inside = total.inside + hn::IfThenElseZero(inside, set(1.0));
      total.k_first = hn::Min(total.k_first, hn::IfThenElse(inside, k, infinity));
      total.k_last = hn::Max(total.k_last, hn::IfThenElse(inside, k, hn::Neg(infinity)));
      for (int f = 0; f < count; ++f) {
        total.sum[f] = total.sum[f] + hn::IfThenElseZero(inside, values[v][f]);
        column_min[f] = hn::Min(column_min[f], hn::IfThenElse(inside, values[v][f], infinity));
        column_max[f] = hn::Max(column_max[f], hn::IfThenElse(inside, values[v][f], hn::Neg(infinity)));
      }
      k = k + set(static_cast<double>(lanes));
    }
  }
  for (int f = 0; f < count; ++f) {
    total.min_j[f] = hn::IfThenElse(column_min[f] < total.min[f], j, total.min_j[f]);
    total.max_j[f] = hn::IfThenElse(column_max[f] > total.max[f], j, total.max_j[f]);
    total.min[f] = hn::Min(total.min[f], column_min[f]);
    total.max[f] = hn::Max(total.max[f], column_max[f]);
  }
}

double sum_of(V v) {
  return hn::GetLane(hn::SumOfLanes(D(), v));
}
double min_of(V v) {
  return hn::GetLane(hn::MinOfLanes(D(), v));
}
double max_of(V v) {
  return hn::GetLane(hn::MaxOfLanes(D(), v));
}

template <bool all>
DeltaBatch::PlaneSummary sweep_plane_of(const Parameters& p, std::int64_t i, DeltaBatch::IndexRange j_range,
                                        DeltaBatch::IndexRange k_range, double spacing) {
  constexpr int count = all ? kFigureCount : kCoreFigureCount;
  const D d;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  const Constants c(p);
  const V x = set(static_cast<double>(i) * spacing);
  const double pad = 1e-7 * (p.d2 + p.d3 + std::abs(p.d5));
  Accumulators<count> total;
  DeltaBatch::PlaneSummary summary;
  HWY_ALIGN double bounds[4][hn::MaxLanes(D())];

  for (std::int64_t j0 = j_range.first; j0 <= j_range.last; j0 += lanes) {
    Hull hull;
    for (int side = 0; side < 2; ++side) {
      hull.low[side] = set(-kInfinity);
      hull.high[side] = set(kInfinity);
    }
    const V y = hn::Iota(d, static_cast<double>(j0)) * set(spacing);
    intersect_leg<0>(p, x, y, hull);
    if (empty(hull)) continue;
    intersect_leg<1>(p, x, y, hull);
    if (empty(hull)) continue;
    intersect_leg<2>(p, x, y, hull);
    const V limit_low = set(static_cast<double>(k_range.first)),
            limit_high = set(static_cast<double>(k_range.last));
    for (int side = 0; side < 2; ++side) {
      hn::Store(hn::Max(hn::Ceil((hull.low[side] - set(pad)) / set(spacing)), limit_low), d, bounds[2 * side]);
      hn::Store(hn::Min(hn::Floor((hull.high[side] + set(pad)) / set(spacing)), limit_high), d,
                bounds[2 * side + 1]);
    }
    const std::int64_t columns = HWY_MIN(lanes, j_range.last - j0 + 1);
    for (std::int64_t lane = 0; lane < columns; ++lane) {
      const double j = static_cast<double>(j0 + lane);
      const double before = sum_of(total.inside);
      double done = -kInfinity;  // the two sides may share an index
      for (int side = 0; side < 2; ++side) {
        const double low = HWY_MAX(bounds[2 * side][lane], done + 1.0), high = bounds[2 * side + 1][lane];
        if (!(low <= high)) continue;
        sweep_column<all>(c, x, set(j * spacing), set(j), static_cast<std::int64_t>(low),
                          static_cast<std::int64_t>(high), spacing, total);
        done = high;
      }
      if (sum_of(total.inside) > before) {
        if (before == 0.0) summary.j_first = j0 + lane;
        summary.j_last = j0 + lane;
      }
    }
  }

  summary.inside = static_cast<std::int64_t>(sum_of(total.inside));
  if (summary.inside == 0) return summary;
  summary.k_first = static_cast<std::int64_t>(min_of(total.k_first));
  summary.k_last = static_cast<std::int64_t>(max_of(total.k_last));
  for (int f = 0; f < count; ++f) {
    summary.sum[f] = sum_of(total.sum[f]);
    // Of equal extremes the one with the smallest j, whatever the number of lanes.
    const double least = min_of(total.min[f]), most = max_of(total.max[f]);
    const V infinity = set(kInfinity);
    summary.min[f] = {least, static_cast<std::int64_t>(
                                 min_of(hn::IfThenElse(total.min[f] == set(least), total.min_j[f], infinity)))};
    summary.max[f] = {most, static_cast<std::int64_t>(
                                min_of(hn::IfThenElse(total.max[f] == set(most), total.max_j[f], infinity)))};
  }
  return summary;
}

DeltaBatch::PlaneSummary sweep_plane(const Parameters& p, std::int64_t i, DeltaBatch::IndexRange j_range,
                                     DeltaBatch::IndexRange k_range, double spacing, bool all) {
  return all ? sweep_plane_of<true>(p, i, j_range, k_range, spacing)
             : sweep_plane_of<false>(p, i, j_range, k_range, spacing);
}

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
    const M closes = hn::And(h2 >= zero, N > set(degenerate * degenerate));
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
