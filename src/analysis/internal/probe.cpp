#include "zwidth/analysis/internal/probe.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/family_of.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/plane_figure.h"

namespace zwidth {
namespace internal {
namespace {

constexpr double kLimitTolerance = 1e-9;  // [rad], as delta_inverse
constexpr Interval kAnyAngle{-1e9, 1e9};

// Whether a point is the upper one of the two assembly modes of its driven angles: det R, which has the sign of
// det J on the outward roots, agrees with the z component of the normal of the elbows' plane.
bool is_upper_mode(const DeltaGeometry& geometry, const Vector3& theta, const Matrix3& jacobian) {
  const double d2 = geometry.upper_arm, d5 = geometry.offset();
  const double e0 = d5 + d2 * std::cos(theta[0]), e1 = d5 + d2 * std::cos(theta[1]),
               e2 = d5 + d2 * std::cos(theta[2]);
  return jacobian.determinant() * (e0 * e1 + e1 * e2 + e2 * e0) >= 0.0;
}

// Sine of the angle from a to b, in the plane.
double sine_between(const Vector3& a, const Vector3& b) {
  return (a.x() * b.y() - a.y() * b.x()) / std::sqrt(a.squaredNorm() * b.squaredNorm());
}

// Sine of crank to coupler of leg l.
double bend(const Posture& posture, int l) {
  const int crank = posture.mechanism().legs()[l].first;
  const Vector3& elbow = posture.joint_point(crank + 1);
  return sine_between(elbow - posture.joint_point(crank), posture.leg_tip(l) - elbow);
}

// Of the joints that no drive moves: what follows must have room to.
bool passive_within_ranges(const Posture& posture) {
  const std::vector<JointModel>& joints = posture.mechanism().joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].active < 0 &&
        !joints[j].range.contains(posture.joints()[static_cast<Eigen::Index>(j)], kLimitTolerance))
      return false;
  }
  return true;
}

}  // namespace

Probe::Probe(const Mechanism& mechanism) : mechanism_(&mechanism), dimension_(tool_dimension(mechanism)) {
  if (mechanism.delta()) return;
  if (const auto* r_cube = r_cube_of(mechanism)) {
    r_cube_ = r_cube_geometry(*r_cube);
    r_cube_branches_ = r_cube_branches(0, r_cube->elbow_mode);
    return;
  }
  if (const auto* five_bar = five_bar_of(mechanism)) {
    five_bar_ = five_bar_geometry(*five_bar);
    mode_ = working_mode(*five_bar);
    assembly_mode_ = five_bar->assembly_mode;
    branch_ = mode_.left * mode_.right * assembly_mode_;
    return;
  }
  scale_ = jacobian_scale(mechanism);
  if (mechanism.active_count() == 3) arm_ = positioning_form_of(mechanism);
  if (arm_.arm != nullptr) {
    arm_start_ = middle();
    return;
  }
  const Solution home = solve_forward(mechanism, middle().head(dimension_));
  if (!home) return;
  rotation_ = home.posture->tool().rotation;
  height_ = home.posture->tool().position.z();
  middle_ = home.posture;
  const double det = answer_from(*home.posture).jacobian.determinant();
  branch_ = mechanism.legs().size() == 1 ? 0.0 : det < 0.0 ? -1.0 : 1.0;
  two_cranks_ = has_two_cranks(mechanism);
  if (two_cranks_) {
    for (int l = 0; l < 2; ++l) modes_[l] = bend(*home.posture, l) < 0.0 ? -1.0 : 1.0;
  }
}

Vector3 Probe::middle() const {
  return {range(0).middle(), range(1).middle(), range(2).middle()};
}

Vector3 Probe::grid_joints(int index, int n) const {
  Vector3 joints;
  for (int j = 0; j < 3; ++j, index /= n) joints[j] = range(j).min + range(j).width() * (index % n) / (n - 1);
  return joints;
}

bool Probe::within_ranges(const Vector3& joints) const {
  for (int j = 0; j < dimension_; ++j) {
    if (!range(j).contains(joints[j], kLimitTolerance)) return false;
  }
  return true;
}

Probe::Answer Probe::answer_from(const Posture& posture) const {
  Answer answer;
  answer.reached = true;
  answer.joints.head(dimension_) = posture.active();
  answer.position = posture.tool().position;
  answer.jacobian.setIdentity();
  answer.jacobian.topLeftCorner(dimension_, dimension_) = zwidth::jacobian(posture).topRows(dimension_);
  answer.on_branch = answer.jacobian.determinant() * branch_ >= 0.0;
  if (two_cranks_) {
    const double left = bend(posture, 0), right = bend(posture, 1);
    answer.leg_singularity = std::min(std::abs(left), std::abs(right));
    answer.platform_singularity = std::abs(
        sine_between(posture.leg_tip(0) - posture.joint_point(1), posture.leg_tip(1) - posture.joint_point(3)));
    answer.on_branch = answer.on_branch && left * modes_[0] >= 0.0 && right * modes_[1] >= 0.0;
  }
  answer.inside = answer.on_branch && within_ranges(answer.joints) && passive_within_ranges(posture);
  return answer;
}

