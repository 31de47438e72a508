#include "zwidth/mechanism/internal/arm_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/internal/closure.h"
#include "zwidth/mechanism/internal/joint_values.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth::internal {
namespace {

constexpr double kLargestStep = 0.6;  // of a joint [units]
constexpr double kEdge = 1e-12;       // by which a step may go beyond a range [units]
constexpr Interval kAnywhere{-1e9, 1e9};

// Van der Corput sequence: spreads seeds evenly, the same ones every time.
double radical_inverse(int index, int base) {
  double result = 0.0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) result += digit * (index % base);
  return result;
}

}  // namespace

ArmSolver::ArmSolver(const Mechanism& mechanism, const Pose& goal, const SolveOptions& options) noexcept
    : mechanism_(mechanism),
      chain_(*mechanism.serial()),
      goal_(goal),
      options_(options),
      n_(mechanism.active_count()),
      rows_(options.match == Match::position ? 3 : 6),
      length_(mechanism.characteristic_length()),
      unit_(ActiveVector::Ones(n_)) {
  for (int j = 0; j < n_; ++j) {
    if (mechanism.joints()[j].type == JointType::prismatic) unit_[j] = length_;
  }
  start_ = options.start != nullptr ? options.start->active() : ActiveVector(mechanism.home_guess());
  start_ = start_.cwiseQuotient(unit_);
  const Redundancy& rule = options.redundancy;
  for (int j = 0; j < n_; ++j) {
    const Interval range = mechanism.active_range(j);
    const bool turns = mechanism.joints()[j].type == JointType::revolute;
    limits_[j] = turns && goes_round(range) ? kAnywhere : Interval{range.min / unit_[j], range.max / unit_[j]};
    free_[j] = kAnywhere;
    if (rule.rule != Redundancy::Rule::keep || rule.joint != j) continue;
    const double value = rule.value ? *rule.value / unit_[j] : start_[j];
    limits_[j] = free_[j] = {value, value};
  }
}

// The largest error.
double ArmSolver::linearise(const ActiveVector& q, Equations& error, EquationMatrix& J) const noexcept {
  SerialForward here;
  chain_.forward(in_units(q), here);
  error.resize(rows_);
  J.resize(rows_, n_);
  error.head<3>() = (goal_.position - here.tool.position) / length_;
  J.topRows<3>() = here.jacobian.topRows<3>() / length_;
  if (rows_ == 6) {
    error.tail<3>() = rotation_between(here.tool.rotation, goal_.rotation);
    J.bottomRows<3>() = here.jacobian.bottomRows<3>();
  }
  for (int j = 0; j < n_; ++j) J.col(j) *= unit_[j];
  return error.cwiseAbs().maxCoeff();
}

// `change` comes in as the wish, and goes out as what is nearest to it of all changes that meet the equations
// with every joint in its range: joints that would leave theirs are put at its end, the farthest first, and the
// others asked anew. False where none is left to ask.
bool ArmSolver::step(const EquationMatrix& J, const Equations& error, const ActiveVector& q,
                     const Ranges& ranges, double damping, ActiveVector& change) const noexcept {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const ActiveVector wish = change;
  unsigned held = 0;
  for (int j = 0; j < n_; ++j) {
    if (ranges[j].width() > 0.0) continue;
    held |= 1U << j;
    change[j] = ranges[j].min - q[j];
  }
  for (int pass = 0; pass <= n_; ++pass) {
    Square A = Square::Zero(rows_, rows_);
    Equations rest = error;
    for (int j = 0; j < n_; ++j) {
      rest -= J.col(j) * change[j];
      if ((held >> j & 1U) == 0) A += J.col(j) * J.col(j).transpose();
    }
    const double size = A.trace();
    if (!(size > 0.0)) return false;
    A.diagonal().array() += damping * size;
    const Equations pull = A.ldlt().solve(rest);
    int worst = -1;
    double farthest = kEdge;
    for (int j = 0; j < n_; ++j) {
      if ((held >> j & 1U) != 0) continue;
      change[j] = wish[j] + J.col(j).dot(pull);
      const double beyond = std::max(ranges[j].min - q[j] - change[j], q[j] + change[j] - ranges[j].max);
      if (beyond > farthest) {
        farthest = beyond;
        worst = j;
      }
    }
    if (worst < 0) return true;
    held |= 1U << worst;
    for (int j = 0; j < n_; ++j) {
      if ((held >> j & 1U) == 0) change[j] = wish[j];
    }
    change[worst] =
        (q[worst] + change[worst] < ranges[worst].min ? ranges[worst].min : ranges[worst].max) - q[worst];
  }
  return false;
}

// Newton's method, by least changes.
bool ArmSolver::meet(ActiveVector& q, const Ranges& ranges, int limit, ArmAnswer& answer) const noexcept {
  Equations error;
  EquationMatrix J;
  double best = std::numeric_limits<double>::infinity();
  int stagnant = 0;
  for (int j = 0; j < n_; ++j) q[j] = std::clamp(q[j], ranges[j].min, ranges[j].max);
  for (int iteration = 0;; ++iteration) {
    const double residual = linearise(q, error, J);
    answer.residual = residual * length_;
    if (residual <= options_.tolerance) return true;
    stagnant = residual < 0.7 * best ? 0 : stagnant + 1;
    best = std::min(best, residual);
    if (iteration >= limit || stagnant > 8) return false;
    ++answer.iterations;
    // Less damping as the goal comes near, so that the last steps are Newton's own; more where they fail.
    const double damping = 1e-14 + (stagnant > 2 ? 1e-2 : 1e-4) * std::min(1.0, residual * residual);
    ActiveVector change = ActiveVector::Zero(n_);
    if (!step(J, error, q, ranges, damping, change)) return false;
    const double largest = change.cwiseAbs().maxCoeff();
    q += change * (largest > kLargestStep ? kLargestStep / largest : 1.0);
  }
}

