#include "zwidth/design/workers.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <gtest/gtest.h>
#include <limits>
#include <mutex>
#include <set>
#include <thread>

namespace zwidth {
namespace {

// Scratch memory of its own, used in a way that shows if two threads share it.
DesignEvaluation sum_and_product(std::atomic<int>& made) {
  ++made;
  return [scratch = std::vector<double>()](std::span<const double> x, std::span<double> f) mutable {
    scratch.assign(x.begin(), x.end());
    f[0] = f[1] = 0.0;
    for (int repeat = 0; repeat < 50; ++repeat) {
      f[0] += scratch[0] + scratch[1];
      f[1] += scratch[0] * scratch[1];
    }
  };
}

std::vector<double> designs_of(std::size_t count) {
  std::vector<double> designs;
  for (std::size_t i = 0; i < count; ++i) designs.insert(designs.end(), {0.5 * static_cast<double>(i), 3.0});
  return designs;
}

TEST(Workers, EveryRowIsThatOfItsDesignForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5, 0}) {
    std::atomic<int> made{0};
    const BatchEvaluation evaluate =
        on_workers(2, 2, [&] { return sum_and_product(made); }, {.threads = threads});
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u, 3u}) {
      std::vector<double> outcomes(2 * count, -1.0);
      EXPECT_TRUE(evaluate(designs_of(count), outcomes));
      for (std::size_t i = 0; i < count; ++i) {
        const double x = 0.5 * static_cast<double>(i);
        double sum = 0.0, product = 0.0;
        for (int repeat = 0; repeat < 50; ++repeat) {
          sum += x + 3.0;
          product += x * 3.0;
        }
        ASSERT_EQ(outcomes[2 * i], sum);
        ASSERT_EQ(outcomes[2 * i + 1], product);
      }
    }
    EXPECT_GE(made, 1);
    EXPECT_LE(made, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  }
}

TEST(Workers, SlowRowsAreSharedAmongThreads) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  // Every row waits for a second thread to take one, which ends as soon as it does.
  std::mutex mutex;
  std::condition_variable came;
  std::set<std::thread::id> threads;
  bool alone = false;
  const BatchEvaluation evaluate =
      on_workers(1, 1,
                 [&]() -> DesignEvaluation {
                   return [&](std::span<const double> x, std::span<double> f) {
                     std::unique_lock lock(mutex);
                     threads.insert(std::this_thread::get_id());
                     came.notify_all();
                     const auto both = [&] { return alone || threads.size() == 2; };
                     if (!came.wait_for(lock, std::chrono::seconds(20), both)) alone = true;
                     f[0] = x[0];
                   };
                 },
                 {.threads = 2});
  std::vector<double> outcomes(50);
  EXPECT_TRUE(evaluate(std::vector<double>(50, 1.0), outcomes));
  EXPECT_EQ(threads.size(), 2u);
}

TEST(Workers, AnExceptionCostsItsRowOnly) {
  std::vector<std::string> failures;
  const BatchEvaluation evaluate =
      on_workers(1, 2,
                 []() -> DesignEvaluation {
                   return [](std::span<const double> x, std::span<double> f) {
                     f[0] = x[0];
                     if (x[0] == 3.0) throw std::runtime_error("three");
                     if (x[0] == 4.0) return;  // leaves its second outcome
                     f[1] = 1.0;
                   };
                 },
                 {.threads = 2, .failed = [&](const std::string& what) { failures.push_back(what); }});
  std::vector<double> outcomes(12, 7.0);
  EXPECT_TRUE(evaluate(std::vector<double>{0, 1, 2, 3, 4, 5}, outcomes));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(std::isnan(outcomes[2 * i]), i == 3) << i;
    EXPECT_EQ(std::isnan(outcomes[2 * i + 1]), i == 3 || i == 4) << i;
  }
  EXPECT_EQ(failures, std::vector<std::string>{"three"});
}

TEST(Workers, ABatchEndsSoonAfterItIsCancelled) {
  std::atomic<bool> cancel{false};
  std::atomic<int> done{0};
  const BatchEvaluation evaluate = on_workers(1, 1,
                                              [&]() -> DesignEvaluation {
                                                return [&](std::span<const double>, std::span<double> f) {
                                                  f[0] = 0.0;
                                                  if (++done == 10) cancel = true;
                                                };
                                              },
                                              {.threads = 2, .cancel = &cancel});
  std::vector<double> outcomes(100'000);
  EXPECT_FALSE(evaluate(std::vector<double>(100'000, 1.0), outcomes));
  EXPECT_LT(done, 100);
}

}  // namespace
}  // namespace zwidth
