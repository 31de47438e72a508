#include "zwidth/actuation/cable.h"

#include <cmath>
#include <gtest/gtest.h>

namespace zwidth {
namespace {

TEST(Cable, SectionAsPublished) {  // Neal 2015, tables 4.9 and 5.1
  const RopeSection section = *rope_section(0.6096e-3, 7, 19);
  EXPECT_NEAR(section.strand_diameter, 0.2032e-3, 1e-18);
  EXPECT_NEAR(section.wire_diameter, 0.04064e-3, 1e-18);
  EXPECT_NEAR(section.wire_area, 1.2971711e-9, 1e-16);
  EXPECT_NEAR(section.metal_area, 1.7252376e-7, 1e-14);
  EXPECT_NEAR(*cable_stiffness(1.9e11, section.metal_area, 0.06122018795620905), 535436.36, 0.01);
}

TEST(Cable, ASingleWireIsItsOwnSection) {
  const RopeSection wire = *rope_section(1e-3, 1, 1);
  EXPECT_DOUBLE_EQ(wire.wire_diameter, 1e-3);
  EXPECT_DOUBLE_EQ(wire.metal_area, wire.wire_area);
  EXPECT_DOUBLE_EQ(rope_section(7e-3, 1, 37)->wire_diameter, 1e-3);
}

TEST(Cable, OnlyFullLayersHaveASection) {
  for (int count : {0, -7, 2, 6, 8, 18, 20}) {
    EXPECT_FALSE(rope_section(1e-3, count, 19).has_value());
    EXPECT_FALSE(rope_section(1e-3, 7, count).has_value());
  }
  EXPECT_FALSE(rope_section(0.0, 7, 19).has_value());
  EXPECT_FALSE(rope_section(std::nan(""), 7, 19).has_value());
}

TEST(Cable, StiffnessNeedsPositiveValues) {
  EXPECT_FALSE(cable_stiffness(0.0, 1.0, 1.0).has_value());
  EXPECT_FALSE(cable_stiffness(1.0, -1.0, 1.0).has_value());
  EXPECT_FALSE(cable_stiffness(1.0, 1.0, 0.0).has_value());
  EXPECT_FALSE(cable_stiffness(1.0, 1.0, 1.0, 0.0).has_value());
  EXPECT_FALSE(cable_stiffness(std::nan(""), 1.0, 1.0).has_value());
}

}  // namespace
}  // namespace zwidth
