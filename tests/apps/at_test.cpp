#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include "run_command.h"

namespace zwidth::testing {
namespace {

using nlohmann::json;

/// The largest difference between two documents of the same shape.
double difference(const json& a, const json& b) {
  if (a.is_number() && b.is_number()) return std::abs(a.get<double>() - b.get<double>());
  if (a.is_null() && b.is_null()) return 0.0;
  if (!a.is_structured() || a.type() != b.type() || a.size() != b.size())
    return std::numeric_limits<double>::infinity();
  double worst = 0.0;
  for (auto i = a.begin(), j = b.begin(); i != a.end(); ++i, ++j) worst = std::max(worst, difference(*i, *j));
  return worst;
}

void expect_finite(const json& value, const std::string& path) {
  if (value.is_number_float()) {
    EXPECT_TRUE(std::isfinite(value.get<double>())) << path;
  }
  if (!value.is_structured()) return;
  for (const auto& [key, item] : value.items()) expect_finite(item, path + "." + key);
}

TEST(At, JointsAndLoadGiveTheKeysOfTheContract) {
  const Outcome outcome = run({"at", "delta", "--joints", "10deg,20deg,30deg", "--load", "1,2,3", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json document = outcome.json();
  for (const char* key : {"device", "status", "joints", "passive_joints", "position", "orientation", "jacobian",
                          "condition_number", "manipulability", "torques", "gravity_torques", "force_limits",
                          "mass_matrix", "cartesian_mass", "resolution", "singularity"}) {
    EXPECT_TRUE(document.contains(key)) << key;
  }
  EXPECT_EQ(document["device"], "delta");
  EXPECT_EQ(document["status"], "reached");
  expect_finite(document, "");
}

TEST(At, TorquesAreGravityAndTheTransposedJacobianTimesTheLoadOnTheHand) {
  const json document =
      run({"at", "delta", "--joints", "10deg,20deg,30deg", "--load", "1,2,3", "--json"}).json();
  const double load[] = {1.0, 2.0, 3.0};
  for (size_t j = 0; j < 3; ++j) {
    double expected = document["gravity_torques"][j];
    for (size_t k = 0; k < 3; ++k) expected += document["jacobian"][k][j].get<double>() * load[k];
    EXPECT_NEAR(document["torques"][j].get<double>(), expected, 1e-12);
  }
}

TEST(At, PublishedLengthsGiveTheIndependentlyComputedPosition) {
  // h.fk.pub0 of tests/data/delta-capstan-computed.json.
  const json document = run({"at", "delta", "--joints", "1.138775,-0.255203,0.435359", "--json"}).json();
  const std::vector<double> expected{-0.03931247510428882, -0.08643893500255448, 0.12786043728194746};
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(document["position"][k].get<double>(), expected[k], 1e-12);
}

TEST(At, PositionGivesEveryBranchAndTheSameTool) {
  const Outcome outcome = run({"at", "delta", "--position", "0.02,-0.03,0.12", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  ASSERT_EQ(document["solutions"].size(), 8u);
  EXPECT_TRUE(document["solutions"][0]["within_range"].get<bool>());
  EXPECT_LT(difference(document["solutions"][0]["joints"], document["joints"]), 1e-9);
  EXPECT_LT(difference(document["position"], json({0.02, -0.03, 0.12})), 1e-12);
  std::set<std::string> statuses;
  for (const json& solution : document["solutions"]) statuses.insert(solution["status"].get<std::string>());
  EXPECT_TRUE(statuses.contains("joint_limit"));
}

TEST(At, UnitsOnTheCommandLineMeanTheSame) {
  const json metres = run({"at", "delta", "--position", "0.02,-0.03,0.12", "--json"}).json();
  const json millimetres = run({"at", "delta", "--position", "20 mm,-3 cm,120mm", "--json"}).json();
  EXPECT_LT(difference(metres["joints"], millimetres["joints"]), 1e-12);
}

TEST(At, NegativeFirstNumberIsAValueAndNotAnOption) {
  const Outcome outcome = run({"at", "delta", "--position", "-0.02,-0.03,0.12", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(At, LegsSpelledOutGiveTheSameNumbersAsTheClosedForm) {
  const ScratchDirectory scratch;
  const Outcome shown = run({"show", "delta", "--as", "legs"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const std::string file = scratch.file("d.toml", shown.out);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-0.6, 1.4);
  for (int i = 0; i < 10; ++i) {
    const std::string joints = std::to_string(angle(random)) + "," + std::to_string(angle(random)) + "," +
                               std::to_string(angle(random));
    const std::vector<std::string> tail{"--joints", joints,           "--load", "1,2,3", "--rate",
                                        "1,-2,0.5", "--acceleration", "3,0,-9", "--json"};
    std::vector<std::string> closed{"at", "delta"};
    std::vector<std::string> general{"at", file};
    closed.insert(closed.end(), tail.begin(), tail.end());
    general.insert(general.end(), tail.begin(), tail.end());
    const json a = run(closed).json();
    const Outcome outcome = run(general);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json b = outcome.json();
    for (const char* key : {"joints", "passive_joints", "position", "jacobian", "torques", "gravity_torques",
                            "mass_matrix", "cartesian_mass", "velocity", "acceleration"}) {
      EXPECT_LT(difference(a[key], b[key]), 1e-9) << key << " at " << joints;
    }
    // Forces and the condition number are large and depend on differences: relative.
    for (const char* key : {"condition_number", "manipulability"}) {
      EXPECT_NEAR(b[key].get<double>() / a[key].get<double>(), 1.0, 1e-9) << key << " at " << joints;
    }
    EXPECT_NEAR(b["force_limits"]["continuous"]["every_direction"].get<double>() /
                    a["force_limits"]["continuous"]["every_direction"].get<double>(),
                1.0, 1e-9);
  }
}

TEST(At, SetChangesTheAnswerAsTheFileWould) {
  const json longer =
      run({"at", "delta", "--joints", "0,0,0", "--set", "mechanism.forearm=170 mm", "--json"}).json();
  // All arms horizontal: the tool is on the axis, sqrt(d3^2 - (d5 + d2)^2) above the elbows.
  EXPECT_NEAR(longer["position"][2].get<double>(), std::sqrt(0.17 * 0.17 - 0.105 * 0.105), 1e-12);
  const json twice = run({"at", "delta", "--joints", "0,0,0", "--set", "mechanism.forearm=170 mm", "--set",
                          "mechanism.upper_arm=90 mm", "--json"})
                         .json();
  EXPECT_NEAR(twice["position"][2].get<double>(), std::sqrt(0.17 * 0.17 - 0.115 * 0.115), 1e-12);
}

TEST(At, UserFrameTurnsEveryToolVector) {
  const json device = run({"at", "delta", "--joints", "10deg,20deg,30deg", "--json"}).json();
  const json user = run({"at", "delta", "--joints", "10deg,20deg,30deg", "--frame", "user", "--json"}).json();
  // Both frames agree about lengths, the joints and everything seen from them.
  const auto length = [](const json& v) {
    return std::hypot(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  EXPECT_NEAR(length(device["position"]), length(user["position"]), 1e-14);
  EXPECT_GT(difference(device["position"], user["position"]), 1e-3);
  EXPECT_LT(difference(device["mass_matrix"], user["mass_matrix"]), 1e-15);
  EXPECT_NEAR(device["condition_number"].get<double>(), user["condition_number"].get<double>(), 1e-10);
  // A load and its reaction are in that frame too.
  const std::string p = std::to_string(user["position"][0].get<double>()) + "," +
                        std::to_string(user["position"][1].get<double>()) + "," +
                        std::to_string(user["position"][2].get<double>());
  const json back = run({"at", "delta", "--position", p, "--frame", "user", "--json"}).json();
  EXPECT_LT(difference(back["joints"], device["joints"]), 1e-4);
}

TEST(At, OnlyPrintsWhatWasAsked) {
  const json document =
      run({"at", "delta", "--joints", "0,0,0", "--only", "position,jacobian", "--json"}).json();
  EXPECT_EQ(document.size(), 4u);
  EXPECT_TRUE(document.contains("device") && document.contains("status") && document.contains("position") &&
              document.contains("jacobian"));
}

TEST(At, OnlyChoosesTheLinesOfThePageToo) {
  const Outcome outcome = run({"at", "delta", "--joints", "0,0,0", "--only", "position,force_limits"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* there : {"status", "position [mm]", "continuous force"})
    EXPECT_NE(outcome.out.find(there), std::string::npos) << there;
  for (const char* gone : {"Joints", "Jacobian", "against gravity", "mass matrix", "Resolution"})
    EXPECT_EQ(outcome.out.find(gone), std::string::npos) << gone;
}

TEST(At, KeyThatNeedsAnOptionSaysWhich) {
  const json document = run({"at", "delta", "--joints", "0,0,0", "--only", "velocity", "--json"}).json();
  EXPECT_TRUE(document["velocity"].is_null());
  EXPECT_NE(document["notes"]["velocity"].get<std::string>().find("--rate"), std::string::npos);
}

// A delta whose arms and forearms lie flat, one on the other, at the origin: the tool gains a freedom upwards.
const std::vector<std::string> kFlat = {
    "--set", "mechanism.base_radius=100 mm",    "--set", "mechanism.upper_arm=100 mm",
    "--set", "mechanism.platform_radius=40 mm", "--set", "mechanism.joint_range=[\"-90 deg\", \"90 deg\"]"};

TEST(At, SingularityThatGainsAFreedomHoldsNoForceAlongIt) {
  std::vector<std::string> arguments{"at", "delta", "--position", "0,0,0", "--json"};
  arguments.insert(arguments.end(), kFlat.begin(), kFlat.end());
  const Outcome outcome = run(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_EQ(document["status"], "degraded");
  // Arms and forearms lie along each other, so that the tool moves neither way of the plane.
  EXPECT_EQ(document["singularity"]["kind"], "the tool gains and loses a freedom");
  EXPECT_NEAR(std::abs(document["singularity"]["free_direction"][2].get<double>()), 1.0, 1e-9);
  EXPECT_EQ(document["singularity"]["free_directions"].size(), 1u);
  EXPECT_EQ(document["singularity"]["lost_directions"].size(), 2u);
  EXPECT_EQ(document["singularity"]["lost_by"], json({"leg1", "leg2", "leg3"}));
  EXPECT_EQ(document["force_limits"]["continuous"]["every_direction"].get<double>(), 0.0);
  for (const char* key : {"jacobian", "torques", "gravity_torques", "mass_matrix", "cartesian_mass"}) {
    EXPECT_TRUE(document[key].is_null()) << key;
    EXPECT_TRUE(document["notes"].contains(key)) << key;
  }
  arguments.erase(arguments.begin() + 4);
  const std::string page = run(arguments).out;
  EXPECT_NE(page.find("none"), std::string::npos) << page;
  EXPECT_EQ(page.find("e+"), std::string::npos) << "rounding is no figure: " << page;
}

TEST(At, SingularityThatLosesAFreedomBearsAnyForceAlongIt) {
  // Arm and forearm of leg 1 in one line, 80 + 160 mm along (0, 0.28, 0.96) from its axis at y = -40 mm.
  std::vector<std::string> arguments{"at",         "delta",
                                     "--position", "0,0.0272,0.2304",
                                     "--set",      "mechanism.base_radius=40 mm",
                                     "--set",      "mechanism.platform_radius=80 mm",
                                     "--set",      "mechanism.joint_range=[\"-150 deg\", \"150 deg\"]"};
  const std::string page = run(arguments).out;
  EXPECT_NE(page.find("unlimited"), std::string::npos) << page;
  arguments.emplace_back("--json");
  const Outcome outcome = run(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_EQ(document["status"], "degraded");
  EXPECT_EQ(document["singularity"]["kind"], "the tool loses a freedom");
  ASSERT_EQ(document["singularity"]["lost_directions"].size(), 1u);
  EXPECT_EQ(document["singularity"]["lost_by"], json({"leg1"}));
  const json& lost = document["singularity"]["lost_directions"][0];
  EXPECT_NEAR(std::abs(lost[1].get<double>()), 0.28, 1e-6);
  EXPECT_NEAR(std::abs(lost[2].get<double>()), 0.96, 1e-6);
  EXPECT_EQ(document["manipulability"].get<double>(), 0.0);
  const json& limits = document["force_limits"]["continuous"];
  EXPECT_TRUE(limits["strongest"].is_null());
  EXPECT_GT(limits["every_direction"].get<double>(), 0.0);
  EXPECT_TRUE(document["cartesian_mass"].is_null());
}

TEST(At, PointOfTheOtherAssemblyModeIsUnreachableAndSaysSo) {
  // Below the base the legs meet, but driven to those angles the tool stands above them.
  const Outcome outcome = run({"at", "delta", "--position", "0,0,-0.076", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const json document = outcome.json();
  EXPECT_EQ(document["status"], "unreachable");
  EXPECT_NE(document["reason"].get<std::string>().find("assembly mode"), std::string::npos);
  const json& branch = document["solutions"][0];
  EXPECT_EQ(branch["assembly"], "other");
  EXPECT_TRUE(branch["within_range"].get<bool>());
  EXPECT_TRUE(document.contains("nearest_reachable"));
  const json branches = run({"at", "delta", "--position", "0,0,0.15", "--json"}).json()["solutions"];
  EXPECT_EQ(branches[0]["assembly"], "own");
}

TEST(At, ToolOfAPlaneTakesTwoCoordinatesAndNoPointOutside) {
  const Outcome two = run({"at", "five-bar", "--position", "10mm,213mm", "--json"});
  ASSERT_EQ(two.status, 0) << two.err;
  EXPECT_EQ(two.json()["tool_axes"], json({"x", "y"}));
  EXPECT_EQ(two.json()["jacobian"].size(), 2u);
  const json three = run({"at", "five-bar", "--position", "10mm,213mm,0", "--json"}).json();
  EXPECT_LT(difference(two.json()["joints"], three["joints"]), 1e-12);
  const Outcome outside = run({"at", "five-bar", "--position", "10mm,213mm,5mm", "--json"});
  EXPECT_EQ(outside.status, 1);
  EXPECT_EQ(outside.json()["status"], "unreachable");
  EXPECT_NE(outside.json()["reason"].get<std::string>().find("5.000 mm"), std::string::npos);
  EXPECT_EQ(run({"at", "delta", "--position", "0,0"}).status, 2);
}

TEST(At, UnreachablePointSaysWhichLegHowFarAndTheNearestPoint) {
  const Outcome outcome = run({"at", "delta", "--position", "0,0,0.5", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const json document = outcome.json();
  EXPECT_EQ(document["status"], "unreachable");
  EXPECT_NE(document["reason"].get<std::string>().find("leg1"), std::string::npos);
  const json& nearest = document["nearest_reachable"];
  // The top of the workspace lies on the axis: every joint at its upper end.
  const double theta = 84.0 * M_PI / 180.0;
  const double r = 0.025 + 0.08 * std::cos(theta);
  const double top = 0.08 * std::sin(theta) + std::sqrt(0.16 * 0.16 - r * r);
  EXPECT_NEAR(nearest["position"][2].get<double>(), top, 1e-9);
  EXPECT_NEAR(nearest["distance"].get<double>(), 0.5 - top, 1e-9);
  EXPECT_NE(outcome.err.find("unreachable"), std::string::npos);
}

TEST(At, JointBeyondItsRangeIsNamedWithValueAndRange) {
  const Outcome outcome = run({"at", "delta", "--joints", "10,0,0"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("joint_limit"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("theta1"), std::string::npos);
  EXPECT_NE(outcome.out.find("radians"), std::string::npos) << "a bare 10 looks like degrees";
}

TEST(At, PointMassMassMatrixStandsBesideTheFullOne) {
  const json document = run({"at", "delta", "--joints", "0.2,0.3,0.4", "--json"}).json();
  const double between = difference(document["mass_matrix"], document["mass_matrix_point_mass"]);
  EXPECT_GT(between, 0.0);
  EXPECT_LT(between, 0.5 * document["mass_matrix"][0][0].get<double>());
}

TEST(At, ArmWithoutDrivesOrMassLeavesOutWhatIsNotKnown) {
  const ScratchDirectory scratch;
  const std::string file = scratch.file("arm.toml", R"([device]
name = "arm"
title = "Planar arm of two links"
source = "chosen: for a test"
[mechanism]
type = "legs"
platform = "rigid"
[[leg]]
name = "arm"
tip = ["200 mm", 0, 0]
attachment = "rigid"
[[leg.joint]]
name = "shoulder"
type = "revolute"
active = true
axis = [0, 0, 1]
point = [0, 0, 0]
range = ["-90 deg", "90 deg"]
[[leg.joint]]
name = "elbow"
type = "revolute"
active = true
axis = [0, 0, 1]
point = ["100 mm", 0, 0]
range = ["10 deg", "150 deg"]
home = "20 deg"
)");
  const Outcome outcome = run({"at", file, "--joints", "30deg,60deg", "--load", "0,-2,0", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_LT(
      difference(document["position"], json({0.1 * std::cos(M_PI / 6), 0.1 * std::sin(M_PI / 6) + 0.1, 0.0})),
      1e-12);
  EXPECT_EQ(document["jacobian"].size(), 6u);
  EXPECT_EQ(document["condition_number"], document["homogeneous"]["condition_number"]);
  EXPECT_TRUE(document["force_limits"].is_null());
  EXPECT_TRUE(document["notes"].contains("force_limits"));
  // 2 N downwards on the hand, at 86.6 mm from the shoulder and straight above the elbow.
  EXPECT_NEAR(document["torques"][0].get<double>(), -2.0 * 0.1 * std::cos(M_PI / 6), 1e-12);
  EXPECT_NEAR(document["torques"][1].get<double>(), 0.0, 1e-12);
  EXPECT_EQ(run({"size", file}).status, 2);
  const Outcome workspace = run({"workspace", file, "--json"});
  EXPECT_EQ(workspace.status, 0) << workspace.err;
  EXPECT_TRUE(workspace.json()["orientations"].is_null());  // two joints leave the tool no choice
  const Outcome report = run({"report", file, "-o", (scratch.path() / "out").string(), "--json"});
  EXPECT_EQ(report.status, 0) << report.err;
  EXPECT_TRUE(report.json()["notes"].contains("workspace"));
}

TEST(At, TextFitsTheWidthItIsGiven) {
  const std::vector<std::vector<std::string>> questions = {
      {"at", "delta", "--joints", "10deg,20deg,30deg"},
      {"at", "seven-dof", "--joints", "10deg,50deg,20deg,80deg,30deg,70deg,20deg"},
      {"at", "--help"}};
  for (size_t i = 0; i < 2 * questions.size(); ++i) {
    const int width = i % 2 == 0 ? 80 : 120;
    const Outcome outcome = run(questions[i / 2], {.environment = {"COLUMNS=" + std::to_string(width)}});
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) {
      const auto starts = std::count_if(line.begin(), line.end(),
                                        [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
      EXPECT_LE(starts, width) << line;
    }
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << "no colours into a file";
  }
}

TEST(At, EllipsesFollowFromTheJacobian) {
  const json bar = run({"at", "five-bar", "--joints", "130deg,50deg", "--json"}).json();
  const json moves = bar["velocity_ellipsoid"]["translation"]["half_axes"];
  const json pushes = bar["force_ellipsoid"]["force"]["half_axes"];
  ASSERT_EQ(moves.size(), 2u);
  EXPECT_NEAR(moves[0].get<double>() * moves[1].get<double>() / bar["manipulability"].get<double>(), 1.0,
              1e-12);
  EXPECT_NEAR(moves[0].get<double>() / moves[1].get<double>() / bar["condition_number"].get<double>(), 1.0,
              1e-12);
  // Both drives are alike: where the tool is fast it is weak.
  const double torque = bar["force_limits"]["continuous"]["torque"][0];
  for (size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(moves[i].get<double>() * pushes[1 - i].get<double>() / torque, 1.0, 1e-12);
}

TEST(At, TheConditionNumberIsOfTheHomogeneousJacobian) {
  const json arm =
      run({"at", "seven-dof", "--joints", "10deg,50deg,20deg,80deg,30deg,70deg,20deg", "--json"}).json();
  const json rows = arm["jacobian"];
  const auto condition = [&](double length) {
    Eigen::MatrixXd J(6, 7);
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 7; ++c) J(r, c) = rows[r][c].get<double>() * (r < 3 ? 1.0 : length);
    }
    const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
    return sigma[0] / sigma[5];
  };
  const double length = arm["homogeneous"]["length"], value = arm["homogeneous"]["condition_number"];
  EXPECT_NEAR(condition(length) / value, 1.0, 1e-9);
  EXPECT_EQ(arm["condition_number"], arm["homogeneous"]["condition_number"]);
  // The length is the device's, not the posture's.
  const json other =
      run({"at", "seven-dof", "--joints", "0,30deg,20deg,60deg,30deg,50deg,20deg", "--json"}).json();
  EXPECT_EQ(other["homogeneous"]["length"].get<double>(), length);
  const json report = run({"workspace", "seven-dof", "--grid", "30mm", "--json"}).json();
  EXPECT_EQ(report["conditioning"]["characteristic_length"].get<double>(), length);
}

// Görgülü 2018, table 7.8, as the device's file has it: spec values of the stated design, moduli by the mean of
// plies.
TEST(At, StiffnessOfTheRCube) {
  const json home = run({"at", "r-cube", "--joints", "0,0,0", "--only",
                         "stiffness,compliance,compliance_shares,natural_frequencies,cartesian_mass", "--json"})
                        .json();
  const json K = home["stiffness"], C = home["compliance"];
  ASSERT_EQ(K.size(), 6u);
  EXPECT_NEAR(K[0][0].get<double>() / 101870.0, 1.0, 1e-5);
  EXPECT_NEAR(K[0][5].get<double>() / 3795.6, 1.0, 2e-5);
  EXPECT_NEAR(K[3][3].get<double>() / 416.80, 1.0, 2e-5);
  double one = 0.0, worst = 0.0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) sum += K[i][k].get<double>() * C[k][j].get<double>();
      (i == j ? one : worst) = i == j ? std::max(one, std::abs(sum - 1.0)) : std::max(worst, std::abs(sum));
    }
  }
  EXPECT_LT(one, 1e-9);
  EXPECT_LT(worst, 1e-6);
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    for (const json& part : home["compliance_shares"]) sum += part["shares"][axis].get<double>();
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
  // What vibrates at home: 1/(2 pi) of these is some hundred hertz; motors that may swing raise it.
  const json& modes = home["natural_frequencies"];
  double before = 0.0;
  for (int m = 0; m < 3; ++m) {
    const double held = modes["held"]["frequencies"][m], free = modes["free"]["frequencies"][m],
                 block = modes["rotation_held"]["frequencies"][m];
    EXPECT_GE(held, before);
    EXPECT_GT(free, held);
    EXPECT_GT(block, held);
    before = held;
  }

  const json load = run({"at", "r-cube", "--joints", "32.5deg,32.5deg,32.5deg", "--load", "-20,0,0", "--only",
                         "deflection", "--json"})
                        .json();
  double squares = 0.0;
  for (int i = 0; i < 3; ++i) squares += std::pow(load["deflection"][i].get<double>(), 2);
  EXPECT_NEAR(std::sqrt(squares), 1.369e-3, 1e-6);
  EXPECT_GT(load["deflection"][0].get<double>(), 0.0);  // the way the hand pushes
}

TEST(At, StiffnessIsNotGivenWhereLinksHaveNoSection) {
  const Outcome outcome = run({"at", "seven-dof", "--joints", "0,60deg,0,45deg,0,30deg,0", "--only",
                               "stiffness,natural_frequencies", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_TRUE(document["stiffness"].is_null());
  EXPECT_NE(document["notes"]["stiffness"].get<std::string>().find("not given by the source"),
            std::string::npos);
  EXPECT_NE(document["notes"]["natural_frequencies"].get<std::string>().find("not given by the source"),
            std::string::npos);
  EXPECT_NE(run({"at", "seven-dof", "--joints", "0,60deg,0,45deg,0,30deg,0", "--only", "stiffness"})
                .out.find("not given by the source"),
            std::string::npos);
  // A delta's cables give, its links are rigid.
  const json delta = run({"at", "delta", "--joints", "10deg,20deg,30deg", "--only",
                          "stiffness,stiffness_with_drives", "--json"})
                         .json();
  EXPECT_TRUE(delta["stiffness"].is_null());
  EXPECT_EQ(delta["stiffness_with_drives"].size(), 3u);
}

TEST(At, StiffnessTurnsWithTheFrame) {
  const std::vector<std::string> base = {
      "at", "delta", "--joints", "10deg,20deg,30deg", "--only", "stiffness_with_drives", "--json"};
  std::vector<std::string> turned = base;
  turned.insert(turned.end(), {"--frame", "user"});
  const json K = run(base).json()["stiffness_with_drives"], U = run(turned).json()["stiffness_with_drives"];
  double trace_K = 0.0, trace_U = 0.0;
  for (int i = 0; i < 3; ++i) {
    trace_K += K[i][i].get<double>();
    trace_U += U[i][i].get<double>();
  }
  EXPECT_NEAR(trace_U / trace_K, 1.0, 1e-12);
  EXPECT_GT(difference(K, U), 1e-3 * trace_K);
}

// ------------------------------------------------------------------------------------------ arms

const std::vector<std::string> kPose = {"--position", "0.35,0.05,0.1", "--orientation", "0,90deg,0"};

Outcome at_seven_dof(std::vector<std::string> more, const char* device = "seven-dof") {
  std::vector<std::string> arguments{"at", device};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments);
}
std::vector<std::string> pose_and(std::vector<std::string> more) {
  std::vector<std::string> arguments = kPose;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(AtArm, EveryWayToChooseAPostureReachesThePose) {
  const json wanted_rotation = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}};
  for (const std::vector<std::string>& choice : {std::vector<std::string>{"--keep", "theta3=10deg"},
                                                 {"--keep", "theta1=5deg"},
                                                 {"--keep", "theta2=40deg"},
                                                 {"--keep", "theta6=40deg"},
                                                 {"--near", "home"},
                                                 {"--near", "0.1,0.6,0.2,1.5,3,0.5,3"},
                                                 {"--maximise", "manipulability"},
                                                 {"--maximise", "inverse_condition"},
                                                 {"--maximise", "limit_distance"}}) {
    std::vector<std::string> more = choice;
    more.push_back("--json");
    const Outcome outcome = at_seven_dof(pose_and(more));
    const json document = outcome.json();
    ASSERT_TRUE(document.contains("joints")) << choice[1] << outcome.err;
    EXPECT_LT(difference(document["position"], json({0.35, 0.05, 0.1})), 1e-12) << choice[1];
    EXPECT_LT(difference(document["orientation"], wanted_rotation), 1e-12) << choice[1];
    EXPECT_EQ(document["choice"]["spare_joints"], 1);
    EXPECT_EQ(document["choice"]["rule"], choice[0] == "--near" ? "nearest" : choice[0].substr(2));
    expect_finite(document, "");
    // The posture is one of those listed, the first.
    EXPECT_LT(difference(document["solutions"][0]["joints"], document["joints"]), 1e-9) << choice[1];
  }
}

TEST(AtArm, AJointKeptHasItsValueInEverySolution) {
  const json document = at_seven_dof(pose_and({"--keep", "theta3=10deg", "--json"})).json();
  ASSERT_EQ(document["solutions"].size(), 8u);
  for (const json& solution : document["solutions"]) {
    EXPECT_NEAR(std::remainder(solution["joints"][2].get<double>() - 10.0 * std::numbers::pi / 180.0,
                               2.0 * std::numbers::pi),
                0.0, 1e-9);
  }
  EXPECT_NEAR(document["choice"]["value"].get<double>(), 10.0 * std::numbers::pi / 180.0, 1e-9);
}

TEST(AtArm, OrientationsInAllFormsAreTheSame) {
  const json angles = at_seven_dof(pose_and({"--near", "home", "--json"})).json();
  for (const std::vector<std::string>& form :
       {std::vector<std::string>{"--orientation", "0.70710678,0,0.70710678,0"},
        {"--rotation", "0,0,1,0,1,0,-1,0,0"}}) {
    std::vector<std::string> more{"--position", "0.35,0.05,0.1", "--near", "home", "--json"};
    more.insert(more.end(), form.begin(), form.end());
    EXPECT_LT(difference(at_seven_dof(more).json()["joints"], angles["joints"]), 1e-7) << form[0];
  }
  // What one answer says is what the next may ask.
  std::string rotation;
  for (const json& row : angles["orientation"]) {
    for (const json& value : row) {
      if (!rotation.empty()) rotation += ',';
      rotation += value.dump();
    }
  }
  const json again =
      at_seven_dof({"--position", "0.35,0.05,0.1", "--rotation", rotation, "--near", "home", "--json"}).json();
  EXPECT_LT(difference(again["joints"], angles["joints"]), 1e-9);
}

TEST(AtArm, APoseThatLeavesAJointOpenIsRefusedWithTheRemedy) {
  const Outcome outcome = at_seven_dof(kPose);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  for (const char* remedy : {"--keep theta3", "--near", "--maximise manipulability"})
    EXPECT_NE(outcome.err.find(remedy), std::string::npos) << remedy;
}

TEST(AtArm, APositionAloneTakesThePostureNearestToHome) {
  const json document = at_seven_dof({"--position", "0.35,0.05,0.1", "--json"}).json();
  EXPECT_EQ(document["status"], "reached");
  EXPECT_LT(difference(document["position"], json({0.35, 0.05, 0.1})), 1e-12);
  EXPECT_EQ(document["choice"]["rule"], "nearest");
  EXPECT_EQ(document["choice"]["spare_joints"], 4);
  for (size_t j = 4; j < 7; ++j)  // the wrist has no part in it
    EXPECT_NEAR(document["joints"][j].get<double>(), 0.5 * std::numbers::pi, 1e-12);
}

TEST(AtArm, WhatIsWrongIsNamedWithItsRule) {
  struct Case {
    std::vector<std::string> arguments;
    const char* says;
  };
  for (const Case& one : std::vector<Case>{
           {{"--position", "0.35,0.05,0.1", "--rotation", "1,0,0,0,1,0,0,0,1.1", "--near", "home"}, "R^T R"},
           {{"--position", "0.35,0.05,0.1", "--rotation", "1,0,0,0,1,0,0,0,-1", "--near", "home"}, "mirrors"},
           {{"--position", "0.35,0.05,0.1", "--rotation", "1,0,0", "--near", "home"}, "9 are expected"},
           {{"--position", "0.35,0.05,0.1", "--orientation", "1,0,0,0.2", "--near", "home"}, "length 1"},
           {{"--position", "0.35,0.05,0.1", "--orientation", "0,90kg,0", "--near", "home"},
            "an angle was expected"},
           {pose_and({"--keep", "theta8"}), "there is no joint"},
           {pose_and({"--keep", "theta3=1kg"}), "an angle was expected"},
           {pose_and({"--keep", "theta3", "--maximise", "manipulability"}), "give one"},
           {pose_and({"--maximise", "speed"}), "limit_distance"},
           {pose_and({"--near", "1,2,3"}), "give 7 values"},
           {{"--joints", "0,1,0,1,1,1,1", "--keep", "theta3"}, "goes with --position"}}) {
    const Outcome outcome = at_seven_dof(one.arguments);
    EXPECT_EQ(outcome.status, 2) << one.says;
    EXPECT_NE(outcome.err.find(one.says), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(run({"at", "delta", "--position", "0,0,0.15", "--orientation", "0,0,0"}).status, 2);
  EXPECT_EQ(run({"at", "delta", "--position", "0,0,0.15", "--keep", "leg1"}).status, 2);
  EXPECT_EQ(at_seven_dof(pose_and({"--keep", "theta4"}), "seven-dof-locked").status, 2);
}

TEST(AtArm, AJointThatTheGoalDecidesCannotBeKept) {
  const Outcome outcome = at_seven_dof(pose_and({"--keep", "theta4=1", "--json"}));
  EXPECT_EQ(outcome.status, 1);
  const std::string reason = outcome.json()["reason"];
  EXPECT_NE(reason.find("does not move while the tool is held"), std::string::npos) << reason;
}

TEST(AtArm, ItsFourSingularitiesAreNamed) {
  struct Case {
    const char* joints;
    const char* name;
  };
  for (const Case& one : {Case{"0.1,75deg,0.2,0,30deg,40deg,0.3", "elbow"},
                          {"0.1,0,90deg,80deg,30deg,40deg,0.3", "shoulder"},
                          {"0.1,75deg,0.2,80deg,90deg,0,0.3", "wrist"},
                          {"0.1,0,0.2,80deg,30deg,180deg,0.3", "shoulder and wrist"}}) {
    const Outcome outcome =
        at_seven_dof({"--set", R"(joint[1].range=["-180 deg", "180 deg"])", "--set",
                      R"(joint[2].range=["-180 deg", "180 deg"])", "--set",
                      R"(joint[3].range=["-180 deg", "180 deg"])", "--joints", one.joints, "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json document = outcome.json();
    EXPECT_EQ(document["status"], "degraded") << one.name;
    EXPECT_EQ(document["singularity"]["names"], json({one.name}));
    EXPECT_EQ(document["singularity"]["weak_direction"].size(), 6u);
    expect_finite(document, "");
  }
  const json regular = at_seven_dof({"--joints", "0.1,75deg,0.2,80deg,30deg,40deg,0.3", "--json"}).json();
  EXPECT_TRUE(regular["singularity"]["names"].empty());
  EXPECT_EQ(regular["singularity"]["sets"].size(), 4u);
}

TEST(AtArm, WithTheJointFixedThereAreEightBranchesAndNothingToChoose) {
  const Outcome outcome = at_seven_dof(pose_and({"--json"}), "seven-dof-locked");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_EQ(document["solutions"].size(), 8u);
  EXPECT_FALSE(document.contains("choice"));
  EXPECT_EQ(document["singularity"]["sets"].size(), 3u);
}

}  // namespace
}  // namespace zwidth::testing
