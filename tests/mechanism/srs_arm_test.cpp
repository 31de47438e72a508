#include "zwidth/mechanism/srs_arm.h"

#include <Eigen/SVD>
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "support/storm.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
const SrsLengths kPublished{.upper_arm = 0.25, .forearm = 0.25};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
SrsAngles random_angles(std::mt19937_64& random) {
  SrsAngles theta;
  for (double& t : theta) t = uniform(random, -kPi, kPi);
  return theta;
}
SrsLengths random_lengths(std::mt19937_64& random) {
  return {uniform(random, 0.05, 0.6), uniform(random, 0.05, 0.6)};
}

Matrix3 Ry(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitY()).toRotationMatrix();
}
Matrix3 Rz(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
}

double gap(const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).cwiseAbs().maxCoeff(),
                  (a.rotation - b.rotation).cwiseAbs().maxCoeff());
}
double apart(const SrsAngles& a, const SrsAngles& b) {
  double worst = 0.0;
  for (int i = 0; i < 7; ++i) worst = std::max(worst, std::abs(std::remainder(a[i] - b[i], 2.0 * kPi)));
  return worst;
}
// Away from all places where a parameterisation or the arm itself is singular.
bool regular(const SrsAngles& theta) {
  return std::abs(std::sin(theta[3])) > 0.03 && std::abs(std::sin(theta[1])) > 0.03 &&
         std::abs(std::cos(theta[2])) > 0.03 && std::abs(std::sin(theta[5])) > 0.03;
}

TEST(SrsForward, IsTheProductOfTheSourcesRotations) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 2000; ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles t = random_angles(random);
    const Matrix3 C02 = Rz(t[0]) * Ry(t[1]), C04 = C02 * Rz(t[2]) * Ry(t[3]);
    const Pose expected{.position = lengths.upper_arm * C02.col(2) + lengths.forearm * C04.col(2),
                        .rotation = C04 * Rz(t[4]) * Ry(t[5]) * Rz(t[6])};
    EXPECT_LT(gap(srs_forward(lengths, t).wrist, expected), 1e-14);
  }
}

TEST(SrsForward, EqualsTheWrittenOutPosition) {  // (3.10)-(3.12)
  std::mt19937_64 random(2);
  for (int n = 0; n < 200; ++n) {
    const SrsAngles t = random_angles(random);
    const auto [d3, d4] = random_lengths(random);
    const double s1 = std::sin(t[0]), c1 = std::cos(t[0]), s2 = std::sin(t[1]), c2 = std::cos(t[1]),
                 s3 = std::sin(t[2]), c3 = std::cos(t[2]), s4 = std::sin(t[3]), c4 = std::cos(t[3]);
    const Vector3 r(c1 * s2 * d3 + (c1 * c2 * c3 * s4 - s1 * s3 * s4 + c1 * s2 * c4) * d4,
                    s1 * s2 * d3 + (s1 * c2 * c3 * s4 + c1 * s3 * s4 + s1 * s2 * c4) * d4,
                    c2 * d3 + (-s2 * c3 * s4 + c2 * c4) * d4);
    EXPECT_LT((srs_forward({d3, d4}, t).wrist.position - r).norm(), 1e-15);
  }
}

TEST(SrsForward, JacobianIsTheDifferenceQuotient) {
  std::mt19937_64 random(3);
  constexpr double h = 1e-5;  // truncation h^2/6, rounding 1e-16/h: both about 1e-11
  for (int n = 0; n < 300; ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    const SrsForward here = srs_forward(lengths, theta);
    for (int i = 0; i < 7; ++i) {
      SrsAngles before = theta, after = theta;
      before[i] -= h;
      after[i] += h;
      const Pose a = srs_forward(lengths, before).wrist, b = srs_forward(lengths, after).wrist;
      const Vector3 v = (b.position - a.position) / (2.0 * h);
      const Matrix3 S = (b.rotation - a.rotation) / (2.0 * h) * here.wrist.rotation.transpose();
      EXPECT_LT((here.jacobian.col(i).head<3>() - v).norm(), 1e-10);
      EXPECT_LT((here.jacobian.col(i).tail<3>() - Vector3(S(2, 1), S(0, 2), S(1, 0))).norm(), 1e-10);
    }
  }
}

