#include "zwidth/analysis/dexterity.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "support/small_arms.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Jacobian random_jacobian(std::mt19937_64& random, int joints) {
  Jacobian J(6, joints);
  for (int j = 0; j < joints; ++j) {
    for (int i = 0; i < 6; ++i) J(i, j) = uniform(random, -1.0, 1.0) * (i < 3 ? 0.2 : 1.0);
  }
  return J;
}

double condition_at(const Jacobian& J, const JacobianUnits& units, double length) {
  return dexterity(homogeneous(J, units, length)).condition_number;
}

TEST(CharacteristicLength, NoOtherLengthIsBetter) {
  std::mt19937_64 random(61);
  for (int round = 0; round < 40; ++round) {
    const Jacobian J = random_jacobian(random, 6 + round % 3);
    JacobianUnits units;
    if (round % 4 == 3) units.sliding_joints = 1U << (round % 6);
    const CharacteristicLength best = characteristic_length(J, units);
    EXPECT_NEAR(best.condition_number, condition_at(J, units, best.length), 1e-9 * best.condition_number);
    for (double power = -4.0; power <= 3.0; power += 0.01) {
      EXPECT_LE(best.condition_number, condition_at(J, units, std::pow(10.0, power)) * (1.0 + 1e-9));
    }
  }
}

TEST(CharacteristicLength, GrowsWithTheDevice) {
  std::mt19937_64 random(62);
  const Jacobian J = random_jacobian(random, 7);
  Jacobian larger = J;
  larger.topRows(3) *= 3.7;
  const CharacteristicLength a = characteristic_length(J, {}), b = characteristic_length(larger, {});
  EXPECT_NEAR(b.length / a.length, 3.7, 1e-6);
  EXPECT_NEAR(b.condition_number, a.condition_number, 1e-9 * a.condition_number);
}

TEST(CharacteristicLength, OfOneKindOfRowsChangesNothing) {
  std::mt19937_64 random(63);
  const Jacobian J = random_jacobian(random, 6).topRows(3);
  EXPECT_NEAR(characteristic_length(J, {}).condition_number, dexterity(J).condition_number, 1e-12);
  EXPECT_EQ(characteristic_length(J, {}).length, 1.0);
  const Jacobian singular = Jacobian::Zero(6, 6);
  EXPECT_EQ(characteristic_length(singular, {}).conditioning, 0.0);
}

TEST(CharacteristicLength, OfManyPosturesMakesTheMeanLargest) {
  std::mt19937_64 random(64);
  std::vector<Jacobian> postures;
  for (int k = 0; k < 20; ++k) postures.push_back(random_jacobian(random, 6));
  const CharacteristicLength best = characteristic_length(postures, {});
  for (double power = -4.0; power <= 2.0; power += 0.02) {
    double mean = 0.0;
    for (const Jacobian& J : postures) mean += 1.0 / condition_at(J, {}, std::pow(10.0, power)) / 20.0;
    EXPECT_LE(mean, best.conditioning + 1e-9);
  }
}

// One definition for maps, data sheets and single postures, over every device that a lattice covers.
TEST(JacobianScale, OfAMapIsThatOfEveryPosture) {
  int mixed = 0;
  const auto agrees = [&](const Description& description) {
    const Mechanism whole(description), mechanism(without_free_joints(description));
    if (workspace_obstacle(mechanism)) return;
    const JacobianScale scale = jacobian_scale(whole);
    mixed += scale.mixed ? 1 : 0;
    const double size = workspace_extents(mechanism).size().maxCoeff();
    const WorkspaceMap map = map_workspace(mechanism, {.spacing = size / 9.3});
    ASSERT_FALSE(map.positions.empty()) << mechanism.name();
    for (std::size_t p = 0; p < map.positions.size(); p += 1 + map.positions.size() / 40) {
      const double K = figure(map.figures[p], Figure::condition_number);
      // The map has one of the postures that an arm reaches the place by.
      double nearest = std::numeric_limits<double>::infinity();
      for (const Solution& solution : solve_inverse_all(mechanism, {.position = map.positions[p]})) {
        if (!solution) continue;
        const double other = scale.condition_number(jacobian(*solution.posture));
        nearest = std::min(nearest, std::abs(other / K - 1.0));
      }
      EXPECT_LT(nearest, 1e-7) << mechanism.name() << " " << map.positions[p].transpose();
    }
  };
  const Catalogue catalogue = Catalogue::load();
  for (const BuiltinFile& device : catalogue.devices()) agrees(read_description(device.name, {}, catalogue));
  Description arm = test::cylindrical_arm(0.22, 0.18);
  std::get<SerialDescription>(arm.mechanism).platform = PlatformFreedom::point;
  agrees(arm);
  EXPECT_GE(mixed, 2);
}

