#include "zwidth/description/units.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <mutex>
#include <udunits2.h>
#include <utility>

namespace zwidth {
namespace {

struct DimensionEntry {
  Dimension dimension;
  std::string_view name;
  std::string_view si;                        // as UDUNITS reads it
  bool strict_angle;                          // radians must match too; UDUNITS takes them for plain numbers
  std::string_view examples;                  // units to offer when another was given
  std::array<std::string_view, 3> customary;  // tried in this order by format_quantity
};

// In the order of the enumeration.
constexpr DimensionEntry kDimensions[] = {
    {Dimension::number, "a plain number", "1", true, "no unit, or %", {}},
    {Dimension::length, "a length", "m", false, "m, mm or um", {"mm", "um"}},
    {Dimension::angle, "an angle", "rad", true, "rad or deg", {"deg", "rad"}},
    {Dimension::area, "an area", "m^2", false, "m^2 or mm^2", {"mm^2"}},
    {Dimension::volume, "a volume", "m^3", false, "m^3 or mm^3", {"mm^3"}},
    {Dimension::time, "a time", "s", false, "s or ms", {"s", "ms", "us"}},
    {Dimension::frequency, "a frequency", "Hz", true, "Hz or kHz", {"Hz", "kHz", "MHz"}},
    {Dimension::speed, "a speed", "m/s", false, "m/s or mm/s", {"m/s", "mm/s"}},
    {Dimension::angular_speed, "an angular speed", "rad/s", true, "rad/s, deg/s or rpm", {"rpm", "rad/s"}},
    {Dimension::acceleration, "an acceleration", "m/s^2", false, "m/s^2", {"m/s^2"}},
    {Dimension::angular_acceleration,
     "an angular acceleration",
     "rad/s^2",
     true,
     "rad/s^2 or deg/s^2",
     {"rad/s^2"}},
    {Dimension::mass, "a mass", "kg", false, "kg or g", {"g", "kg"}},
    {Dimension::inertia, "a moment of inertia", "kg m^2", false, "kg m^2 or g cm^2", {"g cm^2", "kg m^2"}},
    {Dimension::density, "a density", "kg/m^3", false, "kg/m^3 or g/cm^3", {"kg/m^3", "g/cm^3"}},
    {Dimension::force, "a force", "N", false, "N", {"N", "mN", "kN"}},
    {Dimension::torque, "a torque", "N m", false, "N m or mN m", {"N m", "mN m"}},
    {Dimension::power, "a power", "W", false, "W or mW", {"W", "mW"}},
    {Dimension::pressure, "a pressure", "Pa", false, "Pa, kPa, MPa or GPa", {"GPa", "MPa", "kPa"}},
    {Dimension::stiffness, "a stiffness", "N/m", false, "N/m or N/mm", {"N/m", "N/mm", "N/um"}},
    {Dimension::damping, "a damping", "N s/m", false, "N s/m", {"N s/m"}},
    {Dimension::angular_stiffness, "an angular stiffness", "N m/rad", false, "N m/rad", {"N m/rad"}},
    {Dimension::angular_damping, "an angular damping", "N m s/rad", false, "N m s/rad", {"N m s/rad"}},
    {Dimension::voltage, "a voltage", "V", false, "V or mV", {"V", "mV"}},
    {Dimension::current, "a current", "A", false, "A or mA", {"A", "mA"}},
    {Dimension::resistance, "a resistance", "ohm", false, "ohm or mohm", {"ohm", "mohm"}},
    {Dimension::inductance, "an inductance", "H", false, "H, mH or uH", {"mH", "uH", "H"}},
    {Dimension::torque_constant, "a torque constant", "N m/A", false, "N m/A or mN m/A", {"mN m/A", "N m/A"}},
    {Dimension::speed_constant, "a speed constant", "rad/s/V", true, "rad/s/V or rpm/V", {"rpm/V", "rad/s/V"}},
    {Dimension::temperature, "a temperature", "K", false, "K or degC", {"K"}},
    {Dimension::thermal_resistance, "a thermal resistance", "K/W", false, "K/W", {"K/W"}},
    {Dimension::speed_torque_gradient,
     "a loss of speed per torque",
     "rad/s/(N m)",
     true,
     "rad/s/(N m) or rpm/(mN m)",
     {"rpm/(mN m)", "rad/s/(N m)"}},
};

const DimensionEntry& entry(Dimension dimension) {
  const auto index = static_cast<std::size_t>(dimension);
  assert(index < std::size(kDimensions) && kDimensions[index].dimension == dimension);
  return kDimensions[index];
}

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;
struct FreeSystem {
  void operator()(ut_system* system) const { ut_free_system(system); }
};

// SI value = x * factor + offset.
struct Scale {
  double factor = 1.0;
  double offset = 0.0;
  // 1/factor where that is a whole number: x / 1000 is rounded once, x * 0.001 twice ("80 mm" is 0.08 exactly).
  double whole_inverse = 0.0;

