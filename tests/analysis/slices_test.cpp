#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

#include "support/deltas.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

Description published() {
  Description description;
  description.name = "delta";
  description.mechanism = test::published_delta();
  return description;
}

TEST(Slice, OutlinesLieOnTheBoundary) {
  const Mechanism mechanism(published());
  const Extents extents = workspace_extents(mechanism);
  const Interval range = mechanism.active_range(0);
  for (int axis = 0; axis < 3; ++axis) {
    const SliceMap map = map_slice(mechanism, extents, axis, extents.range[axis].middle(), 61, {});
    ASSERT_FALSE(map.slice.outlines.empty());
    for (const Outline& outline : map.slice.outlines) {
      for (const auto& uv : outline) {
        Vector3 p;
        p[axis] = map.slice.at;
        p[map.slice.u] = uv[0];
        p[map.slice.v] = uv[1];
        const DeltaInverse pose = delta_inverse(*mechanism.delta(), p, range);
        ASSERT_EQ(pose.status, SolveStatus::reached);
        // Within 1e-6 m of the end of a joint's range.
        double gap = 1e9;
        for (int j = 0; j < 3; ++j) {
          gap = std::min({gap, pose.theta[j] - range.min, range.max - pose.theta[j]});
        }
        EXPECT_LT(gap, 1e-5);
      }
    }
  }
}

TEST(Slice, AreasOfAllHeightsMakeTheVolume) {
  const Mechanism mechanism(published());
  const Extents extents = workspace_extents(mechanism);
  const int layers = 80;
  double sum = 0.0;
  for (int n = 0; n < layers; ++n) {
    const double z = extents.range[2].min + extents.range[2].width() * (n + 0.5) / layers;
    const double area = map_slice(mechanism, extents, 2, z, 81, {}).slice.area;
    EXPECT_GE(area, 0.0);
    sum += area * extents.range[2].width() / layers;
  }
  EXPECT_NEAR(sum, workspace_volume(mechanism).value, 2e-3 * sum);
}

TEST(Slice, HolesRunTheOtherWayRound) {
  // Bottom of a delta with a wide joint range: the plane z = 0 cuts a ring or several pieces, never a negative
  // area.
  DeltaDescription delta = test::published_delta();
  delta.joint_range = {-2.0, 2.0};
  Description description;
  description.mechanism = delta;
  const Mechanism mechanism(description);
  const Extents extents = workspace_extents(mechanism);
  const SliceMap map = map_slice(mechanism, extents, 2, 0.05, 101, {});
  double counted = 0.0;
  for (const double value : map.values[0]) counted += std::isnan(value) ? 0.0 : 1.0;
  const double cell = map.u_range.width() / (map.nu - 1) * map.v_range.width() / (map.nv - 1);
  EXPECT_NEAR(map.slice.area, counted * cell, 0.05 * counted * cell);
}

TEST(Slice, LegsAgreeWithClosedForm) {
  const Mechanism delta(published()), legs(spelled_out(published()));
  const Extents extents = workspace_extents(delta);
  const SliceMap a = map_slice(delta, extents, 0, 0.01, 21, {}), b = map_slice(legs, extents, 0, 0.01, 21, {});
  EXPECT_NEAR(a.slice.area, b.slice.area, 1e-8);
  ASSERT_EQ(a.values[0].size(), b.values[0].size());
  for (std::size_t p = 0; p < a.values[0].size(); ++p) {
    ASSERT_EQ(std::isnan(a.values[0][p]), std::isnan(b.values[0][p]));
    if (!std::isnan(a.values[0][p])) {
      EXPECT_NEAR(a.values[0][p], b.values[0][p], 1e-6);
    }
  }
}

TEST(SurfaceMesh, EnclosesTheVolumeFacingOutwards) {
  const Mechanism mechanism(published());
  const SurfaceMesh mesh = workspace_surface(mechanism, 40);
  ASSERT_EQ(mesh.triangles.size(), 6u * 40u * 40u * 2u);
  ASSERT_EQ(mesh.face.size(), mesh.triangles.size());
  double volume = 0.0;  // divergence theorem
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto vertex = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
    volume += vertex(a).dot(vertex(b).cross(vertex(c))) / 6.0;
  }
  EXPECT_NEAR(volume, workspace_volume(mechanism).value, 2e-3 * volume);
}

}  // namespace
}  // namespace zwidth
