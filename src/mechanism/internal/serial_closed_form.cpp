#include "zwidth/mechanism/internal/serial_closed_form.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/internal/joint_values.h"
#include "zwidth/mechanism/positioning_arm.h"

namespace zwidth {
namespace internal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-7;  // [rad]: an elbow is known to half the digits where its circle is touched
constexpr double kStep = kTurn / 96.0;  // between elbows that are tried along an arc [rad]

double gap(double angle, double other) {
  return std::abs(std::remainder(angle - other, kTurn));
}

// The least of f between low and high, where it has one minimum (golden section; Kiefer 1953).
template <class Function>
double minimum(double low, double high, const Function& f) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  auto f_a = f(a), f_b = f(b);
  while (high - low > 1e-9) {
    if (f_a.better_than(f_b)) {
      high = b;
      b = a;
      f_b = f_a;
      a = high - kGolden * (high - low);
      f_a = f(a);
    } else {
      low = a;
      a = b;
      f_a = f_b;
      b = low + kGolden * (high - low);
      f_b = f(b);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

SerialClosedForm::SerialClosedForm(const SerialDescription& arm, const LegDescription& leg)
    : chain_(arm), srs_(srs_pattern(leg)), home_(static_cast<Eigen::Index>(leg.joints.size())) {
  Vector3 inner = Vector3::Zero();
  for (std::size_t j = 0; j < leg.joints.size(); ++j) {
    range_.push_back(leg.joints[j].range);
    home_[static_cast<Eigen::Index>(j)] = leg.joints[j].home;
    length_ = std::max(length_, (leg.joints[j].point - inner).norm());
    inner = leg.joints[j].point;
  }
  length_ = std::max(length_, (leg.tip - inner).norm());
}

ClosedPosture SerialClosedForm::forward(const ActiveVector& active) const noexcept {
  return {.status = SolveStatus::reached, .joints = active, .tool = chain_.pose(active)};
}

int SerialClosedForm::branch_count() const noexcept {
  return srs_ ? 8 : 0;
}

bool SerialClosedForm::covers(const SolveOptions& options) const noexcept {
  if (!srs_) return false;
  // Of a position alone only where the tool point is the wrist, so that the hand does not matter.
  const double size = srs_->lengths.upper_arm + srs_->lengths.forearm;
  return options.match == Match::pose || srs_->tool.position.norm() < 1e-12 * size;
}

void SerialClosedForm::Candidates::add(const Candidate& one) noexcept {
  int at = count_;
  while (at > 0 && one.better_than(best_[at - 1])) --at;
  if (at == kMost) return;
  if (count_ < kMost) ++count_;
  std::move_backward(best_.begin() + at, best_.begin() + count_ - 1, best_.begin() + count_);
  best_[at] = one;
}

SerialClosedForm::Candidate SerialClosedForm::candidate(const Question& question,
                                                        const SrsAngles& theta) const noexcept {
  SrsAngles angles = theta;
  if (question.match == Match::position) {  // the hand stays as it is, or as it is told
    std::copy(question.near.begin() + 4, question.near.end(), angles.begin() + 4);
  }
  Candidate result;
  result.joints.resize(home_.size());
  srs_->joints_of(angles, result.joints);
  result.within = true;
  for (Eigen::Index j = 0; j < result.joints.size(); ++j) {
    double& q = result.joints[j];
    q = settled(q, range_[j], question.start[j]);
    result.within = result.within && range_[j].contains(q, kLimitTolerance);
  }
  if (question.redundancy.rule == Redundancy::Rule::maximise && !srs_->theta3_locked) {
    SerialForward forward;
    if (question.redundancy.figure != RedundancyFigure::limit_distance) {
      chain_.forward(result.joints, forward);
    } else {
      forward.jacobian.resize(6, result.joints.size());  // not looked at
    }
    result.objective = -redundancy_figure(question.redundancy.figure, question.match, forward.jacobian,
                                          result.joints, range_, length_);
  } else {
    result.objective = (result.joints - question.start).squaredNorm();
  }
  return result;
}

SrsAngles SerialClosedForm::angles_at(const Question& question, double elbow, int branch) const noexcept {
  return srs_on_circle(srs_->lengths, question.wrist, question.circle, elbow, branch, question.near);
}

SerialClosedForm::Candidate SerialClosedForm::at(const Question& question, double elbow,
                                                 int branch) const noexcept {
  return candidate(question, angles_at(question, elbow, branch));
}

// Where on the circle, from an elbow on, a joint of some branch is at an end of its range; and the circle's
// ends.
SerialClosedForm::Cuts SerialClosedForm::cuts_of(const Question& question, double own) const noexcept {
  Cuts cuts;
  cuts.at[cuts.count++] = 0.0;
  cuts.at[cuts.count++] = kTurn;
  const int last = question.match == Match::position ? 3 : 7;  // the hand does not move
  for (int i = 0; i < last; ++i) {
    if (i == 3 || srs_->joint[i] < 0) continue;
    const Interval& range = range_[srs_->joint[i]];
    for (const double end : {range.min, range.max}) {
      if (!(std::abs(end) < 1e5)) continue;
      const double angle = srs_->sign[i] * end + srs_->offset[i];
      const SrsElbows ends = srs_elbows_with(srs_->lengths, question.wrist, question.circle, i, angle);
      for (int e = 0; e < ends.count; ++e) {
        const double from_own = std::remainder(ends.elbow[e] - own, kTurn);
        cuts.at[cuts.count++] = from_own < 0.0 ? from_own + kTurn : from_own;
      }
    }
  }
  std::sort(cuts.at.begin(), cuts.at.begin() + cuts.count);
  return cuts;
}

// The best elbow of one branch. Where a joint is at an end of its range an arc of the circle ends; on each
// that is allowed, elbows are tried, and from the best of their neighbours the search goes on.
void SerialClosedForm::best_of_branch(const Question& question, int branch,
                                      Candidates& candidates) const noexcept {
  const double own = question.circle.angle_of_elbow(srs_->lengths, question.near);
  const auto [cut, cuts] = cuts_of(question, own);

  const auto here = [&](double elbow) { return at(question, own + elbow, branch); };
  bool some_allowed = false;
  for (int c = 0; c + 1 < cuts; ++c) some_allowed |= here(0.5 * (cut[c] + cut[c + 1])).within;
  Candidate best;
  double best_elbow = 0.0;
  bool any = false;
  const auto consider = [&](double elbow, const Candidate& one) {
    if (any && !one.better_than(best)) return;
    best = one;
    best_elbow = elbow;
    any = true;
  };
  for (int c = 0; c + 1 < cuts; ++c) {
    const double low = cut[c], high = cut[c + 1];
    if (high - low < 1e-12 || here(0.5 * (low + high)).within != some_allowed) continue;
    const int steps = std::max(2, static_cast<int>(std::ceil((high - low) / kStep)));
    const double step = (high - low) / steps;
    Candidate before, middle = here(low), after = here(low + step);
    consider(low, middle);
    for (int s = 1; s <= steps; ++s) {
      before = middle;
      middle = after;
      const double elbow = low + s * step;
      consider(elbow, middle);
      if (s < steps) after = here(elbow + step);
      const bool down = middle.better_than(before) || s == 1, up = s == steps || !after.better_than(middle);
      // At the first and the last step the minimum may lie between the end and its neighbour.
      if (!down || !up) continue;
      const double found = minimum(elbow - step, std::min(high, elbow + step), here);
      consider(found, here(found));
    }
  }
  if (question.redundancy.rule != Redundancy::Rule::maximise)
    polish(question, branch, own + best_elbow, false, best);
  candidates.add(best);
}

// Gauss-Newton on the squared distance, whose minimum comparing values finds to half the digits only.
// `beyond` lets joints leave their ranges. Whether it has come to rest.
bool SerialClosedForm::polish(const Question& question, int branch, double elbow, bool beyond,
                              Candidate& best) const noexcept {
  constexpr double kAtRest = 1e-7;
  double step = 1.0;
  for (int iteration = 0; iteration < 20; ++iteration) {
    constexpr double h = 1e-4;
    const ActiveVector along =
        (at(question, elbow + h, branch).joints - at(question, elbow - h, branch).joints) / (2.0 * h);
    step = along.dot(question.start - best.joints) / along.squaredNorm();
    if (!(std::abs(step) < kStep)) return false;
    const Candidate there = at(question, elbow + step, branch);
    const bool leaves = best.within && !there.within;
    if ((leaves && !beyond) || there.objective > best.objective + 1e-14 * (1.0 + best.objective)) break;
    best = there;
    elbow += step;
    if (std::abs(step) < 1e-14) break;
  }
  return std::abs(step) < kAtRest;
}

// The start's own branch, where the next posture is close by: what a control cycle asks, without a search.
// Where a joint is at the end of its range the nearest posture that is allowed has it there.
bool SerialClosedForm::follow(const Question& question, Candidates& candidates) const noexcept {
  constexpr double kClose = 0.2;  // of every joint [rad]
  const SrsAngles& near = question.near;
  const auto negative = [](double angle) { return std::remainder(angle, kTurn) < 0.0 ? 1 : 0; };
  const int branch = negative(near[5]) + 2 * negative(near[3]) + 4 * negative(near[1]);
  const double own = question.circle.angle_of_elbow(srs_->lengths, near);
  const auto close = [&](const Candidate& one) {
    return one.within && (one.joints - question.start).cwiseAbs().maxCoeff() < kClose;
  };
  Candidate best = at(question, own, branch);
  if (!polish(question, branch, own, true, best)) return false;
  if (!close(best)) {
    const Cuts cuts = cuts_of(question, own);
    for (int c = 0; c < cuts.count; ++c) {
      const Candidate edge = at(question, own + cuts.at[c], branch);
      if (close(edge) && edge.better_than(best)) best = edge;
    }
  }
  if (!close(best)) return false;
  candidates.add(best);
  return true;
}

// Every posture with a joint of the shoulder at an angle; of them only those with another, `also`, at its angle
// too.
SrsStatus SerialClosedForm::ask(const Question& question, SrsGiven joint, double angle, const Angle* also,
                                Candidates& candidates) const noexcept {
  const auto agrees = [&](const auto& theta) {
    return also == nullptr || gap(theta[static_cast<std::size_t>(also->joint) - 1], also->angle) < kSameAngle;
  };
  if (question.match == Match::position) {
    const SrsArmSolutions arms = srs_arm_inverse(srs_->lengths, question.wrist.position, joint, angle);
    for (int i = 0; i < arms.count; ++i) {
      if (!agrees(arms.theta[i])) continue;
      SrsAngles theta{};
      std::copy(arms.theta[i].begin(), arms.theta[i].end(), theta.begin());
      candidates.add(candidate(question, theta));
    }
    return arms.status;
  }
  const SrsSolutions all = srs_inverse(srs_->lengths, question.wrist, joint, angle, question.near[4]);
  for (int i = 0; i < all.count; ++i) {
    if (agrees(all.theta[i])) candidates.add(candidate(question, all.theta[i]));
  }
  return all.status;
}

SolveStatus SerialClosedForm::given(const Question& question, SrsGiven joint, double angle,
                                    Candidates& candidates) const noexcept {
  const SrsStatus status = ask(question, joint, angle, nullptr, candidates);
  switch (status) {
    case SrsStatus::solved:
    case SrsStatus::singular_wrist:
      return SolveStatus::reached;
    case SrsStatus::theta1_undefined:
    case SrsStatus::theta2_undefined: {
      // The wrist lies on that joint's axis, which may turn as it likes: it stays as it is.
      const SrsGiven open = status == SrsStatus::theta1_undefined ? SrsGiven::theta1 : SrsGiven::theta2;
      if (open == joint) return SolveStatus::degenerate;
      const Angle also{joint, angle};
      ask(question, open, question.near[static_cast<std::size_t>(open) - 1], &also, candidates);
      return candidates.count() > 0 ? SolveStatus::reached : SolveStatus::degenerate;
    }
    case SrsStatus::singular_elbow: {
      // Stretched or folded, theta3 is open and the others are decided.
      const int given = static_cast<int>(joint) - 1;
      Question open = question;
      open.near[given] = angle;
      for (int branch = 0; branch < 8; branch += question.match == Match::position ? 2 : 1) {
        const SrsAngles theta = angles_at(open, 0.0, branch);
        if (gap(theta[given], angle) < kSameAngle) candidates.add(candidate(question, theta));
      }
      return candidates.count() > 0 ? SolveStatus::reached : SolveStatus::unreachable;
    }
    default:
      return SolveStatus::unreachable;
  }
}

SolveStatus SerialClosedForm::keep(Question& question, Candidates& candidates) const noexcept {
  const int kept = question.redundancy.joint;
  const int joint =
      static_cast<int>(std::find(srs_->joint.begin(), srs_->joint.end(), kept) - srs_->joint.begin());
  const double value = question.redundancy.value.value_or(question.start[kept]);
  const double angle = srs_->sign[joint] * value + srs_->offset[joint];
  if (joint < 3) return given(question, SrsGiven(joint + 1), angle, candidates);
  if (joint == 3) {  // decided by the distance of the wrist: there is nothing to keep, it must agree
    if (gap(std::abs(std::remainder(angle, kTurn)), question.circle.bend) > kSameAngle) {
      return SolveStatus::unreachable;
    }
    const bool negative = std::remainder(angle, kTurn) < 0.0;
    for (int branch = 0; branch < 8; branch += question.match == Match::position ? 2 : 1) {
      if (((branch & 2) != 0) == negative) best_of_branch(question, branch, candidates);
    }
    return SolveStatus::reached;
  }
  if (question.match == Match::position) {  // the hand does not matter to it
    question.near[joint] = angle;
    for (int branch = 0; branch < 8; branch += 2) best_of_branch(question, branch, candidates);
    return SolveStatus::reached;
  }
  if (joint == 4 && question.circle.status == SrsStatus::singular_elbow) {
    // Stretched, theta3 + theta5 is decided, folded theta5 - theta3.
    const double sign = question.circle.bend < 0.5 * std::numbers::pi ? -1.0 : 1.0;
    for (int branch = 0; branch < 8; ++branch) {
      SrsAngles theta = angles_at(question, 0.0, branch);
      theta[2] += sign * (angle - theta[4]);
      theta[4] = angle;
      candidates.add(candidate(question, theta));
    }
    return SolveStatus::reached;
  }
  const SrsElbows elbows = srs_elbows_with(srs_->lengths, question.wrist, question.circle, joint, angle);
  for (int e = 0; e < elbows.count; ++e) {
    for (int branch = 0; branch < 8; ++branch) {
      SrsAngles theta = angles_at(question, elbows.elbow[e], branch);
      if (gap(theta[joint], angle) < kSameAngle) candidates.add(candidate(question, theta));
    }
  }
  return candidates.count() > 0 ? SolveStatus::reached : SolveStatus::unreachable;
}

SolveStatus SerialClosedForm::solve(Question& question, Candidates& candidates) const noexcept {
  if (question.circle.status != SrsStatus::solved && question.circle.status != SrsStatus::singular_elbow) {
    return SolveStatus::unreachable;
  }
  if (srs_->theta3_locked) return given(question, SrsGiven::theta3, srs_->offset[2], candidates);
  if (question.redundancy.rule == Redundancy::Rule::keep) return keep(question, candidates);
  const int step = question.match == Match::position ? 2 : 1;  // the wrist's branches are then one
  for (int branch = 0; branch < 8; branch += step) best_of_branch(question, branch, candidates);
  return SolveStatus::reached;
}

ClosedPosture SerialClosedForm::inverse(const Pose& tool, const SolveOptions& options,
                                        int branch) const noexcept {
  const ActiveVector start = options.start != nullptr ? options.start->active() : home_;
  Question question{.wrist = srs_->wrist_of(tool),
                    .match = options.match,
                    .redundancy = options.redundancy,
                    .start = start,
                    .near = srs_->angles_of(start)};
  question.circle = srs_elbow_circle(srs_->lengths, question.wrist.position);
  Candidates candidates;
  SolveStatus status = SolveStatus::reached;
  const bool may_follow = branch == 0 && options.start != nullptr && !srs_->theta3_locked &&
                          question.circle.status == SrsStatus::solved &&
                          options.redundancy.rule == Redundancy::Rule::nearest;
  if (!may_follow || !follow(question, candidates)) status = solve(question, candidates);
  if (status != SolveStatus::reached) {
    const bool kept = options.redundancy.rule == Redundancy::Rule::keep;
    return {.status = status, .joint = kept ? options.redundancy.joint : 0};
  }
  if (branch >= candidates.count()) return {.status = SolveStatus::unreachable};
  const ActiveVector& joints = candidates[branch].joints;
  const Pose reached = options.match == Match::position ? chain_.pose(joints) : tool;
  return {.status = SolveStatus::reached, .joints = joints, .tool = reached};
}

}  // namespace internal

std::shared_ptr<const ClosedForm> closed_form_of(const SerialDescription& arm) {
  if (auto positioning = positioning_closed_form(arm)) return positioning;
  if (arm.platform != PlatformFreedom::rigid) return nullptr;
  return std::make_shared<internal::SerialClosedForm>(arm, legs_of(arm).legs.front());
}

std::shared_ptr<const ClosedForm> closed_form_of(const LegsDescription& legs) {
  if (legs.platform != PlatformFreedom::rigid || legs.legs.size() != 1) return nullptr;
  const auto rows = rows_of(legs.legs.front());
  if (!rows) return nullptr;
  if (auto positioning = positioning_closed_form(*rows)) return positioning;
  return std::make_shared<internal::SerialClosedForm>(*rows, legs.legs.front());
}

}  // namespace zwidth
