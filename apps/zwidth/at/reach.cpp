#include "reach.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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

std::string unsolved(const Found& found, const Mechanism& mechanism, bool by_position) {
  std::string reason;
  if (found.solution.status == SolveStatus::degenerate) {
    reason = "the equations leave the posture open here: a joint can turn freely or the legs coincide";
  } else if (by_position && found.solution.other_assembly) {
    reason =
        "only another assembly mode reaches this point: driven to those joint values, the device stands "
        "elsewhere";
  } else if (by_position && mechanism.delta()) {
    reason = delta_reach(*mechanism.delta(), found.target);
  } else if (!by_position) {
    reason = "the legs cannot close at these joint values";
  }
  return reason.empty() ? "the legs cannot reach this point" : reason;
}

/// The tool's position in the user's frame: three coordinates, or those that a tool held in a plane has.
Vector3 position_option(const std::string& text, const Frame& frame) {
  const auto given = std::count(text.begin(), text.end(), ',') + 1;
  const bool in_plane = frame.linear() == 2 && given == 2;
  const std::vector<double> values =
      option_values("--position", text, std::vector<Dimension>(in_plane ? 2 : 3, Dimension::length));
  Vector3 position = Vector3::Zero();
  for (size_t i = 0; i < values.size(); ++i)
    position[in_plane ? frame.axes[i] : static_cast<int>(i)] = values[i];
  return position;
}

/// Takes back a posture that does not put the tool where it is asked for: one held in a plane leaves the rest
/// out.
void hold_to_target(Found& found, const Mechanism& mechanism) {
  if (!found.solution) return;
  const double off = (found.solution.posture->tool().position - found.target).norm();
  if (off <= 1e-6 * mechanism.characteristic_length()) return;
  found.solution.status = SolveStatus::unreachable;
  found.solution.posture.reset();
  found.solutions.clear();
  found.reason =
      fmt::format("the tool cannot leave its plane, which is {} away from this point", readable(off, "m"));
}

}  // namespace

Found find_posture(const Model& model, const Arguments& arguments, const Frame& frame) {
  const Mechanism& mechanism = model.mechanism;
  const bool by_position = !arguments.position.empty();
  Found found;
  if (by_position) {
    found.target = frame.R.transpose() * position_option(arguments.position, frame);
    const Pose pose{found.target, Matrix3::Identity()};
    found.solution = solve_inverse(mechanism, pose);
    found.solutions = solve_inverse_all(mechanism, pose);
    hold_to_target(found, mechanism);
  } else {
    found.solution = solve_forward(mechanism, joint_option("--joints", arguments.joints, mechanism, 0));
  }
  if (!found.reason.empty()) return found;
  if (!found.solution) {
    found.reason = unsolved(found, mechanism, by_position);
  } else if (found.solution.status == SolveStatus::joint_limit) {
    found.reason = limits_broken(mechanism, *found.solution.posture);
  }
  return found;
}

void write_branches(const Found& found, const Model& model, Answer& answer) {
  if (!answer.wants("solutions")) return;
  const Mechanism& mechanism = model.mechanism;
  Json list = Json::array();
  std::vector<std::vector<std::string>> rows;
  bool others = false;
  for (const Solution& solution : found.solutions) {
    if (!solution) continue;
    Json entry;
    entry["status"] = to_string(solution.status);
    entry["within_range"] = solution.status != SolveStatus::joint_limit;
    entry["assembly"] = solution.other_assembly ? "other" : "own";
    entry["joints"] = json_array(solution.posture->active());
    entry["residual"] = json_number(solution.residual);
    list.push_back(entry);
    others = others || solution.other_assembly;
    std::vector<std::string> row{to_string(solution.status), solution.other_assembly ? "other" : "own"};
    for (int i = 0; i < mechanism.active_count(); ++i)
      row.push_back(joint_text(mechanism, mechanism.active_joint(i), solution.posture->active()[i]));
    rows.push_back(row);
  }
  answer.put("solutions", list);
  if (rows.empty()) return;
  answer.begin("Branches");
  std::vector<std::string> header{"status", "assembly"};
  header.insert(header.end(), mechanism.active_names().begin(), mechanism.active_names().end());
  answer.page().table(header, rows);
  if (others)
    answer.page().paragraph("assembly other: driven to these joint values the device takes its tool elsewhere.",
                            2, Tint::dim);
}

void write_nearest(Found& found, const Model& model, const Arguments& arguments, const Frame& frame,
                   Answer& answer) {
  const Mechanism& mechanism = model.mechanism;
  const auto point = nearest_reachable(mechanism, found.target);
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
    const std::string turned = "the tool can be there, but not with its axes along those of the base frame";
    found.reason += "; " + turned;
    answer.page().paragraph(turned);
  }
  if (!answer.wants("nearest_reachable")) return;
  answer.begin("Nearest reachable point");
  answer.axes();
  answer.cells("position [mm]", p, kMilli, "", 6, 1e-8);
  answer.cell("distance [mm]", point->distance * kMilli);
  // Joint values, because a rounded position may lie outside again.
  std::string joints;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const bool slide = slides(mechanism, mechanism.active_joint(i));
    joints += fmt::format("{}{}{}", i > 0 ? "," : "",
                          trimmed(point->joints[i] * (slide ? kMilli : kDegrees), 7), slide ? "mm" : "deg");
  }
  answer.page().row("try", fmt::format("zwidth at {} --joints {}", arguments.device, joints));
}

}  // namespace zwidth::at
