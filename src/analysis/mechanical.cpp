#include "zwidth/analysis/mechanical.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/analysis/internal/climb.h"
#include "zwidth/analysis/internal/lattice.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/internal/posture_statistic.h"
#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/internal/quantiles.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/vibration.h"

namespace zwidth {
namespace {

constexpr double kNothing = 1e-9;   // share of the largest mass that counts as none
constexpr double kSingular = 1e-6;  // of the largest mobility: too heavy to be moved at all
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

void put(MechanicalValues& values, MechanicalFigure first, int offset, double value) {
  values[static_cast<std::size_t>(first) + static_cast<std::size_t>(offset)] = value;
}

// Least and largest of a symmetric matrix.
Interval principal(const ToolMatrix& A) {
  if (A.rows() == 3) {
    const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(Matrix3(A), Eigen::EigenvaluesOnly);
    return {eigen.eigenvalues()[0], eigen.eigenvalues()[2]};
  }
  const Eigen::SelfAdjointEigenSolver<ToolMatrix> eigen(A, Eigen::EigenvaluesOnly);
  return {eigen.eigenvalues()[0], eigen.eigenvalues()[A.rows() - 1]};
}

void put_stiffness(const Mechanism& mechanism, const Compliance& compliance, MechanicalValues& values) {
  const int linear = mechanism.linear_rows();
  const std::span<const int> axes = mechanism.tool_axes();
  ToolMatrix C(linear, linear);
  for (int r = 0; r < linear; ++r) {
    for (int c = 0; c < linear; ++c)
      C(r, c) = compliance.matrix(axes[static_cast<std::size_t>(r)], axes[static_cast<std::size_t>(c)]);
    put(values, MechanicalFigure::stiffness_x, axes[static_cast<std::size_t>(r)], 1.0 / C(r, r));
  }
  const Interval give = principal(C);
  put(values, MechanicalFigure::softest, 0, 1.0 / give.max);
  put(values, MechanicalFigure::stiffest, 0, 1.0 / give.min);
}

void put_masses(const Mechanism& mechanism, const ToolMatrix& mobility, MechanicalValues& values) {
  const int linear = mechanism.linear_rows();
  const ToolMatrix W = mobility.topLeftCorner(linear, linear);
  const Interval range = principal(W);
  const auto mass = [&](double w) { return w > kSingular * range.max ? 1.0 / w : kUnknown; };
  for (int r = 0; r < linear; ++r)
    put(values, MechanicalFigure::mass_x, mechanism.tool_axes()[static_cast<std::size_t>(r)], mass(W(r, r)));
  put(values, MechanicalFigure::lightest, 0, mass(range.max));
  put(values, MechanicalFigure::heaviest, 0, mass(range.min));
}

// What gives: the same in every posture.
std::optional<Elasticity> elasticity_of(const Mechanism& mechanism, const Drives& drives) {
  for (std::int64_t sample = 0; sample < 100; ++sample) {
    const Solution solution = solve_forward(mechanism, spread_posture(mechanism, sample));
    if (!solution) continue;
    if (const auto known = known_stiffness(*solution.posture, drives)) return known->of;
  }
  return std::nullopt;
}

// What the continuous torques give the tool in every direction; nothing unless all drives are known.
std::optional<double> acceleration_of(const Posture& posture, const Drives& drives, const Rates& rate,
                                      const ActiveMatrix& M) {
  const Mechanism& mechanism = posture.mechanism();
  const int n = mechanism.active_count(), linear = mechanism.linear_rows();
  ActiveVector limit = ActiveVector::Zero(n);
  for (int i = 0; i < n; ++i) {
    const auto& drive = drives[static_cast<std::size_t>(i)];
    if (!drive && !mechanism.is_free(i)) return std::nullopt;
    if (drive) limit[i] = drive->continuous_torque().usable;
  }
  const TorqueRange left = TorqueRange::symmetric(limit).beside(gravity_torques(posture, rate));
  const Jacobian response = M.ldlt().solve(rate.tool.topRows(linear).transpose()).transpose();
  if (n != linear) return zonotope({response, left.min, left.max}).inner_radius;
  // As many joints as directions: a parallelepiped, whose faces are those of one torque at its limit each.
  const Eigen::FullPivLU<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>> lu(response);
  if (!lu.isInvertible()) return 0.0;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> inverse = lu.inverse();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i)
    least = std::min(least, std::min(left.max[i], -left.min[i]) / inverse.row(i).norm());
  return std::max(0.0, least);
}

// A figure, with masses that are too large to be moved as infinite.
double climbed(const MechanicalValues& values, std::size_t f) {
  const auto first = static_cast<std::size_t>(MechanicalFigure::mass_x),
             last = static_cast<std::size_t>(MechanicalFigure::heaviest);
  const bool mass = f >= first && f <= last;
  if (mass && std::isnan(values[f]) && std::isfinite(figure(values, MechanicalFigure::lightest)))
    return std::numeric_limits<double>::infinity();
  return values[f];
}

struct Builders {
  std::int64_t inside = 0;
  std::array<internal::StatisticBuilder, kMechanicalFigureCount> figures;
  std::array<std::vector<double>, kMechanicalFigureCount> values;