  double to_si(double x) const {
    if (offset != 0.0) return x * factor + offset;
    return whole_inverse > 0.0 ? x / whole_inverse : x * factor;
  }
  double from_si(double si) const { return whole_inverse > 0.0 ? si * whole_inverse : (si - offset) / factor; }
};

// UDUNITS keeps global state, so that all use of it goes through one object, one thread at a time.
class UnitSystem {
 public:
  static UnitSystem& instance() {
    static UnitSystem units;
    return units;
  }

  bool available() const { return system_ != nullptr; }

  bool known(const std::string& unit) {
    const std::scoped_lock lock(mutex_);
    return parse(unit) != nullptr;
  }

  // Nothing unless the text is a unit of this dimension.
  std::optional<Scale> scale(const std::string& unit, const DimensionEntry& dimension) {
    constexpr std::size_t kMostRemembered = 256;
    const std::scoped_lock lock(mutex_);
    const auto key = std::pair(unit, dimension.dimension);
    if (const auto found = scales_.find(key); found != scales_.end()) return found->second;
    const std::optional<Scale> scale = make_scale(parse(unit), dimension);
    if (scale && scales_.size() < kMostRemembered) scales_.emplace(key, *scale);
    return scale;
  }

 private:
  Unit parse(const std::string& text) const { return Unit(ut_parse(system_.get(), text.c_str(), UT_UTF8)); }

  std::optional<Scale> make_scale(const Unit& unit, const DimensionEntry& dimension) const {
    if (!unit) return std::nullopt;
    const Unit si(ut_parse(system_.get(), std::string(dimension.si).c_str(), UT_UTF8));
    if (!si || ut_are_convertible(unit.get(), si.get()) == 0) return std::nullopt;
    if (dimension.strict_angle && radians(unit) != radians(si)) return std::nullopt;

    const std::unique_ptr<cv_converter, decltype(&cv_free)> converter(ut_get_converter(unit.get(), si.get()),
                                                                      &cv_free);
    if (!converter) return std::nullopt;
    Scale scale;
    scale.offset = cv_convert_double(converter.get(), 0.0);
    scale.factor = cv_convert_double(converter.get(), 1.0) - scale.offset;
    const double twice = cv_convert_double(converter.get(), 2.0) - scale.offset;
    const bool linear = std::abs(twice - 2.0 * scale.factor) <= 1e-9 * std::abs(scale.factor);
    // Decibels and such are not linear.
    if (!linear || !std::isfinite(scale.factor) || scale.factor == 0.0) return std::nullopt;
    const double inverse = std::round(1.0 / scale.factor);
    if (inverse > 1.0 && std::abs(scale.factor * inverse - 1.0) < 1e-14) scale.whole_inverse = inverse;
    return scale;
  }

  UnitSystem() {
    ut_set_error_message_handler(ut_ignore);
    system_.reset(ut_read_xml(nullptr));
    if (!system_) return;
    alias("deg", "degree");
    alias("rev", "turn");
    alias("Nm", "N m");
  }

