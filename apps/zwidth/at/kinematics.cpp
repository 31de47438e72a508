#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "json_rows.h"
#include "section.h"

#include "zwidth/analysis/dexterity.h"
#include "zwidth/mechanism/arm_singularities.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/five_bar.h"

/// Where the joints and the tool are, and how the one moves with the others.

namespace zwidth::at {

namespace {

constexpr double kNear = kNearSingularity;

}  // namespace

void write_joints(const Situation& at, Answer& answer) {
  Json names = Json::array(), values = Json::array(), passive_names = Json::array(), passive = Json::array();
  Json free_names = Json::array();
  for (int i = 0; i < at.mechanism.active_count(); ++i) {
    if (at.mechanism.is_free(i)) free_names.push_back(at.mechanism.active_names()[static_cast<size_t>(i)]);
    names.push_back(at.mechanism.active_names()[static_cast<size_t>(i)]);
    values.push_back(json_number(at.posture.active()[i]));
  }
  std::vector<std::vector<std::string>> rows;
  for (int j = 0; j < at.mechanism.joint_count(); ++j) {
    const JointModel& joint = at.mechanism.joints()[static_cast<size_t>(j)];
    const bool active = joint.active >= 0;
    const std::string& name = active ? at.mechanism.active_names()[static_cast<size_t>(joint.active)]
                                     : at.mechanism.joint_names()[static_cast<size_t>(j)];
    if (!active) {
      passive_names.push_back(name);
      passive.push_back(json_number(at.posture.joints()[j]));
    }
    const bool limited = joint.range.width() < 1e6;
    const std::string range = limited ? fmt::format("{} … {}", joint_text(at.mechanism, j, joint.range.min),
                                                    joint_text(at.mechanism, j, joint.range.max))
                                      : "";
    if (active || answer.wants("passive_joints")) {
      rows.push_back({name, joint_text(at.mechanism, j, at.posture.joints()[j]),
                      !active      ? "passive"
                      : joint.free ? "free"
                                   : "active",
                      range});
    }
  }
  answer.page().table({"joint", "value", "", "range"}, rows);
  answer.put("joint_names", names);
  answer.put("joints", values);
  answer.put("free_joint_names", free_names);
  answer.put("passive_joint_names", passive_names);
  answer.put("passive_joints", passive);
}

void write_tool_axes(const Situation& at, Answer& answer) {
  answer.put("tool_axes", at.frame.names());
}

void write_position(const Situation& at, Answer& answer) {
  const Vector3 p = at.frame.R * at.posture.tool().position;
  answer.put("position", json_array(p));
  answer.axes();
  answer.cells("position [mm]", p, kMilli, "", 6);
}

void write_orientation(const Situation& at, Answer& answer) {
  const Matrix3 R = at.frame.R * at.posture.tool().rotation;
  answer.put("orientation", json_array(R));
  if (R.isApprox(at.frame.R, 1e-12)) return;  // the axes of the frame: nothing to show
  answer.axes();
  for (int r = 0; r < 3; ++r)
    answer.cells(r == 0 ? "axes of the tool" : "", R.row(r).transpose(), 1.0, r == 0 ? "in columns" : "");
}

void write_jacobian(const Situation& at, Answer& answer) {
  answer.put("jacobian", json_rows(at.J));
  answer.columns(at.mechanism.active_names());
  const std::vector<std::string> names = at.frame.names();
  const unsigned sliding = units_of(at).sliding_joints;
  const unsigned all = (1U << at.mechanism.active_count()) - 1U;
  const char* unit = sliding == 0 ? "[mm/rad]" : sliding == all ? "[mm/mm]" : "[mm/rad, 1]";
  const char* turning_unit = sliding == 0 ? "[rad/rad]" : sliding == all ? "[rad/m]" : "[1, rad/m]";
  for (Eigen::Index r = 0; r < at.J.rows(); ++r) {
    const bool turns = r >= at.frame.linear();
    // Sliding joints: metres per metre are shown as they are.
    ActiveVector row = at.J.row(r).transpose();
    for (Eigen::Index j = 0; j < row.size(); ++j) {
      if (!turns && (sliding >> j & 1U) == 0) row[j] *= kMilli;
    }
    std::string label = r == 0 ? "Jacobian" : "";
    if (r == 0 || r == at.frame.linear()) label += fmt::format(" {}", turns ? turning_unit : unit);
    answer.cells(label, row, 1.0, "d" + names[static_cast<size_t>(r)]);
  }
}

namespace {

/// What a five-bar's posture is called, and how far it is from being singular.
void write_five_bar(const FiveBarDescription& five_bar, const Situation& at, Json& entry, Answer& answer) {
  const FiveBarGeometry geometry = five_bar_geometry(five_bar);
  const Vector2 theta(at.posture.active()[0], at.posture.active()[1]);
  const Vector2 position = at.posture.tool().position.head<2>();
  const FiveBarState state(geometry, theta, position);
  entry["legs"] = json_array(state.inverse_singularity());
  entry["couplers"] = json_number(state.direct_singularity());
  const WorkingMode mode = working_mode(geometry, theta, position);
  entry["working_mode"] = {mode.left, mode.right};
  entry["assembly_mode"] = assembly_mode(geometry, theta, position);
  const FiveBarSingularity named = state.singularity(kNear);
  Json names = Json::array();
  std::string text;
  const auto name = [&](const std::string& one) {
    names.push_back(one);
    text += (text.empty() ? "" : ", ") + one;
  };
  for (std::size_t l = 0; l < 2; ++l) {
    const std::string leg = l == 0 ? "left leg " : "right leg ";
    if (named.leg[l] != LegShape::bent) name(leg + to_string(named.leg[l]));
  }
  if (named.direct()) name(to_string(named.couplers));
  entry["names"] = names;
  if (!text.empty()) answer.page().paragraph("At or near: " + text + ".", 2, Tint::warning);
  answer.columns(at.mechanism.active_names());
  answer.cells("distance to leg singularities", state.inverse_singularity(), 1.0, "0: stretched or folded");
  answer.cell("distance to coupler singularity", state.direct_singularity(),
              "0: the elbows coincide, or the couplers are in line");
}

/// Which of its singularities an arm with a shoulder, an elbow and a wrist is at or near, and how far it is
/// from each.
void write_arm(const Situation& at, Json& entry, Answer& answer) {
  const std::vector<SrsSingularity> sets = arm_singularities(at.posture);
  if (sets.empty()) return;
  constexpr double kClose = 1e-3;  // [rad]
  const auto nearest = std::min_element(sets.begin(), sets.end(),
                                        [](const auto& a, const auto& b) { return a.distance < b.distance; });
  const bool singular = at.singularity.loses || at.degraded;
  Json names = Json::array(), list = Json::array();
  std::vector<std::vector<std::string>> rows;
  for (auto set = sets.begin(); set != sets.end(); ++set) {
    list.push_back({{"name", set->name},
                    {"what", set->what},
                    {"where", set->where},
                    {"distance", json_number(set->distance)}});
    rows.push_back({std::string(set->name), fmt::format("{}°", number(set->distance * kDegrees, 4)),
                    std::string(set->where)});
    if (set->distance >= kClose && !(singular && set == nearest)) continue;
    names.push_back(set->name);
    answer.page().paragraph(
        fmt::format("{} the {} singularity: {} ({}). The links then carry {} without any torque.",
                    set->distance < 1e-6 ? "At" : "Near", set->name, set->what, set->where, set->carried),
        2, Tint::warning);
  }
  entry["names"] = names;
  entry["sets"] = list;
  answer.page().table({"singularity", "distance", "where"}, rows);
}

Json directions_json(const std::vector<SingularWay>& ways) {
  Json list = Json::array();
  for (const SingularWay& way : ways) list.push_back(json_array(way.direction));
  return list;
}

/// "(1.000, 0.000, 0.000)", or several with "and" between them.
std::string directions_text(const std::vector<SingularWay>& ways) {
  std::string text;
  for (const SingularWay& way : ways)
    text += fmt::format("{}({})", text.empty() ? "" : " and ", direction_text(way.direction));
  return text;
}

/// The legs that bar lost ways, each once.
std::vector<std::string> barring_legs(const std::vector<SingularWay>& ways) {
  std::vector<std::string> legs;
  for (const SingularWay& way : ways) {
    for (const std::string& leg : way.legs) {
      if (std::find(legs.begin(), legs.end(), leg) == legs.end()) legs.push_back(leg);
    }
  }
  return legs;
}

std::string barring_text(const Mechanism& mechanism, const std::vector<SingularWay>& ways) {
  const std::vector<std::string> legs = barring_legs(ways);
  if (mechanism.legs().size() == 1 || legs.empty()) return "";
  return fmt::format(" {} {} it.", fmt::join(legs, ", "), legs.size() == 1 ? "bars" : "bar");
}

/// What the posture loses or gains, exactly or nearly, into `entry`; returned in words.
std::string write_singular_ways(const Situation& at, Json& entry) {
  const Singularity& found = at.singularity;
  std::string text;
  const auto lost = [&](const std::vector<SingularWay>& ways) {
    entry["lost_directions"] = directions_json(ways);
    entry["lost_by"] = barring_legs(ways);
  };
  if (found.gains) {
    entry["kind"] = found.loses ? "the tool gains and loses a freedom" : "the tool gains a freedom";
    entry["free_directions"] = directions_json(found.free);
    if (!found.free.empty()) entry["free_direction"] = json_array(found.free.front().direction);
    text = fmt::format(
        "Singular: the tool can move{} although every joint is held. No force can be held along it.",
        found.free.empty() ? "" : " along " + directions_text(found.free));
  }
  if (found.loses) {
    if (!found.gains) entry["kind"] = "the tool loses a freedom";
    entry["weak_direction"] = json_array(found.lost.front().direction);
    lost(found.lost);
    text += fmt::format("{}Singular: the tool cannot move along {}; the links bear any force along it.{}",
                        text.empty() ? "" : " ", directions_text(found.lost),
                        barring_text(at.mechanism, found.lost));
  }
  if (found.gains || found.loses || !at.degraded) return text;
  const bool gains = at.rates.closure < kNear;
  entry["kind"] = gains ? "the tool gains a freedom" : "the tool loses a freedom";
  if (gains) {
    entry["free_directions"] = directions_json(found.nearly);
    return fmt::format(
        "Near a singularity: the tool can move{} although the joints are held; forces there are hardly "
        "controlled.",
        found.nearly.empty() ? "" : " along " + directions_text(found.nearly));
  }
  if (found.hardly.empty()) return "Near a singularity: passive joints hardly know where to go.";
  lost(found.hardly);
  entry["weak_direction"] = json_array(found.hardly.front().direction);
  return fmt::format("Near a singularity: the tool can hardly move along {}.{}", directions_text(found.hardly),
                     barring_text(at.mechanism, found.hardly));
}

}  // namespace

void write_singularity(const Situation& at, Answer& answer) {
  Json entry;
  entry["closure"] = json_number(at.rates.closure);
  if (!at.singularity.gains && units_of(at).homogeneous(at.J)) {
    const Dexterity figures = dexterity(at.J);
    entry["min_singular_value"] = json_number(figures.min_singular_value);
    entry["max_singular_value"] = json_number(figures.max_singular_value);
    entry["weak_direction"] = json_array(figures.weak_direction);
  }
  const std::string text = write_singular_ways(at, entry);
  if (!text.empty()) answer.page().paragraph(text, 2, Tint::warning);
  if (const auto& geometry = at.mechanism.delta()) {
    const DeltaState state(*geometry, Vector3(at.posture.active()), at.posture.tool().position);
    entry["legs"] = json_array(state.inverse_singularity());
    entry["platform"] = json_number(state.direct_singularity());
    answer.columns(at.mechanism.active_names());
    answer.cells("distance to leg singularities", state.inverse_singularity(), 1.0, "0: stretched or folded");
    answer.cell("distance to platform singularity", state.direct_singularity(), "0: the forearms are coplanar");
  }
  if (const auto* five_bar = std::get_if<FiveBarDescription>(&at.model.description.mechanism)) {
    write_five_bar(*five_bar, at, entry, answer);
  }
  write_arm(at, entry, answer);
  answer.put("singularity", entry);
}

void write_motion(const Situation& at, Answer& answer) {
  if (!at.moving) return;
  const BiasAcceleration bias = bias_acceleration(at.posture, at.rates, at.rate);
  const ToolVector v = at.J * at.rate;
  const ToolVector a = at.J * at.acceleration + at.frame.turn * bias.tool;
  answer.put("velocity", json_array(v));
  answer.put("acceleration", json_array(a));
  if (answer.wants("velocity"))
    answer.tool_vector(at.frame, v, "velocity [mm/s]", kMilli, "turning [rad/s]", 1.0);
  if (answer.wants("acceleration"))
    answer.tool_vector(at.frame, a, "acceleration [m/s²]", 1.0, "turning [rad/s²]", 1.0);
}

}  // namespace zwidth::at
