#include <cmath>
#include <gtest/gtest.h>
#include <regex>

#include "run_command.h"

// Arms through the command: joints of the hand, nearest points, linkages of cylinders, slides.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

// A number with a negative power of ten, or a zero with a sign.
bool has_dust(const std::string& text) {
  return std::regex_search(text, std::regex("[0-9]e-[0-9]|[ \\[]-0[,\\] ]"));
}

// ---------------------------------------------------------------------------------------- joints of the hand

TEST(FreeJoints, AreAtHomeUnlessGiven) {
  const Json all = run({"at", "pneumatic-3", "--joints", "10deg,5deg,-3deg,0,0", "--json"}).json(),
             driven = run({"at", "pneumatic-3", "--joints", "10deg,5deg,-3deg", "--json"}).json();
  EXPECT_EQ(all, driven);
  EXPECT_EQ(driven["joints"].size(), 5U);
  EXPECT_EQ(driven["free_joint_names"], Json({"theta4", "theta5"}));
  EXPECT_TRUE(run({"at", "delta", "--joints", "0,0,0", "--json"}).json()["free_joint_names"].empty());
  const Json turned = run({"at", "pneumatic-3", "--joints", "10deg,5deg,-3deg,40deg,0", "--json"}).json();
  EXPECT_NE(turned["orientation"], driven["orientation"]);
  const Json moving =
      run({"at", "pneumatic-3", "--joints", "10deg,5deg,-3deg", "--rate", "1,0,0", "--json"}).json();
  EXPECT_NEAR(moving["velocity"][1].get<double>(), moving["jacobian"][1][0].get<double>(), 1e-15);
  const std::string page = run({"at", "pneumatic-3", "--joints", "0,0,0"}).out;
  EXPECT_TRUE(has(page, "theta4     0°    free")) << page;
  EXPECT_TRUE(has(page, "theta3     0°  active")) << page;
}

TEST(FreeJoints, AreNamedWhereTheCountIsWrong) {
  const Outcome outcome = run({"at", "pneumatic-3", "--joints", "0,0"});
  EXPECT_EQ(outcome.status, 2);
  for (const char* words : {"has 2 entries", "3 values", "theta1, theta2, theta3", "or 5", "theta4, theta5"})
    EXPECT_TRUE(has(outcome.err, words)) << outcome.err;
  EXPECT_EQ(run({"at", "pneumatic-3", "--joints", "0,0,0,0"}).status, 2);
  EXPECT_TRUE(has(run({"at", "delta", "--joints", "0,0"}).err, "3 values, one for each active joint"));
  EXPECT_TRUE(has(run({"check", "pneumatic-3"}).out, "hand"));
  EXPECT_EQ(run({"check", "pneumatic-3", "--json"}).json()["devices"][0]["free_joints"], 2);
}

TEST(FreeJoints, StayWhereThePostureHasThemInSizing) {
  // A wrist turned sideways moves the mass of the handle's fork: theta3 holds another weight.
  const auto gravity = [](const char* joints) {
    return run({"size", "pneumatic-3", "--set", "body[3].centre=[\"198 mm\", \"-140 mm\", 0]", "--joints",
                joints, "--json"})
        .json()["joints"][2]["gravity"]
        .get<double>();
  };
  EXPECT_NEAR(gravity("0,0,0"), gravity("0,0,0,0,0"), 1e-12);
  const Json at = run({"at", "pneumatic-3", "--set", "body[3].centre=[\"198 mm\", \"-140 mm\", 0]", "--joints",
                       "0,0,20deg,50deg,0", "--json"})
                      .json();
  EXPECT_NEAR(gravity("0,0,20deg,50deg,0"), std::abs(at["gravity_torques"][2].get<double>()), 1e-12);
  EXPECT_GT(std::abs(gravity("0,0,20deg,50deg,0") - gravity("0,0,20deg")), 1e-5);
}

// ----------------------------------------------------------------------------------------------- nearest
// points

