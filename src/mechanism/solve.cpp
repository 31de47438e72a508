#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "zwidth/mechanism/internal/arm_solver.h"
#include "zwidth/mechanism/internal/joint_values.h"
#include "zwidth/mechanism/internal/loops.h"
#include "zwidth/mechanism/internal/posture_builder.h"
#include "zwidth/mechanism/posture.h"

// The general solver is Newton on the loop closure, led from a start by small steps of what is asked for, so
// that it stays on the branch (assembly mode, working mode) of the start.

namespace zwidth {

using internal::Budget;
using internal::Closure;
using internal::closure_column;
using internal::closure_error;
using internal::damping;
using internal::kLimitTolerance;
using internal::kLongestStep;
using internal::kLoose;
using internal::kShortestStep;
using internal::Newton;
using internal::PostureBuilder;
using internal::Reuse;
using internal::scaled;
using internal::Stagnation;

namespace {

// ----------------------------------------------------------------------------------------------------- forward

// Wraps the passive angles, then says what the posture is worth, given its closure.
void judge(Solution& solution, const Closure& closure) {
  Posture& posture = *solution.posture;
  const Mechanism& mechanism = posture.mechanism();
  JointVector& joints = PostureBuilder::joints(posture);
  if (mechanism.platform() == PlatformFreedom::point) {
    PostureBuilder::tool(posture).rotation = posture.leg_tip_rotation(0);
  }
  solution.conditioning =
      std::min({closure.reciprocal_condition(), closure.drive_condition(posture), closure.passive_condition()});
  solution.status = solution.near_singularity() ? SolveStatus::degraded : SolveStatus::reached;
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    const JointModel& joint = mechanism.joints()[j];
    if (joint.active < 0) joints[j] = internal::wrapped(joint, joints[j]);
    if (!joint.range.contains(joints[j], kLimitTolerance)) {
      solution.status = SolveStatus::joint_limit;
      if (solution.joint < 0) solution.joint = j;
    }
  }
}

Solution forward_general(const Mechanism& mechanism, const ActiveVector& active, const SolveOptions& options) {
  const double length = mechanism.characteristic_length();
  Budget budget{options.max_iterations};
  Closure closure;
  Solution solution;
  Newton newton;
  if (options.start != nullptr) {
    solution.posture = PostureBuilder::unplaced(*options.start);
    newton = internal::lead_active(*solution.posture, active, options.tolerance, budget, closure);
  }
  if (!newton.converged && (options.start == nullptr || options.restart)) {  // from home there may be a way
    solution.posture = internal::at_home_guess(mechanism);
    budget.left = std::max(budget.left, options.max_iterations / 2);
    newton = internal::close_loops(*solution.posture, kLoose * length, 40, budget, closure);
    if (newton.converged) {
      closure.factor(*solution.posture);
      // A start on another branch has none of home's answers.
      newton.converged = options.start == nullptr || Closure(*options.start).sign() * closure.sign() >= 0;
    }
    if (newton.converged) {
      const Posture home = *solution.posture;
      newton = internal::lead_active(*solution.posture, active, options.tolerance, budget, closure);
      if (!newton.converged && options.restart) {
        const Newton straight = newton;
        Posture round = home;
        newton =
            internal::lead_round(round, active, options.tolerance, options.max_iterations, budget, closure);
        if (newton.converged) {
          solution.posture = round;
        } else {
          newton.residual = straight.residual;
        }
      }
    }
  }
  solution.iterations = budget.used;
  solution.residual = newton.residual;
  if (!newton.converged) {
    if (options.restart)
      solution.other_assembly = internal::closes_elsewhere(*solution.posture, active, options.tolerance);
    solution.posture.reset();
    return solution;
  }
  if (newton.iterations == 0) closure.factor(*solution.posture);
  judge(solution, closure);
  return solution;
}

// ----------------------------------------------------------------------------------------------------- inverse

// Moves the joints of leg l until its tip meets the platform, where `posture` has it. A leg with more joints
// than closure rows moves as little as it can.
ZWIDTH_WIDE Newton reach(Posture& posture, int l, double tolerance, int limit, Budget& budget) {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const double length = mechanism.characteristic_length();
  JointVector& joints = PostureBuilder::joints(posture);
  Newton newton;
  Stagnation stagnation;
  Reuse reuse;
  SmallQr<6, kMaxLegJoints> qr;  // of the columns, or where there are more joints than rows, of their transpose
  SmallQr<kMaxLegJoints, 6> transposed_qr;
  std::array<double, 6> error, column;
  std::array<double, kMaxLegJoints> change;
  while (true) {
    PostureBuilder::place_leg(posture, l);
    const int rows = closure_error(posture, l, error);
    newton.residual = 0.0;
    double sum = 0.0;
    for (int i = 0; i < rows; ++i) {
      newton.residual = std::max(newton.residual, std::abs(error[i]));
      sum += error[i];
    }
    if (!std::isfinite(sum)) return newton;  // a goal so far that rounding left no number
    newton.converged = newton.residual <= tolerance;
    if (newton.converged || newton.iterations >= limit || budget.left <= 0 ||
        stagnation.reached(newton.residual))
      return newton;
    ++newton.iterations;
    --budget.left;
    ++budget.used;

    const bool fresh = !reuse.allowed(newton.residual, tolerance), redundant = leg.count > rows;
    if (fresh) {
      redundant ? transposed_qr.resize(leg.count, rows) : qr.resize(rows, leg.count);
      for (int j = 0; j < leg.count; ++j) {
        closure_column(posture, l, leg.first + j, column);
        for (int i = 0; i < rows; ++i) (redundant ? transposed_qr.at(j, i) : qr.at(i, j)) = column[i];
      }
      redundant ? transposed_qr.factor() : qr.factor();
    }
    if (redundant) {
      transposed_qr.solve_transposed(error, change);
    } else {
      qr.apply_q_transposed(error);
      qr.back_substitute(error, change);
    }
    double largest = 0.0;
    for (int j = 0; j < leg.count; ++j) {
      largest = std::max(largest, scaled(mechanism.joints()[leg.first + j], change[j], length));
    }
    const double share = damping(largest);
    for (int j = 0; j < leg.count; ++j) joints[leg.first + j] -= share * change[j];
  }
}

Pose between(const Pose& from, const Pose& to, double share) {
  const Vector3 turn = internal::rotation_between(from.rotation, to.rotation);
  const double angle = turn.norm();
  Pose pose{.position = from.position + share * (to.position - from.position), .rotation = from.rotation};
  if (angle > 0.0) pose.rotation = Eigen::AngleAxisd(share * angle, turn / angle) * from.rotation;
  return pose;
}

// Leads leg l of `posture` from where it meets the tool pose `from` to where it meets `to`.
Newton lead_leg(Posture& posture, int l, const Pose& from, const Pose& to, double tolerance, Budget& budget) {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const double length = mechanism.characteristic_length();
  JointVector& joints = PostureBuilder::joints(posture);
  Pose& tool = PostureBuilder::tool(posture);
  const double way = std::max((to.position - from.position).norm() / length,
                              internal::rotation_between(from.rotation, to.rotation).norm());
  // However long the way, steps are long enough to get on.
  double step = std::max(kShortestStep, 1.0 / std::max(1.0, std::ceil(way / kLongestStep)));
  double done = 0.0;
  Newton newton;
  while (done < 1.0) {
    const double next = done + step > 1.0 - 1e-9 ? 1.0 : done + step;
    const bool last = next == 1.0;
    const JointVector before = joints;
    tool = last ? to : between(from, to, next);
    newton = reach(posture, l, last ? tolerance * length : kLoose * length, last ? 60 : 12, budget);
    if (newton.converged && !internal::jumped(posture, before)) {
      done = next;
      continue;
    }
    newton.converged = false;
    step *= 0.5;
    if (step < kShortestStep || budget.left <= 0) return newton;
    joints.segment(leg.first, leg.count) = before.segment(leg.first, leg.count);
  }
  return newton;
}

// Van der Corput sequence: spreads seeds evenly, the same ones every time.
double radical_inverse(int index, int base) {
  double result = 0.0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) result += digit * (index % base);
  return result;
}

