#include "zwidth/mechanism/mechanism_problems.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>

#include "zwidth/description/validate.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

// A slider crank in the plane: a driven crank, a rod, a slide.
Description slider_crank() {
  LegsDescription legs;
  legs.platform = PlatformFreedom::planar_translation;
  LegDescription crank{.name = "crank",
                       .joints = {{.name = "turn", .active = true, .range = {-1.0, 1.0}},
                                  {.name = "knee", .point = {0.1, 0.0, 0.0}}},
                       .tip = {0.3, 0.0, 0.0},
                       .attachment = Attachment::spherical};
  LegDescription rail{.name = "rail",
                      .joints = {{.name = "slide",
                                  .type = JointType::prismatic,
                                  .axis = Vector3::UnitX(),
                                  .point = {0.25, 0.0, 0.0},
                                  .range = {-0.2, 0.2}}},
                      .tip = {0.3, 0.0, 0.0},
                      .attachment = Attachment::spherical};
  legs.legs = {crank, rail};
  legs.legs[0].joints[0].home = 0.5;
  Description description;
  description.name = "slider";
  description.mechanism = legs;
  return description;
}

LegsDescription& legs_in(Description& description) {
  return std::get<LegsDescription>(description.mechanism);
}

Problem only_problem(const Description& description) {
  EXPECT_TRUE(validate(description).empty());
  const std::vector<Problem> problems = mechanism_problems(description);
  std::string all;
  for (const Problem& problem : problems) all += to_string(problem) + "\n";
  EXPECT_EQ(problems.size(), 1U) << all;
  return problems.empty() ? Problem{} : problems[0];
}

TEST(MechanismProblems, AreNoneOfASoundMechanism) {
  EXPECT_TRUE(mechanism_problems(slider_crank()).empty());
}

TEST(MechanismProblems, PassiveJointsThatStayFreeAreNamed) {
  Description device = slider_crank();
  legs_in(device).legs.pop_back();  // nothing holds the knee
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg[0].joint[1]");
  EXPECT_TRUE(problem.rule.starts_with("under-constrained")) << problem.rule;
  EXPECT_NE(problem.rule.find("\"crank/knee\""), std::string::npos);
  EXPECT_NE(problem.rule.find("2 freedoms and 1 active joint"), std::string::npos) << problem.rule;
  EXPECT_NE(problem.advice.find("active = true"), std::string::npos);
}

TEST(MechanismProblems, AJointThatMovesNothingIsNamed) {
  Description device = slider_crank();
  // The rod spins about itself, which the tool does not notice.
  legs_in(device).legs[0].joints.push_back(
      {.name = "spin", .axis = Vector3::UnitX(), .point = {0.1, 0.0, 0.0}});
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg[0].joint[2]");
  EXPECT_NE(problem.rule.find("without the platform"), std::string::npos) << problem.rule;
}

TEST(MechanismProblems, AJointThatOthersDecideIsNamed) {
  Description device = slider_crank();
  legs_in(device).legs[1].joints[0].active = true;
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg[1].joint[0].active");
  EXPECT_TRUE(problem.rule.starts_with("over-actuated")) << problem.rule;
}

TEST(MechanismProblems, WhatCannotMoveIsSaid) {
  Description device = slider_crank();
  LegDescription strut{.name = "strut",
                       .joints = {{.name = "pin", .point = {0.2, 0.2, 0.0}}},
                       .tip = {0.3, 0.0, 0.0},
                       .attachment = Attachment::spherical};
  legs_in(device).legs[0].joints[0].home = 0.0;
  legs_in(device).legs.push_back(strut);
  EXPECT_EQ(only_problem(device).rule, "cannot move: its closure equations leave no freedom");
}

TEST(MechanismProblems, RangesThatExcludeEveryPostureAreSaid) {
  Description device = slider_crank();
  legs_in(device).legs[1].joints[0].range = {0.3, 0.5};  // the rod is not that long
  legs_in(device).legs[1].joints[0].home = 0.4;
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg[1].joint[0].range");
  EXPECT_NE(problem.rule.find("excludes every posture"), std::string::npos) << problem.rule;
  EXPECT_EQ(problem.value, "[300 mm, 500 mm]");
}

TEST(MechanismProblems, AHomeThatDoesNotCloseComesWithOneThatDoes) {
  Description device = slider_crank();
  LegsDescription& legs = legs_in(device);
  // The rail is so high that the rod meets it only with the crank up, and home is down.
  legs.legs[0].joints[0].range = {-3.1, 3.1};
  legs.legs[0].joints[0].home = -1.5;
  for (JointDescription& joint : legs.legs[1].joints) joint.point.y() += 0.25;
  legs.legs[1].tip.y() += 0.25;
  ASSERT_TRUE(validate(device).empty());
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg[0].joint[0].home");
  // Told so, it closes.
  double turn = 0.0, knee = 0.0, slide = 0.0;
  ASSERT_EQ(
      std::sscanf(problem.advice.c_str(),
                  "set home in every joint as here: crank/turn %lf deg, crank/knee %lf deg, rail/slide %lf mm",
                  &turn, &knee, &slide),
      3)
      << problem.advice;
  legs.legs[0].joints[0].home = turn * std::numbers::pi / 180.0;
  legs.legs[0].joints[1].home = knee * std::numbers::pi / 180.0;
  legs.legs[1].joints[0].home = slide / 1000.0;
  EXPECT_TRUE(mechanism_problems(device).empty());
}

TEST(MechanismProblems, LoopsThatCloseNowhereAreSaid) {
  Description device = slider_crank();
  for (JointDescription& joint : legs_in(device).legs[1].joints) joint.point.y() += 0.35;
  legs_in(device).legs[1].tip.y() += 0.35;  // within the sum of all lengths, but not within reach
  const Problem problem = only_problem(device);
  EXPECT_EQ(problem.key, "leg");
  EXPECT_TRUE(problem.rule.starts_with("never closes")) << problem.rule;
}

TEST(MechanismProblems, APlatformThatTurnsMustBeDeclaredSo) {
  Description device = slider_crank();
  LegsDescription& legs = legs_in(device);
  legs.platform = PlatformFreedom::translation;
  for (LegDescription& leg : legs.legs) leg.attachment = Attachment::rigid;
  legs.legs[1].joints.push_back({.name = "pin", .point = {0.3, 0.0, 0.0}});
  legs.legs[0].joints.push_back({.name = "pin", .point = {0.3, 0.0, 0.0}});
  // Crank, rod and slide meet in two pins of one platform, which so may turn.
  const std::vector<Problem> problems = mechanism_problems(device);
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0].key, "mechanism.platform");
}

}  // namespace
}  // namespace zwidth