TEST(Nearest, LeavesAtHomeWhatNeedNotMove) {
  const Json arm = run({"at", "seven-dof", "--position", "1,0,0", "--json"}).json()["nearest_reachable"];
  // As far as theta4 lets it, straight to the point; the wrist's home is 90 degrees.
  const double reach = 2.0 * 0.25 * std::cos(M_PI / 8.0);
  EXPECT_NEAR(arm["position"][0].get<double>(), reach, 1e-9);
  EXPECT_EQ(arm["position"][1], 0.0);
  EXPECT_EQ(arm["position"][2], 0.0);
  for (const int j : {0, 2}) EXPECT_EQ(arm["joints"][j], 0.0) << arm;
  for (const int j : {4, 5, 6}) EXPECT_EQ(arm["joints"][j], M_PI / 2.0) << arm;
  const Outcome pneumatic = run({"at", "pneumatic-3", "--position", "0.3,0,0.1"});
  EXPECT_TRUE(has(pneumatic.out, "30deg,30deg\n")) << pneumatic.out;  // nothing of the wrist, which is at home
  const Json joints =
      run({"at", "pneumatic-3", "--position", "0.3,0,0.1", "--json"}).json()["nearest_reachable"]["joints"];
  EXPECT_EQ(joints[3], 0.0);
  EXPECT_EQ(joints[4], 0.0);
}

// No posture of a raster over the joints comes nearer, and none a little beside it.
TEST(Nearest, IsNearest) {
  struct Case {
    const char* device;
    const char* position;
    Json target;
  };
  for (const Case& one :
       {Case{"delta", "0.3,0.1,0.2", {0.3, 0.1, 0.2}}, Case{"delta", "1,0,0", {1, 0, 0}},
        Case{"r-cube", "-0.5,0.2,0.3", {-0.5, 0.2, 0.3}}, Case{"five-bar", "0.4,0.1", {0.4, 0.1, 0}},
        Case{"seven-dof-locked", "-0.6,0.2,0.1", {-0.6, 0.2, 0.1}},
        Case{"pneumatic-1", "0.9,0.3,0.5", {0.9, 0.3, 0.5}}}) {
    const Json nearest =
        run({"at", one.device, "--position", one.position, "--json"}).json()["nearest_reachable"];
    const auto distance = [&](const Json& p) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += std::pow(p[k].get<double>() - one.target[k].get<double>(), 2);
      return std::sqrt(sum);
    };
    EXPECT_NEAR(nearest["distance"].get<double>(), distance(nearest["position"]), 1e-12);
    const auto joints = nearest["joints"].get<std::vector<double>>();
    for (size_t j = 0; j < joints.size(); ++j) {
      for (const double step : {-1e-3, 1e-3}) {
        std::string text;
        for (size_t i = 0; i < joints.size(); ++i)
          text += (i > 0 ? "," : "") + Json(joints[i] + (i == j ? step : 0.0)).dump();
        const Json beside = run({"at", one.device, "--joints", text, "--only", "position", "--json"}).json();
        if (beside["status"] != "reached" && beside["status"] != "degraded") continue;
        EXPECT_GE(distance(beside["position"]), nearest["distance"].get<double>() - 1e-10)
            << one.device << " " << one.position << " joint " << j;
      }
    }
  }
}

TEST(Nearest, OfAPointFarAwayIsTheFarthestThatWay) {
  const Json huge = run({"at", "delta", "--position", "1e300,0,0", "--json"}).json()["nearest_reachable"],
             far = run({"at", "delta", "--position", "1e5,0,0", "--json"}).json()["nearest_reachable"];
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(huge["position"][k].get<double>(), far["position"][k].get<double>(), 1e-6);
  EXPECT_DOUBLE_EQ(huge["distance"].get<double>(), 1e300);
  const Json arm =
      run({"at", "seven-dof", "--position", "1e300,1e300,0", "--json"}).json()["nearest_reachable"]["position"];
  EXPECT_NEAR(arm[0].get<double>(), arm[1].get<double>(), 1e-9);
  EXPECT_NEAR(std::hypot(arm[0].get<double>(), arm[1].get<double>()), 0.5 * std::cos(M_PI / 8.0), 1e-9);
}

// --------------------------------------------------------------------------------------------- arm and
// cylinder

std::vector<std::string> synthesise(const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"synthesise", "arm-cylinder"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return arguments;
}

const std::vector<std::string> kLong = {"--stroke", "100mm", "--retracted", "228.1mm", "--range", "25deg"};

