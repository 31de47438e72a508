#include "context.h"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <system_error>

#include "zwidth/actuation/drive_problems.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/mechanism_problems.h"

namespace zwidth {

void add_device_arguments(CLI::App& verb, DeviceArguments& arguments) {
  verb.add_option("DEVICE", arguments.device,
                  "built-in device (see `zwidth devices`), a .toml file, or - for the standard input")
      ->required();
  verb.add_option("--set", arguments.overrides,
                  "change a value of the device file, e.g. mechanism.forearm=\"170 mm\"; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_json_flag(verb, arguments.json);
}

void add_json_flag(CLI::App& verb, bool& json) {
  verb.add_flag("--json", json, "print one JSON document, SI units and radians");
}

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description,
                   const std::string& examples) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->footer("\nExamples:\n" + examples);
  return verb;
}

const Catalogue& catalogue() {
  static const Catalogue loaded = Catalogue::load();
  return loaded;
}

Description read_device(const std::string& device, const std::vector<std::string>& overrides) {
  static constexpr DescriptionCheck kChecks[] = {drive_problems, beam_problems, mechanism_problems};
  return read_description(device, overrides, catalogue(), kChecks);
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw MachineError(fmt::format("cannot write to the standard output: {}", std::strerror(errno)));
  }
}

void print_json(const Json& document) {
  print(document.dump(2) + "\n");
}

void complain(const std::string& text) {
  const std::string line = "zwidth: " + text + "\n";
  std::fputs(detect_terminal(2).unicode ? line.c_str() : spelled_in_ascii(line).c_str(), stderr);
}

std::filesystem::path results_directory(const std::string& wanted, const std::filesystem::path& otherwise) {
  const std::filesystem::path directory = wanted.empty() ? otherwise : std::filesystem::path(wanted);
  std::error_code error;
  if (std::filesystem::exists(directory, error) && !std::filesystem::is_directory(directory, error)) {
    throw InputError(fmt::format("-o {}: is a file; name a directory", directory.string()));
  }
  std::filesystem::create_directories(directory / "figures", error);
  if (error) {
    throw MachineError(fmt::format("cannot make the directory {}: {}; name another with -o", directory.string(),
                                   error.message()));
  }
  return directory;
}

void write_file(const std::string& path, std::string_view contents) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  bool good = file != nullptr;
  if (good) {
    good = std::fwrite(contents.data(), 1, contents.size(), file) == contents.size();
    // A full disk may show only when the last block is written.
    good = std::fclose(file) == 0 && good;
  }
  if (!good) throw MachineError(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
}

Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace zwidth
