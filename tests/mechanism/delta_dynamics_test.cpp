#include "zwidth/mechanism/delta_dynamics.h"

#include <cmath>
#include <gtest/gtest.h>

#include "support/allocation_counter.h"
#include "support/deltas.h"

#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

// Tubes for forearms: they have an inertia about their own line, and two bodies of each leg differ.
Description with_tubes(const DeltaDescription& delta) {
  Description description = test::with_bodies(delta);
  description.bodies[1].beam.reset();
  description.bodies[1].inertia(2, 2) = 4e-6;
  description.bodies.push_back({.on = "forearm",
                                .mass = 0.02,
                                .centre = {0.0, 0.0, 0.3 * delta.forearm},
                                .inertia = Vector3(3e-6, 3e-6, 5e-6).asDiagonal()});
  description.gravity = {1.5, -2.5, -9.0};
  return description;
}

TEST(DeltaDynamics, EqualsThatOfPostures) {
  std::mt19937_64 random(71);
  for (int round = 0; round < 20; ++round) {
    const DeltaDescription lengths = round == 0 ? test::published_delta() : test::random_delta(random);
    for (const Description& device : {test::with_bodies(lengths), with_tubes(lengths)}) {
      Mechanism mechanism(device);
      mechanism.set_drive_inertia(Vector3(4e-4, 5e-4, 6e-4));
      const auto dynamics = DeltaDynamics::of(mechanism);
      ASSERT_TRUE(dynamics);
      for (int k = 0; k < 20; ++k) {
        const DeltaMotion motion{test::random_angles(random, lengths.joint_range),
                                 test::random_angles(random, {-5, 5})};
        const Vector3 wanted = test::random_angles(random, {-90, 90}),
                      push = test::random_angles(random, {-5, 5});
        const Solution solution = solve_forward(mechanism, motion.theta);
        if (!solution || solution.conditioning < 0.02) continue;
        const Vector3 torque = dynamics->inverse(motion, wanted, push),
                      expected = inverse_dynamics(*solution.posture, motion.rate, wanted, push);
        // Both lose as many digits as the closure is badly conditioned.
        EXPECT_LT((torque - expected).norm(), 1e-11 * (1.0 + expected.norm()) / solution.conditioning);
        const DeltaAcceleration back = dynamics->forward(motion, torque, push);
        EXPECT_EQ(back.status, solution.status == SolveStatus::joint_limit ? back.status : solution.status);
        EXPECT_LT((back.theta - wanted).norm(), 1e-9 * wanted.norm() / solution.conditioning);
      }
    }
  }
}

TEST(DeltaDynamics, KeepsItsEnergyAndItsLoops) {
  // Symplectic Euler: the energy error stays in proportion to the step, and halves with it.
  const Mechanism mechanism(with_tubes(test::published_delta()));
  const auto dynamics = DeltaDynamics::of(mechanism);
  const double stiffness = 1.5;
  const Vector3 middle(0.5, 0.4, 0.6);
  const auto energy = [&](const DeltaMotion& motion) {
    const Posture posture = *solve_forward(mechanism, motion.theta).posture;
    return kinetic_energy(posture, motion.rate) + potential_energy(posture) +
           0.5 * stiffness * (motion.theta - middle).squaredNorm();
  };
  const auto worst = [&](double dt) {
    DeltaMotion motion{middle, {3.0, -2.0, 1.0}};
    const double before = energy(motion);
    double error = 0.0;
    for (int k = 0; k * dt < 2.0; ++k) {
      const Vector3 torque = -stiffness * (motion.theta - middle);
      EXPECT_EQ(dynamics->step(motion, torque, Vector3::Zero(), dt), SolveStatus::reached);
      if (k % 10 == 0) error = std::max(error, std::abs(energy(motion) - before));
    }
    // The loops: from the elbows, shifted inwards, to the tool it is a forearm's length.
    const DeltaGeometry geometry = *mechanism.delta();
    const Vector3 tool = delta_forward(geometry, motion.theta).position;
    for (int i = 0; i < 3; ++i) {
      const double azimuth = delta_azimuth(i),
                   outward = geometry.offset() + geometry.upper_arm * std::cos(motion.theta[i]);
      const Vector3 elbow(outward * std::cos(azimuth), outward * std::sin(azimuth),
                          geometry.upper_arm * std::sin(motion.theta[i]));
      EXPECT_NEAR((tool - elbow).norm(), geometry.forearm, 1e-12);
    }
    return error;
  };
  const double coarse = worst(2e-4), fine = worst(1e-4);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_NEAR(coarse / fine, 2.0, 0.2);
}

TEST(DeltaDynamics, HasNoAnswerWhereTheLoopsDoNotClose) {
  const Mechanism mechanism(test::with_bodies(test::published_delta()));
  const auto dynamics = DeltaDynamics::of(mechanism);
  DeltaMotion motion{{3.1, -1.5, 1.5}, {1.0, 2.0, 3.0}};
  const DeltaMotion before = motion;
  EXPECT_EQ(dynamics->step(motion, Vector3::Ones(), Vector3::Zero(), 1e-3),
            delta_forward(*mechanism.delta(), motion.theta).status);
  if (delta_forward(*mechanism.delta(), before.theta).status == SolveStatus::unreachable) {
    EXPECT_EQ(motion.theta, before.theta);
    EXPECT_EQ(motion.rate, before.rate);
  }
}

TEST(DeltaDynamics, IsOnlyThereForRods) {
  Description lopsided = test::with_bodies(test::published_delta());
  lopsided.bodies[1].centre.x() = 1e-3;
  EXPECT_FALSE(DeltaDynamics::of(Mechanism(lopsided)));
  Description flat = test::with_bodies(test::published_delta());
  flat.bodies[1].inertia(0, 0) *= 2.0;
  EXPECT_FALSE(DeltaDynamics::of(Mechanism(flat)));
}

TEST(DeltaDynamics, DoesNotAllocate) {
  const Mechanism mechanism(with_tubes(test::published_delta()));
  const auto dynamics = DeltaDynamics::of(mechanism);
  DeltaMotion motion{{0.5, 0.4, 0.6}, {3.0, -2.0, 1.0}};
  const long before = test::allocations();
  dynamics->step(motion, Vector3::Ones(), Vector3::Zero(), 1e-3);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace zwidth
