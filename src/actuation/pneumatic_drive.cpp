#include "zwidth/actuation/pneumatic_drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "zwidth/actuation/internal/margin.h"

namespace zwidth {

using internal::add_margin;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// Angles at which a cylinder's lever is looked at over a joint's range: between two of them it hardly changes.
constexpr int kRaster = 256;

double require(const char* quantity, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InvalidDrive(std::string(quantity) + " must be positive and finite, not " + std::to_string(value));
  }
  return value;
}

std::optional<ArmCylinder> arm_of(const PneumaticDriveDescription& description) {
  const auto* arm = std::get_if<ArmCylinderDescription>(&description.mount);
  if (arm == nullptr) return std::nullopt;
  try {
    return ArmCylinder(*arm);
  } catch (const std::invalid_argument& problem) {
    throw InvalidDrive(std::string("cylinder mount: ") + problem.what());
  }
}

PressureAllocation allocation_of(const PneumaticDriveDescription& description) {
  const double usable =
      std::min({require("the supply pressure", description.supply_pressure),
                require("the regulator's highest pressure", description.regulator.max_pressure),
                require("the cylinder's highest pressure", description.cylinder.max_pressure)});
  try {
    return {description.cylinder.rear_area, description.cylinder.rod_area, description.bias_pressure, usable};
  } catch (const std::invalid_argument& problem) {
    throw InvalidDrive(std::string("cylinder: ") + problem.what());
  }
}

double angle_per_voltage_of(const PneumaticDriveDescription& description) {
  if (!description.potentiometer || !(description.sensor_voltage > 0.0)) return kNone;
  return description.potentiometer->electrical_angle / description.sensor_voltage;
}

}  // namespace

const char* to_string(PressureLimiter limiter) {
  switch (limiter) {
    case PressureLimiter::supply:
      return "supply";
    case PressureLimiter::regulator:
      return "regulator";
    case PressureLimiter::cylinder:
      return "cylinder";
  }
  return "";
}

const char* to_string(PneumaticStatus status) {
  switch (status) {
    case PneumaticStatus::ok:
      return "ok";
    case PneumaticStatus::saturated:
      return "saturated";
    case PneumaticStatus::dead_point:
      return "dead_point";
  }
  return "";
}

PneumaticDrive::PneumaticDrive(const PneumaticDriveDescription& description, const Interval& joint_range)
    : description_(description),
      joint_range_(joint_range),
      arm_(arm_of(description)),
      allocation_(allocation_of(description)),
      angle_per_voltage_(angle_per_voltage_of(description)) {
  const Regulator& regulator = description.regulator;
  require("the regulator's range of commands", regulator.max_command - regulator.min_command);
  require("the regulator's range of pressures", regulator.max_pressure - regulator.min_pressure);
  require("the cylinder's stroke", description.cylinder.stroke);
  usable_pressure_ = description.supply_pressure;
  if (regulator.max_pressure < usable_pressure_) {
    usable_pressure_ = regulator.max_pressure;
    limited_by_ = PressureLimiter::regulator;
  }
  if (description.cylinder.max_pressure < usable_pressure_) {
    usable_pressure_ = description.cylinder.max_pressure;
    limited_by_ = PressureLimiter::cylinder;
  }
}

std::optional<PneumaticDrive> PneumaticDrive::try_make(const PneumaticDriveDescription& description,
                                                       const Interval& joint_range) {
  try {
    return PneumaticDrive(description, joint_range);
  } catch (const InvalidDrive&) {
    return std::nullopt;
  }
}

double PneumaticDrive::length(double joint) const noexcept {
  return arm_ ? arm_->length(joint) : kNone;
}

Interval PneumaticDrive::torque_range(double joint) const noexcept {
  const double d = lever(joint);
  if (std::abs(d) < kDeadPointLever) return {0.0, 0.0};
  const Interval force = force_range();
  return d > 0.0 ? Interval{force.min * d, force.max * d} : Interval{force.max * d, force.min * d};
}

Interval PneumaticDrive::guaranteed_torque() const {
  Interval worst = torque_range(joint_range_.min);
  for (int n = 1; n <= kRaster && arm_; ++n) {
    const Interval here = torque_range(joint_range_.min + joint_range_.width() * n / kRaster);
    worst = {std::max(worst.min, here.min), std::min(worst.max, here.max)};
  }
  return worst;
}

Interval PneumaticDrive::greatest_torque() const {
  Interval best = torque_range(joint_range_.min);
  for (int n = 1; n <= kRaster && arm_; ++n) {
    const Interval here = torque_range(joint_range_.min + joint_range_.width() * n / kRaster);
    best = {std::min(best.min, here.min), std::max(best.max, here.max)};
  }
  return best;
}

PneumaticCommand PneumaticDrive::command(double torque, double joint) const noexcept {
  PneumaticCommand command;
  const double d = lever(joint);
  const bool dead = !(std::abs(d) >= kDeadPointLever);
  command.force = dead ? 0.0 : torque / d;
  command.pressures = allocation_.pressures(command.force);
  const RegulatorCommand rear = regulator_command(description_.regulator, command.pressures.rear);
  const RegulatorCommand rod = regulator_command(description_.regulator, command.pressures.rod);
  command.voltages = {rear.voltage, rod.voltage};
  command.torque = dead ? 0.0 : allocation_.force(command.pressures) * d;
  const bool clamped = command.pressures.saturated || rear.saturated || rod.saturated;
  command.status = dead      ? PneumaticStatus::dead_point
                   : clamped ? PneumaticStatus::saturated
                             : PneumaticStatus::ok;
  return command;
}

std::optional<double> PneumaticDrive::angular_resolution() const {
  if (!(description_.sensor_step > 0.0) || !std::isfinite(angle_per_voltage_)) return std::nullopt;
  return description_.sensor_step * angle_per_voltage_;
}

