#include "zwidth/math/linear_programme.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace zwidth {
namespace {

using Rows = LinearProgramme::Rows;
using Bounds = LinearProgramme::Bounds;
using Point = LinearProgramme::Point;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// What rounding leaves, beside numbers of size one: rows, objective and columns are scaled to that.
constexpr double kRounding = 1e-11;
constexpr int kMostSteps = 200;

enum class Side { none, lower, upper };

// Rows that hold the point, with an orthonormal basis of their span kept by Gram-Schmidt with repetition.
class WorkingSet {
 public:
  explicit WorkingSet(int variables) : variables_(variables) { basis_.resize(variables, 0); }

  int size() const { return static_cast<int>(basis_.cols()); }
  Side side(int row) const { return held_[static_cast<std::size_t>(row)]; }
  int row(int k) const { return order_[static_cast<std::size_t>(k)]; }

  // The share of a direction that moves along none of the rows held.
  Point free_part(const Point& direction) const {
    Point rest = direction;
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k < size(); ++k) rest -= basis_.col(k) * basis_.col(k).dot(rest);
    }
    return rest;
  }

  void add(int row, Side side, const Rows& rows) {
    held_[static_cast<std::size_t>(row)] = side;
    order_[static_cast<std::size_t>(size())] = row;
    const int k = size();
    const Point rest = free_part(rows.row(row).transpose());
    basis_.conservativeResize(Eigen::NoChange, k + 1);
    basis_.col(k) = rest.normalized();
  }

  void drop(int k, const Rows& rows) {
    held_[static_cast<std::size_t>(row(k))] = Side::none;
    const int before = size();
    std::array<int, LinearProgramme::kMaxVariables> left{};
    std::array<Side, LinearProgramme::kMaxVariables> sides{};
    int count = 0;
    for (int i = 0; i < before; ++i) {
      if (i == k) continue;
      left[static_cast<std::size_t>(count)] = row(i);
      sides[static_cast<std::size_t>(count++)] = side(row(i));
    }
    basis_.resize(variables_, 0);
    for (int i = 0; i < count; ++i)
      add(left[static_cast<std::size_t>(i)], sides[static_cast<std::size_t>(i)], rows);
  }

  // The numbers y with sum_k y_k a_(row k) = direction, for a direction in the span of the rows held.
  Point combination(const Point& direction, const Rows& rows) const {
    // Row k lies in the span of the first k + 1 basis vectors, so the last coordinate gives the last number.
    Point y(size());
    Point rest = direction;
    for (int k = size() - 1; k >= 0; --k) {
      y[k] = basis_.col(k).dot(rest) / basis_.col(k).dot(rows.row(row(k)));
      rest -= y[k] * rows.row(row(k)).transpose();
    }
    return y;
  }

 private:
  int variables_;
  std::array<Side, LinearProgramme::kMaxRows> held_{};
  std::array<int, LinearProgramme::kMaxVariables> order_{};
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, LinearProgramme::kMaxVariables,
                LinearProgramme::kMaxVariables>
      basis_;
};

// From a point that keeps every row. Rows, objective and columns are of size one or zero.
ProgrammeSolution climb(const LinearProgramme& p, const Point& start) {
  const int m = static_cast<int>(p.rows.rows()), n = static_cast<int>(p.rows.cols());
  ProgrammeSolution solution;
  solution.status = ProgrammeStatus::stalled;
  solution.point = start;
  solution.multipliers = Bounds::Zero(m);
  WorkingSet held(n);
  // Equal bounds hold for good, as far as their rows do not follow from each other.
  for (int i = 0; i < m; ++i) {
    if (p.lower[i] == p.upper[i] && held.size() < n &&
        held.free_part(p.rows.row(i).transpose()).norm() > kRounding) {
      held.add(i, Side::upper, p.rows);
    }
  }
  for (int step = 0; step < kMostSteps; ++step) {
    const Point d = held.size() == n ? Point(Point::Zero(n)) : held.free_part(p.objective);
    if (d.norm() <= kRounding) {
      const Point y = held.combination(p.objective, p.rows);
      // The row of the lowest index that would rather be left.
      int worst = -1;
      for (int k = 0; k < held.size(); ++k) {
        const int i = held.row(k);
        if (p.lower[i] == p.upper[i]) continue;
        const double gain = held.side(i) == Side::upper ? y[k] : -y[k];
        if (gain < -kRounding && (worst < 0 || i < held.row(worst))) worst = k;
      }
      if (worst < 0) {
        solution.status = ProgrammeStatus::optimal;
        for (int k = 0; k < held.size(); ++k) solution.multipliers[held.row(k)] = y[k];
        break;
      }
      held.drop(worst, p.rows);
      continue;
    }
    // The first row met on the way; of several at once the one of the lowest index.
    double length = kInfinity;
    int met = -1;
    Side side = Side::none;
    for (int i = 0; i < m; ++i) {
      if (held.side(i) != Side::none) continue;
      const double slope = p.rows.row(i).dot(d) / d.norm();
      if (std::abs(slope) <= kRounding) continue;
      const double value = p.rows.row(i).dot(solution.point);
      const double bound = slope > 0.0 ? p.upper[i] : p.lower[i];
      if (!std::isfinite(bound)) continue;
      const double way = std::max(0.0, (bound - value) / (slope * d.norm()));
      if (way < length * (1.0 - kRounding)) {
        length = way;
        met = i;
        side = slope > 0.0 ? Side::upper : Side::lower;
      }
    }
    if (met < 0) {
      solution.status = ProgrammeStatus::unbounded;
      break;
    }
    solution.point += length * d;
    held.add(met, side, p.rows);
  }
  solution.value = p.objective.dot(solution.point);
  return solution;
}

