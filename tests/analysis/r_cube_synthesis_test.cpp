#include "zwidth/analysis/r_cube_synthesis.h"

#include <Eigen/SVD>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "support/r_cubes.h"

#include "zwidth/math/section.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(RCubeSynthesis, MaxAngleAndDriveLinkUndoEachOther) {
  const double angle = *r_cube_max_angle(0.1117, 0.06);
  EXPECT_NEAR(angle / kDegree, 32.5, 0.05);  // Görgülü 2018, table 7.2, solution 1
  EXPECT_NEAR(*r_cube_drive_link(angle, 0.06), 0.1117, 1e-15);
  EXPECT_NEAR(*r_cube_max_angle(0.06, 0.06), 0.5 * std::numbers::pi, 1e-12);
  EXPECT_FALSE(r_cube_max_angle(0.05, 0.06));
  EXPECT_FALSE(r_cube_max_angle(NAN, 0.06));
  EXPECT_FALSE(r_cube_max_angle(0.1, 0.0));
  EXPECT_FALSE(r_cube_drive_link(0.0, 0.06));
  EXPECT_FALSE(r_cube_drive_link(1.6, 0.06));
  EXPECT_FALSE(r_cube_drive_link(0.5, -0.06));
}

TEST(RCubeSynthesis, IndicesAreTheWorstOfTheWindow) {
  const RCubeGeometry geometry = test::published_r_cube();
  const double qmax = 0.5;
  double least = HUGE_VAL, worst = 0.0;
  const int n = 11;
  for (int a = 0; a < n * n * n; ++a) {
    const Vector3 theta = (Vector3(a % n, a / n % n, a / n / n) * 2.0 / (n - 1) - Vector3::Ones()) * qmax;
    const RCubeSolution at = r_cube_forward(geometry, theta);
    ASSERT_TRUE(at.closed());
    const Vector3 sigma = RCubeState(geometry, at).jacobian().jacobiSvd().singularValues();
    least = std::min(least, sigma[2]);
    worst = std::max(worst, sigma[0] / sigma[2]);
  }
  EXPECT_NEAR(r_cube_manipulability_index(geometry.drive_link, qmax), least, 1e-15);
  EXPECT_NEAR(r_cube_condition_index(qmax), worst * worst, 1e-12);
}

TEST(RCubeSynthesis, ConstraintsAreThoseOfTheArmAtTheCorners) {
  // Leg 1 of the mechanism itself, taken to the same corners: r_x = r_2, r_y = r_3 - l1 cos q_11.
  const RCubeDesign design{.max_angle = 0.45, .inner_link = 0.088, .outer_link = 0.155};
  const RCubeConstraints constraints = *r_cube_constraints(design);
  const double l1 = 0.06 / std::sin(0.45), h = 0.065;
  const RCubeGeometry geometry{
      .drive_link = l1, .inner_link = design.inner_link, .outer_link = design.outer_link, .base_offset = l1};
  const auto leg = [&](double q11, double r2, double r3) {
    const Vector3 theta(q11, std::asin((r2 - l1) / l1), std::asin((r3 - l1) / l1));
    return r_cube_forward(geometry, theta);
  };
  const auto reach = [&](double q11, double r2, double r3) {
    const double c = std::cos(leg(q11, r2, r3).elbow[0]);
    return c * c - 1.0;
  };
  const auto slope = [&](double q11, double r2, double r3) {
    const RCubeSolution at = leg(q11, r2, r3);
    return std::sin(at.swing[0] + at.elbow[0]);
  };
  EXPECT_NEAR(constraints.far_low, reach(0.0, l1 + h, l1 - h), 1e-12);
  EXPECT_NEAR(constraints.far_high, reach(0.0, l1 + h, l1 + h), 1e-12);
  EXPECT_NEAR(constraints.near, reach(0.0, l1 - h, l1), 1e-12);
  EXPECT_NEAR(constraints.raised_far, reach(0.45, l1 + h, l1 + h), 1e-12);
  EXPECT_NEAR(constraints.raised_near, reach(0.45, l1 - h, l1), 1e-12);
  EXPECT_NEAR(constraints.elbow, slope(0.0, l1 - h, l1 - h), 1e-12);
  EXPECT_NEAR(constraints.raised_elbow, slope(0.45, l1 - h, l1 - h), 1e-12);
  const std::array<double, 7> all = constraints.all();
  EXPECT_EQ(constraints.worst(), *std::max_element(all.begin(), all.end()));
}

