#include <algorithm>
#include <cmath>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/cstrs_self_adaptive.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/de1220.hpp>
#include <pagmo/algorithms/moead.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/algorithms/sade.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/s11n.hpp>
#include <random>
#include <sstream>
#include <tbb/task_arena.h>

#include "zwidth/design/internal/bytes.h"
#include "zwidth/design/internal/engine.h"
#include "zwidth/design/pareto.h"

namespace zwidth::internal {

/// The search problem as pagmo sees it: without the variables that cannot vary, whole numbers last, and without
/// constraints, unless the algorithm is one that takes them.
class PagmoSpace {
 public:
  PagmoSpace(const SearchOptions& options, Evaluator& evaluator) : evaluator_(evaluator) {
    knows_integers_ = options.algorithm == SearchAlgorithm::nsga2;
    takes_constraints_ = options.algorithm == SearchAlgorithm::self_adaptive_constraints;
    const std::vector<SearchVariable>& variables = evaluator.problem().variables;
    for (const bool integers : {false, true}) {
      for (std::size_t v = 0; v < variables.size(); ++v) {
        if (variables[v].min < variables[v].max && variables[v].integer == integers) order_.push_back(v);
      }
    }
  }

  std::size_t size() const { return order_.size(); }
  std::size_t objectives() const { return evaluator_.problem().objectives.size(); }
  std::size_t constraints() const { return takes_constraints_ ? evaluator_.problem().constraints.size() : 0; }
  std::size_t integers() const {
    if (!knows_integers_) return 0;
    return static_cast<std::size_t>(std::count_if(order_.begin(), order_.end(), [&](std::size_t v) {
      return evaluator_.problem().variables[v].integer;
    }));
  }

  /// Whole numbers that are drawn as real ones get the same share of the range each.
  std::pair<std::vector<double>, std::vector<double>> bounds() const {
    std::pair<std::vector<double>, std::vector<double>> result;
    for (const std::size_t v : order_) {
      const SearchVariable& variable = evaluator_.problem().variables[v];
      const double margin = variable.integer && !knows_integers_ ? 0.499999 : 0.0;
      result.first.push_back(variable.min - margin);
      result.second.push_back(variable.max + margin);
    }
    return result;
  }

  /// The design of a chromosome, within the bounds even if that is not (or is NaN).
  void decode(std::span<const double> chromosome, std::span<double> design) const {
    const std::vector<SearchVariable>& variables = evaluator_.problem().variables;
    for (std::size_t v = 0; v < variables.size(); ++v) design[v] = variables[v].min;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const SearchVariable& variable = variables[order_[i]];
      const double value = variable.integer ? std::round(chromosome[i]) : chromosome[i];
      if (value > variable.min) design[order_[i]] = std::min(value, variable.max);
    }
  }
  std::vector<double> encode(std::span<const double> design) const {
    std::vector<double> chromosome;
    for (const std::size_t v : order_) chromosome.push_back(design[v]);
    return chromosome;
  }

  /// Fitness of chromosomes, row by row, evaluated together.
  std::vector<double> fitness(std::span<const double> chromosomes) {
    const std::size_t variables = evaluator_.problem().variables.size(),
                      width = evaluator_.problem().outcome_size();
    const std::size_t count = chromosomes.size() / size();
    designs_.resize(count * variables);
    outcomes_.resize(count * width);
    for (std::size_t row = 0; row < count; ++row) {
      decode(chromosomes.subspan(row * size(), size()),
             std::span<double>(designs_).subspan(row * variables, variables));
    }
    evaluator_.evaluate_once(designs_, outcomes_);
    std::vector<double> result;
    for (std::size_t row = 0; row < count; ++row) {
      const std::vector<double> one =
          fitness_of(std::span<const double>(outcomes_).subspan(row * width, width));
      result.insert(result.end(), one.begin(), one.end());
    }
    return result;
  }

