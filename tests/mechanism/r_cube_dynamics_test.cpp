#include "zwidth/mechanism/r_cube_dynamics.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/r_cubes.h"

#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

const Material kMaterial{.elastic_modulus = 70e9, .poisson_ratio = 0.3, .density = 1800.0};

Description device(const Vector3& gravity) {
  Description description = test::r_cube_device();
  description.gravity = gravity;
  description.bodies = {{.on = "drive_link", .beam = TubeDescription{0.03, 0.0225, kMaterial}},
                        {.on = "inner_link", .beam = TubeDescription{0.024, 0.018, kMaterial}},
                        {.on = "outer_link", .beam = TubeDescription{0.0144, 0.0108, kMaterial}},
                        {.on = "platform", .mass = 0.07}};
  return description;
}

RCubeMasses masses(const Vector3& gravity) {
  RCubeMasses result = r_cube_masses(
      test::published_r_cube(),
      {*tube_section(0.03, 0.0225), *tube_section(0.024, 0.018), *tube_section(0.0144, 0.0108)}, 1800.0);
  result.platform = 0.07;
  result.gravity = gravity;
  return result;
}

Vector3 random(std::mt19937_64& random, double size) {
  return {test::uniform(random, -size, size), test::uniform(random, -size, size),
          test::uniform(random, -size, size)};
}

TEST(RCubeDynamics, TheGeneralDynamicsAgree) {
  std::mt19937_64 seed(21);
  for (int i = 0; i < 100; ++i) {
    const Vector3 gravity = random(seed, 10.0), theta = random(seed, 0.56), rate = random(seed, 3.0),
                  acceleration = random(seed, 30.0);
    const Mechanism mechanism(device(gravity));
    const Solution general = solve_forward(mechanism, theta);
    const RCubeMasses own = masses(gravity);
    const RCubeSolution closed = r_cube_forward(own.geometry, theta);
    ASSERT_TRUE(general && closed.closed());
    const auto mass = r_cube_cartesian_mass(own, closed);
    const auto effort = r_cube_inverse_dynamics(own, closed, rate, acceleration);
    ASSERT_TRUE(mass && effort);
    const Matrix3 felt = cartesian_mass(jacobian(*general.posture), mass_matrix(*general.posture));
    EXPECT_LT((felt - *mass).cwiseAbs().maxCoeff(), 1e-11 * mass->maxCoeff());
    const Vector3 torque = inverse_dynamics(*general.posture, rate, acceleration);
    EXPECT_LT((torque - effort->torque).norm(), 1e-9 * std::max(1e-3, torque.norm()));
    EXPECT_LT((Vector3(closed.lever.cwiseProduct(effort->force)) - effort->torque).norm(), 1e-15);
  }
}

TEST(RCubeDynamics, ForceTimesVelocityIsTheRiseOfKineticEnergy) {
  const RCubeMasses own = masses(Vector3::Zero());
  const Vector3 theta(0.2, -0.3, 0.1), rate(1.0, -2.0, 0.5), acceleration(3.0, 5.0, -4.0);
  const auto energy = [&](double t) {
    const Vector3 q = theta + t * rate + 0.5 * t * t * acceleration, qd = rate + t * acceleration;
    const RCubeSolution at = r_cube_forward(own.geometry, q);
    const Vector3 v = at.lever.cwiseProduct(qd);
    return 0.5 * v.dot(*r_cube_cartesian_mass(own, at) * v);
  };
  const double h = 1e-5;
  const RCubeSolution now = r_cube_forward(own.geometry, theta);
  const RCubeEffort effort = *r_cube_inverse_dynamics(own, now, rate, acceleration);
  const double power = effort.force.dot(now.lever.cwiseProduct(rate));
  EXPECT_NEAR((energy(h) - energy(-h)) / (2.0 * h), power, 1e-7 * std::abs(power));
}

TEST(RCubeDynamics, ThePublishedInertiaIsThatAboutTheEnd) {
  const Section tube = *tube_section(0.02, 0.01);
  const RCubeGeometry geometry = test::published_r_cube();
  const RCubeMasses plain = r_cube_masses(geometry, {tube, tube, tube}, 2000.0),
                    printed = r_cube_masses(geometry, {tube, tube, tube}, 2000.0, RCubeInertia::published);
  const double m = plain.mass[0], l = geometry.drive_link;
  EXPECT_NEAR(plain.inertia[0], m * (l * l / 12.0 + (1e-4 + 0.25e-4) / 4.0), 1e-15);
  EXPECT_NEAR(printed.inertia[0], m * (l * l / 3.0 + (1e-4 + 0.25e-4) / 4.0), 1e-15);
}

TEST(RCubeDynamics, HasNoAnswerWhereALegIsStretched) {
  RCubeMasses own = masses(Vector3::Zero());
  own.geometry = {.drive_link = 0.1, .inner_link = 0.06, .outer_link = 0.04, .base_offset = 0.1};
  const RCubeSolution at = r_cube_forward(own.geometry, Vector3::Zero());
  ASSERT_TRUE(at.closed());
  EXPECT_FALSE(r_cube_cartesian_mass(own, at));
  EXPECT_FALSE(r_cube_inverse_dynamics(own, at, Vector3::Ones(), Vector3::Zero()));
}

}  // namespace
}  // namespace zwidth
