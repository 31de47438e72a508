#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "design/problems.h"

#include "zwidth/design/search.h"

namespace zwidth {
namespace {

class Checkpoint : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("zwidth_checkpoint_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file() const { return folder_ / "run.checkpoint"; }
  std::filesystem::path previous() const { return folder_ / "run.checkpoint.previous"; }

  // Kept after every generation.
  SearchOptions options(SearchAlgorithm algorithm = SearchAlgorithm::nsga2) const {
    return {.algorithm = algorithm,
            .population = 24,
            .generations = 12,
            .seed = 9,
            .checkpoint = file(),
            .checkpoint_seconds = 0.0};
  }

 private:
  std::filesystem::path folder_;
};

SearchProblem problem_for(const SearchAlgorithmInfo& algorithm) {
  if (algorithm.algorithm != SearchAlgorithm::grid) {
    return algorithm.several_objectives ? test::bnh() : test::hyperbola();
  }
  SearchProblem problem{.variables = {{"a", 0.0, 99.0, true}, {"b", 0.0, 119.0, true}},
                        .objectives = {"f1", "f2"},
                        .constraints = {"c"}};
  problem.evaluate = test::row_by_row(2, 3, [](std::span<const double> x, std::span<double> f) {
    f[0] = x[0] + 0.01 * x[1];
    f[1] = 10.0 - x[1] - x[0];
    f[2] = 50.0 - x[0] - x[1];
  });
  return problem;
}

// The same problem, told to stop in the middle of its work after `rows` evaluations.
SearchProblem stopping_after(const SearchProblem& problem, std::int64_t rows) {
  SearchProblem stopping = problem;
  stopping.evaluate = [evaluate = problem.evaluate, width = problem.outcome_size(), left = rows](
                          std::span<const double> designs, std::span<double> outcomes) mutable {
    left -= static_cast<std::int64_t>(outcomes.size() / width);
    return left >= 0 && evaluate(designs, outcomes);
  };
  return stopping;
}

void expect_same(const SearchResult& a, const SearchResult& b, std::string_view what) {
  EXPECT_EQ(a.end, b.end) << what;
  EXPECT_EQ(a.designs, b.designs) << what;
  EXPECT_EQ(a.front, b.front) << what;
  EXPECT_EQ(a.reference, b.reference) << what;
  EXPECT_EQ(a.evaluations, b.evaluations) << what;
  ASSERT_EQ(a.history.size(), b.history.size()) << what;
  for (std::size_t i = 0; i < a.history.size(); ++i) {
    EXPECT_EQ(a.history[i].number, b.history[i].number) << what;
    EXPECT_EQ(a.history[i].evaluations, b.history[i].evaluations) << what << i;
    EXPECT_EQ(a.history[i].feasible_share, b.history[i].feasible_share) << what;
    EXPECT_TRUE(a.history[i].hypervolume == b.history[i].hypervolume ||
                (std::isnan(a.history[i].hypervolume) && std::isnan(b.history[i].hypervolume)))
        << what << i;
  }
  ASSERT_EQ(a.constraints.size(), b.constraints.size());
  for (std::size_t i = 0; i < a.constraints.size(); ++i) {
    EXPECT_EQ(a.constraints[i].held, b.constraints[i].held) << what;
    EXPECT_EQ(a.constraints[i].least_violation, b.constraints[i].least_violation) << what;
  }
}

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

std::string refusal(const SearchProblem& problem, const SearchOptions& options) {
  try {
    search(problem, options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(Checkpoint, ASearchInterruptedTwiceIsTheSearchThatWasNot) {
  for (const SearchAlgorithmInfo& algorithm : search_algorithms()) {
    const SearchProblem problem = problem_for(algorithm);
    SearchOptions kept = options(algorithm.algorithm);
    const SearchResult whole = search(problem, {.algorithm = kept.algorithm,
                                                .population = kept.population,
                                                .generations = kept.generations,
                                                .seed = kept.seed});
    const std::int64_t third = whole.evaluations / 3;
    const SearchResult first = search(stopping_after(problem, third), kept);
    EXPECT_EQ(first.end, SearchEnd::stopped) << algorithm.name;
    ASSERT_FALSE(first.history.empty()) << algorithm.name;
    kept.resume = true;
    const SearchResult second = search(stopping_after(problem, third), kept);
    EXPECT_EQ(second.end, SearchEnd::stopped) << algorithm.name;
    EXPECT_GE(second.history.size(), first.history.size());
    const SearchResult last = search(problem, kept);
    EXPECT_TRUE(last.notes.empty());
    expect_same(whole, last, algorithm.name);
    // Ended, it can be taken up again for nothing more, and for more.
    expect_same(last, search(problem, kept), algorithm.name);
  }
}

TEST_F(Checkpoint, AnEndedSearchGoesOnWithALargerBudget) {
  const SearchProblem problem = test::bnh();
  SearchOptions kept = options();
  search(problem, kept);
  kept.resume = true;
  kept.generations = 20;
  const SearchResult longer = search(problem, kept);
  SearchOptions once = kept;
  once.resume = false;
  once.checkpoint.clear();
  expect_same(search(problem, once), longer, "longer");
}

TEST_F(Checkpoint, ABrokenOneFallsBackToTheOneBefore) {
  const SearchProblem problem = test::bnh();
  SearchOptions kept = options();
  const SearchResult whole = search(problem, kept);
  kept.resume = true;
  const std::string good = read(file());
  std::string altered = good;
  altered[good.size() / 2] = static_cast<char>(altered[good.size() / 2] ^ 1);
  const std::vector<std::pair<std::string, std::string>> damages = {
      {good.substr(0, good.size() / 2), "ends too early"},
      {altered, "checksum"},
      {"", "no checkpoint"},
      {"hello\n", "no checkpoint"},
      {good.substr(0, 30), "ends too early"},
  };
  const std::string before = read(previous());
  for (const auto& [bytes, reason] : damages) {
    write(file(), bytes);
    write(previous(), before);
    const SearchResult resumed = search(problem, kept);
    ASSERT_EQ(resumed.notes.size(), 1u);
    EXPECT_NE(resumed.notes[0].find(reason), std::string::npos) << resumed.notes[0];
    EXPECT_NE(resumed.notes[0].find("going on from the one before, generation"), std::string::npos);
    expect_same(whole, resumed, reason);
  }
  // Killed between the two renames, there is only the one before.
  std::filesystem::remove(file());
  write(previous(), before);
  const SearchResult resumed = search(problem, kept);
  ASSERT_EQ(resumed.notes.size(), 1u);
  EXPECT_NE(resumed.notes[0].find("no such file"), std::string::npos) << resumed.notes[0];
  expect_same(whole, resumed, "missing");
}

TEST_F(Checkpoint, WithoutAUsableOneItSaysSo) {
  SearchOptions kept = options();
  kept.resume = true;
  EXPECT_NE(refusal(test::bnh(), kept).find("no such file"), std::string::npos);
  write(file(), "x");
  write(previous(), "y");
  EXPECT_NE(refusal(test::bnh(), kept).find("it is no checkpoint"), std::string::npos);
}

TEST_F(Checkpoint, OneOfAnotherSearchIsRefusedWithWhatDiffers) {
  SearchProblem problem = test::bnh();
  SearchOptions kept = options();
  search(problem, kept);
  kept.resume = true;
  const auto expect_refused = [&](const SearchProblem& other, const SearchOptions& with,
                                  const std::string& words) {
    const std::string text = refusal(other, with);
    EXPECT_NE(text.find("is of another search"), std::string::npos) << text;
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  SearchOptions with = kept;
  with.seed = 10;
  expect_refused(problem, with, "\"seed 9\" where this one has \"seed 10\"");
  with = kept;
  with.algorithm = SearchAlgorithm::nspso;
  expect_refused(problem, with, "algorithm nsga2");
  with = kept;
  with.population = 40;
  expect_refused(problem, with, "population 24");
  SearchProblem other = problem;
  other.variables[1].max = 2.5;
  expect_refused(other, kept, "\"variable y in [0, 3]\" where this one has \"variable y in [0, 2.5]\"");
  other = problem;
  other.objectives[0] = "mass";
  expect_refused(other, kept, "objective f1");
  other = problem;
  other.identity = "another device";
  expect_refused(other, kept, "another device");
}

TEST_F(Checkpoint, AFolderThatIsNotThereIsSaidAndEndsNothing) {
  SearchOptions kept = options();
  kept.checkpoint = file() / "nowhere" / "run";
  const SearchResult result = search(test::bnh(), kept);
  EXPECT_EQ(result.end, SearchEnd::generations);
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_NE(result.notes[0].find("cannot write the checkpoint"), std::string::npos);
}

}  // namespace
}  // namespace zwidth
