#include "size_pneumatic.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>

#include "efforts.h"
#include "size_balance.h"

#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/statics.h"
#include "zwidth/description/names.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/jacobian.h"

/// `zwidth size` for joints that cylinders move: required against available force, over postures and loads.

namespace zwidth {

namespace {

constexpr double kRounding = 1e-9;
constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

/// The hardest that one direction of one cylinder is asked to work.
struct Demand {
  double force = 0.0;      ///< magnitude [N]
  double available = 0.0;  ///< [N]
  std::size_t posture = kNowhere;
  std::size_t load = kNowhere;

  double used() const {
    return available > 0.0 ? force / available : force > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
  }
};

struct JointDemand {
  Demand push, pull;
  double torque = 0.0;   ///< largest magnitude [N m, N]
  double gravity = 0.0;  ///< largest magnitude against the device's own weight [N m, N]
  bool dead_point = false;
};

class PneumaticSizing {
 public:
  PneumaticSizing(const Description& description, const PneumaticSizeRequest& request, const Terminal& terminal)
      : full_(description),
        description_(without_free_joints(description)),
        mechanism_(description_),
        drives_(joint_pneumatic_drives(description_, mechanism_)),
        request_(request),
        sheet_(terminal) {}

  int run() {
    for (int j = 0; j < mechanism_.active_count(); ++j) {
      if (drives_[static_cast<std::size_t>(j)] || mechanism_.is_free(j)) continue;
      throw InputError(
          fmt::format("{}: {} has no cylinder; drives of both kinds, or none, are not sized together",
                      description_.name, mechanism_.active_names()[static_cast<std::size_t>(j)]));
    }
    if (!gather()) return kNo;
    guarantee();
    demands_.assign(drives_.size(), {});
    for (std::size_t l = 0; l < request_.loads.size(); ++l) ask(l);
    if (request_.loads.empty()) ask_every_direction(guaranteed_);
    return answer();
  }

 private:
  /// The posture of all active joints, with the free ones held where they are given.
  Posture posture_of(const std::string& name, const ActiveVector& joints) {
    Description held = full_;
    ActiveVector driven(mechanism_.active_count());
    Eigen::Index next = 0;
    const Mechanism mechanism(full_);
    const bool reduced = mechanism.active_count() != mechanism_.active_count();
    std::vector<double> free;
    for (int j = 0; j < mechanism.active_count(); ++j) {
      if (!reduced || !mechanism.is_free(j)) {
        driven[next++] = joints[j];
      } else {
        free.push_back(joints[j]);
      }
    }
    if (auto* arm = std::get_if<SerialDescription>(&held.mechanism); arm != nullptr && reduced) {
      auto value = free.begin();
      for (SerialJointDescription& row : arm->joints) {
        if (row.free && row.type != SerialJointType::fixed) row.home = *value++;
      }
    }
    held_.push_back(std::make_unique<Mechanism>(without_free_joints(held)));
    const Solution solution = solve_forward(*held_.back(), driven);
    if (!solution)
      throw InputError(fmt::format("posture \"{}\": {}; see `zwidth at {}`", name, to_string(solution.status),
                                   description_.name));
    return *solution.posture;
  }

  /// The postures to look at: those given, or a raster of the joint ranges.
  bool gather() {
    const int n = mechanism_.active_count();
    for (const auto& [name, joints] : request_.postures) {
      postures_.push_back(posture_of(name, joints));
      names_.push_back(name);
    }
    if (request_.position) {
      const Solution solution = solve_inverse(mechanism_, Pose{*request_.position, Matrix3::Identity()});
      if (!solution || solution.status == SolveStatus::joint_limit) {
        complain(fmt::format("{} cannot be reached: {}", point_text(*request_.position),
                             to_string(solution.status)));
        if (request_.json)
          print_json(Json{{"device", description_.name}, {"status", to_string(solution.status)}});
        return false;
      }
      postures_.push_back(*solution.posture);
      names_.push_back(point_text(*request_.position));
    }
    if (!postures_.empty()) return true;
    int per_joint = 2;
    while (per_joint < 25 && std::pow(per_joint + 1, n) <= 16000.0) ++per_joint;
    std::vector<int> index(static_cast<std::size_t>(n), 0);
    for (bool more = true; more;) {
      ActiveVector q(n);
      for (int j = 0; j < n; ++j) {
        const Interval range = mechanism_.active_range(j);
        q[j] = range.min + range.width() * index[static_cast<std::size_t>(j)] / (per_joint - 1);
      }
      if (Solution solution = solve_forward(mechanism_, q)) postures_.push_back(*solution.posture);
      more = false;
      for (int j = 0; j < n && !more; ++j) {
        more = ++index[static_cast<std::size_t>(j)] < per_joint;
        if (!more) index[static_cast<std::size_t>(j)] = 0;
      }
    }
    if (postures_.empty()) throw InputError("the legs close nowhere in the joint ranges; see `zwidth check`");
    return true;
  }

