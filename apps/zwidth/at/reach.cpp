#include "reach.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "joint_values.h"

#include "zwidth/math/svd.h"
#include "zwidth/mechanism/delta.h"

namespace zwidth::at {

namespace {

/// Why a point lies out of reach of a delta's legs, in words.
std::string delta_reach(const DeltaGeometry& geometry, const Vector3& p) {
  // Legs with the same complaint share a sentence.
  std::vector<std::pair<std::vector<std::string>, std::string>> complaints;
  for (int leg = 0; leg < 3; ++leg) {
    const double azimuth = delta_azimuth(leg);
    const double outwards = p.x() * std::cos(azimuth) + p.y() * std::sin(azimuth) - geometry.offset();
    const double sideways = -p.x() * std::sin(azimuth) + p.y() * std::cos(azimuth);
    const double from_axis = std::hypot(outwards, p.z());
    const double least = std::hypot(sideways, from_axis - geometry.upper_arm);
    const double most = std::hypot(sideways, from_axis + geometry.upper_arm);
    if (geometry.forearm >= least && geometry.forearm <= most) continue;
    const bool is_short = geometry.forearm < least;
    const double gap = is_short ? least - geometry.forearm : geometry.forearm - most;
    const std::string complaint =
        fmt::format("too {}: a forearm of {} would have to be {} {}", is_short ? "short" : "long",
                    readable(geometry.forearm, "m"), readable(gap, "m"), is_short ? "longer" : "shorter");
    const auto same = std::find_if(complaints.begin(), complaints.end(),
                                   [&](const auto& other) { return other.second == complaint; });
    if (same == complaints.end()) {
      complaints.push_back({{fmt::format("leg{}", leg + 1)}, complaint});
    } else {
      same->first.push_back(fmt::format("leg{}", leg + 1));
    }
  }
  std::string text;
  for (const auto& [legs, complaint] : complaints) {
    std::string names = legs.front();
    for (size_t i = 1; i < legs.size(); ++i) names += (i + 1 < legs.size() ? ", " : " and ") + legs[i];
    text +=
        fmt::format("{}{} {} {}", text.empty() ? "" : "; ", names, legs.size() == 1 ? "is" : "are", complaint);
  }
  return text;
}

/// Joints outside their ranges, in words.
std::string limits_broken(const Mechanism& mechanism, const Posture& posture) {
  std::string text;
  bool looks_like_degrees = false;
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    const JointModel& joint = mechanism.joints()[static_cast<size_t>(j)];
    const double value = posture.joints()[j];
    if (joint.range.contains(value, 1e-9)) continue;
    if (!text.empty()) text += "; ";
    const std::string& name = joint.active >= 0 ? mechanism.active_names()[static_cast<size_t>(joint.active)]
                                                : mechanism.joint_names()[static_cast<size_t>(j)];
    text += fmt::format("{} is at {}, its range is {} … {}", name, joint_text(mechanism, j, value),
                        joint_text(mechanism, j, joint.range.min), joint_text(mechanism, j, joint.range.max));
    looks_like_degrees = looks_like_degrees || (!slides(mechanism, j) && std::abs(value) > 6.3);
  }
  if (looks_like_degrees) text += " (values without a unit are radians: write 10deg for degrees)";
  return text;
}

/// "1.5deg" or "20mm", as an option takes it.
std::string option_value(const Mechanism& mechanism, int active, double value) {
  const bool slide = slides(mechanism, mechanism.active_joint(active));
  return trimmed(value * (slide ? kMilli : kDegrees), 7) + (slide ? "mm" : "deg");
}

/// Where a posture beyond the ranges is not the only one of a mechanism of several legs: one within them, if
/// its joints lead to it; empty if there is none.
std::string within_limits(const Found& found, const Mechanism& mechanism) {
  if (mechanism.serial() != nullptr) return "";
  for (const Solution& one : found.solutions) {
    if (!one || one.other_assembly || one.status == SolveStatus::joint_limit) continue;
    // Where the way there is barred the joint values would lead nowhere.
    const Solution driven = solve_forward(mechanism, one.posture->active());
    if (!driven || (driven.posture->tool().position - one.posture->tool().position).norm() >
                       1e-6 * mechanism.characteristic_length())
      continue;
    std::string joints;
    for (int i = 0; i < mechanism.active_count(); ++i)
      joints += fmt::format("{}{}", i == 0 ? "" : ",", option_value(mechanism, i, one.posture->active()[i]));
    return "; this is home's working mode, in another every joint is in its range: --joints " + joints;
  }
  return "";
}

/// Why an arm has no posture with the joint kept that the goal allows otherwise; empty if that is not why.
std::string kept_in_vain(const Goal& goal, const Mechanism& mechanism) {
  const Redundancy& rule = goal.options.redundancy;
  if (rule.rule != Redundancy::Rule::keep) return "";
  SolveOptions options = goal.options;
  options.redundancy = {};
  const Solution without = solve_inverse(mechanism, goal.tool, options);
  if (!without) return "";
  const std::string& name = mechanism.active_names()[static_cast<size_t>(rule.joint)];
  const int joint = mechanism.active_joint(rule.joint);
  // The self-motion is what the Jacobian's rows leave; a joint that has no part in it follows from the goal.
  const Posture& posture = *without.posture;
  Jacobian J = jacobian(posture);
  if (goal.options.match == Match::position) J = J.topRows(3).eval();
  const SmallMatrix v = svd(J).v;
  const double part = v.row(rule.joint).tail(v.cols() - J.rows()).norm();
  if (part < 1e-9) {
    return fmt::format(
        "{} does not move while the tool is held: it is at {} in the posture nearest to {}; keep "
        "another joint",
        name, joint_text(mechanism, joint, posture.joints()[joint]), goal.near_text);
  }
  return fmt::format("the tool can be there, but not with {}", goal.choice(mechanism));
}

std::string unsolved(Found& found, const Mechanism& mechanism, bool by_position) {
  std::string reason;
  if (by_position) reason = kept_in_vain(found.goal, mechanism);
  found.kept_in_vain = !reason.empty();
  if (found.kept_in_vain) return reason;
  if (found.solution.status == SolveStatus::degenerate) {
    reason = "the equations leave the posture open here: a joint can turn freely or the legs coincide";
  } else if (by_position && found.solution.other_assembly) {
    reason =
        "only another assembly mode reaches this point: driven to those joint values, the device stands "
        "elsewhere";
  } else if (by_position && mechanism.delta()) {
    reason = delta_reach(*mechanism.delta(), found.goal.tool.position);
  } else if (!by_position) {
    reason = found.solution.other_assembly ? "the legs close at these joint values only in another assembly "
                                             "mode, beyond a singularity that the "
                                             "device would have to pass"
                                           : "the legs cannot close at these joint values";
  }
  if (!reason.empty()) return reason;
  const char* what = found.goal.by_orientation ? "pose" : "point";
  return fmt::format("the {} cannot reach this {}", mechanism.serial() != nullptr ? "arm" : "legs", what);
}

/// Takes back a posture that does not put the tool where it is asked for: one held in a plane leaves the rest
/// out.
void hold_to_target(Found& found, const Mechanism& mechanism) {
  if (!found.solution) return;
  const double off = (found.solution.posture->tool().position - found.goal.tool.position).norm();
  if (off <= 1e-6 * mechanism.characteristic_length()) return;
  found.solution.status = SolveStatus::unreachable;
  found.solution.posture.reset();
  found.solutions.clear();
  found.reason =
      fmt::format("the tool cannot leave its plane, which is {} away from this point", readable(off, "m"));
}

}  // namespace

