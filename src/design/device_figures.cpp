#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <tuple>

#include "zwidth/actuation/arm_cylinder.h"
#include "zwidth/analysis/arm_sheet.h"
#include "zwidth/analysis/balance.h"
#include "zwidth/analysis/conditioning.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/five_bar_search.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/analysis/orientation.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/reach_shapes.h"
#include "zwidth/analysis/sizing.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/design/internal/device_cache.h"
#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth::internal {
namespace {

// ------------------------------------------------------------------------------------------------ workspace

const Effort kOneThread{.threads = 1};  // designs are spread over the cores already

// What kind of workspace a device has.
enum class Reach { translation, platform, arm, none };
Reach reach_of(const BuiltDevice& device) {
  if (!workspace_obstacle(device.mechanism())) return Reach::translation;
  if (!pose_workspace_obstacle(device.mechanism())) return Reach::platform;
  return reach_obstacle(turning(device)) ? Reach::none : Reach::arm;
}

std::vector<FigureOption> reach_options() {
  return {{"places", 3000, Dimension::number, "of a platform that turns, about how many are looked at"},
          {"cubes", 50000, Dimension::number, "of an arm, into how many the box around it is cut"}};
}

const PoseWorkspace* pose_of(const BuiltDevice& device, const FigureOptions& options) {
  const auto places = static_cast<std::int64_t>(options.get("places", 3000.0));
  if (places < 1) return nullptr;
  std::map<std::int64_t, PoseWorkspace>& kept = cache_of(device).poses;
  auto found = kept.find(places);
  if (found == kept.end()) {
    found = kept.emplace(places,
                         pose_workspace(device.mechanism(), {.places = places, .slice_points = 0}, kOneThread))
                .first;
  }
  return found->second.reached && !found->second.unbounded ? &found->second : nullptr;
}

const AnyOrientation* anyhow_of(const BuiltDevice& device, const FigureOptions& options) {
  const auto places = static_cast<std::int64_t>(options.get("any_places", 4000.0));
  if (places < 1 || reach_of(device) != Reach::platform) return nullptr;
  std::map<std::int64_t, std::optional<AnyOrientation>>& kept = cache_of(device).anyhow;
  auto found = kept.find(places);
  if (found == kept.end()) {
    const PoseWorkspaceOptions search{
        .shapes = false, .turning = false, .any_places = places, .slice_points = 0};
    found = kept.emplace(places, pose_workspace(device.mechanism(), search, kOneThread).any).first;
  }
  return found->second ? &*found->second : nullptr;
}

const ReachMap* map_of(const BuiltDevice& device, const FigureOptions& options) {
  const auto cubes = static_cast<std::int64_t>(options.get("cubes", 50000.0));
  if (cubes < 1) return nullptr;
  std::map<std::int64_t, ReachMap>& kept = cache_of(device).maps;
  auto found = kept.find(cubes);
  if (found == kept.end()) {
    found = kept.emplace(cubes, reach_map(turning(device), {.samples = 10 * cubes}, kOneThread)).first;
  }
  return &found->second;
}

double volume(const BuiltDevice& device, const FigureOptions& options) {
  switch (reach_of(device)) {
    case Reach::translation:
      return workspace_volume(device.mechanism(), kOneThread).value;
    case Reach::platform: {
      const PoseWorkspace* pose = pose_of(device, options);
      return pose != nullptr ? pose->measure : kUndefined;
    }
    case Reach::arm: {
      const ReachMap* map = map_of(device, options);
      return map != nullptr ? reachable_volume(*map).value : kUndefined;
    }
    default:
      return kUndefined;
  }
}

double inscribed(const BuiltDevice& device, const FigureOptions& options,
                 InscribedShape InscribedShapes::*shape) {
  std::map<std::pair<double, double>, InscribedShapes>& kept = cache_of(device).shapes;
  const std::pair key(options.get("places", 0.0), options.get("cubes", 0.0));
  auto found = kept.find(key);
  if (found == kept.end()) {
    InscribedShapes shapes;
    switch (reach_of(device)) {
      case Reach::translation:
        shapes = inscribed_shapes(device.mechanism());
        break;
      case Reach::platform: {
        const PoseWorkspace* pose = pose_of(device, options);
        if (pose == nullptr) return kUndefined;
        shapes = pose->inscribed;
        break;
      }
      case Reach::arm: {
        const ReachMap* map = map_of(device, options);
        if (map == nullptr) return kUndefined;
        shapes = inscribed_shapes(*map);
        break;
      }
      default:
        return kUndefined;
    }
    found = kept.emplace(key, shapes).first;
  }
  return (found->second.*shape).size;
}

std::optional<Interval> extent(const BuiltDevice& device, int axis, const FigureOptions& options) {
  if (row_of(device.mechanism(), axis) < 0) return std::nullopt;
  const auto a = static_cast<std::size_t>(axis);
  switch (reach_of(device)) {
    case Reach::translation: {
      std::optional<Extents>& kept = cache_of(device).extents;
      if (!kept) kept = workspace_extents(device.mechanism());
      return kept->range[a];
    }
    case Reach::platform: {
      const PoseWorkspace* pose = pose_of(device, options);
      if (pose == nullptr) return std::nullopt;
      return pose->range[a];
    }
    default: {  // of an arm: however it is turned
      const Vector3 direction = Vector3::Unit(axis);
      return Interval{-farthest_along(device.mechanism(), -direction).distance,
                      farthest_along(device.mechanism(), direction).distance};
    }
  }
}

const DexterousRegion* dexterous_of(const BuiltDevice& device, const FigureOptions& options) {
  const double limit = options.get("limit", 5.0);
  const int points = index_of(options, "points", 401.0);
  const Mechanism& mechanism = device.mechanism();
  const bool plane = mechanism.platform() == PlatformFreedom::planar_translation;
  if (!plane || workspace_obstacle(mechanism) || !(limit > 1.0) || points < 3) return nullptr;
  std::map<std::pair<double, int>, DexterousRegion>& kept = cache_of(device).regions;
  auto found = kept.find({limit, points});
  if (found == kept.end()) {
    found = kept.emplace(std::pair(limit, points),
                         dexterous_region(mechanism, workspace_extents(mechanism), limit, points))
                .first;
  }
  return &found->second;
}

// ---------------------------------------------------------------------------------------------- orientations

const OrientationWorkspace* orientations_of(const BuiltDevice& device, const FigureOptions& options) {
  if (reach_of(device) != Reach::arm || orientation_obstacle(turning(device))) return nullptr;
  const ReachMap* map = map_of(device, options);
  const int places = index_of(options, "places", 50.0);
  if (map == nullptr || places < 1) return nullptr;
  std::map<std::pair<double, int>, OrientationWorkspace>& kept = cache_of(device).orientations;
  const std::pair key(options.get("cubes", 50000.0), places);
  auto found = kept.find(key);
  if (found == kept.end()) {
    found =
        kept.emplace(key, orientation_workspace(turning(device), *map, {.places = places}, kOneThread)).first;
  }
  return &found->second;
}

const OrientationsAt* orientations_here(PostureFigures& at) {
  const BuiltDevice& device = at.device();
  if (at.mechanism().serial() == nullptr || orientation_obstacle(turning(device))) return nullptr;
  std::optional<std::pair<Vector3, OrientationsAt>>& kept = cache_of(device).turned;
  const Vector3& here = at.posture().tool().position;
  if (!kept || kept->first != here) kept.emplace(here, orientations_at(turning(device), here));
  return kept->second.reached ? &kept->second : nullptr;
}

// ---------------------------------------------------------------------------------------------------- loads

double total_mass(const BuiltDevice& device, const FigureOptions&) {
  return moving_mass(device.mechanism());
}

// The postures of the device file that close; empty if one does not, or there is none.
std::vector<Posture> named_postures(const BuiltDevice& device) {
  std::vector<Posture> postures;
  for (const PostureDescription& one : device.description().postures) {
    const ActiveVector active =
        Eigen::Map<const Eigen::VectorXd>(one.joints.data(), static_cast<Eigen::Index>(one.joints.size()));
    const Solution solution = solve_forward(device.mechanism(), active);
    if (!solution) return {};
    postures.push_back(*solution.posture);
  }
  return postures;
}

std::vector<FigureOption> joint_range_options() {
  return {{"first_joint", 0, Dimension::number, "of the active joints that count, from 0"},
          {"last_joint", 1000, Dimension::number, "of the active joints that count"}};
}
double demand_utilisation(const BuiltDevice& device, LoadKind kind, const FigureOptions& options) {
  std::vector<SizingPosture> postures;
  for (const Posture& posture : named_postures(device)) postures.push_back({"", posture});
  const std::vector<LoadDescription>& loads = device.description().loads;
  if (postures.empty() || loads.empty()) return kUndefined;
  const Capability capability = [&](const Posture& posture, LoadKind of) {
    return torque_range(device.drives(), device.pneumatic_drives(), posture.active(), of == LoadKind::peak);
  };
  double worst = kUndefined;
  const Sizing sizing = size_drives(postures, loads, capability);
  const std::vector<JointDemand>& demands = sizing.demands(kind);
  for (std::size_t i = 0; i < demands.size(); ++i) {
    const JointDemand& demand = demands[i];
    const auto joint = static_cast<double>(i);
    if (demand.posture < 0 || joint < options.get("first_joint", 0.0) ||
        joint > options.get("last_joint", 1000.0)) {
      continue;
    }
    worst = std::isnan(worst) ? demand.utilisation : std::max(worst, demand.utilisation);
  }
  return worst;
}
double continuous_utilisation(const BuiltDevice& device, const FigureOptions& options) {
  return demand_utilisation(device, LoadKind::continuous, options);
}
double peak_utilisation(const BuiltDevice& device, const FigureOptions& options) {
  return demand_utilisation(device, LoadKind::peak, options);
}

double balance_torque(const BuiltDevice& device, const FigureOptions& options) {
  const auto count = static_cast<std::int64_t>(options.get("postures", 64.0));
  double worst = kUndefined;
  for (std::int64_t i = 0; i < count; ++i) {
    const Solution solution = solve_forward(device.mechanism(), spread_posture(device.mechanism(), i));
    if (!solution) continue;
    const double torque = gravity_torques(*solution.posture).cwiseAbs().maxCoeff();
    worst = std::isnan(worst) ? torque : std::max(worst, torque);
  }
  return worst;
}

constexpr double kAngleStep = 2.0 * std::numbers::pi / 180.0;
const FiveBarDescription* five_bar_of(const BuiltDevice& device) {
  return std::get_if<FiveBarDescription>(&device.description().mechanism);
}
// The points of the last sampling asked for on this thread: all designs of a study have the same.
const PolarPoints& points_of(const PolarSampling& sampling, double reach) {
  struct Kept {
    PolarSampling sampling;
    double reach = -1.0;
    PolarPoints points;
  };
  thread_local Kept kept;
  if (kept.sampling != sampling || reach > kept.reach) {
    kept = {sampling, 1.5 * reach, polar_points(sampling, 1.5 * reach)};
  }
  return kept.points;
}

double badly_conditioned_points(const BuiltDevice& device, const FigureOptions& options) {
  const FiveBarDescription* five_bar = five_bar_of(device);
  if (five_bar == nullptr) return kUndefined;
  const PolarSampling sampling{.radius_step = options.get("radius_step", 0.01),
                               .angle_step = options.get("angle_step", kAngleStep)};
  const bool valid = sampling.radius_step > 0.0 && sampling.angle_step > 0.0;
  if (!valid) return kUndefined;
  const FiveBarBatch::Count found = badly_conditioned(
      {.crank = five_bar->crank, .coupler = five_bar->coupler, .half_base = five_bar->half_base},
      {five_bar->left_mode, five_bar->right_mode}, points_of(sampling, five_bar->crank + five_bar->coupler),
      options.get("limit", 5.0));
  return found.reachable > 0 ? static_cast<double>(found.above) : kUndefined;
}

constexpr double kArmRange = 30.0 * std::numbers::pi / 180.0;
std::vector<FigureOption> cylinder_options() {
  return {{"drive", 0.0, Dimension::number, "which pneumatic drive, from 0"},
          {"load", 10.0, Dimension::force, "hung on the arm"},
          {"distance", 0.1, Dimension::length, "of the load from the arm's pivot"},
          {"range", kArmRange, Dimension::angle, "of the arm to either side"}};
}
const ArmCylinderDescription* mount_of(const BuiltDevice& device, const FigureOptions& options) {
  const auto index = static_cast<std::size_t>(std::max(0.0, options.get("drive", 0.0)));
  const auto& drives = device.description().pneumatic_drives;
  return index < drives.size() ? std::get_if<ArmCylinderDescription>(&drives[index].mount) : nullptr;
}
Interval range_of(const FigureOptions& options) {
  const double range = options.get("range", kArmRange);
  return {-range, range};
}
double cylinder_peak_force(const BuiltDevice& device, const FigureOptions& options) {
  const ArmCylinderDescription* mount = mount_of(device, options);
  if (mount == nullptr) return kUndefined;
  const auto peak = ArmCylinder(*mount).peak_required_force(options.get("load", 10.0),
                                                            options.get("distance", 0.1), range_of(options));
  return peak ? peak->force : kUndefined;
}
double cylinder_length(const BuiltDevice& device, const FigureOptions& options, bool longest) {
  const ArmCylinderDescription* mount = mount_of(device, options);
  if (mount == nullptr) return kUndefined;
  const ArmCylinder arm(*mount);
  const Interval range = range_of(options);
  if (!arm.keeps_direction(range)) return kUndefined;
  const double a = arm.length(range.min), b = arm.length(range.max);
  return longest ? std::max(a, b) : std::min(a, b);
}
double cylinder_length_min(const BuiltDevice& device, const FigureOptions& options) {
  return cylinder_length(device, options, false);
}
double cylinder_length_max(const BuiltDevice& device, const FigureOptions& options) {
  return cylinder_length(device, options, true);
}

}  // namespace

