#pragma once

#include <numbers>

#include "zwidth/description/description.h"

/// The three prototypes of Akhoondi Asadi 2017 by their Denavit-Hartenberg tables 1 to 3.

namespace zwidth::test {

struct Prototype1 {
  double l1x = 0.095, l2x = 0.22501, l3x = 0.01251, l3y = 0.03286, l3z = 0.351943;
};
struct Prototype2 {
  double l1x = 0.2, l12y = 0.03, l2z = 0.04, l2x = 0.15, lex = 0.12;
};
struct Prototype3 {
  double l0 = 0.15, l1 = 0.11, l2 = 0.028, l3 = 0.04;
};

inline Description positioning_device(std::vector<SerialJointDescription> rows) {
  Description device;
  device.name = "prototype";
  SerialDescription arm;
  arm.joints = std::move(rows);
  arm.platform = PlatformFreedom::point;
  device.mechanism = arm;
  return device;
}

inline constexpr Interval kWide{-3.1, 3.1};

inline Description prototype(const Prototype1& l, const Interval& range = kWide) {
  constexpr double kRight = std::numbers::pi / 2.0;
  return positioning_device(
      {{.name = "z", .type = SerialJointType::prismatic, .a = l.l1x, .range = {-0.5, 0.5}},
       {.name = "theta1", .a = l.l2x, .range = range},
       {.name = "theta2", .theta = -kRight, .d = l.l3y, .a = l.l3x, .alpha = -kRight, .range = range},
       {.name = "end", .type = SerialJointType::fixed, .d = l.l3z}});
}

inline Description prototype(const Prototype2& l, const Interval& range = kWide) {
  constexpr double kRight = std::numbers::pi / 2.0;
  return positioning_device({{.name = "theta1", .a = l.l1x, .range = range},
                             {.name = "theta2", .d = l.l12y, .alpha = kRight, .range = range},
                             {.name = "link", .type = SerialJointType::fixed, .d = l.l2z, .a = l.l2x},
                             {.name = "theta3", .a = l.lex, .range = range}});
}

inline Description prototype(const Prototype3& l, const Interval& range = kWide) {
  constexpr double kRight = std::numbers::pi / 2.0;
  return positioning_device(
      {{.name = "theta1", .a = l.l0, .range = range},
       {.name = "theta2", .alpha = kRight, .range = range},
       {.name = "link", .type = SerialJointType::fixed, .d = l.l1},
       {.name = "theta3", .theta = kRight, .alpha = kRight, .range = range},
       {.name = "end", .type = SerialJointType::fixed, .d = l.l2},
       {.name = "theta4", .d = l.l3, .alpha = -kRight, .range = {-1.6, 1.6}, .free = true},
       {.name = "theta5", .range = {-1.6, 1.6}, .free = true}});
}

}  // namespace zwidth::test