// All eight reach the pose, are different, and the posture it came from is among them; for each joint given.
TEST(SrsInverse, FindsEightDifferentPostures) {
  std::mt19937_64 random(4);
  int count = 0;
  for (int n = 0; n < test::storm_size(20000); ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    if (!regular(theta)) continue;
    const Pose wrist = srs_forward(lengths, theta).wrist;
    for (int given = 1; given <= 3; ++given) {
      const SrsSolutions all = srs_inverse(lengths, wrist, SrsGiven(given), theta[given - 1]);
      ASSERT_EQ(all.status, SrsStatus::solved);
      ASSERT_EQ(all.count, 8);
      int same = 0;
      double nearest = 10.0;
      for (int i = 0; i < 8; ++i) {
        EXPECT_LT(gap(srs_forward(lengths, all.theta[i]).wrist, wrist), 1e-13);
        EXPECT_NEAR(all.theta[i][given - 1], theta[given - 1], 1e-15);
        if (apart(all.theta[i], theta) < 1e-10) ++same;
        for (int j = 0; j < i; ++j) nearest = std::min(nearest, apart(all.theta[i], all.theta[j]));
        for (const double t : all.theta[i]) EXPECT_TRUE(t >= -kPi && t <= kPi);
      }
      if (nearest < 0.01) continue;  // next to a double root, where angles lose digits
      EXPECT_EQ(same, 1);
      ++count;
    }
  }
  EXPECT_GT(count, 30000);
}

// The residual grows only as 1/|s4| towards the stretched arm, where theta2 given has a double root.
TEST(SrsInverse, KeepsItsDigitsNearSingularities) {
  std::mt19937_64 random(5);
  for (int n = 0; n < 3000; ++n) {
    SrsAngles theta = random_angles(random);
    const double near = std::pow(10.0, -uniform(random, 1.0, 6.0));
    switch (n % 4) {
      case 0:
        theta[5] = near;
        break;
      case 1:
        theta[5] = kPi - near;
        break;
      case 2:
        theta[3] = near;
        break;
      case 3:
        theta[2] = 0.5 * kPi + near;
        break;
    }
    const Pose wrist = srs_forward(kPublished, theta).wrist;
    for (int given = 1; given <= 3; ++given) {
      const SrsSolutions all = srs_inverse(kPublished, wrist, SrsGiven(given), theta[given - 1]);
      if (all.status != SrsStatus::solved) continue;
      for (const SrsAngles& one : all.theta) {
        EXPECT_LT(gap(srs_forward(kPublished, one).wrist, wrist), 2e-14 + 1e-15 / std::abs(std::sin(theta[3])));
      }
    }
  }
}

TEST(SrsInverse, TheArmAloneIsTheArmOfTheWhole) {
  std::mt19937_64 random(6);
  for (int n = 0; n < 500; ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    const Pose wrist = srs_forward(lengths, theta).wrist;
    for (int given = 1; given <= 3; ++given) {
      const SrsArmSolutions arm = srs_arm_inverse(lengths, wrist.position, SrsGiven(given), theta[given - 1]);
      const SrsSolutions whole = srs_inverse(lengths, wrist, SrsGiven(given), theta[given - 1]);
      ASSERT_EQ(arm.count, 4);
      for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 4; ++k) EXPECT_EQ(whole.theta[i][k], arm.theta[i / 2][k]);
      }
    }
  }
}

