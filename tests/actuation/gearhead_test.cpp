#include "zwidth/actuation/gearhead.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/drives.h"

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/encoder.h"

namespace zwidth {
namespace {

using std::numbers::pi;

// The wrist drive of Baser 2006: RE 16 with the two-stage GP 16 A (appendices A.4, B.1 and C.2).
DriveDescription wrist() {
  DriveDescription drive = test::published_drive();
  drive.preloader.reset();
  drive.output.reset();
  drive.motor = {};
  drive.motor.supply_voltage = 12.0;
  drive.motor.no_load_current = 0.046;
  drive.motor.nominal_torque = 4.98e-3;
  drive.motor.nominal_current = 0.614;
  drive.motor.resistance = 3.38;
  drive.motor.inductance = 0.11e-3;
  drive.motor.torque_constant = 8.11e-3;
  drive.motor.speed_constant = 1180.0 * pi / 30.0;
  drive.motor.rotor_inertia = 1.27e-7;
  drive.motor.max_speed = 16000.0 * pi / 30.0;
  drive.encoder.pulses_per_turn = 5000.0;
  drive.encoder.max_frequency = kNotGiven;
  drive.encoder.code_wheel_inertia = 0.0;
  drive.supply_voltage = 12.0;
  drive.amplifier.output_voltage_factor = 1.0;
  drive.input_inertia = 0.0;
  drive.peak_factor = 28.8 / 4.98;
  GearheadDescription gear;
  gear.gearhead.reduction_numerator = 3249.0;
  gear.gearhead.reduction_denominator = 169.0;
  gear.gearhead.stages = 2;
  gear.gearhead.continuous_torque = 0.15;
  gear.gearhead.intermittent_torque = 0.225;
  gear.gearhead.max_efficiency = 0.81;
  gear.gearhead.backlash = 0.8 * pi / 180.0;
  gear.gearhead.inertia = 0.05e-7;
  gear.gearhead.max_input_speed = kNotGiven;
  drive.transmission = gear;
  return drive;
}

const Interval kRange{-pi, pi};

TEST(Transmission, TorquesOfTheSource) {  // Baser 2006, section 5.1
  EXPECT_NEAR(required_motor_torque(5.080, 10.0, 1.0), 0.508, 1e-12);
  EXPECT_NEAR(required_motor_torque(0.130, 5.4, 0.9), 26.75e-3, 5e-6);
  EXPECT_NEAR(output_torque(4.98e-3, reduction(3249.0, 169.0), 0.9), 86.2e-3, 5e-5);
  EXPECT_NEAR(output_torque(required_motor_torque(0.7, 19.2, 0.81), 19.2, 0.81), 0.7, 1e-15);
  EXPECT_NEAR(reduction(27.0, 5.0), 5.4, 1e-15);
  EXPECT_THROW(reduction(27.0, 0.0), std::invalid_argument);
  EXPECT_THROW(required_motor_torque(1.0, 10.0, 0.0), std::invalid_argument);
  EXPECT_THROW(output_torque(1.0, -10.0, 1.0), std::invalid_argument);
}

TEST(GearheadDrive, TheGearheadHoldsThePeakBack) {
  const Drive drive(wrist(), kRange);
  EXPECT_NEAR(drive.ratio(), 19.224852071005916, 1e-12);
  const TorqueLimit peak = drive.peak_torque();
  EXPECT_NEAR(peak.motor, 28.8e-3 * 3249.0 / 169.0 * 0.81,
              1e-12);  // 448 mN m, short of the 500 that were wanted
  EXPECT_NEAR(*peak.gearhead, 0.225, 1e-15);
  EXPECT_NEAR(peak.usable, 0.225, 1e-15);
  EXPECT_EQ(peak.limited_by, Limiter::gearhead);
  const TorqueLimit continuous = drive.continuous_torque();
  EXPECT_EQ(continuous.limited_by, Limiter::motor);
  EXPECT_NEAR(continuous.usable, 4.98e-3 * 3249.0 / 169.0 * 0.81, 1e-12);
  EXPECT_EQ(*continuous.gearhead, 0.15);
  EXPECT_NEAR(*drive.backlash(), 0.8 * pi / 180.0, 1e-15);
  EXPECT_NEAR(drive.reflected_inertia(), 1.32e-7 * std::pow(3249.0 / 169.0, 2), 1e-12);
  EXPECT_NEAR(drive.angular_resolution(), 2.0 * pi / (4.0 * 5000.0 * 3249.0 / 169.0), 1e-15);
  EXPECT_FALSE(drive.joint_stiffness(0.0));
  bool short_failed = false;
  for (const Margin& margin : drive.margins()) {
    if (margin.name == "gearhead torque, short") {
      short_failed = !margin.ok;
      EXPECT_NEAR(margin.capability, 0.225, 1e-15);
    }
    EXPECT_NE(margin.name, "gearhead speed");  // not given
  }
  EXPECT_TRUE(short_failed);
}

TEST(GearheadDrive, AFurtherRatioMultipliesTheGearheads) {
  DriveDescription description = wrist();
  auto& gear = std::get<GearheadDescription>(description.transmission);
  gear.further_ratio = 2.0;
  gear.further_efficiency = 0.9;
  gear.stiffness = 12.0;
  gear.gearhead.max_input_speed = 500.0;
  const Drive plain(wrist(), kRange), drive(description, kRange);
  EXPECT_NEAR(drive.ratio(), 2.0 * plain.ratio(), 1e-12);
  EXPECT_NEAR(drive.peak_torque().usable, 0.225 * 1.8, 1e-15);
  EXPECT_NEAR(*drive.backlash(), 0.5 * *plain.backlash(), 1e-15);
  EXPECT_EQ(drive.joint_stiffness(0.3), 12.0);
  EXPECT_EQ(drive.speed().limited_by, Limiter::gearhead);
  EXPECT_NEAR(drive.speed().usable, 500.0 / drive.ratio(), 1e-12);
  EXPECT_NEAR(drive.torque_for_current(0.3), 0.3 * 8.11e-3 * drive.ratio() * 0.81 * 0.9, 1e-15);
  EXPECT_NEAR(drive.motor_torque(drive.torque_for_current(0.3)), 0.3 * 8.11e-3, 1e-15);
}

TEST(RatioDrive, IsNothingButItsRatioAndEfficiency) {
  DriveDescription description = wrist();
  RatioDescription ratio;
  ratio.ratio = 8.0;
  ratio.efficiency = 0.95;
  ratio.backlash = 1e-3;
  ratio.inertia = 3e-6;
  description.transmission = ratio;
  description.encoder.max_frequency = 100e3;
  const Drive drive(description, kRange);
  EXPECT_NEAR(drive.continuous_torque().usable, 4.98e-3 * 8.0 * 0.95, 1e-15);
  EXPECT_FALSE(drive.continuous_torque().gearhead || drive.continuous_torque().slip);
  EXPECT_NEAR(drive.reflected_inertia(), 1.27e-7 * 64.0 + 3e-6, 1e-18);
  EXPECT_EQ(drive.backlash(), 1e-3);
  EXPECT_FALSE(drive.capstan());
  EXPECT_EQ(drive.speed().limited_by, Limiter::encoder);
  EXPECT_NEAR(*drive.speed().motor, 16000.0 * pi / 30.0 / 8.0, 1e-9);
  description.motor.max_speed = 10.0;
  EXPECT_EQ(Drive(description, kRange).speed().limited_by, Limiter::motor);
  std::get<RatioDescription>(description.transmission).efficiency = 1.2;
  EXPECT_THROW(Drive(description, kRange), InvalidDrive);
  std::get<RatioDescription>(description.transmission).efficiency = 1.0;
  std::get<RatioDescription>(description.transmission).ratio = 0.0;
  EXPECT_THROW(Drive(description, kRange), InvalidDrive);
}

TEST(Drive, TheSupplyLimitsAPeakBeyondTheStallTorque) {
  DriveDescription description = wrist();
  description.transmission = DirectDriveDescription{};
  description.peak_factor = 100.0;
  const TorqueLimit peak = Drive(description, kRange).peak_torque();
  EXPECT_EQ(peak.limited_by, Limiter::supply);
  EXPECT_NEAR(peak.usable, 8.11e-3 * 12.0 / 3.38, 1e-15);
}

}  // namespace
}  // namespace zwidth