// Every way found for leg l to meet the platform, nearest to `posture`'s own first. Joint values that put the
// driven joints and all links' origins in the same place (a universal joint's two readings) count once.
std::vector<JointVector> leg_roots(const Posture& posture, int l, double tolerance) {
  constexpr int kSeeds = 64;
  constexpr double kSame = 1e-6;
  constexpr std::array<int, kMaxLegJoints> kBases = {2, 3, 5, 7, 11, 13, 17, 19};
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const double length = mechanism.characteristic_length();
  const JointVector here = posture.joints().segment(leg.first, leg.count);
  const auto own = [&](const Posture& other) -> JointVector {
    return other.joints().segment(leg.first, leg.count);
  };

  const auto same = [&](const Posture& a, const Posture& b) {
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const JointModel& joint = mechanism.joints()[j];
      const double apart = a.joints()[j] - b.joints()[j];
      const bool driven_apart =
          joint.active >= 0 && (joint.type == JointType::prismatic
                                    ? std::abs(apart) / length
                                    : std::abs(std::remainder(apart, 2.0 * std::numbers::pi))) > kSame;
      if (driven_apart || (a.joint_point(j) - b.joint_point(j)).norm() > kSame * length) return false;
    }
    return true;
  };

  std::vector<Posture> found;
  for (int seed = 0; seed <= kSeeds; ++seed) {
    Posture trial = posture;
    JointVector& joints = PostureBuilder::joints(trial);
    for (int j = 0; j < leg.count && seed > 0; ++j) {
      const JointModel& joint = mechanism.joints()[leg.first + j];
      const double bound = joint.type == JointType::prismatic ? 2.0 * length : std::numbers::pi;
      const double low = std::max(joint.range.min, -bound), high = std::min(joint.range.max, bound);
      joints[leg.first + j] = low + (high - low) * radical_inverse(seed, kBases[j]);
    }
    Budget budget{80};
    if (!reach(trial, l, tolerance * length, 80, budget).converged) continue;
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      joints[j] = internal::wrapped(mechanism.joints()[j], joints[j]);
    }
    const auto known =
        std::find_if(found.begin(), found.end(), [&](const Posture& one) { return same(one, trial); });
    if (known == found.end()) {
      found.push_back(trial);
    } else if ((own(trial) - here).norm() < (own(*known) - here).norm()) {
      *known = trial;
    }
  }
  std::vector<JointVector> roots;
  for (const Posture& one : found) roots.push_back(own(one));
  std::stable_sort(roots.begin(), roots.end(), [&](const JointVector& a, const JointVector& b) {
    return (a - here).norm() < (b - here).norm();
  });
  return roots;
}

