#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "zwidth/description/description.h"

/// Platforms on several legs that move and turn, each with an inverse of its own that knows nothing of the
/// general solver.

namespace zwidth::test {

/// Six struts between two plates. All joints are zero with the upper plate at (0, 0, height), not turned.
struct Hexapod {
  std::array<Vector3, 6> base, plate;  ///< ends of the struts; the upper ones from the middle of the plate [m]
  double height = 0.2;
  double stroke = 0.04;  ///< of each strut, either way [m]

  Vector3 home() const { return {0.0, 0.0, height}; }
  double extension(int strut, const Pose& pose) const {
    const auto s = static_cast<std::size_t>(strut);
    return (pose.position + pose.rotation * plate[s] - base[s]).norm() - (home() + plate[s] - base[s]).norm();
  }
  bool reaches(const Pose& pose) const {
    for (int s = 0; s < 6; ++s) {
      if (std::abs(extension(s, pose)) > stroke) return false;
    }
    return true;
  }
  Description description() const {
    LegsDescription legs;
    for (std::size_t s = 0; s < 6; ++s) {
      LegDescription leg{.name = "strut" + std::to_string(s + 1)};
      leg.tip = home() + plate[s];
      leg.platform_point = plate[s];
      leg.attachment = Attachment::spherical;
      const Vector3 along = (leg.tip - base[s]).normalized(), turn = along.cross(Vector3::UnitZ()).normalized();
      const std::string n = std::to_string(s + 1);
      leg.joints.push_back({.name = "turn" + n, .axis = turn, .point = base[s]});
      leg.joints.push_back({.name = "tilt" + n, .axis = turn.cross(along), .point = base[s]});
      leg.joints.push_back({.name = "reach" + n,
                            .type = JointType::prismatic,
                            .active = true,
                            .axis = along,
                            .point = base[s] + 0.3 * (leg.tip - base[s]),
                            .range = {-stroke, stroke}});
      legs.legs.push_back(leg);
    }
    Description description;
    description.name = "hexapod";
    description.mechanism = legs;
    return description;
  }
};

/// Three legs of a hinge, a driven slide and a ball joint each under one plate: it heaves, tilts two ways, and
/// drifts sideways as it tilts. All joints are zero with the plate at (0, 0, height), not turned.
struct ThreeRps {
  double base_radius = 0.12, plate_radius = 0.08, height = 0.15;
  double stroke = 0.03;  ///< of each leg, either way [m]

  /// Height of the plate, not turned, with every leg longer by `extension`.
  double height_at(double extension) const {
    const double across = base_radius - plate_radius;
    return std::sqrt(std::pow(std::hypot(across, height) + extension, 2) - across * across);
  }
  Description description() const {
    LegsDescription legs;
    legs.platform = PlatformFreedom::rigid;
    for (int arm = 0; arm < 3; ++arm) {
      const double angle = 1.5707963267948966 + 2.0943951023931953 * arm;
      const Vector3 out(std::cos(angle), std::sin(angle), 0.0), aside(-out.y(), out.x(), 0.0);
      const std::string n = std::to_string(arm + 1);
      LegDescription leg{.name = "leg" + n};
      leg.platform_point = plate_radius * out;
      leg.tip = leg.platform_point + Vector3(0.0, 0.0, height);
      leg.attachment = Attachment::spherical;
      const Vector3 foot = base_radius * out;
      leg.joints.push_back({.name = "hinge" + n, .axis = aside, .point = foot});
      leg.joints.push_back({.name = "push" + n,
                            .type = JointType::prismatic,
                            .active = true,
                            .axis = (leg.tip - foot).normalized(),
                            .point = foot,
                            .range = {-stroke, stroke}});
      legs.legs.push_back(leg);
    }
    Description description;
    description.name = "three-rps";
    description.mechanism = legs;
    return description;
  }
};

inline Hexapod hexapod(double base_radius = 0.15, double plate_radius = 0.06, double height = 0.2,
                       double stroke = 0.04) {
  Hexapod result{.height = height, .stroke = stroke};
  for (std::size_t s = 0; s < 6; ++s) {
    // In pairs: feet near the corners of one triangle, ball joints near those of the other.
    const double corner = 2.0943951023931953 * static_cast<double>(s / 2), side = s % 2 == 0 ? -1.0 : 1.0;
    const double foot = corner + side * 0.21, ball = corner + side * 0.84;
    result.base[s] = base_radius * Vector3(std::cos(foot), std::sin(foot), 0.0);
    result.plate[s] = plate_radius * Vector3(std::cos(ball), std::sin(ball), 0.0);
  }
  return result;
}

/// Three arms of crank and coupler in a plane, whose cranks are driven. All joints are zero with the plate at
/// the origin, not turned, and every elbow on the right of the line from motor to plate.
struct ThreeRrr {
  double base_radius = 0.12, crank = 0.09, coupler = 0.09, plate_radius = 0.04;
  double half_range = 50.0 / 57.295779513082323;  ///< of each crank, either way [rad]

  static Vector3 direction(int arm) {
    const double angle = 1.5707963267948966 + 2.0943951023931953 * arm;
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  Vector3 motor(int arm) const { return base_radius * direction(arm); }
  Vector3 pin(int arm, const Pose& pose) const {
    return pose.position + plate_radius * (pose.rotation * direction(arm));
  }
  /// Intersection of the circles round motor and pin; NaN if they do not meet.
  Vector3 elbow(int arm, const Pose& pose) const {
    const Vector3 way = pin(arm, pose) - motor(arm);
    const double d = way.norm(), a = (d * d + crank * crank - coupler * coupler) / (2.0 * d);
    const Vector3 along = way / d, right(along.y(), -along.x(), 0.0);
    return motor(arm) + a * along + std::sqrt(crank * crank - a * a) * right;
  }
  double crank_angle(int arm, const Pose& pose) const {
    const Vector3 from = elbow(arm, {}) - motor(arm), to = elbow(arm, pose) - motor(arm);
    return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
  }
  /// Of the couplers' lines, as forces on the plate: zero where they meet in a point or are parallel.
  double determinant(const Pose& pose) const {
    Matrix3 rows;
    for (int arm = 0; arm < 3; ++arm) {
      const Vector3 tip = pin(arm, pose), line = (tip - elbow(arm, pose)) / coupler, r = tip - pose.position;
      rows.row(arm) << line.x(), line.y(), (r.x() * line.y() - r.y() * line.x()) / plate_radius;
    }
    return rows.determinant();
  }
  bool reaches(const Pose& pose) const {
    for (int arm = 0; arm < 3; ++arm) {
      if (!(std::abs(crank_angle(arm, pose)) <= half_range)) return false;
    }
    return determinant(pose) * determinant({}) > 0.0;
  }
  Description description() const {
    LegsDescription legs;
    legs.platform = PlatformFreedom::planar;
    for (int arm = 0; arm < 3; ++arm) {
      const std::string n = std::to_string(arm + 1);
      LegDescription leg{.name = "arm" + n};
      leg.tip = leg.platform_point = pin(arm, {});
      leg.attachment = Attachment::spherical;
      leg.joints.push_back({.name = "crank" + n,
                            .active = true,
                            .axis = Vector3::UnitZ(),
                            .point = motor(arm),
                            .range = {-half_range, half_range}});
      leg.joints.push_back({.name = "elbow" + n, .axis = Vector3::UnitZ(), .point = elbow(arm, {})});
      legs.legs.push_back(leg);
    }
    Description description;
    description.name = "three-rrr";
    description.mechanism = legs;
    return description;
  }
};

}  // namespace zwidth::test
