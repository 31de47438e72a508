#include "zwidth/analysis/pose_workspace.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "zwidth/analysis/internal/any_orientation.h"
#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/loads.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/pose_flood.h"
#include "zwidth/analysis/internal/pose_guide.h"
#include "zwidth/analysis/internal/quantiles.h"
#include "zwidth/analysis/internal/region.h"
#include "zwidth/analysis/internal/trace.h"

namespace zwidth {
namespace {

using internal::flood_poses;
using internal::PoseChart;
using internal::PoseFlood;
using internal::PoseFloodOptions;
using internal::PoseGuide;
using std::numbers::pi;

constexpr std::size_t kMostPlaces = 2'000'000;
constexpr std::size_t kFewest = 200, kMany = 4000;  // points of a first look
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The nearest of 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten.
double rounded(double spacing) {
  const double power = std::pow(10.0, std::floor(std::log10(spacing)));
  double best = 10.0;
  for (const double factor : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
    if (std::abs(std::log(spacing / power / factor)) < std::abs(std::log(spacing / power / best)))
      best = factor;
  }
  return best * power;
}

// ------------------------------------------------------------------------------------------------ a first look

struct Look {
  PoseFlood flood;
  bool unbounded = false;
};

// A coarse lattice of a useful number of points, whatever the size of what is looked at.
Look look(const PoseGuide& guide, const PoseChart& chart, const Posture& seed, const Vector3& from,
          double spacing, double most_radius, const Effort& effort) {
  const double longest = 1e3 * spacing, shortest = 1e-7 * spacing;
  Look result;
  while (true) {
    result.flood =
        flood_poses(guide, chart, seed, from,
                    {.spacing = spacing, .most = kMany, .exits = false, .most_radius = most_radius}, effort);
    if (!result.flood.complete) return result;
    const std::size_t fewest = chart.dimension() == 3 ? kFewest : chart.dimension() == 2 ? 100 : 20;
    if (result.flood.full) {
      spacing *= 1.9;
      result.unbounded = spacing > longest;
      if (result.unbounded) return result;
    } else if (result.flood.points.size() < fewest) {
      spacing *= 0.5;
      if (spacing < shortest) return result;
    } else {
      return result;
    }
  }
}

double fitting_spacing(const PoseFlood& coarse, double points) {
  const double ratio = static_cast<double>(coarse.points.size()) / points;
  return rounded(coarse.spacing * std::pow(ratio, 1.0 / coarse.dimension));
}

// ------------------------------------------------------------------------------------------------ conditioning

class Figures {
 public:
  enum {
    translation,
    rotation,
    homogeneous,
    weakest_force,
    weakest_moment,
    force,
    moment = force + 3,
    count = moment + 3
  };

  Figures(const PoseGuide& guide, const PoseWorkspaceOptions& options)
      : guide_(guide), options_(options), scale_(jacobian_scale(guide.mechanism())) {
    scale_.units.linear_rows = static_cast<int>(guide.moves().size());
  }

  double length() const { return scale_.length; }

  void fill(const Posture& posture, const Rates& rates, std::span<double> values) const {
    std::ranges::fill(values, kNone);
    if (options_.torque) fill_loads(rates.tool, options_.torque(posture), values);
    const Jacobian J = guide_.rows(rates.tool);
    const Eigen::Index linear = scale_.units.linear_rows, angular = J.rows() - linear;
    const auto figure = [this](const Jacobian& part) { return 1.0 / scale_.rows_condition_number(part); };
    values[translation] = linear > 0 ? figure(J.topRows(linear)) : kNone;
    values[rotation] = angular > 1 ? figure(J.bottomRows(angular)) : kNone;
    values[homogeneous] = linear > 0 && angular > 0 ? 1.0 / scale_.condition_number(J) : values[translation];
  }

 private:
  void fill_loads(const Jacobian& tool, const TorqueRange& range, std::span<double> values) const {
    const Jacobian J = guide_.rows(tool);
    const auto linear = static_cast<Eigen::Index>(guide_.moves().size()), angular = J.rows() - linear;
    const auto fill_kind = [&](const Jacobian& rows, const std::vector<int>& axes, int along, int weakest) {
      for (Eigen::Index r = 0; r < rows.rows(); ++r) {
        const int axis = axes[static_cast<std::size_t>(r)] % 3;
        values[static_cast<std::size_t>(along) + static_cast<std::size_t>(axis)] =
            internal::axis_load(rows, range, r);
      }
      values[static_cast<std::size_t>(weakest)] = internal::weakest_load(rows, range);
    };
    if (linear > 0) fill_kind(J.topRows(linear), guide_.moves(), force, weakest_force);
    if (angular > 0) fill_kind(J.bottomRows(angular), guide_.turns(), moment, weakest_moment);
  }

