// A plane of the workspace lattice of a delta, column after column, reduced to sums and extremes. Included once
// per instruction set, after <hwy/foreach_target.h>.

#if defined(ZWIDTH_MECHANISM_DELTA_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ZWIDTH_MECHANISM_DELTA_SWEEP_INL_H
#undef ZWIDTH_MECHANISM_DELTA_SWEEP_INL_H
#else
#define ZWIDTH_MECHANISM_DELTA_SWEEP_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "zwidth/mechanism/internal/delta_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace zwidth::HWY_NAMESPACE {
namespace {

// Lowest and highest z of the workspace on either side of z = 0, per column: a hull, found in closed form from
// the ends of every leg's reach and of its joint range.
struct Hull {
  V low[2], high[2];  // [0] below zero, [1] above
};

template <int leg>
HWY_INLINE void intersect_leg(const Parameters& p, V x, V y, Hull& hull) {
  const V zero = hn::Zero(D()), infinity = set(kInfinity);
  const double scale = p.d2 + p.d3 + std::abs(p.d5), slack = 1e-9 * scale;
  const V s = outward<leg>(x, y), X = s - set(p.d5);
  const V tangential2 = hn::Max(hn::MulAdd(x, x, hn::NegMulAdd(s, s, y * y)), zero);
  const V q2 = set(p.d3 * p.d3) - tangential2;  // squared length of the forearm in the leg's plane
  const M crosses = q2 >= set(-slack * scale);
  const V q = hn::Sqrt(hn::Max(q2, zero));

  V low = infinity, high = hn::Neg(infinity), low_above = infinity, high_below = hn::Neg(infinity);
  const auto candidate = [&](V z, M valid) {
    low = hn::Min(low, hn::IfThenElse(valid, z, infinity));
    high = hn::Max(high, hn::IfThenElse(valid, z, hn::Neg(infinity)));
    low_above = hn::Min(low_above, hn::IfThenElse(hn::And(valid, z >= zero), z, infinity));
    high_below = hn::Max(high_below, hn::IfThenElse(hn::And(valid, z < zero), z, hn::Neg(infinity)));
  };

  // Ends of reach: the arm stretched (rho = d2 + q) or folded (rho = |d2 - q|), where the angle points along
  // (X, z), or against it if the forearm is the longer one.
  const V X2 = X * X;
  const V outer = set(p.d2) + q, inner = hn::Abs(set(p.d2) - q);
  const V outer_z2 = hn::MulSub(outer, outer, X2), inner_z2 = hn::MulSub(inner, inner, X2);
  const M gap = inner_z2 > zero;
  const V outer_z = hn::Sqrt(hn::Max(outer_z2, zero)), inner_z = hn::Sqrt(hn::Max(inner_z2, zero));
  const auto in_range = [&](V z, V rho, V direction) {
    return direction * hn::MulAdd(X, set(p.cos_middle), z * set(p.sin_middle)) >=
           hn::MulSub(set(p.cos_half), rho, set(slack));
  };
  const V one = set(1.0), folded = hn::IfThenElse(set(p.d2) >= q, one, hn::Neg(one));
  const M reaches = hn::And(crosses, outer_z2 >= set(-slack * scale));
  candidate(outer_z, hn::And(reaches, in_range(outer_z, outer, one)));
  candidate(hn::Neg(outer_z), hn::And(reaches, in_range(hn::Neg(outer_z), outer, one)));
  candidate(inner_z, hn::And(hn::And(reaches, gap), in_range(inner_z, inner, folded)));
  candidate(hn::Neg(inner_z), hn::And(hn::And(reaches, gap), in_range(hn::Neg(inner_z), inner, folded)));

  // Ends of the joint range, on the outward root: r . b >= 0.
  if (p.cos_half >= -1.0) {
    for (int end = 0; end < 2; ++end) {
      const V cosine = set(p.cos_end[end]), sine = set(p.sin_end[end]);
      const V across = hn::NegMulAdd(set(p.d2), cosine, X);
      const V up2 = hn::NegMulAdd(across, across, q2);
      const M meets = hn::And(crosses, up2 >= set(-slack * scale));
      const V up = hn::Sqrt(hn::Max(up2, zero)), elbow = set(p.d2) * sine;
      for (const V z : {elbow + up, elbow - up}) {
        candidate(z, hn::And(meets, hn::MulSub(cosine, z, sine * X) >= set(-slack)));
      }
    }
  }
  hull.low[0] = hn::Max(hull.low[0], low);
  hull.high[0] = hn::Min(hull.high[0], hn::IfThenElse(gap, high_below, hn::Min(high, zero)));
  hull.low[1] = hn::Max(hull.low[1], hn::IfThenElse(gap, low_above, hn::Max(low, zero)));
  hull.high[1] = hn::Min(hull.high[1], high);
}

HWY_INLINE bool empty(const Hull& hull) {
  return hn::AllFalse(D(), hn::Or(hull.low[0] <= hull.high[0], hull.low[1] <= hull.high[1]));
}

template <int count>
struct Accumulators {
  Accumulators() {
    inside = hn::Zero(D());
    for (int f = 0; f < count; ++f) {
      sum[f] = hn::Zero(D());
      min[f] = set(kInfinity);
      max[f] = set(-kInfinity);
      min_j[f] = max_j[f] = hn::Zero(D());
    }
    k_first = set(kInfinity);
    k_last = set(-kInfinity);
  }
  V inside, k_first, k_last;
  V sum[count], min[count], max[count], min_j[count], max_j[count];
};

constexpr int kStage = 8;

template <bool all>
HWY_INLINE void sweep_column(const Constants& c, V x, V y, V j, std::int64_t k_first, std::int64_t k_last,
                             double spacing, Accumulators<all ? kFigureCount : kCoreFigureCount>& total) {
  constexpr int count = all ? kFigureCount : kCoreFigureCount;
  const D d;
  const V infinity = set(kInfinity), last = set(static_cast<double>(k_last));
  const Column column = column_at(c, x, y);
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  V column_min[count], column_max[count];
  for (int f = 0; f < count; ++f) {
    column_min[f] = infinity;
    column_max[f] = hn::Neg(infinity);
  }
  // Stage by stage over a few vectors: each stage is one long chain of divisions and roots, and only so do the
  // chains of several vectors overlap.
  Legs legs[kStage];
  V values[kStage][count];
  Gram gram[kStage];
  for (std::int64_t k0 = k_first; k0 <= k_last; k0 += lanes * kStage) {
    const int stage = static_cast<int>(HWY_MIN((k_last - k0) / lanes + 1, kStage));
    V k = hn::Iota(d, static_cast<double>(k0));
    for (int v = 0; v < stage; ++v) {
      solve(c, column, (k + set(static_cast<double>(v * lanes))) * set(spacing), legs[v]);
    }
    for (int v = 0; v < stage; ++v) figures_of<all>(c, legs[v], values[v], gram[v]);
    for (int v = 0; v < stage; ++v) values[v][0] = condition_number(gram[v]);
    for (int v = 0; v < stage; ++v) {
      const M inside = hn::And(legs[v].inside, k <= last);
      total.inside = total.inside + hn::IfThenElseZero(inside, set(1.0));
      total.k_first = hn::Min(total.k_first, hn::IfThenElse(inside, k, infinity));
      total.k_last = hn::Max(total.k_last, hn::IfThenElse(inside, k, hn::Neg(infinity)));
      for (int f = 0; f < count; ++f) {
        total.sum[f] = total.sum[f] + hn::IfThenElseZero(inside, values[v][f]);
        column_min[f] = hn::Min(column_min[f], hn::IfThenElse(inside, values[v][f], infinity));
        column_max[f] = hn::Max(column_max[f], hn::IfThenElse(inside, values[v][f], hn::Neg(infinity)));
      }
      k = k + set(static_cast<double>(lanes));
    }
  }
  for (int f = 0; f < count; ++f) {
    total.min_j[f] = hn::IfThenElse(column_min[f] < total.min[f], j, total.min_j[f]);
    total.max_j[f] = hn::IfThenElse(column_max[f] > total.max[f], j, total.max_j[f]);
    total.min[f] = hn::Min(total.min[f], column_min[f]);
    total.max[f] = hn::Max(total.max[f], column_max[f]);
  }
}

double sum_of(V v) {
  return hn::GetLane(hn::SumOfLanes(D(), v));
}
double min_of(V v) {
  return hn::GetLane(hn::MinOfLanes(D(), v));
}
double max_of(V v) {
  return hn::GetLane(hn::MaxOfLanes(D(), v));
}

template <bool all>
DeltaBatch::PlaneSummary sweep_plane_of(const Parameters& p, std::int64_t i, DeltaBatch::IndexRange j_range,
                                        DeltaBatch::IndexRange k_range, double spacing) {
  constexpr int count = all ? kFigureCount : kCoreFigureCount;
  const D d;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  const Constants c(p);
  const V x = set(static_cast<double>(i) * spacing);
  const double pad = 1e-7 * (p.d2 + p.d3 + std::abs(p.d5));
  Accumulators<count> total;
  DeltaBatch::PlaneSummary summary;
  HWY_ALIGN double bounds[4][hn::MaxLanes(D())];

  for (std::int64_t j0 = j_range.first; j0 <= j_range.last; j0 += lanes) {
    Hull hull;
    for (int side = 0; side < 2; ++side) {
      hull.low[side] = set(-kInfinity);
      hull.high[side] = set(kInfinity);
    }
    const V y = hn::Iota(d, static_cast<double>(j0)) * set(spacing);
    intersect_leg<0>(p, x, y, hull);
    if (empty(hull)) continue;
    intersect_leg<1>(p, x, y, hull);
    if (empty(hull)) continue;
    intersect_leg<2>(p, x, y, hull);
    const V limit_low = set(static_cast<double>(k_range.first)),
            limit_high = set(static_cast<double>(k_range.last));
    for (int side = 0; side < 2; ++side) {
      hn::Store(hn::Max(hn::Ceil((hull.low[side] - set(pad)) / set(spacing)), limit_low), d, bounds[2 * side]);
      hn::Store(hn::Min(hn::Floor((hull.high[side] + set(pad)) / set(spacing)), limit_high), d,
                bounds[2 * side + 1]);
    }
    const std::int64_t columns = HWY_MIN(lanes, j_range.last - j0 + 1);
    for (std::int64_t lane = 0; lane < columns; ++lane) {
      const double j = static_cast<double>(j0 + lane);
      const double before = sum_of(total.inside);
      double done = -kInfinity;  // the two sides may share an index
      for (int side = 0; side < 2; ++side) {
        const double low = HWY_MAX(bounds[2 * side][lane], done + 1.0), high = bounds[2 * side + 1][lane];
        if (!(low <= high)) continue;
        sweep_column<all>(c, x, set(j * spacing), set(j), static_cast<std::int64_t>(low),
                          static_cast<std::int64_t>(high), spacing, total);
        done = high;
      }
      if (sum_of(total.inside) > before) {
        if (before == 0.0) summary.j_first = j0 + lane;
        summary.j_last = j0 + lane;
      }
    }
  }

  summary.inside = static_cast<std::int64_t>(sum_of(total.inside));
  if (summary.inside == 0) return summary;
  summary.k_first = static_cast<std::int64_t>(min_of(total.k_first));
  summary.k_last = static_cast<std::int64_t>(max_of(total.k_last));
  for (int f = 0; f < count; ++f) {
    summary.sum[f] = sum_of(total.sum[f]);
    // Of equal extremes the one with the smallest j, whatever the number of lanes.
    const double least = min_of(total.min[f]), most = max_of(total.max[f]);
    const V infinity = set(kInfinity);
    summary.min[f] = {least, static_cast<std::int64_t>(
                                 min_of(hn::IfThenElse(total.min[f] == set(least), total.min_j[f], infinity)))};
    summary.max[f] = {most, static_cast<std::int64_t>(
                                min_of(hn::IfThenElse(total.max[f] == set(most), total.max_j[f], infinity)))};
  }
  return summary;
}

DeltaBatch::PlaneSummary sweep_plane(const Parameters& p, std::int64_t i, DeltaBatch::IndexRange j_range,
                                     DeltaBatch::IndexRange k_range, double spacing, bool all) {
  return all ? sweep_plane_of<true>(p, i, j_range, k_range, spacing)
             : sweep_plane_of<false>(p, i, j_range, k_range, spacing);
}

}  // namespace
}  // namespace zwidth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
