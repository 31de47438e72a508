#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "model.h"
#include "verbs.h"

#include "zwidth/analysis/force.h"
#include "zwidth/analysis/inertia.h"
#include "zwidth/analysis/resolution.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {

namespace {

struct AtArguments : DeviceArguments {
  std::string joints;
  std::string position;
  std::string load;
  std::string rate;
  std::string acceleration;
  std::string frame = "device";
  std::vector<std::string> only;
};

const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> keys = {"device",
                                                "status",
                                                "frame",
                                                "joint_names",
                                                "joints",
                                                "passive_joint_names",
                                                "passive_joints",
                                                "position",
                                                "orientation",
                                                "jacobian",
                                                "condition_number",
                                                "manipulability",
                                                "velocity",
                                                "acceleration",
                                                "load",
                                                "torques",
                                                "gravity_torques",
                                                "force_limits",
                                                "mass_matrix",
                                                "mass_matrix_point_mass",
                                                "cartesian_mass",
                                                "resolution",
                                                "singularity",
                                                "solutions",
                                                "nearest_reachable",
                                                "reason",
                                                "notes"};
  return keys;
}

std::vector<double> parsed(const char* option, const std::string& text,
                           const std::vector<Dimension>& dimensions) {
  const ParsedQuantities values = parse_quantity_list(text, dimensions);
  if (!values)
    throw InputError(fmt::format("{} \"{}\": {}{}", option, text, values.rule,
                                 values.advice.empty() ? "" : "; " + values.advice));
  return values.values;
}

ActiveVector active_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Dimensions of the active joints, of their rates (order 1) or accelerations (order 2).
std::vector<Dimension> joint_dimensions(const Mechanism& mechanism, int order) {
  std::vector<Dimension> result;
  for (int i = 0; i < mechanism.active_count(); ++i) {
    const bool slides =
        mechanism.joints()[static_cast<size_t>(mechanism.active_joint(i))].type == JointType::prismatic;
    if (order == 0) result.push_back(slides ? Dimension::length : Dimension::angle);
    if (order == 1) result.push_back(slides ? Dimension::speed : Dimension::angular_speed);
    if (order == 2) result.push_back(slides ? Dimension::acceleration : Dimension::angular_acceleration);
  }
  return result;
}

bool slides(const Mechanism& mechanism, int joint) {
  return mechanism.joints()[static_cast<size_t>(joint)].type == JointType::prismatic;
}

std::string joint_text(const Mechanism& mechanism, int joint, double value) {
  // Rounding errors are no angles.
  if (std::abs(value) < 1e-12) value = 0.0;
  return slides(mechanism, joint) ? quantity(value, kMilli, "mm", 5)
                                  : fmt::format("{}°", number(value * kDegrees, 5));
}

/// The frame that the user chose to speak in: tool vectors are R times those of the base frame.
struct Frame {
  Matrix3 R = Matrix3::Identity();

  template <class Matrix>
  Matrix rows(const Matrix& values) const {
    Matrix result = values;
    for (Eigen::Index r = 0; r + 3 <= values.rows(); r += 3)
      result.middleRows(r, 3) = (R * values.middleRows(r, 3)).eval();
    return result;
  }
};

