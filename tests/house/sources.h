#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

/// The files of the repository, as the tests of the house read them.
namespace zwidth::house {

inline std::filesystem::path root() {
  return ZWIDTH_ROOT;
}

inline std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines(const std::filesystem::path& file) {
  std::istringstream stream(read(file));
  std::vector<std::string> result;
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// Path below the root, as a person writes it.
inline std::string name(const std::filesystem::path& file) {
  return file.lexically_relative(root()).generic_string();
}

/// Every file below `folder`, sorted, leaving out what git leaves out: hidden folders and build results.
inline std::vector<std::filesystem::path> files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> result;
  for (auto entry = std::filesystem::recursive_directory_iterator(folder); entry != end(entry); ++entry) {
    const std::string base = entry->path().filename().string();
    const bool at_root = entry.depth() == 0 && folder == root();
    const bool hidden = entry->is_directory() && base.starts_with(".") && base != ".ci";
    if (hidden || (at_root && (base == "build" || base == "report" || base == "node_modules"))) {
      entry.disable_recursion_pending();
      continue;
    }
    // In a git worktree .git is a file.
    if (entry->is_regular_file() && base != ".git") result.push_back(entry->path());
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace zwidth::house
