// Sine, cosine and angle of many lanes at once, for kernels written with Highway. As every "-inl.h" of Highway
// it is included once per instruction set, after <hwy/foreach_target.h>; the scalar twin is in trigonometry.h.

#if defined(ZWIDTH_MATH_VECTOR_TRIGONOMETRY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ZWIDTH_MATH_VECTOR_TRIGONOMETRY_INL_H
#undef ZWIDTH_MATH_VECTOR_TRIGONOMETRY_INL_H
#else
#define ZWIDTH_MATH_VECTOR_TRIGONOMETRY_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {

/// Sine and cosine of every lane [rad]: absolute error below 2.5e-16 for |angle| < 1e5. Beyond that the answer
/// loses digits, and for infinities and NaN it is NaN.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE void sine_cosine(D d, V angle, V& sine, V& cosine) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RebindToUnsigned<D> du;
  const auto set = [d](double value) { return hn::Set(d, value); };

  // angle = quarter pi/2 + r with |r| <= pi/4; pi/2 in two parts, the first with 33 bits (Cody and Waite 1980).
  // Adding 1.5 2^52 leaves the nearest integer in the low bits.
  const V round = set(6755399441055744.0);
  const V shifted = hn::MulAdd(angle, set(0.63661977236758134308), round);
  const V quarter = shifted - round;
  const V r = hn::NegMulAdd(quarter, set(6.07710050650619224932e-11),
                            hn::NegMulAdd(quarter, set(1.57079632673412561417), angle));

  // Minimax polynomials of FreeBSD's libm (Sun 1993, k_sin.c and k_cos.c).
  const V z = r * r;
  V s = set(1.58969099521155010221e-10);
  s = hn::MulAdd(s, z, set(-2.50507602534068634195e-08));
  s = hn::MulAdd(s, z, set(2.75573137070700676789e-06));
  s = hn::MulAdd(s, z, set(-1.98412698298579493134e-04));
  s = hn::MulAdd(s, z, set(8.33333333332248946124e-03));
  s = hn::MulAdd(s, z, set(-1.66666666666666324348e-01));
  s = hn::MulAdd(r * z, s, r);
  V c = set(-1.13596475577881948265e-11);
  c = hn::MulAdd(c, z, set(2.08757232129817482790e-09));
  c = hn::MulAdd(c, z, set(-2.75573143513906633035e-07));
  c = hn::MulAdd(c, z, set(2.48015872894767294178e-05));
  c = hn::MulAdd(c, z, set(-1.38888888888741095749e-03));
  c = hn::MulAdd(c, z, set(4.16666666666666019037e-02));
  c = hn::MulAdd(z * z, c, hn::NegMulAdd(set(0.5), z, set(1.0)));

  // Odd quadrants exchange sine and cosine; the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
  const auto quadrant = hn::BitCast(du, shifted);
  const auto one = hn::Set(du, 1), two = hn::Set(du, 2);
  const auto swapped = hn::MaskFromVec(hn::BitCast(d, hn::Zero(du) - hn::And(quadrant, one)));
  const V flip_sine = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(quadrant, two)));
  const V flip_cosine = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(quadrant + one, two)));
  sine = hn::Xor(hn::IfThenElse(swapped, c, s), flip_sine);
  cosine = hn::Xor(hn::IfThenElse(swapped, s, c), flip_cosine);
}

/// Angle of the direction (cosine, sine) of every lane, which need not have length 1, in [-pi, pi]: absolute
/// error below 5e-16. Zero for (0, 0).
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V angle_of(D d, V cosine, V sine) {
  namespace hn = hwy::HWY_NAMESPACE;
  const auto set = [d](double value) { return hn::Set(d, value); };
  const V zero = hn::Zero(d);
  const V x = hn::Abs(cosine), y = hn::Abs(sine);
  // atan(y/x) from 0, pi/4 or pi/2, whichever is nearest, so that the argument of the series is at most 0.66.
  const auto steep = y > x * set(2.41421356237309504880);
  const auto middle = hn::AndNot(steep, y > x * set(0.66));
  const V numerator = hn::IfThenElse(steep, hn::Neg(x), hn::IfThenElse(middle, y - x, y));
  const V denominator = hn::IfThenElse(steep, y, hn::IfThenElse(middle, y + x, x));
  const V base = hn::IfThenElse(steep, set(1.57079632679489661923),
                                hn::IfThenElseZero(middle, set(0.78539816339744830962)));
  const auto nothing = denominator == zero;
  const V t = hn::IfThenElse(nothing, zero, numerator) / hn::IfThenElse(nothing, set(1.0), denominator);

  // Rational approximation of (atan t - t)/t^3 (Moshier 1989, Cephes atan.c).
  const V z = t * t;
  V p = set(-8.750608600031904122785e-01);
  p = hn::MulAdd(p, z, set(-1.615753718733365076637e+01));
  p = hn::MulAdd(p, z, set(-7.500855792314704667340e+01));
  p = hn::MulAdd(p, z, set(-1.228866684490136173410e+02));
  p = hn::MulAdd(p, z, set(-6.485021904942025371773e+01));
  V q = z + set(2.485846490142306297962e+01);
  q = hn::MulAdd(q, z, set(1.650270098316988542046e+02));
  q = hn::MulAdd(q, z, set(4.328810604912902668951e+02));
  q = hn::MulAdd(q, z, set(4.853903996359136964868e+02));
  q = hn::MulAdd(q, z, set(1.945506571482613964425e+02));
  const V acute = base + hn::MulAdd(t, z * p / q, t);
  return hn::CopySign(hn::IfThenElse(cosine < zero, set(3.14159265358979323846) - acute, acute), sine);
}

}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
