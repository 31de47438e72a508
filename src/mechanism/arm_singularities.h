#pragma once

#include <vector>

#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth {

/// The sets of singular postures of an arm of the S-R-S form (srs_arm.h), however its frames and zeros lie, and
/// how far a posture is from each: four with seven joints, three of an arm of six, whose theta3 is fixed at any
/// angle. Empty for other mechanisms. `dexterity` says of any mechanism how near to a singularity it is, but
/// not to which. Allocates.
std::vector<SrsSingularity> arm_singularities(const Posture& posture);

}  // namespace zwidth