  const PoseGuide& guide_;
  const PoseWorkspaceOptions& options_;
  JacobianScale scale_;
};

Statistic statistic_of(const PoseChart& chart, const PoseFlood& flood, const std::vector<std::size_t>& order,
                       int figure) {
  internal::StatisticBuilder builder;
  const std::vector<double>& values = flood.values[static_cast<std::size_t>(figure)];
  std::vector<double> known;
  for (const std::size_t p : order) {
    if (std::isnan(values[p])) continue;
    builder.add(values[p], chart.at(flood.coordinates(flood.points[p])).position);
    known.push_back(values[p]);
  }
  Statistic statistic = builder.result();
  internal::put_quantiles(known, statistic);
  return statistic;
}

PoseConditioning conditioning_of(const PoseChart& chart, const PoseFlood& flood,
                                 const std::vector<std::size_t>& order, int figure) {
  PoseConditioning result{.of_all = {}, .figure = statistic_of(chart, flood, order, figure)};
  const std::vector<double>& values = flood.values[static_cast<std::size_t>(figure)];
  for (const std::size_t p : order) {
    const double value = values[p];
    if (!std::isnan(value))
      result.of_all.add(value > 0.0 ? 1.0 / value : std::numeric_limits<double>::infinity());
  }
  return result;
}

// Forces and moments over the points of a flood.
void put_loads(const PoseChart& chart, const PoseFlood& flood, const std::vector<std::size_t>& order,
               const PoseWorkspaceOptions& options, PoseWorkspace& workspace) {
  if (!options.torque) return;
  for (std::size_t k = 0; k < 3; ++k) {
    workspace.force[k] = statistic_of(chart, flood, order, Figures::force + static_cast<int>(k));
    workspace.moment[k] = statistic_of(chart, flood, order, Figures::moment + static_cast<int>(k));
  }
  workspace.weakest_force = statistic_of(chart, flood, order, Figures::weakest_force);
  workspace.weakest_moment = statistic_of(chart, flood, order, Figures::weakest_moment);
}

// ---------------------------------------------------------------------------------------------- its shape

// The places of one orientation, in the coordinates of a chart.
class PoseRegion : public internal::Region {
 public:
  PoseRegion(const PoseGuide& guide, const PoseChart& chart, const Posture& seed)
      : guide_(guide), chart_(chart), seed_(seed), last_(seed) {}

  int dimension() const override { return chart_.dimension(); }
  bool inside(const Vector3& point) override { return lead(point).inside; }

  double margin(const Vector3& point) override {
    const PoseGuide::Step step = lead(point);
    return step.reached ? guide_.margin(*step.posture) : kNone;
  }

  // Of the surface on which the joint that has come to an end of its range stays there.
  std::optional<Vector3> normal(const Vector3& point, const Vector3& outwards) override {
    const PoseGuide::Step step = lead(point);
    if (!step.reached) return std::nullopt;
    int joint = -1;
    bool upper = false;
    constexpr double kClose = 1e-3;
    if (!(std::abs(guide_.margin(*step.posture, &joint, &upper)) < kClose)) return std::nullopt;
    const Rates rate = rates(*step.posture);
    // Active rates for moves without turning, then the joint's.
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(guide_.rows(rate.tool));
    const Eigen::RowVectorXd slope = rate.joints.row(joint) * inverse.pseudoInverse();
    Vector3 n = Vector3::Zero();
    for (int k = 0; k < dimension(); ++k) n[k] = upper ? slope[k] : -slope[k];
    if (!(n.norm() > 0.0) || !n.allFinite()) return std::nullopt;
    n.normalize();
    if (n.dot(outwards) <= 0.05) return std::nullopt;
    return n;
  }

 private:
  PoseGuide::Step lead(const Vector3& point) {
    const Pose pose = chart_.at(point);
    PoseGuide::Step step = guide_.step(last_, pose);
    // The last place may lie on the other side of a hole.
    if (!step.posture) step = guide_.step(seed_, pose);
    if (step.inside) last_ = *step.posture;
    return step;
  }

