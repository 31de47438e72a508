#include "sheet_arm.h"

#include <fmt/format.h>

#include "mechanics.h"
#include "sheet_json.h"
#include "sheet_text.h"
#include "statistic_text.h"
#include "terminal.h"

namespace zwidth {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

class TableBuilder {
 public:
  TableBuilder(std::string id, std::string title, std::string how, bool quantiles = false)
      : table_{std::move(id), std::move(title), std::move(how), {}, quantiles} {}
  void how(std::string text) { table_.how = std::move(text); }

  void row(std::string name, const PostureStatistic& statistic, double factor, std::string unit) {
    if (statistic.count > 0) table_.rows.push_back({std::move(name), &statistic, factor, std::move(unit)});
  }
  void axes(const std::string& name, const std::array<PostureStatistic, 3>& statistics, double factor,
            const std::string& unit) {
    for (int k = 0; k < 3; ++k) row(fmt::format("{} {}", name, kAxes[k]), statistics[k], factor, unit);
  }
  void into(std::vector<PostureTable>& tables) {
    if (!table_.rows.empty()) tables.push_back(std::move(table_));
  }

 private:
  PostureTable table_;
};

std::string joint_text(const Mechanism& mechanism, int i, double value) {
  const bool slides =
      mechanism.joints()[static_cast<std::size_t>(mechanism.active_joint(i))].type == JointType::prismatic;
  if (std::abs(value) < 1e-12) value = 0.0;
  return slides ? quantity(value, kMilli, "mm") : fmt::format("{}°", trimmed(value * kDegrees, 5));
}

std::string loads_text(const ToolVector& loads, Eigen::Index first, Eigen::Index count, const char* unit) {
  std::string text;
  for (Eigen::Index r = first; r < first + count; ++r) text += (text.empty() ? "" : ", ") + number(loads[r], 3);
  return fmt::format("{} {}", text, unit);
}

Json axes_json(const std::array<PostureStatistic, 3>& statistics) {
  return {{"x", statistic_json(statistics[0])},
          {"y", statistic_json(statistics[1])},
          {"z", statistic_json(statistics[2])}};
}

Json loads_json(const PostureSweep& sweep) {
  return {{"force", axes_json(sweep.force)},
          {"force_every_direction", statistic_json(sweep.weakest_force)},
          {"moment", axes_json(sweep.moment)},
          {"moment_every_direction", statistic_json(sweep.weakest_moment)}};
}

Json farthest_json(const FarthestPosture& farthest) {
  return {{"distance", json_number(farthest.distance)},
          {"position", json_array(farthest.position)},
          {"joints", json_array(farthest.active)}};
}

Json conditioning_json(const PostureSweep& sweep) {
  return {{"postures", sweep.solved},
          {"translation", conditioning_json(sweep.translation)},
          {"best_joints", sweep.translation_conditioning.count > 0
                              ? json_array(sweep.translation_conditioning.max_at)
                              : Json(nullptr)},
          {"rotation", conditioning_json(sweep.rotation)},
          {"homogeneous", conditioning_json(sweep.homogeneous)},
          {"characteristic_length", json_number(sweep.characteristic_length)}};
}

Json ranges_json(const ArmSheet& arm) {
  Json ranges;
  for (int k = 0; k < 3; ++k) {
    ranges[kAxes[k]] = {json_number(arm.ends[k][0].distance), json_number(arm.ends[k][1].distance)};
  }
  return ranges;
}

Json volume_json(const ReachSheet& reach) {
  return {{"volume", json_number(reach.volume.value)},
          {"volume_error", json_number(reach.volume.error_estimate)},
          {"inscribed_sphere",
           {{"centre", json_array(reach.inscribed.sphere.centre)},
            {"radius", json_number(reach.inscribed.sphere.size)}}},
          {"inscribed_cube",
           {{"centre", json_array(reach.inscribed.cube.centre)},
            {"edge", json_number(reach.inscribed.cube.size)}}}};
}

Json share_json(const Share& share) {
  return {{"share", json_number(share.value)}, {"error", json_number(share.error)}};
}

Json turning_json(const OrientationsAt& turning) {
  return {{"reached", turning.reached},
          {"orientations", turning.orientations ? share_json(*turning.orientations) : Json(nullptr)},
          {"directions", share_json(turning.directions)}};
}

Json spread_json(const ShareSpread& spread) {
  Json volumes = Json::array();
  for (size_t level = 0; level < kShareLevels.size(); ++level) {
    volumes.push_back({{"share", kShareLevels[level]},
                       {"volume", json_number(spread.volume[level])},
                       {"error", json_number(spread.volume_error[level])}});
  }
  return {{"mean", json_number(spread.mean)},
          {"least", json_number(spread.least)},
          {"most", json_number(spread.most)},
          {"volumes", volumes}};
}

}  // namespace

