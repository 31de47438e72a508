#include "zwidth/analysis/data_sheet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/analysis/internal/probe.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/description/names.h"
#include "zwidth/description/units.h"
#include "zwidth/description/values.h"
#include "zwidth/math/svd.h"
#include "zwidth/mechanism/family_of.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> driven_joints(const DriveDescription& drive, const Mechanism& mechanism) {
  if (!drive.joints.empty()) return drive.joints;
  std::vector<std::string> names;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (!mechanism.is_free(i)) names.push_back(mechanism.active_names()[static_cast<std::size_t>(i)]);
  }
  return names;
}

int joint_index(const Mechanism& mechanism, const std::string& name) {
  const auto& names = mechanism.active_names();
  return static_cast<int>(std::ranges::find(names, name) - names.begin());
}

// The lengths and angles of a family as its file gives them.
std::vector<GeometryEntry> geometry_of(const Description& description) {
  std::vector<GeometryEntry> entries;
  for (const DescribedValue& value : described_values(description)) {
    const bool of_row = value.table.starts_with("joint[");
    if (value.table != "mechanism" && !of_row) continue;
    if (of_row && value.values.size() == 1 && value.values.front() == 0.0) continue;
    std::string key = of_row ? value.table + "." + value.key : value.key, name = key;
    std::ranges::replace(name, '_', ' ');
    const std::string unit(si_unit(value.dimension));
    if (value.values.size() == 2) {
      entries.push_back({key + "_min", name + " from", "", value.values[0], unit});
      entries.push_back({key + "_max", name + " to", "", value.values[1], unit});
    } else {
      entries.push_back({key, name, "", value.values.front(), unit});
    }
  }
  return entries;
}

std::vector<GeometryEntry> geometry_of(const DeltaDescription& delta) {
  return {{"base_radius", "base radius", "d1", delta.base_radius, "m"},
          {"upper_arm", "upper arm", "d2", delta.upper_arm, "m"},
          {"forearm", "forearm", "d3", delta.forearm, "m"},
          {"platform_radius", "platform radius", "d4", delta.platform_radius, "m"},
          {"joint_range_min", "joint range from", "theta_min", delta.joint_range.min, "rad"},
          {"joint_range_max", "joint range to", "theta_max", delta.joint_range.max, "rad"}};
}

std::vector<GeometryEntry> geometry_of(const LegsDescription& legs) {
  std::vector<GeometryEntry> entries = {{"legs", "legs", "", static_cast<double>(legs.legs.size()), ""}};
  double joints = 0.0;
  for (const LegDescription& leg : legs.legs) joints += static_cast<double>(leg.joints.size());
  entries.push_back({"joints", "joints", "", joints, ""});
  return entries;
}

// One torque limit per joint; only called where every joint has a drive.
ActiveVector torques(const std::vector<std::optional<Drive>>& drives, bool peak) {
  ActiveVector torque(static_cast<Eigen::Index>(drives.size()));
  for (std::size_t j = 0; j < drives.size(); ++j) {
    torque[static_cast<Eigen::Index>(j)] =
        (peak ? drives[j]->peak_torque() : drives[j]->continuous_torque()).usable;
  }
  return torque;
}

ForceSheet force_sheet(const LatticeSweep& sweep, const std::vector<std::optional<Drive>>& drives, bool peak) {
  ForceSheet sheet;
  sheet.torque = torques(drives, peak);
  const int first = static_cast<int>(Figure::force_x);
  for (int axis = 0; axis < 3; ++axis) sheet.axes[axis] = sweep.figures[first + axis];
  sheet.weakest = sweep[Figure::weakest_force];
  sheet.strongest = sweep[Figure::strongest_force];
  for (const auto& drive : drives) {
    const std::string limiter =
        to_string((peak ? drive->peak_torque() : drive->continuous_torque()).limited_by);
    sheet.limited_by = sheet.limited_by.empty() || sheet.limited_by == limiter ? limiter : "various";
  }
  return sheet;
}

