#pragma once

#include <array>
#include <optional>

#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/sizes.h"

/// Stiffness of any mechanism of legs by the method of virtual joints (Pashkevich, Chablat & Wenger 2009):
/// links that are beams end in springs of six freedoms, passive joints give way, and the legs hold the tool
/// side by side. Displacements and loads of the tool stack linear over angular, in the base frame, about the
/// tool point.

namespace zwidth {

/// What the active joints do while the tool is loaded.
enum class DriveState {
  held,  ///< motors stand still; what lies between motor and joint may give
  free,  ///< nothing holds them
};

struct StiffnessOptions {
  DriveState drives = DriveState::held;
  /// Between motor and joint, one for each active joint [N m/rad, N/m]; infinity: rigid. Empty: all rigid.
  ActiveVector drive_stiffness = {};
};

/// What one leg holds the tool with.
struct LegStiffness {
  int wrenches = 0;  ///< number of independent wrenches that it can exert while its passive joints are at rest
  std::array<Vector6, 6> wrench;  ///< those, about the tool point [N, N m]
  Matrix6 compliance;             ///< what they move along each other, in the first `wrenches` rows and columns
  std::array<Vector6, 6> root;    ///< K = sum of r r^T over the first `wrenches`

  Matrix6 matrix() const noexcept;  ///< its share of the stiffness [N/m, N, N m/rad]
};

/// Stiffness of the tool in one posture, and of each leg.
struct Stiffness {
  /// Some leg exerts a wrench along which nothing in it gives: neither a link that is a beam nor a drive. The
  /// matrix then means nothing.
  bool rigid = true;
  /// 6, or 3 where all legs hold the tool in points: then it is displaced without turning, and the angular
  /// parts are zero.
  int rows = 6;
  Matrix6 matrix = Matrix6::Zero();  ///< load per displacement [N/m, N, N m/rad]
  int leg_count = 0;
  std::array<LegStiffness, kMaxLegs> legs;  ///< the first `leg_count`
};

/// Unloaded: the small loads that are meant here do not bend the posture itself. Links that are no beams are
/// rigid. Joints that the hand moves are passive.
Stiffness stiffness(const Posture& posture, const StiffnessOptions& options = {}) noexcept;

/// What the tool does under a load: the inverse of the stiffness.
struct Compliance {
  /// Some displacement meets no resistance; the matrix is then that of the others.
  bool free = false;
  Vector6 free_direction = Vector6::Zero();  ///< that displacement, unit in [m, rad x characteristic length]
  Matrix6 matrix = Matrix6::Zero();          ///< displacement per load [m/N, rad/N, rad/(N m)]
};
/// `length` makes rotations comparable with translations, to tell a free displacement from a soft one;
/// `Mechanism::characteristic_length`, say. REQUIRES: not rigid; length > 0 [m].
Compliance compliance(const Stiffness& stiffness, double length) noexcept;

/// Load per displacement in the tool's own rows (`Mechanism::tool_axes`), while the tool may give in the
/// others: what the hand feels. Where the hand keeps the tool from turning, it is that block of the stiffness
/// itself. Nothing where the compliance is free along them.
std::optional<ToolMatrix> felt_stiffness(const Mechanism& mechanism, const Compliance& compliance) noexcept;

/// Where the give of the tool under a load comes from: shares of the strain energy, which add up to 1.
struct ComplianceShares {
  std::array<double, kMaxJoints> beams{};   ///< of each beam, in the order of `Mechanism::beams()`
  std::array<double, kMaxActive> drives{};  ///< of each active joint's drive
};
/// `options` as for the stiffness. Nothing if the load does no work: the tool is free along it, or it is zero.
std::optional<ComplianceShares> compliance_shares(const Posture& posture, const Stiffness& stiffness,
                                                  const Compliance& compliance, const Vector6& load,
                                                  const StiffnessOptions& options = {}) noexcept;

/// Figures by which Görgülü 2018 compares stiffnesses (section 6.3). All of K, in mixed units.
struct StiffnessIndices {
  double frobenius = 0.0;                ///< S_f [mixed]
  double condition_translation = 0.0;    ///< S_et, of the block of forces and displacements (eq 6.55)
  double condition_rotation = 0.0;       ///< S_er, of the block of moments and rotations (eq 6.56)
  double determinant_translation = 0.0;  ///< S_da (eq 6.74)
  double determinant_rotation = 0.0;     ///< S_dd (eq 6.75)
};
StiffnessIndices stiffness_indices(const Matrix6& stiffness) noexcept;

}  // namespace zwidth
