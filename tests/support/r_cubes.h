#pragma once

#include <numbers>
#include <random>

#include "support/deltas.h"

#include "zwidth/mechanism/r_cube.h"

namespace zwidth::test {

/// The lengths of the source's choice (Görgülü 2018, table 7.8).
inline RCubeGeometry published_r_cube() {
  return {.drive_link = 0.1117, .inner_link = 0.0741, .outer_link = 0.1218, .base_offset = 0.1117};
}

/// Lengths with which the arms reach the home position and some way around it.
inline RCubeGeometry random_r_cube(std::mt19937_64& random) {
  RCubeGeometry geometry;
  geometry.drive_link = uniform(random, 0.05, 0.2);
  geometry.base_offset = geometry.drive_link * uniform(random, 0.7, 1.3);
  // At home an arm spans base_offset along e_b and base_offset - 0 along e_c.
  const double span = std::hypot(geometry.base_offset, geometry.base_offset - geometry.drive_link);
  geometry.inner_link = span * uniform(random, 0.5, 1.2);
  geometry.outer_link = span * uniform(random, 0.8, 1.3);
  return geometry;
}

inline RCubeDescription described(const RCubeGeometry& geometry, const Interval& joint_range,
                                  int elbow_mode = -1) {
  return {.drive_link = geometry.drive_link,
          .inner_link = geometry.inner_link,
          .outer_link = geometry.outer_link,
          .base_offset = geometry.base_offset,
          .joint_range = joint_range,
          .elbow_mode = elbow_mode};
}

/// Görgülü 2018, table 7.8.
inline Description r_cube_device(const RCubeGeometry& geometry = published_r_cube(),
                                 const Interval& joint_range = {-0.5672, 0.5672}, int elbow_mode = -1) {
  Description description;
  description.name = "r-cube";
  description.mechanism = described(geometry, joint_range, elbow_mode);
  return description;
}

inline RCubeBranches random_branches(std::mt19937_64& random) {
  return r_cube_branches(static_cast<int>(random() % kRCubeBranches));
}

}  // namespace zwidth::test
