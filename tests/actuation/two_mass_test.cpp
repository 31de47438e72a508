#include "zwidth/actuation/two_mass.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <stdexcept>

namespace zwidth {
namespace {

using std::numbers::pi;
constexpr double kRatio = 15.062523164965542;

// Neal 2015, table 5.1; the cable's stiffness is 0.225 of EA/l, as its results need.
TwoMassParameters published_parameters() {
  return {.input_inertia = 1.944e-6,
          .input_damping = 0.0007778110047846889,
          .input_radius = 0.005004540021245003,
          .output_inertia = 0.0002117,
          .output_radius = 0.075381,
          .tip_radius = 0.08,
          .contact_stiffness = 9.8e7,
          .contact_damping = 0.0,
          .cable_stiffness = 120465.0,
          .torque_constant = 0.0255};
}

TwoMassModel published() {
  return *TwoMassModel::make(published_parameters());
}

TwoMassModel random_model(std::mt19937& random) {
  std::uniform_real_distribution<double> decade(-0.5, 0.5);
  const auto around = [&](double x) { return x * std::pow(10.0, decade(random)); };
  TwoMassParameters p = published_parameters();
  p.input_inertia = around(p.input_inertia);
  p.input_damping = around(p.input_damping);
  p.input_radius = around(p.input_radius);
  p.output_inertia = around(p.output_inertia);
  p.output_radius = around(p.output_radius);
  p.tip_radius = around(p.tip_radius);
  p.contact_stiffness = around(p.contact_stiffness);
  p.contact_damping = around(20.0);
  p.cable_stiffness = around(p.cable_stiffness);
  p.torque_constant = around(p.torque_constant);
  return *TwoMassModel::make(p);
}

TEST(TwoMass, CoefficientsAsPublished) {  // Neal 2015, table 5.1
  const TwoMassCoefficients c = published().coefficients();
  EXPECT_NEAR(c.m1, 0.077618979, 5e-10);
  EXPECT_NEAR(c.c1, 31.056, 5e-4);
  EXPECT_NEAR(c.m2, 0.037256072, 5e-10);
  EXPECT_NEAR(c.k2, 1.1037793e8, 10.0);
  EXPECT_EQ(c.k1, 120465.0);
  EXPECT_EQ(c.c2, 0.0);
}

TEST(TwoMass, FiguresAsPublished) {  // Neal 2015, table 4.1
  EXPECT_NEAR(reflected_inertia(1.944e-6, 2.117e-4, kRatio), 6.5275395e-4, 5e-12);
  EXPECT_NEAR(perceived_mass(1.944e-6, 2.117e-4, kRatio, 0.08), 0.1019928, 5e-8);
  EXPECT_NEAR(torque_resolution(0.0255, 1e-3, kRatio), 3.8409434e-4, 5e-12);
  EXPECT_NEAR(angular_resolution(4000.0, kRatio) * 180.0 / pi * 3600.0, 21.51034, 5e-6);
}

TEST(TwoMass, ResponseAsPublished) {  // Neal 2015, section 6.1
  EXPECT_NEAR(published().dc_gain()[TwoMassModel::tip_force], 4.80118, 5e-6);
  EXPECT_NEAR(published().resonance().frequency, 192.98807, 5e-6);
  EXPECT_TRUE(published().resonance().is_resonance);
  EXPECT_NEAR(published().resonance_peak(), 9.978532, 5e-7);
  EXPECT_NEAR(*published().bandwidth(3.0), 302.26705, 5e-6);
  EXPECT_NEAR(published().static_force(1.5), 7.2017689, 5e-8);
  EXPECT_NEAR(published().static_force(0.094), 0.45131085, 5e-9);
  const double at_130 = std::abs(published().frequency_response(130.0)) / published().dc_gain()[0];
  EXPECT_NEAR(decibel(at_130), 4.3, 0.05);
}

TEST(TwoMass, ResponseWithThePrintedCableStiffness) {
  TwoMassParameters parameters = published_parameters();
  parameters.cable_stiffness = 1.339e5;
  const TwoMassModel model = *TwoMassModel::make(parameters);
  EXPECT_NEAR(model.resonance().frequency, 204.0, 0.05);
  EXPECT_NEAR(model.resonance_peak(), 10.43, 5e-3);
  EXPECT_NEAR(*model.bandwidth(3.0), 319.3, 0.05);
}

TEST(TwoMass, SecondModeIsNearlyUndamped) {
  const PoleVector poles = published().system().poles();
  double highest = 0.0;
  for (const auto& pole : poles) {
    highest = std::max(highest, pole.imag());
  }
  EXPECT_NEAR(highest / (2.0 * pi), 8670.0, 5.0);
  EXPECT_TRUE(published().system().is_stable());
  // Above the search limit of the resonance it towers over everything.
  EXPECT_NEAR(published().resonance(20e3).frequency, highest / (2.0 * pi), 1e-3);
}

TEST(TwoMass, StepOvershootsAsComputedFromTheSource) {
  const auto overshoot = [](double period, int count) {
    const std::vector<double> force = published().step_force(1.5, period, count);
    EXPECT_EQ(force[0], 0.0);
    return step_metrics(force, published().static_force(1.5)).overshoot;
  };
  EXPECT_NEAR(overshoot(1e-5, 5000), 0.600, 5e-4) << "continuous";
  EXPECT_NEAR(overshoot(1.0 / 420.0, 100), 0.585, 5e-4) << "as sampled in the source's experiment";
}

TEST(TwoMass, SamplesDoNotDependOnThePeriod) {
  const std::vector<double> fine = published().step_force(1.5, 1.0 / 42000.0, 4201);
  const std::vector<double> coarse = published().step_force(1.5, 1.0 / 420.0, 43);
  for (std::size_t k = 0; k < 42; ++k) {
    EXPECT_NEAR(coarse[k], fine[100 * k], 1e-9);
  }
}

TEST(TwoMass, StaticGainIsTheSystems) {
  std::mt19937 random(1);
  for (int storm = 0; storm < 200; ++storm) {
    const TwoMassModel model = random_model(random);
    const auto by_matrix = *model.system().dc_gain();
    for (int output = 0; output < 3; ++output) {
      const double expected = model.dc_gain()[output];
      EXPECT_NEAR(by_matrix(output, 0), expected, 1e-11 * expected);
    }
  }
}

TEST(TwoMass, PowerIsKept) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int storm = 0; storm < 200; ++storm) {
    const TwoMassModel model = random_model(random);
    const auto [m1, c1, k1, m2, c2, k2] = model.coefficients();
    const double z1 = 1e-4 * normal(random), v1 = normal(random), z2 = 1e-5 * normal(random),
                 v2 = normal(random);
    const double current = 3.0 * normal(random);
    StateVector x(4);
    x << z1, v1, z2, v2;
    const StateVector dx = model.system().A * x + model.system().B * current;
    const double stored = m1 * v1 * dx[1] + m2 * v2 * dx[3] + k1 * (z1 - z2) * (v1 - v2) + k2 * z2 * v2;
    const double torque = model.parameters().torque_constant * current;
    const double put_in = torque * v1 / model.parameters().input_radius;
    const double lost = c1 * v1 * v1 + c2 * v2 * v2;
    const double scale = m2 * std::abs(v2 * dx[3]) + m1 * std::abs(v1 * dx[1]) + lost;
    EXPECT_NEAR(stored, put_in - lost, 1e-12 * scale);
    // Virtual work: the tip moves r_o/r2 times as far as the cable, and carries the contact's force.
    const double force = (model.system().C * x)(TwoMassModel::tip_force);
    const double tip_per_cable = model.parameters().tip_radius / model.parameters().output_radius;
    EXPECT_NEAR(force * tip_per_cable, k2 * z2 + c2 * v2, 1e-12 * (k2 * std::abs(z2) + c2 * std::abs(v2)));
  }
}

