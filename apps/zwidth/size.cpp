#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "model.h"
#include "verbs.h"

#include "zwidth/actuation/drive_problems.h"
#include "zwidth/analysis/force.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/jacobian.h"

namespace zwidth {

namespace {

struct SizeArguments : DeviceArguments {
  std::string load;
  std::string position;
};

/// Rules of a drive that do not depend on how hard the motor is driven.
const std::set<std::string> kStanding = {"supply voltage", "least supply voltage", "encoder frequency",
                                         "wrap spacing",   "cable bend radius",    "sector range"};

/// What one posture asks of one joint.
struct Loading {
  double gravity = 0.0;     ///< |torque| against gravity [N m]
  double per_newton = 0.0;  ///< largest |torque| per newton of tool force, over its directions [N m/N]
  double fixed = 0.0;       ///< |torque| of the given load and gravity [N m]
};

/// The most that any posture asks of one joint.
struct Requirement {
  double torque = 0.0;
  Vector3 at = Vector3::Zero();  ///< tool position there [m]
};

/// Postures over the whole workspace, its boundary included: a raster of the joint ranges.
std::vector<Posture> raster(const Mechanism& mechanism) {
  const int n = mechanism.active_count();
  int per_joint = 2;
  while (per_joint < 25 && std::pow(per_joint + 1, n) <= 16000.0) ++per_joint;
  std::vector<Posture> postures;
  std::vector<int> index(static_cast<size_t>(n), 0);
  for (bool more = true; more;) {
    ActiveVector q(n);
    for (int j = 0; j < n; ++j) {
      const Interval range = mechanism.active_range(j);
      q[j] = range.min + range.width() * index[static_cast<size_t>(j)] / (per_joint - 1);
    }
    if (Solution solution = solve_forward(mechanism, q)) postures.push_back(*solution.posture);
    more = false;
    for (int j = 0; j < n && !more; ++j) {
      more = ++index[static_cast<size_t>(j)] < per_joint;
      if (!more) index[static_cast<size_t>(j)] = 0;
    }
  }
  return postures;
}

struct SizeMargin {
  std::string name;
  double demand = 0.0;
  double capability = 0.0;
  std::string unit;
  bool ok() const { return demand <= capability * (1.0 + 1e-9); }
  double utilisation() const {
    return capability > 0.0 ? demand / capability : std::numeric_limits<double>::infinity();
  }
};

/// What a joint torque asks of every element of its drive.
std::vector<SizeMargin> margins_at(const Drive& drive, double joint_torque) {
  const Motor& motor = drive.description().motor;
  const Amplifier& amplifier = drive.description().amplifier;
  const double motor_torque = joint_torque / drive.ratio();
  const double current = std::abs(drive.current_for_torque(joint_torque));
  std::vector<SizeMargin> margins;
  const auto add = [&](const char* name, double demand, double capability, const char* unit) {
    if (given(demand) && given(capability)) margins.push_back({name, demand, capability, unit});
  };
  add("motor torque, continuous", motor_torque, motor.nominal_torque, "N m");
  add("amplifier current, continuous", current, amplifier.continuous_current, "A");
  if (const auto& thermal = drive.thermal()) add("winding heat", current, thermal->continuous_current(), "A");
  if (const auto& capstan = drive.capstan()) {
    const auto& description = std::get<CapstanDescription>(drive.description().transmission);
    const CapstanLoads loads = capstan->loads(description.preload, motor_torque);
    add("cable slip", joint_torque, capstan->slip_torque(description.preload), "N m");
    add("cable tension", loads.high_tension, description.cable.max_working_load, "N");
    add("motor bearing, radial", loads.bearing_radial, motor.max_radial_load, "N");
    add("motor bearing, axial", loads.bearing_axial, motor.max_axial_load, "N");
  }
  return margins;
}

/// Which limit a drive meets first at a joint torque, or nothing.
std::string first_failure(const Drive& drive, double joint_torque) {
  const SizeMargin* worst = nullptr;
  const auto margins = margins_at(drive, joint_torque);
  for (const SizeMargin& margin : margins) {
    if (!margin.ok() && (worst == nullptr || margin.utilisation() > worst->utilisation())) worst = &margin;
  }
  return worst == nullptr ? "" : worst->name;
}

struct Candidate {
  std::string kind;
  std::string name;
  bool used = false;
  bool fits = false;
  double continuous = 0.0;  ///< joint torque that the drive could then hold [N m]
  std::string reason;
};

/// The drive with each part of the catalogue in turn.
std::vector<Candidate> candidates(const Drive& drive, double joint_torque) {
  std::vector<Candidate> list;
  const auto try_part = [&](const char* kind, const PartInfo& info, const std::string& used,
                            const DriveDescription& description) {
    Candidate candidate{kind, info.name, info.name == used, false, 0.0, ""};
    const std::vector<Problem> problems = drive_problems(description, "drive");
    if (problems.empty()) {
      const Drive other(description, drive.joint_range());
      candidate.continuous = other.continuous_torque().usable;
      candidate.reason = first_failure(other, joint_torque);
      // Rules that the present drive breaks are its own affair.
      const auto present = drive.margins();
      for (const Margin& margin : other.margins()) {
        const auto same = std::find_if(present.begin(), present.end(),
                                       [&](const Margin& m) { return m.name == margin.name; });
        const bool broken_already = same != present.end() && !same->ok;
        if (candidate.reason.empty() && !margin.ok && kStanding.contains(margin.name) && !broken_already)
          candidate.reason = margin.name;
      }
      candidate.fits = candidate.reason.empty();
    } else {
      const std::string& rule = problems.front().rule;
      candidate.reason = rule.substr(0, rule.find(':'));  // what follows explains
    }
    list.push_back(candidate);
  };
  for (const Motor& motor : catalogue().all<Motor>()) {
    DriveDescription description = drive.description();
    description.motor = motor;
    try_part("motor", motor.info, drive.description().motor.info.name, description);
  }
  for (const Amplifier& amplifier : catalogue().all<Amplifier>()) {
    DriveDescription description = drive.description();
    description.amplifier = amplifier;
    try_part("amplifier", amplifier.info, drive.description().amplifier.info.name, description);
  }
  if (const auto* capstan = std::get_if<CapstanDescription>(&drive.description().transmission)) {
    for (const Cable& cable : catalogue().all<Cable>()) {
      DriveDescription description = drive.description();
      std::get<CapstanDescription>(description.transmission).cable = cable;
      try_part("cable", cable.info, capstan->cable.info.name, description);
    }
  }
  return list;
}

class Sizing {
 public:
  Sizing(const Model& model, const SizeArguments& arguments, const Terminal& terminal)
      : model_(model), mechanism_(model.mechanism), arguments_(arguments), sheet_(terminal) {}

