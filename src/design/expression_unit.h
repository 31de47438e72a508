#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "zwidth/description/units.h"

/// What an expression measures: the unit of its value, from the units of its names and numbers.

namespace zwidth {

/// Powers of metre, kilogram, second, ampere and kelvin. Angles count as plain numbers.
struct UnitPowers {
  std::array<double, 5> power{};

  bool operator==(const UnitPowers&) const = default;
};

UnitPowers unit_powers(Dimension dimension);
/// "N", "m/s^2", "1"; of no customary unit "kg^2 m".
std::string unit_text(const UnitPowers& powers);
/// "a length", "a plain number", "in kg^2 m".
std::string unit_words(const UnitPowers& powers);

/// What a number without a unit counts as.
enum class BareNumber {
  any,   ///< whatever fits: people write SI numbers without their units
  pure,  ///< a plain number
};

struct ExpressionUnit {
  std::optional<UnitPowers> unit;  ///< nothing where it cannot be told
  std::string rule;                ///< what does not go together: "adds a length and a mass"; empty if nothing
};
/// `of_name` gives the unit of a name, or nothing. REQUIRES: `parse_expression(text)` finds nothing wrong.
ExpressionUnit expression_unit(std::string_view text,
                               const std::function<std::optional<UnitPowers>(const std::string& name)>& of_name,
                               BareNumber bare);

}  // namespace zwidth
