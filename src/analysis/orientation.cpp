#include "zwidth/analysis/orientation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "zwidth/analysis/internal/bounded_step.h"
#include "zwidth/analysis/internal/parallel.h"
#include "zwidth/analysis/posture_sweep.h"

namespace zwidth {
namespace {

using internal::BoundedStep;
using std::numbers::pi;

// Rotations spread evenly over all there are: super-Fibonacci spirals (Alexa 2022).
std::vector<Matrix3> spread_rotations(int n) {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;  // psi^4 = psi + 4
  std::vector<Matrix3> rotations;
  for (int i = 0; i < n; ++i) {
    const double s = i + 0.5, r = std::sqrt(s / n), R = std::sqrt(1.0 - s / n);
    const double alpha = 2.0 * pi * s / phi, beta = 2.0 * pi * s / psi;
    const Eigen::Quaterniond q(R * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                               R * std::sin(beta));
    rotations.push_back(q.toRotationMatrix());
  }
  return rotations;
}

// Directions spread evenly over the sphere: a spiral that turns by the golden angle.
std::vector<Vector3> spread_directions(int n) {
  std::vector<Vector3> directions;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n, r = std::sqrt(1.0 - z * z);
    const double turn = pi * (1.0 + std::sqrt(5.0)) * i;
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

// The turn that takes rotation `from` to `to`, as a vector in the base frame [rad].
Vector3 turn_between(const Matrix3& from, const Matrix3& to) {
  const Eigen::AngleAxisd turn(Matrix3(to * from.transpose()));
  return turn.angle() * turn.axis();
}

// What to ask for at a place: whole orientations, or directions of the tool's axis. Each tells how far a tool
// frame is from target k, and its Newton step: `kRows` rows, all lengths.
class Orientations {
 public:
  static constexpr int kRows = 6;
  Orientations(int count, double length) : rotations_(spread_rotations(count)), length_(length) {}

  std::size_t size() const { return rotations_.size(); }
  // Grows with the angle between them, fast to compute.
  double apart(const Matrix3& tool, std::size_t k) const { return -tool.cwiseProduct(rotations_[k]).sum(); }
  double apart(std::size_t a, std::size_t b) const { return apart(rotations_[a], b); }
  Vector3 turn(const Matrix3& tool, std::size_t k) const { return turn_between(tool, rotations_[k]); }
  void rows(const SerialForward& here, const Vector3& slip, const Vector3& turn, Jacobian& J,
            Eigen::Matrix<double, kRows, 1>& gap) const {
    J = here.jacobian;
    J.bottomRows<3>() *= length_;
    gap << slip, length_ * turn;
  }

 private:
  std::vector<Matrix3> rotations_;
  double length_;
};

class Directions {
 public:
  static constexpr int kRows = 5;
  Directions(int count, const Vector3& axis, double length)
      : directions_(spread_directions(count)), axis_(axis), length_(length) {}

  std::size_t size() const { return directions_.size(); }
  double apart(const Matrix3& tool, std::size_t k) const { return -directions_[k].dot(tool * axis_); }
  double apart(std::size_t a, std::size_t b) const { return -directions_[a].dot(directions_[b]); }
  Vector3 turn(const Matrix3& tool, std::size_t k) const {
    const Vector3 axis = tool * axis_, across = axis.cross(directions_[k]);
    const double sine = across.norm(), cosine = axis.dot(directions_[k]);
    if (sine > 1e-12) return std::atan2(sine, cosine) / sine * across;
    return cosine > 0.0 ? Vector3::Zero() : Vector3(pi * axis.unitOrthogonal());
  }
  void rows(const SerialForward& here, const Vector3& slip, const Vector3& turn, Jacobian& J,
            Eigen::Matrix<double, kRows, 1>& gap) const {
    const Vector3 axis = here.tool.rotation * axis_, u = axis.unitOrthogonal(), v = axis.cross(u);
    J.resize(5, here.jacobian.cols());
    J.topRows<3>() = here.jacobian.topRows<3>();
    J.row(3) = length_ * u.transpose() * here.jacobian.bottomRows<3>();
    J.row(4) = length_ * v.transpose() * here.jacobian.bottomRows<3>();
    gap << slip, length_ * u.dot(turn), length_ * v.dot(turn);
  }

 private:
  std::vector<Vector3> directions_;
  Vector3 axis_;
  double length_;
};

// Targets with those nearest to each.
template <class Targets>
struct Network {
  static constexpr std::size_t kNeighbours = 8;
  Targets targets;
  std::vector<std::vector<std::size_t>> neighbours;

  explicit Network(Targets wanted) : targets(std::move(wanted)) {
    const std::size_t n = targets.size(), count = std::min(kNeighbours, n - 1);
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t k = 0; k < n; ++k) {
      others.clear();
      for (std::size_t other = 0; other < n; ++other) {
        if (other != k) others.emplace_back(targets.apart(k, other), other);
      }
      std::ranges::partial_sort(others, others.begin() + static_cast<std::ptrdiff_t>(count));
      neighbours.emplace_back();
      for (std::size_t i = 0; i < count; ++i) neighbours.back().push_back(others[i].second);
    }
  }
};

Vector3 axis_of(const Mechanism& mechanism, const OrientationOptions& options) {
  return options.tool_axis.isZero(0.0) ? tool_axis_of(mechanism) : options.tool_axis.normalized();
}

// What is the same at every place.
class Explorer {
 public:
  Explorer(const Mechanism& mechanism, const OrientationOptions& options)
      : mechanism_(mechanism),
        chain_(*mechanism.serial()),
        step_(mechanism),
        length_(mechanism.characteristic_length()),
        starts_(options.starts),
        directions_(Directions(options.directions, axis_of(mechanism, options), length_)) {
    if (mechanism.active_count() >= 6) orientations_.emplace(Orientations(options.orientations, length_));
  }