std::vector<std::string> and_lever(std::vector<std::string> options, const char* lever) {
  options.insert(options.end(), {"--lever", lever});
  return options;
}

TEST(Synthesis, MountsNothingWithADeadPoint) {
  const Outcome some = run(synthesise(and_lever(kLong, "400mm")));
  EXPECT_EQ(some.status, 0);
  EXPECT_TRUE(has(some.out, "a dead point in the range"));
  EXPECT_TRUE(has(some.out, "l0 = \"151.580657798 mm\"")) << some.out;
  EXPECT_FALSE(has(some.out, "l0 = \"573")) << some.out;
  std::vector<std::string> as_json = synthesise(and_lever(kLong, "400mm"));
  as_json.emplace_back("--json");
  const Json designs = run(as_json).json()["designs"];
  EXPECT_EQ(designs[0]["status"], "ok");
  EXPECT_EQ(designs[1]["status"], "dead_point");
  const Outcome none = run(synthesise(and_lever(kLong, "640mm")));
  EXPECT_EQ(none.status, 1);
  EXPECT_TRUE(has(none.err, "dead_point"));
  EXPECT_TRUE(has(none.err, "shorter lever"));
  EXPECT_FALSE(has(none.out, "For a device file"));
}

TEST(Synthesis, HasNoLinesForADeviceFileWhereThereIsNoDesign) {
  const Outcome none = run(synthesise(and_lever(kLong, "4m")));
  EXPECT_EQ(none.status, 1);
  EXPECT_TRUE(has(none.err, "infeasible_design"));
  EXPECT_FALSE(has(none.out, "For a device file"));
}

TEST(Synthesis, SaysThatACylinderIsLongerThanItsStroke) {
  const std::vector<std::string> options = {"--stroke", "100mm", "--retracted", "90mm", "--range", "60deg"};
  EXPECT_TRUE(has(run(synthesise(options)).out, "Not to be built"));
  std::vector<std::string> as_json = synthesise(options);
  as_json.emplace_back("--json");
  const Outcome outcome = run(as_json);
  EXPECT_EQ(outcome.json()["buildable"], false);
  EXPECT_TRUE(has(outcome.err, "longer than"));
  EXPECT_FALSE(has(run(synthesise(kLong)).out, "Not to be built"));
}

// What is printed for a device file passes the checks of one, to the last margin.
TEST(Synthesis, ItsLinesMakeADevice) {
  const std::vector<std::string> options = {"--cylinder", "airpel-m9d12.5u", "--retracted",
                                            "75mm",       "--range",         "30deg"};
  const std::string page = run(synthesise(options)).out;
  int tried = 0;
  for (size_t at = page.find("mount = "); at != std::string::npos; at = page.find("mount = ", at + 1)) {
    const std::string mount = page.substr(at + 8, page.find('\n', at) - at - 8);
    const Outcome outcome = run({"check", "pneumatic-3", "--json", "--set", "drive[0].mount=" + mount});
    EXPECT_EQ(outcome.status, 0) << mount << outcome.err;
    EXPECT_TRUE(outcome.json()["devices"][0]["warnings"].empty()) << mount << outcome.out;
    ++tried;
  }
  EXPECT_GE(tried, 5) << page;
}

// ---------------------------------------------------------------------------------------------------------
// sizing

const char* const kSlides = R"([device]
name = "slides"
title = "Three slides at right angles"
source = "chosen: a test"
[mechanism]
type = "serial"
platform = "translation"
source = "chosen"
[[joint]]
name = "up"
type = "prismatic"
alpha = "90 deg"
range = ["-100 mm", "100 mm"]
[[joint]]
name = "across"
type = "prismatic"
theta = "90 deg"
alpha = "90 deg"
range = ["-100 mm", "100 mm"]
[[joint]]
name = "along"
type = "prismatic"
range = ["-100 mm", "100 mm"]
[[body]]
on = "platform"
mass = "200 g"
centre = [0, 0, 0]
inertia = ["10 g cm^2", "10 g cm^2", "10 g cm^2"]
source = "chosen"
[[drive]]
joints = "all"
motor = "maxon-ec-max-40-120w-48v"
encoder = "maxon-mr-1024"
amplifier = "maxon-escon-module-50-5"
supply_voltage = "48 V"
proportional_gain = 1.23
integral_gain = 6280
peak_factor = 3.6
transmission = { type = "ratio", ratio = 100, source = "chosen: a pinion of 10 mm radius" }
source = "chosen"
)";

