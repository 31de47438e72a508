#include "zwidth/mechanism/mobility.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <tuple>

#include "zwidth/mechanism/internal/closure_equations.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth {
namespace {

using internal::closure_equations;
using internal::held_rigidly;
using internal::PostureBuilder;
using internal::Unknowns;
using internal::unknowns_of;

constexpr double kRankTolerance = 1e-8;  // of the largest pivot

int rank(const Eigen::MatrixXd& equations, const std::vector<int>& columns) {
  if (columns.empty() || equations.rows() == 0) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kRankTolerance);
  qr.compute(equations(Eigen::all, columns));
  return static_cast<int>(qr.rank());
}

// Freedoms left in the unknowns `columns`, the others being held.
int freedoms(const Eigen::MatrixXd& equations, const std::vector<int>& columns) {
  return static_cast<int>(columns.size()) - rank(equations, columns);
}

std::vector<int> together(std::vector<int> columns, const std::vector<int>& more) {
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

// ------------------------------------------------------------------------------------------ groups of motions

// A subspace of twists about the base origin (lengths over the characteristic length), by an orthonormal basis.
class Span {
 public:
  // False if the twist is in it already.
  bool add(Vector6 twist) {
    constexpr double kNothing = 1e-7;
    const double size = twist.norm();
    if (!(size > kNothing)) return false;
    twist /= size;
    for (int pass = 0; pass < 2; ++pass) {
      for (const Vector6& one : basis_) twist -= one.dot(twist) * one;
    }
    if (twist.norm() < kNothing) return false;
    basis_.push_back(twist.normalized());
    return true;
  }

  // Adds what motions of it make when one follows another: the Lie algebra that it generates.
  void complete() {
    for (std::size_t i = 0; i < basis_.size(); ++i) {
      for (std::size_t j = 0; j < i && basis_.size() < 6; ++j) {
        const Vector3 v1 = basis_[i].head<3>(), w1 = basis_[i].tail<3>(), v2 = basis_[j].head<3>(),
                      w2 = basis_[j].tail<3>();
        Vector6 bracket;
        bracket << w1.cross(v2) - w2.cross(v1), w1.cross(w2);
        add(bracket);
      }
    }
  }

  int size() const { return static_cast<int>(basis_.size()); }

  // In how many directions it moves a point, near `point`: neighbours go where the point itself, on an axis,
  // may not.
  int directions(const Vector3& point) const {
    Span linear;
    for (const Vector3& aside : {Vector3(0.0, 0.0, 0.0), Vector3(0.3, 0.1, 0.2), Vector3(-0.1, 0.3, 0.2)}) {
      for (const Vector6& one : basis_) {
        Vector6 way = Vector6::Zero();
        way.head<3>() = one.head<3>() + one.tail<3>().cross(point + aside);
        linear.add(way);
      }
    }
    return linear.size();
  }

  MotionGroup group() const {
    Eigen::MatrixXd turns = Eigen::MatrixXd::Zero(3, std::max(1, size()));
    for (int i = 0; i < size(); ++i) turns.col(i) = basis_[static_cast<std::size_t>(i)].tail<3>();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(1e-7);
    qr.compute(turns);
    const auto turning = turns.isZero(1e-7) ? 0 : static_cast<int>(qr.rank());
    if (turning == 0) return MotionGroup::translation;
    if (turning == 3 && size() == 3) return MotionGroup::spherical;
    if (turning != 1) return MotionGroup::spatial;
    // Turns about parallel axes: in a plane if nothing moves along them, screws included.
    int axis = 0;
    for (int i = 1; i < size(); ++i) axis = turns.col(i).norm() > turns.col(axis).norm() ? i : axis;
    const Vector3 u = turns.col(axis).normalized();
    const bool flat = std::all_of(basis_.begin(), basis_.end(),
                                  [&u](const Vector6& one) { return std::abs(u.dot(one.head<3>())) < 1e-7; });
    return flat ? MotionGroup::planar : MotionGroup::schoenflies;
  }

 private:
  std::vector<Vector6> basis_;
};

// What joint j may contribute, about the base origin.
void add_joint(const Posture& posture, int j, Span& span) {
  const Mechanism& mechanism = posture.mechanism();
  const Vector3& axis = posture.joint_axis(j);
  const Vector3 zero = Vector3::Zero();
  const auto twist = [](const Vector3& linear, const Vector3& angular) {
    Vector6 both;
    both << linear, angular;
    return both;
  };
  switch (mechanism.joints()[j].type) {
    case JointType::prismatic:
      span.add(twist(axis, zero));
      return;
    case JointType::revolute:
      span.add(twist(posture.joint_point(j).cross(axis) / mechanism.characteristic_length(), axis));
      return;
    case JointType::parallelogram:  // on a circle: both ways across the axis
      span.add(twist(axis.unitOrthogonal(), zero));
      span.add(twist(axis.cross(axis.unitOrthogonal()), zero));
      return;
  }
}

// Equations of one leg's closure that say anything, the platform having the freedoms `platform`.
int telling_equations(const Posture& posture, int l, const Eigen::MatrixXd& equations,
                      const std::vector<int>& platform) {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  if (leg.attachment == Attachment::spherical) {
    int row = 0;
    for (int i = 0; i < l; ++i) row += internal::closure_rows(mechanism.legs()[i]);
    std::vector<int> columns = platform;
    for (int j = leg.first; j < leg.first + leg.count; ++j) columns.push_back(j);
    return rank(equations.middleRows(row, 3), columns);
  }
  Span span;
  for (int j = leg.first; j < leg.first + leg.count; ++j) add_joint(posture, j, span);
  const Vector3 p = posture.tool().position / mechanism.characteristic_length();
  for (const int column : platform) {
    const int axis = column - mechanism.joint_count();
    Vector6 twist = Vector6::Unit(axis);
    if (axis >= 3) twist.head<3>() = p.cross(Vector3::Unit(axis - 3));
    span.add(twist);
  }
  span.complete();
  return span.size();
}

int gruebler(const Posture& posture, const Eigen::MatrixXd& equations, const Unknowns& unknowns,
             const Span& group) {
  const Mechanism& mechanism = posture.mechanism();
  const int joints = mechanism.joint_count(), legs = static_cast<int>(mechanism.legs().size());
  // Whatever the platform does is in the group of the joints, and so is every equation.
  if (held_rigidly(mechanism)) return joints - group.size() * (legs - 1);
  // So it is with a platform that only translates, hung on points: each leg says where it is, in the directions
  // that the group moves points in.
  const bool points = std::all_of(mechanism.legs().begin(), mechanism.legs().end(),
                                  [](const LegModel& leg) { return leg.attachment == Attachment::spherical; });
  if (points && !mechanism.tool_turns() && unknowns.platform.size() == 3) {
    const auto directions = group.directions(posture.tool().position / mechanism.characteristic_length());
    return joints - directions * (legs - 1);
  }
  int count = joints + static_cast<int>(unknowns.platform.size());
  for (int l = 0; l < legs; ++l) count -= telling_equations(posture, l, equations, unknowns.platform);
  return count;
}

// ------------------------------------------------------------------------------------------------- postures

ActiveVector random_active(const Mechanism& mechanism, std::mt19937_64& random) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) {
    const Interval range = mechanism.active_range(i);
    active[i] = std::uniform_real_distribution(range.min, range.max)(random);
  }
  return active;
}

