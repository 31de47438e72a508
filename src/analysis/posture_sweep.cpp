#include "zwidth/analysis/posture_sweep.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "zwidth/analysis/inertia.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

constexpr std::int64_t kBlock = 256;  // samples that one task takes; results do not depend on threads
constexpr double kSilent = 1e-12;     // a column of J that small against the largest feels no load

// Running minimum, maximum and mean that remembers which sample the extremes belong to.
class Builder {
 public:
  void add(double value, std::int64_t index) {
    if (count_ == 0 || value < min_) {
      min_ = value;
      min_index_ = index;
    }
    if (count_ == 0 || value > max_) {
      max_ = value;
      max_index_ = index;
    }
    ++count_;
    sum_ += value;
  }
  void add(const Builder& other) {
    if (other.count_ == 0) return;
    if (count_ == 0 || other.min_ < min_) {
      min_ = other.min_;
      min_index_ = other.min_index_;
    }
    if (count_ == 0 || other.max_ > max_) {
      max_ = other.max_;
      max_index_ = other.max_index_;
    }
    count_ += other.count_;
    sum_ += other.sum_;
  }
  PostureStatistic result(const Mechanism& mechanism) const {
    PostureStatistic statistic{.count = count_, .min = min_, .max = max_};
    if (count_ == 0) return statistic;
    statistic.mean = sum_ / static_cast<double>(count_);
    statistic.min_at = spread_posture(mechanism, min_index_);
    statistic.max_at = spread_posture(mechanism, max_index_);
    return statistic;
  }

 private:
  std::int64_t count_ = 0, min_index_ = 0, max_index_ = 0;
  double min_ = 0.0, max_ = 0.0, sum_ = 0.0;
};

struct Block {
  std::int64_t solved = 0;
  GlobalConditioning translation, rotation;
  Builder translation_conditioning, rotation_conditioning, manipulability, weakest_force, weakest_moment,
      turn_step, lightest, heaviest, gravity_torque;
  std::array<Builder, 3> force, moment, step;
  std::vector<Jacobian> jacobians;  // some of them, for the characteristic length
};

// Largest load available in every direction: the nearest face of min_j <= J_j . w <= max_j. Joints that feel no
// load of these rows do not count.
double weakest_load(const Jacobian& jacobian, const TorqueRange& range) {
  const double loudest = jacobian.colwise().norm().maxCoeff();
  double weakest = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    const double norm = jacobian.col(j).norm();
    if (norm <= kSilent * loudest) continue;
    weakest = std::min(weakest, std::max(0.0, std::min(range.max[j], -range.min[j])) / norm);
  }
  return weakest;
}

// Largest pure load along an axis, whichever way is weaker.
double axis_load(const Jacobian& jacobian, const TorqueRange& range, Eigen::Index axis) {
  ToolVector direction = ToolVector::Unit(jacobian.rows(), axis);
  const double forwards = load_limit(jacobian, range, direction).value;
  direction = -direction;
  return std::min(forwards, load_limit(jacobian, range, direction).value);
}

// Which of x, y, z a row of one kind means.
int axis_of(const Mechanism& mechanism, Eigen::Index row) {
  return mechanism.tool_axes()[static_cast<std::size_t>(row)] % 3;
}

class Sweeper {
 public:
  Sweeper(const Mechanism& mechanism, const PostureSweepOptions& options)
      : mechanism_(mechanism), options_(options), linear_(mechanism.linear_rows()) {}

  void sample(std::int64_t index, Block& block) const {
    const Solution solution = solve_forward(mechanism_, spread_posture(mechanism_, index));
    // The active joints are within their ranges: a passive one may not be.
    if (!solution || solution.status == SolveStatus::joint_limit) return;
    ++block.solved;
    const Posture& posture = *solution.posture;
    const Rates rate = rates(posture);
    const Jacobian linear = rate.tool.topRows(linear_);
    const Jacobian angular = rate.tool.bottomRows(rate.tool.rows() - linear_);
    if (linear_ > 0) {
      const Dexterity figures = dexterity(linear);
      block.translation.add(figures.condition_number);
      block.translation_conditioning.add(1.0 / figures.condition_number, index);
      block.manipulability.add(figures.manipulability, index);
    }
    if (angular.rows() > 0) {
      const double condition = dexterity(angular).condition_number;
      block.rotation.add(condition);
      block.rotation_conditioning.add(1.0 / condition, index);
      if (linear_ > 0 && block.jacobians.size() < kJacobiansPerBlock) block.jacobians.push_back(rate.tool);
    }
    if (options_.torque) loads(index, options_.torque(posture), linear, angular, block);
    if (options_.joint_step.size() > 0) steps(index, rate.tool, block);
    masses(index, posture, rate, linear, block);
  }