TEST(Slides, PushWithForcesInNewtons) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("slides.toml", kSlides);
  const Outcome page = run({"size", file});
  ASSERT_EQ(page.status, 0) << page.err;
  for (const char* words : {"18.60 N  ", "Force ─", "at 18.60 N ─", "felt mass", "✓ 18.6 N, 101 g", "1.961 N"})
    EXPECT_TRUE(has(page.out, words)) << words << page.out;
  EXPECT_FALSE(has(page.out, "18.60 N m"));
  EXPECT_FALSE(has_dust(page.out)) << page.out;
  EXPECT_TRUE(has(run({"size", file, "--load", "1,2,3"}).out, "Force for ever"));
  const Outcome report = run({"report", file, "-o", (scratch.path() / "out").string()});
  ASSERT_EQ(report.status, 0) << report.err;
  for (const char* words : {"range of every joint      -100.0 … 100.0 mm", "Joint force 18.60 N continuous",
                            "continuous force", "reflected mass", "force against gravity"})
    EXPECT_TRUE(has(report.out, words)) << words;
  EXPECT_FALSE(has(report.out, "18.60 N m"));
  const std::string html = read_text(scratch.path() / "out" / "report.html");
  EXPECT_TRUE(has(html, "18.60 N per joint"));
}

TEST(PneumaticSizing, TakesPosturesAndLoadsAndSaysWhatIsNotBalanced) {
  const Json document = run({"size", "pneumatic-3", "--joints", "10deg,0,0", "--joints", "0,5deg,20deg",
                             "--load", "1,0,0", "--load", "0,0,3", "--json"})
                            .json();
  EXPECT_EQ(document["where"], "postures");
  EXPECT_EQ(document["loads"].size(), 2U);
  const Json& pull = document["joints"][2]["pull"];
  EXPECT_EQ(pull["load"], "0,0,3");
  // The largest of the four cases, each as `at` has it.
  double most = 0.0;
  for (const char* joints : {"10deg,0,0", "0,5deg,20deg"}) {
    for (const char* load : {"1,0,0", "0,0,3"}) {
      const Json at = run({"at", "pneumatic-3", "--joints", joints, "--load", load, "--json"}).json();
      most = std::max(most, std::abs(at["torques"][2].get<double>()));
    }
  }
  EXPECT_NEAR(document["joints"][2]["required"].get<double>(), most, 1e-12);
  const Json& balance = document["balance"];
  EXPECT_NEAR(balance["moving_mass"].get<double>(), 0.266, 1e-12);
  // theta1 and theta2 turn level; theta3 lifts, and a body of its link can balance it.
  EXPECT_EQ(balance["joints"][0]["gravity"], 0.0);
  EXPECT_NEAR(balance["joints"][2]["gravity"].get<double>(), 0.0184, 1e-4);
  EXPECT_EQ(balance["counterweight"]["on"], "arm/theta3");
  EXPECT_LT(balance["counterweight"]["residual"].get<double>(), 1e-12);
  const std::string page = run({"size", "pneumatic-3"}).out;
  for (const char* words : {"Static balance", "turns level", "least lever", "1.000 nm"})
    EXPECT_TRUE(has(page, words)) << words << page;
  EXPECT_FALSE(has(page, "-0,")) << page;
}

// -------------------------------------------------------------------------------------------------------
// printing

TEST(Printing, ShowsNoDustOfRounding) {
  for (const char* device : {"seven-dof", "seven-dof-locked", "pneumatic-1", "pneumatic-2", "pneumatic-3"}) {
    const std::string text = run({"show", device, "--as", "legs"}).out;
    EXPECT_FALSE(has_dust(text)) << device << text;
  }
  EXPECT_TRUE(has(run({"show", "pneumatic-3"}).out, "bias_pressure = \"20 kPa\""));
}

}  // namespace
}  // namespace zwidth::testing
