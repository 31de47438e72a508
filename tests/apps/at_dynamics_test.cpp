#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>

#include "run_command.h"

// What `at` says of masses, accelerations and power, against what follows from its other keys.

namespace zwidth::testing {
namespace {

using nlohmann::json;

Eigen::MatrixXd matrix(const json& rows) {
  Eigen::MatrixXd M(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index r = 0; r < M.rows(); ++r) {
    for (Eigen::Index c = 0; c < M.cols(); ++c) M(r, c) = rows[static_cast<size_t>(r)][static_cast<size_t>(c)];
  }
  return M;
}
Eigen::VectorXd vector(const json& values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = values[static_cast<size_t>(i)];
  return v;
}

json at(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"at"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.emplace_back("--json");
  const Outcome outcome = run(all);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.json();
}

TEST(AtDynamics, MassesFollowFromTheMassMatrix) {
  for (const std::vector<std::string>& place :
       {std::vector<std::string>{"delta", "--joints", "10deg,20deg,30deg", "--frame", "user"},
        {"five-bar", "--joints", "120deg,60deg"},
        {"seven-dof", "--joints", "0,75deg,10deg,90deg,90deg,80deg,90deg"}}) {
    const json document = at(place);
    const Eigen::MatrixXd J = matrix(document["jacobian"]), M = matrix(document["mass_matrix"]);
    const Eigen::MatrixXd mobility = J * M.inverse() * J.transpose();
    const Eigen::Index linear = std::min<Eigen::Index>(3, J.rows());
    const json& mass = document["apparent_mass"]["translation"];
    for (Eigen::Index k = 0; k < linear; ++k)
      EXPECT_NEAR(mass["axis"][static_cast<size_t>(k)].get<double>() * mobility(k, k), 1.0, 1e-9) << place[0];
    const Eigen::MatrixXd block = mobility.topLeftCorner(linear, linear);
    const Eigen::VectorXd u = vector(mass["lightest_direction"]), h = vector(mass["heaviest_direction"]);
    EXPECT_NEAR(u.dot(block * u) * mass["lightest"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(h.dot(block * h) * mass["heaviest"].get<double>(), 1.0, 1e-9);
    EXPECT_LT((block * h - h.dot(block * h) * h).norm(), 1e-9 * block.norm());
    const Eigen::VectorXd lengths = vector(document["inertia_ellipsoid"]["translation"]["half_axes"]);
    EXPECT_NEAR(lengths[0] * lengths[0] * mass["lightest"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(
        document["dynamic_manipulability"]["translation"]["unit_torque"].get<double>(),
        std::sqrt(
            (J.topRows(linear) * M.inverse() * M.inverse() * J.topRows(linear).transpose()).determinant()),
        1e-7 * std::sqrt((J * M.inverse() * M.inverse() * J.transpose()).norm()) * 1e3);
    EXPECT_EQ(document["drive_inertia"].size(), document["joints"].size());
  }
}

TEST(AtDynamics, AccelerationsInEveryDirectionAreTheLeastOverTheTorques) {
  const json document = at({"delta", "--joints", "10deg,20deg,30deg", "--rate", "1,-2,0.5"});
  const Eigen::MatrixXd R = matrix(document["jacobian"]) * matrix(document["mass_matrix"]).inverse();
  for (const char* name : {"continuous", "peak"}) {
    const json& limits = document["acceleration_limits"][name]["translation"];
    const Eigen::VectorXd torque = vector(document["force_limits"][name]["torque"]);
    const Eigen::VectorXd coasting = vector(limits["coasting"]), u = vector(limits["weakest_direction"]);
    EXPECT_NEAR(limits["every_direction"].get<double>(),
                u.dot(coasting) + (R.transpose() * u).cwiseAbs().dot(torque), 1e-7);
    // Coasting is what the joints' own inverse dynamics says: no torque at all.
    const Eigen::VectorXd held = vector(document["torques"]);  // at no joint acceleration
    EXPECT_LT((coasting + R * held - vector(document["acceleration"])).norm(), 1e-9);
  }
}

TEST(AtDynamics, PowerIsTorqueTimesRate) {
  const json document = at({"delta", "--joints", "10deg,20deg,30deg", "--rate", "1,-2,0.5", "--acceleration",
                            "9,8,7", "--load", "1,2,3"});
  double total = 0.0;
  const double rate[] = {1.0, -2.0, 0.5};
  for (size_t j = 0; j < 3; ++j) {
    const double power = document["torques"][j].get<double>() * rate[j];
    EXPECT_NEAR(document["power"]["joints"][j].get<double>(), power, 1e-12);
    total += power;
  }
  EXPECT_NEAR(document["power"]["total"].get<double>(), total, 1e-12);
}

TEST(AtDynamics, TorquesAccelerateAsTheyAreNeededFor) {
  // What `torques` says an acceleration needs gives it.
  const json needed = at({"seven-dof", "--joints", "0,75deg,10deg,90deg,90deg,80deg,90deg", "--rate",
                          "1,-2,0.5,0,1,2,3", "--acceleration", "9,8,7,6,5,4,3", "--load", "1,2,3"});
  std::string torques;
  for (const json& torque : needed["torques"]) torques += (torques.empty() ? "" : ",") + torque.dump();
  const json document = at({"seven-dof", "--joints", "0,75deg,10deg,90deg,90deg,80deg,90deg", "--rate",
                            "1,-2,0.5,0,1,2,3", "--torque", torques, "--load", "1,2,3"});
  for (size_t j = 0; j < 7; ++j)
    EXPECT_NEAR(document["accelerations"]["joints"][j].get<double>(), 9.0 - static_cast<double>(j), 1e-6);
  EXPECT_LT((vector(document["accelerations"]["tool"]) - vector(needed["acceleration"])).norm(), 1e-6);
  EXPECT_EQ(run({"at", "delta", "--joints", "0,0,0", "--torque", "1,2"}).status, 2);
}

TEST(AtDynamics, EnergyIsThatOfTheMassMatrix) {
  const json document = at({"delta", "--joints", "10deg,20deg,30deg", "--rate", "1,-2,0.5"});
  const Eigen::Vector3d rate(1.0, -2.0, 0.5);
  EXPECT_NEAR(document["energy"]["kinetic"].get<double>(),
              0.5 * rate.dot(matrix(document["mass_matrix"]) * rate), 1e-12);
  EXPECT_TRUE(at({"delta", "--joints", "0,0,0"})["energy"]["kinetic"].is_null());
}

TEST(AtDynamics, ALoadedDeviceGivesAsItsComplianceSaysForSmallLoads) {
  const std::vector<std::string> place{"r-cube", "--joints", "0.1,0.2,0.1"};
  const auto with = [&](const char* load) {
    std::vector<std::string> arguments = place;
    arguments.insert(arguments.end(), {"--load", load});
    return at(arguments);
  };
  const json sag = at(place), loaded = with("0.01,0,0");
  EXPECT_EQ(sag["loaded"]["status"], "balanced");
  EXPECT_LT(sag["loaded"]["residual"].get<double>(), 1e-12);
  const Eigen::MatrixXd K = matrix(sag["loaded"]["stiffness"]);
  const Eigen::VectorXd moved =
      vector(loaded["loaded"]["displacement"]) - vector(sag["loaded"]["displacement"]);
  // The hand pushes back with what the device exerts on it.
  Eigen::VectorXd push = Eigen::VectorXd::Zero(6);
  push[0] = -0.01;
  EXPECT_LT((moved - K.inverse() * push).norm(), 1e-4 * moved.norm());
  EXPECT_EQ(at({"five-bar", "--joints", "120deg,60deg"})["loaded"], nullptr);
}

TEST(AtDynamics, ALoadThatBreaksTheBalanceIsNoAnswer) {
  const Outcome outcome = run({"at", "r-cube", "--joints", "0.1,0.2,0.1", "--load", "1e5,0,0", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json loaded = outcome.json()["loaded"];
  EXPECT_NE(loaded["status"], "balanced");
  EXPECT_TRUE(loaded["displacement"].is_null());
  EXPECT_GT(loaded["residual"].get<double>(), 0.0);
}

TEST(AtDynamics, ThePageShowsHowTheToolMovesInEachMode) {
  const Outcome outcome = run({"at", "r-cube", "--joints", "0.1,0.2,0.1", "--only", "natural_frequencies"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* line : {"motors held [Hz]", "motors free [Hz]", "along x", "along z"})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << line;
}

TEST(AtDynamics, WhereTheToolCannotMoveItIsInfinitelyHeavy) {
  const Outcome outcome = run({"at", "r-cube", "--set", "mechanism.inner_link=60 mm", "--set",
                               "mechanism.outer_link=51.7 mm", "--joints", "0,0,0", "--only",
                               "apparent_mass,dynamic_manipulability,acceleration_limits", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json document = outcome.json();
  EXPECT_TRUE(document["apparent_mass"]["translation"]["lightest"].is_null());
  EXPECT_EQ(document["dynamic_manipulability"]["translation"]["unit_torque"], 0.0);
  EXPECT_EQ(document["acceleration_limits"]["continuous"]["translation"]["every_direction"], 0.0);
}

TEST(AtDynamics, WithoutDrivesOrMassesItSaysSo) {
  const json hexapod = at({std::string(ZWIDTH_EXAMPLES) + "/devices/hexapod.toml", "--joints", "0,0,0,0,0,0"});
  EXPECT_TRUE(hexapod["acceleration_limits"].is_null());
  EXPECT_TRUE(hexapod["notes"].contains("acceleration_limits"));
  EXPECT_GT(hexapod["apparent_mass"]["translation"]["lightest"].get<double>(), 0.0);
  EXPECT_FALSE(hexapod["dynamic_manipulability"]["translation"].contains("half_axes"));
  const ScratchDirectory scratch;
  const std::string bare = scratch.file("bare.toml", R"(
[device]
name = "bare"
[mechanism]
type = "serial"
[[joint]]
name = "a"
type = "revolute"
a = "100 mm"
range = ["-90 deg", "90 deg"]
[[joint]]
name = "b"
type = "revolute"
a = "100 mm"
range = ["-90 deg", "90 deg"]
)");
  const json nothing = at({bare, "--joints", "10deg,20deg"});
  for (const char* key : {"apparent_mass", "inertia_ellipsoid", "dynamic_manipulability"}) {
    EXPECT_TRUE(nothing[key].is_null()) << key;
    EXPECT_EQ(nothing["notes"][key], "not given by the source: the mass that some joint moves");
  }
}

}  // namespace
}  // namespace zwidth::testing
