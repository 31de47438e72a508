#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>

#include "efforts.h"
#include "joint_values.h"
#include "model.h"
#include "size_balance.h"
#include "size_pneumatic.h"
#include "verbs.h"

#include "zwidth/analysis/sizing.h"
#include "zwidth/analysis/statics.h"
#include "zwidth/description/names.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/jacobian.h"

/// `zwidth size`: what loads in postures ask of the drives, against what they have.

namespace zwidth {

namespace {

struct SizeArguments : DeviceArguments {
  std::vector<std::string> loads;
  std::string kind = "continuous";
  std::string moment_frame = "base";
  std::vector<std::string> postures;
  std::vector<std::string> joints;
  std::string position;
};

/// What one posture asks of one joint.
struct Loading {
  double gravity = 0.0;     ///< |torque| against gravity [N m]
  double per_newton = 0.0;  ///< largest |torque| per newton of tool force, over its directions [N m/N]
};

/// The most that any posture asks of one joint.
struct Requirement {
  double torque = 0.0;
  Vector3 at = Vector3::Zero();  ///< tool position there [m]
};

/// Postures over the whole workspace, its boundary included: a raster of the joint ranges.
std::vector<SizingPosture> raster(const Mechanism& mechanism) {
  const int n = mechanism.active_count();
  int per_joint = 2;
  while (per_joint < 25 && std::pow(per_joint + 1, n) <= 16000.0) ++per_joint;
  std::vector<SizingPosture> postures;
  std::vector<int> index(static_cast<size_t>(n), 0);
  for (bool more = true; more;) {
    ActiveVector q(n);
    for (int j = 0; j < n; ++j) {
      const Interval range = mechanism.active_range(j);
      q[j] = range.min + range.width() * index[static_cast<size_t>(j)] / (per_joint - 1);
    }
    if (Solution solution = solve_forward(mechanism, q)) postures.push_back({"", *solution.posture});
    more = false;
    for (int j = 0; j < n && !more; ++j) {
      more = ++index[static_cast<size_t>(j)] < per_joint;
      if (!more) index[static_cast<size_t>(j)] = 0;
    }
  }
  return postures;
}

std::vector<double> parsed(const char* option, const std::string& text,
                           const std::vector<Dimension>& dimensions) {
  const ParsedQuantities values = parse_quantity_list(text, dimensions);
  if (!values)
    throw InputError(fmt::format("{} \"{}\": {}{}", option, text, values.rule,
                                 values.advice.empty() ? "" : "; " + values.advice));
  return values.values;
}

template <class Enum>
Enum chosen(const char* option, const std::string& text,
            const std::vector<std::pair<std::string, Enum>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (name == text) return value;
    names.push_back(name);
  }
  throw InputError(fmt::format("{} \"{}\": is not known; {}", option, text, suggest(text, names)));
}

/// The entry of a list of the description that has this name.
template <class Named>
const Named& named(const char* option, const std::string& text, const std::vector<Named>& list,
                   const char* what) {
  std::vector<std::string> names;
  for (const Named& one : list) {
    if (one.name == text) return one;
    names.push_back(one.name);
  }
  throw InputError(names.empty() ? fmt::format("{} \"{}\": the device file has no [[{}]]", option, text, what)
                                 : fmt::format("{} \"{}\": is no [[{}]] of the device file; {}", option, text,
                                               what, suggest(text, names)));
}

LoadDescription parsed_load(const SizeArguments& arguments, const Description& description,
                            const Mechanism& mechanism, const std::string& text) {
  // A name first, for it may start with a digit; then whatever has a comma or starts like a number is numbers.
  const bool known = std::any_of(description.loads.begin(), description.loads.end(),
                                 [&](const LoadDescription& load) { return load.name == text; });
  const bool numbers = text.find(',') != text.npos || text.find_first_of("+-.0123456789") == 0;
  if (known || !numbers) return named("--load", text, description.loads, "load");
  const auto entries = std::count(text.begin(), text.end(), ',') + 1;
  const bool in_plane = mechanism.linear_rows() == 2, turns = mechanism.tool_turns();
  const bool only_turns = mechanism.linear_rows() == 0;
  // A tool in the plane x, y takes a force there, and if it turns a moment about z; one that only turns takes a
  // moment: the rows that `at` takes.
  std::vector<int> rows{0, 1};
  if (in_plane && turns && entries == 3) rows.push_back(5);
  if (!in_plane) rows = {0, 1, 2};
  if (!in_plane && turns && entries == 6) rows = {0, 1, 2, 3, 4, 5};
  if (only_turns) rows = {3, 4, 5};
  if (static_cast<std::size_t>(entries) != rows.size()) {
    throw InputError(
        fmt::format("--load \"{}\": has {} {}; give {}", text, entries, entries == 1 ? "entry" : "entries",
                    only_turns ? "three, a moment about x, y, z: the tool only turns, so it takes no force"
                    : in_plane && turns ? "two (a force along x, y) or three (and a moment about z)"
                    : in_plane          ? "two, a force along x, y"
                    : turns             ? "three (a force) or six (a force and a moment)"
                                        : "three, a force: the tool does not turn, so it takes no moment"));
  }
  std::vector<Dimension> dimensions;
  for (const int row : rows) dimensions.push_back(row < 3 ? Dimension::force : Dimension::torque);
  const std::vector<double> values = parsed("--load", text, dimensions);
  LoadDescription load;
  load.name = text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    (rows[i] < 3 ? load.force : load.moment)[rows[i] % 3] = values[i];
  }
  load.kind = chosen("--kind", arguments.kind, load_kind_names());
  load.moment_frame = chosen("--moment-frame", arguments.moment_frame, moment_frame_names());
  return load;
}