void scale(Statistic& statistic, double factor) {
  statistic.min *= factor;
  statistic.max *= factor;
  statistic.mean *= factor;
}

ActuatorResponse response_of(const TwoMassModel& model, const DataSheetOptions& options) {
  ActuatorResponse response;
  response.dc_gain = model.dc_gain()[TwoMassModel::tip_force];
  response.resonance = model.resonance(options.max_frequency);
  response.resonance_peak = model.resonance_peak(options.max_frequency);
  response.bandwidth = model.bandwidth(3.0, options.max_frequency);
  response.cable_stiffness = model.parameters().cable_stiffness;
  response.step_current = options.step_current;
  if (options.frequency_points < 2) return response;

  constexpr double kFirstFrequency = 1.0;  // [Hz]
  double turns = 0.0, before = 0.0;
  for (int n = 0; n < options.frequency_points; ++n) {
    const double f = kFirstFrequency * std::pow(options.max_frequency / kFirstFrequency,
                                                static_cast<double>(n) / (options.frequency_points - 1));
    const std::complex<double> gain = model.frequency_response(f);
    const double phase = std::arg(gain);
    if (n > 0 && phase - before > std::numbers::pi) turns -= 1.0;
    if (n > 0 && phase - before < -std::numbers::pi) turns += 1.0;
    before = phase;
    response.frequency.push_back(f);
    response.magnitude.push_back(std::abs(gain));
    response.phase.push_back(phase + kTurn * turns);
  }
  const int samples = 501;
  const double period = options.step_duration / (samples - 1);
  response.step_force = model.step_force(options.step_current, period, samples);
  for (int n = 0; n < samples; ++n) response.step_time.push_back(n * period);
  const double target = response.dc_gain * options.step_current;
  if (target != 0.0) response.step = step_metrics(response.step_force, target);
  return response;
}

DriveSheet drive_sheet(const DriveDescription& description, const Mechanism& mechanism,
                       const DataSheetOptions& options) {
  std::vector<std::string> joints = driven_joints(description, mechanism);
  const int first = joint_index(mechanism, joints.front());
  DriveSheet sheet{.joints = std::move(joints), .drive = Drive(description, mechanism.active_range(first))};
  const Drive& drive = sheet.drive;
  sheet.margins = drive.margins();
  sheet.figures = drive.figures(
      mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(first))].type == JointType::prismatic);
  sheet.continuous = drive.continuous_torque();
  sheet.peak = drive.peak_torque();
  sheet.stall = drive.stall_torque();
  sheet.speed = drive.speed();
  sheet.current_loop_bandwidth = drive.current_loop().bandwidth();
  if (description.amplifier.current_loop_rate > 0.0 && drive.current_loop().is_stable()) {
    sheet.current_step_period = 1.0 / description.amplifier.current_loop_rate;
    sheet.current_step = drive.current_loop().step(sheet.current_step_period, 31);
  }
  if (const std::optional<TwoMassModel> model = drive.two_mass()) sheet.response = response_of(*model, options);
  return sheet;
}

bool has_mass(const Mechanism& mechanism) {
  double mass = mechanism.drive_inertia().size() > 0 ? mechanism.drive_inertia().sum() : 0.0;
  for (const BodyModel& body : mechanism.bodies()) mass += body.mass;
  return mass > 0.0;
}

