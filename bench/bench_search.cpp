#include <cmath>
#include <mutex>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/batch_evaluators/thread_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <thread>

#include "harness.h"

#include "zwidth/design/pareto.h"
#include "zwidth/design/search.h"
#include "zwidth/design/workers.h"

/// What a search costs besides its evaluations, beside pagmo as it comes: three variables, three objectives and
/// eight constraints, which cost 0, 1 or 100 us. pagmo has them as a penalty, since it knows no constraints
/// there. All make the same number of generations; ideal is the time of the evaluations alone, over the
/// threads.

namespace {

double burn(double x, long steps) {
  for (long i = 0; i < steps; ++i) x = x * 0.999999 + 1e-7;
  return x;
}

// Of one microsecond.
long calibrate() {
  double best = 1.0;
  for (int i = 0; i < 20; ++i) {
    const double start = bench::cpu_seconds();
    bench::keep(burn(1.0, 1'000'000));
    best = std::min(best, bench::cpu_seconds() - start);
  }
  return static_cast<long>(1.0 / best);
}

constexpr double kMin[3] = {0.03, 0.05, 0.01}, kMax[3] = {0.35, 0.5, 0.2};

/// Lengths of two links and a radius of something like a delta: reach, torque and inertia.
void outcomes_of(const double* x, double* f, long steps) {
  const double a = x[0], b = x[1], r = x[2];
  bench::keep(burn(a, steps));
  const double reach = a + b - r, shape = std::abs(a - b) / (a + b),
               inertia = a * a * a + 0.3 * b * b * b + r * r, torque = (a + 0.2 * r) / (b + 0.05);
  f[0] = -reach * reach;
  f[1] = torque;
  f[2] = inertia + (a - 0.2) * (a - 0.2);
  const double g[8] = {0.15 - reach, reach - 0.6,   shape - 0.8,  r - a,
                       0.02 - r,     inertia - 0.2, torque - 4.0, a * b - 0.12};
  std::copy(g, g + 8, f + 3);
}

struct Penalised {
  long steps = 0;
  std::vector<double> fitness(const std::vector<double>& x) const {
    double f[11];
    outcomes_of(x.data(), f, steps);
    double penalty = 0.0;
    for (int c = 3; c < 11; ++c) penalty += 10.0 * std::max(0.0, f[c]);
    return {f[0] + penalty, f[1] + penalty, f[2] + penalty};
  }
  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {{kMin, kMin + 3}, {kMax, kMax + 3}};
  }
  std::vector<double>::size_type get_nobj() const { return 3; }
  pagmo::thread_safety get_thread_safety() const { return pagmo::thread_safety::constant; }
  template <class Archive>
  void serialize(Archive& archive, unsigned) {
    archive& steps;
  }
};

double process_cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Contestant {
  std::string name;
  int threads;
  std::function<void()> run;
  std::vector<double> wall, cpu;
};

zwidth::SearchProblem problem_of(long steps, int threads) {
  zwidth::SearchProblem problem{
      .variables = {{"a", kMin[0], kMax[0]}, {"b", kMin[1], kMax[1]}, {"r", kMin[2], kMax[2]}},
      .objectives = {"reach", "torque", "inertia"},
      .constraints = {"1", "2", "3", "4", "5", "6", "7", "8"}};
  problem.evaluate = zwidth::on_workers(3, 11,
                                        [steps]() -> zwidth::DesignEvaluation {
                                          return [steps](std::span<const double> x, std::span<double> f) {
                                            outcomes_of(x.data(), f.data(), steps);
                                          };
                                        },
                                        {.threads = threads});
  return problem;
}