Json orientations_json(const std::optional<OrientationWorkspace>& workspace) {
  if (!workspace) return nullptr;
  return {{"places", workspace->places},
          {"spacing", json_number(workspace->spacing)},
          {"tool_axis", json_array(workspace->tool_axis)},
          {"orientations", workspace->orientations ? spread_json(*workspace->orientations) : Json(nullptr)},
          {"directions", spread_json(workspace->directions)}};
}

namespace {

std::string axis_text(const Vector3& axis) {
  for (int k = 0; k < 3; ++k) {
    if (axis == Vector3::Unit(k)) return kAxes[k];
  }
  return point_text(axis);
}

std::string share_text(const Share& share) {
  return fmt::format("{} %", number(100.0 * share.value, 3)) +
         (share.error > 0.0 ? fmt::format(" ± {}", number(100.0 * share.error, 2)) : "");
}

}  // namespace

std::vector<PostureTable> arm_tables(const DataSheet& sheet, const Mechanism& mechanism) {
  const ArmSheet& arm = *sheet.arm;
  const PostureSweep& sweep = arm.continuous;
  const std::string postures = fmt::format("{} postures spread evenly over the joint ranges", sweep.solved);
  std::vector<PostureTable> tables;

  TableBuilder dexterity("dexterity", "Dexterity over the joint ranges",
                         postures + ". Conditioning is 1/(condition number): 1 is isotropic, 0 singular.");
  dexterity.row("conditioning, translation", sweep.translation_conditioning, 1.0, "");
  if (sweep.rotation_conditioning.max > 0.0)  // else it does not turn every way, wherever it is
    dexterity.row("conditioning, rotation", sweep.rotation_conditioning, 1.0, "");
  double factor = 1.0;
  const std::string unit = manipulability_unit(mechanism, mechanism.linear_rows(), factor);
  dexterity.row("manipulability, translation", sweep.manipulability, factor, unit);
  dexterity.into(tables);

  TableBuilder force(
      "force", "Force over the joint ranges",
      postures +
          ". Pure forces, and pure moments, within the torque limits of every joint; along an axis "
          "whichever way is weaker. The device's weight is not taken off.");
  for (const auto& [name, loads] :
       {std::pair{"continuous", &arm.continuous}, std::pair{"peak", arm.peak ? &*arm.peak : nullptr}}) {
    if (loads == nullptr) continue;
    force.axes(fmt::format("{} force, along", name), loads->force, 1.0, "N");
    force.row(fmt::format("{} force, every direction", name), loads->weakest_force, 1.0, "N");
    force.axes(fmt::format("{} moment, about", name), loads->moment, kMilli, "mN m");
    force.row(fmt::format("{} moment, every direction", name), loads->weakest_moment, kMilli, "mN m");
  }
  force.into(tables);

  TableBuilder inertia("inertia", "Inertia felt at the tool", "", true);
  if (sheet.mechanics_of_postures) {
    const MechanicalPostures& masses = *sheet.mechanics_of_postures;
    inertia.how(
        fmt::format("{} postures spread evenly over the joint ranges. Against pure forces, with rotors and "
                    "transmissions.",
                    masses.solved));
    inertia.row("in the lightest direction", masses[MechanicalFigure::lightest], kMilli, "g");
    inertia.row("in the heaviest direction", masses[MechanicalFigure::heaviest], kMilli, "g");
    const ShownUnit shown = gravity_unit(sheet.joint_slides);
    inertia.row(gravity_label(sheet.joint_slides), masses[MechanicalFigure::gravity_torque], shown.factor,
                shown.unit);
  }
  inertia.into(tables);

  TableBuilder resolution("resolution", "Resolution at the tool",
                          postures + ". When every joint moves by its resolution, at worst.");
  resolution.axes("smallest step along", sweep.step, 1e6, "µm");
  resolution.row("smallest turn", sweep.turn_step, kDegrees, "°");
  resolution.into(tables);
  return tables;
}

