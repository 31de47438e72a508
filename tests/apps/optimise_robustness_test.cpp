#include <csignal>
#include <filesystem>
#include <gtest/gtest.h>

#include "even_study.h"
#include "run_command.h"

/// What befalls long runs: they are killed, interrupted, resumed, spread over ranks, and asked impossible
/// things.

namespace zwidth::testing {
namespace {

namespace fs = std::filesystem;

// Long enough to be interrupted, and quick all the same.
const std::string kLong = even_study(150);

// Five designs by number, and what they are to be.
std::string numbered(const std::string& objective, const std::string& more = "") {
  return "[study]\nname = \"numbered\"\ndevice = \"five-bar\"\n[search]\nalgorithm = \"grid\"\n"
         "[[variable]]\nname = \"n\"\nmin = 0\nmax = 4\ninteger = true\n"
         "[[objective]]\nname = \"small\"\nminimise = \"" +
         objective + "\"\n" + more;
}

class OptimiseRobustness : public ::testing::Test {
 protected:
  std::string folder(const char* name) const { return (scratch_.path() / name).string(); }
  Outcome optimise(const std::string& study, const char* into, std::vector<std::string> more = {},
                   const RunOptions& options = {}) const {
    std::vector<std::string> words = {"optimise", study, "-o", folder(into), "--samples", "0", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, options);
  }
  // Sends `signal` once there are two checkpoints; with that, in the middle of the run.
  Outcome interrupted(const std::string& study, const char* into, int signal) const {
    const fs::path second = fs::path(folder(into)) / "checkpoint.previous";
    return optimise(study, into, {"--checkpoint", "0"},
                    {.signal = signal, .signal_when = [second] { return fs::exists(second); }});
  }

