#include "zwidth/mechanism/serial_dynamics.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <kdl/chain.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "support/allocation_counter.h"
#include "support/arms.h"
#include "support/positioning_stage.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

struct Draw {
  ActiveVector joints, rate, acceleration;
  ToolVector push;
};

double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Draw draw(std::mt19937_64& random, const Mechanism& mechanism) {
  const int n = mechanism.active_count();
  Draw one{ActiveVector(n), ActiveVector(n), ActiveVector(n), ToolVector(6)};
  for (int j = 0; j < n; ++j) {
    one.joints[j] = between(random, -2.5, 2.5);
    one.rate[j] = between(random, -4, 4);
    one.acceleration[j] = between(random, -30, 30);
  }
  for (double& value : one.push) value = between(random, -5, 5);
  return one;
}

// A body of any shape on every link and on the platform.
void add_bodies(Description& description, std::mt19937_64& random, bool platform = true) {
  const auto& rows = std::get<SerialDescription>(description.mechanism);
  std::vector<std::string> names;
  for (const SerialJointDescription& row : rows.joints) {
    if (row.type != SerialJointType::fixed) names.push_back("arm/" + row.name);
  }
  if (platform) names.emplace_back("platform");
  for (const std::string& name : names) {
    BodyDescription body;
    body.on = name;
    body.mass = between(random, 0.1, 0.8);
    body.centre = {between(random, -0.2, 0.2), between(random, -0.2, 0.2), between(random, -0.2, 0.2)};
    const Matrix3 R =
        Eigen::Quaterniond(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1), 0.3)
            .normalized()
            .toRotationMatrix();
    body.inertia = R * Vector3(2e-3, 3e-3, 4e-3).asDiagonal() * R.transpose();
    description.bodies.push_back(body);
  }
}

Description sliding_arm() {
  Description arm;
  arm.name = "arm";
  arm.gravity = {1.0, -2.0, -9.0};
  arm.mechanism = SerialDescription{
      .joints = {{.name = "a", .a = 0.2, .alpha = 0.7, .range = {-3, 3}},
                 {.name = "b", .type = SerialJointType::prismatic, .d = 0.1, .alpha = -1.2, .range = {-3, 3}},
                 {.name = "c", .d = 0.1, .a = 0.3, .alpha = 0.4, .range = {-3, 3}},
                 {.name = "d", .type = SerialJointType::prismatic, .a = 0.1, .range = {-3, 3}},
                 {.name = "e", .theta = 0.3, .a = 0.1, .alpha = 1.0, .range = {-3, 3}}}};
  return arm;
}

void expect_the_same_as_of_postures(const Description& description, std::mt19937_64& random) {
  Mechanism mechanism(description);
  mechanism.set_drive_inertia(ActiveVector::LinSpaced(mechanism.active_count(), 1e-4, 9e-4));
  const auto dynamics = SerialDynamics::of(mechanism);
  ASSERT_TRUE(dynamics);
  for (int k = 0; k < 50; ++k) {
    const Draw one = draw(random, mechanism);
    const Posture posture = *solve_forward(mechanism, one.joints).posture;
    const ActiveVector torque = dynamics->inverse(one.joints, one.rate, one.acceleration, one.push),
                       expected = inverse_dynamics(posture, one.rate, one.acceleration, one.push);
    EXPECT_LT((torque - expected).norm(), 1e-12 * (1.0 + expected.norm()));
    const ActiveMatrix M = mass_matrix(posture);
    EXPECT_LT((dynamics->mass_matrix(one.joints) - M).norm(), 1e-13 * (1.0 + M.norm()));
    EXPECT_LT((dynamics->forward(one.joints, one.rate, torque, one.push) - one.acceleration).norm(),
              1e-9 * one.acceleration.norm());
  }
}

