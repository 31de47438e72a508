#include "zwidth/analysis/dexterity.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

double conditioning(const Jacobian& jacobian) {
  // Of a tool with fewer freedoms than rows, over those that it has.
  const SmallVector sigma = svd(jacobian).sigma;
  return sigma[0] > 0.0 ? sigma[sigma.size() - 1] / sigma[0] : 0.0;
}

double mean_conditioning(std::span<const Jacobian> jacobians, const JacobianUnits& units, double length) {
  double sum = 0.0;
  for (const Jacobian& jacobian : jacobians) sum += conditioning(homogeneous(jacobian, units, length));
  return sum / static_cast<double>(jacobians.size());
}

}  // namespace

bool JacobianUnits::homogeneous(const Jacobian& jacobian) const {
  const int n = static_cast<int>(jacobian.cols());
  int sliding = 0;
  for (int j = 0; j < n; ++j) sliding += slides(j) ? 1 : 0;
  const bool rows_alike = linear_rows == jacobian.rows() || linear_rows == 0;
  return rows_alike && (sliding == 0 || sliding == n);
}

JacobianUnits jacobian_units(const Mechanism& mechanism) {
  JacobianUnits units{.linear_rows = mechanism.linear_rows()};
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(i))].type == JointType::prismatic) {
      units.sliding_joints |= 1U << i;
    }
  }
  return units;
}

Jacobian homogeneous(const Jacobian& jacobian, const JacobianUnits& units, double length) {
  assert(length > 0.0 && units.linear_rows <= jacobian.rows());
  Jacobian result = jacobian;
  result.bottomRows(jacobian.rows() - units.linear_rows) *= length;
  for (int j = 0; j < jacobian.cols(); ++j) {
    if (units.slides(j)) result.col(j) *= length;
  }
  return result;
}

CharacteristicLength characteristic_length(const Jacobian& jacobian, const JacobianUnits& units) {
  return characteristic_length(std::span(&jacobian, 1), units);
}

CharacteristicLength characteristic_length(std::span<const Jacobian> jacobians, const JacobianUnits& units) {
  assert(!jacobians.empty());
  const auto result_at = [&](double length) {
    const double figure = mean_conditioning(jacobians, units, length);
    return CharacteristicLength{length, figure, 1.0 / figure};
  };
  const bool alike =
      std::all_of(jacobians.begin(), jacobians.end(), [&](const Jacobian& J) { return units.homogeneous(J); });
  if (alike) return result_at(1.0);
  // Around the ratio of the sizes of the two kinds of entries. Of one Jacobian the logarithm of the condition
  // number is convex in that of the length (three-lines theorem), so a raster brackets the one minimum; of
  // several it finds the best valley.
  double linear = 0.0, angular = 0.0;
  for (const Jacobian& J : jacobians) {
    linear += J.topRows(units.linear_rows).squaredNorm();
    angular += J.bottomRows(J.rows() - units.linear_rows).squaredNorm();
  }
  const double middle = linear > 0.0 && angular > 0.0 ? 0.5 * std::log(linear / angular) : 0.0;
  const double step = 0.1 * std::log(10.0);
  const auto at = [&](double log_length) { return mean_conditioning(jacobians, units, std::exp(log_length)); };
  int best = 0, first = 0, last = -1;
  double best_value = -1.0;
  const auto look_at = [&](int k) {
    const double value = at(middle + step * k);
    if (value > best_value) {
      best_value = value;
      best = k;
    }
  };
  // Farther only while the best lies near an end of what was looked at.
  constexpr int kMost = 60, kFurther = 10;
  do {
    for (int k = first - kFurther; k < first; ++k) look_at(k);
    for (int k = last + 1; k <= last + kFurther; ++k) look_at(k);
    first -= kFurther;
    last += kFurther;
  } while (last < kMost && (best - first < kFurther / 2 || last - best < kFurther / 2));
  if (!(best_value > 0.0)) return result_at(1.0);
  // Golden section within the neighbours.
  double low = middle + step * (best - 1), high = low + 2.0 * step;
  constexpr double kGolden = 0.61803398874989485;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = at(left), at_right = at(right);
  while (high - low > 1e-9) {
    if (at_left >= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = at(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = at(right);
    }
  }
  return result_at(std::exp(0.5 * (low + high)));
}

Jacobian JacobianScale::homogeneous_rows(const Jacobian& rows) const {
  JacobianUnits of_one_kind = units;
  of_one_kind.linear_rows = static_cast<int>(rows.rows());
  return zwidth::homogeneous(rows, of_one_kind, length);
}

namespace {

// Over as many singular values as there are freedoms.
double condition_over_freedoms(const Jacobian& jacobian) {
  constexpr double kRounding = 1e-13;
  const SmallVector sigma = svd(jacobian).sigma;
  const double least = sigma[sigma.size() - 1];
  return least > kRounding * sigma[0] ? sigma[0] / least : std::numeric_limits<double>::infinity();
}

// Active joints of sample `index`, the joints that the hand moves at home.
ActiveVector driven_posture(const Mechanism& mechanism, std::int64_t index) {
  std::vector<int> driven;
  ActiveVector joints(mechanism.active_count());
  for (int j = 0; j < mechanism.active_count(); ++j) {
    joints[j] = mechanism.home_guess()[mechanism.active_joint(j)];
    if (!mechanism.is_free(j)) driven.push_back(j);
  }
  const int n = static_cast<int>(driven.size());
  for (int k = 0; k < n; ++k) {
    const int j = driven[static_cast<std::size_t>(k)];
    Interval range = mechanism.active_range(j);
    if (!(range.width() < 1e3)) {
      const bool slides =
          mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(j))].type == JointType::prismatic;
      const double far = slides ? mechanism.characteristic_length() : std::numbers::pi;
      range = {joints[j] - far, joints[j] + far};
    }
    joints[j] = range.min + range.width() * spread_coordinate(n, k, index);
  }
  return joints;
}

}  // namespace

