#include <cmath>
#include <fmt/format.h>

#include "json_rows.h"
#include "section.h"

#include "zwidth/analysis/force.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/dynamics.h"

/// What the hand feels of the device's mass, and of the steps of its sensors and currents.

namespace zwidth::at {

namespace {

void show_matrix(std::string_view label, const ActiveMatrix& M, double factor, const char* note,
                 Answer& answer) {
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    answer.cells(i == 0 ? label : "", M.row(i).transpose(), factor, i == 0 ? note : "");
}

}  // namespace

void write_mass_matrix(const Situation& at, Answer& answer) {
  const ActiveMatrix M = mass_matrix(at.posture, at.rates);
  answer.put("mass_matrix", json_rows(M));
  answer.columns(at.mechanism.active_names());
  const JointUnits units = joint_units(at.mechanism);
  show_matrix(fmt::format("mass matrix [{}]", units.inertia), M, units.inertia_factor, "", answer);
}

void write_point_mass(const Situation& at, Answer& answer) {
  const auto& geometry = at.mechanism.delta();
  if (!geometry) return;
  DeltaMasses masses = delta_masses(at.model.description);
  masses.motor_inertia = Vector3(at.mechanism.drive_inertia());
  const DeltaState state(*geometry, Vector3(at.posture.active()), at.posture.tool().position);
  const Matrix3 M = DeltaPointMassDynamics(*geometry, masses).mass_matrix(state);
  answer.put("mass_matrix_point_mass", json_array(M));
  answer.columns(at.mechanism.active_names());
  show_matrix("  with forearms as points", M, joint_units(at.mechanism).inertia_factor, "Neal 2015, appendix B",
              answer);
}

void write_cartesian_mass(const Situation& at, Answer& answer) {
  if (at.singularity.loses) {
    answer.undefined("cartesian_mass", "infinite along the direction in which the tool cannot move");
    return;
  }
  const ToolMatrix felt = cartesian_mass(at.J, mass_matrix(at.posture, at.rates));
  answer.put("cartesian_mass", json_rows(felt));
}

namespace {

/// With potentiometers, where the voltage step that is read is known. What does not move the tool does not
/// matter.
void write_pneumatic_resolution(const Situation& at, Answer& answer) {
  ActiveVector steps = at.model.joint_step();
  Json entry;
  entry["joint"] = json_array(steps);
  for (Eigen::Index j = 0; j < steps.size(); ++j) {
    if (at.J.col(j).norm() < 1e-12 * at.mechanism.characteristic_length()) steps[j] = 0.0;
  }
  const ToolVector tool = tool_resolution(at.J, steps);
  entry["position"] = json_array(tool);
  if (tool.allFinite()) {
    answer.tool_vector(at.frame, tool, "position step [µm]", 1e6, "angle step [mrad]", kMilli,
                       "one step read of every joint");
  } else {
    answer.page().row("position step", "not given", "a joint has no sensor, or its step is not given");
  }
  answer.put("resolution", entry);
}

}  // namespace

void write_resolution(const Situation& at, Answer& answer) {
  if (!at.model.description.pneumatic_drives.empty() && at.model.has_drives()) {
    write_pneumatic_resolution(at, answer);
    return;
  }
  if (!at.model.driven()) {
    answer.undefined("resolution", "some joints have no drive");
    return;
  }
  Json entry;
  entry["joint"] = json_array(at.model.joint_step());
  entry["torque"] = json_array(at.model.torque_step());
  const ToolVector steps = tool_resolution(at.J, at.model.joint_step());
  entry["position"] = json_array(steps);
  answer.tool_vector(at.frame, steps, "position step [µm]", 1e6, "angle step [mrad]", kMilli,
                     "one count in every joint");
  if (at.J.rows() == at.J.cols() && !at.singularity.loses) {
    const ToolVector force = force_resolution(at.J, at.model.torque_step());
    entry["force"] = json_array(force);
    answer.tool_vector(at.frame, force, "force step [mN]", kMilli, "moment step [mN m]", kMilli,
                       "one current step in every motor");
  }
  answer.put("resolution", entry);
}

}  // namespace zwidth::at
