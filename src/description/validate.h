#pragma once

#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

namespace zwidth {

/// Everything that is wrong with a description, whether read or made in code: values out of range, names
/// unknown or used twice, geometry that never closes. Keys are those of the device file; places are empty.
/// Empty means that a `Mechanism` can be built from it, and that `drive_problems` may be asked about its
/// drives.
std::vector<Problem> validate(const Description& description);

/// Of that, what is wrong with the numbers and the geometry: all that can go wrong when numbers change.
std::vector<Problem> value_problems(const Description& description);

}  // namespace zwidth
