#include "zwidth/actuation/arm_cylinder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <stdexcept>

#include "support/storm.h"

namespace zwidth {
namespace {

using std::numbers::pi;
using enum ArmCylinderLayout;

constexpr double kDegree = pi / 180.0;

// Where the source has the pins, independently of its length equations.
struct Pins {
  Eigen::Vector2d base, arm;
};
Pins pins(const ArmCylinderDescription& d) {
  switch (d.layout) {
    case one:
      return {{0.0, -d.l1}, {d.l2, 0.0}};
    case two:
      return {{d.l0, -d.l1}, {d.l2, 0.0}};
    case two_mod:
      return {{d.l0, d.l1}, {d.l2, 0.0}};
    case three:
      return {{-d.l2, d.h}, {d.l0, d.l1}};
  }
  return {};
}

Eigen::Vector2d turned(const Eigen::Vector2d& v, double angle) {
  return Eigen::Rotation2Dd(angle) * v;
}

class Storm {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  ArmCylinderDescription linkage(ArmCylinderLayout layout) {
    return {.layout = layout,
            .l0 = layout == one ? 0.0 : (*this)(-0.1, 0.1),
            .l1 = (*this)(0.05, 0.3),
            .l2 = (*this)(0.02, 0.15),
            .h = layout == three ? (*this)(-0.1, 0.1) : 0.0};
  }
  CylinderTravel travel() {
    const double min = (*this)(0.05, 0.3);
    return {
        .min_length = min, .max_length = min * (*this)(1.05, 1.9), .half_range = (*this)(5.0, 80.0) * kDegree};
  }

