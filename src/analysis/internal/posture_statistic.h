#pragma once

#include "zwidth/analysis/posture_sweep.h"

namespace zwidth::internal {

/// Takes one posture's value into a statistic. Not for NaN.
inline void add(PostureStatistic& statistic, double value, const ActiveVector& at) {
  if (statistic.count == 0 || value < statistic.min) {
    statistic.min = value;
    statistic.min_at = at;
  }
  if (statistic.count == 0 || value > statistic.max) {
    statistic.max = value;
    statistic.max_at = at;
  }
  ++statistic.count;
  statistic.mean += (value - statistic.mean) / static_cast<double>(statistic.count);
}

}  // namespace zwidth::internal