std::optional<PostureSheet> middle_posture(const Mechanism& mechanism, const DataSheet& sheet,
                                           const std::vector<std::optional<Drive>>& drives, bool driven) {
  ActiveVector active(mechanism.active_count());
  for (int j = 0; j < active.size(); ++j) active[j] = mechanism.active_range(j).middle();
  const Solution solution = solve_forward(mechanism, active);
  if (!solution) return std::nullopt;
  const Posture& posture = *solution.posture;
  const Rates rate = rates(posture);
  const Jacobian J = rate.tool.topRows(internal::tool_dimension(mechanism));

  PostureSheet middle;
  middle.active = active;
  middle.position = posture.tool().position;
  middle.jacobian = J;
  middle.condition_number = jacobian_scale(mechanism).rows_condition_number(J);
  middle.manipulability = dexterity(J).manipulability;
  middle.gravity_torques = gravity_torques(posture, rate);
  if (has_mass(mechanism)) middle.apparent_mass = apparent_mass(cartesian_mass(J, mass_matrix(posture, rate)));
  if (driven) {
    middle.continuous_forces = force_polytope(J, torques(drives, false));
    middle.peak_forces = force_polytope(J, torques(drives, true));
    middle.tool_resolution = tool_resolution(J, sheet.joint_resolution);
    if (sheet.torque_resolution.minCoeff() > 0.0) {
      middle.force_resolution = force_resolution(J, sheet.torque_resolution);
    }
  }
  return middle;
}

// Torque ranges of all active joints; zero where there is no drive.
TorqueRange torque_range(const std::vector<std::optional<Drive>>& drives, bool peak) {
  ActiveVector limit = ActiveVector::Zero(static_cast<Eigen::Index>(drives.size()));
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (!drives[j]) continue;
    limit[static_cast<Eigen::Index>(j)] =
        (peak ? drives[j]->peak_torque() : drives[j]->continuous_torque()).usable;
  }
  return TorqueRange::symmetric(limit);
}

ArmSheet arm_of(const Mechanism& mechanism, const std::vector<std::optional<Drive>>& drives,
                const std::vector<std::optional<PneumaticDrive>>& cylinders, const ActiveVector& joint_step,
                const Mechanism& turning, const DataSheetOptions& options) {
  bool driven = true, stepped = true;
  for (int j = 0; j < mechanism.active_count(); ++j) {
    const bool has_drive = drives[static_cast<std::size_t>(j)] || cylinders[static_cast<std::size_t>(j)];
    driven = driven && (has_drive || mechanism.is_free(j));
    stepped = stepped && has_drive && joint_step[j] > 0.0;
  }
  const auto source = [&](bool peak) -> TorqueSource {
    if (!driven) return {};
    if (std::ranges::none_of(cylinders, [](const auto& cylinder) { return cylinder.has_value(); })) {
      return [range = torque_range(drives, peak)](const Posture&) { return range; };
    }
    return [&drives, &cylinders, peak](const Posture& posture) {
      return torque_range(drives, cylinders, posture.active(), peak);
    };
  };
  ArmSheetOptions arm;
  arm.effort = options.effort;
  arm.pose.torque = source(false);
  arm.pose.any_places = 4000;
  if (options.slice_points <= 1) {
    arm.slice_postures = 0;
    arm.pose.slice_points = 0;
  }
  if (mechanism.platform() == PlatformFreedom::point) arm.turning = &turning;
  return arm_sheet(mechanism, source(false), source(true), stepped ? joint_step : ActiveVector(), arm);
}

Effort quiet_of(const Effort& effort) {
  return {.threads = effort.threads, .cancel = effort.cancel};
}

WorkspaceSheet workspace_sheet(const Mechanism& mechanism, const LatticeOptions& lattice,
                               const DataSheetOptions& options) {
  WorkspaceSheet workspace;
  workspace.sweep = sweep_workspace(mechanism, lattice, options.effort);
  if (workspace.sweep.complete) refine_extremes(mechanism, lattice, workspace.sweep, quiet_of(options.effort));
  workspace.extents = workspace_extents(mechanism);
  workspace.volume =
      finer_count(workspace_volume(mechanism, {.threads = options.effort.threads}), workspace.sweep);
  workspace.inscribed = inscribed_shapes(mechanism);
  for (int axis = 0; axis < 3 && options.slice_points > 1; ++axis) {
    workspace.slices[axis] =
        map_slice(mechanism, workspace.extents, axis, workspace.extents.range[axis].middle(),
                  options.slice_points, lattice.limits);
  }
  if (options.surface_divisions > 0)
    workspace.surface = workspace_surface(mechanism, options.surface_divisions);
  return workspace;
}

