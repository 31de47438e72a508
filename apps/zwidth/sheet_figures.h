#pragma once

#include <string>
#include <vector>

#include "zwidth/analysis/data_sheet.h"

namespace zwidth {

/// One figure of a data sheet.
struct SheetFigure {
  std::string id;       ///< "condition-xy": file name, and anchor in the page
  std::string section;  ///< of the page: "device", "workspace", "dexterity", "force", "drive-0"
  std::string title;
  std::string caption;
  std::string svg;
};

/// Every figure that the sheet has data for, in the order of the page.
std::vector<SheetFigure> sheet_figures(const DataSheet& sheet, const Description& description);

/// A figure as a file of its own, in light colours.
std::string standalone_svg(const SheetFigure& figure);

}  // namespace zwidth
