#include "zwidth/mechanism/internal/posture_builder.h"

#include <cmath>
#include <numbers>

#include "zwidth/math/lanes.h"
#include "zwidth/math/trigonometry.h"
#include "zwidth/math/vector_trigonometry.h"

namespace zwidth::internal {
namespace {

// While legs are placed, vectors are lanes of which the fourth is idle, and an orientation R three of them, its
// columns x, y and z: separate variables, because an object that holds them would go through memory at every
// joint.

// R v.
[[gnu::always_inline]] inline void map(const Lanes& x, const Lanes& y, const Lanes& z, const Vector3& v,
                                       Lanes& to) {
  to = v[0] * x + v[1] * y + v[2] * z;
}

// R times the rotation about the unit vector u, which R maps to `axis` (Rodrigues).
[[gnu::always_inline]] inline void turn(Lanes& x, Lanes& y, Lanes& z, const Vector3& u, const Lanes& axis,
                                        double s, double c) {
  const double v = 1.0 - c, s0 = s * u[0], s1 = s * u[1], s2 = s * u[2];
  const Lanes turned_x = c * x + s2 * y - s1 * z + (v * u[0]) * axis;
  const Lanes turned_y = c * y + s0 * z - s2 * x + (v * u[1]) * axis;
  z = c * z + s1 * x - s0 * y + (v * u[2]) * axis;
  x = turned_x;
  y = turned_y;
}

// A vector that is followed by another number, which is written later.
[[gnu::always_inline]] inline void store(const Lanes& v, Vector3& where) {
  lanes_at(where.data()) = v;
}
[[gnu::always_inline]] inline void store(const Lanes& x, const Lanes& y, const Lanes& z, Matrix3& where) {
  lanes_at(where.data()) = x;
  lanes_at(where.data() + 3) = y;
  lanes_at(where.data() + 6) = z;
}

}  // namespace

struct PostureBuilder::Turns {
  std::array<double, kMaxJoints> sine, cosine;

  Turns(const JointVector& joints, int first, int count) {
    const auto part = [first, count](auto& of) {
      return std::span(of.data() + first, static_cast<std::size_t>(count));
    };
    sine_cosines(part(joints), part(sine), part(cosine));
  }
};

inline void PostureBuilder::place(Posture& posture, int l, const Turns& turns) noexcept {
  const Mechanism& mechanism = *posture.mechanism_;
  const LegModel& leg = mechanism.legs()[l];
  // R, the orientation that the next joint's axis sits in, and that of the link that carries the next joint's
  // point.
  Lanes Rx = {1.0, 0.0, 0.0, 0.0}, Ry = {0.0, 1.0, 0.0, 0.0}, Rz = {0.0, 0.0, 1.0, 0.0};
  Lanes link_x = Rx, link_y = Ry, link_z = Rz;
  Lanes p{}, axis, step;
  for (int j = leg.first; j < leg.first + leg.count; ++j) {
    const JointModel& joint = mechanism.joints()[j];
    map(link_x, link_y, link_z, joint.offset, step);
    p += step;
    map(Rx, Ry, Rz, joint.axis, axis);
    if (joint.type == JointType::revolute) turn(Rx, Ry, Rz, joint.axis, axis, turns.sine[j], turns.cosine[j]);
    link_x = Rx;
    link_y = Ry;
    link_z = Rz;
    if (joint.type == JointType::prismatic) p += posture.joints_[j] * axis;
    if (joint.type == JointType::parallelogram)
      turn(link_x, link_y, link_z, joint.axis, axis, turns.sine[j], turns.cosine[j]);

    Posture::Link& link = posture.links_[j];
    store(p, link.point);
    store(axis, link.axis);
    store(link_x, link_y, link_z, link.rotation);
  }
  Posture::Tip& tip = posture.tips_[l];
  map(link_x, link_y, link_z, leg.tip, step);
  p += step;
  store(p, tip.point);
  map(Rx, Ry, Rz, leg.platform_rotation.col(0), link_x);
  map(Rx, Ry, Rz, leg.platform_rotation.col(1), link_y);
  map(Rx, Ry, Rz, leg.platform_rotation.col(2), link_z);
  store(link_x, link_y, link_z, tip.rotation);
}

ZWIDTH_WIDE void PostureBuilder::place_leg(Posture& posture, int l) noexcept {
  const LegModel& leg = posture.mechanism_->legs()[l];
  place(posture, l, Turns(posture.joints_, leg.first, leg.count));
}

ZWIDTH_WIDE void PostureBuilder::place_legs(Posture& posture) noexcept {
  const Turns turns(posture.joints_, 0, posture.mechanism_->joint_count());
  for (int l = 0; l < static_cast<int>(posture.mechanism_->legs().size()); ++l) place(posture, l, turns);
}

int closure_error(const Posture& posture, int l, std::array<double, 6>& error) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const Matrix3& R = posture.tool().rotation;
  const Vector3 &c = leg.platform_point, &tip = posture.leg_tip(l), &p = posture.tool().position;
  for (int i = 0; i < 3; ++i) error[i] = tip[i] - p[i] - (R(i, 0) * c[0] + R(i, 1) * c[1] + R(i, 2) * c[2]);
  if (leg.attachment == Attachment::spherical) return 3;
  const Vector3 turn = rotation_between(R, posture.leg_tip_rotation(l));
  for (int i = 0; i < 3; ++i) error[3 + i] = turn[i] * mechanism.characteristic_length();
  return 6;
}