TEST(SrsInverse, NamesWhatIsWrong) {
  const Matrix3 C = Matrix3::Identity();
  const auto status = [&](const Vector3& r, int given, double angle, const SrsLengths& lengths = kPublished) {
    return srs_arm_inverse(lengths, r, SrsGiven(given), angle).status;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status({0.3, nan, 0.0}, 1, 0.0), SrsStatus::invalid_argument);
  EXPECT_EQ(status({0.3, 0.0, 0.0}, 1, nan), SrsStatus::invalid_argument);
  EXPECT_EQ(status({0.3, 0.0, 0.0}, 1, 0.0, {0.25, 0.0}), SrsStatus::invalid_argument);
  EXPECT_EQ(status({0.3, 0.0, 0.0}, 1, 0.0, {-0.25, 0.25}), SrsStatus::invalid_argument);
  EXPECT_EQ(status({0.4, 0.3, 0.2}, 3, 0.0), SrsStatus::unreachable);
  EXPECT_EQ(status({0.05, 0.0, 0.0}, 3, 0.0, {0.3, 0.2}), SrsStatus::unreachable);  // nearer than d3 - d4
  EXPECT_EQ(status({0.5, 0.0, 0.0}, 1, 0.0), SrsStatus::singular_elbow);
  EXPECT_EQ(status({0.0, 0.0, 0.0}, 3, 0.0), SrsStatus::singular_elbow);    // folded, d3 = d4
  EXPECT_EQ(status({0.3, 0.1, 0.2}, 2, 0.0), SrsStatus::theta1_undefined);  // theta2 = 0
  EXPECT_EQ(status({0.0, 0.0, 0.3}, 2, 1.0), SrsStatus::theta1_undefined);  // on axis 1
  EXPECT_EQ(status({0.0, 0.0, 0.3}, 3, 0.0), SrsStatus::theta1_undefined);
  EXPECT_EQ(status({0.0, 0.2, 0.0}, 1, 0.0), SrsStatus::theta2_undefined);  // on axis 2
  EXPECT_EQ(status({0.1, 0.3, 0.0}, 1, 0.0), SrsStatus::no_solution_for_theta1);
  EXPECT_EQ(status({0.1, 0.0, 0.3}, 2, 1.5), SrsStatus::no_solution_for_theta2);
  EXPECT_EQ(status({0.05, 0.0, 0.3}, 3, 1.5), SrsStatus::no_solution_for_theta3);

  Matrix3 mirrored = C;
  mirrored(2, 2) = -1.0;
  EXPECT_EQ(srs_inverse(kPublished, {{0.3, 0.0, 0.0}, mirrored}, SrsGiven::theta3, 0.0).status,
            SrsStatus::invalid_argument);
  EXPECT_EQ(srs_inverse(kPublished, {{0.3, 0.0, 0.0}, 1.001 * C}, SrsGiven::theta3, 0.0).status,
            SrsStatus::invalid_argument);
  for (const auto& one : {SrsStatus::unreachable, SrsStatus::singular_elbow}) EXPECT_NE(to_string(one), "");
}

// Where theta6 is 0 or pi only theta5 + theta7, or theta5 - theta7, is defined: the answer takes the theta5
// asked for and still reaches the pose.
TEST(SrsInverse, ASingularWristKeepsTheAngleAskedFor) {
  std::mt19937_64 random(7);
  for (const double theta6 : {0.0, kPi}) {
    for (int n = 0; n < 100; ++n) {
      SrsAngles theta = random_angles(random);
      theta[5] = theta6;
      const Pose wrist = srs_forward(kPublished, theta).wrist;
      const SrsSolutions all = srs_inverse(kPublished, wrist, SrsGiven::theta1, theta[0], theta[4]);
      ASSERT_EQ(all.status, SrsStatus::singular_wrist);
      double nearest = 10.0;
      for (const SrsAngles& one : all.theta) {
        EXPECT_LT(gap(srs_forward(kPublished, one).wrist, wrist), 1e-13 / std::abs(std::sin(theta[3])));
        nearest = std::min(nearest, apart(one, theta));
      }
      EXPECT_LT(nearest, 1e-9);
    }
  }
}

