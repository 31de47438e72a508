#include "zwidth/analysis/conditioning.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/probe.h"

namespace zwidth {
namespace {

using internal::Probe;
using IndexRange = DeltaBatch::IndexRange;

double coordinate(std::int64_t index, double spacing) {
  return static_cast<double>(index) * spacing;
}

// ---------------------------------------------------------------------------------------- over the workspace

// Condition numbers along columns of the lattice; NaN outside.
class Columns {
 public:
  Columns(const Probe& fresh, const IndexRange& k, double spacing)
      : probe_(fresh), spacing_(spacing), k_(k), condition_(static_cast<std::size_t>(internal::size(k))) {
    const Mechanism& mechanism = fresh.mechanism();
    if (!mechanism.delta()) return;
    batch_.emplace(*mechanism.delta(), mechanism.active_range(0));
    x_.resize(condition_.size());
    y_.resize(condition_.size());
    values_.resize(condition_.size() * kFigureCount);
    for (std::size_t p = 0; p < condition_.size(); ++p)
      z_.push_back(coordinate(k.first + static_cast<std::int64_t>(p), spacing));
  }

  const std::vector<double>& at(double x, double y) {
    if (batch_) {
      std::ranges::fill(x_, x);
      std::ranges::fill(y_, y);
      batch_->figures(x_, y_, z_, values_);
      const auto first =
          static_cast<std::ptrdiff_t>(static_cast<std::size_t>(Figure::condition_number) * condition_.size());
      std::copy_n(values_.begin() + first, condition_.size(), condition_.begin());
      return condition_;
    }
    if (probe_.dimension() == 3) probe_.restart();
    for (std::size_t p = 0; p < condition_.size(); ++p) {
      const double z = coordinate(k_.first + static_cast<std::int64_t>(p), spacing_);
      condition_[p] = internal::condition_number(probe_, {x, y, z});
    }
    return condition_;
  }

 private:
  Probe probe_;
  double spacing_;
  IndexRange k_;
  std::optional<DeltaBatch> batch_;
  std::vector<double> condition_, x_, y_, z_, values_;
};

// ------------------------------------------------------------------------------------------- in a plane

// Radii between which an outline runs, seen from the origin.
Interval radii(const Outline& outline) {
  Interval range{std::numeric_limits<double>::infinity(), 0.0};
  for (const auto& point : outline) {
    const double r = std::hypot(point[0], point[1]);
    range = {std::min(range.min, r), std::max(range.max, r)};
  }
  return range;
}

// The end of a band of circles within the region: where its boundary comes nearest to the band, refined from
// the nearest of the outline's points. `outwards`: the boundary lies beyond the band.
class BandEnd {
 public:
  BandEnd(Probe& probe, double limit, double inside_radius, bool outwards)
      : probe_(probe), limit_(limit), inside_(inside_radius), outwards_(outwards) {}

  double refined(double angle, double radius, double spacing) {
    // Golden section on the angle; the boundary is smooth on this scale, or has one corner.
    const double turn = 2.0 * spacing / radius, ratio = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = angle - turn, high = angle + turn;
    const double step = spacing;
    double a = high - ratio * (high - low), b = low + ratio * (high - low);
    double ra = along(a, radius, step), rb = along(b, radius, step);
    for (int iteration = 0; iteration < 40; ++iteration) {
      const bool keep_low = outwards_ ? ra < rb : ra > rb;
      if (keep_low) {
        high = b;
        b = a;
        rb = ra;
        a = high - ratio * (high - low);
        ra = along(a, radius, step);
      } else {
        low = a;
        a = b;
        ra = rb;
        b = low + ratio * (high - low);
        rb = along(b, radius, step);
      }
    }
    return outwards_ ? std::min({ra, rb, radius}) : std::max({ra, rb, radius});
  }

 private:
  bool within(double angle, double radius) {
    return internal::condition_number(probe_, {radius * std::cos(angle), radius * std::sin(angle), 0.0}) <
           limit_;
  }
  // Radius at which the ray of this angle leaves the region, near `radius`.
  double along(double angle, double radius, double step) {
    double in = outwards_ ? std::max(radius - step, inside_) : std::min(radius + step, inside_);
    double out = outwards_ ? radius + step : std::max(radius - step, 0.0);
    if (!within(angle, in)) return in;
    if (within(angle, out)) return out;
    while (std::abs(out - in) > 1e-9) {
      const double middle = 0.5 * (in + out);
      (within(angle, middle) ? in : out) = middle;
    }
    return in;
  }

