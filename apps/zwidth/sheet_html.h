#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sheet_figures.h"

namespace zwidth {

/// CSS of a page with a header, contents at its side, tiles, tables and figures.
std::string_view page_style();

/// A data sheet as one page that needs nothing else: no network, no script. `overrides` are those of the
/// command line.
std::string data_sheet_html(const DataSheet& sheet, const Description& description,
                            const std::vector<SheetFigure>& figures, const std::vector<std::string>& overrides);

}  // namespace zwidth
