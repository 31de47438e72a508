#pragma once

#include <string>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/problem.h"

/// What keeps a drive from being built although every value of its description is allowed by itself: pulleys
/// that overlap, a cable that does not sit in its groove. Give it to `read_description`, which adds the places.

namespace zwidth {

/// Of one drive. Keys begin with `path`, such as "drive[0]". Empty means that `Drive` can be built.
std::vector<Problem> drive_problems(const DriveDescription& description, const std::string& path);

/// Of every drive of a device.
std::vector<Problem> drive_problems(const Description& description);

}  // namespace zwidth
