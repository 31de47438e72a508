#pragma once

#include <string>
#include <vector>

#include "sheet_figures.h"

namespace zwidth {

/// A data sheet as one page that needs nothing else: no network, no script. `overrides` are those of the
/// command line.
std::string data_sheet_html(const DataSheet& sheet, const Description& description,
                            const std::vector<SheetFigure>& figures, const std::vector<std::string>& overrides);

}  // namespace zwidth