  const PoseGuide& guide_;
  const PoseChart& chart_;
  const Posture& seed_;
  Posture last_;
};

// The lattice of a first look as a box with a rim.
internal::RegionLattice lattice_of(const PoseFlood& flood) {
  internal::RegionLattice lattice{.spacing = flood.spacing};
  internal::LatticeIndex low = flood.points.front().at, high = low;
  for (const PoseFlood::Point& point : flood.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], point.at[k]);
      high[k] = std::max(high[k], point.at[k]);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int rim = static_cast<int>(k) < flood.dimension ? 1 : 0;
    lattice.count[k] = high[k] - low[k] + 1 + 2 * rim;
    low[k] -= rim;
    lattice.origin[static_cast<Eigen::Index>(k)] = flood.spacing * low[k];
  }
  lattice.inside.resize(lattice.index(lattice.count[0] - 1, lattice.count[1] - 1, lattice.count[2] - 1) + 1);
  for (const PoseFlood::Point& point : flood.points) {
    lattice.inside[lattice.index(point.at[0] - low[0], point.at[1] - low[1], point.at[2] - low[2])] = 1;
  }
  return lattice;
}

// The largest coordinate along an axis, or the smallest, from the farthest point of a lattice: steps in ever
// other directions of the half space ahead, as long as they stay inside.
double farthest(PoseRegion& region, const PoseFlood& flood, int axis, bool up, bool closely) {
  constexpr int kDirections = 14, kPatience = 3;
  const double sign = up ? 1.0 : -1.0;
  const auto edge = 2 * static_cast<std::size_t>(axis) + (up ? 1U : 0U);
  Vector3 best = Vector3::Zero();
  double value = -std::numeric_limits<double>::infinity();
  for (const PoseFlood::Point& point : flood.points) {
    const float exit = point.exit[edge];
    if (std::isnan(exit)) continue;
    const double here = sign * flood.coordinates(point)[axis] + flood.spacing * static_cast<double>(exit);
    if (here <= value) continue;
    value = here;
    best = flood.coordinates(point);
  }
  const int dimension = region.dimension();
  double step = flood.spacing;
  int failures = 0;
  for (int round = 0; closely && step > 1e-5 * flood.spacing && round < 400; ++round) {
    bool gained = false;
    for (int n = 0; n < kDirections && !gained; ++n) {
      // Ahead first, then ever more to the side.
      const double turn = pi * (3.0 - std::sqrt(5.0)) * (n + kDirections * round);
      const double ahead = 1.0 - static_cast<double>(n) / kDirections, aside = std::sqrt(1.0 - ahead * ahead);
      Vector3 way = sign * ahead * Vector3::Unit(axis);
      if (dimension == 2) way[1 - axis] = (n % 2 == 0 ? 1.0 : -1.0) * aside;
      if (dimension == 3) {
        way[(axis + 1) % 3] = aside * std::cos(turn);
        way[(axis + 2) % 3] = aside * std::sin(turn);
      }
      if (!region.inside(best + step * way)) continue;
      best += step * way;
      gained = true;
    }
    if (gained) {
      failures = 0;
      step *= 1.2;
    } else if (++failures >= (dimension == 3 ? kPatience : 1)) {
      failures = 0;
      step *= 0.4;
    }
  }
  return std::max(value, sign * best[axis]) * sign;
}

