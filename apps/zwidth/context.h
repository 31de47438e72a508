#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "terminal.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"

/// What every verb shares: its outcome, the device it reads, and how it prints.

namespace CLI {
class App;
}

namespace zwidth {

/// Exit status of the command.
enum Exit : int {
  kDone = 0,
  kNo = 1,             ///< the answer is "no": unreachable, infeasible, not reproduced
  kInputWrong = 2,     ///< a mistake in the command line or in a file
  kMachineFailed = 3,  ///< disk, memory, a missing program
};

/// A mistake in the command line. `what()` says what, the value, the rule and what to do next.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine failed. `what()` says what and what to do next.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Object keys keep the order in which they are written.
using Json = nlohmann::ordered_json;

/// What the command line asked for: a verb sets `run`, and main calls it.
struct Context {
  Terminal terminal;
  std::function<int()> run;
};

/// The arguments DEVICE and --set.
struct DeviceArguments {
  std::string device;
  std::vector<std::string> overrides;
  bool json = false;
};

/// Adds DEVICE, --set and --json to a verb.
void add_device_arguments(CLI::App& verb, DeviceArguments& arguments);

/// Adds --json.
void add_json_flag(CLI::App& verb, bool& json);

/// A verb with its examples, shown below its help.
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description,
                   const std::string& examples);

/// The parts and devices that come with zwidth, read on first use.
const Catalogue& catalogue();

/// The description of a device, with its overrides, held to the rules of every room. Throws DescriptionError.
Description read_device(const std::string& device, const std::vector<std::string>& overrides);
inline Description read_device(const DeviceArguments& arguments) {
  return read_device(arguments.device, arguments.overrides);
}

/// Writes to the standard output; a full disk or a closed pipe throws MachineError.
void print(const std::string& text);
/// Writes one JSON document. No number in it is NaN or infinite: see `json_number`.
void print_json(const Json& document);
/// Writes a line to the standard error, prefixed "zwidth: ".
void complain(const std::string& text);

/// The directory `wanted`, or `otherwise` if that is empty, with a directory "figures" in it; made if need be.
/// Throws InputError where it is a file, MachineError where it cannot be made.
std::filesystem::path results_directory(const std::string& wanted, const std::filesystem::path& otherwise);

/// Writes a whole file, or throws MachineError naming it.
void write_file(const std::string& path, std::string_view contents);

/// The number, or null where it is undefined (NaN, infinite).
Json json_number(double value);
/// A vector as an array, a matrix as an array of rows.
template <class Derived>
Json json_array(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    if (matrix.cols() == 1) {
      rows.push_back(json_number(matrix(r, 0)));
      continue;
    }
    Json row = Json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(json_number(matrix(r, c)));
    rows.push_back(row);
  }
  return rows;
}
inline Json json_interval(const Interval& interval) {
  return {json_number(interval.min), json_number(interval.max)};
}

}  // namespace zwidth