std::vector<ArmFact> reach_facts(const ArmSheet& arm, const Mechanism& mechanism) {
  std::vector<ArmFact> facts;
  if (arm.reach) {
    const ReachableVolume& volume = arm.reach->volume;
    facts.push_back(
        {"volume",
         fmt::format("{} ± {}", quantity(volume.value, 1e3, "dm³", 5),
                     quantity(volume.error_estimate, 1e3, "dm³", 2)),
         fmt::format("of the tool point, any orientation; cubes of {}", readable(volume.spacing, "m", 3))});
  }
  for (int k = 0; k < 3; ++k) {
    const double low = arm.ends[k][0].distance, high = arm.ends[k][1].distance;
    if (mechanism.platform() == PlatformFreedom::planar && k == 2) continue;
    facts.push_back({fmt::format("range of {}", kAxes[k]), interval(low, high, kMilli, "mm"),
                     quantity(high - low, kMilli, "mm wide")});
  }
  facts.push_back({"farthest", quantity(arm.farthest.distance, kMilli, "mm"), "from the base origin"});
  if (arm.reach) {
    const InscribedShapes& inscribed = arm.reach->inscribed;
    facts.push_back({"largest sphere",
                     fmt::format("{} diameter", quantity(2.0 * inscribed.sphere.size, kMilli, "mm")),
                     "centre " + point_text(inscribed.sphere.centre)});
    facts.push_back({"largest cube", fmt::format("{} edge", quantity(inscribed.cube.size, kMilli, "mm")),
                     "centre " + point_text(inscribed.cube.centre)});
  }
  const PostureSweep& sweep = arm.continuous;
  if (sweep.translation.weight() > 0.0) {
    facts.push_back({"global conditioning", number(sweep.translation.index(), 4),
                     "of translation, mean of 1/(condition number K) over postures; 1 is best"});
    facts.push_back({"share by K", "", shares_by_class(sweep.translation)});
    const PostureStatistic& best = sweep.translation_conditioning;
    if (best.count > 0 && best.max > 0.0) {
      std::string joints;
      for (int i = 0; i < mechanism.active_count(); ++i)
        joints += (i > 0 ? ", " : "") + joint_text(mechanism, i, best.max_at[i]);
      facts.push_back({"nearest to isotropic", fmt::format("K = {}", number(1.0 / best.max)), "at " + joints});
      facts.push_back({fmt::format("near isotropic, K < {:g}", kNearIsotropic),
                       near_isotropic_share(sweep.translation), "of the postures"});
    }
  }
  if (sweep.homogeneous.weight() > 0.0) {
    facts.push_back(
        {"with rotation", number(sweep.homogeneous.index(), 4),
         fmt::format("rotations made lengths by {}", readable(sweep.characteristic_length, "m", 3))});
  }
  return facts;
}

std::optional<PlaceOrientations> home_turning(const ArmSheet& arm) {
  if (!arm.home || !arm.home->turning) return std::nullopt;
  return PlaceOrientations{arm.home->tool.position, *arm.home->turning};
}