  int run() {
    std::vector<Posture> postures;
    std::string where = "anywhere in the workspace";
    if (arguments_.position.empty()) {
      postures = raster(mechanism_);
      if (postures.empty()) throw InputError("the legs close nowhere in the joint ranges; see `zwidth check`");
    } else {
      const auto p = parsed("--position", arguments_.position, Dimension::length);
      const Solution solution = solve_inverse(mechanism_, Pose{Vector3(p[0], p[1], p[2]), Matrix3::Identity()});
      if (!solution || solution.status == SolveStatus::joint_limit) {
        complain(fmt::format("{} cannot be reached: {}; see `zwidth at {} --position {}`", arguments_.position,
                             to_string(solution.status), arguments_.device, arguments_.position));
        if (arguments_.json)
          print_json(Json{{"device", model_.description.name}, {"status", to_string(solution.status)}});
        return kNo;
      }
      postures.push_back(*solution.posture);
      where = "at " + arguments_.position;
    }
    std::optional<Vector3> load;
    if (!arguments_.load.empty()) {
      const auto f = parsed("--load", arguments_.load, Dimension::force);
      load = Vector3(f[0], f[1], f[2]);
    }
    ask(postures, load);
    if (!load) guaranteed_force(postures);
    requirements(postures, load);
    return answer(where, load);
  }

 private:
  static std::vector<double> parsed(const char* option, const std::string& text, Dimension dimension) {
    const ParsedQuantities values = parse_quantity_list(text, std::vector<Dimension>(3, dimension));
    if (!values)
      throw InputError(fmt::format("{} \"{}\": {}{}", option, text, values.rule,
                                   values.advice.empty() ? "" : "; " + values.advice));
    return values.values;
  }

  void ask(const std::vector<Posture>& postures, const std::optional<Vector3>& load) {
    const int n = mechanism_.active_count();
    loadings_.resize(postures.size() * static_cast<size_t>(n));
    for (size_t i = 0; i < postures.size(); ++i) {
      const Rates rate_maps = rates(postures[i]);
      const Jacobian J = rate_maps.tool.topRows(3);
      const ActiveVector gravity = gravity_torques(postures[i], rate_maps);
      const ActiveVector fixed = load ? ActiveVector(gravity + torques_for_load(J, *load)) : gravity;
      for (int j = 0; j < n; ++j) {
        loadings_[i * static_cast<size_t>(n) + static_cast<size_t>(j)] = {std::abs(gravity[j]), J.col(j).norm(),
                                                                          std::abs(fixed[j])};
      }
    }
  }

