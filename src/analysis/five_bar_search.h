#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/batch_five_bar.h"
#include "zwidth/mechanism/five_bar.h"

/// The design search of Singh, Saha and Manivannan (section 5): of a grid of link lengths, the five-bar with
/// the fewest workspace points whose Jacobian is badly conditioned.
///
/// The optimum hangs on where the points lie (docs/devices/five-bar.md), so the sampling is an input, and comes
/// back with the result.

namespace zwidth {

/// Points on circles about the origin: radii step, 2 step, ... up to the sum of crank and coupler; angles from
/// +x.
struct PolarSampling {
  double radius_step = 0.01;                    ///< [m], or the unit of the lengths
  double angle_step = 0.034906585039886591538;  ///< [rad]
  double angle_span = 6.2831853071795864769;    ///< of a full turn the end is left out, else it counts [rad]
  bool operator==(const PolarSampling&) const = default;
};

/// Points of a sampling, ordered by radius.
struct PolarPoints {
  std::vector<double> x, y;  ///< [m]
  std::int64_t per_circle = 0;
  double radius_step = 0.0;  ///< [m]
  /// How many of them, the first ones, lie within `reach` [m].
  std::size_t within(double reach) const;
  std::size_t size() const { return x.size(); }
};
/// Points up to `reach` [m]. Throws std::invalid_argument if a step is not positive and finite, or the span not
/// in (0, 2 pi], and std::length_error for more than 2 10^7 points.
PolarPoints polar_points(const PolarSampling& sampling, double reach);

/// How the source's figures draw a class: "plus", "asterisk", "square", "diamond".
const char* symbol(ConditionClass condition_class);

/// A five-bar's condition number over a sampling, by the classes of section 4.1.
struct ConditionCensus {
  std::int64_t points = 0;               ///< sampled
  std::int64_t reachable = 0;            ///< of them, singular ones included
  std::array<std::int64_t, 4> count{};   ///< by `ConditionClass`, singular points left out
  std::int64_t singular = 0;             ///< K infinite
  double largest = 0.0;                  ///< finite K; 0 if there is none
  Vector2 largest_at = Vector2::Zero();  ///< the first point that has it [m]

  std::int64_t operator[](ConditionClass one) const { return count[static_cast<std::size_t>(one)]; }
};
/// Throws as `polar_points`.
ConditionCensus condition_census(const FiveBarGeometry& geometry, WorkingMode mode,
                                 const PolarSampling& sampling);

/// The widest band of circles about the origin, with their whole circumference (all angles of the sampling),
/// reachable and with K below `limit`; none if there is no such circle.
std::optional<Interval> dexterous_annulus(const FiveBarGeometry& geometry, WorkingMode mode, double limit,
                                          const PolarSampling& sampling);

/// first, first + step, ... up to last.
struct LengthRange {
  double first = 0.0;
  double last = 0.0;
  double step = 0.0;  ///< may be 0 if first = last
  bool operator==(const LengthRange&) const = default;
};

struct FiveBarSearch {
  LengthRange crank;    ///< a1
  LengthRange coupler;  ///< a2
  LengthRange base;     ///< a3
  /// Whether a3 is half the distance of the motors, as in equations (1)-(9), or all of it, as section 5 has it.
  bool base_is_half = true;
  PolarSampling sampling;
  WorkingMode mode;
  double limit = 5.0;           ///< on the condition number
  bool count_singular = false;  ///< whether exactly singular points count as badly conditioned
};

struct FiveBarScore {
  std::array<double, 3> lengths{};  ///< a1, a2, a3 as the search has them
  FiveBarGeometry geometry;
  std::int64_t reachable = 0;     ///< sampled points in reach, singular ones too
  std::int64_t bad = 0;           ///< the score: points above the limit, and singular ones if they count
  std::int64_t singular = 0;      ///< exactly singular points
  double inscribed_radius = 0.0;  ///< r_MIC = min(a1, a2)
};

struct FiveBarSearchResult {
  FiveBarSearch search;                 ///< what was asked
  bool complete = true;                 ///< false if it was cancelled: `designs` then holds a part
  std::int64_t points = 0;              ///< looked at, all designs together
  std::vector<FiveBarScore> designs;    ///< that can be assembled and reach a point; by a1, then a2, then a3
  std::vector<std::size_t> optimum;     ///< those with the fewest bad points
  std::optional<std::size_t> selected;  ///< of them, the first with the largest r_MIC; none without designs

  /// The fewest bad points among the designs with each a3: (a3, count), by a3.
  std::vector<std::pair<double, std::int64_t>> fewest_by_base() const;
};

/// The reachable points within crank + coupler, how many are singular, and how many others have a condition
/// number above `limit`. All zero for lengths that cannot be assembled.
FiveBarBatch::Count badly_conditioned(const FiveBarGeometry& geometry, WorkingMode mode,
                                      const PolarPoints& points, double limit);

/// Looks at every design. The result does not depend on the number of threads. Throws as `polar_points`, and
/// std::invalid_argument for ranges that are empty or have a step that is not positive, std::length_error for
/// more than 10^8 designs.
FiveBarSearchResult search_five_bars(const FiveBarSearch& search, const Effort& effort = {});

}  // namespace zwidth
