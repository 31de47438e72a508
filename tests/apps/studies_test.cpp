#include <filesystem>
#include <gtest/gtest.h>

#include "run_command.h"

namespace zwidth::testing {
namespace {

namespace fs = std::filesystem;

Outcome optimise_a_little(const std::string& study, const fs::path& folder) {
  return run({"optimise", study, "-o", folder.string(), "--json", "--set", "search.generations=2", "--set",
              "search.population=24", "--samples", "20"});
}

// Every study that comes with zwidth runs, whether or not so few designs hold one that meets all constraints.
TEST(Studies, RunWithASmallBudget) {
  const ScratchDirectory scratch;
  int count = 0;
  for (const fs::directory_entry& file : fs::directory_iterator(ZWIDTH_STUDIES)) {
    if (file.path().extension() != ".toml") continue;
    ++count;
    const std::string name = file.path().stem();
    EXPECT_EQ(run({"check", name}).status, 0) << name;
    const fs::path folder = scratch.path() / name;
    const Outcome outcome = optimise_a_little(name, folder);
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 1) << name << ": " << outcome.err;
    EXPECT_EQ(outcome.json().at("status"), outcome.status == 0 ? "found" : "infeasible") << name;
    for (const char* written : {"index.html", "pareto.json", "history.csv", "checkpoint"}) {
      EXPECT_TRUE(fs::exists(folder / written)) << name << ": " << written;
    }
    EXPECT_EQ(fs::exists(folder / "chosen.toml"), outcome.status == 0) << name;
    if (outcome.status == 0) {
      EXPECT_EQ(run({"check", (folder / "chosen.toml").string()}).status, 0) << name;
    }
  }
  EXPECT_GE(count, 8);
}

// A device that is in none of the sources, from its file and a study of it.
TEST(Studies, AskAboutADeviceOfTheUsersOwn) {
  const ScratchDirectory scratch;
  const std::string study = ZWIDTH_EXAMPLES "/studies/lamps.toml";
  EXPECT_EQ(run({"check", study}).status, 0);
  const Outcome outcome = optimise_a_little(study, scratch.path());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json document = outcome.json(), chosen = document.at("chosen");
  EXPECT_GT(document.at("pareto").size(), 3U);
  // What the study says of the chosen design, the device says of itself.
  const std::string bar = std::to_string(chosen.at("variables").at("bar").get<double>());
  const Outcome at = run({"at", (scratch.path() / "chosen.toml").string(), "--joints", "0,0,0", "--json"});
  ASSERT_EQ(at.status, 0) << at.err;
  EXPECT_NEAR(at.json().at("jacobian")[0][0].get<double>(), std::stod(bar), 1e-5);
}

}  // namespace
}  // namespace zwidth::testing