  /// Largest force that can be held in every direction at every posture, on top of gravity.
  void guaranteed_force(const std::vector<Posture>& postures) {
    const int n = mechanism_.active_count();
    const ActiveVector limit = model_.continuous_torque();
    force_ = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < postures.size(); ++i) {
      for (int j = 0; j < n; ++j) {
        const Loading& loading = loadings_[i * static_cast<size_t>(n) + static_cast<size_t>(j)];
        if (loading.per_newton > 0.0)
          force_ = std::min(force_, (limit[j] - loading.gravity) / loading.per_newton);
      }
    }
    force_ = std::max(0.0, force_);
  }

  void requirements(const std::vector<Posture>& postures, const std::optional<Vector3>& load) {
    const int n = mechanism_.active_count();
    required_.assign(static_cast<size_t>(n), {});
    gravity_.assign(static_cast<size_t>(n), {});
    for (size_t i = 0; i < postures.size(); ++i) {
      for (int j = 0; j < n; ++j) {
        const Loading& loading = loadings_[i * static_cast<size_t>(n) + static_cast<size_t>(j)];
        const double torque = load ? loading.fixed : loading.gravity + force_ * loading.per_newton;
        auto& required = required_[static_cast<size_t>(j)];
        if (torque >= required.torque) required = {torque, postures[i].tool().position};
        auto& gravity = gravity_[static_cast<size_t>(j)];
        if (loading.gravity >= gravity.torque) gravity = {loading.gravity, postures[i].tool().position};
      }
    }
  }