  void add(const MechanicalValues& of_one, const Vector3& at) {
    ++inside;
    for (std::size_t f = 0; f < of_one.size(); ++f) {
      if (!std::isfinite(of_one[f])) continue;
      figures[f].add(of_one[f], at);
      values[f].push_back(of_one[f]);
    }
  }
  void add(const Builders& other) {
    inside += other.inside;
    for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) {
      figures[f].add(other.figures[f]);
      values[f].insert(values[f].end(), other.values[f].begin(), other.values[f].end());
    }
  }
};

}  // namespace

ActiveVector drive_stiffness(const Posture& posture, const Drives& drives) {
  const Mechanism& mechanism = posture.mechanism();
  const ActiveVector joints = posture.active();
  ActiveVector stiffness =
      ActiveVector::Constant(mechanism.active_count(), std::numeric_limits<double>::infinity());
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (mechanism.is_free(i)) continue;
    const auto& drive = drives[static_cast<std::size_t>(i)];
    const std::optional<double> known = drive ? drive->joint_stiffness(joints[i]) : std::nullopt;
    if (!known) return {};
    stiffness[i] = *known;
  }
  return stiffness;
}

const FigureInfo& mechanical_figure_info(int index) {
  static constexpr std::array<FigureInfo, kMechanicalFigureCount> kInfo = {{
      {"stiffness_x", "N/m", "stiffness along x"},
      {"stiffness_y", "N/m", "stiffness along y"},
      {"stiffness_z", "N/m", "stiffness along z"},
      {"softest", "N/m", "stiffness in the softest direction"},
      {"stiffest", "N/m", "stiffness in the stiffest direction"},
      {"mass_x", "kg", "apparent mass along x"},
      {"mass_y", "kg", "apparent mass along y"},
      {"mass_z", "kg", "apparent mass along z"},
      {"lightest", "kg", "apparent mass in the lightest direction"},
      {"heaviest", "kg", "apparent mass in the heaviest direction"},
      {"frequency_held", "rad/s", "lowest natural frequency, motors held"},
      {"frequency_free", "rad/s", "lowest natural frequency, motors free"},
      {"acceleration", "m/s^2", "acceleration in every direction"},
      {"gravity_torque", "N m", "torque against gravity"},
  }};
  return kInfo[static_cast<std::size_t>(index)];
}

std::optional<KnownStiffness> known_stiffness(const Posture& posture, const Drives& drives) {
  const bool beams = !posture.mechanism().beams().empty();
  KnownStiffness known;
  known.options.drive_stiffness = drive_stiffness(posture, drives);
  if (known.options.drive_stiffness.size() > 0) {
    known.stiffness = stiffness(posture, known.options);
    known.of = beams ? Elasticity::both : Elasticity::drives;
    if (!known.stiffness.rigid) return known;
  }
  if (!beams) return std::nullopt;
  known.options = {};
  known.of = Elasticity::links;
  known.stiffness = stiffness(posture);
  if (known.stiffness.rigid) return std::nullopt;
  return known;
}

