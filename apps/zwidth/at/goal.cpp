#include "goal.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "joint_values.h"

#include "zwidth/description/names.h"
#include "zwidth/description/problem.h"

namespace zwidth::at {

namespace {

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

/// Three angles, roll, pitch and yaw about the fixed axes x, y and z: Rz(yaw) Ry(pitch) Rx(roll); or a
/// quaternion w,x,y,z.
Matrix3 orientation_option(const std::string& text) {
  const auto given = std::count(text.begin(), text.end(), ',') + 1;
  if (given != 4) {
    const std::vector<double> rpy =
        option_values("--orientation", text, std::vector<Dimension>(3, Dimension::angle));
    return (Eigen::AngleAxisd(rpy[2], Vector3::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3::UnitY()) *
            Eigen::AngleAxisd(rpy[0], Vector3::UnitX()))
        .toRotationMatrix();
  }
  const std::vector<double> q =
      option_values("--orientation", text, std::vector<Dimension>(4, Dimension::number));
  const Eigen::Quaterniond quaternion(q[0], q[1], q[2], q[3]);
  constexpr double kRounded = 1e-3;  // digits that were left out
  if (!(std::abs(quaternion.norm() - 1.0) < kRounded)) {
    throw InputError(fmt::format(
        "--orientation \"{}\": a quaternion w,x,y,z must have length 1, its length is {:.6g}; three "
        "values are the angles roll, pitch and yaw, such as 0,90deg,0",
        text, quaternion.norm()));
  }
  return quaternion.normalized().toRotationMatrix();
}

Matrix3 rotation_option(const std::string& text) {
  const std::vector<double> values =
      option_values("--rotation", text, std::vector<Dimension>(9, Dimension::number));
  Matrix3 R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = values[static_cast<size_t>(i)];
  constexpr double kRounded = 1e-6;
  const double off = (R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRounded)) {
    throw InputError(fmt::format(
        "--rotation \"{}\": must be a rotation, row by row: columns of length 1 at right angles; an "
        "element of R^T R is {:.3g} off the identity; --orientation takes roll, pitch and yaw",
        text, off));
  }
  if (R.determinant() < 0.0) {
    throw InputError(fmt::format(
        "--rotation \"{}\": mirrors, its determinant is -1; a rotation has +1: turn one column round", text));
  }
  const Eigen::Quaterniond nearest(R);
  return nearest.normalized().toRotationMatrix();
}

int joint_named(const std::string& name, const std::string& text, const Mechanism& mechanism) {
  const auto& names = mechanism.active_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError(fmt::format("--keep {}: there is no joint \"{}\"; {}", text, name, suggest(name, names)));
  return static_cast<int>(found - names.begin());
}

/// NAME or NAME=VALUE.
Redundancy keep_option(const std::string& text, const Mechanism& mechanism) {
  const size_t equals = text.find('=');
  Redundancy redundancy{.rule = Redundancy::Rule::keep};
  redundancy.joint = joint_named(text.substr(0, equals), text, mechanism);
  if (equals == std::string::npos) return redundancy;
  const bool slide = slides(mechanism, mechanism.active_joint(redundancy.joint));
  redundancy.value =
      option_values("--keep", text.substr(equals + 1), {slide ? Dimension::length : Dimension::angle}).front();
  return redundancy;
}

Redundancy maximise_option(const std::string& text) {
  const auto figure = redundancy_figure_named(text);
  if (!figure) {
    throw InputError(fmt::format("--maximise {}: there is no such figure; {}", text,
                                 suggest(text, {"manipulability", "inverse_condition", "limit_distance"})));
  }
  return {.rule = Redundancy::Rule::maximise, .figure = *figure};
}

std::string value_text(const Mechanism& mechanism, int active, double value) {
  const bool slide = slides(mechanism, mechanism.active_joint(active));
  return trimmed(value * (slide ? kMilli : kDegrees), 6) + (slide ? "mm" : "deg");
}

[[noreturn]] void refuse_open_choice(const Mechanism& mechanism, int spare) {
  int last = 0;  // the joint that the source of such arms most often names
  for (int i = 0; i < std::min(3, mechanism.active_count()); ++i) last = i;
  throw InputError(fmt::format(
      "--position with an orientation: leaves {} of the {} joints of {} open, so which posture is meant must "
      "be "
      "said; keep a joint (--keep {}={}), stay near a posture (--near A,B,... or --near home), or make a "
      "figure "
      "as large as can be (--maximise manipulability)",
      spare, mechanism.active_count(), mechanism.name(), mechanism.active_names()[static_cast<size_t>(last)],
      value_text(mechanism, last, mechanism.home_guess()[mechanism.active_joint(last)])));
}

}  // namespace

