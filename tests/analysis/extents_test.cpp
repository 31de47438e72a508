#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "support/deltas.h"
#include "support/pneumatics.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Description describe(DeltaDescription delta) {
  Description description;
  description.name = "delta";
  description.mechanism = std::move(delta);
  return description;
}

Description published(double from_degrees, double to_degrees) {
  DeltaDescription delta = test::published_delta();
  delta.joint_range = {from_degrees * kDegree, to_degrees * kDegree};
  return describe(delta);
}

// A flat prism: the plane region that two cranks sweep, times the slide. A coarse cubic lattice misses it by a
// layer; the area is that of a raster of tool points with either branch of the two cranks in range.
TEST(Volume, AFlatPrismIsCountedOnTheFinerLattice) {
  const test::Prototype1 l;
  constexpr double kRange = std::numbers::pi / 3.0;
  Description device = test::prototype(l, {-kRange, kRange});
  std::get<SerialDescription>(device.mechanism).joints[0].range = {0.0, 0.1};
  const Mechanism mechanism(device);
  constexpr double kSpacing = 0.002;
  const WorkspaceVolume coarse = workspace_volume(mechanism);
  ASSERT_EQ(coarse.method, WorkspaceVolume::Method::lattice);
  const LatticeSweep sweep = sweep_workspace(mechanism, {.spacing = kSpacing});
  const WorkspaceVolume volume = finer_count(coarse, sweep);
  EXPECT_EQ(volume.value, sweep.volume);
  EXPECT_EQ(volume.spacing, kSpacing);

  // The tool point is at the end of two links, l2x and the hypotenuse of l3x and l3z, which leans by
  // atan(l3x/l3z).
  const double outer = std::hypot(l.l3x, l.l3z), lean = std::atan2(l.l3x, l.l3z);
  constexpr double kStep = 1e-3;
  int inside = 0;
  for (double x = -0.8; x < 0.8; x += kStep) {
    for (double y = -0.8; y < 0.8; y += kStep) {
      const double cosine = (x * x + y * y - l.l2x * l.l2x - outer * outer) / (2.0 * l.l2x * outer);
      if (std::abs(cosine) > 1.0) continue;
      for (const double sign : {-1.0, 1.0}) {
        const double bend = sign * std::acos(cosine);
        const double first =
            std::atan2(y, x) - std::atan2(outer * std::sin(bend), l.l2x + outer * std::cos(bend));
        const double second = std::remainder(bend + lean, 2.0 * std::numbers::pi);
        if (std::abs(std::remainder(first, 2.0 * std::numbers::pi)) > kRange || std::abs(second) > kRange)
          continue;
        ++inside;
        break;
      }
    }
  }
  const double area = inside * kStep * kStep;
  // One layer of the slide, and a strip of half a spacing along the rim of some 4 m.
  EXPECT_NEAR(volume.value, 0.1 * area, area * kSpacing + 0.1 * 4.0 * 0.5 * kSpacing);
  EXPECT_LT(std::abs(volume.value - 0.1 * area), std::abs(coarse.value - 0.1 * area));
}

TEST(Extents, PublishedRangesToTheLastKnownDigit) {
  // Neal 2015, table 3.1, worked out independently to 1e-8 m.
  const Extents extents = workspace_extents(Mechanism(published(-36.0, 84.0)));
  EXPECT_NEAR(extents.range[0].min, -0.12963541, 6e-9);
  EXPECT_NEAR(extents.range[0].max, 0.12963541, 6e-9);
  EXPECT_NEAR(extents.range[1].min, -0.12663772, 6e-9);
  EXPECT_NEAR(extents.range[1].max, 0.13856282, 6e-9);
  EXPECT_NEAR(extents.range[2].width(), 0.16923424, 6e-9);
  EXPECT_NEAR(extents.range[2].min, 0.066811, 6e-7);
}

TEST(Extents, MirrorImagesAgreeToRounding) {
  const Extents extents = workspace_extents(Mechanism(published(-36.0, 84.0)));
  EXPECT_NEAR(extents.range[0].min, -extents.range[0].max, 1e-12);
}

