#include "zwidth/design/search.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <stdexcept>

#include "zwidth/design/internal/checkpoint.h"
#include "zwidth/design/internal/engine.h"
#include "zwidth/design/pareto.h"

namespace zwidth {
namespace {

using internal::Checkpoint;
using internal::Engine;
using internal::Evaluator;
using internal::Rows;

constexpr double kLargestGrid = 1e9;
constexpr std::int64_t kReferenceDesigns = 10;  // feasible ones that fix the hypervolume's reference

constexpr std::array<SearchAlgorithmInfo, 9> kAlgorithms = {{
    {SearchAlgorithm::nsga2, "nsga2", "NSGA-II: non-dominated sorting and crowding", false, true, true, 8, 4,
     1},
    {SearchAlgorithm::nspso, "nspso", "NSPSO: a swarm with non-dominated sorting", false, true, true, 5, 1, 10},
    {SearchAlgorithm::moead, "moead", "MOEA/D: one problem per weight, neighbours help each other", false, true,
     false, 5, 1, 1},
    {SearchAlgorithm::cmaes, "cmaes", "CMA-ES: covariance matrix adaptation", true, false, false, 5, 1, 1},
    {SearchAlgorithm::de, "de", "differential evolution", true, false, false, 5, 1, 1},
    {SearchAlgorithm::de1220, "de1220", "differential evolution that chooses variant and parameters", true,
     false, false, 8, 1, 20},
    {SearchAlgorithm::sade, "sade", "differential evolution that chooses its parameters", true, false, false, 7,
     1, 1},
    {SearchAlgorithm::self_adaptive_constraints, "self-adaptive-constraints",
     "differential evolution under penalties that adapt", true, false, false, 5, 1, 10},
    {SearchAlgorithm::grid, "grid", "every design, for variables that are all whole numbers", true, true, true,
     1, 1, 1},
}};

// ---------------------------------------------------------------------------------------------- what is wrong

void check_variables(const SearchProblem& problem, const SearchOptions& options,
                     std::vector<std::string>& problems) {
  if (problem.variables.empty()) problems.push_back("there are no variables");
  std::set<std::string> names;
  double designs = 1.0;
  bool all_fixed = true;
  for (const SearchVariable& variable : problem.variables) {
    const std::string name = fmt::format("variable '{}'", variable.name);
    const std::string bounds = fmt::format("[{}, {}]", variable.min, variable.max);
    if (!names.insert(variable.name).second) problems.push_back(name + " is there twice");
    if (!std::isfinite(variable.min) || !std::isfinite(variable.max)) {
      problems.push_back(fmt::format("{} needs finite bounds, not {}", name, bounds));
      continue;
    }
    if (variable.min > variable.max) {
      problems.push_back(fmt::format("{} has its bounds the wrong way round: {}", name, bounds));
      continue;
    }
    if (variable.integer &&
        (variable.min != std::floor(variable.min) || variable.max != std::floor(variable.max))) {
      problems.push_back(fmt::format("{} takes whole numbers, so its bounds must be whole: {}", name, bounds));
    }
    if (options.algorithm == SearchAlgorithm::grid && !variable.integer) {
      problems.push_back(
          fmt::format("{} takes any real number; a grid needs whole numbers (give it a step), or "
                      "choose {}",
                      name, problem.objectives.size() > 1 ? "nsga2" : "de"));
    }
    all_fixed = all_fixed && variable.min == variable.max;
    designs *= variable.max - variable.min + 1.0;
  }
  if (options.algorithm == SearchAlgorithm::grid) {
    if (designs > kLargestGrid) {
      problems.push_back(
          fmt::format("the grid has {} designs, more than {}; take larger steps or another algorithm", designs,
                      kLargestGrid));
    }
  } else if (!problem.variables.empty() && all_fixed) {
    problems.push_back("no variable can vary: the bounds of each are equal");
  }
}

void check_options(const SearchProblem& problem, const SearchOptions& options,
                   std::vector<std::string>& problems) {
  const SearchAlgorithmInfo& algorithm = info(options.algorithm);
  const std::size_t objectives = problem.objectives.size();
  if (objectives == 1 && !algorithm.one_objective) {
    problems.push_back(
        fmt::format("{} needs two objectives or more; for one take cmaes, de, de1220 or sade", algorithm.name));
  }
  if (objectives > 1 && !algorithm.several_objectives) {
    problems.push_back(fmt::format("{} searches for one objective, not {}; take nsga2, nspso or moead",
                                   algorithm.name, objectives));
  }
  if (options.algorithm == SearchAlgorithm::self_adaptive_constraints && problem.constraints.empty()) {
    problems.push_back(fmt::format("{} needs constraints; without them take de", algorithm.name));
  }
  if (options.population < algorithm.min_population || options.population % algorithm.population_step != 0) {
    const std::string step =
        algorithm.population_step > 1 ? fmt::format(", a multiple of {}", algorithm.population_step) : "";
    problems.push_back(fmt::format("{} needs a population of at least {}{}, not {}", algorithm.name,
                                   algorithm.min_population, step, options.population));
  }
  if (options.generations < 0) {
    problems.push_back(fmt::format("the number of generations must not be negative: {}", options.generations));
  }
  if (options.evaluations < 0) {
    problems.push_back(fmt::format("the number of evaluations must not be negative: {}", options.evaluations));
  }
  if (options.evaluations > 0 && options.algorithm != SearchAlgorithm::grid &&
      options.evaluations < options.population) {
    problems.push_back(fmt::format("the budget of {} evaluations is less than the first population of {}",
                                   options.evaluations, options.population));
  }
  if (!(options.stagnation >= 0.0)) problems.push_back("the stagnation share must not be negative");
  if (options.stagnation > 0.0 && options.stagnation_generations < 1) {
    problems.push_back("stagnation must be judged over one generation or more");
  }
  if (!options.reference.empty() && options.reference.size() != objectives) {
    problems.push_back(fmt::format("the hypervolume's reference needs a value per objective: {}, not {}",
                                   objectives, options.reference.size()));
  }
  for (const double value : options.reference) {
    if (!std::isfinite(value)) problems.push_back("the hypervolume's reference must be finite");
  }
  if (!(options.checkpoint_seconds >= 0.0))
    problems.push_back("the time between checkpoints must not be negative");
  if (options.resume && options.checkpoint.empty()) problems.push_back("to resume, name the checkpoint");
}

void check_start(const SearchProblem& problem, const SearchOptions& options,
                 std::vector<std::string>& problems) {
  const std::size_t variables = problem.variables.size();
  if (variables == 0 || options.start.empty()) return;
  const std::size_t count = options.start.size() / variables;
  if (options.start.size() % variables != 0) {
    problems.push_back("designs to start from need a value per variable");
    return;
  }
  if (count > static_cast<std::size_t>(std::max(0, options.population))) {
    problems.push_back(fmt::format("there are {} designs to start from, more than the population of {}", count,
                                   options.population));
  }
  for (std::size_t i = 0; i < options.start.size(); ++i) {
    const SearchVariable& variable = problem.variables[i % variables];
    const double value = options.start[i];
    const bool inside = value >= variable.min && value <= variable.max;
    if (inside && (!variable.integer || value == std::floor(value))) continue;
    problems.push_back(fmt::format(
        "design {} to start from has '{}' = {}, which is not {} in [{}, {}]", i / variables + 1, variable.name,
        value, variable.integer ? "a whole number" : "a number", variable.min, variable.max));
  }
}

// ------------------------------------------------------------------------------------------------- the search

// What a checkpoint must have in common with a search that resumes it; how long to search may differ.
std::vector<std::string> identity_of(const SearchProblem& problem, const SearchOptions& options) {
  std::vector<std::string> lines = {fmt::format("algorithm {}", info(options.algorithm).name),
                                    fmt::format("population {}", options.population),
                                    fmt::format("seed {}", options.seed)};
  for (const SearchVariable& variable : problem.variables) {
    lines.push_back(fmt::format("variable {} in [{}, {}]{}", variable.name, variable.min, variable.max,
                                variable.integer ? ", whole" : ""));
  }
  for (const std::string& objective : problem.objectives) lines.push_back("objective " + objective);
  for (const std::string& constraint : problem.constraints) lines.push_back("constraint " + constraint);
  lines.push_back(fmt::format("start {}", fmt::join(options.start, " ")));
  lines.push_back(fmt::format("reference {}", fmt::join(options.reference, " ")));
  lines.push_back("identity " + problem.identity);
  return lines;
}

class Search {
 public:
  Search(const SearchProblem& problem, const SearchOptions& options)
      : problem_(problem), options_(options), identity_(identity_of(problem, options)), evaluator_(problem) {
    engine_ = options.algorithm == SearchAlgorithm::grid ? internal::make_grid_engine(options, evaluator_)
                                                         : internal::make_pagmo_engine(options, evaluator_);
    result_.reference = options.reference;
  }