  std::vector<double> fitness_of(std::span<const double> outcomes) const {
    std::vector<double> result(objectives());
    unconstrained_image(outcomes, result);
    if (takes_constraints_) {
      // The penalties are added to the objective, which an infeasible design may not have.
      constexpr double kWorst = 1e30;
      const Standing place = standing(outcomes, objectives());
      if (!place.feasible()) result[0] = std::isnan(outcomes[0]) ? kWorst : std::min(outcomes[0], kWorst);
      for (const double constraint : outcomes.subspan(objectives())) {
        result.push_back(std::isnan(constraint) ? kWorst : std::clamp(constraint, -kWorst, kWorst));
      }
      return result;
    }
    if (scale_.empty() || !standing(outcomes, objectives()).feasible()) return result;
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = (result[k] - offset_[k]) * scale_[k];
    return result;
  }

  /// Objectives scaled by their range over feasible designs, for algorithms that add or compare them.
  void set_scale(std::vector<double> offset, std::vector<double> scale) {
    offset_ = std::move(offset);
    scale_ = std::move(scale);
  }
  const std::vector<double>& offset() const { return offset_; }
  const std::vector<double>& scale() const { return scale_; }

 private:
  Evaluator& evaluator_;
  bool knows_integers_ = false;
  bool takes_constraints_ = false;
  std::vector<std::size_t> order_;  // variable of each gene
  std::vector<double> offset_, scale_;
  std::vector<double> designs_, outcomes_;  // of the latest call
};

/// What pagmo calls the problem. Copies share the space; an archive holds none.
struct PagmoProblem {
  PagmoSpace* space = nullptr;

  std::vector<double> fitness(const std::vector<double>& chromosome) const {
    return space->fitness(chromosome);
  }
  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return space != nullptr ? space->bounds() : std::pair(std::vector{0.0}, std::vector{1.0});
  }
  std::vector<double>::size_type get_nobj() const { return space != nullptr ? space->objectives() : 1; }
  std::vector<double>::size_type get_nix() const { return space != nullptr ? space->integers() : 0; }
  std::vector<double>::size_type get_nic() const { return space != nullptr ? space->constraints() : 0; }
  template <class Archive>
  void serialize(Archive&, unsigned) {}
};

/// What pagmo calls a batch evaluator: a whole generation at once.
struct PagmoBatch {
  std::vector<double> operator()(const pagmo::problem& problem, const std::vector<double>& chromosomes) const {
    return problem.extract<PagmoProblem>()->space->fitness(chromosomes);
  }
  template <class Archive>
  void serialize(Archive&, unsigned) {}
};

}  // namespace zwidth::internal

PAGMO_S11N_BFE_EXPORT(zwidth::internal::PagmoBatch)

