#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "zwidth/mechanism/delta.h"

/// The delta as one writes it down from a textbook, with Eigen: trigonometric functions, matrix inverse and
/// singular values. What the library is measured against.

namespace bench {

struct Textbook {
  double d2, d3, d5;
  Eigen::Vector3d azimuth, low, high;

  Textbook(const zwidth::DeltaGeometry& geometry, const zwidth::Interval& range)
      : d2(geometry.upper_arm), d3(geometry.forearm), d5(geometry.offset()) {
    for (int i = 0; i < 3; ++i) azimuth[i] = zwidth::delta_azimuth(i);
    low.setConstant(range.min);
    high.setConstant(range.max);
  }

  Eigen::Vector3d centre(int i, double theta) const {
    const double radius = d5 + d2 * std::cos(theta);
    return {radius * std::cos(azimuth[i]), radius * std::sin(azimuth[i]), d2 * std::sin(theta)};
  }

  /// J = R^-1 D (Neal 2015, A.32).
  Eigen::Matrix3d jacobian(const Eigen::Vector3d& theta, const Eigen::Vector3d& p) const {
    Eigen::Matrix3d R, D = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d r = p - centre(i, theta[i]);
      const Eigen::Vector3d b(-d2 * std::sin(theta[i]) * std::cos(azimuth[i]),
                              -d2 * std::sin(theta[i]) * std::sin(azimuth[i]), d2 * std::cos(theta[i]));
      R.row(i) = r;
      D(i, i) = r.dot(b);
    }
    return R.inverse() * D;
  }

  /// Three spheres by elimination (A.12-A.21).
  Eigen::Vector3d forward(const Eigen::Vector3d& theta) const {
    const Eigen::Vector3d c1 = centre(0, theta[0]), c2 = centre(1, theta[1]), c3 = centre(2, theta[2]);
    const double w1 = c1.squaredNorm(), w2 = c2.squaredNorm(), w3 = c3.squaredNorm();
    const double x12 = c1.x() - c2.x(), x13 = c1.x() - c3.x(), y12 = c1.y() - c2.y(), y13 = c1.y() - c3.y();
    const double z12 = c1.z() - c2.z(), z13 = c1.z() - c3.z(), den = x13 * y12 - x12 * y13;
    const double ax = (z12 * y13 - z13 * y12) / den, bx = (-(w1 - w2) * y13 + (w1 - w3) * y12) / (2.0 * den);
    const double ay = (-z12 * x13 + z13 * x12) / den, by = ((w1 - w2) * x13 - (w1 - w3) * x12) / (2.0 * den);
    const double a = ax * ax + ay * ay + 1.0, b = 2.0 * (ax * (bx - c1.x()) + ay * (by - c1.y()) - c1.z());
    const double c = std::pow(bx - c1.x(), 2) + std::pow(by - c1.y(), 2) + c1.z() * c1.z() - d3 * d3;
    const double z = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    return {ax * z + bx, ay * z + by, z};
  }

  /// Angles of the outward roots; false if a leg does not reach, or a joint leaves its range.
  bool inverse(const Eigen::Vector3d& p, Eigen::Vector3d& theta) const {
    for (int i = 0; i < 3; ++i) {
      const double X = p.x() * std::cos(azimuth[i]) + p.y() * std::sin(azimuth[i]) - d5;
      const double T = p.y() * std::cos(azimuth[i]) - p.x() * std::sin(azimuth[i]);
      const double rho = std::hypot(X, p.z());
      const double K = (X * X + p.z() * p.z() + T * T + d2 * d2 - d3 * d3) / (2.0 * d2);
      if (std::abs(K) > rho) return false;
      theta[i] = std::atan2(p.z(), X) - std::acos(K / rho);
      if (theta[i] <= -M_PI) theta[i] += 2.0 * M_PI;
      if (theta[i] < low[i] || theta[i] > high[i]) return false;
    }
    return true;
  }

  static Eigen::Vector3d axis_forces(const Eigen::Matrix3d& J, double torque) {
    return torque * J.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
  }

  static double condition_number(const Eigen::Matrix3d& J) {
    const Eigen::Vector3d sigma = Eigen::JacobiSVD<Eigen::Matrix3d>(J).singularValues();
    return sigma[0] / sigma[2];
  }
};

}  // namespace bench
