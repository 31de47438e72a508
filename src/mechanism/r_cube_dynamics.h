#pragma once

#include <array>
#include <optional>

#include "zwidth/math/section.h"
#include "zwidth/mechanism/r_cube.h"

/// Dynamics of the R-CUBE in closed form (Görgülü 2018, section 5.3, as corrected in docs/devices/r-cube.md):
/// its links as slender bodies whose mass lies on their axes, the platform as a point. For bodies of any kind
/// see dynamics.h; each is the check of the other.

namespace zwidth {

/// How a link's moment of inertia about an axis across its centre is taken.
enum class RCubeInertia {
  about_centre,  ///< m L^2/12 and the section's share
  published,     ///< m L^2/3 and the section's share: eq 5.229, which counts the way to the centre twice
};

/// Masses of the links, equal in all legs. Centres lie in the middle of the links.
struct RCubeMasses {
  RCubeGeometry geometry;
  Vector3 mass = Vector3::Zero();     ///< of drive, inner and outer link [kg]
  Vector3 inertia = Vector3::Zero();  ///< across the link, about its centre [kg m^2]
  double platform = 0.0;              ///< of all legs together, at P [kg]
  Vector3 gravity = Vector3::Zero();  ///< base axes [m/s^2]
};

/// Links of one section each. REQUIRES: density >= 0 [kg/m^3].
RCubeMasses r_cube_masses(const RCubeGeometry& geometry, const std::array<Section, 3>& sections, double density,
                          RCubeInertia inertia = RCubeInertia::about_centre) noexcept;

/// Mass matrix of one leg in q_i1, q_i2, q_i3 with a mass at its tip [kg m^2].
Matrix3 r_cube_leg_mass_matrix(const RCubeMasses& masses, const Vector3& angles, double tip_mass) noexcept;

/// The same of leg 0..2 at the platform point, J_i^-T M_i J_i^-1 (eq 5.223) [kg]. REQUIRES: the leg not
/// singular.
Matrix3 r_cube_leg_cartesian_mass(const RCubeMasses& masses, int leg, const Vector3& angles,
                                  double tip_mass) noexcept;

/// M_C, of the whole device at P (eq 5.223, 5.227) [kg]. Nothing in a singular posture. REQUIRES: closed.
std::optional<Matrix3> r_cube_cartesian_mass(const RCubeMasses& masses, const RCubeSolution& at) noexcept;

/// Figures by which the source compares masses.
struct RCubeMassIndices {
  double determinant = 0.0;  ///< I_m (eq 6.76) [kg^3]
  double condition = 0.0;    ///< I_e, largest over smallest principal mass (eq 6.81)
  double frobenius = 0.0;    ///< I_f (eq 4.98) [kg]
};
/// REQUIRES: mass symmetric.
RCubeMassIndices r_cube_mass_indices(const Matrix3& mass) noexcept;

/// What moves the device as it is asked to.
struct RCubeEffort {
  Vector3 force;   ///< at P, if it alone does [N]
  Vector3 torque;  ///< of the motors, if they alone do: J_m^T force [N m]
};
/// For rates and accelerations of the driven angles [rad/s, rad/s^2] (eq 5.203, 5.210, 5.225). Nothing in a
/// singular posture. REQUIRES: closed.
std::optional<RCubeEffort> r_cube_inverse_dynamics(const RCubeMasses& masses, const RCubeSolution& at,
                                                   const Vector3& rate, const Vector3& acceleration) noexcept;

}  // namespace zwidth