namespace zwidth::internal {
namespace {

// Generations of the algorithm in one of ours, where what it learns between them cannot be kept in pagmo's
// archive: the penalties, the choice among variants, the best place of each particle.
constexpr unsigned kPenaltyGenerations = 10;
constexpr unsigned kVariantGenerations = 20;
constexpr unsigned kSwarmGenerations = 10;

pagmo::algorithm make_algorithm(const SearchOptions& options, std::size_t variables) {
  const std::uint32_t seed = options.seed;
  switch (options.algorithm) {
    case SearchAlgorithm::nsga2: {
      // p_c, eta_c, p_m = 1/n and eta_m of Deb et al. 2002, section IV.
      pagmo::nsga2 nsga2(1, 0.9, 15.0, 1.0 / static_cast<double>(variables), 20.0, seed);
      nsga2.set_bfe(pagmo::bfe(PagmoBatch()));
      return pagmo::algorithm(nsga2);
    }
    case SearchAlgorithm::nspso: {
      pagmo::nspso nspso(kSwarmGenerations, 0.6, 2.0, 2.0, 1.0, 0.5, 60, "crowding distance", false, seed);
      nspso.set_bfe(pagmo::bfe(PagmoBatch()));
      return pagmo::algorithm(nspso);
    }
    case SearchAlgorithm::moead: {
      const auto neighbours = static_cast<pagmo::population::size_type>(std::min(20, options.population - 1));
      return pagmo::algorithm(
          pagmo::moead(1, "low discrepancy", "tchebycheff", neighbours, 1.0, 0.5, 20.0, 0.9, 2, true, seed));
    }
    // Tolerances of 0: whether there is anything left to gain is for the person to say.
    case SearchAlgorithm::cmaes:
      return pagmo::algorithm(pagmo::cmaes(1, -1.0, -1.0, -1.0, -1.0, 0.3, 0.0, 0.0, true, true, seed));
    case SearchAlgorithm::de:
      return pagmo::algorithm(pagmo::de(1, 0.8, 0.9, 2, 0.0, 0.0, seed));
    case SearchAlgorithm::de1220:
      return pagmo::algorithm(pagmo::de1220(kVariantGenerations, pagmo::de1220_statics<void>::allowed_variants,
                                            1, 0.0, 0.0, false, seed));
    case SearchAlgorithm::sade:
      return pagmo::algorithm(pagmo::sade(1, 2, 1, 0.0, 0.0, true, seed));
    case SearchAlgorithm::self_adaptive_constraints:
      return pagmo::algorithm(
          pagmo::cstrs_self_adaptive(1, pagmo::de(kPenaltyGenerations, 0.8, 0.9, 2, 0.0, 0.0, seed), seed));
    case SearchAlgorithm::grid:
      break;
  }
  throw std::logic_error("no algorithm of pagmo");
}

std::string archived(const pagmo::algorithm& algorithm) {
  std::ostringstream stream;
  {
    boost::archive::binary_oarchive archive(stream);
    archive << algorithm;
  }
  return stream.str();
}

pagmo::algorithm from_archive(const std::string& bytes) {
  std::istringstream stream(bytes);
  boost::archive::binary_iarchive archive(stream);
  pagmo::algorithm algorithm;
  archive >> algorithm;
  return algorithm;
}

class PagmoEngine final : public Engine {
 public:
  PagmoEngine(const SearchOptions& options, Evaluator& evaluator)
      : options_(options),
        evaluator_(evaluator),
        space_(options, evaluator),
        algorithm_(make_algorithm(options, std::max<std::size_t>(1, space_.size()))),
        population_(new_population()) {}

  void start() override {
    const auto [lower, upper] = space_.bounds();
    const std::size_t variables = evaluator_.problem().variables.size(), genes = space_.size();
    std::vector<double> chromosomes;
    for (std::size_t at = 0; at < options_.start.size(); at += variables) {
      const std::vector<double> one = space_.encode(std::span(options_.start).subspan(at, variables));
      chromosomes.insert(chromosomes.end(), one.begin(), one.end());
    }
    // Drawn here and not by pagmo, whose distributions are the compiler's own.
    std::mt19937_64 random(options_.seed);
    const std::size_t integers = space_.integers();
    const std::size_t all = static_cast<std::size_t>(options_.population) * genes;
    for (std::size_t at = chromosomes.size(); at < all; ++at) {
      const std::size_t gene = at % genes;
      const double u = static_cast<double>(random() >> 11) * 0x1p-53;
      chromosomes.push_back(gene + integers < genes
                                ? lower[gene] + u * (upper[gene] - lower[gene])
                                : lower[gene] + std::floor(u * (upper[gene] - lower[gene] + 1.0)));
    }
    const std::vector<double> fitness = space_.fitness(chromosomes);
    pagmo::population population = new_population();
    const auto width = static_cast<std::ptrdiff_t>(space_.objectives() + space_.constraints());
    for (std::ptrdiff_t row = 0; row < options_.population; ++row) {
      const auto x = chromosomes.begin() + row * static_cast<std::ptrdiff_t>(genes);
      const auto f = fitness.begin() + row * width;
      population.push_back(std::vector<double>(x, x + static_cast<std::ptrdiff_t>(genes)),
                           std::vector<double>(f, f + width));
    }
    population_ = std::move(population);
    after_generation();
  }

