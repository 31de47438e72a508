#pragma once

#include "zwidth/description/parts.h"

/// A current amplifier (servo drive): gains between its registers and SI, and what it can give.

namespace zwidth {

/// Gains of a current loop, C(s) = proportional + integral / s (Neal 2015, eq 4.9).
struct CurrentGains {
  double proportional = 0.0;  ///< [ohm]
  double integral = 0.0;      ///< [ohm/s]
};

/// The same gains as an amplifier stores them: whole numbers.
struct GainRegisters {
  long proportional = 0;
  long integral = 0;
};

/// Register value per SI value.
struct GainScale {
  double proportional = 1.0;  ///< per ohm
  double integral = 1.0;      ///< per ohm/s
};

/// Maxon EPOS2: 2^8, and 2^8 per 10^4 current-loop samples in a second (Neal 2015, eq 4.12, 4.13).
inline constexpr GainScale kEpos2GainScale{256.0, 256.0 / 1e4};

GainScale gain_scale(const Amplifier& amplifier);

/// Registers may be given with a fraction here (what one would like to write). Throws std::invalid_argument
/// unless the scale is positive.
CurrentGains gains_from_registers(double proportional, double integral, const GainScale& scale);

/// Rounded to the nearest register values.
GainRegisters registers_from_gains(const CurrentGains& gains, const GainScale& scale);

/// Highest voltage at the motor [V] from a supply [V].
double available_voltage(const Amplifier& amplifier, double supply_voltage);

/// The supply lies in the range that the amplifier accepts; a minimum that is not given does not count.
bool accepts_supply(const Amplifier& amplifier, double supply_voltage);

}  // namespace zwidth