bool keeps(const LinearProgramme& p, const Point& x, double slack) {
  for (int i = 0; i < p.rows.rows(); ++i) {
    const double value = p.rows.row(i).dot(x);
    if (value < p.lower[i] - slack || value > p.upper[i] + slack) return false;
  }
  return true;
}

}  // namespace

const char* to_string(ProgrammeStatus status) {
  switch (status) {
    case ProgrammeStatus::optimal:
      return "optimal";
    case ProgrammeStatus::unbounded:
      return "unbounded";
    case ProgrammeStatus::infeasible:
      return "infeasible";
    case ProgrammeStatus::stalled:
      return "stalled";
  }
  return "";
}

ProgrammeSolution maximise(const LinearProgramme& programme) noexcept {
  const int m = static_cast<int>(programme.rows.rows()), n = static_cast<int>(programme.rows.cols());
  assert(programme.lower.size() == m && programme.upper.size() == m && programme.objective.size() == n);
  assert((programme.lower.array() <= programme.upper.array()).all());

  // Columns, rows and objective to size one, so that tolerances mean something: x_k = x'_k / column_k.
  LinearProgramme p = programme;
  Point column = Point::Ones(n);
  for (int k = 0; k < n; ++k) {
    const double size = m > 0 ? p.rows.col(k).cwiseAbs().maxCoeff() : 0.0;
    if (size > 0.0) column[k] = size;
    p.rows.col(k) /= column[k];
    p.objective[k] /= column[k];
  }
  Bounds row = Bounds::Ones(m);
  double largest = 0.0;
  for (int i = 0; i < m; ++i) largest = std::max(largest, p.rows.row(i).norm());
  bool possible = true;
  for (int i = 0; i < m; ++i) {
    const double size = p.rows.row(i).norm();
    if (size <= kRounding * largest || size == 0.0) {
      // Nothing moves this row: it is kept always or never.
      p.rows.row(i).setZero();
      possible = possible && p.lower[i] <= 0.0 && p.upper[i] >= 0.0;
      p.lower[i] = -kInfinity;
      p.upper[i] = kInfinity;
      continue;
    }
    row[i] = size;
    p.rows.row(i) /= size;
    p.lower[i] /= size;
    p.upper[i] /= size;
  }
  const double objective_size = p.objective.norm();
  if (objective_size > 0.0) p.objective /= objective_size;

  ProgrammeSolution solution;
  solution.point = Point::Zero(n);
  solution.multipliers = Bounds::Zero(m);
  if (!possible) return solution;
  Point start = Point::Zero(n);
  if (!keeps(p, start, 0.0)) {
    // From the origin, with z of the distance by which each row misses; then z down to zero.
    assert(m < LinearProgramme::kMaxRows && n < LinearProgramme::kMaxVariables);
    LinearProgramme first;
    first.rows.setZero(m + 1, n + 1);
    first.lower.resize(m + 1);
    first.upper.resize(m + 1);
    first.rows.topLeftCorner(m, n) = p.rows;
    double reach = 0.0;
    for (int i = 0; i < m; ++i) reach = std::max(reach, std::abs(std::clamp(0.0, p.lower[i], p.upper[i])));
    for (int i = 0; i < m; ++i) {
      const double miss = std::clamp(0.0, p.lower[i], p.upper[i]) / reach;
      const double size = std::hypot(1.0, miss);
      first.rows(i, n) = miss;
      first.rows.row(i) /= size;
      first.lower[i] = p.lower[i] / (reach * size);
      first.upper[i] = p.upper[i] / (reach * size);
    }
    first.rows(m, n) = 1.0;
    first.lower[m] = 0.0;
    first.upper[m] = 1.0;
    first.objective = -Point::Unit(n + 1, n);
    const ProgrammeSolution found = climb(first, Point::Unit(n + 1, n));
    if (found.status != ProgrammeStatus::optimal) {
      solution.status = ProgrammeStatus::stalled;
      return solution;
    }
    constexpr double kMiss = 1e-9;  // of the largest bound that the origin misses
    if (found.point[n] > kMiss) return solution;
    start = reach * found.point.head(n);
  }
  solution = climb(p, start);
  solution.value *= objective_size;
  for (int k = 0; k < n; ++k) solution.point[k] /= column[k];
  for (int i = 0; i < m; ++i) solution.multipliers[i] *= objective_size / row[i];
  return solution;
}

}  // namespace zwidth
