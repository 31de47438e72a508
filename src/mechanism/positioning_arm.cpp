#include "zwidth/mechanism/positioning_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/internal/joint_values.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/serial_chain.h"
#include "zwidth/mechanism/wrist.h"

namespace zwidth {
namespace {

constexpr double kSame = 1e-9;       // of directions, and of positions relative to the arm's size
constexpr double kRounding = 1e-12;  // by which a cosine may be beyond 1

// Of an angle a few turns off at most.
double wrapped(double angle) {
  while (angle > std::numbers::pi) angle -= 2.0 * std::numbers::pi;
  while (angle <= -std::numbers::pi) angle += 2.0 * std::numbers::pi;
  return angle;
}

bool parallel(const Vector3& a, const Vector3& b) {
  return a.cross(b).norm() < kSame;
}

}  // namespace

std::optional<PositioningArm> PositioningArm::of(const LegDescription& leg) {
  if (leg.joints.size() < 3) return std::nullopt;
  double size = 0.0;
  for (const JointDescription& joint : leg.joints) {
    if (!joint.active || joint.type == JointType::parallelogram) return std::nullopt;
    size = std::max(size, (leg.tip - joint.point).norm());
  }
  for (std::size_t j = 3; j < leg.joints.size(); ++j) {
    const JointDescription& wrist = leg.joints[j];
    if (wrist.type != JointType::revolute) return std::nullopt;
    if (wrist.axis.cross(leg.tip - wrist.point).norm() > kSame * size) return std::nullopt;
  }

  PositioningArm arm;
  for (int j = 0; j < 3; ++j) {
    if (leg.joints[j].type != JointType::prismatic) continue;
    if (arm.slide_ >= 0) return std::nullopt;
    arm.slide_ = j;
  }
  arm.first_ = arm.slide_ == 0 ? 1 : 0;
  arm.second_ = arm.slide_ < 0 ? 1 : 3 - arm.slide_ - arm.first_;
  const JointDescription &first = leg.joints[arm.first_], &second = leg.joints[arm.second_];
  arm.n_ = first.axis;
  if (!parallel(arm.n_, second.axis)) return std::nullopt;
  arm.p1_ = first.point;
  arm.p2_ = second.point;
  arm.tip_ = leg.tip;
  arm.sign_ = {1.0, 1.0, 1.0};
  arm.sign_[arm.second_] = arm.n_.dot(second.axis) < 0.0 ? -1.0 : 1.0;
  if (arm.slide_ >= 0) {
    const Vector3& along = leg.joints[arm.slide_].axis;
    if (!parallel(arm.n_, along)) return std::nullopt;
    arm.sign_[arm.slide_] = arm.n_.dot(along) < 0.0 ? -1.0 : 1.0;
  } else {
    arm.m_ = leg.joints[2].axis;
    arm.p3_ = leg.joints[2].point;
    if (std::abs(arm.m_.dot(arm.n_)) > kSame) return std::nullopt;
    if (arm.m_.cross(arm.tip_ - arm.p3_).norm() < kSame * size)
      return std::nullopt;  // it does not lift the tool
  }
  arm.e1_ = arm.n_.unitOrthogonal();
  arm.e2_ = arm.n_.cross(arm.e1_);
  // Without an upper arm the first two joints are one.
  const Planar u = arm.across(arm.p2_ - arm.p1_);
  arm.upper_ = std::hypot(u.x, u.y);
  arm.upper_angle_ = std::atan2(u.y, u.x);
  if (arm.upper_ < kSame * size) return std::nullopt;
  return arm;
}

// Adds the two elbows for a target r seen from the first joint, with w from the second joint to the tool:
// r = R(theta1) (u + R(theta2) w).
void PositioningArm::plane(const Planar& r, const Planar& w, double third,
                           PositioningSolutions& solutions) const noexcept {
  const double upper = upper_, fore = std::sqrt(w.x * w.x + w.y * w.y);
  const double reach = std::sqrt(r.x * r.x + r.y * r.y);
  const double size = upper + fore;
  if (fore < kRounding * size || (reach < kRounding * size && std::abs(upper - fore) < kRounding * size)) {
    if (solutions.status == SolveStatus::unreachable) solutions.status = SolveStatus::degenerate;
    return;
  }
  const double cosine = (reach * reach - upper * upper - fore * fore) / (2.0 * upper * fore);
  if (!(std::abs(cosine) <= 1.0 + kRounding)) return;
  const double c = std::clamp(cosine, -1.0, 1.0), sine = std::sqrt(1.0 - c * c), bend = std::atan2(sine, c);
  const double towards = std::atan2(r.y, r.x) - upper_angle_, aside = std::atan2(fore * sine, upper + fore * c);
  const double straight = upper_angle_ - std::atan2(w.y, w.x);
  for (const double side : {1.0, -1.0}) {
    std::array<double, 3>& q = solutions.joints[solutions.count++];
    q[first_] = wrapped(towards - side * aside);
    q[second_] = wrapped(sign_[second_] * (straight + side * bend));
    q[slide_ >= 0 ? slide_ : 2] = third;
  }
  solutions.status = SolveStatus::reached;
}

PositioningSolutions PositioningArm::inverse(const Vector3& position) const noexcept {
  PositioningSolutions solutions;
  const Planar r = across(position - p1_);
  if (slide_ >= 0) {
    plane(r, across(tip_ - p2_), sign_[slide_] * n_.dot(position - tip_), solutions);
    return solutions;
  }
  // The third joint alone sets the height: A cos q + B sin q = C.
  const Vector3 v = tip_ - p3_;
  const double A = n_.dot(v), B = n_.dot(m_.cross(v)), C = n_.dot(position - p3_);
  const double amplitude = std::hypot(A, B);
  if (!(std::abs(C) <= amplitude * (1.0 + kRounding)) || amplitude == 0.0) return solutions;
  const double middle = std::atan2(B, A), apart = std::acos(std::clamp(C / amplitude, -1.0, 1.0));
  const Vector3 along = m_ * m_.dot(v);
  for (const double q : {middle - apart, middle + apart}) {
    const Vector3 tip = p3_ + along + std::cos(q) * (v - along) + std::sin(q) * m_.cross(v);
    plane(r, across(tip - p2_), wrapped(q), solutions);
  }
  return solutions;
}

PositioningSolutions PositioningArm::inverse(const Vector3& position,
                                             PositioningMemory& memory) const noexcept {
  if (slide_ < 0) return inverse(position);
  const Planar across_it = across(position);
  if (memory.solutions.count < 0 || memory.across[0] != across_it.x || memory.across[1] != across_it.y) {
    memory.across = {across_it.x, across_it.y};
    memory.solutions = inverse(position);
    return memory.solutions;
  }
  PositioningSolutions solutions = memory.solutions;
  for (int s = 0; s < solutions.count; ++s)
    solutions.joints[static_cast<std::size_t>(s)][static_cast<std::size_t>(slide_)] =
        sign_[slide_] * n_.dot(position - tip_);
  return solutions;
}

// -------------------------------------------------------------------------------------------------- closed
// form

namespace {

class PositioningClosedForm final : public ClosedForm {
 public:
  /// `wrist` is empty of a tool that is a point, whose turning is not asked for.
  PositioningClosedForm(const PositioningArm& arm, const std::optional<Wrist>& wrist, const LegDescription& leg,
                        const SerialChain& chain)
      : arm_(arm), wrist_(wrist), leg_(leg), chain_(chain) {
    home_.resize(static_cast<Eigen::Index>(leg.joints.size()));
    for (Eigen::Index j = 0; j < home_.size(); ++j) home_[j] = leg.joints[static_cast<std::size_t>(j)].home;
    if (wrist_) hand_ = leg.platform_rotation.transpose() * (leg.tip - wrist_->centre());
  }

