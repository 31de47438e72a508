#include <cmath>
#include <gtest/gtest.h>

#include "run_command.h"

// Devices that cylinders move, through the command.

namespace zwidth::testing {
namespace {

TEST(Pneumatic, DevicesAreSound) {
  for (const char* device : {"pneumatic-1", "pneumatic-2", "pneumatic-3"}) {
    const Outcome outcome = run({"check", device, "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto entry = outcome.json()["devices"][0];
    EXPECT_EQ(entry["drives"], 3) << device;
    EXPECT_TRUE(entry["warnings"].empty()) << device << entry["warnings"];
  }
}

TEST(Pneumatic, PositionHasFourBranchesAndTorquesForALoad) {
  const Outcome outcome =
      run({"at", "pneumatic-3", "--position", "210mm,-100mm,20mm", "--load", "1,0,2", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_EQ(document["solutions"].size(), 4U);
  const auto& J = document["jacobian"];
  for (int j = 0; j < 5; ++j) {
    const double wanted =
        document["gravity_torques"][j].get<double>() + J[0][j].get<double>() + 2.0 * J[2][j].get<double>();
    EXPECT_NEAR(document["torques"][j].get<double>(), wanted, 1e-12);
  }
  // Cylinders give these torques, with the pressures and the commands that they say.
  ASSERT_EQ(document["cylinders"].size(), 3U);
  for (int j = 0; j < 3; ++j) {
    const auto& cylinder = document["cylinders"][j];
    EXPECT_EQ(cylinder["status"], "ok");
    const double force = cylinder["force"].get<double>();
    EXPECT_NEAR(force * cylinder["lever"].get<double>(), document["torques"][j].get<double>(), 1e-12);
    const double A1 = 0.105 * 0.0254 * 0.0254, A2 = 0.093 * 0.0254 * 0.0254;
    EXPECT_NEAR(cylinder["pressures"][0].get<double>() * A1 - cylinder["pressures"][1].get<double>() * A2,
                force, 1e-9);
    for (int side = 0; side < 2; ++side) {
      EXPECT_NEAR(1e3 + 49.9e3 * cylinder["voltages"][side].get<double>(),
                  cylinder["pressures"][side].get<double>(), 1e-6);
    }
  }
  const auto& limits = document["force_limits"]["continuous"];
  EXPECT_GT(-limits["torque_range"][0][1].get<double>(), limits["torque_range"][1][1].get<double>());
  // Upwards the rod side of the third cylinder works, downwards the other.
  EXPECT_LT(limits["axis_range"][2][1].get<double>(), -limits["axis_range"][2][0].get<double>());
  EXPECT_NEAR(document["resolution"]["joint"][0].get<double>(), 1.22e-3 / 5.0 * 330.0 * M_PI / 180.0, 1e-12);
  EXPECT_GT(document["resolution"]["position"][0].get<double>(), 1e-5);
  // The wrist moves nothing.
  for (int r = 0; r < 3; ++r) EXPECT_NEAR(J[r][4].get<double>(), 0.0, 1e-15);
  EXPECT_EQ(run({"at", "pneumatic-3", "--position", "0.9,0,0", "--json"}).json()["status"], "unreachable");
  const auto pressed =
      run({"at", "pneumatic-3", "--joints", "0,0,0,0,0", "--load", "0,0,20", "--json"}).json()["cylinders"][2];
  EXPECT_EQ(pressed["status"], "saturated");
  EXPECT_DOUBLE_EQ(pressed["pressures"][1].get<double>(), 500e3);
}

TEST(Pneumatic, SizeComparesForcesWithTheCylinders) {
  const Outcome enough =
      run({"size", "pneumatic-3", "--position", "218mm,-110mm,0", "--load", "0,0,4", "--json"});
  ASSERT_EQ(enough.status, 0) << enough.err;
  const auto document = enough.json();
  // Upwards the third cylinder pulls: torque L F over the lever of 12.497 mm, weight on top.
  const auto& third = document["joints"][2];
  const double torque = third["required"].get<double>();
  EXPECT_NEAR(torque, 0.068 * 4.0 + third["gravity"].get<double>(), 1e-9);
  EXPECT_NEAR(third["pull"]["required"].get<double>(), torque / 0.012497, 0.01 * torque / 0.012497);
  EXPECT_EQ(third["push"]["available"], nullptr);
  const Outcome much =
      run({"size", "pneumatic-3", "--position", "218mm,-110mm,0", "--load", "0,0,9", "--json"});
  EXPECT_EQ(much.status, 1);
  EXPECT_EQ(much.json()["joints"][2]["status"], "saturated");
  // A supply below the regulators' range is what limits then.
  const Outcome weak = run({"size", "pneumatic-3", "--set", "drive.supply_pressure=0.3 MPa", "--json"});
  ASSERT_EQ(weak.status, 0) << weak.err;
  EXPECT_EQ(weak.json()["drives"][0]["limited_by"], "supply");
}

TEST(Pneumatic, SizeRefusesWhatItCannotCompare) {
  EXPECT_EQ(run({"size", "pneumatic-3", "--load", "1,2"}).status, 2);
  EXPECT_EQ(run({"size", "pneumatic-3", "--position", "0.9,0,0"}).status, 1);
}

TEST(Synthesise, PrintsDesignsWithTheirTravel) {
  const Outcome outcome = run({"synthesise", "arm-cylinder", "--stroke", "100mm", "--retracted", "228.1mm",
                               "--range", "25deg", "--load", "25N", "--distance", "360mm", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto document = outcome.json();
  EXPECT_NEAR(document["minimum_peak_force"].get<double>(), 76.07, 0.01);
  ASSERT_EQ(document["designs"].size(), 6U);
  for (const auto& design : document["designs"]) {
    EXPECT_EQ(design["status"], "ok");
    EXPECT_TRUE(design["keeps_direction"].get<bool>());
    EXPECT_GE(design["peak_force"].get<double>(), 76.07);
  }
  EXPECT_NEAR(document["designs"][0]["l1"].get<double>(), 0.25005, 1e-5);
}

TEST(Synthesise, SaysWhatIsInfeasible) {
  const Outcome outcome = run({"synthesise", "arm-cylinder", "--stroke", "12.5mm", "--retracted", "75mm",
                               "--range", "30deg", "--lever", "1mm", "--json"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.json()["designs"][0]["status"], "infeasible_design");
  EXPECT_NE(outcome.err.find("--lever must be from"), std::string::npos);
}

TEST(Synthesise, MistakesEndWithAdvice) {
  const auto wrong = [](std::vector<std::string> arguments, const std::string& part) {
    arguments.insert(arguments.begin(), "synthesise");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  };
  wrong({"leg"}, "arm-cylinder");
  wrong({"arm-cylinder", "--range", "30deg"}, "--stroke");
  wrong({"arm-cylinder", "--stroke", "1 kg", "--retracted", "75mm", "--range", "30deg"}, "mass");
  wrong({"arm-cylinder", "--stroke", "-1mm", "--retracted", "75mm", "--range", "30deg"}, "positive");
  wrong({"arm-cylinder", "--stroke", "1mm", "--retracted", "75mm", "--range", "95deg"}, "less than 90 deg");
  wrong({"arm-cylinder", "--cylinder", "airpel-m9", "--retracted", "75mm", "--range", "30deg"},
        "airpel-m9d12.5u");
  wrong({"arm-cylinder", "--stroke", "1mm", "--retracted", "75mm", "--range", "30deg", "--layout", "five"},
        "two_mod");
  wrong({"arm-cylinder", "--stroke", "1mm", "--retracted", "75mm", "--range", "30deg", "--load", "5N"},
        "--distance");
}

}  // namespace
}  // namespace zwidth::testing
