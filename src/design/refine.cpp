#include "zwidth/design/refine.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <nlopt.h>
#include <stdexcept>

#include "zwidth/design/internal/evaluator.h"
#include "zwidth/design/pareto.h"

namespace zwidth {
namespace {

constexpr double kAugmentation = 1e-3;
constexpr double kDifference = 1e-6;  // step of finite differences, as a share of a variable's range
constexpr double kBroken = 1e30;      // of a design that is not feasible, for methods that go by order alone
constexpr double kUndefined = 1e140;

void check(const SearchProblem& problem, std::span<const double> start, const RefineOptions& options) {
  const std::size_t objectives = problem.objectives.size();
  const auto fail = [](const std::string& what) { throw std::invalid_argument(what); };
  if (objectives == 0) fail("there are no objectives");
  if (!problem.evaluate) fail("there is nothing to evaluate designs with");
  if (start.size() != problem.variables.size()) {
    fail(fmt::format("a design has {} values, not {}", problem.variables.size(), start.size()));
  }
  for (std::size_t v = 0; v < start.size(); ++v) {
    const SearchVariable& variable = problem.variables[v];
    if (start[v] >= variable.min && start[v] <= variable.max) continue;
    fail(fmt::format("'{}' = {} is not in [{}, {}]", variable.name, start[v], variable.min, variable.max));
  }
  if (!options.weights.empty() && options.weights.size() != objectives) {
    fail(fmt::format("{} objectives need as many weights, not {}", objectives, options.weights.size()));
  }
  for (const double weight : options.weights) {
    if (!(weight > 0.0) || !std::isfinite(weight)) fail("weights must be positive");
  }
  if (options.ideal.size() != options.nadir.size() ||
      (!options.ideal.empty() && options.ideal.size() != objectives)) {
    fail("ideal and nadir need a value per objective");
  }
  if (options.evaluations < 1) fail("a local search needs evaluations");
  if (!(options.tolerance > 0.0) || !(options.first_step > 0.0) || options.first_step > 1.0) {
    fail("tolerance and first step must be positive shares of the ranges");
  }
}

/// The problem as NLopt sees it: the free variables as shares of their ranges, one number to minimise. Several
/// objectives have a last variable t for methods that build models: minimise t with w_k p_k <= t, which is
/// smooth where the largest of them is not.
class Local {
 public:
  Local(const SearchProblem& problem, std::span<const double> start, const RefineOptions& options)
      : problem_(problem), options_(options), evaluator_(problem), base_(start.begin(), start.end()) {
    for (std::size_t v = 0; v < start.size(); ++v) {
      const SearchVariable& variable = problem.variables[v];
      if (!variable.integer && variable.min < variable.max) free_.push_back(v);
    }
    best_ = base_;
    best_outcomes_.resize(problem.outcome_size());
    evaluator_.evaluate(base_, best_outcomes_);
    best_standing_ = standing(best_outcomes_, objectives());
    set_weights();
    best_value_ = best_standing_.feasible() ? compromise(best_outcomes_) : kBroken;
    worst_value_ = best_standing_.feasible() ? best_value_ : 1.0;
    epigraph_ = objectives() > 1 && options.method != RefineMethod::sbplx;
  }

  Refinement run() {
    Refinement result;
    const Standing before = best_standing_;
    const double value_before = best_value_;
    if (free_.empty()) {
      result.reason = "no variable is free to move";
    } else {
      // Models go astray where figures are undefined; another start from the best so far sets them right.
      constexpr double kWorthAnotherStart = 1e-6;
      for (;;) {
        const Standing standing_before = best_standing_;
        const double value_at_start = best_value_;
        result.reason = minimise();
        const bool far = best_standing_.better_than(standing_before) ||
                         value_at_start - best_value_ > kWorthAnotherStart * (1e-3 + std::abs(value_at_start));
        if (stopped_ || !far || evaluator_.record().evaluations >= options_.evaluations) break;
      }
    }
    result.stopped = stopped_;
    result.improved = best_standing_.better_than(before) ||
                      (best_standing_.feasible() && before.feasible() && best_value_ < value_before);
    result.design = best_;
    result.outcomes = best_outcomes_;
    result.evaluations = evaluator_.record().evaluations;
    return result;
  }

