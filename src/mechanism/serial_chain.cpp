#include "zwidth/mechanism/serial_chain.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "zwidth/math/vector_trigonometry.h"

namespace zwidth {
namespace {

// Three doubles without Eigen's alignment: the recursion below then stays in registers.
struct Vec {
  double x, y, z;
};
Vec combined(double a, const Vec& u, double b, const Vec& v) {
  return {a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
}
void advance(Vec& point, double length, const Vec& direction) {
  point.x += length * direction.x;
  point.y += length * direction.y;
  point.z += length * direction.z;
}
Vec negative(const Vec& v) {
  return {-v.x, -v.y, -v.z};
}

SerialChain::Row::Twist twist_of(double alpha) {
  using Twist = SerialChain::Row::Twist;
  constexpr double kQuarter = 0.5 * std::numbers::pi, kSame = 1e-15;  // an angle typed as "90 deg" is exact
  if (alpha == 0.0) return Twist::none;
  if (std::abs(alpha - kQuarter) < kSame) return Twist::quarter;
  if (std::abs(alpha + kQuarter) < kSame) return Twist::minus_quarter;
  return Twist::other;
}

}  // namespace

SerialChain::SerialChain(const SerialDescription& description) {
  for (const SerialJointDescription& one : description.joints) {
    Row row;
    row.theta = one.theta;
    row.d = one.d;
    row.a = one.a;
    row.twist = twist_of(one.alpha);
    row.sin_alpha = std::sin(one.alpha);
    row.cos_alpha = std::cos(one.alpha);
    row.sin_theta = std::sin(one.theta);
    row.cos_theta = std::cos(one.theta);
    if (one.type != SerialJointType::fixed) {
      assert(joint_count_ < kMaxActive);
      row.joint = joint_count_++;
      row.slides = one.type == SerialJointType::prismatic;
      if (row.slides) {
        slides_[row.joint] = 1;
      } else {
        offset_[row.joint] = one.theta;
      }
    }
    rows_.push_back(row);
  }
}

SerialChain SerialChain::position_part() const {
  SerialChain part = *this;
  while (!part.rows_.empty()) {
    const Row& last = part.rows_.back();
    if (last.slides || last.d != 0.0 || last.a != 0.0) break;
    if (last.joint >= 0) --part.joint_count_;
    part.rows_.pop_back();
  }
  return part;
}

template <bool with_jacobian>
void SerialChain::run(const ActiveVector& joints, Pose& tool, Jacobian* jacobian) const noexcept {
  assert(joints.size() == joint_count_);
  // All sines and cosines at once, of a full vector: unused lanes cost nothing.
  std::array<double, kMaxActive> angle, sine, cosine;
  for (int j = 0; j < kMaxActive; ++j) {
    angle[j] = j < joint_count_ && slides_[j] == 0 ? joints[j] + offset_[j] : 0.0;
  }
  sine_cosines(angle, sine, cosine);

  Vec x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0}, p{0.0, 0.0, 0.0};
  std::array<Vec, kMaxActive> axis, point;  // of each joint
  for (const Row& row : rows_) {
    double s = row.sin_theta, c = row.cos_theta, d = row.d;
    if (row.joint >= 0) {
      if constexpr (with_jacobian) {
        axis[row.joint] = z;
        point[row.joint] = p;
      }
      if (row.slides) {
        d += joints[row.joint];
      } else {
        s = sine[row.joint];
        c = cosine[row.joint];
      }
    }
    if (d != 0.0) advance(p, d, z);
    const Vec untwisted = combined(c, y, -s, x);
    x = combined(c, x, s, y);
    y = untwisted;
    if (row.a != 0.0) advance(p, row.a, x);
    switch (row.twist) {
      case Row::Twist::none:
        break;
      case Row::Twist::quarter: {
        const Vec turned = z;
        z = negative(y);
        y = turned;
        break;
      }
      case Row::Twist::minus_quarter: {
        const Vec turned = negative(z);
        z = y;
        y = turned;
        break;
      }
      case Row::Twist::other: {
        const Vec turned = combined(row.cos_alpha, y, row.sin_alpha, z);
        z = combined(row.cos_alpha, z, -row.sin_alpha, y);
        y = turned;
        break;
      }
    }
  }
  tool.position = {p.x, p.y, p.z};
  tool.rotation.col(0) = Vector3(x.x, x.y, x.z);
  tool.rotation.col(1) = Vector3(y.x, y.y, y.z);
  tool.rotation.col(2) = Vector3(z.x, z.y, z.z);
  if constexpr (with_jacobian) {
    jacobian->resize(6, joint_count_);
    double* column = jacobian->data();
    for (int j = 0; j < joint_count_; ++j, column += 6) {
      const Vec& w = axis[j];
      if (slides_[j] != 0) {
        column[0] = w.x, column[1] = w.y, column[2] = w.z;
        column[3] = column[4] = column[5] = 0.0;
        continue;
      }
      const Vec r{p.x - point[j].x, p.y - point[j].y, p.z - point[j].z};
      column[0] = w.y * r.z - w.z * r.y;
      column[1] = w.z * r.x - w.x * r.z;
      column[2] = w.x * r.y - w.y * r.x;
      column[3] = w.x, column[4] = w.y, column[5] = w.z;
    }
  }
}

void SerialChain::forward(const ActiveVector& joints, SerialForward& result) const noexcept {
  run<true>(joints, result.tool, &result.jacobian);
}

SerialForward SerialChain::forward(const ActiveVector& joints) const noexcept {
  SerialForward result;
  forward(joints, result);
  return result;
}

Pose SerialChain::pose(const ActiveVector& joints) const noexcept {
  Pose tool;
  run<false>(joints, tool, nullptr);
  return tool;
}

}  // namespace zwidth