MechanicalValues mechanical_figures(const Posture& posture, const Drives& drives) {
  const Mechanism& mechanism = posture.mechanism();
  MechanicalValues values;
  values.fill(kUnknown);
  if (mechanism.linear_rows() == 0) return values;

  std::optional<ToolMatrix> felt;
  if (const std::optional<KnownStiffness> known = known_stiffness(posture, drives)) {
    const Compliance give = compliance(known->stiffness, mechanism.characteristic_length());
    felt = felt_stiffness(mechanism, give);
    if (felt) put_stiffness(mechanism, give, values);
  }

  const Rates rate = rates(posture);
  if (!mechanism.bodies().empty())
    put(values, MechanicalFigure::gravity_torque, 0, gravity_torques(posture, rate).cwiseAbs().maxCoeff());
  ActiveMatrix M = mass_matrix(posture, rate);
  if (!(M.diagonal().minCoeff() > 0.0)) return values;
  put_masses(mechanism, tool_mobility(rate.tool, M), values);
  if (const auto acceleration = acceleration_of(posture, drives, rate, M))
    put(values, MechanicalFigure::acceleration, 0, *acceleration);
  if (!felt) return values;

  M.diagonal() -= mechanism.drive_inertia();
  if (!(M.diagonal().minCoeff() > kNothing * M.diagonal().maxCoeff())) return values;
  const ToolMatrix links = tool_mobility(rate.tool, M);
  if (const auto held = modes_by_mobility(*felt, links))
    put(values, MechanicalFigure::frequency_held, 0, held->frequencies[0]);
  if (!(mechanism.drive_inertia().minCoeff() > 0.0)) return values;
  const ActiveMatrix rotors = mechanism.drive_inertia().asDiagonal();
  if (const auto free = modes_by_mobility(*felt, links + tool_mobility(rate.tool, rotors)))
    put(values, MechanicalFigure::frequency_free, 0, free->frequencies[0]);
  return values;
}

MechanicalSweep sweep_mechanics(const Mechanism& mechanism, const Drives& drives, double spacing,
                                const Effort& effort) {
  assert(!workspace_obstacle(mechanism) && spacing > 0.0);
  const auto box = internal::lattice_box(mechanism, spacing);
  std::vector<Builders> planes(static_cast<std::size_t>(internal::size(box[0])));
  MechanicalSweep sweep;
  sweep.spacing = spacing;
  const internal::Probe fresh(mechanism);
  sweep.complete = internal::for_each_index(planes.size(), effort, [&](std::size_t index) {
    internal::Probe probe = fresh;
    const double x = static_cast<double>(box[0].first + static_cast<std::int64_t>(index)) * spacing;
    for (std::int64_t j = box[1].first; j <= box[1].last; ++j) {
      if (probe.dimension() == 3) probe.restart();
      for (std::int64_t k = box[2].first; k <= box[2].last; ++k) {
        const Vector3 point(x, static_cast<double>(j) * spacing, static_cast<double>(k) * spacing);
        if (!probe.inverse(point).inside) continue;
        if (const auto posture = probe.posture(point))
          planes[index].add(mechanical_figures(*posture, drives), point);
      }
    }
  });
  Builders total;
  for (const Builders& plane : planes) total.add(plane);
  sweep.inside = total.inside;
  if (total.figures[static_cast<std::size_t>(MechanicalFigure::softest)].result().count > 0)
    sweep.of = elasticity_of(mechanism, drives);
  for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) {
    sweep.figures[f] = total.figures[f].result();
    internal::put_quantiles(total.values[f], sweep.figures[f]);
  }
  if (!sweep.complete) return sweep;
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  sweep.complete = internal::for_each_index(kMechanicalFigureCount, quiet, [&](std::size_t f) {
    Statistic& statistic = sweep.figures[f];
    if (statistic.count == 0) return;
    internal::Probe probe = fresh;
    const auto joints_at = [&probe](const Vector3& place) {
      probe.restart();
      return ActiveVector(probe.inverse(place).joints.head(probe.dimension()));
    };
    const auto place_of = [&probe](const ActiveVector& joints) -> Vector3 {
      Vector3 all = Vector3::Zero();
      all.head(joints.size()) = joints;
      return probe.forward(all).position;
    };
    const auto figure = [&](const ActiveVector& joints) {
      Vector3 all = Vector3::Zero();
      all.head(joints.size()) = joints;
      const internal::Probe::Answer answer = probe.forward(all);
      if (!answer.inside) return kUnknown;
      const std::optional<Posture> posture = probe.posture(answer.position);
      return posture ? climbed(mechanical_figures(*posture, drives), f) : kUnknown;
    };
    const ActiveVector least = joints_at(statistic.min_at), largest = joints_at(statistic.max_at);
    internal::refine(statistic, mechanism, least, largest, figure, place_of);
  });
  return sweep;
}

