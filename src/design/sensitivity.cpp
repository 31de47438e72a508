#include "zwidth/design/sensitivity.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace zwidth {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kConfidence = 1.959963984540054;  // of 95 %, in standard deviations
constexpr std::size_t kBatch = 1024;               // samples at a time, so that a stop comes soon

// A number that is spread evenly over 0..1, ends excluded, for each triple: SplitMix64 (Steele, Lea & Flood
// 2014).
double uniform(std::uint64_t seed, std::uint64_t sample, std::uint64_t draw) {
  const auto mix = [](std::uint64_t z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  return (static_cast<double>(mix(mix(mix(seed) ^ sample) ^ draw) >> 11) + 0.5) * 0x1p-53;
}

// Deviation of sample `sample` along variable `variable`, in units of the tolerance's size.
double unit_deviation(Tolerance::Spread spread, std::uint64_t seed, std::uint64_t sample,
                      std::uint64_t variable) {
  const double u = uniform(seed, sample, 2 * variable);
  if (spread == Tolerance::Spread::uniform) return 2.0 * u - 1.0;
  const double v = uniform(seed, sample, 2 * variable + 1);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);  // Box & Muller 1958
}

// Of sorted values, with the interval of the order statistics about it.
Estimate percentile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return {kNaN, kNaN, kNaN};
  const double n = static_cast<double>(sorted.size());
  const double place = share * (n - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  const double width = kConfidence * std::sqrt(n * share * (1.0 - share));
  const auto at = [&](double rank) { return sorted[static_cast<std::size_t>(std::clamp(rank, 0.0, n - 1.0))]; };
  return {sorted[below] + part * (sorted[above] - sorted[below]), at(std::floor(n * share - width) - 1.0),
          at(std::ceil(n * share + width))};
}

Estimate share_of(std::int64_t hits, std::int64_t samples) {
  const double n = static_cast<double>(samples), p = static_cast<double>(hits) / n;
  const double z2 = kConfidence * kConfidence;
  const double centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double width = kConfidence / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
  // The ends themselves, free of rounding.
  return {p, hits == 0 ? 0.0 : std::max(0.0, centre - width),
          hits == samples ? 1.0 : std::min(1.0, centre + width)};
}

OutcomeSpread spread_of(std::vector<double> values, std::int64_t samples) {
  OutcomeSpread spread;
  std::erase_if(values, [](double value) { return std::isnan(value); });
  spread.undefined = samples - static_cast<std::int64_t>(values.size());
  const double n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = n > 0.0 ? sum / n : kNaN;
  for (const double value : values) squares += (value - mean) * (value - mean);
  spread.standard_deviation = n > 1.0 ? std::sqrt(squares / (n - 1.0)) : kNaN;
  const double width = kConfidence * spread.standard_deviation / std::sqrt(n);
  spread.mean = {mean, mean - width, mean + width};
  std::sort(values.begin(), values.end());
  spread.percentile_5 = percentile(values, 0.05);
  spread.median = percentile(values, 0.5);
  spread.percentile_95 = percentile(values, 0.95);
  return spread;
}

}  // namespace

Sensitivity sensitivity(const BatchEvaluation& evaluate, std::span<const double> design,
                        std::span<const double> steps, std::size_t outcomes) {
  const std::size_t variables = design.size();
  assert(steps.size() == variables && outcomes > 0);
  std::vector<double> designs(design.begin(), design.end());  // then two rows per variable, + and -
  for (std::size_t v = 0; v < variables; ++v) {
    assert(steps[v] > 0.0);
    for (const double sign : {1.0, -1.0}) {
      designs.insert(designs.end(), design.begin(), design.end());
      designs[designs.size() - variables + v] += sign * steps[v];
    }
  }
  std::vector<double> values((2 * variables + 1) * outcomes, kNaN);
  Sensitivity result;
  result.complete = evaluate(designs, values);
  result.nominal.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(outcomes));
  result.slope.resize(outcomes * variables);
  result.bend.resize(outcomes * variables);
  for (std::size_t v = 0; v < variables; ++v) {
    for (std::size_t o = 0; o < outcomes; ++o) {
      // The steps that were really taken, after rounding.
      const double ahead = designs[(2 * v + 1) * variables + v] - design[v];
      const double back = design[v] - designs[(2 * v + 2) * variables + v];
      const double here = result.nominal[o];
      const double rise = values[(2 * v + 1) * outcomes + o] - here;
      const double fall = here - values[(2 * v + 2) * outcomes + o];
      double& slope = result.slope[o * variables + v];
      double& bend = result.bend[o * variables + v];
      bend = kNaN;
      if (!std::isnan(rise) && !std::isnan(fall)) {
        slope = (rise + fall) / (ahead + back);
        if (rise + fall != 0.0) bend = std::abs(rise - fall) / std::abs(rise + fall);
      } else {
        slope = std::isnan(rise) ? fall / back : rise / ahead;
      }
    }
  }
  return result;
}

