#pragma once

#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

/// The other half of `validate`, beside `value_problems`.

namespace zwidth {

/// Links and joints that bodies and drives name and the mechanism does not have. Means something only if the
/// mechanism could be read.
std::vector<Problem> name_problems(const Description& description);

}  // namespace zwidth