/// The posture of given joints; a posture that is outside the ranges counts, one that does not close is an
/// error.
SizingPosture posture_of(const Mechanism& mechanism, const std::string& name, const ActiveVector& joints) {
  const Solution solution = solve_forward(mechanism, joints);
  if (!solution)
    throw InputError(fmt::format("posture \"{}\": {}; see `zwidth at {}`", name, to_string(solution.status),
                                 mechanism.name()));
  return {name, *solution.posture};
}

std::string bar(double utilisation) {
  const int cells = static_cast<int>(std::lround(std::clamp(utilisation, 0.0, 1.0) * 12));
  std::string text;
  for (int i = 0; i < 12; ++i) text += i < cells ? "█" : "░";
  return text;
}

/// Coordinates [mm] in whole numbers, none of them -0.
std::string millimetres(const Vector3& at) {
  const auto whole = [](double x) { return std::round(x) + 0.0; };
  return fmt::format("{:.0f}, {:.0f}, {:.0f}", whole(at.x()), whole(at.y()), whole(at.z()));
}

/// What rounding leaves of a joint that feels nothing is nothing.
double without_dust(double torque, double limit) {
  return torque < 1e-12 * limit ? 0.0 : torque;
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{} %", number(100.0 * share, 3)) : "–";
}

class Answer {
 public:
  Answer(const Model& model, const SizeArguments& arguments, const Terminal& terminal)
      : model_(model), mechanism_(model.mechanism), arguments_(arguments), sheet_(terminal) {}

  int run() {
    loads_ = wanted_loads();
    if (!find_postures()) return kNo;
    document_["device"] = model_.description.name;
    document_["where"] = where_key_;
    if (loads_.empty()) {
      guaranteed_load();
    } else {
      load_cases();
    }
    std::vector<Posture> postures;
    postures.reserve(postures_.size());
    for (const SizingPosture& one : postures_) postures.push_back(one.posture);
    document_["balance"] = write_balance(model_.description, mechanism_, postures, sheet_);
    margins_and_parts();
    document_["ok"] = ok_;
    sheet_.gap();
    sheet_.paragraph(ok_ ? "The drives suffice." : "The drives do not suffice.", 2,
                     ok_ ? Tint::good : Tint::bad);
    if (arguments_.json) {
      print_json(document_);
    } else {
      print(sheet_.text());
    }
    return ok_ ? kDone : kNo;
  }

