#include "zwidth/analysis/joint_torque.h"

#include <gtest/gtest.h>
#include <numbers>

#include "support/pneumatics.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The final device with cylinders of its first three joints; the wrist is free.
Description device() {
  Description described = test::prototype(test::Prototype3{}, {-30.0 * kDegree, 30.0 * kDegree});
  const CylinderTravel travel{0.075, 0.0875, 30.0 * kDegree};
  for (const auto& [joint, mount] :
       {std::pair{"theta1", design_two_optimal(travel)},
        std::pair{"theta2", design_two_optimal(travel, ArmCylinderLayout::two_mod)},
        std::pair{"theta3", design_three_optimal(travel)}}) {
    PneumaticDriveDescription drive;
    drive.joints = {joint};
    drive.cylinder.stroke = 0.0125;
    drive.cylinder.rear_area = 67.74e-6;
    drive.cylinder.rod_area = 60.0e-6;
    drive.cylinder.max_pressure = 0.7e6;
    drive.regulator.max_pressure = 0.7e6;
    drive.regulator.max_command = 10.0;
    drive.regulator.max_supply_pressure = 1e6;
    drive.supply_pressure = 0.7e6;
    drive.mount = mount;
    described.pneumatic_drives.push_back(drive);
  }
  return described;
}

TEST(JointTorque, IsThatOfTheCylindersAtThePosture) {
  const Description described = device();
  const Mechanism mechanism(described);
  const auto cylinders = joint_pneumatic_drives(described, mechanism);
  const std::vector<std::optional<Drive>> none(5);
  ASSERT_EQ(cylinders.size(), 5U);
  EXPECT_FALSE(cylinders[3] || cylinders[4]);
  ActiveVector q(5);
  q << 0.2, -0.3, 0.4, 0.5, -0.5;
  const TorqueRange range = torque_range(none, cylinders, q, false);
  for (int j = 0; j < 3; ++j) {
    const Interval torque = cylinders[static_cast<std::size_t>(j)]->torque_range(q[j]);
    EXPECT_EQ(range.min[j], torque.min);
    EXPECT_EQ(range.max[j], torque.max);
    EXPECT_EQ(either_way(range)[j], std::min(torque.max, -torque.min));
  }
  for (int j = 3; j < 5; ++j) {
    EXPECT_EQ(range.min[j], 0.0);
    EXPECT_EQ(range.max[j], 0.0);
  }
}

// The chain of the source's largest force: pressure, area, lever, reach. Upwards the rod side works in layout
// three, downwards the rear one.
TEST(JointTorque, VerticalForceOfTheFinalDevice) {
  const Description described = device();
  const Mechanism mechanism(described);
  const ActiveVector q = ActiveVector::Zero(5);
  const Solution solution = solve_forward(mechanism, q);
  const TorqueRange range = torque_range(std::vector<std::optional<Drive>>(5),
                                         joint_pneumatic_drives(described, mechanism), q, false);
  const Jacobian J = jacobian(*solution.posture);
  const LoadLimit up = load_limit(J, range, Vector3::UnitZ()), down = load_limit(J, range, -Vector3::UnitZ());
  EXPECT_NEAR(down.value, 8.715, 0.005);
  EXPECT_NEAR(up.value, 7.72, 0.005);
  EXPECT_EQ(up.joint, 2);
}

}  // namespace
}  // namespace zwidth