// A cut through a place: a lattice of its own in the plane.
ReachSlice slice_of(const PoseGuide& guide, const Pose& through, const Posture& seed, int u, int v, int normal,
                    double spacing, const Figures& figures, const Effort& effort) {
  const PoseChart chart{.origin = through, .axes = {u, v}};
  const PoseFlood flood =
      flood_poses(guide, chart, seed, chart.coordinates(through.position),
                  {.spacing = spacing,
                   .figures = Figures::count,
                   .figure = [&](const Posture& posture, const Rates& rates,
                                 std::span<double> row) { figures.fill(posture, rates, row); }},
                  effort);
  ReachSlice cut{.slice = {.axis = normal, .at = through.position[normal], .u = u, .v = v}, .conditioning = {}};
  if (flood.points.empty()) return cut;
  const internal::RegionLattice lattice = lattice_of(flood);
  PlaneGrid& grid = cut.conditioning;
  grid.nu = lattice.count[0];
  grid.nv = lattice.count[1];
  grid.u = {lattice.origin[0], lattice.origin[0] + spacing * (grid.nu - 1)};
  grid.v = {lattice.origin[1], lattice.origin[1] + spacing * (grid.nv - 1)};
  grid.values.assign(static_cast<std::size_t>(grid.nu) * static_cast<std::size_t>(grid.nv), kNone);
  const auto first_u = static_cast<int>(std::lround(lattice.origin[0] / spacing));
  const auto first_v = static_cast<int>(std::lround(lattice.origin[1] / spacing));
  for (std::size_t p = 0; p < flood.points.size(); ++p) {
    const auto& at = flood.points[p].at;
    grid.values[static_cast<std::size_t>((at[1] - first_v) * grid.nu + at[0] - first_u)] =
        flood.values[Figures::homogeneous][p];
  }
  const auto point = [&](int iu, int iv) { return flood.place.find({iu + first_u, iv + first_v, 0}); };
  const auto crossing = [&](const internal::GridLine& line) -> std::array<double, 2> {
    const int ju = line.iu + (line.up ? 0 : 1), jv = line.iv + (line.up ? 1 : 0);
    const bool from_low = lattice.at(line.iu, line.iv, 0);
    const auto found = from_low ? point(line.iu, line.iv) : point(ju, jv);
    const std::size_t edge = (line.up ? 2U : 0U) + (from_low ? 1U : 0U);
    const float exit = flood.points[found->second].exit[edge];
    const double share = from_low ? static_cast<double>(exit) : 1.0 - static_cast<double>(exit);
    return {grid.u.min + spacing * (line.iu + (line.up ? 0.0 : share)),
            grid.v.min + spacing * (line.iv + (line.up ? share : 0.0))};
  };
  cut.slice.outlines = internal::trace_outlines(
      grid.nu, grid.nv, [&](int iu, int iv) { return lattice.at(iu, iv, 0); }, [](int, int) { return false; },
      crossing);
  cut.slice.area = internal::enclosed_area(cut.slice.outlines);
  return cut;
}

// --------------------------------------------------------------------------------------------------------
// turns

// How far the tool turns about one axis alone.
Interval turn_about(const PoseGuide& guide, const Pose& origin, int axis, const Posture& seed) {
  constexpr double kStep = pi / 180.0;
  const PoseChart chart{.origin = origin, .axes = {axis}};
  Interval range;
  for (const double sign : {-1.0, 1.0}) {
    Posture last = seed;
    double in = 0.0, out = 0.0;
    while (out <= in && in < pi) {
      const double next = std::min(in + kStep, pi);
      PoseGuide::Step step = guide.step(last, chart.at({sign * next, 0.0, 0.0}));
      if (step.inside) {
        last = *step.posture;
        in = next;
      } else {
        out = next;
      }
    }
    while (out - in > 1e-9) {
      const double middle = 0.5 * (in + out);
      PoseGuide::Step step = guide.step(last, chart.at({sign * middle, 0.0, 0.0}));
      if (step.inside) last = *step.posture;
      (step.inside ? in : out) = middle;
    }
    (sign < 0.0 ? range.min : range.max) = sign * in;
  }
  return range;
}

void turn_round(const PoseGuide& guide, const Posture& seed, TurningRange& turning, const Effort& effort) {
  const Pose& origin = seed.tool();
  for (const int axis : guide.turns()) turning.about[axis - 3] = turn_about(guide, origin, axis, seed);
  if (guide.turns().size() == 1) {
    turning.share = turning.about[guide.turns().front() - 3]->width() / (2.0 * pi);
    turning.share_error = 1e-9 / pi;
  }
  if (guide.turns().size() < 2) return;
  const PoseChart chart{.origin = origin, .axes = guide.turns()};
  const Look first = look(guide, chart, seed, Vector3::Zero(), 0.1, pi, effort);
  constexpr double kOrientations = 15'000.0;
  const PoseFlood flood = flood_poses(
      guide, chart, seed, Vector3::Zero(),
      {.spacing = fitting_spacing(first.flood, kOrientations), .most = kMostPlaces, .most_radius = pi}, effort);
  // Of a tool that turns in two ways the directions of the axis that is left, of the sphere.
  const auto directions = [](const Vector3& turn) {
    const double angle = turn.norm();
    return (angle < 1e-4 ? 1.0 : std::sin(angle) / angle) / (4.0 * pi);
  };
  const internal::FloodMeasure share = guide.turns().size() == 2
                                           ? internal::measure(flood, directions)
                                           : internal::measure(flood, internal::orientation_density);
  turning.share = share.value;
  turning.share_error = share.error_estimate;
}