  SearchResult run() {
    if (options_.resume) resume();
    // A resumed search starts its clock where the other one left it.
    began_ = std::chrono::steady_clock::now();
    written_ = began_;
    result_.end = iterate();
    finish();
    return std::move(result_);
  }

 private:
  SearchEnd iterate() {
    try {
      if (result_.history.empty()) {
        engine_->start();
        if (!take_generation(0)) return SearchEnd::stopped;
      }
      for (;;) {
        if (const std::optional<SearchEnd> end = reason_to_end()) return *end;
        engine_->step();
        if (!take_generation(result_.history.back().number + 1)) return SearchEnd::stopped;
      }
    } catch (const internal::Stopped&) {
      return SearchEnd::stopped;
    } catch (const std::exception& error) {
      result_.notes.push_back(std::string(info(options_.algorithm).name) + " gave up: " + error.what());
      return SearchEnd::gave_up;
    }
  }

  std::optional<SearchEnd> reason_to_end() const {
    if (engine_->done()) return SearchEnd::grid;
    const Generation& now = result_.history.back();
    if (options_.algorithm != SearchAlgorithm::grid && now.number >= options_.generations) {
      return SearchEnd::generations;
    }
    if (options_.evaluations > 0 &&
        evaluator_.record().evaluations + engine_->next_evaluations() > options_.evaluations) {
      return SearchEnd::evaluations;
    }
    const auto back = static_cast<std::size_t>(options_.stagnation_generations);
    if (options_.stagnation > 0.0 && result_.history.size() > back) {
      const double before = result_.history[result_.history.size() - 1 - back].hypervolume;
      if (before > 0.0 && now.hypervolume - before < options_.stagnation * before) return SearchEnd::stagnation;
    }
    return std::nullopt;
  }

