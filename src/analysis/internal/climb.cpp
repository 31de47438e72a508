#include "zwidth/analysis/internal/climb.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <random>
#include <utility>

namespace zwidth::internal {
namespace {

constexpr double kFirstStep = 0.03, kLastStep = 1e-8, kWatched = 1e-4;  // of the joint ranges
constexpr double kGain = 1e-10;                                         // what is less may be rounding
constexpr double kEndless = 10.0;
constexpr int kMostQuestionsPerJoint = 150;

double uniform(std::mt19937& random) {
  return 2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0;
}

// Of a joint without a range a turn, or the size of the mechanism.
Interval range_of(const Mechanism& mechanism, int active) {
  const Interval range = mechanism.active_range(active);
  if (range.width() < 1e3) return range;
  const int joint = mechanism.active_joint(active);
  const bool slides = mechanism.joints()[static_cast<std::size_t>(joint)].type == JointType::prismatic;
  const double far = slides ? mechanism.characteristic_length() : std::numbers::pi;
  const double home = mechanism.home_guess()[joint];
  return {home - far, home + far};
}

}  // namespace

Summit climb(const Mechanism& mechanism, const ActiveVector& start, const JointFigure& figure) {
  const auto n = static_cast<int>(start.size());
  ActiveVector unit(n), low(n), high(n);
  for (int j = 0; j < n; ++j) {
    const Interval range = range_of(mechanism, j);
    low[j] = range.min;
    high[j] = range.max;
    unit[j] = range.width();
  }
  Summit best{.value = figure(start), .at = start};
  if (!(best.value > 0.0)) return best;
  std::mt19937 random(1);
  double step = kFirstStep, watched = 0.0;
  for (int left = kMostQuestionsPerJoint * n; left > 0 && step > kLastStep; left -= 2 * n) {
    bool gained = false;
    for (int w = 0; w < n && !gained; ++w) {
      ActiveVector way(n);
      for (int j = 0; j < n; ++j) way[j] = uniform(random);
      way *= step / std::max(way.norm(), 1e-3);
      for (const double sign : {1.0, -1.0}) {
        ActiveVector there = best.at + sign * way.cwiseProduct(unit);
        there = there.cwiseMax(low).cwiseMin(high);
        const double value = figure(there);
        if (std::isinf(value)) return {value, there, true};
        if (!(value > best.value * (1.0 + kGain))) continue;
        best.value = value;
        best.at = there;
        gained = true;
        break;
      }
    }
    step *= gained ? 1.5 : 0.5;
    if (step < kWatched && watched == 0.0) watched = best.value;
  }
  best.unbounded = watched > 0.0 && best.value > kEndless * watched;
  return best;
}

std::vector<ActiveVector> joint_raster(const Mechanism& mechanism) {
  const int n = mechanism.active_count();
  constexpr std::array kPoints = {33, 9, 5, 3};  // along each joint, of one to four joints; of more the ends
  const int points = n <= 4 ? kPoints[static_cast<std::size_t>(n - 1)] : 2;
  int count = 1;
  for (int j = 0; j < n; ++j) count *= points;
  std::vector<ActiveVector> raster;
  for (int index = 0; index < count; ++index) {
    ActiveVector joints(n);
    for (int j = 0, rest = index; j < n; ++j, rest /= points) {
      const Interval range = range_of(mechanism, j);
      joints[j] = range.min + range.width() * (rest % points) / (points - 1);
    }
    raster.push_back(joints);
  }
  return raster;
}

Summit highest(const Mechanism& mechanism, const ActiveVector& start, const std::vector<ActiveVector>& raster,
               const JointFigure& figure) {
  constexpr std::size_t kStarts = 3;
  Summit best = climb(mechanism, start, figure);
  std::vector<std::pair<double, std::size_t>> values;
  for (std::size_t r = 0; r < raster.size() && !best.unbounded; ++r) {
    const double value = figure(raster[r]);
    if (std::isinf(value)) return {value, raster[r], true};
    if (value > 0.0) values.emplace_back(value, r);
  }
  const std::size_t few = std::min(kStarts, values.size());
  std::partial_sort(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(few), values.end(),
                    std::greater());
  for (std::size_t s = 0; s < few && !best.unbounded; ++s) {
    const Summit other = climb(mechanism, raster[values[s].second], figure);
    if (other.unbounded || !(best.value >= other.value)) best = other;
  }
  return best;
}

}  // namespace zwidth::internal
