#include "zwidth/description/problem.h"

#include <gtest/gtest.h>

namespace zwidth {
namespace {

TEST(Problem, NamesPlaceKeyValueRuleAndRemedy) {
  const Problem problem{.file = "devices/x.toml",
                        .line = 12,
                        .column = 3,
                        .key = "mechanism.forearm",
                        .value = "\"-80 mm\"",
                        .rule = "must be positive",
                        .advice = "give the length"};
  EXPECT_EQ(to_string(problem),
            "devices/x.toml:12:3: mechanism.forearm = \"-80 mm\": must be positive; give the length");
}

TEST(Problem, LeavesOutWhatThereIsNot) {
  EXPECT_EQ(to_string({.file = "x.toml", .rule = "is empty"}), "x.toml: is empty");
  EXPECT_EQ(to_string({.key = "drive", .rule = "is missing"}), "drive: is missing");
}

TEST(Problem, SendsNoControlCharactersToATerminal) {
  const std::string text = to_string({.file = "a\x1b[2Jb", .key = "k", .value = "\x07", .rule = "is\nwrong"});
  for (const char c : text) EXPECT_TRUE(c >= ' ' && c != 0x7F) << static_cast<int>(c);
}

TEST(DescriptionError, SaysEverythingAtOnce) {
  const DescriptionError error({{.file = "a", .rule = "one"}, {.file = "b", .rule = "two"}});
  EXPECT_STREQ(error.what(), "a: one\nb: two");
  EXPECT_EQ(error.problems().size(), 2U);
}

TEST(Nearest, FindsTypingErrors) {
  const std::vector<std::string> keys{"base_radius", "upper_arm", "forearm", "platform_radius"};
  EXPECT_EQ(nearest_names("foream", keys), std::vector<std::string>{"forearm"});
  EXPECT_EQ(nearest_names("forarem", keys), std::vector<std::string>{"forearm"});
  EXPECT_EQ(nearest_names("radius", keys), (std::vector<std::string>{"base_radius", "platform_radius"}));
  EXPECT_TRUE(nearest_names("zzzzzz", keys).empty());
  EXPECT_TRUE(nearest_names("", keys).empty());
  EXPECT_TRUE(nearest_names(std::string(1000000, 'x'), keys).empty());
}

TEST(Nearest, SuggestsOrLists) {
  EXPECT_EQ(suggest("dleta", {"delta", "legs"}), "did you mean \"delta\"?");
  EXPECT_EQ(suggest("zzzz", {"delta", "legs"}), "known are \"delta\" and \"legs\"");
  EXPECT_EQ(suggest("zzzz", {}), "there are none to choose from");
}

}  // namespace
}  // namespace zwidth
