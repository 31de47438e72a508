#include "zwidth/analysis/reach_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/trace.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/point_reach.h"

namespace zwidth {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Squared distances to the nearest zero of `f` along a line, f itself being squared distances across it: the
// lower envelope of parabolas (Felzenszwalb & Huttenlocher 2012). Beyond both ends f counts as zero.
class DistancePass {
 public:
  void run(std::vector<float>& f) {
    const int n = static_cast<int>(f.size());
    lowest_.clear();
    from_.clear();
    const auto value = [&](int q) { return q < 0 || q >= n ? 0.0F : f[static_cast<std::size_t>(q)]; };
    for (int q = -1; q <= n; ++q) {
      float start = -std::numeric_limits<float>::infinity();
      while (!lowest_.empty()) {
        const int p = lowest_.back();
        const auto square = [](int k) { return static_cast<float>(k) * static_cast<float>(k); };
        start = ((value(q) + square(q)) - (value(p) + square(p))) / static_cast<float>(2 * (q - p));
        if (start > from_.back()) break;
        lowest_.pop_back();
        from_.pop_back();
        start = -std::numeric_limits<float>::infinity();
      }
      lowest_.push_back(q);
      from_.push_back(start);
    }
    result_.resize(f.size());
    std::size_t k = 0;
    for (int q = 0; q < n; ++q) {
      while (k + 1 < from_.size() && from_[k + 1] < static_cast<float>(q)) ++k;
      const auto apart = static_cast<float>(q - lowest_[k]);
      result_[static_cast<std::size_t>(q)] = apart * apart + value(lowest_[k]);
    }
    f.swap(result_);
  }

 private:
  std::vector<int> lowest_;
  std::vector<float> from_, result_;
};

struct Grid {
  std::array<std::int64_t, 3> n;
  std::size_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((i * n[1] + j) * n[2] + k);
  }
};

Vector3 middle_of(const ReachMap& map, double i, double j, double k) {
  return map.spacing * Vector3(static_cast<double>(map.first[0]) + i + 0.5,
                               static_cast<double>(map.first[1]) + j + 0.5,
                               static_cast<double>(map.first[2]) + k + 0.5);
}

InscribedShape largest_ball(const ReachMap& map) {
  const Grid grid{map.count};
  constexpr float kFar = 1e12F;
  std::vector<float> distance(map.inside.size());
  std::transform(map.inside.begin(), map.inside.end(), distance.begin(),
                 [](std::uint8_t inside) { return inside != 0 ? kFar : 0.0F; });
  DistancePass pass;
  std::vector<float> line;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    std::array<std::int64_t, 3> at{};
    for (at[a] = 0; at[a] < grid.n[a]; ++at[a]) {
      for (at[b] = 0; at[b] < grid.n[b]; ++at[b]) {
        line.clear();
        for (at[axis] = 0; at[axis] < grid.n[axis]; ++at[axis]) {
          line.push_back(distance[grid.index(at[0], at[1], at[2])]);
        }
        pass.run(line);
        for (at[axis] = 0; at[axis] < grid.n[axis]; ++at[axis]) {
          distance[grid.index(at[0], at[1], at[2])] = line[static_cast<std::size_t>(at[axis])];
        }
      }
    }
  }
  InscribedShape ball;
  const auto farthest = std::ranges::max_element(distance);
  if (farthest == distance.end() || *farthest <= 0.0F) return ball;
  const std::int64_t at = farthest - distance.begin();
  const std::int64_t k = at % grid.n[2], j = at / grid.n[2] % grid.n[1], i = at / grid.n[2] / grid.n[1];
  ball.centre = middle_of(map, static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  // The middle of the nearest cube outside is that far; the boundary lies between it and the last middle
  // inside.
  ball.size = map.spacing * std::max(0.5, std::sqrt(static_cast<double>(*farthest)) - 0.5);
  ball.volume = 4.0 / 3.0 * std::numbers::pi * std::pow(ball.size, 3);
  return ball;
}