TEST(TwoMass, FrequencyResponseSolvesTheEquationsOfMotion) {
  std::mt19937 random(3);
  for (int storm = 0; storm < 200; ++storm) {
    const TwoMassModel model = random_model(random);
    const auto [m1, c1, k1, m2, c2, k2] = model.coefficients();
    const double f = std::pow(10.0, 0.02 * storm);
    const std::complex<double> s(0.0, 2.0 * pi * f);
    const double F = model.parameters().torque_constant / model.parameters().input_radius;
    const auto upper = m1 * s * s + c1 * s + k1;
    const auto lower = m2 * s * s + c2 * s + k1 + k2;
    const auto z1 = F * lower / (upper * lower - k1 * k1);
    const auto z2 = k1 * z1 / lower;
    const double r2 = model.parameters().output_radius, r_o = model.parameters().tip_radius;
    const auto force = r2 / r_o * (k2 + c2 * s) * z2;
    EXPECT_LT(std::abs(model.frequency_response(f) - force), 1e-9 * std::abs(force));
    const auto motor = z1 / model.parameters().input_radius;
    EXPECT_LT(std::abs(model.frequency_response(f, TwoMassModel::motor_angle) - motor), 1e-9 * std::abs(motor));
    const auto sector = z2 / r2;
    EXPECT_LT(std::abs(model.frequency_response(f, TwoMassModel::sector_angle) - sector),
              1e-9 * std::abs(sector));
  }
}

