#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "run_command.h"

// Stiffness, mass and natural frequencies in `workspace` and `report`.

namespace zwidth::testing {
namespace {

using nlohmann::json;

json answer(const std::vector<std::string>& arguments) {
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.json();
}

TEST(WorkspaceMechanics, ItsExtremesAreWhatAtSaysThere) {
  const json document = answer({"workspace", "r-cube", "--grid", "10mm", "--json"});
  const json& mechanics = document["mechanics"];
  EXPECT_EQ(mechanics["of"], "links and drives");
  const json& slowest = mechanics["figures"]["frequency_held"];
  std::string place;
  for (const json& value : slowest["min_at"]) place += (place.empty() ? "" : ",") + value.dump();
  const json there = answer({"at", "r-cube", "--position", place, "--only", "natural_frequencies", "--json"});
  EXPECT_NEAR(
      there["natural_frequencies"]["held"]["frequencies"][0].get<double>() / slowest["min"].get<double>(), 1.0,
      1e-9);
  const json& heaviest = mechanics["figures"]["heaviest"];
  place.clear();
  for (const json& value : heaviest["max_at"]) place += (place.empty() ? "" : ",") + value.dump();
  const json mass = answer({"at", "r-cube", "--position", place, "--only", "apparent_mass", "--json"});
  EXPECT_NEAR(mass["apparent_mass"]["translation"]["heaviest"].get<double>() / heaviest["max"].get<double>(),
              1.0, 1e-9);
}

TEST(WorkspaceMechanics, WhatTheSourceDoesNotGiveIsSaid) {
  for (const char* device : {"five-bar", "seven-dof"}) {
    const json mechanics = answer({"workspace", device, "--grid", "20mm", "--json"})["mechanics"];
    EXPECT_TRUE(mechanics["of"].is_null());
    EXPECT_TRUE(mechanics["figures"]["softest"].is_null());
    EXPECT_GT(mechanics["figures"]["heaviest"]["max"].get<double>(), 0.0);
    EXPECT_NE(mechanics["notes"].dump().find("not given by the source"), std::string::npos);
    const Outcome page = run({"workspace", device, "--grid", "20mm"});
    EXPECT_NE(page.out.find("not given by the source"), std::string::npos);
  }
}

TEST(WorkspaceMechanics, OfAPlatformThatTurnsIsOverPostures) {
  const json mechanics =
      answer({"workspace", ZWIDTH_EXAMPLES "/devices/hexapod.toml", "--grid", "20mm", "--json"})["mechanics"];
  EXPECT_GT(mechanics["postures"].get<int>(), 100);
  EXPECT_GT(mechanics["figures"]["lightest"]["min"].get<double>(), 0.0);
  EXPECT_TRUE(mechanics["of"].is_null());
}

TEST(WorkspaceMechanics, AMapHasThem) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("map.csv", "");
  ASSERT_EQ(run({"workspace", "r-cube", "--grid", "20mm", "--all-figures", "--map", file}).status, 0);
  std::ifstream in(file);
  std::string header;
  std::getline(in, header);
  for (const char* column : {"softest", "heaviest", "frequency_held", "stiffness_z"})
    EXPECT_NE(header.find(column), std::string::npos) << column;
}

TEST(WorkspaceMechanics, AFigureThatIsNotThereIsAnError) {
  const Outcome outcome = run({"workspace", "r-cube", "--grid", "20mm", "--of", "softst"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("softest"), std::string::npos);
  EXPECT_EQ(run({"workspace", "seven-dof", "--of", "softest"}).status, 2);
}

}  // namespace
}  // namespace zwidth::testing