 private:
  const char* unit_of(int active) const { return effort_unit(joint_slides(mechanism_, active)); }
  /// The word that fits the driven joints: all turn, all slide, or some of both.
  const char* efforts(const char* turning, const char* sliding, const char* both) const {
    int slides = 0, turns = 0;
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      if (!mechanism_.is_free(j)) ++(joint_slides(mechanism_, j) ? slides : turns);
    }
    return slides == 0 ? turning : turns == 0 ? sliding : both;
  }

  std::vector<LoadDescription> wanted_loads() const {
    if (arguments_.loads.empty()) return model_.description.loads;
    std::vector<LoadDescription> loads;
    for (const std::string& text : arguments_.loads)
      loads.push_back(parsed_load(arguments_, model_.description, mechanism_, text));
    return loads;
  }

  /// False if the position that was asked for cannot be reached, which it then says.
  bool find_postures() {
    for (const std::string& text : arguments_.joints)
      postures_.push_back(posture_of(mechanism_, text, joint_values("--joints", text, mechanism_)));
    std::vector<PostureDescription> wanted;
    for (const std::string& text : arguments_.postures)
      wanted.push_back(named("--posture", text, model_.description.postures, "posture"));
    const bool nothing_said = arguments_.joints.empty() && wanted.empty() && arguments_.position.empty();
    if (nothing_said && !loads_.empty()) wanted = model_.description.postures;
    for (const PostureDescription& one : wanted) {
      postures_.push_back(posture_of(mechanism_, one.name,
                                     Eigen::Map<const Eigen::VectorXd>(one.joints.data(), one.joints.size())));
    }
    if (!arguments_.position.empty() && !reach(arguments_.position)) return false;
    where_ = "in the postures given";
    where_key_ = "postures";
    if (!arguments_.position.empty() && postures_.size() == 1) {
      where_ = "at " + arguments_.position;
      where_key_ = "position";
    }
    if (postures_.empty()) {
      where_ = "anywhere in the workspace";
      where_key_ = "workspace";
      postures_ = raster(mechanism_);
      if (postures_.empty()) throw InputError("the legs close nowhere in the joint ranges; see `zwidth check`");
    }
    return true;
  }

  bool reach(const std::string& text) {
    const bool in_plane = mechanism_.linear_rows() == 2 && std::count(text.begin(), text.end(), ',') == 1;
    std::vector<double> p =
        parsed("--position", text, std::vector<Dimension>(in_plane ? 2 : 3, Dimension::length));
    p.resize(3, 0.0);
    // As `at --position`: an arm turns its tool as it likes, in the posture nearest to home.
    SolveOptions options;
    if (mechanism_.serial() != nullptr) options.match = Match::position;
    const Pose goal{Vector3(p[0], p[1], p[2]), Matrix3::Identity()};
    Solution solution = solve_inverse(mechanism_, goal, options);
    constexpr double kThere = 1e-6;  // one held in a plane leaves the rest out
    if (solution && (solution.posture->tool().position - goal.position).norm() >
                        kThere * mechanism_.characteristic_length()) {
      solution.status = SolveStatus::unreachable;
      solution.posture.reset();
    }
    if (!solution || solution.status == SolveStatus::joint_limit) {
      complain(fmt::format("{} cannot be reached: {}; see `zwidth at {} --position {}`", text,
                           to_string(solution.status), arguments_.device, text));
      if (arguments_.json)
        print_json(Json{{"device", model_.description.name}, {"status", to_string(solution.status)}});
      return false;
    }
    postures_.push_back({text, *solution.posture});
    return true;
  }

  // ------------------------------------------------------------------------------- without loads

  /// Largest force, of a tool that only turns moment, that can be held in every direction in every posture, on
  /// top of gravity.
  void guaranteed_load() {
    const int n = mechanism_.active_count(), linear = mechanism_.linear_rows();
    const ActiveVector limit = model_.continuous_torque();
    std::vector<Loading> loadings(postures_.size() * static_cast<size_t>(n));
    double force = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < postures_.size(); ++i) {
      const Rates rate_maps = rates(postures_[i].posture);
      const Jacobian J = linear > 0 ? Jacobian(rate_maps.tool.topRows(linear)) : rate_maps.tool;
      const ActiveVector gravity = gravity_torques(postures_[i].posture, rate_maps);
      for (int j = 0; j < n; ++j) {
        const Loading loading{std::abs(gravity[j]), J.col(j).norm()};
        loadings[i * static_cast<size_t>(n) + static_cast<size_t>(j)] = loading;
        // What rounding leaves of an axis through the tool feels no force.
        if (loading.per_newton > kZeroRow * J.norm() && !mechanism_.is_free(j))
          force = std::min(force, (limit[j] - loading.gravity) / loading.per_newton);
      }
    }
    force = std::max(0.0, force);
    std::vector<Requirement> required(static_cast<size_t>(n)), gravity(static_cast<size_t>(n));
    for (size_t i = 0; i < postures_.size(); ++i) {
      const Vector3& at = postures_[i].posture.tool().position;
      for (int j = 0; j < n; ++j) {
        const auto index = static_cast<size_t>(j);
        const Loading& loading = loadings[i * static_cast<size_t>(n) + index];
        const double torque = loading.gravity + force * loading.per_newton;
        if (torque >= required[index].torque) required[index] = {torque, at};
        if (loading.gravity >= gravity[index].torque) gravity[index] = {loading.gravity, at};
      }
    }
    document_[linear > 0 ? "guaranteed_force" : "guaranteed_moment"] = json_number(force);
    sheet_.title(fmt::format("{}: sizing of the drives", model_.description.name), where_);
    sheet_.paragraph(
        fmt::format("The drives can hold {} in every direction {}, for as long as one likes, on top of the "
                    "device's own weight. Another load: --load {}.",
                    quantity(force, 1.0, linear > 0 ? "N" : "N m"), where_,
                    linear == 0   ? "MX,MY,MZ"
                    : linear == 2 ? "FX,FY"
                                  : "FX,FY,FZ"));
    sheet_.heading(efforts("Torque", "Force", "Torque and force"));
    Json joints = Json::array();
    std::vector<std::vector<std::string>> rows;
    const ActiveVector peak = model_.peak_torque();
    for (int j = 0; j < n; ++j) {
      if (mechanism_.is_free(j)) continue;
      const auto index = static_cast<size_t>(j);
      const std::string& name = mechanism_.active_names()[index];
      const bool good = required[index].torque <= limit[j] * (1.0 + 1e-9);
      ok_ = ok_ && good;
      joints.push_back({{"joint", name},
                        {"required", json_number(required[index].torque)},
                        {"required_at", json_array(required[index].at)},
                        {"gravity", json_number(gravity[index].torque)},
                        {"continuous", json_number(limit[j])},
                        {"peak", json_number(peak[j])},
                        {"ok", good}});
      const Vector3 at = required[index].at * kMilli;
      const char* unit = unit_of(j);
      const double needed = without_dust(required[index].torque, limit[j]);
      rows.push_back({name, readable(needed, unit),
                      readable(without_dust(gravity[index].torque, limit[j]), unit), readable(limit[j], unit),
                      readable(peak[j], unit), percent(needed / limit[j]), good ? "✓" : "✗", millimetres(at)});
      demands_.push_back({required[index].torque, 0.0});
    }
    sheet_.table({"joint", "required", "gravity", "continuous", "peak", "used", "", "worst at mm"}, rows);
    document_["joints"] = joints;
  }

  // ---------------------------------------------------------------------------------- with loads

  void load_cases() {
    const Sizing sizing = size_drives(postures_, loads_, capability_of(model_.drives));
    ok_ = sizing.ok;
    const bool one_load = loads_.size() == 1 && arguments_.loads.size() == 1;
    if (one_load) document_["load"] = load_numbers(loads_[0]);
    Json loads = Json::array();
    for (const LoadDescription& load : loads_) {
      loads.push_back({{"name", load.name},
                       {"kind", to_string(load.kind)},
                       {"force", json_array(load.force)},
                       {"moment", json_array(load.moment)},
                       {"moment_frame", to_string(load.moment_frame)}});
    }
    document_["loads"] = loads;
    sheet_.title(fmt::format("{}: sizing of the drives", model_.description.name),
                 where_key_ == "postures" ? fmt::format("{} posture{}, {} load{}", postures_.size(),
                                                        postures_.size() == 1 ? "" : "s", loads_.size(),
                                                        loads_.size() == 1 ? "" : "s")
                                          : where_);
    if (one_load) {
      const Vector3 &f = loads_[0].force, &m = loads_[0].moment;
      const auto vector = [](const Vector3& v, const char* unit) {
        return fmt::format("({:g}, {:g}, {:g}) {}", v.x(), v.y(), v.z(), unit);
      };
      std::string load = mechanism_.linear_rows() > 0 || !f.isZero(0.0) ? vector(f, "N") : "";
      if (load.empty() || !m.isZero(0.0)) load += (load.empty() ? "" : " and ") + vector(m, "N m");
      sheet_.paragraph(fmt::format("For the {} load {} on the hand, {}, on top of the device's own weight.",
                                   to_string(loads_[0].kind), load, where_));
    } else {
      sheet_.paragraph(
          fmt::format("For every load {}, on top of the device's own weight: the worst of each kind.", where_));
    }
    const bool published = std::any_of(loads_.begin(), loads_.end(), [](const LoadDescription& load) {
      return load.moment_frame == MomentFrame::published && !load.moment.isZero(0.0);
    });
    if (published) {
      sheet_.paragraph(
          "Moments are turned as the source's tables have them (moment_frame = \"published\"), which is not "
          "physics; `--set load.moment_frame=base` takes them as they are.",
          2, Tint::warning);
      notes_.push_back("moments in the frame \"published\" reproduce a source's tables; they are not physics");
    }
    joint_table(sizing);
    if (where_key_ == "postures") case_list(sizing);
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      if (mechanism_.is_free(j)) continue;
      const auto index = static_cast<size_t>(j);
      demands_.push_back({std::abs(sizing.continuous[index].torque), std::abs(sizing.peak[index].torque)});
    }
    if (!notes_.empty()) document_["notes"] = notes_;
  }

  Json load_numbers(const LoadDescription& load) const {
    Json numbers = mechanism_.linear_rows() > 0 ? json_array(load.force) : Json::array();
    if (mechanism_.tool_turns()) {
      for (const double value : load.moment) numbers.push_back(json_number(value));
    }
    return numbers;
  }

  std::string posture_name(int index) const {
    const SizingPosture& posture = postures_[static_cast<size_t>(index)];
    if (!posture.name.empty()) return posture.name;
    const Vector3 at = posture.posture.tool().position * kMilli;
    return millimetres(at) + " mm";
  }

  void joint_table(const Sizing& sizing) {
    Json joints = Json::array();
    std::array<std::vector<std::vector<std::string>>, 2> rows;  // continuous, peak
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      const auto index = static_cast<size_t>(j);
      const std::string& name = mechanism_.active_names()[index];
      const auto& drive = model_.drives[index];
      double gravity = 0.0;
      for (const SizingCase& one : sizing.cases) gravity = std::max(gravity, std::abs(one.gravity[j]));
      const TorqueLimit continuous = drive ? drive->continuous_torque() : TorqueLimit{};
      const TorqueLimit peak = drive ? drive->peak_torque() : TorqueLimit{};
      // The kind that is asked most stands for the joint.
      const JointDemand& worst = sizing.peak[index].utilisation > sizing.continuous[index].utilisation
                                     ? sizing.peak[index]
                                     : sizing.continuous[index];
      const bool good = sizing.continuous[index].ok && sizing.peak[index].ok;
      Json entry{{"joint", name},
                 {"required", json_number(std::abs(worst.torque))},
                 {"required_at",
                  worst.posture < 0
                      ? Json(nullptr)
                      : json_array(postures_[static_cast<size_t>(worst.posture)].posture.tool().position)},
                 {"gravity", json_number(gravity)},
                 {"continuous", json_number(continuous.usable)},
                 {"peak", json_number(peak.usable)},
                 {"ok", good}};
      Json demands;
      for (const LoadKind kind : {LoadKind::continuous, LoadKind::peak}) {
        const JointDemand& demand = sizing.demands(kind)[index];
        if (demand.posture < 0) continue;
        const TorqueLimit& limit_of = kind == LoadKind::peak ? peak : continuous;
        const LoadDescription& load = loads_[static_cast<size_t>(demand.load)];
        Json item{{"required", json_number(std::abs(demand.torque))},
                  {"available", json_number(demand.available)},
                  {"utilisation", json_number(demand.utilisation)},
                  {"ok", demand.ok},
                  {"limited_by", drive ? to_string(limit_of.limited_by) : "no drive"},
                  {"posture", posture_name(demand.posture)},
                  {"load", load.name}};
        if (drive) item["motor_torque"] = json_number(drive->motor_torque(std::abs(demand.torque)));
        demands[to_string(kind)] = item;
        const std::string limit = drive ? to_string(limit_of.limited_by) : "no drive";
        const double needed = without_dust(std::abs(demand.torque), demand.available);
        rows[kind == LoadKind::peak ? 1 : 0].push_back(
            {name, readable(needed, unit_of(j)), readable(demand.available, unit_of(j)),
             percent(needed > 0.0 ? demand.utilisation : 0.0), demand.ok ? "✓" : "✗ " + limit,
             posture_name(demand.posture), load.name});
      }
      entry["demands"] = demands;
      joints.push_back(entry);
    }
    for (const LoadKind kind : {LoadKind::continuous, LoadKind::peak}) {
      auto& of_kind = rows[kind == LoadKind::peak ? 1 : 0];
      if (of_kind.empty()) continue;
      sheet_.heading(fmt::format("{} for {}", efforts("Torque", "Force", "Torque and force"),
                                 kind == LoadKind::peak ? "a short time" : "ever"));
      sheet_.table({"joint", "required", "of", "used", "", "posture", "load"}, of_kind, false);
    }
    document_["joints"] = joints;
  }

  void case_list(const Sizing& sizing) {
    Json cases = Json::array();
    for (const SizingCase& one : sizing.cases) {
      const LoadDescription& load = loads_[static_cast<size_t>(one.load)];
      cases.push_back({{"posture", posture_name(one.posture)},
                       {"load", load.name},
                       {"kind", to_string(load.kind)},
                       {"torques", json_array(one.torque)},
                       {"gravity_torques", json_array(one.gravity)}});
    }
    document_["cases"] = cases;
  }

  // ----------------------------------------------------------------------------- drives and parts

  void margins_and_parts() {
    // Joints that share a drive's description are answered once, for the one that is asked most.
    struct Group {
      const Drive* drive;
      bool slides;
      std::string joints;
      DriveDemand demand;
    };
    std::vector<Group> groups;
    size_t driven = 0;
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      if (mechanism_.is_free(j)) continue;
      const DriveDemand& demand = demands_[driven++];
      const auto& drive = model_.drives[static_cast<size_t>(j)];
      if (!drive) continue;
      auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& other) {
        return other.slides == joint_slides(mechanism_, j) &&
               other.drive->description() == drive->description();
      });
      if (group == groups.end())
        group = groups.insert(groups.end(), Group{&*drive, joint_slides(mechanism_, j), "", {}});
      group->joints += (group->joints.empty() ? "" : ", ") + mechanism_.active_names()[static_cast<size_t>(j)];
      group->demand.continuous = std::max(group->demand.continuous, demand.continuous);
      group->demand.peak = std::max(group->demand.peak, demand.peak);
    }
    Json drives = Json::array();
    for (const Group& group : groups)
      drives.push_back(of_drive(*group.drive, group.joints, group.demand, group.slides));
    document_["drives"] = drives;
  }

  Json of_drive(const Drive& drive, const std::string& names, const DriveDemand& demand, bool slides) {
    Json entry;
    entry["joints"] = names;
    entry["torque"] = json_number(demand.continuous > 0.0 ? demand.continuous : demand.peak);
    entry["continuous_torque"] = json_number(demand.continuous);
    entry["peak_torque"] = json_number(demand.peak);
    Json list = Json::array();
    for (const LoadKind kind : {LoadKind::continuous, LoadKind::peak}) {
      const double torque = kind == LoadKind::peak ? demand.peak : demand.continuous;
      if (torque == 0.0) continue;
      std::vector<std::vector<std::string>> rows;
      for (const Margin& margin : load_margins(drive, torque, kind)) {
        ok_ = ok_ && margin.ok;
        const double used = margin.utilisation.value_or(std::numeric_limits<double>::infinity());
        list.push_back({{"kind", to_string(kind)},
                        {"name", margin.name},
                        {"demand", json_number(margin.demand)},
                        {"capability", json_number(margin.capability)},
                        {"unit", margin.unit},
                        {"utilisation", json_number(used)},
                        {"ok", margin.ok},
                        {"rule", margin.rule}});
        rows.push_back({margin.name, readable(margin.demand, margin.unit),
                        readable(margin.capability, margin.unit), percent(used), bar(used),
                        margin.ok ? "✓" : "✗"});
      }
      sheet_.heading(fmt::format("Margins of the drive of {} at {}{}", names,
                                 readable(torque, effort_unit(slides)),
                                 kind == LoadKind::peak ? " for a short time" : ""));
      sheet_.table({"", "demand", "limit", "used", "", ""}, rows);
      if (kind == LoadKind::peak) heat(drive, torque, entry);
    }
    entry["margins"] = list;
    if (const std::optional<double> ratio = least_ratio(drive, demand)) {
      entry["ratio"] = json_number(drive.ratio());
      entry["least_ratio"] = json_number(*ratio);
      sheet_.paragraph(fmt::format("Motor and amplifier need a ratio of {} for this; it is {}.",
                                   trimmed(*ratio, 4), trimmed(drive.ratio(), 4)));
    }
    Json broken = Json::array();
    for (const Margin& margin : standing_failures(drive)) {
      broken.push_back(margin.name);
      sheet_.paragraph(
          fmt::format("whatever the load, {}: {} of {}; {}", margin.name, readable(margin.demand, margin.unit),
                      readable(margin.capability, margin.unit), margin.rule),
          2, Tint::warning);
    }
    entry["broken_rules"] = broken;
    parts(drive, demand, slides, entry);
    return entry;
  }

  void heat(const Drive& drive, double torque, Json& entry) {
    const auto& thermal = drive.thermal();
    if (!thermal) return;
    const std::optional<double> time = thermal->time_to_overheat(drive.current_for_torque(torque));
    entry["time_at_peak"] = time ? json_number(*time) : Json(nullptr);
    sheet_.paragraph(time ? fmt::format("From cold the winding bears this for {}.", readable(*time, "s"))
                          : "The winding bears this for as long as one likes.");
  }

  void parts(const Drive& drive, const DriveDemand& demand, bool slides, Json& entry) {
    const char* felt = slides ? "holds for ever, felt mass" : "holds for ever, felt inertia";
    Json list = Json::array();
    std::vector<std::vector<std::string>> rows, pairs;
    for (const DriveCandidate& candidate : drive_candidates(drive, catalogue(), demand)) {
      list.push_back({{"kind", candidate.kind},
                      {"name", candidate.name},
                      {"used", candidate.used},
                      {"fits", candidate.fits},
                      {"continuous_torque", json_number(candidate.continuous)},
                      {"peak_torque", json_number(candidate.peak)},
                      {"reflected_inertia", json_number(candidate.reflected_inertia)},
                      {"utilisation", json_number(candidate.utilisation)},
                      {"reason", candidate.reason}});
      const std::string verdict =
          (candidate.fits ? fmt::format("✓ {}, {}", readable(candidate.continuous, effort_unit(slides), 3),
                                        readable(candidate.reflected_inertia, slides ? "kg" : "kg m^2", 3))
                          : "✗ " + candidate.reason) +
          (candidate.used ? " (in use)" : "");
      if (candidate.kind != "motor and gearhead") {
        rows.push_back({candidate.kind, candidate.name, verdict});
      } else if (candidate.fits) {  // of the many pairs only those that would do are worth a line
        pairs.push_back({candidate.name, verdict});
      }
    }
    entry["parts"] = list;
    sheet_.heading("Parts of the catalogue that would do, all else kept");
    sheet_.table({"kind", "part", felt}, rows, false);
    if (!pairs.empty()) {
      sheet_.gap();
      sheet_.table({"motor and gearhead", felt}, pairs, false);
    }
  }

  const Model& model_;
  const Mechanism& mechanism_;
  const SizeArguments& arguments_;
  Sheet sheet_;
  Json document_;
  Json notes_ = Json::array();
  bool ok_ = true;
  std::vector<LoadDescription> loads_;
  std::vector<SizingPosture> postures_;
  std::string where_;
  std::string where_key_;
  std::vector<DriveDemand> demands_;  // of each joint that is not free
};