Probe::Answer Probe::answer_from(const RCubeSolution& solution) const {
  Answer answer;
  if (!solution.closed()) return answer;
  answer.reached = true;
  answer.joints = solution.theta;
  answer.position = solution.position;
  answer.jacobian = solution.lever.asDiagonal();
  // |cos| of the driven angles and |sin| of the elbows.
  answer.leg_singularity = std::min((solution.lever / r_cube_->drive_link).cwiseAbs().minCoeff(),
                                    solution.elbow.array().sin().abs().minCoeff());
  answer.on_branch = solution.lever.minCoeff() >= 0.0;
  answer.inside = answer.on_branch && within_ranges(answer.joints);
  return answer;
}

Probe::Answer Probe::arm_answer(const Vector3& joints) const {
  SerialForward here;
  arm_.chain->forward(joints, here);
  Answer answer;
  answer.reached = answer.on_branch = true;  // it has no loops: all its postures are its own
  answer.joints = joints;
  answer.position = here.tool.position;
  answer.jacobian = here.jacobian.topRows<3>();
  answer.inside = within_ranges(joints);
  return answer;
}

Probe::Answer Probe::five_bar_answer(const Vector2& theta, const Vector2& position, const Matrix2& J) const {
  Answer answer;
  answer.reached = true;
  for (int j = 0; j < 2; ++j) {  // within the range if whole turns bring it there
    const double middle = range(j).middle(), turns = std::round((theta[j] - middle) / (2.0 * std::numbers::pi));
    answer.joints[j] = theta[j] - turns * 2.0 * std::numbers::pi;
  }
  answer.position = {position.x(), position.y(), 0.0};
  answer.jacobian.setIdentity();
  answer.jacobian.topLeftCorner<2, 2>() = J;
  answer.on_branch = J.determinant() * branch_ > 0.0;  // where it is zero, two branches meet
  answer.inside = answer.on_branch && within_ranges(answer.joints);
  return answer;
}