 private:
  std::mt19937_64 random_{20170701};
};

constexpr std::array kLayouts = {one, two, two_mod, three};

TEST(ArmCylinder, LengthAndLeverAreThoseOfThePins) {
  Storm any;
  for (int n = 0; n < test::storm_size(2000); ++n) {
    const ArmCylinderDescription linkage = any.linkage(kLayouts[n % 4]);
    const ArmCylinder arm(linkage);
    const double angle = any(-pi, pi);
    const auto [base, arm_pin] = pins(linkage);
    const Eigen::Vector2d tip = turned(arm_pin, angle), along = tip - base;
    EXPECT_NEAR(arm.length(angle), along.norm(), 1e-14);
    // A push acts along the cylinder on the arm pin: its moment about the pivot.
    const double moment = (tip.x() * along.y() - tip.y() * along.x()) / along.norm();
    EXPECT_NEAR(arm.lever(angle), moment, 1e-14 / along.norm());
    constexpr double kStep = 1e-5;
    const double difference = (arm.length(angle + kStep) - arm.length(angle - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(arm.lever(angle), difference, 1e-8 / std::pow(along.norm(), 2));
    EXPECT_DOUBLE_EQ(arm.torque(3.0, angle), 3.0 * arm.lever(angle));
  }
}

// The thesis' own way to the force: lever arm times sin(beta), with its signs per layout.
TEST(ArmCylinder, PrintedAnglesGiveTheSameLever) {
  Storm any;
  for (int n = 0; n < 1000; ++n) {
    const ArmCylinderDescription linkage = any.linkage(kLayouts[n % 4]);
    const ArmCylinder arm(linkage);
    const double angle = any(-0.5, 0.5);
    const double sign = linkage.layout == one || linkage.layout == two ? 1.0 : -1.0;
    const double lever = sign * arm.arm_radius() * std::sin(arm.beta(angle));
    EXPECT_NEAR(arm.lever(angle), lever, 1e-14) << static_cast<int>(linkage.layout);
  }
}

TEST(ArmCylinder, PushGivesItsTorqueAndLoadIsCarried) {
  Storm any;
  for (int n = 0; n < 1000; ++n) {
    const ArmCylinder arm(any.linkage(kLayouts[n % 4]));
    const double angle = any(-1.0, 1.0), torque = any(-2.0, 2.0);
    const auto push = arm.push_for_torque(torque, angle);
    ASSERT_TRUE(push);
    EXPECT_NEAR(arm.torque(*push, angle), torque, 1e-14);
    // Virtual work: what the load loses, the cylinder gives.
    constexpr double kStep = 1e-5, kLoad = 25.0, kDistance = 0.36;
    const double lifted = kDistance * (std::sin(angle + kStep) - std::sin(angle - kStep));
    const double moved = arm.length(angle + kStep) - arm.length(angle - kStep);
    const double force = *arm.required_force(kLoad, kDistance, angle);
    EXPECT_NEAR(force * std::abs(moved), kLoad * lifted, 1e-7 * kLoad * lifted + 1e-9);
  }
}

TEST(ArmCylinder, FigureSevenAndEight) {
  const ArmCylinder arm({.layout = one, .l1 = 0.25, .l2 = 0.13});
  const Interval range{-25.0 * kDegree, 25.0 * kDegree};
  EXPECT_NEAR(arm.length(range.max) - arm.length(range.min), 0.09903, 5e-6);
  EXPECT_NEAR(*arm.required_force(25.0, 0.36, range.min), 63.1, 0.05);
  EXPECT_NEAR(*arm.required_force(25.0, 0.36, 0.0), 78.0, 0.05);
  const auto peak = arm.peak_required_force(25.0, 0.36, range);
  ASSERT_TRUE(peak);
  EXPECT_NEAR(peak->force, 90.5, 0.05);
  EXPECT_NEAR(peak->angle, range.max, 1e-9);
  // In layout one it is F l_F d / (l1 l2).
  EXPECT_NEAR(peak->force, 25.0 * 0.36 * arm.length(range.max) / (0.25 * 0.13), 1e-12);
}

TEST(ArmCylinder, PeakIsTheLargestOfAFineRaster) {
  Storm any;
  for (int n = 0; n < 200; ++n) {
    const ArmCylinder arm(any.linkage(kLayouts[n % 4]));
    const double middle = any(-0.6, 0.6), half = any(0.05, 0.5);
    const Interval range{middle - half, middle + half};
    const auto peak = arm.peak_required_force(10.0, 0.2, range);
    if (!peak) continue;
    double largest = 0.0;
    for (int k = 0; k <= 5000; ++k) {
      largest = std::max(largest, *arm.required_force(10.0, 0.2, range.min + range.width() * k / 5000.0));
    }
    EXPECT_GE(peak->force, largest * (1.0 - 1e-12));
    EXPECT_LE(peak->force, largest * (1.0 + 1e-4));
  }
}

TEST(ArmCylinder, DeadPointsAreTold) {
  // Pivot, base pin and arm pin in one line at 90 deg.
  const ArmCylinder arm({.layout = one, .l1 = 0.25, .l2 = 0.13});
  EXPECT_FALSE(arm.push_for_torque(1.0, pi / 2.0));
  EXPECT_FALSE(arm.required_force(25.0, 0.36, -pi / 2.0));
  EXPECT_FALSE(arm.keeps_direction({0.0, 100.0 * kDegree}));
  EXPECT_FALSE(arm.keeps_direction({-pi / 2.0, 0.0}));
  EXPECT_TRUE(arm.keeps_direction({-89.0 * kDegree, 89.0 * kDegree}));
  EXPECT_FALSE(arm.peak_required_force(25.0, 0.36, {0.0, 100.0 * kDegree}));
  // Two dead points in the range bring the sign back: still no answer.
  EXPECT_FALSE(arm.keeps_direction({-pi, pi}));
  // Both pins in one place.
  const ArmCylinder folded({.layout = one, .l1 = 0.1, .l2 = 0.1});
  EXPECT_EQ(folded.lever(-pi / 2.0), 0.0);
}

TEST(ArmCylinder, AngleOfALengthIsTheOneNearestZero) {
  Storm any;
  for (int n = 0; n < 1000; ++n) {
    const ArmCylinder arm(any.linkage(kLayouts[n % 4]));
    const double length = arm.length(any(-pi, pi));
    const auto angle = arm.angle(length);
    ASSERT_TRUE(angle);
    EXPECT_NEAR(arm.length(*angle), length, 1e-12);
    // The length is a sinusoid's root: its other angle lies as far on the other side of the greatest length.
    const ArmCylinderForm form = arm.form();
    const double longest = form.sign * (pi / 2.0 + form.alpha);
    const double other = std::remainder(2.0 * longest - *angle, 2.0 * pi);
    EXPECT_NEAR(arm.length(other), length, 1e-9);
    EXPECT_LE(std::abs(*angle), std::abs(other) + 1e-9);
  }
  const ArmCylinder arm({.layout = two, .l0 = 0.05, .l1 = 0.27, .l2 = 0.12});
  EXPECT_FALSE(arm.angle(1.0));
  EXPECT_FALSE(arm.angle(0.01));
  EXPECT_THROW(arm.angle(-0.1), std::invalid_argument);
  EXPECT_THROW(arm.angle(std::nan("")), std::invalid_argument);
}

TEST(ArmCylinder, OneFormHoldsForAllLayouts) {
  Storm any;
  for (int n = 0; n < 1000; ++n) {
    const ArmCylinder arm(any.linkage(kLayouts[n % 4]));
    const ArmCylinderForm form = arm.form();
    const double angle = any(-pi, pi);
    const double squared =
        form.a * form.a + form.b * form.b + 2.0 * form.a * form.b * std::sin(form.sign * angle - form.alpha);
    EXPECT_NEAR(arm.length(angle), std::sqrt(squared), 1e-9);
    EXPECT_LE(std::abs(form.alpha), pi / 2.0);
  }
}

TEST(ArmCylinder, RefusesImpossibleLengths) {
  EXPECT_THROW(ArmCylinder({.layout = one, .l1 = 0.0, .l2 = 0.1}), std::invalid_argument);
  EXPECT_THROW(ArmCylinder({.layout = two, .l0 = 0.1, .l1 = 0.1, .l2 = -0.1}), std::invalid_argument);
  EXPECT_THROW(ArmCylinder({.layout = two_mod, .l0 = std::nan(""), .l1 = 0.1, .l2 = 0.1}),
               std::invalid_argument);
  EXPECT_THROW(ArmCylinder({.layout = three, .l0 = 0.0, .l1 = 0.0, .l2 = 0.1, .h = 0.1}),
               std::invalid_argument);
  EXPECT_NO_THROW(ArmCylinder({.layout = three, .l0 = 0.0, .l1 = 0.0125, .l2 = 0.08, .h = 0.0}));
  try {
    ArmCylinder({.layout = two, .l0 = 0.1, .l1 = 0.1, .l2 = -0.25});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("l2"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("-0.25"), std::string::npos);
  }
}

// ------------------------------------------------------------------------------------------------ synthesis

void expect_travel(const ArmCylinderDescription& design, const CylinderTravel& travel,
                   double tolerance = 1e-12) {
  const ArmCylinder arm(design);
  const double start = arm.length(-travel.half_range), end = arm.length(travel.half_range);
  EXPECT_NEAR(std::min(start, end), travel.min_length, tolerance);
  EXPECT_NEAR(std::max(start, end), travel.max_length, tolerance);
  const bool lengthens = design.layout == one || design.layout == two;
  EXPECT_EQ(end > start, lengthens);
  EXPECT_EQ(design.retracted_length, travel.min_length);
}

TEST(ArmCylinderDesign, EveryDesignHasItsTravel) {
  Storm any;
  int ones = 0, threes = 0;
  for (int n = 0; n < test::storm_size(1000); ++n) {
    const CylinderTravel travel = any.travel();
    for (const DesignRoot root : {DesignRoot::minus, DesignRoot::plus}) {
      if (const auto design = design_one(travel, root)) {
        ++ones;
        expect_travel(*design, travel);
        EXPECT_EQ(design->l1 >= design->l2, root == DesignRoot::plus);
      }
      const Interval levers = feasible_levers(travel);
      for (const ArmCylinderLayout layout : {two, two_mod}) {
        const auto design = design_two(travel, any(levers.min, levers.max), root, layout);
        ASSERT_TRUE(design);
        expect_travel(*design, travel);
      }
      const auto design = design_three(travel, any(-0.1, 0.1), any(0.02, 0.4), root);
      // A pair of pins may come out on the other side, where the cylinder shortens the other way round.
      if (design && (design->l0 != 0.0 || design->l1 != 0.0)) {
        ++threes;
        expect_travel(*design, travel, 1e-11);
      }
    }
    for (const ArmCylinderLayout layout : {two, two_mod})
      expect_travel(design_two_optimal(travel, layout), travel);
    expect_travel(design_three_optimal(travel), travel);
  }
  EXPECT_GT(ones, 500);
  EXPECT_GT(threes, 500);
}

TEST(ArmCylinderDesign, RootsAreTheOnlyLinkages) {
  const CylinderTravel travel{.min_length = 0.2281, .max_length = 0.3281, .half_range = 25.0 * kDegree};
  // The thesis' figure 7 is layout one, rounded.
  const auto figure = design_one(travel);
  ASSERT_TRUE(figure);
  EXPECT_NEAR(figure->l1, 0.250, 5e-4);
  EXPECT_NEAR(figure->l2, 0.130, 2e-3);
  // Both roots of layout two are apart, and meet in the optimal design.
  const double least = feasible_levers(travel).min;
  EXPECT_NEAR(least, travel.stroke() / (2.0 * std::sin(travel.half_range)), 1e-15);
  const auto minus = design_two(travel, 1.02 * least, DesignRoot::minus),
             plus = design_two(travel, 1.02 * least, DesignRoot::plus);
  EXPECT_LT(minus->l0, plus->l0);
  const ArmCylinderDescription best = design_two_optimal(travel);
  EXPECT_NEAR(design_two(travel, least, DesignRoot::plus)->l0, best.l0, 1e-6);
  EXPECT_NEAR(0.5 * (design_two(travel, 1.0001 * least, DesignRoot::minus)->l0 +
                     design_two(travel, 1.0001 * least, DesignRoot::plus)->l0),
              best.l0, 1e-4 * best.l0);
}

TEST(ArmCylinderDesign, InfeasibleIsAnAnswer) {
  const CylinderTravel travel{.min_length = 0.075, .max_length = 0.0875, .half_range = 30.0 * kDegree};
  const Interval levers = feasible_levers(travel);
  EXPECT_FALSE(design_two(travel, 0.999 * levers.min, DesignRoot::plus));
  EXPECT_FALSE(design_two(travel, 1.001 * levers.max, DesignRoot::minus));
  EXPECT_FALSE(design_three(travel, 0.0, 1.0, DesignRoot::plus));
  // A long stroke over a small range asks for S >= 2 D.
  const CylinderTravel steep{.min_length = 0.1, .max_length = 0.25, .half_range = 10.0 * kDegree};
  EXPECT_FALSE(design_one(steep));
}

TEST(ArmCylinderDesign, RefusesAnImpossibleTravel) {
  EXPECT_THROW(design_one({.min_length = 0.2, .max_length = 0.1, .half_range = 0.4}), std::invalid_argument);
  EXPECT_THROW(design_one({.min_length = 0.0, .max_length = 0.1, .half_range = 0.4}), std::invalid_argument);
  EXPECT_THROW(design_one({.min_length = 0.1, .max_length = 0.2, .half_range = pi / 2.0}),
               std::invalid_argument);
  EXPECT_THROW(design_one({.min_length = 0.1, .max_length = std::nan(""), .half_range = 0.4}),
               std::invalid_argument);
  EXPECT_THROW(feasible_levers({.min_length = 0.1, .max_length = 0.2, .half_range = 0.0}),
               std::invalid_argument);
  const CylinderTravel travel{.min_length = 0.1, .max_length = 0.12, .half_range = 0.4};
  EXPECT_THROW(design_two(travel, -1.0, DesignRoot::plus), std::invalid_argument);
  EXPECT_THROW(design_two(travel, 0.05, DesignRoot::plus, three), std::invalid_argument);
  EXPECT_THROW(design_three(travel, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(minimum_peak_force(0.0, 0.4, 25.0, 0.3), std::invalid_argument);
  EXPECT_THROW(minimum_peak_force(0.1, 2.0, 25.0, 0.3), std::invalid_argument);
}

// For a cylinder and a range there is one free parameter, whatever the layout: equal alpha, equal force.
TEST(ArmCylinderDesign, EqualAlphaMeansEqualForce) {
  Storm any;
  for (int n = 0; n < 200; ++n) {
    const CylinderTravel travel = any.travel();
    const ArmCylinder flat(design_two_optimal(travel)), mirrored(design_two_optimal(travel, two_mod)),
        packed(design_three_optimal(travel));
    EXPECT_NEAR(flat.form().alpha, packed.form().alpha, 1e-12);
    for (double share = -1.0; share <= 1.0; share += 0.125) {
      const double angle = share * travel.half_range;
      // `two` lengthens where the other two shorten: mirror the angle.
      EXPECT_NEAR(flat.lever(angle), -mirrored.lever(-angle), 1e-14);
      EXPECT_NEAR(packed.lever(angle), mirrored.lever(angle), 1e-13);
    }
  }
}

TEST(ArmCylinderDesign, NoLinkageNeedsLessThanTheWorkBound) {
  Storm any;
  for (int n = 0; n < 100; ++n) {
    const CylinderTravel travel = any.travel();
    const Interval range{-travel.half_range, travel.half_range};
    const double bound = minimum_peak_force(travel.stroke(), travel.half_range, 25.0, 0.36);
    const auto best = design_least_peak(travel);
    ASSERT_TRUE(best);
    expect_travel(*best, travel, 1e-11);
    const double least = ArmCylinder(*best).peak_required_force(25.0, 0.36, range)->force;
    EXPECT_GE(least, bound * (1.0 - 1e-12));
    const Interval levers = feasible_levers(travel);
    for (int k = 0; k < 20; ++k) {
      const auto other =
          design_two(travel, any(levers.min, levers.max), k % 2 == 0 ? DesignRoot::plus : DesignRoot::minus);
      const auto peak = ArmCylinder(*other).peak_required_force(25.0, 0.36, range);
      if (peak) {
        EXPECT_GE(peak->force, least * (1.0 - 1e-6));
      }
    }
    const auto ends = ArmCylinder(design_two_optimal(travel));
    const double at_end = 25.0 * 0.36 / levers.min;
    EXPECT_NEAR(*ends.required_force(25.0, 0.36, range.min), at_end, 1e-9 * at_end);
    EXPECT_NEAR(*ends.required_force(25.0, 0.36, range.max), at_end, 1e-9 * at_end);
  }
}

// Section 3.1's comparison for the cylinder of figure 7.
TEST(ArmCylinderDesign, LayoutsComparedForFigureSeven) {
  const ArmCylinder printed({.layout = one, .l1 = 0.25, .l2 = 0.13});
  const double half = 25.0 * kDegree;
  const CylinderTravel travel{printed.length(-half), printed.length(half), half};
  const auto peak = [&](const ArmCylinderDescription& d) {
    return ArmCylinder(d).peak_required_force(25.0, 0.36, {-half, half})->force;
  };
  EXPECT_NEAR(peak(printed.description()), 90.5, 0.05);
  EXPECT_NEAR(feasible_levers(travel).min, 0.1172, 5e-5);
  EXPECT_NEAR(peak(design_two_optimal(travel)), 77.3, 0.05);
  EXPECT_NEAR(peak(*design_least_peak(travel)), 77.2, 0.05);
  EXPECT_NEAR(minimum_peak_force(travel.stroke(), half, 25.0, 0.36), 76.8, 0.05);
}

}  // namespace
}  // namespace zwidth
