#include "zwidth/actuation/pneumatic_drive.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "support/storm.h"

namespace zwidth {
namespace {

using enum ArmCylinderLayout;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Interval kRange{-30.0 * kDegree, 30.0 * kDegree};

// Joint 1 of the final device: an M9D12.5U for 30 deg either way.
PneumaticDriveDescription described(ArmCylinderLayout layout = two) {
  PneumaticDriveDescription drive;
  drive.cylinder.stroke = 0.0125;
  drive.cylinder.rear_area = 67.74e-6;
  drive.cylinder.rod_area = 60.0e-6;
  drive.cylinder.max_pressure = 0.689e6;
  drive.cylinder.breakaway_pressure = 1379.0;
  drive.cylinder.moving_mass = 5.17e-3;
  drive.regulator.min_pressure = 1e3;
  drive.regulator.max_pressure = 500e3;
  drive.regulator.max_command = 10.0;
  drive.regulator.max_supply_pressure = 1e6;
  drive.regulator.linearity = 0.01;
  drive.potentiometer = Potentiometer{};
  drive.potentiometer->electrical_angle = 330.0 * kDegree;
  drive.potentiometer->linearity = 0.02;
  drive.potentiometer->max_voltage = 16.0;
  drive.supply_pressure = 0.7e6;
  drive.bias_pressure = 20e3;
  drive.sensor_voltage = 5.0;
  drive.sensor_step = 1.22e-3;
  const CylinderTravel travel{0.075, 0.0875, kRange.max};
  drive.mount = layout == three ? design_three_optimal(travel) : design_two_optimal(travel, layout);
  return drive;
}

const Margin& margin(const std::vector<Margin>& margins, const std::string& name) {
  for (const Margin& one : margins) {
    if (one.name == name) return one;
  }
  throw std::logic_error("no margin " + name);
}

TEST(PneumaticDrive, PressureIsTheLeastOfSupplyRegulatorAndCylinder) {
  PneumaticDriveDescription drive = described();
  EXPECT_EQ(PneumaticDrive(drive, kRange).usable_pressure(), 500e3);
  EXPECT_EQ(PneumaticDrive(drive, kRange).limited_by(), PressureLimiter::regulator);
  drive.supply_pressure = 0.3e6;
  EXPECT_EQ(PneumaticDrive(drive, kRange).usable_pressure(), 0.3e6);
  EXPECT_EQ(PneumaticDrive(drive, kRange).limited_by(), PressureLimiter::supply);
  drive.supply_pressure = 0.9e6;
  drive.regulator.max_pressure = 0.9e6;
  EXPECT_EQ(PneumaticDrive(drive, kRange).usable_pressure(), 0.689e6);
  EXPECT_EQ(PneumaticDrive(drive, kRange).limited_by(), PressureLimiter::cylinder);
}

TEST(PneumaticDrive, TorqueRangeIsThatOfTheForcesAndFollowsTheLever) {
  for (const ArmCylinderLayout layout : {two, two_mod, three}) {
    const PneumaticDrive drive(described(layout), kRange);
    const Interval force = drive.force_range();
    EXPECT_NEAR(force.max, 500e3 * 67.74e-6 - 20e3 * 60e-6, 1e-12);
    EXPECT_NEAR(force.min, 20e3 * 67.74e-6 - 500e3 * 60e-6, 1e-12);
    for (double angle = kRange.min; angle <= kRange.max; angle += 0.05) {
      const Interval torque = drive.torque_range(angle);
      const double d = drive.lever(angle);
      EXPECT_NEAR(torque.max, std::max(d * force.max, d * force.min), 1e-14);
      EXPECT_NEAR(torque.min, std::min(d * force.max, d * force.min), 1e-14);
      // The rod's side is the weaker one, so the directions differ, and with the layout.
      EXPECT_EQ(torque.max > -torque.min, layout == two);
    }
    const Interval worst = drive.guaranteed_torque(), best = drive.greatest_torque();
    EXPECT_NEAR(worst.max, std::min(drive.torque_range(kRange.min).max, drive.torque_range(kRange.max).max),
                1e-12);
    EXPECT_LT(worst.max, best.max);
    EXPECT_GT(worst.min, best.min);
  }
}

TEST(PneumaticDrive, CommandGivesTheTorqueItSays) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int n = 0; n < test::storm_size(5000); ++n) {
    const PneumaticDrive drive(described(n % 3 == 0 ? two : n % 3 == 1 ? two_mod : three), kRange);
    const double angle = kRange.min + unit(random) * kRange.width();
    const Interval range = drive.torque_range(angle);
    const double torque = range.min + unit(random) * range.width();
    const PneumaticCommand command = drive.command(torque, angle);
    EXPECT_EQ(command.status, PneumaticStatus::ok);
    EXPECT_NEAR(command.torque, torque, 1e-14);
    // The regulators, told so, give the pressures back, and these the force, and that the torque.
    const Regulator& regulator = drive.description().regulator;
    const Cylinder& cylinder = drive.description().cylinder;
    const double force = cylinder_force(cylinder.rear_area, cylinder.rod_area,
                                        regulator_pressure(regulator, command.voltages[0]),
                                        regulator_pressure(regulator, command.voltages[1]));
    EXPECT_NEAR(force * drive.lever(angle), torque, 1e-12);
  }
}

