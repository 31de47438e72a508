#pragma once

#include <numbers>
#include <random>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

namespace zwidth::test {

/// The published lengths and window (Neal 2015, tables 3.1 and 5.1).
inline DeltaDescription published_delta() {
  return {.base_radius = 0.08,
          .upper_arm = 0.08,
          .forearm = 0.16,
          .platform_radius = 0.055,
          .joint_range = {-0.2 * std::numbers::pi, 7.0 / 15.0 * std::numbers::pi}};
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Lengths around those of desktop devices, with the forearm long enough for a useful window.
inline DeltaDescription random_delta(std::mt19937_64& random) {
  DeltaDescription delta;
  delta.base_radius = uniform(random, 0.03, 0.15);
  delta.platform_radius = uniform(random, 0.01, 0.08);
  delta.upper_arm = uniform(random, 0.05, 0.15);
  delta.forearm =
      delta.upper_arm * uniform(random, 1.5, 2.5) + std::abs(delta.base_radius - delta.platform_radius);
  delta.joint_range = {uniform(random, -0.7, -0.1), uniform(random, 0.3, 1.3)};
  return delta;
}

inline Vector3 random_angles(std::mt19937_64& random, const Interval& range) {
  return {uniform(random, range.min, range.max), uniform(random, range.min, range.max),
          uniform(random, range.min, range.max)};
}

inline Matrix3 thin_rod(double mass, double length, const Vector3& along) {
  return mass * length * length / 12.0 * (Matrix3::Identity() - along * along.transpose());
}

/// A delta with the masses of a light desktop device, some of them off the links' middle.
inline Description with_bodies(const DeltaDescription& delta) {
  Description description;
  description.name = "delta";
  description.mechanism = delta;
  Matrix3 arm_inertia = thin_rod(0.05, delta.upper_arm, Vector3::UnitX());
  arm_inertia(0, 0) = 2e-6;
  arm_inertia(0, 2) = arm_inertia(2, 0) = 1e-6;
  description.bodies = {
      {.on = "upper_arm", .mass = 0.05, .centre = {0.4 * delta.upper_arm, 0.0, -0.006}, .inertia = arm_inertia},
      {.on = "forearm",
       .mass = 0.03,
       .centre = {0.0, 0.0, 0.5 * delta.forearm},
       .inertia = thin_rod(0.03, delta.forearm, Vector3::UnitZ())},
      {.on = "platform", .mass = 0.06, .centre = {0.0, 0.0, 0.01}, .inertia = 1e-5 * Matrix3::Identity()}};
  return description;
}

/// The same delta with real parallelograms: revolute, revolute, parallelogram, revolute and a platform with all
/// six degrees of freedom, whose orientation nothing but the legs holds.
inline Description with_parallelograms(const DeltaDescription& delta) {
  Description description = with_bodies(delta);
  LegsDescription legs = legs_of(delta);
  legs.platform = PlatformFreedom::rigid;
  for (LegDescription& leg : legs.legs) {
    leg.joints[2].type = JointType::parallelogram;
    JointDescription wrist = leg.joints[1];
    wrist.name = "wrist" + leg.name;
    wrist.point = leg.tip;
    wrist.home = -(leg.joints[0].home + leg.joints[1].home);
    leg.joints.push_back(wrist);
    leg.attachment = Attachment::rigid;
  }
  description.bodies = spelled_out(description).bodies;
  description.mechanism = legs;
  return description;
}

}  // namespace zwidth::test