/// What is asked about a device that cylinders move.
PneumaticSizeRequest pneumatic_request(const SizeArguments& arguments, const Description& description) {
  const Mechanism mechanism(description);
  PneumaticSizeRequest request{.json = arguments.json};
  if (arguments.loads.empty()) request.loads = description.loads;
  for (const std::string& text : arguments.loads)
    request.loads.push_back(parsed_load(arguments, description, mechanism, text));
  for (const std::string& text : arguments.joints)
    request.postures.emplace_back(text, joint_values("--joints", text, mechanism));
  std::vector<PostureDescription> wanted;
  for (const std::string& text : arguments.postures)
    wanted.push_back(named("--posture", text, description.postures, "posture"));
  const bool nothing_said = arguments.joints.empty() && wanted.empty() && arguments.position.empty();
  if (nothing_said && !request.loads.empty()) wanted = description.postures;
  for (const PostureDescription& one : wanted) {
    request.postures.emplace_back(one.name,
                                  Eigen::Map<const Eigen::VectorXd>(one.joints.data(), one.joints.size()));
  }
  if (!arguments.position.empty()) {
    const std::vector<double> p =
        parsed("--position", arguments.position, std::vector<Dimension>(3, Dimension::length));
    request.position = Vector3(p[0], p[1], p[2]);
  }
  return request;
}

