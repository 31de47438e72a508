#include <algorithm>
#include <optional>
#include <utility>

#include "zwidth/design/internal/bytes.h"
#include "zwidth/design/internal/engine.h"
#include "zwidth/design/pareto.h"

namespace zwidth::internal {
namespace {

/// All designs of a space of whole numbers, the last variable fastest, in batches. Keeps those that no other
/// constraint-dominates: the feasible front, or as long as nothing is feasible the first of the best standing.
class GridEngine final : public Engine {
 public:
  GridEngine(const SearchOptions& options, Evaluator& evaluator)
      : evaluator_(evaluator), batch_(std::max<std::int64_t>(options.population, 1000)) {
    for (const SearchVariable& variable : evaluator.problem().variables) {
      steps_.push_back(static_cast<std::int64_t>(variable.max - variable.min) + 1);
      size_ *= steps_.back();
    }
  }

  void start() override { step(); }

  void step() override {
    const SearchProblem& problem = evaluator_.problem();
    const std::size_t variables = problem.variables.size(), width = problem.outcome_size();
    const std::int64_t count = std::min(batch_, size_ - next_);
    Rows batch{std::vector<double>(static_cast<std::size_t>(count) * variables),
               std::vector<double>(static_cast<std::size_t>(count) * width)};
    for (std::int64_t row = 0; row < count; ++row) {
      std::int64_t rest = next_ + row;
      for (std::size_t v = variables; v-- > 0; rest /= steps_[v]) {
        batch.designs[static_cast<std::size_t>(row) * variables + v] =
            problem.variables[v].min + static_cast<double>(rest % steps_[v]);
      }
    }
    evaluator_.evaluate(batch.designs, batch.outcomes);
    next_ += count;
    keep_best_of(batch);
  }

  bool done() const override { return next_ == size_; }
  std::int64_t next_evaluations() const override { return std::min(batch_, size_ - next_); }
  Rows rows() const override { return best_; }

  std::string memory() const override {
    ByteWriter writer;
    writer.put(next_);
    writer.put(best_.designs);
    writer.put(best_.outcomes);
    return writer.bytes();
  }
  void restore(const std::string& memory) override {
    ByteReader reader(memory);
    next_ = reader.get<std::int64_t>();
    best_.designs = reader.doubles();
    best_.outcomes = reader.doubles();
  }

 private:
  void keep_best_of(const Rows& batch) {
    const SearchProblem& problem = evaluator_.problem();
    const std::size_t variables = problem.variables.size(), width = problem.outcome_size(),
                      objectives = problem.objectives.size();
    const auto add = [&](Rows& to, const Rows& from, std::size_t row) {
      const auto design = from.designs.begin() + static_cast<std::ptrdiff_t>(row * variables);
      const auto outcome = from.outcomes.begin() + static_cast<std::ptrdiff_t>(row * width);
      to.designs.insert(to.designs.end(), design, design + static_cast<std::ptrdiff_t>(variables));
      to.outcomes.insert(to.outcomes.end(), outcome, outcome + static_cast<std::ptrdiff_t>(width));
    };
    Rows candidates, least_broken;
    std::optional<Standing> least;
    std::vector<double> values;
    for (const Rows* rows : {&std::as_const(best_), &batch}) {
      for (std::size_t row = 0; row < rows->outcomes.size() / width; ++row) {
        const auto outcomes = std::span<const double>(rows->outcomes).subspan(row * width, width);
        const Standing place = standing(outcomes, objectives);
        if (place.feasible()) {
          add(candidates, *rows, row);
          values.insert(values.end(), outcomes.begin(),
                        outcomes.begin() + static_cast<std::ptrdiff_t>(objectives));
        } else if (!least || place.better_than(*least)) {
          least = place;
          least_broken = {};
          add(least_broken, *rows, row);
        }
      }
    }
    if (candidates.designs.empty()) {
      best_ = std::move(least_broken);
      return;
    }
    best_ = {};
    for (const std::size_t row : non_dominated(values, objectives)) add(best_, candidates, row);
  }

  Evaluator& evaluator_;
  std::int64_t batch_;
  std::vector<std::int64_t> steps_;  // values of each variable
  std::int64_t size_ = 1;
  std::int64_t next_ = 0;  // first design that was not seen yet
  Rows best_;
};

}  // namespace

std::unique_ptr<Engine> make_grid_engine(const SearchOptions& options, Evaluator& evaluator) {
  return std::make_unique<GridEngine>(options, evaluator);
}

}  // namespace zwidth::internal
