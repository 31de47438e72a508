#include <algorithm>

#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth::internal {

ActiveVector holding_torques(PostureFigures& at, const FigureOptions& options) {
  const Mechanism& mechanism = at.mechanism();
  ToolVector load(mechanism.tool_rows());
  for (int r = 0; r < load.size(); ++r) {
    load[r] = options.load[mechanism.tool_axes()[static_cast<std::size_t>(r)]];
  }
  // A load on the tool is held by pushing back.
  return gravity_torques(at.posture(), at.rates()) - torques_for_load(at.rates().tool, load);
}

namespace {

// What is known of the short-time limits: nothing of cylinders.
bool has_limits(PostureFigures& at, bool peak) {
  return has_drives(at.device()) && !(peak && pneumatic(at.device()));
}

double polytope_figure(PostureFigures& at, bool moments, bool peak, bool strongest) {
  const Jacobian rows = moments ? at.angular_rows() : at.linear_rows();
  if (rows.rows() == 0 || !has_limits(at, peak)) return kUndefined;
  const ForcePolytope polytope = force_polytope(rows, either_way(at.torque_range(peak)));
  return strongest ? finite_or_undefined(polytope.strongest) : polytope.weakest;
}

// Along one axis alone, all other forces and moments zero.
double axis_limit(PostureFigures& at, int axis, bool peak, const FigureOptions& options) {
  const int row = row_of(at.mechanism(), axis);
  if (row < 0 || !has_limits(at, peak)) return kUndefined;
  const Jacobian& J = at.rates().tool;
  const double way = options.get("way", 0.0);
  if (way == 0.0) return finite_or_undefined(axis_force_limits(J, either_way(at.torque_range(peak)))[row]);
  const ToolVector direction = (way > 0.0 ? 1.0 : -1.0) * ToolVector::Unit(J.rows(), row);
  return finite_or_undefined(load_limit(J, at.torque_range(peak), direction).value);
}

double ellipsoid_figure(PostureFigures& at, bool moments, const FigureOptions& options) {
  const Jacobian rows = moments ? at.angular_rows() : at.linear_rows();
  if (rows.rows() == 0 || !driven(at.device())) return kUndefined;
  const Ellipsoid ellipsoid = force_ellipsoid(rows, either_way(at.torque_range(false)));
  return finite_or_undefined(element_of(ellipsoid.lengths, index_of(options, "which")));
}

// Of one joint, or the largest of all.
double worst_torque(const ActiveVector& torque, const FigureOptions& options) {
  const int joint = index_of(options, "joint", kAll);
  return joint < 0 ? torque.cwiseAbs().maxCoeff() : element_of(torque, joint);
}

double load_utilisation(PostureFigures& at, const FigureOptions& options) {
  const ActiveVector torque = holding_torques(at, options);
  const TorqueRange& range = at.torque_range(false);
  const int only = index_of(options, "joint", kAll);
  if (only >= torque.size()) return kUndefined;
  double worst = 0.0;
  for (int i = 0; i < torque.size(); ++i) {
    if (at.mechanism().is_free(i) || (only >= 0 && i != only)) continue;
    worst = std::max(worst, std::abs(torque[i]) / std::abs(torque[i] > 0.0 ? range.max[i] : range.min[i]));
  }
  return finite_or_undefined(worst);
}

double range_end(PostureFigures& at, const FigureOptions& options, bool up) {
  if (at.device().drives().empty()) return kUndefined;
  const TorqueRange& range = at.torque_range(false);
  return element_of(up ? range.max : range.min, index_of(options, "joint"));
}

// Of every active joint; NaN where it is not known.
ActiveVector joint_steps(PostureFigures& at) {
  const BuiltDevice& device = at.device();
  ActiveVector step = ActiveVector::Constant(at.mechanism().active_count(), kUndefined);
  for (int i = 0; i < step.size(); ++i) {
    const auto j = static_cast<std::size_t>(i);
    if (device.drives()[j]) step[i] = device.drives()[j]->angular_resolution();
    const auto& cylinder = device.pneumatic_drives()[j];
    if (cylinder && cylinder->angular_resolution()) step[i] = *cylinder->angular_resolution();
  }
  return step;
}

double resolution(PostureFigures& at, const FigureOptions&) {
  ActiveVector step = joint_steps(at);
  for (int i = 0; i < step.size(); ++i) {
    if (std::isnan(step[i]) && at.mechanism().is_free(i)) step[i] = 0.0;
  }
  if (!step.allFinite()) return kUndefined;
  return posture_resolution(at.posture(), step).together.distance;
}

double axis_step(PostureFigures& at, int axis) {
  const int row = row_of(at.mechanism(), axis);
  if (row < 0 || !has_drives(at.device())) return kUndefined;
  const Jacobian& J = at.rates().tool;
  ActiveVector step = joint_steps(at);
  for (int j = 0; j < step.size() && pneumatic(at.device());
       ++j) {  // what does not move the tool does not matter
    if (J.col(j).norm() < 1e-12 * at.mechanism().characteristic_length()) step[j] = 0.0;
  }
  return finite_or_undefined(tool_resolution(J, step)[row]);
}

double force_step(PostureFigures& at, int axis) {
  const int row = row_of(at.mechanism(), axis);
  const Jacobian& J = at.rates().tool;
  if (row < 0 || !driven(at.device()) || J.rows() != J.cols()) return kUndefined;
  ActiveVector step(J.cols());
  for (int j = 0; j < step.size(); ++j) {
    const std::optional<double> one = at.device().drives()[static_cast<std::size_t>(j)]->torque_resolution();
    if (!one) return kUndefined;
    step[j] = *one;
  }
  return finite_or_undefined(force_resolution(J, step)[row]);
}

// ------------------------------------------------------------------------------------------------ cylinders

// What a cylinder does while it holds weight and load.
template <class Function>
double of_cylinder(PostureFigures& at, const FigureOptions& options, Function function) {
  const int joint = index_of(options, "joint");
  const auto& drives = at.device().pneumatic_drives();
  if (joint < 0 || joint >= static_cast<int>(drives.size())) return kUndefined;
  const auto& drive = drives[static_cast<std::size_t>(joint)];
  if (!drive) return kUndefined;
  const double angle = at.posture().active()[joint];
  return finite_or_undefined(function(*drive, angle, holding_torques(at, options)[joint]));
}

}  // namespace

