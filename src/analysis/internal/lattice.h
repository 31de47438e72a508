#pragma once

#include <array>
#include <cstdint>

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_delta.h"

namespace zwidth::internal {

/// Lattice indices of a box that holds the whole workspace. Throws std::length_error beyond 10^12 lattice
/// points.
std::array<DeltaBatch::IndexRange, 3> lattice_box(const Mechanism& mechanism, double spacing);

/// Number of indices in a range.
inline std::int64_t size(const DeltaBatch::IndexRange& range) {
  return range.last < range.first ? 0 : range.last - range.first + 1;
}

/// Running minimum, maximum and mean, added to in a fixed order.
class StatisticBuilder {
 public:
  void add(double value, const Vector3& at) { add(1, value, value, at, value, at); }
  void add(std::int64_t count, double sum, double min, const Vector3& min_at, double max,
           const Vector3& max_at) {
    if (count == 0) return;
    if (statistic_.count == 0 || min < statistic_.min) {
      statistic_.min = min;
      statistic_.min_at = min_at;
    }
    if (statistic_.count == 0 || max > statistic_.max) {
      statistic_.max = max;
      statistic_.max_at = max_at;
    }
    statistic_.count += count;
    sum_ += sum;
  }
  void add(const StatisticBuilder& other) {
    const Statistic& s = other.statistic_;
    add(s.count, other.sum_, s.min, s.min_at, s.max, s.max_at);
  }
  Statistic result() const {
    Statistic result = statistic_;
    if (result.count > 0) result.mean = sum_ / static_cast<double>(result.count);
    return result;
  }

 private:
  Statistic statistic_;
  double sum_ = 0.0;
};

}  // namespace zwidth::internal
