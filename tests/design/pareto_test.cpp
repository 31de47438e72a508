#include "zwidth/design/pareto.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <random>

namespace zwidth {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Small whole numbers, so that ties and duplicates are common.
std::vector<double> random_rows(std::mt19937& random, std::size_t count, std::size_t objectives) {
  std::uniform_int_distribution<int> digit(0, 9);
  std::vector<double> values(count * objectives);
  for (double& value : values) value = digit(random);
  return values;
}

std::span<const double> row(const std::vector<double>& values, std::size_t objectives, std::size_t index) {
  return std::span<const double>(values).subspan(index * objectives, objectives);
}

TEST(Pareto, DominationNeedsOneBetterAndNoneWorse) {
  const std::vector<double> a = {1.0, 2.0}, b = {1.0, 3.0}, c = {0.0, 4.0}, undefined = {0.0, kNaN};
  EXPECT_TRUE(dominates(a, b));
  EXPECT_FALSE(dominates(b, a));
  EXPECT_FALSE(dominates(a, a));
  EXPECT_FALSE(dominates(a, c));
  EXPECT_FALSE(dominates(c, a));
  EXPECT_FALSE(dominates(undefined, a));
  EXPECT_FALSE(dominates(a, undefined));
}

TEST(Pareto, NonDominatedRowsAreThoseThatNoOtherDominates) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t objectives = 1 + trial % 4, count = trial % 37;
    const std::vector<double> values = random_rows(random, count, objectives);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < count; ++i) {
      bool beaten = false;
      for (std::size_t j = 0; j < count; ++j) {
        beaten = beaten || dominates(row(values, objectives, j), row(values, objectives, i));
      }
      if (!beaten) expected.push_back(i);
    }
    EXPECT_EQ(non_dominated(values, objectives), expected);
  }
}

TEST(Pareto, FirstFrontIsTheNonDominatedAndEachNextThatOfTheRest) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const std::size_t objectives = 1 + trial % 4, count = 1 + trial % 40;
    const std::vector<double> values = random_rows(random, count, objectives);
    std::vector<std::size_t> left(count);
    std::iota(left.begin(), left.end(), std::size_t{0});
    for (const std::vector<std::size_t>& front : pareto_fronts(values, objectives)) {
      std::vector<double> rest;
      for (const std::size_t i : left) {
        rest.insert(rest.end(), row(values, objectives, i).begin(), row(values, objectives, i).end());
      }
      std::vector<std::size_t> expected;
      for (const std::size_t i : non_dominated(rest, objectives)) expected.push_back(left[i]);
      EXPECT_EQ(front, expected);
      std::erase_if(left,
                    [&](std::size_t i) { return std::find(front.begin(), front.end(), i) != front.end(); });
    }
    EXPECT_TRUE(left.empty());
  }
}

TEST(Pareto, DuplicatesShareAFront) {
  const std::vector<double> values = {1, 5, 2, 3, 4, 1, 3, 4, 5, 5, 2, 3};
  const std::vector<std::vector<std::size_t>> expected = {{0, 1, 2, 5}, {3}, {4}};
  EXPECT_EQ(pareto_fronts(values, 2), expected);
}

TEST(Pareto, BrokenConstraintsComeAfterAllThatHoldByHowMuchTheyAreBroken) {
  const std::vector<double> values = {1, 1, 2, 2, 0, 0, 3, 1}, violations = {0, 0, 0.5, 0.1};
  const std::vector<std::vector<std::size_t>> expected = {{0}, {1}, {3}, {2}};
  EXPECT_EQ(pareto_fronts(values, 2, violations), expected);
}

TEST(Pareto, StandingCountsWhatIsUndefinedAndSumsWhatIsBroken) {
  const std::vector<double> good = {1.0, 2.0, -3.0, 0.0}, broken = {kNaN, kNaN, 0.25, 0.5},
                            unknown = {kNaN, kNaN, kNaN, 0.5}, failed = {1.0, kNaN, 0.0, -1.0};
  EXPECT_TRUE(standing(good, 2).feasible());
  EXPECT_EQ(standing(broken, 2).undefined, 0u);
  EXPECT_DOUBLE_EQ(standing(broken, 2).violation, 0.75);
  EXPECT_EQ(standing(unknown, 2).undefined, 1u);
  EXPECT_DOUBLE_EQ(standing(unknown, 2).violation, 0.5);
  EXPECT_EQ(standing(failed, 2).undefined, 1u);
  EXPECT_FALSE(standing(failed, 2).feasible());
}

