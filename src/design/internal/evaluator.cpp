#include "zwidth/design/internal/evaluator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "zwidth/design/pareto.h"

namespace zwidth::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Of the bits, so that a design is the same only if it is so to the last of them.
std::uint64_t hash_of(std::span<const double> design) {
  std::uint64_t hash = 0x9e3779b97f4a7c15;
  for (const double value : design) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0xff51afd7ed558ccd;
    hash ^= hash >> 32;
  }
  return hash;
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

Evaluator::Evaluator(const SearchProblem& problem) : problem_(problem) {
  record_.constraints.assign(problem.constraints.size(),
                             {.least_violation = std::numeric_limits<double>::infinity()});
}

void Evaluator::evaluate(std::span<const double> designs, std::span<double> outcomes) {
  if (designs.empty()) return;
  std::fill(outcomes.begin(), outcomes.end(), kNaN);
  const std::int64_t failures_before = record_.failures;
  const auto start = std::chrono::steady_clock::now();
  const auto take_time = [&] {
    record_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  try {
    if (!problem_.evaluate(designs, outcomes)) {
      take_time();
      throw Stopped();
    }
  } catch (const Stopped&) {
    throw;
  } catch (...) {
    try {
      evaluate_one_by_one(designs, outcomes);
    } catch (const Stopped&) {
      take_time();
      throw;
    }
  }
  take_time();

  const std::size_t width = problem_.outcome_size(), objectives = problem_.objectives.size();
  const std::size_t count = outcomes.size() / width;
  record_.evaluations += static_cast<std::int64_t>(count);
  const bool threw = record_.failures != failures_before;
  for (std::size_t row = 0; row < count; ++row) {
    const std::span<const double> values = outcomes.subspan(row * width, width);
    bool defined = true, broken = false;
    for (std::size_t c = 0; c < record_.constraints.size(); ++c) {
      ConstraintRecord& seen = record_.constraints[c];
      const double value = values[objectives + c];
      defined = defined && !std::isnan(value);
      broken = broken || value > 0.0;
      if (std::isnan(value)) {
        ++seen.undefined;
        continue;
      }
      if (value <= 0.0) ++seen.held;
      seen.least_violation = std::min(seen.least_violation, std::max(0.0, value));
    }
    if (!threw && defined && !broken && !standing(values, objectives).feasible()) ++record_.failures;
  }
}

void Evaluator::evaluate_one_by_one(std::span<const double> designs, std::span<double> outcomes) {
  const std::size_t variables = problem_.variables.size(), width = problem_.outcome_size();
  for (std::size_t row = 0; row < outcomes.size() / width; ++row) {
    const std::span<double> values = outcomes.subspan(row * width, width);
    std::fill(values.begin(), values.end(), kNaN);
    const auto failed = [&](const char* what) {
      std::fill(values.begin(), values.end(), kNaN);
      if (record_.failures++ == 0) record_.first_failure = what;
    };
    try {
      if (!problem_.evaluate(designs.subspan(row * variables, variables), values)) throw Stopped();
    } catch (const Stopped&) {
      throw;
    } catch (const std::exception& error) {
      failed(error.what());
    } catch (...) {
      failed("an exception that is no std::exception");
    }
  }
}

void Evaluator::evaluate_once(std::span<const double> designs, std::span<double> outcomes) {
  const std::size_t variables = problem_.variables.size(), width = problem_.outcome_size();
  const std::size_t count = outcomes.size() / width;
  const auto design = [&](std::size_t row) { return designs.subspan(row * variables, variables); };

  std::vector<std::size_t> asked;  // rows that nobody has seen yet
  std::vector<double> asked_designs;
  std::unordered_multimap<std::uint64_t, std::size_t> among;  // hash -> row asked
  for (std::size_t row = 0; row < count; ++row) {
    if (!find(design(row)).empty()) continue;
    const std::uint64_t hash = hash_of(design(row));
    const auto [first, last] = among.equal_range(hash);
    if (std::any_of(first, last,
                    [&](const auto& entry) { return same_bits(design(entry.second), design(row)); })) {
      continue;
    }
    among.emplace(hash, row);
    asked.push_back(row);
    asked_designs.insert(asked_designs.end(), design(row).begin(), design(row).end());
  }
  std::vector<double> answers(asked.size() * width);
  evaluate(asked_designs, answers);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    remember(design(asked[i]), std::span<const double>(answers).subspan(i * width, width));
  }
  for (std::size_t row = 0; row < count; ++row) {
    const std::span<const double> values = find(design(row));
    std::copy(values.begin(), values.end(), outcomes.begin() + static_cast<std::ptrdiff_t>(row * width));
  }
}

std::span<const double> Evaluator::find(std::span<const double> design) const {
  const std::size_t variables = problem_.variables.size(), width = problem_.outcome_size();
  const auto [first, last] = places_.equal_range(hash_of(design));
  for (auto entry = first; entry != last; ++entry) {
    const std::span<const double> known(remembered_.designs);
    if (same_bits(known.subspan(entry->second * variables, variables), design)) {
      return std::span<const double>(remembered_.outcomes).subspan(entry->second * width, width);
    }
  }
  return {};
}

void Evaluator::remember(std::span<const double> design, std::span<const double> outcomes) {
  places_.emplace(hash_of(design), remembered_.outcomes.size() / problem_.outcome_size());
  remembered_.designs.insert(remembered_.designs.end(), design.begin(), design.end());
  remembered_.outcomes.insert(remembered_.outcomes.end(), outcomes.begin(), outcomes.end());
}

void Evaluator::remember_only(Rows rows) {
  remembered_ = {};
  places_.clear();
  const std::size_t variables = problem_.variables.size(), width = problem_.outcome_size();
  for (std::size_t row = 0; row < rows.outcomes.size() / width; ++row) {
    const auto design = std::span<const double>(rows.designs).subspan(row * variables, variables);
    if (!find(design).empty()) continue;
    remember(design, std::span<const double>(rows.outcomes).subspan(row * width, width));
  }
}

}  // namespace zwidth::internal