  void alias(const char* symbol, const char* meaning) {
    const Unit unit(ut_parse(system_.get(), meaning, UT_UTF8));
    if (unit) ut_map_symbol_to_unit(symbol, UT_UTF8, unit.get());
  }

  // The radians in a unit's definition: "rad" in rad/s, "" in Hz.
  static std::string radians(const Unit& unit) {
    std::array<char, 256> text{};
    if (ut_format(unit.get(), text.data(), text.size() - 1, UT_ASCII | UT_DEFINITION) < 0) return "?";
    const std::string definition(text.data());
    const std::size_t at = definition.find("rad");
    if (at == std::string::npos) return {};
    const std::size_t end = definition.find_first_of(". ", at);
    return definition.substr(at, end == std::string::npos ? end : end - at);
  }

  std::mutex mutex_;
  std::unique_ptr<ut_system, FreeSystem> system_;
  // Parsing a unit costs more than the rest of reading.
  std::map<std::pair<std::string, Dimension>, Scale> scales_;
};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

ParsedQuantity broken(std::string rule, std::string advice) {
  return {.value = std::nullopt, .rule = std::move(rule), .advice = std::move(advice)};
}

// UDUNITS would take these for something else than a product of units.
bool plain_unit(std::string_view unit) {
  constexpr std::size_t kLongestUnit = 64;
  const char first = unit.front();
  const bool starts_well =
      !(first >= '0' && first <= '9') && std::string_view("+-.,^*/=").find(first) == unit.npos;
  const bool printable = std::none_of(unit.begin(), unit.end(), [](char c) { return c >= 0 && c < ' '; });
  return starts_well && printable && unit.size() <= kLongestUnit && unit.find_first_of("@:") == unit.npos;
}

std::string unit_advice(const DimensionEntry& dimension) {
  if (dimension.dimension == Dimension::number) return "give a plain number";
  return fmt::format("units of {} are {}, or give a plain number in {}",
                     dimension.name.substr(dimension.name.find(' ') + 1), dimension.examples, dimension.si);
}

}  // namespace

std::string_view dimension_name(Dimension dimension) {
  return entry(dimension).name;
}
std::string_view si_unit(Dimension dimension) {
  return entry(dimension).si;
}

ParsedQuantity parse_quantity(std::string_view text, Dimension dimension) {
  const DimensionEntry& wanted = entry(dimension);
  const std::string example =
      dimension == Dimension::number ? "such as 1.5" : fmt::format("such as \"1.5 {}\"", wanted.customary[0]);

  std::string_view rest = trimmed(text);
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const bool starts_number = !rest.empty() && std::string_view("-.0123456789").find(rest[0]) != rest.npos;
  double number = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (!starts_number || error == std::errc::invalid_argument) {
    return broken("has no number", "give a number, with a unit if it is not SI, " + example);
  }
  if (error == std::errc::result_out_of_range) return broken("is beyond any number", "give a smaller number");
  if (!std::isfinite(number)) return broken("must be finite", "give a number, " + example);

  const std::string_view digits = rest.substr(0, end - rest.data());
  const std::string unit_text(trimmed(rest.substr(digits.size())));
  if (unit_text.empty()) return {.value = number, .rule = {}, .advice = {}};
  if (unit_text.front() == ',') {
    return broken("has a comma in its number", "write the decimals after a point, " + example);
  }

  UnitSystem& units = UnitSystem::instance();
  if (!units.available()) {
    return broken("has a unit, but the units database of UDUNITS cannot be read",
                  "install libudunits2-data, or give a plain number in SI");
  }
  const bool plain = plain_unit(unit_text);
  const std::optional<Scale> scale = plain ? units.scale(unit_text, wanted) : std::nullopt;
  if (!scale) {
    if (!plain || !units.known(unit_text)) {
      return broken(fmt::format("has an unknown unit '{}'", unit_text), unit_advice(wanted));
    }
    for (const DimensionEntry& other : kDimensions) {
      if (other.dimension != dimension && units.scale(unit_text, other)) {
        return broken(fmt::format("has the dimension of {}, {} was expected", other.name, wanted.name),
                      unit_advice(wanted));
      }
    }
    return broken(fmt::format("has the unit '{}', {} was expected", unit_text, wanted.name),
                  unit_advice(wanted));
  }
  const double value = scale->to_si(number);
  if (!std::isfinite(value)) return broken("is beyond any number", "give a smaller number");
  return {.value = value, .rule = {}, .advice = {}};
}

std::optional<AnyQuantity> parse_any_quantity(std::string_view text) {
  if (const ParsedQuantity number = parse_quantity(text, Dimension::number)) {
    const bool plain = text.find_first_not_of("+-.0123456789eE \t") == std::string_view::npos;
    return AnyQuantity{*number.value, plain ? std::nullopt : std::optional(Dimension::number)};
  }
  for (const DimensionEntry& one : kDimensions) {
    if (const ParsedQuantity quantity = parse_quantity(text, one.dimension)) {
      return AnyQuantity{*quantity.value, one.dimension};
    }
  }
  return std::nullopt;
}

ParsedQuantities parse_quantity_list(std::string_view text, std::span<const Dimension> dimensions) {
  ParsedQuantities result;
  std::vector<std::string_view> entries;
  while (true) {
    const std::size_t comma = text.find(',');
    entries.push_back(trimmed(text.substr(0, comma)));
    if (comma == text.npos) break;
    text.remove_prefix(comma + 1);
  }
  if (entries.size() != dimensions.size()) {
    result.rule =
        fmt::format("has {} {}, {} expected", entries.size(), entries.size() == 1 ? "entry" : "entries",
                    dimensions.size() == 1 ? "one is" : fmt::format("{} are", dimensions.size()));
    result.advice = fmt::format("give {} {} between commas", dimensions.size(),
                                dimensions.size() == 1 ? "quantity" : "quantities");
    return result;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ParsedQuantity quantity = parse_quantity(entries[i], dimensions[i]);
    if (!quantity) {
      result.values.clear();
      result.rule = fmt::format("entry {} ('{}') {}", i + 1, entries[i].substr(0, 40), quantity.rule);
      result.advice = quantity.advice;
      return result;
    }
    result.values.push_back(*quantity.value);
  }
  return result;
}

ParsedQuantities parse_quantity_list(std::string_view text, Dimension dimension) {
  const auto count = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
  return parse_quantity_list(text, std::vector<Dimension>(count, dimension));
}

std::string format_quantity(double value, Dimension dimension) {
  assert(std::isfinite(value));
  constexpr int kMostDigits = 9;  // more of them are no customary number; SI then says it as well
  const DimensionEntry& wanted = entry(dimension);
  UnitSystem& units = UnitSystem::instance();
  std::string best;
  std::size_t shortest = 0, later = 0;  // a unit that stands later in the list must be shorter by more
  for (const std::string_view customary : wanted.customary) {
    if (customary.empty() || !units.available()) break;
    const std::optional<Scale> scale = units.scale(std::string(customary), wanted);
    if (!scale) continue;
    for (int digits = 1; digits <= kMostDigits; ++digits) {
      const std::string number = fmt::format("{:.{}g}", scale->from_si(value), digits);
      double back = 0.0;
      std::from_chars(number.data(), number.data() + number.size(), back);
      if (scale->to_si(back) != value) continue;
      const std::string plain = fmt::format("{}", back);  // 80, where %g with one digit says 8e+01
      constexpr std::size_t kPower = 9;  // a power of ten reads as badly as so many digits more
      const std::size_t length = plain.size() + later + (plain.find('e') == std::string::npos ? 0 : kPower);
      if (best.empty() || length < shortest) {
        best = plain + ' ' + std::string(customary);
        shortest = length;
      }
      break;
    }
    ++later;
  }
  return best.empty() ? fmt::format("{}", value) : best;
}

}  // namespace zwidth
