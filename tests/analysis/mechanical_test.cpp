#include "zwidth/analysis/mechanical.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <sstream>
#include <vector>

#include "support/r_cubes.h"

#include "zwidth/analysis/acceleration.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/inertia.h"
#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/batch_r_cube.h"

namespace zwidth {
namespace {

struct Device {
  explicit Device(const char* name)
      : description(read_description(name, {}, Catalogue::load())),
        mechanism(mechanism_with_drives(description)),
        drives(joint_drives(description, mechanism)) {}
  Description description;
  Mechanism mechanism;
  Drives drives;
};

Posture middle(const Mechanism& mechanism) {
  ActiveVector joints(mechanism.active_count());
  for (int i = 0; i < joints.size(); ++i) joints[i] = mechanism.active_range(i).middle();
  return *solve_forward(mechanism, joints).posture;
}

// How far the tool gives along a direction, from the compliance: the other route to each figure.
TEST(Mechanical, StiffnessIsThatOfTheComplianceUnderPureForces) {
  const Device cube("r-cube");
  const Posture posture = middle(cube.mechanism);
  const auto known = known_stiffness(posture, cube.drives);
  ASSERT_TRUE(known);
  const Matrix6 K = known->stiffness.matrix, C = K.inverse();
  const MechanicalValues values = mechanical_figures(posture, cube.drives);
  std::mt19937_64 random(91);
  const double softest = figure(values, MechanicalFigure::softest),
               stiffest = figure(values, MechanicalFigure::stiffest);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(values[static_cast<std::size_t>(axis)] * C(axis, axis), 1.0, 1e-9);
  double least = 1e300, most = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3 u = test::random_angles(random, {-1, 1}).normalized();
    const double along = 1.0 / (C.topLeftCorner<3, 3>() * u).norm();  // force over displacement, any direction
    least = std::min(least, along);
    most = std::max(most, along);
  }
  EXPECT_GE(least, softest * (1.0 - 1e-9));
  EXPECT_LE(most, stiffest * (1.0 + 1e-9));
  EXPECT_LT(least, 1.02 * softest);
  EXPECT_GT(most, 0.98 * stiffest);
}

TEST(Mechanical, ASweepCountsTheWorkspaceAndBracketsEveryPosture) {
  for (const char* name : {"delta", "five-bar"}) {
    const Device device(name);
    const double spacing = 0.02;
    const MechanicalSweep sweep = sweep_mechanics(device.mechanism, device.drives, spacing);
    EXPECT_EQ(sweep.inside, sweep_workspace(device.mechanism, {.spacing = spacing}).inside);
    const WorkspaceMap map = map_workspace(device.mechanism, {.spacing = spacing});
    std::vector<double> heaviest, gravity;
    for (const Vector3& place : map.positions) {
      const Posture posture = *solve_inverse(device.mechanism, {.position = place}).posture;
      const Rates rate = rates(posture);
      const Jacobian J = rate.tool.topRows(device.mechanism.linear_rows());
      const ApparentMass mass = apparent_mass(cartesian_mass(J, mass_matrix(posture, rate)));
      heaviest.push_back(mass.heaviest);
      gravity.push_back(gravity_torques(posture, rate).cwiseAbs().maxCoeff());
      EXPECT_GE(mass.lightest, sweep[MechanicalFigure::lightest].min * (1.0 - 1e-9));
      EXPECT_GE(mass.along_axes[0], sweep[MechanicalFigure::mass_x].min * (1.0 - 1e-9));
    }
    std::ranges::sort(heaviest);
    const Statistic& found = sweep[MechanicalFigure::heaviest];
    EXPECT_NEAR(*found.median / heaviest[heaviest.size() / 2], 1.0, 0.05) << name;
    const double most = static_cast<double>(std::ranges::count_if(
        heaviest, [&](double mass) { return mass <= *found.percentile_95 * (1.0 + 1e-9); }));
    EXPECT_NEAR(most / static_cast<double>(heaviest.size()), 0.95, 1.0 / static_cast<double>(heaviest.size()));
    EXPECT_GE(found.max, heaviest.back() * (1.0 - 1e-9));
    EXPECT_GE(sweep[MechanicalFigure::gravity_torque].max, *std::ranges::max_element(gravity) * (1.0 - 1e-9));
  }
}

// Extremes belong to the workspace, not to a lattice.
TEST(Mechanical, ExtremesDoNotDependOnTheLattice) {
  // The five-bar is heaviest in a corner of its joint ranges, nearly stretched out; the first pneumatic arm has
  // none between it and its stretched elbow.
  const Device five_bar("five-bar"), arm("pneumatic-1");
  std::vector<double> heaviest;
  for (const double spacing : {0.007, 0.011, 0.02}) {
    const MechanicalSweep sweep = sweep_mechanics(five_bar.mechanism, five_bar.drives, spacing);
    EXPECT_FALSE(sweep[MechanicalFigure::heaviest].unbounded) << spacing;
    heaviest.push_back(sweep[MechanicalFigure::heaviest].max);
  }
  EXPECT_NEAR(heaviest[1] / heaviest[0], 1.0, 1e-3);
  EXPECT_NEAR(heaviest[2] / heaviest[0], 1.0, 1e-3);
  for (const double spacing : {0.03, 0.05}) {
    const MechanicalSweep sweep = sweep_mechanics(arm.mechanism, arm.drives, spacing);
    EXPECT_TRUE(sweep[MechanicalFigure::heaviest].unbounded) << spacing;
    EXPECT_FALSE(sweep[MechanicalFigure::lightest].unbounded) << spacing;
  }
  const Device delta("delta");
  const MechanicalSweep fine = sweep_mechanics(delta.mechanism, delta.drives, 0.015),
                        coarse = sweep_mechanics(delta.mechanism, delta.drives, 0.023);
  for (const MechanicalFigure which :
       {MechanicalFigure::heaviest, MechanicalFigure::lightest, MechanicalFigure::mass_z}) {
    EXPECT_EQ(fine[which].unbounded, coarse[which].unbounded);
    EXPECT_NEAR(fine[which].min / coarse[which].min, 1.0, 1e-4);
    if (fine[which].unbounded) continue;
    EXPECT_NEAR(fine[which].max / coarse[which].max, 1.0, 1e-4);
  }
}

TEST(Mechanical, AMapOfTheRCubeIsThatOfItsBatch) {
  // Links alone, written out in the batch kernel.
  Device cube("r-cube");
  const Drives none(3);
  const RCubeLinks links = [&] {
    RCubeLinks result{.geometry = r_cube_geometry(std::get<RCubeDescription>(cube.description.mechanism)),
                      .rigidity = {}};
    for (std::size_t k = 0; k < 3; ++k) result.rigidity[k] = cube.mechanism.beams()[k].rigidity;
    return result;
  }();
  const RCubeStiffnessBatch batch(links);
  std::vector<Vector3> points;
  std::vector<double> x, y, z;
  const Vector3 centre = middle(cube.mechanism).tool().position;
  std::mt19937_64 random(92);
  for (int p = 0; p < 2000; ++p) {
    points.push_back(centre + test::random_angles(random, {-0.08, 0.08}));
    x.push_back(points.back().x());
    y.push_back(points.back().y());
    z.push_back(points.back().z());
  }
  std::vector<double> figures(kRCubeElasticFigures * points.size());
  batch.figures(x, y, z, figures);
  const std::vector<MechanicalValues> map = map_mechanics(cube.mechanism, none, points, {.threads = 2});
  ASSERT_EQ(map.size(), points.size());
  int inside = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double softest = figure(map[p], MechanicalFigure::softest);
    if (std::isnan(softest)) continue;
    ++inside;
    const double expected = figures[static_cast<std::size_t>(RCubeElasticFigure::softest) * points.size() + p];
    EXPECT_NEAR(softest / expected, 1.0, 1e-7);
    EXPECT_NEAR(figure(map[p], MechanicalFigure::stiffness_y) *
                    figures[static_cast<std::size_t>(RCubeElasticFigure::give_yy) * points.size() + p],
                1.0, 1e-7);
  }
  EXPECT_GT(inside, 100);
  // Whatever the threads.
  const std::vector<MechanicalValues> alone = map_mechanics(cube.mechanism, none, points, {.threads = 1});
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) {
      EXPECT_TRUE(map[p][f] == alone[p][f] || (std::isnan(map[p][f]) && std::isnan(alone[p][f])));
    }
  }
}

