#pragma once

#include <map>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "zwidth/description/problem.h"

/// The text of a file as a tree, with what was overridden in it and what is wrong with it.

namespace zwidth {

/// Largest file that is read at all. [bytes]
inline constexpr std::size_t kLargestFile = 1 << 20;

/// One TOML file being read, with what was overridden in it and what is wrong with it.
class Input {
 public:
  /// Throws DescriptionError if the text is no TOML, or deeper or longer than any description.
  Input(std::string_view text, std::string_view file);

  /// Changes the tree as `--set` asks; notes a problem if the key cannot be.
  void set(const std::string& override_text);

  const toml::table& root() const { return root_; }

  /// Notes what is wrong with the value at `path`. The place is that of the value, or of the nearest table
  /// around it.
  void report(const std::string& path, std::string rule, std::string advice);
  /// What `validate` calls `path` stands at `in_file`.
  void alias(std::string path, std::string in_file);
  /// Adds what `validate` found, with places, except where the value or its table could not be read anyway.
  void add_value_problems(const std::vector<Problem>& problems);

  /// Whether something at `path`, in it or around it, or the type of a table around it, is known to be wrong.
  bool faulty(const std::string& path) const;
  bool has_problems() const { return !problems_.empty(); }

  /// Throws DescriptionError if anything is wrong, in the order of the file.
  void throw_problems();

 private:
  void set_in(toml::node& node, const std::vector<std::string>& parts, std::size_t next,
              const std::string& path, const toml::node& value, const std::string& label);
  // The deepest node on the way to a path, and whether that is all the way.
  struct Found {
    const toml::node* node;
    std::string path;
    bool complete;
  };
  Found find(const std::string& path) const;
  void place(Problem& problem) const;

  std::string file_;
  toml::table root_;
  std::map<std::string, std::string> overridden_;  // path -> "--set KEY"
  std::map<std::string, std::string> aliases_;     // path of a table in the description -> in the file
  std::vector<Problem> problems_;
};

/// The text of a file, "-" being the standard input. Throws DescriptionError if there is none to be had.
std::string read_text(const std::string& path);

/// "a table", "a string", ... for messages.
std::string_view kind_of(const toml::node& node);

}  // namespace zwidth
