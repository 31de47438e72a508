#include "sheet_arm.h"

#include <fmt/format.h>

#include "terminal.h"

namespace zwidth {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

class TableBuilder {
 public:
  TableBuilder(std::string id, std::string title, std::string how)
      : table_{std::move(id), std::move(title), std::move(how), {}} {}

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

Json statistic_json(const PostureStatistic& statistic) {
  if (statistic.count == 0) return nullptr;
  return {{"min", json_number(statistic.min)},
          {"max", json_number(statistic.max)},
          {"mean", json_number(statistic.mean)},
          {"min_at", json_array(statistic.min_at)},
          {"max_at", json_array(statistic.max_at)}};
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

Json index_json(const GlobalConditioning& conditioning) {
  return conditioning.weight() > 0.0 ? json_number(conditioning.index()) : Json(nullptr);
}

}  // namespace

std::vector<PostureTable> arm_tables(const ArmSheet& arm) {
  const PostureSweep& sweep = arm.continuous;
  const std::string postures = fmt::format("{} postures spread evenly over the joint ranges", sweep.solved);
  std::vector<PostureTable> tables;

  TableBuilder dexterity("dexterity", "Dexterity over the joint ranges",
                         postures + ". Conditioning is 1/(condition number): 1 is isotropic, 0 singular.");
  dexterity.row("conditioning, translation", sweep.translation_conditioning, 1.0, "");
  dexterity.row("conditioning, rotation", sweep.rotation_conditioning, 1.0, "");
  dexterity.row("manipulability, translation", sweep.manipulability, 1e6, "cm³/rad³");
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

  TableBuilder inertia("inertia", "Inertia felt at the tool",
                       postures + ". Against pure forces, with rotors and transmissions.");
  inertia.row("in the lightest direction", sweep.lightest, kMilli, "g");
  inertia.row("in the heaviest direction", sweep.heaviest, kMilli, "g");
  inertia.row("torque against gravity", sweep.gravity_torque, kMilli, "mN m");
  inertia.into(tables);

  TableBuilder resolution("resolution", "Resolution at the tool",
                          postures + ". When every joint moves by its resolution, at worst.");
  resolution.axes("smallest step along", sweep.step, 1e6, "µm");
  resolution.row("smallest turn", sweep.turn_step, kDegrees, "°");
  resolution.into(tables);
  return tables;
}

std::vector<ArmFact> reach_facts(const ArmSheet& arm) {
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
  if (arm.continuous.homogeneous.weight() > 0.0) {
    facts.push_back(
        {"global conditioning", number(arm.continuous.homogeneous.index(), 3),
         fmt::format("rotations made lengths by {}", readable(arm.continuous.characteristic_length, "m", 3))});
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
    if (linear > 0)
      facts.push_back({fmt::format("{} force", name), loads_text(*loads, 0, linear, "N"), "along x, y, z"});
    if (loads->size() > linear) {
      const ToolVector milli = *loads * kMilli;
      facts.push_back({fmt::format("{} moment", name),
                       loads_text(milli, linear, loads->size() - linear, "mN m"), "about x, y, z"});
    }
  }
  return facts;
}

Json arm_json(const ArmSheet& arm) {
  Json entry;
  entry["postures"] = arm.continuous.solved;
  entry["translation_conditioning"] = statistic_json(arm.continuous.translation_conditioning);
  entry["rotation_conditioning"] = statistic_json(arm.continuous.rotation_conditioning);
  entry["manipulability"] = statistic_json(arm.continuous.manipulability);
  entry["global_conditioning"] = {{"translation", index_json(arm.continuous.translation)},
                                  {"rotation", index_json(arm.continuous.rotation)},
                                  {"homogeneous", index_json(arm.continuous.homogeneous)},
                                  {"characteristic_length", json_number(arm.continuous.characteristic_length)}};
  entry["continuous"] = loads_json(arm.continuous);
  entry["peak"] = arm.peak ? loads_json(*arm.peak) : Json(nullptr);
  entry["step"] = axes_json(arm.continuous.step);
  entry["turn_step"] = statistic_json(arm.continuous.turn_step);
  entry["lightest"] = statistic_json(arm.continuous.lightest);
  entry["heaviest"] = statistic_json(arm.continuous.heaviest);
  entry["gravity_torque"] = statistic_json(arm.continuous.gravity_torque);
  Json ranges;
  for (int k = 0; k < 3; ++k) {
    ranges[kAxes[k]] = {json_number(arm.ends[k][0].distance), json_number(arm.ends[k][1].distance)};
  }
  entry["ranges"] = ranges;
  entry["farthest"] = farthest_json(arm.farthest);
  if (arm.home) {
    entry["home"] = {{"joints", json_array(arm.home->active)},
                     {"position", json_array(arm.home->tool.position)},
                     {"orientation", json_array(arm.home->tool.rotation)},
                     {"jacobian", json_array(arm.home->jacobian)},
                     {"condition_number", json_number(arm.home->translation.condition_number)},
                     {"gravity_torques", json_array(arm.home->gravity_torques)},
                     {"continuous_loads", json_array(arm.home->continuous_loads)},
                     {"peak_loads", json_array(arm.home->peak_loads)}};
  } else {
    entry["home"] = nullptr;
  }
  if (arm.reach) {
    const ReachSheet& reach = *arm.reach;
    entry["reach"] = {{"volume", json_number(reach.volume.value)},
                      {"volume_error", json_number(reach.volume.error_estimate)},
                      {"spacing", json_number(reach.volume.spacing)},
                      {"inscribed_sphere",
                       {{"centre", json_array(reach.inscribed.sphere.centre)},
                        {"radius", json_number(reach.inscribed.sphere.size)}}},
                      {"inscribed_cube",
                       {{"centre", json_array(reach.inscribed.cube.centre)},
                        {"edge", json_number(reach.inscribed.cube.size)}}}};
  } else {
    entry["reach"] = nullptr;
  }
  return entry;
}

}  // namespace zwidth
