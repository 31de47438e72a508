#include "study.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>

#include "context.h"

#include "zwidth/design/workers.h"

namespace zwidth {

bool names_study(const std::string& study) {
  const auto& known = catalogue().studies();
  if (std::any_of(known.begin(), known.end(), [&](const BuiltinFile& one) { return one.name == study; })) {
    return true;
  }
  std::ifstream file(study);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[study]")) return true;
  }
  return false;
}

namespace {

// What is wrong with the device, placed where the study says it: at the entry of `set`, or the device's name.
// Throws the error again where it stands in the device's own file.
std::vector<Problem> of_device(const DescriptionError& error, const Study& study) {
  std::vector<Problem> placed;
  for (const Problem& problem : error.problems()) {
    const std::string text =
        problem.key.empty() ? problem.rule : fmt::format("makes {} wrong: it {}", problem.key, problem.rule);
    std::size_t entry = study.overrides.size();
    for (std::size_t i = 0; i < study.overrides.size(); ++i) {
      const std::string& one = study.overrides[i];
      const std::string key = one.substr(0, std::min(one.find('='), one.size()));
      if (problem.file == "--set " + key.substr(0, key.find_last_not_of(' ') + 1)) entry = i;
    }
    if (entry < study.overrides.size()) {
      placed.push_back({.key = fmt::format("study.set[{}]", entry), .rule = text, .advice = problem.advice});
    } else if (problem.line == 0 && problem.key.empty()) {
      placed.push_back({.key = "study.device", .rule = problem.rule, .advice = problem.advice});
    } else {
      throw error;
    }
  }
  return placed;
}

// What keeps the study's algorithm from searching its variables.
std::vector<Problem> of_search(const StudyModel& model) {
  SearchProblem problem = model.search_problem();
  problem.evaluate = [](std::span<const double>, std::span<double>) { return false; };  // is not called
  std::vector<Problem> found;
  for (const std::string& rule : search_problems(problem, study_search_options(model))) {
    const bool of_population = rule.find("population") != rule.npos;
    found.push_back({.key = of_population ? "search.population" : "search.algorithm", .rule = rule});
  }
  return found;
}

}  // namespace

std::unique_ptr<StudyModel> read_study_model(const std::string& study,
                                             const std::vector<std::string>& overrides) {
  const auto device_of = [](const Study& one) { return read_device(one.device, one.overrides); };
  const Study read = read_study(study, overrides, catalogue(), [&](const Study& one) -> std::vector<Problem> {
    try {
      const Description device = device_of(one);
      std::vector<Problem> problems = study_problems(one, device, catalogue());
      return problems.empty() ? of_search(StudyModel(one, device, catalogue())) : problems;
    } catch (const DescriptionError& error) {
      return of_device(error, one);
    }
  });
  return std::make_unique<StudyModel>(read, device_of(read), catalogue());
}

BatchEvaluation study_evaluation(const StudyModel& model, int threads, const std::atomic<bool>* cancel) {
  const SearchProblem problem = model.search_problem();
  return on_workers(problem.variables.size(), problem.outcome_size(),
                    [&model]() -> DesignEvaluation {
                      auto evaluator = std::make_shared<StudyEvaluator>(model);
                      return [evaluator](std::span<const double> row, std::span<double> outcome) {
                        evaluator->evaluate(row, outcome);
                      };
                    },
                    {.threads = threads, .cancel = cancel});
}

SearchOptions study_search_options(const StudyModel& model) {
  const Study& study = model.study();
  SearchOptions options;
  options.algorithm = model.algorithm();
  options.population = study.search.population;
  if (options.algorithm == SearchAlgorithm::grid) options.population = std::max(options.population, 1000);
  options.generations = study.search.generations;
  options.seed = static_cast<std::uint32_t>(study.search.seed);
  return options;
}

std::span<const double> StudyRun::design(std::size_t front_row) const {
  const std::size_t width = problem.variables.size();
  return std::span(result.designs).subspan(result.front[front_row] * width, width);
}

std::span<const double> StudyRun::objectives(std::size_t front_row) const {
  return std::span(result.outcomes)
      .subspan(result.front[front_row] * problem.outcome_size(), problem.objectives.size());
}

StudyRun search_study(const std::string& study, const std::vector<std::string>& overrides) {
  StudyRun found{.model = read_study_model(study, overrides)};
  found.problem = found.model->search_problem();
  found.problem.evaluate = study_evaluation(*found.model, 0, nullptr);
  found.result = search(found.problem, study_search_options(*found.model));
  return found;
}

}  // namespace zwidth
