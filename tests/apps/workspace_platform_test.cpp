#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

#include "run_command.h"

// The workspace of platforms on several legs that turn: of the example devices.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

const std::string kHexapod = ZWIDTH_EXAMPLES "/devices/hexapod.toml";
const std::string kPlane = ZWIDTH_EXAMPLES "/devices/three-rrr.toml";

TEST(WorkspacePlatform, OfAHexapodHasAVolumeAndTurns) {
  const Json document = run({"workspace", kHexapod, "--grid", "12mm", "--json"}).json();
  // 904.5 cm^3, counted from the lengths of the struts alone on a lattice of 0.5 mm.
  EXPECT_NEAR(document["volume"].get<double>(), 9.045e-4, 3.0 * document["volume_error"].get<double>());
  EXPECT_NEAR(document["inscribed_sphere"]["radius"].get<double>(), 0.04, 1e-6);
  const Json& about = document["turning"]["about"];
  // The hexapod is its own mirror image in y.
  EXPECT_NEAR(about["x"][0].get<double>(), -about["x"][1].get<double>(), 1e-5);
  EXPECT_NEAR(about["z"][0].get<double>(), -about["z"][1].get<double>(), 1e-5);
  const double share = document["turning"]["share"].get<double>();
  EXPECT_GT(share, 0.01);
  EXPECT_LT(share, 0.1);
  EXPECT_LE(document["conditioning"]["homogeneous"]["best"].get<double>(), 1.0);
}

TEST(WorkspacePlatform, OfAPlateHasAnAreaInAnyOrientationAsked) {
  const Json home = run({"workspace", kPlane, "--grid", "4mm", "--json"}).json();
  EXPECT_NEAR(home["area"].get<double>(), 0.0130, 2e-4);
  const Json turned =
      run({"workspace", kPlane, "--grid", "4mm", "--orientation", "0,0,20deg", "--json"}).json();
  EXPECT_NEAR(turned["orientation"][1][0].get<double>(), std::sin(0.34906585), 1e-8);
  // What it turns from there is less by what it has turned.
  EXPECT_NEAR(turned["turning"]["about"]["z"][1].get<double>(),
              home["turning"]["about"]["z"][1].get<double>() - 0.34906585, 1e-6);
  const Json beside = run({"workspace", kPlane, "--grid", "4mm", "--position", "30mm,0,0", "--json"}).json();
  EXPECT_EQ(beside["turning"]["position"][0], 0.03);
  EXPECT_LT(beside["turning"]["share"].get<double>(), home["turning"]["share"].get<double>());
  const Outcome text = run({"workspace", kPlane, "--grid", "4mm"});
  EXPECT_NE(text.out.find("turns about z"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("±"), std::string::npos) << text.out;
}

TEST(WorkspacePlatform, SaysForcesAndWhatAnyOrientationGives) {
  const Json document = run({"workspace", kPlane, "--grid", "4mm", "--json"}).json();
  const Json& forces = document["forces"];
  EXPECT_GT(forces["force_every_direction"]["median"].get<double>(), 1.0);
  EXPECT_LE(forces["force_every_direction"]["percentile_5"], forces["force_every_direction"]["median"]);
  EXPECT_TRUE(forces["force"]["z"].is_null());
  EXPECT_GT(forces["moment"]["z"]["median"].get<double>(), 0.1);
  const Json& any = document["any_orientation"];
  EXPECT_GT(any["area"].get<double>(), document["area"].get<double>());
  EXPECT_GT(any["share"]["mean"].get<double>(), 0.05);
  EXPECT_EQ(any["turned_every_way"].size(), 4u);
  const Outcome text = run({"workspace", kPlane, "--grid", "4mm"});
  for (const char* wanted : {"Forces, continuous", "In any orientation", "every way in"})
    EXPECT_NE(text.out.find(wanted), std::string::npos) << wanted;
  // Without drives there are no forces.
  EXPECT_TRUE(run({"workspace", kHexapod, "--grid", "20mm", "--json"}).json()["forces"].is_null());
}

TEST(WorkspacePlatform, IsComparedWithOthersThatMoveAlongTheSameAxes) {
  const Json planes = run({"workspace", kPlane, "--against", "five-bar", "--grid", "4mm", "--json"}).json();
  EXPECT_EQ(planes["measure"], "area");
  const auto value = [&](const char* key) { return planes[key]["value"].get<double>(); };
  EXPECT_NEAR(value("both") + value("only_first"), value("first"), 1e-12);
  EXPECT_GT(value("second"), 0.0);
  const Json upright =
      run({"workspace", kHexapod, "--against", "delta", "--grid", "15mm", "--orientation", "0,0,0", "--json"})
          .json();
  EXPECT_EQ(upright["measure"], "volume");
  // 904.5 cm^3, see above.
  EXPECT_NEAR(upright["first"]["value"].get<double>(), 9.045e-4, 0.05 * 9.045e-4);
  const Outcome mixed = run({"workspace", kHexapod, "--against", "five-bar"});
  EXPECT_EQ(mixed.status, 2);
  EXPECT_NE(mixed.err.find("same axes"), std::string::npos) << mixed.err;
}

TEST(WorkspacePlatform, SaysWhatCannotBe) {
  const Outcome tilted = run({"workspace", kHexapod, "--orientation", "0,80deg,0", "--json"});
  EXPECT_EQ(tilted.status, 1);
  EXPECT_EQ(tilted.json()["reached"], false);
  const Outcome wide = run({"workspace", kPlane, "--grid", "1m"});
  EXPECT_EQ(wide.status, 2);
  EXPECT_NE(wide.err.find("finer grid"), std::string::npos) << wide.err;
  EXPECT_EQ(run({"workspace", kHexapod, "--grid", "0.05mm"}).status, 2);
  const Outcome delta = run({"workspace", "delta", "--orientation", "0,0,0"});
  EXPECT_EQ(delta.status, 2);
  EXPECT_NE(delta.err.find("leave it out"), std::string::npos) << delta.err;
}

TEST(WorkspacePlatform, IsInTheReport) {
  const ScratchDirectory scratch;
  const Outcome outcome = run({"report", kPlane, "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(outcome.json()["workspace"]["area"].get<double>(), 0.0130, 1e-4);
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "figures" / "pose-xy.svg"));
}

}  // namespace
}  // namespace zwidth::testing
