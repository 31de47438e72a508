// How thick should the input pulley of a cable drive be? A thin one gives a high ratio, but loads cable and
// bearings. Works on plain numbers: no device file is needed to use the formulas.

#include <cstdio>
#include <numbers>

#include "zwidth/actuation/capstan.h"

int main() {
  using namespace zwidth;
  constexpr double kMotorTorque = 0.0694;  // [N m]
  constexpr double kSafety = 1.3;          // preload over the least that does not slip

  std::printf("input  ratio  output  preload  tension  bearing  cable\n");
  std::printf("   mm           N m        N        N        N     mm\n");
  for (double diameter = 6e-3; diameter <= 16.1e-3; diameter += 2e-3) {
    const Capstan capstan = solve_capstan({.input_diameter = diameter,
                                           .lead = 1e-3,
                                           .cable_diameter = 0.762e-3,
                                           .output_diameter = 150e-3,
                                           .centre_distance = 84e-3,
                                           .wraps = 3.0,
                                           .friction = 0.1,
                                           .output_range = 120.0 * std::numbers::pi / 180.0});
    if (!capstan.ok()) {
      std::printf("%5.1f  %.*s\n", 1e3 * diameter, static_cast<int>(capstan.reason.size()),
                  capstan.reason.data());
      continue;
    }
    const double preload = kSafety * capstan.min_preload(kMotorTorque);
    const CapstanLoads loads = capstan.loads(preload, kMotorTorque);
    std::printf("%5.1f  %5.2f  %6.3f  %7.2f  %7.2f  %7.2f  %5.0f\n", 1e3 * diameter, capstan.ratio,
                capstan.output_torque(kMotorTorque), preload, loads.high_tension, loads.bearing_radial,
                1e3 * capstan.cable_length);
  }
}
