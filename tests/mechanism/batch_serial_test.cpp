#include "zwidth/mechanism/batch_serial.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <vector>

#include "support/arms.h"
#include "support/storm.h"

namespace zwidth {
namespace {

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

struct Postures {
  Postures(std::mt19937_64& random, int joints, int n)
      : count(n), values(joints * n), x(n), y(n), z(n), m(n), k(n) {
    for (double& v : values) v = test::arm_uniform(random, -3.0, 3.0);
  }
  ActiveVector joints(int p) const {
    ActiveVector q(static_cast<Eigen::Index>(values.size()) / count);
    for (int j = 0; j < q.size(); ++j) q[j] = values[j * count + p];
    return q;
  }
  int count;
  std::vector<double> values, x, y, z, m, k;
};

TEST(SerialBatch, PositionsAreThoseOfOnePosture) {
  on_every_target([] {
    std::mt19937_64 random(1);
    for (int n = 0; n < 60; ++n) {
      const SerialDescription arm = test::random_arm(random, 1 + n % kMaxActive);
      const SerialChain chain(arm);
      Postures all(random, chain.joint_count(), 1 + n);
      SerialBatch(chain).positions(all.values, all.x, all.y, all.z);
      for (int p = 0; p < all.count; ++p) {
        EXPECT_LT((chain.pose(all.joints(p)).position - Vector3(all.x[p], all.y[p], all.z[p])).norm(), 2e-14);
      }
    }
  });
}

TEST(SerialBatch, DexterityIsThatOfTheSingularValues) {
  on_every_target([] {
    std::mt19937_64 random(2);
    for (int n = 0; n < 40; ++n) {
      const SerialDescription arm = test::random_arm(random, 6 + n % 3);
      const SerialChain chain(arm);
      const double length = test::arm_uniform(random, 0.1, 0.6);
      for (const auto rows : {SerialBatch::Rows::position, SerialBatch::Rows::pose}) {
        Postures all(random, chain.joint_count(), 13);
        SerialBatch(chain).dexterity(all.values, rows, length, all.x, all.y, all.z, all.m, all.k);
        std::vector<double> alone(all.count);
        SerialBatch(chain).dexterity(all.values, rows, length, all.x, all.y, all.z, alone, {});
        for (int p = 0; p < all.count; ++p) {
          const SerialForward one = chain.forward(all.joints(p));
          Eigen::MatrixXd J = one.jacobian;
          J.bottomRows(3) *= length;
          if (rows == SerialBatch::Rows::position) J = one.jacobian.topRows(3);
          const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
          const double condition = sigma[0] / sigma[sigma.size() - 1];
          if (condition > 1e4) continue;
          // det(J J^T) squares the condition number, the square root halves the error again.
          const double relative = 1e-15 * condition * condition + 1e-14;
          EXPECT_NEAR(all.m[p], sigma.prod(), sigma.prod() * relative);
          EXPECT_EQ(alone[p], all.m[p]);
          const double frobenius = static_cast<double>(J.rows()) /
                                   std::sqrt(sigma.squaredNorm() * sigma.cwiseInverse().squaredNorm());
          EXPECT_NEAR(all.k[p], frobenius, frobenius * relative);
          EXPECT_LT((one.tool.position - Vector3(all.x[p], all.y[p], all.z[p])).norm(), 2e-14);
        }
      }
    }
  });
}

TEST(SerialBatch, ASingularPostureHasNoDexterityAndNoNonsense) {
  const SerialChain chain(test::seven_dof());
  const SerialBatch batch(chain);
  std::vector<double> q = {0.1, 0.7, 0.2, 0.0, 0.3, 0.9, 0.4}, x(1), y(1), z(1), m(1), k(1);  // stretched
  batch.dexterity(q, SerialBatch::Rows::pose, 0.25, x, y, z, m, k);
  EXPECT_LT(m[0], 1e-9);
  EXPECT_GE(m[0], 0.0);
  EXPECT_LT(k[0], 1e-6);
  EXPECT_GE(k[0], 0.0);
  std::mt19937_64 random(3);
  const SerialBatch few(SerialChain(test::random_arm(random, 2)));
  std::vector<double> two = {0.3, 0.4};
  few.dexterity(two, SerialBatch::Rows::position, 1.0, x, y, z, m, k);
  EXPECT_EQ(m[0], 0.0);
  EXPECT_EQ(k[0], 0.0);
}

}  // namespace
}  // namespace zwidth