FigureTable force_figures() {
  FigureTable list;
  std::string topic = "Forces and torques";
  const auto add = [&](FigureDefinition figure) {
    figure.topic = topic;
    list.push_back(std::move(figure));
  };
  for (const bool peak : {false, true}) {
    const std::string of = peak ? "short-time" : "continuous", key = peak ? "peak" : "continuous";
    const std::string first = peak ? "peak_" : "";
    for (const bool moments : {false, true}) {
      const std::string what = moments ? "moment" : "force", unit = moments ? "N m" : "N";
      for (const bool strongest : {false, true}) {
        std::vector<FigureAnswer> answers;
        const char* last = strongest ? "strongest" : "every_direction";
        if (moments) {
          answers = {{"at force_limits." + key + ".moment." + last}};
          if (!strongest) answers.push_back({"report arm." + key + ".moment_every_direction"});
        } else {
          answers = {{"at force_limits." + key + "." + last}, {"report forces." + key + "." + last}};
          if (!strongest) answers.push_back({"report arm." + key + ".force_every_direction"});
        }
        add({.name = first + what + (strongest ? "_max" : "_min"),
             .unit = unit,
             .meaning = strongest ? "largest " + of + " " + what + " in any direction"
                                  : of + " " + what + " available in every direction",
             .needs_drives = true,
             .answers = answers,
             .of = [=](PostureFigures& at, const FigureOptions&) {
               return polytope_figure(at, moments, peak, strongest);
             }});
      }
      for (int axis = moments ? 3 : 0; axis < (moments ? 6 : 3); ++axis) {
        const std::string letter = kAxisNames[axis % 3];
        add({.name = first + what + "_" + letter,
             .unit = unit,
             .meaning = "largest " + of + " " + what + (moments ? " about " : " along ") + letter + " alone",
             .needs_drives = true,
             .axis = axis,
             .options = {{"way", 0, Dimension::number,
                          "1 along the axis, -1 against it, 0 the weaker of both"}},
             .answers = {{"at force_limits." + key + ".axis[" + kAxisNames[axis] + "]"},
                         {"report " +
                          std::string(moments ? "arm." + key + ".moment." : "forces." + key + ".axis.") +
                          letter},
                         {"report arm." + key + "." + what + "." + letter}},
             .of = [=](PostureFigures& at, const FigureOptions& options) {
               return axis_limit(at, axis, peak, options);
             }});
      }
    }
  }
  add({.name = "force_ellipsoid",
       .unit = "N",
       .meaning = "a half-axis of the ellipsoid of continuous forces",
       .needs_drives = true,
       .options = {{"which", 0, Dimension::number, "from 0, the longest"}},
       .answers = {{"at force_ellipsoid.force.half_axes[which]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return ellipsoid_figure(at, false, options);
       }});
  add({.name = "moment_ellipsoid",
       .unit = "N m",
       .meaning = "a half-axis of the ellipsoid of continuous moments",
       .needs_drives = true,
       .options = {{"which", 0, Dimension::number, "from 0, the longest"}},
       .answers = {{"at force_ellipsoid.moment.half_axes[which]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return ellipsoid_figure(at, true, options);
       }});
  add({.name = "gravity_torque",
       .unit = "N m",
       .meaning = "torque that holds the weight of the links",
       .options = {any_joint_option("the largest of all, without its sign")},
       .answers = {{"at gravity_torques[joint]"},
                   {"report inertia.gravity_torque", {{"joint", kAll}}},
                   {"report mechanics.figures.gravity_torque", {{"joint", kAll}}},
                   {"report arm.gravity_torque", {{"joint", kAll}}}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return worst_torque(gravity_torques(at.posture(), at.rates()), options);
       }});
  add({.name = "load_torque",
       .unit = "N m",
       .meaning = "torque that holds a load on the tool and the weight",
       .load = FigureLoad::needed,
       .options = {any_joint_option("the largest of all, without its sign")},
       .answers = {{"at torques[joint]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return worst_torque(holding_torques(at, options), options);
       }});
  add({.name = "load_utilisation",
       .unit = "1",
       .meaning = "that torque over what the drive gives for ever",
       .needs_drives = true,
       .load = FigureLoad::needed,
       .options = {any_joint_option("the worst of all")},
       .of = load_utilisation});
  add({.name = "torque_up",
       .unit = "N m",
       .meaning = "continuous torque of a joint's drive, or force of a slide, the positive way",
       .needs_drives = true,
       .options = {joint_option()},
       .answers = {{"at force_limits.continuous.torque_range[1][joint]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) { return range_end(at, options, true); }});
  add({.name = "torque_down",
       .unit = "N m",
       .meaning = "the same the negative way, below zero",
       .needs_drives = true,
       .options = {joint_option()},
       .answers = {{"at force_limits.continuous.torque_range[0][joint]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) { return range_end(at, options, false); }});
  add({.name = "potential_energy",
       .unit = "J",
       .meaning = "of all bodies, zero at the base origin",
       .answers = {{"at energy.potential"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return potential_energy(at.posture()); }});

  topic = "Resolution";
  add({.name = "resolution",
       .unit = "m",
       .meaning = "largest tool step when every joint moves by its encoder's step",
       .needs_drives = true,
       .of = resolution});
  for (int axis = 0; axis < 6; ++axis) {
    const bool turns = axis >= 3;
    const std::string letter = kAxisNames[axis % 3];
    add({.name = (turns ? "turn_step_" : "step_") + letter,
         .unit = turns ? "rad" : "m",
         .meaning = "that step " + std::string(turns ? "about " : "along ") + letter,
         .needs_drives = true,
         .axis = axis,
         .answers = {{"at resolution.position[" + std::string(kAxisNames[axis]) + "]"},
                     {turns ? "report arm.turn_step" : "report resolution.position." + letter},
                     {turns ? "report arm.turn_step" : "report arm.step." + letter}},
         .of = [axis](PostureFigures& at, const FigureOptions&) { return axis_step(at, axis); }});
  }
  for (int axis = 0; axis < 6; ++axis) {
    const bool turns = axis >= 3;
    const std::string letter = kAxisNames[axis % 3];
    add({.name = (turns ? "moment_step_" : "force_step_") + letter,
         .unit = turns ? "N m" : "N",
         .meaning = std::string(turns ? "moment about " : "force along ") + letter +
                    " of one current step in every motor",
         .needs_drives = true,
         .axis = axis,
         .answers = {{"at resolution.force[" + std::string(kAxisNames[axis]) + "]"}},
         .of = [axis](PostureFigures& at, const FigureOptions&) { return force_step(at, axis); }});
  }

  topic = "Cylinders, while they hold the weight and a load";
  const auto add_cylinder = [&](const std::string& name, const std::string& unit, const std::string& meaning,
                                const std::string& place, auto of) {
    add({.name = name,
         .unit = unit,
         .meaning = meaning,
         .needs_drives = true,
         .load = FigureLoad::possible,
         .options = {joint_option()},
         .answers = {{"at cylinders[joint]." + place}},
         .of = [of](PostureFigures& at, const FigureOptions& options) {
           return of_cylinder(at, options, of);
         }});
  };
  using Drive = const PneumaticDrive&;
  add_cylinder("cylinder_force", "N", "push of a joint's cylinder", "force",
               [](Drive drive, double at, double torque) { return drive.command(torque, at).force; });
  add_cylinder("cylinder_rear_pressure", "Pa", "gauge pressure behind the piston", "pressures[0]",
               [](Drive drive, double at, double torque) { return drive.command(torque, at).pressures.rear; });
  add_cylinder("cylinder_rod_pressure", "Pa", "gauge pressure on the rod's side", "pressures[1]",
               [](Drive drive, double at, double torque) { return drive.command(torque, at).pressures.rod; });
  add_cylinder("cylinder_rear_command", "V", "voltage of the rear chamber's regulator", "voltages[0]",
               [](Drive drive, double at, double torque) { return drive.command(torque, at).voltages[0]; });
  add_cylinder("cylinder_rod_command", "V", "voltage of the rod chamber's regulator", "voltages[1]",
               [](Drive drive, double at, double torque) { return drive.command(torque, at).voltages[1]; });
  add_cylinder("cylinder_lever", "m", "torque of a unit push", "lever",
               [](Drive drive, double at, double) { return drive.lever(at); });
  add_cylinder("cylinder_distance", "m", "from pin to pin", "length",
               [](Drive drive, double at, double) { return drive.length(at); });
  return list;
}

}  // namespace zwidth::internal
