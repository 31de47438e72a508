#include "zwidth/math/elimination.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <random>

namespace zwidth {
namespace {

Eigen::MatrixXd random_matrix(std::mt19937_64& random, int rows, int columns) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

void fill(Elimination& elimination, const Eigen::MatrixXd& a) {
  elimination.resize(static_cast<int>(a.rows()), static_cast<int>(a.cols()));
  for (int c = 0; c < a.cols(); ++c) {
    for (int r = 0; r < a.rows(); ++r) elimination.at(r, c) = a(r, c);
  }
}

void run(Elimination& elimination) {
  while (elimination.step()) {
  }
  elimination.finish();
}

Eigen::MatrixXd inverse(const Elimination& elimination) {
  Eigen::MatrixXd x(elimination.columns(), elimination.rows());
  for (int c = 0; c < x.rows(); ++c) {
    for (int r = 0; r < x.cols(); ++r) x(c, r) = elimination.inverse(c)[r];
  }
  return x;
}

Eigen::MatrixXd left_over(const Elimination& elimination) {
  Eigen::MatrixXd n(elimination.rows(), elimination.rows() - elimination.rank());
  for (int i = 0; i < n.cols(); ++i) {
    for (int r = 0; r < n.rows(); ++r) n(r, i) = elimination.left_over(i)[r];
  }
  return n;
}

TEST(Elimination, KnowsHowItsColumnsAreOriented) {
  std::mt19937_64 random(52);
  for (int k = 0; k < 500; ++k) {
    const int rows = random() % 2 == 0 ? 3 : 6, columns = 1 + static_cast<int>(random() % 3);
    const Eigen::MatrixXd a = random_matrix(random, rows, columns);
    Elimination elimination;
    fill(elimination, a);
    run(elimination);
    Eigen::MatrixXd basis(rows, rows);
    for (int i = 0; i < columns; ++i)
      basis.col(i) = Eigen::Map<const Eigen::VectorXd>(elimination.range(i).data(), rows);
    basis.rightCols(rows - columns) = left_over(elimination);
    EXPECT_LT((basis.leftCols(columns) * basis.leftCols(columns).transpose() * a - a).norm(), 1e-14);
    // So that the determinant of [A N] has this sign whatever the basis of the rest is turned like.
    Eigen::MatrixXd whole(rows, rows);
    whole << a, left_over(elimination);
    EXPECT_GT(elimination.orientation() * whole.determinant(), 0.0);
  }
}

TEST(Elimination, OfAnyRankHasAnInverseForWhatActsAndABasisOfTheRest) {
  std::mt19937_64 random(51);
  for (int k = 0; k < 2000; ++k) {
    const int rows = random() % 2 == 0 ? 3 : 6, columns = static_cast<int>(random() % 9);
    const int rank = columns == 0 ? 0 : 1 + static_cast<int>(random() % std::min(rows, columns));
    const Eigen::MatrixXd a = random_matrix(random, rows, rank) * random_matrix(random, rank, columns);
    Elimination elimination;
    fill(elimination, a);
    run(elimination);
    ASSERT_EQ(elimination.rank(), rank);
    const Eigen::MatrixXd x = inverse(elimination), n = left_over(elimination);
    const double size = 1.0 + x.norm();
    EXPECT_LT((a * x * a - a).norm(), 1e-13 * size * (1.0 + a.norm() * a.norm()));
    // What a dependent column leaves is the rounding of its combination of the others.
    EXPECT_LT((n.transpose() * a).norm(), 1e-14 * size * (1.0 + a.norm()));
    EXPECT_LT((n.transpose() * n - Eigen::MatrixXd::Identity(n.cols(), n.cols())).norm(), 1e-14);
    EXPECT_LT((a * x + n * n.transpose() - Eigen::MatrixXd::Identity(rows, rows)).norm(), 1e-13 * size);
  }
}

TEST(Elimination, OfIndependentColumnsInvertsFromTheLeft) {
  std::mt19937_64 random(52);
  for (int k = 0; k < 500; ++k) {
    const int rows = random() % 2 == 0 ? 3 : 6, columns = 1 + static_cast<int>(random() % rows);
    const Eigen::MatrixXd a = random_matrix(random, rows, columns);
    Elimination elimination;
    fill(elimination, a);
    run(elimination);
    const Eigen::MatrixXd x = inverse(elimination);
    EXPECT_LT((x * a - Eigen::MatrixXd::Identity(columns, columns)).norm(), 1e-13 * (1.0 + x.norm()));
  }
}

TEST(Elimination, TellsAZeroColumnAndOneThatNearlyRepeatsAnother) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(6, 3);
  a.col(1) << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  a.col(2) = a.col(1);
  for (const auto& [apart, rank] : {std::pair(1e-13, 1), std::pair(1e-8, 2)}) {
    a(0, 2) = 1.0 + apart;
    Elimination elimination;
    fill(elimination, a);
    run(elimination);
    EXPECT_EQ(elimination.rank(), rank) << apart;
    EXPECT_EQ(inverse(elimination).row(0).norm(), 0.0);
    EXPECT_TRUE(inverse(elimination).allFinite());
  }
}

TEST(Elimination, StepsInTurnGiveWhatEachGivesAlone) {
  std::mt19937_64 random(53);
  std::array<Elimination, 3> together, alone;
  for (int e = 0; e < 3; ++e) {
    const Eigen::MatrixXd a = random_matrix(random, e == 0 ? 3 : 6, e + 2);
    fill(together[e], a);
    fill(alone[e], a);
    run(alone[e]);
  }
  for (bool more = true; more;) {
    more = false;
    for (Elimination& one : together) more |= one.step();
  }
  for (int e = 0; e < 3; ++e) {
    together[e].finish();
    EXPECT_EQ(inverse(together[e]), inverse(alone[e]));
    EXPECT_EQ(left_over(together[e]), left_over(alone[e]));
  }
}

TEST(Elimination, ProductsOfLanesAreThoseOfNumbers) {
  std::mt19937_64 random(54);
  for (const int rows : {3, 6}) {
    Elimination elimination;
    fill(elimination, random_matrix(random, rows, 2));
    run(elimination);
    const Eigen::MatrixXd b = random_matrix(random, 6, kLanes);
    std::array<Lanes, 6> lanes;
    for (int r = 0; r < 6; ++r) {
      for (int lane = 0; lane < kLanes; ++lane) lanes[r][lane] = b(r, lane);
    }
    Lanes sum;
    elimination.product(elimination.inverse(1), lanes, sum);
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_NEAR(sum[lane], inverse(elimination).row(1).dot(b.col(lane).head(rows)), 1e-14);
    }
  }
}

}  // namespace
}  // namespace zwidth