TEST(RCubeSynthesis, ConstraintsRefuseWhatIsNoDesign) {
  EXPECT_FALSE(r_cube_constraints({.max_angle = 0.5, .inner_link = 0.0, .outer_link = 0.1}));
  EXPECT_FALSE(r_cube_constraints({.max_angle = 0.5, .inner_link = 0.1, .outer_link = NAN}));
  EXPECT_FALSE(r_cube_constraints({.max_angle = 0.0, .inner_link = 0.1, .outer_link = 0.1}));
  EXPECT_FALSE(r_cube_constraints({.max_angle = 1.6, .inner_link = 0.1, .outer_link = 0.1}));
  // Far out of reach the slope is that of stretched links, not a number beyond 1.
  const RCubeConstraints far = *r_cube_constraints({.max_angle = 0.3, .inner_link = 0.01, .outer_link = 0.01});
  EXPECT_GT(far.far_low, 1.0);
  EXPECT_LE(std::abs(far.elbow), 1.0);
}

TEST(RCubeSynthesis, ChoiceFollowsTheWeight) {
  const std::vector<double> frequency = {1.0, 0.7, 0.0}, manipulability = {0.0, 0.6, 1.0};
  EXPECT_EQ(r_cube_choice(frequency, manipulability, 0.0), 0);
  EXPECT_EQ(r_cube_choice(frequency, manipulability, 1.0), 1);
  EXPECT_EQ(r_cube_choice(frequency, manipulability, 1e3), 2);
  EXPECT_FALSE(r_cube_choice({}, {}, 1.0));
  EXPECT_FALSE(r_cube_choice(frequency, std::vector<double>{1.0}, 1.0));
}

TEST(RCubeSynthesis, NormalisesOverARange) {
  EXPECT_EQ(normalised(3.0, 2.0, 4.0), 0.5);
  EXPECT_FALSE(normalised(3.0, 4.0, 4.0));
}

TEST(RCubeSynthesis, HollowRatioIsTheBestOfAFineGrid) {
  for (const Interval range : {Interval{0.0, 0.9}, Interval{0.0, 0.9034}, Interval{0.3, 0.99}}) {
    for (const HollowSection& section :
         {HollowSection{},
          HollowSection{.outer_diameter = 0.02, .length = 0.1, .density = 2e3, .elastic_modulus = 2e11}}) {
      const double D = section.outer_diameter, l = section.length;
      const auto objectives = [&](double k) {
        const Section tube = *tube_section(D, k * D);
        const double m = section.density * tube.area * l;
        return std::pair(1.0 / (12.0 * section.elastic_modulus * tube.second_moment_z / (l * l * l)),
                         m * (l * l / 3 + (D * D + k * k * D * D) / 16 + l * l / 4));
      };
      const auto [c0, i0] = objectives(range.min);
      const auto [c1, i1] = objectives(range.max);
      double best = 0.0, least = HUGE_VAL;
      const int n = 20000;
      for (int s = 0; s <= n; ++s) {
        const double k = range.min + range.width() * s / n;
        const auto [c, i] = objectives(k);
        const double rms = std::hypot((c - c0) / (c1 - c0), (i - i1) / (i0 - i1));
        if (rms < least) least = rms, best = k;
      }
      EXPECT_NEAR(*hollow_section_ratio(section, range), best, range.width() / n);
    }
  }
  EXPECT_NEAR(*hollow_section_ratio({}, {0.0, 0.9}), 0.7636, 5e-5);
  EXPECT_NEAR(*hollow_section_ratio({}, {0.0, 0.99}), 0.930, 5e-4);
  EXPECT_FALSE(hollow_section_ratio({}, {0.0, 1.0}));
  EXPECT_FALSE(hollow_section_ratio({}, {0.5, 0.4}));
  EXPECT_FALSE(hollow_section_ratio({.density = 0.0}, {0.0, 0.9}));
}

}  // namespace
}  // namespace zwidth