TEST(Mechanical, WhatTheSourceDoesNotGiveHasNoValue) {
  Description bare = test::r_cube_device();
  const Mechanism mechanism(bare);
  const MechanicalValues values = mechanical_figures(middle(mechanism), Drives(3));
  for (const double value : values) EXPECT_TRUE(std::isnan(value));
  // The five published devices: what their files give.
  for (const char* name : {"delta", "five-bar", "r-cube", "seven-dof"}) {
    const Device device(name);
    const MechanicalPostures sweep = sweep_mechanics_of_postures(device.mechanism, device.drives, 50);
    EXPECT_GT(sweep.solved, 0) << name;
    EXPECT_GT(sweep[MechanicalFigure::lightest].count, 0) << name;
  }
}

TEST(Mechanical, FrequenciesFallWithTheSquareRootOfTheMass) {
  const auto cube = [](double times) {
    Description description = test::r_cube_device();
    const Material carbon{.elastic_modulus = 70e9, .poisson_ratio = 0.3, .density = 1630.0 * times};
    for (const char* link : {"drive_link", "inner_link", "outer_link"})
      description.bodies.push_back({.on = link, .beam = TubeDescription{0.02, 0.015, carbon}});
    description.bodies.push_back({.on = "platform", .mass = 0.1 * times});
    return description;
  };
  Mechanism one(cube(1.0)), four(cube(4.0));
  EXPECT_NEAR(moving_mass(four) / moving_mass(one), 4.0, 1e-12);
  // Rotors count for what the hand feels and for motors that are free, not for motors that are held.
  one.set_drive_inertia(Vector3::Constant(1e-4));
  four.set_drive_inertia(Vector3::Constant(4e-4));
  const MechanicalValues light = mechanical_figures(middle(one), Drives(3)),
                         heavy = mechanical_figures(middle(four), Drives(3));
  for (const MechanicalFigure which : {MechanicalFigure::frequency_held, MechanicalFigure::frequency_free})
    EXPECT_NEAR(figure(light, which) / figure(heavy, which), 2.0, 1e-9);
  for (const MechanicalFigure which : {MechanicalFigure::lightest, MechanicalFigure::mass_z})
    EXPECT_NEAR(figure(heavy, which) / figure(light, which), 4.0, 1e-9);
  EXPECT_EQ(figure(light, MechanicalFigure::softest), figure(heavy, MechanicalFigure::softest));
  EXPECT_GT(figure(light, MechanicalFigure::frequency_free), figure(light, MechanicalFigure::frequency_held));
}