std::vector<ArmFact> orientation_facts(const std::optional<OrientationWorkspace>& workspace,
                                       const std::optional<PlaceOrientations>& place) {
  std::vector<ArmFact> facts;
  if (!workspace) return facts;
  const std::string axis = axis_text(workspace->tool_axis);
  if (place) {
    const std::string where = "at " + point_text(place->position);
    if (!place->turning.reached) return {{"place", "not reached", where}};
    if (place->turning.orientations)
      facts.push_back({"orientations", share_text(*place->turning.orientations), "of all, " + where});
    facts.push_back({fmt::format("directions of tool {}", axis), share_text(place->turning.directions),
                     "of the sphere, " + where});
  }
  const auto over_all = [&](const char* name, const char* whole, const ShareSpread& spread) {
    facts.push_back({fmt::format("{}, mean", name), fmt::format("{} %", number(100.0 * spread.mean, 3)),
                     fmt::format("over {} places, from {} to {} %", workspace->places,
                                 number(100.0 * spread.least, 3), number(100.0 * spread.most, 3))});
    facts.push_back({whole,
                     fmt::format("{} ± {}", quantity(spread.dexterous_volume(), 1e3, "dm³", 4),
                                 quantity(spread.volume_error.back(), 1e3, "dm³", 2)),
                     fmt::format("where all of them can be had; half of them in {} ± {}",
                                 quantity(spread.volume[1], 1e3, "dm³", 4),
                                 quantity(spread.volume_error[1], 1e3, "dm³", 2))});
  };
  if (workspace->orientations) over_all("orientations", "dexterous volume", *workspace->orientations);
  over_all("directions", "any direction", workspace->directions);
  return facts;
}

namespace {

/// Volume, area or length with its error, by how many axes there are.
std::string measure_text(double value, double error, int dimension) {
  const double factor = dimension == 3 ? 1e6 : dimension == 2 ? 1e4 : kMilli;
  const char* unit = dimension == 3 ? "cm³" : dimension == 2 ? "cm²" : "mm";
  return fmt::format("{} ± {}", quantity(value, factor, unit, 5), quantity(error, factor, unit, 2));
}

}  // namespace

std::string orientation_text(const Matrix3& rotation) {
  // R = Rz(yaw) Ry(pitch) Rx(roll), as --orientation has it.
  const double pitch = std::atan2(-rotation(2, 0), std::hypot(rotation(0, 0), rotation(1, 0)));
  const bool upright = std::hypot(rotation(0, 0), rotation(1, 0)) > 1e-9;
  const double roll = upright ? std::atan2(rotation(2, 1), rotation(2, 2)) : 0.0;
  const double yaw =
      upright ? std::atan2(rotation(1, 0), rotation(0, 0)) : std::atan2(-rotation(0, 1), rotation(1, 1));
  const auto degrees = [](double angle) { return trimmed(std::abs(angle) < 1e-9 ? 0.0 : angle * kDegrees, 5); };
  return fmt::format("roll {}°, pitch {}°, yaw {}°", degrees(roll), degrees(pitch), degrees(yaw));
}

namespace {

/// Where the search of a conditioning ended best.
std::string place_text(const PoseWorkspace& workspace, const Vector3& place) {
  return workspace.axes == std::vector<int>{0, 1} ? plane_point_text(place) : point_text(place);
}

/// In a plane an orientation is one angle.
std::string orientation_words(const Matrix3& rotation, bool in_plane) {
  const double yaw = std::atan2(rotation(1, 0), rotation(0, 0));
  return in_plane ? fmt::format("{}° about z", trimmed(std::abs(yaw) < 1e-9 ? 0.0 : yaw * kDegrees, 5))
                  : orientation_text(rotation);
}

}  // namespace

