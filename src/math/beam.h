#pragma once

#include "zwidth/math/section.h"
#include "zwidth/math/spatial.h"

/// A straight uniform beam, held at one end and loaded at the other (Euler & Bernoulli: no shear).
///
/// Its frame has axis 1 from the held end to the loaded one and the section's axes y and z after it.
/// Displacements and loads of the loaded end stack linear over angular.

namespace zwidth {

/// What a beam's section and material resist deformation with.
struct BeamRigidity {
  double axial = 0.0;      ///< E A [N]
  double bending_y = 0.0;  ///< E I_y, about y [N m^2]
  double bending_z = 0.0;  ///< E I_z, about z [N m^2]
  double torsion = 0.0;    ///< G J [N m^2]

  bool operator==(const BeamRigidity&) const = default;
};

/// `axial` [Pa] is the modulus along the beam, which stretching and bending strain; `shear` [Pa] that of twist.
BeamRigidity beam_rigidity(const Section& section, double axial, double shear) noexcept;
/// With another modulus in bending than along the beam. Görgülü 2018 (eq 4.59) takes the transverse one of a
/// laminate there; this is for its numbers, not for design.
BeamRigidity beam_rigidity(const Section& section, double axial, double bending, double shear) noexcept;

/// What the loaded end does per load on it: the entries of its compliance that are not zero.
struct BeamFlexibility {
  double stretch = 0.0;     ///< along 1 per force along 1, L/(E A) [m/N]
  double twist = 0.0;       ///< about 1 per moment about 1, L/(G J) [rad/(N m)]
  double deflection_y = 0;  ///< along y per force along y, L^3/(3 E I_z) [m/N]
  double deflection_z = 0;  ///< along z per force along z, L^3/(3 E I_y) [m/N]
  double slope_y = 0.0;  ///< about y per force along z, -L^2/(2 E I_y), and along z per moment about y [rad/N]
  double slope_z = 0.0;  ///< about z per force along y, L^2/(2 E I_z), and along y per moment about z [rad/N]
  double turn_y = 0.0;   ///< about y per moment about y, L/(E I_y) [rad/(N m)]
  double turn_z = 0.0;   ///< about z per moment about z, L/(E I_z) [rad/(N m)]
};
/// REQUIRES: length > 0, rigidities > 0.
BeamFlexibility beam_flexibility(const BeamRigidity& beam, double length) noexcept;

/// Displacement of the loaded end per load on it. [m/N, rad/N, rad/(N m)] REQUIRES: length > 0, rigidities > 0.
Matrix6 beam_compliance(const BeamRigidity& beam, double length) noexcept;

/// Its inverse, written out (Görgülü 2018, eq 4.58).
Matrix6 beam_stiffness(const BeamRigidity& beam, double length) noexcept;

}  // namespace zwidth
