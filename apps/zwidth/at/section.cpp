#include "section.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "joint_values.h"

#include "zwidth/description/problem.h"

namespace zwidth::at {

namespace {

// What rounding leaves of a singularity: roots of differences that cancel are good to the square root of a
// double's precision.
constexpr double kRounding = 1e-7;
/// Of a posture whose loops are only closed to `residual` [m]: where they fold, x^2 = 0 is met with x the root.
double rounding_of(const Solution& solution, const Mechanism& mechanism) {
  const double open = std::max(0.0, solution.residual) / mechanism.characteristic_length();
  return std::max(kRounding, 3.0 * std::sqrt(open));
}

constexpr const char* kMotion = "give --rate or --acceleration";
constexpr const char* kLoad = "give --load";
constexpr const char* kTorque = "give --torque";

/// Keys of the head, and of the answer to --position; `write_sections` does not write them.
const std::vector<std::string> kOtherKeys = {
    "device", "status", "degraded", "frame", "reason", "notes", "choice", "solutions", "nearest_reachable"};

std::vector<SingularWay> ways_of(const Mechanism& mechanism, const std::vector<SingularDirection>& directions,
                                 const Frame& frame) {
  std::vector<SingularWay> ways;
  for (const SingularDirection& one : directions) {
    constexpr double kNothing = 1e-12;
    SingularWay way{frame.turn * one.direction, {}};
    way.direction = (way.direction.array().abs() < kNothing).select(0.0, way.direction);
    for (const int leg : one.legs) {
      const std::string& joint =
          mechanism.joint_names()[static_cast<size_t>(mechanism.legs()[static_cast<size_t>(leg)].first)];
      way.legs.push_back(joint.substr(0, joint.find('/')));
    }
    ways.push_back(std::move(way));
  }
  return ways;
}

/// Makes zero the rows of J that are rounding beside the largest: a tool that is free to turn by its
/// declaration may have legs that keep it from turning.
void drop_idle_rows(const Frame& frame, double length, Jacobian& J) {
  constexpr double kNothing = 1e-11;  // loops closed to 1e-12, over their condition
  Jacobian scaled = J;
  scaled.bottomRows(J.rows() - frame.linear()) *= length;
  const double largest = scaled.rowwise().norm().maxCoeff();
  for (Eigen::Index r = 0; r < J.rows(); ++r) {
    if (scaled.row(r).norm() <= kNothing * largest) J.row(r).setZero();
  }
}

/// Looks for singularities, and takes from J what is only rounding.
Singularity find_singularity(const Posture& posture, bool degraded, double rounding, const Rates& rates,
                             const Frame& frame, Jacobian& J) {
  const Mechanism& mechanism = posture.mechanism();
  Singularity result;
  const SingularDirections exact = singular_directions(posture, rounding);
  result.gains = !(rates.closure >= rounding) || !J.allFinite();
  if (result.gains) result.free = ways_of(mechanism, exact.gained, frame);
  result.loses = !exact.lost.empty();
  result.lost = ways_of(mechanism, exact.lost, frame);
  if (degraded && !result.gains && !result.loses) {
    constexpr double kNear = 1e-3;  // whatever makes the solvers call a posture degraded is within it
    const SingularDirections near = singular_directions(posture, kNear);
    result.hardly = ways_of(mechanism, near.lost, frame);
    result.nearly = ways_of(mechanism, near.gained, frame);
  }
  if (!result.gains) drop_idle_rows(frame, mechanism.characteristic_length(), J);
  if (!result.loses || result.gains) return result;
  // Turning counts as the way of a point at the characteristic length.
  const double length = mechanism.characteristic_length();
  const Eigen::Index turning = J.rows() - frame.linear();
  Jacobian scaled = J;
  scaled.bottomRows(turning) *= length;
  for (const SingularWay& way : result.lost) scaled -= way.direction * (way.direction.transpose() * scaled);
  scaled.bottomRows(turning) /= length;
  const double zero = 1e-12 * J.cwiseAbs().maxCoeff();
  J = (scaled.array().abs() <= zero).select(0.0, scaled);
  return result;
}

}  // namespace

std::vector<double> option_values(const char* option, const std::string& text,
                                  const std::vector<Dimension>& dimensions) {
  const ParsedQuantities values = parse_quantity_list(text, dimensions);
  if (!values)
    throw InputError(fmt::format("{} \"{}\": {}{}", option, text, values.rule,
                                 values.advice.empty() ? "" : "; " + values.advice));
  return values.values;
}

int Frame::linear() const {
  return static_cast<int>(std::count_if(axes.begin(), axes.end(), [](int axis) { return axis < 3; }));
}

std::vector<std::string> Frame::names() const {
  static const char* const kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  std::vector<std::string> names;
  for (const int axis : axes) names.emplace_back(kNames[axis]);
  return names;
}

Frame frame_of(const Arguments& arguments, const Description& description, const Mechanism& mechanism) {
  Frame frame;
  if (arguments.frame == "user") {
    frame.R = description.to_user;
  } else if (arguments.frame != "device") {
    throw InputError(fmt::format("--frame {}: must be \"device\" or \"user\"", arguments.frame));
  }
  Matrix6 six = Matrix6::Zero();
  six.topLeftCorner<3, 3>() = six.bottomRightCorner<3, 3>() = frame.R;
  const std::span<const int> own = mechanism.tool_axes();
  ToolMatrix turned(6, static_cast<Eigen::Index>(own.size()));
  for (size_t c = 0; c < own.size(); ++c) turned.col(static_cast<Eigen::Index>(c)) = six.col(own[c]);
  for (int axis = 0; axis < 6; ++axis) {
    if (turned.row(axis).cwiseAbs().maxCoeff() > 1e-9) frame.axes.push_back(axis);
  }
  frame.turn.resize(static_cast<Eigen::Index>(frame.axes.size()), turned.cols());
  for (size_t r = 0; r < frame.axes.size(); ++r)
    frame.turn.row(static_cast<Eigen::Index>(r)) = turned.row(frame.axes[r]);
  return frame;
}

Situation::Situation(const Model& of, const Arguments& arguments, const Frame& user, const Solution& solution)
    : model(of),
      mechanism(of.mechanism),
      posture(*solution.posture),
      degraded(solution.near_singularity()),
      frame(user),
      rates(zwidth::rates(posture)),
      J(frame.turn * rates.tool),
      singularity(find_singularity(posture, degraded, rounding_of(solution, mechanism), rates, frame, J)),
      rate(ActiveVector::Zero(mechanism.active_count())),
      acceleration(rate),
      moving(!arguments.rate.empty() || !arguments.acceleration.empty()) {
  if (!arguments.rate.empty()) rate = joint_values("--rate", arguments.rate, mechanism, 1);
  if (!arguments.acceleration.empty())
    acceleration = joint_values("--acceleration", arguments.acceleration, mechanism, 2);
  if (!arguments.torque.empty()) torque = joint_values("--torque", arguments.torque, mechanism, 3);
  if (!arguments.load.empty()) {
    // The force alone, or the moment with it.
    const auto given = static_cast<int>(std::count(arguments.load.begin(), arguments.load.end(), ',')) + 1;
    const int all = static_cast<int>(frame.axes.size()), linear = frame.linear();
    const bool force_alone = linear > 0 && given <= linear;
    if (given != all && !(linear > 0 && given == linear)) {
      const std::vector<std::string> names = frame.names();
      const std::string force =
          fmt::format("a force along {}", fmt::join(names.begin(), names.begin() + linear, ", "));
      const std::string moment =
          fmt::format("a moment about {}", fmt::join(names.begin() + linear, names.end(), ", "));
      std::string wanted =
          linear > 0 ? fmt::format("give {}, {}", linear, force) : fmt::format("give {}, {}", all, moment);
      if (linear > 0 && linear < all) wanted += fmt::format(", or {} with {}", all, moment);
      if (linear == all) wanted += "; the tool does not turn, so it takes no moment";
      throw InputError(fmt::format("--load \"{}\": has {} {}; {}", arguments.load, given,
                                   given == 1 ? "entry" : "entries", wanted));
    }
    std::vector<Dimension> dimensions;
    for (const int axis : frame.axes) {
      if (axis < 3 || !force_alone) dimensions.push_back(axis < 3 ? Dimension::force : Dimension::torque);
    }
    const std::vector<double> values = option_values("--load", arguments.load, dimensions);
    load = ToolVector::Zero(static_cast<Eigen::Index>(frame.axes.size()));
    for (size_t i = 0; i < values.size(); ++i) (*load)[static_cast<Eigen::Index>(i)] = values[i];
  }
}

const std::vector<Section>& sections() {
  static const std::vector<Section> table = {
      {"Joints",
       {"joint_names", "joints", "free_joint_names", "passive_joint_names", "passive_joints"},
       write_joints},
      {"Tool", {"tool_axes"}, write_tool_axes},
      {"Tool", {"position"}, write_position},
      {"Tool", {"orientation"}, write_orientation},
      {"Dexterity", {"jacobian"}, write_jacobian, true},
      {"Dexterity",
       {"condition_number", "manipulability", "isotropy", "homogeneous"},
       write_dexterity,
       true,
       "homogeneous is of tools that move and turn, and of joints that turn and slide"},
      {"Dexterity", {"velocity_ellipsoid", "force_ellipsoid"}, write_ellipsoids, true},
      {"Dexterity", {"singularity"}, write_singularity},
      {"Motion", {"velocity", "acceleration"}, write_motion, true, kMotion},
      {"Motion", {"accelerations"}, write_accelerations, true, kTorque},
      {"Forces and torques", {"gravity_torques"}, write_gravity, true},
      {"Forces and torques", {"load", "torques"}, write_torques, true, kLoad},
      {"Forces and torques", {"power"}, write_power, true, kMotion},
      {"Forces and torques", {"energy"}, write_energy, true},
      {"Forces and torques", {"force_limits"}, write_force_limits},
      {"Cylinders", {"cylinders"}, write_cylinders, true, "only for pneumatic drives"},
      {"Inertia", {"mass_matrix"}, write_mass_matrix, true},
      {"Inertia", {"drive_inertia"}, write_drive_inertia},
      {"Inertia", {"mass_matrix_point_mass"}, write_point_mass, true, "only for a delta"},
      {"Inertia", {"cartesian_mass"}, write_cartesian_mass, true},
      {"Inertia", {"apparent_mass", "inertia_ellipsoid"}, write_apparent_mass, true},
      {"Inertia", {"dynamic_manipulability"}, write_dynamic_manipulability, true},
      {"Inertia", {"acceleration_limits"}, write_acceleration_limits, true},
      {"Stiffness", {"stiffness", "stiffness_with_drives", "compliance"}, write_stiffness},
      {"Stiffness", {"deflection"}, write_deflection, false, kLoad},
      {"Stiffness", {"stiffness_indices"}, write_stiffness_indices},
      {"Stiffness", {"loaded"}, write_loaded},
      {"Stiffness", {"compliance_shares"}, write_compliance_shares},
      {"Vibration", {"natural_frequencies"}, write_natural_frequencies, true},
      {"Resolution", {"resolution"}, write_resolution, true},
  };
  return table;
}

void write_sections(const Situation& situation, Answer& answer) {
  for (const Section& section : sections()) {
    const bool wanted = std::any_of(section.keys.begin(), section.keys.end(),
                                    [&](const char* key) { return answer.wants(key); });
    if (!wanted) continue;
    answer.begin(section.heading);
    if (section.needs_rates && situation.singularity.gains) {
      for (const char* key : section.keys)
        answer.undefined(key, "the tool moves although every joint is held: nothing follows from the joints");
      continue;
    }
    section.write(situation, answer);
  }
}

void check_only(const std::vector<std::string>& only) {
  std::vector<std::string> known = kOtherKeys;
  for (const Section& section : sections()) known.insert(known.end(), section.keys.begin(), section.keys.end());
  for (const std::string& key : only) {
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw InputError(fmt::format("--only {}: there is no such key; {}", key, suggest(key, known)));
  }
}

bool Answer::wants(const std::string& key) const {
  return only_.empty() || std::find(only_.begin(), only_.end(), key) != only_.end();
}

void Answer::undefined(const std::string& key, const std::string& reason) {
  document_[key] = nullptr;
  notes_[key] = reason;
}

void Answer::begin(const std::string& heading) {
  heading_ = heading;
}

Sheet& Answer::page() {
  if (heading_ != shown_heading_) {
    if (!heading_.empty()) sheet_.heading(heading_);
    shown_heading_ = heading_;
    shown_columns_.clear();
  }
  return sheet_;
}

void Answer::columns(const std::vector<std::string>& names) {
  Sheet& sheet = page();
  if (names == shown_columns_) return;
  sheet.cells("", names);
  shown_columns_ = names;
}

void Answer::cells(std::string_view label, const Eigen::Ref<const Eigen::VectorXd>& values, double factor,
                   std::string_view note, int digits, double rounding) {
  double largest = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  std::vector<std::string> texts;
  for (const double value : values)
    texts.push_back(number(std::abs(value) < rounding * largest ? 0.0 : value * factor, digits));
  page().cells(label, texts, note);
}

void Answer::tool_vector(const Frame& frame, const ToolVector& values, std::string_view linear,
                         double linear_factor, std::string_view angular, double angular_factor,
                         std::string_view note) {
  const std::vector<std::string> names = frame.names();
  const int split = frame.linear();
  if (split > 0) {
    columns({names.begin(), names.begin() + split});
    cells(linear, values.head(split), linear_factor, note);
  }
  if (split < values.size()) {
    columns({names.begin() + split, names.end()});
    cells(angular, values.tail(values.size() - split), angular_factor, split > 0 ? "" : note);
  }
}

void Answer::cell(std::string_view label, double value, std::string_view note) {
  page().cells(label, {number(value)}, note);
}

Json Answer::document() const {
  Json result;
  for (const auto& [key, value] : document_.items()) {
    if (key == "device" || key == "status" || wants(key)) result[key] = value;
  }
  Json notes;
  for (const auto& [key, note] : notes_.items()) {
    if (wants(key)) notes[key] = note;
  }
  // Whoever asks for a key by name is told why it is not there.
  for (const std::string& key : only_) {
    for (const Section& section : sections()) {
      const bool its = std::find(section.keys.begin(), section.keys.end(), key) != section.keys.end();
      if (!its || result.contains(key) || section.otherwise == nullptr) continue;
      result[key] = nullptr;
      notes[key] = section.otherwise;
    }
  }
  if (!notes.empty()) result["notes"] = notes;
  return result;
}

bool slides(const Mechanism& mechanism, int joint) {
  return mechanism.joints()[static_cast<size_t>(joint)].type == JointType::prismatic;
}

JointUnits joint_units(const Mechanism& mechanism) {
  int sliding = 0;
  for (int i = 0; i < mechanism.active_count(); ++i)
    sliding += slides(mechanism, mechanism.active_joint(i)) ? 1 : 0;
  if (sliding == 0) return {"torque", "mN m", kMilli, "g cm²", 1e7};
  if (sliding == mechanism.active_count()) return {"force", "N", 1.0, "g", kMilli};
  return {"torque", "N m, N", 1.0, "kg m², kg", 1.0};
}

std::string joint_text(const Mechanism& mechanism, int joint, double value) {
  if (std::abs(value) < 1e-12) value = 0.0;  // rounding errors are no angles
  return slides(mechanism, joint) ? quantity(value, kMilli, "mm", 5)
                                  : fmt::format("{}°", number(value * kDegrees, 5));
}

std::string direction_text(const ToolVector& direction) {
  std::string text;
  for (const double value : direction)
    text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", std::abs(value) < 5e-4 ? 0.0 : value);
  return text;
}

}  // namespace zwidth::at