PlaneSheet plane_sheet(const Mechanism& mechanism, const LatticeOptions& lattice,
                       const DataSheetOptions& options) {
  PlaneSheet plane;
  plane.sweep = sweep_workspace(mechanism, lattice, options.effort);
  if (plane.sweep.complete) refine_extremes(mechanism, lattice, plane.sweep, quiet_of(options.effort));
  plane.extents = workspace_extents(mechanism);
  plane.area = workspace_volume(mechanism, {.threads = options.effort.threads});
  plane.inscribed = inscribed_shapes(mechanism);
  plane.dexterous = dexterous_region(mechanism, plane.extents);
  if (options.slice_points > 1) {
    plane.map = map_slice(mechanism, plane.extents, 2, 0.0, 2 * options.slice_points - 1, lattice.limits);
    for (const double limit : {5.0, 10.0, 100.0})
      plane.condition_regions.push_back(condition_region(mechanism, plane.map, limit));
    if (const auto* five_bar = five_bar_of(mechanism)) {
      plane.singular_curves = singular_curves(five_bar_geometry(*five_bar), {.mode = working_mode(*five_bar)});
    }
  }
  return plane;
}

// What the tool can do of its components, by the Jacobian at home.
int freedoms_of(const Mechanism& mechanism) {
  ActiveVector home(mechanism.active_count());
  for (int i = 0; i < home.size(); ++i) home[i] = mechanism.home_guess()[mechanism.active_joint(i)];
  const Solution solution = solve_forward(mechanism, home);
  if (!solution || solution.status == SolveStatus::degraded) return mechanism.tool_rows();
  constexpr double kNothing = 1e-9;
  const SmallVector sigma = svd(jacobian_scale(mechanism).homogeneous(jacobian(*solution.posture))).sigma;
  return static_cast<int>(std::ranges::count_if(sigma, [&](double s) { return s > kNothing * sigma[0]; }));
}

void add_drive_warnings(DataSheet& sheet) {
  const auto warn = [&sheet](const std::string& joints, const std::vector<Margin>& margins) {
    for (const Margin& margin : margins) {
      if (margin.ok) continue;
      sheet.warnings.push_back("Drive of " + joints + ": " + margin.name + " breaks its rule: " + margin.rule +
                               ".");
    }
  };
  for (const DriveSheet& drive : sheet.drives) warn(joined(drive.joints), drive.margins);
  for (const PneumaticDriveSheet& drive : sheet.pneumatic_drives) warn(drive.joint, drive.drive.margins());
}

}  // namespace

std::vector<std::optional<Drive>> joint_drives(const Description& description, const Mechanism& mechanism) {
  std::vector<std::optional<Drive>> drives(static_cast<std::size_t>(mechanism.active_count()));
  for (const DriveDescription& drive : description.drives) {
    for (const std::string& name : driven_joints(drive, mechanism)) {
      const int j = joint_index(mechanism, name);
      if (j < mechanism.active_count())
        drives[static_cast<std::size_t>(j)].emplace(drive, mechanism.active_range(j));
    }
  }
  return drives;
}

Mechanism mechanism_with_drives(const Description& description) {
  Mechanism mechanism(description);
  ActiveVector inertia = ActiveVector::Zero(mechanism.active_count());
  const auto drives = joint_drives(description, mechanism);
  const auto cylinders = joint_pneumatic_drives(description, mechanism);
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (drives[j]) inertia[static_cast<Eigen::Index>(j)] = drives[j]->reflected_inertia();
    // Piston and rod where the joint is in the middle of its range.
    if (cylinders[j]) {
      const double middle = mechanism.active_range(static_cast<int>(j)).middle();
      inertia[static_cast<Eigen::Index>(j)] = cylinders[j]->reflected_inertia(middle);
    }
  }
  mechanism.set_drive_inertia(inertia);
  return mechanism;
}

