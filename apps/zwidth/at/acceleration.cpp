#include "zwidth/analysis/acceleration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "section.h"

#include "zwidth/analysis/joint_torque.h"

/// What the device's own mass does to the tool: how heavy it feels in each direction, what the drives can
/// accelerate, and what a motion takes of them.

namespace zwidth::at {

namespace {

constexpr const char* kNoMass = "not given by the source: the mass that some joint moves";
constexpr double kIdle = 1e-9;   // of a response: directions come out of sums, and of roots of them
constexpr double kNone = 1e-12;  // of the largest: what rounding leaves of a mobility that is zero

/// At the given rates, in the user's frame; nothing where some joint moves no mass.
std::optional<ToolMotion> motion_of(const Situation& at, const ActiveVector& rate) {
  const ActiveMatrix M = mass_matrix(at.posture, at.rates);
  const Eigen::SelfAdjointEigenSolver<ActiveMatrix> eigen(M, Eigen::EigenvaluesOnly);
  const auto& inertia = eigen.eigenvalues();
  if (!(inertia[0] > kNone * inertia[inertia.size() - 1])) return std::nullopt;
  ToolMotion motion = tool_motion(at.posture, at.rates, rate);
  // By the Jacobian that knows what rounding made zero.
  motion.response = M.ldlt().solve(at.J.transpose()).transpose();
  motion.mobility = motion.response.lazyProduct(at.J.transpose());
  motion.turning = at.frame.turn * motion.turning;
  motion.coasting = motion.turning - motion.response * motion.needed;
  return motion;
}

ActiveVector still(const Situation& at) {
  return ActiveVector::Zero(at.mechanism.active_count());
}

/// Calls `use(key, rows, linear)` for the linear rows of the motion and for the angular ones, where there are
/// any.
template <class Use>
void each_kind(const Situation& at, const ToolMotion& motion, Use use) {
  const int rows = static_cast<int>(motion.coasting.size()), linear = at.frame.linear();
  if (linear > 0) use("translation", motion.rows(0, linear), true);
  if (linear < rows) use("rotation", motion.rows(linear, rows - linear), false);
}

/// "12.3 m/s² along (1.000, 0.000, 0.000)".
std::string along(double value, const char* unit, const ToolVector& direction) {
  return fmt::format("{} {} along ({})", number(value), unit, direction_text(direction));
}

}  // namespace

void write_drive_inertia(const Situation& at, Answer& answer) {
  const ActiveVector& inertia = at.mechanism.drive_inertia();
  answer.put("drive_inertia", json_array(inertia));
  if (!(inertia.maxCoeff() > 0.0)) return;
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  answer.cells(fmt::format("  of rotors and transmissions [{}]", units.inertia), inertia, units.inertia_factor);
}

void write_apparent_mass(const Situation& at, Answer& answer) {
  const auto motion = motion_of(at, still(at));
  if (!motion) {
    answer.undefined("apparent_mass", kNoMass);
    answer.undefined("inertia_ellipsoid", kNoMass);
    return;
  }
  Json masses, ellipsoids;
  each_kind(at, *motion, [&](const char* key, const ToolMotion& part, bool linear) {
    const Ellipsoid ellipsoid = inertia_ellipsoid(part.mobility);
    const auto n = part.mobility.rows();
    const double largest = ellipsoid.lengths[0];
    const double zero = std::sqrt(kNone) * largest;
    const auto mass = [&](double mobility) {
      return mobility > kNone * largest * largest ? 1.0 / mobility : HUGE_VAL;
    };
    ToolVector axis(n), lengths(n);
    Json directions = Json::array();
    for (Eigen::Index k = 0; k < n; ++k) {
      axis[k] = mass(part.mobility(k, k));
      lengths[k] = ellipsoid.lengths[k] > zero ? ellipsoid.lengths[k] : 0.0;
      directions.push_back(json_array(ellipsoid.axes.col(k)));
    }
    const double lightest = mass(largest * largest), heaviest = mass(lengths[n - 1] * lengths[n - 1]);
    Json entry;
    entry["axis"] = json_array(axis);
    entry["lightest"] = json_number(lightest);
    entry["lightest_direction"] = directions[0];
    entry["heaviest"] = json_number(heaviest);
    entry["heaviest_direction"] = directions[static_cast<size_t>(n - 1)];
    masses[key] = entry;
    ellipsoids[key] = {{"half_axes", json_array(lengths)}, {"directions", directions}};
    if (!answer.wants("apparent_mass")) return;
    const std::vector<std::string> names = at.frame.names();
    const auto split = static_cast<std::ptrdiff_t>(at.frame.linear());
    answer.columns(linear ? std::vector(names.begin(), names.begin() + split)
                          : std::vector(names.begin() + split, names.end()));
    const double factor = linear ? kMilli : 1e7;
    const char* unit = linear ? "g" : "g cm²";
    answer.cells(fmt::format("apparent {} [{}]", linear ? "mass" : "inertia", unit), axis, factor,
                 n == at.J.rows() ? "free to move sideways" : "free in all other ways");
    if (n < 2) return;
    answer.page().row("  lightest", along(lightest * factor, unit, ellipsoid.axes.col(0)));
    answer.page().row("  heaviest",
                      std::isfinite(heaviest)
                          ? along(heaviest * factor, unit, ellipsoid.axes.col(n - 1))
                          : fmt::format("cannot move along ({})", direction_text(ellipsoid.axes.col(n - 1))));
  });
  answer.put("apparent_mass", masses);
  answer.put("inertia_ellipsoid", ellipsoids);
}

void write_dynamic_manipulability(const Situation& at, Answer& answer) {
  const auto motion = motion_of(at, still(at));
  if (!motion) {
    answer.undefined("dynamic_manipulability", kNoMass);
    return;
  }
  Json entry;
  each_kind(at, *motion, [&](const char* key, const ToolMotion& part, bool linear) {
    Json one;
    const double value = at.singularity.loses ? 0.0 : dynamic_manipulability(part);
    one["unit_torque"] = json_number(value);
    if (at.model.driven()) {
      const Ellipsoid ellipsoid = acceleration_ellipsoid(part, at.model.continuous_torque());
      Json directions = Json::array();
      for (Eigen::Index k = 0; k < ellipsoid.axes.cols(); ++k)
        directions.push_back(json_array(ellipsoid.axes.col(k)));
      one["half_axes"] = json_array(ellipsoid.lengths);
      one["directions"] = directions;
      std::string text;
      for (const double length : ellipsoid.lengths) text += (text.empty() ? "" : " × ") + number(length);
      answer.page().row(fmt::format("acceleration ellipsoid{}", linear ? "" : ", turning"),
                        text + (linear ? " m/s²" : " rad/s²"), "half-axes, continuous, weight left out");
    }
    entry[key] = one;
  });
  answer.put("dynamic_manipulability", entry);
}

void write_acceleration_limits(const Situation& at, Answer& answer) {
  if (!at.model.has_drives()) {
    answer.undefined("acceleration_limits", "some joints have no drive");
    return;
  }
  const auto motion = motion_of(at, at.rate);
  if (!motion) {
    answer.undefined("acceleration_limits", kNoMass);
    return;
  }
  const bool pneumatic = !at.model.description.pneumatic_drives.empty();
  Json entry;
  for (const bool peak : {false, true}) {
    const char* name = peak ? "peak" : "continuous";
    if (peak && pneumatic) {
      entry[name] = nullptr;
      continue;
    }
    const TorqueRange range =
        torque_range(at.model.drives, at.model.pneumatic_drives, at.posture.active(), peak);
    Json figures;
    each_kind(at, *motion, [&](const char* key, const ToolMotion& part, bool linear) {
      const Zonotope polytope = acceleration_polytope(part, range);
      const char* unit = linear ? "m/s²" : "rad/s²";
      figures[key] = {{"coasting", json_array(part.coasting)},
                      {"every_direction", json_number(polytope.inner_radius)},
                      {"weakest_direction", json_array(polytope.inner_direction)},
                      {"strongest", json_number(polytope.outer_radius)},
                      {"strongest_direction", json_array(polytope.outer_direction)}};
      const std::string label = fmt::format("{} {}", name, linear ? "acceleration" : "turning");
      if (polytope.inner_radius > 0.0) {
        answer.page().row(label,
                          fmt::format("{} {} in every direction, {} at best", number(polytope.inner_radius),
                                      unit, number(polytope.outer_radius)),
                          fmt::format("least along ({})", direction_text(polytope.inner_direction)));
      } else {
        double most = 0.0;  // that a drive gives along it
        for (Eigen::Index j = 0; j < part.response.cols(); ++j)
          most = std::max(most, std::abs(polytope.inner_direction.dot(part.response.col(j))));
        const bool idle = most <= kIdle * part.response.norm();
        answer.page().row(label, "none",
                          fmt::format("{} along ({})", idle ? "the tool cannot move" : "the weight takes more",
                                      direction_text(polytope.inner_direction)));
      }
    });
    entry[name] = figures;
  }
  answer.put("acceleration_limits", entry);
}

void write_power(const Situation& at, Answer& answer) {
  if (!at.moving) return;
  ToolVector push = ToolVector::Zero(at.mechanism.tool_rows());
  if (at.load) push = -(at.frame.turn.transpose() * *at.load);
  const ActiveVector torque = inverse_dynamics(at.posture, at.rate, at.acceleration, push);
  const ActiveVector power = torque.cwiseProduct(at.rate);
  answer.put("power", Json{{"joints", json_array(power)}, {"total", json_number(power.sum())}});
  answer.columns(at.mechanism.active_names());
  answer.cells("power of the drives [W]", power, 1.0, fmt::format("together {} W", number(power.sum())));
}

void write_accelerations(const Situation& at, Answer& answer) {
  if (!at.torque) return;
  if (!motion_of(at, at.rate)) {
    answer.undefined("accelerations", kNoMass);
    return;
  }
  ToolVector push = ToolVector::Zero(at.mechanism.tool_rows());
  if (at.load) push = -(at.frame.turn.transpose() * *at.load);
  const ActiveVector joints = forward_dynamics(at.posture, at.rate, *at.torque, push);
  const ToolVector tool = at.J * joints + at.frame.turn * bias_acceleration(at.posture, at.rates, at.rate).tool;
  answer.put("accelerations", Json{{"joints", json_array(joints)}, {"tool", json_array(tool)}});
  answer.columns(at.mechanism.active_names());
  answer.cells("the torques accelerate [rad/s², m/s²]", joints, 1.0);
  answer.tool_vector(at.frame, tool, "  and the tool [m/s²]", 1.0, "  and turn it [rad/s²]", 1.0);
}

void write_energy(const Situation& at, Answer& answer) {
  const double potential = potential_energy(at.posture);
  Json entry{{"potential", json_number(potential)}, {"kinetic", nullptr}};
  if (at.moving) {
    const double kinetic = kinetic_energy(at.posture, at.rate);
    entry["kinetic"] = json_number(kinetic);
    answer.page().row("kinetic energy", quantity(kinetic, 1e3, "mJ"),
                      fmt::format("potential {}, zero at the base origin", quantity(potential, 1e3, "mJ")));
  }
  answer.put("energy", entry);
}

}  // namespace zwidth::at
