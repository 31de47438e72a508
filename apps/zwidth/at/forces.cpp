#include <cmath>
#include <fmt/format.h>

#include "section.h"

#include "zwidth/analysis/force.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/mechanism/dynamics.h"

/// What the joints must hold, and what the tool can push.

namespace zwidth::at {

void write_gravity(const Situation& at, Answer& answer) {
  const ActiveVector gravity = gravity_torques(at.posture, at.rates);
  answer.put("gravity_torques", json_array(gravity));
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  answer.cells(fmt::format("{} against gravity [{}]", units.effort_name, units.effort), gravity,
               units.effort_factor);
}

void write_torques(const Situation& at, Answer& answer) {
  if (at.load) answer.put("load", json_array(*at.load));
  // The user pushes back on the tool with what the device exerts.
  ToolVector push = ToolVector::Zero(at.mechanism.tool_rows());
  if (at.load) push = -(at.frame.turn.transpose() * *at.load);
  const ActiveVector torques = inverse_dynamics(at.posture, at.rate, at.acceleration, push);
  answer.put("torques", json_array(torques));
  if (!at.load && !at.moving) return;  // those against gravity
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  answer.cells(fmt::format("{} {} [{}]", units.effort_name, at.load ? "with load" : "in motion", units.effort),
               torques, units.effort_factor, at.load ? "the load is what the device exerts on the hand" : "");
  if (!at.model.driven()) return;
  const ActiveVector share = torques.cwiseAbs().cwiseQuotient(at.model.continuous_torque());
  answer.cells("of the continuous limit [%]", share, 100.0, share.maxCoeff() <= 1.0 ? "" : "too much to hold",
               3);
}

namespace {

/// What is to be had in every direction of forces alone or moments alone, and in the best.
Json every_direction(const Jacobian& J, const ActiveVector& torque, const char* unit, Answer& answer) {
  const ForcePolytope polytope = force_polytope(J, torque);
  const bool bounded = polytope.status == PolytopeStatus::bounded;
  Json entry;
  entry["every_direction"] = json_number(polytope.weakest);
  entry["weakest_direction"] = json_array(polytope.weakest_direction);
  entry["strongest"] = bounded ? json_number(polytope.strongest) : Json(nullptr);
  entry["strongest_direction"] = json_array(polytope.strongest_direction);
  answer.page().cells(fmt::format("  in every direction [{}]", unit), {number(polytope.weakest)},
                      fmt::format("along ({})", direction_text(polytope.weakest_direction)));
  if (!bounded)
    answer.page().cells(fmt::format("  strongest [{}]", unit), {"unlimited"},
                        fmt::format("along ({})", direction_text(polytope.strongest_direction)));
  return entry;
}

Json limits_entry(const Situation& at, const char* name, const ActiveVector& torque, Answer& answer) {
  Json entry;
  entry["torque"] = json_array(torque);
  const std::string label = fmt::format("{} force [N]", name);
  if (at.singularity.gains) {
    entry["axis"] = nullptr;
    entry["every_direction"] = 0.0;
    const std::vector<SingularWay>& free = at.singularity.free;
    if (!free.empty()) entry["weakest_direction"] = json_array(free.front().direction);
    answer.page().cells(label, {"none"},
                        free.empty() ? "along the freedom that is gained"
                                     : fmt::format("along ({})", direction_text(free.front().direction)));
    return entry;
  }
  entry["axis"] = json_array(axis_force_limits(at.J, torque));
  answer.tool_vector(at.frame, axis_force_limits(at.J, torque), label, 1.0,
                     fmt::format("{} moment [N m]", name), 1.0, "alone along each axis");
  const int linear = at.frame.linear();
  if (linear > 0) {
    // Pure forces: the moment is zero.
    Json figures = every_direction(at.J.topRows(linear), torque, "N", answer);
    entry.update(figures);
  }
  if (linear < at.J.rows()) {
    Json figures = every_direction(at.J.bottomRows(at.J.rows() - linear), torque, "N m", answer);
    if (linear == 0) {
      entry.update(figures);
    } else {
      entry["moment"] = figures;
    }
  }
  return entry;
}

}  // namespace

namespace {

/// With cylinders, whose limits follow the posture and differ with the direction.
void write_pneumatic_limits(const Situation& at, Answer& answer) {
  const TorqueRange range =
      torque_range(at.model.drives, at.model.pneumatic_drives, at.posture.active(), false);
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  answer.cells(fmt::format("{} limit, positive [{}]", units.effort_name, units.effort), range.max,
               units.effort_factor);
  answer.cells(fmt::format("{} limit, negative [{}]", units.effort_name, units.effort), range.min,
               units.effort_factor);
  Json entry = at.singularity.gains ? Json() : limits_entry(at, "continuous", either_way(range), answer);
  entry["torque_range"] = {json_array(range.min), json_array(range.max)};
  Json along = Json::array();
  const Eigen::Index rows = at.J.rows();
  for (Eigen::Index r = 0; r < rows && !at.singularity.gains; ++r) {
    const ToolVector axis = ToolVector::Unit(rows, r);
    along.push_back(
        {json_number(-load_limit(at.J, range, -axis).value), json_number(load_limit(at.J, range, axis).value)});
  }
  entry["axis_range"] = along;
  answer.put("force_limits", Json{{"continuous", entry}, {"peak", nullptr}});
}

}  // namespace

void write_force_limits(const Situation& at, Answer& answer) {
  if (!at.model.description.pneumatic_drives.empty() && at.model.has_drives()) {
    write_pneumatic_limits(at, answer);
    return;
  }
  if (!at.model.driven()) {
    answer.undefined("force_limits", "some joints have no drive");
    return;
  }
  const ActiveVector continuous = at.model.continuous_torque(), peak = at.model.peak_torque();
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  answer.cells(fmt::format("continuous limit [{}]", units.effort), continuous, units.effort_factor);
  answer.cells(fmt::format("peak limit [{}]", units.effort), peak, units.effort_factor);
  Json limits;
  limits["continuous"] = limits_entry(at, "continuous", continuous, answer);
  limits["peak"] = limits_entry(at, "peak", peak, answer);
  answer.put("force_limits", limits);
}

}  // namespace zwidth::at