std::vector<ArmFact> pose_facts(const PoseWorkspace& workspace) {
  std::vector<ArmFact> facts;
  const int n = workspace.dimension();
  const bool in_plane = workspace.axes == std::vector<int>{0, 1};
  const std::string orientation = orientation_words(workspace.orientation, in_plane);
  if (!workspace.reached) return {{"orientation", "not reached", orientation}};
  if (n == 0) {
    if (workspace.rotation.figure.count > 0) {
      facts.push_back({"conditioning", number(workspace.rotation.of_all.index(), 4),
                       "mean of 1/(condition number K) over its orientations, 1 is best"});
      facts.push_back(
          {"  nearest to isotropic", fmt::format("K = {}", number(1.0 / workspace.rotation.figure.max)), ""});
      facts.push_back({fmt::format("  near isotropic, K < {:g}", kNearIsotropic),
                       near_isotropic_share(workspace.rotation.of_all), "of the orientations"});
      facts.push_back({"  share by K", "", shares_by_class(workspace.rotation.of_all)});
    }
    return facts;
  }
  facts.push_back({"orientation", orientation, "of the tool, kept"});
  if (workspace.unbounded) {
    facts.push_back({"workspace", "unbounded", "nothing ends it: give the sliding joints ranges"});
    return facts;
  }
  facts.push_back(
      {n == 3   ? "volume"
       : n == 2 ? "area"
                : "length",
       measure_text(workspace.measure, workspace.error_estimate, n),
       fmt::format("{} points of a lattice of {}", workspace.inside, readable(workspace.spacing, "m", 3))});
  for (const int axis : workspace.axes) {
    const Interval& range = workspace.range[static_cast<size_t>(axis)];
    facts.push_back({fmt::format("range of {}", kAxes[axis]), interval(range.min, range.max, kMilli, "mm"),
                     quantity(range.width(), kMilli, "mm wide")});
  }
  if (n > 1) {
    const InscribedShapes& inscribed = workspace.inscribed;
    facts.push_back({n == 3 ? "largest sphere" : "largest circle",
                     fmt::format("{} diameter", quantity(2.0 * inscribed.sphere.size, kMilli, "mm")),
                     "centre " + place_text(workspace, inscribed.sphere.centre)});
    facts.push_back({n == 3 ? "largest cube" : "largest square",
                     fmt::format("{} edge", quantity(inscribed.cube.size, kMilli, "mm")),
                     "centre " + place_text(workspace, inscribed.cube.centre)});
  }
  const auto conditioning = [&](const char* name, const PoseConditioning& part, const std::string& of) {
    if (part.figure.count == 0 || !(part.figure.max > 0.0)) return;  // it does not move every way at all
    facts.push_back({name, number(part.of_all.index(), 4), of});
    facts.push_back({"  nearest to isotropic", fmt::format("K = {}", number(1.0 / part.figure.max)),
                     "at " + place_text(workspace, part.figure.max_at)});
    facts.push_back({fmt::format("  near isotropic, K < {:g}", kNearIsotropic),
                     near_isotropic_share(part.of_all), "of the places"});
    facts.push_back({"  share by K", "", shares_by_class(part.of_all)});
  };
  conditioning("conditioning, translation", workspace.translation, "mean of 1/(condition number K), 1 is best");
  conditioning("conditioning, rotation", workspace.rotation, "");
  if (workspace.homogeneous.figure.count > 0) {
    conditioning("conditioning, both", workspace.homogeneous,
                 fmt::format("a radian counts as {}", readable(workspace.characteristic_length, "m", 3)));
  }
  return facts;
}

std::vector<ArmFact> pose_load_facts(const PoseWorkspace& workspace) {
  std::vector<ArmFact> facts;
  const auto add = [&](const std::string& name, const Statistic& statistic, double factor, const char* unit) {
    if (statistic.count == 0) return;
    facts.push_back({name, quantity(statistic.median.value_or(statistic.mean), factor, unit),
                     fmt::format("median; above {} at 95 of 100",
                                 quantity(statistic.percentile_5.value_or(statistic.min), factor, unit))});
  };
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("force along {}", kAxes[k]), workspace.force[k], 1.0, "N");
  add("force in every direction", workspace.weakest_force, 1.0, "N");
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("moment about {}", kAxes[k]), workspace.moment[k], kMilli, "mN m");
  add("moment in every direction", workspace.weakest_moment, kMilli, "mN m");
  return facts;
}

