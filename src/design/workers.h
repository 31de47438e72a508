#pragma once

#include <atomic>
#include <memory>

#include "zwidth/design/search.h"

/// Evaluates designs on several cores.

namespace zwidth {

/// Evaluates one design: see `BatchEvaluation`. What it leaves untouched is NaN. An exception makes the whole
/// row NaN and harms no other.
using DesignEvaluation = std::function<void(std::span<const double> design, std::span<double> outcomes)>;

struct WorkerOptions {
  int threads = 0;  ///< at most this many; 0 uses all cores, and more than all are not used
  const std::atomic<bool>* cancel = nullptr;  ///< set it to make a batch return false soon
  /// Called with what an evaluation threw, from any thread, never at once.
  std::function<void(const std::string& what)> failed;
};

/// A batch evaluation that spreads its rows over threads. `make_worker` is called once per thread that takes
/// part, so that each has scratch memory of its own. Rows are dealt out as threads come free; those that cost
/// microseconds in such numbers that threads pay for themselves, too few rows for that stay on the calling
/// thread. Idle threads sleep (after the short while in which TBB waits for more).
/// REQUIRES: variables > 0 and outcomes > 0 values in a row.
BatchEvaluation on_workers(std::size_t variables, std::size_t outcomes,
                           std::function<DesignEvaluation()> make_worker, const WorkerOptions& options = {});

}  // namespace zwidth
