#include "zwidth/analysis/internal/pose_guide.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace zwidth::internal {
namespace {

constexpr int kMaxIterations = 60;  // most questions about poses out of reach end here
constexpr double kUnlimited = 1e3;  // a sliding joint with a longer range [m] has none
constexpr double kSolvable = 1e-8;  // of what a motion of the tool asks of the joints

Solution home_of(const Mechanism& mechanism) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) active[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  return solve_forward(mechanism, active);
}

// Which rows of the tool can be moved alone; if fewer than it has freedoms, others beside them that are as
// independent as can be.
std::vector<int> free_rows(const Mechanism& mechanism, Jacobian J) {
  J.bottomRows(J.rows() - mechanism.linear_rows()) *= mechanism.characteristic_length();
  const double scale = J.norm();
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(J);
  std::vector<int> rows;
  for (int r = 0; r < J.rows(); ++r) {
    const Eigen::VectorXd wanted = Eigen::VectorXd::Unit(J.rows(), r);
    const Eigen::VectorXd rate = inverse.solve(wanted);
    if (scale > 0.0 && (J * rate - wanted).norm() < kSolvable) rows.push_back(r);
  }
  constexpr double kIndependent = 1e-6;
  const Eigen::Index freedoms = inverse.rank();
  Eigen::MatrixXd rest = J / std::max(scale, 1e-300);
  const auto take = [&rest](Eigen::Index r) {
    const Eigen::RowVectorXd unit = rest.row(r).normalized();
    rest -= (rest * unit.transpose()) * unit;
  };
  for (const int row : rows) take(row);
  while (static_cast<Eigen::Index>(rows.size()) < freedoms) {
    Eigen::Index best = 0;
    const double left = rest.rowwise().norm().maxCoeff(&best);
    if (!(left > kIndependent)) break;
    rows.push_back(static_cast<int>(best));
    take(best);
  }
  std::ranges::sort(rows);
  return rows;
}

}  // namespace

Pose PoseChart::at(const Vector3& coordinates) const {
  Pose pose = origin;
  Vector3 turn = Vector3::Zero();
  for (int k = 0; k < dimension(); ++k) {
    const int axis = axes[static_cast<std::size_t>(k)];
    (axis < 3 ? pose.position[axis] : turn[axis - 3]) = coordinates[k];
  }
  const double angle = turn.norm();
  if (angle > 0.0) pose.rotation = Eigen::AngleAxisd(angle, turn / angle) * origin.rotation;
  return pose;
}

Vector3 PoseChart::coordinates(const Vector3& position) const {
  Vector3 result = Vector3::Zero();
  for (int k = 0; k < dimension(); ++k) result[k] = position[axes[static_cast<std::size_t>(k)]];
  return result;
}

std::optional<std::string> PoseGuide::obstacle(const Mechanism& mechanism) {
  if (mechanism.serial() != nullptr || !mechanism.tool_turns())
    return "it is worked out for mechanisms of several legs whose tool turns";
  for (const JointModel& joint : mechanism.joints()) {
    if (joint.type == JointType::prismatic && joint.active >= 0 && !(joint.range.width() < kUnlimited))
      return "joint " + mechanism.active_names()[static_cast<std::size_t>(joint.active)] + " has no range";
  }
  const Solution home = home_of(mechanism);
  if (!home) return "its loops do not close in the home posture";
  if (home.status == SolveStatus::joint_limit) {
    return "in its home posture joint " + mechanism.joint_names()[static_cast<std::size_t>(home.joint)] +
           " is beyond its range";
  }
  if (home.status == SolveStatus::degraded) return "its home posture is singular";
  if (free_rows(mechanism, jacobian(*home.posture)).empty())
    return "its tool can neither move along an axis without turning nor turn about one without moving";
  return std::nullopt;
}

PoseGuide::PoseGuide(const Mechanism& mechanism) : mechanism_(&mechanism), home_(*home_of(mechanism).posture) {
  const Jacobian J = jacobian(home_);
  for (const int row : free_rows(mechanism, J)) {
    const int axis = mechanism.tool_axes()[static_cast<std::size_t>(row)];
    (axis < 3 ? moves_ : turns_).push_back(axis);
    rows_.push_back(row);
  }
  branch_ = handedness(J);
}

