#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "zwidth/design/internal/evaluator.h"

namespace zwidth::internal {

/// All that a search needs to go on.
struct Checkpoint {
  std::vector<std::string> identity;  ///< of the search, a line each
  std::vector<Generation> history;
  std::vector<double> reference;
  EvaluationRecord record;
  Rows rows;           ///< the last whole generation
  std::string memory;  ///< of the engine
};

/// Replaces FILE, whose contents become FILE.previous; whatever happens on the way, one of the two is whole.
/// Throws std::runtime_error.
void write_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& file);

/// FILE, or FILE.previous if that cannot be used, and then says so in `notes`. Throws std::runtime_error if
/// neither can, or if it is of a search other than `identity`, and says what differs.
Checkpoint read_checkpoint(const std::filesystem::path& file, const std::vector<std::string>& identity,
                           std::vector<std::string>& notes);

}  // namespace zwidth::internal
