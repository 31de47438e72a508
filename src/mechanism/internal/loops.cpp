#include "zwidth/mechanism/internal/loops.h"

#include <cmath>
#include <numbers>

#include "zwidth/mechanism/internal/joint_values.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth::internal {
namespace {

// Of Newton's second correction over the first. Next to a fold, x^2 = t, it is at most 1/2, which only a step
// right onto the fold takes; Deuflhard 2011, chapter 5, asks for as much of a continuation.
constexpr double kContraction = 0.55;
constexpr double kRegular = 1e-2;   // condition of a closure that the shortest step does not bring to zero
constexpr double kRounding = 1e-7;  // a correction [rad, characteristic lengths] below this leads nowhere else

// Whether a step from `before` led past a direct singularity. `closure` is that of the last step of Newton, and
// is brought to the answer where it may differ.
bool crossed(const Posture& posture, const JointVector& before, const Pose& tool_before, const Newton& newton,
             Closure& closure) {
  constexpr double kSure = 0.1;  // of the closure's condition: less way cannot bring it to zero
  const Mechanism& mechanism = posture.mechanism();
  if (newton.iterations == 0 || newton.moved > kSure * closure.direct_condition()) closure.factor(posture);
  double way = 0.0;
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    way = std::max(
        way, scaled(mechanism.joints()[j], posture.joints()[j] - before[j], mechanism.characteristic_length()));
  }
  if (way <= kSure * closure.direct_condition() || closure.direct_condition() <= Closure::kSingular)
    return false;
  Posture earlier = PostureBuilder::unplaced(posture);
  PostureBuilder::joints(earlier) = before;
  PostureBuilder::tool(earlier) = tool_before;
  PostureBuilder::place_legs(earlier);
  return closure.sign_against(Closure(earlier)) < 0;
}

}  // namespace

ZWIDTH_WIDE Newton close_loops(Posture& posture, double tolerance, int limit, Budget& budget,
                               Closure& closure) {
  const Mechanism& mechanism = posture.mechanism();
  const int legs = static_cast<int>(mechanism.legs().size());
  const double length = mechanism.characteristic_length();
  const bool turns = mechanism.tool_turns();
  JointVector& joints = PostureBuilder::joints(posture);
  Pose& tool = PostureBuilder::tool(posture);

  Newton newton;
  Stagnation stagnation;
  Reuse reuse;
  ClosureVector error;
  std::array<double, 6> twist;
  JointVector change = JointVector::Zero(mechanism.joint_count());
  double first = 0.0;
  while (true) {
    PostureBuilder::place_legs(posture);
    newton.residual = 0.0;
    double sum = 0.0;
    for (int l = 0; l < legs; ++l) {
      const int rows = closure_error(posture, l, error[l]);
      for (int i = 0; i < rows; ++i) {
        newton.residual = std::max(newton.residual, std::abs(error[l][i]));
        sum += error[l][i];
      }
    }
    if (!std::isfinite(sum)) return newton;  // joints so far out that rounding left no number
    newton.converged = newton.residual <= tolerance;
    if (newton.converged || newton.iterations >= limit || budget.left <= 0 ||
        stagnation.reached(newton.residual))
      return newton;
    ++newton.iterations;
    --budget.left;
    ++budget.used;

    if (!reuse.allowed(newton.residual, tolerance)) {
      closure.factor(posture);
      newton.moved = 0.0;
    }
    closure.solve(error, twist, [&change](int j, double correction) { change[j] = correction; });
    double largest = 0.0;
    for (int j = 0; j < mechanism.joint_count(); ++j) {
      largest = std::max(largest, scaled(mechanism.joints()[j], change[j], length));
    }
    const double share = damping(largest);
    newton.moved += share * largest;
    if (newton.iterations == 1) first = largest;
    if (newton.iterations == 2 && first > kRounding) newton.contraction = largest / first;
    joints += share * change;
    Vector3 turn = Vector3::Zero();
    const std::span<const int> axes = mechanism.tool_axes();
    for (std::size_t r = 0; r < axes.size(); ++r) {
      (axes[r] < 3 ? tool.position[axes[r]] : turn[axes[r] - 3]) += share * twist[r];
    }
    if (turns) {
      tool.rotation = internal::orthonormal(internal::turned_by(turn, tool.rotation));
    }
  }
}

