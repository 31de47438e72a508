#include "zwidth/mechanism/singularity.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "zwidth/mechanism/internal/closure_equations.h"
#include "zwidth/mechanism/internal/posture_builder.h"
#include "zwidth/mechanism/mobility.h"

namespace zwidth {
namespace {

using Svd = Eigen::JacobiSVD<Eigen::MatrixXd>;

constexpr double kRounding = 1e-11;  // of the largest singular value: below, equations repeat others

// A basis of what the equations leave open in the unknowns `columns`, orthonormal.
Eigen::MatrixXd left_open(const Eigen::MatrixXd& equations, const std::vector<int>& columns) {
  const Svd svd(equations(Eigen::all, columns), Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < svd.singularValues().size() && svd.singularValues()[rank] > kRounding * svd.singularValues()[0])
    ++rank;
  return svd.matrixV().rightCols(static_cast<Eigen::Index>(columns.size()) - rank);
}

// The platform's part of all motions of the mechanism, rows as the tool's: its singular values compare the way
// of the tool with that of everything.
Svd tool_motions(const Posture& posture) {
  const internal::Unknowns of = internal::unknowns_of(posture.mechanism());
  std::vector<int> columns = of.joints;
  columns.insert(columns.end(), of.declared.begin(), of.declared.end());
  const Eigen::MatrixXd motions = left_open(internal::closure_equations(posture), columns);
  const auto rows = static_cast<Eigen::Index>(of.declared.size());
  if (motions.cols() == 0) return Svd(Eigen::MatrixXd::Zero(rows, 1), Eigen::ComputeFullU);
  return Svd(motions.bottomRows(rows), Eigen::ComputeFullU);
}

double value(const Svd& svd, Eigen::Index i) {
  return i < svd.singularValues().size() ? svd.singularValues()[i] : 0.0;
}

// How far the tool goes along its way i for joints that go a unit, relative to the easiest way, or to what a
// lever would give where all are hard.
double ease(const Svd& motions, Eigen::Index i, const Mechanism& mechanism) {
  constexpr double kLever = 0.2;  // of the longest link
  return value(motions, i) / std::max(value(motions, 0), kLever * mechanism.characteristic_length());
}

// How many ways of the tool are worth counting.
Eigen::Index ways(const Svd& motions, const Mechanism& mechanism, double tolerance) {
  Eigen::Index count = 0;
  while (count < motions.matrixU().rows() && ease(motions, count, mechanism) > tolerance) ++count;
  return count;
}

// Legs that cannot follow the platform along `direction`, or hardly.
std::vector<int> barring_legs(const Posture& posture, const ToolVector& direction) {
  constexpr double kHardly = 1e-4, kMuch = 0.1;
  const Mechanism& mechanism = posture.mechanism();
  std::vector<int> legs;
  std::array<double, 6> column;
  std::array<std::array<double, 6>, 6> platform;
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    const int rows = internal::closure_rows(leg);
    Eigen::MatrixXd A(rows, leg.count);
    for (int j = 0; j < leg.count; ++j) {
      internal::closure_column(posture, l, leg.first + j, column);
      for (int i = 0; i < rows; ++i) A(i, j) = column[i];
    }
    Eigen::VectorXd b = Eigen::VectorXd::Zero(rows);
    internal::platform_columns(posture, l, platform);
    for (Eigen::Index c = 0; c < direction.size(); ++c) {
      for (int i = 0; i < rows; ++i) b[i] += platform[static_cast<std::size_t>(c)][i] * direction[c];
    }
    const Svd svd(A, Eigen::ComputeFullU);
    Eigen::Index rank = 0;
    while (value(svd, rank) > kHardly * value(svd, 0)) ++rank;
    if ((svd.matrixU().rightCols(rows - rank).transpose() * b).norm() > kMuch * b.norm()) legs.push_back(l);
  }
  return legs;
}

// The ways that the mechanism has beside this posture and lacks here: of the first `freedoms` columns of what
// it has there, the parts across the first `rank` of what it has here.
std::vector<ToolVector> missing(const Posture& posture, const Svd& here, Eigen::Index rank,
                                Eigen::Index freedoms) {
  constexpr double kAside = 1e-5;  // [rad] or characteristic lengths
  const Mechanism& mechanism = posture.mechanism();
  for (unsigned signs = 0; signs < 8U; ++signs) {
    ActiveVector active = posture.active();
    for (Eigen::Index i = 0; i < active.size(); ++i) {
      const bool slides =
          mechanism.joints()[mechanism.active_joint(static_cast<int>(i))].type == JointType::prismatic;
      const double step =
          kAside * (1.0 + 0.1 * static_cast<double>(i)) * (slides ? mechanism.characteristic_length() : 1.0);
      active[i] += (signs >> (i % 3) & 1U) != 0 ? -step : step;
    }
    const Solution aside =
        solve_forward(mechanism, active, {.start = &posture, .closed_form = false, .restart = false});
    if (!aside) continue;
    const Svd there = tool_motions(*aside.posture);
    const Eigen::MatrixXd had = there.matrixU().leftCols(freedoms), has = here.matrixU().leftCols(rank);
    const Svd gap(had - has * (has.transpose() * had), Eigen::ComputeThinU);
    std::vector<ToolVector> ways;
    for (Eigen::Index i = 0; i < freedoms - rank; ++i) ways.emplace_back(gap.matrixU().col(i));
    return ways;
  }
  return {};
}

}  // namespace

SingularDirections singular_directions(const Posture& posture, double tolerance) {
  const Mechanism& mechanism = posture.mechanism();
  SingularDirections result;

  const Svd motions = tool_motions(posture);
  const Eigen::Index rows = motions.matrixU().rows();
  const Eigen::Index rank = ways(motions, mechanism, tolerance);
  if (rank < rows) {
    constexpr int kOthers = 6;
    constexpr double kOwn = 1e-7;
    const MobilitySample sample = sample_mobility(mechanism, kOthers);
    const Eigen::Index has =
        sample.posture.empty() ? rows : ways(tool_motions(sample.posture[0]), mechanism, kOwn);
    const Eigen::Index freedoms = std::min(rows, has);
    if (freedoms == rows) {
      for (Eigen::Index i = rows - 1; i >= rank; --i)
        result.lost.push_back({motions.matrixU().col(i), ease(motions, i, mechanism)});
    } else if (rank < freedoms) {
      for (const ToolVector& way : missing(posture, motions, rank, freedoms)) result.lost.push_back({way, 0.0});
    }
  }
  for (SingularDirection& one : result.lost) one.legs = barring_legs(posture, one.direction);

  // What the equations hardly hold, the active joints at rest.
  const internal::Unknowns of = internal::unknowns_of(mechanism);
  std::vector<int> columns = of.passive;
  columns.insert(columns.end(), of.declared.begin(), of.declared.end());
  const Svd held(internal::closure_equations(posture)(Eigen::all, columns), Eigen::ComputeFullV);
  const auto unknowns = static_cast<Eigen::Index>(columns.size());
  for (Eigen::Index i = unknowns - 1; i >= 0; --i) {
    const double measure = value(held, i) / std::max(value(held, 0), 1e-300);
    if (measure > tolerance) break;
    const ToolVector way = held.matrixV().col(i).tail(static_cast<Eigen::Index>(of.declared.size()));
    // Motions of passive joints alone are nothing to the tool.
    constexpr double kStill = 1e-4;
    if (way.norm() > kStill) result.gained.push_back({way.normalized(), measure});
  }
  return result;
}

}  // namespace zwidth
