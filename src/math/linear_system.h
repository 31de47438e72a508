#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <span>
#include <vector>

/// Linear time-invariant systems with few states: the actuators and loops of a drive.
/// Sizes are known at run time, storage is inline: nothing here allocates unless it returns a std::vector.

namespace zwidth {

inline constexpr int kMaxStates = 8;
inline constexpr int kMaxPorts = 4;  ///< inputs, and outputs

using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStates, 1>;
using PortVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxPorts, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;
using InputMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxPorts>;
using OutputMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxPorts, kMaxStates>;
using FeedthroughMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxPorts, kMaxPorts>;
using PoleVector = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, 0, kMaxStates, 1>;
using PortGains = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxPorts, kMaxPorts>;

/// The largest gain of a response on [0, limit].
struct GainPeak {
  double frequency = 0.0;     ///< [Hz]; 0 when the response falls from its static value
  double gain = 0.0;          ///< magnitude there, in output per input unit
  bool is_resonance = false;  ///< a maximum inside the band; false when it lies at 0 or at the limit
};

/// y_k = C x_k + D u_k, x_k+1 = A x_k + B u_k.
struct DiscreteSystem {
  StateMatrix A;
  InputMatrix B;
  OutputMatrix C;
  FeedthroughMatrix D;
  double period = 0.0;  ///< [s]

  /// Output in the state x under the input u. Sizes must match. Never allocates.
  PortVector output(const StateVector& x, const PortVector& u) const noexcept;

  /// State one period later, the input held at u. Sizes must match. Never allocates.
  StateVector next(const StateVector& x, const PortVector& u) const noexcept;

  /// Eigenvalues of A, largest magnitude first; stable when all lie inside the unit circle.
  PoleVector poles() const;
};

/// xdot = A x + B u, y = C x + D u; n states (at most kMaxStates), m inputs and p outputs (at most kMaxPorts).
/// All members assert that the four sizes agree.
struct LinearSystem {
  StateMatrix A;        ///< n x n [1/s in the states' own units]
  InputMatrix B;        ///< n x m
  OutputMatrix C;       ///< p x n
  FeedthroughMatrix D;  ///< p x m

  /// A proper transfer function in controllable canonical form; coefficients of falling powers of s. The
  /// denominator's first coefficient must not be zero, its degree at most kMaxStates and no less than the
  /// numerator's; throws std::invalid_argument otherwise.
  static LinearSystem from_transfer_function(std::span<const double> numerator,
                                             std::span<const double> denominator);

  int states() const { return static_cast<int>(A.rows()); }

  /// Eigenvalues of A [rad/s], the slowest (largest real part) first.
  PoleVector poles() const;

  /// Every pole has a negative real part.
  bool is_stable() const;

  /// Static gain D - C A^-1 B, p x m; empty when A is singular (a pole at zero).
  std::optional<FeedthroughMatrix> dc_gain() const;

  /// C (jw I - A)^-1 B + D, p x m, at the angular frequency w [rad/s]. Not finite exactly on an undamped pole.
  PortGains frequency_response(double angular_frequency) const;

  /// The same system under inputs that are held over each period [s], exact at the samples: the exponential of
  /// [[A, B], [0, 0]] T. Throws std::invalid_argument unless the period is positive and finite.
  DiscreteSystem zero_order_hold(double period) const;

  /// Largest |gain| from `input` to `output` up to `max_frequency` [Hz], located to rounding error from the
  /// zeros of its derivative. An undamped pole inside the band gives an infinite gain.
  GainPeak peak_gain(double max_frequency, int output = 0, int input = 0) const;

  /// First frequency [Hz] above `start` [Hz] at which |gain| crosses `level` downwards; `start` itself when it
  /// already lies below. Empty when it stays above at all frequencies that matter (a hundred times the fastest
  /// pole, extended while it falls).
  std::optional<double> first_fall_below(double level, double start, int output = 0, int input = 0) const;
};

/// How a step response meets its target, in samples (Neal 2015, table 4.5).
struct StepMetrics {
  std::optional<int> rise_samples;  ///< first sample >= 90 % less first sample >= 10 %; empty if never reached
  std::optional<int> time_constant_samples;  ///< first sample >= 63.2 %; empty if never reached
  std::optional<int>
      settling_samples;             ///< first sample from which on |y - 1| <= 2 %; empty if it does not stay
  double overshoot = 0.0;           ///< largest excess over the target, as a fraction of it, not below 0 [-]
  double steady_state_error = 0.0;  ///< target less last sample, as a fraction of the target [-]
};

/// Metrics of the samples y_0, y_1, ... of a response to a step towards `target` (not zero; throws
/// std::invalid_argument otherwise). "Steady" is the last sample: give enough of them.
StepMetrics step_metrics(std::span<const double> samples, double target = 1.0);

/// Metrics of the unit step from `input` to `output`, from rest, on as many samples as the slowest pole needs
/// to die out to rounding error. Empty when the system is not stable, or so slow that this takes more than
/// kMaxStepSamples.
std::optional<StepMetrics> step_metrics(const DiscreteSystem& system, double target = 1.0, int output = 0,
                                        int input = 0);
inline constexpr int kMaxStepSamples = 10'000'000;

/// Samples 0 .. count-1 of the response of `output` to a step of the given height on `input`, from rest.
std::vector<double> step_response(const DiscreteSystem& system, int count, double height = 1.0, int output = 0,
                                  int input = 0);

/// 20 log10 of a ratio.
double decibel(double ratio);

/// The ratio that 20 log10 maps to `decibels`.
double ratio_of_decibel(double decibels);

}  // namespace zwidth
