#include <gtest/gtest.h>

#include "run_command.h"

namespace zwidth::testing {
namespace {

TEST(Show, ReadsBackToTheSame) {
  const Outcome first = run({"show", "delta"});
  ASSERT_EQ(first.status, 0) << first.err;
  const ScratchDirectory scratch;
  const Outcome second = run({"show", scratch.file("d.toml", first.out)});
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_EQ(first.out, second.out);
}

TEST(Show, LegsReadBackToTheSame) {
  const Outcome first = run({"show", "delta", "--as", "legs"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_NE(first.out.find("[[leg"), std::string::npos);
  const ScratchDirectory scratch;
  const Outcome second = run({"show", scratch.file("d.toml", first.out)});
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_EQ(first.out, second.out);
}

TEST(Show, HasTheOverrides) {
  const Outcome outcome = run({"show", "delta", "--set", "mechanism.forearm=170 mm"});
  EXPECT_NE(outcome.out.find("forearm = \"170 mm\""), std::string::npos) << outcome.out;
}

TEST(Show, TakesTheStandardInput) {
  const std::string text = run({"show", "delta"}).out;
  const Outcome outcome = run({"show", "-"}, {.input = text});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, text);
}

TEST(Show, UnknownForm) {
  EXPECT_EQ(run({"show", "delta", "--as", "urdf"}).status, 2);
}

}  // namespace
}  // namespace zwidth::testing
