#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Runs the built command as a child process, as a user would.

namespace zwidth::testing {

struct Outcome {
  int status = -1;  ///< exit status; 128 + signal if it was killed
  std::string out;  ///< standard output
  std::string err;  ///< standard error

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

struct RunOptions {
  std::string input;                     ///< standard input
  std::string output_file;               ///< goes there instead of `out`
  std::filesystem::path directory;       ///< to run in; empty stays
  std::vector<std::string> environment;  ///< "NAME=VALUE", besides PATH, HOME and LANG
  std::vector<std::string> launcher;     ///< runs the command; its first word is a path
  int signal = 0;                        ///< to send to it, as soon as `signal_when` says so
  std::function<bool()> signal_when;
};

Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A directory of its own, removed at the end.
class ScratchDirectory {
 public:
  ScratchDirectory();
  ~ScratchDirectory();
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file there, and gives its path.
  std::string file(const std::string& name, const std::string& contents) const;

 private:
  std::filesystem::path path_;
};

std::string read_text(const std::filesystem::path& path);

}  // namespace zwidth::testing
