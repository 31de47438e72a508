#include "zwidth/analysis/posture_sweep.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "zwidth/analysis/internal/climb.h"
#include "zwidth/analysis/internal/loads.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

constexpr std::int64_t kBlock = 256;  // samples that one task takes; results do not depend on threads
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
    PostureStatistic statistic;
    statistic.count = count_;
    statistic.min = min_;
    statistic.max = max_;
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

// Figures of a posture, in the order of `statistic_of`.
enum Value {
  translation_conditioning,
  rotation_conditioning,
  manipulability,
  weakest_force,
  weakest_moment,
  turn_step,
  gravity_torque,
  force,
  moment = force + 3,
  step = moment + 3,
  value_count = step + 3
};
using Values = std::array<double, value_count>;

// Of x, y or z among three of them.
constexpr std::size_t component(Value first, int axis) {
  return static_cast<std::size_t>(first) + static_cast<std::size_t>(axis);
}

PostureStatistic& statistic_of(PostureSweep& sweep, int value) {
  PostureStatistic* const single[] = {&sweep.translation_conditioning,
                                      &sweep.rotation_conditioning,
                                      &sweep.manipulability,
                                      &sweep.weakest_force,
                                      &sweep.weakest_moment,
                                      &sweep.turn_step,
                                      &sweep.gravity_torque};
  if (value < force) return *single[value];
  if (value < moment) return sweep.force[static_cast<std::size_t>(value - force)];
  return value < step ? sweep.moment[static_cast<std::size_t>(value - moment)]
                      : sweep.step[static_cast<std::size_t>(value - step)];
}

struct Block {
  std::int64_t solved = 0;
  GlobalConditioning translation, rotation, homogeneous;
  std::array<Builder, value_count> figures;
};

// Which of x, y, z a row of one kind means.
int axis_of(const Mechanism& mechanism, Eigen::Index row) {
  return mechanism.tool_axes()[static_cast<std::size_t>(row)] % 3;
}

class Sweeper {
 public:
  Sweeper(const Mechanism& mechanism, const PostureSweepOptions& options)
      : mechanism_(mechanism),
        options_(options),
        scale_(jacobian_scale(mechanism)),
        linear_(mechanism.linear_rows()) {}

  const JacobianScale& scale() const { return scale_; }

  void sample(std::int64_t index, Block& block) const {
    const Solution solution = solve_forward(mechanism_, spread_posture(mechanism_, index));
    // The active joints are within their ranges: a passive one may not be.
    if (!solution || solution.status == SolveStatus::joint_limit) return;
    ++block.solved;
    const Values values = values_of(*solution.posture);
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (!std::isnan(values[v])) block.figures[v].add(values[v], index);
    }
    const auto count = [](GlobalConditioning& conditioning, double inverse) {
      if (!std::isnan(inverse)) conditioning.add(inverse > 0.0 ? std::max(1.0, 1.0 / inverse) : kInfinity);
    };
    count(block.translation, values[translation_conditioning]);
    count(block.rotation, values[rotation_conditioning]);
    if (linear_ > 0 && mechanism_.tool_turns())
      block.homogeneous.add(scale_.condition_number(jacobian(*solution.posture)));
  }

  // NaN where a figure is not defined.
  Values values_of(const Posture& posture) const {
    Values values;
    values.fill(std::numeric_limits<double>::quiet_NaN());
    const Rates rate = rates(posture);
    const Jacobian linear = rate.tool.topRows(linear_);
    const Jacobian angular = rate.tool.bottomRows(rate.tool.rows() - linear_);
    if (linear_ > 0) {
      values[translation_conditioning] = 1.0 / scale_.rows_condition_number(linear);
      values[manipulability] = dexterity(linear).manipulability;
    }
    if (angular.rows() > 0) values[rotation_conditioning] = 1.0 / scale_.rows_condition_number(angular);
    if (options_.torque) loads(options_.torque(posture), linear, angular, values);
    if (options_.joint_step.size() > 0) steps(rate.tool, values);
    if (!mechanism_.bodies().empty())
      values[gravity_torque] = gravity_torques(posture, rate).cwiseAbs().maxCoeff();
    return values;
  }

  // One of them as a function of the joints, which are led from those of the last question.
  internal::JointFigure figure(int value) const {
    return [this, value, last = std::optional<Posture>()](const ActiveVector& joints) mutable {
      const SolveOptions follow{.start = last ? &*last : nullptr, .restart = false, .max_iterations = 60};
      const Solution solution = solve_forward(mechanism_, joints, last ? follow : SolveOptions{});
      if (!solution || solution.status == SolveStatus::joint_limit)
        return std::numeric_limits<double>::quiet_NaN();
      last = *solution.posture;
      return values_of(*last)[static_cast<std::size_t>(value)];
    };
  }

 private:
  void loads(const TorqueRange& range, const Jacobian& linear, const Jacobian& angular, Values& values) const {
    for (Eigen::Index r = 0; r < linear.rows(); ++r)
      values[component(force, axis_of(mechanism_, r))] = internal::axis_load(linear, range, r);
    for (Eigen::Index r = 0; r < angular.rows(); ++r) {
      values[component(moment, axis_of(mechanism_, linear.rows() + r))] =
          internal::axis_load(angular, range, r);
    }
    if (linear.rows() > 0) values[weakest_force] = internal::weakest_load(linear, range);
    if (angular.rows() > 0) values[weakest_moment] = internal::weakest_load(angular, range);
  }

  void steps(const Jacobian& jacobian, Values& values) const {
    const ToolVector steps = tool_resolution(jacobian, options_.joint_step);
    double turn = 0.0;
    for (Eigen::Index r = 0; r < steps.size(); ++r) {
      if (r < linear_) {
        values[component(step, axis_of(mechanism_, r))] = steps[r];
      } else {
        turn = std::max(turn, steps[r]);
      }
    }
    if (steps.size() > linear_) values[turn_step] = turn;
  }

  const Mechanism& mechanism_;
  const PostureSweepOptions& options_;
  JacobianScale scale_;
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

double spread_coordinate(int n, int k, std::int64_t index) {
  double share = 1.0;
  for (int j = 0; j <= k; ++j) share /= golden_ratio(n);
  const double whole = 0.5 + share * static_cast<double>(index + 1);
  return whole - std::floor(whole);
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
    all.homogeneous.add(block.homogeneous);
    for (std::size_t v = 0; v < value_count; ++v) all.figures[v].add(block.figures[v]);
  }
  sweep.solved = all.solved;
  sweep.translation = all.translation;
  sweep.rotation = all.rotation;
  sweep.homogeneous = all.homogeneous;
  for (int v = 0; v < value_count; ++v)
    statistic_of(sweep, v) = all.figures[static_cast<std::size_t>(v)].result(mechanism);
  if (sweep.complete) {
    const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
    sweep.complete = internal::for_each_index(value_count, quiet, [&](std::size_t v) {
      PostureStatistic& statistic = statistic_of(sweep, static_cast<int>(v));
      const ActiveVector least = statistic.min_at, largest = statistic.max_at;
      internal::refine(statistic, mechanism, least, largest, sweeper.figure(static_cast<int>(v)),
                       [](const ActiveVector& joints) { return joints; });
    });
  }
  if (sweeper.scale().mixed) sweep.characteristic_length = sweeper.scale().length;
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