std::vector<ArmFact> any_orientation_facts(const PoseWorkspace& workspace) {
  std::vector<ArmFact> facts;
  if (!workspace.any || workspace.any->inside == 0) return facts;
  const AnyOrientation& any = *workspace.any;
  const int n = workspace.dimension();
  facts.push_back({n == 3   ? "volume"
                   : n == 2 ? "area"
                            : "length",
                   measure_text(any.measure, any.error_estimate, n),
                   fmt::format("{} points of a lattice of {}, in some orientation each", any.inside,
                               readable(any.spacing, "m", 3))});
  for (const int axis : workspace.axes) {
    const Interval& range = any.range[static_cast<size_t>(axis)];
    facts.push_back({fmt::format("range of {}", kAxes[axis]), interval(range.min, range.max, kMilli, "mm"),
                     "of the lattice points"});
  }
  if (any.share) {
    facts.push_back({"orientations, mean", fmt::format("{} %", number(100.0 * any.share->mean, 3)),
                     fmt::format("of all, over {} places, from {} to {} %", any.places,
                                 number(100.0 * any.share->least, 3), number(100.0 * any.share->most, 3))});
  }
  for (const AnyOrientation::Turned& turned : any.turned) {
    if (!(turned.angle > 0.0)) continue;
    facts.push_back({fmt::format("turns {:g}° every way in", std::round(turned.angle * kDegrees)),
                     measure_text(turned.measure, turned.error, n),
                     any.measure > 0.0 ? fmt::format("{} % of that, from the home orientation",
                                                     number(100.0 * turned.measure / any.measure, 3))
                                       : ""});
  }
  return facts;
}

std::vector<ArmFact> turning_facts(const TurningRange& turning) {
  const bool in_plane = !turning.about[0] && !turning.about[1];
  const std::string from = orientation_words(turning.orientation, in_plane);
  const std::string where =
      "at " + (in_plane ? plane_point_text(turning.position) : point_text(turning.position));
  if (!turning.reached) return {{"place", "not reached", where + ", in " + from}};
  std::vector<ArmFact> facts;
  for (int k = 0; k < 3; ++k) {
    const std::optional<Interval>& range = turning.about[static_cast<size_t>(k)];
    if (!range) continue;
    const bool whole = range->width() > 6.2831;
    facts.push_back({fmt::format("turns about {}", kAxes[k]),
                     whole ? "all round" : interval(range->min, range->max, kDegrees, "°"),
                     facts.empty() ? where + ", from " + from : std::string(whole ? "" : "alone")});
  }
  const std::size_t ways = facts.size();
  if (turning.share && ways == 2) {
    facts.push_back(
        {"directions",
         fmt::format("{} ± {} %", number(100.0 * *turning.share, 3), number(100.0 * turning.share_error, 1)),
         "of the sphere, for the axis that it does not turn about"});
  }
  if (turning.share && ways == 3) {
    facts.push_back(
        {"orientations",
         fmt::format("{} ± {} %", number(100.0 * *turning.share, 3), number(100.0 * turning.share_error, 1)),
         "of all orientations, about any axis, without leaving the workspace between"});
  }
  return facts;
}

