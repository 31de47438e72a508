#pragma once

#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

/// What keeps a mechanism from being solved although every value of its description is allowed by itself: loops
/// that close nowhere, joint ranges that exclude every posture, too many or too few active joints. Give it to
/// `read_description`, which adds the places.

namespace zwidth {

/// REQUIRES: `validate(description)` finds nothing. Empty means that the loops close somewhere within the joint
/// ranges, and that the active joints, and nothing less or more, decide the posture.
std::vector<Problem> mechanism_problems(const Description& description);

}  // namespace zwidth