 private:
  std::size_t objectives() const { return problem_.objectives.size(); }
  std::size_t constraints() const { return problem_.constraints.size(); }

  void set_weights() {
    for (std::size_t k = 0; k < objectives(); ++k) {
      const double width = options_.ideal.empty() ? 1.0 : options_.nadir[k] - options_.ideal[k];
      ideal_.push_back(options_.ideal.empty() ? 0.0 : options_.ideal[k]);
      scale_.push_back(width > 0.0 ? 1.0 / width : 1.0);
    }
    weights_ = options_.weights;
    if (!weights_.empty()) return;
    weights_.assign(objectives(), 1.0);
    if (best_standing_.feasible()) ideal_ = best_outcomes_;
    augmentation_ = 0.0;
  }

  // w_k p_k. Without weights measured from the start, so that the largest is negative only if all improve.
  double term(std::span<const double> outcomes, std::size_t k) const {
    return weights_[k] * (outcomes[k] - ideal_[k]) * scale_[k];
  }

  double compromise(std::span<const double> outcomes) const {
    if (objectives() == 1) return outcomes[0] * scale_[0];
    double largest = -std::numeric_limits<double>::infinity(), sum = 0.0;
    for (std::size_t k = 0; k < objectives(); ++k) {
      largest = std::max(largest, term(outcomes, k));
      sum += term(outcomes, k);
    }
    return largest + augmentation_ * sum;
  }

  void decode(const double* x, std::span<double> design) const {
    std::copy(base_.begin(), base_.end(), design.begin());
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const SearchVariable& variable = problem_.variables[free_[i]];
      const double share = x[i] > 0.0 ? std::min(x[i], 1.0) : 0.0;
      design[free_[i]] =
          std::clamp(variable.min + share * (variable.max - variable.min), variable.min, variable.max);
    }
  }

  void take_if_better(std::span<const double> design, std::span<const double> outcomes) {
    const Standing place = standing(outcomes, objectives());
    const double value = place.feasible() ? compromise(outcomes) : kBroken;
    const bool better =
        place.feasible() && best_standing_.feasible() ? value < best_value_ : place.better_than(best_standing_);
    if (place.feasible()) worst_value_ = std::max(worst_value_, value);
    if (!better) return;
    best_.assign(design.begin(), design.end());
    best_outcomes_.assign(outcomes.begin(), outcomes.end());
    best_standing_ = place;
    best_value_ = value;
  }

  // Outcomes at x, and with `differences` at a step along each variable, row after row in `rows_`.
  void evaluate(const double* x, bool differences) {
    const std::size_t variables = base_.size(), width = problem_.outcome_size();
    const std::size_t count = differences ? free_.size() + 1 : 1;
    if (x_ == std::vector<double>(x, x + free_.size()) && rows_.size() >= count * width) return;
    x_.assign(x, x + free_.size());
    std::vector<double> designs(count * variables), at = x_;
    steps_.assign(free_.size(), kDifference);
    decode(at.data(), std::span<double>(designs).first(variables));
    for (std::size_t i = 0; i + 1 < count; ++i) {
      if (at[i] > 0.5) steps_[i] = -kDifference;  // away from the bound
      at[i] += steps_[i];
      decode(at.data(), std::span<double>(designs).subspan((i + 1) * variables, variables));
      at[i] = x_[i];
    }
    rows_.assign(count * width, 0.0);
    evaluator_.evaluate(designs, rows_);
    for (std::size_t row = 0; row < count; ++row) {
      take_if_better(std::span<const double>(designs).subspan(row * variables, variables), row_at(row));
    }
  }
  std::span<const double> row_at(std::size_t row) const {
    return std::span<const double>(rows_).subspan(row * problem_.outcome_size(), problem_.outcome_size());
  }

