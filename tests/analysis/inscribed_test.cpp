#include <chrono>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "support/deltas.h"
#include "support/pneumatics.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

Description describe(DeltaDescription delta) {
  Description description;
  description.name = "delta";
  description.mechanism = std::move(delta);
  return description;
}

bool inside(const DeltaGeometry& geometry, const Interval& range, const Vector3& p) {
  const DeltaInverse inverse = delta_inverse(geometry, p, range);
  if (inverse.status != SolveStatus::reached && inverse.status != SolveStatus::degraded) return false;
  return (delta_forward(geometry, inverse.theta).position - p).norm() < 1e-7;
}

// A random point of the surface of the unit sphere or cube.
Vector3 surface_point(std::mt19937_64& random, bool cube) {
  std::normal_distribution<double> normal;
  const Vector3 u(normal(random), normal(random), normal(random));
  return u / (cube ? u.lpNorm<Eigen::Infinity>() : u.norm());
}

void expect_largest(const DeltaDescription& delta, const InscribedShape& shape, bool cube,
                    std::mt19937_64& random) {
  const DeltaGeometry geometry = delta_geometry(delta);
  const double a = cube ? 0.5 * shape.size : shape.size;
  ASSERT_GT(a, 0.0);
  std::vector<Vector3> surface;
  for (int n = 0; n < 8000; ++n) surface.push_back(surface_point(random, cube));
  if (cube) {
    for (int corner = 0; corner < 8; ++corner) {
      surface.emplace_back(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    }
  }
  int out = 0, out_larger = 0;
  for (const Vector3& u : surface) {
    out += !inside(geometry, delta.joint_range, shape.centre + a * u);
    out_larger += !inside(geometry, delta.joint_range, shape.centre + 1.005 * a * u);
  }
  EXPECT_EQ(out, 0) << (cube ? "cube" : "sphere");
  EXPECT_GT(out_larger, 0) << (cube ? "cube" : "sphere");

  // No shape of the same kind, slightly larger, fits anywhere near.
  std::uniform_real_distribution<double> move(-0.05, 0.05);
  for (int n = 0; n < 200; ++n) {
    const Vector3 centre = shape.centre + a * Vector3(move(random), move(random), move(random));
    const double larger = a * 1.0002 + 1e-6;
    const bool fits = std::ranges::all_of(
        surface, [&](const Vector3& u) { return inside(geometry, delta.joint_range, centre + larger * u); });
    EXPECT_FALSE(fits) << (cube ? "cube at " : "sphere at ") << centre.transpose();
  }
}

TEST(Inscribed, PublishedDelta) {
  std::mt19937_64 random(31);
  const DeltaDescription delta = test::published_delta();
  const InscribedShapes shapes = inscribed_shapes(Mechanism(describe(delta)));
  expect_largest(delta, shapes.sphere, false, random);
  expect_largest(delta, shapes.cube, true, random);
  // Mirror symmetry of the delta about the plane of leg 1, threefold symmetry about z.
  EXPECT_NEAR(shapes.sphere.centre.x(), 0.0, 1e-6);
  EXPECT_NEAR(shapes.sphere.centre.y(), 0.0, 1e-6);
  EXPECT_NEAR(shapes.sphere.volume, 4.0 / 3.0 * std::numbers::pi * std::pow(shapes.sphere.size, 3), 1e-15);
  EXPECT_NEAR(shapes.cube.volume, std::pow(shapes.cube.size, 3), 1e-15);
}

TEST(Inscribed, RandomDeltas) {
  std::mt19937_64 random(32);
  for (int design = 0; design < 4; ++design) {
    const DeltaDescription delta = test::random_delta(random);
    const InscribedShapes shapes = inscribed_shapes(Mechanism(describe(delta)));
    expect_largest(delta, shapes.sphere, false, random);
    expect_largest(delta, shapes.cube, true, random);
  }
}

TEST(Inscribed, LegsAgreeWithClosedForm) {
  const Description description = describe(test::published_delta());
  const InscribedShapes closed = inscribed_shapes(Mechanism(description));
  const InscribedShapes general = inscribed_shapes(Mechanism(spelled_out(description)));
  EXPECT_NEAR(general.sphere.size / closed.sphere.size, 1.0, 1e-5);
  EXPECT_NEAR(general.cube.size / closed.cube.size, 1.0, 1e-5);
}

// The first pneumatic prototype covers a crescent, thin beside its width: the largest cube lies across it,
// between the circle of the stretched arm and that of the bent one.
TEST(Inscribed, ThinWorkspaceOfAnArm) {
  const test::Prototype1 l;
  Description device = test::prototype(l, {-std::numbers::pi / 3.0, std::numbers::pi / 3.0});
  std::get<SerialDescription>(device.mechanism).joints[0].range = {0.0, 0.1};
  const InscribedShapes shapes = inscribed_shapes(Mechanism(device));
  const double forearm = std::hypot(l.l3z, l.l3x), lean = std::atan2(l.l3x, l.l3z);
  const double outer = l.l2x + forearm;
  const double inner = std::sqrt(l.l2x * l.l2x + forearm * forearm +
                                 2.0 * l.l2x * forearm * std::cos(std::numbers::pi / 3.0 + lean));
  // A square across the x axis: its inner side touches the inner circle, its outer corners the outer one,
  // (inner + a)^2 + (a/2)^2 = outer^2.
  const double a =
      (-2.0 * inner + std::sqrt(4.0 * inner * inner + 5.0 * (outer * outer - inner * inner))) / 2.5;
  EXPECT_NEAR(shapes.cube.size, a, 1e-7 * a);
  EXPECT_NEAR(shapes.cube.centre.y(), 0.0, 1e-6);
  EXPECT_NEAR(2.0 * shapes.sphere.size, outer - inner, 1e-6);
}

// The workspace of an R-CUBE is a cube itself, which lies against all its sides at once; its legs alone do not
// know that.
TEST(Inscribed, CubeOfAnRCubeByItsLegs) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const RCubeDescription d{.drive_link = 0.08,
                           .inner_link = 0.12,
                           .outer_link = 0.12,
                           .base_offset = 0.1,
                           .joint_range = {-40.0 * kDegree, 40.0 * kDegree},
                           .source = "test"};
  Description description;
  description.mechanism = legs_of(d);
  const InscribedShapes shapes = inscribed_shapes(Mechanism(description));
  const double edge = 2.0 * d.drive_link * std::sin(40.0 * kDegree);
  EXPECT_NEAR(shapes.cube.size, edge, 1e-6 * edge);
  EXPECT_NEAR(2.0 * shapes.sphere.size, edge, 1e-6 * edge);
}

}  // namespace
}  // namespace zwidth
