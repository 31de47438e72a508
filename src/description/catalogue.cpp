#include "zwidth/description/catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <system_error>

#include "zwidth/description/internal/part_reader.h"

namespace zwidth {
namespace {

namespace fs = std::filesystem;

bool good_name(const std::string& name) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), good);
}

template <class Part>
std::vector<Part> load_parts(const fs::path& path, std::vector<Problem>& problems) {
  std::vector<Part> parts;
  try {
    Input input(read_text(path.string()), path.string());
    TableReader file(input, input.root(), "");
    for (auto& [name, table] : file.all_tables()) {
      Part part;
      part.info.name = name;
      if (!good_name(name)) {
        file.report(name, "is no name of a part", "write it in small letters, digits, '-' and '.'");
      }
      read_part_values(table, part, false, Need::required);
      input.add_value_problems(field_problems(part, table.path()));
      parts.push_back(part);
    }
    input.throw_problems();
  } catch (const DescriptionError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
  return parts;
}

// The title in a file's first table, without judging the rest of it.
std::string title_of(const fs::path& path, std::string_view table) {
  try {
    const Input input(read_text(path.string()), path.string());
    if (const auto title = input.root()[table]["title"].value<std::string>()) return *title;
    return path.stem().string();
  } catch (const DescriptionError&) {
    return "(cannot be read)";
  }
}

std::vector<BuiltinFile> list_files(const fs::path& directory, std::string_view table) {
  std::vector<BuiltinFile> files;
  std::error_code error;
  for (const fs::directory_entry& file : fs::directory_iterator(directory, error)) {
    if (file.path().extension() != ".toml") continue;
    files.push_back(
        {.name = file.path().stem().string(), .title = title_of(file.path(), table), .path = file.path()});
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return files;
}

}  // namespace

fs::path default_data_directory() {
  if (const char* data = std::getenv("ZWIDTH_DATA"); data != nullptr && *data != '\0') return data;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path beside = program.parent_path().parent_path() / "share" / "zwidth";
    if (fs::is_directory(beside / "parts", error)) return beside;
  }
  return ZWIDTH_INSTALLED_DATA;
}

Catalogue Catalogue::load(const fs::path& directory) {
  Catalogue catalogue;
  catalogue.directory_ = directory;
  std::error_code error;
  if (!fs::is_directory(directory / "parts", error)) {
    throw DescriptionError({{.file = directory.string(),
                             .rule = "has no directory \"parts\", so it is not zwidth's data directory",
                             .advice = "set ZWIDTH_DATA to the directory that holds parts/ and devices/"}});
  }
  std::vector<Problem> problems;
  const fs::path parts = directory / "parts";
  catalogue.motors_ = load_parts<Motor>(parts / "motors.toml", problems);
  catalogue.gearheads_ = load_parts<Gearhead>(parts / "gearheads.toml", problems);
  catalogue.encoders_ = load_parts<Encoder>(parts / "encoders.toml", problems);
  catalogue.amplifiers_ = load_parts<Amplifier>(parts / "amplifiers.toml", problems);
  catalogue.cables_ = load_parts<Cable>(parts / "cables.toml", problems);
  catalogue.bearings_ = load_parts<Bearing>(parts / "bearings.toml", problems);
  catalogue.materials_ = load_parts<Material>(parts / "materials.toml", problems);
  catalogue.laminae_ = load_parts<Lamina>(parts / "laminae.toml", problems);
  catalogue.cylinders_ = load_parts<Cylinder>(parts / "cylinders.toml", problems);
  catalogue.regulators_ = load_parts<Regulator>(parts / "regulators.toml", problems);
  catalogue.potentiometers_ = load_parts<Potentiometer>(parts / "potentiometers.toml", problems);
  if (!problems.empty()) throw DescriptionError(std::move(problems));
  catalogue.devices_ = list_files(directory / "devices", "device");
  catalogue.studies_ = list_files(directory / "studies", "study");
  return catalogue;
}

template <>
const std::vector<Motor>& Catalogue::all<Motor>() const {
  return motors_;
}
template <>
const std::vector<Gearhead>& Catalogue::all<Gearhead>() const {
  return gearheads_;
}
template <>
const std::vector<Encoder>& Catalogue::all<Encoder>() const {
  return encoders_;
}
template <>
const std::vector<Amplifier>& Catalogue::all<Amplifier>() const {
  return amplifiers_;
}
template <>
const std::vector<Cable>& Catalogue::all<Cable>() const {
  return cables_;
}
template <>
const std::vector<Bearing>& Catalogue::all<Bearing>() const {
  return bearings_;
}
template <>
const std::vector<Material>& Catalogue::all<Material>() const {
  return materials_;
}
template <>
const std::vector<Lamina>& Catalogue::all<Lamina>() const {
  return laminae_;
}
template <>
const std::vector<Cylinder>& Catalogue::all<Cylinder>() const {
  return cylinders_;
}
template <>
const std::vector<Regulator>& Catalogue::all<Regulator>() const {
  return regulators_;
}
template <>
const std::vector<Potentiometer>& Catalogue::all<Potentiometer>() const {
  return potentiometers_;
}

template <class Part>
const Part* Catalogue::find(std::string_view name) const {
  const std::vector<Part>& parts = all<Part>();
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const Part& part) { return part.info.name == name; });
  return found == parts.end() ? nullptr : &*found;
}
template const Motor* Catalogue::find<Motor>(std::string_view) const;
template const Gearhead* Catalogue::find<Gearhead>(std::string_view) const;
template const Encoder* Catalogue::find<Encoder>(std::string_view) const;
template const Amplifier* Catalogue::find<Amplifier>(std::string_view) const;
template const Cable* Catalogue::find<Cable>(std::string_view) const;
template const Bearing* Catalogue::find<Bearing>(std::string_view) const;
template const Material* Catalogue::find<Material>(std::string_view) const;
template const Lamina* Catalogue::find<Lamina>(std::string_view) const;
template const Cylinder* Catalogue::find<Cylinder>(std::string_view) const;
template const Regulator* Catalogue::find<Regulator>(std::string_view) const;
template const Potentiometer* Catalogue::find<Potentiometer>(std::string_view) const;

namespace {

// `what` is "device" or "study".
fs::path resolve(std::string_view name, const std::vector<BuiltinFile>& builtins, std::string_view what) {
  std::vector<std::string> names;
  for (const BuiltinFile& builtin : builtins) {
    if (builtin.name == name) return builtin.path;
    names.push_back(builtin.name);
  }
  const std::string path(name);
  std::error_code error;
  if (path.find('/') != path.npos || path.ends_with(".toml") || (!path.empty() && fs::exists(path, error)))
    return path;
  throw DescriptionError({{.file = path.empty() ? "\"\"" : path,
                           .rule = fmt::format("is neither a built-in {} nor a file", what),
                           .advice = suggest(path, names) + " (a path has a '/' or ends in .toml)"}});
}

}  // namespace

fs::path resolve_device(std::string_view device, const Catalogue& catalogue) {
  return resolve(device, catalogue.devices(), "device");
}

fs::path resolve_study(std::string_view study, const Catalogue& catalogue) {
  return resolve(study, catalogue.studies(), "study");
}

}  // namespace zwidth