TEST(JacobianScale, ToolsWithFewFreedomsAreJudgedByThose) {
  // A SCARA: three translations and a turn of six components.
  Description arm =
      test::arm_description({test::turning("one", 0.3, 0.2, 0.0, {-90.0, 90.0}),
                             test::turning("two", 0.0, 0.15, 0.0, {20.0, 120.0}),
                             {.name = "lift", .type = SerialJointType::prismatic, .range = {-0.1, 0.0}},
                             test::turning("twist", 0.0, 0.0, 0.0, {-150.0, 150.0})});
  const Mechanism mechanism(arm);
  const JacobianScale scale = jacobian_scale(mechanism);
  const Solution solution = solve_forward(mechanism, Eigen::Vector4d(0.2, 1.0, -0.05, 0.3));
  const Jacobian J = jacobian(*solution.posture);
  ASSERT_EQ(J.rows(), 6);
  const Eigen::VectorXd sigma =
      Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(scale.homogeneous(J))).singularValues();
  EXPECT_NEAR(scale.condition_number(J) / (sigma[0] / sigma[3]), 1.0, 1e-9);
  EXPECT_TRUE(std::isinf(scale.rows_condition_number(J.bottomRows(3))));
  EXPECT_LT(scale.rows_condition_number(J.topRows(3)), 100.0);
}

TEST(JacobianScale, GrowsWithTheDevice) {
  Description small = test::cylindrical_arm(0.22, 0.18), large = test::cylindrical_arm(0.44, 0.36);
  for (Description* arm : {&small, &large}) {
    auto& serial = std::get<SerialDescription>(arm->mechanism);
    serial.platform = PlatformFreedom::point;
    if (arm == &small) continue;
    for (auto& joint : serial.joints) {
      if (joint.type == SerialJointType::prismatic)
        joint.range = {2.0 * joint.range.min, 2.0 * joint.range.max};
    }
  }
  const JacobianScale one = jacobian_scale(Mechanism(small)), two = jacobian_scale(Mechanism(large));
  ASSERT_TRUE(one.mixed);
  EXPECT_NEAR(two.length / one.length, 2.0, 1e-6);
}

TEST(Homogeneous, MultipliesAngularRows) {
  Jacobian J(6, 6);
  J << 0.1, 0, 0, 0, 0.02, 0, 0, 0.12, 0, -0.02, 0, 0, 0, 0, 0.09, 0, 0, 0.01, 0, 0.5, 0, 1, 0, 0, 0.4, 0, 0, 0,
      1, 0, 0, 0, 0.3, 0, 0, 1;
  EXPECT_NEAR(condition_at(J, {}, 0.1), 1.8931074441034212, 1e-9);
}

