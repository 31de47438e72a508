#include "zwidth/actuation/cylinder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <stdexcept>

#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kA1 = 67.74e-6, kA2 = 60.0e-6;

Regulator regulator() {
  Regulator made;
  made.min_pressure = 1e3;
  made.max_pressure = 500e3;
  made.max_command = 10.0;
  made.min_monitor = 1.0;
  made.max_monitor = 5.0;
  return made;
}

TEST(Cylinder, ForceOfBothChambers) {
  EXPECT_NEAR(cylinder_force(198.06e-6, 178.06e-6, 0.7e6, 0.0), 138.6, 0.05);  // the thesis' 139 N
  EXPECT_NEAR(cylinder_force(kA1, kA2, 0.0, 0.7e6), -42.0, 1e-9);
  EXPECT_NEAR(cylinder_force(kA1, kA2, 3e5, 1e5), 3e5 * kA1 - 1e5 * kA2, 1e-12);
  EXPECT_THROW(cylinder_force(0.0, kA2, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(cylinder_force(kA1, -kA2, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(cylinder_force(kA1, kA2, -1.1 * kAtmosphere, 0.0), std::invalid_argument);
  EXPECT_THROW(cylinder_force(kA1, kA2, 0.0, std::nan("")), std::invalid_argument);
  EXPECT_NO_THROW(cylinder_force(kA1, kA2, -kAtmosphere, 0.0));
}

TEST(PressureAllocation, GivesTheForceWithOneSideAtTheBias) {
  const PressureAllocation allocation(kA1, kA2, 2e4, 5e5);
  const Interval range = allocation.force_range();
  EXPECT_NEAR(range.max, 5e5 * kA1 - 2e4 * kA2, 1e-12);
  EXPECT_NEAR(range.min, 2e4 * kA1 - 5e5 * kA2, 1e-12);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> force(range.min, range.max);
  for (int n = 0; n < test::storm_size(2000); ++n) {
    const double wanted = force(random);
    const ChamberPressures pressures = allocation.pressures(wanted);
    EXPECT_FALSE(pressures.saturated);
    EXPECT_NEAR(allocation.force(pressures), wanted, 1e-12);
    EXPECT_NEAR(cylinder_force(kA1, kA2, pressures.rear, pressures.rod), wanted, 1e-12);
    EXPECT_NEAR(std::min(pressures.rear, pressures.rod), 2e4, 1e-9);
    EXPECT_LE(std::max(pressures.rear, pressures.rod), 5e5 * (1.0 + 1e-12));
  }
}

TEST(PressureAllocation, ClampsAndSaysSo) {
  const PressureAllocation allocation(kA1, kA2, 2e4, 5e5);
  const ChamberPressures push = allocation.pressures(49.2), pull = allocation.pressures(-40.0);
  EXPECT_TRUE(push.saturated);
  EXPECT_EQ(push.rear, 5e5);
  EXPECT_EQ(push.rod, 2e4);
  EXPECT_TRUE(pull.saturated);
  EXPECT_EQ(pull.rod, 5e5);
  EXPECT_EQ(pull.rear, 2e4);
  // Nothing that comes in may come out as a pressure beyond the limits.
  for (const double force : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
    const ChamberPressures pressures = allocation.pressures(force);
    EXPECT_TRUE(pressures.saturated) << force;
    for (const double pressure : {pressures.rear, pressures.rod}) {
      EXPECT_GE(pressure, 0.0) << force;
      EXPECT_LE(pressure, 5e5) << force;
    }
  }
  // A bias below ambient cannot be had, one above the limit neither.
  EXPECT_TRUE(PressureAllocation(kA1, kA2, -1e4, 5e5).pressures(10.0).saturated);
  EXPECT_TRUE(PressureAllocation(kA1, kA2, 6e5, 5e5).pressures(10.0).saturated);
  EXPECT_THROW(PressureAllocation(kA1, kA2, -2e5, 5e5), std::invalid_argument);
  EXPECT_THROW(PressureAllocation(kA1, 0.0, 2e4, 5e5), std::invalid_argument);
  EXPECT_THROW(PressureAllocation(kA1, kA2, 2e4, 0.0), std::invalid_argument);
}

TEST(Regulator, CommandAndPressureAreInverse) {
  const Regulator made = regulator();
  EXPECT_DOUBLE_EQ(regulator_pressure(made, 0.0), 1e3);
  EXPECT_DOUBLE_EQ(regulator_pressure(made, 10.0), 500e3);
  EXPECT_DOUBLE_EQ(regulator_pressure(made, 5.0), 250.5e3);
  for (double voltage = 0.0; voltage <= 10.0; voltage += 0.37) {
    const RegulatorCommand command = regulator_command(made, regulator_pressure(made, voltage));
    EXPECT_NEAR(command.voltage, voltage, 1e-12);
  }
  EXPECT_DOUBLE_EQ(monitored_pressure(made, 3.0), 250.5e3);
  EXPECT_TRUE(std::isnan(monitored_pressure(Regulator{}, 3.0)));
}

TEST(Regulator, ClampsWhatIsOutOfItsRange) {
  const Regulator made = regulator();
  EXPECT_DOUBLE_EQ(regulator_pressure(made, -1.0), 1e3);
  EXPECT_DOUBLE_EQ(regulator_pressure(made, 12.0), 500e3);
  EXPECT_DOUBLE_EQ(regulator_pressure(made, std::nan("")), 1e3);
  for (const double pressure : {0.0, 6e5, std::nan("")})
    EXPECT_TRUE(regulator_command(made, pressure).saturated);
  EXPECT_FALSE(regulator_command(made, 500e3).saturated);
  EXPECT_DOUBLE_EQ(regulator_command(made, 6e5).voltage, 10.0);
  EXPECT_DOUBLE_EQ(regulator_command(made, std::nan("")).voltage, 0.0);
}

TEST(MassFlow, ChokedSubsonicLaminarAndBack) {
  const FlowPath path{.sonic_conductance = 2e-10, .critical_ratio = 0.3};
  constexpr double T = 293.15;
  EXPECT_NEAR(mass_flow(path, 600e3, 101325.0, T), 1.42200e-4, 5e-10);
  EXPECT_NEAR(mass_flow(path, 400e3, 260e3, T), 8.2099e-5, 5e-10);
  // Choked flow does not feel what is downstream.
  EXPECT_DOUBLE_EQ(mass_flow(path, 600e3, 10e3, T), mass_flow(path, 600e3, 150e3, T));
  EXPECT_DOUBLE_EQ(mass_flow(path, 260e3, 400e3, T), -mass_flow(path, 400e3, 260e3, T));
  EXPECT_EQ(mass_flow(path, 4e5, 4e5, T), 0.0);
  // No jump at either change of law.
  for (const double ratio : {0.3, 0.999}) {
    EXPECT_NEAR(mass_flow(path, 1e5, ratio * (1.0 - 1e-9) * 1e5, T),
                mass_flow(path, 1e5, ratio * (1.0 + 1e-9) * 1e5, T), 1e-7 * mass_flow(path, 1e5, 5e4, T));
  }
  EXPECT_NEAR(mass_flow(path, 600e3, 101325.0, 4.0 * T), 0.5 * 1.42200e-4, 5e-10);
  EXPECT_THROW(mass_flow(path, 0.0, 1e5, T), std::invalid_argument);
  EXPECT_THROW(mass_flow(path, 1e5, -1.0, T), std::invalid_argument);
  EXPECT_THROW(mass_flow(path, 2e5, 1e5, 0.0), std::invalid_argument);
  EXPECT_THROW(mass_flow({.sonic_conductance = 2e-10, .critical_ratio = 1.0}, 2e5, 1e5, T),
               std::invalid_argument);
  EXPECT_THROW(mass_flow({.sonic_conductance = 0.0, .critical_ratio = 0.3}, 2e5, 1e5, T),
               std::invalid_argument);
}

}  // namespace
}  // namespace zwidth
