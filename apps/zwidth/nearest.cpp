#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "model.h"

#include "zwidth/mechanism/jacobian.h"

// The reachable point nearest to one that is not: downhill in the distance from several starts, with every
// joint in its range, by Newton's method with the free joints' second derivatives from differences of the
// first.

namespace zwidth {

namespace {

constexpr double kFar = 1e6;  // reaches away, where the nearest point is the farthest one that way

/// What is made small: the distance from the target, or from one far away the way against its direction.
struct Goal {
  Vector3 target;
  Vector3 direction;  // unit, to a target that is far
  bool far = false;

  double value(const Vector3& p) const { return far ? -direction.dot(p) : (p - target).norm(); }
  Vector3 gradient(const Vector3& p) const {
    if (far) return -direction;
    const double away = (p - target).norm();
    return away > 0.0 ? Vector3((p - target) / away) : Vector3::Zero();
  }
};

/// Rows of the tool point in space, zero along what a tool held in a plane leaves out.
Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxActive> point_jacobian(const Posture& posture) {
  const Jacobian J = jacobian(posture);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxActive> result;
  result.setZero(3, J.cols());
  const std::span<const int> axes = posture.mechanism().tool_axes();
  for (std::size_t r = 0; r < axes.size(); ++r) {
    if (axes[r] < 3) result.row(axes[r]) = J.row(static_cast<Eigen::Index>(r));
  }
  return result;
}

class Search {
 public:
  Search(const Mechanism& mechanism, const Vector3& position)
      : mechanism_(mechanism), n_(mechanism.active_count()) {
    goal_.target = position;
    for (int j = 0; j < n_; ++j) {
      const JointModel& joint = mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(j))];
      const bool slides = joint.type == JointType::prismatic;
      const double length = mechanism.characteristic_length();
      unit_.push_back(slides ? length : 1.0);
      const double widest = slides ? 2.0 * length : std::numbers::pi;
      const double home = mechanism.home_guess()[mechanism.active_joint(j)];
      spread_.push_back({std::max(joint.range.min, home - widest), std::min(joint.range.max, home + widest)});
      home_.push_back(std::clamp(home, joint.range.min, joint.range.max));
    }
  }

  std::optional<NearestPoint> run() {
    find_idle();
    std::vector<Posture> starts = raster();
    if (starts.empty()) return std::nullopt;
    judge_distance(starts);
    const auto nearer = [this](const Posture& a, const Posture& b) {
      return goal_.value(a.tool().position) < goal_.value(b.tool().position);
    };
    const auto keep = static_cast<std::ptrdiff_t>(std::min<std::size_t>(8, starts.size()));
    std::partial_sort(starts.begin(), starts.begin() + keep, starts.end(), nearer);
    Posture best = descend(starts.front());
    for (auto start = starts.begin() + 1; start != starts.begin() + keep; ++start) {
      const Posture found = descend(*start);
      const double gain = goal_.value(best.tool().position) - goal_.value(found.tool().position);
      // Among equally near ones that which is nearer to home.
      const double rounding = 1e-12 * mechanism_.characteristic_length();
      if (gain > rounding || (gain > -rounding && from_home(found) < from_home(best) - 1e-9)) best = found;
    }
    return tidy(best);
  }

 private:
  Interval range(int j) const { return mechanism_.active_range(j); }

  double from_home(const Posture& posture) const {
    double sum = 0.0;
    for (int j = 0; j < n_; ++j) sum += std::pow((posture.active()[j] - home(j)) / unit(j), 2);
    return sum;
  }
  double unit(int j) const { return unit_[static_cast<std::size_t>(j)]; }
  double home(int j) const { return home_[static_cast<std::size_t>(j)]; }

