#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <random>
#include <thread>
#include <utility>

#include "interrupt.h"
#include "optimise/outcome.h"
#include "study.h"
#include "verbs.h"

#include "zwidth/design/pareto.h"
#include "zwidth/design/refine.h"
#include "zwidth/design/workers.h"
#include "zwidth/ranks/ranks.h"

/// `zwidth optimise`: searches for better designs, as a study file says.

namespace zwidth {

namespace {

namespace fs = std::filesystem;

struct OptimiseArguments {
  std::string study;
  std::vector<std::string> overrides;
  std::string directory;
  std::vector<std::string> weights;
  int threads = 0;
  std::int64_t samples = 2000;
  double checkpoint_seconds = 30.0;
  bool resume = false;
  bool json = false;
};

/// NAME=VALUE of --weights.
std::map<std::string, double> weights_of(const OptimiseArguments& arguments, const Study& study) {
  std::vector<std::string> known;
  for (const StudyObjective& one : study.objectives) known.push_back(one.name);
  std::map<std::string, double> weights;
  for (const std::string& text : arguments.weights) {
    const std::size_t equals = text.rfind('=');
    const std::string name = text.substr(0, equals);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw InputError(
          fmt::format("--weights {}: \"{}\" is no objective; {}", text, name, suggest(name, known)));
    }
    const ParsedQuantity value = equals == std::string::npos
                                     ? ParsedQuantity{}
                                     : parse_quantity(text.substr(equals + 1), Dimension::number);
    if (!value || *value.value < 0.0) {
      throw InputError(
          fmt::format("--weights {}: give a number that is not negative, as in {}=0.5", text, name));
    }
    weights[name] = *value.value;
  }
  return weights;
}

/// Which design of the front, by the study's rule or by weights.
void choose(StudyOutcome& outcome, const StudyModel& model, const std::map<std::string, double>& by_hand) {
  if (outcome.front.empty()) return;
  const Study& study = model.study();
  const std::size_t n = study.objectives.size();
  if (n == 1) {
    outcome.chosen = outcome.best(0);
    outcome.choice = fmt::format("the best {}", study.objectives.front().name);
    return;
  }
  const std::vector<double> values = outcome.minimised();
  std::vector<double> weights;
  std::string said;
  const std::map<std::string, double>& given = by_hand.empty() ? study.choice.weights : by_hand;
  for (const StudyObjective& one : study.objectives) {
    const auto found = given.find(one.name);
    weights.push_back(found == given.end() ? 1.0 : found->second);
    said += fmt::format("{}{} {}", said.empty() ? "" : ", ", one.name, trimmed(weights.back(), 4));
  }
  const ChoiceRule rule = by_hand.empty() ? study.choice.rule : ChoiceRule::weights;
  if (rule == ChoiceRule::knee) {
    outcome.chosen = knee(values, n);
    outcome.choice = "the knee: farthest from the plane through the best design of each objective";
    if (outcome.chosen) return;
    // A front that bulges the other way has none.
  }
  if (rule == ChoiceRule::topsis) {
    const std::vector<double> close = topsis(values, n, weights);
    outcome.chosen = static_cast<std::size_t>(std::max_element(close.begin(), close.end()) - close.begin());
    outcome.choice = fmt::format("TOPSIS, weights {}", said);
    return;
  }
  const std::vector<double> rms = weighted_rms(values, n, weights);
  outcome.chosen = static_cast<std::size_t>(std::min_element(rms.begin(), rms.end()) - rms.begin());
  outcome.choice = fmt::format("{}least weighted root mean square of the normalised objectives, weights {}",
                               rule == ChoiceRule::knee ? "no knee; " : "", said);
}

/// A batch evaluation of whatever `of` makes of a row, on all threads.
BatchEvaluation spread_out(
    const StudyModel& model, std::size_t variables, std::size_t outcomes, int threads,
    std::function<void(StudyEvaluator&, std::span<const double>, std::span<double>)> of) {
  return on_workers(variables, outcomes,
                    [&model, of = std::move(of)]() -> DesignEvaluation {
                      auto evaluator = std::make_shared<StudyEvaluator>(model);
                      return [evaluator, of](std::span<const double> row, std::span<double> outcome) {
                        of(*evaluator, row, outcome);
                      };
                    },
                    {.threads = threads, .cancel = &stop_on_interrupt()});
}

/// What small changes, or one step, of each variable do to every figure of the chosen design.
void find_sensitivity(StudyOutcome& outcome, const StudyModel& model, int threads) {
  const std::span<const double> chosen = outcome.design(*outcome.chosen);
  const std::vector<double> design(chosen.begin(), chosen.end());
  const Study& study = model.study();
  ChosenSensitivity found;
  found.figures = outcome_figures(model);
  const DesignSheet& sheet = outcome.front[*outcome.chosen];
  found.values = figure_values(sheet, study);
  found.margins = margins_of(sheet);
  std::vector<double> at, steps;
  StudyEvaluator evaluator(model);
  for (std::size_t v = 0; v < design.size(); ++v) {
    const SearchVariable& variable = outcome.problem.variables[v];
    if (!(variable.max > variable.min)) continue;
    if (!variable.integer) {
      constexpr double kStep = 1e-5;  // of the range: differences of smooth figures to some ten digits
      found.smooth.push_back(v);
      at.push_back(design[v]);
      steps.push_back(kStep * (variable.max - variable.min));
      continue;
    }
    ChosenSensitivity::Step step{.variable = v};
    for (const bool up : {false, true}) {
      std::vector<double> moved = design;
      moved[v] += up ? 1.0 : -1.0;
      const auto side = static_cast<std::size_t>(up);
      step.figures[side].assign(found.figures.size(), std::nan(""));
      if (moved[v] < variable.min || moved[v] > variable.max) continue;
      const DesignSheet there = evaluator.sheet(moved);
      step.value[side] = value_text(there.variables[v]);
      step.figures[side] = figure_values(there, study);
      step.feasible[side] = there.feasible;
    }
    found.steps.push_back(std::move(step));
  }
  for (const std::size_t v : found.smooth) {
    const SearchVariable& variable = outcome.problem.variables[v];
    std::vector<double> moved = design;
    moved[v] += ChosenSensitivity::kPart * (variable.max - variable.min);
    found.grown.push_back(figure_values(evaluator.sheet(moved), study));
  }
  if (!at.empty()) {
    const std::size_t outcomes = found.figures.size() + found.margins.size();
    const BatchEvaluation evaluate = spread_out(
        model, at.size(), outcomes, threads,
        [&](StudyEvaluator& one, std::span<const double> row, std::span<double> result) {
          std::vector<double> moved = design;
          for (std::size_t i = 0; i < row.size(); ++i) moved[found.smooth[i]] = row[i];
          const DesignSheet there = one.sheet(moved);
          const std::vector<double> values = figure_values(there, study), margins = margins_of(there);
          std::copy(margins.begin(), margins.end(), std::copy(values.begin(), values.end(), result.begin()));
        });
    found.slopes = sensitivity(evaluate, at, steps, outcomes);
    if (!found.slopes.complete) return;
  }
  outcome.sensitivity = std::move(found);
}

/// The device as it is beside what was found.
void find_start(StudyOutcome& outcome, const StudyModel& model) {
  StudyEvaluator evaluator(model);
  outcome.start = evaluator.sheet(model.device_design());
  // Variables without a key are nobody's before the search.
  outcome.start_moved = !model.starts_at_device();
}

void try_tolerances(StudyOutcome& outcome, const StudyModel& model, int threads, std::int64_t samples) {
  const std::size_t count = model.study().tolerances.size();
  if (count == 0 || samples <= 0) return;
  const std::span<const double> chosen = outcome.design(*outcome.chosen);
  const std::vector<double> design(chosen.begin(), chosen.end());
  const std::size_t outcomes = outcome.problem.outcome_size() - 1;  // "can be built" is not asked
  const BatchEvaluation evaluate = spread_out(
      model, count, outcomes, threads,
      [&](StudyEvaluator& evaluator, std::span<const double> row, std::span<double> result) {
        const DesignSheet sheet = evaluator.sheet(design, row);
        const auto after = std::copy(sheet.objectives.begin(), sheet.objectives.end(), result.begin());
        std::copy(sheet.violations.begin(), sheet.violations.end(), after);
      });
  const std::vector<double> nominal(count, 0.0);
  const std::vector<Tolerance> tolerances(count, Tolerance{.size = 1.0});
  ToleranceOptions options;
  options.samples = samples;
  options.seed = model.study().search.seed;
  options.constraints = model.study().constraints.size();
  ToleranceStudy study = tolerance_study(evaluate, nominal, tolerances, outcomes, options);
  if (study.complete) outcome.tolerances = std::move(study);
}

/// The words of a study that decide its outcomes: a checkpoint belongs to them.
std::string identity_of(const StudyModel& model) {
  const Study& study = model.study();
  std::string text = study.device;
  for (const std::string& one : study.overrides) text += "|" + one;
  for (const StudyDerived& one : study.derived) text += "|" + one.name + "=" + one.value;
  for (const StudyMeasure& one : study.measures) text += "|" + one.name + ":" + one.figure + one.posture;
  for (const StudyObjective& one : study.objectives) text += "|" + one.value;
  for (const StudyConstraint& one : study.constraints) text += "|" + one.value + "<" + one.max + ">" + one.min;
  return text;
}

/// `ranks`: of an MPI job, if this is one.
StudyOutcome run_search(const StudyModel& model, const OptimiseArguments& arguments, const fs::path& directory,
                        Ranks* ranks) {
  const Study& study = model.study();
  StudyOutcome outcome;
  outcome.workers = arguments.threads > 0 ? arguments.threads
                                          : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  outcome.problem = model.search_problem();
  outcome.problem.identity = identity_of(model);
  outcome.problem.evaluate = study_evaluation(model, arguments.threads, &stop_on_interrupt());
  if (ranks != nullptr) {
    outcome.workers *= ranks->size();
    outcome.ranks = ranks->size() > 1;
    outcome.problem.evaluate = ranks->spread(outcome.problem.variables.size(), outcome.problem.outcome_size(),
                                             outcome.problem.evaluate);
  }
  outcome.options = study_search_options(model);
  SearchOptions& options = outcome.options;
  options.checkpoint = directory / "checkpoint";
  options.checkpoint_seconds = arguments.checkpoint_seconds;
  options.resume = arguments.resume;
  Progress progress(study.name, "designs");
  double designs = 0.0;
  if (options.algorithm == SearchAlgorithm::grid) {
    designs = 1.0;
    for (const SearchVariable& one : outcome.problem.variables) designs *= one.max - one.min + 1.0;
  } else {
    designs = static_cast<double>(options.generations + 1) * options.population;
  }
  options.progress = [&, first = true](const Generation& at) mutable {
    // The first to be heard of after a resumption is one generation on.
    if (std::exchange(first, false) && options.resume) {
      progress.go_on_from(static_cast<double>(
          at.evaluations - std::int64_t{options.population} * info(options.algorithm).populations_per_step));
    }
    progress.update(
        static_cast<double>(at.evaluations), designs,
        fmt::format("generation {}, hypervolume {}, {:.0f} % feasible", at.number,
                    std::isnan(at.hypervolume) ? "none" : number(at.hypervolume), 100.0 * at.feasible_share));
    return !stop_on_interrupt();
  };
  try {
    outcome.result = search(outcome.problem, options);
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("--resume: {}", error.what()));
  }
  options.progress = nullptr;
  return outcome;
}

