#include "zwidth/analysis/reach.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "zwidth/analysis/internal/bounded_step.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/mechanism/batch_serial.h"
#include "zwidth/mechanism/point_reach.h"

namespace zwidth {
namespace {

constexpr double kMostCubes = 1e9;
constexpr std::int64_t kBlock = 4096;  // postures of one call of the batch kernel
constexpr std::uint64_t kNoSample = ~std::uint64_t{0};
constexpr double kOnMiddle = 1e-3;  // of the spacing: near enough to the middle of a cube

using Indices = std::array<std::int64_t, 3>;

struct Box {
  double h = 0.0;
  Indices first{}, count{};

  std::size_t size() const { return static_cast<std::size_t>(count[0] * count[1] * count[2]); }
  std::size_t index(const Indices& at) const {
    return static_cast<std::size_t>((at[0] * count[1] + at[1]) * count[2] + at[2]);
  }
  Indices place(std::size_t index) const {
    const auto at = static_cast<std::int64_t>(index);
    return {at / count[2] / count[1], at / count[2] % count[1], at % count[2]};
  }
  bool holds(const Indices& at) const {
    for (int k = 0; k < 3; ++k) {
      if (at[k] < 0 || at[k] >= count[k]) return false;
    }
    return true;
  }
  Vector3 middle(const Indices& at) const {
    return h * Vector3(static_cast<double>(first[0] + at[0]) + 0.5, static_cast<double>(first[1] + at[1]) + 0.5,
                       static_cast<double>(first[2] + at[2]) + 0.5);
  }
};

// A box round the reach; a margin keeps cubes whose middle lies on the boundary.
Box box_of(const Mechanism& mechanism, const ReachOptions& options) {
  std::array<Interval, 3> ends;
  for (int k = 0; k < 3; ++k) {
    ends[k].max = farthest_along(mechanism, Vector3::Unit(k)).distance;
    ends[k].min = -farthest_along(mechanism, -Vector3::Unit(k)).distance;
  }
  Box box{.h = options.spacing};
  const double longest = std::max({ends[0].width(), ends[1].width(), ends[2].width()});
  if (box.h == 0.0) {
    // A flat reach is as thick as a hundredth of its length here, so that its cubes stay of a useful size.
    double volume = 1.0;
    for (const Interval& end : ends) volume *= std::max(end.width(), 0.01 * longest);
    box.h = std::cbrt(volume / std::max(1.0, 0.1 * static_cast<double>(options.samples)));
  }
  double cubes = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double low = std::floor(ends[k].min / box.h) - 1.0, high = std::floor(ends[k].max / box.h) + 1.0;
    cubes *= high - low + 1.0;
    if (!(cubes <= kMostCubes))
      throw std::length_error("a spacing this fine cuts the box round the reach into more than 10^9 cubes");
    box.first[k] = static_cast<std::int64_t>(low);
    box.count[k] = static_cast<std::int64_t>(high - low) + 1;
  }
  return box;
}

// Of each cube, the drawn posture whose tool is nearest to its middle: its distance in the upper half, its
// number in the lower one. The least of them does not depend on the order of the threads.
std::vector<std::uint64_t> nearest_samples(const Mechanism& mechanism, const Box& box, std::int64_t samples,
                                           const Effort& effort, bool& complete) {
  std::vector<std::uint64_t> nearest(box.size(), kNoSample);
  const SerialBatch batch(*mechanism.serial());
  const int joints = mechanism.active_count();
  const auto blocks = static_cast<std::size_t>((samples + kBlock - 1) / kBlock);
  complete = internal::for_each_index(blocks, effort, [&](std::size_t b) {
    const std::int64_t begin = static_cast<std::int64_t>(b) * kBlock;
    const auto n = static_cast<std::size_t>(std::min(kBlock, samples - begin));
    thread_local std::vector<double> q, x, y, z;
    q.resize(n * static_cast<std::size_t>(joints));
    for (auto* axis : {&x, &y, &z}) axis->resize(n);
    spread_postures(mechanism, begin, n, q);
    batch.positions(std::span(q).first(n * static_cast<std::size_t>(joints)), x, y, z);
    for (std::size_t p = 0; p < n; ++p) {
      const Vector3 position(x[p], y[p], z[p]);
      Indices at;
      for (int k = 0; k < 3; ++k)
        at[k] = static_cast<std::int64_t>(std::floor(position[k] / box.h)) - box.first[k];
      if (!box.holds(at)) continue;
      const auto distance = static_cast<float>((position - box.middle(at)).squaredNorm());
      const std::uint64_t key = (std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32U) |
                                static_cast<std::uint32_t>(begin + static_cast<std::int64_t>(p));
      std::atomic_ref<std::uint64_t> best(nearest[box.index(at)]);
      std::uint64_t before = best.load(std::memory_order_relaxed);
      while (key < before && !best.compare_exchange_weak(before, key, std::memory_order_relaxed)) {
      }
    }
  });
  return nearest;
}

// Leads the tool point to a place by Newton's method with the joints in their ranges.
class Leader {
 public:
  explicit Leader(const Mechanism& mechanism) : chain_(*mechanism.serial()), step_(mechanism) {}

