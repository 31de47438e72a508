#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

#include "run_command.h"

// The verbs for a tool that moves in a plane, and comparisons of two devices.

namespace zwidth::testing {
namespace {

const std::vector<std::string> kWholePlane = {"--set", "mechanism.left_range=[\"-180 deg\", \"180 deg\"]",
                                              "--set", "mechanism.right_range=[\"-180 deg\", \"180 deg\"]"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Plane, WorkspaceOfTheFiveBarIsThatOfItsSource) {
  const Outcome outcome = run(with({"workspace", "five-bar", "--grid", "5mm", "--json"}, kWholePlane));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_NEAR(document["inscribed_circle"]["radius"].get<double>(), 0.10, 1e-6);
  EXPECT_NEAR(document["dexterous"]["annulus"][0].get<double>(), 0.085, 1e-3);
  EXPECT_NEAR(document["dexterous"]["annulus"][1].get<double>(), 0.216, 1e-3);
  EXPECT_EQ(document["inscribed_circle"]["centre"].size(), 2u);
  EXPECT_FALSE(document["figures"].contains("force_z"));
  EXPECT_NEAR(document["lattice_area"].get<double>() / document["area"].get<double>(), 1.0, 0.02);
}

TEST(Plane, MapHasColumnsOfThePlane) {
  const ScratchDirectory scratch;
  const std::string csv = (scratch.path() / "map.csv").string();
  const Outcome outcome =
      run({"workspace", "five-bar", "--grid", "10mm", "--all-figures", "--map", csv, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string text = read_text(csv);
  EXPECT_TRUE(text.starts_with("x,y,condition_number,"));
  EXPECT_EQ(text.substr(0, text.find('\n')).find("_z"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n') - 1, outcome.json()["inside"].get<long>());
}

TEST(Plane, FigureAndReport) {
  const ScratchDirectory scratch;
  const std::string png = (scratch.path() / "plane.png").string();
  ASSERT_EQ(run({"workspace", "five-bar", "--grid", "10mm", "--figure", png}).status, 0);
  EXPECT_TRUE(read_text(png).starts_with("\x89PNG"));
  const std::string directory = (scratch.path() / "report").string();
  const Outcome report = run({"report", "five-bar", "-o", directory});
  ASSERT_EQ(report.status, 0) << report.err;
  EXPECT_NE(report.out.find("largest circle"), std::string::npos);
  const std::string page = read_text(scratch.path() / "report" / "report.html");
  for (const char* id :
       {"device", "workspace-plane", "singularities", "condition-classes", "conditioning", "ellipses"})
    EXPECT_NE(page.find("id=\"" + std::string(id) + "\""), std::string::npos) << id;
}

TEST(Workspace, AFigureOfWhatIsNotKnownIsRefused) {
  const ScratchDirectory scratch;
  const std::string svg = (scratch.path() / "plane.svg").string();
  const Outcome outcome = run({"workspace", "five-bar", "--grid", "10mm", "--figure", svg, "--of", "softest"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("neither sections of the links"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("known are condition_number"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(svg));
  ASSERT_EQ(run({"workspace", "five-bar", "--grid", "10mm", "--figure", svg, "--of", "heaviest"}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(svg));
}

TEST(Workspace, TakesALatticeThatSuitsTheDevice) {
  const auto grid = [](const char* device) {
    return run({"workspace", device, "--json"}).json()["grid"].get<double>();
  };
  EXPECT_DOUBLE_EQ(grid("five-bar"), 1e-3);
  EXPECT_DOUBLE_EQ(grid("delta"), 1e-3);
  EXPECT_DOUBLE_EQ(grid("pneumatic-1"), 5e-3);
}

TEST(Against, SaysWhatBothReachAndWhatOnlyOne) {
  const Outcome outcome = run({"workspace", "five-bar", "--set", "mechanism.coupler=\"17 cm\"", "--against",
                               "five-bar", "--grid", "2mm", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  const auto value = [&](const char* key) { return document[key]["value"].get<double>(); };
  EXPECT_EQ(document["measure"], "area");
  EXPECT_NEAR(value("both") + value("only_first"), value("first"), 1e-12);
  EXPECT_NEAR(value("both") + value("only_second"), value("second"), 1e-12);
  EXPECT_GT(value("only_first"), 0.0);
  // The second is the device as it comes.
  const auto alone = run({"workspace", "five-bar", "--grid", "2mm", "--json"}).json();
  EXPECT_NEAR(value("second") / alone["area"].get<double>(), 1.0, 2e-3);
}

TEST(Against, DevicesOfTwoKindsAreRefused) {
  const Outcome outcome = run({"workspace", "delta", "--against", "five-bar"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("along x and y"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("same axes"), std::string::npos) << outcome.err;
  EXPECT_TRUE(outcome.out.empty());
}

}  // namespace
}  // namespace zwidth::testing