  // A finite number for what may be undefined: where constraints are broken, of which the method knows, that of
  // the best so far, elsewhere one that is no better than any.
  double defined(double value, double of_best, std::size_t row) const {
    if (!std::isnan(value)) return value;
    const Standing place = standing(row_at(row), objectives());
    return place.undefined == 0 && best_standing_.feasible() ? of_best : worst_value_ + 1.0;
  }
  double objective_at(std::size_t row) const {
    if (options_.method == RefineMethod::sbplx) {
      const Standing place = standing(row_at(row), objectives());
      if (place.undefined > 0) return kUndefined * static_cast<double>(place.undefined);
      if (!place.feasible()) return kBroken * (1.0 + place.violation / (1.0 + place.violation));
    }
    return defined(compromise(row_at(row)), best_value_, row);
  }
  double constraint_at(std::size_t row, std::size_t c) const {
    if (c < constraints()) {
      const double value = row_at(row)[objectives() + c];
      return std::isnan(value) ? 1.0 : std::clamp(value, -1e6, 1e6);
    }
    const auto of = [&](std::span<const double> outcomes) {
      double sum = 0.0;
      for (std::size_t k = 0; k < objectives(); ++k) sum += term(outcomes, k);
      return term(outcomes, c - constraints()) + augmentation_ * sum;
    };
    return defined(of(row_at(row)), of(best_outcomes_), row);
  }

  // The slope of a quantity along each free variable, 0 where it is not defined.
  template <class Quantity>
  void slopes(const Quantity& quantity, double* gradient) const {
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const double slope = (quantity(i + 1) - quantity(0)) / steps_[i];
      gradient[i] = std::isfinite(slope) ? slope : 0.0;
    }
  }

  double objective(const double* x, double* gradient) {
    if (epigraph_) {
      if (gradient != nullptr) {
        std::fill(gradient, gradient + free_.size(), 0.0);
        gradient[free_.size()] = 1.0;
      }
      return x[free_.size()];
    }
    evaluate(x, gradient != nullptr);
    if (gradient != nullptr) slopes([&](std::size_t row) { return objective_at(row); }, gradient);
    return objective_at(0);
  }

  void constrain(unsigned count, double* values, const double* x, double* gradient) {
    evaluate(x, gradient != nullptr);
    const std::size_t width = free_.size() + (epigraph_ ? 1 : 0);
    for (std::size_t c = 0; c < count; ++c) {
      const bool bound_on_t = c >= constraints();
      values[c] = constraint_at(0, c) - (bound_on_t ? x[free_.size()] : 0.0);
      if (gradient == nullptr) continue;
      slopes([&](std::size_t row) { return constraint_at(row, c); }, gradient + c * width);
      if (epigraph_) gradient[c * width + free_.size()] = bound_on_t ? -1.0 : 0.0;
    }
  }

  // Exceptions must not pass through NLopt, which is C.
  template <class Work>
  double guarded(const Work& work) {
    try {
      if (!stopped_) return work();
    } catch (const internal::Stopped&) {
      stopped_ = true;
    }
    nlopt_force_stop(nlopt_);
    return kUndefined;
  }