  // Whether the tool gets within `tolerance` of `goal`; `q` is then the posture.
  bool lead(ActiveVector& q, const Vector3& goal, double tolerance) const noexcept {
    constexpr int kSteps = 12;
    SerialForward here;
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0; step <= kSteps; ++step) {
      chain_.forward(q, here);
      const Vector3 gap = goal - here.tool.position;
      const double distance = gap.norm();
      if (distance <= tolerance) return true;
      // At a boundary of the reach the gap stops shrinking.
      if (step > 2 && distance > 0.9 * before) return false;
      before = distance;
      if (!step_.take<3>(here.jacobian, gap, q)) return false;
    }
    return false;
  }

 private:
  const SerialChain& chain_;
  internal::BoundedStep step_;
};

// Tests the middle of every cube.
bool decide(ReachMap& map, const Box& box, const PointReach& reach, const Effort& effort) {
  const auto rows = static_cast<std::size_t>(box.count[0] * box.count[1]);
  const auto per_row = static_cast<std::size_t>(box.count[2]);
  return internal::for_each_index(rows, effort, [&](std::size_t row) {
    for (std::size_t cube = row * per_row; cube < (row + 1) * per_row; ++cube) {
      map.inside[cube] = reach.contains(box.middle(box.place(cube))) ? 1 : 0;
    }
  });
}

// The arm's postures in the middles of the cubes found so far.
class Postures {
 public:
  Postures(std::size_t cubes, int joints)
      : joints_(joints), values_(cubes * static_cast<std::size_t>(joints)) {}
  void keep(std::size_t cube, const ActiveVector& q) {
    for (int j = 0; j < joints_; ++j) values_[cube * joints_ + j] = static_cast<float>(q[j]);
  }
  ActiveVector of(std::size_t cube) const {
    ActiveVector q(joints_);
    for (int j = 0; j < joints_; ++j) q[j] = values_[cube * joints_ + j];
    return q;
  }

 private:
  int joints_;
  std::vector<float> values_;
};

}  // namespace

std::optional<std::string> reach_obstacle(const Mechanism& mechanism) {
  if (mechanism.serial() == nullptr)
    return "it is known for arms of one leg only, all of whose joints are active";
  return std::nullopt;
}

bool ReachMap::at(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const Box box{spacing, first, count};
  const Indices place{i - first[0], j - first[1], k - first[2]};
  return box.holds(place) && inside[box.index(place)] != 0;
}

bool ReachMap::contains(const Vector3& point) const {
  const auto index = [&](int axis) { return static_cast<std::int64_t>(std::floor(point[axis] / spacing)); };
  return at(index(0), index(1), index(2));
}

std::int64_t ReachMap::cubes_inside() const {
  return std::count(inside.begin(), inside.end(), std::uint8_t{1});
}

