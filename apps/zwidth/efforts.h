#pragma once

#include <string>
#include <vector>

#include "zwidth/mechanism/mechanism.h"

/// What joints push with: torques of those that turn, forces of those that slide.

namespace zwidth {

/// Whether active joint `i` is prismatic.
bool joint_slides(const Mechanism& mechanism, int i);
/// "N" of a joint that slides, else "N m".
const char* effort_unit(bool slides);
/// "force", "torque", or of some of both "torque and force".
const char* effort_word(const std::vector<bool>& slides);
bool all_slide(const std::vector<bool>& slides);
/// "18.60 N", or from the least to the largest where they differ: "0.4085 … 1.045 N m", "1.045 N m and 18.60
/// N".
std::string efforts_text(const ActiveVector& efforts, const std::vector<bool>& slides);

}  // namespace zwidth
