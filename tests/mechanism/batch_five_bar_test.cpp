#include "zwidth/mechanism/batch_five_bar.h"

#include <cmath>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <limits>
#include <numbers>
#include <vector>

#include "support/five_bars.h"
#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;

// Runs `body` on every instruction set that this machine has, the portable one included.
template <class Body>
void on_every_target(const Body& body) {
  const auto attainable = hwy::SupportedTargets();
  for (auto rest = attainable; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & ~(rest - 1));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

struct Points {
  std::vector<double> x, y;
  std::size_t size() const { return x.size(); }
  Vector2 operator[](std::size_t p) const { return {x[p], y[p]}; }
};

// Points in and around the reach of a five-bar, a number that no vector length divides.
Points random_points(std::mt19937_64& random, const FiveBarGeometry& geometry) {
  Points points;
  const double reach = 1.05 * (geometry.crank + geometry.coupler);
  for (int p = 0; p < 253; ++p) {
    points.x.push_back(test::draw(random, -reach, reach));
    points.y.push_back(test::draw(random, -reach, reach));
  }
  return points;
}

std::array<Interval, 2> random_ranges(std::mt19937_64& random) {
  std::array<Interval, 2> ranges = kAnyCrankAngle;
  for (Interval& range : ranges) {
    if (test::draw(random, 0.0, 1.0) < 0.5) continue;
    const double low = test::draw(random, -kPi, kPi);
    range = {low, low + test::draw(random, 0.5, 6.0)};
  }
  return ranges;
}

// By how much a tool point misses the nearest bound of what is reachable; there both answers are right.
double clearance(const FiveBarGeometry& g, const std::array<Interval, 2>& ranges, const FiveBarInverse& pose,
                 const Vector2& p) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i) {
    const double D = (p - Vector2(i == 0 ? -g.half_base : g.half_base, 0.0)).norm();
    least = std::min({least, std::abs(D - g.crank - g.coupler) / g.scale(),
                      std::abs(D - std::abs(g.crank - g.coupler)) / g.scale()});
    for (const double end : {ranges[i].min, ranges[i].max}) {
      least = std::min(least, std::abs(std::remainder(pose.theta[i] - end, 2 * kPi)));
    }
  }
  return least;
}

TEST(FiveBarBatch, AgreesWithOnePoseAtATimeOnEveryTarget) {
  on_every_target([] {
    std::mt19937_64 random(21);
    int reachable = 0, out = 0;
    for (int k = 0; k < test::storm_size(200); ++k) {
      const FiveBarGeometry g = test::random_five_bar(random);
      const WorkingMode mode = kWorkingModes[static_cast<std::size_t>(k % 4)];
      const std::array<Interval, 2> ranges = random_ranges(random);
      const FiveBarBatch batch(g, mode, ranges);
      const Points points = random_points(random, g);
      const std::size_t n = points.size();
      std::vector<double> K(n), cosine(2 * n), sine(2 * n), J(4 * n);
      batch.condition_numbers(points.x, points.y, K);
      batch.inverse(points.x, points.y, cosine, sine, J);
      for (std::size_t p = 0; p < n; ++p) {
        const FiveBarInverse pose = five_bar_inverse(g, points[p], mode, ranges);
        if (clearance(g, ranges, pose, points[p]) < 1e-6) continue;
        const bool inside = pose.status == SolveStatus::reached || pose.status == SolveStatus::degraded;
        ASSERT_EQ(!std::isnan(K[p]), inside) << k << " " << points[p].transpose();
        ASSERT_EQ(!std::isnan(cosine[p]), inside);
        if (!inside) {
          ++out;
          continue;
        }
        ++reachable;
        const FiveBarState state(g, pose.theta, points[p]);
        const double sides = state.inverse_singularity().cwiseAbs().minCoeff(),
                     amplified = 1e-13 / (sides * std::abs(state.direct_singularity()));
        if (!(amplified < 1e-6)) continue;
        EXPECT_NEAR(K[p], state.condition_number(), 10.0 * amplified * K[p]);
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_NEAR(cosine[i * n + p], std::cos(pose.theta[static_cast<int>(i)]), 1e-12 / sides);
          EXPECT_NEAR(sine[i * n + p], std::sin(pose.theta[static_cast<int>(i)]), 1e-12 / sides);
        }
        for (std::size_t e = 0; e < 4; ++e) {
          EXPECT_NEAR(J[e * n + p], pose.jacobian(static_cast<int>(e / 2), static_cast<int>(e % 2)),
                      10.0 * amplified * pose.jacobian.norm());
        }
      }
    }
    EXPECT_GT(reachable, 1000);
    EXPECT_GT(out, 1000);
  });
}

TEST(FiveBarBatch, CountsWhatItsConditionNumbersSay) {
  on_every_target([] {
    std::mt19937_64 random(22);
    for (int k = 0; k < 100; ++k) {
      const FiveBarGeometry g = test::random_five_bar(random);
      const FiveBarBatch batch(g, kWorkingModes[static_cast<std::size_t>(k % 4)], random_ranges(random));
      const Points points = random_points(random, g);
      std::vector<double> K(points.size());
      batch.condition_numbers(points.x, points.y, K);
      for (const double limit : {0.5, 1.0, 2.0, 5.0, 100.0}) {
        FiveBarBatch::Count expected;
        for (const double one : K) {
          expected.reachable += !std::isnan(one);
          expected.singular += std::isinf(one);
          expected.above += std::isfinite(one) && one > limit;
        }
        const FiveBarBatch::Count found = batch.count_above(points.x, points.y, limit);
        EXPECT_EQ(found.reachable, expected.reachable);
        EXPECT_EQ(found.singular, expected.singular);
        EXPECT_EQ(found.above, expected.above);
      }
    }
  });
}

TEST(FiveBarBatch, KnowsTheBoundaryAndTheMotorAxes) {
  on_every_target([] {
    const std::vector<double> x = {0.22, 0.08, 0.0, 0.22 + 1e-9, 0.03}, y = {0.0, 0.0, 0.04, 0.0, 0.0};
    const FiveBarBatch::Count count = FiveBarBatch(test::kPublishedFiveBar).count_above(x, y, 5.0);
    EXPECT_EQ(count.reachable, 3);
    EXPECT_EQ(count.singular, 3);
    EXPECT_EQ(count.above, 0);
    // Equal links: next to a motor axis the leg is bent at a right angle, on it there is no answer.
    const FiveBarGeometry equal{.crank = 0.1, .coupler = 0.1, .half_base = 0.03};
    const std::vector<double> nx = {0.03, 0.03 + 1e-9}, ny = {0.0, 1e-9};
    std::vector<double> K(2);
    FiveBarBatch(equal).condition_numbers(nx, ny, K);
    EXPECT_TRUE(std::isnan(K[0]));
    const Vector2 p(nx[1], ny[1]);
    const double one = FiveBarState(equal, five_bar_inverse(equal, p).theta, p).condition_number();
    EXPECT_NEAR(K[1], one, 1e-6 * one);
    // Lengths that cannot be assembled reach nothing.
    EXPECT_EQ(FiveBarBatch({1.0, 1.0, 2.5}).count_above(x, y, 5.0).reachable, 0);
    EXPECT_EQ(FiveBarBatch({0.0, 1.0, 0.5}).count_above(x, y, 5.0).reachable, 0);
  });
}

}  // namespace
}  // namespace zwidth