ReachMap reach_map(const Mechanism& mechanism, const ReachOptions& options, const Effort& effort) {
  assert(!reach_obstacle(mechanism) && options.samples > 0 && options.spacing >= 0.0);
  const Box box = box_of(mechanism, options);
  ReachMap map{.spacing = box.h, .first = box.first, .count = box.count};
  map.inside.assign(box.size(), 0);
  if (options.closed_form) {
    if (const auto exact = PointReach::of(mechanism)) {
      map.complete = decide(map, box, *exact, effort);
      return map;
    }
  }
  const std::int64_t samples =
      std::min<std::int64_t>(options.samples, std::numeric_limits<std::uint32_t>::max());
  const std::vector<std::uint64_t> nearest = nearest_samples(mechanism, box, samples, effort, map.complete);
  if (!map.complete) return map;

  const double tolerance = kOnMiddle * box.h;
  Postures postures(box.size(), mechanism.active_count());
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  const auto layers = static_cast<std::size_t>(box.count[0]);
  const std::size_t per_layer = box.size() / std::max<std::size_t>(1, layers);
  map.complete = internal::for_each_index(layers, quiet, [&](std::size_t layer) {
    const Leader leader(mechanism);
    for (std::size_t cube = layer * per_layer; cube < (layer + 1) * per_layer; ++cube) {
      if (nearest[cube] == kNoSample) continue;
      ActiveVector q = spread_posture(mechanism, static_cast<std::uint32_t>(nearest[cube]));
      if (!leader.lead(q, box.middle(box.place(cube)), tolerance)) continue;
      map.inside[cube] = 1;
      postures.keep(cube, q);
    }
  });

  // On to the neighbours, all of one round at once, so that the order of the threads does not matter.
  std::vector<std::size_t> fresh;
  for (std::size_t cube = 0; cube < map.inside.size(); ++cube) {
    if (map.inside[cube] != 0) fresh.push_back(cube);
  }
  while (!fresh.empty() && map.complete) {
    struct Attempt {
      std::size_t cube, from;
      bool reached = false;
      ActiveVector q = {};
    };
    std::vector<Attempt> attempts;
    for (const std::size_t from : fresh) {
      const Indices place = box.place(from);
      for (int k = 0; k < 3; ++k) {
        for (const std::int64_t step : {-1, 1}) {
          Indices next = place;
          next[k] += step;
          if (box.holds(next) && map.inside[box.index(next)] == 0) attempts.push_back({box.index(next), from});
        }
      }
    }
    constexpr std::size_t kChunk = 512;
    map.complete =
        internal::for_each_index((attempts.size() + kChunk - 1) / kChunk, quiet, [&](std::size_t chunk) {
          const Leader leader(mechanism);
          for (std::size_t a = chunk * kChunk; a < std::min(attempts.size(), (chunk + 1) * kChunk); ++a) {
            Attempt& attempt = attempts[a];
            attempt.q = postures.of(attempt.from);
            attempt.reached = leader.lead(attempt.q, box.middle(box.place(attempt.cube)), tolerance);
          }
        });
    fresh.clear();
    for (const Attempt& attempt : attempts) {
      if (!attempt.reached || map.inside[attempt.cube] != 0) continue;
      map.inside[attempt.cube] = 1;
      postures.keep(attempt.cube, attempt.q);
      fresh.push_back(attempt.cube);
    }
  }
  return map;
}

namespace {

// Sum over the planes between layers of cubes of (faces of the boundary in that plane)^2. A flat side of the
// reach lies somewhere between two planes, so all its faces err by the same part of a spacing, evenly
// distributed: by 1/sqrt(12) in the mean square. Those of a curved side lie in many planes, and err by chance.
double squared_faces(const ReachMap& map) {
  const Box box{map.spacing, map.first, map.count};
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> faces(static_cast<std::size_t>(map.count[axis]) + 1);
    for (std::size_t cube = 0; cube < map.inside.size(); ++cube) {
      if (map.inside[cube] == 0) continue;
      const Indices at = box.place(cube);
      for (const std::int64_t step : {-1, 1}) {
        Indices next = at;
        next[axis] += step;
        if (box.holds(next) && map.inside[box.index(next)] != 0) continue;
        faces[static_cast<std::size_t>(std::max(at[axis], next[axis]))] += 1.0;
      }
    }
    for (const double count : faces) sum += count * count;
  }
  return sum;
}

}  // namespace

ReachableVolume reachable_volume(const ReachMap& map) {
  ReachableVolume volume{.spacing = map.spacing, .complete = map.complete};
  const Box box{map.spacing, map.first, map.count};
  std::array<std::int64_t, 8> counts{};
  std::array<Indices, 2> ends{Indices{box.count}, Indices{-1, -1, -1}};
  for (std::size_t cube = 0; cube < map.inside.size(); ++cube) {
    if (map.inside[cube] == 0) continue;
    const Indices at = box.place(cube);
    unsigned parity = 0;
    for (int k = 0; k < 3; ++k) {
      parity |= static_cast<unsigned>((map.first[k] + at[k]) & 1) << k;
      ends[0][k] = std::min(ends[0][k], at[k]);
      ends[1][k] = std::max(ends[1][k], at[k]);
    }
    ++counts[parity];
  }
  const double cube = std::pow(map.spacing, 3);
  std::int64_t all = 0;
  for (const std::int64_t count : counts) all += count;
  volume.value = static_cast<double>(all) * cube;
  volume.error_estimate = std::sqrt(squared_faces(map) / 12.0) * cube;
  for (const std::int64_t count : counts) {
    // Where a flat side lies along the lattice, which is the worst case, twice the spacing errs twice as much.
    const double apart = std::abs(8.0 * static_cast<double>(count) * cube - volume.value);
    volume.error_estimate = std::max(volume.error_estimate, 0.5 * apart);
  }
  if (all == 0) return volume;
  for (int k = 0; k < 3; ++k) {
    volume.bounds[k] = {map.spacing * static_cast<double>(map.first[k] + ends[0][k]),
                        map.spacing * static_cast<double>(map.first[k] + ends[1][k] + 1)};
  }
  return volume;
}

ReachableVolume reachable_volume(const Mechanism& mechanism, const ReachOptions& options,
                                 const Effort& effort) {
  return reachable_volume(reach_map(mechanism, options, effort));
}

}  // namespace zwidth
