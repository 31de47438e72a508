#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "house/sources.h"

// Each room includes only the rooms of its link line, and only the outside libraries that it links. The lists
// come from CMake (zwidth_room.cmake), so they are written down once.

namespace zwidth::house {
namespace {

struct Room {
  std::set<std::string> rooms;      // that it may include, itself too
  std::set<std::string> libraries;  // CMake targets that it links
};

std::set<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::set<std::string> result;
  for (std::string word; stream >> word;) result.insert(word);
  return result;
}

std::map<std::string, Room> rooms() {
  std::map<std::string, Room> result;
  for (const std::string& line : lines(ZWIDTH_ROOMS)) {
    const std::size_t first = line.find(" | ");
    const std::size_t second = line.find(" | ", first + 1);
    Room& room = result[line.substr(0, first)];
    room.rooms = words(line.substr(first + 3, second - first - 3));
    room.rooms.insert(line.substr(0, first));
    room.libraries = words(line.substr(second + 3));
  }
  return result;
}

// The outside library that an include belongs to; none for the standard library and the system.
std::optional<std::string> library_of(const std::string& include) {
  static const std::map<std::string, std::string> kLibraries = {{"Eigen/", "Eigen3::Eigen"},
                                                                {"toml++/", "tomlplusplus::tomlplusplus"},
                                                                {"udunits2", "udunits2::udunits2"},
                                                                {"fmt/", "fmt::fmt"},
                                                                {"nlohmann/", "nlohmann_json::nlohmann_json"},
                                                                {"CLI/", "CLI11::CLI11"},
                                                                {"tbb/", "TBB::tbb"},
                                                                {"oneapi/tbb", "TBB::tbb"},
                                                                {"hwy/", "hwy::hwy"},
                                                                {"pagmo/", "Pagmo::pagmo"},
                                                                {"nlopt", "NLopt::nlopt"},
                                                                {"mpi.h", "MPI::MPI_CXX"},
                                                                {"muParser", "muparser::muparser"},
                                                                {"mujoco/", "mujoco::mujoco"},
                                                                {"kdl/", "orocos_kdl::orocos_kdl"},
                                                                {"gtest/", "GTest::gtest"},
                                                                {"benchmark/", "benchmark::benchmark"}};
  for (const auto& [prefix, library] : kLibraries) {
    if (include.starts_with(prefix)) return library;
  }
  return std::nullopt;
}

struct Include {
  std::string file;  // below the root
  int line = 0;
  bool quoted = false;
  std::string target;
};

std::vector<Include> includes_of(const std::filesystem::path& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<Include> result;
  int number = 0;
  for (const std::string& line : lines(file)) {
    ++number;
    if (std::smatch match; std::regex_search(line, match, kInclude)) {
      result.push_back({name(file), number, match[1] == "\"", match[2]});
    }
  }
  return result;
}

bool is_source(const std::filesystem::path& file) {
  return file.extension() == ".h" || file.extension() == ".cpp";
}

TEST(IncludeRule, RoomsAreThoseOfTheSourceTree) {
  std::set<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(root() / "src")) {
    if (entry.is_directory()) folders.insert(entry.path().filename().string());
  }
  std::set<std::string> targets;
  for (const auto& [room, permitted] : rooms()) targets.insert(room);
  EXPECT_EQ(folders, targets) << "every folder of src/ is one zwidth_room";
}

TEST(IncludeRule, ARoomIncludesOnlyWhatItsLinkLineNames) {
  const std::map<std::string, Room> permitted = rooms();
  for (const auto& [room, may] : permitted) {
    for (const std::filesystem::path& file : files(root() / "src" / room)) {
      if (!is_source(file)) continue;
      for (const Include& include : includes_of(file)) {
        const std::string where = include.file + ":" + std::to_string(include.line) + ": ";
        if (!include.quoted) continue;
        ASSERT_TRUE(include.target.starts_with("zwidth/"))
            << where << "includes \"" << include.target
            << "\"; the project's headers are \"zwidth/ROOM/NAME.h\"";
        const std::string below = include.target.substr(7);
        const std::string other = below.substr(0, below.find('/'));
        EXPECT_TRUE(may.rooms.contains(other)) << where << room << " may not include the room " << other;
        EXPECT_TRUE(std::filesystem::exists(root() / "src" / below)) << where << "no such header";
        EXPECT_TRUE(other == room || below.find("/internal/") == std::string::npos)
            << where << "includes an internal header of the room " << other;
      }
    }
  }
}

TEST(IncludeRule, ARoomUsesOnlyTheLibrariesThatItLinks) {
  const std::map<std::string, Room> permitted = rooms();
  for (const auto& [room, may] : permitted) {
    std::set<std::string> libraries;
    for (const std::string& other : may.rooms) {
      if (!permitted.contains(other)) continue;
      libraries.insert(permitted.at(other).libraries.begin(), permitted.at(other).libraries.end());
    }
    for (const std::filesystem::path& file : files(root() / "src" / room)) {
      if (!is_source(file)) continue;
      for (const Include& include : includes_of(file)) {
        const std::optional<std::string> library = library_of(include.target);
        EXPECT_TRUE(!library || libraries.contains(*library))
            << include.file << ":" << include.line << ": " << room << " does not link " << library.value_or("");
      }
    }
  }
}

TEST(IncludeRule, RoomsFormNoCircle) {
  // Each room's list holds every room that its rooms may use, so a circle would contain two that name each
  // other.
  const std::map<std::string, Room> permitted = rooms();
  for (const auto& [room, may] : permitted) {
    for (const std::string& other : may.rooms) {
      if (other == room) continue;
      ASSERT_TRUE(permitted.contains(other)) << room << " names a room that is not there: " << other;
      EXPECT_FALSE(permitted.at(other).rooms.contains(room))
          << room << " and " << other << " include each other";
      for (const std::string& next : permitted.at(other).rooms) {
        EXPECT_TRUE(may.rooms.contains(next))
            << room << " uses " << next << " through " << other << " without naming it";
      }
    }
  }
}

TEST(IncludeRule, HeadersStandAlone) {
  for (const std::filesystem::path& file : files(root() / "src")) {
    if (file.extension() == ".h") {
      if (name(file).ends_with("-inl.h")) continue;  // Highway's, included once per instruction set
      EXPECT_NE(read(file).find("#pragma once"), std::string::npos) << name(file);
      continue;
    }
    std::filesystem::path header = file;
    header.replace_extension(".h");
    if (file.extension() != ".cpp" || !std::filesystem::exists(header)) continue;
    const std::vector<Include> includes = includes_of(file);
    ASSERT_FALSE(includes.empty()) << name(file);
    EXPECT_EQ("src/" + includes.front().target.substr(7), name(header))
        << name(file) << ": its own header comes first";
  }
}

}  // namespace
}  // namespace zwidth::house
