#pragma once

#include <array>
#include <optional>
#include <span>

#include "zwidth/math/section.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/r_cube.h"

/// How the source of the R-CUBE sizes it: the indices, constraints and choices of Görgülü 2018, chapters 6
/// and 7.

namespace zwidth {

/// Driven angle that a cube-shaped workspace of half edge h takes to either side: asin(h/l1) (eq 6.23) [rad].
/// Nothing unless 0 < h <= l1, both finite [m].
std::optional<double> r_cube_max_angle(double drive_link, double half_workspace) noexcept;

/// The drive link that does it within `max_angle`: h/sin qmax (eq 6.24) [m]. Nothing unless h > 0 and
/// 0 < max_angle <= pi/2.
std::optional<double> r_cube_drive_link(double max_angle, double half_workspace) noexcept;

/// Smallest singular value of J_m within +-qmax, l1 cos qmax [m/rad] (eq 6.8): the source's manipulability
/// index.
double r_cube_manipulability_index(double drive_link, double max_angle) noexcept;

/// 1/cos^2 qmax (eq 6.18): the source's condition index, which is the square of the largest condition number of
/// J_m within +-qmax.
double r_cube_condition_index(double max_angle) noexcept;

/// The three variables of the source's search; l1 and S follow from the workspace.
struct RCubeDesign {
  double max_angle = 0.0;         ///< qmax [rad]
  double inner_link = 0.0;        ///< l2 [m]
  double outer_link = 0.0;        ///< l3 [m]
  double half_workspace = 0.060;  ///< half the edge of the cube that the tool is to reach [m]
  double half_clearance =
      0.065;  ///< h, half the edge of the larger cube within which no arm is to be singular [m]
};

/// Left sides of the source's constraints 3 to 8, which hold where they are not positive.
struct RCubeConstraints {
  double far_low = 0.0;      ///< 3: cos^2 q3 - 1 at C2, the far corner below [-]
  double far_high = 0.0;     ///< 4: at C3, the far corner above; always equal to constraint 3
  double near = 0.0;         ///< 5: at C5, the middle of the near side
  double raised_far = 0.0;   ///< 6: at B3, the far corner above with the drive link at qmax
  double raised_near = 0.0;  ///< 7: at B5, the middle of the near side with the drive link at qmax
  double elbow = 0.0;  ///< 8: sin(q2 + q3) at C1, the near corner below: the elbow keeps clear of the hand
  double raised_elbow = 0.0;  ///< 8: the same at B1, with the drive link at qmax

  std::array<double, 7> all() const {
    return {far_low, far_high, near, raised_far, raised_near, elbow, raised_elbow};
  }
  double worst() const;
};

/// Eq 6.45-6.52 as corrected in docs/devices/r-cube.md. Where the two outer links do not reach a point,
/// constraint 8 takes them as stretched or folded. Nothing unless the design's lengths are positive and finite
/// and 0 < qmax < pi/2.
std::optional<RCubeConstraints> r_cube_constraints(const RCubeDesign& design) noexcept;

/// (value - min)/(max - min) (eq 7.1). Nothing unless max > min.
std::optional<double> normalised(double value, double min, double max) noexcept;

/// Index of the design of smallest sqrt((a^2 + weight b^2)/2) with a = 1 - frequency and b = 1 -
/// manipulability, both normalised (Görgülü 2018, section 7.2). Nothing if the lists are empty or unequally
/// long.
std::optional<int> r_cube_choice(std::span<const double> frequency, std::span<const double> manipulability,
                                 double weight) noexcept;

/// What the source weighs against each other in the section of a link (section 6.5).
struct HollowSection {
  double outer_diameter = 1.0;   ///< D [m]
  double length = 1.0;           ///< l [m]
  double density = 1.0;          ///< rho [kg/m^3]
  double elastic_modulus = 1.0;  ///< E [Pa]
};

/// The d/D in `range` with the smallest root mean square of compliance l^3/(12 E I) and inertia (eq 6.86), each
/// normalised over the range (eq 7.1). It depends on the range. Eq 6.86 counts m l^2/4 + m l^2/3 for the
/// length, that is the inertia about the end and once more the centre's share. Nothing unless 0 <= range.min <
/// range.max < 1 and all of `section` is positive.
std::optional<double> hollow_section_ratio(const HollowSection& section, const Interval& range) noexcept;

/// Frobenius norm of M_1^-1 K_C1 with the joint-space mass matrix of a leg and the first three rows of its
/// stiffness (eq 4.107), the omega_n of table 7.3. Its units are mixed: it ranks designs, and is no frequency.
/// REQUIRES: mass positive definite.
double r_cube_frequency_index(const Matrix3& leg_mass, const Matrix6& leg_stiffness) noexcept;

/// What all links of a design are made of while it is searched for. The source does not say.
struct RCubeLinkChoice {
  Section section;               ///< of a tube
  double elastic_modulus = 0.0;  ///< E [Pa]
  double shear_modulus = 0.0;    ///< G [Pa]
  double density = 0.0;          ///< [kg/m^3]
  double platform_mass = 0.0;    ///< [kg]
};

/// The source's objectives, all to be small.
struct RCubeObjectives {
  double closeness = 0.0;   ///< O1 = tan qmax (eq 6.82)
  double inertia = 0.0;     ///< O2 = det M_C with two legs folded and one at home (eq 6.83) [kg^3]
  double compliance = 0.0;  ///< O3 = 1/det K_CA fully extended (eq 6.84) [(m/N)^3]
};
/// Nothing where the design's lengths are not positive or its legs do not reach these two postures.
std::optional<RCubeObjectives> r_cube_objectives(const RCubeDesign& design,
                                                 const RCubeLinkChoice& links) noexcept;

}  // namespace zwidth
