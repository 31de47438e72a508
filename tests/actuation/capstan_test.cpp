#include "zwidth/actuation/capstan.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "support/drives.h"
#include "support/storm.h"

namespace zwidth {
namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180.0;
constexpr double kTorque = 0.0694;

CapstanDimensions published_dimensions() {
  return {.input_diameter = 10e-3,
          .lead = 1e-3,
          .cable_diameter = 0.762e-3,
          .output_diameter = 150e-3,
          .centre_distance = 80.5e-3,
          .wraps = 3.0,
          .friction = 0.1,
          .output_range = 120.0 * kDegree};
}

Capstan published() {
  return solve_capstan(published_dimensions());
}

CapstanDimensions random_dimensions(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto between = [&](double a, double b) { return a + (b - a) * uniform(random); };
  CapstanDimensions d;
  d.lead = between(0.5e-3, 2e-3);
  d.cable_diameter = d.lead * between(0.4, 0.9);
  d.input_diameter = d.lead * between(4.0, 20.0);
  d.output_diameter = between(0.05, 0.3);
  d.centre_distance =
      0.5 * (d.input_diameter + d.output_diameter) + 2.0 * d.cable_diameter + between(0.0, 5e-3);
  d.wraps = between(1.0, 6.0);
  d.friction = between(0.03, 0.4);
  d.output_range = between(0.5, 2.5);
  return d;
}

TEST(Capstan, GeometryAsPublished) {  // Neal 2015, table 4.8
  const Capstan capstan = published();
  ASSERT_TRUE(capstan.ok());
  EXPECT_TRUE(capstan.reason.empty());
  const double half_digit = 5e-7;
  EXPECT_NEAR(capstan.pitch_diameter, 9.350e-3, half_digit);
  EXPECT_NEAR(capstan.contact_diameter, 9.628e-3, half_digit);
  EXPECT_NEAR(capstan.input_pitch_diameter, 10.009e-3, half_digit);
  EXPECT_NEAR(capstan.output_pitch_diameter, 150.762e-3, half_digit);
  EXPECT_NEAR(capstan.length_on_input, 93.847e-3, half_digit);
  EXPECT_NEAR(capstan.length_on_output, 157.957e-3, half_digit);
  EXPECT_NEAR(capstan.length_between, 8.587e-3, half_digit);
  EXPECT_NEAR(capstan.cable_length, 260.391e-3, half_digit);
  EXPECT_NEAR(capstan.input_width, 8.021e-3, half_digit);
  EXPECT_NEAR(capstan.thread_width, 8.004e-3, half_digit);
  EXPECT_NEAR(capstan.min_centre_distance, 80.386e-3, half_digit);
  EXPECT_NEAR(capstan.helix_angle / kDegree, 1.894, 5e-4);
  EXPECT_NEAR(capstan.groove_half_angle / kDegree, 29.986, 5e-4);
  EXPECT_NEAR(capstan.cable_angle / kDegree, 1.822, 5e-4);
  EXPECT_NEAR(capstan.tangent_angle / kDegree, 3.056, 5e-4);
  EXPECT_NEAR(capstan.contact_angle / kDegree, 1073.888, 5e-4);
  EXPECT_NEAR(capstan.ratio, 15.0625, 5e-5);
  EXPECT_FALSE(capstan.wraps_touch);
}

TEST(Capstan, ForcesAsPublished) {  // Neal 2015, table 4.8
  const CapstanLoads loads = published().loads_at_min_preload(kTorque);
  const double half_digit = 5e-4;
  EXPECT_NEAR(loads.tension_difference, 6.937, half_digit);
  EXPECT_NEAR(loads.preload, 7.271, half_digit);
  EXPECT_NEAR(loads.low_tension, 0.334, half_digit);
  EXPECT_NEAR(loads.high_tension, 14.209, half_digit);
  EXPECT_NEAR(loads.bearing_x, 0.775, half_digit);
  EXPECT_NEAR(loads.bearing_y, 13.848, half_digit);
  EXPECT_NEAR(loads.bearing_axial, 0.441, half_digit);
  EXPECT_NEAR(loads.bearing_radial, 13.869, half_digit);
  EXPECT_NEAR(published().output_torque(kTorque), 1.045, half_digit);
  EXPECT_NEAR(published().output_torque(kTorque, 1.3), 1.359, half_digit);
  EXPECT_NEAR(published().slip_torque(9.5), 1.3657, 5e-5) << "not the 1.359 N m that the source ties to it";
}

TEST(Capstan, OfOtherDimensions) {
  const Capstan a = solve_capstan({12e-3, 1.25e-3, 0.8e-3, 0.12, 66.8e-3, 2.0, 0.15, 100.0 * kDegree});
  EXPECT_NEAR(a.min_preload(0.05), 4.491502008138945, 1e-12);
  const Capstan b = solve_capstan({8e-3, 1e-3, 0.6e-3, 0.2, 0.106, 4.0, 0.08, 90.0 * kDegree});
  EXPECT_NEAR(b.loads_at_min_preload(0.03).low_tension, 0.1512317521284489, 1e-13);
}

TEST(Capstan, WithoutIterationKeepsTheHelixOfThePitchDiameter) {
  const Capstan capstan = solve_capstan(published_dimensions(), {.iterate_helix = false});
  EXPECT_NEAR(capstan.helix_angle / kDegree, 1.950, 5e-4);
  EXPECT_NEAR(capstan.ratio, 15.06247, 5e-6);
}

TEST(Capstan, HelixBelongsToTheContactDiameter) {
  std::mt19937 random(1);
  for (int storm = 0; storm < test::storm_size(1000); ++storm) {
    const Capstan capstan = solve_capstan(random_dimensions(random));
    ASSERT_NE(capstan.status, CapstanStatus::invalid_argument);
    const CapstanDimensions& d = capstan.dimensions;
    EXPECT_NEAR(std::tan(capstan.helix_angle), d.lead / (pi * capstan.contact_diameter), 1e-15);
    EXPECT_NEAR(std::tan(capstan.groove_half_angle), std::cos(capstan.helix_angle) * std::tan(pi / 6.0), 1e-15);
    // The cable's centre line to where it touches: half a cable in the flank's direction.
    const double x = capstan.input_pitch_diameter - d.cable_diameter * std::sin(capstan.groove_half_angle);
    const double y = d.cable_diameter * std::cos(capstan.groove_half_angle) * std::sin(capstan.helix_angle);
    EXPECT_NEAR(capstan.contact_diameter, std::hypot(x, y), 1e-15 * 10.0);
  }
}

TEST(Capstan, PreloadHoldsExactlyAtSlip) {
  std::mt19937 random(2);
  for (int storm = 0; storm < test::storm_size(1000); ++storm) {
    const Capstan capstan = solve_capstan(random_dimensions(random));
    const double torque = 0.01 + 1e-4 * (storm % 1000);
    const double preload = capstan.min_preload(torque);
    EXPECT_NEAR(capstan.slip_torque(preload), capstan.output_torque(torque), 1e-13);
    // Euler's rope at that preload: the tensions' ratio is what friction can hold.
    const CapstanLoads loads = capstan.loads_at_min_preload(torque);
    EXPECT_NEAR(std::log(loads.high_tension / loads.low_tension), capstan.friction_exponent,
                1e-12 * capstan.friction_exponent);
    EXPECT_NEAR(loads.low_tension, preload - loads.tension_difference, 1e-14 * preload);
    EXPECT_NEAR(loads.high_tension - loads.low_tension, 2.0 * loads.tension_difference, 1e-13 * preload);
  }
}

TEST(Capstan, BearingLoadHasTwoForms) {
  std::mt19937 random(3);
  for (int storm = 0; storm < test::storm_size(1000); ++storm) {
    const Capstan capstan = solve_capstan(random_dimensions(random));
    const CapstanLoads loads = capstan.loads(20.0, 0.05);
    const double d5 = capstan.input_pitch_diameter, d7 = capstan.output_pitch_diameter;
    EXPECT_NEAR(loads.bearing_y, (d5 + d7) * 0.05 / (d5 * capstan.dimensions.centre_distance),
                1e-13 * loads.bearing_y);
    EXPECT_NEAR(capstan.tangent_angle, std::acos((d5 + d7) / (2.0 * capstan.dimensions.centre_distance)), 1e-7);
    EXPECT_EQ(capstan.loads(20.0, -0.05).bearing_y, loads.bearing_y);
  }
}

TEST(Capstan, PaysOutOnOnePulleyWhatTheOtherTakesUp) {
  std::mt19937 random(4);
  for (int storm = 0; storm < test::storm_size(1000); ++storm) {
    CapstanDimensions dimensions = random_dimensions(random);
    const Capstan before = solve_capstan(dimensions);
    const double turn = 0.1;
    dimensions.output_range += turn;
    const Capstan after = solve_capstan(dimensions);
    const double taken_up = after.length_on_output - before.length_on_output;
    const double paid_out = before.length_on_input / before.contact_angle * before.ratio * turn;
    EXPECT_NEAR(taken_up, paid_out, 1e-13);
    EXPECT_NEAR(after.thread_width - before.thread_width, before.ratio * turn / (2.0 * pi) * dimensions.lead,
                1e-15);
  }
}

TEST(Capstan, WidthIsTheAdvanceAlongTheWholeCable) {
  std::mt19937 random(5);
  for (int storm = 0; storm < test::storm_size(1000); ++storm) {
    const Capstan capstan = solve_capstan(random_dimensions(random));
    // (4.49), less the angle that (4.46) and (4.50) count differently
    const double along = std::sin(capstan.cable_angle) * capstan.cable_length;
    const double twice = capstan.ratio * capstan.tangent_angle * capstan.dimensions.lead / pi;
    EXPECT_NEAR(capstan.input_width, along - twice, 1e-15 * 20.0);
  }
}

TEST(Capstan, EquivalentLengthAsPublished) {  // Neal 2015, table 5.1
  EXPECT_NEAR(*published().equivalent_cable_length(24.14 * kDegree), 0.061220188, 5e-10);
  EXPECT_NEAR(*published().equivalent_cable_length(24.0 * kDegree), 0.06127, 5e-6);
}

TEST(Capstan, EquivalentLengthIsLongestInTheMiddle) {
  const Capstan capstan = published();
  EXPECT_NEAR(*capstan.equivalent_cable_length(0.0), 0.25 * capstan.cable_length, 1e-16);
  double last = *capstan.equivalent_cable_length(0.0);
  for (double angle = 0.1; angle < 1.05; angle += 0.1) {
    EXPECT_LT(*capstan.equivalent_cable_length(angle), last);
    EXPECT_DOUBLE_EQ(*capstan.equivalent_cable_length(-angle), *capstan.equivalent_cable_length(angle));
    last = *capstan.equivalent_cable_length(angle);
  }
  EXPECT_FALSE(capstan.equivalent_cable_length(2.0).has_value());
  EXPECT_FALSE(capstan.equivalent_cable_length(std::nan("")).has_value());
}

TEST(Capstan, ManyWrapsNeitherOverflowNorSlip) {
  CapstanDimensions dimensions = published_dimensions();
  dimensions.wraps = 1e4;
  const CapstanLoads loads = solve_capstan(dimensions).loads_at_min_preload(kTorque);
  EXPECT_DOUBLE_EQ(loads.preload, loads.tension_difference);
  EXPECT_EQ(loads.low_tension, 0.0);
}

TEST(Capstan, RefusesWhatBreaksARule) {
  const auto refused = [](auto&& change) {
    CapstanDimensions dimensions = published_dimensions();
    change(dimensions);
    const Capstan capstan = solve_capstan(dimensions);
    return capstan.status == CapstanStatus::invalid_argument && !capstan.reason.empty();
  };
  for (double bad : {0.0, -1e-3, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(refused([&](auto& d) { d.input_diameter = bad; }));
    EXPECT_TRUE(refused([&](auto& d) { d.lead = bad; }));
    EXPECT_TRUE(refused([&](auto& d) { d.cable_diameter = bad; }));
    EXPECT_TRUE(refused([&](auto& d) { d.output_diameter = bad; }));
    EXPECT_TRUE(refused([&](auto& d) { d.centre_distance = bad; }));
    EXPECT_TRUE(refused([&](auto& d) { d.friction = bad; }));
  }
  EXPECT_TRUE(refused([](auto& d) { d.wraps = 0.99; }));
  EXPECT_TRUE(refused([](auto& d) { d.output_range = -0.1; }));
  EXPECT_TRUE(refused([](auto& d) { d.lead = 16e-3; })) << "no core is left below the thread";
}

TEST(Capstan, OverlappingPulleysNameTheLeastDistance) {
  CapstanDimensions dimensions = published_dimensions();
  dimensions.centre_distance = 80.3e-3;
  const Capstan overlapping = solve_capstan(dimensions);
  EXPECT_EQ(overlapping.status, CapstanStatus::invalid_argument);
  EXPECT_NEAR(overlapping.min_centre_distance, 80.38554e-3, 5e-9);
  dimensions.centre_distance = overlapping.min_centre_distance;
  const Capstan touching = solve_capstan(dimensions);
  EXPECT_TRUE(touching.ok());
  EXPECT_EQ(touching.tangent_angle, 0.0);
}

TEST(Capstan, ThickCableRidesOnTheCrests) {
  CapstanDimensions dimensions = published_dimensions();
  dimensions.cable_diameter = 1.2e-3;
  dimensions.centre_distance = 82e-3;
  const Capstan capstan = solve_capstan(dimensions);
  EXPECT_EQ(capstan.status, CapstanStatus::not_seated);
  EXPECT_GT(capstan.contact_diameter, dimensions.input_diameter);
  EXPECT_TRUE(capstan.wraps_touch);
}

TEST(Capstan, DimensionsComeFromADescription) {
  const DriveDescription drive = test::published_drive();
  CapstanDescription description = std::get<CapstanDescription>(drive.transmission);
  const Capstan capstan = solve_capstan(capstan_dimensions(description, {-1.0, 1.0}));
  EXPECT_EQ(capstan.ratio, published().ratio);
  EXPECT_EQ(capstan.length_on_output, published().length_on_output);
  description.output_range = 0.0;
  EXPECT_EQ(capstan_dimensions(description, {-1.0, 1.0}).output_range, 2.0);
}

}  // namespace
}  // namespace zwidth