int size(const SizeArguments& arguments, const Terminal& terminal) {
  const Description description = read_device(arguments);
  if (!description.pneumatic_drives.empty()) {
    return size_pneumatic(description, pneumatic_request(arguments, description), terminal);
  }
  const Model model(description);
  if (!model.driven())
    throw InputError(fmt::format(
        "{}: some joints have no drive, so nothing can be sized; add a [[drive]] to the device file",
        model.description.name));
  return Answer(model, arguments, terminal).run();
}

}  // namespace

void add_size(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, "size", "Required against available torque, margins of the drives, and parts that would do",
      "  zwidth size delta                                       the force that the drives can always hold\n"
      "  zwidth size delta --load 0,0,10                         10 N upwards, anywhere in the workspace\n"
      "  zwidth size delta --load 0,0,10 --position 0,0,150mm    at one place\n"
      "  zwidth size seven-dof                                   every [[load]] in every [[posture]] of the "
      "file\n"
      "  zwidth size seven-dof --load 0,0,5,0,0,0.1 --joints 0,60deg,0,45deg,0,0,0 --kind peak\n"
      "\nExits 1 if the drives do not suffice.");
  auto arguments = std::make_shared<SizeArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option(
          "--load", arguments->loads,
          "force, or force and moment, that the device exerts on the hand, device frame; or the name of a "
          "[[load]]; may be repeated. Left out: the loads of the device file")
      ->type_name("FX,FY,FZ[,MX,MY,MZ]")
      ->allow_extra_args(false);
  verb->add_option("--kind", arguments->kind, "how long a load given in numbers lasts: continuous or peak");
  verb->add_option("--moment-frame", arguments->moment_frame,
                   "what a moment given in numbers refers to: base or tool");
  verb->add_option("--posture", arguments->postures, "a [[posture]] of the device file; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  verb->add_option("--joints", arguments->joints, "a posture by its active joints; may be repeated")
      ->type_name("Q1,Q2,...")
      ->allow_extra_args(false);
  verb->add_option("--position", arguments->position,
                   "tool position to look at, instead of the whole workspace")
      ->type_name("X,Y,Z");
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return size(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
