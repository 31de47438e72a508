#include "zwidth/analysis/reach_shapes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/small_arms.h"

#include "zwidth/analysis/dexterity.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/point_reach.h"

namespace zwidth {
namespace {

// A map of the cubes whose middles satisfy a predicate, in a box of -1..1.
template <class Inside>
ReachMap map_of(int cubes, const Inside& inside) {
  ReachMap map;
  map.spacing = 2.0 / cubes;
  map.first = {-cubes / 2, -cubes / 2, -cubes / 2};
  map.count = {cubes, cubes, cubes};
  for (int i = 0; i < cubes; ++i) {
    for (int j = 0; j < cubes; ++j) {
      for (int k = 0; k < cubes; ++k) {
        const auto middle = [&](int index) { return (index - cubes / 2 + 0.5) * map.spacing; };
        map.inside.push_back(inside(Vector3(middle(i), middle(j), middle(k))) ? 1 : 0);
      }
    }
  }
  return map;
}

TEST(ReachShapes, TheLargestBallOfABallIsItself) {
  const Vector3 centre(0.1, -0.2, 0.15);
  const ReachMap map = map_of(60, [&](const Vector3& p) { return (p - centre).norm() < 0.7; });
  const InscribedShapes shapes = inscribed_shapes(map);
  const double diagonal = std::sqrt(3.0) * map.spacing;
  EXPECT_NEAR(shapes.sphere.size, 0.7, diagonal);
  EXPECT_NEAR((shapes.sphere.centre - centre).norm(), 0.0, diagonal);
  EXPECT_NEAR(shapes.cube.size, 2.0 * 0.7 / std::sqrt(3.0), 2.0 * map.spacing);
  EXPECT_NEAR((shapes.cube.centre - centre).cwiseAbs().maxCoeff(), 0.0, 2.0 * map.spacing);
}

TEST(ReachShapes, TheLargestShapesOfABoxTouchItsNarrowSide) {
  const ReachMap map = map_of(50, [](const Vector3& p) {
    return std::abs(p.x()) < 0.8 && std::abs(p.y()) < 0.4 && std::abs(p.z()) < 0.9;
  });
  const InscribedShapes shapes = inscribed_shapes(map);
  EXPECT_NEAR(shapes.cube.size, 0.8, 1e-12);
  EXPECT_NEAR(shapes.sphere.size, 0.4, map.spacing);
}

TEST(ReachShapes, ReachTheRimOfTheMap) {
  const ReachMap map = map_of(20, [](const Vector3&) { return true; });
  EXPECT_NEAR(inscribed_shapes(map).cube.size, 2.0, 1e-12);
  EXPECT_NEAR(inscribed_shapes(map).sphere.size, 1.0, map.spacing);
}

TEST(ReachShapes, OfNothingAreNothing) {
  const InscribedShapes shapes = inscribed_shapes(map_of(8, [](const Vector3&) { return false; }));
  EXPECT_EQ(shapes.sphere.size, 0.0);
  EXPECT_EQ(shapes.cube.size, 0.0);
}

// A vertical slide and two links that turn about it: a cut across z is a crescent of known area.
Mechanism cylindrical() {
  Description description;
  const Interval turn{-0.5, 0.5}, bend{0.6, 2.0};
  description.mechanism = SerialDescription{
      .joints = {{.name = "lift", .type = SerialJointType::prismatic, .range = {0.0, 0.2}, .home = 0.1},
                 {.name = "shoulder", .a = 0.3, .range = turn},
                 {.name = "elbow", .a = 0.2, .range = bend, .home = 1.0}}};
  return Mechanism(description);
}

TEST(ReachShapes, ACutHasTheAreaOfTheRegionAndItsBestConditioning) {
  const Mechanism mechanism = cylindrical();
  const ReachMap map = reach_map(mechanism, {.spacing = 0.004});
  const Vector3 through(0.3, 0.1, 0.1);
  const auto slices = slice_reach(mechanism, map, through, 200'000);
  // Each radius r^2 = a^2 + b^2 + 2 a b cos(elbow) is swept over the shoulder's range: area = width (r1^2 -
  // r2^2)/2.
  const auto squared = [](double elbow) { return 0.09 + 0.04 + 0.12 * std::cos(elbow); };
  const double area = 1.0 * (squared(0.6) - squared(2.0)) / 2.0;
  EXPECT_NEAR(slices[2].slice.area, area, 0.02 * area);
  // 1/K of the linear rows at one point, from the two links' Jacobian and the slide's unit column.
  const PlaneGrid& grid = slices[2].conditioning;
  const JacobianScale scale = jacobian_scale(mechanism);
  int compared = 0;
  for (int iv = 0; iv < grid.nv; iv += 7) {
    for (int iu = 0; iu < grid.nu; iu += 7) {
      if (std::isnan(grid.at(iu, iv))) continue;
      const double x = grid.u.min + grid.u.width() * iu / (grid.nu - 1);
      const double y = grid.v.min + grid.v.width() * iv / (grid.nv - 1);
      const double c = ((x * x + y * y) - 0.13) / 0.12, elbow = std::acos(std::clamp(c, -1.0, 1.0));
      const double shoulder = std::atan2(y, x) - std::atan2(0.2 * std::sin(elbow), 0.3 + 0.2 * std::cos(elbow));
      const Solution solution = solve_forward(mechanism, Vector3(0.1, shoulder, elbow));
      const Jacobian rows = jacobian(*solution.posture).topRows(3);
      const double expected = 1.0 / scale.rows_condition_number(rows);
      EXPECT_NEAR(grid.at(iu, iv), expected, 0.02);  // over a cube and its neighbours in height
      ++compared;
    }
  }
  EXPECT_GT(compared, 15);
}

TEST(ReachShapes, CutsOfAnArmInClosedFormFollowItsBoundary) {
  const Mechanism mechanism(test::seven_joint_arm(0.25, 0.2));
  const std::optional<PointReach> reach = PointReach::of(mechanism);
  ASSERT_TRUE(reach);
  const ReachMap map = reach_map(mechanism, {.spacing = 0.02});
  const Vector3 through(0.2, 0.05, -0.1);
  for (const ReachSlice& cut : slice_reach(mechanism, map, through, 2'000)) {
    ASSERT_FALSE(cut.slice.outlines.empty());
    double inside = 0.0;
    constexpr double h = 2e-3;
    for (double u = -0.5; u < 0.5; u += h) {
      for (double v = -0.5; v < 0.5; v += h) {
        Vector3 point = through;
        point[cut.slice.u] = u;
        point[cut.slice.v] = v;
        inside += reach->contains(point) ? h * h : 0.0;
      }
    }
    EXPECT_NEAR(cut.slice.area, inside, 0.01 * inside);
    // Every point of an outline is inside, and next to points that are not.
    for (const Outline& outline : cut.slice.outlines) {
      for (std::size_t p = 0; p < outline.size(); p += 29) {
        Vector3 point = through;
        point[cut.slice.u] = outline[p][0];
        point[cut.slice.v] = outline[p][1];
        EXPECT_TRUE(reach->contains(point));
        bool beside = false;
        for (const auto& [u, v] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
          Vector3 other = point;
          other[cut.slice.u] += 1e-7 * u;
          other[cut.slice.v] += 1e-7 * v;
          beside = beside || !reach->contains(other);
        }
        EXPECT_TRUE(beside);
      }
    }
  }
}

}  // namespace
}  // namespace zwidth