TEST(PneumaticDrive, SaysWhenItSaturates) {
  const PneumaticDrive drive(described(), kRange);
  const Interval range = drive.torque_range(0.1);
  for (const double torque : {1.2 * range.max, 1.2 * range.min, 1e9, -1e9}) {
    const PneumaticCommand command = drive.command(torque, 0.1);
    EXPECT_EQ(command.status, PneumaticStatus::saturated);
    EXPECT_NEAR(command.torque, torque > 0.0 ? range.max : range.min, 1e-12);
  }
  const PneumaticCommand nonsense = drive.command(std::nan(""), 0.1);
  EXPECT_EQ(nonsense.status, PneumaticStatus::saturated);
  for (const double voltage : nonsense.voltages) {
    EXPECT_GE(voltage, 0.0);
    EXPECT_LE(voltage, 10.0);
  }
}

TEST(PneumaticDrive, GivesNoForceAtADeadPoint) {
  PneumaticDriveDescription description = described();
  description.mount = ArmCylinderDescription{.layout = one, .l1 = 0.25, .l2 = 0.13, .retracted_length = 0.2};
  const PneumaticDrive drive(description, {-1.0, 2.0});
  const double dead = std::numbers::pi / 2.0;
  const PneumaticCommand command = drive.command(1.0, dead);
  EXPECT_EQ(command.status, PneumaticStatus::dead_point);
  EXPECT_EQ(command.force, 0.0);
  EXPECT_EQ(command.torque, 0.0);
  EXPECT_EQ(drive.torque_range(dead), (Interval{0.0, 0.0}));
  EXPECT_FALSE(margin(drive.margins(), "least lever").ok);
  EXPECT_EQ(drive.command(1.0, std::nan("")).status, PneumaticStatus::dead_point);
}

TEST(PneumaticDrive, ASlideIsTheRodItself) {
  PneumaticDriveDescription description = described();
  description.mount = DirectCylinderDescription{};
  const PneumaticDrive drive(description, {0.0, 0.0125});
  EXPECT_EQ(drive.lever(0.003), 1.0);
  EXPECT_EQ(drive.torque_range(0.003), drive.force_range());
  EXPECT_NEAR(drive.command(20.0, 0.0).force, 20.0, 0.0);
  EXPECT_TRUE(margin(drive.margins(), "stroke").ok);
  EXPECT_FALSE(margin(PneumaticDrive(description, {0.0, 0.013}).margins(), "stroke").ok);
  EXPECT_DOUBLE_EQ(drive.reflected_inertia(0.0), 5.17e-3);
}

TEST(PneumaticDrive, MarginsHoldForTheDesignAndFailBeyondIt) {
  for (const Margin& one : PneumaticDrive(described(), kRange).margins()) EXPECT_TRUE(one.ok) << one.name;
  const PneumaticDrive wide(described(), {-35.0 * kDegree, 35.0 * kDegree});
  EXPECT_FALSE(margin(wide.margins(), "stroke").ok);
  EXPECT_FALSE(margin(wide.margins(), "shortest length").ok);
  EXPECT_FALSE(margin(wide.margins(), "greatest length").ok);
  PneumaticDriveDescription description = described();
  description.bias_pressure = 100.0;
  EXPECT_FALSE(margin(PneumaticDrive(description, kRange).margins(), "least pressure").ok);
  description = described();
  description.supply_pressure = 1.2e6;
  EXPECT_FALSE(margin(PneumaticDrive(description, kRange).margins(), "supply pressure").ok);
}

TEST(PneumaticDrive, AngleAndItsResolutionComeFromThePotentiometer) {
  PneumaticDriveDescription description = described();
  const PneumaticDrive drive(description, kRange);
  EXPECT_NEAR(drive.joint_angle(5.0), 330.0 * kDegree, 1e-12);
  EXPECT_NEAR(drive.joint_angle(2.5, 2.0), 33.0 * kDegree, 1e-12);
  EXPECT_NEAR(*drive.angular_resolution(), 1.22e-3 / 5.0 * 330.0 * kDegree, 1e-15);
  EXPECT_NEAR(*drive.angular_error(), 6.6 * kDegree, 1e-12);
  description.sensor_step = 0.0;
  EXPECT_FALSE(PneumaticDrive(description, kRange).angular_resolution());
  description.potentiometer.reset();
  EXPECT_FALSE(PneumaticDrive(description, kRange).angular_error());
  EXPECT_TRUE(std::isnan(PneumaticDrive(description, kRange).joint_angle(1.0)));
}

TEST(PneumaticDrive, RefusesContradictions) {
  const auto refused = [](auto change) {
    PneumaticDriveDescription description = described();
    change(description);
    EXPECT_THROW(PneumaticDrive(description, kRange), InvalidDrive);
    EXPECT_FALSE(PneumaticDrive::try_make(description, kRange));
  };
  refused([](auto& d) { d.supply_pressure = 0.0; });
  refused([](auto& d) { d.cylinder.rear_area = -1.0; });
  refused([](auto& d) { d.bias_pressure = -2e5; });
  refused([](auto& d) { d.regulator.max_command = 0.0; });
  refused([](auto& d) { d.regulator.min_pressure = 6e5; });
  refused([](auto& d) { std::get<ArmCylinderDescription>(d.mount).l2 = 0.0; });
  refused([](auto& d) { d.cylinder.stroke = std::nan(""); });
  EXPECT_TRUE(PneumaticDrive::try_make(described(), kRange));
}

}  // namespace
}  // namespace zwidth