  ClosedPosture forward(const ActiveVector& active) const noexcept override {
    return {.status = SolveStatus::reached, .joints = active, .tool = chain_.pose(active)};
  }

  int branch_count() const noexcept override {
    return arm_.branch_count() * (wrist_ ? wrist_->branch_count() : 1);
  }
  // Of an arm with a wrist the place that is solved for is not the tool.
  PositioningForm parts() const noexcept {
    return wrist_ ? PositioningForm{} : PositioningForm{&arm_, &chain_};
  }

  // Of a rigid tool a position alone leaves joints open.
  bool covers(const SolveOptions& options) const noexcept override {
    return !wrist_ || options.match == Match::pose;
  }

  // Solutions within the joint ranges come first, then those near the start, or else near home. Joints that do
  // not matter stay.
  ClosedPosture inverse(const Pose& tool, const SolveOptions& options, int branch) const noexcept override {
    const Vector3 centre = wrist_ ? Vector3(tool.position - tool.rotation * hand_) : tool.position;
    const PositioningSolutions solutions = arm_.inverse(centre);
    if (solutions.status != SolveStatus::reached) return {.status = solutions.status, .joint = 0};
    const JointVector start = options.start != nullptr ? options.start->joints() : home_;
    Found found;
    for (int n = 0; n < solutions.count; ++n) {
      JointVector joints = start;
      for (int j = 0; j < 3; ++j) joints[j] = solutions.joints[n][j];
      if (!wrist_) {
        add(joints, start, found);
        continue;
      }
      Wrist::Angles near{};
      for (int w = 0; w < wrist_->joint_count(); ++w) near[w] = start[3 + w];
      const Matrix3 turn = turn_of(joints).transpose() * tool.rotation * leg_.platform_rotation.transpose();
      const Wrist::Solutions wrist = wrist_->inverse(turn, near);
      for (int k = 0; k < wrist.count; ++k) {
        for (int w = 0; w < wrist_->joint_count(); ++w) joints[3 + w] = wrist.angles[k][w];
        add(joints, start, found);
      }
    }
    if (branch >= found.count) return {.status = SolveStatus::unreachable, .joint = found.count > 0 ? 0 : 3};
    return forward(ActiveVector(found.joints[branch]));
  }

