#include "zwidth/analysis/five_bar_search.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <stdexcept>

#include "support/five_bars.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Table 1, in cm, on the sampling that gives the paper's result.
FiveBarSearch published_search() {
  return {.crank = {9.0, 12.0, 1.0},
          .coupler = {11.0, 15.0, 1.0},
          .base = {3.0, 5.0, 1.0},
          .sampling = {.radius_step = 1.0, .angle_step = 2.0 * kDegree}};
}

std::vector<std::array<double, 3>> winners(const FiveBarSearchResult& result) {
  std::vector<std::array<double, 3>> lengths;
  for (const std::size_t d : result.optimum) lengths.push_back(result.designs[d].lengths);
  return lengths;
}

using Lengths = std::vector<std::array<double, 3>>;

TEST(PolarPoints, LeaveOutTheEndOfAFullTurnOnly) {
  const PolarSampling full{.radius_step = 0.5, .angle_step = 90.0 * kDegree};
  const PolarPoints points = polar_points(full, 1.2);
  EXPECT_EQ(points.per_circle, 4);
  ASSERT_EQ(points.size(), 8u);
  EXPECT_NEAR(points.y[1], 0.5, 1e-16);
  EXPECT_NEAR(points.x[6], -1.0, 1e-16);
  PolarSampling half = full;
  half.angle_span = 180.0 * kDegree;
  EXPECT_EQ(polar_points(half, 1.2).per_circle, 3);
  PolarSampling uneven = full;
  uneven.angle_step = 100.0 * kDegree;  // 0, 100, 200, 300
  EXPECT_EQ(polar_points(uneven, 1.2).per_circle, 4);
  EXPECT_EQ(polar_points(full, 1.5).size(), 12u);  // the last circle is the reach itself
  EXPECT_EQ(polar_points(full, 0.4).size(), 0u);
}

TEST(PolarPoints, RefuseStepsThatGoNowhere) {
  for (const PolarSampling& bad :
       {PolarSampling{.radius_step = 0.0}, PolarSampling{.angle_step = -1.0}, PolarSampling{.angle_span = 0.0},
        PolarSampling{.angle_span = 7.0}, PolarSampling{.radius_step = std::nan("")}}) {
    EXPECT_THROW(polar_points(bad, 1.0), std::invalid_argument);
  }
  EXPECT_THROW(polar_points({.radius_step = 1e-9}, 1.0), std::length_error);
}

TEST(ConditionCensus, CountsTheSelectedDesignAsTheSpecificationDoes) {
  const ConditionCensus census =
      condition_census({10.0, 15.0, 3.0}, {}, {.radius_step = 1.0, .angle_step = 2.0 * kDegree});
  EXPECT_EQ(census.points, 25 * 180);
  EXPECT_EQ(census[ConditionClass::below_5], 2738);
  EXPECT_EQ(census[ConditionClass::from_5_to_10], 147);
  EXPECT_EQ(census[ConditionClass::from_10_to_100], 119);
  EXPECT_EQ(census[ConditionClass::above_100], 6);
  EXPECT_EQ(census.singular, 6);
  EXPECT_EQ(census.reachable, 2738 + 147 + 119 + 6 + 6);
  EXPECT_NEAR(census.largest, 232.0, 1.0);
  const Vector2 p = census.largest_at;
  EXPECT_NEAR(
      FiveBarState({10.0, 15.0, 3.0}, five_bar_inverse({10.0, 15.0, 3.0}, p).theta, p).condition_number(),
      census.largest, 1e-6 * census.largest);
}

TEST(DexterousAnnulus, OfTheSelectedDesignReachesFromInnerToOuterEdge) {
  const auto annulus =
      dexterous_annulus({10.0, 15.0, 3.0}, {}, 5.0, {.radius_step = 0.05, .angle_step = kDegree});
  ASSERT_TRUE(annulus);
  EXPECT_NEAR(annulus->min, 8.5, 0.051);
  EXPECT_NEAR(annulus->max, 21.6, 0.051);
  EXPECT_FALSE(dexterous_annulus({10.0, 15.0, 3.0}, {}, 1.0, {.radius_step = 1.0}));
}

TEST(SearchFiveBars, PublishedGridTiesTheTwoPublishedDesigns) {
  const FiveBarSearchResult result = search_five_bars(published_search());
  EXPECT_EQ(result.designs.size(), 60u);
  EXPECT_EQ(winners(result), (Lengths{{9, 14, 3}, {10, 15, 3}}));
  EXPECT_EQ(result.designs[result.optimum.front()].bad, 272);
  EXPECT_EQ(result.designs[*result.selected].lengths, (std::array<double, 3>{10, 15, 3}));
  const std::vector<std::pair<double, std::int64_t>> expected = {{3, 272}, {4, 350}, {5, 490}};
  EXPECT_EQ(result.fewest_by_base(), expected);
  const auto bad = [&](const std::array<double, 3>& lengths) {
    return std::find_if(result.designs.begin(), result.designs.end(),
                        [&](const FiveBarScore& design) { return design.lengths == lengths; })
        ->bad;
  };
  EXPECT_EQ(bad({10, 14, 3}), 274);
  EXPECT_EQ(bad({9, 13, 3}), 276);
  EXPECT_EQ(bad({11, 15, 3}), 276);
  EXPECT_EQ(bad({9, 15, 3}), 296);
  EXPECT_EQ(result.designs[*result.selected].singular, 6);
}

