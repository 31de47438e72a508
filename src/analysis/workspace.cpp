#include "zwidth/analysis/workspace.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "zwidth/analysis/internal/climb.h"
#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/probe.h"

namespace zwidth {
namespace {

using internal::Probe;
using internal::StatisticBuilder;
using IndexRange = DeltaBatch::IndexRange;
using LatticeBox = std::array<IndexRange, 3>;

constexpr double kMaxLatticePoints = 1e12;

Vector3 lattice_point(std::int64_t i, std::int64_t j, std::int64_t k, double spacing) {
  return {static_cast<double>(i) * spacing, static_cast<double>(j) * spacing, static_cast<double>(k) * spacing};
}

// What one plane of the lattice x = i h comes to.
struct Plane {
  std::int64_t inside = 0;
  std::array<StatisticBuilder, kFigureCount> figures;
  IndexRange j{0, -1}, k{0, -1};
};

void stretch(IndexRange& range, const IndexRange& other) {
  if (internal::size(other) == 0) return;
  if (internal::size(range) == 0) {
    range = other;
  } else {
    range = {std::min(range.first, other.first), std::max(range.last, other.last)};
  }
}

Plane sweep_plane_of_delta(const DeltaBatch& batch, std::int64_t i, const LatticeBox& box, double h, bool all) {
  const DeltaBatch::PlaneSummary summary = batch.sweep_plane(i, box[1], box[2], h, all);
  Plane plane;
  plane.inside = summary.inside;
  if (summary.inside == 0) return plane;
  plane.j = {summary.j_first, summary.j_last};
  plane.k = {summary.k_first, summary.k_last};
  const int count = all ? kFigureCount : kCoreFigureCount;
  for (int f = 0; f < count; ++f) {
    // Along z the place is found at the end, for the planes that have an extreme of the whole (see
    // find_heights).
    plane.figures[f].add(summary.inside, summary.sum[f], summary.min[f].value,
                         lattice_point(i, summary.min[f].j, 0, h), summary.max[f].value,
                         lattice_point(i, summary.max[f].j, 0, h));
  }
  return plane;
}

// The sweep keeps the column of every extreme; this finds the point in it.
void find_heights(const DeltaBatch& batch, const IndexRange& k, double h, LatticeSweep& sweep) {
  const auto n = static_cast<std::size_t>(internal::size(k));
  std::vector<double> x(n), y(n), z(n), values(n * kFigureCount);
  for (std::size_t p = 0; p < n; ++p) z[p] = static_cast<double>(k.first + static_cast<std::int64_t>(p)) * h;
  for (int f = 0; f < kFigureCount; ++f) {
    Statistic& statistic = sweep.figures[f];
    if (statistic.count == 0) continue;
    for (const bool largest : {false, true}) {
      Vector3& at = largest ? statistic.max_at : statistic.min_at;
      std::fill(x.begin(), x.end(), at.x());
      std::fill(y.begin(), y.end(), at.y());
      batch.figures(x, y, z, values);
      double best = NAN;
      for (std::size_t p = 0; p < n; ++p) {
        const double value = values[static_cast<std::size_t>(f) * n + p];
        if (std::isnan(value) || (largest ? value <= best : value >= best)) continue;
        best = value;
        at.z() = z[p];
      }
    }
  }
}

Plane sweep_plane_of_legs(Probe probe, std::int64_t i, const LatticeBox& box, const LatticeOptions& options) {
  Plane plane;
  const std::array<bool, kFigureCount> defined =
      internal::defined_figures(probe.mechanism(), options.all_figures);
  for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
    if (probe.dimension() == 3) probe.restart();
    for (std::int64_t k = box[2].first; k <= box[2].last; ++k) {
      const Vector3 point = lattice_point(i, j, k, options.spacing);
      const Probe::Answer answer = probe.inverse(point);
      if (!answer.inside) continue;
      ++plane.inside;
      stretch(plane.j, {j, j});
      stretch(plane.k, {k, k});
      const FigureValues values = probe.figures(answer, options.limits);
      for (int f = 0; f < kFigureCount; ++f) {
        if (defined[f]) plane.figures[f].add(values[f], point);
      }
    }
  }
  return plane;
}

}  // namespace

