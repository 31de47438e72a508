#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace zwidth {

using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Position and orientation of a frame, seen from the base frame.
struct Pose {
  Vector3 position = Vector3::Zero();      ///< [m], base frame
  Matrix3 rotation = Matrix3::Identity();  ///< columns are the frame's axes in the base frame
};

/// Velocity of a rigid body: linear velocity of a reference point, and angular velocity.
/// Stacks linear over angular wherever it becomes a six-vector.
struct Twist {
  Vector3 linear = Vector3::Zero();   ///< [m/s], base frame
  Vector3 angular = Vector3::Zero();  ///< [rad/s], base frame
};

/// Force and moment about a reference point. Stacks force over moment.
struct Wrench {
  Vector3 force = Vector3::Zero();   ///< [N], base frame
  Vector3 moment = Vector3::Zero();  ///< [N m], base frame, about the reference point
};

/// Power [W] of a wrench along a twist of the same reference point: the only meeting point of the two.
inline double power(const Wrench& wrench, const Twist& twist) {
  return wrench.force.dot(twist.linear) + wrench.moment.dot(twist.angular);
}

/// Closed interval [min, max].
struct Interval {
  double min = 0.0;
  double max = 0.0;
  double middle() const { return 0.5 * (min + max); }
  double width() const { return max - min; }
  bool contains(double value, double tolerance = 0.0) const {
    return value >= min - tolerance && value <= max + tolerance;
  }
  bool operator==(const Interval&) const = default;
};

/// The matrix S(v) with S(v) u = v x u.
inline Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

}  // namespace zwidth
