#pragma once

#include "sheet_figures.h"

namespace zwidth {

/// Figures of a device whose tool moves in a plane, in the order of the page. REQUIRES: sheet.plane.
std::vector<SheetFigure> plane_sheet_figures(const DataSheet& sheet, const Description& description);

}  // namespace zwidth
