#include "zwidth/math/beam.h"

namespace zwidth {

BeamRigidity beam_rigidity(const Section& section, double axial, double shear) noexcept {
  return beam_rigidity(section, axial, axial, shear);
}

BeamRigidity beam_rigidity(const Section& section, double axial, double bending, double shear) noexcept {
  return {.axial = axial * section.area,
          .bending_y = bending * section.second_moment_y,
          .bending_z = bending * section.second_moment_z,
          .torsion = shear * section.torsion_constant};
}

BeamFlexibility beam_flexibility(const BeamRigidity& beam, double length) noexcept {
  const double L = length, L2 = L * L, L3 = L2 * L;
  return {.stretch = L / beam.axial,
          .twist = L / beam.torsion,
          .deflection_y = L3 / (3.0 * beam.bending_z),
          .deflection_z = L3 / (3.0 * beam.bending_y),
          .slope_y = -L2 / (2.0 * beam.bending_y),
          .slope_z = L2 / (2.0 * beam.bending_z),
          .turn_y = L / beam.bending_y,
          .turn_z = L / beam.bending_z};
}

Matrix6 beam_compliance(const BeamRigidity& beam, double length) noexcept {
  const BeamFlexibility c = beam_flexibility(beam, length);
  Matrix6 C = Matrix6::Zero();
  C.diagonal() << c.stretch, c.deflection_y, c.deflection_z, c.twist, c.turn_y, c.turn_z;
  C(1, 5) = C(5, 1) = c.slope_z;
  C(2, 4) = C(4, 2) = c.slope_y;
  return C;
}

Matrix6 beam_stiffness(const BeamRigidity& beam, double length) noexcept {
  const double L = length, L2 = L * L, L3 = L2 * L;
  Matrix6 K = Matrix6::Zero();
  K(0, 0) = beam.axial / L;
  K(1, 1) = 12.0 * beam.bending_z / L3;
  K(2, 2) = 12.0 * beam.bending_y / L3;
  K(3, 3) = beam.torsion / L;
  K(4, 4) = 4.0 * beam.bending_y / L;
  K(5, 5) = 4.0 * beam.bending_z / L;
  K(1, 5) = K(5, 1) = -6.0 * beam.bending_z / L2;
  K(2, 4) = K(4, 2) = 6.0 * beam.bending_y / L2;
  return K;
}

}  // namespace zwidth
