#include "zwidth/mechanism/loaded_stiffness.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "support/allocation_counter.h"
#include "support/r_cubes.h"

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Material soft_steel(double density = 7850.0) {
  return {.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = density};
}

// Thin tubes, so that loads of some newtons show.
Description tubes(double density = 7850.0) {
  Description device = test::r_cube_device();
  for (const char* link : {"drive_link", "inner_link", "outer_link"}) {
    device.bodies.push_back({.on = link, .beam = TubeDescription{0.004, 0.002, soft_steel(density)}});
  }
  device.bodies.push_back({.on = "platform", .mass = 0.1});
  return device;
}

Posture at(const Mechanism& mechanism, double a, double b, double c) {
  const Solution solution = solve_forward(mechanism, Vector3(a, b, c) * kDegree);
  EXPECT_TRUE(solution);
  return *solution.posture;
}

const Vector6 kLoad = (Vector6() << 4.0, -3.0, 5.0, 0.05, 0.1, -0.08).finished();

// Metres, and radians as so many times 0.1 m.
double size_of(const Vector6& u) {
  return std::max(u.head<3>().norm(), 0.1 * u.tail<3>().norm());
}

TEST(LoadedStiffness, WithoutLoadsIsTheUnloadedOne) {
  const Mechanism mechanism(tubes());
  for (const auto& q : {Vector3(0, 0, 0), Vector3(20, -10, 30), Vector3(-30, -30, 10)}) {
    const Posture posture = at(mechanism, q[0], q[1], q[2]);
    const LoadedState state = loaded_stiffness(posture, {.weights = false});
    ASSERT_EQ(state.status, LoadedStatus::balanced);
    EXPECT_LT(size_of(state.displacement), 1e-12);
    const Matrix6 K = stiffness(posture).matrix;
    EXPECT_LT((state.stiffness - K).cwiseAbs().maxCoeff(), 1e-8 * K.cwiseAbs().maxCoeff());
  }
}

TEST(LoadedStiffness, OneDirectStepIsTheComplianceTimesTheLoad) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 30);
  const Vector6 u = compliance(stiffness(posture), 0.1).matrix * kLoad;
  const LoadedState direct =
      loaded_stiffness(posture, {.tool = kLoad, .weights = false}, {.method = LoadedMethod::direct});
  EXPECT_EQ(direct.status, LoadedStatus::balanced);
  EXPECT_EQ(direct.iterations, 1);
  EXPECT_LT(size_of(direct.displacement - u), 1e-9 * size_of(u));
  // And what small loads come to.
  const LoadedState small = loaded_stiffness(posture, {.tool = 1e-5 * kLoad, .weights = false});
  EXPECT_LT(size_of(small.displacement - 1e-5 * u), 1e-5 * size_of(1e-5 * u));
}

TEST(LoadedStiffness, IsHowTheBalanceMovesWithTheLoad) {
  // The tangent, geometric term included, against differences of whole solutions.
  const Mechanism mechanism(tubes());
  for (const bool weights : {false, true}) {
    const Posture posture = at(mechanism, 20, -10, 30);
    const LoadedState state = loaded_stiffness(posture, {.tool = kLoad, .weights = weights});
    ASSERT_EQ(state.status, LoadedStatus::balanced) << to_string(state.status);
    const Matrix6 C = state.stiffness.inverse();
    for (int i = 0; i < 6; ++i) {
      const double h = i < 3 ? 0.05 : 0.002;
      const auto shifted = [&](double by) {
        const LoadedState other =
            loaded_stiffness(posture, {.tool = kLoad + by * Vector6::Unit(i), .weights = weights});
        EXPECT_EQ(other.status, LoadedStatus::balanced);
        return other.tool;
      };
      const Pose plus = shifted(h), minus = shifted(-h);
      const Eigen::AngleAxisd turn(plus.rotation * minus.rotation.transpose());
      Vector6 slope;
      slope << (plus.position - minus.position) / (2.0 * h), turn.axis() * turn.angle() / (2.0 * h);
      EXPECT_LT(size_of(slope - C.col(i)), 1e-4 * size_of(slope)) << i << weights << "\n"
                                                                  << slope.transpose() << "\n"
                                                                  << C.col(i).transpose();
    }
    // The geometric term is there: without it the slope would be that of the unloaded device.
    EXPECT_GT((state.stiffness - stiffness(posture).matrix).norm(), 1e-3 * state.stiffness.norm());
  }
}

// One elastic link and, behind it, a rigid one in line: a held arm along x.
Description arm(double elastic, double rigid, double density = 1e-9) {
  SerialDescription rows;
  rows.joints = {{.name = "shoulder", .a = elastic, .range = {-3.0, 3.0}},
                 {.name = "elbow", .a = rigid, .range = {-3.0, 3.0}}};
  Description device;
  device.name = "arm";
  device.gravity = {0.0, 0.0, -10.0};
  device.mechanism = rows;
  device.bodies = {{.on = "arm/shoulder", .beam = TubeDescription{0.004, 0.0, soft_steel(density)}}};
  return device;
}