Posture at_home_guess(const Mechanism& mechanism) {
  Posture posture = PostureBuilder::open(mechanism);
  PostureBuilder::joints(posture) = mechanism.home_guess();
  PostureBuilder::place_legs(posture);
  Pose& tool = PostureBuilder::tool(posture);
  const int legs = static_cast<int>(mechanism.legs().size());
  for (int l = 0; l < legs && mechanism.tool_turns(); ++l) {
    if (mechanism.legs()[l].attachment == Attachment::rigid) {
      tool.rotation = posture.leg_tip_rotation(l);
      break;
    }
  }
  for (int l = 0; l < legs; ++l) {
    tool.position += (posture.leg_tip(l) - tool.rotation * mechanism.legs()[l].platform_point) / legs;
  }
  return posture;
}

Newton lead_active(Posture& posture, const ActiveVector& target, double tolerance, Budget& budget,
                   Closure& closure) {
  const Mechanism& mechanism = posture.mechanism();
  const double length = mechanism.characteristic_length();
  JointVector& joints = PostureBuilder::joints(posture);
  const ActiveVector from = posture.active();
  double way = 0.0;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    way = std::max(way, scaled(mechanism.joints()[mechanism.active_joint(i)], target[i] - from[i], length));
  }
  // However long the way, steps are long enough to get on.
  const double longest = std::max(kShortestStep, 1.0 / std::max(1.0, std::ceil(way / kLongestStep)));
  double step = longest, done = 0.0;
  Newton newton;
  while (done < 1.0) {
    const double next = done + step > 1.0 - 1e-9 ? 1.0 : done + step;
    const bool last = next == 1.0;
    const JointVector before = joints;
    const Pose tool_before = posture.tool();
    for (int i = 0; i < mechanism.active_count(); ++i) {
      joints[mechanism.active_joint(i)] = last ? target[i] : from[i] + next * (target[i] - from[i]);
    }
    newton = close_loops(posture, last ? tolerance * length : kLoose * length, last ? 40 : 12, budget, closure);
    if (newton.converged && newton.contraction <= kContraction && !jumped(posture, before)) {
      // What only passive joints of a leg are singular in, as a universal joint may be, the platform passes.
      const bool platform_passes = 0.5 * step < kShortestStep && closure.reciprocal_condition() > kRegular;
      if (!crossed(posture, before, tool_before, newton, closure) || platform_passes) {
        done = next;
        step = std::min(longest, 2.0 * step);
        continue;
      }
    }
    newton.converged = false;
    step *= 0.5;
    if (step < kShortestStep || budget.left <= 0) return newton;
    joints = before;
    PostureBuilder::tool(posture) = tool_before;
  }
  return newton;
}

Newton lead_round(Posture& posture, const ActiveVector& target, double tolerance, int limit, Budget& budget,
                  Closure& closure) {
  const Mechanism& mechanism = posture.mechanism();
  const Posture from = posture;
  const ActiveVector here = from.active();
  Newton newton;
  const auto lead = [&](const ActiveVector& turned) {
    posture = from;
    budget.left = limit;
    newton = lead_active(posture, turned, tolerance, budget, closure);
    if (!newton.converged) return false;
    // The same angles, as they are called.
    for (int i = 0; i < mechanism.active_count(); ++i)
      PostureBuilder::joints(posture)[mechanism.active_joint(i)] = target[i];
    newton = close_loops(posture, tolerance * mechanism.characteristic_length(), 10, budget, closure);
    return newton.converged;
  };
  const auto goes_round = [&](int i) {
    const JointModel& joint = mechanism.joints()[mechanism.active_joint(i)];
    return joint.type == JointType::revolute && internal::goes_round(joint.range);
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  ActiveVector shorter = target;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (goes_round(i)) shorter[i] = here[i] + std::remainder(target[i] - here[i], kTurn);
  }
  if ((shorter - target).cwiseAbs().maxCoeff() > 1.0 && lead(shorter)) return newton;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (!goes_round(i)) continue;
    ActiveVector other = shorter;
    other[i] += shorter[i] > here[i] ? -kTurn : kTurn;
    if (lead(other)) return newton;
  }
  newton.converged = false;
  return newton;
}

bool closes_elsewhere(Posture& posture, const ActiveVector& active, double tolerance) {
  const Mechanism& mechanism = posture.mechanism();
  for (int i = 0; i < mechanism.active_count(); ++i)
    PostureBuilder::joints(posture)[mechanism.active_joint(i)] = active[i];
  constexpr int kSteps = 60;
  Budget budget{kSteps};
  Closure closure;
  return close_loops(posture, tolerance * mechanism.characteristic_length(), kSteps, budget, closure).converged;
}

}  // namespace zwidth::internal
