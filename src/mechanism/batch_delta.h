#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/figure.h"

/// The delta for many postures at once: structure of arrays, SIMD chosen at run time (Highway), no trigonometry
/// on the way from tool points to figures. The one-pose code in delta.h and figure.h is its scalar twin.
///
/// A tool point is inside the workspace if the outward root of every leg exists, lies within the joint range
/// (tolerance 1e-9 rad, as `delta_inverse`), and the point is the upper of the two assembly modes of its
/// angles.

namespace zwidth {

/// A delta ready for batch work. Joint ranges narrower than 1e-6 rad are not resolved.
class DeltaBatch {
 public:
  DeltaBatch(const DeltaGeometry& geometry, const Interval& joint_range, const DriveLimits& limits = {});

  /// One extreme value of a lattice plane, and the column where it is met.
  struct Extreme {
    double value = 0.0;
    std::int64_t j = 0;  ///< lattice index along y
  };

  /// What a plane of the lattice comes to. All but `inside` mean nothing if that is 0.
  struct PlaneSummary {
    std::int64_t inside = 0;                 ///< lattice points in the workspace
    std::array<double, kFigureCount> sum{};  ///< of each figure over them
    std::array<Extreme, kFigureCount> min{};
    std::array<Extreme, kFigureCount> max{};
    std::int64_t j_first = 0, j_last = 0;  ///< smallest and largest index along y inside
    std::int64_t k_first = 0, k_last = 0;  ///< smallest and largest index along z inside
  };

  /// Indices first..last.
  struct IndexRange {
    std::int64_t first = 0, last = -1;
  };

  /// Sweeps the lattice plane x = i spacing over the indices along y and z given, and reduces it: nothing is
  /// stored per point. With `all` false only the first kCoreFigureCount figures are computed. REQUIRES:
  /// |indices| < 2^31.
  PlaneSummary sweep_plane(std::int64_t i, IndexRange j, IndexRange k, double spacing, bool all) const;

  /// Whether each point is inside: out[n] = 1 or 0. REQUIRES: all spans have as many elements.
  void inside(std::span<const double> x, std::span<const double> y, std::span<const double> z,
              std::span<std::uint8_t> out) const;

  /// Cosine and sine of the driven angles (outward roots), leg after leg: cosine[leg n + p], and whether the
  /// point is inside. Where a leg cannot reach the point its cosine and sine are NaN. REQUIRES: x, y, z, out
  /// have n elements, cosine and sine 3 n.
  void inverse(std::span<const double> x, std::span<const double> y, std::span<const double> z,
               std::span<double> cosine, std::span<double> sine, std::span<std::uint8_t> out) const;

  /// Every figure of every point, figure after figure: out[f n + p]; NaN for points outside.
  /// REQUIRES: x, y, z have n elements, out kFigureCount n.
  void figures(std::span<const double> x, std::span<const double> y, std::span<const double> z,
               std::span<double> out) const;

  /// Tool points (upper assembly mode) and det J of driven angles given by cosine and sine, leg after leg as in
  /// `inverse`; the joint range is not looked at. Where the loops do not close all four are NaN.
  /// REQUIRES: x, y, z, det have n elements, cosine and sine 3 n.
  void forward(std::span<const double> cosine, std::span<const double> sine, std::span<double> x,
               std::span<double> y, std::span<double> z, std::span<double> det) const;

  /// A box that holds every point that all three legs reach [m]; not tight.
  std::array<Interval, 3> reach_box() const;

  /// What the kernels read.
  struct Parameters {
    double d2 = 0.0, d3 = 0.0, d5 = 0.0;         // [m]
    double cos_middle = 1.0, sin_middle = 0.0;   // the joint range is cos(theta - middle) >= cos_half
    double cos_half = -2.0;                      // below -1 where every angle is allowed
    std::array<double, 2> cos_end{}, sin_end{};  // both ends of the joint range
    std::array<double, 3> torque{}, inverse_torque{}, step{};  // per joint
  };

 private:
  Parameters parameters_;
};

/// Name of the SIMD instruction set in use ("AVX3", "AVX2", ...).
const char* batch_target_name();

}  // namespace zwidth
