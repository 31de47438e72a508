#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "terminal.h"

/// Statistics over a workspace or over postures, as people read them.

namespace zwidth {

/// The largest value, or that there is none.
template <class Statistic>
std::string largest_text(const Statistic& statistic, double factor) {
  return statistic.unbounded || !std::isfinite(statistic.max) ? "no bound" : number(statistic.max * factor);
}

/// A row: label, least, mean, largest, unit; with `quantiles`, median and 95th percentile instead of the mean.
template <class Statistic>
std::vector<std::string> statistic_cells(const std::string& label, const Statistic& statistic, double factor,
                                         const std::string& unit, bool quantiles = false) {
  const bool known = statistic.count > 0;
  std::vector<std::string> row = {label, known ? number(statistic.min * factor) : "–"};
  if (quantiles) {
    row.push_back(known && statistic.median ? number(*statistic.median * factor) : "–");
    row.push_back(known && statistic.percentile_95 ? number(*statistic.percentile_95 * factor) : "–");
  } else {
    row.push_back(!known ? "–" : std::isfinite(statistic.mean) ? number(statistic.mean * factor) : "no bound");
  }
  row.push_back(known ? largest_text(statistic, factor) : "–");
  row.push_back(unit);
  return row;
}

/// The heads of such rows, `over` over the labels.
inline std::vector<std::string> statistic_heads(const std::string& over, bool quantiles = false) {
  if (quantiles) return {over, "min", "median", "95 %", "max", ""};
  return {over, "min", "mean", "max", ""};
}

/// Whether any row says that there is no bound.
inline bool any_unbounded(const std::vector<std::vector<std::string>>& rows) {
  for (const std::vector<std::string>& row : rows) {
    for (const std::string& text : row) {
      if (text == "no bound") return true;
    }
  }
  return false;
}

/// What those rows mean.
inline std::string rows_note(const std::vector<std::vector<std::string>>& rows, bool quantiles) {
  std::string note;
  if (quantiles) note = "Half of all lie below the median, 95 of 100 below 95 %.";
  if (any_unbounded(rows)) {
    note += note.empty() ? "" : " ";
    note += "No bound: the figure grows without end towards a singular posture.";
  }
  return note;
}

}  // namespace zwidth