InscribedShape largest_cube(const ReachMap& map) {
  const Grid grid{map.count};
  // Edge of the largest cube whose upper corner is each cell: one more than the least of its lower neighbours.
  std::vector<std::int32_t> edge(map.inside.size(), 0);
  std::int32_t largest = 0;
  std::array<std::int64_t, 3> corner{};
  for (std::int64_t i = 0; i < grid.n[0]; ++i) {
    for (std::int64_t j = 0; j < grid.n[1]; ++j) {
      for (std::int64_t k = 0; k < grid.n[2]; ++k) {
        const std::size_t here = grid.index(i, j, k);
        if (map.inside[here] == 0) continue;
        std::int32_t least = std::numeric_limits<std::int32_t>::max();
        for (int lower = 1; lower < 8; ++lower) {
          const std::int64_t li = i - (lower & 1), lj = j - (lower >> 1 & 1), lk = k - (lower >> 2 & 1);
          least = std::min(least, li < 0 || lj < 0 || lk < 0 ? 0 : edge[grid.index(li, lj, lk)]);
        }
        edge[here] = least + 1;
        if (edge[here] > largest) {
          largest = edge[here];
          corner = {i, j, k};
        }
      }
    }
  }
  InscribedShape cube;
  if (largest == 0) return cube;
  const double half = 0.5 * (largest - 1);
  cube.centre = middle_of(map, static_cast<double>(corner[0]) - half, static_cast<double>(corner[1]) - half,
                          static_cast<double>(corner[2]) - half);
  cube.size = map.spacing * largest;
  cube.volume = std::pow(cube.size, 3);
  return cube;
}

// The layer of a map that a plane goes through.
struct Layer {
  int axis = 2, u = 0, v = 1;
  std::int64_t index = 0;

  std::array<std::int64_t, 3> cell(std::int64_t iu, std::int64_t iv) const {
    std::array<std::int64_t, 3> at{};
    at[static_cast<std::size_t>(axis)] = index;
    at[static_cast<std::size_t>(u)] = iu;
    at[static_cast<std::size_t>(v)] = iv;
    return at;
  }
};

Slice cut(const ReachMap& map, const Layer& layer, double at) {
  Slice slice{.axis = layer.axis, .at = at, .u = layer.u, .v = layer.v};
  const auto inside = [&](std::int64_t iu, std::int64_t iv) {
    if (iu < 0 || iv < 0 || iu >= map.count[layer.u] || iv >= map.count[layer.v]) return 0.0;
    const auto cell = layer.cell(iu, iv);
    return map.inside[Grid{map.count}.index(cell[0], cell[1], cell[2])] != 0 ? 1.0 : 0.0;
  };
  // Each point takes a quarter of itself, an eighth of its neighbours and a sixteenth of the corners, so that
  // the outline is no staircase.
  PlaneGrid share{.nu = static_cast<int>(map.count[layer.u]) + 2,
                  .nv = static_cast<int>(map.count[layer.v]) + 2};
  const auto middle = [&](int axis, double i) {
    return map.spacing * (static_cast<double>(map.first[axis]) + i + 0.5);
  };
  share.u = {middle(layer.u, -1.0), middle(layer.u, static_cast<double>(map.count[layer.u]))};
  share.v = {middle(layer.v, -1.0), middle(layer.v, static_cast<double>(map.count[layer.v]))};
  for (int iv = -1; iv < share.nv - 1; ++iv) {
    for (int iu = -1; iu < share.nu - 1; ++iu) {
      double sum = 0.0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          sum += inside(iu + du, iv + dv) / ((1 + std::abs(du)) * (1 + std::abs(dv)) * 4.0);
        }
      }
      share.values.push_back(sum);
    }
  }
  slice.outlines = contours(share, 0.5);
  slice.area = area_within(slice.outlines);
  return slice;
}

