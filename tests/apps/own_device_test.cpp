#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

#include "run_command.h"

// A mechanism that zwidth does not know, from its file alone: docs/your_own_device.md.

namespace zwidth::testing {
namespace {

using Json = nlohmann::json;

const std::string kLamps = ZWIDTH_EXAMPLES "/devices/lamps.toml";

TEST(OwnDevice, IsChecked) {
  const Json mobility = run({"check", kLamps, "--json"}).json()["devices"][0]["mobility"];
  EXPECT_EQ(mobility["freedoms"], 3);
  EXPECT_EQ(mobility["gruebler"], 3);
  EXPECT_EQ(mobility["group"], "translation");
  EXPECT_EQ(mobility["verdict"], "constrained");
}

TEST(OwnDevice, MovesAsItsSketchSays) {
  const Json home = run({"at", kLamps, "--joints", "0,0,0", "--json"}).json();
  EXPECT_EQ(home["status"], "reached");
  for (size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(home["position"][row].get<double>(), 0.0, 1e-12);
    for (size_t column = 0; column < 3; ++column)
      EXPECT_NEAR(home["jacobian"][row][column].get<double>(), row == column ? 0.1 : 0.0, 1e-12);
  }
  EXPECT_NEAR(home["condition_number"].get<double>(), 1.0, 1e-12);
  // By hand: the arm of x lifts by a, its bars swing to make good the height, and so x = 100 sin a - 120 (1 -
  // cos b), where 120 sin b = 100 (1 - cos a) + z.
  const Json there = run({"at", kLamps, "--position", "20mm,-10mm,15mm", "--json"}).json();
  ASSERT_EQ(there["status"], "reached");
  const std::vector<double> p{0.020, -0.010, 0.015};
  for (size_t i = 0; i < 3; ++i) {
    const double a = there["joints"][i].get<double>(), across = p[(i + 2) % 3];
    const double b = std::asin((0.1 * (1.0 - std::cos(a)) + across) / 0.12);
    EXPECT_NEAR(0.1 * std::sin(a) + 0.12 * (1.0 - std::cos(b)), p[i], 1e-10);
  }
}

TEST(OwnDevice, HasAWorkspaceAndAReport) {
  const Json workspace = run({"workspace", kLamps, "--grid", "10mm", "--json"}).json();
  EXPECT_GT(workspace["inside"].get<int>(), 200);
  EXPECT_GT(workspace["volume"].get<double>(), 2e-4);
  for (const char* axis : {"x", "y", "z"}) {
    // The sketch is the same for all three: -57.36 mm with the lamp's drive at its end, and 70 mm of slide.
    EXPECT_NEAR(workspace["ranges"][axis][0].get<double>(), -0.1 * std::sin(35.0 * 0.017453292519943), 2e-5);
    EXPECT_NEAR(workspace["ranges"][axis][1].get<double>(), 0.07, 1e-6);
  }
  const ScratchDirectory scratch;
  const Outcome outcome = run({"report", kLamps, "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = outcome.json();
  EXPECT_EQ(report["mechanism"]["type"], "legs");
  EXPECT_GT(report["workspace"]["volume"].get<double>(), 2e-4);
  EXPECT_GT(report["forces"]["continuous"]["axis"]["x"]["min"].get<double>(), 1.0);
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "report.html"));
  EXPECT_FALSE(std::filesystem::is_empty(scratch.path() / "figures"));
}

TEST(OwnDevice, IsSized) {
  const Json sized = run({"size", kLamps, "--load", "2,0,0", "--json"}).json();
  EXPECT_EQ(sized["joints"].size(), 3u);
  EXPECT_NEAR(sized["balance"]["moving_mass"].get<double>(), 0.315, 1e-12);
}

// Rates of the struts by hand, u . v + (p x u) . w for a platform that moves with v and turns with w: the
// Jacobian's inverse.
TEST(OwnDevice, AHexapodMovesAndTurnsAsItsStrutsSay) {
  const std::string hexapod = ZWIDTH_EXAMPLES "/devices/hexapod.toml";
  const Json checked = run({"check", hexapod, "--json"}).json()["devices"][0];
  EXPECT_EQ(checked["mobility"]["freedoms"], 6);
  EXPECT_EQ(checked["mobility"]["gruebler"], 6);
  EXPECT_EQ(checked["mobility"]["verdict"], "constrained");
  const Json home = run({"at", hexapod, "--joints", "0,0,0,0,0,0", "--json"}).json();
  ASSERT_EQ(home["status"], "reached");
  const double degree = 0.017453292519943295;
  const std::vector<double> base{-12, 12, 108, 132, 228, 252}, top{-48, 48, 72, 168, 192, 288};
  for (size_t k = 0; k < 6; ++k) {
    const double px = 0.06 * std::cos(top[k] * degree), py = 0.06 * std::sin(top[k] * degree);
    double ux = px - 0.15 * std::cos(base[k] * degree), uy = py - 0.15 * std::sin(base[k] * degree), uz = 0.2;
    const double length = std::sqrt(ux * ux + uy * uy + uz * uz);
    ux /= length, uy /= length, uz /= length;
    const std::vector<double> row{ux, uy, uz, py * uz, -px * uz, px * uy - py * ux};
    for (size_t j = 0; j < 6; ++j) {
      double product = 0.0;
      for (size_t i = 0; i < 6; ++i) product += row[i] * home["jacobian"][i][j].get<double>();
      EXPECT_NEAR(product, k == j ? 1.0 : 0.0, 1e-4) << k << ", " << j;  // the file has micrometres
    }
  }
  const ScratchDirectory scratch;
  const Outcome report = run({"report", hexapod, "-o", scratch.path().string(), "--json"});
  ASSERT_EQ(report.status, 0) << report.err;
  EXPECT_GT(report.json()["arm"]["postures"].get<int>(), 1000);
}

}  // namespace
}  // namespace zwidth::testing