FigureTable device_figures() {
  FigureTable list;
  std::string topic = "Workspace";
  const auto add = [&](FigureDefinition figure) {
    figure.topic = topic;
    figure.of_posture = figure.of != nullptr;
    list.push_back(std::move(figure));
  };
  for (const bool orientations : {false, true}) {
    const std::string what = orientations ? "orientation" : "direction";
    const std::string words = orientations ? "of all orientations" : "of all directions of the tool's axis";
    add({.name = what + "_share",
         .unit = "1",
         .meaning = "share " + words + " that an arm's tool can have at this position",
         .answers = {{"report arm.home.turning." + what + "s.share"}},
         .of = [orientations](PostureFigures& at, const FigureOptions&) {
           const OrientationsAt* found = orientations_here(at);
           if (found == nullptr || (orientations && !found->orientations)) return kUndefined;
           return orientations ? found->orientations->value : found->directions.value;
         }});
  }
  add({.name = "workspace_volume",
       .unit = "m^n",
       .meaning = "volume of the workspace, or its area in a plane; of a platform that turns in its home "
                  "orientation, of an "
                  "arm whatever the orientation",
       .options = reach_options(),
       .answers = {{"report workspace.volume"}, {"report workspace.area"}, {"report arm.reach.volume"}},
       .of_device = volume});
  add({.name = "inscribed_radius",
       .unit = "m",
       .meaning = "radius of the largest sphere, or circle, in that workspace",
       .options = reach_options(),
       .answers = {{"report workspace.inscribed_sphere.radius"},
                   {"report workspace.inscribed_circle.radius"},
                   {"report arm.reach.inscribed_sphere.radius"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         return inscribed(device, options, &InscribedShapes::sphere);
       }});
  add({.name = "inscribed_edge",
       .unit = "m",
       .meaning = "edge of the largest cube, or square, in that workspace, its edges along the axes",
       .options = reach_options(),
       .answers = {{"report workspace.inscribed_cube.edge"},
                   {"report workspace.inscribed_square.edge"},
                   {"report arm.reach.inscribed_cube.edge"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         return inscribed(device, options, &InscribedShapes::cube);
       }});
  for (int axis = 0; axis < 3; ++axis) {
    const std::string letter = kAxisNames[axis];
    add({.name = "extent_" + letter,
         .unit = "m",
         .meaning = "how far that workspace extends along " + letter,
         .axis = axis,
         .options = reach_options(),
         .of_device = [axis](const BuiltDevice& device, const FigureOptions& options) {
           const auto range = extent(device, axis, options);
           return range ? range->width() : kUndefined;
         }});
    for (const bool upper : {false, true}) {
      const std::string index = upper ? "[1]" : "[0]";
      const std::string words = std::string(upper ? "upper" : "lower") + " end along " + letter;
      add({.name = "extent_" + letter + (upper ? "_max" : "_min"),
           .unit = "m",
           .meaning = "its " + words,
           .axis = axis,
           .options = reach_options(),
           .answers = {{"report workspace.ranges." + letter + index}},
           .of_device = [=](const BuiltDevice& device, const FigureOptions& options) {
             const auto range = extent(device, axis, options);
             return !range ? kUndefined : upper ? range->max : range->min;
           }});
      add({.name = "reach_" + letter + (upper ? "_max" : "_min"),
           .unit = "m",
           .meaning = words + " of where the tool gets at all, however it is turned",
           .answers = {{"report arm.ranges." + letter + index}},
           .of_device = [=](const BuiltDevice& device, const FigureOptions&) {
             if (device.mechanism().linear_rows() == 0) return kUndefined;
             const double sign = upper ? 1.0 : -1.0;
             return sign * farthest_along(device.mechanism(), sign * Vector3::Unit(axis)).distance;
           }});
    }
  }
  add({.name = "farthest_reach",
       .unit = "m",
       .meaning = "farthest that the tool gets from the base origin",
       .answers = {{"report arm.farthest.distance"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions&) {
         return device.mechanism().linear_rows() > 0
                    ? farthest_from(device.mechanism(), Vector3::Zero()).distance
                    : kUndefined;
       }});
  const std::vector<FigureOption> region = {
      {"limit", 5.0, Dimension::number, "of the condition number"},
      {"points", 401, Dimension::number, "along the longer side of the plane"}};
  add({.name = "dexterous_area",
       .unit = "m^2",
       .meaning = "of a tool in a plane, the area where the condition number is below a limit",
       .options = region,
       .answers = {{"report workspace.dexterous.area"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         const DexterousRegion* found = dexterous_of(device, options);
         return found != nullptr ? found->area : kUndefined;
       }});
  for (const bool outer : {false, true}) {
    add({.name = outer ? "annulus_outer_radius" : "annulus_inner_radius",
         .unit = "m",
         .meaning = std::string(outer ? "outer" : "inner") +
                    " radius of the widest whole ring about the origin in that area",
         .options = region,
         .answers = {{outer ? "report workspace.dexterous.annulus[1]"
                            : "report workspace.dexterous.annulus[0]"}},
         .of_device = [outer](const BuiltDevice& device, const FigureOptions& options) {
           const DexterousRegion* found = dexterous_of(device, options);
           if (found == nullptr || !found->annulus) return kUndefined;
           return outer ? found->annulus->max : found->annulus->min;
         }});
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      const std::string letter = kAxisNames[axis];
      add({.name = "turning_" + letter + (upper ? "_max" : "_min"),
           .unit = "rad",
           .meaning = "how far a platform at home turns about " + letter + " alone, the " +
                      (upper ? "positive" : "negative") + " way",
           .axis = axis + 3,
           .options = {reach_options()[0]},
           .answers = {{"report workspace.turning.about." + letter + (upper ? "[1]" : "[0]")}},
           .of_device = [=](const BuiltDevice& device, const FigureOptions& options) {
             const PoseWorkspace* pose =
                 reach_of(device) == Reach::platform ? pose_of(device, options) : nullptr;
             if (pose == nullptr || !pose->turning.about[static_cast<std::size_t>(axis)]) return kUndefined;
             const Interval range = *pose->turning.about[static_cast<std::size_t>(axis)];
             return upper ? range.max : range.min;
           }});
    }
  }
  add({.name = "turning_share",
       .unit = "1",
       .meaning = "share of all orientations that a platform reaches at its home position",
       .options = {reach_options()[0]},
       .answers = {{"report workspace.turning.share"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         const PoseWorkspace* pose = reach_of(device) == Reach::platform ? pose_of(device, options) : nullptr;
         return pose != nullptr ? pose->turning.share.value_or(kUndefined) : kUndefined;
       }});
  const std::vector<FigureOption> anyhow = {
      {"any_places", 4000, Dimension::number, "about how many are looked at, a quarter of them in a plane"}};
  const auto add_anyhow = [&](const std::string& name, const std::string& unit, const std::string& words,
                              int axis, std::vector<FigureAnswer> answers, std::vector<FigureOption> options,
                              auto of) {
    add({.name = "any_orientation_" + name,
         .unit = unit,
         .meaning = words + " a platform that turns as its joints need",
         .axis = axis,
         .options = std::move(options),
         .answers = std::move(answers),
         .of_device = [of](const BuiltDevice& device, const FigureOptions& given) {
           const AnyOrientation* found = anyhow_of(device, given);
           return found != nullptr ? of(*found, given) : kUndefined;
         }});
  };
  add_anyhow("volume", "m^n", "volume, or area in a plane, of the places of", -1,
             {{"report workspace.any_orientation.volume"},
              {"report workspace.any_orientation.area"},
              {"report workspace.any_orientation.length"}},
             anyhow, [](const AnyOrientation& found, const FigureOptions&) { return found.measure; });
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      const std::string letter = kAxisNames[axis];
      add_anyhow(letter + (upper ? "_max" : "_min"), "m",
                 std::string(upper ? "upper" : "lower") + " end along " + letter + " of the places of", axis,
                 {{"report workspace.any_orientation.ranges." + letter + (upper ? "[1]" : "[0]")}}, anyhow,
                 [=](const AnyOrientation& found, const FigureOptions&) {
                   const Interval range = found.range[static_cast<std::size_t>(axis)];
                   return upper ? range.max : range.min;
                 });
    }
  }
  for (const auto& [name, words, of] : {std::tuple("mean", "mean", &AnyOrientation::Spread::mean),
                                        std::tuple("least", "smallest", &AnyOrientation::Spread::least),
                                        std::tuple("most", "largest", &AnyOrientation::Spread::most)}) {
    add_anyhow(std::string("share_") + name, "1",
               std::string(words) + " share of all orientations, over the places of", -1,
               {{std::string("report workspace.any_orientation.share.") + name}}, anyhow,
               [of = of](const AnyOrientation& found, const FigureOptions&) {
                 return found.share ? (*found.share).*of : kUndefined;
               });
  }
  std::vector<FigureOption> every_way = anyhow;
  every_way.push_back({"level", 3, Dimension::number, "0 10 deg, 1 20 deg, 2 30 deg, 3 45 deg"});
  add_anyhow("turned_volume", "m^n", "volume, or area in a plane, where it turns so far about every axis, of",
             -1,
             {{"report workspace.any_orientation.turned_every_way[level].volume"},
              {"report workspace.any_orientation.turned_every_way[level].area"}},
             every_way, [](const AnyOrientation& found, const FigureOptions& given) {
               const int level = index_of(given, "level", 3.0);
               if (level < 0 || level >= static_cast<int>(found.turned.size())) return kUndefined;
               return found.turned[static_cast<std::size_t>(level)].measure;
             });
  const std::vector<FigureOption> turned = {
      {"places", 50, Dimension::number, "about how many are looked at"},
      {"cubes", 50000, Dimension::number, "into how many the box around the arm is cut"}};
  for (const bool orientations : {false, true}) {
    const std::string what = orientations ? "orientation" : "direction";
    const auto spread_of = [orientations](const BuiltDevice& device,
                                          const FigureOptions& options) -> const ShareSpread* {
      const OrientationWorkspace* found = orientations_of(device, options);
      if (found == nullptr || (orientations && !found->orientations)) return nullptr;
      return orientations ? &*found->orientations : &found->directions;
    };
    const auto add_spread = [&](const std::string& end, const std::string& words, const std::string& place,
                                double ShareSpread::*of) {
      add({.name = what + "_share_" + end,
           .unit = "1",
           .meaning = words + " share of " + what + "s that an arm's tool can have, over its reach",
           .options = turned,
           .answers = {{"report arm.orientations." + what + "s." + place}},
           .of_device = [=](const BuiltDevice& device, const FigureOptions& options) {
             const ShareSpread* spread = spread_of(device, options);
             return spread != nullptr ? spread->*of : kUndefined;
           }});
    };
    add_spread("mean", "mean", "mean", &ShareSpread::mean);
    add_spread("min", "smallest", "least", &ShareSpread::least);
    add_spread("max", "largest", "most", &ShareSpread::most);
    std::vector<FigureOption> levels = turned;
    levels.push_back({"level", 3, Dimension::number, "0 a quarter, 1 half, 2 three quarters, 3 all of them"});
    add({.name = what + "_volume",
         .unit = "m^3",
         .meaning = "volume where an arm's tool can have a share of all " + what + "s",
         .options = levels,
         .answers = {{"report arm.orientations." + what + "s.volumes[level].volume"}},
         .of_device = [=](const BuiltDevice& device, const FigureOptions& options) {
           const ShareSpread* spread = spread_of(device, options);
           const int level = index_of(options, "level", 3.0);
           if (spread == nullptr || level < 0 || level >= static_cast<int>(spread->volume.size()))
             return kUndefined;
           return spread->volume[static_cast<std::size_t>(level)];
         }});
  }

  topic = "Mass and loads of the whole";
  add({.name = "moving_mass",
       .unit = "kg",
       .meaning = "mass of all bodies",
       .answers = {{"report mechanism.moving_mass"}},
       .of_device = total_mass});
  const char* moduli[] = {"axial", "transverse", "shear"};
  double WallModuli::*const modulus[] = {&WallModuli::axial, &WallModuli::transverse, &WallModuli::shear};
  for (std::size_t m = 0; m < 3; ++m) {
    add({.name = std::string("laminate_") + moduli[m] + "_modulus",
         .unit = "Pa",
         .meaning = std::string(moduli[m]) + " modulus of a laminated link",
         .options = {{"laminate", 0, Dimension::number, "which laminated link, from 0"},
                     {"rule", 0, Dimension::number, "0 by lamination theory, 1 by the mean of the plies"}},
         .answers = {{std::string("report laminates[laminate].lamination.") + moduli[m], {{"rule", 0.0}}},
                     {std::string("report laminates[laminate].mean.") + moduli[m], {{"rule", 1.0}}}},
         .of_device = [of = modulus[m]](const BuiltDevice& device, const FigureOptions& options) {
           const std::vector<LaminateComparison> found = laminate_comparisons(device.description());
           const int which = index_of(options, "laminate");
           if (which < 0 || which >= static_cast<int>(found.size())) return kUndefined;
           const LaminateComparison& one = found[static_cast<std::size_t>(which)];
           return finite_or_undefined((options.get("rule", 0.0) == 0.0 ? one.lamination : one.mean).*of);
         }});
  }
  add({.name = "continuous_utilisation",
       .unit = "1",
       .meaning = "torque of the continuous loads in the named postures over what the drives give, the largest",
       .needs_drives = true,
       .options = joint_range_options(),
       .of_device = continuous_utilisation});
  add({.name = "peak_utilisation",
       .unit = "1",
       .meaning = "the same of the peak loads",
       .needs_drives = true,
       .options = joint_range_options(),
       .of_device = peak_utilisation});
  add({.name = "balance_torque",
       .unit = "N m",
       .meaning = "largest torque of the links' weight over the joint ranges",
       .options = {{"postures", 64, Dimension::number,
                    "how many postures, spread evenly over the joint ranges"}},
       .of_device = balance_torque});

  topic = "By the searches of the sources";
  add({.name = "badly_conditioned_points",
       .unit = "1",
       .meaning = "of a five-bar, sampled points with a condition number above the limit",
       .options = {{"limit", 5.0, Dimension::number, "of the condition number"},
                   {"radius_step", 0.01, Dimension::length, "between the circles of points about the origin"},
                   {"angle_step", kAngleStep, Dimension::angle, "between points of a circle"}},
       .of_device = badly_conditioned_points});
  add({.name = "cylinder_peak_force",
       .unit = "N",
       .meaning = "largest cylinder force that lifts a load over the arm's range",
       .options = cylinder_options(),
       .of_device = cylinder_peak_force});
  add({.name = "cylinder_length_min",
       .unit = "m",
       .meaning = "shortest distance of the cylinder's pins over the arm's range",
       .options = cylinder_options(),
       .of_device = cylinder_length_min});
  add({.name = "cylinder_length_max",
       .unit = "m",
       .meaning = "longest distance of the cylinder's pins over the arm's range",
       .options = cylinder_options(),
       .of_device = cylinder_length_max});
  return list;
}

}  // namespace zwidth::internal
