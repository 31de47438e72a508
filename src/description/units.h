#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Quantities as users write them, "80 mm" or "-36 deg", and their SI values. Thread-safe; never prints.

namespace zwidth {

/// The kind of a quantity; each has one SI unit, in which all numbers inside zwidth are.
enum class Dimension {
  number,                 ///< 1
  length,                 ///< m
  angle,                  ///< rad
  area,                   ///< m^2
  volume,                 ///< m^3
  time,                   ///< s
  frequency,              ///< Hz
  speed,                  ///< m/s
  angular_speed,          ///< rad/s
  acceleration,           ///< m/s^2
  angular_acceleration,   ///< rad/s^2
  mass,                   ///< kg
  inertia,                ///< kg m^2
  density,                ///< kg/m^3
  force,                  ///< N
  torque,                 ///< N m
  power,                  ///< W
  pressure,               ///< Pa
  stiffness,              ///< N/m
  damping,                ///< N s/m
  angular_stiffness,      ///< N m/rad
  angular_damping,        ///< N m s/rad
  voltage,                ///< V
  current,                ///< A
  resistance,             ///< ohm
  inductance,             ///< H
  torque_constant,        ///< N m/A
  speed_constant,         ///< rad/s/V
  temperature,            ///< K
  thermal_resistance,     ///< K/W
  speed_torque_gradient,  ///< rad/s/(N m)
};

std::string_view dimension_name(Dimension dimension);  ///< with its article: "a length", "an angle"
std::string_view si_unit(Dimension dimension);         ///< as UDUNITS reads it: "m", "rad", "1"

/// A quantity read from text: its SI value, or why there is none.
struct ParsedQuantity {
  std::optional<double> value;  ///< SI; always finite
  std::string rule;    ///< why there is no value: "has the dimension of a length, an angle was expected"
  std::string advice;  ///< what to write instead
  explicit operator bool() const { return value.has_value(); }
};

/// Reads "80 mm", "60deg", "0.254 N m", "18.3 g cm^2"; a number without a unit is SI. Units are those of
/// UDUNITS, and their dimension must be the one asked for. An angle is a dimension of its own here: "Hz" is no
/// angular speed and "deg" no plain number. Garbage, NaN and infinities come back as a rule that was broken.
ParsedQuantity parse_quantity(std::string_view text, Dimension dimension);

/// A quantity of whatever kind its unit says; a number without a unit is of no kind in particular.
struct AnyQuantity {
  double value = 0.0;                  ///< SI
  std::optional<Dimension> dimension;  ///< none without a unit
};
/// Reads "80 mm" without being told what it is. Empty where `parse_quantity` takes it for no dimension.
std::optional<AnyQuantity> parse_any_quantity(std::string_view text);

struct ParsedQuantities {
  std::vector<double> values;  ///< SI; empty if anything is wrong
  std::string rule;            ///< why there are no values; names the entry at fault
  std::string advice;
  explicit operator bool() const { return rule.empty(); }
};

/// Reads "0, 60deg, 0.1": quantities between commas, as command lines have them.
ParsedQuantities parse_quantity_list(std::string_view text, Dimension dimension);

/// Reads a list whose entries have dimensions of their own (joints of which some turn and others slide).
/// A list with another number of entries is wrong.
ParsedQuantities parse_quantity_list(std::string_view text, std::span<const Dimension> dimensions);

/// Text that `parse_quantity` reads back to exactly `value`: in a customary unit ("80 mm", "-36 deg") where
/// that is short, as a plain SI number otherwise. REQUIRES: value is finite.
std::string format_quantity(double value, Dimension dimension);

}  // namespace zwidth
