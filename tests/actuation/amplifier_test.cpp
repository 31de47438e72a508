#include "zwidth/actuation/amplifier.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "support/drives.h"

namespace zwidth {
namespace {

TEST(Amplifier, GainsAsPublished) {  // Neal 2015, table 4.6
  const CurrentGains gains = gains_from_registers(300, 130, kEpos2GainScale);
  EXPECT_DOUBLE_EQ(gains.proportional, 1.171875);
  EXPECT_DOUBLE_EQ(gains.integral, 5078.125);
  const GainRegisters registers = registers_from_gains({1.172, 5078.0}, kEpos2GainScale);
  EXPECT_EQ(registers.proportional, 300);
  EXPECT_EQ(registers.integral, 130);
}

TEST(Amplifier, GainsReturnFromTheirRegisters) {
  for (int register_value = 0; register_value < 2000; register_value += 7) {
    const CurrentGains gains = gains_from_registers(register_value, 2 * register_value, kEpos2GainScale);
    const GainRegisters registers = registers_from_gains(gains, kEpos2GainScale);
    EXPECT_EQ(registers.proportional, register_value);
    EXPECT_EQ(registers.integral, 2 * register_value);
  }
}

TEST(Amplifier, VoltageAndSupply) {
  const Amplifier amplifier = test::published_drive().amplifier;
  EXPECT_DOUBLE_EQ(available_voltage(amplifier, 48.0), 43.2);
  EXPECT_TRUE(accepts_supply(amplifier, 11.0));
  EXPECT_TRUE(accepts_supply(amplifier, 50.0));
  EXPECT_FALSE(accepts_supply(amplifier, 10.9));
  EXPECT_FALSE(accepts_supply(amplifier, 50.1));
  EXPECT_TRUE(accepts_supply(Amplifier{.info = {}, .max_supply_voltage = 24.0}, 5.0)) << "no minimum given";
}

TEST(Amplifier, RefusesAScaleThatIsNotPositive) {
  EXPECT_THROW(gains_from_registers(1, 1, {0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(registers_from_gains({1.0, 1.0}, {1.0, -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace zwidth