TEST(Extents, AreMetByTheirPosturesAndExceededByNone) {
  std::mt19937_64 random(21);
  for (int design = 0; design < 40; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const DeltaGeometry geometry = delta_geometry(delta);
    const Mechanism mechanism(describe(delta));
    const Extents extents = workspace_extents(mechanism);
    for (int axis = 0; axis < 3; ++axis) {
      for (int end = 0; end < 2; ++end) {
        const Vector3 p = delta_forward(geometry, extents.joints[axis][end]).position;
        EXPECT_NEAR(p[axis], end == 0 ? extents.range[axis].min : extents.range[axis].max, 1e-14);
        for (int j = 0; j < 3; ++j)
          EXPECT_TRUE(delta.joint_range.contains(extents.joints[axis][end][j], 1e-15));
      }
    }
    for (int n = 0; n < 3000; ++n) {
      const Vector3 theta = test::random_angles(random, delta.joint_range);
      const DeltaForward forward = delta_forward(geometry, theta);
      if (forward.status != SolveStatus::reached) continue;
      const DeltaInverse back = delta_inverse(geometry, forward.position, delta.joint_range);
      if ((back.theta - theta).norm() > 1e-6) continue;  // another branch: not in the workspace
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(extents.range[axis].contains(forward.position[axis], 1e-9)) << "design " << design;
      }
    }
  }
}

TEST(Extents, LegsAgreeWithClosedForm) {
  const Description description = published(-36.0, 84.0);
  const Extents closed = workspace_extents(Mechanism(description));
  const Extents general = workspace_extents(Mechanism(spelled_out(description)));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(closed.range[axis].min, general.range[axis].min, 1e-10);
    EXPECT_NEAR(closed.range[axis].max, general.range[axis].max, 1e-10);
  }
}

TEST(WorkspaceVolume, PublishedVolumes) {
  const WorkspaceVolume printed = workspace_volume(Mechanism(published(-36.0, 84.0)));
  EXPECT_EQ(printed.method, WorkspaceVolume::Method::integral);
  EXPECT_NEAR(printed.value, 4.18188e-3, 5.1e-9);
  EXPECT_LT(printed.error_estimate, 1e-12);
  const WorkspaceVolume shifted = workspace_volume(Mechanism(published(-35.86, 84.14)));
  EXPECT_NEAR(shifted.value, 0.0041903334, 5.1e-11);
}

TEST(WorkspaceVolume, OfOtherLengths) {
  const WorkspaceVolume volume =
      workspace_volume(Mechanism(describe({.base_radius = 0.06,
                                           .upper_arm = 0.07,
                                           .forearm = 0.15,
                                           .platform_radius = 0.03,
                                           .joint_range = {-20.0 * kDegree, 70.0 * kDegree}})));
  EXPECT_EQ(volume.method, WorkspaceVolume::Method::integral);
  EXPECT_NEAR(volume.value, 0.0013184273553850487, 1e-15);
}

TEST(WorkspaceVolume, LegsAgreeWithClosedForm) {
  const Description description = published(-36.0, 84.0);
  const WorkspaceVolume closed = workspace_volume(Mechanism(description));
  const WorkspaceVolume general = workspace_volume(Mechanism(spelled_out(description)));
  EXPECT_EQ(general.method, WorkspaceVolume::Method::integral);
  EXPECT_NEAR(general.value, closed.value, 1e-8 * closed.value);
}

TEST(WorkspaceVolume, IsCountedWhereJointRangesPassASingularity) {
  // A range of a whole turn holds folded legs and postures that do not close.
  const Mechanism mechanism(published(-180.0, 180.0));
  const WorkspaceVolume volume = workspace_volume(mechanism);
  EXPECT_EQ(volume.method, WorkspaceVolume::Method::lattice);
  EXPECT_NEAR(volume.value, sweep_workspace(mechanism, {.spacing = 3e-3}).volume, 0.01 * volume.value);
}

}  // namespace
}  // namespace zwidth