/// Draws designs to say what of them is undefined, and why, where some could not be evaluated.
void find_obstacles(StudyOutcome& outcome, const StudyModel& model) {
  const std::vector<ConstraintRecord>& records = outcome.result.constraints;
  const bool all_defined = std::all_of(records.begin(), records.end(), [&](const ConstraintRecord& one) {
    return one.undefined == 0 && (&one != &records.front() || one.held == outcome.result.evaluations);
  });
  if (all_defined || records.empty()) return;
  // A small part of what the search itself cost.
  constexpr std::int64_t kFew = 16, kMany = 256, kPart = 20;
  outcome.looked_at = static_cast<int>(std::clamp(outcome.result.evaluations / kPart, kFew, kMany));
  StudyEvaluator evaluator(model);
  std::mt19937_64 random(model.study().search.seed);
  std::vector<double> design(outcome.problem.variables.size());
  for (int i = 0; i < outcome.looked_at && !stop_on_interrupt(); ++i) {
    for (std::size_t v = 0; v < design.size(); ++v) {
      const SearchVariable& one = outcome.problem.variables[v];
      const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random);
      design[v] = one.integer ? std::min(std::floor(one.min + share * (one.max - one.min + 1.0)), one.max)
                              : one.min + share * (one.max - one.min);
    }
    for (DesignObstacle& found : evaluator.obstacles(design)) {
      const auto known =
          std::find_if(outcome.obstacles.begin(), outcome.obstacles.end(), [&](const CountedObstacle& one) {
            return one.first.place == found.place && one.first.what == found.what &&
                   one.first.rule == found.rule;
          });
      if (known != outcome.obstacles.end()) {
        ++known->count;
        continue;
      }
      std::string example;
      for (const DesignValue& one : evaluator.sheet(design).variables) {
        example += fmt::format("{}{} = {}", example.empty() ? "" : ", ", one.name, value_text(one));
      }
      outcome.obstacles.push_back({std::move(found), std::move(example), 1});
    }
  }
  std::stable_sort(outcome.obstacles.begin(), outcome.obstacles.end(),
                   [](const CountedObstacle& a, const CountedObstacle& b) { return a.count > b.count; });
}