std::optional<double> PneumaticDrive::angular_error() const {
  if (!description_.potentiometer || !given(description_.potentiometer->linearity)) return std::nullopt;
  return description_.potentiometer->linearity * description_.potentiometer->electrical_angle;
}

double PneumaticDrive::reflected_inertia(double joint) const noexcept {
  const double d = lever(joint);
  return description_.cylinder.moving_mass * d * d;
}

double PneumaticDrive::friction_torque(double joint) const noexcept {
  return description_.cylinder.breakaway_pressure * description_.cylinder.rear_area * std::abs(lever(joint));
}

std::optional<double> PneumaticDrive::torque_error(double joint) const noexcept {
  const Regulator& regulator = description_.regulator;
  if (!given(regulator.linearity)) return std::nullopt;
  const double pressure = regulator.linearity * (regulator.max_pressure - regulator.min_pressure);
  return pressure * (description_.cylinder.rear_area + description_.cylinder.rod_area) * std::abs(lever(joint));
}

std::vector<Margin> PneumaticDrive::margins() const {
  const Cylinder& cylinder = description_.cylinder;
  const Regulator& regulator = description_.regulator;
  std::vector<Margin> margins;
  if (arm_) {
    const auto& mount = arm_->description();
    double shortest = length(joint_range_.min), longest = shortest, least = HUGE_VAL;
    for (int n = 0; n <= kRaster; ++n) {
      const double joint = joint_range_.min + joint_range_.width() * n / kRaster;
      shortest = std::min(shortest, length(joint));
      longest = std::max(longest, length(joint));
      least = std::min(least, std::abs(lever(joint)));
    }
    if (!arm_->keeps_direction(joint_range_)) least = 0.0;
    add_margin(margins, "stroke", longest - shortest, cylinder.stroke, "m",
               "the joint's range must not need more than the stroke");
    add_margin(margins, "stroke within the cylinder", cylinder.stroke, mount.retracted_length, "m",
               "a cylinder with the rod in is longer than its stroke");
    add_margin(margins, "shortest length", mount.retracted_length, shortest, "m",
               "the cylinder must not be shorter than it is with the rod in");
    add_margin(margins, "greatest length", longest, mount.retracted_length + cylinder.stroke, "m",
               "the cylinder must not be longer than it is with the rod out");
    add_margin(margins, "least lever", kDeadPointLever, least, "m",
               "the lever must not vanish within the joint's range (a dead point: |d'| < 1 nm/rad)");
  } else {
    add_margin(margins, "stroke", joint_range_.width(), cylinder.stroke, "m",
               "the joint's range must not be more than the stroke");
  }
  add_margin(margins, "supply pressure", description_.supply_pressure, regulator.max_supply_pressure, "Pa",
             "the regulators must stand the supply pressure");
  add_margin(margins, "regulator pressure", usable_pressure_, cylinder.max_pressure, "Pa",
             "the cylinder must stand the highest pressure used");
  add_margin(margins, "bias pressure", description_.bias_pressure, usable_pressure_, "Pa",
             "the bias must leave pressure to work with");
  add_margin(margins, "least pressure", regulator.min_pressure, description_.bias_pressure, "Pa",
             "the bias must not be below what the regulators can hold");
  if (const auto& sensor = description_.potentiometer; sensor && arm_) {
    add_margin(margins, "potentiometer angle", joint_range_.width(), sensor->electrical_angle, "rad",
               "the joint's range must not be more than the potentiometer's");
    if (description_.sensor_voltage > 0.0) {
      add_margin(margins, "potentiometer voltage", description_.sensor_voltage, sensor->max_voltage, "V",
                 "the potentiometer must stand its voltage");
    }
  }
  return margins;
}

std::vector<DriveFigure> PneumaticDrive::figures() const {
  std::vector<DriveFigure> figures;
  const auto put = [&figures](const char* key, const char* name, std::optional<double> value,
                              const char* unit) {
    if (value && std::isfinite(*value)) figures.push_back({key, name, *value, unit});
  };
  const bool turns = arm_.has_value();
  const char* torque_unit = turns ? "N m" : "N";
  const double middle = joint_range_.middle();
  const Interval force = force_range(), worst = guaranteed_torque(), best = greatest_torque();
  put("usable_pressure", "highest chamber pressure", usable_pressure_, "Pa");
  put("push_force", "push at that pressure", force.max, "N");
  put("pull_force", "pull at that pressure", -force.min, "N");
  if (turns) {
    put("lever", "lever in the middle of the range", lever(middle), "m");
    put("guaranteed_torque_up", "torque at every angle, positive", worst.max, torque_unit);
    put("guaranteed_torque_down", "torque at every angle, negative", worst.min, torque_unit);
    put("greatest_torque_up", "torque at the best angle, positive", best.max, torque_unit);
    put("greatest_torque_down", "torque at the best angle, negative", best.min, torque_unit);
    put("shortest_length", "cylinder at one end of the range",
        std::min(length(joint_range_.min), length(joint_range_.max)), "m");
    put("greatest_length", "cylinder at the other end",
        std::max(length(joint_range_.min), length(joint_range_.max)), "m");
  }
  put("breakaway", "friction felt at the joint, from rest", friction_torque(middle), torque_unit);
  put("torque_error", "error from the regulators' linearity", torque_error(middle), torque_unit);
  put("angular_resolution", "angle of one step read", angular_resolution(), "rad");
  put("angular_error", "error from the potentiometer's linearity", angular_error(), "rad");
  put("reflected_inertia", "piston and rod felt at the joint", reflected_inertia(middle),
      turns ? "kg m^2" : "kg");
  return figures;
}

}  // namespace zwidth
