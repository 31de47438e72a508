#include "zwidth/analysis/internal/probe.h"

#include <Eigen/LU>
#include <cmath>

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {
namespace internal {
namespace {

constexpr double kLimitTolerance = 1e-9;  // [rad], as delta_inverse

// Whether a point is the upper one of the two assembly modes of its driven angles: det R, which has the sign of
// det J on the outward roots, agrees with the z component of the normal of the elbows' plane.
bool is_upper_mode(const DeltaGeometry& geometry, const Vector3& theta, const Matrix3& jacobian) {
  const double d2 = geometry.upper_arm, d5 = geometry.offset();
  const double e0 = d5 + d2 * std::cos(theta[0]), e1 = d5 + d2 * std::cos(theta[1]),
               e2 = d5 + d2 * std::cos(theta[2]);
  return jacobian.determinant() * (e0 * e1 + e1 * e2 + e2 * e0) >= 0.0;
}

}  // namespace

Probe::Probe(const Mechanism& mechanism) : mechanism_(&mechanism) {
  if (mechanism.delta()) return;
  const Solution home = solve_forward(mechanism, ActiveVector(middle()));
  if (!home) return;
  rotation_ = home.posture->tool().rotation;
  middle_ = home.posture;
  branch_ = mechanism.legs().size() == 1                               ? 0.0
            : jacobian(*home.posture).topRows<3>().determinant() < 0.0 ? -1.0
                                                                       : 1.0;
}

Vector3 Probe::middle() const {
  return {range(0).middle(), range(1).middle(), range(2).middle()};
}

bool Probe::within_ranges(const Vector3& joints) const {
  for (int j = 0; j < 3; ++j) {
    if (!range(j).contains(joints[j], kLimitTolerance)) return false;
  }
  return true;
}

Probe::Answer Probe::answer_from(const Posture& posture) const {
  Answer answer;
  answer.reached = true;
  answer.joints = posture.active();
  answer.position = posture.tool().position;
  answer.jacobian = zwidth::jacobian(posture).topRows<3>();
  answer.on_branch = answer.jacobian.determinant() * branch_ >= 0.0;
  answer.inside = answer.on_branch && within_ranges(answer.joints);
  return answer;
}

Solution Probe::solve_at(const Vector3& position) {
  const Pose pose{.position = position, .rotation = rotation_};
  return solve_inverse(*mechanism_, pose, follow());
}

// From the last answer, or from the middle of the joint ranges, one short way: most questions about points out
// of reach end here, and a search for other ways would cost a hundred times as much.
SolveOptions Probe::follow() const {
  const Posture* start = last_ ? &*last_ : middle_ ? &*middle_ : nullptr;
  return {.start = start, .restart = start == nullptr, .max_iterations = 60};
}

Probe::Answer Probe::inverse(const Vector3& position) {
  if (const auto& geometry = mechanism_->delta()) {
    const DeltaInverse inverse = delta_inverse(*geometry, position, range(0));
    Answer answer;
    if (inverse.status == SolveStatus::unreachable || inverse.status == SolveStatus::degenerate) return answer;
    answer.reached = true;
    answer.joints = inverse.theta;
    answer.position = position;
    answer.jacobian = inverse.jacobian;
    answer.on_branch = is_upper_mode(*geometry, inverse.theta, inverse.jacobian);
    answer.inside = answer.on_branch && inverse.status != SolveStatus::joint_limit;
    return answer;
  }
  const Solution solution = solve_at(position);
  if (!solution) return {};
  const Answer answer = answer_from(*solution.posture);
  if (answer.inside) last_ = solution.posture;
  return answer;
}

std::optional<Posture> Probe::posture(const Vector3& position) {
  Solution solution = solve_at(position);
  if (solution) last_ = *solution.posture;
  return std::move(solution.posture);
}

Probe::Answer Probe::forward(const Vector3& joints) {
  if (const auto& geometry = mechanism_->delta()) {
    const DeltaForward forward = delta_forward(*geometry, joints);
    Answer answer;
    if (forward.status == SolveStatus::unreachable || forward.status == SolveStatus::degenerate) return answer;
    answer.reached = true;
    answer.joints = joints;
    answer.position = forward.position;
    answer.jacobian = forward.jacobian;
    // On the device's own branch the inverse leads back to the same angles.
    const DeltaState state(*geometry, joints, forward.position);
    answer.on_branch = state.inverse_singularity().minCoeff() >= 0.0;
    answer.inside = answer.on_branch && within_ranges(joints);
    return answer;
  }
  const Solution solution = solve_forward(*mechanism_, ActiveVector(joints), follow());
  if (!solution) return {};
  const Answer answer = answer_from(*solution.posture);
  if (answer.inside) last_ = solution.posture;
  return answer;
}

}  // namespace internal

std::optional<std::string> workspace_obstacle(const Mechanism& mechanism) {
  if (mechanism.active_count() != 3) {
    return "its workspace is worked out for three active joints only, and it has " +
           std::to_string(mechanism.active_count());
  }
  for (int j = 0; j < 3; ++j) {
    if (!(mechanism.active_range(j).width() < 1e3)) {
      return "joint " + mechanism.active_names()[j] + " has no range";
    }
  }
  if (mechanism.delta()) return std::nullopt;
  const Vector3 middle(mechanism.active_range(0).middle(), mechanism.active_range(1).middle(),
                       mechanism.active_range(2).middle());
  const Solution solution = solve_forward(mechanism, ActiveVector(middle));
  if (!solution) return "its loops do not close in the middle of the joint ranges";
  const Jacobian J = jacobian(*solution.posture);
  if (J.rows() == 6 &&
      J.bottomRows<3>().norm() * mechanism.characteristic_length() > 1e-9 * J.topRows<3>().norm()) {
    return "its workspace is worked out for platforms that only translate, and this one turns";
  }
  return std::nullopt;
}

}  // namespace zwidth