/// Improves the chosen design nearby; the better one joins the front.
void refine_choice(StudyOutcome& outcome, const StudyModel& model) {
  const std::size_t objectives = outcome.problem.objectives.size();
  RefineOptions options;
  if (objectives > 1) {
    const ObjectiveRange range = objective_range(outcome.minimised(), objectives);
    options.ideal = range.min;
    options.nadir = range.max;
  }
  Progress progress(model.study().name, "designs");
  double done = 0.0;
  const auto start = std::chrono::steady_clock::now();
  SearchProblem problem = outcome.problem;
  problem.evaluate = [&](std::span<const double> designs, std::span<double> outcomes) {
    done += static_cast<double>(designs.size()) / static_cast<double>(problem.variables.size());
    progress.update(done, static_cast<double>(options.evaluations), "local search, at most");
    return outcome.problem.evaluate(designs, outcomes);
  };
  const Refinement better = refine(problem, outcome.design(*outcome.chosen), options);
  outcome.result.evaluations += better.evaluations;
  outcome.result.seconds_evaluating +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!better.improved) return;
  SearchResult& result = outcome.result;
  result.front.push_back(result.designs.size() / outcome.problem.variables.size());
  result.designs.insert(result.designs.end(), better.design.begin(), better.design.end());
  result.outcomes.insert(result.outcomes.end(), better.outcomes.begin(), better.outcomes.end());
  outcome.front.push_back(StudyEvaluator(model).sheet(better.design));
  outcome.chosen = outcome.front.size() - 1;
  outcome.choice += "; refined by a local search";
}

