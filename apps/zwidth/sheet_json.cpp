#include "sheet_json.h"

#include <cmath>

#include "mechanics.h"
#include "sheet_arm.h"
#include "sheet_stiffness.h"

#include "zwidth/description/names.h"
#include "zwidth/description/values.h"

namespace zwidth {

namespace {

Json optional_number(const std::optional<double>& value) {
  return value ? json_number(*value) : Json(nullptr);
}

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json axes_json(const std::array<Statistic, 3>& axes) {
  return {{"x", statistic_json(axes[0])}, {"y", statistic_json(axes[1])}, {"z", statistic_json(axes[2])}};
}

Json force_json(const ForceSheet& forces) {
  Json entry;
  entry["torque"] = json_array(forces.torque);
  entry["limited_by"] = forces.limited_by;
  entry["axis"] = axes_json(forces.axes);
  entry["every_direction"] = statistic_json(forces.weakest);
  entry["strongest"] = statistic_json(forces.strongest);
  return entry;
}

Json torque_json(const TorqueLimit& limit) {
  Json entry;
  entry["usable"] = json_number(limit.usable);
  entry["limited_by"] = to_string(limit.limited_by);
  entry["motor"] = json_number(limit.motor);
  entry["slip"] = optional_number(limit.slip);
  entry["gearhead"] = optional_number(limit.gearhead);
  entry["amplifier"] = json_number(limit.amplifier);
  entry["supply"] = json_number(limit.supply);
  return entry;
}

Json workspace_json(const WorkspaceSheet& workspace) {
  Json entry;
  entry["volume"] = json_number(workspace.volume.value);
  entry["volume_method"] = to_string(workspace.volume.method);
  entry["volume_error"] = json_number(workspace.volume.error_estimate);
  entry["lattice"] = {{"spacing", json_number(workspace.sweep.spacing)},
                      {"points", workspace.sweep.lattice_points},
                      {"inside", workspace.sweep.inside},
                      {"volume", json_number(workspace.sweep.volume)},
                      {"error", json_number(counting_error(workspace.volume, workspace.sweep))}};
  Json ranges;
  for (size_t k = 0; k < 3; ++k)
    ranges[std::string(1, static_cast<char>('x' + k))] = json_interval(workspace.extents.range[k]);
  entry["ranges"] = ranges;
  const InscribedShapes& inscribed = workspace.inscribed;
  entry["inscribed_sphere"] = {{"centre", json_array(inscribed.sphere.centre)},
                               {"radius", json_number(inscribed.sphere.size)}};
  entry["inscribed_cube"] = {{"centre", json_array(inscribed.cube.centre)},
                             {"edge", json_number(inscribed.cube.size)}};
  Json figures;
  for (const Figure which : {Figure::condition_number, Figure::manipulability, Figure::leg_singularity,
                             Figure::platform_singularity}) {
    figures[std::string(figure_info(static_cast<int>(which)).name)] = statistic_json(workspace.sweep[which]);
  }
  entry["figures"] = figures;
  return entry;
}

Json plane_json(const PlaneSheet& plane) {
  Json entry;
  entry["area"] = json_number(plane.area.value);
  entry["area_method"] = to_string(plane.area.method);
  entry["area_error"] = json_number(plane.area.error_estimate);
  entry["lattice"] = {{"spacing", json_number(plane.sweep.spacing)},
                      {"points", plane.sweep.lattice_points},
                      {"inside", plane.sweep.inside},
                      {"area", json_number(plane.sweep.area)},
                      {"error", json_number(counting_error(plane.area, plane.sweep))}};
  entry["ranges"] = {{"x", json_interval(plane.extents.range[0])},
                     {"y", json_interval(plane.extents.range[1])}};
  const InscribedShape &circle = plane.inscribed.circle(), &square = plane.inscribed.square();
  entry["inscribed_circle"] = {{"centre", json_array(circle.centre.head<2>())},
                               {"radius", json_number(circle.size)}};
  entry["inscribed_square"] = {{"centre", json_array(square.centre.head<2>())},
                               {"edge", json_number(square.size)}};
  entry["dexterous"] = dexterous_json(plane.dexterous);
  Json figures;
  for (const Figure which : {Figure::condition_number, Figure::manipulability, Figure::leg_singularity,
                             Figure::platform_singularity}) {
    figures[std::string(figure_info(static_cast<int>(which)).name)] = statistic_json(plane.sweep[which]);
  }
  entry["figures"] = figures;
  return entry;
}

// REQUIRES: a workspace in space or in a plane.
double lattice_spacing(const DataSheet& sheet) {
  return (sheet.plane ? sheet.plane->sweep : sheet.workspace->sweep).spacing;
}

Json posture_json(const PostureSheet& posture) {
  Json entry;
  entry["joints"] = json_array(posture.active);
  entry["position"] = json_array(posture.position);
  entry["jacobian"] = json_array(posture.jacobian);
  entry["condition_number"] = json_number(posture.condition_number);
  entry["manipulability"] = json_number(posture.manipulability);
  entry["gravity_torques"] = json_array(posture.gravity_torques);
  for (const auto& [key, forces] : {std::pair{"continuous_forces", &posture.continuous_forces},
                                    std::pair{"peak_forces", &posture.peak_forces}}) {
    if (!*forces) {
      entry[key] = nullptr;
      continue;
    }
    Json vertices = Json::array();
    for (const ToolVector& vertex : (*forces)->vertices) vertices.push_back(json_array(vertex));
    entry[key] = {{"every_direction", json_number((*forces)->weakest)},
                  {"weakest_direction", json_array((*forces)->weakest_direction)},
                  {"strongest", json_number((*forces)->strongest)},
                  {"strongest_direction", json_array((*forces)->strongest_direction)},
                  {"vertices", vertices}};
  }
  if (posture.apparent_mass) {
    entry["apparent_mass"] = {{"axis", json_array(posture.apparent_mass->along_axes)},
                              {"lightest", json_number(posture.apparent_mass->lightest)},
                              {"heaviest", json_number(posture.apparent_mass->heaviest)}};
  } else {
    entry["apparent_mass"] = nullptr;
  }
  entry["position_resolution"] = posture.tool_resolution ? json_array(*posture.tool_resolution) : Json(nullptr);
  entry["force_resolution"] = posture.force_resolution ? json_array(*posture.force_resolution) : Json(nullptr);
  return entry;
}

Json cylinder_json(const PneumaticDriveSheet& sheet) {
  const PneumaticDriveDescription& description = sheet.drive.description();
  Json entry;
  entry["joints"] = {sheet.joint};
  entry["cylinder"] = description.cylinder.info.name;
  entry["regulator"] = description.regulator.info.name;
  entry["potentiometer"] =
      description.potentiometer ? Json(description.potentiometer->info.name) : Json(nullptr);
  entry["usable_pressure"] = json_number(sheet.drive.usable_pressure());
  entry["limited_by"] = to_string(sheet.drive.limited_by());
  entry["torque"] = {{"guaranteed", json_interval(sheet.drive.guaranteed_torque())},
                     {"greatest", json_interval(sheet.drive.greatest_torque())}};
  Json figures;
  for (const DriveFigure& figure : sheet.drive.figures())
    figures[figure.key] = {{"value", json_number(figure.value)}, {"unit", figure.unit}};
  entry["figures"] = figures;
  Json margins = Json::array();
  for (const Margin& margin : sheet.drive.margins()) margins.push_back(margin_json(margin));
  entry["margins"] = margins;
  return entry;
}

Json drive_json(const DriveSheet& sheet) {
  const DriveDescription& description = sheet.drive.description();
  Json entry;
  entry["joints"] = sheet.joints;
  entry["motor"] = description.motor.info.name;
  entry["encoder"] = description.encoder.info.name;
  entry["amplifier"] = description.amplifier.info.name;
  entry["transmission"] = transmission_type(description.transmission);
  const auto* gear = std::get_if<GearheadDescription>(&description.transmission);
  if (gear != nullptr) entry["gearhead"] = gear->gearhead.info.name;
  entry["torque"] = {{"continuous", torque_json(sheet.continuous)},
                     {"peak", torque_json(sheet.peak)},
                     {"stall", torque_json(sheet.stall)}};
  entry["speed"] = {{"usable", json_number(sheet.speed.usable)},
                    {"limited_by", to_string(sheet.speed.limited_by)},
                    {"unloaded", json_number(sheet.speed.unloaded)},
                    {"at_continuous_torque", json_number(sheet.speed.at_continuous_torque)},
                    {"motor", optional_number(sheet.speed.motor)},
                    {"gearhead", optional_number(sheet.speed.gearhead)},
                    {"encoder", optional_number(sheet.speed.encoder)}};
  Json figures;
  for (const DriveFigure& figure : sheet.figures)
    figures[figure.key] = {{"value", json_number(figure.value)}, {"unit", figure.unit}};
  entry["figures"] = figures;
  Json margins = Json::array();
  for (const Margin& margin : sheet.margins) margins.push_back(margin_json(margin));
  entry["margins"] = margins;
  entry["current_loop"] = {
      {"bandwidth", optional_number(sheet.current_loop_bandwidth)},
      {"step", {{"period", json_number(sheet.current_step_period)}, {"samples", numbers(sheet.current_step)}}}};
  if (!sheet.response) {
    entry["actuator"] = nullptr;
    return entry;
  }
  const ActuatorResponse& response = *sheet.response;
  Json actuator;
  actuator["force_per_current"] = json_number(response.dc_gain);
  actuator["cable_stiffness"] = json_number(response.cable_stiffness);
  actuator["resonance_frequency"] =
      response.resonance.is_resonance ? json_number(response.resonance.frequency) : Json(nullptr);
  actuator["resonance_peak"] =
      response.resonance.is_resonance ? json_number(response.resonance_peak) : Json(nullptr);
  actuator["bandwidth"] = optional_number(response.bandwidth);
  actuator["frequency_response"] = {{"frequency", numbers(response.frequency)},
                                    {"magnitude", numbers(response.magnitude)},
                                    {"phase", numbers(response.phase)}};
  actuator["step"] = {{"current", json_number(response.step_current)},
                      {"time", numbers(response.step_time)},
                      {"force", numbers(response.step_force)},
                      {"overshoot", json_number(response.step.overshoot)}};
  entry["actuator"] = actuator;
  return entry;
}

}  // namespace

Json conditioning_json(const GlobalConditioning& conditioning) {
  if (!(conditioning.weight() > 0.0)) return nullptr;
  static constexpr const char* kClasses[] = {"below_5", "from_5_to_10", "from_10_to_100", "above_100"};
  Json shares;
  for (const ConditionClass k : kConditionClasses)
    shares[kClasses[static_cast<size_t>(k)]] = json_number(conditioning.share(k));
  return {{"index", json_number(conditioning.index())},
          {"spread", json_number(conditioning.spread())},
          {"worst", json_number(conditioning.worst())},
          {"best", json_number(conditioning.best())},
          {"near_isotropic", json_number(conditioning.near_isotropic())},
          {"shares", shares}};
}

Json conditioning_json(const WorkspaceConditioning& conditioning) {
  Json entry = conditioning_json(conditioning.of_all);
  if (!entry.is_null()) entry["spacing"] = json_number(conditioning.spacing);
  return entry;
}

Json dexterous_json(const DexterousRegion& region) {
  return {{"limit", json_number(region.limit)},
          {"area", json_number(region.area)},
          {"area_error", json_number(region.error_estimate)},
          {"annulus", region.annulus ? json_interval(*region.annulus) : Json(nullptr)}};
}

namespace {

template <class Statistic>
Json statistic_entry(const Statistic& statistic) {
  if (statistic.count == 0) return nullptr;
  const bool endless = statistic.unbounded || !std::isfinite(statistic.max);
  Json entry;
  entry["min"] = json_number(statistic.min);
  entry["max"] = endless ? Json(nullptr) : json_number(statistic.max);
  entry["mean"] = endless && statistic.median ? Json(nullptr) : json_number(statistic.mean);
  if (statistic.median) entry["median"] = json_number(*statistic.median);
  if (statistic.percentile_5) entry["percentile_5"] = json_number(*statistic.percentile_5);
  if (statistic.percentile_95) entry["percentile_95"] = json_number(*statistic.percentile_95);
  entry["min_at"] = json_array(statistic.min_at);
  entry["max_at"] = json_array(statistic.max_at);
  if (endless) entry["unbounded"] = true;
  return entry;
}

}  // namespace

Json statistic_json(const Statistic& statistic) {
  return statistic_entry(statistic);
}
Json statistic_json(const PostureStatistic& statistic) {
  return statistic_entry(statistic);
}

Json margin_json(const Margin& margin) {
  Json entry;
  entry["name"] = margin.name;
  entry["demand"] = json_number(margin.demand);
  entry["capability"] = json_number(margin.capability);
  entry["unit"] = margin.unit;
  entry["utilisation"] = optional_number(margin.utilisation);
  entry["ok"] = margin.ok;
  entry["rule"] = margin.rule;
  return entry;
}

Json data_sheet_json(const DataSheet& sheet, const Description& description) {
  Json document;
  document["device"] = sheet.name;
  document["title"] = sheet.title;
  document["source"] = sheet.source;
  document["zwidth"] = ZWIDTH_VERSION;
  document["complete"] = sheet.complete;
  Json mechanism;
  mechanism["type"] = sheet.mechanism_type;
  mechanism["active_joints"] = sheet.joint_names;
  mechanism["tool_freedoms"] = sheet.tool_freedoms;
  Json ranges = Json::array();
  for (const Interval& range : sheet.joint_ranges) ranges.push_back(json_interval(range));
  mechanism["joint_ranges"] = ranges;
  mechanism["moving_mass"] = json_number(sheet.moving_mass);
  document["mechanism"] = mechanism;
  Json values = Json::array();
  for (const DescribedValue& value : described_values(description)) {
    Json entry;
    entry["key"] = value.table + "." + value.key;
    entry["value"] = value.values.size() == 1 ? json_number(value.values.front()) : numbers(value.values);
    entry["unit"] = si_unit(value.dimension);
    entry["source"] = value.source;
    entry["chosen"] = value.chosen();
    if (!value.given()) entry["note"] = "not given by the source";
    values.push_back(entry);
  }
  document["values"] = values;

  Json notes;
  const auto absent = [&](const char* key, const char* why) {
    document[key] = nullptr;
    notes[key] = why;
  };
  document["arm"] = sheet.arm ? arm_json(sheet) : Json(nullptr);
  if (!sheet.arm) notes["arm"] = "of a tool that also turns";
  if (sheet.workspace) {
    document["workspace"] = workspace_json(*sheet.workspace);
  } else if (sheet.plane) {
    document["workspace"] = plane_json(*sheet.plane);
  } else if (sheet.arm && sheet.arm->pose) {
    document["workspace"] = pose_json(*sheet.arm->pose);
  } else {
    absent("workspace", sheet.arm && sheet.arm->reach
                            ? "of an arm whose tool turns see arm.reach"
                            : "defined for a tool that only translates, and for platforms on several legs");
  }
  if (sheet.conditioning) document["conditioning"] = conditioning_json(*sheet.conditioning);
  if (sheet.continuous && sheet.peak) {
    document["forces"] = {{"spacing", json_number(lattice_spacing(sheet))},
                          {"continuous", force_json(*sheet.continuous)},
                          {"peak", force_json(*sheet.peak)}};
  } else {
    absent("forces", "needs a drive on every active joint, and a workspace");
  }
  if (sheet.mechanics && knows_inertia(sheet.mechanics->sweep)) {
    const MechanicalSweep& sweep = sheet.mechanics->sweep;
    document["inertia"] = {{"spacing", json_number(sweep.spacing)},
                           {"axis", axes_json({sweep[MechanicalFigure::mass_x], sweep[MechanicalFigure::mass_y],
                                               sweep[MechanicalFigure::mass_z]})},
                           {"lightest", statistic_json(sweep[MechanicalFigure::lightest])},
                           {"heaviest", statistic_json(sweep[MechanicalFigure::heaviest])},
                           {"gravity_torque", statistic_json(sweep[MechanicalFigure::gravity_torque])}};
  } else {
    absent("inertia", sheet.arm ? "of a tool that also turns see mechanics" : "nothing has mass");
  }
  document["mechanics"] = sheet.mechanics               ? mechanics_json(sheet.mechanics->sweep)
                          : sheet.mechanics_of_postures ? mechanics_json(*sheet.mechanics_of_postures)
                                                        : Json(nullptr);
  if (sheet.stiffness) {
    document["stiffness"] = stiffness_json(*sheet.stiffness);
  } else {
    absent("stiffness",
           "not given by the source: neither sections of the links nor the stiffness of every drive");
  }
  document["laminates"] = laminates_json(description);
  Json resolution;
  resolution["joint"] = json_array(sheet.joint_resolution);
  resolution["torque"] = json_array(sheet.torque_resolution);
  if (sheet.workspace || sheet.plane) resolution["spacing"] = json_number(lattice_spacing(sheet));
  resolution["position"] = axes_json(sheet.resolution);
  document["resolution"] = resolution;
  if (sheet.middle) {
    document["middle"] = posture_json(*sheet.middle);
  } else {
    absent("middle", "the legs do not close in the middle of the joint ranges");
  }
  Json drives = Json::array();
  for (const DriveSheet& drive : sheet.drives) drives.push_back(drive_json(drive));
  for (const PneumaticDriveSheet& drive : sheet.pneumatic_drives) drives.push_back(cylinder_json(drive));
  document["drives"] = drives;
  document["warnings"] = sheet.warnings;
  if (!notes.empty()) document["notes"] = notes;
  return document;
}

}  // namespace zwidth
