#include "zwidth/design/workers.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>
#include <mutex>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace zwidth {
namespace {

using Clock = std::chrono::steady_clock;

// Waking a thread takes some 10 to 50 us, taking rows from the common counter some 0.1 us.
constexpr double kWorthWaking = 100e-6;  // [s]
constexpr double kWorthTaking = 10e-6;   // [s]

class Workers {
 public:
  Workers(std::size_t variables, std::size_t outcomes, std::function<DesignEvaluation()> make_worker,
          const WorkerOptions& options)
      : variables_(variables),
        outcomes_(outcomes),
        make_worker_(std::move(make_worker)),
        options_(options),
        // Asking TBB for more threads than there are cores makes it print.
        threads_(options.threads > 0 ? std::min(options.threads, tbb::info::default_concurrency())
                                     : tbb::info::default_concurrency()),
        arena_(threads_),
        workers_(static_cast<std::size_t>(threads_)) {}

  bool evaluate(std::span<const double> designs, std::span<double> outcomes) {
    assert(designs.size() % variables_ == 0 && designs.size() / variables_ == outcomes.size() / outcomes_);
    const std::size_t count = outcomes.size() / outcomes_;
    const auto start = Clock::now();
    std::atomic<std::size_t> next{0};
    const double whole = cost_ * static_cast<double>(count);
    const bool alone = threads_ == 1 || count == 1 || (cost_ > 0.0 && whole < kWorthWaking);
    int helpers = 1;
    if (alone) {
      work(0, next, count, count, designs, outcomes);
    } else {
      // Small enough that nobody waits long for the last one.
      const double share = static_cast<double>(count) / (8.0 * threads_);
      const double chunk = cost_ > 0.0 ? std::min(kWorthTaking / cost_, share) : 1.0;
      const std::size_t rows = std::max<std::size_t>(1, static_cast<std::size_t>(chunk));
      helpers = threads_;
      arena_.execute([&] {
        tbb::parallel_for(0, threads_, [&](int) {
          const auto slot = static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
          work(slot, next, count, rows, designs, outcomes);
        });
      });
    }
    // The cost of a row steers only who does it.
    const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    if (count > 0) cost_ = elapsed * helpers / static_cast<double>(count);
    return !cancelled();
  }

 private:
  bool cancelled() const {
    return options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed);
  }

  void work(std::size_t slot, std::atomic<std::size_t>& next, std::size_t count, std::size_t rows,
            std::span<const double> designs, std::span<double> outcomes) {
    while (!cancelled()) {
      const std::size_t first = next.fetch_add(rows, std::memory_order_relaxed);
      if (first >= count) return;
      for (std::size_t row = first; row < std::min(count, first + rows) && !cancelled(); ++row) {
        one(slot, designs.subspan(row * variables_, variables_), outcomes.subspan(row * outcomes_, outcomes_));
      }
    }
  }

  void one(std::size_t slot, std::span<const double> design, std::span<double> outcomes) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    std::fill(outcomes.begin(), outcomes.end(), kNaN);
    const auto failed = [&](const char* what) {
      std::fill(outcomes.begin(), outcomes.end(), kNaN);
      if (!options_.failed) return;
      const std::lock_guard lock(failing_);
      options_.failed(what);
    };
    try {
      DesignEvaluation& worker = workers_[slot];
      if (!worker) worker = make_worker_();
      worker(design, outcomes);
    } catch (const std::exception& error) {
      failed(error.what());
    } catch (...) {
      failed("an exception that is no std::exception");
    }
  }

  std::size_t variables_, outcomes_;
  std::function<DesignEvaluation()> make_worker_;
  WorkerOptions options_;
  int threads_;
  tbb::task_arena arena_;
  std::vector<DesignEvaluation> workers_;  // one per slot of the arena, made by the thread that needs it first
  std::mutex failing_;
  double cost_ = 0.0;  // of a row in the batch before, on one thread [s]; 0 before the first
};

}  // namespace

BatchEvaluation on_workers(std::size_t variables, std::size_t outcomes,
                           std::function<DesignEvaluation()> make_worker, const WorkerOptions& options) {
  assert(variables > 0 && outcomes > 0);
  auto workers = std::make_shared<Workers>(variables, outcomes, std::move(make_worker), options);
  return [workers](std::span<const double> designs, std::span<double> rows) {
    return workers->evaluate(designs, rows);
  };
}

}  // namespace zwidth
