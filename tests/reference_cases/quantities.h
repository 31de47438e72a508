#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "zwidth/math/spatial.h"

/// What a reference case can ask for. Every quantity is a call of the library; nothing is computed here.

namespace zwidth::reference {

/// An answer that is an error by name ("unreachable", "invalid_argument", ...).
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The inputs of one case. A missing key throws std::out_of_range with its name.
class Inputs {
 public:
  explicit Inputs(const nlohmann::json& values) : values_(values) {}

  bool has(const std::string& key) const { return values_.contains(key); }
  double number(const std::string& key) const;
  double number_or(const std::string& key, double fallback) const { return has(key) ? number(key) : fallback; }
  int integer(const std::string& key) const;
  /// Three numbers; a single one stands for three equal ones.
  Vector3 vector(const std::string& key) const;
  std::size_t count(const std::string& key) const;  ///< elements of an array, rows of a nested one
  double degrees(const std::string& key) const;     ///< given in deg, in rad
  /// An array of numbers of any length; nested ones row by row.
  std::vector<double> list(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;
  Inputs table(const std::string& key) const;

 private:
  const nlohmann::json& values_;
};

/// An answer in numbers: one, an array row by row, or the values of an object in the order of its keys'
/// letters. Yes is 1 and no is 0.
using Values = std::vector<double>;
/// Rows of angles [rad] in any order, each angle modulo a turn.
struct AngleRows {
  std::vector<Values> rows;
};
/// A direction of which either sign will do.
struct UpToSign {
  Values values;
};
/// Numbers, a name, or solutions.
using Answer = std::variant<Values, std::string, AngleRows, UpToSign>;
using Quantity = std::function<Answer(const Inputs&)>;
using Quantities = std::map<std::string, Quantity>;

void add_delta(Quantities& quantities);
void add_arm(Quantities& quantities);
void add_five_bar(Quantities& quantities);
void add_actuation(Quantities& quantities);
void add_r_cube(Quantities& quantities);
void add_r_cube_elastic(Quantities& quantities);
void add_seven_dof(Quantities& quantities);
void add_pneumatic(Quantities& quantities);
void add_design(Quantities& quantities);

}  // namespace zwidth::reference