  // The feasible rows of `rows_` that none dominates, each design once, and how many are feasible.
  void look_at(const Rows& rows, std::vector<std::size_t>& front, std::vector<double>& feasible,
               std::vector<double>& front_values) const {
    const std::size_t width = problem_.outcome_size(), objectives = problem_.objectives.size();
    std::vector<std::size_t> feasible_rows;
    feasible.clear();
    for (std::size_t row = 0; row < rows.outcomes.size() / width; ++row) {
      const auto outcomes = std::span<const double>(rows.outcomes).subspan(row * width, width);
      if (!standing(outcomes, objectives).feasible()) continue;
      feasible_rows.push_back(row);
      feasible.insert(feasible.end(), outcomes.begin(),
                      outcomes.begin() + static_cast<std::ptrdiff_t>(objectives));
    }
    const std::size_t variables = problem_.variables.size();
    const auto design = [&](std::size_t row) {
      return std::span<const double>(rows.designs).subspan(row * variables, variables);
    };
    const auto value = [&](std::size_t row) {
      return std::span<const double>(rows.outcomes).subspan(row * width, objectives);
    };
    front.clear();
    for (const std::size_t i : non_dominated(feasible, objectives)) front.push_back(feasible_rows[i]);
    // By objectives, then by design; equal designs are then neighbours.
    const auto less = [&](std::size_t a, std::size_t b) {
      const auto x = value(a), y = value(b);
      if (!std::equal(x.begin(), x.end(), y.begin())) {
        return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
      }
      const auto p = design(a), q = design(b);
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    };
    std::stable_sort(front.begin(), front.end(), less);
    const auto same = [&](std::size_t a, std::size_t b) { return !less(a, b) && !less(b, a); };
    front.erase(std::unique(front.begin(), front.end(), same), front.end());
    front_values.clear();
    for (const std::size_t row : front)
      front_values.insert(front_values.end(), value(row).begin(), value(row).end());
  }

  // False if the person wants to stop.
  bool take_generation(std::int64_t number) {
    rows_ = engine_->rows();
    record_ = evaluator_.record();
    std::vector<std::size_t> front;
    std::vector<double> feasible, front_values;
    look_at(rows_, front, feasible, front_values);
    const std::size_t objectives = problem_.objectives.size();
    const std::size_t feasible_count = feasible.size() / objectives;

    Generation generation;
    generation.number = number;
    generation.evaluations = evaluator_.record().evaluations;
    const std::size_t population = rows_.outcomes.size() / problem_.outcome_size();
    generation.feasible_share =
        population > 0 ? static_cast<double>(feasible_count) / static_cast<double>(population) : 0.0;
    generation.front = static_cast<std::int64_t>(front.size());
    if (result_.reference.empty() && static_cast<std::int64_t>(feasible_count) >= kReferenceDesigns) {
      fix_reference(feasible);
    }
    generation.hypervolume = result_.reference.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                       : hypervolume(front_values, result_.reference);
    take_times(generation);
    result_.history.push_back(generation);
    const bool go_on = !options_.progress || options_.progress(generation);
    save_now_and_then();
    return go_on;
  }

  void fix_reference(std::span<const double> feasible) {
    const ObjectiveRange range = objective_range(feasible, problem_.objectives.size());
    for (std::size_t k = 0; k < range.max.size(); ++k) {
      const double width = range.max[k] - range.min[k];
      result_.reference.push_back(range.max[k] +
                                  0.1 * (width > 0.0 ? width : std::max(std::abs(range.max[k]), 1e-9)));
    }
  }