Matrix3 orientation_given(const std::string& orientation, const std::string& rotation) {
  if (!orientation.empty() && !rotation.empty())
    throw InputError("--rotation: give it or --orientation, not both");
  return orientation.empty() ? rotation_option(rotation) : orientation_option(orientation);
}

void read_goal(const Arguments& arguments, const Mechanism& mechanism, const Frame& frame, Goal& goal) {
  goal.tool.position = frame.R.transpose() * position_option(arguments.position, frame);
  const bool any_orientation = !arguments.orientation.empty() || !arguments.rotation.empty();
  if (any_orientation) {
    const char* option = arguments.orientation.empty() ? "--rotation" : "--orientation";
    if (!mechanism.tool_turns())
      throw InputError(fmt::format("{}: the tool of {} has no orientation to choose; leave it out", option,
                                   mechanism.name()));
    const Matrix3 R = orientation_given(arguments.orientation, arguments.rotation);
    goal.tool.rotation = frame.R.transpose() * R;
    goal.by_orientation = true;
  }
  const bool arm = mechanism.serial() != nullptr;
  if (arm && !any_orientation) goal.options.match = Match::position;
  goal.spare = arm ? std::max(0, mechanism.active_count() - (any_orientation ? 6 : 3)) : 0;

  if (!arguments.keep.empty() && !arguments.maximise.empty())
    throw InputError("--keep and --maximise: a posture is chosen by one of them; give one");
  const char* rule = !arguments.keep.empty() ? "--keep" : !arguments.maximise.empty() ? "--maximise" : nullptr;
  if (rule != nullptr && goal.spare == 0) {
    throw InputError(fmt::format("{}: {} has no joint to spare{}; leave it out", rule, mechanism.name(),
                                 arm ? " here" : ", only arms of one leg may have one"));
  }
  if (!arguments.near.empty()) {
    if (!arm) throw InputError(fmt::format("--near: {} is no arm of one leg; leave it out", mechanism.name()));
    if (arguments.near != "home") {
      const ActiveVector joints = joint_values("--near", arguments.near, mechanism);
      goal.near = solve_forward(mechanism, joints).posture;
      goal.options.start = &*goal.near;
      goal.near_text = arguments.near;
    }
  }
  if (!arguments.keep.empty()) goal.options.redundancy = keep_option(arguments.keep, mechanism);
  if (!arguments.maximise.empty()) goal.options.redundancy = maximise_option(arguments.maximise);
  if (any_orientation && goal.spare > 0 && rule == nullptr && arguments.near.empty())
    refuse_open_choice(mechanism, goal.spare);
}

std::string Goal::choice(const Mechanism& mechanism) const {
  const Redundancy& rule = options.redundancy;
  switch (rule.rule) {
    case Redundancy::Rule::keep: {
      const double start = options.start != nullptr
                               ? options.start->active()[rule.joint]
                               : mechanism.home_guess()[mechanism.active_joint(rule.joint)];
      return fmt::format("{} kept at {}", mechanism.active_names()[static_cast<size_t>(rule.joint)],
                         joint_text(mechanism, mechanism.active_joint(rule.joint), rule.value.value_or(start)));
    }
    case Redundancy::Rule::maximise:
      return fmt::format("largest {}", to_string(rule.figure));
    case Redundancy::Rule::nearest:
      break;
  }
  return fmt::format("nearest to {}", near_text);
}

Json Goal::choice_json(const Mechanism& mechanism) const {
  const Redundancy& rule = options.redundancy;
  Json entry;
  entry["spare_joints"] = spare;
  switch (rule.rule) {
    case Redundancy::Rule::nearest:
      entry["rule"] = "nearest";
      break;
    case Redundancy::Rule::keep:
      entry["rule"] = "keep";
      entry["joint"] = mechanism.active_names()[static_cast<size_t>(rule.joint)];
      break;
    case Redundancy::Rule::maximise:
      entry["rule"] = "maximise";
      entry["figure"] = to_string(rule.figure);
      break;
  }
  return entry;
}

}  // namespace zwidth::at