// ------------------------------------------------------------------------------------------- any orientation

// As many places as suit, from how many there are in one orientation.
AnyOrientation any_orientation(const PoseGuide& guide, const PoseFlood& flood, std::int64_t places,
                               const Effort& effort) {
  constexpr double kMore = 3.0;  // times as many places as in one orientation
  const int dimension = guide.moves().empty() ? 0 : static_cast<int>(guide.moves().size());
  const double wanted = static_cast<double>(places) / (dimension == 3 ? 1.0 : 4.0);
  AnyOrientation any{.spacing = fitting_spacing(flood, wanted / kMore)};
  const int stride = dimension == 1 ? 5 : 3;  // of the places where the tool is turned
  const Matrix3& upright = guide.home().tool().rotation;
  const auto turn = [&](const Posture& posture, const Rates&, std::span<double> row) {
    std::ranges::fill(row, kNone);
    for (const int axis : guide.moves()) {
      const auto index = std::lround(posture.tool().position[axis] / any.spacing);
      if (index % stride != 0) return;
    }
    const internal::TurnedPlace here = internal::turn_at(guide, posture, upright);
    row[0] = here.share;
    row[1] = here.every_way;
  };
  const PoseFlood reached = internal::flood_places(
      guide,
      {.spacing = any.spacing, .most = static_cast<std::size_t>(8 * places), .figures = 2, .figure = turn},
      effort);
  any.inside = static_cast<std::int64_t>(reached.points.size());
  const internal::FloodMeasure measure = internal::measure(reached);
  any.measure = measure.value;
  any.error_estimate = measure.error_estimate;
  const PoseChart chart{.origin = guide.home().tool(), .axes = guide.moves()};
  std::vector<double> shares, every_way;
  for (std::size_t p = 0; p < reached.points.size(); ++p) {
    const Vector3 at = chart.at(reached.coordinates(reached.points[p])).position;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = at[static_cast<Eigen::Index>(k)];
      any.range[k] = p == 0 ? Interval{value, value}
                            : Interval{std::min(any.range[k].min, value), std::max(any.range[k].max, value)};
    }
    if (std::isnan(reached.values[1][p])) continue;
    every_way.push_back(reached.values[1][p]);
    if (!std::isnan(reached.values[0][p])) shares.push_back(reached.values[0][p]);
  }
  any.places = static_cast<int>(every_way.size());
  std::ranges::sort(shares);
  if (!shares.empty()) {
    any.share = AnyOrientation::Spread{};
    AnyOrientation::Spread& share = *any.share;
    for (const double value : shares) share.mean += value / static_cast<double>(shares.size());
    share.least = shares.front();
    share.most = shares.back();
  }
  constexpr std::array kAngles = {10.0, 20.0, 30.0, 45.0};  // [deg]
  for (std::size_t k = 0; k < kAngles.size() && any.places > 0; ++k) {
    AnyOrientation::Turned& turned = any.turned[k];
    turned.angle = kAngles[k] * pi / 180.0;
    const auto n = static_cast<double>(any.places);
    const double part = static_cast<double>(std::ranges::count_if(
                            every_way, [&](double angle) { return angle >= turned.angle; })) /
                        n;
    turned.measure = part * any.measure;
    turned.error = any.measure * std::sqrt(part * (1.0 - part) / n);
  }
  return any;
}