TEST(SrsElbow, EveryBranchOfEveryElbowReachesThePose) {
  std::mt19937_64 random(8);
  for (int n = 0; n < test::storm_size(5000); ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    if (!regular(theta)) continue;
    const Pose wrist = srs_forward(lengths, theta).wrist;
    const SrsElbowCircle circle = srs_elbow_circle(lengths, wrist.position);
    ASSERT_EQ(circle.status, SrsStatus::solved);
    const double own = circle.angle_of_elbow(lengths, theta), other = uniform(random, -kPi, kPi);
    int same = 0;
    for (int branch = 0; branch < 8; ++branch) {
      const SrsAngles here = srs_on_circle(lengths, wrist, circle, own, branch, theta);
      const SrsAngles there = srs_on_circle(lengths, wrist, circle, other, branch, theta);
      EXPECT_LT(gap(srs_forward(lengths, here).wrist, wrist), 1e-13);
      EXPECT_LT(gap(srs_forward(lengths, there).wrist, wrist), 1e-12);
      EXPECT_NEAR(std::remainder(circle.angle_of_elbow(lengths, there) - other, 2.0 * kPi), 0.0, 1e-9);
      EXPECT_EQ(there[5] < 0.0, (branch & 1) != 0);
      EXPECT_EQ(there[3] < 0.0, (branch & 2) != 0);
      EXPECT_EQ(there[1] < 0.0, (branch & 4) != 0);
      if (apart(here, theta) < 1e-9) ++same;
    }
    EXPECT_EQ(same, 1);
  }
}

// A joint that is asked for its own angle leads to the posture that it came from, on one of two elbows.
TEST(SrsElbow, IsWhereAJointHasTheAngleAskedFor) {
  std::mt19937_64 random(9);
  for (int n = 0; n < test::storm_size(5000); ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    if (!regular(theta)) continue;
    const Pose wrist = srs_forward(lengths, theta).wrist;
    const SrsElbowCircle circle = srs_elbow_circle(lengths, wrist.position);
    const double own = circle.angle_of_elbow(lengths, theta);
    for (const int joint : {0, 1, 2, 4, 5, 6}) {
      const SrsElbows elbows = srs_elbows_with(lengths, wrist, circle, joint, theta[joint]);
      double nearest = 10.0;
      for (int e = 0; e < elbows.count; ++e) {
        nearest = std::min(nearest, std::abs(std::remainder(elbows.elbow[e] - own, 2.0 * kPi)));
        int branches = 0;
        for (int branch = 0; branch < 8; ++branch) {
          const SrsAngles there = srs_on_circle(lengths, wrist, circle, elbows.elbow[e], branch, theta);
          branches += std::abs(std::remainder(there[joint] - theta[joint], 2.0 * kPi)) < 1e-6 ? 1 : 0;
        }
        EXPECT_GE(branches, 2);
      }
      // Where the joint turns back, an elbow is known to half the digits.
      EXPECT_LT(nearest, 1e-6);
    }
  }
}

TEST(SrsElbow, AStretchedArmKeepsTheAnglesLeftOpen) {
  const SrsAngles theta = {0.0, 0.5 * kPi, -0.4, 0.0, 0.5, 0.9, -0.7};
  Pose wrist = srs_forward(kPublished, theta).wrist;
  wrist.position = {0.5, 0.0, 0.0};  // exactly: rounding alone bends the elbow by 1e-8 rad
  const SrsElbowCircle circle = srs_elbow_circle(kPublished, wrist.position);
  EXPECT_EQ(circle.status, SrsStatus::singular_elbow);
  EXPECT_LT(apart(srs_on_circle(kPublished, wrist, circle, 1.0, 0, theta), theta), 1e-9);
}

// Of unequal lengths: equal ones folded bring the wrist onto the shoulder, where two freedoms are lost.
constexpr SrsLengths kUnequal{.upper_arm = 0.3, .forearm = 0.2};
int rank(const SrsAngles& theta, int rows) {
  Eigen::MatrixXd J = srs_forward(kUnequal, theta).jacobian.topRows(rows);
  J.topRows(3) /= 0.5;
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
  return static_cast<int>((sigma.array() > 1e-9).count());
}