void find_posture(const Model& model, const Arguments& arguments, const Frame& frame, Found& found) {
  const Mechanism& mechanism = model.mechanism;
  const bool by_position = !arguments.position.empty();
  if (by_position) {
    read_goal(arguments, mechanism, frame, found.goal);
    found.solution = solve_inverse(mechanism, found.goal.tool, found.goal.options);
    found.solutions = solve_inverse_all(mechanism, found.goal.tool, found.goal.options);
    hold_to_target(found, mechanism);
  } else {
    found.solution = solve_forward(mechanism, joint_values("--joints", arguments.joints, mechanism));
  }
  if (!found.reason.empty()) return;
  if (!found.solution) {
    found.reason = unsolved(found, mechanism, by_position);
  } else if (found.solution.status == SolveStatus::joint_limit) {
    found.reason = limits_broken(mechanism, *found.solution.posture);
    if (by_position) found.reason += within_limits(found, mechanism);
  }
}

void write_choice(const Found& found, const Model& model, Answer& answer) {
  const Mechanism& mechanism = model.mechanism;
  if (mechanism.serial() == nullptr || found.goal.spare == 0) return;
  Json entry = found.goal.choice_json(mechanism);
  std::string text = found.goal.choice(mechanism);
  const Redundancy& rule = found.goal.options.redundancy;
  if (found.solution && rule.rule == Redundancy::Rule::keep)
    entry["value"] = json_number(found.solution.posture->active()[rule.joint]);
  if (found.solution && rule.rule == Redundancy::Rule::maximise) {
    const Posture& posture = *found.solution.posture;
    std::vector<Interval> ranges;
    for (int i = 0; i < mechanism.active_count(); ++i) ranges.push_back(mechanism.active_range(i));
    const double value = redundancy_figure(rule.figure, found.goal.options.match, jacobian(posture),
                                           posture.active(), ranges, mechanism.characteristic_length());
    entry["value"] = json_number(value);
    text += ", " + number(value, 4);
  }
  answer.put("choice", entry);
  if (answer.wants("choice")) answer.page().row("posture", text);
}

