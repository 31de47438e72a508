#include "zwidth/analysis/arm_sheet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

// Largest pure load along each tool axis: rows of the other kind are zero.
ToolVector axis_loads(const Mechanism& mechanism, const Jacobian& jacobian, const TorqueRange& range) {
  ToolVector loads(jacobian.rows());
  for (Eigen::Index r = 0; r < jacobian.rows(); ++r) {
    const bool is_force = r < mechanism.linear_rows();
    const Jacobian rows = is_force ? jacobian.topRows(mechanism.linear_rows())
                                   : jacobian.bottomRows(jacobian.rows() - mechanism.linear_rows());
    const Eigen::Index row = is_force ? r : r - mechanism.linear_rows();
    ToolVector direction = ToolVector::Unit(rows.rows(), row);
    const double forwards = load_limit(rows, range, direction).value;
    direction = -direction;
    loads[r] = std::min(forwards, load_limit(rows, range, direction).value);
  }
  return loads;
}

std::optional<HomePosture> home_posture(const Mechanism& mechanism, const TorqueSource& continuous,
                                        const TorqueSource& peak) {
  HomePosture home;
  home.active.resize(mechanism.active_count());
  for (int i = 0; i < home.active.size(); ++i)
    home.active[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution solution = solve_forward(mechanism, home.active);
  if (!solution) return std::nullopt;
  const Posture& posture = *solution.posture;
  home.tool = posture.tool();
  const Rates rate = rates(posture);
  home.jacobian = rate.tool;
  const int linear = mechanism.linear_rows();
  const JacobianScale scale = jacobian_scale(mechanism);
  if (linear > 0) home.translation = dexterity(scale.homogeneous_rows(rate.tool.topRows(linear)));
  if (mechanism.tool_turns())
    home.rotation = dexterity(scale.homogeneous_rows(rate.tool.bottomRows(rate.tool.rows() - linear)));
  home.gravity_torques = gravity_torques(posture, rate);
  if (continuous) home.continuous_loads = axis_loads(mechanism, rate.tool, continuous(posture));
  if (peak) home.peak_loads = axis_loads(mechanism, rate.tool, peak(posture));
  return home;
}

}  // namespace

ArmSheet arm_sheet(const Mechanism& mechanism, const TorqueSource& continuous, const TorqueSource& peak,
                   const ActiveVector& joint_step, const ArmSheetOptions& options) {
  const Effort quiet{.threads = options.effort.threads, .cancel = options.effort.cancel};
  const auto report = [&](double fraction) {
    if (options.effort.progress) options.effort.progress(fraction);
  };
  ArmSheet sheet;
  sheet.continuous = sweep_postures(
      mechanism, {.samples = options.postures, .torque = continuous, .joint_step = joint_step}, quiet);
  report(0.2);
  if (peak) sheet.peak = sweep_postures(mechanism, {.samples = options.postures, .torque = peak}, quiet);
  report(0.3);
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const double sign = end == 0 ? -1.0 : 1.0;
      sheet.ends[axis][end] = farthest_along(mechanism, sign * Vector3::Unit(axis));
      sheet.ends[axis][end].distance *= sign;
    }
  }
  sheet.farthest = farthest_from(mechanism, Vector3::Zero());
  sheet.home = home_posture(mechanism, continuous, peak);
  report(0.4);
  sheet.complete = sheet.continuous.complete && (!sheet.peak || sheet.peak->complete);
  if (sheet.complete && options.pose.places > 0 && !pose_workspace_obstacle(mechanism)) {
    Effort rest = quiet;
    if (options.effort.progress) rest.progress = [&](double share) { report(0.4 + 0.6 * share); };
    sheet.pose = pose_workspace(mechanism, options.pose, rest);
    sheet.complete = sheet.pose->complete;
  }
  const Mechanism& arm = options.turning != nullptr ? *options.turning : mechanism;
  if (reach_obstacle(arm) || !sheet.complete) return sheet;

  const ReachMap map =
      reach_map(arm, {.samples = options.reach_postures, .spacing = options.reach_spacing}, quiet);
  report(0.6);
  ReachSheet reach{.volume = reachable_volume(map), .inscribed = inscribed_shapes(map)};
  // Counted in cubes: no wider than the reach itself.
  for (int axis = 0; axis < 3; ++axis) {
    const Interval range{sheet.ends[axis][0].distance, sheet.ends[axis][1].distance};
    InscribedShape &sphere = reach.inscribed.sphere, &cube = reach.inscribed.cube;
    const auto fit = [&](InscribedShape& shape, double half) {
      const double most = std::min(half, 0.5 * range.width());
      shape.centre[axis] = std::clamp(shape.centre[axis], range.min + most, range.max - most);
      return most;
    };
    sphere.size = fit(sphere, sphere.size);
    cube.size = 2.0 * fit(cube, 0.5 * cube.size);
    sphere.volume = 4.0 / 3.0 * std::numbers::pi * std::pow(sphere.size, 3);
    cube.volume = std::pow(cube.size, 3);
  }
  Vector3 through = reach.inscribed.sphere.centre;
  if (sheet.home && map.contains(sheet.home->tool.position)) through = sheet.home->tool.position;
  if (options.slice_postures > 0) {
    reach.slices = slice_reach(arm, map, through, options.slice_postures, quiet);
  }
  sheet.complete = map.complete;
  sheet.reach = std::move(reach);
  report(0.7);
  if (options.orientation.places > 0 && !orientation_obstacle(arm)) {
    sheet.orientations = orientation_workspace(arm, map, options.orientation, quiet);
    sheet.complete = sheet.complete && sheet.orientations->complete;
    if (sheet.home) {
      sheet.home->turning = orientations_at(arm, sheet.home->tool.position, options.orientation);
    }
  }
  report(1.0);
  return sheet;
}

}  // namespace zwidth
