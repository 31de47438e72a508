#include "zwidth/actuation/drive.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

#include "support/drives.h"

namespace zwidth {
namespace {

using std::numbers::pi;

Drive published() {
  return Drive(test::published_drive(), test::published_drive_range());
}

DriveDescription direct_drive() {
  DriveDescription description = test::published_drive();
  description.transmission = DirectDriveDescription{};
  description.preloader.reset();
  return description;
}

const Margin& margin(const std::vector<Margin>& margins, const std::string& name) {
  const auto found =
      std::find_if(margins.begin(), margins.end(), [&](const Margin& m) { return m.name == name; });
  if (found == margins.end()) {
    throw std::out_of_range(name);
  }
  return *found;
}

TEST(Drive, TorquesAsPublished) {  // Neal 2015, table 4.1
  const TorqueLimit continuous = published().continuous_torque();
  EXPECT_NEAR(continuous.usable, 1.045, 5e-4);
  EXPECT_EQ(continuous.limited_by, Limiter::motor);
  const TorqueLimit peak = published().peak_torque();
  EXPECT_NEAR(peak.usable, 1.359, 5e-4);
  EXPECT_NEAR(*peak.slip, 1.3657, 5e-5);
  EXPECT_NEAR(peak.amplifier, 0.0255 * 10.0 * published().ratio(), 1e-12);
  EXPECT_EQ(peak.limited_by, Limiter::motor);
  EXPECT_EQ(published().stall_torque().limited_by, Limiter::slip);
}

TEST(Drive, FiguresAsPublished) {  // Neal 2015, table 4.1
  EXPECT_NEAR(published().reflected_inertia(), 6.53e-4, 5e-7);
  EXPECT_NEAR(*published().perceived_mass(), 0.102, 5e-4);
  EXPECT_NEAR(*published().torque_resolution(), 3.84e-4, 5e-7);
  EXPECT_NEAR(published().angular_resolution() * 180.0 / pi * 3600.0, 21.5, 0.05);
  EXPECT_NEAR(*published().cable_stiffness(0.0), 0.225 * 535436.36, 0.01);
  const TwoMassModel model = *published().two_mass();
  EXPECT_NEAR(model.resonance().frequency, 192.99, 0.01);
  EXPECT_NEAR(*model.bandwidth(), 302.27, 0.01);
  EXPECT_NEAR(*published().current_loop().bandwidth(), 1003.07, 5e-3);
}

TEST(Drive, LeastOfItsElementsLimitsTheTorque) {
  DriveDescription description = test::published_drive();
  std::get<CapstanDescription>(description.transmission).preload = 5.0;
  const Drive slipping(description, test::published_drive_range());
  EXPECT_EQ(slipping.continuous_torque().limited_by, Limiter::slip);
  EXPECT_DOUBLE_EQ(slipping.continuous_torque().usable, slipping.capstan()->slip_torque(5.0));
  description = test::published_drive();
  description.amplifier.continuous_current = 1.0;
  const Drive weak(description, test::published_drive_range());
  EXPECT_EQ(weak.continuous_torque().limited_by, Limiter::amplifier);
  EXPECT_NEAR(weak.continuous_torque().usable, 0.0255 * weak.ratio(), 1e-15);
}

TEST(Drive, EncoderLimitsTheSpeed) {
  const SpeedLimit speed = published().speed();
  EXPECT_EQ(speed.limited_by, Limiter::encoder);
  EXPECT_NEAR(speed.usable * published().ratio(), 12000.0 * 2.0 * pi / 60.0, 1e-9);
  EXPECT_LT(speed.at_continuous_torque, speed.unloaded);
  DriveDescription description = test::published_drive();
  description.encoder.max_frequency = kNotGiven;
  const SpeedLimit free = Drive(description, test::published_drive_range()).speed();
  EXPECT_FALSE(free.encoder.has_value());
  EXPECT_EQ(free.limited_by, Limiter::supply);
  EXPECT_EQ(free.usable, free.unloaded);
}

TEST(Drive, PowerPassesTheTransmission) {
  const Drive drive = published();
  const double current = 1.7;
  EXPECT_NEAR(drive.torque_for_current(current), 0.0255 * current * drive.ratio(), 1e-15);
  EXPECT_NEAR(drive.current_for_torque(drive.torque_for_current(current)), current, 1e-15);
  EXPECT_NEAR(drive.joint_angle(4000) * drive.ratio(), 2.0 * pi, 1e-14);
  EXPECT_NEAR(drive.joint_angle(4100, 100) * drive.ratio(), 2.0 * pi, 1e-14);
  EXPECT_LT(drive.joint_angle(-1), 0.0);
  static_assert(noexcept(drive.joint_angle(1))&& noexcept(drive.current_for_torque(1.0)));
}

TEST(Drive, MarginsAreKeptByThePublishedDesignButOne) {
  const std::vector<Margin> margins = published().margins();
  for (const Margin& m : margins) {
    EXPECT_EQ(m.ok, m.name != "encoder frequency") << m.name << " " << m.demand << " of " << m.capability;
    EXPECT_TRUE(m.utilisation.has_value());
    EXPECT_FALSE(m.rule.empty());
  }
  EXPECT_NEAR(margin(margins, "preload at continuous torque").demand, 7.271, 5e-4);
  EXPECT_NEAR(margin(margins, "preload at peak torque").demand, 1.3 * 7.271324, 1e-5);
  EXPECT_NEAR(margin(margins, "cable seat").demand, 9.628e-3, 5e-7);
  EXPECT_NEAR(margin(margins, "flexure stress").demand, 159.6e6, 1e3);
  EXPECT_NEAR(margin(margins, "motor radial load").demand, 1.3 * 13.8477, 0.05);
  EXPECT_NEAR(margin(margins, "cable tension").demand, 9.5 + 1.3 * 6.9372, 1e-3);
  EXPECT_NEAR(margin(margins, "encoder frequency").capability, 200e3, 1e-9);
}

TEST(Drive, MarginsNameWhatFails) {
  DriveDescription description = test::published_drive();
  description.supply_voltage = 60.0;
  auto& capstan = std::get<CapstanDescription>(description.transmission);
  capstan.preload = 6.0;
  capstan.cable.coated_diameter = 1.005e-3;
  capstan.centre_distance = 82e-3;
  const auto margins = Drive(description, {-2.0, 2.0}).margins();
  for (const char* name : {"supply voltage", "preload at continuous torque", "wrap spacing", "sector range"}) {
    EXPECT_FALSE(margin(margins, name).ok) << name;
    EXPECT_GT(*margin(margins, name).utilisation, 1.0) << name;
  }
}

TEST(Drive, WithoutDataHasNoMargin) {
  DriveDescription description = test::published_drive();
  description.motor.max_radial_load = kNotGiven;
  description.preloader->material.yield_strength = kNotGiven;
  const auto margins = Drive(description, test::published_drive_range()).margins();
  EXPECT_THROW(margin(margins, "motor radial load"), std::out_of_range);
  EXPECT_THROW(margin(margins, "flexure stress"), std::out_of_range);
  EXPECT_THROW(margin(margins, "winding heat"), std::out_of_range);
}

TEST(Drive, DirectDriveIsTheMotorItself) {
  const Drive drive(direct_drive(), {-1.0, 1.0});
  EXPECT_EQ(drive.ratio(), 1.0);
  EXPECT_FALSE(drive.continuous_torque().slip.has_value());
  EXPECT_DOUBLE_EQ(drive.continuous_torque().usable, 0.0694);
  EXPECT_DOUBLE_EQ(drive.angular_resolution(), 2.0 * pi / 4000.0);
  EXPECT_FALSE(drive.two_mass().has_value());
  EXPECT_FALSE(drive.cable_stiffness(0.0).has_value());
  EXPECT_FALSE(drive.joint_stiffness(0.0).has_value());
  EXPECT_NEAR(drive.reflected_inertia(), 1.944e-6 + 2.117e-4, 1e-18);
  EXPECT_FALSE(drive.margins().empty());
}

TEST(Drive, WarmMotorKnowsItsTime) {
  DriveDescription description = test::published_drive();
  description.motor.thermal_resistance_winding = 0.6;
  description.motor.thermal_resistance_housing = 7.4;
  description.motor.thermal_time_constant_winding = 2.1;
  description.motor.thermal_time_constant_housing = 1180.0;
  description.motor.max_winding_temperature = 428.15;
  const Drive drive(description, test::published_drive_range());
  ASSERT_TRUE(drive.thermal().has_value());
  EXPECT_DOUBLE_EQ(margin(drive.margins(), "winding heat").capability, drive.thermal()->continuous_current());
}

TEST(Drive, FiguresHaveKeysOfTheirOwnAndFiniteValues) {
  for (const DriveDescription& description : {test::published_drive(), direct_drive()}) {
    std::set<std::string> keys;
    for (const DriveFigure& figure : Drive(description, test::published_drive_range()).figures()) {
      EXPECT_TRUE(keys.insert(figure.key).second) << figure.key;
      EXPECT_TRUE(std::isfinite(figure.value)) << figure.key;
    }
    EXPECT_TRUE(keys.contains("continuous_torque"));
  }
}

TEST(Drive, RefusesContradictionsByName) {
  const auto message = [](auto&& change) -> std::string {
    DriveDescription description = test::published_drive();
    change(description);
    EXPECT_FALSE(Drive::try_make(description, test::published_drive_range()).has_value());
    try {
      Drive(description, test::published_drive_range());
    } catch (const InvalidDrive& error) {
      return error.what();
    }
    return "";
  };
  const auto capstan = [](DriveDescription& d) -> CapstanDescription& {
    return std::get<CapstanDescription>(d.transmission);
  };
  EXPECT_NE(message([&](auto& d) { capstan(d).centre_distance = 0.0803; }).find("80.386 mm"),
            std::string::npos);
  EXPECT_NE(message([&](auto& d) { capstan(d).wraps = 0.0; }).find("wrap"), std::string::npos);
  EXPECT_NE(message([&](auto& d) { capstan(d).preload = 0.0; }).find("preload"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.motor.resistance = 0.0; }).find("resistance"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.motor.torque_constant = -1.0; }).find("torque_constant"),
            std::string::npos);
  EXPECT_NE(message([](auto& d) { d.preloader->height = 0.0; }).find("preloader"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.proportional_gain = std::nan(""); }).find("proportional_gain"),
            std::string::npos);
  EXPECT_TRUE(Drive::try_make(test::published_drive(), test::published_drive_range()).has_value());
}

}  // namespace
}  // namespace zwidth
