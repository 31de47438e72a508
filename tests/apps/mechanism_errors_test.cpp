#include <algorithm>
#include <gtest/gtest.h>

#include "run_command.h"

// Mistakes in mechanisms that users describe: exit 2, and the place, the value, the rule and the remedy.

namespace zwidth::testing {
namespace {

// A five-bar spelled out, every value on a line of its own.
const char* const kBars = R"([device]
name = "bars"
title = "Two cranks, two rods"

[mechanism]
type = "legs"
platform = "planar-translation"

[[leg]]
name = "left"
tip = ["220 mm", 0, 0]
attachment = "spherical"
[[leg.joint]]
name = "crank"
type = "revolute"
active = true
axis = [0, 0, 1]
point = ["-30 mm", 0, 0]
range = ["60 deg", "200 deg"]
home = "128 deg"
[[leg.joint]]
name = "elbow"
type = "revolute"
axis = [0, 0, 1]
point = ["70 mm", 0, 0]
home = "-76 deg"

[[leg]]
name = "right"
tip = ["280 mm", 0, 0]
attachment = "spherical"
[[leg.joint]]
name = "crank"
type = "revolute"
active = true
axis = [0, 0, 1]
point = ["30 mm", 0, 0]
range = ["-20 deg", "120 deg"]
home = "52 deg"
[[leg.joint]]
name = "elbow"
type = "revolute"
axis = [0, 0, 1]
point = ["130 mm", 0, 0]
home = "76 deg"
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Every verb refuses the file, with the line of `part` and these words.
void expect_refused(const std::string& text, const std::string& part, const std::vector<std::string>& words) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("bars.toml", text);
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(part)), '\n');
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"check", file},
                                             {"at", file, "--joints", "128deg,52deg"},
                                             {"report", file, "-o", scratch.path() / "out"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments[0] << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "") << arguments[0];
    EXPECT_NE(outcome.err.find(file + ":" + std::to_string(line) + ":"), std::string::npos)
        << "line " << line << ": " << outcome.err;
    for (const std::string& word : words)
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << ": " << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "out"));
  const auto document = run({"check", file, "--json"}).json();
  ASSERT_FALSE(document["ok"].get<bool>());
  EXPECT_EQ(document["devices"][0]["problems"][0]["line"].get<long>(), line);
}

TEST(MechanismErrors, AreNoneInASoundFile) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("bars.toml", kBars);
  const Outcome checked = run({"check", file});
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find("2 freedoms, constrained"), std::string::npos) << checked.out;
  EXPECT_NE(checked.out.find("in the plane"), std::string::npos) << checked.out;
  EXPECT_EQ(run({"at", file, "--joints", "128deg,52deg"}).status, 0);
  const auto mobility = run({"check", file, "--json"}).json()["devices"][0]["mobility"];
  EXPECT_EQ(mobility["gruebler"], 2);
  EXPECT_EQ(mobility["freedoms"], 2);
  EXPECT_EQ(mobility["redundant_equations"], 0);
  EXPECT_EQ(mobility["group"], "planar");
  EXPECT_EQ(mobility["verdict"], "constrained");
}

