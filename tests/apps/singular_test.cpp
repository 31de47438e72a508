#include <cmath>
#include <gtest/gtest.h>

#include "run_command.h"

// At a singularity every verb that is asked about one posture says what is lost or gained, in numbers.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

struct Place {
  const char* what;
  std::vector<std::string> device;  // with what is set
  std::vector<std::string> posture;
  size_t lost, gained;
};

const std::vector<Place> kPlaces = {
    {"a delta with one leg stretched",
     {"delta", "--set", "mechanism.base_radius=40 mm", "--set", "mechanism.platform_radius=80 mm", "--set",
      "mechanism.joint_range=[\"-150 deg\", \"150 deg\"]"},
     {"--position", "0,0.0272,0.2304"},
     1,
     0},
    {"a delta with coplanar forearms, its arms across them",
     {"delta", "--set", "mechanism.base_radius=150 mm", "--set", "mechanism.upper_arm=100 mm", "--set",
      "mechanism.forearm=130 mm", "--set", "mechanism.platform_radius=20 mm", "--set",
      "mechanism.joint_range=[\"-120 deg\", \"120 deg\"]"},
     {"--joints", "90deg,90deg,90deg"},
     0,
     1},
    {"a five-bar with one leg stretched",
     {"five-bar", "--set", "mechanism.left_range=[\"-180 deg\", \"180 deg\"]", "--set",
      "mechanism.right_range=[\"-180 deg\", \"180 deg\"]"},
     {"--position", "120mm,200mm"},
     1,
     0},
    {"a five-bar with its couplers in line",
     {"five-bar", "--set", "mechanism.half_base=50 mm", "--set", "mechanism.coupler=100 mm"},
     {"--joints", "120deg,60deg"},
     0,
     1},
    {"an R-CUBE with all legs stretched",
     {"r-cube", "--set", "mechanism.inner_link=60 mm", "--set", "mechanism.outer_link=51.7 mm"},
     {"--joints", "0,0,0"},
     3,
     0},
    {"the 7-DOF arm with its wrist straight",
     {"seven-dof"},
     {"--joints", "0,60deg,0,90deg,90deg,0,90deg"},
     1,
     0},
    {"the first pneumatic arm stretched", {"pneumatic-1"}, {"--joints", "50mm,0,0.03553056960858745"}, 1, 0},
    {"the second pneumatic arm, its wrist in the plane of its vertical axes",
     {"pneumatic-2", "--set", "joint[1].range=[\"-80 deg\", \"80 deg\"]"},
     {"--joints", "10deg,0.7378150601204649,0"},
     1,
     0},
    {"the second pneumatic arm, its last link upright",
     {"pneumatic-2", "--set", "joint[3].range=[\"-90 deg\", \"90 deg\"]"},
     {"--joints", "10deg,5deg,90deg"},
     1,
     0},
    {"the third pneumatic arm, its tool in the plane of its vertical axes",
     {"pneumatic-3", "--set", "joint[1].range=[\"-80 deg\", \"80 deg\"]"},
     {"--joints", "10deg,1.017115004587899,0"},
     1,
     0},
    {"the third pneumatic arm in two singularities at once",
     {"pneumatic-3", "--set", "joint[1].range=[\"-90 deg\", \"90 deg\"]", "--set",
      "joint[3].range=[\"-90 deg\", \"90 deg\"]"},
     {"--joints", "10deg,90deg,90deg,20deg,30deg"},
     2,
     0},
    {"the arm with theta3 locked stretched",
     {"seven-dof-locked", "--set", "joint[3].range=[\"-90 deg\", \"90 deg\"]"},
     {"--joints", "10deg,40deg,0,10deg,20deg,30deg"},
     1,
     0},
    {"the arm with theta3 locked, its wrist straight",
     {"seven-dof-locked"},
     {"--joints", "10deg,40deg,90deg,10deg,0,30deg"},
     1,
     0},
    {"the arm with theta3 locked, its wrist on axis 1",
     {"seven-dof-locked", "--set", "joint[1].range=[\"-90 deg\", \"90 deg\"]"},
     {"--joints", "10deg,-45deg,90deg,10deg,20deg,30deg"},
     1,
     0},
    {"the arm with theta3 locked at 30 degrees, its wrist in the plane of axes 1 and 2",
     {"seven-dof-locked", "--set", "joint[2].theta=30 deg", "--set",
      "joint[1].range=[\"-90 deg\", \"90 deg\"]"},
     {"--joints", "10deg,-0.7137243789447656,90deg,10deg,20deg,30deg"},
     1,
     0}};

