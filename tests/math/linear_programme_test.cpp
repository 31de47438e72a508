#include "zwidth/math/linear_programme.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "support/allocation_counter.h"
#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

LinearProgramme empty(int rows, int variables) {
  LinearProgramme p;
  p.rows.setZero(rows, variables);
  p.lower.setZero(rows);
  p.upper.setZero(rows);
  p.objective.setZero(variables);
  return p;
}

// The best corner, by solving every choice of rows at every choice of their bounds; -infinity if there is none.
double best_corner(const LinearProgramme& p) {
  const int m = static_cast<int>(p.rows.rows()), n = static_cast<int>(p.rows.cols());
  double best = -kInfinity;
  for (unsigned chosen = 0; chosen < 1U << m; ++chosen) {
    if (__builtin_popcount(chosen) != n) continue;
    for (unsigned side = 0; side < 1U << n; ++side) {
      Eigen::MatrixXd A(n, n);
      Eigen::VectorXd b(n);
      int k = 0;
      for (int i = 0; i < m; ++i) {
        if ((chosen >> i & 1U) == 0) continue;
        A.row(k) = p.rows.row(i);
        b[k] = (side >> k & 1U) != 0 ? p.upper[i] : p.lower[i];
        ++k;
      }
      const Eigen::FullPivLU<Eigen::MatrixXd> lu(A);
      if (!lu.isInvertible() || !b.allFinite()) continue;
      const Eigen::VectorXd x = lu.solve(b);
      const Eigen::VectorXd value = p.rows * x;
      const double slack = 1e-9 * (1.0 + b.cwiseAbs().maxCoeff() + value.cwiseAbs().maxCoeff());
      if (((value - p.lower).array() < -slack).any() || ((p.upper - value).array() < -slack).any()) continue;
      best = std::max(best, p.objective.dot(x));
    }
  }
  return best;
}

void expect_keeps(const LinearProgramme& p, const LinearProgramme::Point& x, double size) {
  const LinearProgramme::Bounds value = p.rows * x;
  for (int i = 0; i < value.size(); ++i) {
    EXPECT_GE(value[i], p.lower[i] - 1e-8 * size);
    EXPECT_LE(value[i], p.upper[i] + 1e-8 * size);
  }
}

TEST(LinearProgramme, FindsTheBestCornerOfRandomSlabs) {
  std::mt19937_64 random(31);
  int optimal = 0, infeasible = 0;
  for (int round = 0; round < test::storm_size(3000); ++round) {
    const int n = 1 + round % 4, m = n + round % 5;
    LinearProgramme p = empty(m, n);
    const bool coarse = round % 3 == 0;  // small whole numbers make corners of many planes
    for (int i = 0; i < m; ++i) {
      for (int k = 0; k < n; ++k)
        p.rows(i, k) = coarse ? std::floor(uniform(random, -2, 3)) : uniform(random, -1, 1);
      p.lower[i] = coarse ? std::floor(uniform(random, -3, 2)) : uniform(random, -1, 0.3);
      p.upper[i] = p.lower[i] + (coarse ? std::floor(uniform(random, 0, 4)) : uniform(random, 0, 1));
    }
    for (int k = 0; k < n; ++k)
      p.objective[k] = coarse ? std::floor(uniform(random, -2, 3)) : uniform(random, -1, 1);
    const ProgrammeSolution solution = maximise(p);
    ASSERT_NE(solution.status, ProgrammeStatus::stalled) << round;
    const double corner = best_corner(p);
    if (solution.status == ProgrammeStatus::optimal) {
      ++optimal;
      expect_keeps(p, solution.point, 3.0);
      if (std::isfinite(corner)) {
        EXPECT_NEAR(solution.value, corner, 1e-7 * (1.0 + std::abs(corner))) << round;
      }
      // The multipliers prove it: c = A^T y, and y . bound is the value.
      EXPECT_LT((p.rows.transpose() * solution.multipliers - p.objective).norm(), 1e-8) << round;
      double dual = 0.0;
      for (int i = 0; i < m; ++i) {
        const double y = solution.multipliers[i];
        if (y != 0.0) dual += y * (y > 0.0 ? p.upper[i] : p.lower[i]);
      }
      EXPECT_NEAR(dual, solution.value, 1e-7 * (1.0 + std::abs(dual))) << round;
    } else if (solution.status == ProgrammeStatus::infeasible) {
      ++infeasible;
      EXPECT_EQ(corner, -kInfinity) << round;
    } else {
      EXPECT_LT(Eigen::FullPivLU<Eigen::MatrixXd>(p.rows).rank(), n) << round;
    }
  }
  EXPECT_GT(optimal, 500);
  EXPECT_GT(infeasible, 100);
}