double ArmSolver::objective(const ActiveVector& q) const noexcept {
  if (options_.redundancy.rule != Redundancy::Rule::maximise) return (q - start_).squaredNorm();
  SerialForward here;
  chain_.forward(in_units(q), here);
  std::array<Interval, kMaxActive> range;
  ActiveVector joints = in_units(q);
  for (int j = 0; j < n_; ++j) {
    range[j] = mechanism_.active_range(j);
    if (goes_round(range[j])) joints[j] = settled(joints[j], range[j], start_[j]);
  }
  return -redundancy_figure(options_.redundancy.figure, options_.match, here.jacobian, joints,
                            std::span(range).first(static_cast<std::size_t>(n_)), length_);
}

// Where the objective falls most: of a distance the whole way to the start.
ActiveVector ArmSolver::downhill(const ActiveVector& q) const noexcept {
  if (options_.redundancy.rule != Redundancy::Rule::maximise) return start_ - q;
  constexpr double h = 1e-5;
  ActiveVector result(n_);
  for (int j = 0; j < n_; ++j) {
    ActiveVector ahead = q, behind = q;
    ahead[j] += h;
    behind[j] -= h;
    result[j] = (objective(behind) - objective(ahead)) / (2.0 * h);
  }
  return result;
}

// Downhill along the self-motion, in steps that the goal is met again after.
void ArmSolver::improve(ActiveVector& q, const Ranges& ranges, ArmAnswer& answer) const noexcept {
  constexpr double kAtRest = 1e-10;  // [units]
  const auto moving = std::count_if(ranges.begin(), ranges.begin() + n_,
                                    [](const Interval& range) { return range.width() > 0.0; });
  if (moving <= rows_) return;  // nothing is left open
  const bool nearest = options_.redundancy.rule != Redundancy::Rule::maximise;
  Equations error;
  EquationMatrix J;
  double value = objective(q), reach = 0.3;  // of the next step [units]
  for (int iteration = 0; iteration < 300; ++iteration) {
    linearise(q, error, J);
    ActiveVector along = downhill(q);
    const double wish = along.norm();
    if (!nearest && wish > 0.0) along *= reach / wish;
    error.setZero();
    if (!step(J, error, q, ranges, 1e-14, along)) return;
    const double size = along.norm();
    double share = std::min(1.0, 0.5 / std::max(size, kAtRest));
    bool better = false;
    for (; share * size > kAtRest; share *= 0.5) {
      ActiveVector trial = q + share * along;
      ArmAnswer unused;
      const bool met = meet(trial, ranges, 12, unused);
      answer.iterations += unused.iterations;
      const double there = met ? objective(trial) : value;
      better = there < value;
      if (!better) continue;
      q = trial;
      value = there;
      break;
    }
    if (!better) return;
    reach = std::clamp(2.0 * share * size, 1e-9, 0.5);
  }
}

ArmAnswer ArmSolver::solve_from(int seed, bool limited) const noexcept {
  static constexpr std::array<int, kMaxActive> kBases = {2, 3, 5, 7, 11, 13, 17, 19};
  const Ranges& ranges = limited ? limits_ : free_;
  ArmAnswer answer;
  ActiveVector q = start_;
  for (int j = 0; j < n_ && seed > 0; ++j) {
    const double bound = unit_[j] == 1.0 ? std::numbers::pi : 2.0;
    const Interval spread = ranges[j].width() < 1e3 ? ranges[j] : Interval{-bound, bound};
    q[j] = spread.min + spread.width() * radical_inverse(seed, kBases[j]);
  }
  answer.found = meet(q, ranges, 60, answer);
  if (!answer.found) return answer;
  const double residual = answer.residual;
  improve(q, ranges, answer);
  answer.residual = residual;
  answer.objective = objective(q);
  answer.joints = in_units(q);
  answer.within = true;
  for (int j = 0; j < n_; ++j) {
    const Interval range = mechanism_.active_range(j);
    if (mechanism_.joints()[j].type == JointType::revolute)
      answer.joints[j] = settled(answer.joints[j], range, start_[j]);
    answer.within = answer.within && range.contains(answer.joints[j], kLimitTolerance);
  }
  return answer;
}

ArmAnswer ArmSolver::solve() const noexcept {
  const bool everywhere =
      options_.restart && options_.start == nullptr && options_.redundancy.rule == Redundancy::Rule::maximise;
  ArmAnswer best = solve_from(0);
  int iterations = best.iterations;
  for (int seed = 1; seed <= kSeeds && options_.restart && (everywhere || !best.found); ++seed) {
    const ArmAnswer one = solve_from(seed);
    iterations += one.iterations;
    if (one.found && (!best.found || one.objective < best.objective)) best = one;
  }
  // Within the ranges there is none; beyond them there may be.
  for (int seed = 0; seed <= (options_.restart ? kSeeds : 0) && !best.found; ++seed) {
    best = solve_from(seed, false);
    iterations += best.iterations;
  }
  best.iterations = iterations;
  return best;
}

}  // namespace zwidth::internal