// The table of ranks: which sets of postures cost the arm a freedom, and which only break a parameterisation.
TEST(SrsSingularities, AreWhereTheJacobianLosesRankAndNowhereElse) {
  std::mt19937_64 random(9);
  for (int n = 0; n < 200; ++n) {
    for (const double half : {0.0, kPi}) {
      for (const double quarter : {-0.5 * kPi, 0.5 * kPi}) {
        for (int set = 0; set < 4; ++set) {
          SrsAngles theta = random_angles(random);
          if (!regular(theta)) continue;
          if (set == 0) theta[3] = half;
          if (set == 1) theta[1] = half, theta[2] = quarter;
          if (set == 2) theta[5] = half, theta[4] = quarter;
          if (set == 3) theta[1] = half, theta[5] = quarter > 0.0 ? half : kPi - half;
          EXPECT_EQ(rank(theta, 6), 5) << set;
          EXPECT_EQ(srs_jacobian_rank(kUnequal, theta), 5) << set;
          EXPECT_EQ(rank(theta, 3), set < 2 ? 2 : 3) << set;
          const auto sets = srs_singularities(theta);
          for (int s = 0; s < 4; ++s) EXPECT_EQ(sets[s].distance < 1e-12, s == set) << s << " at " << set;
        }
        SrsAngles theta = random_angles(random);
        if (!regular(theta) || std::abs(std::cos(theta[4])) < 0.03) continue;
        EXPECT_EQ(rank(theta, 6), 6);
        theta[1] = half;  // theta2 = 0 alone
        EXPECT_EQ(rank(theta, 6), 6);
        theta[1] = 0.7;
        theta[5] = half;  // theta6 = 0 alone
        EXPECT_EQ(rank(theta, 6), 6);
      }
    }
  }
}

// What each singularity is said to carry does no work with any joint: J^T w = 0.
TEST(SrsSingularities, CarryTheLoadTheyName) {
  std::mt19937_64 random(10);
  for (int n = 0; n < 100; ++n) {
    SrsAngles theta = random_angles(random);
    const auto work = [&](const Vector3& along, const Vector3& from_wrist) {  // of a force on a line
      Vector6 w;
      w << along, from_wrist.cross(along);
      return (srs_forward(kPublished, theta).jacobian.transpose() * w).cwiseAbs().maxCoeff();
    };
    const auto elbow = [&] { return Vector3(0.25 * (Rz(theta[0]) * Ry(theta[1])).col(2)); };
    const auto wrist = [&] { return srs_forward(kPublished, theta).wrist.position; };
    theta[3] = 0.0;
    EXPECT_LT(work(wrist().normalized(), Vector3::Zero()), 1e-15);
    theta[3] = 1.1;
    theta[1] = 0.0, theta[2] = 0.5 * kPi;
    EXPECT_LT(work((wrist() - elbow()).normalized(), Vector3::Zero()), 1e-15);
    theta[1] = 0.6, theta[2] = 0.2;
    theta[5] = kPi, theta[4] = -0.5 * kPi;
    EXPECT_LT(work(elbow().normalized(), -wrist()), 1e-15);
  }
}

TEST(SrsSingularities, DistanceIsThatOfTheJointAngles) {
  SrsAngles theta = {0.0, 3.0 * kDegree, 86.0 * kDegree, 30.0 * kDegree, 80.0 * kDegree, -170.0 * kDegree, 0.0};
  const auto sets = srs_singularities(theta);
  EXPECT_NEAR(sets[0].distance, 30.0 * kDegree, 1e-12);
  EXPECT_NEAR(sets[1].distance, 5.0 * kDegree, 1e-12);
  EXPECT_NEAR(sets[2].distance, std::hypot(10.0, 10.0) * kDegree, 1e-12);
  EXPECT_NEAR(sets[3].distance, std::hypot(3.0, 10.0) * kDegree, 1e-12);
}

TEST(SrsSingularities, MinorsAreDeterminantsOfTheJacobian) {
  std::mt19937_64 random(11);
  for (int n = 0; n < 500; ++n) {
    const SrsLengths lengths = random_lengths(random);
    const SrsAngles theta = random_angles(random);
    const Eigen::Matrix<double, 3, 7> J = srs_forward(lengths, theta).jacobian.topRows<3>();
    Matrix3 first, second;
    first << J.col(1), J.col(2), J.col(3);
    second << J.col(0), J.col(2), J.col(3);
    const auto minors = srs_position_minors(lengths, theta);
    EXPECT_NEAR(minors[0], first.determinant(), 1e-15);
    EXPECT_NEAR(minors[1], second.determinant(), 1e-15);
    EXPECT_NEAR(srs_position_manipulability(lengths, theta), std::sqrt((J * J.transpose()).determinant()),
                1e-9);
  }
}

}  // namespace
}  // namespace zwidth
