#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"
#include "zwidth/description/units.h"

/// The keys of every table that holds plain quantities, written down once: reading, checking, writing and the
/// reference in docs/device_file.md all go through these lists. A new part, transmission or closed-form
/// mechanism starts with a struct and its list here.

namespace zwidth {

/// Which values are allowed.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself is not allowed

  bool contains(double value) const { return (above_min ? value > min : value >= min) && value <= max; }
};

enum class Need {
  required,
  optional,  ///< the value that the struct starts with stands in: "not given" if that is NaN
};

/// One key of a table and the member of `Owner` that it sets.
template <class Owner>
struct Field {
  std::string_view key;
  std::variant<double Owner::*, int Owner::*, Vector3 Owner::*, Interval Owner::*> member;
  Dimension dimension;
  Bounds bounds;  ///< of every number in it
  Need need;
  std::string_view meaning;  ///< a phrase without its unit
  std::string_view example;  ///< as TOML
};

/// The fields of Motor, Gearhead, Encoder, Amplifier, Cable, Bearing, Material, Lamina, Cylinder, Regulator,
/// Potentiometer, TubeDescription, BarDescription, PlyDescription, DeltaDescription, FiveBarDescription,
/// RCubeDescription, SerialJointDescription, CapstanDescription, RatioDescription, GearheadDescription,
/// ArmCylinderDescription, FlexureDescription, DriveOutputDescription, DriveDescription and
/// PneumaticDriveDescription.
template <class Owner>
std::span<const Field<Owner>> fields();

/// Whether two structs agree in all their fields; numbers that are not given are equal.
template <class Owner>
bool same_fields(const Owner& a, const Owner& b) {
  const auto same = [&](const Field<Owner>& field) {
    return std::visit(
        [&](auto member) {
          if constexpr (std::is_same_v<decltype(member), double Owner::*>) {
            if (std::isnan(a.*member) && std::isnan(b.*member)) return true;
          }
          return a.*member == b.*member;
        },
        field.member);
  };
  return std::all_of(fields<Owner>().begin(), fields<Owner>().end(), same);
}

/// "must be positive", "must be from 0 to 10 m".
std::string bounds_rule(const Bounds& bounds, Dimension dimension);

/// Text on one line of at most 60 bytes, for messages.
std::string shortened(std::string text);

/// "table.key", quoted where TOML needs it, and "array[index]".
std::string join_path(const std::string& table, std::string_view key);
std::string join_path(const std::string& array, std::size_t index);

/// Notes a number that is not finite or out of bounds; `advice` says what to give instead.
void check_number(double value, Dimension dimension, const Bounds& bounds, const std::string& path,
                  const std::string& advice, std::vector<Problem>& problems);

/// Notes an interval whose ends are not finite, out of bounds, or the wrong way round.
void check_interval(const Interval& interval, Dimension dimension, const Bounds& bounds,
                    const std::string& path, const std::string& advice, std::vector<Problem>& problems);

/// What an error about this field tells the user to do.
template <class Owner>
std::string field_advice(const Field<Owner>& field) {
  return "give the " + std::string(field.meaning) + ", such as " + std::string(field.example);
}

/// Whether the value of a field breaks no rule.
template <class Owner>
bool field_holds(const Owner& owner, const Owner& untouched, const Field<Owner>& field) {
  const auto good = [&](double value) { return std::isfinite(value) && field.bounds.contains(value); };
  return std::visit(
      [&](auto member) {
        const auto& value = owner.*member;
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, Interval>) {
          return good(value.min) && good(value.max) && value.min < value.max;
        } else if constexpr (std::is_same_v<Value, Vector3>) {
          return good(value[0]) && good(value[1]) && good(value[2]);
        } else {
          const auto number = static_cast<double>(value);
          return good(number) || (std::isnan(number) && std::isnan(static_cast<double>(untouched.*member)));
        }
      },
      field.member);
}

/// What is wrong with the values of all fields of `owner`, the table at `path`.
template <class Owner>
std::vector<Problem> field_problems(const Owner& owner, const std::string& path) {
  static const Owner untouched{};
  std::vector<Problem> problems;
  for (const Field<Owner>& field : fields<Owner>()) {
    if (field_holds(owner, untouched, field)) continue;  // a design search asks often, and mostly all is well
    const std::string key = join_path(path, field.key);
    const std::string advice = field_advice(field);
    std::visit(
        [&](auto member) {
          using Value = std::remove_cvref_t<decltype(owner.*member)>;
          if constexpr (std::is_same_v<Value, Interval>) {
            check_interval(owner.*member, field.dimension, field.bounds, key, advice, problems);
          } else if constexpr (std::is_same_v<Value, Vector3>) {
            for (const double value : owner.*member) {
              check_number(value, field.dimension, field.bounds, key, advice, problems);
            }
          } else {
            const auto value = static_cast<double>(owner.*member);
            const bool may_be_unknown = std::isnan(static_cast<double>(untouched.*member));
            if (may_be_unknown && std::isnan(value)) return;
            check_number(value, field.dimension, field.bounds, key, advice, problems);
          }
        },
        field.member);
  }
  return problems;
}

}  // namespace zwidth