  OrientationsAt at(const Vector3& place) const {
    OrientationsAt result;
    std::vector<ActiveVector> there;
    for (int s = 0; s < starts_; ++s) {
      ActiveVector q = spread_posture(mechanism_, s);
      if (lead_to(place, q)) there.push_back(q);
    }
    result.reached = !there.empty();
    result.directions = share(directions_, place, there);
    if (orientations_) result.orientations = share(*orientations_, place, there);
    return result;
  }

 private:
  static constexpr double kClose = 1e-4;  // [rad], and of the characteristic length

  bool lead_to(const Vector3& place, ActiveVector& q) const {
    SerialForward here;
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0; step <= 20; ++step) {
      chain_.forward(q, here);
      const Vector3 slip = place - here.tool.position;
      const double distance = slip.norm();
      if (distance < kClose * length_) return true;
      if (step > 3 && distance > 0.9 * before) return false;
      before = distance;
      if (!step_.take<3>(here.jacobian, slip, q)) return false;
    }
    return false;
  }

  // The same with target k; in turns of at most half a radian, as the first order is good for.
  template <class Targets>
  bool lead_to(const Vector3& place, const Targets& targets, std::size_t k, ActiveVector& q) const {
    constexpr double kFarthest = 0.5;
    SerialForward here;
    Jacobian J;
    Eigen::Matrix<double, Targets::kRows, 1> gap;
    double best = std::numeric_limits<double>::infinity();
    for (int step = 0, idle = 0; step <= 40 && idle < 4; ++step) {
      chain_.forward(q, here);
      const Vector3 slip = place - here.tool.position;
      Vector3 turn = targets.turn(here.tool.rotation, k);
      const double distance = slip.norm() / length_ + turn.norm();
      if (distance < kClose) return true;
      idle = distance < 0.9 * best ? 0 : idle + 1;
      best = std::min(best, distance);
      if (turn.norm() > kFarthest) turn *= kFarthest / turn.norm();
      targets.rows(here, slip, turn, J, gap);
      if (!step_.take<Targets::kRows>(J, gap, q)) return false;
    }
    return false;
  }

  // Targets are tried from the postures whose tools are nearest, and those found lead on to their neighbours.
  template <class Targets>
  Share share(const Network<Targets>& network, const Vector3& place,
              const std::vector<ActiveVector>& there) const {
    constexpr std::size_t kTries = 4, kFew = 20;
    const Targets& targets = network.targets;
    const std::size_t n = targets.size();
    std::vector<Matrix3> turned;
    for (const ActiveVector& q : there) turned.push_back(chain_.pose(q).rotation);
    std::vector<std::optional<ActiveVector>> found(n);
    std::deque<std::size_t> fresh;
    std::size_t count = 0;
    const auto lead = [&](std::size_t k, ActiveVector q) {
      if (!lead_to(place, targets, k, q)) return false;
      found[k] = q;
      fresh.push_back(k);
      ++count;
      return true;
    };
    std::vector<std::pair<double, std::size_t>> order(there.size());
    const auto lead_from_nearest = [&](std::size_t k, std::size_t tries) {
      for (std::size_t s = 0; s < there.size(); ++s) order[s] = {targets.apart(turned[s], k), s};
      std::ranges::sort(order);
      for (std::size_t t = 0; t < std::min(tries, order.size()); ++t) {
        if (lead(k, there[order[t].second])) return;
      }
    };
    const auto spread = [&] {
      while (!fresh.empty()) {
        const std::size_t from = fresh.front();
        fresh.pop_front();
        for (const std::size_t k : network.neighbours[from]) {
          if (!found[k]) lead(k, *found[from]);
        }
      }
    };
    for (std::size_t k = 0; k < n; ++k) lead_from_nearest(k, kTries);
    spread();
    // Where nearly all are found, the last ones are worth a search from everywhere.
    if (n - count <= n / kFew) {
      for (std::size_t k = 0; k < n; ++k) {
        if (!found[k]) lead_from_nearest(k, there.size());
      }
      spread();
    }
    const double value = static_cast<double>(count) / static_cast<double>(n);
    return {.value = value, .error = std::sqrt(value * (1.0 - value) / static_cast<double>(n))};
  }

