#include "zwidth/math/linear_system.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "support/allocation_counter.h"

namespace zwidth {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

// A system with random real and complex poles of 1 to 100 rad/s, well damped, in random coordinates.
LinearSystem random_stable_system(std::mt19937& random, int states, int inputs, int outputs) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_real_distribution<double> rate(1.0, 100.0);
  const auto draw = [&] { return uniform(random); };
  StateMatrix blocks = StateMatrix::Zero(states, states);
  for (int i = 0; i < states; ++i) {
    blocks(i, i) = -rate(random);
  }
  for (int i = 0; i + 1 < states; i += 3) {
    blocks(i + 1, i + 1) = blocks(i, i);
    blocks(i, i + 1) = rate(random);
    blocks(i + 1, i) = -blocks(i, i + 1);
  }
  const StateMatrix T =
      StateMatrix::Identity(states, states) + 0.3 * StateMatrix::NullaryExpr(states, states, draw);
  LinearSystem system;
  system.A = T * blocks * T.inverse();
  system.B = InputMatrix::NullaryExpr(states, inputs, draw);
  system.C = OutputMatrix::NullaryExpr(outputs, states, draw);
  system.D = FeedthroughMatrix::NullaryExpr(outputs, inputs, draw);
  return system;
}

LinearSystem second_order(double natural_frequency, double damping_ratio) {
  const double w2 = natural_frequency * natural_frequency;
  return LinearSystem::from_transfer_function(std::array{w2},
                                              std::array{1.0, 2.0 * damping_ratio * natural_frequency, w2});
}

TEST(ZeroOrderHold, FirstOrderLagInClosedForm) {
  const double pole = 3.0, period = 0.1;
  const auto discrete =
      LinearSystem::from_transfer_function(std::array{6.0}, std::array{1.0, pole}).zero_order_hold(period);
  EXPECT_DOUBLE_EQ(discrete.A(0, 0), std::exp(-0.3));
  EXPECT_DOUBLE_EQ(discrete.B(0, 0), -std::expm1(-0.3) / pole);
}

TEST(ZeroOrderHold, DoubleIntegratorInClosedForm) {
  const auto discrete =
      LinearSystem::from_transfer_function(std::array{1.0}, std::array{1.0, 0.0, 0.0}).zero_order_hold(0.25);
  EXPECT_DOUBLE_EQ(discrete.A(0, 1), 0.25);
  EXPECT_DOUBLE_EQ(discrete.B(0, 0), 0.03125);
  EXPECT_DOUBLE_EQ(discrete.B(1, 0), 0.25);
}