/// Why a point lies out of reach of a delta's legs, in words.
std::string delta_reach(const DeltaGeometry& geometry, const Vector3& p) {
  // Legs with the same complaint share a sentence.
  std::vector<std::pair<std::string, std::string>> complaints;
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
      complaints.emplace_back(fmt::format("leg{}", leg + 1), complaint);
    } else {
      same->first += fmt::format(" and leg{}", leg + 1);
    }
  }
  std::string text;
  for (const auto& [legs, complaint] : complaints) {
    text += fmt::format("{}{} {} {}", text.empty() ? "" : "; ", legs,
                        legs.find(' ') == std::string::npos ? "is" : "are", complaint);
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

std::vector<std::string> cells_of(const Eigen::Ref<const Eigen::VectorXd>& values, double factor,
                                  int digits = 4, double rounding = 1e-13) {
  const double largest = values.cwiseAbs().maxCoeff();
  std::vector<std::string> cells;
  for (const double value : values) {
    // Rounding errors beside real numbers are zeros.
    cells.push_back(number(std::abs(value) < rounding * largest ? 0.0 : value * factor, digits));
  }
  return cells;
}

class Answer {
 public:
  Answer(const Model& model, const AtArguments& arguments)
      : model_(model), mechanism_(model.mechanism), arguments_(arguments), sheet_(Terminal{}) {
    if (arguments.frame == "user") {
      frame_.R = model.description.to_user;
    } else if (arguments.frame != "device") {
      throw InputError(fmt::format("--frame {}: must be \"device\" or \"user\"", arguments.frame));
    }
  }

  int run(const Terminal& terminal) {
    sheet_ = Sheet(terminal);
    document_["device"] = model_.description.name;
    std::vector<Solution> solutions;
    Vector3 target = Vector3::Zero();
    Solution solution;
    if (!arguments_.joints.empty()) {
      solution = solve_forward(
          mechanism_, active_vector(parsed("--joints", arguments_.joints, joint_dimensions(mechanism_, 0))));
    } else {
      const auto p = parsed("--position", arguments_.position, std::vector<Dimension>(3, Dimension::length));
      target = frame_.R.transpose() * Vector3(p[0], p[1], p[2]);
      solution = solve_inverse(mechanism_, Pose{target, Matrix3::Identity()});
      solutions = solve_inverse_all(mechanism_, Pose{target, Matrix3::Identity()});
    }
    document_["status"] = to_string(solution.status);
    document_["frame"] = arguments_.frame;
    solution_status_ = solution.status;
    std::string reason;
    if (solution.status == SolveStatus::joint_limit) reason = limits_broken(mechanism_, *solution.posture);
    if (solution) {
      posture(solution, reason);
    } else {
      reason = unsolved(solution, target);
    }
    if (!arguments_.position.empty()) branches(solutions);
    const bool no = solution.status != SolveStatus::reached && solution.status != SolveStatus::degraded;
    if (no && !arguments_.position.empty()) nearest(target, reason);
    if (!reason.empty()) document_["reason"] = reason;
    if (!notes_.empty()) document_["notes"] = notes_;
    if (arguments_.json) {
      print_json(chosen());
      if (no) complain(fmt::format("{}: {}", to_string(solution.status), reason));
    } else {
      print(sheet_.text());
    }
    return no ? kNo : kDone;
  }

 private:
  bool wanted(const char* key) const {
    return arguments_.only.empty() ||
           std::find(arguments_.only.begin(), arguments_.only.end(), key) != arguments_.only.end();
  }

  Json chosen() const {
    if (arguments_.only.empty()) return document_;
    Json result;
    for (const auto& [key, value] : document_.items()) {
      if (key == "device" || key == "status" || wanted(key.c_str())) result[key] = value;
    }
    return result;
  }

  void head(const std::string& status, Tint tint) {
    sheet_.title(fmt::format("{} at {}", model_.description.name,
                             arguments_.joints.empty() ? arguments_.position : arguments_.joints),
                 arguments_.frame == "user" ? "user's frame: x to the user, y right, z up" : "device frame");
    sheet_.row("status", tinted(sheet_.terminal(), tint, status));
  }

  /// Everything that a solved posture answers.
  void posture(const Solution& solution, const std::string& reason) {
    const Posture& posture = *solution.posture;
    const bool bad = solution.status == SolveStatus::joint_limit;
    head(to_string(solution.status), bad                                        ? Tint::bad
                                     : solution.status == SolveStatus::degraded ? Tint::warning
                                                                                : Tint::good);
    if (!reason.empty()) sheet_.paragraph(reason, 2, Tint::bad);

    const Rates rate_maps = rates(posture);
    const Jacobian J = frame_.rows(rate_maps.tool);
    const bool translates = mechanism_.tool_rows() == 3;
    joints(posture);
    tool(posture);

    document_["jacobian"] = json_array(J);
    dexterity_and_singularity(posture, rate_maps, J, translates, solution.status);
    motion(posture, rate_maps, J);
    forces(posture, rate_maps, J);
    inertia(posture, rate_maps, J);
    resolution(J);
  }

  void joints(const Posture& posture) {
    Json names = Json::array();
    Json values = Json::array();
    Json passive_names = Json::array();
    Json passive = Json::array();
    sheet_.heading("Joints");
    for (int i = 0; i < mechanism_.active_count(); ++i) {
      names.push_back(mechanism_.active_names()[static_cast<size_t>(i)]);
      values.push_back(json_number(posture.active()[i]));
    }
    std::vector<std::vector<std::string>> rows;
    for (const LegModel& leg : mechanism_.legs()) {
      for (int j = leg.first; j < leg.first + leg.count; ++j) {
        const JointModel& joint = mechanism_.joints()[static_cast<size_t>(j)];
        const std::string& name = mechanism_.joint_names()[static_cast<size_t>(j)];
        if (joint.active < 0) {
          passive_names.push_back(name);
          passive.push_back(json_number(posture.joints()[j]));
        }
        const bool limited = joint.range.width() < 1e6;
        rows.push_back({joint.active < 0 ? name : mechanism_.active_names()[static_cast<size_t>(joint.active)],
                        joint_text(mechanism_, j, posture.joints()[j]), joint.active < 0 ? "passive" : "active",
                        limited ? fmt::format("{} … {}", joint_text(mechanism_, j, joint.range.min),
                                              joint_text(mechanism_, j, joint.range.max))
                                : ""});
      }
    }
    sheet_.table({"joint", "value", "", "range"}, rows);
    document_["joint_names"] = names;
    document_["joints"] = values;
    document_["passive_joint_names"] = passive_names;
    document_["passive_joints"] = passive;
  }

  void tool(const Posture& posture) {
    const Vector3 p = frame_.R * posture.tool().position;
    document_["position"] = json_array(p);
    document_["orientation"] = json_array(Matrix3(frame_.R * posture.tool().rotation));
    sheet_.heading("Tool");
    axes_head();
    sheet_.cells("position [mm]", cells_of(p, kMilli, 6));
  }

  void axes_head() { sheet_.cells("", {"x", "y", "z"}); }

  void joints_head() { sheet_.cells("", mechanism_.active_names()); }

  void dexterity_and_singularity(const Posture& posture, const Rates& rate_maps, const Jacobian& J,
                                 bool translates, SolveStatus status) {
    Json singularity;
    singularity["closure"] = json_number(rate_maps.closure);
    sheet_.heading("Dexterity");
    if (translates) {
      const Dexterity figures = dexterity(J);
      document_["condition_number"] = json_number(figures.condition_number);
      document_["manipulability"] = json_number(figures.manipulability);
      singularity["min_singular_value"] = json_number(figures.min_singular_value);
      singularity["max_singular_value"] = json_number(figures.max_singular_value);
      singularity["weak_direction"] = json_array(figures.weak_direction);
      if (!std::isfinite(figures.condition_number))
        notes_["condition_number"] = "infinite: the Jacobian is singular here";
      joints_head();
      for (int r = 0; r < 3; ++r) {
        sheet_.cells(r == 0 ? "Jacobian [mm/rad]" : "", cells_of(J.row(r).transpose(), kMilli),
                     fmt::format("d{}", static_cast<char>('x' + r)));
      }
      sheet_.cells("condition number", {number(figures.condition_number)}, "1 is best");
      sheet_.cells("manipulability [cm³/rad³]", {number(figures.manipulability * 1e6)}, "|det J|");
      if (status == SolveStatus::degraded || rate_maps.closure < 1e-6) {
        const bool gains = rate_maps.closure < 1e-6;
        singularity["kind"] = gains ? "the tool gains a freedom" : "the tool loses a freedom";
        sheet_.paragraph(gains ? "Near a singularity: the tool can move although the joints are held; forces "
                                 "there are not controlled."
                               : fmt::format("Near a singularity: the tool can hardly move along ({}).",
                                             direction_text(figures.weak_direction)),
                         2, Tint::warning);
      }
    } else {
      document_["condition_number"] = nullptr;
      document_["manipulability"] = nullptr;
      notes_["condition_number"] =
          "not defined: the tool both translates and turns, and metres cannot be compared with radians";
      notes_["manipulability"] = notes_["condition_number"];
      sheet_.row("condition number", "not defined", "the tool both translates and turns");
    }
    if (const auto& geometry = mechanism_.delta()) {
      const DeltaState state(*geometry, Vector3(posture.active()), posture.tool().position);
      singularity["legs"] = json_array(state.inverse_singularity());
      singularity["platform"] = json_number(state.direct_singularity());
      sheet_.cells("distance to leg singularities", cells_of(state.inverse_singularity(), 1.0),
                   "0: stretched or folded");
      sheet_.cells("distance to platform singularity", {number(state.direct_singularity())},
                   "0: the forearms are coplanar");
    }
    document_["singularity"] = singularity;
  }

  static std::string direction_text(const ToolVector& direction) {
    std::string text;
    for (Eigen::Index i = 0; i < direction.size(); ++i)
      text += (i > 0 ? ", " : "") + fmt::format("{:.3f}", direction[i]);
    return text;
  }

  void motion(const Posture& posture, const Rates& rate_maps, const Jacobian& J) {
    if (!moving()) return;
    const BiasAcceleration bias = bias_acceleration(posture, rate_maps, rate_);
    const ToolVector v = J * rate_;
    const ToolVector a = J * acceleration_ + frame_.rows(bias.tool);
    document_["velocity"] = json_array(v);
    document_["acceleration"] = json_array(a);
    sheet_.heading("Motion");
    axes_head();
    sheet_.cells("velocity [mm/s]", cells_of(v.head(3), kMilli));
    sheet_.cells("acceleration [m/s²]", cells_of(a.head(3), 1.0));
  }

  bool moving() {
    rate_ = ActiveVector::Zero(mechanism_.active_count());
    acceleration_ = rate_;
    if (!arguments_.rate.empty())
      rate_ = active_vector(parsed("--rate", arguments_.rate, joint_dimensions(mechanism_, 1)));
    if (!arguments_.acceleration.empty()) {
      acceleration_ =
          active_vector(parsed("--acceleration", arguments_.acceleration, joint_dimensions(mechanism_, 2)));
    }
    return !arguments_.rate.empty() || !arguments_.acceleration.empty();
  }

  void forces(const Posture& posture, const Rates& rate_maps, const Jacobian& J) {
    const int rows = mechanism_.tool_rows();
    ToolVector load = ToolVector::Zero(rows);
    const bool loaded = !arguments_.load.empty();
    if (loaded) {
      const bool wrench = std::count(arguments_.load.begin(), arguments_.load.end(), ',') > 2 && rows == 6;
      std::vector<Dimension> dimensions(3, Dimension::force);
      if (wrench) dimensions.insert(dimensions.end(), 3, Dimension::torque);
      const auto values = parsed("--load", arguments_.load, dimensions);
      for (size_t i = 0; i < values.size(); ++i) load[static_cast<Eigen::Index>(i)] = values[i];
    }
    sheet_.heading("Forces and torques");
    joints_head();
    if (loaded) document_["load"] = json_array(load);
    const ActiveVector gravity = gravity_torques(posture, rate_maps);
    // The user pushes back on the tool with what the device exerts.
    const ToolVector push = -frame_back(load);
    const ActiveVector torques = inverse_dynamics(posture, rate_, acceleration_, push);
    document_["torques"] = json_array(torques);
    document_["gravity_torques"] = json_array(gravity);
    sheet_.cells("torque against gravity [mN m]", cells_of(gravity, kMilli));
    if (loaded || moving()) {
      sheet_.cells(loaded ? "torque with load [mN m]" : "torque in motion [mN m]", cells_of(torques, kMilli),
                   loaded ? "the load is what the device exerts on the hand" : "");
    }
    if (!model_.driven()) {
      document_["force_limits"] = nullptr;
      notes_["force_limits"] = "some joints have no drive";
      return;
    }
    const ActiveVector continuous = model_.continuous_torque();
    const ActiveVector peak = model_.peak_torque();
    sheet_.cells("continuous limit [mN m]", cells_of(continuous, kMilli));
    sheet_.cells("peak limit [mN m]", cells_of(peak, kMilli));
    if (loaded || moving()) {
      const ActiveVector share = torques.cwiseAbs().cwiseQuotient(continuous);
      sheet_.cells("of the continuous limit [%]", cells_of(share, 100.0, 3),
                   share.maxCoeff() <= 1.0 ? "" : "more than can be held");
    }
    Json limits;
    axes_head();
    for (const auto& [name, torque] : {std::pair{"continuous", continuous}, std::pair{"peak", peak}}) {
      const ToolVector axis = axis_force_limits(J, torque);
      Json entry;
      entry["torque"] = json_array(torque);
      entry["axis"] = json_array(axis);
      sheet_.cells(fmt::format("{} force [N]", name), cells_of(axis.head(3), 1.0), "alone along each axis");
      if (J.rows() == J.cols()) {
        const ForcePolytope polytope = force_polytope(J, torque);
        entry["every_direction"] = json_number(polytope.weakest);
        entry["weakest_direction"] = json_array(polytope.weakest_direction);
        entry["strongest"] = json_number(polytope.strongest);
        entry["strongest_direction"] = json_array(polytope.strongest_direction);
        sheet_.cells("  in every direction [N]", {number(polytope.weakest)},
                     fmt::format("weakest along ({})", direction_text(polytope.weakest_direction)));
      }
      limits[name] = entry;
    }
    document_["force_limits"] = limits;
  }

  /// A tool vector in the user's chosen frame, turned into the base frame.
  ToolVector frame_back(const ToolVector& vector) const {
    Frame back;
    back.R = frame_.R.transpose();
    return back.rows(vector);
  }

  void inertia(const Posture& posture, const Rates& rate_maps, const Jacobian& J) {
    const ActiveMatrix M = mass_matrix(posture, rate_maps);
    document_["mass_matrix"] = json_array(M);
    sheet_.heading("Inertia");
    joints_head();
    for (int i = 0; i < M.rows(); ++i)
      sheet_.cells(i == 0 ? "mass matrix [g cm²]" : "", cells_of(M.row(i).transpose(), 1e7));
    if (const auto& geometry = mechanism_.delta()) {
      DeltaMasses masses = delta_masses(model_.description);
      masses.motor_inertia = Vector3(mechanism_.drive_inertia());
      const DeltaState state(*geometry, Vector3(posture.active()), posture.tool().position);
      const Matrix3 lumped = DeltaPointMassDynamics(*geometry, masses).mass_matrix(state);
      document_["mass_matrix_point_mass"] = json_array(lumped);
      for (int i = 0; i < 3; ++i)
        sheet_.cells(i == 0 ? "  with forearms as points" : "", cells_of(lumped.row(i).transpose(), 1e7),
                     i == 0 ? "Neal 2015, appendix B" : "");
    }
    const ToolMatrix felt = cartesian_mass(J, M);
    document_["cartesian_mass"] = json_array(felt);
    if (felt.rows() == 3) {
      const ApparentMass mass = apparent_mass(felt);
      axes_head();
      sheet_.cells("apparent mass [g]", cells_of(mass.along_axes, kMilli), "free to move sideways");
    }
  }

  void resolution(const Jacobian& J) {
    if (!model_.driven()) {
      document_["resolution"] = nullptr;
      notes_["resolution"] = "some joints have no drive";
      return;
    }
    Json entry;
    entry["joint"] = json_array(model_.joint_step());
    entry["torque"] = json_array(model_.torque_step());
    const ToolVector steps = tool_resolution(J, model_.joint_step());
    entry["position"] = json_array(steps);
    sheet_.heading("Resolution");
    axes_head();
    sheet_.cells("position step [µm]", cells_of(steps.head(3), 1e6), "one count in every joint");
    if (J.rows() == J.cols()) {
      const ToolVector force = force_resolution(J, model_.torque_step());
      entry["force"] = json_array(force);
      sheet_.cells("force step [mN]", cells_of(force.head(3), kMilli), "one current step in every motor");
    }
    document_["resolution"] = entry;
  }

  std::string unsolved(const Solution& solution, const Vector3& target) {
    head(to_string(solution.status), Tint::bad);
    std::string reason;
    if (solution.status == SolveStatus::degenerate) {
      reason = "the equations leave the posture open here: a joint can turn freely or the legs coincide";
    } else if (!arguments_.position.empty() && mechanism_.delta()) {
      reason = delta_reach(*mechanism_.delta(), target);
    } else if (!arguments_.joints.empty()) {
      reason = "the legs cannot close at these joint values";
    }
    if (reason.empty()) reason = "the legs cannot reach this point";
    sheet_.paragraph(reason, 2, Tint::bad);
    return reason;
  }

  void branches(const std::vector<Solution>& solutions) {
    Json list = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const Solution& solution : solutions) {
      if (!solution) continue;
      Json entry;
      const bool within = solution.status != SolveStatus::joint_limit;
      entry["status"] = to_string(solution.status);
      entry["within_range"] = within;
      entry["joints"] = json_array(solution.posture->active());
      entry["residual"] = json_number(solution.residual);
      list.push_back(entry);
      std::vector<std::string> row{to_string(solution.status)};
      for (int i = 0; i < mechanism_.active_count(); ++i) {
        row.push_back(joint_text(mechanism_, mechanism_.active_joint(i), solution.posture->active()[i]));
      }
      rows.push_back(row);
    }
    document_["solutions"] = list;
    if (rows.empty()) return;
    sheet_.heading("Branches");
    std::vector<std::string> header{"status"};
    header.insert(header.end(), mechanism_.active_names().begin(), mechanism_.active_names().end());
    sheet_.table(header, rows);
  }

  void nearest(const Vector3& target, std::string& reason) {
    const auto point = nearest_reachable(mechanism_, target);
    if (!point) {
      document_["nearest_reachable"] = nullptr;
      notes_["nearest_reachable"] = "no joint values close the legs";
      return;
    }
    const Vector3 p = frame_.R * point->position;
    Json entry;
    entry["position"] = json_array(p);
    entry["joints"] = json_array(point->joints);
    entry["distance"] = json_number(point->distance);
    document_["nearest_reachable"] = entry;
    if (point->distance < 1e-9 && solution_status_ == SolveStatus::unreachable) {
      const std::string turned = "the tool can be there, but not with its axes along those of the base frame";
      reason += "; " + turned;
      sheet_.paragraph(turned);
    }
    sheet_.heading("Nearest reachable point");
    axes_head();
    sheet_.cells("position [mm]", cells_of(p, kMilli, 6, 1e-8));
    sheet_.cells("distance [mm]", {number(point->distance * kMilli)});
    // Joint values, because a rounded position may lie outside again.
    std::string joints;
    for (int i = 0; i < mechanism_.active_count(); ++i) {
      const bool slide = slides(mechanism_, mechanism_.active_joint(i));
      joints += fmt::format("{}{}{}", i > 0 ? "," : "",
                            trimmed(point->joints[i] * (slide ? kMilli : kDegrees), 7), slide ? "mm" : "deg");
    }
    sheet_.row("try", fmt::format("zwidth at {} --joints {}", arguments_.device, joints));
  }

  const Model& model_;
  const Mechanism& mechanism_;
  const AtArguments& arguments_;
  Frame frame_;
  Sheet sheet_;
  Json document_;
  Json notes_;
  SolveStatus solution_status_ = SolveStatus::unreachable;
  ActiveVector rate_;
  ActiveVector acceleration_;
};