// Whether the mechanism, driven to the posture's active joints, stands elsewhere. Where it cannot be driven
// there nothing is known against the posture.
bool stands_elsewhere(const Posture& posture, const SolveOptions& options) {
  constexpr double kSame =
      1e-6;  // of the characteristic length, or rad: a root that cancels loses half the digits
  const Mechanism& mechanism = posture.mechanism();
  if (mechanism.serial() != nullptr) return false;  // an arm has one posture for its joints
  const Solution driven = solve_forward(mechanism, posture.active(), {.closed_form = options.closed_form});
  if (!driven) return false;
  const Pose &here = posture.tool(), &there = driven.posture->tool();
  return (there.position - here.position).norm() > kSame * mechanism.characteristic_length() ||
         internal::rotation_between(here.rotation, there.rotation).norm() > kSame;
}

// Another posture of an arm with its tool in the same place and every joint in its range, the nearest that is
// found.
void seek_within_ranges(Solution& solution, const SolveOptions& options) {
  const Mechanism& mechanism = solution.posture->mechanism();
  for (const JointVector& root : leg_roots(*solution.posture, 0, options.tolerance)) {
    Solution other = solution;
    other.joint = -1;
    PostureBuilder::joints(*other.posture) = root;
    PostureBuilder::place_leg(*other.posture, 0);
    Budget budget{10};
    other.residual =
        reach(*other.posture, 0, options.tolerance * mechanism.characteristic_length(), 5, budget).residual;
    judge(other, Closure(*other.posture));
    if (other.status == SolveStatus::joint_limit) continue;
    solution = std::move(other);
    return;
  }
}

