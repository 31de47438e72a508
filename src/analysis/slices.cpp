#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/internal/trace.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_delta.h"

namespace zwidth {
namespace {

using internal::Probe;

// Outlines of a region on the grid of a slice; `inside` is `within` at the grid points. Where one crosses a
// grid line is found by bisection.
template <class Within>
std::vector<Outline> outlines_of(const SliceMap& grid, const std::vector<char>& inside, const Within& within) {
  const auto point = [&](double iu, double iv) {
    Vector3 p;
    p[grid.slice.axis] = grid.slice.at;
    p[grid.slice.u] = grid.u_range.min + grid.u_range.width() * iu / (grid.nu - 1);
    p[grid.slice.v] = grid.v_range.min + grid.v_range.width() * iv / (grid.nv - 1);
    return p;
  };
  const auto at = [&](int iu, int iv) { return inside[iv * grid.nu + iu] != 0; };
  const auto joined = [&](int iu, int iv) { return within(point(iu + 0.5, iv + 0.5)); };
  const auto crossing = [&](const internal::GridLine& line) -> std::array<double, 2> {
    Vector3 in = point(line.iu, line.iv), out = point(line.iu + (line.up ? 0 : 1), line.iv + (line.up ? 1 : 0));
    if (!at(line.iu, line.iv)) std::swap(in, out);
    while ((out - in).norm() > 1e-7) {
      const Vector3 middle = 0.5 * (in + out);
      (within(middle) ? in : out) = middle;
    }
    return {in[grid.slice.u], in[grid.slice.v]};
  };
  return internal::trace_outlines(grid.nu, grid.nv, at, joined, crossing);
}

}  // namespace

SliceMap map_slice(const Mechanism& mechanism, const Extents& extents, int axis, double at, int points,
                   const DriveLimits& limits) {
  assert(!workspace_obstacle(mechanism) && points > 1 && axis >= 0 && axis < 3);
  SliceMap map;
  map.slice.axis = axis;
  map.slice.at = at;
  map.slice.u = axis == 0 ? 1 : 0;
  map.slice.v = axis == 2 ? 1 : 2;
  const Interval u = extents.range[map.slice.u], v = extents.range[map.slice.v];
  const double h = std::max(u.width(), v.width()) / (points - 1);
  if (!(h > 0.0)) return map;
  // One grid point more on each side, so that every outline closes.
  const auto grid = [h](const Interval& side, int& count, Interval& range) {
    count = static_cast<int>(std::ceil(side.width() / h - 1e-9)) + 3;
    const double half = 0.5 * (count - 1) * h;
    range = {side.middle() - half, side.middle() + half};
  };
  grid(u, map.nu, map.u_range);
  grid(v, map.nv, map.v_range);

  const auto n = static_cast<std::size_t>(map.nu) * static_cast<std::size_t>(map.nv);
  std::vector<char> inside(n);
  std::array<std::vector<double>, 3> coordinates;
  coordinates[axis].assign(n, at);
  for (int iv = 0; iv < map.nv; ++iv) {
    for (int iu = 0; iu < map.nu; ++iu) {
      coordinates[map.slice.u].push_back(map.u_range.min + h * iu);
      coordinates[map.slice.v].push_back(map.v_range.min + h * iv);
    }
  }
  Probe probe(mechanism);
  const std::array<bool, kFigureCount> defined = internal::defined_figures(mechanism, true);
  if (mechanism.delta()) {
    std::vector<double> values(n * kFigureCount);
    DeltaBatch(*mechanism.delta(), mechanism.active_range(0), limits)
        .figures(coordinates[0], coordinates[1], coordinates[2], values);
    for (std::size_t f = 0; f < kFigureCount; ++f) {
      map.values[f].assign(values.begin() + static_cast<std::ptrdiff_t>(f * n),
                           values.begin() + static_cast<std::ptrdiff_t>((f + 1) * n));
    }
    for (std::size_t p = 0; p < n; ++p) inside[p] = !std::isnan(values[p]);
  } else {
    for (std::vector<double>& values : map.values) values.assign(n, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t p = 0; p < n; ++p) {
      if (p % static_cast<std::size_t>(map.nu) == 0) probe.restart();
      const Probe::Answer answer = probe.inverse({coordinates[0][p], coordinates[1][p], coordinates[2][p]});
      inside[p] = answer.inside;
      if (!answer.inside) continue;
      const FigureValues values = probe.figures(answer, limits);
      for (int f = 0; f < kFigureCount; ++f) {
        if (defined[f]) map.values[f][p] = values[f];
      }
    }
  }
  map.slice.outlines = outlines_of(map, inside, [&probe](const Vector3& p) { return probe.inverse(p).inside; });
  map.slice.area = internal::enclosed_area(map.slice.outlines);
  return map;
}

Slice condition_region(const Mechanism& mechanism, const SliceMap& map, double limit) {
  assert(!workspace_obstacle(mechanism) && limit > 1.0);
  Slice region = map.slice;
  region.outlines.clear();
  region.area = 0.0;
  if (map.nu == 0) return region;
  const std::vector<double>& condition = map.values[static_cast<std::size_t>(Figure::condition_number)];
  std::vector<char> inside(condition.size());
  for (std::size_t p = 0; p < condition.size(); ++p) inside[p] = condition[p] < limit;
  Probe probe(mechanism);
  region.outlines =
      outlines_of(map, inside, [&](const Vector3& p) { return internal::condition_number(probe, p) < limit; });
  region.area = internal::enclosed_area(region.outlines);
  return region;
}

SurfaceMesh workspace_surface(const Mechanism& mechanism, int n) {
  assert(!workspace_obstacle(mechanism) && n > 0 && internal::tool_dimension(mechanism) == 3);
  SurfaceMesh mesh;
  Probe probe(mechanism);
  const int side = n + 1;
  for (int face = 0; face < 6; ++face) {
    const int fixed = face / 2, a = (fixed + 1) % 3, b = (fixed + 2) % 3;
    const int first = static_cast<int>(mesh.vertices.size());
    std::vector<char> closes;
    for (int ia = 0; ia < side; ++ia) {
      for (int ib = 0; ib < side; ++ib) {
        Vector3 joints;
        joints[fixed] = face % 2 == 0 ? probe.range(fixed).min : probe.range(fixed).max;
        joints[a] = probe.range(a).min + probe.range(a).width() * ia / n;
        joints[b] = probe.range(b).min + probe.range(b).width() * ib / n;
        const Probe::Answer answer = probe.forward(joints);
        closes.push_back(answer.inside);
        mesh.vertices.push_back(answer.inside ? answer.position : Vector3::Zero());
      }
    }
    for (int ia = 0; ia < n; ++ia) {
      for (int ib = 0; ib < n; ++ib) {
        const int p = ia * side + ib;
        // Two triangles of each cell, turned outwards: det J > 0 keeps the joints' orientation.
        for (std::array<int, 3> corner :
             {std::array{p, p + side, p + side + 1}, std::array{p, p + side + 1, p + 1}}) {
          if (!std::ranges::all_of(corner, [&](int c) { return closes[static_cast<std::size_t>(c)] != 0; }))
            continue;
          if (face % 2 == 0) std::swap(corner[1], corner[2]);
          mesh.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
          mesh.face.push_back(face);
        }
      }
    }
  }
  return mesh;
}

}  // namespace zwidth
