#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "zwidth/description/parts.h"
#include "zwidth/description/problem.h"
#include "zwidth/description/units.h"

namespace zwidth {

/// Where parts and built-in devices lie: $ZWIDTH_DATA if set, else ../share/zwidth beside the running program's
/// directory, else the directory that zwidth was configured to install to.
std::filesystem::path default_data_directory();

/// A device or a study that comes with zwidth.
struct BuiltinFile {
  std::string name;   ///< file name without ".toml", as commands take it
  std::string title;  ///< title in its first table; says so if the file cannot be read
  std::filesystem::path path;
};

/// The parts and devices of one data directory, read once and never changed.
class Catalogue {
 public:
  /// Nothing in it.
  Catalogue() = default;

  /// Reads
  /// DIRECTORY/parts/{motors,gearheads,encoders,amplifiers,cables,bearings,materials,laminae,cylinders,
  /// regulators,potentiometers}.toml and lists DIRECTORY/devices/*.toml and DIRECTORY/studies/*.toml. Throws
  /// DescriptionError with everything that is wrong in the parts files.
  static Catalogue load(const std::filesystem::path& directory = default_data_directory());

  /// Parts of one kind (Motor, Gearhead, Encoder, Amplifier, Cable, Bearing, Material, Lamina, Cylinder,
  /// Regulator, Potentiometer), in the order of their file.
  template <class Part>
  const std::vector<Part>& all() const;
  /// Null if there is no such part.
  template <class Part>
  const Part* find(std::string_view name) const;

  const std::vector<BuiltinFile>& devices() const { return devices_; }  ///< by name
  const std::vector<BuiltinFile>& studies() const { return studies_; }  ///< by name
  const std::filesystem::path& directory() const { return directory_; }

 private:
  std::filesystem::path directory_;
  std::vector<Motor> motors_;
  std::vector<Gearhead> gearheads_;
  std::vector<Encoder> encoders_;
  std::vector<Amplifier> amplifiers_;
  std::vector<Cable> cables_;
  std::vector<Bearing> bearings_;
  std::vector<Material> materials_;
  std::vector<Lamina> laminae_;
  std::vector<Cylinder> cylinders_;
  std::vector<Regulator> regulators_;
  std::vector<Potentiometer> potentiometers_;
  std::vector<BuiltinFile> devices_;
  std::vector<BuiltinFile> studies_;
};

/// File that DEVICE on a command line means: a built-in device by name, else a path (anything with a '/' or
/// ending in
/// ".toml"). Throws DescriptionError with the built-ins and the nearest of them if it is neither.
std::filesystem::path resolve_device(std::string_view device, const Catalogue& catalogue);
/// The same for STUDY.
std::filesystem::path resolve_study(std::string_view study, const Catalogue& catalogue);

/// One value of a part, for lists and tables.
struct PartValue {
  std::string key;     ///< as in parts/*.toml
  double value = 0.0;  ///< SI; NaN if the source gives none
  Dimension dimension = Dimension::number;
  std::string meaning;  ///< a phrase without its unit
  std::string source;   ///< of this value: its own, else the part's
};

/// Every value of a part of any kind, in the order of its definition.
template <class Part>
std::vector<PartValue> part_values(const Part& part);

/// "motor", "encoder", ... as device files write it.
template <class Part>
std::string_view part_kind();

}  // namespace zwidth
