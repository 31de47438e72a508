#pragma once

#include <string>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/internal/table_reader.h"

namespace zwidth {

/// Reads the values, title and sources of a part on top of what `part` already holds, and finishes the table.
/// Unless `partial`, whatever is required must be there. `source` says whether the part must name its source.
template <class Part>
void read_part_values(TableReader& table, Part& part, bool partial, Need source);

/// Reads `key = "NAME"`, `key = { base = "NAME", value = ... }` or a whole part as an inline table.
template <class Part>
Part read_part(TableReader& table, std::string_view key, const Catalogue& catalogue);

}  // namespace zwidth
