// The delta in lanes of SIMD, for the kernels of batch_delta.cpp: legs solved from tool points, and the figures
// of solved legs. As every "-inl.h" of Highway it is included once per instruction set, after
// <hwy/foreach_target.h>.

#if defined(ZWIDTH_MECHANISM_DELTA_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ZWIDTH_MECHANISM_DELTA_KERNELS_INL_H
#undef ZWIDTH_MECHANISM_DELTA_KERNELS_INL_H
#else
#define ZWIDTH_MECHANISM_DELTA_KERNELS_INL_H
#endif

#include <cmath>
#include <hwy/highway.h>
#include <limits>

#include "zwidth/mechanism/batch_delta.h"

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

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
