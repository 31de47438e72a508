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

TEST(Export, WritesAModelAndWhatItCannotSay) {
  const Outcome mjcf = run({"export", "r-cube", "--to", "mjcf"});
  ASSERT_EQ(mjcf.status, 0) << mjcf.err;
  EXPECT_TRUE(mjcf.out.starts_with("<mujoco model=\"r-cube\">"));
  EXPECT_NE(mjcf.out.find("<weld "), std::string::npos);
  EXPECT_EQ(mjcf.err, "");
  const Outcome urdf = run({"export", "r-cube", "--to", "urdf", "--json"});
  ASSERT_EQ(urdf.status, 0) << urdf.err;
  EXPECT_NE(urdf.err.find("URDF is a tree"), std::string::npos);
  EXPECT_EQ(urdf.json()["notices"].size(), 2u);  // and no inertia of rotors
  EXPECT_NE(urdf.json()["text"].get<std::string>().find("<robot name=\"r-cube\">"), std::string::npos);
  EXPECT_EQ(run({"export", "r-cube", "--to", "stl"}).status, 2);
  for (const char* device : {"delta", "five-bar", "seven-dof", "pneumatic-1", "pneumatic-3"}) {
    for (const char* format : {"mjcf", "urdf"})
      EXPECT_EQ(run({"export", device, "--to", format}).status, 0) << device;
  }
}

}  // namespace
}  // namespace zwidth::testing