  /// Joints that leave the tool point where it is wherever they are, such as those of a wrist: they keep still.
  void find_idle() {
    idle_.assign(static_cast<std::size_t>(n_), true);
    constexpr int kPostures = 24;
    for (int k = 0; k < kPostures; ++k) {
      ActiveVector q(n_);
      for (int j = 0; j < n_; ++j) {
        const Interval& spread = spread_[static_cast<std::size_t>(j)];
        const double share =
            std::fmod(0.5 + k * std::sqrt(2.0 + 3.0 * j), 1.0);  // irrational steps: all different
        q[j] = spread.min + spread.width() * share;
      }
      const Solution solution = solve_forward(mechanism_, q);
      if (!solution || solution.near_singularity()) continue;
      const auto J = point_jacobian(*solution.posture);
      for (int j = 0; j < n_; ++j) {
        const double moved = J.col(j).norm() * unit(j);
        if (moved > 1e-12 * mechanism_.characteristic_length()) idle_[static_cast<std::size_t>(j)] = false;
      }
    }
  }

  std::vector<Posture> raster() const {
    const auto moving = std::count(idle_.begin(), idle_.end(), false);
    int per_joint = 2;
    while (per_joint < 100 && std::pow(per_joint + 1, static_cast<double>(moving)) <= 3000.0) ++per_joint;
    std::vector<Posture> starts;
    std::vector<int> index(static_cast<std::size_t>(n_), 0);
    for (bool more = true; more;) {
      ActiveVector q(n_);
      for (int j = 0; j < n_; ++j) {
        const Interval& spread = spread_[static_cast<std::size_t>(j)];
        q[j] = idle_[static_cast<std::size_t>(j)]
                   ? home(j)
                   : spread.min + spread.width() * index[static_cast<std::size_t>(j)] / (per_joint - 1);
      }
      if (const Solution solution = solve_forward(mechanism_, q)) starts.push_back(*solution.posture);
      more = false;
      for (std::size_t j = 0; j < idle_.size() && !more; ++j) {
        if (idle_[j]) continue;
        more = ++index[j] < per_joint;
        if (!more) index[j] = 0;
      }
    }
    return starts;
  }

  void judge_distance(const std::vector<Posture>& starts) {
    Vector3 centre = Vector3::Zero();
    for (const Posture& start : starts) centre += start.tool().position / static_cast<double>(starts.size());
    double reach = mechanism_.characteristic_length();
    for (const Posture& start : starts) reach = std::max(reach, (start.tool().position - centre).norm());
    const Vector3 way = goal_.target - centre;
    goal_.far = way.stableNorm() > kFar * reach;
    if (goal_.far) goal_.direction = way.stableNormalized();
  }

  /// Slope of the goal over the joints [m].
  ActiveVector slope(const Posture& at) const {
    ActiveVector g = point_jacobian(at).transpose() * goal_.gradient(at.tool().position);
    for (int j = 0; j < n_; ++j) g[j] *= unit(j);
    return g;
  }

  std::optional<Posture> moved(const Posture& from, const ActiveVector& q) const {
    SolveOptions options;
    options.start = &from;
    Solution solution = solve_forward(mechanism_, q, options);
    return std::move(solution.posture);
  }

  /// Second derivatives [m] from differences of the slope.
  ActiveMatrix curvature(const Posture& at) const {
    constexpr double h = 1e-5;
    ActiveMatrix H = ActiveMatrix::Zero(n_, n_);
    for (int j = 0; j < n_; ++j) {
      if (idle_[static_cast<std::size_t>(j)]) continue;
      ActiveVector ahead = at.active(), behind = ahead;
      ahead[j] += h * unit(j);
      behind[j] -= h * unit(j);
      const auto front = moved(at, ahead), back = moved(at, behind);
      if (front && back) H.col(j) = (slope(*front) - slope(*back)) / (2.0 * h);
    }
    return 0.5 * (H + H.transpose());
  }

  /// A joint at its end that would leave its range stays where it is, as an idle one does.
  bool held(int j, const ActiveVector& q, const ActiveVector& g) const {
    return idle_[static_cast<std::size_t>(j)] || (q[j] <= range(j).min && g[j] > 0.0) ||
           (q[j] >= range(j).max && g[j] < 0.0);
  }
  double pull(const ActiveVector& q, const ActiveVector& g) const {
    double most = 0.0;
    for (int j = 0; j < n_; ++j) most = std::max(most, held(j, q, g) ? 0.0 : std::abs(g[j]));
    return most;
  }

