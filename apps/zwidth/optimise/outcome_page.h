#pragma once

#include <string>
#include <vector>

#include "optimise/outcome.h"
#include "sheet_figures.h"

namespace zwidth {

/// Every figure that the outcome has data for. Sections: "front", "parallel", "sensitivity", "steps", "search".
std::vector<SheetFigure> outcome_drawings(const StudyOutcome& outcome, const StudyModel& model);

/// The outcome as one page that explains the trade-off and needs nothing else: no network, no script.
std::string outcome_page(const StudyOutcome& outcome, const StudyModel& model,
                         const std::vector<SheetFigure>& figures);

}  // namespace zwidth
