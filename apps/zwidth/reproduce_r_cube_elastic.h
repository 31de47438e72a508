#pragma once

#include <vector>

#include "reproduction.h"

#include "zwidth/description/description.h"

/// Stiffness, laminates and vibration in Görgülü 2018: eq 5.132-5.134, tables 7.3 and 7.6, eq 7.6-7.13. Its
/// tables mix inputs; each is replayed as it came about, beside what the stated design has.

namespace zwidth {

/// REQUIRES: the description of devices/r-cube.toml.
void r_cube_elastic_figures(Figures& figures, const Description& description);

/// What of it does not come out.
std::vector<Erratum> r_cube_elastic_misses(const Description& description);

}  // namespace zwidth