void expect_numbers(const Json& value, const std::string& path) {
  if (value.is_object() || value.is_array()) {
    for (const auto& [key, inner] : value.items()) expect_numbers(inner, path + "." + key);
  } else {
    EXPECT_FALSE(value.is_null()) << path;
  }
}

/// No figure is what rounding leaves of a division by zero.
void expect_no_dust(const Json& value, const std::string& path) {
  if (value.is_object() || value.is_array()) {
    for (const auto& [key, inner] : value.items()) {
      const bool stiffness = key == "stiffness_with_drives" || key == "stiffness_indices";
      if (!stiffness) expect_no_dust(inner, path + "." + key);  // a lost way is held firmly
    }
  } else if (value.is_number()) {
    EXPECT_LT(std::abs(value.get<double>()), 1e12) << path;
  }
}

TEST(Singular, PosturesAnswerDegradedWithTheDirections) {
  for (const Place& place : kPlaces) {
    SCOPED_TRACE(place.what);
    std::vector<std::string> arguments{"at"};
    arguments.insert(arguments.end(), place.device.begin(), place.device.end());
    arguments.insert(arguments.end(), place.posture.begin(), place.posture.end());
    const Outcome page = run(arguments);
    arguments.emplace_back("--json");
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json document = outcome.json();
    EXPECT_EQ(document["status"], "degraded");
    const Json& singularity = document["singularity"];
    EXPECT_EQ(singularity.value("lost_directions", Json::array()).size(), place.lost) << singularity;
    EXPECT_EQ(singularity.value("free_directions", Json::array()).size(), place.gained) << singularity;
    EXPECT_TRUE(singularity.contains("kind"));
    if (place.lost > 0) {
      EXPECT_FALSE(singularity["lost_by"].empty());
    }
    expect_numbers(singularity, "singularity");
    expect_no_dust(document, "at");
    EXPECT_EQ(document["degraded"], true);
    // Whatever is not defined is null, and says why.
    for (const auto& [key, value] : document.items()) {
      if (value.is_null()) {
        EXPECT_TRUE(document["notes"].contains(key)) << key;
      }
    }
    EXPECT_NE(page.out.find("Singular"), std::string::npos) << page.out;
    for (const char* word : {"nan", "inf ", "-inf", "e+1"})
      EXPECT_EQ(page.out.find(word), std::string::npos) << word << "\n" << page.out;
  }
}

TEST(Singular, PosturesSpelledOutInLegsAnswerTheSame) {
  const ScratchDirectory scratch;
  for (const Place& place : kPlaces) {
    SCOPED_TRACE(place.what);
    std::vector<std::string> show{"show"};
    show.insert(show.end(), place.device.begin(), place.device.end());
    show.insert(show.end(), {"--as", "legs"});
    const std::string file = scratch.file("legs.toml", run(show).out);
    std::vector<std::string> arguments{"at", file, "--json"};
    arguments.insert(arguments.end(), place.posture.begin(), place.posture.end());
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["status"], "degraded");
    // The general solver meets a double root to half the digits: near, but not to rounding.
    const Json singularity = outcome.json()["singularity"];
    EXPECT_EQ(singularity.value("lost_directions", Json::array()).size(), place.lost) << singularity;
    EXPECT_EQ(singularity.value("free_directions", Json::array()).size(), place.gained) << singularity;
  }
}