// A posture with the tool in an orientation: at home, or at the place of a first look that is nearest to it.
std::optional<Posture> posture_in(const PoseGuide& guide, const Matrix3& orientation, const Effort& effort) {
  constexpr std::size_t kTries = 400;
  const Posture& home = guide.home();
  const Pose& here = home.tool();
  PoseGuide::Step step = guide.step(home, {.position = here.position, .rotation = orientation});
  if (step.inside) return step.posture;
  if (guide.moves().empty()) return std::nullopt;
  const PoseChart chart{.origin = here, .axes = guide.moves()};
  const Look first =
      look(guide, chart, home, chart.coordinates(here.position),
           0.1 * guide.mechanism().characteristic_length(), std::numeric_limits<double>::infinity(), effort);
  std::vector<Vector3> places;
  for (const PoseFlood::Point& point : first.flood.points)
    places.push_back(chart.at(first.flood.coordinates(point)).position);
  std::ranges::stable_sort(places, {}, [&](const Vector3& place) { return (place - here.position).norm(); });
  const std::size_t stride = places.size() / kTries + 1;
  for (std::size_t p = 0; p < places.size(); p += stride) {
    const PoseGuide::Step there = guide.step(home, {.position = places[p], .rotation = here.rotation});
    if (!there.posture) continue;
    step = guide.step(*there.posture, {.position = places[p], .rotation = orientation});
    if (step.inside) return step.posture;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> pose_workspace_obstacle(const Mechanism& mechanism) {
  return PoseGuide::obstacle(mechanism);
}

PoseWorkspace pose_workspace(const Mechanism& mechanism, const PoseWorkspaceOptions& options,
                             const Effort& effort) {
  assert(!pose_workspace_obstacle(mechanism) && options.spacing >= 0.0);
  const PoseGuide guide(mechanism);
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  const auto report = [&](double from, double to) {
    Effort part = quiet;
    if (effort.progress)
      part.progress = [&effort, from, to](double share) { effort.progress(from + share * (to - from)); };
    return part;
  };
  PoseWorkspace workspace;
  workspace.axes = guide.moves();
  workspace.orientation = options.orientation.value_or(guide.home().tool().rotation);
  workspace.turning.orientation = workspace.orientation;
  workspace.turning.position = options.position.value_or(guide.home().tool().position);

  const std::optional<Posture> seed =
      options.orientation ? posture_in(guide, workspace.orientation, quiet) : std::optional(guide.home());
  if (!seed) return workspace;
  workspace.from = seed->tool().position;
  workspace.reached = true;
  if (!options.position && options.orientation) workspace.turning.position = workspace.from;
  const auto turn = [&] {
    if (!options.turning) return;
    const PoseGuide::Step there =
        guide.step(*seed, {.position = workspace.turning.position, .rotation = workspace.orientation});
    workspace.turning.reached = there.inside;
    if (there.inside) turn_round(guide, *there.posture, workspace.turning, quiet);
  };
  const Figures figures(guide, options);
  workspace.characteristic_length = figures.length();
  if (workspace.dimension() == 0) {
    turn();
    const PoseChart turns{.origin = seed->tool(), .axes = guide.turns()};
    const Look first = look(guide, turns, *seed, Vector3::Zero(), 0.1, pi, quiet);
    if (first.flood.points.empty()) return workspace;
    constexpr double kOrientations = 3000.0;
    const PoseFlood flood =
        flood_poses(guide, turns, *seed, Vector3::Zero(),
                    {.spacing = fitting_spacing(first.flood, kOrientations),
                     .most = kMostPlaces,
                     .exits = false,
                     .most_radius = pi,
                     .figures = Figures::count,
                     .figure = [&](const Posture& posture, const Rates& rates,
                                   std::span<double> row) { figures.fill(posture, rates, row); }},
                    quiet);
    workspace.complete = flood.complete;
    std::vector<std::size_t> all(flood.points.size());
    for (std::size_t p = 0; p < all.size(); ++p) all[p] = p;
    workspace.rotation = conditioning_of(turns, flood, all, Figures::rotation);
    put_loads(turns, flood, all, options, workspace);
    return workspace;
  }

  const PoseChart chart{.origin = seed->tool(), .axes = guide.moves()};
  const Vector3 from = chart.coordinates(workspace.from);
  const Look first = look(guide, chart, *seed, from, 0.1 * mechanism.characteristic_length(),
                          std::numeric_limits<double>::infinity(), quiet);
  workspace.complete = first.flood.complete;
  workspace.unbounded = first.unbounded;
  if (!workspace.complete || workspace.unbounded || first.flood.points.empty()) return workspace;
  const double wanted = static_cast<double>(options.places) / (workspace.dimension() == 3 ? 1.0 : 4.0);
  workspace.spacing = options.spacing > 0.0 ? options.spacing : fitting_spacing(first.flood, wanted);
  const double expected = static_cast<double>(first.flood.points.size()) *
                          std::pow(first.flood.spacing / workspace.spacing, workspace.dimension());
  if (expected > static_cast<double>(kMostPlaces))
    throw std::length_error("a lattice this fine has more than two million points in the workspace");

  const PoseFlood flood =
      flood_poses(guide, chart, *seed, from,
                  {.spacing = workspace.spacing,
                   .most = 2 * kMostPlaces,
                   .figures = Figures::count,
                   .figure = [&](const Posture& posture, const Rates& rates,
                                 std::span<double> row) { figures.fill(posture, rates, row); },
                   .expected = static_cast<std::size_t>(expected)},
                  report(0.05, 0.6));
  workspace.complete = flood.complete;
  workspace.inside = static_cast<std::int64_t>(flood.points.size());
  if (!workspace.complete || flood.points.empty()) return workspace;

  std::vector<std::size_t> order(flood.points.size());
  for (std::size_t p = 0; p < order.size(); ++p) order[p] = p;
  std::ranges::sort(order, {}, [&](std::size_t p) { return flood.points[p].at; });
  for (const std::size_t p : order) {
    workspace.places.push_back(chart.at(flood.coordinates(flood.points[p])).position);
    workspace.conditioning.push_back(flood.values[Figures::homogeneous][p]);
  }
  workspace.translation = conditioning_of(chart, flood, order, Figures::translation);
  workspace.rotation = conditioning_of(chart, flood, order, Figures::rotation);
  workspace.homogeneous = conditioning_of(chart, flood, order, Figures::homogeneous);
  put_loads(chart, flood, order, options, workspace);
  const internal::FloodMeasure measure = internal::measure(flood);
  workspace.measure = measure.value;
  workspace.error_estimate = measure.error_estimate;

  // Ends of the ranges, shapes and turns do not wait for each other.
  const int dimension = workspace.dimension();
  Vector3 low = from, high = from;
  const internal::RegionLattice lattice = lattice_of(first.flood);
  const double scale = lattice.spacing * *std::ranges::max_element(lattice.count);
  constexpr std::size_t kShapes = 2;
  const std::size_t ends = 2 * static_cast<std::size_t>(dimension),
                    shapes = dimension > 1 && options.shapes ? kShapes : 0;
  workspace.complete = internal::for_each_index(shapes + ends + 1, report(0.6, 0.9), [&](std::size_t task) {
    PoseRegion region(guide, chart, *seed);
    if (task < shapes) {
      InscribedShape& shape = task == 0 ? workspace.inscribed.sphere : workspace.inscribed.cube;
      shape = internal::largest_shape(region, task == 1, lattice, scale, 1);
      shape.centre = chart.at(shape.centre).position;
    } else if (task < shapes + ends) {
      const auto axis = static_cast<int>((task - shapes) / 2);
      const bool up = (task - shapes) % 2 == 1;
      (up ? high : low)[axis] = farthest(region, flood, axis, up, options.shapes);
    } else {
      turn();
    }
  });
  for (int k = 0; k < 3; ++k) workspace.range[k] = {workspace.from[k], workspace.from[k]};
  for (int k = 0; k < dimension; ++k)
    workspace.range[static_cast<std::size_t>(workspace.axes[static_cast<std::size_t>(k)])] = {low[k], high[k]};
  if (options.slice_points > 1 && dimension > 1) {
    const double longest = (high - low).maxCoeff(), spacing = longest / options.slice_points;
    const std::vector<int>& axes = workspace.axes;
    if (dimension == 2) {
      workspace.slices.push_back(slice_of(guide, seed->tool(), *seed, axes[0], axes[1], 3 - axes[0] - axes[1],
                                          spacing, figures, quiet));
    } else {
      for (const int normal : {0, 1, 2}) {
        workspace.slices.push_back(slice_of(guide, seed->tool(), *seed, normal == 0 ? 1 : 0,
                                            normal == 2 ? 1 : 2, normal, spacing, figures, quiet));
      }
    }
  }
  if (options.any_places > 0 && !guide.turns().empty())
    workspace.any = any_orientation(guide, flood, options.any_places, report(0.9, 1.0));
  if (effort.progress) effort.progress(1.0);
  workspace.complete = effort.cancel == nullptr || !effort.cancel->load();
  return workspace;
}

}  // namespace zwidth
