#pragma once

#include <string>

#include "zwidth/mechanism/mechanism.h"

namespace zwidth {

/// Values of all active joints (order 0), their rates (1), accelerations (2) or torques (3) from the text of an
/// option, one for each joint. Those of joints that the hand alone moves may be left out: they are then at
/// home, all else zero. Throws InputError.
ActiveVector joint_values(const char* option, const std::string& text, const Mechanism& mechanism,
                          int order = 0);

/// "3 values, one for each driven joint (theta1, theta2, theta3), or 5 with the joints that the hand turns
/// (theta4, theta5)".
std::string joint_values_wanted(const Mechanism& mechanism);

}  // namespace zwidth