ActiveVector home_active(const Mechanism& mechanism) {
  ActiveVector active(mechanism.active_count());
  for (int i = 0; i < active.size(); ++i) active[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  return active;
}

// A joint within its range, as far as it has one.
double within(const Mechanism& mechanism, int j, double value) {
  const Interval& range = mechanism.joints()[j].range;
  return std::clamp(value, range.min, range.max);
}

double random_value(const Mechanism& mechanism, int j, std::mt19937_64& random) {
  const JointModel& joint = mechanism.joints()[j];
  const double bound =
      joint.type == JointType::prismatic ? 2.0 * mechanism.characteristic_length() : std::numbers::pi;
  const double low = std::max(joint.range.min, -bound), high = std::min(joint.range.max, bound);
  return low < high ? std::uniform_real_distribution(low, high)(random) : joint.range.middle();
}

// Largest closure error of `posture`, all of it in `error`, by legs.
double open_by(Posture& posture, Eigen::VectorXd& error) {
  const Mechanism& mechanism = posture.mechanism();
  PostureBuilder::place_legs(posture);
  int row = 0;
  std::array<double, 6> one;
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const int rows = internal::closure_error(posture, l, one);
    for (int i = 0; i < rows; ++i) error[row + i] = one[i];
    row += rows;
  }
  return error.size() == 0 ? 0.0 : error.cwiseAbs().maxCoeff();
}

