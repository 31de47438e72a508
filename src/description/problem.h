#pragma once

#include <stdexcept>
#include <string>
#include <vector>

/// What is wrong with a user's file or override, said so that it can be mended.

namespace zwidth {

/// One mistake: where it is, what stands there, which rule it breaks, what to do.
struct Problem {
  std::string file;   ///< path, "<stdin>", or "--set KEY" for an override; empty for a description made in code
  int line = 0;       ///< from 1; 0 where there is none
  int column = 0;     ///< from 1, counted in characters; 0 where there is none
  std::string key;    ///< dotted path such as "drive[0].motor"; empty for the file as a whole
  std::string value;  ///< as the user wrote it, shortened; empty if nothing is there
  std::string rule;   ///< what must hold, or what is the matter: "must be positive"
  std::string advice;  ///< what to do next; may be empty

  bool operator==(const Problem&) const = default;
};

/// "devices/x.toml:12:3: mechanism.forearm = \"-80 mm\": must be positive; give the length of the forearm".
std::string to_string(const Problem& problem);

/// Everything that is wrong with one input, at once. `what()` has one line per problem.
class DescriptionError : public std::runtime_error {
 public:
  /// REQUIRES: at least one problem.
  explicit DescriptionError(std::vector<Problem> problems);

  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// The candidates that a mistyped `name` most likely meant, nearest first, at most three; empty if none is
/// near.
std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& candidates);

/// `did you mean "a" or "b"?`, or `known are a, b, c` (at most a dozen), for `Problem::advice`.
std::string suggest(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace zwidth
