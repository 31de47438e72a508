#include "zwidth/mechanism/redundancy.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "zwidth/math/svd.h"

namespace zwidth {
namespace {

constexpr std::array<std::string_view, 3> kFigureNames = {"manipulability", "inverse_condition",
                                                          "limit_distance"};
constexpr double kUnlimited = 1e8;  // ranges wider than this are none [rad] or [m]

double limit_distance(const ActiveVector& joints, std::span<const Interval> ranges) {
  double nearest = 1.0;
  for (int j = 0; j < joints.size(); ++j) {
    if (!(ranges[j].width() < kUnlimited)) continue;
    const double half = 0.5 * ranges[j].width();
    nearest = std::min(nearest, 1.0 - std::abs(joints[j] - ranges[j].middle()) / half);
  }
  return nearest;
}

}  // namespace

std::string_view to_string(RedundancyFigure figure) {
  return kFigureNames[static_cast<int>(figure)];
}

std::optional<RedundancyFigure> redundancy_figure_named(std::string_view name) {
  const auto found = std::find(kFigureNames.begin(), kFigureNames.end(), name);
  if (found == kFigureNames.end()) return std::nullopt;
  return RedundancyFigure(found - kFigureNames.begin());
}

double redundancy_figure(RedundancyFigure figure, Match match, const Jacobian& jacobian,
                         const ActiveVector& joints, std::span<const Interval> ranges, double length) noexcept {
  assert(static_cast<std::size_t>(joints.size()) == ranges.size() && jacobian.cols() == joints.size());
  if (figure == RedundancyFigure::limit_distance) return limit_distance(joints, ranges);
  Jacobian J = match == Match::position ? Jacobian(jacobian.topRows(3)) : jacobian;
  if (J.cols() < J.rows()) return 0.0;
  if (J.rows() == 6) J.bottomRows(3) *= length;
  const ToolMatrix G = J.lazyProduct(J.transpose());
  if (figure == RedundancyFigure::manipulability) {
    // G = L D L^T; its determinant is the product of the pivots.
    ToolMatrix A = G;
    double det = 1.0;
    for (int k = 0; k < A.rows(); ++k) {
      const double pivot = A(k, k);
      if (!(pivot > 0.0)) return 0.0;
      det *= pivot;
      for (int r = k + 1; r < A.rows(); ++r) {
        const double l = A(r, k) / pivot;
        for (int c = k + 1; c <= r; ++c) A(r, c) -= l * A(c, k);
      }
    }
    return std::sqrt(det);
  }
  const SmallVector sigma = svd(J).sigma;
  return sigma[0] > 0.0 ? sigma[sigma.size() - 1] / sigma[0] : 0.0;
}

}  // namespace zwidth