TEST(Singular, PosturesCanBeSizedFor) {
  for (const Place& place : kPlaces) {
    SCOPED_TRACE(place.what);
    for (const char* load : {"", place.device[0] == "five-bar" ? "1,2" : "1,2,0"}) {
      std::vector<std::string> arguments{"size", "--json"};
      if (*load != '\0') arguments.insert(arguments.end(), {"--load", load});
      arguments.insert(arguments.end(), place.device.begin(), place.device.end());
      arguments.insert(arguments.end(), place.posture.begin(), place.posture.end());
      if (place.device[0] == "five-bar" && place.posture[0] == "--position") arguments.back() += ",0";
      const Outcome outcome = run(arguments);
      EXPECT_LE(outcome.status, 1) << outcome.err;
      EXPECT_TRUE(outcome.json().contains("joints")) << outcome.out;
      expect_no_dust(outcome.json(), "size");
    }
  }
}

// Asked for where the tool is instead of how the joints are, a singular posture answers degraded too.
TEST(Singular, PosesOfArmsAnswerDegradedToo) {
  for (const Place& place : kPlaces) {
    const bool turns = place.device[0].starts_with("seven-dof");
    if (!turns && !place.device[0].starts_with("pneumatic")) continue;
    SCOPED_TRACE(place.what);
    std::vector<std::string> arguments{"at"};
    arguments.insert(arguments.end(), place.device.begin(), place.device.end());
    arguments.emplace_back("--json");
    std::vector<std::string> by_joints = arguments;
    by_joints.insert(by_joints.end(), place.posture.begin(), place.posture.end());
    const Json there = run(by_joints).json();
    const auto list = [](const Json& numbers) {
      std::string text;
      for (const Json& number : numbers.flatten()) text += (text.empty() ? "" : ",") + number.dump();
      return text;
    };
    arguments.insert(arguments.end(), {"--position", list(there["position"])});
    if (turns) arguments.insert(arguments.end(), {"--rotation", list(there["orientation"])});
    if (place.device[0] == "seven-dof") arguments.insert(arguments.end(), {"--near", place.posture[1]});
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json document = outcome.json();
    EXPECT_EQ(document["status"], "degraded");
    EXPECT_EQ(document["degraded"], true);
    EXPECT_EQ(document["singularity"].value("lost_directions", Json::array()).size(), place.lost);
    EXPECT_FALSE(document["solutions"].empty());
    expect_no_dust(document, "at");
  }
}

// A joint beyond its range does not hide that the posture is singular.
TEST(Singular, BeyondTheRangesBothAreSaid) {
  const Outcome outcome = run({"at", "seven-dof", "--joints", "0,0,0,0,0,0,0", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const Json document = outcome.json();
  EXPECT_EQ(document["status"], "joint_limit");
  EXPECT_EQ(document["degraded"], true);
  EXPECT_EQ(document["singularity"]["lost_directions"].size(), 3U);
  EXPECT_EQ(document["singularity"]["names"], Json({"elbow", "shoulder and wrist"}));
  const std::string page = run({"at", "seven-dof", "--joints", "0,0,0,0,0,0,0"}).out;
  EXPECT_NE(page.find("joint_limit, degraded"), std::string::npos) << page;
  EXPECT_NE(page.find("Singular"), std::string::npos);
  // Near, not at: nearly lost directions are said too.
  const Json near = run({"at", "pneumatic-3", "--joints", "0,1.01712,0", "--json"}).json();
  EXPECT_EQ(near["status"], "joint_limit");
  EXPECT_EQ(near["degraded"], true);
  EXPECT_EQ(near["singularity"]["lost_directions"].size(), 1U);
  EXPECT_EQ(run({"at", "seven-dof", "--joints", "0,0,0,90deg,0,90deg,0", "--json"}).json()["degraded"], false);
}

}  // namespace
}  // namespace zwidth::testing
