#pragma once

#include <array>

#include "zwidth/math/beam.h"
#include "zwidth/mechanism/r_cube.h"

/// The elastic R-CUBE leg by leg, as Görgülü 2018 writes it (section 5.2): any angles of one leg, whether the
/// others can follow or not, which its numbers need. For a posture of a device `stiffness` does it for any
/// mechanism, and each is the check of the other.

namespace zwidth {

/// The elastic links, equal in all legs.
struct RCubeLinks {
  RCubeGeometry geometry;
  std::array<BeamRigidity, 3> rigidity;  ///< of drive, inner and outer link
  /// Of the links' own stiffness, where they differ from the geometry's: the source computes with two sets
  /// beside each other, which is no physics [m].
  std::optional<Vector3> stiffness_lengths = {};
};

/// What one leg's links and joints come to, at the platform point P, base axes, linear over angular.
struct RCubeLegElasticity {
  Matrix6 compliance;  ///< C_i = J_theta K_theta^-1 J_theta^T: the links alone, all joints locked [m/N, ...]
  Matrix6 stiffness;   ///< K_Ci: with its passive joints free, the drive held (eq 5.122) [N/m, ...]

  /// K*_Ci = C_i^-1, as if the leg had no passive joints (eq 6.60).
  Matrix6 locked_stiffness() const noexcept;
};

/// Of leg 0..2 at its own angles q_i1, q_i2, q_i3 [rad], unloaded. REQUIRES: geometry valid, rigidities
/// positive.
RCubeLegElasticity r_cube_leg_elasticity(const RCubeLinks& links, int leg, const Vector3& angles) noexcept;

/// The same with the links deflected by a wrench on P, found in one step from the undeflected leg with all its
/// joints locked (the "direct method" of section 5.2.3, from which eq 5.132 comes).
RCubeLegElasticity r_cube_leg_elasticity(const RCubeLinks& links, int leg, const Vector3& angles,
                                         const Vector6& wrench) noexcept;

/// The same with every step taken from the leg as the last one deflected it, its angles fixed, until the
/// deflections stay (the force equilibrium of fig 5.7).
struct RCubeLoadedLeg {
  bool converged = false;  ///< else what stands here is not the answer
  int iterations = 0;
  double residual = 0.0;  ///< last change of a deflection, over the leg's length or in rad
  RCubeLegElasticity elasticity;
};
RCubeLoadedLeg r_cube_loaded_leg(const RCubeLinks& links, int leg, const Vector3& angles, const Vector6& wrench,
                                 double tolerance = 1e-12, int max_iterations = 100) noexcept;

/// K_C of all legs at their postures (eq 5.123). REQUIRES: solution.closed().
Matrix6 r_cube_stiffness(const RCubeLinks& links, const RCubeSolution& solution) noexcept;

/// Displacement of the platform under a load on P: that of a statically determinate structure, whose three legs
/// carry two wrenches each, so that no matrix is inverted. [m, rad] REQUIRES: solution.closed().
Vector6 r_cube_deflection(const RCubeLinks& links, const RCubeSolution& solution, const Vector6& load) noexcept;

}  // namespace zwidth