// What lets algorithms without constraints search under constraint domination.
TEST(Pareto, PlainOrderOfTheImagesIsConstraintDomination) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> digit(0, 5), kind(0, 9);
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 400; ++i) {
    std::vector<double> outcomes(5);
    for (std::size_t k = 0; k < 3; ++k) outcomes[k] = digit(random) - 2.0;
    for (std::size_t k = 3; k < 5; ++k) {
      const int which = kind(random);
      outcomes[k] = which < 5 ? -digit(random) : which < 9 ? std::pow(10.0, 2 * digit(random) - 4) : kNaN;
    }
    if (kind(random) == 0) outcomes[1] = kNaN;
    rows.push_back(outcomes);
  }
  rows.push_back({1e35, 1.0, 1.0, 0.0, 0.0});        // a feasible design beyond all reason
  rows.push_back({0.0, 0.0, 0.0, 1e200, 0.0});       // and one that is not
  rows.push_back({0.0, 0.0, 0.0, kInfinity, kNaN});  // or worse
  int dominated = 0;
  for (const std::vector<double>& a : rows) {
    for (const std::vector<double>& b : rows) {
      std::vector<double> image_a(3), image_b(3);
      unconstrained_image(a, image_a);
      unconstrained_image(b, image_b);
      EXPECT_TRUE(std::isfinite(image_a[0]));
      EXPECT_EQ(dominates(image_a, image_b), constraint_dominates(a, b, 3));
      dominated += dominates(image_a, image_b) ? 1 : 0;
    }
  }
  EXPECT_GT(dominated, 40'000);
}

TEST(Pareto, CrowdingIsTheSumOfTheSidesOfTheBoxBetweenNeighbours) {
  const std::vector<double> values = {1, 5, 2, 3, 4, 1, 2.5, 2.5};
  const std::vector<double> distance = crowding_distances(values, 2);
  EXPECT_EQ(distance[0], kInfinity);
  EXPECT_NEAR(distance[1], 1.5 / 3.0 + 2.5 / 4.0, 1e-15);
  EXPECT_EQ(distance[2], kInfinity);
  EXPECT_NEAR(distance[3], 2.0 / 3.0 + 2.0 / 4.0, 1e-15);
}

TEST(Pareto, HypervolumeOfAFewBoxesIsThatByHand) {
  EXPECT_NEAR(hypervolume(std::vector<double>{1, 3, 2, 2, 3, 1}, std::vector<double>{4, 4}), 6.0, 1e-12);
  EXPECT_NEAR(hypervolume(std::vector<double>{1, 2, 3, 2, 1, 2, 3, 3, 1}, std::vector<double>{4, 4, 4}), 15.0,
              1e-12);
  EXPECT_NEAR(hypervolume(std::vector<double>{3, 1, 2}, std::vector<double>{4}), 3.0, 1e-15);
  EXPECT_EQ(hypervolume(std::vector<double>{}, std::vector<double>{4, 4}), 0.0);
  // Beyond the reference in one objective, or on it: nothing.
  EXPECT_EQ(hypervolume(std::vector<double>{1, 5, 4, 1}, std::vector<double>{4, 4}), 0.0);
}

TEST(Pareto, HypervolumeIsTheNumberOfUnitCellsThatARowDominates) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t objectives = 2 + trial % 3, count = 1 + trial % 12;
    const std::vector<double> values = random_rows(random, count, objectives);
    const std::vector<double> reference(objectives, 10.0);
    int cells = 0;
    std::vector<double> corner(objectives);  // lower corners of the cells of 0..10
    const int all = static_cast<int>(std::pow(10, objectives));
    for (int cell = 0; cell < all; ++cell) {
      int rest = cell;
      for (double& value : corner) {
        value = rest % 10;
        rest /= 10;
      }
      bool inside = false;
      for (std::size_t i = 0; i < count; ++i) {
        const auto point = row(values, objectives, i);
        inside = inside || std::equal(point.begin(), point.end(), corner.begin(), std::less_equal<>());
      }
      cells += inside ? 1 : 0;
    }
    EXPECT_NEAR(hypervolume(values, reference), cells, 1e-9 * all);
  }
}

