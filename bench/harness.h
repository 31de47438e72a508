#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

/// Interleaved micro-benchmarks: every round gives every contestant a slice of thread CPU time, so that all of
/// them see the same noise of the machine. Ratios are the median of the rounds' ratios and hold on a busy
/// machine; absolute times do not.

namespace bench {

inline double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double wall_seconds() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Keeps the compiler from dropping a value that nobody reads.
template <class T>
inline void keep(const T& value) {
  asm volatile("" : : "r,m"(&value) : "memory");
}

/// A quantile of samples, 0 the smallest and 1 the largest.
inline double quantile(std::vector<double> samples, double share) {
  std::sort(samples.begin(), samples.end());
  const double at = share * static_cast<double>(samples.size() - 1);
  return samples[static_cast<std::size_t>(std::lround(at))];
}

struct Options {
  int rounds = 15;
  double slice = 0.015;   ///< of CPU time per contestant and round [s]
  double chunk = 100e-6;  ///< the times of which the quantiles are taken [s]
};

/// `--quick` for a run that only shows that all of it works, `--rounds N`.
inline Options options_of(int argc, char** argv) {
  Options options;
  for (int a = 1; a < argc; ++a) {
    if (std::strcmp(argv[a], "--quick") == 0) options = {.rounds = 2, .slice = 0.001, .chunk = 50e-6};
    if (std::strcmp(argv[a], "--rounds") == 0 && a + 1 < argc)
      options.rounds = std::max(1, std::atoi(argv[a + 1]));
  }
  return options;
}

class Suite {
 public:
  Suite(std::string title, const Options& options) : title_(std::move(title)), options_(options) {}

  /// `run(n)` does n iterations of `items` things each. The first contestant is the one that ratios refer to,
  /// unless `reference` names another.
  void add(std::string name, double items, std::function<void(long)> run) {
    contestants_.push_back({std::move(name), items, std::move(run), 1, {}, {}});
  }
  /// A time per item that is not to be exceeded [s], printed beside the median of the contestant added last.
  void goal(double seconds) { contestants_.back().goal = seconds; }

  void run(std::size_t reference = 0) {
    for (Contestant& contestant : contestants_) {
      for (;;) {
        const double start = cpu_seconds();
        contestant.run(contestant.iterations);
        if (cpu_seconds() - start > options_.chunk || contestant.iterations > 1L << 40) break;
        contestant.iterations *= 2;
      }
    }
    for (int round = 0; round < options_.rounds; ++round) {
      for (Contestant& contestant : contestants_) {
        const double begin = cpu_seconds();
        double now = begin;
        long iterations = 0;
        while (now - begin < options_.slice) {
          const double start = now;
          contestant.run(contestant.iterations);
          iterations += contestant.iterations;
          now = cpu_seconds();
          contestant.chunks.push_back((now - start) /
                                      (static_cast<double>(contestant.iterations) * contestant.items));
        }
        contestant.rounds.push_back((now - begin) / (static_cast<double>(iterations) * contestant.items));
      }
    }
    print(reference);
  }

 private:
  struct Contestant {
    std::string name;
    double items;
    std::function<void(long)> run;
    long iterations;
    std::vector<double> rounds, chunks;
    double goal = 0.0;
  };

  void print(std::size_t reference) const {
    std::printf(
        "%s\n%d rounds of %.0f ms of thread CPU time each; quantiles over chunks of %.0f us; ns per item\n\n",
        title_.c_str(), options_.rounds, options_.slice * 1e3, options_.chunk * 1e6);
    std::printf("| %-62s | %9s | %9s | %9s | %7s | %7s |\n", "contestant", "median", "p99", "worst", "ratio",
                "goal");
    std::printf("|-%.62s-|-%.9s:|-%.9s:|-%.9s:|-%.7s:|-%.7s:|\n", kRule, kRule, kRule, kRule, kRule, kRule);
    for (const Contestant& contestant : contestants_) {
      std::vector<double> ratios;
      for (std::size_t round = 0; round < contestant.rounds.size(); ++round) {
        ratios.push_back(contestant.rounds[round] / contestants_[reference].rounds[round]);
      }
      char goal[32] = "";
      if (contestant.goal > 0.0) std::snprintf(goal, sizeof goal, "%.0f", contestant.goal * 1e9);
      std::printf("| %-62s | %9.1f | %9.1f | %9.1f | %7.3f | %7s |\n", contestant.name.c_str(),
                  quantile(contestant.chunks, 0.5) * 1e9, quantile(contestant.chunks, 0.99) * 1e9,
                  quantile(contestant.chunks, 1.0) * 1e9, quantile(ratios, 0.5), goal);
    }
    std::printf("\n");
    std::fflush(stdout);
  }

  static constexpr const char* kRule = "----------------------------------------------------------------";
  std::string title_;
  Options options_;
  std::vector<Contestant> contestants_;
};

}  // namespace bench