std::vector<ArmFact> home_facts(const ArmSheet& arm, const Mechanism& mechanism) {
  std::vector<ArmFact> facts;
  if (!arm.home) return facts;
  const HomePosture& home = *arm.home;
  std::string joints;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    joints += (i > 0 ? ", " : "") + joint_text(mechanism, i, home.active[i]);
  }
  facts.push_back({"joints", joints, ""});
  facts.push_back({"position", point_text(home.tool.position), ""});
  facts.push_back({"condition number",
                   std::isfinite(home.translation.condition_number) ? number(home.translation.condition_number)
                                                                    : "singular",
                   "of translation"});
  const Eigen::Index linear = mechanism.linear_rows();
  for (const auto& [name, loads] :
       {std::pair{"continuous", &home.continuous_loads}, std::pair{"peak", &home.peak_loads}}) {
    if (loads->size() == 0) continue;
    std::string along, about;
    for (const int axis : mechanism.tool_axes()) {
      std::string& text = axis < 3 ? along : about;
      text += fmt::format("{}{}", text.empty() ? "" : ", ", kAxes[axis % 3]);
    }
    if (linear > 0)
      facts.push_back({fmt::format("{} force", name), loads_text(*loads, 0, linear, "N"), "along " + along});
    if (loads->size() > linear) {
      const ToolVector milli = *loads * kMilli;
      facts.push_back({fmt::format("{} moment", name),
                       loads_text(milli, linear, loads->size() - linear, "mN m"), "about " + about});
    }
  }
  return facts;
}

Json arm_json(const DataSheet& sheet) {
  const ArmSheet& arm = *sheet.arm;
  Json entry;
  entry["postures"] = arm.continuous.solved;
  entry["translation_conditioning"] = statistic_json(arm.continuous.translation_conditioning);
  entry["rotation_conditioning"] = statistic_json(arm.continuous.rotation_conditioning);
  entry["manipulability"] = statistic_json(arm.continuous.manipulability);
  entry["conditioning"] = conditioning_json(arm.continuous);
  entry["continuous"] = loads_json(arm.continuous);
  entry["peak"] = arm.peak ? loads_json(*arm.peak) : Json(nullptr);
  entry["step"] = axes_json(arm.continuous.step);
  entry["turn_step"] = statistic_json(arm.continuous.turn_step);
  const auto mass = [&sheet](MechanicalFigure which) {
    return sheet.mechanics_of_postures ? statistic_json((*sheet.mechanics_of_postures)[which]) : Json(nullptr);
  };
  entry["lightest"] = mass(MechanicalFigure::lightest);
  entry["heaviest"] = mass(MechanicalFigure::heaviest);
  entry["gravity_torque"] = statistic_json(arm.continuous.gravity_torque);
  entry["ranges"] = ranges_json(arm);
  entry["farthest"] = farthest_json(arm.farthest);
  if (arm.home) {
    entry["home"] = {{"joints", json_array(arm.home->active)},
                     {"position", json_array(arm.home->tool.position)},
                     {"orientation", json_array(arm.home->tool.rotation)},
                     {"jacobian", json_array(arm.home->jacobian)},
                     {"condition_number", json_number(arm.home->translation.condition_number)},
                     {"gravity_torques", json_array(arm.home->gravity_torques)},
                     {"continuous_loads", json_array(arm.home->continuous_loads)},
                     {"peak_loads", json_array(arm.home->peak_loads)},
                     {"turning", arm.home->turning ? turning_json(*arm.home->turning) : Json(nullptr)}};
  } else {
    entry["home"] = nullptr;
  }
  entry["reach"] = nullptr;
  if (arm.reach) {
    entry["reach"] = volume_json(*arm.reach);
    entry["reach"]["spacing"] = json_number(arm.reach->volume.spacing);
  }
  entry["orientations"] = orientations_json(arm.orientations);
  return entry;
}

Json reach_json(const ArmSheet& arm) {
  Json entry = volume_json(*arm.reach);
  entry["ranges"] = ranges_json(arm);
  entry["farthest"] = farthest_json(arm.farthest);
  entry["conditioning"] = conditioning_json(arm.continuous);
  return entry;
}