  Posture descend(Posture at) const {
    constexpr double kLongest = 0.3;  // step of a joint [units]
    const double length = mechanism_.characteristic_length();
    double damping = 1e-6;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const ActiveVector q = at.active(), g = slope(at);
      const double value = goal_.value(at.tool().position), steep = pull(q, g);
      if (steep < 1e-14 * length) break;
      ActiveMatrix H = curvature(at);
      const double scale = std::max(H.cwiseAbs().maxCoeff(), 1e-9 * length);
      ActiveVector down = -g;
      for (int j = 0; j < n_; ++j) {
        if (!held(j, q, g)) continue;
        H.row(j).setZero();
        H.col(j).setZero();
        H(j, j) = scale;
        down[j] = 0.0;
      }
      bool better = false;
      for (; !better && damping < 1e8; damping *= 8.0) {
        ActiveMatrix A = H;
        A.diagonal().array() += damping * scale;
        const Eigen::LDLT<ActiveMatrix> factors(A);
        if (!factors.isPositive() || factors.info() != Eigen::Success) continue;
        ActiveVector step = factors.solve(down);
        const double largest = step.cwiseAbs().maxCoeff();
        if (!std::isfinite(largest)) continue;
        if (largest > kLongest) step *= kLongest / largest;
        ActiveVector trial = q;
        for (int j = 0; j < n_; ++j) {
          if (!held(j, q, g)) trial[j] = std::clamp(q[j] + unit(j) * step[j], range(j).min, range(j).max);
        }
        const auto there = moved(at, trial);
        if (!there) continue;
        const double now = goal_.value(there->tool().position);
        // Next to the bottom rounding hides what the value gains; the slope still tells.
        const double rounding = 1e-15 * (std::abs(value) + length);
        better =
            now < value - rounding || (now <= value + rounding && pull(trial, slope(*there)) < 0.5 * steep);
        if (better) at = *there;
      }
      if (!better) break;
      damping = std::max(1e-12, damping / 64.0);
    }
    return at;
  }

  /// Of an arm the posture nearest to home that has its tool there; no -0 and no dust of rounding.
  NearestPoint tidy(const Posture& found) const {
    std::optional<Posture> best = found;
    if (mechanism_.serial() != nullptr) {
      SolveOptions options;
      options.match = Match::position;
      Solution near = solve_inverse(mechanism_, found.tool(), options);
      const bool usable = near && near.status != SolveStatus::joint_limit &&
                          (near.posture->tool().position - found.tool().position).norm() <
                              1e-9 * mechanism_.characteristic_length();
      if (usable && from_home(*near.posture) < from_home(found)) best = near.posture;
    }
    ActiveVector q = best->active();
    for (int j = 0; j < n_; ++j) {
      const double near = 1e-9 * unit(j);
      for (const double mark : {0.0, home(j), range(j).min, range(j).max}) {
        if (std::abs(q[j] - mark) < near && range(j).contains(mark, 0.0)) q[j] = mark;
      }
      q[j] = std::clamp(q[j], range(j).min, range(j).max) + 0.0;
    }
    if (const auto clean = moved(*best, q)) best = clean;
    NearestPoint result{best->tool().position, q, 0.0};
    for (double& x : result.position) {
      if (std::abs(x) < 1e-12 * mechanism_.characteristic_length()) x = 0.0;
    }
    result.distance = (result.position - goal_.target).stableNorm();
    // Closer than the loops close there is no telling.
    constexpr double kThere = 1e-9;
    if (result.distance <= kThere * mechanism_.characteristic_length()) {
      result.position = goal_.target;
      result.distance = 0.0;
    }
    return result;
  }

  const Mechanism& mechanism_;
  int n_;
  Goal goal_;
  std::vector<double> unit_, home_;
  std::vector<Interval> spread_;  // of the raster's values
  std::vector<bool> idle_;
};

}  // namespace

std::optional<NearestPoint> nearest_reachable(const Mechanism& mechanism, const Vector3& position) {
  return Search(mechanism, position).run();
}

}  // namespace zwidth
