#pragma once

#include <optional>

#include "zwidth/description/description.h"

namespace zwidth {

/// A cantilever with a flexible part next to the wall and a rigid part beyond it, loaded at its end by a force:
/// the leaf spring that preloads a cable (Neal 2015, section 4.5, eq 4.52-4.68).
///
/// x runs from the wall [m]; deflection and slope are negative for a force that bends it down, as is the
/// moment. It is made bent the other way by -deflection(x), so that it is straight under the wanted force.
/// Every function of x is empty outside [0, length].
class Flexure {
 public:
  /// Flexible and rigid length, width, height in the direction of bending [m], Young's modulus [Pa].
  /// Empty unless all are positive and finite.
  static std::optional<Flexure> make(double flexible_length, double rigid_length, double width, double height,
                                     double elastic_modulus);
  static std::optional<Flexure> make(const FlexureDescription& description);

  double length() const { return flexible_length_ + rigid_length_; }  ///< [m]
  double area_moment() const;                                         ///< w h^3 / 12 [m^4]
  double section_modulus() const;                                     ///< w h^2 / 6 [m^3]
  double stiffness() const;  ///< force per deflection at the end [N/m] (eq 4.68)

  std::optional<double> deflection(double force, double x) const;  ///< [m] (eq 4.65, 4.67)
  std::optional<double> slope(double force, double x) const;       ///< [rad] (eq 4.64, 4.66)
  std::optional<double> moment(double force, double x) const;      ///< [N m] (eq 4.63)

  /// Largest bending stress, at the wall [Pa].
  double bending_stress(double force) const;

  /// Yield strength over bending stress; empty when the strength is not given (NaN or not positive) or nothing
  /// bends.
  std::optional<double> safety_factor(double force, double yield_strength) const;

 private:
  double flexible_length_ = 0.0;
  double rigid_length_ = 0.0;
  double width_ = 0.0;
  double height_ = 0.0;
  double elastic_modulus_ = 0.0;
};

}  // namespace zwidth
