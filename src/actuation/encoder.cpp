#include "zwidth/actuation/encoder.h"

#include <numbers>

#include "zwidth/actuation/require.h"

namespace zwidth {

using std::numbers::pi;

double counts_per_turn(double pulses_per_turn) {
  return 4.0 * require_positive("pulses per turn", pulses_per_turn);
}

double encoder_resolution(double pulses_per_turn) {
  return 2.0 * pi / counts_per_turn(pulses_per_turn);
}

double encoder_max_speed(double max_frequency, double pulses_per_turn) {
  return 2.0 * pi * require_positive("encoder frequency", max_frequency) /
         require_positive("pulses per turn", pulses_per_turn);
}

double counts_per_turn(const Encoder& encoder) {
  return counts_per_turn(encoder.pulses_per_turn);
}

double encoder_resolution(const Encoder& encoder) {
  return encoder_resolution(encoder.pulses_per_turn);
}

double encoder_max_speed(const Encoder& encoder) {
  return encoder_max_speed(encoder.max_frequency, encoder.pulses_per_turn);
}

}  // namespace zwidth
