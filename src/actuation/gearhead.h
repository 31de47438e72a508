#pragma once

#include "zwidth/description/description.h"

/// A transmission as far as torque and speed go: how many turns of the motor make one of the joint, and what
/// share of the motor's torque arrives (Baser 2006, section 5.1).

namespace zwidth {

/// Exact reduction: turns of the motor per turn of the output. Throws std::invalid_argument unless both are
/// positive and finite.
double reduction(double numerator, double denominator);
double reduction(const Gearhead& gearhead);

/// Motor torque M = Q / (i eta) [N m] that brings a torque Q [N m] to the joint; throws std::invalid_argument
/// unless ratio and efficiency are positive and finite.
double required_motor_torque(double joint_torque, double ratio, double efficiency);

/// Joint torque M i eta [N m] that a motor torque M [N m] brings. Throws likewise.
double output_torque(double motor_torque, double ratio, double efficiency);

}  // namespace zwidth
