#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/actuation/cylinder.h"
#include "zwidth/actuation/drive.h"
#include "zwidth/description/description.h"

namespace zwidth {

/// What sets the highest pressure of a chamber.
enum class PressureLimiter { supply, regulator, cylinder };

/// "supply", "regulator", "cylinder".
const char* to_string(PressureLimiter limiter);

/// What a cylinder and its regulators are told, for a torque at the joint.
enum class PneumaticStatus {
  ok,
  saturated,   ///< a pressure or a command was clamped: the torque is not what was asked for
  dead_point,  ///< the cylinder cannot turn the joint here; its chambers are at the bias
};
const char* to_string(PneumaticStatus status);

struct PneumaticCommand {
  PneumaticStatus status = PneumaticStatus::dead_point;
  double force = 0.0;                ///< push of the cylinder that was asked for [N]
  ChamberPressures pressures;        ///< gauge [Pa]
  std::array<double, 2> voltages{};  ///< of the regulators of rear and rod chamber [V]
  double torque = 0.0;               ///< that these pressures give at the joint [N m], or force of a slide [N]
};

/// A double-acting cylinder with two regulators and a potentiometer, that moves one active joint. Immutable;
/// what a tick calls (`command`, `torque_range`, `joint_angle`) neither throws nor allocates.
///
/// Torque limits depend on the joint's angle, and differ with the direction: the rod takes from the piston's
/// area on its side. A torque is positive along the joint; for a joint that slides, read force [N] and position
/// [m].
class PneumaticDrive {
 public:
  /// `joint_range` [rad, or m for a slide] is the range of the joint it moves. A cylinder that is too short for
  /// it is a failed margin, not an error; contradictory numbers throw InvalidDrive.
  PneumaticDrive(const PneumaticDriveDescription& description, const Interval& joint_range);

  /// The same for a design search: empty where the constructor would throw.
  static std::optional<PneumaticDrive> try_make(const PneumaticDriveDescription& description,
                                                const Interval& joint_range);

  const PneumaticDriveDescription& description() const { return description_; }
  const Interval& joint_range() const { return joint_range_; }
  /// Empty where the cylinder is the joint.
  const std::optional<ArmCylinder>& arm() const { return arm_; }
  const PressureAllocation& allocation() const { return allocation_; }

  /// Highest pressure of a chamber, gauge [Pa]: the least of supply, regulator and cylinder.
  double usable_pressure() const noexcept { return usable_pressure_; }
  PressureLimiter limited_by() const noexcept { return limited_by_; }

  /// Pull and push of the cylinder at that pressure, with the other side at the bias [N].
  Interval force_range() const noexcept { return allocation_.force_range(); }

  /// Torque of a unit push, d' [m/rad]; 1 for a slide.
  double lever(double joint) const noexcept { return arm_ ? arm_->lever(joint) : 1.0; }

  /// Pin to pin [m]; NaN for a slide.
  double length(double joint) const noexcept;

  /// Torques that the cylinder can give at a joint angle [N m]; both zero at a dead point.
  Interval torque_range(double joint) const noexcept;

  /// Torques that it can give at every angle of the joint's range [N m]: the worst of each direction.
  Interval guaranteed_torque() const;

  /// Largest torque in each direction over the joint's range [N m].
  Interval greatest_torque() const;

  /// What gives a torque [N m] at a joint angle [rad].
  PneumaticCommand command(double torque, double joint) const noexcept;

  /// Joint angle [rad] from the potentiometer's voltage [V], of which `zero` is read at joint angle zero. NaN
  /// where the potentiometer or its voltage is not given.
  double joint_angle(double voltage, double zero = 0.0) const noexcept {
    return (voltage - zero) * angle_per_voltage_;
  }

  /// Joint angle of the smallest voltage step that is read [rad]; empty if not given.
  std::optional<double> angular_resolution() const;
  /// Largest error of the angle from the potentiometer's linearity [rad]; empty if not given.
  std::optional<double> angular_error() const;

  /// Piston and rod felt at the joint, m d'^2 [kg m^2, or kg].
  double reflected_inertia(double joint) const noexcept;
  /// What moves the piston from rest, felt at the joint [N m].
  double friction_torque(double joint) const noexcept;
  /// Error of the torque from the linearity of both regulators, at worst [N m]; empty if not given.
  std::optional<double> torque_error(double joint) const noexcept;

  /// Every rule that the data allow to be checked, in a fixed order.
  std::vector<Margin> margins() const;

  /// What is worth printing of the drive, in a fixed order. Where a figure depends on the joint, in the middle
  /// of its range.
  std::vector<DriveFigure> figures() const;

 private:
  PneumaticDriveDescription description_;
  Interval joint_range_;
  std::optional<ArmCylinder> arm_;
  double usable_pressure_ = 0.0;
  PressureLimiter limited_by_ = PressureLimiter::supply;
  PressureAllocation allocation_;
  double angle_per_voltage_ = 0.0;
};

}  // namespace zwidth
