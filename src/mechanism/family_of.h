#pragma once

#include "zwidth/mechanism/mechanism.h"

namespace zwidth {

/// The description of a mechanism, if it was described as one of this family and not as legs; null otherwise.
const FiveBarDescription* five_bar_of(const Mechanism& mechanism) noexcept;
const RCubeDescription* r_cube_of(const Mechanism& mechanism) noexcept;

}  // namespace zwidth
