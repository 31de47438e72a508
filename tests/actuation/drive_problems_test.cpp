#include "zwidth/actuation/drive_problems.h"

#include <gtest/gtest.h>
#include <random>
#include <set>

#include "support/drives.h"

#include "zwidth/actuation/capstan.h"
#include "zwidth/actuation/drive.h"
#include "zwidth/description/units.h"

namespace zwidth {
namespace {

const Interval kRange = {-0.6, 1.5};

CapstanDescription& capstan(DriveDescription& drive) {
  return std::get<CapstanDescription>(drive.transmission);
}

/// The length that an advice names after `words`.
double advised(const Problem& problem, const std::string& words) {
  const std::size_t from = problem.advice.find(words);
  if (from == std::string::npos) return 0.0;
  const std::string rest = problem.advice.substr(from + words.size());
  return parse_quantity(rest.substr(0, rest.find(',')), Dimension::length).value.value_or(0.0);
}

TEST(DriveProblems, PublishedDriveHasNone) {
  EXPECT_TRUE(drive_problems(test::published_drive(), "drive[0]").empty());
}

TEST(DriveProblems, AreEmptyExactlyWhereADriveCanBeBuilt) {
  std::mt19937_64 random(11);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  std::set<std::string> keys;
  int good = 0;
  for (int i = 0; i < 3000; ++i) {
    DriveDescription drive = test::published_drive();
    CapstanDescription& c = capstan(drive);
    c.input_diameter = between(0.5e-3, 20e-3);
    c.lead = between(0.3e-3, 3e-3);
    c.cable.coated_diameter = between(0.2e-3, 2e-3);
    c.centre_distance = 0.5 * (c.input_diameter + c.output_diameter) + between(0.0, 3e-3);
    const std::vector<Problem> problems = drive_problems(drive, "drive[2]");
    const CapstanStatus status = solve_capstan(capstan_dimensions(c, kRange)).status;
    EXPECT_EQ(problems.empty(), status == CapstanStatus::ok);
    EXPECT_EQ(problems.empty(), Drive::try_make(drive, kRange).has_value());
    good += problems.empty() ? 1 : 0;
    for (const Problem& problem : problems) {
      keys.insert(problem.key);
      EXPECT_FALSE(problem.rule.empty() || problem.advice.empty()) << problem.key;
    }
  }
  EXPECT_GT(good, 100);
  EXPECT_EQ(keys,
            (std::set<std::string>{"drive[2].transmission.cable.coated_diameter",
                                   "drive[2].transmission.centre_distance", "drive[2].transmission.lead"}));
}

TEST(DriveProblems, AdviceMendsThem) {
  DriveDescription drive = test::published_drive();
  capstan(drive).centre_distance = 80.3e-3;
  std::vector<Problem> problems = drive_problems(drive, "drive[0]");
  ASSERT_EQ(problems.size(), 1u);
  const std::string& rule = problems[0].rule;
  capstan(drive).centre_distance =
      parse_quantity(rule.substr(rule.find("touch at ") + 9), Dimension::length).value.value_or(0.0);
  EXPECT_TRUE(drive_problems(drive, "drive[0]").empty());
  EXPECT_LT(capstan(drive).centre_distance, 80.3866e-3) << "and no farther than needed";

  drive = test::published_drive();
  capstan(drive).centre_distance = 90e-3;
  capstan(drive).cable.coated_diameter = 1.5e-3;
  problems = drive_problems(drive, "drive[0]");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "drive[0].transmission.cable.coated_diameter");
  DriveDescription thinner = drive, coarser = drive;
  capstan(thinner).cable.coated_diameter = advised(problems[0], "cable of at most ");
  capstan(coarser).lead = advised(problems[0], "lead of at least ");
  EXPECT_GT(capstan(thinner).cable.coated_diameter, 0.9e-3);
  EXPECT_LT(capstan(coarser).lead, 1.6e-3);
  EXPECT_TRUE(drive_problems(thinner, "drive[0]").empty());
  EXPECT_TRUE(drive_problems(coarser, "drive[0]").empty());
}

TEST(DriveProblems, OfADeviceNameTheDrive) {
  Description device;
  device.drives = {test::published_drive(), test::published_drive()};
  EXPECT_TRUE(drive_problems(device).empty());
  capstan(device.drives[1]).centre_distance = 80.3e-3;
  const std::vector<Problem> problems = drive_problems(device);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "drive[1].transmission.centre_distance");
}

}  // namespace
}  // namespace zwidth