  void take_times(Generation& generation) const {
    const double since = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    generation.seconds_evaluating = evaluator_.record().seconds;
    generation.seconds_in_algorithm = std::max(0.0, seconds_before_ + since - evaluator_.record().seconds);
  }

  void save_now_and_then() {
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - written_).count() < options_.checkpoint_seconds) return;
    save();
    written_ = std::chrono::steady_clock::now();
  }

  // A disk that is full must not end a search of hours: it is said once, and tried again.
  void save() {
    if (options_.checkpoint.empty() || result_.history.empty()) return;
    try {
      internal::write_checkpoint({.identity = identity_,
                                  .history = result_.history,
                                  .reference = result_.reference,
                                  .record = record_,
                                  .rows = rows_,
                                  .memory = engine_->memory()},
                                 options_.checkpoint);
    } catch (const std::exception& error) {
      if (!save_failed_) result_.notes.push_back(error.what());
      save_failed_ = true;
    }
  }

  void resume() {
    Checkpoint checkpoint = internal::read_checkpoint(options_.checkpoint, identity_, result_.notes);
    try {
      engine_->restore(checkpoint.memory);
    } catch (const std::exception& error) {
      throw std::runtime_error("the checkpoint " + options_.checkpoint.string() +
                               " holds a state that this program cannot take up: " + error.what());
    }
    evaluator_.set_record(checkpoint.record);
    record_ = checkpoint.record;
    evaluator_.remember_only(checkpoint.rows);
    rows_ = std::move(checkpoint.rows);
    result_.history = std::move(checkpoint.history);
    result_.reference = std::move(checkpoint.reference);
    if (!result_.history.empty()) {
      const Generation& last = result_.history.back();
      seconds_before_ = last.seconds_evaluating + last.seconds_in_algorithm;
    }
  }

  void finish() {
    save();
    Generation at_end;
    take_times(at_end);
    const internal::EvaluationRecord& record = evaluator_.record();
    result_.evaluations = record.evaluations;
    result_.failures = record.failures;
    result_.first_failure = record.first_failure;
    result_.constraints = record.constraints;
    result_.seconds_evaluating = at_end.seconds_evaluating;
    result_.seconds_in_algorithm = at_end.seconds_in_algorithm;
    std::vector<double> feasible, front_values;
    look_at(rows_, result_.front, feasible, front_values);
    result_.designs = std::move(rows_.designs);
    result_.outcomes = std::move(rows_.outcomes);
  }

  const SearchProblem& problem_;
  const SearchOptions& options_;
  std::vector<std::string> identity_;
  Evaluator evaluator_;
  std::unique_ptr<Engine> engine_;
  Rows rows_;  // of the last whole generation
  // At its end: what a generation that was broken off has evaluated is done again after a resumption.
  internal::EvaluationRecord record_;
  SearchResult result_;
  std::chrono::steady_clock::time_point began_, written_;
  double seconds_before_ = 0.0;  // of the searches that this one resumes
  bool save_failed_ = false;
};

}  // namespace

std::span<const SearchAlgorithmInfo> search_algorithms() {
  return kAlgorithms;
}

const SearchAlgorithmInfo& info(SearchAlgorithm algorithm) {
  return *std::find_if(kAlgorithms.begin(), kAlgorithms.end(),
                       [&](const SearchAlgorithmInfo& one) { return one.algorithm == algorithm; });
}

std::optional<SearchAlgorithm> search_algorithm(std::string_view name) {
  for (const SearchAlgorithmInfo& one : kAlgorithms) {
    if (one.name == name) return one.algorithm;
  }
  return std::nullopt;
}

std::string_view to_words(SearchEnd end) {
  switch (end) {
    case SearchEnd::generations:
      return "all generations done";
    case SearchEnd::evaluations:
      return "budget of evaluations used up";
    case SearchEnd::stagnation:
      return "hypervolume no longer grows";
    case SearchEnd::grid:
      return "every design seen";
    case SearchEnd::stopped:
      return "stopped";
    case SearchEnd::gave_up:
      return "algorithm gave up";
  }
  return "";
}

std::vector<std::string> search_problems(const SearchProblem& problem, const SearchOptions& options) {
  std::vector<std::string> problems;
  if (problem.objectives.empty()) problems.push_back("there are no objectives");
  if (!problem.evaluate) problems.push_back("there is nothing to evaluate designs with");
  check_variables(problem, options, problems);
  check_options(problem, options, problems);
  check_start(problem, options, problems);
  return problems;
}

SearchResult search(const SearchProblem& problem, const SearchOptions& options) {
  const std::vector<std::string> problems = search_problems(problem, options);
  if (!problems.empty()) {
    std::string all;
    for (const std::string& one : problems) all += (all.empty() ? "" : "\n") + one;
    throw std::invalid_argument(all);
  }
  return Search(problem, options).run();
}

}  // namespace zwidth
