#include "model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "terminal.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {

Model::Model(const Description& of)
    : description(of),
      mechanism(mechanism_with_drives(of)),
      drives(joint_drives(of, mechanism)),
      pneumatic_drives(joint_pneumatic_drives(of, mechanism)) {}

bool Model::has_drive(int i) const {
  const auto j = static_cast<size_t>(i);
  return drives[j] || pneumatic_drives[j] || mechanism.is_free(i);
}

bool Model::has_drives() const {
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (!has_drive(i)) return false;
  }
  return true;
}

bool Model::driven() const {
  return std::all_of(drives.begin(), drives.end(), [](const auto& drive) { return drive.has_value(); });
}

namespace {

template <class Function>
ActiveVector of_drives(const Model& model, Function function) {
  ActiveVector values =
      ActiveVector::Constant(model.mechanism.active_count(), std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < values.size(); ++i) {
    if (const auto& drive = model.drives[static_cast<size_t>(i)]) {
      const std::optional<double> value = function(*drive);
      if (value) values[i] = *value;
    }
  }
  return values;
}

}  // namespace

ActiveVector Model::continuous_torque() const {
  return of_drives(*this, [](const Drive& drive) { return drive.continuous_torque().usable; });
}
ActiveVector Model::peak_torque() const {
  return of_drives(*this, [](const Drive& drive) { return drive.peak_torque().usable; });
}
ActiveVector Model::torque_step() const {
  return of_drives(*this, [](const Drive& drive) { return drive.torque_resolution(); });
}
ActiveVector Model::joint_step() const {
  ActiveVector steps = of_drives(*this, [](const Drive& drive) { return drive.angular_resolution(); });
  for (int i = 0; i < steps.size(); ++i) {
    const auto& drive = pneumatic_drives[static_cast<size_t>(i)];
    if (drive && drive->angular_resolution()) steps[i] = *drive->angular_resolution();
  }
  return steps;
}

namespace {

/// Walks downhill in |p(q) - target| with q kept in its ranges (Levenberg & Marquardt, bounds by projection).
NearestPoint descend(const Mechanism& mechanism, Solution start, const Vector3& target) {
  const int n = mechanism.active_count();
  const auto result_of = [&](const Posture& posture) {
    return NearestPoint{posture.tool().position, posture.active(), (posture.tool().position - target).norm()};
  };
  NearestPoint best = result_of(*start.posture);
  Posture at = *start.posture;
  double damping = 1e-3;
  for (int round = 0; round < 100 && damping < 1e9; ++round) {
    const Jacobian J = jacobian(at).topRows(3);
    const Eigen::Vector3d gap = target - best.position;
    const ActiveVector downhill = J.transpose() * gap;
    // A joint at its end that would leave its range stays where it is.
    ActiveMatrix H = J.transpose() * J;
    ActiveVector g = downhill;
    const double scale = std::max(1e-12, H.diagonal().maxCoeff());
    for (int j = 0; j < n; ++j) {
      const Interval range = mechanism.active_range(j);
      const bool held = (best.joints[j] <= range.min && downhill[j] < 0.0) ||
                        (best.joints[j] >= range.max && downhill[j] > 0.0);
      if (!held) continue;
      H.row(j).setZero();
      H.col(j).setZero();
      H(j, j) = scale;
      g[j] = 0.0;
    }
    H.diagonal().array() += damping * scale;
    ActiveVector q = best.joints + ActiveVector(H.ldlt().solve(g));
    for (int j = 0; j < n; ++j)
      q[j] = std::clamp(q[j], mechanism.active_range(j).min, mechanism.active_range(j).max);
    const double step = (q - best.joints).cwiseAbs().maxCoeff();
    SolveOptions options;
    options.start = &at;
    const Solution next = solve_forward(mechanism, q, options);
    if (next && result_of(*next.posture).distance < best.distance) {
      best = result_of(*next.posture);
      at = *next.posture;
      damping = std::max(1e-12, damping / 5.0);
      if (step < 1e-13) break;
    } else {
      damping *= 4.0;
    }
  }
  return best;
}

}  // namespace

TransmissionText transmission_text(const TransmissionDescription& transmission) {
  struct Text {
    TransmissionText operator()(const DirectDriveDescription&) const { return {"direct", ""}; }
    TransmissionText operator()(const CapstanDescription& capstan) const {
      return {"cable capstan", capstan.cable.info.title};
    }
    TransmissionText operator()(const RatioDescription& ratio) const {
      return {trimmed(ratio.ratio) + ":1",
              ratio.efficiency < 1.0 ? "efficiency " + trimmed(ratio.efficiency) : ""};
    }
    TransmissionText operator()(const GearheadDescription& gear) const {
      return {"gearhead",
              gear.gearhead.info.title +
                  (gear.further_ratio == 1.0 ? "" : ", then " + trimmed(gear.further_ratio) + ":1")};
    }
  };
  return std::visit(Text{}, transmission);
}

std::optional<NearestPoint> nearest_reachable(const Mechanism& mechanism, const Vector3& position) {
  const int n = mechanism.active_count();
  int per_joint = 2;
  while (std::pow(per_joint + 1, n) <= 3000.0) ++per_joint;
  struct Start {
    double distance;
    Solution solution;
  };
  std::vector<Start> starts;
  std::vector<int> index(static_cast<size_t>(n), 0);
  for (bool more = true; more;) {
    ActiveVector q(n);
    for (int j = 0; j < n; ++j) {
      const Interval range = mechanism.active_range(j);
      q[j] = range.min + range.width() * index[static_cast<size_t>(j)] / (per_joint - 1);
    }
    if (Solution solution = solve_forward(mechanism, q)) {
      const double distance = (solution.posture->tool().position - position).norm();
      starts.push_back({distance, std::move(solution)});
    }
    more = false;
    for (int j = 0; j < n && !more; ++j) {
      if (++index[static_cast<size_t>(j)] < per_joint) {
        more = true;
      } else {
        index[static_cast<size_t>(j)] = 0;
      }
    }
  }
  if (starts.empty()) return std::nullopt;
  const auto keep = static_cast<std::ptrdiff_t>(std::min<size_t>(8, starts.size()));
  std::partial_sort(starts.begin(), starts.begin() + keep, starts.end(),
                    [](const Start& a, const Start& b) { return a.distance < b.distance; });
  std::optional<NearestPoint> best;
  for (auto start = starts.begin(); start != starts.begin() + keep; ++start) {
    const NearestPoint found = descend(mechanism, start->solution, position);
    if (!best || found.distance < best->distance) best = found;
  }
  return best;
}

}  // namespace zwidth
