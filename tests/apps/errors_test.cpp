#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

#include "run_command.h"

namespace zwidth::testing {
namespace {

/// The command refuses, says why on the standard error, and prints nothing else.
void expect_refused(const std::vector<std::string>& arguments, int status,
                    const std::vector<std::string>& words, const RunOptions& options = {}) {
  const Outcome outcome = run(arguments, options);
  std::string line;
  for (const std::string& argument : arguments) line += argument + " ";
  EXPECT_EQ(outcome.status, status) << line << outcome.err;
  EXPECT_EQ(outcome.out, "") << line;
  for (const std::string& word : words)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << line << "lacks '" << word << "': " << outcome.err;
}

TEST(Errors, UnknownVerbSuggestsTheNearest) {
  expect_refused({"repot", "delta"}, 2, {"unknown verb", "repot", "report"});
}
TEST(Errors, HelpOfNoVerb) {
  EXPECT_EQ(run({"help", "at"}).out, run({"at", "--help"}).out);
  expect_refused({"help", "repot"}, 2, {"unknown verb", "repot", "report"});
}
TEST(Errors, UnknownOptionSuggestsTheNearest) {
  expect_refused({"at", "delta", "--joint", "0,0,0"}, 2, {"--joint", "--joints"});
}
TEST(Errors, UnknownDeviceSuggestsTheNearest) {
  expect_refused({"report", "dleta"}, 2, {"dleta", "delta"});
}
TEST(Errors, MissingDevice) {
  expect_refused({"at", "--joints", "0,0,0"}, 2, {"DEVICE"});
}
TEST(Errors, MissingFile) {
  expect_refused({"report", "./nowhere.toml"}, 2, {"./nowhere.toml"});
}
TEST(Errors, DirectoryIsNoDevice) {
  expect_refused({"at", "/", "--joints", "0,0,0"}, 2, {"/"});
}
TEST(Errors, UnknownPart) {
  expect_refused({"parts", "motor", "maxon-ec-4pole-30"}, 2,
                 {"maxon-ec-4pole-30", "maxon-ec-4pole-30-100w-48v"});
}
TEST(Errors, UnknownKindOfPart) {
  expect_refused({"parts", "moter", "x"}, 2, {"moter", "motor"});
}
TEST(Errors, UnknownPartInADevice) {
  expect_refused({"at", "delta", "--joints", "0,0,0", "--set", "drive.motor=maxon-ec-4pole-31"}, 2,
                 {"--set", "drive", "maxon-ec-4pole-31"});
}
TEST(Errors, GeometryOfADriveThatCannotBe) {
  const ScratchDirectory scratch;
  std::string text = run({"show", "delta"}).out;
  text.replace(text.find("80.5 mm"), 7, "80.3 mm");
  const std::string file = scratch.file("overlap.toml", text);
  const std::string line = std::to_string(
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("80.3 mm")), '\n'));
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"check", file},
                                             {"size", file},
                                             {"at", file, "--joints", "0,0,0"},
                                             {"report", file, "-o", (scratch.path() / "out").string()}}) {
    expect_refused(
        arguments, 2,
        {file + ":" + line, "drive[0].transmission.centre_distance", "80.3 mm", "overlap", "80.386 mm"});
  }
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "out"));
  expect_refused({"size", "delta", "--set", "drive.transmission.cable.coated_diameter=1.1 mm", "--set",
                  "drive.transmission.centre_distance=90 mm"},
                 2, {"--set", "coated_diameter", "1.1 mm", "groove", "at most"});
}
TEST(Errors, UnknownKeyInSet) {
  expect_refused({"report", "delta", "--set", "mechanism.foream=170 mm"}, 2, {"foream", "forearm"});
}
TEST(Errors, WrongUnitInSet) {
  expect_refused({"report", "delta", "--set", "mechanism.forearm=80 kg"}, 2,
                 {"mechanism.forearm", "80 kg", "length"});
}
TEST(Errors, WrongUnitOfJoints) {
  expect_refused({"at", "delta", "--joints", "10mm,0,0"}, 2, {"--joints", "10mm"});
}
TEST(Errors, WrongNumberOfJoints) {
  expect_refused({"at", "delta", "--joints", "0,0"}, 2, {"--joints", "3"});
}
TEST(Errors, NotANumberOnTheCommandLine) {
  expect_refused({"at", "delta", "--joints", "nan,0,0"}, 2, {"--joints", "nan"});
  expect_refused({"at", "delta", "--position", "inf,0,0"}, 2, {"--position", "inf"});
  expect_refused({"at", "delta", "--position", ",,"}, 2, {"--position"});
  expect_refused({"at", "delta", "--joints", "0,0,0", "--load", "1,2"}, 2, {"--load"});
}
TEST(Errors, NeitherJointsNorPosition) {
  expect_refused({"at", "delta"}, 2, {"--joints", "--position"});
}
TEST(Errors, UnknownKeyInOnly) {
  expect_refused({"at", "delta", "--joints", "0,0,0", "--only", "postion"}, 2, {"postion", "position"});
  expect_refused({"at", "delta", "--joints", "0,0,0", "--only", "stifness"}, 2, {"stifness", "stiffness"});
}
TEST(Errors, UnknownFrame) {
  expect_refused({"at", "delta", "--joints", "0,0,0", "--frame", "world"}, 2, {"world", "user"});
}
TEST(Errors, BadGrid) {
  expect_refused({"workspace", "delta", "--grid", "0"}, 2, {"--grid", "positive"});
  expect_refused({"workspace", "delta", "--grid", "-1mm"}, 2, {"--grid"});
  expect_refused({"workspace", "delta", "--grid", "1 kg"}, 2, {"--grid", "length"});
  expect_refused({"workspace", "delta", "--grid", "1nm"}, 2, {"--grid", "coarser"});
  expect_refused({"workspace", "delta", "--grid", "1m"}, 2, {"--grid", "259", "finer"});
  expect_refused({"workspace", "five-bar", "--grid", "1m"}, 2, {"--grid", "257", "finer"});
  expect_refused({"workspace", "seven-dof", "--grid", "10m"}, 2, {"--grid", "finer"});
}
TEST(Errors, BadMapAndFigureNames) {
  expect_refused({"workspace", "delta", "--map", "x.xls"}, 2, {"x.xls", ".csv"});
  expect_refused({"workspace", "delta", "--figure", "x.gif"}, 2, {"x.gif", ".svg"});
}

