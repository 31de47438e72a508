#include <cstdlib>
#include <gtest/gtest.h>

#include "support/allocation_counter.h"
#include "support/deltas.h"

#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

// What a control cycle asks of a mechanism, for the closed form and for the general solver.
double cycle(const Mechanism& mechanism, const Posture& last, const Vector3& theta, bool closed_form) {
  const SolveOptions options{.start = &last, .closed_form = closed_form};
  const Solution forward = solve_forward(mechanism, theta, options);
  const Solution inverse = solve_inverse(mechanism, forward.posture->tool(), options);
  const Rates all = rates(*forward.posture);
  const ActiveVector rate = Vector3(0.1, 0.2, 0.3), acceleration = Vector3(1.0, 2.0, 3.0);
  const ActiveVector torque = inverse_dynamics(*inverse.posture, rate, acceleration);
  const ActiveVector response = forward_dynamics(*forward.posture, rate, torque);
  return response.sum() + gravity_torques(*forward.posture, all).sum() +
         cartesian_mass(all.tool, mass_matrix(*forward.posture, all)).trace();
}

TEST(RealTime, ACycleDoesNotAllocate) {
  const DeltaDescription description = test::published_delta();
  for (const Description& device : {test::with_bodies(description), test::with_parallelograms(description)}) {
    const Mechanism mechanism(device);
    const Posture start = *solve_forward(mechanism, Vector3(0.3, 0.4, 0.5)).posture;
    for (const bool closed_form : {true, false}) {
      const long before = test::allocations();
      const double sum = cycle(mechanism, start, {0.31, 0.41, 0.49}, closed_form);
      EXPECT_EQ(test::allocations(), before);
      EXPECT_TRUE(std::isfinite(sum));
    }
  }
}

TEST(RealTime, TheCounterCounts) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const long before = test::allocations();
  void* volatile memory = std::malloc(10);
  EXPECT_EQ(test::allocations(), before + 1);
  std::free(memory);
#endif
}

}  // namespace
}  // namespace zwidth
