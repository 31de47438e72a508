#include "zwidth/analysis/internal/parallel.h"

#include <algorithm>
#include <mutex>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace zwidth::internal {

bool for_each_index(std::size_t count, const Effort& effort, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> done{0};
  std::atomic<bool> cancelled{false};
  std::mutex reporting;
  const auto one = [&](std::size_t index) {
    if (effort.cancel != nullptr && effort.cancel->load(std::memory_order_relaxed)) {
      cancelled = true;
      return;
    }
    body(index);
    const std::size_t so_far = ++done;
    if (!effort.progress) return;
    const std::unique_lock lock(reporting, std::try_to_lock);
    if (lock) effort.progress(static_cast<double>(so_far) / static_cast<double>(count));
  };
  if (effort.threads == 1) {
    for (std::size_t index = 0; index < count; ++index) one(index);
  } else {
    // Asking TBB for more threads than there are cores makes it print.
    const int cores = tbb::info::default_concurrency();
    tbb::task_arena arena(effort.threads > 0 ? std::min(effort.threads, cores) : cores);
    arena.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, count, 1),
          [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t index = range.begin(); index < range.end(); ++index) one(index);
          },
          tbb::simple_partitioner());
    });
  }
  return !cancelled;
}

}  // namespace zwidth::internal
