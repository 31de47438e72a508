#include "zwidth/actuation/current_loop.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

namespace zwidth {
namespace {

using std::numbers::pi;

CurrentLoop published() {
  return *CurrentLoop::make(0.836, 0.118e-3, {1.171875, 5078.125});
}

CurrentLoop random_loop(std::mt19937& random) {
  std::uniform_real_distribution<double> decade(-1.0, 1.0);
  const auto around = [&](double x) { return x * std::pow(10.0, decade(random)); };
  const double R = around(1.0), L = around(2e-4), KP = around(1.0), KI = around(5e3);
  return *CurrentLoop::make(R, L, {KP, KI});
}

// The same loop with its physical states: the current, and the integral of the error.
LinearSystem physical(const CurrentLoop& loop) {
  const double R = loop.resistance(), L = loop.inductance();
  const auto [KP, KI] = loop.gains();
  LinearSystem system;
  system.A.resize(2, 2);
  system.A << -(KP + R) / L, KI / L, -1.0, 0.0;
  system.B.resize(2, 1);
  system.B << KP / L, 1.0;
  system.C.resize(1, 2);
  system.C << 1.0, 0.0;
  system.D = FeedthroughMatrix::Zero(1, 1);
  return system;
}

TEST(CurrentLoop, BandwidthPolesAndZeroAsPublished) {
  EXPECT_NEAR(*published().bandwidth(3.0), 1003.0728, 1e-4);
  EXPECT_NEAR(*published().bandwidth(10.0 * std::log10(2.0)), 1007.08, 5e-3);
  EXPECT_NEAR(published().poles()[0].real(), -3090.4, 0.05);
  EXPECT_NEAR(published().poles()[1].real(), -13925.5, 0.05);
  EXPECT_NEAR(*published().zero(), -4333.3, 0.05);
  EXPECT_GT(*published().damping_ratio(), 1.0);
}

TEST(CurrentLoop, StepAsPublished) {  // Neal 2015, table 4.5
  const std::array expected{0.0,    0.5725, 0.7623, 0.8444, 0.8905, 0.9208,
                            0.9421, 0.9576, 0.9689, 0.9772, 0.9832};
  const std::vector<double> step = published().step(1e-4, 11);
  ASSERT_EQ(step.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(step[k], expected[k], 5.1e-5);
  }
  const StepMetrics metrics = *published().metrics(1e-4);
  EXPECT_EQ(metrics.rise_samples, 4);
  EXPECT_EQ(metrics.time_constant_samples, 2);
  EXPECT_EQ(metrics.settling_samples, 10);
  EXPECT_NEAR(metrics.overshoot, 0.0, 1e-12);
  EXPECT_NEAR(metrics.steady_state_error, 0.0, 1e-12);
}

TEST(CurrentLoop, OfAnotherMotor) {
  const CurrentLoop loop = *CurrentLoop::make(1.43, 0.00031, {1.640625, 8203.125});
  EXPECT_NEAR(*loop.bandwidth(3.0), 904.2794146567762, 1e-9);
  const std::array expected{0.0,
                            0.41710617890753565,
                            0.6677941969832135,
                            0.8154839432296896,
                            0.9006533074976857,
                            0.9486085251958372,
                            0.9748629804919895,
                            0.9887439781768713};
  const std::vector<double> step = loop.step(1e-4, 8);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(step[k], expected[k], 1e-13);
  }
  EXPECT_EQ(loop.metrics(1e-4)->settling_samples, 7);
  EXPECT_NEAR(loop.metrics(1e-4)->overshoot, 0.0008939274470460834, 1e-12);
}

TEST(CurrentLoop, BandwidthIsTheLastFrequencyAboveTheDrop) {
  std::mt19937 random(1);
  for (int storm = 0; storm < 300; ++storm) {
    const CurrentLoop loop = random_loop(random);
    const LinearSystem system = loop.closed_loop();
    const double drop = 0.5 + 0.05 * storm;
    const double level = ratio_of_decibel(-drop);
    const double found = *loop.bandwidth(drop);
    EXPECT_NEAR(std::abs(system.frequency_response(2.0 * pi * found)(0, 0)), level, 1e-10);
    EXPECT_LT(std::abs(system.frequency_response(2.0 * pi * found * 1.01)(0, 0)), level);
    const auto searched = system.first_fall_below(level, system.peak_gain(10.0 * found).frequency);
    EXPECT_NEAR(*searched, found, 1e-9 * found);
  }
}

TEST(CurrentLoop, TransferFunctionIsThatOfThePhysicalLoop) {
  std::mt19937 random(2);
  for (int storm = 0; storm < 100; ++storm) {
    const CurrentLoop loop = random_loop(random);
    const auto poles = loop.poles();
    const PoleVector eigenvalues = physical(loop).poles();
    EXPECT_LT(std::abs(poles[0] + poles[1] - eigenvalues.sum()), 1e-9 * std::abs(eigenvalues.sum()));
    EXPECT_LT(std::abs(poles[0] * poles[1] - eigenvalues.prod()), 1e-9 * std::abs(eigenvalues.prod()));
    EXPECT_LE(std::abs(poles[0].real()), std::abs(poles[1].real()));
    const std::vector<double> ours = loop.step(1e-4, 30);
    const std::vector<double> theirs = step_response(physical(loop).zero_order_hold(1e-4), 30);
    for (std::size_t k = 0; k < ours.size(); ++k) {
      EXPECT_NEAR(ours[k], theirs[k], 1e-11);
    }
  }
}

TEST(CurrentLoop, RingsBelowADampingRatioOfOne) {
  const CurrentLoop loop = *CurrentLoop::make(0.5, 1e-3, {0.5, 4000.0});
  EXPECT_DOUBLE_EQ(*loop.damping_ratio(), 0.25);
  EXPECT_NEAR(loop.natural_frequency(), 2000.0, 1e-9);
  EXPECT_NEAR(std::abs(loop.poles()[0]), 2000.0, 1e-9);
  EXPECT_NEAR(loop.poles()[0].real(), -500.0, 1e-9);
  EXPECT_GT(loop.metrics(1e-4)->overshoot, 0.4);
}

TEST(CurrentLoop, WithoutIntegralGainStopsShort) {
  const CurrentLoop loop = *CurrentLoop::make(1.0, 1e-3, {3.0, 0.0});
  EXPECT_TRUE(loop.is_stable());
  EXPECT_FALSE(loop.damping_ratio().has_value());
  EXPECT_EQ(loop.poles()[0], 0.0);
  EXPECT_DOUBLE_EQ(loop.poles()[1].real(), -4000.0);
  const StepMetrics metrics = *loop.metrics(1e-4);
  EXPECT_NEAR(metrics.steady_state_error, 0.25, 1e-12);
  EXPECT_FALSE(metrics.settling_samples.has_value());
  EXPECT_FALSE(metrics.rise_samples.has_value());
  EXPECT_FALSE(loop.bandwidth(2.0).has_value()) << "its gain is 2.5 dB below one everywhere";
  EXPECT_NEAR(*loop.bandwidth(3.0), 4000.0 / (2.0 * pi) * std::sqrt(0.5625 * std::pow(10.0, 0.3) - 1.0), 1e-9);
}

TEST(CurrentLoop, UnstableHasNoBandwidthAndNoMetrics) {
  for (const CurrentGains& gains : {CurrentGains{-2.0, 100.0}, CurrentGains{1.0, -10.0}}) {
    const CurrentLoop loop = *CurrentLoop::make(1.0, 1e-3, gains);
    EXPECT_FALSE(loop.is_stable());
    EXPECT_FALSE(loop.bandwidth().has_value());
    EXPECT_FALSE(loop.metrics(1e-4).has_value());
  }
}

TEST(CurrentLoop, NeedsAWinding) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(CurrentLoop::make(0.0, 1e-3, {1.0, 1.0}).has_value());
  EXPECT_FALSE(CurrentLoop::make(1.0, -1e-3, {1.0, 1.0}).has_value());
  EXPECT_FALSE(CurrentLoop::make(1.0, 1e-3, {std::nan(""), 1.0}).has_value());
  EXPECT_FALSE(CurrentLoop::make(1.0, infinity, {1.0, 1.0}).has_value());
  EXPECT_FALSE(published().bandwidth(0.0).has_value());
  EXPECT_FALSE(published().bandwidth(-3.0).has_value());
}

}  // namespace
}  // namespace zwidth
