#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"
#include "zwidth/design/study_model.h"
#include "zwidth/design/workers.h"
#include "zwidth/ranks/ranks.h"

/// How long whole studies take, evaluations and all: the R-CUBE's kinematic search of 100 000 designs (goal 4 s
/// on two cores) and the five-bar's grid with a million (goal 10 s); and whether memory stays as it is.
///
///     bench_studies
///     mpirun --bind-to none -np 2 bench_studies      two ranks beside two threads

namespace {

const zwidth::Catalogue& catalogue() {
  static const zwidth::Catalogue loaded = zwidth::Catalogue::load();
  return loaded;
}

std::unique_ptr<zwidth::StudyModel> model_of(const char* name, const std::vector<std::string>& overrides) {
  const auto device_of = [](const zwidth::Study& study) {
    return zwidth::read_description(study.device, study.overrides, catalogue());
  };
  const zwidth::Study study = zwidth::read_study(name, overrides, catalogue(), [&](const zwidth::Study& one) {
    return zwidth::study_problems(one, device_of(one), catalogue());
  });
  return std::make_unique<zwidth::StudyModel>(study, device_of(study), catalogue());
}

zwidth::BatchEvaluation evaluation(const zwidth::StudyModel& model, int threads) {
  const zwidth::SearchProblem problem = model.search_problem();
  return zwidth::on_workers(problem.variables.size(), problem.outcome_size(),
                            [&model]() -> zwidth::DesignEvaluation {
                              auto evaluator = std::make_shared<zwidth::StudyEvaluator>(model);
                              return [evaluator](std::span<const double> row, std::span<double> outcome) {
                                evaluator->evaluate(row, outcome);
                              };
                            },
                            {.threads = threads});
}

double process_cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Resident memory of this process [MiB].
double resident() {
  std::ifstream status("/proc/self/statm");
  double pages = 0.0, resident_pages = 0.0;
  status >> pages >> resident_pages;
  return resident_pages * 4096.0 / 1048576.0;
}

void head() {
  std::printf("| %-44s | %9s | %7s | %7s | %5s | %10s | %17s |\n", "study", "designs", "wall, s", "CPU, s",
              "goal", "in search", "MiB, 1/4 and end");
  std::printf("|%.46s|%.10s:|%.8s:|%.8s:|%.6s:|%.11s:|%.18s:|\n",
              "----------------------------------------------", "-------------", "----------", "----------",
              "--------", "------------", "--------------------");
}

double search(const std::string& name, const zwidth::StudyModel& model, zwidth::BatchEvaluation evaluate,
              double goal) {
  zwidth::SearchProblem problem = model.search_problem();
  problem.evaluate = std::move(evaluate);
  zwidth::SearchOptions options{.algorithm = model.algorithm(),
                                .population = model.study().search.population,
                                .generations = model.study().search.generations,
                                .seed = static_cast<std::uint32_t>(model.study().search.seed)};
  double designs = options.population * static_cast<double>(options.generations + 1);
  if (options.algorithm == zwidth::SearchAlgorithm::grid) {
    options.population = 1000;
    designs = 1.0;
    for (const zwidth::SearchVariable& one : problem.variables) designs *= one.max - one.min + 1.0;
  }
  double early = 0.0;
  options.progress = [&](const zwidth::Generation& at) {
    if (early == 0.0 && static_cast<double>(at.evaluations) > 0.25 * designs) early = resident();
    return true;
  };
  const double wall = bench::wall_seconds(), cpu = process_cpu_seconds();
  const zwidth::SearchResult result = zwidth::search(problem, options);
  const double took = bench::wall_seconds() - wall;
  std::printf("| %-44s | %9lld | %7.2f | %7.2f | %5.0f | %8.1f %% | %8.1f %8.1f |\n", name.c_str(),
              static_cast<long long>(result.evaluations), took, process_cpu_seconds() - cpu, goal,
              100.0 * result.seconds_in_algorithm / took, early, resident());
  return took;
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  std::optional<zwidth::Ranks> ranks;
  if (zwidth::Ranks::started_by_launcher()) ranks.emplace();
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  // Designs that are met again are not evaluated again, so that this makes a little more than 100 000.
  const auto r_cube =
      model_of("r-cube-kinematics", {quick ? "search.generations=2" : "search.generations=355"});
  const zwidth::SearchProblem problem = r_cube->search_problem();
  if (ranks && !ranks->drives()) {
    ranks->serve(problem.variables.size(), problem.outcome_size(), evaluation(*r_cube, 1));
    return 0;
  }
  head();
  const double threads = search("r-cube-kinematics, two threads", *r_cube, evaluation(*r_cube, 2), 4.0);
  if (ranks && ranks->size() > 1) {
    const double spread =
        search("r-cube-kinematics, " + std::to_string(ranks->size()) + " ranks", *r_cube,
               ranks->spread(problem.variables.size(), problem.outcome_size(), evaluation(*r_cube, 1)), 4.0);
    std::printf("ranks/threads %.3f\n", spread / threads);
    return 0;
  }
  // 101 x 101 x 101 in the bounds of table 1 of Singh, Saha and Manivannan.
  std::vector<std::string> finer = {"variable[0].step=\"0.3 mm\"", "variable[1].step=\"0.4 mm\"",
                                    "variable[2].step=\"0.2 mm\""};
  if (quick) finer = {"variable[0].step=\"1 cm\""};
  const auto five_bar = model_of("five-bar-grid", finer);
  search("five-bar-grid, two threads", *five_bar, evaluation(*five_bar, 2), 10.0);
  return 0;
}