TEST(LoadedStiffness, ACompressedArmIsSofterAcross) {
  const double l = 0.2, a = 0.1;
  const Mechanism mechanism(arm(l, a));
  const Solution solution = solve_forward(mechanism, ActiveVector::Zero(2));
  const double EI = 200e9 * tube_section(0.004, 0.0)->second_moment_y;
  // What bends is turned by phi, and the push P then has the arm a phi.
  for (const double P : {-50.0, 50.0, 120.0}) {
    const LoadedState state =
        loaded_stiffness(*solution.posture, {.tool = -P * Vector6::Unit(0), .weights = false});
    ASSERT_EQ(state.status, LoadedStatus::balanced);
    const double phi = (l * l / (2.0 * EI) + a * l / EI) / (1.0 - P * a * l / EI);
    const double v = l * l * l / (3.0 * EI) + l * l / (2.0 * EI) * (a + P * a * phi);
    const double give = state.stiffness.inverse()(1, 1);
    EXPECT_NEAR(give / (v + a * phi), 1.0, 1e-6) << P;
  }
}

TEST(LoadedStiffness, AWeightBendsWhatCarriesIt) {
  const double l = 0.2, a = 0.1, m = 0.3;
  Description device = arm(l, a);
  device.bodies.push_back({.on = "arm/elbow", .mass = m, .centre = {l + 0.04, 0.0, 0.0}});
  device.bodies.push_back({.on = "arm/shoulder", .mass = 5.0, .centre = {0.1, 0.0, 0.0}});  // before the spring
  const Mechanism mechanism(device);
  const Solution solution = solve_forward(mechanism, ActiveVector::Zero(2));
  const LoadedState state = loaded_stiffness(*solution.posture, {}, {.method = LoadedMethod::direct});
  const double EI = 200e9 * tube_section(0.004, 0.0)->second_moment_y, F = 10.0 * m;
  const double w = F * (l * l * l / 3.0 + 0.04 * l * l / 2.0) / EI, turn = F * (l * l / 2.0 + 0.04 * l) / EI;
  EXPECT_NEAR(state.displacement[2], -w - a * turn, 1e-9 * w);
  EXPECT_NEAR(state.displacement[4], turn, 1e-9 * turn);
}

TEST(LoadedStiffness, WeightsOnPassiveJointsAreBalancedByTheDrives) {
  // Links of no stiffness to speak of against their weight, and a platform: the loops must close and the drives
  // hold; turned the other way up, everything hangs by as much.
  Description device = tubes();
  const Mechanism up(device);
  device.gravity = -device.gravity;
  const Mechanism down(device);
  const LoadedState a = loaded_stiffness(at(up, 10, 5, -20), {}, {.method = LoadedMethod::direct}),
                    b = loaded_stiffness(at(down, 10, 5, -20), {}, {.method = LoadedMethod::direct});
  EXPECT_GT(size_of(a.displacement), 1e-5);
  EXPECT_LT(size_of(a.displacement + b.displacement), 1e-9 * size_of(a.displacement));
}

TEST(LoadedStiffness, SaysWhenThereIsNoAnswer) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 30);
  const LoadedState early = loaded_stiffness(posture, {.tool = kLoad}, {.max_iterations = 2});
  EXPECT_EQ(early.status, LoadedStatus::not_converged);
  EXPECT_GT(early.residual, 1e-12);
  EXPECT_TRUE(early.stiffness.isZero());
  const LoadedState crushed = loaded_stiffness(posture, {.tool = 1e6 * kLoad});
  EXPECT_TRUE(crushed.status == LoadedStatus::unstable || crushed.status == LoadedStatus::not_converged)
      << to_string(crushed.status);
  const Mechanism rigid(test::r_cube_device());
  EXPECT_EQ(loaded_stiffness(at(rigid, 0, 0, 0), {}).status, LoadedStatus::rigid);
  LoadedOptions free;
  free.stiffness.drives = DriveState::free;
  EXPECT_EQ(loaded_stiffness(posture, {}, free).status, LoadedStatus::free);
}

TEST(LoadedStiffness, DrivesGiveToo) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 30);
  LoadedOptions options;
  options.stiffness.drive_stiffness = Vector3(90.0, 50.0, 70.0);
  const LoadedState state = loaded_stiffness(posture, {.weights = false}, options);
  const Matrix6 K = stiffness(posture, options.stiffness).matrix;
  EXPECT_LT((state.stiffness - K).cwiseAbs().maxCoeff(), 1e-8 * K.cwiseAbs().maxCoeff());
}

TEST(LoadedStiffness, DoesNotAllocate) {
  const Mechanism mechanism(tubes());
  const Posture posture = at(mechanism, 20, -10, 30);
  const long before = test::allocations();
  const LoadedState state = loaded_stiffness(posture, {.tool = kLoad});
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(state.status, LoadedStatus::balanced);
}

}  // namespace
}  // namespace zwidth