std::vector<MechanicalValues> map_mechanics(const Mechanism& mechanism, const Drives& drives,
                                            std::span<const Vector3> positions, const Effort& effort) {
  assert(!workspace_obstacle(mechanism));
  constexpr std::size_t kBlock = 512;  // positions that follow each other from one start
  MechanicalValues nothing;
  nothing.fill(kUnknown);
  std::vector<MechanicalValues> map(positions.size(), nothing);
  const internal::Probe fresh(mechanism);
  const bool complete =
      internal::for_each_index((positions.size() + kBlock - 1) / kBlock, effort, [&](std::size_t block) {
        internal::Probe probe = fresh;
        const std::size_t end = std::min(positions.size(), (block + 1) * kBlock);
        for (std::size_t p = block * kBlock; p < end; ++p) {
          if (!probe.inverse(positions[p]).inside) continue;
          if (const auto posture = probe.posture(positions[p])) map[p] = mechanical_figures(*posture, drives);
        }
      });
  if (!complete) map.clear();
  return map;
}

MechanicalPostures sweep_mechanics_of_postures(const Mechanism& mechanism, const Drives& drives,
                                               std::int64_t samples, const Effort& effort) {
  constexpr std::int64_t kBlock = 64;
  struct Found {
    ActiveVector at;
    MechanicalValues values;
  };
  std::vector<std::vector<Found>> blocks(static_cast<std::size_t>((samples + kBlock - 1) / kBlock));
  MechanicalPostures sweep;
  sweep.complete = internal::for_each_index(blocks.size(), effort, [&](std::size_t b) {
    const std::int64_t first = static_cast<std::int64_t>(b) * kBlock;
    for (std::int64_t sample = first; sample < std::min(first + kBlock, samples); ++sample) {
      const Solution solution = solve_forward(mechanism, spread_posture(mechanism, sample));
      if (solution && solution.status != SolveStatus::joint_limit)
        blocks[b].push_back({solution.posture->active(), mechanical_figures(*solution.posture, drives)});
    }
  });
  std::array<std::vector<double>, kMechanicalFigureCount> values;
  for (const std::vector<Found>& block : blocks) {
    for (const Found& one : block) {
      ++sweep.solved;
      for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) {
        if (!std::isfinite(one.values[f])) continue;
        internal::add(sweep.figures[f], one.values[f], one.at);
        values[f].push_back(one.values[f]);
      }
    }
  }
  if (sweep[MechanicalFigure::softest].count > 0) sweep.of = elasticity_of(mechanism, drives);
  for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) internal::put_quantiles(values[f], sweep.figures[f]);
  if (!sweep.complete) return sweep;
  const Effort quiet{.threads = effort.threads, .cancel = effort.cancel};
  sweep.complete = internal::for_each_index(kMechanicalFigureCount, quiet, [&](std::size_t f) {
    std::optional<Posture> last;
    const auto figure = [&](const ActiveVector& joints) {
      const SolveOptions follow{.start = last ? &*last : nullptr, .restart = false, .max_iterations = 60};
      const Solution solution = solve_forward(mechanism, joints, last ? follow : SolveOptions{});
      if (!solution || solution.status == SolveStatus::joint_limit) return kUnknown;
      last = *solution.posture;
      return climbed(mechanical_figures(*last, drives), f);
    };
    const ActiveVector least = sweep.figures[f].min_at, largest = sweep.figures[f].max_at;
    internal::refine(sweep.figures[f], mechanism, least, largest, figure,
                     [](const ActiveVector& joints) { return joints; });
  });
  return sweep;
}