TEST(LinearProgramme, SaysWhenThereIsNoEndOrNoPoint) {
  LinearProgramme p = empty(1, 2);
  p.rows << 1.0, 0.0;
  p.lower << -1.0;
  p.upper << 2.0;
  p.objective << 1.0, 0.0;
  const ProgrammeSolution solution = maximise(p);
  EXPECT_EQ(solution.status, ProgrammeStatus::optimal);
  EXPECT_NEAR(solution.value, 2.0, 1e-12);
  EXPECT_NEAR(solution.multipliers[0], 1.0, 1e-12);
  p.objective << 1.0, 1e-3;
  EXPECT_EQ(maximise(p).status, ProgrammeStatus::unbounded);
  p.lower << 1.0;
  p.rows.setZero();
  EXPECT_EQ(maximise(p).status, ProgrammeStatus::infeasible);
  p.upper << kInfinity;
  p.lower << -kInfinity;
  EXPECT_EQ(maximise(p).status, ProgrammeStatus::unbounded);
  p.objective.setZero();
  EXPECT_EQ(maximise(p).status, ProgrammeStatus::optimal);
}

TEST(LinearProgramme, ScalesOfRowsAndVariablesDoNotMatter) {
  std::mt19937_64 random(33);
  for (int round = 0; round < 200; ++round) {
    LinearProgramme p = empty(7, 4);
    for (int i = 0; i < 7; ++i) {
      for (int k = 0; k < 4; ++k) p.rows(i, k) = uniform(random, -1, 1);
      p.lower[i] = uniform(random, -1, 0.1);
      p.upper[i] = p.lower[i] + uniform(random, 0.2, 1);
    }
    for (int k = 0; k < 4; ++k) p.objective[k] = uniform(random, -1, 1);
    const ProgrammeSolution before = maximise(p);
    LinearProgramme q = p;
    for (int k = 0; k < 4; ++k) {
      const double factor = std::pow(10.0, uniform(random, -4, 4));
      q.rows.col(k) *= factor;
      q.objective[k] *= factor;
    }
    for (int i = 0; i < 7; ++i) {
      const double factor = std::pow(10.0, uniform(random, -4, 4));
      q.rows.row(i) *= factor;
      q.lower[i] *= factor;
      q.upper[i] *= factor;
    }
    const ProgrammeSolution after = maximise(q);
    ASSERT_EQ(before.status, after.status) << round;
    if (before.status == ProgrammeStatus::optimal) {
      EXPECT_NEAR(before.value, after.value, 1e-8) << round;
    }
  }
}

TEST(LinearProgramme, DoesNotTouchTheHeap) {
  LinearProgramme p = empty(8, 4);
  std::mt19937_64 random(34);
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 4; ++k) p.rows(i, k) = uniform(random, -1, 1);
    p.lower[i] = 0.1;
    p.upper[i] = 1.0;
  }
  p.objective.setOnes();
  const long before = test::allocations();
  const ProgrammeSolution solution = maximise(p);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_NE(solution.status, ProgrammeStatus::stalled);
  static_assert(noexcept(maximise(p)));
}

}  // namespace
}  // namespace zwidth
