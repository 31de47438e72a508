#include "zwidth/analysis/acceleration.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"
#include "support/positioning_stage.h"

#include "zwidth/analysis/inertia.h"

namespace zwidth {
namespace {

using test::uniform;

Mechanism heavy_delta() {
  Mechanism mechanism(test::with_bodies(test::published_delta()));
  mechanism.set_drive_inertia(Vector3(4e-4, 5e-4, 6e-4));
  return mechanism;
}

// Seven joints for six freedoms, bodies on pins, rotors so that every joint moves something.
Mechanism heavy_arm() {
  Mechanism mechanism(test::balanced_arm({}));
  mechanism.set_drive_inertia(ActiveVector::LinSpaced(7, 1e-3, 4e-3));
  return mechanism;
}

ActiveVector random_vector(std::mt19937_64& random, Eigen::Index n, double size) {
  ActiveVector v(n);
  for (double& value : v) value = uniform(random, -size, size);
  return v;
}

struct State {
  Posture posture;
  Rates all;
  ActiveVector rate;
};

State random_state(std::mt19937_64& random, const Mechanism& mechanism) {
  for (;;) {
    ActiveVector joints(mechanism.active_count());
    for (int j = 0; j < joints.size(); ++j) {
      const Interval range = mechanism.active_range(j);
      joints[j] = range.middle() + uniform(random, -0.35, 0.35) * range.width();
    }
    const Solution solution = solve_forward(mechanism, joints);
    if (solution.status != SolveStatus::reached || solution.conditioning < 0.02) continue;
    return {*solution.posture, rates(*solution.posture), random_vector(random, joints.size(), 3.0)};
  }
}

TEST(ToolMotion, IsTheSecondDifferenceOfTheToolsWay) {
  std::mt19937_64 random(81);
  for (const Mechanism& mechanism : {heavy_delta(), heavy_arm()}) {
    for (int k = 0; k < 20; ++k) {
      const State state = random_state(random, mechanism);
      const auto n = state.rate.size();
      const ActiveVector torque = random_vector(random, n, 1.0);
      const ToolVector push = random_vector(random, state.all.tool.rows(), 3.0);
      const ActiveVector acceleration = forward_dynamics(state.posture, state.rate, torque, push);
      const auto tool = [&](double t) {
        const ActiveVector joints = state.posture.active() + t * state.rate + 0.5 * t * t * acceleration;
        return solve_forward(mechanism, joints).posture->tool().position;
      };
      const double h = 1e-4;
      const Vector3 expected = (tool(h) - 2.0 * tool(0.0) + tool(-h)) / (h * h);
      const ToolMotion motion = tool_motion(state.posture, state.all, state.rate);
      const Vector3 got = tool_acceleration(motion, torque, push).head<3>();
      EXPECT_LT((got - expected).norm(), 1e-5 * (1.0 + acceleration.norm()));
    }
  }
}

TEST(ToolMotion, TorquesGiveTheToolTheAccelerationThatTheyAreFor) {
  std::mt19937_64 random(82);
  for (const Mechanism& mechanism : {heavy_delta(), heavy_arm()}) {
    for (int k = 0; k < 50; ++k) {
      const State state = random_state(random, mechanism);
      const auto rows = state.all.tool.rows();
      const ToolVector wanted = random_vector(random, rows, 20.0), push = random_vector(random, rows, 3.0);
      const auto torque = torques_for_tool_acceleration(state.posture, state.all, state.rate, wanted, push);
      ASSERT_TRUE(torque);
      const ToolVector got =
          tool_acceleration(tool_motion(state.posture, state.all, state.rate), *torque, push);
      EXPECT_LT((got - wanted).norm(), 1e-7 * (1.0 + wanted.norm()));
      // No other joint acceleration that does it costs less.
      const ActiveVector joints = forward_dynamics(state.posture, state.rate, *torque, push);
      const ActiveMatrix M = mass_matrix(state.posture);
      const Eigen::FullPivLU<Eigen::MatrixXd> lu{Eigen::MatrixXd(state.all.tool)};
      if (lu.dimensionOfKernel() == 0) continue;
      const Eigen::VectorXd spare = lu.kernel().col(0).normalized();
      EXPECT_LT(std::abs(spare.dot(M * joints)), 1e-8 * M.norm() * (1.0 + joints.norm()));
    }
  }
}

TEST(ToolMotion, ASingularPostureHasNoTorquesForEveryAcceleration) {
  // A stretched elbow.
  const Mechanism mechanism = heavy_arm();
  ActiveVector joints = ActiveVector::Zero(7);
  joints[1] = 1.0;
  const Posture posture = *solve_forward(mechanism, joints).posture;
  EXPECT_FALSE(
      torques_for_tool_acceleration(posture, rates(posture), ActiveVector::Zero(7), ToolVector::Ones(6)));
}

TEST(InertiaEllipsoid, HasTheKineticEnergyOfHalfAJoule) {
  std::mt19937_64 random(83);
  const Mechanism mechanism = heavy_delta();
  for (int k = 0; k < 30; ++k) {
    const State state = random_state(random, mechanism);
    const ToolMotion motion = tool_motion(state.posture, state.all, state.rate);
    const Ellipsoid ellipsoid = inertia_ellipsoid(motion.mobility);
    const Vector3 direction = Vector3(random_vector(random, 3, 1.0)).normalized();
    const Vector3 velocity = ellipsoid.axes * ellipsoid.lengths.asDiagonal() * direction;
    const ActiveVector rate = Matrix3(state.all.tool).inverse() * velocity;
    EXPECT_NEAR(kinetic_energy(state.posture, rate), 0.5, 1e-9);
    // Its ends are where the user feels least and most.
    const ApparentMass mass = apparent_mass(cartesian_mass(state.all.tool, mass_matrix(state.posture)));
    EXPECT_NEAR(1.0 / (ellipsoid.lengths[0] * ellipsoid.lengths[0]), mass.lightest, 1e-9 * mass.lightest);
    EXPECT_NEAR(1.0 / (ellipsoid.lengths[2] * ellipsoid.lengths[2]), mass.heaviest, 1e-9 * mass.heaviest);
  }
}

TEST(DynamicManipulability, IsJacobianOverMassMatrix) {
  std::mt19937_64 random(84);
  const Mechanism mechanism = heavy_delta();
  for (int k = 0; k < 30; ++k) {
    const State state = random_state(random, mechanism);
    const ToolMotion motion = tool_motion(state.posture, state.all, state.rate);
    const double expected =
        std::abs(Matrix3(state.all.tool).determinant()) / Matrix3(mass_matrix(state.posture)).determinant();
    EXPECT_NEAR(dynamic_manipulability(motion), expected, 1e-9 * expected);
    const ActiveVector limit = Vector3(0.5, 1.0, 2.0);
    const Ellipsoid ellipsoid = acceleration_ellipsoid(motion, limit);
    EXPECT_NEAR(ellipsoid.lengths.prod(), expected * limit.prod(), 1e-9 * expected);
  }
}

TEST(AccelerationPolytope, ReachesAsFarAsTheBestCornerOfTheTorques) {
  // Every corner of the torques through the joints' own forward dynamics.
  std::mt19937_64 random(85);
  for (const Mechanism& mechanism : {heavy_delta(), heavy_arm()}) {
    for (int k = 0; k < 10; ++k) {
      const State state = random_state(random, mechanism);
      const int n = mechanism.active_count();
      const TorqueRange range{-random_vector(random, n, 0.3).cwiseAbs() - ActiveVector::Constant(n, 2.0),
                              random_vector(random, n, 0.3).cwiseAbs() + ActiveVector::Constant(n, 2.5)};
      const ToolMotion motion = tool_motion(state.posture, state.all, state.rate).rows(0, 3);
      const Zonotope polytope = acceleration_polytope(motion, range);
      std::vector<Vector3> corners;
      const Vector3 bias = bias_acceleration(state.posture, state.all, state.rate).tool.head<3>();
      for (int corner = 0; corner < 1 << n; ++corner) {
        ActiveVector torque(n);
        for (int j = 0; j < n; ++j) torque[j] = (corner >> j & 1) != 0 ? range.max[j] : range.min[j];
        const ActiveVector joints = forward_dynamics(state.posture, state.rate, torque);
        corners.emplace_back((state.all.tool * joints).head<3>() + bias);
      }
      const auto reach = [&](const Vector3& u) {
        double best = -1e300;
        for (const Vector3& corner : corners) best = std::max(best, u.dot(corner));
        return best;
      };
      double least = 1e300;
      for (int d = 0; d < 2000; ++d)
        least = std::min(least, reach(Vector3(random_vector(random, 3, 1.0)).normalized()));
      const double size = polytope.outer_radius;
      EXPECT_GE(std::max(0.0, least), polytope.inner_radius - 1e-9 * size);
      EXPECT_NEAR(std::max(0.0, reach(polytope.inner_direction)), polytope.inner_radius, 1e-9 * size);
      double farthest = 0.0;
      for (const Vector3& corner : corners) farthest = std::max(farthest, corner.norm());
      EXPECT_NEAR(farthest, polytope.outer_radius, 1e-9 * farthest);
    }
  }
}

TEST(AccelerationPolytope, HasNothingLeftWhereTheWeightIsTooMuch) {
  std::mt19937_64 random(86);
  const Mechanism mechanism = heavy_delta();
  const State state = random_state(random, mechanism);
  const ToolMotion motion = tool_motion(state.posture, state.all, ActiveVector::Zero(3));
  const ActiveVector weight = gravity_torques(state.posture);
  EXPECT_EQ(acceleration_polytope(motion, TorqueRange::symmetric(0.99 * weight.cwiseAbs())).inner_radius, 0.0);
  EXPECT_GT(acceleration_polytope(motion, TorqueRange::symmetric(1.5 * weight.cwiseAbs())).inner_radius, 0.0);
}

TEST(MotionPower, IsTheRateOfEnergyPlusWhatTheUserTakes) {
  std::mt19937_64 random(87);
  const Mechanism mechanism = heavy_delta();
  for (int k = 0; k < 20; ++k) {
    const State state = random_state(random, mechanism);
    const ActiveVector acceleration = random_vector(random, 3, 20.0);
    const ToolVector push = random_vector(random, 3, 3.0);
    const auto energy = [&](double t) {
      const ActiveVector joints = state.posture.active() + t * state.rate + 0.5 * t * t * acceleration;
      const Posture posture = *solve_forward(mechanism, joints).posture;
      return kinetic_energy(posture, state.rate + t * acceleration) + potential_energy(posture);
    };
    const double h = 1e-5, growth = (energy(h) - energy(-h)) / (2.0 * h);
    const double user = push.dot(state.all.tool * state.rate);
    const MotionSample sample{state.posture.active(), state.rate, acceleration, push};
    const MotionPower power = motion_power(mechanism, std::span(&sample, 1));
    EXPECT_EQ(power.samples, 1);
    EXPECT_NEAR(power.peak.sum() - power.braking.sum(), growth - user, 1e-6 * (1.0 + std::abs(growth)));
    EXPECT_NEAR(power.total_peak, std::max(0.0, growth - user), 1e-6 * (1.0 + std::abs(growth)));
  }
}

TEST(MotionPower, FindsTheWorstInstant) {
  const Mechanism mechanism = heavy_delta();
  std::vector<MotionSample> motion;
  for (int s = 0; s < 100; ++s) {
    const double t = 0.01 * s, w = 2.0 * 3.14159265358979323846;
    motion.push_back({Vector3::Constant(0.5 + 0.3 * std::sin(w * t)),
                      Vector3::Constant(0.3 * w * std::cos(w * t)),
                      Vector3::Constant(-0.3 * w * w * std::sin(w * t)),
                      {}});
  }
  motion.push_back({Vector3(3.0, -1.5, 1.5), Vector3::Zero(), Vector3::Zero(), {}});  // out of reach
  const MotionPower power = motion_power(mechanism, motion);
  const bool reachable = static_cast<bool>(solve_forward(mechanism, motion.back().joints));
  EXPECT_EQ(power.samples, reachable ? 101 : 100);
  double expected = 0.0;
  int at = -1;
  for (int s = 0; s < 100; ++s) {
    const Posture posture = *solve_forward(mechanism, motion[static_cast<std::size_t>(s)].joints).posture;
    const MotionSample& sample = motion[static_cast<std::size_t>(s)];
    const double given = inverse_dynamics(posture, sample.rate, sample.acceleration).dot(sample.rate);
    if (given > expected) {
      expected = given;
      at = s;
    }
  }
  EXPECT_NEAR(power.total_peak, expected, 1e-12);
  EXPECT_EQ(power.total_peak_at, at);
  EXPECT_TRUE((power.rms.array() <= power.torque.array()).all());
}

}  // namespace
}  // namespace zwidth