Solution inverse_general(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options) {
  const int legs = static_cast<int>(mechanism.legs().size());
  const double length = mechanism.characteristic_length();
  Budget budget{options.max_iterations};
  Closure closure;
  Solution solution;
  solution.posture = options.start != nullptr ? *options.start : internal::at_home_guess(mechanism);
  Posture& posture = *solution.posture;
  if (options.start == nullptr) {
    const Newton home = internal::close_loops(posture, kLoose * length, 40, budget, closure);
    if (!home.converged) {
      solution.residual = home.residual;
      solution.posture.reset();
      return solution;
    }
  }
  Pose from = posture.tool();
  if (!mechanism.tool_turns()) from.rotation = tool.rotation;
  for (int l = 0; l < legs; ++l) {
    budget.left = options.max_iterations;
    const JointVector before = posture.joints();
    Newton newton = lead_leg(posture, l, from, tool, options.tolerance, budget);
    if (!newton.converged && options.restart) {  // the straight way leaves the leg's reach; its goal need not
      PostureBuilder::joints(posture) = before;
      PostureBuilder::tool(posture) = tool;
      const std::vector<JointVector> roots = leg_roots(posture, l, options.tolerance);
      if (!roots.empty()) {
        const LegModel& leg = mechanism.legs()[l];
        PostureBuilder::joints(posture).segment(leg.first, leg.count) = roots.front();
        newton = reach(posture, l, options.tolerance * length, 5, budget);
      }
    }
    solution.iterations = budget.used;
    solution.residual = std::max(solution.residual, newton.residual);
    if (!newton.converged) {
      solution.joint = mechanism.legs()[l].first;
      solution.posture.reset();
      return solution;
    }
  }
  PostureBuilder::tool(posture) = tool;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const int j = mechanism.active_joint(i);
    const JointModel& joint = mechanism.joints()[j];
    const double near = options.start != nullptr ? options.start->joints()[j] : mechanism.home_guess()[j];
    double& q = PostureBuilder::joints(posture)[j];
    if (joint.type != JointType::prismatic) q = internal::settled(q, joint.range, near);
  }
  closure.factor(posture);
  judge(solution, closure);
  if (solution.status == SolveStatus::joint_limit && mechanism.serial() != nullptr && options.restart &&
      options.start == nullptr) {
    seek_within_ranges(solution, options);
  }
  return solution;
}

// ------------------------------------------------------------------------------------------------------
// Closed forms.

// The posture that a closed form has found, judged as any other.
Solution closed_solution(const Mechanism& mechanism, const ClosedPosture& closed) {
  Solution solution;
  if (closed.status == SolveStatus::unreachable || closed.status == SolveStatus::degenerate) {
    solution.status = closed.status;
    solution.joint = closed.joint;
    return solution;
  }
  solution.posture = PostureBuilder::open(mechanism);
  Posture& posture = *solution.posture;
  PostureBuilder::joints(posture) = closed.joints;
  PostureBuilder::tool(posture) = closed.tool;
  PostureBuilder::place_legs(posture);
  solution.residual = 0.0;
  std::array<double, 6> error;
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const int rows = closure_error(posture, l, error);
    for (int i = 0; i < rows; ++i) solution.residual = std::max(solution.residual, std::abs(error[i]));
  }
  judge(solution, Closure(posture));
  return solution;
}

