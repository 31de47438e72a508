#include "zwidth/actuation/amplifier.h"

#include <cmath>

#include "zwidth/actuation/require.h"

namespace zwidth {

GainScale gain_scale(const Amplifier& amplifier) {
  return {amplifier.proportional_gain_scale, amplifier.integral_gain_scale};
}

CurrentGains gains_from_registers(double proportional, double integral, const GainScale& scale) {
  return {proportional / require_positive("proportional gain scale", scale.proportional),
          integral / require_positive("integral gain scale", scale.integral)};
}

GainRegisters registers_from_gains(const CurrentGains& gains, const GainScale& scale) {
  return {std::lround(gains.proportional * require_positive("proportional gain scale", scale.proportional)),
          std::lround(gains.integral * require_positive("integral gain scale", scale.integral))};
}

double available_voltage(const Amplifier& amplifier, double supply_voltage) {
  return amplifier.output_voltage_factor * supply_voltage;
}

bool accepts_supply(const Amplifier& amplifier, double supply_voltage) {
  return !(supply_voltage < amplifier.min_supply_voltage) && supply_voltage <= amplifier.max_supply_voltage;
}

}  // namespace zwidth