// Fills points that no posture was drawn for from their neighbours.
void fill_gaps(PlaneGrid& grid, const std::vector<char>& wanted) {
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<double> before = grid.values;
    for (int iv = 0; iv < grid.nv; ++iv) {
      for (int iu = 0; iu < grid.nu; ++iu) {
        const std::size_t here = static_cast<std::size_t>(iv) * grid.nu + iu;
        if (wanted[here] == 0 || !std::isnan(before[here])) continue;
        double sum = 0.0;
        int count = 0;
        for (int dv = -1; dv <= 1; ++dv) {
          for (int du = -1; du <= 1; ++du) {
            const int ju = iu + du, jv = iv + dv;
            if (ju < 0 || jv < 0 || ju >= grid.nu || jv >= grid.nv) continue;
            const double value = before[static_cast<std::size_t>(jv) * grid.nu + ju];
            if (std::isnan(value)) continue;
            sum += value;
            ++count;
          }
        }
        if (count == 0) continue;
        grid.values[here] = sum / count;
        changed = true;
      }
    }
  }
}

// The same where every point can be decided exactly: on a finer lattice, its outlines found by bisection.
Slice exact_cut(const PointReach& reach, const ReachMap& map, const Layer& layer, double at) {
  constexpr std::int64_t kPoints = 200;  // along the longer side
  Slice slice{.axis = layer.axis, .at = at, .u = layer.u, .v = layer.v};
  const std::int64_t longest = std::max(map.count[layer.u], map.count[layer.v]);
  const auto fine = static_cast<int>(std::max<std::int64_t>(1, (kPoints + longest - 1) / longest));
  const double h = map.spacing / fine;
  const auto start = [&](int axis) { return map.spacing * static_cast<double>(map.first[axis] - 1) + 0.5 * h; };
  const int nu = static_cast<int>(map.count[layer.u] + 2) * fine,
            nv = static_cast<int>(map.count[layer.v] + 2) * fine;
  const auto place = [&](double iu, double iv) {
    Vector3 point;
    point[layer.axis] = at;
    point[layer.u] = start(layer.u) + h * iu;
    point[layer.v] = start(layer.v) + h * iv;
    return point;
  };
  std::vector<char> inside(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv));
  for (int iv = 1; iv + 1 < nv; ++iv) {
    for (int iu = 1; iu + 1 < nu; ++iu)
      inside[static_cast<std::size_t>(iv) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(iu)] =
          reach.contains(place(iu, iv)) ? 1 : 0;
  }
  const auto is_inside = [&](int iu, int iv) {
    return inside[static_cast<std::size_t>(iv) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(iu)] !=
           0;
  };
  const auto crossing = [&](const internal::GridLine& line) -> std::array<double, 2> {
    const Vector3 low = place(line.iu, line.iv),
                  high = place(line.iu + (line.up ? 0 : 1), line.iv + (line.up ? 1 : 0));
    const bool from_low = is_inside(line.iu, line.iv);
    Vector3 in = from_low ? low : high, out = from_low ? high : low;
    for (int halving = 0; halving < 20; ++halving) {
      const Vector3 middle = 0.5 * (in + out);
      (reach.contains(middle) ? in : out) = middle;
    }
    return {in[layer.u], in[layer.v]};
  };
  slice.outlines = internal::trace_outlines(
      nu, nv, is_inside, [&](int iu, int iv) { return reach.contains(place(iu + 0.5, iv + 0.5)); }, crossing);
  slice.area = internal::enclosed_area(slice.outlines);
  return slice;
}

}  // namespace

InscribedShapes inscribed_shapes(const ReachMap& map) {
  return {.sphere = largest_ball(map), .cube = largest_cube(map)};
}