 private:
  static constexpr std::size_t kJacobiansPerBlock = 4;

  void loads(std::int64_t index, const TorqueRange& range, const Jacobian& linear, const Jacobian& angular,
             Block& block) const {
    for (Eigen::Index r = 0; r < linear.rows(); ++r) {
      block.force[axis_of(mechanism_, r)].add(axis_load(linear, range, r), index);
    }
    for (Eigen::Index r = 0; r < angular.rows(); ++r) {
      block.moment[axis_of(mechanism_, linear.rows() + r)].add(axis_load(angular, range, r), index);
    }
    if (linear.rows() > 0) block.weakest_force.add(weakest_load(linear, range), index);
    if (angular.rows() > 0) block.weakest_moment.add(weakest_load(angular, range), index);
  }

  void steps(std::int64_t index, const Jacobian& jacobian, Block& block) const {
    const ToolVector step = tool_resolution(jacobian, options_.joint_step);
    double turn = 0.0;
    for (Eigen::Index r = 0; r < step.size(); ++r) {
      if (r < linear_) {
        block.step[axis_of(mechanism_, r)].add(step[r], index);
      } else {
        turn = std::max(turn, step[r]);
      }
    }
    if (step.size() > linear_) block.turn_step.add(turn, index);
  }

  void masses(std::int64_t index, const Posture& posture, const Rates& rate, const Jacobian& linear,
              Block& block) const {
    if (!mechanism_.bodies().empty()) {
      block.gravity_torque.add(gravity_torques(posture, rate).cwiseAbs().maxCoeff(), index);
    }
    const ActiveMatrix mass = mass_matrix(posture, rate);
    // A joint that moves nothing heavy has no apparent mass.
    if (linear_ == 0 || mass.diagonal().minCoeff() <= 0.0) return;
    const ApparentMass felt = apparent_mass(cartesian_mass(linear, mass));
    if (!std::isfinite(felt.heaviest) || felt.lightest <= 0.0) return;
    block.lightest.add(felt.lightest, index);
    block.heaviest.add(felt.heaviest, index);
  }

  const Mechanism& mechanism_;
  const PostureSweepOptions& options_;
  Eigen::Index linear_;
};

// Projected gradient ascent of `value` from the best of many postures; `slope` is its gradient at a tool
// position.
template <class Value, class Slope>
FarthestPosture ascend(const Mechanism& mechanism, const Value& value, const Slope& slope) {
  constexpr int kStarts = 2000, kKept = 6, kRounds = 400;
  std::vector<FarthestPosture> starts;
  const auto at = [&](const ActiveVector& q) {
    FarthestPosture result{.distance = -std::numeric_limits<double>::infinity(), .active = q};
    const Solution solution = solve_forward(mechanism, q);
    if (solution && solution.status != SolveStatus::joint_limit) {
      result.position = solution.posture->tool().position;
      result.distance = value(result.position);
    }
    return result;
  };
  for (int index = 0; index < kStarts; ++index) starts.push_back(at(spread_posture(mechanism, index)));
  std::partial_sort(starts.begin(), starts.begin() + kKept, starts.end(),
                    [](const auto& a, const auto& b) { return a.distance > b.distance; });
  FarthestPosture best = starts.front();
  for (int s = 0; s < kKept; ++s) {
    FarthestPosture here = starts[static_cast<std::size_t>(s)];
    double stride = 1.0;  // of the gradient step, which is in joint units per metre
    for (int round = 0; round < kRounds && stride > 1e-9; ++round) {
      const Solution solution = solve_forward(mechanism, here.active);
      if (!solution) break;
      const Jacobian J = jacobian(*solution.posture);
      ActiveVector gradient = ActiveVector::Zero(mechanism.active_count());
      const Vector3 uphill = slope(here.position);
      for (int r = 0; r < mechanism.linear_rows(); ++r) {
        gradient += J.row(r).transpose() * uphill[mechanism.tool_axes()[static_cast<std::size_t>(r)]];
      }
      const double scale = gradient.squaredNorm();
      if (!(scale > 0.0)) break;
      ActiveVector next = here.active + stride / std::max(std::sqrt(scale), 1e-12) * gradient;
      for (int j = 0; j < mechanism.active_count(); ++j) {
        next[j] = std::clamp(next[j], mechanism.active_range(j).min, mechanism.active_range(j).max);
      }
      const FarthestPosture there = at(next);
      if (there.distance > here.distance) {
        here = there;
        stride *= 1.5;
      } else {
        stride *= 0.4;
      }
    }
    if (here.distance > best.distance) best = here;
  }
  return best;
}

