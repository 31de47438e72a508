#pragma once

#include <array>
#include <span>

#include "zwidth/mechanism/r_cube_stiffness.h"

/// Stiffness of the R-CUBE at many tool points at once: what the legs' compliances come to, written out (the
/// structure is statically determinate), with neither angles nor matrices on the way. `stiffness` and
/// `r_cube_stiffness` are its twins for one posture.

namespace zwidth {

/// One row per figure of a tool point. The compliance is that against pure forces on the tool, which may turn.
enum class RCubeElasticFigure {
  give_xx,  ///< displacement along x per force along x [m/N]
  give_yy,
  give_zz,
  give_xy,
  give_xz,
  give_yz,
  softest,   ///< force per displacement in the softest direction [N/m]
  stiffest,  ///< [N/m]
};
inline constexpr int kRCubeElasticFigures = 8;

/// An R-CUBE ready for it.
class RCubeStiffnessBatch {
 public:
  /// REQUIRES: geometry valid, rigidities positive, elbow +1 or -1. The links' own lengths are the geometry's.
  RCubeStiffnessBatch(const RCubeLinks& links, int elbow = -1) noexcept;

  /// Every figure of every tool point, figure after figure: out[f n + p]; NaN where a leg does not reach or
  /// stands singular. Joint ranges are not looked at. REQUIRES: x, y, z have n elements, out
  /// kRCubeElasticFigures n.
  void figures(std::span<const double> x, std::span<const double> y, std::span<const double> z,
               std::span<double> out) const noexcept;

  /// K_C, the entries of its lower triangle row by row: out[e n + p] for e < 21; NaN as above.
  /// REQUIRES: x, y, z have n elements, out 21 n.
  void stiffness(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                 std::span<double> out) const noexcept;

 private:
  // Flexibilities of one link as the sums below need them.
  struct Link {
    double length, stretch, bend, twist;  // 1/EA, 1/EI, 1/GJ
  };
  std::array<Link, 3> links_;
  double offset_, elbow_;

  friend struct RCubeStiffnessKernel;
};

}  // namespace zwidth
