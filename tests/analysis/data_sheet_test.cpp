#include "zwidth/analysis/data_sheet.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "support/deltas.h"

#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

// A motor, encoder and amplifier of the published device's size (Neal 2015, tables 4.2, 4.3), driving a joint
// directly.
DriveDescription direct_drive() {
  DriveDescription drive;
  drive.motor.supply_voltage = 48.0;
  drive.motor.no_load_speed = 1864.0;
  drive.motor.no_load_current = 0.29;
  drive.motor.nominal_speed = 1759.0;
  drive.motor.nominal_torque = 0.0694;
  drive.motor.nominal_current = 2.96;
  drive.motor.stall_torque = 1.47;
  drive.motor.resistance = 0.836;
  drive.motor.inductance = 0.118e-3;
  drive.motor.torque_constant = 0.0255;
  drive.motor.speed_constant = 39.2;
  drive.motor.rotor_inertia = 1.83e-6;
  drive.encoder.pulses_per_turn = 1000.0;
  drive.encoder.max_frequency = 200e3;
  drive.amplifier.max_supply_voltage = 50.0;
  drive.amplifier.min_supply_voltage = 11.0;
  drive.amplifier.output_voltage_factor = 0.9;
  drive.amplifier.max_current = 10.0;
  drive.amplifier.max_current_time = 1.0;
  drive.amplifier.continuous_current = 5.0;
  drive.amplifier.current_resolution = 1e-3;
  drive.amplifier.current_loop_rate = 1e4;
  drive.amplifier.proportional_gain_scale = 256.0;
  drive.amplifier.integral_gain_scale = 256e-4;
  drive.supply_voltage = 48.0;
  drive.proportional_gain = 300.0;
  drive.integral_gain = 130.0;
  drive.peak_factor = 1.3;
  return drive;
}

DataSheetOptions coarse() {
  DataSheetOptions options;
  options.spacing = 5e-3;
  options.most_mechanical_points = 2e3;
  options.slice_points = 31;
  options.surface_divisions = 6;
  return options;
}

TEST(DataSheet, TellsEverythingAboutADrivenDelta) {
  Description description = test::with_bodies(test::published_delta());
  description.drives = {direct_drive()};
  const DataSheet sheet = data_sheet(description, coarse());
  EXPECT_TRUE(sheet.complete);
  EXPECT_EQ(sheet.mechanism_type, "delta");
  EXPECT_EQ(sheet.joint_names.size(), 3u);
  EXPECT_NEAR(sheet.moving_mass, 3 * 0.05 + 3 * 0.03 + 0.06, 1e-12);

  ASSERT_TRUE(sheet.workspace);
  const LatticeSweep& sweep = sheet.workspace->sweep;
  EXPECT_NEAR(sweep.volume, sheet.workspace->volume.value, 0.02 * sweep.volume);
  EXPECT_LT(sheet.workspace->inscribed.sphere.volume, sweep.volume);
  EXPECT_FALSE(sheet.workspace->surface.triangles.empty());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(sheet.workspace->slices[axis].slice.axis, axis);
    EXPECT_FALSE(sheet.workspace->slices[axis].slice.outlines.empty());
  }

  ASSERT_TRUE(sheet.continuous);
  ASSERT_TRUE(sheet.peak);
  EXPECT_NEAR(sheet.continuous->torque[0], 0.0694, 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sheet.peak->axes[axis].mean / sheet.continuous->axes[axis].mean, 1.3, 1e-9);
    EXPECT_GE(sheet.continuous->axes[axis].min, sheet.continuous->weakest.min);
    EXPECT_GT(sheet.resolution[axis].min, 0.0);
  }
  EXPECT_EQ(sheet.continuous->limited_by, "motor");
  EXPECT_NEAR(sheet.joint_resolution[0], 2.0 * M_PI / 4000.0, 1e-15);
  EXPECT_NEAR(sheet.torque_resolution[0], 25.5e-6, 1e-15);

  ASSERT_TRUE(sheet.mechanics);
  EXPECT_GT(sheet.mechanics->sweep[MechanicalFigure::lightest].min, 0.06);
  EXPECT_GT(sheet.mechanics->sweep[MechanicalFigure::gravity_torque].min, 0.0);
  ASSERT_TRUE(sheet.middle);
  ASSERT_TRUE(sheet.middle->continuous_forces);
  EXPECT_EQ(sheet.middle->continuous_forces->vertices.size(), 8u);
  ASSERT_TRUE(sheet.middle->apparent_mass);
  ASSERT_TRUE(sheet.middle->force_resolution);
  ASSERT_EQ(sheet.drives.size(), 1u);
  EXPECT_EQ(sheet.drives[0].joints.size(), 3u);
  EXPECT_FALSE(sheet.drives[0].response);
  EXPECT_EQ(sheet.drives[0].current_step.size(), 31u);
}

