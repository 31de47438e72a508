#include "zwidth/actuation/motor.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "support/drives.h"

namespace zwidth {
namespace {

constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;
const Motor kPublished = test::published_drive().motor;

/// A small brushed motor with all its thermal data, as catalogues give them.
Motor warm_motor() {
  Motor motor = kPublished;
  motor.thermal_resistance_winding = 0.6;
  motor.thermal_resistance_housing = 7.4;
  motor.thermal_time_constant_winding = 2.1;
  motor.thermal_time_constant_housing = 1180.0;
  motor.max_winding_temperature = 428.15;
  return motor;
}

TEST(Motor, ConstantsAsPublished) {  // Neal 2015, table 4.2 and section 4.1.1
  EXPECT_NEAR(equivalent_damping(kPublished), 7.778e-4, 5e-8);
  EXPECT_NEAR(mechanical_time_constant(kPublished), 2.35e-3, 5e-6);
  EXPECT_NEAR(electrical_time_constant(kPublished), 0.141e-3, 5e-7);
  EXPECT_NEAR(motor_torque(0.0255, 1e-3), 25.5e-6, 1e-18);
}

TEST(Motor, CatalogueValuesFollowWithinTheirTolerance) {
  EXPECT_NEAR(speed_torque_gradient(0.0255, 0.836) / kRpm * 1e-3, 12.2, 0.1);
  EXPECT_NEAR(stall_torque(0.0255, 0.836, 48.0), 1.470, 0.01);
  EXPECT_NEAR(motor_speed(kPublished, 48.0, 0.0) / kRpm, 17800.0, 100.0);
  EXPECT_NEAR(motor_speed(kPublished, 48.0, 0.0694) / kRpm, 16800.0, 300.0);
}

TEST(Motor, SpeedFallsByTheGradient) {
  Motor motor = kPublished;
  motor.speed_constant = 1.0 / motor.torque_constant;  // as energy demands; the catalogue rounds
  const double drop = motor_speed(motor, 40.0, 0.0) - motor_speed(motor, 40.0, 0.05);
  EXPECT_NEAR(drop, 0.05 * speed_torque_gradient(motor.torque_constant, motor.resistance), 1e-10);
}

TEST(Motor, FrictionOpposesMotion) {
  EXPECT_DOUBLE_EQ(shaft_torque(0.02, 1.0, 0.3, 5.0), 0.014);
  EXPECT_DOUBLE_EQ(shaft_torque(0.02, 1.0, 0.3, -5.0), 0.026);
  EXPECT_DOUBLE_EQ(shaft_torque(0.02, -1.0, 0.3, 0.0), -0.014);
  EXPECT_DOUBLE_EQ(shaft_torque(0.02, 0.2, 0.3, 0.0), 0.0);
}

TEST(Motor, RefusesToDivideByWhatIsNotPositive) {
  EXPECT_THROW(equivalent_damping(0.02, 0.02, 0.0), std::invalid_argument);
  EXPECT_THROW(mechanical_time_constant(1e-6, -1.0), std::invalid_argument);
  EXPECT_THROW(electrical_time_constant(std::nan(""), 1e-3), std::invalid_argument);
  EXPECT_THROW(speed_torque_gradient(0.0, 1.0), std::invalid_argument);
  EXPECT_THROW(stall_torque(0.02, std::numeric_limits<double>::infinity(), 48.0), std::invalid_argument);
}

TEST(Thermal, IsEmptyWithoutData) {
  EXPECT_FALSE(thermal_model(kPublished).has_value());
  Motor motor = warm_motor();
  motor.thermal_time_constant_housing = std::nan("");
  EXPECT_FALSE(thermal_model(motor).has_value());
}

TEST(Thermal, ContinuousCurrentEndsAtTheLimit) {
  const ThermalModel model = *thermal_model(warm_motor());
  for (double ambient : {253.15, 298.15, 333.15}) {
    const double current = model.continuous_current(ambient);
    EXPECT_NEAR(*model.steady_winding_temperature(current, ambient), 428.15, 1e-9);
    EXPECT_FALSE(model.time_to_overheat(current * 0.999, ambient).has_value());
    EXPECT_TRUE(model.time_to_overheat(current * 1.001, ambient).has_value());
  }
  EXPECT_EQ(model.continuous_current(500.0), 0.0);
}

TEST(Thermal, WindingFollowsItsTwoDifferentialEquations) {
  const Motor motor = warm_motor();
  const ThermalModel model = *thermal_model(motor);
  const double ambient = 310.0, current = 6.0;
  const double C_w = motor.thermal_time_constant_winding / motor.thermal_resistance_winding;
  const double C_h = motor.thermal_time_constant_housing / motor.thermal_resistance_housing;
  double winding = ambient, housing = ambient;
  const double h = 1e-4;  // midpoint rule: error about (h / 2.1 s)^2
  const auto rate = [&](double w, double b) {
    const double R = motor.resistance * (1.0 + 0.00393 * (w - 298.15));
    const double out = (w - b) / motor.thermal_resistance_winding;
    return std::pair((current * current * R - out) / C_w,
                     (out - (b - ambient) / motor.thermal_resistance_housing) / C_h);
  };
  for (int step = 1; step <= 200'000; ++step) {
    const auto [dw, dh] = rate(winding, housing);
    const auto [mw, mh] = rate(winding + 0.5 * h * dw, housing + 0.5 * h * dh);
    winding += h * mw;
    housing += h * mh;
    if (step % 20'000 == 0) {
      EXPECT_NEAR(model.winding_temperature(current, step * h, ambient), winding, 1e-6);
    }
  }
}

TEST(Thermal, WindingEndsAtItsSteadyTemperature) {
  const ThermalModel model = *thermal_model(warm_motor());
  EXPECT_NEAR(model.winding_temperature(2.0, 1e6), *model.steady_winding_temperature(2.0), 1e-8);
  EXPECT_DOUBLE_EQ(model.winding_temperature(2.0, 0.0), ThermalModel::kRoomTemperature);
}

TEST(Thermal, RunsAwayWhenCopperWarmsFasterThanItCools) {
  const ThermalModel model = *thermal_model(warm_motor());
  const double runaway = std::sqrt(1.0 / (8.0 * 0.836 * 0.00393));
  EXPECT_TRUE(model.steady_winding_temperature(runaway * 0.99).has_value());
  EXPECT_FALSE(model.steady_winding_temperature(runaway * 1.01).has_value());
  EXPECT_TRUE(model.time_to_overheat(runaway * 1.01).has_value());
}

TEST(Thermal, OverheatsWhenItSays) {
  const ThermalModel model = *thermal_model(warm_motor());
  double last = std::numeric_limits<double>::infinity();
  for (double current : {5.0, 10.0, 20.0, 50.0}) {
    const double time = *model.time_to_overheat(current);
    EXPECT_LT(time, last);
    EXPECT_NEAR(model.winding_temperature(current, time), 428.15, 1e-9);
    last = time;
  }
  EXPECT_EQ(model.time_to_overheat(1.0, 430.0), 0.0);
}

TEST(Motor, DataSheetsRepeatThemselves) {  // Baser 2006, appendix A: EC-max 40, 120 W
  Motor motor;
  motor.supply_voltage = 48.0;
  motor.resistance = 0.999;
  motor.torque_constant = 0.0455;
  motor.rotor_inertia = 101e-7;
  motor.no_load_current = 0.306;
  motor.stall_torque = 2.190;
  motor.speed_constant = 210.0 * std::numbers::pi / 30.0;
  motor.no_load_speed = 10000.0 * std::numbers::pi / 30.0;
  motor.speed_torque_gradient = 4.61e3 * std::numbers::pi / 30.0;
  motor.mechanical_time_constant = 4.9e-3;
  motor.max_efficiency = 0.85;
  const std::vector<MotorConsistency> checks = motor_consistency(motor);
  ASSERT_EQ(checks.size(), 6u);
  for (const MotorConsistency& check : checks) EXPECT_LT(std::abs(check.difference()), 0.02) << check.key;
  motor.max_output_power = 572.0;  // a quarter of stall torque times no-load speed
  EXPECT_LT(std::abs(motor_consistency(motor).back().difference()), 0.01);
  motor.no_load_speed = 1000.0 * std::numbers::pi / 30.0;  // a misprint
  bool found = false;
  for (const MotorConsistency& check : motor_consistency(motor)) {
    if (check.key == "no_load_speed") found = std::abs(check.difference()) > 1.0;
  }
  EXPECT_TRUE(found);
}

TEST(Motor, EfficiencyIsTheBestOverAllLoads) {
  const double kt = 0.0233, R = 1.25, U = 24.0, I0 = 0.21;
  double best = 0.0;
  for (double current = I0; current < U / R; current += 1e-3) {
    const double speed = (U - R * current) / kt;
    best = std::max(best, kt * (current - I0) * speed / (U * current));
  }
  EXPECT_NEAR(max_efficiency(R, U, I0), best, 1e-6);
  EXPECT_EQ(max_efficiency(R, 0.2, I0), 0.0);
  EXPECT_THROW(max_efficiency(R, 0.0, I0), std::invalid_argument);
}

}  // namespace
}  // namespace zwidth