void compare(int population, double cost, long per_us, int rounds, int generations) {
  const long steps = std::lround(cost * static_cast<double>(per_us));
  std::vector<Contestant> contestants;
  const auto plain = [&](bool threads) {
    return [=] {
      pagmo::nsga2 nsga2(static_cast<unsigned>(generations), 0.9, 15.0, 1.0 / 3.0, 20.0, 7u);
      if (threads) nsga2.set_bfe(pagmo::bfe(pagmo::thread_bfe()));
      const pagmo::algorithm algorithm(nsga2);
      pagmo::population one(pagmo::problem(Penalised{steps}),
                            static_cast<pagmo::population::size_type>(population), 7u);
      bench::keep(algorithm.evolve(one).size());
    };
  };
  const auto ours = [&](int threads) {
    return [=] {
      const zwidth::SearchProblem problem = problem_of(steps, threads);
      bench::keep(
          zwidth::search(problem, {.population = population, .generations = generations, .seed = 7}).front);
    };
  };
  const auto alone = [=] {
    double x[3] = {0.1, 0.2, 0.05}, f[11];
    for (int i = 0; i < population * (generations + 1); ++i) {
      x[0] = 0.1 + 1e-7 * i;
      outcomes_of(x, f, steps);
      bench::keep(f);
    }
  };
  contestants.push_back({"evaluations alone, one thread", 1, alone, {}, {}});
  contestants.push_back({"pagmo nsga2, one thread", 1, plain(false), {}, {}});
  contestants.push_back({"pagmo nsga2, thread_bfe", 2, plain(true), {}, {}});
  contestants.push_back({"zwidth search, one thread", 1, ours(1), {}, {}});
  contestants.push_back({"zwidth search, two threads", 2, ours(2), {}, {}});
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& one : contestants) {
      const double wall = bench::wall_seconds(), cpu = process_cpu_seconds();
      one.run();
      const double each = 1.0 / (static_cast<double>(population) * (generations + 1));
      one.wall.push_back((bench::wall_seconds() - wall) * each);
      one.cpu.push_back((process_cpu_seconds() - cpu) * each);
    }
  }
  std::printf(
      "\nPopulation %d, evaluations of %g us, %d generations; us per evaluation, median of %d rounds\n\n",
      population, cost, generations, rounds);
  std::printf("| %-30s | %8s | %8s | %9s | %14s |\n|%.32s|%.9s:|%.9s:|%.10s:|%.15s:|\n", "contestant", "wall",
              "CPU", "overhead", "share of ideal", "--------------------------------", "---------", "---------",
              "----------", "---------------");
  for (const Contestant& one : contestants) {
    std::vector<double> overhead, share;
    for (std::size_t round = 0; round < one.wall.size(); ++round) {
      const double ideal = contestants[0].wall[round];
      overhead.push_back(one.cpu[round] - contestants[0].cpu[round]);
      share.push_back(ideal / one.threads / one.wall[round]);
    }
    std::printf("| %-30s | %8.2f | %8.2f | %9.2f | %13.1f%% |\n", one.name.c_str(),
                bench::quantile(one.wall, 0.5) * 1e6, bench::quantile(one.cpu, 0.5) * 1e6,
                bench::quantile(overhead, 0.5) * 1e6, bench::quantile(share, 0.5) * 100.0);
  }
}

// A front is only worth its speed if it is as good: hypervolumes of the same generations, over seeds.
void compare_fronts(int seeds, int generations) {
  const std::vector<double> reference = {1.0, 6.0, 1.0};
  double ours = 0.0, plain = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const zwidth::SearchProblem problem = problem_of(0, 1);
    ours += zwidth::search(problem, {.population = 100,
                                     .generations = generations,
                                     .seed = static_cast<std::uint32_t>(seed),
                                     .reference = reference})
                .history.back()
                .hypervolume /
            seeds;
    const pagmo::algorithm algorithm(pagmo::nsga2(static_cast<unsigned>(generations), 0.9, 15.0, 1.0 / 3.0,
                                                  20.0, static_cast<unsigned>(seed)));
    pagmo::population population(pagmo::problem(Penalised{}), 100, static_cast<unsigned>(seed));
    population = algorithm.evolve(population);
    std::vector<double> values;
    for (std::size_t i = 0; i < population.size(); ++i) {
      double f[11];
      outcomes_of(population.get_x()[i].data(), f, 0);
      const bool feasible = std::all_of(f + 3, f + 11, [](double g) { return g <= 0.0; });
      if (feasible) values.insert(values.end(), f, f + 3);
    }
    plain += zwidth::hypervolume(values, reference) / seeds;
  }
  std::printf(
      "mean hypervolume of the feasible front after %d generations of 100, %d seeds: zwidth %.5f, pagmo %.5f\n",
      generations, seeds, ours, plain);
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  const int rounds = quick ? 1 : std::min(9, bench::options_of(argc, argv).rounds);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a long run shows its tables as they come
  const long per_us = calibrate();
  compare_fronts(quick ? 1 : 20, quick ? 5 : 100);
  for (const int population : quick ? std::vector<int>{100} : std::vector<int>{100, 300, 400}) {
    for (const double cost : {0.0, 1.0, 100.0}) {
      const bool slow = cost > 10.0;
      compare(population, cost, per_us, rounds, quick ? 1 : slow ? 10 : 40);
    }
  }
  return 0;
}