MechanicalCut cut_mechanics(const Mechanism& mechanism, const Drives& drives, const SliceMap& map, int stride,
                            const Effort& effort) {
  assert(stride > 0);
  MechanicalCut cut;
  cut.slice = map.slice;
  cut.nu = map.nu > 0 ? (map.nu - 1) / stride + 1 : 0;
  cut.nv = map.nv > 0 ? (map.nv - 1) / stride + 1 : 0;
  const auto at = [stride](const Interval& range, int count, int index) {
    return range.min + (count > 1 ? range.width() * index * stride / (count - 1) : 0.0);
  };
  cut.u_range = {at(map.u_range, map.nu, 0), at(map.u_range, map.nu, cut.nu - 1)};
  cut.v_range = {at(map.v_range, map.nv, 0), at(map.v_range, map.nv, cut.nv - 1)};
  const auto size = static_cast<std::size_t>(cut.nu) * static_cast<std::size_t>(cut.nv);
  std::vector<Vector3> points;
  std::vector<std::size_t> places;
  for (int v = 0; v < cut.nv; ++v) {
    for (int u = 0; u < cut.nu; ++u) {
      const auto of_map = static_cast<std::size_t>(v * stride) * static_cast<std::size_t>(map.nu) +
                          static_cast<std::size_t>(u * stride);
      if (std::isnan(map.values[static_cast<std::size_t>(Figure::condition_number)][of_map])) continue;
      Vector3& point = points.emplace_back();
      point[map.slice.axis] = map.slice.at;
      point[map.slice.u] = at(map.u_range, map.nu, u);
      point[map.slice.v] = at(map.v_range, map.nv, v);
      places.push_back(static_cast<std::size_t>(v) * static_cast<std::size_t>(cut.nu) +
                       static_cast<std::size_t>(u));
    }
  }
  for (std::vector<double>& values : cut.values) values.assign(size, kUnknown);
  const std::vector<MechanicalValues> found = map_mechanics(mechanism, drives, points, effort);
  for (std::size_t p = 0; p < found.size(); ++p) {
    for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) cut.values[f][places[p]] = found[p][f];
  }
  return cut;
}

void add_mechanics(const Mechanism& mechanism, const Drives& drives, WorkspaceMap& map, const Effort& effort) {
  const std::vector<MechanicalValues> found = map_mechanics(mechanism, drives, map.positions, effort);
  if (found.size() != map.positions.size()) {
    map.complete = false;
    return;
  }
  std::vector<std::size_t> known;
  for (std::size_t f = 0; f < kMechanicalFigureCount; ++f) {
    const auto has = [f](const MechanicalValues& values) { return !std::isnan(values[f]); };
    if (!std::any_of(found.begin(), found.end(), has)) continue;
    known.push_back(f);
    map.more_names.emplace_back(mechanical_figure_info(static_cast<int>(f)).name);
  }
  map.more.reserve(known.size() * found.size());
  for (const MechanicalValues& values : found) {
    for (const std::size_t f : known) map.more.push_back(values[f]);
  }
}

}  // namespace zwidth
