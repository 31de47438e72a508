#include "zwidth/analysis/statics.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"
#include "support/positioning_stage.h"

namespace zwidth {
namespace {

using test::kDegreeOfArc;

Posture posture_at(const Mechanism& mechanism, const ActiveVector& joints) {
  const Solution solution = solve_forward(mechanism, joints);
  return *solution.posture;
}

ActiveVector degrees(std::initializer_list<double> values) {
  ActiveVector joints(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) joints[i++] = value * kDegreeOfArc;
  return joints;
}

TEST(Statics,
     TorquesOfTheSource) {  // Baser 2006, section 5.1, critical position 1, in the reading of its tables
  const Mechanism arm(test::arm_description());
  const Posture posture = posture_at(arm, degrees({0, 90, 60, 45, 90, 90, 90}));
  struct Row {
    Vector3 force;
    double moment;
    double torques[4];
  };
  const Row rows[] = {{{10, 0, 0}, 0.5, {0.848, 0.401, 0.224, 0.935}},
                      {{0, 10, 0}, 0.5, {4.951, 0.483, 1.108, 2.364}},
                      {{0, 0, 10}, 0.5, {0.683, 3.785, 1.755, 0.051}},
                      {{1.5, 0, 0}, 0.18, {0.016, 0.041, 0.081, 0.035}},
                      {{0, 0, 1.5}, 0.18, {0.246, 0.466, 0.310, 0.167}}};
  for (const Row& row : rows) {
    LoadDescription load;
    load.force = row.force;
    load.moment.setConstant(row.moment);
    load.moment_frame = MomentFrame::published;
    const ActiveVector torque = load_torques(posture, load).cwiseAbs();
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(torque[j], row.torques[j], 5.1e-4);
  }
}

TEST(Statics, AMomentInTheToolFrameTurnsWithTheTool) {
  std::mt19937_64 random(71);
  for (int n = 0; n < 20; ++n) {
    const Matrix3 C = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    const Vector3 f(1, -2, 3), m(test::uniform(random, -1, 1), 0.4, -0.2);
    EXPECT_EQ(wrench_in_base(f, m, MomentFrame::base, C).moment, m);
    EXPECT_LT((C.transpose() * wrench_in_base(f, m, MomentFrame::tool, C).moment - m).norm(), 1e-14);
    EXPECT_LT((C * wrench_in_base(f, m, MomentFrame::published, C).moment - m).norm(), 1e-14);
    EXPECT_EQ(wrench_in_base(f, m, MomentFrame::tool, C).force, f);
  }
}

TEST(Statics, PowerIsThatOfTheToolInEveryFrame) {
  const Mechanism arm(test::arm_description(0.21, 0.27));
  std::mt19937_64 random(72);
  for (int n = 0; n < 30; ++n) {
    ActiveVector q(7), rate(7);
    for (int j = 0; j < 7; ++j) {
      q[j] = test::uniform(random, -3, 3);
      rate[j] = test::uniform(random, -2, 2);
    }
    const Posture posture = posture_at(arm, q);
    LoadDescription load;
    load.force = {1.0, -0.5, 2.0};
    load.moment = {0.1, 0.3, -0.2};
    load.moment_frame = MomentFrame::tool;
    const ToolVector twist = jacobian(posture) * rate;
    const Vector3 spin = posture.tool().rotation.transpose() * twist.tail<3>();  // in the tool's axes
    const double power = load.force.dot(twist.head<3>()) + load.moment.dot(spin);
    EXPECT_NEAR(load_torques(posture, load).dot(rate), power, 1e-12);
    const Wrench wrench = wrench_in_base(load.force, load.moment, load.moment_frame, posture.tool().rotation);
    const ActiveVector against = torques_against(jacobian(posture), tool_load(arm, wrench));
    EXPECT_LT((against + load_torques(posture, load)).norm(), 1e-14);
  }
}

TEST(Statics, WhatTheToolHasNoFreedomForIsCarriedByTheStructure) {
  Description description;
  description.mechanism = test::published_delta();
  const Mechanism delta(description);
  const Wrench wrench{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(tool_load(delta, wrench).size(), 3);
  EXPECT_EQ(tool_load(delta, wrench), ToolVector(wrench.force));
}

}  // namespace
}  // namespace zwidth
