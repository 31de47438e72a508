#include "zwidth/analysis/inertia.h"

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <random>

#include "support/deltas.h"

namespace zwidth {
namespace {

TEST(ApparentMass, IsTheForcePerAccelerationOfAPushedTool) {
  const Mechanism mechanism(test::with_bodies(test::published_delta()));
  std::mt19937_64 random(51);
  for (int n = 0; n < 20; ++n) {
    const Solution solution = solve_forward(
        mechanism, ActiveVector(test::random_angles(random, test::published_delta().joint_range)));
    ASSERT_TRUE(solution);
    const Posture& posture = *solution.posture;
    const Jacobian J = jacobian(posture);
    const ActiveMatrix M = mass_matrix(posture);
    const ToolMatrix Lambda = cartesian_mass(J, M);
    const ApparentMass mass = apparent_mass(Lambda);
    for (int k = 0; k < 3; ++k) {
      // Push with 1 N along an axis, gravity held off by the drives, and see how the tool accelerates.
      const ActiveVector acceleration = forward_dynamics(
          posture, ActiveVector::Zero(3), gravity_torques(posture), ToolVector(Vector3::Unit(k)));
      const double along = (J * acceleration)[k];
      EXPECT_NEAR(mass.along_axes[k] * along, 1.0, 1e-9);
      EXPECT_NEAR(apparent_mass(Lambda, 2.0 * ToolVector::Unit(3, k)), mass.along_axes[k], 1e-12);
      EXPECT_GE(mass.along_axes[k], mass.lightest * (1.0 - 1e-12));
      EXPECT_LE(mass.along_axes[k], mass.heaviest * (1.0 + 1e-12));
    }
    EXPECT_NEAR(apparent_mass(Lambda, mass.lightest_direction), mass.lightest, 1e-12);
    EXPECT_NEAR(apparent_mass(Lambda, mass.heaviest_direction), mass.heaviest, 1e-12);
  }
}

}  // namespace
}  // namespace zwidth