  Probe& probe_;
  double limit_;
  double inside_;
  bool outwards_;
};

std::optional<Interval> widest_annulus(const Mechanism& mechanism, const std::vector<Outline>& outlines,
                                       double limit, double spacing) {
  // Between the radii that outlines pass through lie bands of circles that none crosses.
  std::vector<Interval> taken;
  for (const Outline& outline : outlines) taken.push_back(radii(outline));
  std::ranges::sort(taken, {}, &Interval::min);
  std::vector<Interval> gaps;
  double reached = 0.0;
  for (const Interval& range : taken) {
    if (range.min > reached) gaps.push_back({reached, range.min});
    reached = std::max(reached, range.max);
  }
  Probe probe(mechanism);
  std::optional<Interval> best;
  for (const Interval& gap : gaps) {
    const double middle = gap.middle();
    const auto within = [&](int n) {
      const double angle = 2.0 * std::numbers::pi * n / 720;
      return internal::condition_number(probe, {middle * std::cos(angle), middle * std::sin(angle), 0.0}) <
             limit;
    };
    bool all = true;
    for (int n = 0; n < 720 && all; ++n) all = within(n);
    if (!all || (best && gap.width() <= best->width())) continue;
    best = gap;
  }
  if (!best) return best;
  const double middle = best->middle();
  Interval refined = *best;
  for (const Outline& outline : outlines) {
    for (const auto& point : outline) {
      const double r = std::hypot(point[0], point[1]), angle = std::atan2(point[1], point[0]);
      // The few points that may belong to the nearest place: others lie farther by more than a step's worth.
      if (r >= best->max && r < best->max + 0.02 * spacing) {
        refined.max = std::min(refined.max, BandEnd(probe, limit, middle, true).refined(angle, r, spacing));
      }
      if (best->min > 0.0 && r <= best->min && r > best->min - 0.02 * spacing) {
        refined.min = std::max(refined.min, BandEnd(probe, limit, middle, false).refined(angle, r, spacing));
      }
    }
  }
  if (!(refined.width() > 0.0)) return std::nullopt;
  return refined;
}

}  // namespace

WorkspaceConditioning sweep_conditioning(const Mechanism& mechanism, double spacing, const Effort& effort) {
  assert(!workspace_obstacle(mechanism) && spacing > 0.0);
  const std::array<IndexRange, 3> box = internal::lattice_box(mechanism, spacing);
  struct Layer {
    GlobalConditioning conditioning;
    std::int64_t inside = 0;
  };
  std::vector<Layer> layers(static_cast<std::size_t>(internal::size(box[0])));
  WorkspaceConditioning result{.spacing = spacing};
  const Probe fresh(mechanism);
  result.complete = internal::for_each_index(layers.size(), effort, [&](std::size_t index) {
    Columns columns(fresh, box[2], spacing);
    const double x = coordinate(box[0].first + static_cast<std::int64_t>(index), spacing);
    for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
      for (const double condition : columns.at(x, coordinate(j, spacing))) {
        if (std::isnan(condition)) continue;
        layers[index].conditioning.add(condition);
        ++layers[index].inside;
      }
    }
  });
  for (const Layer& layer : layers) {
    result.of_all.add(layer.conditioning);
    result.inside += layer.inside;
  }
  return result;
}

DexterousRegion dexterous_region(const Mechanism& mechanism, const Extents& extents, double limit, int points) {
  assert(!workspace_obstacle(mechanism) && internal::tool_dimension(mechanism) == 2 && limit > 1.0 &&
         points > 2);
  DexterousRegion region{.limit = limit};
  const double size = extents.size().maxCoeff();
  if (!(size > 0.0)) return region;
  const auto at = [&](int count) {
    return condition_region(mechanism, map_slice(mechanism, extents, 2, 0.0, count, {}), limit);
  };
  const Slice fine = at(points);
  region.spacing = size / (points - 1);
  region.area = fine.area;
  region.error_estimate = std::abs(fine.area - at((points + 1) / 2).area);
  region.outlines = fine.outlines;
  region.annulus = widest_annulus(mechanism, region.outlines, limit, region.spacing);
  return region;
}

}  // namespace zwidth