  /// What the tool can push at every posture beside the device's weight, in any direction and along the axes.
  void guarantee() {
    const int rows = mechanism_.linear_rows();
    const std::vector<std::optional<Drive>> no_motors(drives_.size());
    guaranteed_ = std::numeric_limits<double>::infinity();
    axis_.assign(2 * static_cast<std::size_t>(rows), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < postures_.size(); ++i) {
      const Rates rate_maps = rates(postures_[i]);
      const Jacobian J = rate_maps.tool.topRows(rows);
      const ActiveVector gravity = gravity_torques(postures_[i], rate_maps);
      const TorqueRange range = torque_range(no_motors, drives_, postures_[i].active(), false).beside(gravity);
      const ActiveVector both = either_way(range);
      double weakest = std::numeric_limits<double>::infinity();
      for (int j = 0; j < mechanism_.active_count(); ++j) {
        if (J.col(j).norm() > kZeroRow * J.norm() && !mechanism_.is_free(j))
          weakest = std::min(weakest, both[j] / J.col(j).norm());
      }
      if (weakest < guaranteed_) {
        guaranteed_ = weakest;
        weakest_at_ = i;
      }
      for (int r = 0; r < rows; ++r) {
        for (int side = 0; side < 2; ++side) {
          const LoadLimit limit = load_limit(J, range, (side == 0 ? 1.0 : -1.0) * ToolVector::Unit(rows, r));
          double& least = axis_[2 * static_cast<std::size_t>(r) + static_cast<std::size_t>(side)];
          least = std::min(least, limit.value);
        }
      }
    }
    if (!std::isfinite(guaranteed_)) guaranteed_ = 0.0;
  }

  void ask(std::size_t load) {
    for (std::size_t i = 0; i < postures_.size(); ++i) {
      const ActiveVector gravity = gravity_torques(postures_[i]);
      const ActiveVector torque = gravity + load_torques(postures_[i], request_.loads[load]);
      for (int j = 0; j < torque.size(); ++j) demand(i, load, j, torque[j], gravity[j]);
    }
  }

  /// A force of one size in the direction that is worst for each joint.
  void ask_every_direction(double force) {
    for (std::size_t i = 0; i < postures_.size(); ++i) {
      const Rates rate_maps = rates(postures_[i]);
      const ActiveVector gravity = gravity_torques(postures_[i], rate_maps);
      for (int j = 0; j < gravity.size(); ++j) {
        const double span = force * rate_maps.tool.topRows(mechanism_.linear_rows()).col(j).norm();
        demand(i, kNowhere, j, gravity[j] + span, gravity[j]);
        demand(i, kNowhere, j, gravity[j] - span, gravity[j]);
      }
    }
  }

  void demand(std::size_t posture, std::size_t load, int joint, double torque, double gravity) {
    if (mechanism_.is_free(joint)) return;  // the hand's
    JointDemand& asked = demands_[static_cast<std::size_t>(joint)];
    const PneumaticDrive& drive = *drives_[static_cast<std::size_t>(joint)];
    asked.torque = std::max(asked.torque, std::abs(torque));
    asked.gravity = std::max(asked.gravity, std::abs(gravity));
    const double lever = drive.lever(postures_[posture].active()[joint]);
    if (std::abs(lever) < kDeadPointLever) {
      asked.dead_point = true;
      return;
    }
    const double force = torque / lever;
    const Interval range = drive.force_range();
    Demand& side = force >= 0.0 ? asked.push : asked.pull;
    if (std::abs(force) >= side.force) {
      side = {std::abs(force), force >= 0.0 ? range.max : -range.min, posture, load};
    }
  }

