#include "zwidth/math/statistics.h"

#include <cmath>

namespace zwidth {

std::optional<double> standard_deviation(double variance) {
  return variance >= 0.0 ? std::optional(std::sqrt(variance)) : std::nullopt;
}

std::optional<double> average_power(double variance, double mean, std::size_t samples) {
  if (samples < 1 || !(variance >= 0.0) || std::isnan(mean)) {
    return std::nullopt;
  }
  const double n = static_cast<double>(samples);
  return (n - 1.0) / n * variance + mean * mean;
}

std::optional<double> frequency_resolution(double sample_rate, std::size_t samples, std::size_t windows) {
  if (!(sample_rate > 0.0) || windows == 0 || samples < windows) {
    return std::nullopt;
  }
  const std::size_t window = samples / windows;
  return sample_rate / static_cast<double>(window);
}

}  // namespace zwidth
