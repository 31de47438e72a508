#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Searches a space of designs for those that no other beats. What a design means is left to `evaluate`.

namespace zwidth {

/// One number that a search may choose.
struct SearchVariable {
  std::string name;
  double min = 0.0;
  double max = 0.0;      ///< not below min; a variable with min = max stays there
  bool integer = false;  ///< whole numbers only; min and max are whole then

  bool operator==(const SearchVariable&) const = default;
};

/// Evaluates designs, one row of `designs` each (a value per variable), into rows of `outcomes`: the
/// objectives, all to be minimised, then a number per constraint, which is positive by how much it is broken;
/// where it holds it is 0, or negative by how much is left. Objectives of a design that breaks a constraint may
/// be NaN, and so is whatever cannot be computed; an undefined constraint counts as worse than any number. A
/// row depends on its design alone. Called with any number of rows, by one thread at a time. Returns false if
/// it was told to stop: its rows are then worth nothing. If it throws, its rows are asked for again one by one,
/// and those that throw again count as undefined.
using BatchEvaluation = std::function<bool(std::span<const double> designs, std::span<double> outcomes)>;

struct SearchProblem {
  std::vector<SearchVariable> variables;
  std::vector<std::string> objectives;   ///< names, at least one
  std::vector<std::string> constraints;  ///< names
  BatchEvaluation evaluate;
  /// Whatever else the outcomes depend on, in words: a checkpoint of a search with another one is refused.
  std::string identity;

  std::size_t outcome_size() const { return objectives.size() + constraints.size(); }
};

// ----------------------------------------------------------------------------------------------- algorithms

enum class SearchAlgorithm {
  nsga2,                      ///< non-dominated sorting and crowding (Deb et al. 2002)
  nspso,                      ///< a swarm with non-dominated sorting (Li 2003)
  moead,                      ///< decomposition into one problem per weight (Zhang & Li 2007)
  cmaes,                      ///< one objective: covariance matrix adaptation (Hansen 2006)
  de,                         ///< one objective: differential evolution (Storn & Price 1997)
  de1220,                     ///< one objective: differential evolution that chooses among 12 variants
  sade,                       ///< one objective: differential evolution that chooses its parameters
  self_adaptive_constraints,  ///< one objective: penalties that adapt (Farmani & Wright 2003) around `de`
  grid,                       ///< every design of a space of integers, in turn
};

/// What an algorithm is and needs.
struct SearchAlgorithmInfo {
  SearchAlgorithm algorithm;
  std::string_view name;     ///< as users write it
  std::string_view what;     ///< one line for people
  bool one_objective;        ///< can search for one objective
  bool several_objectives;   ///< can search for several
  bool batches;              ///< evaluates a generation at once, on all workers; others go one by one
  int min_population;        ///< least population
  int population_step;       ///< the population is a multiple of it
  int populations_per_step;  ///< evaluations of one generation, in populations
};
std::span<const SearchAlgorithmInfo> search_algorithms();
const SearchAlgorithmInfo& info(SearchAlgorithm algorithm);
/// The algorithm that users write as `name`; nothing if there is none.
std::optional<SearchAlgorithm> search_algorithm(std::string_view name);

// -------------------------------------------------------------------------------------------------- progress

/// The state after a generation; the first, number 0, is the first population.
struct Generation {
  std::int64_t number = 0;
  std::int64_t evaluations = 0;  ///< designs evaluated so far; one met again in the population is not repeated
  double feasible_share = 0.0;   ///< of this population
  std::int64_t front = 0;        ///< feasible designs of this population that none of it dominates
  /// Volume that the front dominates up to `SearchResult::reference`, in the product of the objectives' units;
  /// NaN until the reference is known. With one objective, how far the best lies below the reference.
  double hypervolume = 0.0;
  double seconds_evaluating = 0.0;    ///< so far, by a wall clock; goes on after a resumption [s]
  double seconds_in_algorithm = 0.0;  ///< so far, everything else [s]
};

struct SearchOptions {
  SearchAlgorithm algorithm = SearchAlgorithm::nsga2;
  int population = 100;            ///< of a grid: designs in a batch, at least 1000
  std::int64_t generations = 100;  ///< after the first population; a grid ends with its last design instead
  std::int64_t evaluations = 0;    ///< no generation begins that might exceed it; 0: no limit
  std::uint32_t seed = 1;

