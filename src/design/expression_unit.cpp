#include "zwidth/design/expression_unit.h"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "zwidth/design/internal/expression_text.h"

namespace zwidth {
namespace {

using Powers = std::array<double, 5>;

struct NamedUnit {
  Dimension dimension;
  Powers powers;  // m, kg, s, A, K
};
// In the order of preference where two have the same powers.
constexpr NamedUnit kUnits[] = {
    {Dimension::number, {0, 0, 0, 0, 0}},
    {Dimension::length, {1, 0, 0, 0, 0}},
    {Dimension::area, {2, 0, 0, 0, 0}},
    {Dimension::volume, {3, 0, 0, 0, 0}},
    {Dimension::time, {0, 0, 1, 0, 0}},
    {Dimension::speed, {1, 0, -1, 0, 0}},
    {Dimension::acceleration, {1, 0, -2, 0, 0}},
    {Dimension::mass, {0, 1, 0, 0, 0}},
    {Dimension::inertia, {2, 1, 0, 0, 0}},
    {Dimension::density, {-3, 1, 0, 0, 0}},
    {Dimension::force, {1, 1, -2, 0, 0}},
    {Dimension::torque, {2, 1, -2, 0, 0}},
    {Dimension::power, {2, 1, -3, 0, 0}},
    {Dimension::pressure, {-1, 1, -2, 0, 0}},
    {Dimension::stiffness, {0, 1, -2, 0, 0}},
    {Dimension::damping, {0, 1, -1, 0, 0}},
    {Dimension::voltage, {2, 1, -3, -1, 0}},
    {Dimension::current, {0, 0, 0, 1, 0}},
    {Dimension::resistance, {2, 1, -3, -2, 0}},
    {Dimension::inductance, {2, 1, -2, -2, 0}},
    {Dimension::torque_constant, {2, 1, -2, -1, 0}},
    {Dimension::temperature, {0, 0, 0, 0, 1}},
    {Dimension::thermal_resistance, {-2, -1, 3, 0, 1}},
    {Dimension::angle, {0, 0, 0, 0, 0}},
    {Dimension::frequency, {0, 0, -1, 0, 0}},
    {Dimension::angular_speed, {0, 0, -1, 0, 0}},
    {Dimension::angular_acceleration, {0, 0, -2, 0, 0}},
    {Dimension::angular_stiffness, {2, 1, -2, 0, 0}},
    {Dimension::angular_damping, {2, 1, -1, 0, 0}},
    {Dimension::speed_constant, {-2, -1, 2, 1, 0}},
    {Dimension::speed_torque_gradient, {-2, -1, 1, 0, 0}},
};

const NamedUnit* named(const UnitPowers& powers) {
  for (const NamedUnit& one : kUnits) {
    if (one.powers == powers.power) return &one;
  }
  return nullptr;
}

struct Term {
  std::optional<UnitPowers> unit;  // nothing: any, or unknown
  std::optional<double> number;    // of a literal alone
};

class Parser {
 public:
  Parser(std::string_view text, const std::function<std::optional<UnitPowers>(const std::string&)>& of_name,
         BareNumber bare)
      : text_(text), of_name_(of_name), bare_(bare) {}

  ExpressionUnit run() {
    const Term whole = choice();
    return {.unit = rule_.empty() ? whole.unit : std::nullopt, .rule = rule_};
  }

 private:
  bool take(std::string_view symbol) {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    if (text_.substr(at_, symbol.size()) != symbol) return false;
    at_ += symbol.size();
    return true;
  }
  // "<" but not "<=", say.
  bool take_alone(std::string_view symbol) {
    const std::size_t before = at_;
    if (!take(symbol)) return false;
    if (at_ < text_.size() && text_[at_] == '=') {
      at_ = before;
      return false;
    }
    return true;
  }

  // Two that have to be of one kind.
  std::optional<UnitPowers> alike(const Term& a, const Term& b, const char* verb) {
    if (a.unit && b.unit && !(*a.unit == *b.unit) && rule_.empty()) {
      rule_ = fmt::format("{} {} and {}", verb, unit_words(*a.unit), unit_words(*b.unit));
    }
    // A number without a unit takes the kind of the other.
    return a.unit ? a.unit : b.unit;
  }
  static std::optional<UnitPowers> product(const Term& a, const Term& b, double sign) {
    if (!a.unit || !b.unit) return std::nullopt;
    UnitPowers result = *a.unit;
    for (std::size_t i = 0; i < result.power.size(); ++i) result.power[i] += sign * b.unit->power[i];
    return result;
  }
  static std::optional<UnitPowers> raised(const std::optional<UnitPowers>& unit, double exponent) {
    if (!unit) return std::nullopt;
    UnitPowers result = *unit;
    for (double& power : result.power) power *= exponent;
    return result;
  }
  void pure(const Term& term, const std::string& function) {
    if (term.unit && !(*term.unit == UnitPowers{}) && rule_.empty()) {
      rule_ = fmt::format("takes the {} of {}", function, unit_words(*term.unit));
    }
  }

