#include "zwidth/mechanism/wrist.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace zwidth {
namespace {

constexpr double kSame = 1e-9;       // of directions, and of positions relative to the arm's size
constexpr double kRounding = 1e-12;  // by which a cosine may be beyond 1
constexpr double kTurned = 1e-7;     // an arm near a singularity knows its turning to half the digits

double wrapped(double angle) {
  const double turned = std::remainder(angle, 2.0 * std::numbers::pi);
  return turned <= -std::numbers::pi ? std::numbers::pi : turned;
}

Matrix3 about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Vector3 across(const Vector3& axis, const Vector3& v) {
  return v - axis * axis.dot(v);
}

// Angle about an axis that brings what of `from` lies across it to what of `to` does (Paden & Kahan's first
// subproblem).
double angle_between(const Vector3& axis, const Vector3& from, const Vector3& to) {
  const Vector3 u = across(axis, from), v = across(axis, to);
  return std::atan2(axis.dot(u.cross(v)), u.dot(v));
}

// Angle of a turn about an axis, whatever else the turn does.
double angle_about(const Vector3& axis, const Matrix3& turn) {
  const Vector3 u = axis.unitOrthogonal();
  return angle_between(axis, u, turn * u);
}

double off_identity(const Matrix3& turn) {
  return (turn - Matrix3::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace

std::optional<Wrist> Wrist::of(const LegDescription& leg, std::size_t first) {
  if (leg.joints.size() < first || leg.joints.size() > first + kMostJoints) return std::nullopt;
  Wrist wrist;
  double size = 0.0;
  for (const JointDescription& joint : leg.joints) size = std::max(size, (leg.tip - joint.point).norm());
  std::array<Vector3, kMostJoints> point;
  for (std::size_t j = first; j < leg.joints.size(); ++j) {
    const JointDescription& joint = leg.joints[j];
    if (joint.type != JointType::revolute || !joint.active) return std::nullopt;
    wrist.axis_[wrist.count_] = joint.axis.normalized();
    point[wrist.count_++] = joint.point;
  }
  const auto& a = wrist.axis_;
  for (int j = 1; j < wrist.count_; ++j) {
    if (a[j].cross(a[j - 1]).norm() < kSame) return std::nullopt;
  }
  wrist.centre_ = leg.tip;
  if (wrist.count_ == 1) wrist.centre_ = point[0] + a[0] * a[0].dot(leg.tip - point[0]);
  if (wrist.count_ >= 2) {
    // The point of the first axis that is nearest to the second.
    const Vector3 normal = a[0].cross(a[1]), apart = point[1] - point[0];
    if (std::abs(apart.dot(normal.normalized())) > kSame * size) return std::nullopt;
    wrist.centre_ = point[0] + a[0] * apart.cross(a[1]).dot(normal) / normal.squaredNorm();
  }
  for (int j = 0; j < wrist.count_; ++j) {
    if (across(a[j], wrist.centre_ - point[j]).norm() > kSame * size) return std::nullopt;
  }
  // The tip itself, if that is where they meet, to the last digit.
  if ((wrist.centre_ - leg.tip).norm() < kSame * size) wrist.centre_ = leg.tip;
  return wrist;
}

Wrist::Solutions Wrist::inverse(const Matrix3& turn, const Angles& near) const noexcept {
  Solutions solutions;
  const auto& a = axis_;
  // Adds a solution whose first joints are known; the last follows from what is left of the turn.
  const auto add = [&](Angles angles) {
    Matrix3 rest = turn;
    for (int j = 0; j + 1 < count_; ++j) rest = about(a[j], -angles[j]) * rest;
    if (count_ > 0) {
      angles[count_ - 1] = wrapped(angle_about(a[count_ - 1], rest));
      rest = about(a[count_ - 1], -angles[count_ - 1]) * rest;
    }
    if (!(off_identity(rest) < kTurned)) return;
    solutions.angles[solutions.count++] = angles;
    solutions.status = SolveStatus::reached;
  };
  if (count_ < 2) {
    add({});
    return solutions;
  }
  const Vector3 last = turn * a[count_ - 1];  // its own turn leaves the last axis where it is
  if (count_ == 2) {
    add({wrapped(angle_between(a[0], a[1], last))});
    return solutions;
  }
  // The middle joint decides the angle between the outer axes: A cos q + B sin q + C = a1 . last.
  const Vector3 c = across(a[1], a[2]);
  const double A = a[0].dot(c), B = a[0].dot(a[1].cross(c)), C = a[0].dot(a[1]) * a[1].dot(a[2]);
  const double amplitude = std::hypot(A, B);
  const double cosine = (a[0].dot(last) - C) / amplitude;
  if (!(std::abs(cosine) <= 1.0 + kRounding)) return solutions;
  const double middle = std::atan2(B, A), apart = std::acos(std::clamp(cosine, -1.0, 1.0));
  for (const double q : {middle + apart, middle - apart}) {
    const Vector3 from = about(a[1], q) * a[2];
    const bool aligned = across(a[0], from).norm() < kTurned;
    add({aligned ? near[0] : wrapped(angle_between(a[0], from, last)), wrapped(q)});
  }
  return solutions;
}

}  // namespace zwidth