int at(const AtArguments& arguments, const Terminal& terminal) {
  if (arguments.joints.empty() == arguments.position.empty()) {
    throw InputError(
        "give either --joints (e.g. --joints 10deg,20deg,30deg) or --position (e.g. --position 0,0,150mm)");
  }
  for (const std::string& key : arguments.only) {
    if (std::find(known_keys().begin(), known_keys().end(), key) == known_keys().end()) {
      throw InputError(fmt::format("--only {}: there is no such key; {}", key, suggest(key, known_keys())));
    }
  }
  const Model model(read_device(arguments));
  return Answer(model, arguments).run(terminal);
}

}  // namespace

void add_at(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, "at", "Everything about one posture",
      "  zwidth at delta --joints 10deg,20deg,30deg\n"
      "  zwidth at delta --position 20mm,-30mm,120mm          with every branch of the inverse kinematics\n"
      "  zwidth at delta --joints 0,0,0 --load 1,2,3 --json   torques for a force on the hand\n"
      "  zwidth at delta --position 0,0,0.15 --only position,force_limits --json\n"
      "\nThe load is the force that the device exerts on the user's hand, so torques = gravity_torques + J^T "
      "load\n"
      "(at rest). Numbers without a unit are SI: metres, radians, newtons.");
  auto arguments = std::make_shared<AtArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--joints", arguments->joints, "values of the active joints, between commas")
      ->type_name("A,B,...");
  verb->add_option("--position", arguments->position, "position of the tool")->type_name("X,Y,Z");
  verb->add_option("--load", arguments->load, "force that the device exerts on the hand")
      ->type_name("FX,FY,FZ");
  verb->add_option("--rate", arguments->rate, "rates of the active joints")->type_name("A,B,...");
  verb->add_option("--acceleration", arguments->acceleration, "accelerations of the active joints")
      ->type_name("A,B,...");
  verb->add_option("--frame", arguments->frame,
                   "frame of positions and forces, given and printed: device or user")
      ->type_name("FRAME");
  verb->add_option("--only", arguments->only, "keys of the JSON document to print")
      ->type_name("KEY,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return at(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