namespace internal {

std::array<IndexRange, 3> lattice_box(const Mechanism& mechanism, double spacing) {
  std::array<Interval, 3> box;
  if (const auto& geometry = mechanism.delta()) {
    box = DeltaBatch(*geometry, mechanism.active_range(0)).reach_box();
  } else {
    box = workspace_extents(mechanism).range;
    for (Interval& side : box) {
      const double margin = 1e-6 * mechanism.characteristic_length();
      side = {side.min - margin, side.max + margin};
    }
  }
  std::array<IndexRange, 3> indices;
  double points = 1.0;
  if (tool_dimension(mechanism) == 2) indices[2] = {0, 0};
  for (int axis = 0; axis < tool_dimension(mechanism); ++axis) {
    const double first = std::ceil(box[axis].min / spacing), last = std::floor(box[axis].max / spacing);
    points *= std::max(last - first + 1.0, 1.0);
    if (points > kMaxLatticePoints) throw std::length_error("the lattice has more than 10^12 points");
    indices[axis] = {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last)};
  }
  return indices;
}

}  // namespace internal

LatticeSweep sweep_workspace(const Mechanism& mechanism, const LatticeOptions& options, const Effort& effort) {
  assert(!workspace_obstacle(mechanism) && options.spacing > 0.0);
  const double h = options.spacing;
  const LatticeBox box = internal::lattice_box(mechanism, h);
  std::optional<DeltaBatch> batch;
  if (mechanism.delta()) batch.emplace(*mechanism.delta(), mechanism.active_range(0), options.limits);

  const Probe fresh(mechanism);

  // One plane is one piece of work; pieces are added up in order, so the result does not depend on threads.
  std::vector<Plane> planes(static_cast<std::size_t>(internal::size(box[0])));
  LatticeSweep sweep;
  sweep.spacing = h;
  sweep.complete = internal::for_each_index(planes.size(), effort, [&](std::size_t index) {
    const std::int64_t i = box[0].first + static_cast<std::int64_t>(index);
    planes[index] = batch ? sweep_plane_of_delta(*batch, i, box, h, options.all_figures)
                          : sweep_plane_of_legs(fresh, i, box, options);
  });

  std::array<IndexRange, 3> bounds;
  std::array<StatisticBuilder, kFigureCount> figures;
  for (std::size_t index = 0; index < planes.size(); ++index) {
    const Plane& plane = planes[index];
    if (plane.inside == 0) continue;
    sweep.inside += plane.inside;
    const std::int64_t i = box[0].first + static_cast<std::int64_t>(index);
    stretch(bounds[0], {i, i});
    stretch(bounds[1], plane.j);
    stretch(bounds[2], plane.k);
    for (int f = 0; f < kFigureCount; ++f) figures[f].add(plane.figures[f]);
  }
  const bool in_plane = internal::tool_dimension(mechanism) == 2;
  (in_plane ? sweep.area : sweep.volume) = static_cast<double>(sweep.inside) * h * h * (in_plane ? 1.0 : h);
  if (sweep.inside == 0) return sweep;
  sweep.lattice_points = 1;
  for (int axis = 0; axis < 3; ++axis) {
    sweep.lattice_points *= internal::size(bounds[axis]);
    sweep.bounds[axis] = {static_cast<double>(bounds[axis].first) * h,
                          static_cast<double>(bounds[axis].last) * h};
  }
  for (int f = 0; f < kFigureCount; ++f) sweep.figures[f] = figures[f].result();
  if (batch) find_heights(*batch, bounds[2], h, sweep);
  return sweep;
}

double fitting_spacing(const Extents& extents, double least, double most_points) {
  const auto points = [&](double h) {
    const Vector3 size = extents.size();
    return (size.x() / h + 1.0) * (size.y() / h + 1.0) * (size.z() / h + 1.0);
  };
  double spacing = least;
  while (points(spacing) > most_points) {
    const double power = std::pow(10.0, std::floor(std::log10(spacing) + 1e-9));
    const double digit = spacing / power;
    spacing = power * (digit < 1.999 ? 2.0 : digit < 4.999 ? 5.0 : 10.0);
  }
  return spacing;
}

double suitable_spacing(const Mechanism& mechanism, const Extents& extents) {
  const bool plane = internal::tool_dimension(mechanism) == 2, fast = Probe(mechanism).fast();
  const double points = mechanism.delta() ? 3e7 : plane ? (fast ? 2e5 : 2e4) : fast ? 3e6 : 1.2e5;
  const double size = extents.size().maxCoeff();
  if (!(size > 0.0)) return 1e-3;
  return fitting_spacing(extents, std::pow(10.0, std::floor(std::log10(size)) - 5.0), points);
}

