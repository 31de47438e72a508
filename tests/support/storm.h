#pragma once

#include <cstdlib>

namespace zwidth::test {

/// How many random cases a seeded storm runs: `default_size`, unless the environment asks for another number
/// (ZWIDTH_STORM=1e6, as `./test --slow` does). Asking for more never makes a storm smaller.
inline int storm_size(int default_size) {
  const char* asked = std::getenv("ZWIDTH_STORM");
  if (asked == nullptr) return default_size;
  const double size = std::strtod(asked, nullptr);
  return size > default_size && size <= 1e9 ? static_cast<int>(size) : default_size;
}

}  // namespace zwidth::test
