#include "zwidth/analysis/comparison.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/platforms.h"
#include "support/small_arms.h"

#include "zwidth/analysis/reach.h"

namespace zwidth {
namespace {

Mechanism five_bar(double crank, double coupler, double half_base) {
  constexpr double kPi = std::numbers::pi;
  Description description;
  description.name = "plane";
  description.mechanism = FiveBarDescription{.crank = crank,
                                             .coupler = coupler,
                                             .half_base = half_base,
                                             .left_range = {-kPi, kPi},
                                             .right_range = {-kPi, kPi},
                                             .source = "test"};
  return Mechanism(description);
}

TEST(Comparison, OfADeviceWithItselfAndWithALargerOne) {
  const Mechanism small = five_bar(0.05, 0.16, 0.06), large = five_bar(0.10, 0.32, 0.12);
  const WorkspaceComparison same = compare_workspaces(small, small);
  EXPECT_EQ(same.dimension, 2);
  EXPECT_EQ(same.only_first.value, 0.0);
  EXPECT_EQ(same.first.value, same.both.value);
  EXPECT_EQ(same.gain(), 0.0);
  EXPECT_NEAR(same.first.value, workspace_volume(small).value,
              5.0 * same.first.error + 1e-5 * same.first.value);

  // Twice as large a mechanism has four times the area.
  const WorkspaceComparison two = compare_workspaces(small, large, {.spacing = 1e-3});
  EXPECT_NEAR(two.second.value / two.first.value, 4.0, 0.02);
  EXPECT_NEAR(two.both.value + two.only_first.value, two.first.value, 1e-15);
  EXPECT_NEAR(two.both.value + two.only_second.value, two.second.value, 1e-15);
  const WorkspaceComparison turned = compare_workspaces(large, small, {.spacing = 1e-3});
  EXPECT_EQ(turned.only_first.value, two.only_second.value);
  EXPECT_EQ(turned.both.value, two.both.value);
}

// An arm whose tool is a point has a workspace; the same arm with a rigid tool has a map of its reach. Two
// routes to one volume.
TEST(Comparison, OfAnArmByItsInverseAndByItsReach) {
  Description description = test::cylindrical_arm(0.22, 0.18);
  auto& serial = std::get<SerialDescription>(description.mechanism);
  serial.joints[2].range = {0.35, 1.7};
  serial.joints[2].home = 1.0;
  const Mechanism rigid(description);
  serial.platform = PlatformFreedom::point;
  const Mechanism point(description);
  ASSERT_TRUE(workspace_obstacle(rigid));
  ASSERT_FALSE(workspace_obstacle(point));
  const WorkspaceComparison found =
      compare_workspaces(rigid, point, {.spacing = 5e-3, .reach_postures = 1'000'000});
  // They may differ in cells whose middle lies on the boundary to a thousandth of the spacing.
  EXPECT_LT(found.only_first.value, 2e-3 * found.first.value);
  EXPECT_LT(found.only_second.value, 2e-3 * found.second.value);
  EXPECT_NEAR(found.second.value, workspace_volume(point).value, 5.0 * found.second.error);
}

// Platforms that turn, in any orientation and in one, against inverses that know nothing of the general solver.
TEST(Comparison, OfPlatformsThatTurn) {
  const test::Hexapod design = test::hexapod(), longer = test::hexapod(0.15, 0.06, 0.2, 0.05);
  const Mechanism small(design.description()), large(longer.description());
  ASSERT_FALSE(comparison_obstacle(small));
  EXPECT_EQ(comparison_axes(small), (std::vector<int>{0, 1, 2}));
  const ComparisonOptions upright{.spacing = 0.01, .orientation = Matrix3::Identity()};
  const WorkspaceComparison found = compare_workspaces(small, large, upright);
  std::int64_t first = 0, second = 0;
  for (int i = -30; i < 30; ++i) {
    for (int j = -30; j < 30; ++j) {
      for (int k = 5; k < 35; ++k) {
        const Pose pose{.position = 0.01 * (Vector3(i, j, k) + Vector3::Constant(0.5))};
        first += design.reaches(pose) ? 1 : 0;
        second += longer.reaches(pose) ? 1 : 0;
      }
    }
  }
  // A cell at the boundary may have no neighbour to be led to from.
  EXPECT_LE(found.first.value * 1e6, static_cast<double>(first) + 1e-6);
  EXPECT_NEAR(found.first.value * 1e6, static_cast<double>(first), 0.01 * static_cast<double>(first));
  EXPECT_LE(found.second.value * 1e6, static_cast<double>(second) + 1e-6);
  EXPECT_NEAR(found.second.value * 1e6, static_cast<double>(second), 0.01 * static_cast<double>(second));
  EXPECT_EQ(found.only_first.value, 0.0);  // the longer strokes hold the shorter ones
  // In any orientation it reaches more, and all that it reaches upright.
  const WorkspaceComparison any = compare_workspaces(small, small, {.spacing = 0.01});
  EXPECT_GT(any.first.value, 1.5 * found.first.value);
  EXPECT_EQ(any.only_first.value, 0.0);
}

TEST(Comparison, OfAPlateAndAFiveBar) {
  const Mechanism plate(test::ThreeRrr{}.description()), plane = five_bar(0.10, 0.16, 0.06);
  EXPECT_EQ(comparison_axes(plate), comparison_axes(plane));
  const WorkspaceComparison found = compare_workspaces(plate, plane, {.spacing = 2e-3});
  EXPECT_EQ(found.dimension, 2);
  EXPECT_NEAR(found.both.value + found.only_first.value, found.first.value, 1e-12);
  EXPECT_GT(found.both.value, 0.0);
  EXPECT_NEAR(found.second.value, workspace_volume(plane).value, 5.0 * found.second.error + 1e-4);
}

TEST(Comparison, OfTheSevenJointArmIsThatOfTheSource) {
  // Volumes over a (rho, z) grid of 1 mm with theta3 in steps of 0.25 deg, repeated to 1 %: 0.19302 and 0.11797
  // m^3.
  const Mechanism seven(test::seven_joint_arm(0.25, 0.25));
  const Mechanism locked(test::arm_description(test::seven_dof_locked().joints));
  const WorkspaceComparison found = compare_workspaces(seven, locked, {.reach_postures = 3'000'000});
  EXPECT_NEAR(found.first.value, 0.19302, 0.01 * 0.19302 + 2.0 * found.first.error);
  EXPECT_NEAR(found.second.value, 0.11797, 0.01 * 0.11797 + 2.0 * found.second.error);
  EXPECT_NEAR(found.gain(), 0.636, 0.03);
  // What six joints reach, seven reach too, but for cells whose middle lies on the boundary.
  EXPECT_LT(found.only_second.value, 0.005 * found.second.value);
}

}  // namespace
}  // namespace zwidth
