#pragma once

#include "context.h"

#include "zwidth/analysis/data_sheet.h"

namespace zwidth {

/// A data sheet as the document of `zwidth report --json` (keys in docs/json.md).
Json data_sheet_json(const DataSheet& sheet, const Description& description);

/// Minimum, maximum and mean, and where they are; null where the figure is not defined.
Json conditioning_json(const GlobalConditioning& conditioning);
Json conditioning_json(const WorkspaceConditioning& conditioning);
Json dexterous_json(const DexterousRegion& region);
/// Also median and percentiles where they were asked for. A largest value that grows without end is null,
/// and "unbounded" true; so is then a mean that goes with quantiles, which no lattice settles.
Json statistic_json(const Statistic& statistic);
Json statistic_json(const PostureStatistic& statistic);
Json margin_json(const Margin& margin);

}  // namespace zwidth