 private:
  static constexpr int kMost = 8;
  // The cheapest first.
  struct Found {
    int count = 0;
    std::array<JointVector, kMost> joints;
    std::array<double, kMost> cost{};
  };

  // Of the link that carries the wrist, against the zero posture.
  Matrix3 turn_of(const JointVector& joints) const noexcept {
    Matrix3 turn = Matrix3::Identity();
    for (int j = 0; j < 3; ++j) {
      const JointDescription& joint = leg_.joints[static_cast<std::size_t>(j)];
      if (joint.type == JointType::revolute)
        turn = turn * Eigen::AngleAxisd(joints[j], joint.axis.normalized()).toRotationMatrix();
    }
    return turn;
  }

  // Settles the angles in their ranges, and puts them where they belong among the others.
  void add(JointVector joints, const JointVector& start, Found& found) const noexcept {
    constexpr double kOutOfRange = 1e3;  // more than any way from the start
    double cost = 0.0;
    for (std::size_t j = 0; j < leg_.joints.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const JointDescription& joint = leg_.joints[j];
      if (joint.type == JointType::revolute) joints[i] = internal::settled(joints[i], joint.range, start[i]);
      if (!joint.range.contains(joints[i], internal::kLimitTolerance)) cost += kOutOfRange;
      cost += std::abs(joints[i] - start[i]);
    }
    int at = found.count++;
    for (; at > 0 && cost < found.cost[at - 1]; --at) {  // equal ones keep their order
      found.cost[at] = found.cost[at - 1];
      found.joints[at] = found.joints[at - 1];
    }
    found.cost[at] = cost;
    found.joints[at] = joints;
  }

  PositioningArm arm_;
  std::optional<Wrist> wrist_;
  LegDescription leg_;
  SerialChain chain_;
  JointVector home_;
  Vector3 hand_ = Vector3::Zero();  // from the wrist's centre to the tool point, in the tool's frame
};

}  // namespace

PositioningForm positioning_form_of(const Mechanism& mechanism) noexcept {
  const auto* form = dynamic_cast<const PositioningClosedForm*>(mechanism.closed_form());
  return form != nullptr ? form->parts() : PositioningForm{};
}

std::shared_ptr<const ClosedForm> positioning_closed_form(const SerialDescription& arm) {
  const LegDescription leg = legs_of(arm).legs.front();
  LegDescription to_centre = leg;
  std::optional<Wrist> wrist;
  if (arm.platform == PlatformFreedom::rigid) {
    wrist = Wrist::of(leg, 3);
    if (!wrist) return nullptr;
    to_centre.tip = wrist->centre();
  } else if (arm.platform != PlatformFreedom::point) {
    return nullptr;
  }
  const std::optional<PositioningArm> positioning = PositioningArm::of(to_centre);
  return positioning ? std::make_shared<PositioningClosedForm>(*positioning, wrist, leg, SerialChain(arm))
                     : nullptr;
}

}  // namespace zwidth