  int answer(const std::string& where, const std::optional<Vector3>& load) {
    const std::string force_text =
        load ? fmt::format("the load ({}) N", fmt::format("{:g}, {:g}, {:g}", load->x(), load->y(), load->z()))
             : fmt::format("{} in every direction", quantity(force_, 1.0, "N"));
    Json document;
    document["device"] = model_.description.name;
    document["where"] = arguments_.position.empty() ? "workspace" : "position";
    if (load) {
      document["load"] = json_array(*load);
    } else {
      document["guaranteed_force"] = json_number(force_);
    }
    sheet_.title(fmt::format("{}: sizing of the drives", model_.description.name), where);
    sheet_.paragraph(
        load ? fmt::format("For {} on the hand, {}, on top of the device's own weight.", force_text, where)
             : fmt::format("The drives can hold {} {}, for as long as one likes, on top of the device's own "
                           "weight. Another load: --load FX,FY,FZ.",
                           force_text, where));
    sheet_.heading("Torque");
    Json joints = Json::array();
    std::vector<std::vector<std::string>> rows;
    bool all_good = true;
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      const auto index = static_cast<size_t>(j);
      const Drive& drive = *model_.drives[index];
      const double continuous = drive.continuous_torque().usable;
      const double peak = drive.peak_torque().usable;
      const bool good = required_[index].torque <= continuous * (1.0 + 1e-9);
      all_good = all_good && good;
      Json entry;
      entry["joint"] = mechanism_.active_names()[index];
      entry["required"] = json_number(required_[index].torque);
      entry["required_at"] = json_array(required_[index].at);
      entry["gravity"] = json_number(gravity_[index].torque);
      entry["continuous"] = json_number(continuous);
      entry["peak"] = json_number(peak);
      entry["ok"] = good;
      joints.push_back(entry);
      const Vector3 at = required_[index].at * kMilli;
      rows.push_back({mechanism_.active_names()[index], number(required_[index].torque),
                      number(gravity_[index].torque), number(continuous), number(peak),
                      fmt::format("{} %", number(100.0 * required_[index].torque / continuous, 3)),
                      good ? "✓" : "✗", fmt::format("{:.0f}, {:.0f}, {:.0f}", at.x(), at.y(), at.z())});
    }
    sheet_.table({"joint", "required", "gravity", "continuous", "peak N m", "used", "", "worst at mm"}, rows);
    document["joints"] = joints;
    Json drives = Json::array();
    std::vector<const DriveDescription*> done;
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      const Drive& drive = *model_.drives[static_cast<size_t>(j)];
      // Joints that share a drive's description are answered once, for the one that is asked most.
      const bool seen = std::any_of(done.begin(), done.end(), [&](const DriveDescription* other) {
        return *other == drive.description();
      });
      if (seen) continue;
      done.push_back(&drive.description());
      std::string names;
      double torque = 0.0;
      for (int k = 0; k < mechanism_.active_count(); ++k) {
        if (!(model_.drives[static_cast<size_t>(k)]->description() == drive.description())) continue;
        names += (names.empty() ? "" : ", ") + mechanism_.active_names()[static_cast<size_t>(k)];
        torque = std::max(torque, required_[static_cast<size_t>(k)].torque);
      }
      drives.push_back(of_drive(drive, names, torque, all_good));
    }
    document["drives"] = drives;
    document["ok"] = all_good;
    sheet_.gap();
    sheet_.paragraph(all_good ? "The drives suffice." : "The drives do not suffice.", 2,
                     all_good ? Tint::good : Tint::bad);
    if (arguments_.json) {
      print_json(document);
    } else {
      print(sheet_.text());
    }
    return all_good ? kDone : kNo;
  }

  Json of_drive(const Drive& drive, const std::string& names, double torque, bool& all_good) {
    Json entry;
    entry["joints"] = names;
    entry["torque"] = json_number(torque);
    Json margins = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const SizeMargin& margin : margins_at(drive, torque)) {
      all_good = all_good && margin.ok();
      Json item;
      item["name"] = margin.name;
      item["demand"] = json_number(margin.demand);
      item["capability"] = json_number(margin.capability);
      item["unit"] = margin.unit;
      item["utilisation"] = json_number(margin.utilisation());
      item["ok"] = margin.ok();
      margins.push_back(item);
      const int cells = static_cast<int>(std::lround(std::clamp(margin.utilisation(), 0.0, 1.0) * 12));
      std::string bar;
      for (int i = 0; i < 12; ++i) bar += i < cells ? "█" : "░";
      rows.push_back(
          {margin.name, readable(margin.demand, margin.unit), readable(margin.capability, margin.unit),
           fmt::format("{} %", number(100.0 * margin.utilisation(), 3)), bar, margin.ok() ? "✓" : "✗"});
    }
    entry["margins"] = margins;
    sheet_.heading(fmt::format("Margins of the drive of {} at {}", names, readable(torque, "N m")));
    sheet_.table({"", "demand", "limit", "used", "", ""}, rows);
    Json broken = Json::array();
    for (const Margin& margin : drive.margins()) {
      if (margin.ok || !kStanding.contains(margin.name)) continue;
      broken.push_back(margin.name);
      sheet_.paragraph(
          fmt::format("whatever the load, {}: {} of {}; {}", margin.name, readable(margin.demand, margin.unit),
                      readable(margin.capability, margin.unit), margin.rule),
          2, Tint::warning);
    }
    Json parts = Json::array();
    rows.clear();
    for (const Candidate& candidate : candidates(drive, torque)) {
      Json item;
      item["kind"] = candidate.kind;
      item["name"] = candidate.name;
      item["used"] = candidate.used;
      item["fits"] = candidate.fits;
      item["continuous_torque"] = json_number(candidate.continuous);
      item["reason"] = candidate.reason;
      parts.push_back(item);
      rows.push_back(
          {candidate.kind, candidate.name, candidate.fits ? readable(candidate.continuous, "N m") : "–",
           (candidate.fits ? "✓" : "✗ " + candidate.reason) + std::string(candidate.used ? "  in use" : "")});
    }
    entry["parts"] = parts;
    sheet_.heading("Parts of the catalogue that would do, all else kept");
    sheet_.table({"kind", "part", "would hold", ""}, rows, false);
    return entry;
  }

  const Model& model_;
  const Mechanism& mechanism_;
  const SizeArguments& arguments_;
  Sheet sheet_;
  std::vector<Loading> loadings_;
  std::vector<Requirement> required_;
  std::vector<Requirement> gravity_;
  double force_ = 0.0;
};

int size(const SizeArguments& arguments, const Terminal& terminal) {
  const Model model(read_device(arguments));
  if (!model.driven())
    throw InputError(fmt::format(
        "{}: some joints have no drive, so nothing can be sized; add a [[drive]] to the device file",
        model.description.name));
  return Sizing(model, arguments, terminal).run();
}

}  // namespace

void add_size(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, "size", "Required against available torque, margins of the drives, and parts that would do",
      "  zwidth size delta                                       the force that the drives can always hold\n"
      "  zwidth size delta --load 0,0,10                         10 N upwards, anywhere in the workspace\n"
      "  zwidth size delta --load 0,0,10 --position 0,0,150mm    at one place\n"
      "\nExits 1 if the drives do not suffice.");
  auto arguments = std::make_shared<SizeArguments>();
  add_device_arguments(*verb, *arguments);
  verb->add_option("--load", arguments->load, "force that the device exerts on the hand, device frame")
      ->type_name("FX,FY,FZ");
  verb->add_option("--position", arguments->position,
                   "tool position to look at, instead of the whole workspace")
      ->type_name("X,Y,Z");
  verb->callback([arguments, &context] {
    context.run = [arguments, &context] { return size(*arguments, context.terminal); };
  });
}

}  // namespace zwidth
