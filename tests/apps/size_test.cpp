#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "run_command.h"

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

const Json& demand(const Json& document, int joint, const char* kind) {
  return document["joints"][static_cast<std::size_t>(joint - 1)]["demands"][kind];
}

TEST(Size, TheSevenDofArmMeetsWhatItsSourceAsksButForTwoMotorsAndTheWrist) {  // Baser 2006, section 5.1
  const Outcome outcome = run({"size", "seven-dof", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const Json document = outcome.json();
  EXPECT_EQ(document["cases"].size(), 18u);
  const double peak[] = {5.080, 4.226, 2.665, 2.364}, continuous[] = {0.886, 0.560, 0.546, 0.530};
  const bool met[] = {true, true, false, false};
  for (int joint = 1; joint <= 4; ++joint) {
    const Json &for_ever = demand(document, joint, "continuous"), &for_short = demand(document, joint, "peak");
    // The source leaves out what the balance leaves of the weight, at most 0.020 N m.
    EXPECT_NEAR(for_short["required"].get<double>(), peak[joint - 1], 0.0205) << joint;
    EXPECT_NEAR(for_ever["required"].get<double>(), continuous[joint - 1], 0.0205) << joint;
    EXPECT_TRUE(for_short["ok"].get<bool>()) << joint;
    EXPECT_EQ(for_ever["ok"].get<bool>(), met[joint - 1]) << joint;
  }
  for (const int joint : {5, 6}) {
    EXPECT_EQ(demand(document, joint, "peak")["limited_by"], "gearhead");
    EXPECT_NEAR(demand(document, joint, "peak")["available"].get<double>(), 0.225, 1e-12);
  }
  EXPECT_TRUE(document.contains("notes"));  // the moments are not physics
}

TEST(Size, MomentsAsTheyAreLetTheFourthMotorSuffice) {
  const Json document = run({"size", "seven-dof", "--set", "load.moment_frame=base", "--json"}).json();
  EXPECT_FALSE(document.contains("notes"));
  EXPECT_FALSE(demand(document, 3, "continuous")["ok"].get<bool>());
  EXPECT_TRUE(demand(document, 4, "continuous")["ok"].get<bool>());
}

// Baser 2006, section 5.2: with the printed masses A = -1450 g mm and B = -600 g mm are left, and exact balance
// wants l3 = 127.46 mm and d4 = 43.95 mm.
TEST(Size, SaysWhatIsLeftOfTheStaticBalanceAndWhichCounterweightTakesIt) {
  const Json balance = run({"size", "seven-dof", "--json"}).json()["balance"];
  EXPECT_NEAR(balance["joints"][1]["moment"][2].get<double>(), -1450e-6, 1e-9);
  EXPECT_NEAR(balance["joints"][3]["moment"][2].get<double>(), -600e-6, 1e-9);
  for (const Json& joint : balance["joints"]) EXPECT_LE(joint["gravity"].get<double>(), 0.0205);
  EXPECT_NEAR(balance["moving_mass"].get<double>(), 1.23, 1e-12);
  EXPECT_LT(balance["stray"].get<double>(), 2.0 * 1.7e-3);
  EXPECT_LE(balance["weight_at_tool"][0].get<double>(), balance["weight_at_tool"][1].get<double>());
  const Json& counterweight = balance["counterweight"];
  EXPECT_EQ(counterweight["body"], 4);
  EXPECT_EQ(counterweight["turns_with"], "arm/theta4");
  const double l3 = -counterweight["pivot"][2].get<double>(),
               d4 = -l3 - counterweight["centre"][2].get<double>();
  EXPECT_NEAR(l3, 0.12746, 5e-6);
  EXPECT_NEAR(d4, 0.04395, 5e-6);
  EXPECT_LT(counterweight["residual"].get<double>(), 1e-15);
  const std::string page = run({"size", "seven-dof"}).out;
  EXPECT_NE(page.find("Static balance"), std::string::npos);
  EXPECT_NE(page.find("body[4]"), std::string::npos) << page;
}

TEST(Size, BalancesArmsOfOtherMassesAsTheOracleDoes) {
  int compared = 0;
  for (const Json& one : Json::parse(read_text(std::string(ZWIDTH_TEST_DATA) + "/seven-dof-drives.json"))) {
    const bool residuals = one["quantity"] == "balance_residuals",
               moved = one["quantity"] == "balancing_counterweight";
    if ((!residuals && !moved) || compared >= 4) continue;
    ++compared;
    const auto in = [&](const char* key) { return one["inputs"][key].get<double>(); };
    std::vector<std::string> arguments{"size", "seven-dof", "--json"};
    const auto set = [&](const std::string& key, const std::string& value) {
      arguments.insert(arguments.end(), {"--set", key + "=" + value});
    };
    const auto along = [](double z) { return "[0, 0, " + std::to_string(z) + "]"; };
    const double l1 = in("l1_m");
    set("joint[2].d", std::to_string(l1));
    const char* masses[] = {"m1_kg", "m3_kg", "m4_kg", "mL_kg", "mc_kg"};
    for (int i = 0; i < 5; ++i) set("body[" + std::to_string(i) + "].mass", std::to_string(in(masses[i])));
    set("body[0].centre", along(in("l2_m")));
    set("body[1].pivot", along(l1 - in("l4_m")));
    set("body[1].centre", along(l1 - in("l4_m") - in("d2_m")));
    set("body[2].centre", along(l1 + in("d3_m")));
    set("body[3].centre", along(l1 + in("d1_m")));
    set("body[4].pivot", along(-in("l3_m")));
    set("body[4].centre", along(-in("l3_m") - in("d4_m")));
    const Json balance = run(arguments).json()["balance"];
    if (residuals) {
      EXPECT_NEAR(balance["joints"][1]["moment"][2].get<double>(), one["value"][0].get<double>(), 1e-12);
      EXPECT_NEAR(balance["joints"][3]["moment"][2].get<double>(), one["value"][1].get<double>(), 1e-12);
    } else {
      const Json& body = balance["counterweight"];
      EXPECT_EQ(body["body"], 4);
      EXPECT_NEAR(-body["pivot"][2].get<double>(), one["value"]["l3_m"].get<double>(), 1e-12);
      EXPECT_NEAR(body["pivot"][2].get<double>() - body["centre"][2].get<double>(),
                  one["value"]["d4_m"].get<double>(), 1e-12);
    }
  }
  EXPECT_EQ(compared, 4);
}

TEST(Size, ALoadIsNamedOrGivenInNumbers) {
  const std::string joints = "0,90deg,60deg,45deg,90deg,90deg,90deg";
  const Json by_name =
      run({"size", "seven-dof", "--load", "10 N along x", "--posture", "critical 1", "--json"}).json();
  const Json in_numbers = run({"size", "seven-dof", "--load", "10,0,0,0.5,0.5,0.5", "--moment-frame",
                               "published", "--kind", "peak", "--joints", joints, "--json"})
                              .json();
  ASSERT_EQ(by_name["cases"].size(), 1u);
  EXPECT_EQ(by_name["cases"][0]["torques"], in_numbers["cases"][0]["torques"]);
  EXPECT_EQ(in_numbers["load"].size(), 6u);
  const Json at = run({"at", "seven-dof", "--joints", joints, "--load", "0,0,5,0,0,0.1", "--json"}).json();
  const Json sized = run({"size", "seven-dof", "--load", "0,0,5,0,0,0.1", "--joints", joints, "--json"}).json();
  for (std::size_t j = 0; j < 7; ++j) {
    EXPECT_NEAR(sized["cases"][0]["torques"][j].get<double>(), at["torques"][j].get<double>(), 1e-12);
  }
}

TEST(Size, FitsEightyColumns) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"size", "seven-dof"}, std::vector<std::string>{"size", "delta"}}) {
    const std::string text = run(arguments).out;
    int column = 0;
    for (const char c : text) {
      if (c == '\n') {
        EXPECT_LE(column, 80) << arguments[1];
        column = 0;
      } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
        ++column;
      }
    }
  }
}