// Where the legs' tips say on average.
void put_platform(Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  PostureBuilder::place_legs(posture);
  Pose& tool = PostureBuilder::tool(posture);
  const auto legs = static_cast<double>(mechanism.legs().size());
  if (mechanism.tool_turns()) {
    for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
      if (mechanism.legs()[l].attachment != Attachment::rigid) continue;
      tool.rotation = posture.leg_tip_rotation(l);
      break;
    }
  }
  tool.position.setZero();
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l)
    tool.position += (posture.leg_tip(l) - tool.rotation * mechanism.legs()[l].platform_point) / legs;
}

// Closes the loops by moving any joint, active or passive, and the platform, each as little as it can
// (Levenberg and Marquardt); joints stay in their ranges if `bounded`. What stays open is returned.
double close_anyhow(Posture& posture, bool bounded) {
  constexpr int kMostSteps = 80;
  const Mechanism& mechanism = posture.mechanism();
  const double length = mechanism.characteristic_length(), tolerance = 1e-11 * length;
  const Unknowns unknowns = unknowns_of(mechanism);
  const std::vector<int> columns = together(unknowns.joints, unknowns.declared);
  const int joints = mechanism.joint_count();
  Eigen::VectorXd error(closure_equations(posture).rows()), trial_error(error.size());
  double open = open_by(posture, error), damping = 1e-3;
  for (int step = 0; step < kMostSteps && open > tolerance && damping < 1e10; ++step) {
    Eigen::MatrixXd A = closure_equations(posture)(Eigen::all, columns);
    // A joint at its end that would leave its range stays where it is.
    const Eigen::VectorXd slope = A.transpose() * error;
    for (int j = 0; j < joints && bounded; ++j) {
      const Interval& range = mechanism.joints()[j].range;
      const double q = posture.joints()[j];
      if ((q <= range.min && slope[j] > 0.0) || (q >= range.max && slope[j] < 0.0)) A.col(j).setZero();
    }
    Eigen::MatrixXd H = A * A.transpose();
    H.diagonal().array() += damping * length * length * std::min(1.0, error.squaredNorm() / (length * length));
    H.diagonal().array() += 1e-14 * length * length;
    const Eigen::VectorXd change = -A.transpose() * H.ldlt().solve(error);
    Posture trial = posture;
    for (int j = 0; j < joints; ++j) {
      double& q = PostureBuilder::joints(trial)[j];
      q += change[j];
      if (bounded) q = within(mechanism, j, q);
    }
    Pose& tool = PostureBuilder::tool(trial);
    Vector3 turn = Vector3::Zero();
    for (std::size_t c = 0; c < unknowns.declared.size(); ++c) {
      const int axis = unknowns.declared[c] - joints;
      const double by = change[joints + static_cast<Eigen::Index>(c)];
      (axis < 3 ? tool.position[axis] : turn[axis - 3]) += axis < 3 ? by : by / length;
    }
    if (mechanism.tool_turns()) tool.rotation = internal::orthonormal(internal::turned_by(turn, tool.rotation));
    const double then = open_by(trial, trial_error);
    if (trial_error.squaredNorm() < error.squaredNorm()) {
      posture = trial;
      error = trial_error;
      open = then;
      damping = std::max(1e-9, damping * 0.1);
    } else {
      damping *= 10.0;
    }
  }
  return open;
}

