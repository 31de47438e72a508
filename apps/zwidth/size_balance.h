#pragma once

#include <span>

#include "context.h"

#include "zwidth/description/description.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {

/// Static balance over postures: what weight is left for the joints to hold, for the hand at the tool, and
/// where a body of the device would have to be to take it. Adds lines to the page and returns the JSON object,
/// null if nothing has mass. REQUIRES: at least one posture.
Json write_balance(const Description& description, const Mechanism& mechanism,
                   std::span<const Posture> postures, Sheet& sheet);

}  // namespace zwidth