Solution closed_inverse(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options, int branch) {
  ClosedPosture closed = mechanism.closed_form()->inverse(tool, options, branch);
  if (closed.joints.size() == mechanism.joint_count()) {
    for (int i = 0; i < mechanism.active_count(); ++i) {
      const JointModel& joint = mechanism.joints()[mechanism.active_joint(i)];
      double& q = closed.joints[mechanism.active_joint(i)];
      if (!joint.range.contains(q, kLimitTolerance)) q = internal::wrapped(joint, q);
    }
  }
  return closed_solution(mechanism, closed);
}

// Of the mechanism's own assembly mode, or none. A posture beyond a joint's range is no answer in any mode, and
// says more of what is in the way.
Solution own_assembly(Solution solution, const SolveOptions& options) {
  if (!solution || solution.status == SolveStatus::joint_limit || !stands_elsewhere(*solution.posture, options))
    return solution;
  solution.status = SolveStatus::unreachable;
  solution.other_assembly = true;
  solution.posture.reset();
  return solution;
}

// How many branches the closed form has for what is asked; 0 leaves it to the general solver.
int closed_branches(const Mechanism& mechanism, const SolveOptions& options) {
  const ClosedForm* closed = mechanism.closed_form();
  return options.closed_form && closed != nullptr && closed->covers(options) ? closed->branch_count() : 0;
}

// ------------------------------------------------------------------------------------------------------
// Arms with joints to spare, and goals of position alone.

bool leaves_joints_open(const Mechanism& mechanism, const SolveOptions& options) {
  return mechanism.serial() != nullptr && (options.match == Match::position || mechanism.active_count() > 6);
}

Solution arm_solution(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options,
                      const internal::ArmAnswer& answer) {
  Solution solution;
  solution.residual = answer.residual;
  if (answer.found) {
    const Pose reached = options.match == Match::position ? mechanism.serial()->pose(answer.joints) : tool;
    solution =
        closed_solution(mechanism, {.status = SolveStatus::reached, .joints = answer.joints, .tool = reached});
    solution.residual = answer.residual;
  }
  solution.iterations = answer.iterations;
  return solution;
}

// Every answer that the seeds lead to, the best first.
std::vector<Solution> arm_solutions(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options) {
  constexpr double kSame = 1e-4;  // [rad] or [m]: what iteration finds of an optimum
  const internal::ArmSolver solver(mechanism, tool, options);
  std::vector<internal::ArmAnswer> answers;
  const auto add = [&](const internal::ArmAnswer& answer) {
    const auto same = [&](const internal::ArmAnswer& one) {
      for (int j = 0; j < answer.joints.size(); ++j) {
        const double apart = one.joints[j] - answer.joints[j];
        const bool slides = mechanism.joints()[j].type == JointType::prismatic;
        if (std::abs(slides ? apart : std::remainder(apart, 2.0 * std::numbers::pi)) > kSame) return false;
      }
      return true;
    };
    if (answer.found && std::none_of(answers.begin(), answers.end(), same)) answers.push_back(answer);
  };
  for (int seed = 0; seed <= internal::ArmSolver::kSeeds; ++seed) add(solver.solve_from(seed));
  if (answers.empty()) add(solver.solve());
  std::stable_sort(answers.begin(), answers.end(),
                   [](const internal::ArmAnswer& a, const internal::ArmAnswer& b) {
                     return a.within != b.within ? a.within : a.objective < b.objective;
                   });
  std::vector<Solution> solutions;
  for (const internal::ArmAnswer& answer : answers) {
    solutions.push_back(arm_solution(mechanism, tool, options, answer));
  }
  return solutions;
}

}  // namespace

