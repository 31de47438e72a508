#include "zwidth/mechanism/serial_dynamics.h"

#include <Eigen/Cholesky>
#include <cassert>

#include "zwidth/math/lanes.h"
#include "zwidth/math/vector_trigonometry.h"

namespace zwidth {

// Vectors are in the frame of the link that they belong to; m, h and I are about that frame's origin o, so that
// f = m a_o + wdot x h + w x (w x h) and n = I wdot + w x I w + h x a_o.

struct SerialDynamics::Sines {
  std::array<double, kMaxActive> sine, cosine;
};

struct SerialDynamics::Motion {
  Vec w, wd, a;  // angular velocity and acceleration, acceleration of the origin
};

namespace {

template <class V>
[[gnu::always_inline]] inline V cross(const V& u, const V& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}
template <class V>
[[gnu::always_inline]] inline void add(V& to, const V& v) {
  to.x += v.x;
  to.y += v.y;
  to.z += v.z;
}
template <class V>
[[gnu::always_inline]] inline double dot(const V& u, const V& v) {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}
// From the inner link's frame into that of a link, and back.
template <class T, class V>
[[gnu::always_inline]] inline V to_link(const T& turn, double s, double c, const V& v) {
  const double x = dot(turn.x, v), y = dot(turn.y, v);
  return {c * x + s * y, c * y - s * x, dot(turn.z, v)};
}
template <class T, class V>
[[gnu::always_inline]] inline V to_inner(const T& turn, double s, double c, const V& v) {
  const double x = c * v.x - s * v.y, y = s * v.x + c * v.y;
  return {turn.x.x * x + turn.y.x * y + turn.z.x * v.z, turn.x.y * x + turn.y.y * y + turn.z.y * v.z,
          turn.x.z * x + turn.y.z * y + turn.z.z * v.z};
}
// Force, and moment about the origin, that move a body.
template <class I, class V>
[[gnu::always_inline]] inline void load(const I& body, const V& w, const V& wd, const V& a, V& f, V& n) {
  const V& h = body.moment;
  const V wh = cross(w, h), wwh = cross(w, wh), dh = cross(wd, h);
  f = {body.mass * a.x + dh.x + wwh.x, body.mass * a.y + dh.y + wwh.y, body.mass * a.z + dh.z + wwh.z};
  const auto times = [&body](const V& v) {
    return V{body.xx * v.x + body.xy * v.y + body.xz * v.z, body.xy * v.x + body.yy * v.y + body.yz * v.z,
             body.xz * v.x + body.yz * v.y + body.zz * v.z};
  };
  n = times(wd);
  add(n, cross(w, times(w)));
  add(n, cross(h, a));
}

// A frame whose z is the axis.
Matrix3 frame_along(const Vector3& axis) {
  if (axis == Vector3::UnitZ()) return Matrix3::Identity();
  Matrix3 frame;
  frame.col(2) = axis;
  frame.col(0) = axis.unitOrthogonal();
  frame.col(1) = axis.cross(Vector3(frame.col(0)));
  return frame;
}

}  // namespace

SerialDynamics::Inertia SerialDynamics::inertia_of(double mass, const Vector3& centre,
                                                   const Matrix3& inertia) noexcept {
  const Matrix3 I = inertia + mass * (centre.squaredNorm() * Matrix3::Identity() - centre * centre.transpose());
  return {mass, vec(mass * centre), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
}

std::optional<SerialDynamics> SerialDynamics::of(const Mechanism& mechanism) {
  if (mechanism.serial() == nullptr) return std::nullopt;
  SerialDynamics result;
  result.count_ = mechanism.joint_count();
  result.gravity_ = vec(mechanism.gravity());
  std::array<Matrix3, kMaxActive> frame;
  Matrix3 inner = Matrix3::Identity();
  for (int j = 0; j < result.count_; ++j) {
    const JointModel& joint = mechanism.joints()[j];
    Link& link = result.links_[j];
    frame[j] = frame_along(joint.axis);
    const Matrix3 turn = inner.transpose() * frame[j];
    link.turn = {vec(turn.col(0)), vec(turn.col(1)), vec(turn.col(2))};
    link.offset = vec(inner.transpose() * joint.offset);
    link.slides = joint.type == JointType::prismatic;
    link.drive = mechanism.drive_inertia()[j];
    inner = frame[j];
  }
  const LegModel& leg = mechanism.legs().front();
  const int last = result.count_ - 1;
  const Vector3 tool = leg.tip - leg.platform_rotation * leg.platform_point;
  result.tool_ = vec(frame[last].transpose() * tool);

  for (const BodyModel& body : mechanism.bodies()) {
    const int turner = body.joint < 0 ? last : body.turns_with;
    Vector3 centre = body.centre;
    Matrix3 inertia = body.inertia;
    if (body.joint < 0) {
      centre = tool + leg.platform_rotation * centre;
      inertia = leg.platform_rotation * inertia * leg.platform_rotation.transpose();
    }
    const Inertia own = inertia_of(body.mass, frame[turner].transpose() * centre,
                                   frame[turner].transpose() * inertia * frame[turner]);
    if (body.joint >= 0 && body.joint != turner) {
      result.hung_.push_back({body.joint, turner, vec(frame[body.joint].transpose() * body.pivot), own});
      continue;
    }
    Link& link = result.links_[turner];
    Inertia& sum = link.body;
    link.empty = false;
    sum.mass += own.mass;
    add(sum.moment, own.moment);
    sum.xx += own.xx, sum.yy += own.yy, sum.zz += own.zz;
    sum.xy += own.xy, sum.xz += own.xz, sum.yz += own.yz;
  }
  return result;
}

SerialDynamics::Vec SerialDynamics::carried(Vec v, int from, int to, const Sines& sines) const noexcept {
  for (; from < to; ++from) v = to_link(links_[from + 1].turn, sines.sine[from + 1], sines.cosine[from + 1], v);
  for (; from > to; --from) v = to_inner(links_[from].turn, sines.sine[from], sines.cosine[from], v);
  return v;
}

template <bool weight>
[[gnu::always_inline]] inline void SerialDynamics::run(const Sines& sines, const double* joints,
                                                       const double* rate, const double* acceleration,
                                                       const double* push, double* torque) const noexcept {
  std::array<Vec, kMaxActive> force, moment;
  std::array<Motion, kMaxActive> motions;
  Vec w, wd, a;
  if constexpr (weight) a = {-gravity_.x, -gravity_.y, -gravity_.z};
  for (int j = 0; j < count_; ++j) {
    const Link& link = links_[j];
    const double s = sines.sine[j], c = sines.cosine[j], qd = rate[j], qdd = acceleration[j];
    const Vec wp = cross(w, link.offset);
    add(a, cross(wd, link.offset));
    add(a, cross(w, wp));
    w = to_link(link.turn, s, c, w);
    wd = to_link(link.turn, s, c, wd);
    a = to_link(link.turn, s, c, a);
    if (link.slides) {
      const double q = joints[j];
      a.x += wd.y * q + w.z * w.x * q + 2.0 * w.y * qd;
      a.y += -wd.x * q + w.z * w.y * q - 2.0 * w.x * qd;
      a.z += -(w.x * w.x + w.y * w.y) * q + qdd;
    } else {
      wd.x += w.y * qd;
      wd.y -= w.x * qd;
      wd.z += qdd;
      w.z += qd;
    }
    motions[j] = {w, wd, a};
    if (link.empty) {
      force[j] = moment[j] = {};
    } else {
      load(link.body, w, wd, a, force[j], moment[j]);
    }
  }
  for (const Hung& one : hung_) {
    // The pin carries the force; the bars hand the moment to the link that turns the body.
    const Motion& carrier = motions[one.carrier];
    const Motion& turner = motions[one.turner];
    Vec at = carrier.a, f, n;
    add(at, cross(carrier.wd, one.pin));
    add(at, cross(carrier.w, cross(carrier.w, one.pin)));
    load(one.body, turner.w, turner.wd, carried(at, one.carrier, one.turner, sines), f, n);
    add(moment[one.turner], n);
    f = carried(f, one.turner, one.carrier, sines);
    add(force[one.carrier], f);
    add(moment[one.carrier], cross(one.pin, f));
  }
  const int last = count_ - 1;
  if (push != nullptr) {
    const Vec f =
        carried(to_link(links_[0].turn, sines.sine[0], sines.cosine[0], Vec{-push[0], -push[1], -push[2]}), 0,
                last, sines);
    const Vec n =
        carried(to_link(links_[0].turn, sines.sine[0], sines.cosine[0], Vec{-push[3], -push[4], -push[5]}), 0,
                last, sines);
    add(force[last], f);
    add(moment[last], n);
    add(moment[last], cross(tool_, f));
  }
  for (int j = last; j >= 0; --j) {
    const Link& link = links_[j];
    if (link.slides) {
      torque[j] = force[j].z;
      moment[j].x -= joints[j] * force[j].y;
      moment[j].y += joints[j] * force[j].x;
    } else {
      torque[j] = moment[j].z;
    }
    torque[j] += link.drive * acceleration[j];
    if (j == 0) break;
    const Vec f = to_inner(link.turn, sines.sine[j], sines.cosine[j], force[j]);
    add(force[j - 1], f);
    add(moment[j - 1], to_inner(link.turn, sines.sine[j], sines.cosine[j], moment[j]));
    add(moment[j - 1], cross(link.offset, f));
  }
}

SerialDynamics::Sines SerialDynamics::sines_of(const double* joints) const noexcept {
  Sines sines;
  std::array<double, kMaxActive> angle;
  for (int j = 0; j < kMaxActive; ++j) angle[j] = j < count_ && !links_[j].slides ? joints[j] : 0.0;
  sine_cosines(angle, sines.sine, sines.cosine);
  return sines;
}

ZWIDTH_WIDE void SerialDynamics::mass_columns(const double* joints, double* columns) const noexcept {
  const Sines sines = sines_of(joints);
  std::array<double, kMaxActive> still{}, unit{};
  for (int j = 0; j < count_; ++j) {
    unit[j] = 1.0;
    run<false>(sines, joints, still.data(), unit.data(), nullptr, columns + j * count_);
    unit[j] = 0.0;
  }
}

ZWIDTH_WIDE void SerialDynamics::inverse_flat(const double* joints, const double* rate,
                                              const double* acceleration, const double* push,
                                              double* torque) const noexcept {
  const Sines sines = sines_of(joints);
  run<true>(sines, joints, rate, acceleration, push, torque);
}

void SerialDynamics::inverse(const ActiveVector& joints, const ActiveVector& rate,
                             const ActiveVector& acceleration, const ToolVector& push,
                             ActiveVector& torque) const noexcept {
  assert(joints.size() == count_ && rate.size() == count_ && acceleration.size() == count_);
  assert(push.size() == 0 || push.size() == 6);
  torque.resize(count_);
  inverse_flat(joints.data(), rate.data(), acceleration.data(), push.size() > 0 ? push.data() : nullptr,
               torque.data());
}

ActiveVector SerialDynamics::inverse(const ActiveVector& joints, const ActiveVector& rate,
                                     const ActiveVector& acceleration, const ToolVector& push) const noexcept {
  ActiveVector torque;
  inverse(joints, rate, acceleration, push, torque);
  return torque;
}

ActiveMatrix SerialDynamics::mass_matrix(const ActiveVector& joints) const noexcept {
  assert(joints.size() == count_);
  ActiveMatrix M(count_, count_);
  mass_columns(joints.data(), M.data());
  return 0.5 * (M + M.transpose());
}

ActiveVector SerialDynamics::forward(const ActiveVector& joints, const ActiveVector& rate,
                                     const ActiveVector& torque, const ToolVector& push) const noexcept {
  const ActiveVector still = ActiveVector::Zero(count_);
  const ActiveVector driving = torque - inverse(joints, rate, still, push);
  return mass_matrix(joints).ldlt().solve(driving);
}

}  // namespace zwidth