// The root of x^(n+1) = x + 1, which for n = 1 is the golden ratio.
double golden_ratio(int n) {
  static const std::array<double, kMaxActive + 1> roots = [] {
    std::array<double, kMaxActive + 1> found{};
    for (int k = 1; k <= kMaxActive; ++k) {
      found[k] = 2.0;
      for (int round = 0; round < 60; ++round) found[k] = std::pow(1.0 + found[k], 1.0 / (k + 1));
    }
    return found;
  }();
  return roots[static_cast<std::size_t>(n)];
}

}  // namespace

ActiveVector spread_posture(const Mechanism& mechanism, std::int64_t index) {
  ActiveVector q(mechanism.active_count());
  spread_postures(mechanism, index, 1, {q.data(), static_cast<std::size_t>(q.size())});
  return q;
}

void spread_postures(const Mechanism& mechanism, std::int64_t first, std::size_t count, std::span<double> out) {
  const int n = mechanism.active_count();
  const double phi = golden_ratio(n);
  double share = 1.0;
  for (int j = 0; j < n; ++j) {
    share /= phi;
    const Interval range = mechanism.active_range(j);
    for (std::size_t p = 0; p < count; ++p) {
      const double whole = 0.5 + share * static_cast<double>(first + static_cast<std::int64_t>(p) + 1);
      out[static_cast<std::size_t>(j) * count + p] = range.min + range.width() * (whole - std::floor(whole));
    }
  }
}

PostureSweep sweep_postures(const Mechanism& mechanism, const PostureSweepOptions& options,
                            const Effort& effort) {
  assert(options.samples > 0);
  const Sweeper sweeper(mechanism, options);
  std::vector<Block> blocks(static_cast<std::size_t>((options.samples + kBlock - 1) / kBlock));
  PostureSweep sweep{.samples = options.samples};
  sweep.complete = internal::for_each_index(blocks.size(), effort, [&](std::size_t b) {
    const std::int64_t first = static_cast<std::int64_t>(b) * kBlock;
    for (std::int64_t i = first; i < std::min(first + kBlock, options.samples); ++i) {
      sweeper.sample(i, blocks[b]);
    }
  });

  Block all;
  for (const Block& block : blocks) {
    all.solved += block.solved;
    all.translation.add(block.translation);
    all.rotation.add(block.rotation);
    for (Builder Block::*figure :
         {&Block::translation_conditioning, &Block::rotation_conditioning, &Block::manipulability,
          &Block::weakest_force, &Block::weakest_moment, &Block::turn_step, &Block::lightest, &Block::heaviest,
          &Block::gravity_torque}) {
      (all.*figure).add(block.*figure);
    }
    for (int k = 0; k < 3; ++k) {
      all.force[k].add(block.force[k]);
      all.moment[k].add(block.moment[k]);
      all.step[k].add(block.step[k]);
    }
    all.jacobians.insert(all.jacobians.end(), block.jacobians.begin(), block.jacobians.end());
  }
  sweep.solved = all.solved;
  sweep.translation = all.translation;
  sweep.rotation = all.rotation;
  sweep.translation_conditioning = all.translation_conditioning.result(mechanism);
  sweep.rotation_conditioning = all.rotation_conditioning.result(mechanism);
  sweep.manipulability = all.manipulability.result(mechanism);
  sweep.weakest_force = all.weakest_force.result(mechanism);
  sweep.weakest_moment = all.weakest_moment.result(mechanism);
  sweep.turn_step = all.turn_step.result(mechanism);
  sweep.lightest = all.lightest.result(mechanism);
  sweep.heaviest = all.heaviest.result(mechanism);
  sweep.gravity_torque = all.gravity_torque.result(mechanism);
  for (int k = 0; k < 3; ++k) {
    sweep.force[k] = all.force[k].result(mechanism);
    sweep.moment[k] = all.moment[k].result(mechanism);
    sweep.step[k] = all.step[k].result(mechanism);
  }
  if (!all.jacobians.empty()) {
    const JacobianUnits units = jacobian_units(mechanism);
    sweep.characteristic_length = characteristic_length(all.jacobians, units).length;
    for (const Jacobian& J : all.jacobians) {
      sweep.homogeneous.add(dexterity(homogeneous(J, units, sweep.characteristic_length)).condition_number);
    }
  }
  return sweep;
}

FarthestPosture farthest_along(const Mechanism& mechanism, const Vector3& direction) {
  return ascend(
      mechanism, [&](const Vector3& p) { return direction.dot(p); }, [&](const Vector3&) { return direction; });
}

FarthestPosture farthest_from(const Mechanism& mechanism, const Vector3& point) {
  return ascend(
      mechanism, [&](const Vector3& p) { return (p - point).norm(); },
      [&](const Vector3& p) { return Vector3((p - point).normalized()); });
}

}  // namespace zwidth