Posture& Posture::operator=(const Posture& other) {
  mechanism_ = other.mechanism_;
  joints_ = other.joints_;
  tool_ = other.tool_;
  const auto copy = [](auto& to, const auto& from, std::size_t count) {
    std::memcpy(static_cast<void*>(to.data()), from.data(), count * sizeof to[0]);
  };
  copy(links_, other.links_, mechanism_->joints().size());
  copy(tips_, other.tips_, mechanism_->legs().size());
  return *this;
}

ActiveVector Posture::active() const {
  ActiveVector active(mechanism_->active_count());
  for (int i = 0; i < active.size(); ++i) active[i] = joints_[mechanism_->active_joint(i)];
  return active;
}

Solution solve_forward(const Mechanism& mechanism, const ActiveVector& active, const SolveOptions& options) {
  assert(active.size() == mechanism.active_count() && active.allFinite());
  if (options.closed_form && mechanism.closed_form() != nullptr) {
    return closed_solution(mechanism, mechanism.closed_form()->forward(active));
  }
  return forward_general(mechanism, active, options);
}

Solution solve_inverse(const Mechanism& mechanism, const Pose& tool, const SolveOptions& options) {
  assert(tool.position.allFinite() && tool.rotation.allFinite());
  Pose wanted = tool;
  if (!mechanism.tool_turns()) wanted.rotation.setIdentity();
  if (closed_branches(mechanism, options) > 0) {
    return own_assembly(closed_inverse(mechanism, wanted, options, 0), options);
  }
  if (leaves_joints_open(mechanism, options)) {
    return arm_solution(mechanism, wanted, options, internal::ArmSolver(mechanism, wanted, options).solve());
  }
  Solution solution = inverse_general(mechanism, wanted, options);
  return options.start == nullptr ? own_assembly(std::move(solution), options) : solution;
}

std::vector<Solution> solve_inverse_all(const Mechanism& mechanism, const Pose& tool,
                                        const SolveOptions& options) {
  assert(tool.position.allFinite() && tool.rotation.allFinite());
  std::vector<Solution> solutions;
  Pose wanted = tool;
  if (!mechanism.tool_turns()) wanted.rotation.setIdentity();
  const int branches = closed_branches(mechanism, options);
  if (branches == 0 && leaves_joints_open(mechanism, options)) {
    solutions = arm_solutions(mechanism, wanted, options);
  } else if (branches > 0) {
    for (int branch = 0; branch < branches; ++branch) {
      Solution solution = closed_inverse(mechanism, wanted, options, branch);
      if (solution) solutions.push_back(std::move(solution));
    }
  } else {
    constexpr std::size_t kMostSolutions = 256;
    Posture posture = options.start != nullptr ? *options.start : internal::at_home_guess(mechanism);
    PostureBuilder::tool(posture) = wanted;
    std::vector<Posture> postures = {posture};
    for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
      const LegModel& leg = mechanism.legs()[l];
      std::vector<Posture> grown;
      for (const JointVector& root : leg_roots(posture, l, options.tolerance)) {
        for (Posture one : postures) {
          if (grown.size() == kMostSolutions) break;
          PostureBuilder::joints(one).segment(leg.first, leg.count) = root;
          PostureBuilder::place_leg(one, l);
          grown.push_back(one);
        }
      }
      postures = std::move(grown);
    }
    for (const Posture& one : postures) {
      Solution solution;
      solution.posture = one;
      solution.residual = options.tolerance * mechanism.characteristic_length();
      judge(solution, Closure(*solution.posture));
      solutions.push_back(std::move(solution));
    }
  }
  for (Solution& solution : solutions) solution.other_assembly = stands_elsewhere(*solution.posture, options);
  std::stable_sort(solutions.begin(), solutions.end(), [](const Solution& a, const Solution& b) {
    const auto rank = [](const Solution& s) {
      return (s.other_assembly ? 2 : 0) + (s.status == SolveStatus::joint_limit ? 1 : 0);
    };
    return rank(a) < rank(b);
  });
  return solutions;
}

}  // namespace zwidth
