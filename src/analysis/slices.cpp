#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_delta.h"

namespace zwidth {
namespace {

using internal::Probe;

// Outlines of the inside of a predicate on a grid of nu x nv points, by marching squares. Where an outline
// crosses a grid line is found by bisection.
class Tracer {
 public:
  Tracer(Probe& probe, const SliceMap& grid, const std::vector<char>& inside)
      : probe_(probe), grid_(grid), inside_(inside) {}

  std::vector<Outline> trace() {
    for (int iv = 0; iv + 1 < grid_.nv; ++iv) {
      for (int iu = 0; iu + 1 < grid_.nu; ++iu) cross_cell(iu, iv);
    }
    std::vector<Outline> outlines;
    while (!next_.empty()) {
      Outline outline;
      const int first = std::ranges::min_element(next_, {}, [](const auto& link) { return link.first; })->first;
      for (auto link = next_.find(first); link != next_.end(); link = next_.find(following_)) {
        outline.push_back(crossing(link->first));
        following_ = link->second;
        next_.erase(link);
      }
      if (outline.size() > 2) outlines.push_back(std::move(outline));
    }
    return outlines;
  }

 private:
  bool at(int iu, int iv) const { return inside_[iv * grid_.nu + iu] != 0; }
  // Grid lines from point (iu, iv) to its right (0) or upper (1) neighbour have numbers.
  int edge(int iu, int iv, int up) const { return 2 * (iv * grid_.nu + iu) + up; }

  // Links the edges by which outlines pass a cell, the inside on their left.
  void cross_cell(int iu, int iv) {
    const bool corner[4] = {at(iu, iv), at(iu + 1, iv), at(iu + 1, iv + 1), at(iu, iv + 1)};
    const int edges[4] = {edge(iu, iv, 0), edge(iu + 1, iv, 1), edge(iu, iv + 1, 0), edge(iu, iv, 1)};
    // Going round the cell counter-clockwise, runs of inside corners begin at `enter` and end at `leave`.
    int enter[2], leave[2], enters = 0, leaves = 0;
    for (int e = 0; e < 4; ++e) {
      const bool from = corner[e], to = corner[(e + 1) % 4];
      if (!from && to) enter[enters++] = edges[e];
      if (from && !to) leave[leaves++] = edges[e];
    }
    if (enters == 1) next_[leave[0]] = enter[0];
    if (enters == 2) {
      // Two opposite corners inside: joined across the middle or not. `enter` and `leave` alternate; a run that
      // begins at enter[0] ends at leave[0] unless the walk began inside.
      const bool joined = probe_.inverse(point(iu + 0.5, iv + 0.5)).inside;
      const int shift = corner[0] ? 1 : 0;
      next_[leave[shift]] = enter[joined ? 1 : 0];
      next_[leave[1 - shift]] = enter[joined ? 0 : 1];
    }
  }

  Vector3 point(double iu, double iv) const {
    Vector3 p;
    p[grid_.slice.axis] = grid_.slice.at;
    p[grid_.slice.u] = grid_.u_range.min + grid_.u_range.width() * iu / (grid_.nu - 1);
    p[grid_.slice.v] = grid_.v_range.min + grid_.v_range.width() * iv / (grid_.nv - 1);
    return p;
  }

  std::array<double, 2> crossing(int number) {
    const int start = number / 2, iu = start % grid_.nu, iv = start / grid_.nu, up = number % 2;
    Vector3 in = point(iu, iv), out = point(iu + (1 - up), iv + up);
    if (!at(iu, iv)) std::swap(in, out);
    while ((out - in).norm() > 1e-7) {
      const Vector3 middle = 0.5 * (in + out);
      (probe_.inverse(middle).inside ? in : out) = middle;
    }
    return {in[grid_.slice.u], in[grid_.slice.v]};
  }

  Probe& probe_;
  const SliceMap& grid_;
  const std::vector<char>& inside_;
  std::unordered_map<int, int> next_;  // the edge that follows an edge on its outline
  int following_ = 0;
};

double enclosed_area(const std::vector<Outline>& outlines) {
  double area = 0.0;  // outlines of holes run the other way round
  for (const Outline& outline : outlines) {
    for (std::size_t p = 0; p < outline.size(); ++p) {
      const auto& a = outline[p];
      const auto& b = outline[(p + 1) % outline.size()];
      area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
  }
  return area;
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
      const FigureValues values = jacobian_figures(answer.jacobian, limits);
      for (int f = 0; f < static_cast<int>(Figure::leg_singularity); ++f) map.values[f][p] = values[f];
    }
  }
  map.slice.outlines = Tracer(probe, map, inside).trace();
  map.slice.area = enclosed_area(map.slice.outlines);
  return map;
}

SurfaceMesh workspace_surface(const Mechanism& mechanism, int n) {
  assert(!workspace_obstacle(mechanism) && n > 0);
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