bool closed(const Mechanism& mechanism, double open) {
  return open <= 1e-9 * mechanism.characteristic_length();
}

}  // namespace

const char* to_string(MotionGroup group) noexcept {
  switch (group) {
    case MotionGroup::translation:
      return "translation";
    case MotionGroup::planar:
      return "planar";
    case MotionGroup::spherical:
      return "spherical";
    case MotionGroup::schoenflies:
      return "schoenflies";
    case MotionGroup::spatial:
      break;
  }
  return "spatial";
}

const char* in_words(MotionGroup group) noexcept {
  switch (group) {
    case MotionGroup::translation:
      return "of translations";
    case MotionGroup::planar:
      return "in the plane";
    case MotionGroup::spherical:
      return "about a point";
    case MotionGroup::schoenflies:
      return "of translations and turns about one direction";
    case MotionGroup::spatial:
      break;
  }
  return "in space";
}

Mobility mobility(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  const Eigen::MatrixXd equations = closure_equations(posture);
  const Unknowns of = unknowns_of(mechanism);
  Span group;
  for (const int j : of.joints) add_joint(posture, j, group);
  group.complete();

  Mobility result;
  result.active = mechanism.active_count();
  result.group = group.group();
  result.gruebler = gruebler(posture, equations, of, group);
  result.freedoms = freedoms(equations, together(of.joints, of.platform));
  result.redundant_equations = result.freedoms - result.gruebler;
  // Freedoms that remain when the platform is held are the joints' own; the rest are the tool's.
  result.tool_freedoms = result.freedoms - freedoms(equations, of.joints);
  result.loose = freedoms(equations, together(of.passive, of.platform));
  result.loose_tool = result.loose - freedoms(equations, of.passive);
  result.undeclared = result.freedoms - freedoms(equations, together(of.joints, of.declared));
  return result;
}

MobilitySample sample_mobility(const Mechanism& mechanism, int random) {
  constexpr int kEnough = 4;  // postures, below which others are looked for near home
  MobilitySample sample;
  std::mt19937_64 generator(1);
  std::vector<int> counted;
  const auto count = [&](const Posture& posture) {
    const Mobility here = mobility(posture);
    // An arm that is stretched out has its freedoms, but the tool does not show them.
    const auto order = [](const Mobility& one) {
      return std::tuple(one.freedoms + one.loose, -one.tool_freedoms, -one.loose_tool);
    };
    if (counted.empty() || order(here) < order(sample.typical)) {
      sample.typical = here;
      sample.posture.assign(1, posture);
    }
    counted.push_back(here.freedoms);
  };
  for (; sample.tried <= random; ++sample.tried) {
    const Solution solution = solve_forward(
        mechanism, sample.tried == 0 ? home_active(mechanism) : random_active(mechanism, generator));
    if (!solution) continue;
    ++sample.closed;
    count(*solution.posture);
  }
  const JointVector home = sample.posture.empty() ? mechanism.home_guess() : sample.posture[0].joints();
  // Joints that no drive decides are all left as home has them, stretched out perhaps: others are tried too.
  const bool loose = !counted.empty() && sample.typical.loose > 0;
  for (int k = 0; k < 2 * kEnough && (loose || static_cast<int>(counted.size()) < kEnough); ++k) {
    Posture posture = PostureBuilder::open(mechanism);
    PostureBuilder::joints(posture) = home;
    for (int j = 0; j < mechanism.joint_count(); ++j) {
      const double scale =
          mechanism.joints()[j].type == JointType::prismatic ? mechanism.characteristic_length() : 1.0;
      PostureBuilder::joints(posture)[j] += scale * std::uniform_real_distribution(-0.2, 0.2)(generator);
    }
    put_platform(posture);
    if (closed(mechanism, close_anyhow(posture, false))) count(posture);
  }
  for (const int freedoms : counted) {
    if (freedoms > sample.typical.freedoms) ++sample.singular;
    sample.most_freedoms = std::max(sample.most_freedoms, freedoms);
  }
  return sample;
}