  int answer() {
    Json document;
    document["device"] = description_.name;
    const bool workspace = names_.empty(), position = request_.position && names_.size() == 1;
    document["where"] = workspace ? "workspace" : position ? "position" : "postures";
    document["free_joints_at_home"] = request_.postures.empty();
    sheet_.title(fmt::format("{}: cylinders", description_.name),
                 workspace  ? "anywhere in the workspace"
                 : position ? "at one position"
                            : fmt::format("in {} posture{}", names_.size(), names_.size() == 1 ? "" : "s"));
    Json loads = Json::array();
    for (const LoadDescription& load : request_.loads) {
      loads.push_back(
          {{"name", load.name}, {"force", json_array(load.force)}, {"moment", json_array(load.moment)}});
      sheet_.row(request_.loads.size() == 1 ? "load" : load.name, load_text(load));
    }
    if (request_.loads.size() == 1) document["load"] = json_array(request_.loads.front().force);
    document["loads"] = loads;
    document["guaranteed_force"] = json_number(guaranteed_);
    sheet_.row(
        "force in every direction", readable(guaranteed_, "N"),
        fmt::format("beside the weight; least at {}", point_text(postures_[weakest_at_].tool().position)));
    Json axes = Json::array();
    std::vector<std::vector<std::string>> rows;
    const char* const names[] = {"x", "y", "z"};
    for (std::size_t r = 0; r < axis_.size() / 2; ++r) {
      axes.push_back({json_number(-axis_[2 * r + 1]), json_number(axis_[2 * r])});
      rows.push_back({names[r], force_text(axis_[2 * r]), force_text(axis_[2 * r + 1])});
    }
    document["axis_force"] = axes;
    sheet_.heading("Force alone along an axis, at every posture");
    sheet_.table({"", "along", "against"}, rows);

    bool all_good = true;
    Json joints = Json::array();
    rows.clear();
    for (std::size_t j = 0; j < drives_.size(); ++j) {
      if (!drives_[j]) continue;
      const JointDemand& asked = demands_[j];
      const bool good =
          !asked.dead_point && asked.push.used() <= 1.0 + kRounding && asked.pull.used() <= 1.0 + kRounding;
      all_good = all_good && good;
      Json entry;
      entry["joint"] = mechanism_.active_names()[j];
      entry["status"] = asked.dead_point ? "dead_point" : good ? "ok" : "saturated";
      entry["required"] = json_number(asked.torque);
      entry["gravity"] = json_number(asked.gravity);
      entry["push"] = json_of(asked.push);
      entry["pull"] = json_of(asked.pull);
      entry["ok"] = good;
      joints.push_back(entry);
      for (const auto& [name, side] : {std::pair{"push", &asked.push}, std::pair{"pull", &asked.pull}}) {
        if (side->posture == kNowhere) continue;
        std::vector<std::string> row{mechanism_.active_names()[j],
                                     name,
                                     readable(side->force, "N"),
                                     readable(side->available, "N"),
                                     fmt::format("{} %", number(100.0 * side->used(), 3)),
                                     side->used() <= 1.0 + kRounding ? "✓" : "✗ saturated",
                                     place_text(*side)};
        if (request_.loads.size() > 1) row.push_back(request_.loads[side->load].name);
        rows.push_back(row);
      }
      if (asked.dead_point)
        rows.push_back({mechanism_.active_names()[j], "", "no lever", "", "", "✗ dead point", ""});
    }
    document["joints"] = joints;
    sheet_.heading(request_.loads.empty()      ? "Cylinder forces under the force in every direction"
                   : request_.loads.size() > 1 ? "Cylinder forces under the loads"
                                               : "Cylinder forces under the load");
    std::vector<std::string> columns{"joint", "", "required", "available", "used", "", "worst at"};
    if (request_.loads.size() > 1) columns.emplace_back("load");
    for (auto& row : rows) row.resize(columns.size());
    sheet_.table(columns, rows, false);
    document["balance"] = write_balance(description_, mechanism_, postures_, sheet_);
    document["drives"] = drives(all_good);
    document["ok"] = all_good;
    sheet_.gap();
    sheet_.paragraph(all_good ? "The cylinders suffice." : "The cylinders do not suffice.", 2,
                     all_good ? Tint::good : Tint::bad);
    if (request_.json) {
      print_json(document);
    } else {
      print(sheet_.text());
    }
    return all_good ? kDone : kNo;
  }

  static std::string force_text(double force) {
    return std::isfinite(force) ? readable(force, "N") : "unlimited";
  }
  static std::string load_text(const LoadDescription& load) {
    const auto text = [](const Vector3& v, const char* unit) {
      return fmt::format("({}, {}, {}) {}", number(v.x()), number(v.y()), number(v.z()), unit);
    };
    return text(load.force, "N") + (load.moment.isZero(0.0) ? "" : ", " + text(load.moment, "N m"));
  }
  std::string place_text(const Demand& side) const {
    if (!names_.empty() && !request_.postures.empty()) return names_[side.posture];
    const Vector3 at = kMilli * postures_[side.posture].tool().position;
    const auto whole = [](double x) { return std::round(x) + 0.0; };  // no -0
    return fmt::format("{:.0f}, {:.0f}, {:.0f} mm", whole(at.x()), whole(at.y()), whole(at.z()));
  }

