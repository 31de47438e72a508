#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <numbers>
#include <set>

#include "quantities.h"

// reference_cases FILE...: runs every case of the files and prints a line for each. Exit 0 if all cases that
// are covered agree, 1 if one does not, 2 if a file cannot be read.

namespace zwidth::reference {

namespace {

using nlohmann::json;

void flatten(const json& value, Values& out) {
  if (value.is_array()) {
    for (const json& element : value) flatten(element, out);
  } else {
    out.push_back(value.is_boolean() ? static_cast<double>(value.get<bool>()) : value.get<double>());
  }
}

const json& required(const json& values, const std::string& key) {
  if (!values.contains(key)) throw std::out_of_range("the case has no input " + key);
  return values.at(key);
}

}  // namespace

double Inputs::number(const std::string& key) const {
  return required(values_, key).get<double>();
}

int Inputs::integer(const std::string& key) const {
  return static_cast<int>(std::lround(number(key)));
}

Vector3 Inputs::vector(const std::string& key) const {
  const json& value = required(values_, key);
  if (value.is_number()) return Vector3::Constant(value.get<double>());
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

double Inputs::degrees(const std::string& key) const {
  return number(key) * std::numbers::pi / 180.0;
}

std::vector<double> Inputs::list(const std::string& key) const {
  Values values;
  flatten(required(values_, key), values);
  return values;
}

bool Inputs::flag(const std::string& key) const {
  return required(values_, key).get<bool>();
}

std::string Inputs::text(const std::string& key) const {
  return required(values_, key).get<std::string>();
}

namespace {

struct Tally {
  int passed = 0;
  int failed = 0;
  int cases_left_out = 0;
  std::set<std::string> left_out;
};

// How far an element may lie from its reference: a number, or { abs, rel } of which rel is a share of the
// element.
struct Tolerance {
  double absolute = 0.0;
  double relative = 0.0;

  explicit Tolerance(const json& one) {
    if (!one.contains("tolerance")) return;
    const json& given = one.at("tolerance");
    absolute = given.is_object() ? given.value("abs", 0.0) : given.get<double>();
    if (given.is_object()) relative = given.value("rel", 0.0);
  }
  double of(double reference) const { return absolute + relative * std::abs(reference); }
  std::string shown() const {
    return relative > 0.0 ? fmt::format("{:.2e} + {:.2e} of it", absolute, relative)
                          : fmt::format("{:.2e}", absolute);
  }
};

std::string shown(const Values& values) {
  if (values.size() == 1) return fmt::format("{:.9g}", values[0]);
  return fmt::format("[{:.6g}]", fmt::join(values, ", "));
}

void run_case(const Quantities& quantities, const json& one, Tally& tally) {
  const std::string id = one.at("id"), quantity = one.at("quantity");
  const auto found = quantities.find(quantity);
  if (found == quantities.end()) {
    ++tally.cases_left_out;
    tally.left_out.insert(quantity);
    return;
  }
  const json& wanted = one.at("value");
  const Tolerance tolerance(one);
  std::string expected = wanted.is_string() ? wanted.get<std::string>() : "", got, difference = "-";
  bool ok = false;
  try {
    const Answer answer = found->second(Inputs(one.at("inputs")));
    if (const auto* name = std::get_if<std::string>(&answer)) {
      got = *name;
      ok = wanted.is_string() && expected == got;
    } else if (const Values& values = std::get<Values>(answer); wanted.is_string()) {
      got = shown(values);
    } else {
      got = shown(values);
      Values reference;
      flatten(wanted, reference);
      expected = shown(reference);
      double worst = reference.size() == values.size() ? 0.0 : HUGE_VAL;
      ok = reference.size() == values.size();
      for (std::size_t i = 0; i < reference.size() && i < values.size(); ++i) {
        const double apart = std::abs(values[i] - reference[i]);
        worst = std::isnan(apart) ? HUGE_VAL : std::max(worst, apart);
        ok = ok && apart <= tolerance.of(reference[i]);
      }
      difference = fmt::format("{:.2e}", worst);
    }
  } catch (const Refusal& refusal) {
    got = fmt::format("error:{}", refusal.what());
    ok = wanted.is_string() && expected == got;
  } catch (const std::invalid_argument& refusal) {  // how the library refuses plain numbers
    got = "error:invalid_argument";
    ok = wanted.is_string() && expected == got;
  } catch (const std::exception& problem) {
    got = problem.what();
  }
  if (!wanted.is_string() && expected.empty()) expected = wanted.dump();
  ++(ok ? tally.passed : tally.failed);
  fmt::print("{:<4} {}  {}  expected {}  got {}  difference {}  tolerance {} {}\n", ok ? "ok" : "MISS", id,
             quantity, expected, got, difference, tolerance.shown(), one.value("unit", ""));
}

int run(const std::vector<std::string>& files) {
  Quantities quantities;
  add_delta(quantities);
  add_actuation(quantities);
  add_r_cube(quantities);
  Tally tally;
  for (const std::string& file : files) {
    std::ifstream stream(file);
    if (!stream) {
      fmt::print(stderr, "reference_cases: cannot read {}\n", file);
      return 2;
    }
    try {
      json cases = json::parse(stream);
      if (cases.is_object()) cases = cases.at("cases");
      for (const json& one : cases) run_case(quantities, one, tally);
    } catch (const json::exception& problem) {
      fmt::print(stderr, "reference_cases: {}: {}\n", file, problem.what());
      return 2;
    }
  }
  if (!tally.left_out.empty()) {
    fmt::print("not covered ({} cases): {}\n", tally.cases_left_out, fmt::join(tally.left_out, ", "));
  }
  fmt::print("{} passed, {} failed\n", tally.passed, tally.failed);
  return tally.failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace zwidth::reference

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: reference_cases FILE...\n");
    return 2;
  }
  return zwidth::reference::run({argv + 1, argv + argc});
}
