#pragma once

#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

/// The two halves of `validate`.

namespace zwidth {

/// What is wrong with the numbers and the geometry.
std::vector<Problem> value_problems(const Description& description);

/// Links and joints that bodies and drives name and the mechanism does not have. Means something only if the
/// mechanism could be read.
std::vector<Problem> name_problems(const Description& description);

}  // namespace zwidth