Solution Probe::solve_at(const Vector3& position) {
  Pose pose{.position = position, .rotation = rotation_};
  if (dimension_ == 2) pose.position.z() = height_;
  Solution solution = solve_inverse(*mechanism_, pose, follow());
  // A plane may have holes, with the last answer on their other side.
  if (!solution && dimension_ == 2 && last_ && mechanism_->closed_form() == nullptr) {
    last_.reset();
    solution = solve_inverse(*mechanism_, pose, follow());
  }
  return solution;
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
  if (r_cube_) return answer_from(r_cube_inverse(*r_cube_, position, kAnyAngle, r_cube_branches_));
  if (five_bar_) {
    const FiveBarInverse inverse = five_bar_inverse(*five_bar_, position.head<2>(), mode_);
    if (inverse.status == SolveStatus::unreachable || inverse.status == SolveStatus::degenerate) return {};
    return five_bar_answer(inverse.theta, position.head<2>(), inverse.jacobian);
  }
  if (arm_.arm != nullptr) {
    const PositioningSolutions solutions = arm_.arm->inverse(position, arm_memory_);
    if (solutions.status != SolveStatus::reached) return {};
    Vector3 best;
    double least = std::numeric_limits<double>::infinity();
    for (int n = 0; n < solutions.count; ++n) {
      Vector3 joints;
      double way = 0.0;
      for (int j = 0; j < 3; ++j) {
        joints[j] = solutions.joints[static_cast<std::size_t>(n)][static_cast<std::size_t>(j)];
        if (mechanism_->joints()[static_cast<std::size_t>(j)].type == JointType::revolute)
          joints[j] -=
              2.0 * std::numbers::pi * std::round((joints[j] - range(j).middle()) / (2.0 * std::numbers::pi));
        way += std::abs(joints[j] - arm_start_[j]);
      }
      constexpr double kOutOfRange = 1e3;  // more than any way
      if (!within_ranges(joints)) way += kOutOfRange;
      if (way < least) {
        least = way;
        best = joints;
      }
    }
    const Answer answer = arm_answer(best);
    if (answer.inside) arm_start_ = best;
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
  if (r_cube_) return answer_from(r_cube_forward(*r_cube_, joints, r_cube_branches_));
  if (five_bar_) {
    const Vector2 theta = joints.head<2>();
    const FiveBarForward forward = five_bar_forward(*five_bar_, theta, assembly_mode_);
    if (forward.status == SolveStatus::unreachable || forward.status == SolveStatus::degenerate) return {};
    Answer answer = five_bar_answer(theta, forward.position, forward.jacobian);
    answer.joints = joints;
    // A mode of +1 turns the crank on from the line to the tool, so that the elbow bends to the right.
    const Vector2 bends = FiveBarState(*five_bar_, theta, forward.position).jacobian_theta();
    answer.on_branch = bends[0] * mode_.left <= 0.0 && bends[1] * mode_.right <= 0.0;
    answer.inside = answer.on_branch && within_ranges(joints);
    return answer;
  }
  if (arm_.arm != nullptr) return arm_answer(joints);
  const Solution solution = solve_forward(*mechanism_, joints.head(dimension_), follow());
  if (!solution) return {};
  const Answer answer = answer_from(*solution.posture);
  if (answer.inside) last_ = solution.posture;
  return answer;
}

FigureValues Probe::figures(const Answer& answer, const DriveLimits& limits) const {
  FigureValues values = dimension_ == 2 ? plane_figures(answer.jacobian.topLeftCorner<2, 2>(), limits)
                                        : jacobian_figures(answer.jacobian, limits);
  if (scale_.mixed) {
    Matrix3 J = answer.jacobian;
    for (int j = 0; j < dimension_; ++j) {
      if (scale_.units.slides(j)) J.col(j) *= scale_.length;
    }
    const FigureValues homogeneous =
        dimension_ == 2 ? plane_figures(J.topLeftCorner<2, 2>(), {}) : jacobian_figures(J, {});
    values[static_cast<int>(Figure::condition_number)] = figure(homogeneous, Figure::condition_number);
  }
  double leg = answer.leg_singularity, platform = answer.platform_singularity;
  if (five_bar_) {
    const FiveBarState state(*five_bar_, answer.joints.head<2>(), answer.position.head<2>());
    leg = state.inverse_singularity().cwiseAbs().minCoeff();
    platform = std::abs(state.direct_singularity());
  }
  values[static_cast<int>(Figure::leg_singularity)] = leg;
  values[static_cast<int>(Figure::platform_singularity)] = platform;
  return values;
}

double condition_number(Probe& probe, const Vector3& position) {
  const Probe::Answer answer = probe.inverse(position);
  if (!answer.inside) return std::numeric_limits<double>::quiet_NaN();
  return figure(probe.figures(answer, {}), Figure::condition_number);
}

bool has_two_cranks(const Mechanism& mechanism) {
  if (mechanism.platform() != PlatformFreedom::planar_translation || mechanism.legs().size() != 2) return false;
  for (const LegModel& leg : mechanism.legs()) {
    if (leg.count != 2 || mechanism.joints()[leg.first].active < 0) return false;
    for (int j = leg.first; j < leg.first + 2; ++j) {
      if (mechanism.joints()[j].type != JointType::revolute) return false;
    }
  }
  return true;
}

std::array<bool, kFigureCount> defined_figures(const Mechanism& mechanism, bool all) {
  std::array<bool, kFigureCount> defined;
  for (int f = 0; f < kFigureCount; ++f) defined[f] = all || f < kCoreFigureCount;
  const auto leave_out = [&](Figure which) { defined[static_cast<int>(which)] = false; };
  const bool plane = tool_dimension(mechanism) == 2, delta = mechanism.delta().has_value();
  if (plane) leave_out(Figure::force_z), leave_out(Figure::step_z);
  const bool cranks = has_two_cranks(mechanism);
  const bool r_cube = r_cube_of(mechanism) != nullptr;
  if (!(delta || cranks || r_cube)) leave_out(Figure::leg_singularity);
  if (!(delta || cranks)) leave_out(Figure::platform_singularity);
  return defined;
}

}  // namespace internal

std::optional<std::string> workspace_obstacle(const Mechanism& mechanism) {
  const int n = internal::tool_dimension(mechanism);
  if (mechanism.active_count() != n) {
    const std::string joints = ", and it has " + std::to_string(mechanism.active_count());
    if (n == 2)
      return "its workspace is worked out for two active joints where the tool moves in a plane" + joints;
    const bool plane = mechanism.active_count() == 2 && mechanism.platform() == PlatformFreedom::translation;
    return "its workspace is worked out for three active joints where the tool translates in space" + joints +
           (plane
                ? "; a tool that moves as a point in x and y is declared with platform = \"planar-translation\""
                : "");
  }
  for (int j = 0; j < n; ++j) {
    if (!(mechanism.active_range(j).width() < 1e3)) {
      return "joint " + mechanism.active_names()[j] + " has no range";
    }
  }
  const bool closed = mechanism.delta() || r_cube_of(mechanism) != nullptr || five_bar_of(mechanism) != nullptr;
  if (closed) return std::nullopt;
  ActiveVector middle(n);
  for (int j = 0; j < n; ++j) middle[j] = mechanism.active_range(j).middle();
  const Solution solution = solve_forward(mechanism, middle);
  if (!solution) return "its loops do not close in the middle of the joint ranges";
  const Jacobian J = jacobian(*solution.posture);
  const auto moves = mechanism.linear_rows();
  if (moves < n) return "its workspace is worked out for tools that translate";
  if (mechanism.tool_turns() && J.bottomRows(J.rows() - moves).norm() * mechanism.characteristic_length() >
                                    1e-9 * J.topRows(moves).norm()) {
    return "its workspace is worked out for platforms that only translate, and this one turns";
  }
  return std::nullopt;
}

}  // namespace zwidth
