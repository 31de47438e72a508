#pragma once

#include <vector>

#include "zwidth/actuation/drive.h"

namespace zwidth::internal {

/// Adds a margin, unless one of its sides is not known.
void add_margin(std::vector<Margin>& margins, const char* name, double demand, double capability,
                const char* unit, const char* rule);

}  // namespace zwidth::internal
