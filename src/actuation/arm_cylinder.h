#pragma once

#include <optional>

#include "zwidth/description/description.h"

/// An arm turned by a cylinder between a pin on the base and a pin on the arm (Akhoondi Asadi 2017,
/// section 3.1).
///
/// Everything lies in one plane: pivot at the origin, arm along +x at angle zero, angles counter-clockwise. A
/// cylinder force is positive when it pushes, that is when it lengthens the cylinder. The thesis calls the
/// layouts "configuration one" and so on; `ArmCylinderLayout` has its numbers and where the pins are.

namespace zwidth {

/// Below this |d'| [m/rad] a cylinder cannot turn its arm: a dead point.
inline constexpr double kDeadPointLever = 1e-9;

/// The largest cylinder force over a range of arm angles, and the angle where it is needed.
struct PeakForce {
  double force = 0.0;  ///< magnitude [N]
  double angle = 0.0;  ///< [rad]
};

/// Two numbers and an angle that say all about how force and length depend on the arm's angle, whatever the
/// layout: d^2 = a^2 + b^2 + 2 a b sin(sign theta - alpha).
struct ArmCylinderForm {
  double a = 0.0;      ///< from the pivot to the base pin [m]
  double b = 0.0;      ///< from the pivot to the arm pin [m]
  double alpha = 0.0;  ///< [rad]
  int sign = 1;        ///< +1 where the cylinder lengthens as the angle grows, -1 where it shortens
};

class ArmCylinder {
 public:
  /// Throws std::invalid_argument naming the length unless all are finite, l1 and l2 are positive (in `three`
  /// l2, and l0 and l1 not both zero).
  explicit ArmCylinder(const ArmCylinderDescription& description);

  const ArmCylinderDescription& description() const { return description_; }

  /// Pin to pin at an arm angle [rad], d [m] (3.1, 3.17, 3.31, 3.45).
  double length(double angle) const noexcept;

  /// d' = dd/dtheta [m/rad]: torque per push force, with its sign. Zero where both pins coincide.
  double lever(double angle) const noexcept;

  /// Angle that the thesis uses for the cylinder's direction, phi [rad] (3.16, 3.30, 3.44, 3.59).
  double phi(double angle) const noexcept;

  /// Angle between the lever and the cylinder at the arm pin, beta [rad].
  double beta(double angle) const noexcept;

  /// From the pivot to the arm pin [m].
  double arm_radius() const noexcept;

  /// Torque about the pivot [N m] of a push force [N].
  double torque(double push, double angle) const noexcept { return push * lever(angle); }

  /// Push force [N] for a torque [N m]; empty at a dead point.
  std::optional<double> push_for_torque(double torque, double angle) const noexcept;

  /// Magnitude of the cylinder force [N] that carries a load [N] hanging down at `distance` [m] along the arm
  /// (3.13, 3.28, 3.42, 3.57 as corrected); empty at a dead point.
  std::optional<double> required_force(double load, double distance, double angle) const noexcept;

  /// The largest of it over a range of angles [rad]; empty if there is a dead point in the range.
  std::optional<PeakForce> peak_required_force(double load, double distance, const Interval& range) const;

  /// Arm angle in (-pi, pi] at which the cylinder is `length` [m] long, of the two the nearer to zero; empty if
  /// there is none. Throws std::invalid_argument unless the length is positive and finite.
  std::optional<double> angle(double length) const;

  /// Whether d' keeps its sign over a range of angles [rad], so that each length belongs to one angle.
  bool keeps_direction(const Interval& range) const noexcept;

  ArmCylinderForm form() const noexcept;

 private:
  ArmCylinderDescription description_;
  // d^2 = s + 2 (A cos theta + B sin theta)
  double s_ = 0.0;
  double A_ = 0.0;
  double B_ = 0.0;
};

// ------------------------------------------------------------------------------------------------ synthesis

/// What a cylinder should do: be `min_length` and `max_length` long at the two ends of a range of arm angles
/// from -half_range to +half_range.
struct CylinderTravel {
  double min_length = 0.0;  ///< pin to pin, rod in, d_min [m]
  double max_length = 0.0;  ///< pin to pin, rod out, d_max [m]
  double half_range = 0.0;  ///< theta_m, between 0 and 90 deg [rad]

  double stroke() const { return max_length - min_length; }
};

/// Each layout's lengths come from a quadratic; both roots are linkages.
enum class DesignRoot { minus, plus };

// Every function below throws std::invalid_argument unless 0 < min_length < max_length and 0 < half_range <
// pi/2, all finite, and is empty where no linkage of the layout has this travel ("infeasible design"). Whether
// d' keeps its sign within the range is for `ArmCylinder::keeps_direction` to say. Retracted lengths are
// filled in.

/// Layout `one` (3.9 corrected, 3.10); plus: l1 >= l2, minus: the two swapped.
std::optional<ArmCylinderDescription> design_one(const CylinderTravel& travel,
                                                 DesignRoot root = DesignRoot::plus);

/// Layout `two`, or its mirror image `two_mod`, for a lever l2 [m] of one's choice (3.23, 3.25, 3.37, 3.39;
/// the thesis prints the minus root only). Throws for a lever that is not positive.
std::optional<ArmCylinderDescription> design_two(const CylinderTravel& travel, double lever, DesignRoot root,
                                                 ArmCylinderLayout layout = ArmCylinderLayout::two);

/// The levers [m] for which `design_two` has an answer.
Interval feasible_levers(const CylinderTravel& travel);

/// The double root of `design_two`: the shortest lever there is, with equal forces at both ends of the range.
/// It stays within a percent or so of the least peak force that any linkage can have.
ArmCylinderDescription design_two_optimal(const CylinderTravel& travel,
                                          ArmCylinderLayout layout = ArmCylinderLayout::two);

/// Layout `three` for a base pin at a height h and a distance l2 [m] of one's choice (3.50-3.54 corrected).
/// Throws for a distance that is not positive.
std::optional<ArmCylinderDescription> design_three(const CylinderTravel& travel, double height,
                                                   double base_distance, DesignRoot root = DesignRoot::plus);

/// Layout `three` that does what `design_two_optimal` does, packed along the arm: l0 = 0.
ArmCylinderDescription design_three_optimal(const CylinderTravel& travel);

/// Of all linkages with this travel, the one whose largest required force is least, as layout `two` (l0 may be
/// negative). All layouts share one free parameter, alpha of `ArmCylinderForm`; this searches it. Empty where
/// every linkage has a dead point in the range.
std::optional<ArmCylinderDescription> design_least_peak(const CylinderTravel& travel);

/// What no linkage can undercut: 2 F l_F sin(theta_m) / stroke [N], the work of lifting `load` [N] at
/// `distance` [m] over the range spread evenly over the stroke [m]. Throws std::invalid_argument for a stroke
/// that is not positive or a half range outside (0, pi/2).
double minimum_peak_force(double stroke, double half_range, double load, double distance);

}  // namespace zwidth
