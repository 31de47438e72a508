#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numbers>
#include <regex>
#include <set>

#include "quantities.h"

// reference_cases FILE...: runs every case of the files and prints a line for each. Exit 0 if all cases that
// are covered agree, 1 if one does not, 2 if a file cannot be read.

namespace zwidth::reference {

namespace {

using nlohmann::json;

// JSON has no NaN and no infinity: null and "inf" stand for them.
double number_of(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  if (value.is_null()) return std::nan("");
  if (value == "inf") return HUGE_VAL;
  return value.get<double>();
}

void flatten(const json& value, Values& out) {
  if (value.is_structured()) {  // nlohmann's objects are sorted by key
    for (const json& element : value) flatten(element, out);
  } else {
    out.push_back(number_of(value));
  }
}

const json& required(const json& values, const std::string& key) {
  if (!values.contains(key)) throw std::out_of_range("the case has no input " + key);
  return values.at(key);
}

}  // namespace

double Inputs::number(const std::string& key) const {
  return number_of(required(values_, key));
}

int Inputs::integer(const std::string& key) const {
  return static_cast<int>(std::lround(number(key)));
}

Vector3 Inputs::vector(const std::string& key) const {
  const json& value = required(values_, key);
  if (value.is_number()) return Vector3::Constant(value.get<double>());
  return {number_of(value.at(0)), number_of(value.at(1)), number_of(value.at(2))};
}

double Inputs::degrees(const std::string& key) const {
  return number(key) * std::numbers::pi / 180.0;
}

std::vector<double> Inputs::list(const std::string& key) const {
  Values values;
  flatten(required(values_, key), values);
  return values;
}

std::size_t Inputs::count(const std::string& key) const {
  return required(values_, key).size();
}

bool Inputs::flag(const std::string& key) const {
  return required(values_, key).get<bool>();
}

std::vector<std::string> Inputs::texts(const std::string& key) const {
  return required(values_, key).get<std::vector<std::string>>();
}

Inputs Inputs::table(const std::string& key) const {
  return Inputs(required(values_, key));
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

// The largest difference of two sets of rows of angles, each row with its nearest that no other has taken.
double apart(const json& wanted, std::vector<Values> rows) {
  if (wanted.size() != rows.size()) return HUGE_VAL;
  double worst = 0.0;
  for (const json& one : wanted) {
    Values reference;
    flatten(one, reference);
    const auto distance = [&](const Values& row) {
      double largest = row.size() == reference.size() ? 0.0 : HUGE_VAL;
      for (std::size_t i = 0; i < reference.size() && i < row.size(); ++i) {
        const double turn = std::abs(std::remainder(row[i] - reference[i], 2.0 * std::numbers::pi));
        largest = std::isnan(turn) ? HUGE_VAL : std::max(largest, turn);
      }
      return largest;
    };
    const auto nearest = std::min_element(
        rows.begin(), rows.end(), [&](const Values& a, const Values& b) { return distance(a) < distance(b); });
    worst = std::max(worst, distance(*nearest));
    rows.erase(nearest);
  }
  return worst;
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
    Answer answer = found->second(Inputs(one.at("inputs")));
    if (const auto* direction = std::get_if<UpToSign>(&answer)) {
      Values values = direction->values, reference;
      flatten(wanted, reference);
      double along = 0.0;
      for (std::size_t i = 0; i < std::min(values.size(), reference.size()); ++i)
        along += values[i] * reference[i];
      if (along < 0.0) {
        for (double& value : values) value = -value;
      }
      answer = std::move(values);
    }
    if (const auto* name = std::get_if<std::string>(&answer)) {
      got = *name;
      ok = wanted.is_string() && expected == got;
    } else if (const auto* angles = std::get_if<AngleRows>(&answer)) {
      got = fmt::format("{} solutions", angles->rows.size());
      if (wanted.is_array()) {
        expected = fmt::format("{} solutions", wanted.size());
        const double worst = apart(wanted, angles->rows);
        difference = fmt::format("{:.2e}", worst);
        ok = worst <= tolerance.of(0.0);
      }
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

// A case that cannot even be read is missed like any other, with the reason.
void run_or_miss(const Quantities& quantities, const json& one, const std::string& place, Tally& tally) {
  try {
    run_case(quantities, one, tally);
  } catch (const json::exception& problem) {
    ++tally.failed;
    const bool named = one.is_object() && one.contains("id") && one.at("id").is_string();
    fmt::print("MISS {}  cannot be read: {}\n", named ? one.at("id").get<std::string>() : place,
               problem.what());
  }
}

// Python's json module writes NaN, which no other reader takes.
std::string without_nan(std::istream& stream) {
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  return std::regex_replace(text, std::regex(R"(([\[,:]\s*)NaN\b)"), "$1null");
}

int run(const std::vector<std::string>& files) {
  Quantities quantities;
  add_delta(quantities);
  add_arm(quantities);
  add_five_bar(quantities);
  add_actuation(quantities);
  add_r_cube(quantities);
  add_r_cube_elastic(quantities);
  add_seven_dof(quantities);
  add_pneumatic(quantities);
  add_design(quantities);
  Tally tally;
  for (const std::string& file : files) {
    std::ifstream stream(file);
    if (!stream) {
      fmt::print(stderr, "reference_cases: cannot read {}\n", file);
      return 2;
    }
    try {
      json cases = json::parse(without_nan(stream));
      if (cases.is_object()) cases = cases.at("cases");
      int number = 0;
      for (const json& one : cases) run_or_miss(quantities, one, fmt::format("case {}", ++number), tally);
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