int optimise(OptimiseArguments arguments, const Terminal& terminal) {
  std::optional<Ranks> ranks;
  if (Ranks::started_by_launcher()) ranks.emplace();
  // Each rank reads the study; what is wrong with it is said once.
  std::unique_ptr<StudyModel> model;
  std::map<std::string, double> weights;
  std::exception_ptr mistake;
  try {
    model = read_study_model(arguments.study, arguments.overrides);
    weights = weights_of(arguments, model->study());
  } catch (...) {
    mistake = std::current_exception();
  }
  if (ranks) {
    const int first = ranks->first_that(mistake != nullptr);
    if (first < ranks->size() && first != ranks->rank()) return kInputWrong;
  }
  if (mistake != nullptr) std::rethrow_exception(mistake);
  if (ranks) {
    // A launcher starts as many ranks as there are cores to use.
    if (arguments.threads == 0 && ranks->size() > 1) arguments.threads = 1;
    if (!ranks->drives()) {
      const SearchProblem problem = model->search_problem();
      ranks->serve(problem.variables.size(), problem.outcome_size(),
                   study_evaluation(*model, arguments.threads, &stop_on_interrupt()));
      return kDone;
    }
  }
  const fs::path directory = results_directory(arguments.directory, fs::path("optimise") / model->study().name);
  StudyOutcome outcome = run_search(*model, arguments, directory, ranks ? &*ranks : nullptr);
  StudyEvaluator evaluator(*model);
  for (std::size_t i = 0; i < outcome.result.front.size(); ++i) {
    outcome.front.push_back(evaluator.sheet(outcome.design(i)));
  }
  choose(outcome, *model, weights);
  if (outcome.chosen && model->study().search.refine && !stop_on_interrupt()) refine_choice(outcome, *model);
  outcome.problem.evaluate = nullptr;
  ranks.reset();  // the others go home
  find_start(outcome, *model);
  if (outcome.chosen && !stop_on_interrupt()) {
    find_sensitivity(outcome, *model, arguments.threads);
    try_tolerances(outcome, *model, arguments.threads, arguments.samples);
  }
  find_obstacles(outcome, *model);
  for (const std::string& note : outcome.result.notes) complain(note);
  const auto files = write_outcome(outcome, *model, directory.string());
  if (arguments.json) {
    print_json(outcome_json(outcome, *model));
  } else {
    print(outcome_text(outcome, *model, terminal, files));
  }
  return outcome.chosen ? kDone : kNo;
}

}  // namespace