TEST(SearchFiveBars, OptimumHangsOnTheSampling) {
  FiveBarSearch search = published_search();
  search.count_singular = true;
  const FiveBarSearchResult counted = search_five_bars(search);
  EXPECT_EQ(winners(counted), (Lengths{{9, 14, 3}, {10, 14, 3}, {10, 15, 3}}));
  EXPECT_EQ(counted.designs[counted.optimum.front()].bad, 278);
  search.count_singular = false;
  search.sampling = {.radius_step = 1.0, .angle_step = kDegree};
  EXPECT_EQ(winners(search_five_bars(search)), (Lengths{{10, 14, 3}}));
  search.sampling = {.radius_step = 0.5, .angle_step = kDegree};
  EXPECT_EQ(winners(search_five_bars(search)), (Lengths{{11, 15, 3}}));
  // The full base needs arcs as coarse as 4 deg to tie the same two.
  search.base_is_half = false;
  search.sampling = {.radius_step = 1.0, .angle_step = 4.0 * kDegree};
  const FiveBarSearchResult full = search_five_bars(search);
  EXPECT_EQ(winners(full), (Lengths{{9, 14, 3}, {10, 15, 3}}));
  EXPECT_EQ(full.designs[full.optimum.front()].bad, 44);
}

TEST(SearchFiveBars, ScoresEqualOnePoseAtATime) {
  FiveBarSearch search = published_search();
  search.crank = {4.0, 12.0, 4.0};
  search.base = {2.0, 14.0, 6.0};
  search.mode = {.left = -1, .right = -1};
  search.sampling.angle_step = 5.0 * kDegree;
  const FiveBarSearchResult result = search_five_bars(search);
  ASSERT_GT(result.designs.size(), 30u);
  for (const FiveBarScore& design : result.designs) {
    const PolarPoints points = polar_points(search.sampling, design.geometry.crank + design.geometry.coupler);
    std::int64_t reachable = 0, above = 0, singular = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vector2 at(points.x[p], points.y[p]);
      const FiveBarInverse pose = five_bar_inverse(design.geometry, at, search.mode);
      if (pose.status != SolveStatus::reached && pose.status != SolveStatus::degraded) continue;
      const double K = FiveBarState(design.geometry, pose.theta, at).condition_number();
      ++reachable;
      singular += std::isinf(K);
      above += std::isfinite(K) && K > search.limit * (1.0 + 1e-12);
    }
    EXPECT_EQ(design.reachable, reachable);
    EXPECT_EQ(design.singular, singular);
    EXPECT_EQ(design.bad, above);
  }
}

TEST(SearchFiveBars, IsTheSameOnAnyNumberOfThreadsAndStopsWhenAsked) {
  const FiveBarSearchResult one = search_five_bars(published_search(), {.threads = 1});
  const FiveBarSearchResult two = search_five_bars(published_search(), {.threads = 2});
  ASSERT_EQ(one.designs.size(), two.designs.size());
  for (std::size_t d = 0; d < one.designs.size(); ++d) EXPECT_EQ(one.designs[d].bad, two.designs[d].bad);
  EXPECT_EQ(one.optimum, two.optimum);
  EXPECT_EQ(one.points, two.points);
  const std::atomic<bool> cancel{true};
  const FiveBarSearchResult stopped = search_five_bars(published_search(), {.cancel = &cancel});
  EXPECT_FALSE(stopped.complete);
  EXPECT_TRUE(stopped.designs.empty());
  EXPECT_FALSE(stopped.selected);
}

TEST(SearchFiveBars, LeavesOutWhatCannotBeAssembledAndRefusesEmptyRanges) {
  FiveBarSearch search = published_search();
  search.base = {20.0, 30.0, 1.0};  // beyond r1 + r2 of most
  for (const FiveBarScore& design : search_five_bars(search).designs) {
    EXPECT_TRUE(can_assemble(design.geometry));
    EXPECT_GT(design.reachable, 0);
  }
  search = published_search();
  search.crank = {12.0, 9.0, 1.0};
  EXPECT_THROW(search_five_bars(search), std::invalid_argument);
  search.crank = {9.0, 12.0, 0.0};
  EXPECT_THROW(search_five_bars(search), std::invalid_argument);
  search.crank = {9.0, 9.0, 0.0};  // one value needs no step
  EXPECT_EQ(search_five_bars(search).designs.size(), 15u);
  search.crank = {9.0, 12.0, 1e-9};
  EXPECT_THROW(search_five_bars(search), std::length_error);
}

}  // namespace
}  // namespace zwidth