double JacobianScale::condition_number(const Jacobian& tool) const {
  return condition_over_freedoms(homogeneous(tool));
}

double JacobianScale::rows_condition_number(const Jacobian& rows) const {
  return condition_over_freedoms(homogeneous_rows(rows));
}

JacobianScale jacobian_scale(const Mechanism& mechanism) {
  JacobianScale scale{.units = jacobian_units(mechanism)};
  scale.mixed = !scale.units.homogeneous(Jacobian::Zero(mechanism.tool_rows(), mechanism.active_count()));
  if (!scale.mixed) return scale;
  constexpr std::int64_t kTries = 512;
  constexpr std::size_t kEnough = 64;
  ActiveVector home(mechanism.active_count());
  for (int j = 0; j < home.size(); ++j) home[j] = mechanism.home_guess()[mechanism.active_joint(j)];
  const Solution start = solve_forward(mechanism, home);
  const SolveOptions follow{.start = start ? &*start.posture : nullptr, .restart = false, .max_iterations = 60};
  std::vector<Jacobian> jacobians;
  for (std::int64_t index = 0; index < kTries && jacobians.size() < kEnough; ++index) {
    const Solution solution = solve_forward(mechanism, driven_posture(mechanism, index), follow);
    if (solution && solution.status != SolveStatus::joint_limit)
      jacobians.push_back(jacobian(*solution.posture));
  }
  if (jacobians.empty() && start) jacobians.push_back(jacobian(*start.posture));
  scale.length = mechanism.characteristic_length();
  if (jacobians.empty()) return scale;
  const CharacteristicLength found = characteristic_length(jacobians, scale.units);
  if (found.conditioning > 0.0) scale.length = found.length;
  return scale;
}

double isotropy(const Jacobian& jacobian) {
  const SmallVector sigma = svd(jacobian).sigma;
  const auto m = sigma.size();
  const double mean = sigma.squaredNorm() / static_cast<double>(m);
  if (!(sigma[m - 1] > 0.0)) return 0.0;
  double logarithms = 0.0;
  for (const double value : sigma) logarithms += 2.0 * std::log(value);
  return std::min(1.0, std::exp(logarithms / static_cast<double>(m)) / mean);
}

void GlobalConditioning::add(double condition_number, double weight) {
  assert(condition_number >= 1.0 && weight >= 0.0);
  const double value = std::isfinite(condition_number) ? 1.0 / condition_number : 0.0;
  worst_ = std::min(worst_, value);
  best_ = std::max(best_, value);
  if (weight == 0.0) return;
  // Updated as it goes (West 1979), so that a small spread survives many samples.
  weight_ += weight;
  class_weight_[static_cast<std::size_t>(condition_class(condition_number))] += weight;
  if (condition_number < kNearIsotropic) near_weight_ += weight;
  const double gap = value - mean_;
  mean_ += gap * weight / weight_;
  squares_ += weight * gap * (value - mean_);
}

void GlobalConditioning::add(const GlobalConditioning& other) {
  worst_ = std::min(worst_, other.worst_);
  best_ = std::max(best_, other.best_);
  if (other.weight_ == 0.0) return;
  const double gap = other.mean_ - mean_, total = weight_ + other.weight_;
  squares_ += other.squares_ + gap * gap * weight_ * other.weight_ / total;
  mean_ += gap * other.weight_ / total;
  weight_ = total;
  near_weight_ += other.near_weight_;
  for (std::size_t k = 0; k < class_weight_.size(); ++k) class_weight_[k] += other.class_weight_[k];
}

double GlobalConditioning::index() const {
  return mean_;
}

double GlobalConditioning::spread() const {
  return weight_ > 0.0 ? std::sqrt(std::max(0.0, squares_ / weight_)) : 0.0;
}

double GlobalConditioning::near_isotropic() const {
  return weight_ > 0.0 ? near_weight_ / weight_ : 0.0;
}

double GlobalConditioning::share(ConditionClass condition_class) const {
  return weight_ > 0.0 ? class_weight_[static_cast<std::size_t>(condition_class)] / weight_ : 0.0;
}

double task_volume(const Jacobian& jacobian) {
  return dexterity(jacobian).manipulability;
}

ConditionClass condition_class(double condition_number) {
  if (condition_number < 5.0) return ConditionClass::below_5;
  if (condition_number <= 10.0) return ConditionClass::from_5_to_10;
  return condition_number <= 100.0 ? ConditionClass::from_10_to_100 : ConditionClass::above_100;
}

const char* to_string(ConditionClass condition_class) {
  switch (condition_class) {
    case ConditionClass::below_5:
      return "K < 5";
    case ConditionClass::from_5_to_10:
      return "5 to 10";
    case ConditionClass::from_10_to_100:
      return "10 to 100";
    case ConditionClass::above_100:
      return "K > 100";
  }
  return "";
}

}  // namespace zwidth
