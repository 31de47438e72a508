#pragma once

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"
#include "zwidth/description/internal/table_reader.h"

namespace zwidth {

/// Reads the tables of a device file. What is wrong is noted in the input; what could not be read keeps the
/// value that the structs start with.
Description read_device_tables(Input& input, const Catalogue& catalogue);

}  // namespace zwidth