TEST(Mechanical, AccelerationIsTheInnerRadiusOfThePolytope) {
  std::mt19937_64 random(93);
  for (const char* name : {"delta", "five-bar", "r-cube", "seven-dof"}) {
    const Device device(name);
    ActiveVector limit(device.mechanism.active_count());
    for (int i = 0; i < limit.size(); ++i)
      limit[i] = device.drives[static_cast<std::size_t>(i)]->continuous_torque().usable;
    int compared = 0;
    for (std::int64_t sample = 0; sample < 30; ++sample) {
      const Solution solution = solve_forward(device.mechanism, spread_posture(device.mechanism, sample));
      if (!solution || solution.conditioning < 1e-2) continue;
      const Rates all = rates(*solution.posture);
      const ToolMotion motion = tool_motion(*solution.posture, all, ActiveVector::Zero(limit.size()))
                                    .rows(0, device.mechanism.linear_rows());
      const double expected = acceleration_polytope(motion, TorqueRange::symmetric(limit)).inner_radius;
      const double got =
          figure(mechanical_figures(*solution.posture, device.drives), MechanicalFigure::acceleration);
      EXPECT_NEAR(got, expected, 1e-8 * (1.0 + expected)) << name;
      ++compared;
    }
    EXPECT_GT(compared, 5) << name;
  }
}

TEST(Mechanical, ACutHasTheFiguresOfItsPoints) {
  for (const char* name : {"r-cube", "five-bar"}) {
    const Device device(name);
    const Extents extents = workspace_extents(device.mechanism);
    const SliceMap map = map_slice(device.mechanism, extents, 2, extents.range[2].middle(), 21, {});
    const MechanicalCut all = cut_mechanics(device.mechanism, device.drives, map, 1),
                        every_second = cut_mechanics(device.mechanism, device.drives, map, 2);
    EXPECT_EQ(all.nu, map.nu);
    EXPECT_EQ(every_second.nu, (map.nu + 1) / 2);
    EXPECT_DOUBLE_EQ(all.u_range.max, map.u_range.max);
    const auto& heaviest = all[MechanicalFigure::heaviest];
    const auto& coarse = every_second[MechanicalFigure::heaviest];
    int inside = 0;
    for (int v = 0; v < every_second.nv; ++v) {
      for (int u = 0; u < every_second.nu; ++u) {
        const double value = coarse[static_cast<std::size_t>(v * every_second.nu + u)],
                     same = heaviest[static_cast<std::size_t>(2 * v * all.nu + 2 * u)];
        if (std::isnan(value)) {
          EXPECT_TRUE(std::isnan(same));
          continue;
        }
        ++inside;
        EXPECT_NEAR(value / same, 1.0, 1e-9);
        Vector3 point;
        point[map.slice.axis] = map.slice.at;
        point[map.slice.u] =
            every_second.u_range.min + every_second.u_range.width() * u / (every_second.nu - 1);
        point[map.slice.v] =
            every_second.v_range.min + every_second.v_range.width() * v / (every_second.nv - 1);
        const auto one = map_mechanics(device.mechanism, device.drives, std::span(&point, 1));
        EXPECT_NEAR(value / figure(one[0], MechanicalFigure::heaviest), 1.0, 1e-7);
      }
    }
    EXPECT_GT(inside, 20) << name;
  }
}

TEST(Mechanical, AMapHasAColumnForWhatIsKnown) {
  const Device device("five-bar");
  WorkspaceMap map = map_workspace(device.mechanism, {.spacing = 0.02});
  const std::size_t before = map.columns().size();
  add_mechanics(device.mechanism, device.drives, map);
  // Masses along two axes and in two directions, and acceleration; no stiffness.
  EXPECT_EQ(map.columns().size(), before + 6);
  EXPECT_EQ(map.columns()[before], "mass_x");
  EXPECT_EQ(map.more.size(), 6 * map.positions.size());
  std::ostringstream csv;
  write_csv(map, csv);
  const std::string text = csv.str();
  const std::string first =
      text.substr(text.find('\n') + 1, text.find('\n', text.find('\n') + 1) - text.find('\n') - 1);
  EXPECT_EQ(static_cast<std::size_t>(std::count(first.begin(), first.end(), ',')) + 1, before + 6);
}

}  // namespace
}  // namespace zwidth