void add_optimise(CLI::App& app, Context& context) {
  CLI::App* verb =
      add_verb(app, "optimise", "Search for better designs of a device",
               "  zwidth optimise r-cube-kinematics                     writes optimise/r-cube-kinematics/\n"
               "  zwidth optimise mine.toml --set search.generations=50 -o out\n"
               "  zwidth optimise mine.toml --resume                    goes on from its checkpoint\n"
               "  zwidth optimise delta-drive --weights \"footprint=0.2\"\n"
               "  mpirun -np 16 zwidth optimise delta-drive             on a cluster\n"
               "  zwidth report optimise/delta-drive/chosen.toml");
  auto arguments = std::make_shared<OptimiseArguments>();
  verb->add_option("STUDY", arguments->study,
                   "a study that comes with zwidth, a .toml file, or - for the input")
      ->required();
  verb->add_option("--set", arguments->overrides, "change a key of the study: KEY=VALUE")
      ->type_name("KEY=VALUE")
      ->take_all();
  verb->add_option("-o,--output", arguments->directory, "directory for the results; optimise/NAME if not given")
      ->type_name("DIR");
  verb->add_flag("--resume", arguments->resume, "go on from the checkpoint in that directory");
  verb->add_option("--weights", arguments->weights, "choose by weights: OBJECTIVE=WEIGHT,...; 1 if not given")
      ->type_name("NAME=W")
      ->delimiter(',')
      ->take_all();
  verb->add_option("--threads", arguments->threads, "at most so many; all cores if not given")
      ->check(CLI::Range(0, 4096))
      ->type_name("N");
  verb->add_option("--samples", arguments->samples, "of the tolerances; 0 leaves them out")
      ->check(CLI::Range(0, 10000000))
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--checkpoint", arguments->checkpoint_seconds, "seconds between checkpoints")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S")
      ->capture_default_str();
  add_json_flag(*verb, arguments->json);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return optimise(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
