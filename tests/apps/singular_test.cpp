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
    {"the first pneumatic arm stretched", {"pneumatic-1"}, {"--joints", "50mm,0,0.03553056960858745"}, 1, 0}};

void expect_numbers(const Json& value, const std::string& path) {
  if (value.is_object() || value.is_array()) {
    for (const auto& [key, inner] : value.items()) expect_numbers(inner, path + "." + key);
  } else {
    EXPECT_FALSE(value.is_null()) << path;
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
    if (place.device[0] == "pneumatic-1") continue;  // is sized where a position says
    SCOPED_TRACE(place.what);
    std::vector<std::string> arguments{"size", "--json", "--load", "1,2,0"};
    arguments.insert(arguments.end(), place.device.begin(), place.device.end());
    arguments.insert(arguments.end(), place.posture.begin(), place.posture.end());
    if (place.device[0] == "five-bar" && place.posture[0] == "--position") arguments.back() += ",0";
    const Outcome outcome = run(arguments);
    EXPECT_LE(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(outcome.json().contains("joints")) << outcome.out;
  }
}

}  // namespace
}  // namespace zwidth::testing