TEST(TwoMass, BandwidthKeepsItsDefinition) {
  std::mt19937 random(4);
  for (int storm = 0; storm < 100; ++storm) {
    const TwoMassModel model = random_model(random);
    const double drop = 1.0 + 0.1 * storm;
    const double level = model.dc_gain()[0] * ratio_of_decibel(-drop);
    const GainPeak peak = model.resonance();
    const double bandwidth = *model.bandwidth(drop);
    EXPECT_GE(bandwidth, peak.frequency);
    EXPECT_NEAR(std::abs(model.frequency_response(bandwidth)), level, 1e-9 * level);
    for (int i = 0; i < 200; ++i) {
      const double f = peak.frequency + (bandwidth - peak.frequency) * i / 200.0;
      EXPECT_GE(std::abs(model.frequency_response(f)), level * (1.0 - 1e-9));
      EXPECT_LE(std::abs(model.frequency_response(TwoMassModel::kDefaultSearchLimit * i / 200.0)),
                peak.gain * (1.0 + 1e-9));
    }
  }
}

TEST(TwoMass, HeavyDampingHasNoResonance) {
  TwoMassParameters parameters = published_parameters();
  parameters.input_damping *= 20.0;
  const TwoMassModel model = *TwoMassModel::make(parameters);
  EXPECT_FALSE(model.resonance().is_resonance);
  EXPECT_EQ(model.resonance().frequency, 0.0);
  EXPECT_NEAR(model.resonance_peak(), 0.0, 1e-9);
  EXPECT_LT(*model.bandwidth(3.0), published().bandwidth(3.0));
}

TEST(TwoMass, WithoutDampingTheResonanceIsFiniteOnPaperOnly) {
  TwoMassParameters parameters = published_parameters();
  parameters.input_damping = 0.0;
  const TwoMassModel model = *TwoMassModel::make(parameters);
  const TwoMassCoefficients c = model.coefficients();
  EXPECT_NEAR(model.resonance().frequency, std::sqrt(c.k1 / c.m1) / (2.0 * pi), 0.5);
  EXPECT_GT(model.resonance_peak(), 150.0);
  EXPECT_TRUE(std::isfinite(model.resonance_peak()));
}

TEST(TwoMass, NeedsPositiveParameters) {
  const auto made = [](auto&& change) {
    TwoMassParameters parameters = published_parameters();
    change(parameters);
    return TwoMassModel::make(parameters).has_value();
  };
  EXPECT_TRUE(made([](auto&) {}));
  EXPECT_FALSE(made([](auto& p) { p.input_inertia = 0.0; }));
  EXPECT_FALSE(made([](auto& p) { p.input_radius = -1.0; }));
  EXPECT_FALSE(made([](auto& p) { p.output_inertia = std::nan(""); }));
  EXPECT_FALSE(made([](auto& p) { p.contact_stiffness = 0.0; }));
  EXPECT_FALSE(made([](auto& p) { p.contact_damping = -1.0; }));
  EXPECT_FALSE(made([](auto& p) { p.cable_stiffness = 0.0; }));
  EXPECT_THROW(perceived_mass(1e-6, 1e-4, 15.0, 0.0), std::invalid_argument);
  EXPECT_THROW(angular_resolution(0.0, 15.0), std::invalid_argument);
  EXPECT_THROW(tip_to_cable(1.0, 0.0, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace zwidth