  /// Ends a search whose hypervolume grew by less than this share over `stagnation_generations`; 0 never does.
  double stagnation = 0.0;
  int stagnation_generations = 20;

  /// The hypervolume's reference point, a value per objective. Empty: fixed for the rest of the run by the
  /// first generation with ten feasible designs or more, a tenth of their range beyond the worst of each
  /// objective.
  std::vector<double> reference;

  /// Designs for the first population, row by row; the rest is drawn.
  std::vector<double> start;

  /// Called after every generation; false stops the search there.
  std::function<bool(const Generation&)> progress;

  /// Where to keep the state of the search; empty keeps none. Written after a generation when so many seconds
  /// have passed, and at the end, to a file beside it that then takes its place; the one before is kept as
  /// FILE.previous.
  std::filesystem::path checkpoint;
  double checkpoint_seconds = 30.0;  ///< [s]
  bool resume = false;               ///< go on from `checkpoint`
};

enum class SearchEnd {
  generations,  ///< all asked for are done
  evaluations,  ///< the next generation might exceed the budget
  stagnation,   ///< the hypervolume no longer grows
  grid,         ///< every design of the grid was seen
  stopped,      ///< `progress` or `evaluate` said so; the result is the last whole generation
  gave_up,      ///< the algorithm itself failed, `notes` says how; the result is the last whole generation
};
/// "reached its generations" and so on, for people.
std::string_view to_words(SearchEnd end);

/// What a search saw of one constraint, over all its evaluations.
struct ConstraintRecord {
  std::int64_t held = 0;         ///< evaluations in which it held
  std::int64_t undefined = 0;    ///< in which it could not be computed
  double least_violation = 0.0;  ///< 0 if it ever held; infinite if it was never defined
};

struct SearchResult {
  SearchEnd end = SearchEnd::generations;
  std::vector<Generation> history;
  /// The last whole generation, row by row, as `evaluate` takes and gives them. Of a grid: the designs of all
  /// that no other constraint-dominates.
  std::vector<double> designs;
  std::vector<double> outcomes;
  /// Rows that are feasible, not dominated and different designs, by the first objective and so on.
  std::vector<std::size_t> front;
  std::vector<double> reference;              ///< of the hypervolume; empty if it was never fixed
  std::vector<ConstraintRecord> constraints;  ///< in the order of the problem's
  std::int64_t evaluations = 0;
  std::int64_t failures =
      0;  ///< evaluations that threw, or left an objective undefined with no constraint broken
  std::string first_failure;          ///< what the first that threw said
  std::vector<std::string> notes;     ///< what the user should know: a broken checkpoint, ...
  double seconds_evaluating = 0.0;    ///< [s]
  double seconds_in_algorithm = 0.0;  ///< [s]
};

/// What keeps `options` from searching `problem`, a sentence each; empty if nothing does.
std::vector<std::string> search_problems(const SearchProblem& problem, const SearchOptions& options);

/// Searches. The same seed gives the same generations to the last bit, however `evaluate` spreads its work and
/// however often the search was interrupted and resumed.
///
/// Constraints are met by constraint domination (Deb et al. 2002, definition 1): see `unconstrained_image`. The
/// algorithms are those of pagmo, one generation at a time. Those that evaluate one by one and in turn (see
/// `SearchAlgorithmInfo::batches`) use one core, unless one evaluation uses more. Algorithms other than `nsga2`
/// and `grid` know no whole numbers: theirs are drawn as real ones and rounded.
///
/// Throws std::invalid_argument with all of `search_problems`, and std::runtime_error when told to resume
/// without a usable checkpoint, or from one of another search. What fails while it searches ends up in the
/// result.
SearchResult search(const SearchProblem& problem, const SearchOptions& options);

}  // namespace zwidth
