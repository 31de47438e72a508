#include "zwidth/analysis/internal/any_orientation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/analysis/internal/parallel.h"

namespace zwidth::internal {
namespace {

using std::numbers::pi;

Matrix3 turned(const Matrix3& rotation, const Vector3& turn) {
  const double angle = turn.norm();
  return angle > 0.0 ? Matrix3(Eigen::AngleAxisd(angle, turn / angle) * rotation) : rotation;
}

// Rotation vector from one orientation to another, base frame.
Vector3 turn_between(const Matrix3& from, const Matrix3& to) {
  const Eigen::AngleAxisd turn(Matrix3(to * from.transpose()));
  return turn.angle() * turn.axis();
}

// How far every joint is beyond its range.
Eigen::VectorXd excess(const Posture& posture) {
  const std::vector<JointModel>& joints = posture.mechanism().joints();
  Eigen::VectorXd beyond = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const double value = posture.joints()[at];
    beyond[at] = std::max(0.0, value - joints[j].range.max) - std::max(0.0, joints[j].range.min - value);
  }
  return beyond;
}

// The turn of the tool that brings joints back that are beyond their ranges, to first order and a little more;
// zero if none does.
Vector3 turn_back(const PoseGuide& guide, const Posture& posture) {
  constexpr double kMost = 0.3, kOver = 1.05;
  const auto turns = static_cast<Eigen::Index>(guide.turns().size());
  const Rates rate = rates(posture);
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(guide.rows(rate.tool));
  const Eigen::MatrixXd ways = inverse.pseudoInverse().rightCols(turns);
  Eigen::MatrixXd A = rate.joints * ways;
  const Eigen::VectorXd beyond = excess(posture);
  const double length = guide.mechanism().characteristic_length();
  Eigen::VectorXd wanted = beyond;
  for (Eigen::Index j = 0; j < A.rows(); ++j) {
    const bool slides = guide.mechanism().joints()[static_cast<std::size_t>(j)].type == JointType::prismatic;
    const double unit = slides ? 1.0 / length : 1.0;
    A.row(j) *= beyond[j] == 0.0 ? 0.0 : unit;
    wanted[j] *= unit;
  }
  Eigen::MatrixXd normal = A.transpose() * A;
  normal.diagonal().array() += 1e-6 * normal.trace() + 1e-30;
  const Eigen::VectorXd turn = -kOver * normal.ldlt().solve(A.transpose() * wanted);
  Vector3 result = Vector3::Zero();
  for (Eigen::Index t = 0; t < turns; ++t) result[guide.turns()[static_cast<std::size_t>(t)] - 3] = turn[t];
  if (!result.allFinite()) return Vector3::Zero();
  return result.norm() > kMost ? Vector3(result * (kMost / result.norm())) : result;
}

// Directions to turn in, spread over the ways that the tool has.
std::vector<Vector3> ways_to_turn(const PoseGuide& guide) {
  std::vector<Vector3> ways;
  const std::vector<int>& turns = guide.turns();
  const auto add = [&](const Vector3& components) {
    Vector3 way = Vector3::Zero();
    for (std::size_t t = 0; t < turns.size(); ++t) way[turns[t] - 3] = components[static_cast<Eigen::Index>(t)];
    ways.push_back(way.normalized());
  };
  for (int x = -1; x <= 1; ++x) {
    for (int y = turns.size() > 1 ? -1 : 0; y <= (turns.size() > 1 ? 1 : 0); ++y) {
      for (int z = turns.size() > 2 ? -1 : 0; z <= (turns.size() > 2 ? 1 : 0); ++z) {
        if (x != 0 || y != 0 || z != 0)
          add({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
      }
    }
  }
  return ways;
}

// How far the tool turns one way from a posture.
double turn_along(const PoseGuide& guide, const Posture& from, const Vector3& way) {
  constexpr double kStep = pi / 18.0;
  const Pose& origin = from.tool();
  Posture last = from;
  double in = 0.0, out = 0.0;
  while (out <= in && in < pi) {
    const double next = std::min(in + kStep, pi);
    PoseGuide::Step step = guide.step(last, {origin.position, turned(origin.rotation, next * way)});
    if (step.inside) {
      last = *step.posture;
      in = next;
    } else {
      out = next;
    }
  }
  for (int halving = 0; halving < 5 && out > in; ++halving) {
    const double middle = 0.5 * (in + out);
    PoseGuide::Step step = guide.step(last, {origin.position, turned(origin.rotation, middle * way)});
    if (step.inside) last = *step.posture;
    (step.inside ? in : out) = middle;
  }
  return in;
}

}  // namespace

double orientation_density(const Vector3& turn) {
  const double angle = turn.norm();
  const double ratio = angle < 1e-4 ? 1.0 : 2.0 * (1.0 - std::cos(angle)) / (angle * angle);
  return ratio / (8.0 * pi * pi);
}

PoseGuide::Step lead_anyhow(const PoseGuide& guide, const Posture& from, const Vector3& position) {
  constexpr int kRounds = 8;
  Matrix3 rotation = from.tool().rotation;
  PoseGuide::Step step = guide.step(from, {position, rotation});
  if (step.inside) return step;
  // Where the loops do not close, a leg is too short or too long: turn it the other way.
  constexpr double kTry = 0.2;
  for (std::size_t t = 0; t < guide.turns().size() && !step.posture; ++t) {
    for (const double sign : {1.0, -1.0}) {
      const Matrix3 other = turned(from.tool().rotation, sign * kTry * Vector3::Unit(guide.turns()[t] - 3));
      step = guide.step(from, {position, other});
      if (step.inside) return step;
      if (!step.posture) continue;
      rotation = other;
      break;
    }
  }
  for (int round = 0; round < kRounds && step.posture; ++round) {
    const Vector3 turn = turn_back(guide, *step.posture);
    if (!(turn.norm() > 1e-6)) break;
    const Posture at = *step.posture;
    rotation = turned(rotation, turn);
    step = guide.step(at, {position, rotation});
    if (step.inside) return step;
  }
  return {};
}

PoseFlood flood_places(const PoseGuide& guide, const PoseFloodOptions& options, const Effort& effort) {
  const PoseChart chart{.origin = guide.home().tool(), .axes = guide.moves()};
  PoseFloodOptions anyhow = options;
  anyhow.exits = false;
  anyhow.lead = [&guide](const Posture& from, const Pose& to) { return lead_anyhow(guide, from, to.position); };
  return flood_poses(guide, chart, guide.home(), chart.coordinates(guide.home().tool().position), anyhow,
                     effort);
}

TurnedPlace turn_at(const PoseGuide& guide, const Posture& place, const Matrix3& upright) {
  const Pose& here = place.tool();
  TurnedPlace result;
  const std::size_t turns = guide.turns().size();
  const PoseChart chart{.origin = here, .axes = guide.turns()};
  if (turns == 2) {
    result.share = std::numeric_limits<double>::quiet_NaN();
  } else {
    const PoseFlood flood = flood_poses(
        guide, chart, place, Vector3::Zero(),
        {.spacing = turns == 1 ? 0.05 : 0.2, .exits = turns == 1, .most_radius = pi}, {.threads = 1});
    result.share = turns == 1 ? measure(flood).value / (2.0 * pi) : measure(flood, orientation_density).value;
    result.share = std::min(1.0, result.share);
  }
  // Upright first, by short steps.
  const Vector3 way = turn_between(here.rotation, upright);
  const int steps = static_cast<int>(std::ceil(way.norm() / 0.15));
  Posture last = place;
  for (int s = 1; s <= steps; ++s) {
    const PoseGuide::Step step =
        guide.step(last, {here.position, turned(here.rotation, way * (static_cast<double>(s) / steps))});
    if (!step.inside) return result;
    last = *step.posture;
  }
  result.every_way = pi;
  for (const Vector3& direction : ways_to_turn(guide))
    result.every_way = std::min(result.every_way, turn_along(guide, last, direction));
  return result;
}

}  // namespace zwidth::internal