void write_branches(const Found& found, const Model& model, Answer& answer) {
  if (!answer.wants("solutions")) return;
  const Mechanism& mechanism = model.mechanism;
  Json list = Json::array();
  std::vector<std::vector<std::string>> rows;
  bool others = false;
  const bool arm = mechanism.serial() != nullptr;  // has one posture for its joints
  for (const Solution& solution : found.solutions) {
    if (!solution) continue;
    Json entry;
    entry["status"] = to_string(solution.status);
    entry["within_range"] = solution.status != SolveStatus::joint_limit;
    entry["degraded"] = solution.near_singularity();
    entry["assembly"] = solution.other_assembly ? "other" : "own";
    entry["joints"] = json_array(solution.posture->active());
    entry["residual"] = json_number(solution.residual);
    list.push_back(entry);
    others = others || solution.other_assembly;
    const bool both = solution.near_singularity() && solution.status != SolveStatus::degraded;
    std::vector<std::string> row{fmt::format("{}{}", to_string(solution.status), both ? ", degraded" : "")};
    if (!arm) row.emplace_back(solution.other_assembly ? "other" : "own");
    for (int i = 0; i < mechanism.active_count(); ++i)
      row.push_back(joint_text(mechanism, mechanism.active_joint(i), solution.posture->active()[i]));
    rows.push_back(row);
  }
  answer.put("solutions", list);
  if (rows.empty()) return;
  answer.begin("Branches");
  std::vector<std::string> header{"status"};
  if (!arm) header.emplace_back("assembly");
  header.insert(header.end(), mechanism.active_names().begin(), mechanism.active_names().end());
  answer.page().table(header, rows);
  if (others)
    answer.page().paragraph("assembly other: driven to these joint values the device takes its tool elsewhere.",
                            2, Tint::dim);
}

void write_nearest(Found& found, const Model& model, const Arguments& arguments, const Frame& frame,
                   Answer& answer) {
  const Mechanism& mechanism = model.mechanism;
  if (mechanism.linear_rows() == 0) {
    answer.undefined("nearest_reachable", "the tool only turns");
    return;
  }
  const auto point = nearest_reachable(mechanism, found.goal.tool.position);
  if (!point) {
    answer.undefined("nearest_reachable", "no joint values close the legs");
    return;
  }
  const Vector3 p = frame.R * point->position;
  Json entry;
  entry["position"] = json_array(p);
  entry["joints"] = json_array(point->joints);
  entry["distance"] = json_number(point->distance);
  answer.put("nearest_reachable", entry);
  if (point->distance < 1e-9 && found.solution.status == SolveStatus::unreachable) {
    const std::string turned =
        found.goal.by_orientation
            ? "the tool can be there, but not turned like this"
            : "the tool can be there, but not with its axes along those of the base frame";
    found.reason += "; " + turned;
    answer.page().paragraph(turned);
  }
  if (!answer.wants("nearest_reachable")) return;
  answer.begin("Nearest reachable point");
  answer.axes();
  answer.cells("position [mm]", p, kMilli, "", 6, 1e-8);
  answer.cell("distance [mm]", point->distance * kMilli);
  // Joint values, because a rounded position may lie outside again; free joints at home need not be said.
  bool free_at_home = true;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const double home = mechanism.home_guess()[mechanism.active_joint(i)];
    free_at_home = free_at_home && (!mechanism.is_free(i) || point->joints[i] == home);
  }
  std::string joints;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (free_at_home && mechanism.is_free(i)) continue;
    joints += fmt::format("{}{}", joints.empty() ? "" : ",", option_value(mechanism, i, point->joints[i]));
  }
  answer.page().row("try", fmt::format("zwidth at {} --joints {}", arguments.device, joints));
}

}  // namespace zwidth::at