std::vector<int> loose_joints(const Posture& posture) {
  const Eigen::MatrixXd equations = closure_equations(posture);
  const Unknowns of = unknowns_of(posture.mechanism());
  const std::vector<int> columns = together(of.passive, of.platform);
  std::vector<int> joints;
  // A joint is loose if holding it as well takes a freedom away.
  const int all = freedoms(equations, columns);
  for (const int j : of.passive) {
    std::vector<int> others = columns;
    others.erase(std::find(others.begin(), others.end(), j));
    if (freedoms(equations, others) < all) joints.push_back(j);
  }
  return joints;
}

std::vector<int> decided_joints(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  const Eigen::MatrixXd equations = closure_equations(posture);
  const Unknowns of = unknowns_of(mechanism);
  std::vector<int> free = together(of.joints, of.platform), decided;
  int left = freedoms(equations, free);
  for (int i = 0; i < mechanism.active_count(); ++i) {
    free.erase(std::find(free.begin(), free.end(), mechanism.active_joint(i)));
    const int then = freedoms(equations, free);
    if (then == left) decided.push_back(i);
    left = then;
  }
  return decided;
}

Assembly find_assembly(const Mechanism& mechanism) {
  constexpr int kActiveTries = 60, kStarts = 150;
  Assembly assembly;
  assembly.gap = std::numeric_limits<double>::infinity();
  double farthest = std::numeric_limits<double>::infinity();
  const auto closes_with = [&](const Posture& posture) {
    assembly.closes = true;
    int worst = -1;
    double most = 1e-9;
    for (int j = 0; j < mechanism.joint_count(); ++j) {
      const JointModel& joint = mechanism.joints()[j];
      const double q = internal::wrapped(joint, posture.joints()[j]);
      const double out = std::max(joint.range.min - q, q - joint.range.max) /
                         (joint.type == JointType::prismatic ? mechanism.characteristic_length() : 1.0);
      if (out <= most) continue;
      most = out;
      worst = j;
    }
    if (worst < 0 && !assembly.found) {
      assembly.found = true;
      assembly.posture.assign(1, posture);
    }
    if (worst < 0 || most >= farthest) return;
    farthest = most;
    assembly.outside = worst;
    assembly.needed = internal::wrapped(mechanism.joints()[worst], posture.joints()[worst]);
  };
  std::mt19937_64 generator(1);
  for (int k = 0; k <= kActiveTries && !assembly.found; ++k) {
    ++assembly.tried;
    const Solution solution =
        solve_forward(mechanism, k == 0 ? home_active(mechanism) : random_active(mechanism, generator));
    if (solution) {
      assembly.from_home = true;
      closes_with(*solution.posture);
    } else if (solution.residual >= 0.0) {
      assembly.gap = std::min(assembly.gap, solution.residual);
    }
  }
  for (int k = 0; k < kStarts && !assembly.found; ++k) {
    ++assembly.tried;
    Posture posture = PostureBuilder::open(mechanism);
    PostureBuilder::joints(posture) = mechanism.home_guess();
    for (int j = 0; j < mechanism.joint_count() && k > 0; ++j)
      PostureBuilder::joints(posture)[j] = random_value(mechanism, j, generator);
    put_platform(posture);
    for (const bool bounded : {true, false}) {
      const double open = close_anyhow(posture, bounded);
      if (closed(mechanism, open)) {
        closes_with(posture);
        break;
      }
      assembly.gap = std::min(assembly.gap, open);
    }
  }
  return assembly;
}

}  // namespace zwidth