  std::string minimise() {
    const std::size_t width = free_.size() + (epigraph_ ? 1 : 0);
    const nlopt_algorithm algorithm = options_.method == RefineMethod::cobyla  ? NLOPT_LN_COBYLA
                                      : options_.method == RefineMethod::slsqp ? NLOPT_LD_SLSQP
                                                                               : NLOPT_LN_SBPLX;
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> owner(
        nlopt_create(algorithm, static_cast<unsigned>(width)), &nlopt_destroy);
    nlopt_ = owner.get();
    std::vector<double> lower(width, 0.0), upper(width, 1.0), x(width, 0.0), step(width, options_.first_step);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const SearchVariable& variable = problem_.variables[free_[i]];
      x[i] = (best_[free_[i]] - variable.min) / (variable.max - variable.min);
    }
    if (epigraph_) {
      x.back() = best_standing_.feasible() ? best_value_ : 1.0;
      lower.back() = -std::numeric_limits<double>::infinity();
      upper.back() = std::numeric_limits<double>::infinity();
    }
    nlopt_set_lower_bounds(nlopt_, lower.data());
    nlopt_set_upper_bounds(nlopt_, upper.data());
    nlopt_set_initial_step(nlopt_, step.data());
    nlopt_set_xtol_abs1(nlopt_, options_.tolerance);
    const std::int64_t left = options_.evaluations - evaluator_.record().evaluations;
    // NLopt counts calls; with differences, each is as many evaluations as there are variables and one.
    const auto each = options_.method == RefineMethod::slsqp ? static_cast<std::int64_t>(free_.size()) + 1 : 1;
    nlopt_set_maxeval(nlopt_, static_cast<int>(std::clamp<std::int64_t>(left / each, 1, 1'000'000'000)));
    nlopt_set_min_objective(
        nlopt_,
        [](unsigned, const double* at, double* gradient, void* self) {
          auto* local = static_cast<Local*>(self);
          return local->guarded([&] { return local->objective(at, gradient); });
        },
        this);
    const std::size_t count = constraints() + (epigraph_ ? objectives() : 0);
    if (options_.method != RefineMethod::sbplx && count > 0) {
      const std::vector<double> tolerances(count, 0.0);
      nlopt_add_inequality_mconstraint(
          nlopt_, static_cast<unsigned>(count),
          [](unsigned m, double* values, unsigned, const double* at, double* gradient, void* self) {
            auto* local = static_cast<Local*>(self);
            local->guarded([&] {
              local->constrain(m, values, at, gradient);
              return 0.0;
            });
          },
          this, tolerances.data());
    }
    double value = 0.0;
    const nlopt_result end = nlopt_optimize(nlopt_, x.data(), &value);
    nlopt_ = nullptr;
    return words(end);
  }

  std::string words(nlopt_result end) const {
    switch (end) {
      case NLOPT_XTOL_REACHED:
      case NLOPT_FTOL_REACHED:
      case NLOPT_STOPVAL_REACHED:
      case NLOPT_SUCCESS:
        return "converged";
      case NLOPT_MAXEVAL_REACHED:
        return "budget of evaluations used up";
      case NLOPT_ROUNDOFF_LIMITED:
        return "rounding allows no more";
      case NLOPT_FORCED_STOP:
        return "stopped";
      default:
        return fmt::format("{} gave up: {}", to_string(options_.method), nlopt_result_to_string(end));
    }
  }

  const SearchProblem& problem_;
  const RefineOptions& options_;
  internal::Evaluator evaluator_;
  std::vector<double> base_;       // the start
  std::vector<std::size_t> free_;  // variables that may move
  std::vector<double> ideal_, scale_, weights_;
  double augmentation_ = kAugmentation;
  bool epigraph_ = false;
  // The best so far.
  std::vector<double> best_, best_outcomes_;
  Standing best_standing_;
  double best_value_ = 0.0;
  double worst_value_ = 0.0;  // largest compromise of a feasible design
  // The point evaluated last.
  std::vector<double> x_, rows_, steps_;
  nlopt_opt nlopt_ = nullptr;
  bool stopped_ = false;
};

}  // namespace

std::optional<RefineMethod> refine_method(std::string_view name) {
  for (const RefineMethod method : {RefineMethod::cobyla, RefineMethod::slsqp, RefineMethod::sbplx}) {
    if (to_string(method) == name) return method;
  }
  return std::nullopt;
}

std::string_view to_string(RefineMethod method) {
  switch (method) {
    case RefineMethod::cobyla:
      return "cobyla";
    case RefineMethod::slsqp:
      return "slsqp";
    case RefineMethod::sbplx:
      return "sbplx";
  }
  return "";
}

Refinement refine(const SearchProblem& problem, std::span<const double> start, const RefineOptions& options) {
  check(problem, start, options);
  try {
    return Local(problem, start, options).run();
  } catch (const internal::Stopped&) {
    // Told to stop before the start itself was evaluated.
    return {.stopped = true,
            .design = {start.begin(), start.end()},
            .outcomes = std::vector<double>(problem.outcome_size(), std::numeric_limits<double>::quiet_NaN()),
            .reason = "stopped"};
  }
}

}  // namespace zwidth
