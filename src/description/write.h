#pragma once

#include <iosfwd>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"

namespace zwidth {

/// Prints a device file that reads back, with the same catalogue, to an equal description. A part that equals
/// its catalogue entry is written by name; one that was changed names the entry and the values that differ.
/// REQUIRES: `validate(description)` finds nothing, and every part's name is in the catalogue.
void write_description(const Description& description, std::ostream& out, const Catalogue& catalogue);

}  // namespace zwidth
