#pragma once

#include "zwidth/description/parts.h"

/// An incremental encoder with quadrature decoding: four counts per line.
/// Non-positive data throw std::invalid_argument.

namespace zwidth {

double counts_per_turn(double pulses_per_turn);

/// Angle of one count [rad].
double encoder_resolution(double pulses_per_turn);

/// Speed [rad/s] at which one channel reaches its highest frequency [Hz].
double encoder_max_speed(double max_frequency, double pulses_per_turn);

double counts_per_turn(const Encoder& encoder);
double encoder_resolution(const Encoder& encoder);
double encoder_max_speed(const Encoder& encoder);

}  // namespace zwidth