  const ScratchDirectory scratch_;
};

TEST_F(OptimiseRobustness, GoesOnFromTheLastCheckpointWhenItWasKilled) {
  const std::string study = scratch_.file("long.toml", kLong);
  const Outcome whole = optimise(study, "whole");
  ASSERT_EQ(whole.status, 0) << whole.err;
  ASSERT_EQ(interrupted(study, "killed", SIGKILL).status, 128 + SIGKILL);
  ASSERT_FALSE(fs::exists(folder("killed") + "/pareto.json"));
  const Outcome rest = optimise(study, "killed", {"--resume"});
  ASSERT_EQ(rest.status, 0) << rest.err;
  EXPECT_EQ(rest.json().at("pareto"), whole.json().at("pareto"));
  EXPECT_EQ(rest.json().at("search").at("evaluations"), whole.json().at("search").at("evaluations"));
}

TEST_F(OptimiseRobustness, TakesTheCheckpointBeforeABrokenOne) {
  const std::string study = scratch_.file("long.toml", kLong);
  const Outcome whole = optimise(study, "whole");
  ASSERT_EQ(interrupted(study, "killed", SIGKILL).status, 128 + SIGKILL);
  const std::string last = folder("killed") + "/checkpoint";
  fs::resize_file(last, fs::file_size(last) / 2);
  const Outcome rest = optimise(study, "killed", {"--resume"});
  ASSERT_EQ(rest.status, 0) << rest.err;
  EXPECT_NE(rest.err.find("going on from the one before"), std::string::npos) << rest.err;
  EXPECT_EQ(rest.json().at("pareto"), whole.json().at("pareto"));
  // Both broken: an error, and nothing is lost.
  const std::string previous = folder("killed") + "/checkpoint.previous";
  fs::resize_file(last, 10);
  fs::resize_file(previous, 10);
  const Outcome none = optimise(study, "killed", {"--resume"});
  EXPECT_EQ(none.status, 2);
  EXPECT_TRUE(fs::exists(folder("killed") + "/chosen.toml"));
}

TEST_F(OptimiseRobustness, LeavesAResultWhenItIsInterrupted) {
  const std::string study = scratch_.file("long.toml", kLong);
  const Outcome whole = optimise(study, "whole");
  for (const int signal : {SIGINT, SIGTERM}) {
    const char* name = signal == SIGINT ? "interrupted" : "terminated";
    const Outcome part = interrupted(study, name, signal);
    ASSERT_EQ(part.status, 0) << part.err;
    const nlohmann::json search = part.json().at("search");
    EXPECT_EQ(search.at("end"), "stopped") << search;
    EXPECT_LT(search.at("generations").get<int>(), 150);
    EXPECT_EQ(run({"check", folder(name) + "/chosen.toml"}).status, 0);
    const Outcome rest = optimise(study, name, {"--resume"});
    ASSERT_EQ(rest.status, 0) << rest.err;
    EXPECT_EQ(rest.json().at("pareto"), whole.json().at("pareto"));
  }
}

RunOptions two_ranks() {
  return {.environment = {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                          "OMPI_MCA_rmaps_base_oversubscribe=1"},
          .launcher = {MPIEXEC, "-np", "2"}};
}

TEST_F(OptimiseRobustness, GivesTheSameDesignsOnRanksAndThreads) {
  const std::string study = scratch_.file("long.toml", kLong);
  const Outcome one = optimise(study, "one", {"--threads", "1", "--set", "search.generations=10"});
  const Outcome two = optimise(study, "two", {"--threads", "2", "--set", "search.generations=10"});
  const Outcome ranks = optimise(study, "ranks", {"--set", "search.generations=10"}, two_ranks());
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_EQ(ranks.status, 0) << ranks.err;
  EXPECT_EQ(ranks.json().at("search").at("workers"), 2);
  const Outcome page =
      run({"optimise", study, "-o", folder("page"), "--set", "search.generations=2"}, two_ranks());
  EXPECT_EQ(page.out.find('\x1b'), std::string::npos);  // the launcher's terminal is nobody's
  EXPECT_NE(page.out.find("ranks"), std::string::npos);
  for (const char* part : {"pareto", "chosen", "constraints"}) {
    EXPECT_EQ(one.json().at(part), two.json().at(part)) << part;
    EXPECT_EQ(one.json().at(part), ranks.json().at(part)) << part;
  }
}

TEST_F(OptimiseRobustness, SaysAMistakeOnceOnAnyNumberOfRanks) {
  std::string text = kLong;
  text.replace(text.find("condition_number"), 16, "condition_numbre");
  const Outcome wrong = optimise(scratch_.file("wrong.toml", text), "wrong", {}, two_ranks());
  EXPECT_NE(wrong.status, 0);
  const std::size_t first = wrong.err.find("is no figure");
  ASSERT_NE(first, std::string::npos) << wrong.err;
  EXPECT_EQ(wrong.err.find("is no figure", first + 1), std::string::npos) << wrong.err;
  // A mistake that only the rank that drives can see.
  scratch_.file("taken", "");
  const std::string study = scratch_.file("long.toml", kLong);
  const Outcome taken = optimise(study, "taken", {}, two_ranks());
  EXPECT_NE(taken.status, 0);
  EXPECT_NE(taken.err.find("is a file"), std::string::npos) << taken.err;
}

TEST_F(OptimiseRobustness, LeavesOutDesignsThatDivideByZero) {
  const Outcome some = optimise(scratch_.file("some.toml", numbered("n + 1/n")), "some");
  ASSERT_EQ(some.status, 0) << some.err;
  EXPECT_EQ(some.json().at("chosen").at("variables").at("n"), 1.0);
  EXPECT_EQ(some.json().at("constraints")[0].at("held"), 4);
  const Outcome all = optimise(scratch_.file("all.toml", numbered("1/min(n, 0)")), "all");
  EXPECT_EQ(all.status, 1) << all.err;
  EXPECT_EQ(all.json().at("status"), "infeasible");
  EXPECT_EQ(all.json().at("constraints")[0].at("held"), 0);
  EXPECT_EQ(all.json().at("undefined")[0].at("what"), "1/min(n, 0)");
  // What can never have a value is a mistake of the study.
  const Outcome never = optimise(scratch_.file("never.toml", numbered("1/(n - n)")), "never");
  EXPECT_EQ(never.status, 2);
  EXPECT_NE(never.err.find("has no value, whatever n may be"), std::string::npos) << never.err;
}

TEST_F(OptimiseRobustness, SaysThatConstraintsExcludeEachOther) {
  const std::string study =
      scratch_.file("both.toml", numbered("n",
                                          "[[constraint]]\nname = \"large\"\nvalue = \"n\"\nmin = 3\n"
                                          "[[constraint]]\nname = \"little\"\nvalue = \"n\"\nmax = 1\n"));
  const Outcome outcome = run({"optimise", study, "-o", folder("both")});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("never all by one"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("large"), std::string::npos);
  EXPECT_NE(outcome.out.find("little"), std::string::npos);
}

}  // namespace
}  // namespace zwidth::testing