  void step() override {
    // The generators of random numbers are inside the algorithm: it, too, goes back to the last whole
    // generation.
    const pagmo::algorithm before = algorithm_;
    try {
      // pagmo checks what a batch was given and gave with TBB, which wakes every core for some microseconds'
      // work.
      alone_.execute([this] { population_ = algorithm_.evolve(population_); });
    } catch (...) {
      algorithm_ = before;
      throw;
    }
    after_generation();
  }

  std::int64_t next_evaluations() const override {
    return std::int64_t{options_.population} * info(options_.algorithm).populations_per_step;
  }

  Rows rows() const override {
    Rows rows;
    std::vector<double> design(evaluator_.problem().variables.size());
    for (const std::vector<double>& chromosome : population_.get_x()) {
      space_.decode(chromosome, design);
      const std::span<const double> outcomes = evaluator_.find(design);
      rows.designs.insert(rows.designs.end(), design.begin(), design.end());
      rows.outcomes.insert(rows.outcomes.end(), outcomes.begin(), outcomes.end());
    }
    return rows;
  }

  std::string memory() const override {
    ByteWriter writer;
    writer.put(archived(algorithm_));
    writer.put(space_.offset());
    writer.put(space_.scale());
    writer.put<std::uint64_t>(population_.size());
    for (std::size_t i = 0; i < population_.size(); ++i) {
      writer.put(population_.get_x()[i]);
      writer.put(population_.get_f()[i]);
    }
    return writer.bytes();
  }

  void restore(const std::string& memory) override {
    ByteReader reader(memory);
    algorithm_ = from_archive(reader.text());
    std::vector<double> offset = reader.doubles(), scale = reader.doubles();
    space_.set_scale(std::move(offset), std::move(scale));
    population_ = new_population();
    for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
      const std::vector<double> x = reader.doubles(), f = reader.doubles();
      population_.push_back(x, f);
    }
  }

 private:
  pagmo::population new_population() {
    return pagmo::population(pagmo::problem(PagmoProblem{&space_}), 0, options_.seed);
  }

  void after_generation() {
    Rows now = rows();
    if (options_.algorithm == SearchAlgorithm::moead && space_.scale().empty()) scale_objectives(now.outcomes);
    evaluator_.remember_only(std::move(now));
  }

  // Decomposition weighs objectives against each other, so their units must not decide. The scale is that of
  // the first population with two feasible designs or more, and then stays.
  void scale_objectives(std::span<const double> outcomes) {
    const std::size_t width = evaluator_.problem().outcome_size(), objectives = space_.objectives();
    std::vector<double> feasible;
    for (std::size_t at = 0; at < outcomes.size(); at += width) {
      if (!standing(outcomes.subspan(at, width), objectives).feasible()) continue;
      const std::span<const double> values = outcomes.subspan(at, objectives);
      feasible.insert(feasible.end(), values.begin(), values.end());
    }
    if (feasible.size() < 2 * objectives) return;
    const ObjectiveRange range = objective_range(feasible, objectives);
    std::vector<double> scale;
    for (std::size_t k = 0; k < objectives; ++k) {
      const double width_k = range.max[k] - range.min[k];
      scale.push_back(width_k > 0.0 && std::isfinite(width_k) ? 1.0 / width_k : 1.0);
    }
    space_.set_scale(range.min, scale);
    for (std::size_t i = 0; i < population_.size(); ++i) {
      population_.set_xf(i, std::vector<double>(population_.get_x()[i]),
                         space_.fitness_of(outcomes.subspan(i * width, width)));
    }
  }

  SearchOptions options_;
  Evaluator& evaluator_;
  PagmoSpace space_;
  pagmo::algorithm algorithm_;
  pagmo::population population_;
  tbb::task_arena alone_{1};
};

}  // namespace

std::unique_ptr<Engine> make_pagmo_engine(const SearchOptions& options, Evaluator& evaluator) {
  return std::make_unique<PagmoEngine>(options, evaluator);
}

}  // namespace zwidth::internal