TEST(Errors, GarbageFilesAreRefusedWithFileAndLine) {
  const ScratchDirectory scratch;
  const std::string empty = scratch.file("empty.toml", "");
  expect_refused({"report", empty}, 2, {empty});
  const std::string garbage = scratch.file("garbage.toml", "\xff\xfe\x00\x01 not toml at all [[[");
  expect_refused({"report", garbage}, 2, {garbage});
  const std::string broken = scratch.file("broken.toml", "[device]\nname = \"x\"\n[mechanism\n");
  expect_refused({"report", broken}, 2, {broken + ":3"});
  EXPECT_FALSE(std::filesystem::exists("report")) << "nothing is written for a file that cannot be read";
}

TEST(Errors, EveryProblemIsNamedAtOnceWithItsLine) {
  const ScratchDirectory scratch;
  std::string text = run({"show", "delta"}).out;
  const auto replace = [&](const std::string& key, const std::string& line) {
    const size_t at = text.find("\n" + key + " =") + 1;
    text.replace(at, text.find('\n', at) - at, line);
  };
  replace("forearm", "forearm = \"-160 mm\"");
  replace("upper_arm", "upper_arm = \"80 kg\"");
  const std::string file = scratch.file("two.toml", text);
  const auto line_of = [&](const std::string& words) {
    return std::to_string(
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(words)), '\n'));
  };
  expect_refused({"at", file, "--joints", "0,0,0"}, 2,
                 {file + ":" + line_of("-160 mm"), "mechanism.forearm", file + ":" + line_of("80 kg"),
                  "mechanism.upper_arm"});
  const Outcome checked = run({"check", file, "--json"});
  EXPECT_EQ(checked.status, 2);
  const auto document = checked.json();
  EXPECT_FALSE(document["ok"].get<bool>());
  EXPECT_GE(document["devices"][0]["problems"].size(), 2u);
}

TEST(Errors, OutputDirectoryThatCannotBeMade) {
  expect_refused({"report", "delta", "-o", "/proc/zwidth-report"}, 3, {"/proc/zwidth-report"});
  const ScratchDirectory scratch;
  const std::string file = scratch.file("file", "x");
  expect_refused({"report", "delta", "-o", file}, 2, {file, "directory"});
}

TEST(Errors, FullDiskOnTheStandardOutput) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"at", "delta", "--joints", "0,0,0"},
                                             {"at", "delta", "--joints", "0,0,0", "--json"},
                                             {"devices"},
                                             {"--help"},
                                             {"show", "delta"}}) {
    const Outcome outcome = run(arguments, {.output_file = "/dev/full"});
    EXPECT_EQ(outcome.status, 3) << arguments[0];
    EXPECT_NE(outcome.err.find("standard output"), std::string::npos) << outcome.err;
  }
}

TEST(Errors, FullDiskUnderAMapOrFigure) {
  const ScratchDirectory scratch;
  for (const char* name : {"map.csv", "map.npy"}) {
    const auto path = scratch.path() / name;
    std::filesystem::create_symlink("/dev/full", path);
    const Outcome outcome = run({"workspace", "delta", "--grid", "20mm", "--map", path.string()});
    EXPECT_EQ(outcome.status, 3) << name;
    EXPECT_NE(outcome.err.find(path.string()), std::string::npos) << outcome.err;
  }
  const Outcome outcome =
      run({"workspace", "delta", "--grid", "20mm", "--figure", (scratch.path() / "nowhere/x.svg").string()});
  EXPECT_EQ(outcome.status, 3);
}

TEST(Errors, MissingGnuplotNamesThePackage) {
  const ScratchDirectory scratch;
  RunOptions options;
  options.environment = {"PATH=" + scratch.path().string()};
  const Outcome outcome =
      run({"workspace", "delta", "--grid", "20mm", "--figure", (scratch.path() / "x.svg").string()}, options);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("gnuplot-nox"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace zwidth::testing