// A position leaves the posture of an arm open: it is that nearest to home, as of `at --position`.
TEST(Size, AtAPositionTakesThePostureOfAt) {
  const Json at = run({"at", "seven-dof", "--position", "0.3,0,0.1", "--load", "1,2,3", "--json"}).json();
  const Json size = run({"size", "seven-dof", "--position", "0.3,0,0.1", "--load", "1,2,3", "--json"}).json();
  ASSERT_EQ(size["joints"].size(), 7U);
  EXPECT_EQ(size["where"], "position");
  for (std::size_t j = 0; j < 7; ++j)
    EXPECT_NEAR(size["joints"][j]["required"].get<double>(), std::abs(at["torques"][j].get<double>()), 1e-9)
        << j;
  EXPECT_EQ(run({"size", "seven-dof", "--position", "3,0,0"}).status, 1);
}

TEST(Size, WrongLoadsAndPosturesAreExplained) {
  struct Mistake {
    std::vector<std::string> arguments;
    const char* rule;
  };
  const Mistake mistakes[] = {
      {{"size", "delta", "--load", "1,2"}, "has 2 entries"},
      {{"size", "delta", "--load", "0,0,1,0,0,1"}, "does not turn"},
      {{"size", "five-bar", "--load", "1,2,3"}, "has 3 entries"},
      {{"size", "delta", "--load", "push"}, "has no [[load]]"},
      {{"size", "seven-dof", "--load", "nan,0,0"}, "nan"},
      {{"size", "seven-dof", "--load", "10 N along w"}, "10 N along w"},
      {{"size", "seven-dof", "--posture", "critical 9"}, "is no [[posture]]"},
      {{"size", "seven-dof", "--load", "0,0,1", "--kind", "peek"}, "did you mean \"peak\"?"},
      {{"size", "seven-dof", "--joints", "0,1"}, "give 7 values"},
  };
  for (const Mistake& mistake : mistakes) {
    const Outcome outcome = run(mistake.arguments);
    EXPECT_EQ(outcome.status, 2) << mistake.arguments.back();
    EXPECT_EQ(outcome.out, "") << mistake.arguments.back();
    EXPECT_NE(outcome.err.find(mistake.rule), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace zwidth::testing
