#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "run_command.h"

// The verb `workspace` for arms whose tool turns.

namespace zwidth::testing {
namespace {

TEST(ArmWorkspace, OfTheSevenJointArm) {
  const Outcome outcome =
      run({"workspace", "seven-dof", "--grid", "20mm", "--position", "0.3,0,0.1", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  // 0.19302 m^3 by a raster of (rho, z) in steps of 1 mm, repeated to 1 %.
  EXPECT_NEAR(document["volume"].get<double>(), 0.19302,
              0.01 * 0.19302 + document["volume_error"].get<double>());
  EXPECT_EQ(document["grid"], 0.02);
  // The wrist turns any way, wherever it is.
  EXPECT_EQ(document["place"]["orientations"]["share"], 1.0);
  EXPECT_EQ(document["orientations"]["orientations"]["least"], 1.0);
  EXPECT_EQ(document["orientations"]["directions"]["volumes"][3]["volume"], document["volume"]);
  // sqrt(0.25^2 + 0.25^2 + 2 * 0.25^2 cos 45 deg), with the elbow as straight as its range allows.
  EXPECT_NEAR(document["farthest"]["distance"].get<double>(), 0.25 * std::sqrt(2.0 + std::numbers::sqrt2),
              1e-6);
}

TEST(ArmWorkspace, SaysWhatThePlaceOfAWristWithNarrowRangesLeaves) {
  const Outcome outcome =
      run({"workspace", "seven-dof", "--grid", "60mm", "--set", "joint[5].range=[\"30 deg\", \"90 deg\"]",
           "--set", "joint[5].home=\"60 deg\"", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  // One elbow alone leaves a band from 30 to 90 deg off the forearm, (cos 30 - cos 90)/2 of the sphere.
  EXPECT_GT(document["place"]["directions"]["share"].get<double>(), 0.42);
  EXPECT_LT(document["place"]["directions"]["share"].get<double>(), 0.95);
  EXPECT_EQ(document["orientations"]["orientations"]["volumes"][3]["volume"], 0.0);
}

TEST(ArmWorkspace, FreeJointsOfAPointTurnItsTool) {
  const Outcome outcome = run({"workspace", "pneumatic-3", "--grid", "10mm", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_TRUE(document.contains("inscribed_cube"));
  EXPECT_TRUE(document["place"]["orientations"].is_null());
  EXPECT_GT(document["place"]["directions"]["share"].get<double>(), 0.2);
  EXPECT_LT(document["place"]["directions"]["share"].get<double>(), 0.8);
  // Everywhere half the sphere, to the noise of its samples: whether that is half, they cannot tell.
  const auto& half = document["orientations"]["directions"]["volumes"][1];
  EXPECT_GT(half["error"].get<double>(), 0.4 * document["volume"].get<double>());
}

TEST(ArmWorkspace, IsComparedWithAnother) {
  const Outcome outcome = run({"workspace", "seven-dof", "--set", "joint[2].d=\"200 mm\"", "--set",
                               "joint[4].d=\"200 mm\"", "--against", "seven-dof", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  const auto value = [&](const char* key) { return document[key]["value"].get<double>(); };
  EXPECT_EQ(document["measure"], "volume");
  EXPECT_NEAR(value("second"), 0.19302, 0.01 * 0.19302 + 2.0 * document["second"]["error"].get<double>());
  // Both links 0.8 times as long: 0.8^3 of the volume.
  EXPECT_NEAR(document["gain"].get<double>(), std::pow(0.8, 3) - 1.0, 0.01);
  EXPECT_NEAR(value("both") + value("only_first"), value("first"), 1e-12);
  EXPECT_NEAR(value("both") + value("only_second"), value("second"), 1e-12);
}

TEST(ArmWorkspace, PositionMustMakeSense) {
  for (const auto& arguments :
       {std::vector<std::string>{"workspace", "delta", "--grid", "10mm", "--position", "0,0,0.1"},
        {"workspace", "five-bar", "--position", "0,0.1"},
        {"workspace", "seven-dof", "--grid", "60mm", "--position", "0,0"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("--position"), std::string::npos) << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
  }
}

}  // namespace
}  // namespace zwidth::testing
