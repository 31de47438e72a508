#include "zwidth/mechanism/beam_link.h"

#include <gtest/gtest.h>
#include <numbers>

#include "support/deltas.h"
#include "support/r_cubes.h"

#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/mechanism.h"

namespace zwidth {
namespace {

const Material kSteel{.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = 7850.0};

Description beams(double first_diameter = 0.02) {
  Description device = test::r_cube_device();
  device.bodies = {{.on = "drive_link", .beam = TubeDescription{first_diameter, 0.01, kSteel}},
                   {.on = "inner_link", .beam = BarDescription{.width = 0.01, .height = 0.02, .wall = kSteel}},
                   {.on = "outer_link", .beam = TubeDescription{0.015, 0.0, kSteel}}};
  return device;
}

TEST(BeamLink, HasTheMassOfItsSection) {
  const BeamLink tube =
      *beam_link(TubeDescription{0.02, 0.01, kSteel}, {0.1, 0.2, 0.3}, {0.1, 0.2, 0.7}, Vector3::UnitX());
  const double mass = 7850.0 * std::numbers::pi / 4.0 * (4e-4 - 1e-4) * 0.4;
  EXPECT_NEAR(tube.mass, mass, 1e-12);
  EXPECT_LT((tube.centre - Vector3(0.1, 0.2, 0.5)).norm(), 1e-15);
  // m (3 (R^2 + r^2) + L^2)/12 across, m (R^2 + r^2)/2 along.
  EXPECT_NEAR(tube.inertia(0, 0), mass * (3.0 * (1e-4 + 0.25e-4) + 0.16) / 12.0, 1e-12);
  EXPECT_NEAR(tube.inertia(1, 1), tube.inertia(0, 0), 1e-15);
  EXPECT_NEAR(tube.inertia(2, 2), 0.5 * mass * (1e-4 + 0.25e-4), 1e-15);
  EXPECT_NEAR(tube.length, 0.4, 1e-15);
  EXPECT_NEAR(tube.frame.determinant(), 1.0, 1e-15);
}

TEST(BeamLink, ABarsWidthLiesAlongItsJointUnlessSaidOtherwise) {
  const Vector3 from = Vector3::Zero(), to(0.3, 0.0, 0.0), axis = Vector3::UnitZ();
  BarDescription bar{.width = 0.01, .height = 0.03, .wall = kSteel};
  BeamLink link = *beam_link(bar, from, to, axis);
  EXPECT_EQ(link.frame.col(1), axis);
  EXPECT_NEAR(link.rigidity.bending_y, 200e9 * 0.01 * 2.7e-5 / 12.0, 1e-6);
  bar.width_along = Vector3(5.0, 2.0, 0.0);  // what lies along the link does not count
  link = *beam_link(bar, from, to, axis);
  EXPECT_LT((link.frame.col(1) - Vector3::UnitY()).norm(), 1e-15);
  bar.width_along = Vector3(2.0, 0.0, 0.0);
  EXPECT_FALSE(beam_link(bar, from, to, axis));
  EXPECT_FALSE(beam_link(TubeDescription{0.02, 0.01, kSteel}, from, from, axis));
}

TEST(BeamLink, LaminatesByEitherRule) {
  LaminateDescription laminate;
  laminate.lamina.longitudinal_modulus = 300e9;
  laminate.lamina.transverse_modulus = 12e9;
  laminate.lamina.shear_modulus = 5e9;
  laminate.lamina.poisson_ratio = 0.3;
  laminate.lamina.density = 1630.0;
  const double quarter = 0.25 * std::numbers::pi;
  laminate.plies = {{4, 0.0}, {7, 2.0 * quarter}, {7, quarter}, {7, -quarter}};
  const double theory = wall_properties(laminate).moduli.axial;
  laminate.rule = LaminateRule::mean;
  const double mean = wall_properties(laminate).moduli.axial;
  EXPECT_NEAR(
      mean,
      (4.0 * 300e9 + 7.0 * 12e9 + 14.0 * turned_ply({300e9, 12e9, 5e9, 0.3}, 0.7853981633974483).axial) / 25.0,
      1.0);
  EXPECT_GT(theory / mean, 1.2);  // plies that share their strains hold each other
  EXPECT_EQ(wall_properties(laminate, LaminateRule::lamination).moduli.axial, theory);
  EXPECT_EQ(wall_properties(laminate).density, 1630.0);
}

TEST(BeamLink, LaminatesAreComparedByBothRules) {
  LaminateDescription laminate;
  laminate.lamina.longitudinal_modulus = 300e9;
  laminate.lamina.transverse_modulus = 12e9;
  laminate.lamina.shear_modulus = 5e9;
  laminate.lamina.poisson_ratio = 0.3;
  laminate.lamina.density = 1630.0;
  laminate.plies = {{4, 0.0}, {7, 0.5 * std::numbers::pi}};
  laminate.rule = LaminateRule::mean;
  Description device = beams();
  device.bodies[2].beam = TubeDescription{0.015, 0.01, laminate};
  const std::vector<LaminateComparison> found = laminate_comparisons(device);
  ASSERT_EQ(found.size(), 1u);  // the others are of steel
  EXPECT_EQ(found[0].on, "outer_link");
  EXPECT_EQ(found[0].plies, 11);
  EXPECT_EQ(found[0].rule, LaminateRule::mean);
  EXPECT_EQ(found[0].mean.axial, wall_properties(laminate).moduli.axial);
  EXPECT_EQ(found[0].lamination.axial, wall_properties(laminate, LaminateRule::lamination).moduli.axial);
}

TEST(BeamLink, AnRCubesLinksAreBeamsOfAllLegs) {
  const Mechanism mechanism(beams());
  ASSERT_EQ(mechanism.beams().size(), 9u);
  ASSERT_EQ(mechanism.bodies().size(), 9u);
  const Vector3 lengths(0.1117, 0.0741, 0.1218);
  for (int leg = 0; leg < 3; ++leg) {
    for (int k = 0; k < 3; ++k) {
      const BeamModel& beam = mechanism.beams()[static_cast<std::size_t>(3 * leg + k)];
      EXPECT_EQ(beam.joint, 5 * leg + (k == 0 ? 0 : k + 1));
      EXPECT_NEAR(beam.length, lengths[k], 1e-15);
      // At the zero posture all links of a leg lie along its axis c.
      EXPECT_LT((beam.frame.col(0) - Vector3::Unit(r_cube_axis(leg, 2))).norm(), 1e-15);
      // The width of the inner link lies along the axis of its joint, e_a.
      if (k == 1) {
        EXPECT_LT((beam.frame.col(1) - Vector3::Unit(r_cube_axis(leg, 0))).norm(), 1e-15);
      }
    }
  }
  // Spelled out, nothing changes.
  const Mechanism general(spelled_out(beams()));
  ASSERT_EQ(general.beams().size(), 9u);
  for (std::size_t b = 0; b < 9; ++b) {
    EXPECT_EQ(general.beams()[b].rigidity, mechanism.beams()[b].rigidity);
    EXPECT_EQ(general.beams()[b].frame, mechanism.beams()[b].frame);
    EXPECT_EQ(general.bodies()[b].inertia, mechanism.bodies()[b].inertia);
  }
}

TEST(BeamLink, OfADeltaCountAmongItsMasses) {
  Description rigid = test::with_bodies(DeltaDescription{.base_radius = 0.08,
                                                         .upper_arm = 0.08,
                                                         .forearm = 0.16,
                                                         .platform_radius = 0.055,
                                                         .joint_range = {-0.6, 1.4}});
  rigid.bodies.clear();
  Description beam = rigid;
  beam.bodies = {{.on = "upper_arm", .beam = TubeDescription{0.02, 0.01, kSteel}},
                 {.on = "forearm", .beam = TubeDescription{0.006, 0.0, kSteel}}};
  const BeamLink arm = *beam_link(*beam.bodies[0].beam, Vector3::Zero(), {0.08, 0.0, 0.0}, -Vector3::UnitY());
  rigid.bodies = {{.on = "upper_arm", .mass = arm.mass, .centre = arm.centre, .inertia = arm.inertia}};
  const DeltaMasses of_beams = delta_masses(beam), of_bodies = delta_masses(rigid);
  EXPECT_NEAR(of_beams.upper_arm, of_bodies.upper_arm, 1e-15);
  EXPECT_NEAR(of_beams.centre_along, 0.04, 1e-15);
  EXPECT_NEAR(of_beams.upper_arm_inertia[0], of_bodies.upper_arm_inertia[0], 1e-15);
  EXPECT_NEAR(of_beams.forearms[1], 7850.0 * std::numbers::pi / 4.0 * 36e-6 * 0.16, 1e-12);
}

TEST(BeamProblems, NameLinksThatCannotBeBeams) {
  const auto rule = [](const Description& device) {
    const std::vector<Problem> problems = beam_problems(device);
    return problems.size() == 1 ? problems[0].key + " " + problems[0].rule : std::to_string(problems.size());
  };
  EXPECT_EQ(rule(beams()), "0");
  Description device = beams();
  device.bodies[0].on = "leg2/tilt2";
  EXPECT_TRUE(rule(device).starts_with("body[0].on has no length")) << rule(device);
  device = beams();
  device.bodies[1].on = "leg1/theta1";
  EXPECT_TRUE(rule(device).starts_with("body[1].on is a beam already")) << rule(device);
  device = beams();
  // Given in the link's own axes: x along what the leg drives, z along the link.
  device.bodies[1].beam =
      BarDescription{.width = 0.01, .height = 0.02, .width_along = Vector3::UnitZ(), .wall = kSteel};
  EXPECT_TRUE(rule(device).starts_with("body[1].bar.width_along lies along the link")) << rule(device);
}

}  // namespace
}  // namespace zwidth
