#pragma once

#include <optional>
#include <span>

#include "zwidth/math/spatial.h"

/// Plies of parallel fibres, and what a wall made of several of them is worth: by the source's averaging of
/// moduli and by classical lamination theory.

namespace zwidth {

/// One ply: axis 1 along the fibres, axis 2 across them.
struct PlyModuli {
  double longitudinal = 0.0;  ///< E1 [Pa]
  double transverse = 0.0;    ///< E2 [Pa]
  double shear = 0.0;         ///< G12 [Pa]
  double poisson = 0.0;       ///< nu12 [-]

  double poisson_transverse() const { return poisson * transverse / longitudinal; }  ///< nu21
  /// Moduli positive and finite, nu12^2 < E1/E2: the ply resists every deformation.
  bool valid() const;
};

/// A ply from its fibres and matrix by the rule of mixtures (Görgülü 2018, eq 4.60-4.66): E1 = Ef Vf + Em Vm,
/// 1/E2 = Vf/Ef + Vm/Em, 1/G12 = Vf/Gf + Vm/Gm, nu12 = nuf Vf + num Vm.
struct Constituent {
  double elastic_modulus = 0.0;  ///< E [Pa]
  double shear_modulus = 0.0;    ///< G [Pa]
  double poisson_ratio = 0.0;    ///< nu [-]
};
/// Nothing unless moduli are positive and 0 <= fibre_share <= 1.
std::optional<PlyModuli> ply_of(const Constituent& fibre, const Constituent& matrix,
                                double fibre_share) noexcept;

/// Equal plies at one angle.
struct PlyGroup {
  double angle = 0.0;  ///< of the fibres from the x axis of the wall, for a tube its own axis [rad]
  double count = 0.0;  ///< how many, or their share
};

/// Moduli of a wall in its own axes x and y.
struct WallModuli {
  double axial = 0.0;       ///< Ex [Pa]
  double transverse = 0.0;  ///< Ey [Pa]
  double shear = 0.0;       ///< Gxy [Pa]
};

/// One ply turned by an angle [rad] (Görgülü 2018, eq 4.67-4.69). REQUIRES: ply.valid().
WallModuli turned_ply(const PlyModuli& ply, double angle) noexcept;

/// How the shear modulus of the plies at +-45 deg is found.
enum class ShearAt45 {
  textbook,  ///< eq 4.69
  printed,   ///< with the misprint of eq 5.175 and 5.178, from which the source's numbers come
};

/// Mean of the plies' moduli, weighted with their numbers (Görgülü 2018, eq 5.179-5.181). This is the source's
/// rule and not lamination theory: plies side by side share their strain in all directions, not in each alone.
/// Nothing unless the ply is valid, no count is negative and one is positive.
std::optional<WallModuli> mean_moduli(const PlyModuli& ply, std::span<const PlyGroup> plies,
                                      ShearAt45 shear = ShearAt45::textbook) noexcept;

/// Moduli in the plane of a laminate by classical lamination theory (Jones 1999, section 4.2): all plies share
/// the strains, A = sum of their reduced stiffnesses, moduli from its inverse. The stacking order does not
/// matter for a wall that bends as part of a tube. Nothing unless as above.
std::optional<WallModuli> laminate_moduli(const PlyModuli& ply, std::span<const PlyGroup> plies) noexcept;

}  // namespace zwidth
