#pragma once

#include <random>

#include "zwidth/mechanism/posture.h"

/// What holds for every mechanism, whatever it is. Each function expects one law at a posture, by GoogleTest.

namespace zwidth::laws {

/// A posture of a mechanism, and how to solve for others near it.
struct Situation {
  const Posture& here;
  double conditioning;  ///< of the solution that `here` comes from
  bool closed_form;
  ActiveVector rate, acceleration;  ///< a motion through it [rad/s, m/s], [rad/s^2, m/s^2]
  ToolVector wrench;                ///< a load on the tool [N, N m]

  const Mechanism& mechanism() const { return here.mechanism(); }
  /// Where the motion is at a time [s]; empty where it leaves what can be reached.
  Solution at(double time, bool accelerated = false) const;
};

/// A situation with a random motion and a random wrench.
Situation any_situation(const Solution& solution, bool closed_form, std::mt19937_64& random);

void inverse_undoes_forward(const Situation& situation);
void forward_undoes_inverse(const Situation& situation);
void rates_are_differences(const Situation& situation);
void bias_acceleration_is_the_difference_of_rates(const Situation& situation);
void power_at_the_joints_is_power_at_the_tool(const Situation& situation);
void mass_is_symmetric_and_positive(const Situation& situation);
void mass_gives_the_energy_of_the_bodies(const Situation& situation);
void gravity_torques_are_the_slope_of_the_energy(const Situation& situation);
void torques_do_the_work_that_energy_gains(const Situation& situation);
void a_cycle_does_not_allocate(const Situation& situation);
/// Whatever can be asked of a posture, singular or not, is a number.
void everything_is_finite(const Solution& solution);

/// All of those that want a regular posture.
void all(const Situation& situation);

/// Follows a random line of active joints, and one of tool poses, to where they end, and looks at what is just
/// before: the singularities that bound what can be reached.
void borders_are_finite(const Mechanism& mechanism, const Solution& start, bool closed_form,
                        std::mt19937_64& random);

}  // namespace zwidth::laws
