#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <sstream>

#include "run_command.h"

namespace zwidth::testing {
namespace {

TEST(Command, HelpOfEveryVerbHasExamples) {
  EXPECT_NE(run({"--help"}).out.find("Examples"), std::string::npos);
  for (const char* verb : {"report", "at", "workspace", "size", "synthesise", "reproduce", "show", "export",
                           "check", "devices", "parts"}) {
    const Outcome outcome = run({verb, "--help"});
    EXPECT_EQ(outcome.status, 0) << verb;
    EXPECT_NE(outcome.out.find("zwidth " + std::string(verb)), std::string::npos) << verb;
  }
}

TEST(Command, HelpFitsTheTerminal) {
  for (const int width : {80, 120}) {
    for (const char* verb : {"", "report", "at", "workspace", "size", "reproduce", "show", "check", "devices",
                             "parts", "completion"}) {
      std::vector<std::string> arguments{"--help"};
      if (*verb != '\0') arguments.insert(arguments.begin(), verb);
      const Outcome outcome = run(arguments, {.environment = {"COLUMNS=" + std::to_string(width)}});
      std::istringstream lines(outcome.out);
      for (std::string line; std::getline(lines, line);)
        EXPECT_LE(line.size(), static_cast<size_t>(width)) << verb << ": " << line;
    }
  }
}

TEST(Command, Version) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.out.starts_with("zwidth "));
}

TEST(Command, NothingPrintsHelp) {
  const Outcome outcome = run({});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.out.find("report"), std::string::npos);
}

TEST(Command, PlainLocaleGetsPlainCharacters) {
  const Outcome outcome = run({"at", "delta", "--joints", "0,0,0"}, {.environment = {"LC_ALL=C"}});
  EXPECT_TRUE(std::all_of(outcome.out.begin(), outcome.out.end(),
                          [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
  EXPECT_EQ(outcome.out.find('?'), std::string::npos) << "a character has no spelling in ASCII:\n"
                                                      << outcome.out;
}

TEST(Devices, ListsTheBuiltIns) {
  const auto document = run({"devices", "--json"}).json();
  bool delta = false;
  for (const auto& device : document["devices"]) delta = delta || device["name"] == "delta";
  EXPECT_TRUE(delta);
}

TEST(Parts, EveryValueHasAUnitAndASource) {
  const auto document = run({"parts", "--json"}).json();
  ASSERT_GT(document["parts"].size(), 5u);
  for (const auto& part : document["parts"]) {
    for (const auto& [key, value] : part["values"].items()) {
      EXPECT_FALSE(value["unit"].get<std::string>().empty()) << key;
      EXPECT_TRUE(!value["source"].get<std::string>().empty() || value["value"].is_null())
          << part["name"] << " " << key;
    }
  }
}

TEST(Parts, OneByName) {
  const Outcome outcome = run({"parts", "maxon-epos2-50-5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("continuous_current"), std::string::npos);
}

TEST(Check, BuiltInDeviceHasThreeFreedomsAndNoProblem) {
  const Outcome outcome = run({"check", "delta", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_TRUE(document["ok"].get<bool>());
  EXPECT_EQ(document["devices"][0]["mobility"]["freedoms"], 3);
}

TEST(Check, FailedMarginIsAWarning) {
  const Outcome outcome = run({"check", "delta", "--set", "drive.transmission.preload=1 N"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("preload"), std::string::npos) << outcome.out;
}

TEST(Workspace, CoarseGridIsCountedExactly) {
  const Outcome outcome = run({"workspace", "delta", "--grid", "5mm", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_NEAR(document["lattice_volume"].get<double>(), document["inside"].get<double>() * 1.25e-7, 1e-15);
  EXPECT_NEAR(document["volume"].get<double>(), 4.18188e-3, 5e-9);
}

TEST(Workspace, MapHasOneRowPerPoint) {
  const ScratchDirectory scratch;
  const std::string csv = (scratch.path() / "map.csv").string();
  const std::string npy = (scratch.path() / "map.npy").string();
  const Outcome outcome = run({"workspace", "delta", "--grid", "10mm", "--map", csv, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string text = read_text(csv);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n') - 1, outcome.json()["inside"].get<long>());
  ASSERT_EQ(run({"workspace", "delta", "--grid", "10mm", "--map", npy, "--json"}).status, 0);
  EXPECT_TRUE(read_text(npy).starts_with("\x93NUMPY"));
}

TEST(Workspace, FigureInEveryFormat) {
  const ScratchDirectory scratch;
  for (const auto& [name, start] :
       {std::pair{"w.svg", "<?xml"}, std::pair{"w.png", "\x89PNG"}, std::pair{"w.pdf", "%PDF"}}) {
    const std::string file = (scratch.path() / name).string();
    const Outcome outcome = run({"workspace", "delta", "--grid", "20mm", "--figure", file});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(read_text(file).starts_with(start)) << name;
    EXPECT_GT(read_text(file).size(), 10000u) << name;
  }
}

TEST(Size, DefaultLoadUsesTheDrivesFully) {
  const Outcome outcome = run({"size", "delta", "--json"});
  const auto document = outcome.json();
  double most = 0.0;
  for (const auto& joint : document["joints"])
    most = std::max(most, joint["required"].get<double>() / joint["continuous"].get<double>());
  EXPECT_NEAR(most, 1.0, 1e-9);
  EXPECT_GT(document["guaranteed_force"].get<double>(), 0.0);
}

TEST(Size, TooLargeALoadIsANo) {
  EXPECT_EQ(run({"size", "delta", "--load", "0,0,1"}).status, 0);
  const Outcome outcome = run({"size", "delta", "--load", "0,0,100", "--json"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_FALSE(outcome.json()["ok"].get<bool>());
}

TEST(Size, LoadAtAPositionIsWhatAtSays) {
  const auto sized = run({"size", "delta", "--load", "1,2,3", "--position", "0,0,0.15", "--json"}).json();
  const auto at = run({"at", "delta", "--load", "1,2,3", "--position", "0,0,0.15", "--json"}).json();
  for (size_t j = 0; j < 3; ++j)
    EXPECT_NEAR(sized["joints"][j]["required"].get<double>(), std::abs(at["torques"][j].get<double>()), 1e-12);
}

TEST(Completion, IsAScriptThatKnowsTheVerbs) {
  const Outcome outcome = run({"completion", "bash"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.out.find("workspace"), std::string::npos);
  EXPECT_EQ(run({"completion", "fish"}).status, 2);
}

}  // namespace
}  // namespace zwidth::testing
