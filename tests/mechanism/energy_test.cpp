#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "support/deltas.h"
#include "support/r_cubes.h"

#include "zwidth/mechanism/dynamics.h"

/// Energy is kept: ten seconds of swinging, integrated with a method of sixth order (Butcher 1964).

namespace zwidth {
namespace {

struct State {
  ActiveVector joints, rate;
};

class Swing {
 public:
  // Springs of stiffness k hold the joints around `middle`; none for a free swing.
  Swing(const Mechanism& mechanism, const ActiveVector& middle, double k)
      : mechanism_(mechanism), middle_(middle), k_(k) {}

  double energy(const State& s) {
    const Posture at = posture(s.joints);
    return kinetic_energy(at, s.rate) + potential_energy(at) + 0.5 * k_ * (s.joints - middle_).squaredNorm();
  }
  double kinetic(const State& s) { return kinetic_energy(posture(s.joints), s.rate); }

  State step(const State& from, double h) {
    static constexpr double a[7][6] = {{},
                                       {1.0 / 3},
                                       {0.0, 2.0 / 3},
                                       {1.0 / 12, 1.0 / 3, -1.0 / 12},
                                       {-1.0 / 16, 9.0 / 8, -3.0 / 16, -3.0 / 8},
                                       {0.0, 9.0 / 8, -3.0 / 8, -3.0 / 4, 1.0 / 2},
                                       {9.0 / 44, -9.0 / 11, 63.0 / 44, 18.0 / 11, 0.0, -16.0 / 11}};
    static constexpr double b[7] = {11.0 / 120, 0.0, 27.0 / 40, 27.0 / 40, -4.0 / 15, -4.0 / 15, 11.0 / 120};
    std::array<ActiveVector, 7> v, w;  // slopes of joints and rates
    State to = from;
    for (int i = 0; i < 7; ++i) {
      State at = from;
      for (int k = 0; k < i; ++k) {
        at.joints += h * a[i][k] * v[k];
        at.rate += h * a[i][k] * w[k];
      }
      v[i] = at.rate;
      w[i] = forward_dynamics(posture(at.joints), at.rate, -k_ * (at.joints - middle_));
      to.joints += h * b[i] * v[i];
      to.rate += h * b[i] * w[i];
    }
    return to;
  }

 private:
  Posture posture(const ActiveVector& joints) {
    const Solution solution = solve_forward(mechanism_, joints);
    if (!solution) throw std::runtime_error("the swing leaves what the loops can reach");
    return *solution.posture;
  }

  const Mechanism& mechanism_;
  ActiveVector middle_;
  double k_;
};

// Largest change of the energy over ten seconds, over the largest kinetic energy on the way.
double drift(const Mechanism& mechanism, const State& start, double k, double h) {
  Swing swing(mechanism, start.joints, k);
  State state = start;
  const double before = swing.energy(start);
  double worst = 0.0, fastest = swing.kinetic(start);
  const int steps = static_cast<int>(std::lround(10.0 / h));
  for (int i = 1; i <= steps; ++i) {
    state = swing.step(state, h);
    if (i % 50 != 0) continue;
    worst = std::max(worst, std::abs(swing.energy(state) - before));
    fastest = std::max(fastest, swing.kinetic(state));
  }
  return worst / fastest;
}

TEST(Energy, IsKeptByAnArmThatSwingsFreely) {
  SerialDescription rows;
  rows.joints = {{.name = "a", .a = 0.3, .alpha = 1.1, .range = {-9, 9}},
                 {.name = "b", .a = 0.25, .alpha = -0.6, .range = {-9, 9}},
                 {.name = "c", .a = 0.2, .range = {-9, 9}}};
  Description arm;
  arm.name = "arm";
  arm.gravity = {-9.81, 0.0, 0.0};
  arm.mechanism = rows;
  for (const char* on : {"arm/a", "arm/b", "arm/c"}) {
    arm.bodies.push_back(
        {.on = on, .mass = 0.2, .centre = {0.3, 0.1, 0.0}, .inertia = 1e-3 * Matrix3::Identity()});
  }
  const Mechanism mechanism(arm);
  EXPECT_LT(drift(mechanism, {Vector3(0.4, -0.7, 0.9), Vector3::Zero()}, 0.0, 1e-3), 1e-8);
}

TEST(Energy, IsKeptByClosedLoopsOnSprings) {
  const Mechanism delta(test::with_bodies(test::published_delta()));
  EXPECT_LT(drift(delta, {Vector3(0.5, 0.4, 0.6), Vector3(3.0, -2.0, 1.0)}, 1.5, 1e-3), 1e-8);

  Description cube = test::r_cube_device();
  const Material carbon{.elastic_modulus = 70e9, .poisson_ratio = 0.3, .density = 1630.0};
  for (const char* link : {"drive_link", "inner_link", "outer_link"})
    cube.bodies.push_back({.on = link, .beam = TubeDescription{0.02, 0.015, carbon}});
  cube.bodies.push_back({.on = "platform", .mass = 0.1});
  const Mechanism r_cube(cube);
  EXPECT_LT(drift(r_cube, {Vector3(0.0, 0.1, -0.1), Vector3(1.0, -2.0, 1.5)}, 3.0, 1e-3), 1e-8);
}

}  // namespace
}  // namespace zwidth