Jacobian PoseGuide::rows(const Jacobian& jacobian) const {
  return jacobian(rows_, Eigen::all);
}

double PoseGuide::handedness(const Jacobian& jacobian) const {
  if (static_cast<Eigen::Index>(rows_.size()) != jacobian.cols()) return 0.0;
  const double det = rows(jacobian).determinant();
  return det < 0.0 ? -1.0 : det > 0.0 ? 1.0 : 0.0;
}

// Newton's method on the components that the tool has, the loops closed at every step.
std::optional<Solution> PoseGuide::lead(const Posture& from, const Pose& to) const {
  constexpr int kSteps = 25;
  constexpr double kClose = 1e-11, kFar = 0.3;
  const double length = mechanism_->characteristic_length();
  Solution solution{.status = SolveStatus::reached};
  solution.posture = from;
  for (int n = 0; n < kSteps; ++n) {
    const Posture at = *solution.posture;
    const Eigen::AngleAxisd turn(Matrix3(to.rotation * at.tool().rotation.transpose()));
    const Vector3 way = to.position - at.tool().position, turns = turn.angle() * turn.axis();
    Eigen::VectorXd error(static_cast<Eigen::Index>(rows_.size()));
    Eigen::Index k = 0;
    double off = 0.0;
    for (const int axis : moves_) off = std::max(off, std::abs(error[k++] = way[axis]) / length);
    for (const int axis : turns_) off = std::max(off, std::abs(error[k++] = turns[axis - 3]));
    if (off < kClose && n > 0) return solution;
    const Eigen::MatrixXd J = rows(jacobian(at));
    ActiveVector step = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(J).solve(error);
    if (!step.allFinite()) return std::nullopt;
    double longest = 0.0;
    for (int j = 0; j < step.size(); ++j) {
      const JointModel& joint = mechanism_->joints()[static_cast<std::size_t>(mechanism_->active_joint(j))];
      longest = std::max(longest, std::abs(step[j]) / (joint.type == JointType::prismatic ? length : 1.0));
    }
    if (longest > kFar) step *= kFar / longest;
    solution = solve_forward(*mechanism_, at.active() + step,
                             {.start = &at, .restart = false, .max_iterations = kMaxIterations});
    if (!solution) return std::nullopt;
  }
  return std::nullopt;
}

PoseGuide::Step PoseGuide::step(const Posture& from, const Pose& to) const {
  Step step;
  Solution solution;
  if (static_cast<int>(rows_.size()) < mechanism_->tool_rows()) {
    std::optional<Solution> led = lead(from, to);
    if (!led) return step;
    solution = std::move(*led);
  } else {
    solution =
        solve_inverse(*mechanism_, to, {.start = &from, .restart = false, .max_iterations = kMaxIterations});
  }
  if (!solution) return step;
  step.posture = std::move(solution.posture);
  if (solution.status == SolveStatus::joint_limit) {
    step.reached = handedness(jacobian(*step.posture)) * branch_ >= 0.0;
    return step;
  }
  step.rates = rates(*step.posture);
  step.reached = handedness(step.rates.tool) * branch_ >= 0.0;
  step.inside = step.reached;
  return step;
}

double PoseGuide::margin(const Posture& posture, int* nearest, bool* upper) const {
  double least = std::numeric_limits<double>::infinity();
  for (int j = 0; j < mechanism_->joint_count(); ++j) {
    const JointModel& joint = mechanism_->joints()[static_cast<std::size_t>(j)];
    const double unit = joint.type == JointType::prismatic ? mechanism_->characteristic_length() : 1.0;
    for (const bool top : {false, true}) {
      const double room =
          (top ? joint.range.max - posture.joints()[j] : posture.joints()[j] - joint.range.min) / unit;
      if (!(room < least)) continue;
      least = room;
      if (nearest != nullptr) *nearest = j;
      if (upper != nullptr) *upper = top;
    }
  }
  return least;
}

}  // namespace zwidth::internal
