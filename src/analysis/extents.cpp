#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_delta.h"

namespace zwidth {
namespace {

using internal::Probe;

// ------------------------------------------------------------------------------------------------ extents

// Climbs p_axis (times sign) over the joint ranges from q: Newton steps on the joints that are not held by an
// end of their range, with the Hessian by differences of J, and halving until a step gains.
Probe::Answer climb(Probe& probe, const Probe::Answer& start, int axis, double sign) {
  constexpr double kDifference =
      1e-5;  // [share of a joint's range]: balances truncation and rounding for Newton
  Probe::Answer best = start;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Vector3 gradient = sign * best.jacobian.row(axis).transpose();
    std::array<int, 3> free;
    int count = 0;
    for (int j = 0; j < probe.dimension(); ++j) {
      const Interval range = probe.range(j);
      const bool held = (best.joints[j] <= range.min && gradient[j] < 0.0) ||
                        (best.joints[j] >= range.max && gradient[j] > 0.0);
      if (!held) free[count++] = j;
    }
    if (count == 0) break;

    Eigen::MatrixXd H(count, count);
    Eigen::VectorXd g(count);
    for (int a = 0; a < count; ++a) {
      g[a] = gradient[free[a]];
      const double step = kDifference * probe.range(free[a]).width();
      Vector3 above = best.joints, below = best.joints;
      above[free[a]] += step;
      below[free[a]] -= step;
      const Probe::Answer up = probe.forward(above), down = probe.forward(below);
      for (int b = 0; b < count; ++b) {
        H(b, a) = sign * (up.jacobian(axis, free[b]) - down.jacobian(axis, free[b])) / (2.0 * step);
      }
    }
    H = (0.5 * (H + H.transpose())).eval();
    Eigen::VectorXd direction;
    const Eigen::LLT<Eigen::MatrixXd> curvature(-H);
    if (H.allFinite() && curvature.info() == Eigen::Success) {
      direction = curvature.solve(g);
    } else {
      direction = g.normalized() * probe.range(free[0]).width() * 0.1;
    }

    bool gained = false;
    double share = 1.0;
    for (int halving = 0; halving < 50 && !gained; ++halving, share *= 0.5) {
      Vector3 joints = best.joints;
      for (int a = 0; a < count; ++a) {
        const Interval range = probe.range(free[a]);
        joints[free[a]] = std::clamp(joints[free[a]] + share * direction[a], range.min, range.max);
      }
      if (joints == best.joints) break;
      const Probe::Answer answer = probe.forward(joints);
      if (answer.inside && sign * answer.position[axis] > sign * best.position[axis]) {
        best = answer;
        gained = true;
      }
    }
    if (!gained) break;
  }
  return best;
}

// ------------------------------------------------------------------------------------------------- volume

// Nodes and weights of Gauss-Legendre quadrature on -1..1, by Newton on the Legendre polynomial.
struct Quadrature {
  std::vector<double> node, weight;
};

Quadrature gauss_legendre(int order) {
  Quadrature rule;
  for (int m = 0; m < order; ++m) {
    double x = std::cos(std::numbers::pi * (m + 0.75) / (order + 0.5)), slope = 0.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p0 = 1.0, p1 = x;
      for (int n = 2; n <= order; ++n) {
        const double p2 = ((2.0 * n - 1.0) * x * p1 - (n - 1.0) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      slope = order * (x * p1 - p0) / (x * x - 1.0);
      const double step = p1 / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

// Integral of |det J| over the joint ranges; NaN if some joints do not close or det J changes sign.
double integral(const Mechanism& mechanism, int order, const Effort& effort) {
  const Quadrature rule = gauss_legendre(order);
  const auto n = static_cast<std::size_t>(order);
  const int dimension = internal::tool_dimension(mechanism);
  const std::size_t deep = dimension == 2 ? 1 : n;  // points along the third joint
  std::array<std::vector<double>, 3> angle;
  angle[2] = {0.0};
  double scale = 1.0;
  for (int j = 0; j < dimension; ++j) {
    if (j == 2) angle[2].clear();
    const Interval range = mechanism.active_range(j);
    for (const double node : rule.node) angle[j].push_back(range.middle() + 0.5 * range.width() * node);
    scale *= 0.5 * range.width();
  }
  std::vector<double> layers(n);
  const Probe fresh(mechanism);
  std::optional<DeltaBatch> batch;
  if (mechanism.delta()) batch.emplace(*mechanism.delta(), mechanism.active_range(0));
  internal::for_each_index(n, {.threads = effort.threads}, [&](std::size_t a) {
    double sum = 0.0, sign = 0.0;
    const auto take = [&](double weight, double det) {
      if (sign == 0.0) sign = det;
      sum = sign * det > 0.0 ? sum + weight * std::abs(det) : std::numeric_limits<double>::quiet_NaN();
    };
    if (batch) {
      const std::size_t count = n * n;
      std::vector<double> cosine(3 * count), sine(3 * count), x(count), y(count), z(count), det(count);
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t c = 0; c < n; ++c) {
          const double joints[3] = {angle[0][a], angle[1][b], angle[2][c]};
          for (std::size_t leg = 0; leg < 3; ++leg) {
            cosine[leg * count + b * n + c] = std::cos(joints[leg]);
            sine[leg * count + b * n + c] = std::sin(joints[leg]);
          }
        }
      }
      batch->forward(cosine, sine, x, y, z, det);
      for (std::size_t p = 0; p < count; ++p) take(rule.weight[p / n] * rule.weight[p % n], det[p]);
    } else {
      Probe probe = fresh;
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t c = 0; c < deep; ++c) {
          const Probe::Answer answer = probe.forward({angle[0][a], angle[1][b], angle[2][c]});
          take(rule.weight[b] * (dimension == 2 ? 1.0 : rule.weight[c]),
               answer.reached ? answer.jacobian.determinant() : std::numeric_limits<double>::quiet_NaN());
        }
      }
    }
    layers[a] = std::copysign(sum, sign) * rule.weight[a];
  });
  double sum = 0.0;
  for (const double layer : layers) {
    if (!(layer * layers[0] > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    sum += layer;
  }
  return std::abs(sum) * scale;
}

// Whether the joint ranges, ends included, map one to one onto the workspace, as far as a grid of points shows.
bool maps_one_to_one(const Mechanism& mechanism) {
  Probe probe(mechanism);
  const int points = probe.dimension() == 2 ? 25 : 9;
  const int count = points * points * (probe.dimension() == 2 ? 1 : points);
  for (int index = 0; index < count; ++index) {
    if (!probe.forward(probe.grid_joints(index, points)).inside) return false;
  }
  return true;
}

}  // namespace

Extents workspace_extents(const Mechanism& mechanism) {
  assert(!workspace_obstacle(mechanism));
  // A coarse grid of joint values, ends included, finds the hills; the best few are climbed.
  constexpr int kStarts = 4;
  Probe probe(mechanism);
  const int points = probe.dimension() == 2 ? 49 : probe.fast() ? 13 : 7;
  const int count = points * points * (probe.dimension() == 2 ? 1 : points);
  std::vector<Probe::Answer> grid;
  for (int index = 0; index < count; ++index) {
    const Probe::Answer answer = probe.forward(probe.grid_joints(index, points));
    if (answer.inside) grid.push_back(answer);
  }
  Extents extents;
  if (grid.empty()) return extents;
  for (int axis = 0; axis < probe.dimension(); ++axis) {
    for (int end = 0; end < 2; ++end) {
      const double sign = end == 0 ? -1.0 : 1.0;
      const auto starts = std::min<std::ptrdiff_t>(kStarts, std::ssize(grid));
      std::partial_sort(grid.begin(), grid.begin() + starts, grid.end(),
                        [&](const Probe::Answer& a, const Probe::Answer& b) {
                          return sign * a.position[axis] > sign * b.position[axis];
                        });
      Probe::Answer best = grid[0];
      for (std::ptrdiff_t s = 0; s < starts; ++s) {
        const Probe::Answer top = climb(probe, grid[static_cast<std::size_t>(s)], axis, sign);
        if (sign * top.position[axis] > sign * best.position[axis]) best = top;
      }
      (end == 0 ? extents.range[axis].min : extents.range[axis].max) = best.position[axis];
      extents.at[axis][end] = best.position;
      extents.joints[axis][end] = best.joints;
    }
  }
  return extents;
}

const char* to_string(WorkspaceVolume::Method method) {
  switch (method) {
    case WorkspaceVolume::Method::integral:
      return "integral";
    case WorkspaceVolume::Method::lattice:
      return "lattice";
    case WorkspaceVolume::Method::outline:
      break;
  }
  return "outline";
}

WorkspaceVolume workspace_volume(const Mechanism& mechanism, const Effort& effort) {
  assert(!workspace_obstacle(mechanism));
  constexpr double kTolerance = 1e-11;  // relative, between one order and the next
  constexpr double kUseless = 1e-4;     // the integrand is not smooth: counting does as well
  WorkspaceVolume volume;
  const bool fast = Probe(mechanism).fast();
  if (maps_one_to_one(mechanism)) {
    double before = std::numeric_limits<double>::quiet_NaN();
    for (const int order : {8, 12, 16, 24, 32, 40, 48, 64}) {
      const double value = integral(mechanism, order, effort);
      const double change = std::abs(value - before);
      volume = {.value = value, .error_estimate = change, .order = order};
      if (std::isnan(value) || change <= kTolerance * value) break;
      if (!fast && change <= 1e-9 * value) break;  // each value costs a solution of the loops
      before = value;
    }
    if (volume.error_estimate <= kUseless * volume.value) return volume;
  }
  const Extents extents = workspace_extents(mechanism);
  const double size = extents.size().maxCoeff();
  if (internal::tool_dimension(mechanism) == 2) {
    volume = {.method = WorkspaceVolume::Method::outline};
    if (!(size > 0.0)) return volume;
    // The error of a polygon with its corners on the boundary falls with the square of their distance.
    constexpr int kPoints = 401;
    volume.spacing = size / (kPoints - 1);
    volume.value = map_slice(mechanism, extents, 2, 0.0, kPoints, {}).slice.area;
    const double coarse = map_slice(mechanism, extents, 2, 0.0, (kPoints + 1) / 2, {}).slice.area;
    volume.error_estimate = std::abs(volume.value - coarse);
    return volume;
  }
  const double h = size / (fast ? 250.0 : 40.0);
  volume = {.method = WorkspaceVolume::Method::lattice};
  if (!(h > 0.0)) return volume;
  const auto count = [&](double spacing) {
    return sweep_workspace(mechanism, {.spacing = spacing},
                           {.threads = effort.threads, .cancel = effort.cancel})
        .volume;
  };
  volume.spacing = h;
  volume.value = count(h);
  volume.error_estimate = std::abs(volume.value - count(1.3 * h));
  return volume;
}

WorkspaceVolume finer_count(WorkspaceVolume volume, const LatticeSweep& sweep) {
  const bool counted = volume.method == WorkspaceVolume::Method::lattice;
  if (!counted || !sweep.complete || !(sweep.spacing < volume.spacing)) return volume;
  volume.error_estimate *= sweep.spacing / volume.spacing;
  volume.value = sweep.volume;
  volume.spacing = sweep.spacing;
  return volume;
}

double counting_error(const WorkspaceVolume& volume, const LatticeSweep& sweep) {
  if (volume.method == WorkspaceVolume::Method::lattice) return volume.error_estimate;
  return volume.error_estimate + std::abs(sweep.volume + sweep.area - volume.value);
}

}  // namespace zwidth