TEST(DataSheet, UnequalPeakFactorsAreSweptForThemselves) {
  Description description = test::with_bodies(test::published_delta());
  const Mechanism mechanism(description);
  for (int j = 0; j < 3; ++j) {
    DriveDescription drive = direct_drive();
    drive.joints = {mechanism.active_names()[static_cast<std::size_t>(j)]};
    drive.peak_factor = 1.0 + 0.2 * j;
    description.drives.push_back(drive);
  }
  const DataSheet sheet = data_sheet(description, coarse());
  ASSERT_TRUE(sheet.peak);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(sheet.peak->axes[axis].mean, sheet.continuous->axes[axis].mean);
    EXPECT_LE(sheet.peak->axes[axis].mean, 1.4 * sheet.continuous->axes[axis].mean);
  }
}

TEST(DataSheet, WithoutDrivesOrBodiesLeavesOutWhatTheyDecideAndSaysSo) {
  Description description;
  description.name = "bare";
  description.mechanism = test::published_delta();
  const DataSheet sheet = data_sheet(description, coarse());
  EXPECT_TRUE(sheet.workspace);
  EXPECT_FALSE(sheet.continuous);
  EXPECT_FALSE(sheet.mechanics);
  EXPECT_FALSE(sheet.warnings.empty());
}

TEST(DataSheet, OfLegsAgreesWithClosedForm) {
  Description description = test::with_bodies(test::published_delta());
  description.drives = {direct_drive()};
  DataSheetOptions options = coarse();
  options.spacing = 24e-3;
  const DataSheet a = data_sheet(description, options), b = data_sheet(spelled_out(description), options);
  ASSERT_TRUE(b.workspace);
  EXPECT_EQ(b.mechanism_type, "legs");
  EXPECT_EQ(a.workspace->sweep.inside, b.workspace->sweep.inside);
  EXPECT_NEAR(a.continuous->weakest.mean / b.continuous->weakest.mean, 1.0, 1e-9);
  const MechanicalFigure heaviest = MechanicalFigure::heaviest;
  EXPECT_NEAR(*a.mechanics->sweep[heaviest].median / *b.mechanics->sweep[heaviest].median, 1.0, 1e-9);
  EXPECT_NEAR(a.middle->condition_number / b.middle->condition_number, 1.0, 1e-9);
}

TEST(DataSheet, OfAMechanismWithoutAWorkspaceStillTellsTheRest) {
  // One slider: a leg of one prismatic joint.
  Description description;
  description.name = "slider";
  LegsDescription legs;
  legs.platform = PlatformFreedom::rigid;
  LegDescription leg;
  leg.name = "leg";
  JointDescription joint;
  joint.name = "slide";
  joint.type = JointType::prismatic;
  joint.active = true;
  joint.range = {-0.1, 0.1};
  leg.joints = {joint};
  legs.legs = {leg};
  description.mechanism = legs;
  const DataSheet sheet = data_sheet(description, coarse());
  EXPECT_FALSE(sheet.workspace);
  ASSERT_TRUE(sheet.arm);
  EXPECT_NEAR(sheet.arm->ends[2][0].distance, -0.1, 1e-12);
  EXPECT_NEAR(sheet.arm->ends[2][1].distance, 0.1, 1e-12);
}

TEST(DataSheet, LatticeOfALargeDeviceIsCoarserByRoundSteps) {
  Description large = test::with_bodies(test::published_delta());
  auto& delta = std::get<DeltaDescription>(large.mechanism);
  for (double* length : {&delta.base_radius, &delta.upper_arm, &delta.forearm, &delta.platform_radius})
    *length *= 20.0;
  DataSheetOptions options;
  options.slice_points = options.surface_divisions = options.frequency_points = 0;
  options.most_mechanical_points = 2e4;
  const DataSheet sheet = data_sheet(large, options);
  ASSERT_TRUE(sheet.workspace.has_value());
  EXPECT_DOUBLE_EQ(sheet.workspace->sweep.spacing, 0.02);  // in a box of 5.2 x 5.3 x 3.4 m
  EXPECT_DOUBLE_EQ(sheet.mechanics->sweep.spacing, 0.2);
  EXPECT_GT(sheet.workspace->sweep.inside, 1000);
}

}  // namespace
}  // namespace zwidth
