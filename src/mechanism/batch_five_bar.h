#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "zwidth/mechanism/five_bar.h"

/// The five-bar for many tool points at once: structure of arrays, SIMD chosen at run time (Highway), no
/// trigonometry and at most three divisions a point. The one-pose code in five_bar.h is its scalar twin.

namespace zwidth {

/// A five-bar in one working mode, ready for batch work. Lengths that cannot be assembled reach nothing.
class FiveBarBatch {
 public:
  explicit FiveBarBatch(const FiveBarGeometry& geometry, WorkingMode mode = {},
                        const std::array<Interval, 2>& ranges = kAnyCrankAngle);

  /// How many points are what. A point is reachable as in `five_bar_inverse`, joint ranges included.
  struct Count {
    std::int64_t reachable = 0;  ///< the singular ones among them
    std::int64_t above = 0;      ///< regular, with a condition number above the limit by more than 1e-12 of it
    std::int64_t singular = 0;   ///< condition number infinite by the rule of `FiveBarState::condition_number`
  };

  /// REQUIRES: x and y have as many elements.
  Count count_above(std::span<const double> x, std::span<const double> y, double limit) const;

  /// Condition number of every point: infinity at a singularity, NaN out of reach.
  /// REQUIRES: all spans have as many elements.
  void condition_numbers(std::span<const double> x, std::span<const double> y, std::span<double> out) const;

  /// Cosine and sine of both cranks, leg after leg: cosine[leg n + p], and the usual Jacobian by rows, entry
  /// after entry: jacobian[entry n + p]. All are NaN out of reach, the Jacobian also where det Jp = 0.
  /// REQUIRES: x, y have n elements, cosine and sine 2 n, jacobian 4 n.
  void inverse(std::span<const double> x, std::span<const double> y, std::span<double> cosine,
               std::span<double> sine, std::span<double> jacobian) const;

  /// What the kernels read.
  struct Parameters {
    double r1 = 0.0, r2 = 0.0, r3 = 0.0;  // [m]
    std::array<double, 2> sign{};         // s1, s2
    double outer2 = 0.0, inner2 = 0.0;    // squares of r1 + r2 and |r1 - r2| [m^2]
    double reach2 = -1.0, core2 = 0.0;    // the same with the tolerance of the boundary; reach2 < 0: nothing
    double outer_rounding = 0.0,
           inner_rounding = 0.0;  // differences of squares up to here are a boundary [m^2]
    // The range of a crank is cos(theta - middle) >= cos_half; below -1 where every angle is allowed.
    std::array<double, 2> cos_middle{}, sin_middle{}, cos_half{};
  };

 private:
  Parameters parameters_;
};

}  // namespace zwidth
