#pragma once

#include <cstddef>
#include <functional>

#include "zwidth/analysis/workspace.h"

namespace zwidth::internal {

/// Calls body(0) .. body(count - 1) on the threads that `effort` allows, in no particular order, and reports
/// progress. Returns false if it was cancelled before all were called.
bool for_each_index(std::size_t count, const Effort& effort, const std::function<void(std::size_t)>& body);

}  // namespace zwidth::internal
