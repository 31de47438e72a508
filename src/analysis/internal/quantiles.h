#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace zwidth::internal {

/// Puts the median and the two percentiles of values into a statistic; reorders them. No value, none of them.
template <class Statistic>
void put_quantiles(std::vector<double>& values, Statistic& statistic) {
  if (values.empty()) return;
  const auto quantile = [&](double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
  };
  statistic.median = quantile(0.5);
  statistic.percentile_5 = quantile(0.05);
  statistic.percentile_95 = quantile(0.95);
}

}  // namespace zwidth::internal
