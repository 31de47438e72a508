#include "zwidth/analysis/resolution.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"
#include "support/positioning_stage.h"

namespace zwidth {
namespace {

using test::kDegreeOfArc;

Posture posture(const Mechanism& arm, std::initializer_list<double> degrees) {
  ActiveVector joints = ActiveVector::Zero(7);
  Eigen::Index i = 0;
  for (const double value : degrees) joints[i++] = value * kDegreeOfArc;
  return *solve_forward(arm, joints).posture;
}

TEST(ToolStep, OfTheSource) {  // Baser 2006, section 5.4, in its most extended postures
  const Mechanism arm(test::arm_description());
  const Posture first = posture(arm, {0, 60, 0, 45}), second = posture(arm, {0, 60, 0, 90});
  EXPECT_NEAR(tool_step(second, 2, 0.0703 * kDegreeOfArc).distance, 0.3067e-3, 5e-8);
  EXPECT_NEAR(tool_step(second, 3, 0.0439 * kDegreeOfArc).distance, 0.1916e-3, 1.1e-7);
  EXPECT_NEAR(tool_step(first, 1, 0.0439453125 * kDegreeOfArc).distance, 0.35e-3, 5e-6);
  EXPECT_NEAR(tool_step(first, 6, 1e-4).distance, 0.0, 1e-15);
  EXPECT_NEAR(tool_step(first, 6, 1e-4).angle, 1e-4, 1e-14);
}

TEST(PostureResolution, IsTheFirstOrderOfTheStep) {
  const Mechanism arm(test::arm_description(0.21, 0.28));
  std::mt19937_64 random(93);
  for (int n = 0; n < 20; ++n) {
    ActiveVector q(7), step(7);
    for (int j = 0; j < 7; ++j) {
      q[j] = test::uniform(random, -3.0, 3.0);
      step[j] = test::uniform(random, 1e-5, 1e-4);
    }
    const Posture at = *solve_forward(arm, q).posture;
    const PostureResolution resolution = posture_resolution(at, step);
    ASSERT_EQ(resolution.joints.size(), 7u);
    double sum = 0.0, worst = 0.0;
    for (int j = 0; j < 7; ++j) {
      const ToolStep exact = tool_step(at, j, step[j]), first = resolution.joints[static_cast<std::size_t>(j)];
      EXPECT_NEAR(exact.distance, first.distance,
                  step[j] * step[j]);  // chord against arc, links shorter than 1 m
      EXPECT_NEAR(exact.angle, first.angle, 1e-12);
      sum += first.distance;
      worst = std::max(worst, first.distance);
    }
    EXPECT_EQ(resolution.worst.distance, worst);
    EXPECT_GE(resolution.together.distance, worst);
    EXPECT_LE(resolution.together.distance, sum);
    EXPECT_LE(resolution.together.angle, step.sum() + 1e-15);
  }
}

TEST(PostureResolution, OfADeltaOnlyTranslates) {
  Description description;
  description.mechanism = test::published_delta();
  const Mechanism delta(description);
  const Posture at = *solve_forward(delta, Vector3(0.2, 0.3, 0.4)).posture;
  const ActiveVector step = Vector3(1e-4, 1e-4, 1e-4);
  const PostureResolution resolution = posture_resolution(at, step);
  EXPECT_EQ(resolution.worst.angle, 0.0);
  EXPECT_EQ(tool_step(at, 0, 1e-4).angle, 0.0);
  EXPECT_NEAR(tool_step(at, 0, 1e-4).distance, resolution.joints[0].distance, 1e-8);
  // No axis of the tool moves farther than all of it.
  EXPECT_GE(resolution.together.distance, tool_resolution(jacobian(at), step).maxCoeff() - 1e-15);
}

}  // namespace
}  // namespace zwidth