std::array<ReachSlice, 3> slice_reach(const Mechanism& mechanism, const ReachMap& map, const Vector3& through,
                                      std::int64_t samples, const Effort& effort) {
  std::array<ReachSlice, 3> slices;
  std::array<Layer, 3> layers;
  std::array<std::vector<char>, 3> wanted;
  const Grid grid{map.count};
  const std::optional<PointReach> exact = PointReach::of(mechanism);
  for (int axis = 0; axis < 3; ++axis) {
    Layer& layer = layers[axis];
    layer = {.axis = axis, .u = axis == 0 ? 1 : 0, .v = axis == 2 ? 1 : 2};
    layer.index =
        std::clamp(static_cast<std::int64_t>(std::floor(through[axis] / map.spacing)) - map.first[axis],
                   std::int64_t{0}, std::max<std::int64_t>(0, map.count[axis] - 1));
    slices[axis].slice = exact ? exact_cut(*exact, map, layer, through[axis]) : cut(map, layer, through[axis]);
    PlaneGrid& plane = slices[axis].conditioning;
    plane.nu = static_cast<int>(map.count[layer.u]);
    plane.nv = static_cast<int>(map.count[layer.v]);
    const Vector3 low = middle_of(map, 0, 0, 0);
    plane.u = {low[layer.u], low[layer.u] + map.spacing * (plane.nu - 1)};
    plane.v = {low[layer.v], low[layer.v] + map.spacing * (plane.nv - 1)};
    plane.values.assign(static_cast<std::size_t>(plane.nu) * plane.nv, kNone);
    for (int iv = 0; iv < plane.nv; ++iv) {
      for (int iu = 0; iu < plane.nu; ++iu) {
        const auto cell = layer.cell(iu, iv);
        wanted[axis].push_back(static_cast<char>(map.inside[grid.index(cell[0], cell[1], cell[2])]));
      }
    }
  }

  // A posture counts for a cut if it lies within one cube of it.
  struct Hit {
    int axis;
    std::size_t point;
    double conditioning;
  };
  constexpr std::int64_t kBlock = 4096;
  const JacobianScale scale = jacobian_scale(mechanism);
  std::vector<std::vector<Hit>> hits(static_cast<std::size_t>((samples + kBlock - 1) / kBlock));
  internal::for_each_index(hits.size(), effort, [&](std::size_t b) {
    const std::int64_t first = static_cast<std::int64_t>(b) * kBlock;
    for (std::int64_t s = first; s < std::min(first + kBlock, samples); ++s) {
      const Solution solution = solve_forward(mechanism, spread_posture(mechanism, s));
      if (!solution) continue;
      const Vector3& p = solution.posture->tool().position;
      double conditioning = -1.0;
      for (const Layer& layer : layers) {
        if (std::abs(p[layer.axis] - through[layer.axis]) > map.spacing) continue;
        const auto index = [&](int axis) {
          return static_cast<std::int64_t>(std::floor(p[axis] / map.spacing)) - map.first[axis];
        };
        const std::int64_t iu = index(layer.u), iv = index(layer.v);
        if (iu < 0 || iv < 0 || iu >= map.count[layer.u] || iv >= map.count[layer.v]) continue;
        if (conditioning < 0.0) {
          const Jacobian linear = jacobian(*solution.posture).topRows(mechanism.linear_rows());
          conditioning = 1.0 / scale.rows_condition_number(linear);
        }
        hits[b].push_back({layer.axis, static_cast<std::size_t>(iv * map.count[layer.u] + iu), conditioning});
      }
    }
  });
  for (const std::vector<Hit>& block : hits) {
    for (const Hit& hit : block) {
      if (wanted[hit.axis][hit.point] == 0) continue;
      double& best = slices[hit.axis].conditioning.values[hit.point];
      if (std::isnan(best) || hit.conditioning > best) best = hit.conditioning;
    }
  }
  for (int axis = 0; axis < 3; ++axis) fill_gaps(slices[axis].conditioning, wanted[axis]);
  return slices;
}

}  // namespace zwidth