void refine_extremes(const Mechanism& mechanism, const LatticeOptions& options, LatticeSweep& sweep,
                     const Effort& effort) {
  assert(!workspace_obstacle(mechanism));
  const Probe fresh(mechanism);
  internal::for_each_index(kFigureCount, effort, [&](std::size_t f) {
    Statistic& statistic = sweep.figures[f];
    if (statistic.count == 0) return;
    Probe probe = fresh;
    const auto joints_at = [&probe](const Vector3& place) {
      probe.restart();
      return ActiveVector(probe.inverse(place).joints.head(probe.dimension()));
    };
    const auto answer_at = [&probe](const ActiveVector& joints) {
      Vector3 all = Vector3::Zero();
      all.head(joints.size()) = joints;
      return probe.forward(all);
    };
    const auto figure = [&](const ActiveVector& joints) {
      const Probe::Answer answer = answer_at(joints);
      return answer.inside ? probe.figures(answer, options.limits)[f]
                           : std::numeric_limits<double>::quiet_NaN();
    };
    const ActiveVector least = joints_at(statistic.min_at), largest = joints_at(statistic.max_at);
    internal::refine(statistic, mechanism, least, largest, figure,
                     [&](const ActiveVector& joints) { return answer_at(joints).position; });
  });
}

WorkspaceMap map_workspace(const Mechanism& mechanism, const LatticeOptions& options, const Effort& effort) {
  assert(!workspace_obstacle(mechanism) && options.spacing > 0.0);
  const double h = options.spacing;
  const LatticeBox box = internal::lattice_box(mechanism, h);
  std::optional<DeltaBatch> batch;
  if (mechanism.delta()) batch.emplace(*mechanism.delta(), mechanism.active_range(0), options.limits);

  const Probe fresh(mechanism);
  std::vector<WorkspaceMap> planes(static_cast<std::size_t>(internal::size(box[0])));
  WorkspaceMap map;
  map.spacing = h;
  map.dimension = internal::tool_dimension(mechanism);
  const std::array<bool, kFigureCount> defined = internal::defined_figures(mechanism, options.all_figures);
  for (int f = 0; f < kFigureCount; ++f) {
    if (defined[f]) map.defined.push_back(static_cast<Figure>(f));
  }
  map.complete = internal::for_each_index(planes.size(), effort, [&](std::size_t index) {
    const std::int64_t i = box[0].first + static_cast<std::int64_t>(index);
    WorkspaceMap& plane = planes[index];
    if (!batch) {
      Probe probe = fresh;
      for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
        if (probe.dimension() == 3) probe.restart();
        for (std::int64_t k = box[2].first; k <= box[2].last; ++k) {
          const Vector3 point = lattice_point(i, j, k, h);
          const Probe::Answer answer = probe.inverse(point);
          if (!answer.inside) continue;
          plane.positions.push_back(point);
          plane.figures.push_back(probe.figures(answer, options.limits));
        }
      }
      return;
    }
    const auto n = static_cast<std::size_t>(internal::size(box[2]));
    std::vector<double> x(n, static_cast<double>(i) * h), y(n), z(n), values(n * kFigureCount);
    for (std::size_t p = 0; p < n; ++p)
      z[p] = static_cast<double>(box[2].first + static_cast<std::int64_t>(p)) * h;
    for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
      std::fill(y.begin(), y.end(), static_cast<double>(j) * h);
      batch->figures(x, y, z, values);
      for (std::size_t p = 0; p < n; ++p) {
        if (std::isnan(values[p])) continue;
        plane.positions.emplace_back(x[p], y[p], z[p]);
        FigureValues& row = plane.figures.emplace_back();
        for (std::size_t f = 0; f < kFigureCount; ++f) row[f] = values[f * n + p];
      }
    }
  });
  for (WorkspaceMap& plane : planes) {
    map.positions.insert(map.positions.end(), plane.positions.begin(), plane.positions.end());
    map.figures.insert(map.figures.end(), plane.figures.begin(), plane.figures.end());
    plane = {};
  }
  return map;
}

}  // namespace zwidth