Json pose_json(const PoseWorkspace& workspace) {
  Json entry;
  const int n = workspace.dimension();
  entry["orientation"] = json_array(workspace.orientation);
  entry["reached"] = workspace.reached;
  entry["grid"] = nullptr;
  const char* measure = n == 3 ? "volume" : n == 2 ? "area" : "length";
  if (workspace.inside > 0) {
    entry["grid"] = json_number(workspace.spacing);
    entry["inside"] = workspace.inside;
    entry[measure] = json_number(workspace.measure);
    entry[std::string(measure) + "_error"] = json_number(workspace.error_estimate);
    Json ranges;
    for (const int axis : workspace.axes)
      ranges[kAxes[axis]] = json_interval(workspace.range[static_cast<size_t>(axis)]);
    entry["ranges"] = ranges;
    if (n > 1) {
      entry[n == 3 ? "inscribed_sphere" : "inscribed_circle"] = {
          {"centre", json_array(workspace.inscribed.sphere.centre)},
          {"radius", json_number(workspace.inscribed.sphere.size)}};
      entry[n == 3 ? "inscribed_cube" : "inscribed_square"] = {
          {"centre", json_array(workspace.inscribed.cube.centre)},
          {"edge", json_number(workspace.inscribed.cube.size)}};
    }
    const auto conditioning = [](const PoseConditioning& part) -> Json {
      if (part.figure.count == 0) return nullptr;
      Json json = conditioning_json(part.of_all);
      json["best_at"] = json_array(part.figure.max_at);
      json["worst_at"] = json_array(part.figure.min_at);
      return json;
    };
    entry["conditioning"] = {{"translation", conditioning(workspace.translation)},
                             {"rotation", conditioning(workspace.rotation)},
                             {"homogeneous", conditioning(workspace.homogeneous)},
                             {"characteristic_length", json_number(workspace.characteristic_length)}};
  }
  entry["forces"] = nullptr;
  if (workspace.weakest_force.count > 0 || workspace.weakest_moment.count > 0) {
    const auto along = [](const std::array<Statistic, 3>& axes) {
      return Json{
          {"x", statistic_json(axes[0])}, {"y", statistic_json(axes[1])}, {"z", statistic_json(axes[2])}};
    };
    entry["forces"] = {{"force", along(workspace.force)},
                       {"force_every_direction", statistic_json(workspace.weakest_force)},
                       {"moment", along(workspace.moment)},
                       {"moment_every_direction", statistic_json(workspace.weakest_moment)}};
  }
  entry["any_orientation"] = nullptr;
  if (workspace.any && workspace.any->inside > 0) {
    const AnyOrientation& any = *workspace.any;
    Json ranges, turned = Json::array();
    for (const int axis : workspace.axes)
      ranges[kAxes[axis]] = json_interval(any.range[static_cast<size_t>(axis)]);
    for (const AnyOrientation::Turned& one : any.turned) {
      turned.push_back({{"angle", json_number(one.angle)},
                        {measure, json_number(one.measure)},
                        {"error", json_number(one.error)}});
    }
    entry["any_orientation"] = {{"grid", json_number(any.spacing)},
                                {"inside", any.inside},
                                {measure, json_number(any.measure)},
                                {std::string(measure) + "_error", json_number(any.error_estimate)},
                                {"ranges", ranges},
                                {"places", any.places},
                                {"share", any.share ? Json{{"mean", json_number(any.share->mean)},
                                                           {"least", json_number(any.share->least)},
                                                           {"most", json_number(any.share->most)}}
                                                    : Json(nullptr)},
                                {"turned_every_way", turned}};
  }
  const TurningRange& turning = workspace.turning;
  Json about;
  for (int k = 0; k < 3; ++k) {
    const auto& range = turning.about[static_cast<size_t>(k)];
    about[kAxes[k]] = range ? json_interval(*range) : Json(nullptr);
  }
  entry["turning"] = {{"position", json_array(turning.position)},
                      {"reached", turning.reached},
                      {"about", about},
                      {"share", turning.share ? json_number(*turning.share) : Json(nullptr)},
                      {"error", turning.share ? json_number(turning.share_error) : Json(nullptr)}};
  return entry;
}

Json place_json(const PlaceOrientations& place) {
  Json entry = turning_json(place.turning);
  entry["position"] = json_array(place.position);
  return entry;
}

}  // namespace zwidth
