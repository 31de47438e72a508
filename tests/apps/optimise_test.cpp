#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "even_study.h"
#include "run_command.h"

namespace zwidth::testing {
namespace {

const std::string kEven = even_study(8) + R"toml([[tolerance]]
key = "mechanism.crank"
half_width = "0.1 mm"
)toml";

nlohmann::json designs(const nlohmann::json& document) {
  return document.at("pareto");
}

TEST(Optimise, GivesTheSameDesignsOnAnyNumberOfThreads) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", kEven);
  const auto go = [&](const char* threads, const char* folder) {
    return run({"optimise", study, "-o", (scratch.path() / folder).string(), "--threads", threads, "--json",
                "--samples", "50"});
  };
  const Outcome one = go("1", "one"), two = go("2", "two");
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_EQ(two.status, 0) << two.err;
  EXPECT_GT(designs(one.json()).size(), 3U);
  EXPECT_EQ(designs(one.json()), designs(two.json()));
  EXPECT_EQ(one.json().at("chosen"), two.json().at("chosen"));
}

TEST(Optimise, WritesADeviceThatReportReads) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", kEven);
  const std::string folder = (scratch.path() / "out").string();
  const Outcome outcome = run({"optimise", study, "-o", folder, "--samples", "50"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word : {"Pareto set", "Chosen design", "Sensitivity", "Tolerances", "worst", "length"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  }
  for (const char* name :
       {"index.html", "chosen.toml", "pareto.csv", "pareto.json", "history.csv", "checkpoint",
        "figures/front-1-2.svg", "figures/parallel-coordinates.svg", "figures/hypervolume.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  }
  const Outcome checked = run({"check", folder + "/chosen.toml"});
  EXPECT_EQ(checked.status, 0) << checked.err;
  const std::string device = read_text(folder + "/chosen.toml");
  EXPECT_NE(device.find("chosen: by the study even"), std::string::npos);
}

// Slopes and steps of every figure against the study asked again at designs nearby.
TEST(Optimise, SaysWhatEachVariableDoesToEachFigure) {
  const ScratchDirectory scratch;
  std::string text = even_study(4);
  text +=
      "[[variable]]\nname = \"base\"\nkey = \"mechanism.half_base\"\nmin = \"2 cm\"\nmax = \"4 cm\"\nstep = "
      "\"1 cm\"\n";
  const Outcome outcome =
      run({"optimise", scratch.file("even.toml", text), "-o", (scratch.path() / "out").string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto chosen = outcome.json().at("chosen");
  const double crank = chosen["variables"]["crank"], coupler = chosen["variables"]["coupler"],
               base = chosen["variables"]["base"];
  EXPECT_NEAR(chosen["slopes"]["crank"]["length"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(chosen["slopes"]["crank"]["well conditioned"], chosen["slopes"]["crank"]["worst"]);
  EXPECT_NEAR(chosen["margins"]["well conditioned"].get<double>(),
              5.0 - chosen["objectives"]["worst"].get<double>(), 1e-12);
  // The largest condition number of a lattice over the same square, by another verb.
  const auto worst = [&](double a, double b, double c) {
    double most = 0.0;
    for (const double x : {-0.03, 0.0, 0.03}) {
      for (const double y : {0.12, 0.15, 0.18}) {
        const Outcome at =
            run({"at", "five-bar", "--set", fmt::format("mechanism.crank={}", a), "--set",
                 fmt::format("mechanism.coupler={}", b), "--set", fmt::format("mechanism.half_base={}", c),
                 fmt::format("--position={},{}", x, y), "--only", "condition_number", "--json"});
        most = std::max(most, at.json().at("condition_number").get<double>());
      }
    }
    return most;
  };
  EXPECT_NEAR(worst(crank, coupler, base), chosen["objectives"]["worst"].get<double>(), 1e-9);
  const double slope = chosen["slopes"]["crank"]["worst"];
  constexpr double kStep = 1e-5;
  EXPECT_NEAR((worst(crank + kStep, coupler, base) - worst(crank - kStep, coupler, base)) / (2 * kStep), slope,
              1e-3 * std::abs(slope));
  const auto& steps = chosen["steps"]["base"];
  for (const auto& [way, sign] : {std::pair("down", -1.0), std::pair("up", 1.0)}) {
    if (steps[way].is_null()) continue;
    EXPECT_NEAR(steps[way]["figures"]["worst"].get<double>(), worst(crank, coupler, base + sign * 0.01), 1e-9)
        << way;
  }
  EXPECT_FALSE(steps["down"].is_null() && steps["up"].is_null());
  EXPECT_EQ(outcome.json()["objectives"][1]["unit"], "m");
}

TEST(Optimise, PlacesMistakesAboutTheDeviceInTheStudy) {
  const ScratchDirectory scratch;
  std::string text = even_study(2);
  text.insert(text.find("[search]"), "set = [\"mechanism.coupler = '17 kg'\", \"mechanism.half_bse=1\"]\n");
  const Outcome outcome = run({"check", scratch.file("even.toml", text)});
  EXPECT_EQ(outcome.status, 2);
  for (const char* said : {"even.toml:4:8: study.set[0]", "mechanism.coupler wrong", "a length was expected",
                           "study.set[1]", "did you mean \"half_base\"", "2 problems"}) {
    EXPECT_NE(outcome.err.find(said), std::string::npos) << said << "\n" << outcome.err;
  }
  std::string other = even_study(2);
  other.replace(other.find("five-bar"), 8, "five-bra");
  const Outcome unknown = run({"check", scratch.file("other.toml", other)});
  EXPECT_NE(unknown.err.find("other.toml:3:10: study.device"), std::string::npos) << unknown.err;
  EXPECT_NE(unknown.err.find("five-bar"), std::string::npos) << unknown.err;
}

// What keeps the algorithm from searching is found before it does.
TEST(Optimise, ChecksTheAlgorithmAgainstTheStudy) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", even_study(2));
  const Outcome odd = run({"check", study, "--set", "search.population=41"});
  EXPECT_EQ(odd.status, 2);
  EXPECT_NE(odd.err.find("search.population = 41: nsga2 needs a population"), std::string::npos) << odd.err;
  EXPECT_NE(odd.err.find("a multiple of 4"), std::string::npos) << odd.err;
  const Outcome grid = run({"check", study, "--set", "search.algorithm='grid'"});
  EXPECT_EQ(grid.status, 2);
  EXPECT_NE(grid.err.find("a grid needs whole numbers"), std::string::npos) << grid.err;
}

// A division by zero in every design of a part of the space, and a box that is out of reach in another.
TEST(Optimise, NamesWhatIsUndefinedWithAnExample) {
  const ScratchDirectory scratch;
  const std::string text =
      even_study(3) +
      "[[constraint]]\nname = \"root\"\nvalue = \"sqrt(mechanism.half_base - crank)\"\nmax = 1\n";
  const Outcome outcome =
      run({"optimise", scratch.file("even.toml", text), "-o", (scratch.path() / "out").string()});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("sqrt(mechanism.half_base - crank)"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("16 of 16 designs"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("crank ="), std::string::npos) << outcome.out;
  const auto document = nlohmann::json::parse(read_text(scratch.path() / "out" / "pareto.json"));
  ASSERT_EQ(document["undefined"].size(), 1U);
  EXPECT_EQ(document["undefined"][0]["key"], "constraint[1].value");
  EXPECT_EQ(document["undefined"][0]["count"], 16);
}

TEST(Optimise, GoesOnWhereItWasStopped) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", kEven);
  const std::string whole = (scratch.path() / "whole").string(), parts = (scratch.path() / "parts").string();
  const Outcome all = run({"optimise", study, "-o", whole, "--json", "--samples", "0"});
  ASSERT_EQ(
      run({"optimise", study, "-o", parts, "--set", "search.generations=3", "--json", "--samples", "0"}).status,
      0);
  const Outcome rest = run({"optimise", study, "-o", parts, "--resume", "--json", "--samples", "0"});
  ASSERT_EQ(rest.status, 0) << rest.err;
  EXPECT_EQ(designs(all.json()), designs(rest.json()));
  // A checkpoint of another study is refused.
  const Outcome other = run({"optimise", study, "-o", parts, "--resume", "--set", "variable[0].max='15 cm'"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("--resume"), std::string::npos) << other.err;
}

TEST(Optimise, SaysWhichConstraintIsNeverMet) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", kEven);
  const std::string folder = (scratch.path() / "out").string();
  const std::vector<std::string> words = {"optimise", study, "-o", folder, "--set", "constraint[0].max=0.5"};
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("\"well conditioned\" was never met"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("least violation"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder + "/chosen.toml"));
}

TEST(Optimise, WeightsChooseAlongTheFront) {
  const ScratchDirectory scratch;
  const std::string study = scratch.file("even.toml", kEven);
  const auto length = [&](const char* weights) {
    const Outcome outcome = run({"optimise", study, "-o", (scratch.path() / "out").string(), "--weights",
                                 weights, "--json", "--samples", "0"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.json().at("chosen").at("objectives").at("length").get<double>();
  };
  EXPECT_LT(length("length=1,worst=0"), length("length=0,worst=1"));
  const Outcome wrong = run({"optimise", study, "--weights", "lenght=1"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("length"), std::string::npos);
}

// The published optimum of the five-bar, of two designs that tie the one with the larger circle.
TEST(Optimise, FindsThePublishedFiveBar) {
  const ScratchDirectory scratch;
  const Outcome outcome = run({"optimise", "five-bar-grid", "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json chosen = outcome.json().at("chosen");
  EXPECT_NEAR(chosen.at("variables").at("a1").get<double>(), 0.10, 1e-12);
  EXPECT_NEAR(chosen.at("variables").at("a2").get<double>(), 0.15, 1e-12);
  EXPECT_NEAR(chosen.at("variables").at("a3").get<double>(), 0.03, 1e-12);
  EXPECT_EQ(chosen.at("objectives").at("bad_points").get<double>(), 272.0);
  EXPECT_EQ(outcome.json().at("search").at("evaluations").get<int>(), 60);
}

// d/D for the range 0..0.9 (Görgülü 2018, section 7.3, as corrected).
TEST(Optimise, FindsThePublishedSection) {
  const ScratchDirectory scratch;
  const Outcome outcome = run({"optimise", "r-cube-section", "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(outcome.json().at("chosen").at("variables").at("ratio").get<double>(), 0.7636, 1e-3);
}

TEST(Optimise, ExplainsMistakesInStudies) {
  const ScratchDirectory scratch;
  std::string text = kEven;
  text.replace(text.find("condition_number"), 16, "condition_numbre");
  const Outcome outcome = run({"optimise", scratch.file("even.toml", text)});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("even.toml:17"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("condition_number"), std::string::npos) << outcome.err;
  EXPECT_EQ(run({"optimise", "no-such-study"}).status, 2);
}

TEST(FiguresVerb, ListsWhatStudiesMayAskFor) {
  const Outcome outcome = run({"figures", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(outcome.json().at("figures").size(), 30U);
  EXPECT_EQ(run({"figures"}).status, 0);
}

}  // namespace
}  // namespace zwidth::testing