TEST(MechanismErrors, OverConstrainedIsAWarning) {
  // Two legs of three parallel hinges each, across each other (Sarrus 1853): both say that the plate does not
  // tilt.
  std::string sarrus = "[device]\nname = \"sarrus\"\n[mechanism]\ntype = \"legs\"\nplatform = \"rigid\"\n";
  for (const bool along_x : {true, false}) {
    const auto point = [along_x](const char* out, const char* up) {
      return along_x ? std::string("[") + out + ", 0, " + up + "]"
                     : std::string("[0, ") + out + ", " + up + "]";
    };
    sarrus += std::string("[[leg]]\nname = \"") + (along_x ? "a" : "b") +
              "\"\ntip = [0, 0, 0.2]\nattachment = \"rigid\"\nplatform_point = [0, 0, 0]\n";
    const struct {
      const char *name, *out, *up;
    } hinges[] = {{"foot", "0.1", "0"}, {"knee", "0.2", "0.1"}, {"hip", "0.1", "0.2"}};
    for (const auto& [name, out, up] : hinges) {
      sarrus += std::string("[[leg.joint]]\nname = \"") + name +
                "\"\ntype = \"revolute\"\naxis = " + (along_x ? "[0, 1, 0]" : "[1, 0, 0]") +
                "\npoint = " + point(out, up) + "\n";
      if (along_x && std::string_view(name) == "foot") sarrus += "active = true\nrange = [-0.5, 0.5]\n";
    }
  }
  const ScratchDirectory scratch;
  const std::string file = scratch.file("sarrus.toml", sarrus);
  const Outcome outcome = run({"check", file, "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto device = outcome.json()["devices"][0];
  EXPECT_EQ(device["mobility"]["verdict"], "over-constrained");
  EXPECT_EQ(device["mobility"]["redundant_equations"], 1);
  EXPECT_NE(device["warnings"].dump().find("over-constrained: 1 equation in the loops repeats others"),
            std::string::npos)
      << device["warnings"];
}

// Whatever the platform is said to do, in a plane the legs need not say again that it stays there.
TEST(MechanismErrors, APlaneCountsAsOneForAPlatformThatMightLeaveIt) {
  const ScratchDirectory scratch;
  for (const char* platform : {"translation", "point"}) {
    const std::string file = scratch.file("bars.toml", with(kBars, "planar-translation", platform));
    const Outcome outcome = run({"check", file, "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto mobility = outcome.json()["devices"][0]["mobility"];
    EXPECT_EQ(mobility["gruebler"], 2) << platform;
    EXPECT_EQ(mobility["group"], "planar") << platform;
    EXPECT_EQ(mobility["verdict"], "constrained") << platform;
  }
}

// Of the R-CUBE's postures hardly any is left if a link is too short: it stands at home and nowhere else.
TEST(MechanismErrors, ADeviceThatOnlyStandsAtHomeIsNone) {
  const Outcome outcome = run({"check", "r-cube", "--set", "mechanism.outer_link=10 mm"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("closes its legs at home alone"), std::string::npos) << outcome.err;
}

TEST(MechanismErrors, AssemblyThatIsImpossible) {
  std::string apart = with(kBars, "[\"30 mm\", 0, 0]", "[\"900 mm\", 0, 0]");
  apart =
      with(with(apart, "[\"130 mm\", 0, 0]", "[\"1 m\", 0, 0]"), "[\"280 mm\", 0, 0]", "[\"1.15 m\", 0, 0]");
  expect_refused(apart, "[[leg]]\nname = \"right\"", {"leg[1]", "never closes", "lengthen the links"});
}

TEST(MechanismErrors, AHomeThatClosesNothingComesWithOneThatDoes) {
  // One crank is 770 mm long now, which reaches, but not as home has it.
  expect_refused(with(kBars, "[\"30 mm\", 0, 0]", "[\"900 mm\", 0, 0]"), "home = \"128 deg\"",
                 {"leg[0].joint[0].home", "too far", "set home in every joint as here: left/crank "});
}

TEST(MechanismErrors, ALinkOfZeroLength) {
  expect_refused(with(kBars, "[\"70 mm\", 0, 0]", "[\"-30 mm\", 0, \"5 mm\"]"),
                 "point = [\"-30 mm\", 0, \"5 mm\"]",
                 {"leg[0].joint[1].point", "no length", "\"crank\"", "move it off that axis"});
}

TEST(MechanismErrors, AnAxisOfZeroLength) {
  expect_refused(with(kBars, "axis = [0, 0, 1]", "axis = [0, 0, 0]"), "axis = [0, 0, 0]",
                 {"leg[0].joint[0].axis", "[0, 0, 0]", "must not be zero", "such as [0, 0, 1]"});
}

TEST(MechanismErrors, RangesThatExcludeEveryPosture) {
  // Both legs nearly straight, 250 mm long, and the left one turned away from the right one.
  std::string straight = with(kBars, "home = \"-76 deg\"", "home = \"0 deg\"\nrange = [\"-2 deg\", \"2 deg\"]");
  straight = with(straight, "home = \"76 deg\"", "home = \"0 deg\"\nrange = [\"-2 deg\", \"2 deg\"]");
  straight = with(straight, "[\"60 deg\", \"200 deg\"]", "[\"120 deg\", \"200 deg\"]");
  const ScratchDirectory scratch;
  const std::string file = scratch.file("bars.toml", straight);
  for (const char* verb : {"check", "report"}) {
    const Outcome outcome = run({verb, file});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    for (const char* word :
         {"bars.toml:", ".range = [", "excludes every posture", "the loops close with", "widen the range"})
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << ": " << outcome.err;
  }
}

TEST(MechanismErrors, ARotationThatIsNone) {
  expect_refused(with(kBars, "attachment = \"spherical\"",
                      "attachment = \"spherical\"\nplatform_rotation = [[1, 0, 0], [0, 1, 0.1], [0, 0, 1]]"),
                 "platform_rotation",
                 {"leg[0].platform_rotation", "must be a rotation", "orthonormal", "three unit rows"});
}

TEST(MechanismErrors, TooFewActiveJoints) {
  expect_refused(with(kBars, "active = true\n", ""), "[[leg.joint]]\nname = \"crank\"",
                 {"leg[0].joint[0]", "under-constrained", "2 freedoms and 1 active joint", "active = true"});
}

TEST(MechanismErrors, TooManyActiveJoints) {
  expect_refused(
      with(kBars, "home = \"76 deg\"", "active = true\nrange = [\"0 deg\", \"170 deg\"]\nhome = \"76 deg\""),
      "active = true\nrange = [\"0 deg\"",
      {"leg[1].joint[1].active", "over-actuated", "2 freedoms and 3 active joints", "leave active out"});
}

TEST(MechanismErrors, ALoadOfTheWrongDimension) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("bars.toml", kBars);
  for (const std::string load : {"1,2,3", "1,2,3,4,5,6", "1", "0,0,5"}) {
    const Outcome outcome = run({"at", file, "--joints", "128deg,52deg", "--load", load});
    EXPECT_EQ(outcome.status, 2) << load;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("--load \"" + load), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("2"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run({"at", file, "--joints", "128deg,52deg", "--load", "1,2"}).status, 0);
}

TEST(MechanismErrors, ALoadInTheFileOfTheWrongDimension) {
  expect_refused(
      std::string(kBars) + "\n[[load]]\nname = \"push\"\nforce = [0, \"5 N\", 0]\nmoment = [0, 0, \"1 N m\"]\n",
      "moment = [0, 0, \"1 N m\"]", {"load[0].moment", "does not turn", "leave it out"});
  expect_refused(std::string(kBars) + "\n[[load]]\nname = \"push\"\nforce = [0, \"5 N\"]\n",
                 "force = [0, \"5 N\"]", {"load[0].force"});
}

// Values are told as people write them, not with what a double adds.
TEST(MechanismErrors, ShowValuesAsTheyAreWritten) {
  expect_refused(with(kBars, "axis = [0, 0, 1]", "axis = 0.1"), "axis = 0.1", {"axis = 0.1:"});
  expect_refused(with(kBars, "range = [\"60 deg\", \"200 deg\"]", "range = [2.6, 0.1]"), "range = [2.6, 0.1]",
                 {"range = [2.6, 0.1]:", "smaller to a larger"});
}

TEST(MechanismErrors, UnderConstrainedNamesWhatStillMoves) {
  // An elbow more in the right leg, which home has stretched out: it moves, and the tool with it.
  const std::string elbow =
      "[[leg.joint]]\nname = \"wrist\"\ntype = \"revolute\"\naxis = [0, 0, 1]\npoint = [\"200 mm\", 0, 0]\n";
  expect_refused(std::string(kBars) + elbow, "[[leg.joint]]\nname = \"elbow\"",
                 {"under-constrained: with every active joint held", "\"left/elbow\"", "\"right/wrist\"",
                  "can still move, and the platform with them", "3 freedoms and 2 active joints",
                  "set active = true in one of them", "free = true where the hand moves it"});
}

void expect_words(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& word : words)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << "lacks '" << word << "': " << outcome.err;
}

TEST(MechanismErrors, ALinkOfAnArmThatHasNoLength) {
  expect_words(
      {"at", "seven-dof", "--joints", "0,90deg,0,90deg,0,0,0", "--set", "joint[2].d=0"},
      {"joint[2]", "a link has no length", "arm/theta1", "5 ways", "platform = \"rigid\" has 6", "a or d"});
  expect_words({"at", "seven-dof", "--joints", "0,90deg,0,90deg,0,0,0", "--set", "joint[4].d=0"},
               {"joint[", "a link has no length", "arm/theta6"});
  expect_words({"at", "seven-dof-locked", "--joints", "0,90deg,90deg,0,0,0", "--set", "joint[2].d=0"},
               {"joint[", "a link has no length"});
  // Without fewer ways than joints or freedoms four axes may meet.
  EXPECT_EQ(run({"at", "pneumatic-1", "--joints", "0.05,0,0", "--set", "mechanism.platform=rigid"}).status, 0);
}

TEST(MechanismErrors, SlidesThatAreParallel) {
  const ScratchDirectory scratch;
  std::string text =
      "[device]\nname = \"slides\"\ntitle = \"x\"\n[mechanism]\ntype = \"serial\"\nplatform = "
      "\"translation\"\n";
  for (const char* name : {"a", "b", "c"})
    text += std::string("[[joint]]\nname = \"") + name +
            "\"\ntype = \"prismatic\"\nalpha = \"90 deg\"\nrange = " + "[\"-100 mm\", \"100 mm\"]\n";
  expect_words({"at", scratch.file("slides.toml", text), "--joints", "0,0,0"},
               {"mechanism.platform", "2 ways only", "turn an axis"});
}

TEST(MechanismErrors, ARangeTheWrongWayRoundIsSaidOnce) {
  const Outcome outcome = run({"check", "seven-dof", "--set", "joint[0].range=[\"90 deg\", \"-90 deg\"]"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("1 problem\n"), std::string::npos) << outcome.err;
}

TEST(MechanismErrors, ALoadSaysWhatItIsMadeOf) {
  expect_words({"at", "delta", "--joints", "0,0,0", "--load", "1,2,3,4,5,6"},
               {"has 6 entries", "give 3, a force along x, y, z", "no moment"});
  expect_words({"at", "seven-dof", "--joints", "0,90deg,0,90deg,0,0,0", "--load", "1,2,3,4"},
               {"give 3, a force along x, y, z, or 6 with a moment about rx, ry, rz"});
  expect_words({"at", "five-bar", "--joints", "120deg,60deg", "--load", "1,2,3"},
               {"give 2, a force along x, y"});
  expect_words({"size", "five-bar", "--load", "1"}, {"two, a force along x, y"});
  expect_words({"size", "five-bar", "--load", "1,2,0"}, {"two, a force along x, y"});
}

}  // namespace
}  // namespace zwidth::testing
