#include "zwidth/mechanism/vibration.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"

namespace zwidth {
namespace {

ToolMatrix random_positive(std::mt19937_64& random, int n, double size) {
  ToolMatrix A(n, n);
  for (double& value : A.reshaped()) value = test::uniform(random, -1.0, 1.0);
  return size * (A * A.transpose() + 0.1 * ToolMatrix::Identity(n, n));
}

TEST(Modes, SolveTheEquationOfMotion) {
  std::mt19937_64 random(31);
  for (int i = 0; i < 100; ++i) {
    const int n = 1 + i % 6;
    const ToolMatrix K = random_positive(random, n, 1e5), M = random_positive(random, n, 0.1);
    const Modes found = *modes(K, M);
    for (int m = 0; m < n; ++m) {
      const ToolVector phi = found.shapes.col(m);
      const double omega2 = std::pow(found.frequencies[m], 2);
      EXPECT_LT((K * phi - omega2 * M * phi).norm(), 1e-8 * K.norm());
      EXPECT_NEAR(phi.norm(), 1.0, 1e-12);
      EXPECT_GT(phi.maxCoeff(), -phi.minCoeff() - 1e-12);
      EXPECT_GE(found.frequencies[m], m > 0 ? found.frequencies[m - 1] : 0.0);
    }
  }
}

TEST(Modes, OfOneMassOnASpring) {
  const ToolMatrix k = ToolMatrix::Constant(1, 1, 1000.0), m = ToolMatrix::Constant(1, 1, 0.1);
  EXPECT_NEAR(modes(k, m)->frequencies[0], 100.0, 1e-10);
}

TEST(Modes, OfTwoMassesOnASpringAreThoseOfBothMobilities) {
  // Tool and rotors as 2 n freedoms: what is left beside n rigid motions is (W1 + W2) K.
  std::mt19937_64 random(32);
  const ToolMatrix K = random_positive(random, 3, 1e5), M1 = random_positive(random, 3, 0.1),
                   M2 = random_positive(random, 3, 0.3);
  Matrix6 stiffness, mass = Matrix6::Zero();
  stiffness << K, -K, -K, K;
  mass.topLeftCorner<3, 3>() = M1;
  mass.bottomRightCorner<3, 3>() = M2;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> both(stiffness, mass);
  const Modes found = *modes_by_mobility(K, ToolMatrix(M1.inverse() + M2.inverse()));
  for (int m = 0; m < 3; ++m) {
    EXPECT_LT(std::abs(both.eigenvalues()[m]), 1e-6 * both.eigenvalues()[5]);
    EXPECT_NEAR(found.frequencies[m] / std::sqrt(both.eigenvalues()[3 + m]), 1.0, 1e-10);
  }
}

TEST(Modes, RefuseWhatIsNoStiffnessAndNoMass) {
  const ToolMatrix good = ToolMatrix::Identity(2, 2);
  ToolMatrix skew = good, negative = good;
  skew(0, 1) = 0.5;
  negative(1, 1) = -1.0;
  EXPECT_TRUE(modes(good, good));
  EXPECT_FALSE(modes(skew, good));
  EXPECT_FALSE(modes(good, negative));
  EXPECT_FALSE(modes(negative, good));
  EXPECT_FALSE(modes(good, ToolMatrix::Identity(3, 3)));
  EXPECT_FALSE(modes_by_mobility(good, negative));
  // What no torque can move vibrates at no frequency.
  ToolMatrix stuck = good;
  stuck(1, 1) = 0.0;
  EXPECT_EQ(modes_by_mobility(good, stuck)->frequencies[0], 0.0);
}

}  // namespace
}  // namespace zwidth
