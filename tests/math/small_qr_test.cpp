#include "zwidth/math/small_qr.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <random>

#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

Eigen::MatrixXd random_matrix(std::mt19937_64& random, int rows, int columns) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

template <class Qr>
void fill(Qr& qr, const Eigen::MatrixXd& a) {
  qr.resize(static_cast<int>(a.rows()), static_cast<int>(a.cols()));
  for (int c = 0; c < a.cols(); ++c) {
    for (int r = 0; r < a.rows(); ++r) qr.at(r, c) = a(r, c);
  }
  qr.factor();
}

TEST(SmallQr, LeavesAResidualAcrossTheColumns) {
  std::mt19937_64 random(41);
  for (int k = 0; k < 500; ++k) {
    const int columns = 1 + static_cast<int>(random() % 6), rows = columns + static_cast<int>(random() % 4);
    const Eigen::MatrixXd a = random_matrix(random, rows, columns);
    Eigen::VectorXd b = random_matrix(random, rows, 1), x(columns), y = b;
    SmallQr<9, 6> qr;
    fill(qr, a);
    qr.apply_q_transposed(y);
    qr.back_substitute(y, x);
    EXPECT_LT((a.transpose() * (a * x - b)).norm(), 1e-14 * (1.0 + 10.0 * x.norm()));  // rounding of A x
    EXPECT_NEAR(y.tail(rows - columns).norm(), (a * x - b).norm(), 1e-12);
  }
}

TEST(SmallQr, SolveTransposedIsTheShortestSolution) {
  std::mt19937_64 random(42);
  for (int k = 0; k < 500; ++k) {
    const int columns = 1 + static_cast<int>(random() % 5), rows = columns + 1 + static_cast<int>(random() % 3);
    const Eigen::MatrixXd a = random_matrix(random, rows, columns);  // A^T x = b has many solutions
    const Eigen::VectorXd b = random_matrix(random, columns, 1);
    Eigen::VectorXd x(rows);
    SmallQr<8, 6> qr;
    fill(qr, a);
    qr.solve_transposed(b, x);
    EXPECT_LT((a.transpose() * x - b).norm(), 1e-12);
    const Eigen::VectorXd shortest = a * (a.transpose() * a).llt().solve(b);
    EXPECT_LT((x - shortest).norm(), 1e-9 * (1.0 + shortest.norm()));
  }
}

TEST(SmallQr, FindsTheRankAndStillMeetsConsistentEquations) {
  std::mt19937_64 random(43);
  for (int k = 0; k < 300; ++k) {
    const int rank = 1 + static_cast<int>(random() % 3);
    const Eigen::MatrixXd a = random_matrix(random, 6, rank) * random_matrix(random, rank, 4);
    const Eigen::VectorXd b = a * random_matrix(random, 4, 1);
    Eigen::VectorXd x(4), y = b;
    SmallQr<6, 4> qr;
    fill(qr, a);
    EXPECT_EQ(qr.rank(), rank);
    EXPECT_EQ(qr.reciprocal_condition(), 0.0);
    qr.apply_q_transposed(y);
    qr.back_substitute(y, x);
    EXPECT_LT((a * x - b).norm(), 1e-12);
  }
}

TEST(SmallQr, KnowsTheSignOfTheDeterminant) {
  std::mt19937_64 random(46);
  for (int k = 0; k < 500; ++k) {
    const int size = 1 + static_cast<int>(random() % 4);
    const Eigen::MatrixXd a = random_matrix(random, size, size);
    SmallQr<6, 4> qr;
    fill(qr, a);
    EXPECT_GT(qr.determinant_sign() * a.determinant(), 0.0) << a;
    fill(qr, random_matrix(random, size + 1, size));
    EXPECT_EQ(qr.determinant_sign(), 0.0);
  }
}

TEST(SmallQr, OfNoColumnsHasConditionOne) {
  SmallQr<6, 4> qr;
  fill(qr, Eigen::MatrixXd(6, 0));
  EXPECT_EQ(qr.rank(), 0);
  EXPECT_EQ(qr.reciprocal_condition(), 1.0);
}

TEST(Svd, MultipliesBackToTheMatrix) {
  std::mt19937_64 random(44);
  for (int k = 0; k < 100; ++k) {
    const int rows = 1 + static_cast<int>(random() % 8), columns = 1 + static_cast<int>(random() % 8);
    const SmallMatrix a = random_matrix(random, rows, columns);
    const Svd parts = svd(a);
    const auto middle = parts.sigma.size();
    const Eigen::MatrixXd back =
        parts.u.leftCols(middle) * parts.sigma.asDiagonal() * parts.v.leftCols(middle).transpose();
    EXPECT_LT((back - a).norm(), 1e-13);
    EXPECT_TRUE(std::is_sorted(parts.sigma.data(), parts.sigma.data() + middle, std::greater<>()));
  }
}

TEST(PseudoInverse, HasThePropertiesOfPenrose) {
  std::mt19937_64 random(45);
  for (int k = 0; k < 100; ++k) {
    const int rank = 1 + static_cast<int>(random() % 4);
    const SmallMatrix a = random_matrix(random, 6, rank) * random_matrix(random, rank, 5),
                      x = pseudo_inverse(a);
    EXPECT_LT((a * x * a - a).norm(), 1e-10);
    EXPECT_LT((x * a * x - x).norm(), 1e-8 * (1.0 + x.norm()));
    EXPECT_LT((a * x - (a * x).transpose()).norm(), 1e-9);
    EXPECT_LT((x * a - (x * a).transpose()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace zwidth