LinearSpread linear_spread(std::span<const double> slope, std::span<const double> size) {
  const std::size_t variables = size.size();
  assert(variables > 0 && variables <= 24 && slope.size() % variables == 0);
  const std::size_t outcomes = slope.size() / variables;
  LinearSpread spread;
  std::vector<double> error(outcomes);
  for (std::size_t o = 0; o < outcomes; ++o) {
    double variance = 0.0;
    for (std::size_t v = 0; v < variables; ++v) variance += std::pow(slope[o * variables + v] * size[v], 2);
    spread.deviation.push_back(std::sqrt(variance));
  }
  // Corners in the order of Gray's code, each one sign away from the last.
  std::vector<double> sign(variables, 1.0);
  for (std::size_t o = 0; o < outcomes; ++o) {
    for (std::size_t v = 0; v < variables; ++v) error[o] += slope[o * variables + v] * size[v];
  }
  for (std::uint32_t corner = 0;;) {
    double squares = 0.0;
    for (const double value : error) squares += value * value;
    if (corner == 0 || std::sqrt(squares) > spread.worst) {
      spread.worst = std::sqrt(squares);
      spread.worst_sign = sign;
    }
    if (++corner == 1u << (variables - 1)) break;
    const std::size_t v = 1 + static_cast<std::size_t>(std::countr_zero(corner));
    sign[v] = -sign[v];
    for (std::size_t o = 0; o < outcomes; ++o) error[o] += 2.0 * sign[v] * slope[o * variables + v] * size[v];
  }
  return spread;
}

double Tolerance::deviation(double nominal) const {
  const double absolute = relative ? size * std::abs(nominal) : size;
  return spread == Spread::uniform ? absolute / std::numbers::sqrt3 : absolute;
}

ToleranceStudy tolerance_study(const BatchEvaluation& evaluate, std::span<const double> design,
                               std::span<const Tolerance> tolerances, std::size_t outcomes,
                               const ToleranceOptions& options) {
  const std::size_t variables = design.size();
  assert(tolerances.size() == variables && outcomes > 0 && options.samples > 0);
  assert(options.constraints <= outcomes);
  ToleranceStudy study{.samples = options.samples};

  // Slopes over a standard deviation, along the variables that have one.
  std::vector<double> deviations, steps;
  for (std::size_t v = 0; v < variables; ++v) {
    assert(tolerances[v].size >= 0.0);
    deviations.push_back(tolerances[v].deviation(design[v]));
    steps.push_back(deviations[v] > 0.0 ? deviations[v] : std::max(std::abs(design[v]), 1.0) * 1e-6);
  }
  const Sensitivity slopes = sensitivity(evaluate, design, steps, outcomes);
  study.complete = slopes.complete;

  std::vector<std::vector<double>> values(outcomes);
  std::vector<std::int64_t> broken_by(options.constraints, 0);
  std::int64_t broken = 0;
  std::vector<double> designs, rows;
  for (std::int64_t first = 0; first < options.samples && study.complete; first += kBatch) {
    const auto count = static_cast<std::size_t>(std::min<std::int64_t>(kBatch, options.samples - first));
    designs.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const auto sample = static_cast<std::uint64_t>(first) + i;
      for (std::size_t v = 0; v < variables; ++v) {
        const Tolerance& tolerance = tolerances[v];
        const double size = tolerance.relative ? tolerance.size * std::abs(design[v]) : tolerance.size;
        designs.push_back(size > 0.0
                              ? design[v] + size * unit_deviation(tolerance.spread, options.seed, sample, v)
                              : design[v]);
      }
    }
    rows.assign(count * outcomes, kNaN);
    study.complete = evaluate(designs, rows);
    for (std::size_t i = 0; i < count; ++i) {
      bool any = false;
      for (std::size_t o = 0; o < outcomes; ++o) {
        const double value = rows[i * outcomes + o];
        values[o].push_back(value);
        if (o + options.constraints < outcomes || value <= 0.0) continue;
        ++broken_by[o + options.constraints - outcomes];
        any = true;
      }
      broken += any ? 1 : 0;
    }
  }
  if (!study.complete) return study;

  for (std::size_t o = 0; o < outcomes; ++o) {
    OutcomeSpread spread = spread_of(std::move(values[o]), options.samples);
    spread.nominal = slopes.nominal[o];
    double variance = 0.0;
    for (std::size_t v = 0; v < variables; ++v) {
      if (deviations[v] > 0.0) variance += std::pow(slopes.slope[o * variables + v] * deviations[v], 2);
    }
    spread.linear_deviation = std::sqrt(variance);
    study.outcomes.push_back(spread);
  }
  study.broken = share_of(broken, options.samples);
  for (const std::int64_t hits : broken_by) {
    study.broken_by.push_back(static_cast<double>(hits) / static_cast<double>(options.samples));
  }
  return study;
}

}  // namespace zwidth