  Json json_of(const Demand& side) const {
    Json entry;
    if (side.posture != kNowhere && !names_.empty()) entry["posture"] = names_[side.posture];
    if (side.load != kNowhere) entry["load"] = request_.loads[side.load].name;
    entry["required"] = json_number(side.force);
    entry["available"] = side.posture == kNowhere ? Json(nullptr) : json_number(side.available);
    entry["utilisation"] = json_number(side.used());
    entry["required_at"] =
        side.posture == kNowhere ? Json(nullptr) : json_array(postures_[side.posture].tool().position);
    return entry;
  }

  Json drives(bool& all_good) {
    Json list = Json::array();
    for (std::size_t j = 0; j < drives_.size(); ++j) {
      if (!drives_[j]) continue;
      const PneumaticDrive& drive = *drives_[j];
      Json entry;
      entry["joints"] = mechanism_.active_names()[j];
      entry["cylinder"] = drive.description().cylinder.info.name;
      entry["usable_pressure"] = drive.usable_pressure();
      entry["limited_by"] = to_string(drive.limited_by());
      Json margins = Json::array();
      std::vector<std::vector<std::string>> rows;
      for (const Margin& margin : drive.margins()) {
        all_good = all_good && margin.ok;
        Json item;
        item["name"] = margin.name;
        item["demand"] = json_number(margin.demand);
        item["capability"] = json_number(margin.capability);
        item["unit"] = margin.unit;
        item["utilisation"] = margin.utilisation ? json_number(*margin.utilisation) : Json(nullptr);
        item["ok"] = margin.ok;
        margins.push_back(item);
        rows.push_back({margin.name, readable(margin.demand, margin.unit),
                        readable(margin.capability, margin.unit), margin.ok ? "✓" : "✗"});
      }
      entry["margins"] = margins;
      sheet_.heading(fmt::format("Cylinder of {}: {}", mechanism_.active_names()[j],
                                 drive.description().cylinder.info.title));
      sheet_.row("pressure", readable(drive.usable_pressure(), "Pa"),
                 fmt::format("set by the {}", to_string(drive.limited_by())));
      sheet_.table({"", "demand", "limit", ""}, rows);
      entry["parts"] = parts(j);
      list.push_back(entry);
    }
    return list;
  }

  /// Every cylinder of the catalogue in place of the present one.
  Json parts(std::size_t joint) {
    Json list = Json::array();
    std::vector<std::vector<std::string>> rows;
    const JointDemand& asked = demands_[joint];
    for (const Cylinder& cylinder : catalogue().all<Cylinder>()) {
      PneumaticDriveDescription description = drives_[joint]->description();
      const bool used = description.cylinder.info.name == cylinder.info.name;
      description.cylinder = cylinder;
      std::string reason;
      double available = 0.0;
      if (const auto other = PneumaticDrive::try_make(description, drives_[joint]->joint_range())) {
        const Interval force = other->force_range();
        available = std::min(force.max, -force.min);
        for (const Margin& margin : other->margins()) {
          if (reason.empty() && !margin.ok) reason = margin.name;
        }
        if (reason.empty() && (asked.push.force > force.max * (1.0 + kRounding) ||
                               asked.pull.force > -force.min * (1.0 + kRounding))) {
          reason = "force";
        }
      } else {
        reason = "does not fit the drive";
      }
      list.push_back({{"kind", "cylinder"},
                      {"name", cylinder.info.name},
                      {"used", used},
                      {"fits", reason.empty()},
                      {"force", json_number(available)},
                      {"reason", reason}});
      rows.push_back({cylinder.info.name, readable(available, "N"),
                      (reason.empty() ? "✓" : "✗ " + reason) + std::string(used ? "  in use" : "")});
    }
    sheet_.table({"cylinders of the catalogue", "either way", ""}, rows, false);
    return list;
  }

  const Description& full_;
  Description description_;  // without the joints of the hand, which are at home
  Mechanism mechanism_;
  std::vector<std::optional<PneumaticDrive>> drives_;
  const PneumaticSizeRequest& request_;
  Sheet sheet_;
  std::vector<std::unique_ptr<Mechanism>> held_;  // with free joints elsewhere
  std::vector<Posture> postures_;
  std::vector<std::string> names_;  // of the postures, unless they are a raster
  std::vector<JointDemand> demands_;
  std::vector<double> axis_;  // along and against each axis [N]
  double guaranteed_ = 0.0;
  std::size_t weakest_at_ = 0;
};

}  // namespace

int size_pneumatic(const Description& description, const PneumaticSizeRequest& request,
                   const Terminal& terminal) {
  return PneumaticSizing(description, request, terminal).run();
}

}  // namespace zwidth
