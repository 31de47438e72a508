#include "zwidth/analysis/five_bar_curves.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

#include "support/five_bars.h"

namespace zwidth {
namespace {

const FiveBarGeometry kPublished = test::kPublishedFiveBar;

std::set<FiveBarCurveKind> kinds(const std::vector<FiveBarCurve>& curves) {
  std::set<FiveBarCurveKind> found;
  for (const FiveBarCurve& curve : curves) found.insert(curve.kind);
  return found;
}

// How far the point is from being what the curve says, in the best of the working modes allowed.
double defect(const FiveBarGeometry& g, const FiveBarCurve& curve, const Vector2& p,
              const std::optional<WorkingMode>& mode) {
  double least = 1.0;
  for (const WorkingMode one : kWorkingModes) {
    const FiveBarInverse pose = five_bar_inverse(g, p, one);
    EXPECT_NE(pose.status, SolveStatus::unreachable) << p.transpose();
    const FiveBarState state(g, pose.theta, p);
    const Vector2 sides = state.inverse_singularity().cwiseAbs();
    // At the end of a piece a leg is straight, and rounding decides which mode it is in.
    const bool same_left = !mode || one.left == mode->left || sides[0] < 1e-5;
    const bool same_right = !mode || one.right == mode->right || sides[1] < 1e-5;
    if (!same_left || !same_right) continue;
    const bool left =
        curve.kind == FiveBarCurveKind::left_stretched || curve.kind == FiveBarCurveKind::left_folded;
    const double measure = is_direct(curve.kind) ? std::abs(state.direct_singularity()) : sides[left ? 0 : 1];
    least = std::min(least, measure);
  }
  return least;
}

TEST(SingularCurves, ConsistOfSingularPosturesOfTheModeAskedFor) {
  std::mt19937_64 random(31);
  int checked = 0;
  for (int k = 0; k < 40; ++k) {
    const FiveBarGeometry g = k == 0 ? kPublished : test::random_five_bar(random);
    std::vector<std::optional<WorkingMode>> modes = {std::nullopt};
    for (const WorkingMode mode : kWorkingModes) modes.emplace_back(mode);
    for (const auto& mode : modes) {
      for (const FiveBarCurve& curve : singular_curves(g, {.mode = mode, .points_per_turn = 90})) {
        ASSERT_FALSE(curve.points.empty());
        for (const auto& [x, y] : curve.points) {
          // A distance of rounding from a boundary circle is its square root in the angle of the leg.
          EXPECT_LT(defect(g, curve, {x, y}, mode), 1e-5) << to_string(curve.kind) << " " << x << " " << y;
          ++checked;
        }
      }
    }
  }
  EXPECT_GT(checked, 10000);
}

TEST(SingularCurves, AreAbsentExactlyWhereTheConditionsSay) {
  std::mt19937_64 random(32);
  for (int k = 0; k < 300; ++k) {
    const FiveBarGeometry g = test::random_five_bar(random);
    const FiveBarConditions conditions = avoidance_conditions(g);
    const std::set<FiveBarCurveKind> found = kinds(singular_curves(g, {.points_per_turn = 180}));
    EXPECT_EQ(found.contains(FiveBarCurveKind::elbows_coincide), conditions.elbows_can_coincide);
    EXPECT_EQ(found.contains(FiveBarCurveKind::couplers_aligned), conditions.couplers_can_align)
        << g.crank << " " << g.coupler << " " << g.half_base;
  }
}

TEST(SingularCurves, SelectedDesignHasNoDirectSingularityAboveItsBaseInItsOwnMode) {
  for (const FiveBarCurve& curve : singular_curves(kPublished, {.mode = WorkingMode{}})) {
    if (!is_direct(curve.kind)) continue;
    EXPECT_EQ(curve.kind, FiveBarCurveKind::elbows_coincide);  // r2 > r1 + r3
    for (const auto& point : curve.points) EXPECT_LE(point[1], 1e-9);
  }
}

TEST(SingularCurves, BoundaryOfAWholeTurnIsClosedAndAPartHasExactEnds) {
  bool closed = false;
  for (const FiveBarCurve& curve : singular_curves(kPublished)) {
    if (curve.kind != FiveBarCurveKind::left_stretched) continue;
    closed |= curve.closed;
    // The arc of radius 25 about O1 ends where the right leg is stretched too, at x = 0.
    if (!curve.closed) {
      EXPECT_NEAR(curve.points.front()[0], 0.0, 1e-9);
      EXPECT_NEAR(curve.points.back()[0], 0.0, 1e-9);
    }
  }
  EXPECT_FALSE(closed);
  // Cranks of any angle and elbows that meet: a whole circle of radius r2 about each meeting point.
  int circles = 0;
  for (const FiveBarCurve& curve : singular_curves(kPublished)) {
    if (curve.kind == FiveBarCurveKind::elbows_coincide) {
      EXPECT_TRUE(curve.closed);
      ++circles;
    }
  }
  EXPECT_EQ(circles, 2);
}

TEST(SingularCurves, KeepToTheRangesOfTheCranks) {
  const std::array<Interval, 2> ranges = {Interval{1.0, 2.5}, Interval{0.5, 2.0}};
  for (const FiveBarCurve& curve : singular_curves(kPublished, {.mode = WorkingMode{}, .ranges = ranges})) {
    for (const auto& [x, y] : curve.points) {
      const Vector2 theta = five_bar_inverse(kPublished, {x, y}).theta;
      for (int i = 0; i < 2; ++i) EXPECT_TRUE(ranges[static_cast<std::size_t>(i)].contains(theta[i], 1e-5));
    }
  }
}

}  // namespace
}  // namespace zwidth
