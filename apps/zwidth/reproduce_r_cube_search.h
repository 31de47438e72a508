#pragma once

#include <vector>

#include "reproduction.h"

/// The searches of Görgülü 2018, made again by the studies that come with zwidth.

namespace zwidth {

/// The kinematic search within the three sets of bounds of table 7.1, beside the 40 designs of table 7.2.
std::vector<SearchFinding> r_cube_search_findings();

/// The ratio of the diameters by the study r-cube-section.
void r_cube_section_study(Figures& figures);

}  // namespace zwidth