TEST(Pareto, NormalisedRunsFromTheIdealToTheNadir) {
  const std::vector<double> values = {10, -1, 7, 30, -1, 5, 20, -1, 6};
  const std::vector<double> expected = {0, 0, 1, 1, 0, 0, 0.5, 0, 0.5};
  EXPECT_EQ(normalised(values, 3), expected);
}

// By hand from Gorgulu 2018, section 7.2: w* = 1 - omega_nn and m* = 1 - mu_vn of maximised omega and 1/mu are
// what minimised objectives give when normalised.
TEST(Pareto, WeightedRmsMovesTheChoiceFromOneEndToTheOther) {
  const std::vector<double> values = {0.0, 1.0, 0.2, 0.3, 0.5, 0.1, 1.0, 0.0};
  const auto choice = [&](double weight) {
    const std::vector<double> rms = weighted_rms(values, 2, std::vector<double>{1.0, weight});
    return std::min_element(rms.begin(), rms.end()) - rms.begin();
  };
  EXPECT_EQ(choice(0.0), 0);
  EXPECT_EQ(choice(1.0), 1);
  EXPECT_EQ(choice(25.0), 2);
  EXPECT_EQ(choice(1000.0), 3);
  const std::vector<double> rms = weighted_rms(values, 2, std::vector<double>{1.0, 0.5});
  EXPECT_NEAR(rms[1], std::sqrt((0.04 + 0.5 * 0.09) / 2.0), 1e-15);
}

TEST(Pareto, TopsisIsTheShareOfTheWayFromTheWorst) {
  const std::vector<double> closeness =
      topsis(std::vector<double>{1, 5, 2, 3, 4, 1}, 2, std::vector<double>{0.5, 0.5});
  EXPECT_NEAR(closeness[0], 0.49193338482966764, 1e-12);
  EXPECT_NEAR(closeness[1], 0.5784128280412533, 1e-12);
  EXPECT_NEAR(closeness[2], 0.5080666151703325, 1e-12);
}

TEST(Pareto, TopsisOfOneRowAndOfAWeightOfNothing) {
  EXPECT_EQ(topsis(std::vector<double>{3, 4}, 2, std::vector<double>{1, 1}), std::vector<double>{1.0});
  const std::vector<double> closeness = topsis(std::vector<double>{1, 9, 2, 0}, 2, std::vector<double>{1, 0});
  EXPECT_EQ(closeness[0], 1.0);
  EXPECT_EQ(closeness[1], 0.0);
}

TEST(Pareto, KneeIsFarthestFromTheLineOfTheEnds) {
  // f2 = (1 - sqrt f1)^2, whose distance from f1 + f2 = 1 is largest at f1 = 1/4.
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i) {
    const double f1 = 100.0 + i;  // another unit and place must not matter
    values.insert(values.end(), {f1, std::pow(1.0 - std::sqrt(i / 100.0), 2)});
  }
  EXPECT_EQ(knee(values, 2), 25u);
}

TEST(Pareto, KneeInThreeObjectivesIsFarthestFromTheirPlane) {
  // A part of the sphere about (1, 1, 1): the knee is on its diagonal, and a constant objective changes
  // nothing.
  std::vector<double> three, four;
  std::size_t diagonal = 0, count = 0;
  for (int i = 0; i <= 12; ++i) {
    for (int j = 0; i + j <= 12; ++j) {
      const double norm = std::sqrt(i * i + j * j + (12 - i - j) * (12 - i - j));
      const double p[3] = {1.0 - i / norm, 1.0 - j / norm, 1.0 - (12 - i - j) / norm};
      if (i == 4 && j == 4) diagonal = count;
      ++count;
      three.insert(three.end(), p, p + 3);
      four.insert(four.end(), {p[0], 7.0, p[1], p[2]});
    }
  }
  EXPECT_EQ(knee(three, 3), diagonal);
  EXPECT_EQ(knee(four, 4), diagonal);
}

TEST(Pareto, NoKneeOnALineOrInACorner) {
  EXPECT_FALSE(knee(std::vector<double>{0, 2, 1, 1, 2, 0}, 2));
  EXPECT_FALSE(knee(std::vector<double>{1, 2}, 2));
  EXPECT_FALSE(knee(std::vector<double>{}, 2));
  EXPECT_FALSE(knee(std::vector<double>{1, 2, 3}, 1));
}

}  // namespace
}  // namespace zwidth