  Term choice() {
    Term condition = either();
    if (!take("?")) return condition;
    const Term yes = choice();
    take(":");
    const Term no = choice();
    return {alike(yes, no, "chooses between"), std::nullopt};
  }
  Term either() {
    Term left = comparison();
    while (take("||") || take("&&")) {
      comparison();
      left = {UnitPowers{}, std::nullopt};
    }
    return left;
  }
  Term comparison() {
    Term left = sum();
    while (take("<=") || take(">=") || take("==") || take("!=") || take_alone("<") || take_alone(">")) {
      const Term right = sum();
      alike(left, right, "compares");
      left = {UnitPowers{}, std::nullopt};
    }
    return left;
  }
  Term sum() {
    Term left = factors();
    for (;;) {
      const bool plus = take("+");
      if (!plus && !take("-")) return left;
      const Term right = factors();
      left = {alike(left, right, plus ? "adds" : "subtracts"), std::nullopt};
    }
  }
  Term factors() {
    Term left = sign();
    for (;;) {
      const bool times = take("*");
      if (!times && !take("/")) return left;
      const Term right = sign();
      left = {product(left, right, times ? 1.0 : -1.0), std::nullopt};
    }
  }
  Term sign() {
    if (take("-")) {
      Term term = sign();
      if (term.number) term.number = -*term.number;
      return term;
    }
    if (take("+")) return sign();
    return power();
  }
  Term power() {
    Term base = atom();
    if (!take("^")) return base;
    const Term exponent = sign();
    if (exponent.number) return {raised(base.unit, *exponent.number), std::nullopt};
    if (base.unit && *base.unit == UnitPowers{}) return {UnitPowers{}, std::nullopt};
    return {};
  }
  Term atom() {
    if (take("(")) {
      Term inside = choice();
      take(")");
      return inside;
    }
    if (at_ >= text_.size()) return {};
    if (internal::number_start(text_, at_)) return literal();
    const std::size_t start = at_;
    while (at_ < text_.size() && internal::name_character(text_[at_])) ++at_;
    const std::string name(text_.substr(start, at_ - start));
    if (name.empty()) {
      ++at_;  // nothing that an expression has
      return {};
    }
    if (take("(")) return call(name);
    if (name == "pi") return {UnitPowers{}, std::nullopt};
    return {of_name_(name), std::nullopt};
  }
  Term literal() {
    const std::size_t end = internal::number_end(text_, at_);
    const std::string number(text_.substr(at_, end - at_));
    const internal::NumberUnit unit = internal::number_unit(text_, at_, end);
    at_ = unit.end;
    Term term{.unit = std::nullopt, .number = std::strtod(number.c_str(), nullptr)};
    if (!unit.text.empty()) {
      if (unit.quantity && unit.quantity->dimension) term.unit = unit_powers(*unit.quantity->dimension);
      term.number.reset();
    } else if (bare_ == BareNumber::pure) {
      term.unit = UnitPowers{};
    }
    return term;
  }
  Term call(const std::string& name) {
    std::vector<Term> arguments;
    do {
      arguments.push_back(choice());
    } while (take(","));
    take(")");
    const Term& first = arguments.front();
    const auto has = [&](std::initializer_list<const char*> names) {
      for (const char* one : names) {
        if (name == one) return true;
      }
      return false;
    };
    if (has({"abs", "floor", "ceil", "round"})) return {first.unit, std::nullopt};
    if (has({"min", "max", "hypot", "clamp"})) {
      Term all = first;
      for (std::size_t i = 1; i < arguments.size(); ++i)
        all = {alike(all, arguments[i], "compares"), std::nullopt};
      return {all.unit, std::nullopt};
    }
    if (name == "sqrt") return {raised(first.unit, 0.5), std::nullopt};
    if (name == "atan2" && arguments.size() == 2) {
      alike(first, arguments[1], "compares");
    } else if (!has({"sign", "log", "log10"})) {  // the logarithm of a quantity is that of its SI number
      pure(first, name);
    }
    return {UnitPowers{}, std::nullopt};
  }

  std::string_view text_;
  const std::function<std::optional<UnitPowers>(const std::string&)>& of_name_;
  BareNumber bare_;
  std::size_t at_ = 0;
  std::string rule_;
};

}  // namespace

UnitPowers unit_powers(Dimension dimension) {
  for (const NamedUnit& one : kUnits) {
    if (one.dimension == dimension) return {one.powers};
  }
  return {};
}

std::string unit_text(const UnitPowers& powers) {
  if (powers.power == Powers{0, 0, -1, 0, 0}) return "1/s";
  if (const NamedUnit* unit = named(powers)) return std::string(si_unit(unit->dimension));
  constexpr const char* kNames[] = {"m", "kg", "s", "A", "K"};
  std::string text;
  for (const std::size_t i : {1U, 0U, 2U, 3U, 4U}) {
    const double power = powers.power[i];
    if (power == 0.0) continue;
    if (!text.empty()) text += ' ';
    text += power == 1.0 ? kNames[i] : fmt::format("{}^{}", kNames[i], power);
  }
  return text;
}

std::string unit_words(const UnitPowers& powers) {
  if (powers.power == Powers{0, 0, -1, 0, 0}) return "a number per second";
  const NamedUnit* unit = named(powers);
  return unit != nullptr ? std::string(dimension_name(unit->dimension)) : "something in " + unit_text(powers);
}

ExpressionUnit expression_unit(std::string_view text,
                               const std::function<std::optional<UnitPowers>(const std::string& name)>& of_name,
                               BareNumber bare) {
  return Parser(text, of_name, bare).run();
}

}  // namespace zwidth