TEST(ZeroOrderHold, AgreesWithRungeKuttaAtTinySteps) {
  std::mt19937 random(1);
  for (int storm = 0; storm < 20; ++storm) {
    const LinearSystem system = random_stable_system(random, 1 + storm % kMaxStates, 1 + storm % kMaxPorts, 1);
    const double period = 0.01;
    const DiscreteSystem discrete = system.zero_order_hold(period);
    const StateVector start = StateVector::Random(system.states());
    const PortVector u = PortVector::Random(system.B.cols());
    StateVector x = start;
    constexpr int kSteps = 1000;  // of 1e-5 s: local error (140 * 1e-5)^5 / 120, far below rounding
    const double h = period / kSteps;
    const auto f = [&](const StateVector& state) { return StateVector(system.A * state + system.B * u); };
    for (int i = 0; i < kSteps; ++i) {
      const StateVector k1 = f(x), k2 = f(x + 0.5 * h * k1), k3 = f(x + 0.5 * h * k2), k4 = f(x + h * k3);
      x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    EXPECT_LT((discrete.next(start, u) - x).norm(), 1e-11);
  }
}

TEST(ZeroOrderHold, TwoPeriodsAreOneOfTwiceTheLength) {
  std::mt19937 random(2);
  for (int storm = 0; storm < 50; ++storm) {
    const LinearSystem system = random_stable_system(random, 1 + storm % kMaxStates, 2, 2);
    const DiscreteSystem once = system.zero_order_hold(0.02);
    const DiscreteSystem twice = system.zero_order_hold(0.04);
    const StateVector x = StateVector::Random(system.states());
    const PortVector u = PortVector::Random(2);
    EXPECT_LT((once.next(once.next(x, u), u) - twice.next(x, u)).norm(), 1e-12);
  }
}

TEST(ZeroOrderHold, RefusesAPeriodThatIsNotPositive) {
  const LinearSystem system = second_order(1.0, 0.5);
  for (double period : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(system.zero_order_hold(period), std::invalid_argument);
  }
}

TEST(DiscreteSystem, StepsWithoutAllocating) {
  std::mt19937 random(3);
  const DiscreteSystem system =
      random_stable_system(random, kMaxStates, kMaxPorts, kMaxPorts).zero_order_hold(1e-3);
  StateVector x = StateVector::Zero(kMaxStates);
  const PortVector u = PortVector::Ones(kMaxPorts);
  PortVector y;
  const long before = test::allocations();
  for (int k = 0; k < 100; ++k) {
    y = system.output(x, u);
    x = system.next(x, u);
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_TRUE(y.allFinite());
  static_assert(noexcept(system.next(x, u))&& noexcept(system.output(x, u)));
}

TEST(DiscreteSystem, PolesAreExponentialsOfTheContinuousOnes) {
  const LinearSystem system = second_order(20.0, 0.3);
  const Complex continuous = system.poles()(0);
  const Complex discrete = system.zero_order_hold(0.01).poles()(0);
  EXPECT_NEAR(std::abs(discrete), std::exp(continuous.real() * 0.01), 1e-14);
  EXPECT_NEAR(std::abs(std::arg(discrete)), std::abs(continuous.imag()) * 0.01, 1e-14);
}

TEST(FrequencyResponse, IsTheFourierIntegralOfTheImpulseResponse) {
  std::mt19937 random(4);
  for (int storm = 0; storm < 4; ++storm) {
    LinearSystem system = random_stable_system(random, 2 + storm % 5, 1, 1);
    system.D.setZero();
    const double w = 3.0 + 10.0 * storm;
    // Simpson's rule; slowest pole 1 rad/s, fastest 141: error about (141 h)^4 / 180 of the integrand.
    const double h = 1e-4;
    const DiscreteSystem discrete = system.zero_order_hold(h);
    StateVector x = system.B.col(0);
    Complex sum = 0.0;
    const int last = 300'000;
    for (int k = 0; k <= last; ++k) {
      const double weight = k == 0 || k == last ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
      sum += weight * system.C.row(0).dot(x) * std::polar(1.0, -w * k * h);
      x = discrete.A * x;
    }
    EXPECT_LT(std::abs(sum * h / 3.0 - system.frequency_response(w)(0, 0)), 1e-8) << storm;
  }
}

TEST(FrequencyResponse, IsTheRatioOfThePolynomials) {
  const std::array numerator{2.0, -3.0, 5.0};
  const std::array denominator{4.0, 1.0, 7.0, 2.0};
  const LinearSystem system = LinearSystem::from_transfer_function(numerator, denominator);
  for (double w : {0.0, 0.1, 1.0, 1.3, 30.0}) {
    const Complex s(0.0, w);
    const Complex expected = ((2.0 * s - 3.0) * s + 5.0) / (((4.0 * s + 1.0) * s + 7.0) * s + 2.0);
    EXPECT_LT(std::abs(system.frequency_response(w)(0, 0) - expected), 1e-14 * (1.0 + std::abs(expected)));
  }
}

TEST(FrequencyResponse, AtZeroIsTheStaticGainAndTheEndOfTheStep) {
  std::mt19937 random(5);
  for (int storm = 0; storm < 50; ++storm) {
    const LinearSystem system = random_stable_system(random, 1 + storm % kMaxStates, 1, 1);
    const double gain = (*system.dc_gain())(0, 0);
    EXPECT_NEAR(system.frequency_response(0.0)(0, 0).real(), gain, 1e-12);
    EXPECT_NEAR(step_response(system.zero_order_hold(0.5), 100).back(), gain, 1e-11);
  }
}

TEST(LinearSystem, KeepsTheFeedthroughOfAProperTransferFunction) {
  const auto system = LinearSystem::from_transfer_function(std::array{2.0, 1.0}, std::array{1.0, 1.0});
  EXPECT_DOUBLE_EQ(system.D(0, 0), 2.0);
  EXPECT_NEAR((*system.dc_gain())(0, 0), 1.0, 1e-15);
  const auto constant = LinearSystem::from_transfer_function(std::array{3.0}, std::array{2.0});
  EXPECT_EQ(constant.states(), 0);
  EXPECT_DOUBLE_EQ((*constant.dc_gain())(0, 0), 1.5);
}

TEST(LinearSystem, RefusesAnImproperTransferFunction) {
  const std::array<double, 0> nothing{};
  EXPECT_THROW(LinearSystem::from_transfer_function(std::array{1.0, 0.0}, std::array{1.0}),
               std::invalid_argument);
  EXPECT_THROW(LinearSystem::from_transfer_function(std::array{1.0}, std::array{0.0, 1.0}),
               std::invalid_argument);
  EXPECT_THROW(LinearSystem::from_transfer_function(std::array{1.0}, nothing), std::invalid_argument);
  EXPECT_THROW(LinearSystem::from_transfer_function(nothing, std::array{1.0}), std::invalid_argument);
  const std::array<double, kMaxStates + 2> too_long{1.0};
  EXPECT_THROW(LinearSystem::from_transfer_function(std::array{1.0}, too_long), std::invalid_argument);
}

TEST(LinearSystem, HasNoStaticGainWithAPoleAtZero) {
  const auto integrator = LinearSystem::from_transfer_function(std::array{1.0}, std::array{1.0, 2.0, 0.0});
  EXPECT_FALSE(integrator.dc_gain().has_value());
  EXPECT_FALSE(integrator.is_stable());
}

TEST(LinearSystem, PolesAreTheRootsOfTheDenominator) {
  // (s + 1)(s + 1e3)(s^2 + 2e3 s + 1e10), five decades apart
  const double a = 1001.0, b = 1000.0, c = 2e3, d = 1e10;
  const auto system = LinearSystem::from_transfer_function(
      std::array{1.0}, std::array{1.0, a + c, b + a * c + d, a * d + b * c, b * d});
  const PoleVector poles = system.poles();
  EXPECT_NEAR(poles(0).real(), -1.0, 1e-9);
  EXPECT_NEAR(poles(1).real(), -1e3, 1e-7);
  EXPECT_NEAR(poles(2).real(), -1e3, 1e-7);
  EXPECT_NEAR(std::max(std::abs(poles(1).imag()), std::abs(poles(2).imag())), std::sqrt(d - 1e6), 1e-6);
  EXPECT_TRUE(system.is_stable());
}

TEST(PeakGain, OfASecondOrderLagInClosedForm) {
  for (double zeta : {1e-8, 1e-4, 0.01, 0.1, 0.3, 0.6, 0.7}) {
    for (double natural : {0.2, 50.0, 6e4}) {
      const double w = natural * std::sqrt(1.0 - 2.0 * zeta * zeta);
      const GainPeak peak = second_order(natural, zeta).peak_gain(10.0 * natural);
      EXPECT_TRUE(peak.is_resonance);
      // Near zeta = 1/sqrt(2) the peak is as flat as it can be: its place is worth 1/zeta' fewer digits.
      EXPECT_NEAR(2.0 * pi * peak.frequency, w, 1e-12 * natural / (1.0 - 2.0 * zeta * zeta));
      const double gain = 1.0 / (2.0 * zeta * std::sqrt(1.0 - zeta * zeta));
      EXPECT_NEAR(peak.gain, gain, gain * (1e-12 + 1e-15 / zeta));
    }
  }
}

TEST(PeakGain, OfAMonotoneResponseLiesAtZero) {
  for (double zeta : {0.7072, 1.0, 5.0}) {
    const GainPeak peak = second_order(30.0, zeta).peak_gain(1000.0);
    EXPECT_FALSE(peak.is_resonance);
    EXPECT_EQ(peak.frequency, 0.0);
    EXPECT_NEAR(peak.gain, 1.0, 1e-15);
  }
}

TEST(PeakGain, BelowAResonanceLiesAtTheLimit) {
  const GainPeak peak = second_order(2.0 * pi * 100.0, 0.1).peak_gain(50.0);
  EXPECT_FALSE(peak.is_resonance);
  EXPECT_DOUBLE_EQ(peak.frequency, 50.0);
}

TEST(PeakGain, IsNowhereExceeded) {
  std::mt19937 random(6);
  for (int storm = 0; storm < 50; ++storm) {
    const LinearSystem system = random_stable_system(random, 1 + storm % kMaxStates, 1, 1);
    const GainPeak peak = system.peak_gain(100.0);
    EXPECT_NEAR(std::abs(system.frequency_response(2.0 * pi * peak.frequency)(0, 0)), peak.gain,
                1e-11 * peak.gain);
    for (double f = 0.0; f <= 100.0; f += 0.05) {
      EXPECT_LE(std::abs(system.frequency_response(2.0 * pi * f)(0, 0)), peak.gain * (1.0 + 1e-11));
    }
  }
}

TEST(FirstFallBelow, OfASecondOrderLagInClosedForm) {
  for (double zeta : {0.001, 0.1, 0.5, 1.0, 10.0}) {
    const double level = ratio_of_decibel(-3.0);
    const double b = 1.0 - 2.0 * zeta * zeta;
    const double u = b + std::sqrt(b * b + 1.0 / (level * level) - 1.0);
    const LinearSystem system = second_order(70.0, zeta);
    const auto found = system.first_fall_below(level, system.peak_gain(1e4).frequency);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(2.0 * pi * *found, 70.0 * std::sqrt(u), 70.0 * 1e-11 * (1.0 + zeta));
  }
}

TEST(FirstFallBelow, SeesANotchNarrowerThanAnyGrid) {
  // Two zeros almost on the axis at 10 rad/s, two poles almost on it at 10.001 rad/s, then a lag far above.
  const double wz = 10.0, wp = 10.001, damping = 1e-6;
  const auto system = LinearSystem::from_transfer_function(
      std::array{1e3, 2.0 * damping * 1e3, 1e3 * wz * wz},
      std::array{1.0, 1e3 + 2.0 * damping, 2.0 * damping * 1e3 + wp * wp, 1e3 * wp * wp});
  const auto found = system.first_fall_below(0.5, 0.0);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(2.0 * pi * *found, wz - (wp - wz), 1e-6);  // where |w^2 - wz^2| = |w^2 - wp^2| / 2
  EXPECT_NEAR(std::abs(system.frequency_response(2.0 * pi * *found)(0, 0)), 0.5, 1e-6);
}

TEST(FirstFallBelow, IsEmptyWhenTheGainStaysAbove) {
  const auto lead = LinearSystem::from_transfer_function(std::array{1.0, 1.0}, std::array{1.0, 2.0});
  EXPECT_FALSE(lead.first_fall_below(0.4, 0.0).has_value());
}

TEST(FirstFallBelow, IsTheStartWhenAlreadyBelow) {
  EXPECT_DOUBLE_EQ(*second_order(10.0, 0.5).first_fall_below(0.7, 100.0), 100.0);
}

TEST(StepMetrics, CountSamplesOfAPlainResponse) {
  const std::array samples{0.0, 0.2, 0.5, 0.7, 0.95, 1.1, 1.01, 1.0};
  const StepMetrics metrics = step_metrics(samples);
  EXPECT_EQ(metrics.rise_samples, 3);
  EXPECT_EQ(metrics.time_constant_samples, 3);
  EXPECT_EQ(metrics.settling_samples, 6);
  EXPECT_NEAR(metrics.overshoot, 0.1, 1e-15);
  EXPECT_EQ(metrics.steady_state_error, 0.0);
}

TEST(StepMetrics, AreEmptyForWhatIsNeverReached) {
  const std::array samples{0.0, 0.3, 0.5, 0.5};
  const StepMetrics metrics = step_metrics(samples);
  EXPECT_FALSE(metrics.rise_samples.has_value());
  EXPECT_FALSE(metrics.time_constant_samples.has_value());
  EXPECT_FALSE(metrics.settling_samples.has_value());
  EXPECT_EQ(metrics.overshoot, 0.0);
  EXPECT_DOUBLE_EQ(metrics.steady_state_error, 0.5);
}

TEST(StepMetrics, WaitForTheLastExcursion) {
  // A slow ringing that leaves the band of 2 % long after it first enters it.
  const double zeta = 0.01, natural = 1.0, period = 0.5;
  const auto metrics = step_metrics(second_order(natural, zeta).zero_order_hold(period));
  ASSERT_TRUE(metrics.has_value());
  // The envelope exp(-zeta w t) falls to 0.02 at t = 391; the last excursion is at most half a cycle earlier.
  const double settled = *metrics->settling_samples * period;
  EXPECT_LT(settled, -std::log(0.02) / zeta + period);
  EXPECT_GT(settled, -std::log(0.02) / zeta - 2.0 * pi);
  EXPECT_NEAR(metrics->overshoot, std::exp(-pi * zeta), 0.02);
  EXPECT_NEAR(metrics->steady_state_error, 0.0, 1e-12);
}

TEST(StepMetrics, ScaleWithTheTarget) {
  const auto discrete = second_order(1.0, 0.3).zero_order_hold(0.1);
  const auto samples = step_response(discrete, 2000, -4.0);
  const StepMetrics scaled = step_metrics(samples, -4.0);
  const StepMetrics unit = *step_metrics(discrete);
  EXPECT_EQ(scaled.rise_samples, unit.rise_samples);
  EXPECT_EQ(scaled.settling_samples, unit.settling_samples);
  EXPECT_NEAR(scaled.overshoot, unit.overshoot, 1e-13);
  EXPECT_THROW(step_metrics(samples, 0.0), std::invalid_argument);
}

TEST(StepMetrics, AreEmptyForAnUnstableSystem) {
  EXPECT_FALSE(step_metrics(second_order(1.0, -0.1).zero_order_hold(0.1)).has_value());
  EXPECT_FALSE(step_metrics(second_order(1.0, 0.0).zero_order_hold(0.1)).has_value());
}

TEST(Decibel, TurnsBackAndForth) {
  EXPECT_DOUBLE_EQ(decibel(10.0), 20.0);
  EXPECT_DOUBLE_EQ(ratio_of_decibel(decibel(0.3)), 0.3);
}

}  // namespace
}  // namespace zwidth