TEST(Isotropy, IsOneForEqualSingularValuesOnly) {
  std::mt19937_64 random(65);
  const double l1 = std::sqrt(2.0), q2 = 3.0 * std::atan(1.0);
  Jacobian arm(2, 2);  // isotropic: l1 = sqrt(2) l2 at 135 degrees (Salisbury & Craig 1982)
  arm << -std::sin(q2), -std::sin(q2), l1 + std::cos(q2), std::cos(q2);
  EXPECT_NEAR(isotropy(arm), 1.0, 1e-12);
  EXPECT_NEAR(dexterity(arm).condition_number, 1.0, 1e-12);
  for (int round = 0; round < 50; ++round) {
    const Jacobian J = random_jacobian(random, 6).topRows(3);
    const double figure = isotropy(J);
    EXPECT_GT(figure, 0.0);
    EXPECT_LT(figure, 1.0);
    const Matrix3 A = J * J.transpose();
    EXPECT_NEAR(figure, std::cbrt(A.determinant()) / (A.trace() / 3.0), 1e-9);
  }
  EXPECT_EQ(isotropy(Jacobian::Zero(3, 3)), 0.0);
  EXPECT_NEAR(isotropy(Jacobian::Ones(3, 2)), 0.0, 1e-15);
  // With fewer joints than rows of the motions that there are.
  EXPECT_NEAR(isotropy(Jacobian::Identity(3, 2)), 1.0, 1e-15);
}

TEST(GlobalConditioning, OfATwoJointArmBySamplesOfItsJoints) {
  // 1/K depends on q2 alone and the area element on |sin q2|: 0.43604330568173477 for l1 = sqrt(2), l2 = 1.
  GlobalConditioning whole, left, right;
  const int steps = 20000;
  for (int k = 0; k < steps; ++k) {
    const double q2 = 3.14159265358979323846 * (k + 0.5) / steps;
    Jacobian J(2, 2);
    J << -std::sin(q2), -std::sin(q2), std::sqrt(2.0) + std::cos(q2), std::cos(q2);
    const double number = dexterity(J).condition_number;
    whole.add(number, task_volume(J));
    (k < 7000 ? left : right).add(number, task_volume(J));
  }
  EXPECT_NEAR(whole.index(), 0.43604330568173477, 1e-6);
  left.add(right);
  EXPECT_NEAR(left.index(), whole.index(), 1e-12);
  EXPECT_NEAR(left.spread(), whole.spread(), 1e-9);
  EXPECT_EQ(left.worst(), whole.worst());
}

TEST(GlobalConditioning, CountsSingularSamplesAsZero) {
  GlobalConditioning figure;
  EXPECT_EQ(figure.index(), 0.0);
  figure.add(2.0);
  figure.add(std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(figure.index(), 0.25);
  EXPECT_EQ(figure.worst(), 0.0);
  EXPECT_EQ(figure.best(), 0.5);
  EXPECT_DOUBLE_EQ(figure.spread(), 0.25);
}

TEST(GlobalConditioning, SaysHowMuchIsNearIsotropic) {
  GlobalConditioning one, two;
  one.add(1.0, 2.0);
  one.add(1.99, 1.0);
  two.add(2.0, 3.0);  // not below the limit
  two.add(std::numeric_limits<double>::infinity(), 2.0);
  EXPECT_DOUBLE_EQ(one.near_isotropic(), 1.0);
  EXPECT_DOUBLE_EQ(two.near_isotropic(), 0.0);
  one.add(two);
  EXPECT_DOUBLE_EQ(one.near_isotropic(), 3.0 / 8.0);
  EXPECT_EQ(GlobalConditioning().near_isotropic(), 0.0);
}

TEST(ConditionClass, HasTheLimitsOfItsSource) {
  EXPECT_EQ(condition_class(4.999), ConditionClass::below_5);
  EXPECT_EQ(condition_class(5.0), ConditionClass::from_5_to_10);
  EXPECT_EQ(condition_class(10.0), ConditionClass::from_5_to_10);
  EXPECT_EQ(condition_class(10.001), ConditionClass::from_10_to_100);
  EXPECT_EQ(condition_class(100.0), ConditionClass::from_10_to_100);
  EXPECT_EQ(condition_class(std::numeric_limits<double>::infinity()), ConditionClass::above_100);
}

}  // namespace
}  // namespace zwidth