void closure_column(const Posture& posture, int l, int j, std::array<double, 6>& column) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  const double length = mechanism.characteristic_length();
  const Vector3 &axis = posture.joint_axis(j), &tip = posture.leg_tip(l), &point = posture.joint_point(j);
  // Number by number: vectors would go through memory.
  const double ax = axis[0], ay = axis[1], az = axis[2];
  double x = tip[0] - point[0], y = tip[1] - point[1], z = tip[2] - point[2];
  switch (mechanism.joints()[j].type) {
    case JointType::prismatic:
      column = {ax, ay, az, 0.0, 0.0, 0.0};
      return;
    case JointType::revolute:
      column = {ay * z - az * y, az * x - ax * z, ax * y - ay * x, ax * length, ay * length, az * length};
      return;
    case JointType::parallelogram: {
      const bool last = j + 1 == leg.first + leg.count;
      const Vector3 bar = posture.link_rotation(j) * (last ? leg.tip : mechanism.joints()[j + 1].offset);
      x = bar[0], y = bar[1], z = bar[2];
      column = {ay * z - az * y, az * x - ax * z, ax * y - ay * x, 0.0, 0.0, 0.0};
      return;
    }
  }
}

void platform_columns(const Posture& posture, int l, std::array<std::array<double, 6>, 6>& columns) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const std::span<const int> axes = mechanism.tool_axes();
  for (std::size_t c = 0; c < axes.size(); ++c) {
    columns[c].fill(0.0);
    columns[c][axes[c]] = 1.0;
    if (axes[c] < 3) continue;
    const Vector3 arm = posture.tool().rotation * mechanism.legs()[l].platform_point;
    const Vector3 linear = Vector3::Unit(axes[c] - 3).cross(arm) / mechanism.characteristic_length();
    for (int i = 0; i < 3; ++i) columns[c][i] = linear[i];
  }
}

Vector3 rotation_between(const Matrix3& from, const Matrix3& to) noexcept {
  // Skew part and trace of R = to from^T, column by column.
  double sx = 0.0, sy = 0.0, sz = 0.0, trace = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double ax = from(0, k), ay = from(1, k), az = from(2, k), bx = to(0, k), by = to(1, k), bz = to(2, k);
    sx += ay * bz - az * by;
    sy += az * bx - ax * bz;
    sz += ax * by - ay * bx;
    trace += ax * bx + ay * by + az * bz;
  }
  const Vector3 sine(0.5 * sx, 0.5 * sy, 0.5 * sz);
  const double s2 = 0.25 * (sx * sx + sy * sy + sz * sz), c = 0.5 * (trace - 1.0);
  // asin(s)/s by its series: what is left out is below 1e-17.
  if (c > 0.0 && s2 < 1e-4) return sine * (1.0 + s2 * (1.0 / 6.0 + s2 * (3.0 / 40.0 + s2 * (15.0 / 336.0))));
  const double s = std::sqrt(s2);
  if (s > 1e-6) return sine * (std::atan2(s, c) / s);
  const Eigen::AngleAxisd half_turn(to * from.transpose());  // near pi the skew part says nothing of the axis
  return half_turn.axis() * half_turn.angle();
}

Matrix3 turned_by(const Vector3& turn, const Matrix3& R) noexcept {
  const double angle = turn.norm();
  if (angle == 0.0) return R;
  const auto [s, c] = sine_cosine(angle);
  const Vector3 u = turn / angle;
  return c * R + s * (cross_matrix(u) * R) + (1.0 - c) * u * (u.transpose() * R);
}

double wrapped(const JointModel& joint, double value) noexcept {
  if (joint.type == JointType::prismatic) return value;
  constexpr double turn = 2.0 * std::numbers::pi;
  const double angle = std::abs(value) < std::numbers::pi ? value : std::remainder(value, turn);
  for (const double candidate : {angle, angle + turn, angle - turn}) {
    if (joint.range.contains(candidate, 1e-9)) return candidate;
  }
  return angle;
}

}  // namespace zwidth::internal
