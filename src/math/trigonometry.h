#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Sine, cosine and angle without calls and with hardly a branch, so that those of several joints overlap:
/// three sines and cosines in half the time of the C library's, to its accuracy within two units in the last
/// place of 1.

namespace zwidth {

struct SineCosine {
  double sine = 0.0;
  double cosine = 1.0;
};

/// Sine and cosine of an angle [rad]; absolute error below 2.5e-16 for any finite angle, NaN otherwise.
inline SineCosine sine_cosine(double angle) {
  // Beyond, the reduction below loses digits.
  if (!(std::abs(angle) < 1e5)) return {std::sin(angle), std::cos(angle)};

  // angle = quarter pi/2 + r with |r| <= pi/4; pi/2 in two parts, the first with 33 bits (Cody and Waite 1980).
  constexpr double kRound =
      6755399441055744.0;  // 1.5 2^52: adding it leaves the nearest integer in the low bits
  const double shifted = angle * 0.63661977236758134308 + kRound;
  const double quarter = shifted - kRound;
  const double r = (angle - quarter * 1.57079632673412561417) - quarter * 6.07710050650619224932e-11;

  // Minimax polynomials of FreeBSD's libm (Sun 1993, k_sin.c and k_cos.c).
  const double z = r * r;
  const double sine_tail = -1.66666666666666324348e-01 +
                           z * (8.33333333332248946124e-03 +
                                z * (-1.98412698298579493134e-04 +
                                     z * (2.75573137070700676789e-06 +
                                          z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
  const double cosine_tail =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  const double s = r + r * z * sine_tail, c = (1.0 - 0.5 * z) + z * z * cosine_tail;

  const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
  const bool swapped = (quadrant & 1) != 0;
  const double sine = swapped ? c : s, cosine = swapped ? s : c;
  // Signs by flipping the top bit: the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
  const std::uint64_t flip_sine = (quadrant & 2) << 62, flip_cosine = ((quadrant + 1) & 2) << 62;
  return {std::bit_cast<double>(std::bit_cast<std::uint64_t>(sine) ^ flip_sine),
          std::bit_cast<double>(std::bit_cast<std::uint64_t>(cosine) ^ flip_cosine)};
}

/// Angle of the direction (cosine, sine), which need not have length 1, in [-pi, pi]: atan2(sine, cosine) with
/// an absolute error below 5e-16. Zero for (0, 0).
inline double angle_of(double cosine, double sine) {
  const double x = std::abs(cosine), y = std::abs(sine);
  // atan(y/x) from 0, pi/4 or pi/2, whichever is nearest, so that the argument of the series is at most 0.66.
  const bool steep = y > 2.41421356237309504880 * x, middle = !steep && y > 0.66 * x;
  const double numerator = steep ? -x : middle ? y - x : y;
  const double denominator = steep ? y : middle ? y + x : x;
  const double base = steep ? 1.57079632679489661923 : middle ? 0.78539816339744830962 : 0.0;
  const double t = denominator == 0.0 ? 0.0 : numerator / denominator;

  // Rational approximation of (atan t - t)/t^3 (Moshier 1989, Cephes atan.c).
  const double z = t * t;
  const double p =
      (((-8.750608600031904122785e-01 * z - 1.615753718733365076637e+01) * z - 7.500855792314704667340e+01) *
           z -
       1.228866684490136173410e+02) *
          z -
      6.485021904942025371773e+01;
  const double q = ((((z + 2.485846490142306297962e+01) * z + 1.650270098316988542046e+02) * z +
                     4.328810604912902668951e+02) *
                        z +
                    4.853903996359136964868e+02) *
                       z +
                   1.945506571482613964425e+02;
  const double acute = base + (t * (z * p / q) + t);
  const double upper = cosine < 0.0 ? 3.14159265358979323846 - acute : acute;
  return std::copysign(upper, sine);
}

}  // namespace zwidth