  const Mechanism& mechanism_;
  const SerialChain& chain_;
  BoundedStep step_;
  double length_;  // makes turns comparable with ways [m]
  int starts_;
  Network<Directions> directions_;
  std::optional<Network<Orientations>> orientations_;
};

// Middles of every so many cubes of a map, by a step that leaves about as many as wanted.
struct Places {
  std::int64_t step = 1;
  std::vector<Vector3> at;
};

Places places_in(const ReachMap& map, int wanted) {
  const double ratio = static_cast<double>(map.cubes_inside()) / wanted;
  Places places{.step = std::max<std::int64_t>(1, std::llround(std::cbrt(ratio)))};
  const auto first = [&](int axis) {
    const std::int64_t over = map.first[axis] % places.step;
    return map.first[axis] + (over > 0 ? places.step - over : -over);
  };
  for (std::int64_t i = first(0); i < map.first[0] + map.count[0]; i += places.step) {
    for (std::int64_t j = first(1); j < map.first[1] + map.count[1]; j += places.step) {
      for (std::int64_t k = first(2); k < map.first[2] + map.count[2]; k += places.step) {
        if (!map.at(i, j, k)) continue;
        places.at.push_back(map.spacing * Vector3(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5,
                                                  static_cast<double>(k) + 0.5));
      }
    }
  }
  return places;
}

ShareSpread spread_of(const std::vector<Share>& shares, double volume) {
  ShareSpread spread;
  if (shares.empty()) return spread;
  const auto n = static_cast<double>(shares.size());
  spread.least = std::ranges::min(shares, {}, &Share::value).value;
  spread.most = std::ranges::max(shares, {}, &Share::value).value;
  for (const Share& share : shares) spread.mean += share.value / n;
  for (std::size_t level = 0; level < kShareLevels.size(); ++level) {
    const double wanted = kShareLevels[level];
    const auto part = [&](const auto& counts) {
      return static_cast<double>(std::ranges::count_if(shares, counts)) / n;
    };
    const double p = part([&](const Share& s) { return s.value >= wanted; });
    // A whole share has found everything that it asked for, and is sure.
    const double open =
        part([&](const Share& s) { return s.error > 0.0 && std::abs(s.value - wanted) <= s.error; });
    spread.volume[level] = p * volume;
    spread.volume_error[level] = std::hypot(std::sqrt(p * (1.0 - p) / n), 0.5 * open) * volume;
  }
  return spread;
}

}  // namespace

std::optional<std::string> orientation_obstacle(const Mechanism& mechanism) {
  if (auto obstacle = reach_obstacle(mechanism)) return obstacle;
  if (mechanism.active_count() < 5)
    return "at one place its joints leave the tool's axis no choice of directions: that takes five";
  return std::nullopt;
}

Description with_turning_tool(const Description& description) {
  Description turning = description;
  auto* arm = std::get_if<SerialDescription>(&turning.mechanism);
  if (arm != nullptr && arm->platform == PlatformFreedom::point) arm->platform = PlatformFreedom::rigid;
  return turning;
}

Vector3 tool_axis_of(const Mechanism& mechanism) {
  assert(!orientation_obstacle(mechanism));
  const SerialChain::Row& last = mechanism.serial()->rows().back();
  const bool spins_about_z = last.joint >= 0 && !last.slides && last.twist == SerialChain::Row::Twist::none;
  return mechanism.active_count() == 5 && spins_about_z ? Vector3::UnitX() : Vector3::UnitZ();
}

OrientationsAt orientations_at(const Mechanism& mechanism, const Vector3& position,
                               const OrientationOptions& options) {
  assert(!orientation_obstacle(mechanism));
  return Explorer(mechanism, options).at(position);
}

OrientationWorkspace orientation_workspace(const Mechanism& mechanism, const ReachMap& map,
                                           const OrientationOptions& options, const Effort& effort) {
  assert(!orientation_obstacle(mechanism) && options.places > 0);
  const Explorer explorer(mechanism, options);
  const Places places = places_in(map, options.places);
  std::vector<OrientationsAt> answers(places.at.size());
  OrientationWorkspace workspace{.places = std::ssize(places.at),
                                 .spacing = static_cast<double>(places.step) * map.spacing,
                                 .tool_axis = axis_of(mechanism, options)};
  workspace.complete = internal::for_each_index(answers.size(), effort,
                                                [&](std::size_t p) { answers[p] = explorer.at(places.at[p]); });
  const double volume = reachable_volume(map).value;
  std::vector<Share> directions, orientations;
  for (const OrientationsAt& answer : answers) {
    directions.push_back(answer.directions);
    if (answer.orientations) orientations.push_back(*answer.orientations);
  }
  workspace.directions = spread_of(directions, volume);
  if (mechanism.active_count() >= 6) workspace.orientations = spread_of(orientations, volume);
  return workspace;
}

}  // namespace zwidth