DriveLimits drive_limits(const std::vector<std::optional<Drive>>& drives, bool peak) {
  DriveLimits limits;
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (!drives[j]) continue;
    const auto at = static_cast<Eigen::Index>(j);
    limits.torque[at] = (peak ? drives[j]->peak_torque() : drives[j]->continuous_torque()).usable;
    limits.step[at] = drives[j]->angular_resolution();
  }
  return limits;
}

DataSheet data_sheet(const Description& description, const DataSheetOptions& options) {
  const Mechanism mechanism = mechanism_with_drives(description);
  const std::vector<std::optional<Drive>> drives = joint_drives(description, mechanism);
  const std::vector<std::optional<PneumaticDrive>> cylinders = joint_pneumatic_drives(description, mechanism);
  const bool driven = std::ranges::all_of(drives, [](const auto& drive) { return drive.has_value(); });

  DataSheet sheet;
  sheet.name = description.name;
  sheet.title = description.title;
  sheet.source = description.source;
  sheet.mechanism_type = family_name(description.mechanism);
  sheet.active_joints = mechanism.active_count();
  sheet.tool_freedoms = freedoms_of(mechanism);
  sheet.joint_names = mechanism.active_names();
  for (int j = 0; j < mechanism.active_count(); ++j) {
    sheet.joint_ranges.push_back(mechanism.active_range(j));
    sheet.joint_slides.push_back(mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(j))].type ==
                                 JointType::prismatic);
  }
  if (const auto* delta = std::get_if<DeltaDescription>(&description.mechanism)) {
    sheet.geometry = geometry_of(*delta);
  } else if (const auto* legs = std::get_if<LegsDescription>(&description.mechanism)) {
    sheet.geometry = geometry_of(*legs);
  } else {
    sheet.geometry = geometry_of(description);
  }
  for (const BodyModel& body : mechanism.bodies()) sheet.moving_mass += body.mass;

  sheet.joint_resolution = sheet.torque_resolution = ActiveVector::Zero(mechanism.active_count());
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (!drives[j]) continue;
    sheet.joint_resolution[static_cast<Eigen::Index>(j)] = drives[j]->angular_resolution();
    sheet.torque_resolution[static_cast<Eigen::Index>(j)] = drives[j]->torque_resolution().value_or(0.0);
  }
  for (std::size_t j = 0; j < cylinders.size(); ++j) {
    if (!cylinders[j]) continue;
    sheet.joint_resolution[static_cast<Eigen::Index>(j)] = cylinders[j]->angular_resolution().value_or(0.0);
    sheet.pneumatic_drives.push_back({sheet.joint_names[j], *cylinders[j]});
  }
  for (const DriveDescription& drive : description.drives) {
    sheet.drives.push_back(drive_sheet(drive, mechanism, options));
  }
  bool all_moved = true;
  for (std::size_t j = 0; j < drives.size(); ++j) {
    all_moved = all_moved && (drives[j] || cylinders[j] || mechanism.is_free(static_cast<int>(j)));
  }
  if (!all_moved)
    sheet.warnings.push_back("Not every active joint has a drive: forces and resolution are left out.");
  add_drive_warnings(sheet);
  sheet.stiffness = stiffness_sheet(mechanism, drives);

  if (mechanism.tool_turns() || mechanism.platform() == PlatformFreedom::point) {
    const Mechanism turning(with_turning_tool(description));
    sheet.arm = arm_of(mechanism, drives, cylinders, sheet.joint_resolution, turning, options);
    sheet.complete = sheet.arm->complete;
    if (sheet.complete && (has_mass(mechanism) || sheet.stiffness) && mechanism.linear_rows() > 0) {
      sheet.mechanics_of_postures =
          sweep_mechanics_of_postures(mechanism, drives, 4000, quiet_of(options.effort));
      sheet.complete = sheet.mechanics_of_postures->complete;
    }
    return sheet;
  }
  if (const std::optional<std::string> obstacle = workspace_obstacle(mechanism)) {
    sheet.warnings.push_back("The workspace of this mechanism is left out: " + *obstacle + ".");
    return sheet;
  }

  const bool in_plane = internal::tool_dimension(mechanism) == 2;
  const Extents extents = workspace_extents(mechanism);
  const double spacing = options.spacing > 0.0 ? options.spacing : suitable_spacing(mechanism, extents);
  const DriveLimits limits = drive_limits(drives, false);
  const LatticeOptions lattice{.spacing = spacing, .limits = limits, .all_figures = true};

  if (in_plane) {
    sheet.plane = plane_sheet(mechanism, lattice, options);
  } else {
    sheet.workspace = workspace_sheet(mechanism, lattice, options);
  }
  const LatticeSweep& sweep = in_plane ? sheet.plane->sweep : sheet.workspace->sweep;
  sheet.complete = sweep.complete;
  sheet.conditioning = sweep_conditioning(mechanism, in_plane ? spacing : 2.0 * spacing,
                                          {.threads = options.effort.threads, .cancel = options.effort.cancel});
  sheet.complete = sheet.complete && sheet.conditioning->complete;
  if (sweep.inside == 0) {
    sheet.warnings.push_back("No point of the workspace lattice can be reached: is the spacing too wide?");
  }
  if (sheet.workspace && sheet.workspace->volume.method == WorkspaceVolume::Method::lattice) {
    sheet.warnings.push_back(
        "The joint ranges hold postures that the loops cannot take or where a singularity is passed: the "
        "volume is "
        "counted on a lattice.");
  }

  if (driven) {
    sheet.continuous = force_sheet(sweep, drives, false);
    // Forces are proportional to the torques, so equal ratios of peak to continuous torque need no second
    // sweep.
    const ActiveVector ratio = torques(drives, true).cwiseQuotient(torques(drives, false));
    if (ratio.maxCoeff() - ratio.minCoeff() <= 1e-12 * ratio.maxCoeff()) {
      sheet.peak = force_sheet(sweep, drives, true);
      for (Statistic& axis : sheet.peak->axes) scale(axis, ratio[0]);
      scale(sheet.peak->weakest, ratio[0]);
      scale(sheet.peak->strongest, ratio[0]);
    } else {
      const LatticeOptions peak{.spacing = spacing, .limits = drive_limits(drives, true), .all_figures = true};
      LatticeSweep with_peak = sweep_workspace(mechanism, peak, options.effort);
      if (with_peak.complete) refine_extremes(mechanism, peak, with_peak, quiet_of(options.effort));
      sheet.peak = force_sheet(with_peak, drives, true);
    }
    const int first = static_cast<int>(Figure::step_x);
    for (int axis = 0; axis < 3; ++axis) sheet.resolution[axis] = sweep.figures[first + axis];
  }
  if (has_mass(mechanism) || sheet.stiffness) {
    MechanicsSheet mechanics;
    const Effort effort{.threads = options.effort.threads, .cancel = options.effort.cancel};
    mechanics.sweep = sweep_mechanics(
        mechanism, drives, fitting_spacing(extents, spacing, options.most_mechanical_points), effort);
    const auto add = [&](const SliceMap& map) {
      if (map.nu > 1 && map.nv > 1) mechanics.cuts.push_back(cut_mechanics(mechanism, drives, map, 2, effort));
    };
    if (in_plane) add(sheet.plane->map);
    for (int axis = 0; axis < 3 && !in_plane; ++axis)
      add(sheet.workspace->slices[static_cast<std::size_t>(axis)]);
    sheet.complete = sheet.complete && mechanics.sweep.complete;
    sheet.mechanics = std::move(mechanics);
  }
  sheet.middle = middle_posture(mechanism, sheet, drives, driven);
  if (!sheet.middle) sheet.warnings.push_back("The loops do not close in the middle of the joint ranges.");
  return sheet;
}

}  // namespace zwidth
