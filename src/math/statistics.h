#pragma once

#include <cstddef>
#include <optional>

/// Moments of samples, and what follows from them.

namespace zwidth {

/// Square root of a variance; empty when the variance is negative or not a number.
std::optional<double> standard_deviation(double variance);

/// Mean square of a record of n samples from its mean and its (unbiased) sample variance,
/// (n-1)/n variance + mean^2, in the square of the samples' unit (Neal 2015, table 4.7).
/// Empty when n < 1, the variance is negative, or either is not a number.
std::optional<double> average_power(double variance, double mean, std::size_t samples);

/// Frequency step [Hz] of a spectrum averaged over segments of floor(samples / windows) samples, taken at
/// `sample_rate` [Hz] (Neal 2015, section 6.1). Empty when the rate is not positive or a segment would be
/// empty.
std::optional<double> frequency_resolution(double sample_rate, std::size_t samples, std::size_t windows);

}  // namespace zwidth