TEST(SerialDynamics, EqualsThatOfPostures) {
  std::mt19937_64 random(61);
  Description seven = test::arm_description(0.25, 0.22), slides = sliding_arm();
  add_bodies(seven, random);
  add_bodies(slides, random);
  expect_the_same_as_of_postures(seven, random);
  expect_the_same_as_of_postures(slides, random);
  expect_the_same_as_of_postures(test::balanced_arm({}), random);  // bodies on pins
}

TEST(SerialDynamics, EqualsThatOfPosturesForEverySerialDevice) {
  const Catalogue catalogue = Catalogue::load();
  std::mt19937_64 random(62);
  int arms = 0;
  for (const char* name : {"seven-dof", "seven-dof-locked", "pneumatic-1", "pneumatic-2", "pneumatic-3"}) {
    const Description description = read_description(name, {}, catalogue);
    if (!SerialDynamics::of(Mechanism(description))) continue;
    expect_the_same_as_of_postures(description, random);
    ++arms;
  }
  EXPECT_GE(arms, 2);
}

TEST(SerialDynamics, EqualsKdls) {
  std::mt19937_64 random(63);
  Description description = test::arm_description(0.25, 0.22);
  add_bodies(description, random, false);
  const Mechanism mechanism(description);
  const auto dynamics = SerialDynamics::of(mechanism);

  // Bodies are given in the base frame at the zero posture; KDL wants them in the frames of the rows.
  KDL::Chain chain;
  const auto& rows = std::get<SerialDescription>(description.mechanism).joints;
  Pose frame;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KDL::Frame step = KDL::Frame::DH(rows[i].a, rows[i].alpha, rows[i].d, rows[i].theta);
    Matrix3 R;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) R(r, c) = step.M(r, c);
    }
    frame.position += frame.rotation * Vector3(step.p.x(), step.p.y(), step.p.z());
    frame.rotation = frame.rotation * R;
    const BodyDescription& body = description.bodies[i];
    const Vector3 c = frame.rotation.transpose() * (body.centre - frame.position);
    const Matrix3 I = frame.rotation.transpose() * body.inertia * frame.rotation;
    chain.addSegment(KDL::Segment(
        KDL::Joint(KDL::Joint::RotZ), step,
        KDL::RigidBodyInertia(body.mass, {c.x(), c.y(), c.z()},
                              KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)))));
  }
  const Vector3 g = description.gravity;
  KDL::ChainIdSolver_RNE solver(chain, {g.x(), g.y(), g.z()});
  KDL::JntArray q(7), qd(7), qdd(7), tau(7);
  const KDL::Wrenches none(7, KDL::Wrench::Zero());
  for (int k = 0; k < 100; ++k) {
    const Draw one = draw(random, mechanism);
    q.data = one.joints, qd.data = one.rate, qdd.data = one.acceleration;
    ASSERT_EQ(solver.CartToJnt(q, qd, qdd, none, tau), 0);
    const ActiveVector torque = dynamics->inverse(one.joints, one.rate, one.acceleration);
    EXPECT_LT((torque - ActiveVector(tau.data)).norm(), 1e-12 * (1.0 + torque.norm()));
  }
}

TEST(SerialDynamics, DoesNotAllocate) {
  std::mt19937_64 random(64);
  const Mechanism mechanism(test::balanced_arm({}));
  const auto dynamics = SerialDynamics::of(mechanism);
  const Draw one = draw(random, mechanism);
  const long before = test::allocations();
  const ActiveVector torque = dynamics->inverse(one.joints, one.rate, one.acceleration, one.push);
  const ActiveVector back = dynamics->forward(one.joints, one.rate, torque, one.push);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_TRUE(back.allFinite());
}

TEST(SerialDynamics, IsOnlyThereForArms) {
  Description planar;
  planar.name = "five-bar";
  planar.mechanism = FiveBarDescription{.crank = 0.1, .coupler = 0.15, .half_base = 0.03};
  EXPECT_FALSE(SerialDynamics::of(Mechanism(planar)));
}

}  // namespace
}  // namespace zwidth
