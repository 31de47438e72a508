#include "zwidth/analysis/sizing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <set>

#include "zwidth/actuation/amplifier.h"
#include "zwidth/actuation/drive_problems.h"
#include "zwidth/actuation/motor.h"
#include "zwidth/analysis/statics.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;

double utilisation_of(double asked, double available) {
  if (asked == 0.0) return 0.0;
  return available > 0.0 ? asked / available : kInfinity;
}

void ask(JointDemand& demand, double torque, double available, int posture, int load) {
  const double utilisation = utilisation_of(std::abs(torque), available);
  if (demand.posture >= 0 && !(utilisation > demand.utilisation)) return;
  demand = {.torque = torque,
            .available = available,
            .utilisation = utilisation,
            .ok = utilisation <= 1.0 + kRounding,
            .posture = posture,
            .load = load};
}

}  // namespace

Capability capability_of(const std::vector<std::optional<Drive>>& drives) {
  const auto n = static_cast<Eigen::Index>(drives.size());
  ActiveVector continuous = ActiveVector::Zero(n), peak = ActiveVector::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (const auto& drive = drives[static_cast<std::size_t>(j)]) {
      continuous[j] = drive->continuous_torque().usable;
      peak[j] = drive->peak_torque().usable;
    }
  }
  return [continuous, peak](const Posture&, LoadKind kind) {
    return TorqueRange::symmetric(kind == LoadKind::peak ? peak : continuous);
  };
}

Sizing size_drives(std::span<const SizingPosture> postures, std::span<const LoadDescription> loads,
                   const Capability& capability, const SizingOptions& options) {
  assert(!postures.empty() && !loads.empty());
  const int n = postures[0].posture.mechanism().active_count();
  Sizing sizing;
  sizing.continuous.resize(static_cast<std::size_t>(n));
  sizing.peak.resize(static_cast<std::size_t>(n));
  for (std::size_t p = 0; p < postures.size(); ++p) {
    const Posture& posture = postures[p].posture;
    const ActiveVector gravity =
        options.gravity ? gravity_torques(posture) : ActiveVector(ActiveVector::Zero(n));
    const TorqueRange ranges[] = {capability(posture, LoadKind::continuous),
                                  capability(posture, LoadKind::peak)};
    for (std::size_t l = 0; l < loads.size(); ++l) {
      const ActiveVector load = load_torques(posture, loads[l]);
      SizingCase one{static_cast<int>(p), static_cast<int>(l), load + gravity, gravity};
      const bool peak = loads[l].kind == LoadKind::peak;
      const TorqueRange& range = ranges[peak ? 1 : 0];
      for (int j = 0; j < n; ++j) {
        double torque = one.torque[j];
        if (posture.mechanism().is_free(j)) {
          // The hand bears the weight on a joint that it moves; the load must not need it.
          torque = std::abs(load[j]) <= kRounding * load.norm() ? 0.0 : load[j];
        }
        const double available = std::max(0.0, torque >= 0.0 ? range.max[j] : -range.min[j]);
        auto& demands = peak ? sizing.peak : sizing.continuous;
        ask(demands[static_cast<std::size_t>(j)], torque, available, one.posture, one.load);
      }
      sizing.cases.push_back(std::move(one));
    }
  }
  for (const auto* demands : {&sizing.continuous, &sizing.peak}) {
    for (const JointDemand& demand : *demands) sizing.ok = sizing.ok && demand.ok;
  }
  return sizing;
}

std::vector<Margin> load_margins(const Drive& drive, double joint_torque, LoadKind kind) {
  const DriveDescription& description = drive.description();
  const Motor& motor = description.motor;
  const Amplifier& amplifier = description.amplifier;
  const bool peak = kind == LoadKind::peak;
  const double torque = std::abs(joint_torque);
  const double motor_torque = drive.motor_torque(torque);
  const double current = drive.current_for_torque(torque);
  std::vector<Margin> margins;
  const auto add = [&](const char* name, double demand, double capability, const char* unit, const char* rule) {
    if (!given(demand) || !given(capability)) return;
    Margin margin{name, demand, capability, unit, std::nullopt, demand <= capability * (1.0 + kRounding), rule};
    if (capability > 0.0) margin.utilisation = demand / capability;
    margins.push_back(std::move(margin));
  };
  if (peak) {
    const double voltage = available_voltage(amplifier, description.supply_voltage);
    add("motor torque, peak", motor_torque, motor.nominal_torque * description.peak_factor, "N m",
        "the nominal torque times the peak factor");
    add("motor torque, standstill", motor_torque,
        stall_torque(motor.torque_constant, motor.resistance, voltage), "N m",
        "what the available voltage gives at standstill");
    add("amplifier current, peak", current, amplifier.max_current, "A", "the amplifier's largest current");
  } else {
    add("motor torque, continuous", motor_torque, motor.nominal_torque, "N m", "the motor's nominal torque");
    add("amplifier current, continuous", current, amplifier.continuous_current, "A",
        "the amplifier's continuous current");
    if (const auto& thermal = drive.thermal())
      add("winding heat", current, thermal->continuous_current(), "A",
          "the current that the winding bears for ever in a room of 25 degrees Celsius");
  }
  if (const auto* gear = std::get_if<GearheadDescription>(&description.transmission)) {
    const double output = torque / (gear->further_ratio * gear->further_efficiency);
    add(peak ? "gearhead torque, short" : "gearhead torque, continuous", output,
        peak ? gear->gearhead.intermittent_torque : gear->gearhead.continuous_torque, "N m",
        "what the gearhead's output may carry");
  }
  if (const auto& capstan = drive.capstan()) {
    const auto& cable_drive = std::get<CapstanDescription>(description.transmission);
    const CapstanLoads loads = capstan->loads(cable_drive.preload, motor_torque);
    add("cable slip", torque, capstan->slip_torque(cable_drive.preload), "N m",
        "the preload must keep the cable from slipping");
    add("cable tension", loads.high_tension, cable_drive.cable.max_working_load, "N",
        "the cable's working load");
    add("motor bearing, radial", loads.bearing_radial, motor.max_radial_load, "N", "the motor's bearings");
    add("motor bearing, axial", loads.bearing_axial, motor.max_axial_load, "N", "the motor's bearings");
  }
  return margins;
}

namespace {

// Rules of a drive that do not depend on how hard it is driven.
bool is_standing_rule(const std::string& name) {
  static const std::set<std::string> kStanding = {"supply voltage", "least supply voltage", "encoder frequency",
                                                  "wrap spacing",   "cable bend radius",    "sector range",
                                                  "motor speed",    "gearhead speed",       "motor shaft"};
  return kStanding.contains(name);
}

DriveCandidate judged(DriveCandidate candidate, const Drive& present, const DriveDescription& description,
                      const DriveDemand& demand) {
  const std::vector<Problem> problems = drive_problems(description, "drive");
  if (!problems.empty()) {
    const std::string& rule = problems.front().rule;
    candidate.utilisation = kInfinity;
    candidate.reason = rule.substr(0, rule.find(':'));  // what follows explains
    return candidate;
  }
  const Drive other(description, present.joint_range());
  candidate.continuous = other.continuous_torque().usable;
  candidate.peak = other.peak_torque().usable;
  candidate.reflected_inertia = other.reflected_inertia();
  for (const LoadKind kind : {LoadKind::continuous, LoadKind::peak}) {
    const double torque = kind == LoadKind::peak ? demand.peak : demand.continuous;
    if (torque == 0.0) continue;
    for (const Margin& margin : load_margins(other, torque, kind)) {
      const double utilisation = margin.utilisation.value_or(margin.demand > 0.0 ? kInfinity : 0.0);
      if (utilisation <= candidate.utilisation) continue;
      candidate.utilisation = utilisation;
      if (!margin.ok) candidate.reason = margin.name;
    }
  }
  // Rules that the present drive breaks as well are its own affair.
  const std::vector<Margin> before = standing_failures(present);
  for (const Margin& margin : standing_failures(other)) {
    const bool broken_already =
        std::any_of(before.begin(), before.end(), [&](const Margin& m) { return m.name == margin.name; });
    if (candidate.reason.empty() && !broken_already) candidate.reason = margin.name;
  }
  candidate.fits = candidate.reason.empty();
  return candidate;
}

void rank(std::vector<DriveCandidate>& list, std::size_t from) {
  std::stable_sort(list.begin() + static_cast<std::ptrdiff_t>(from), list.end(),
                   [](const DriveCandidate& a, const DriveCandidate& b) {
                     if (a.fits != b.fits) return a.fits;
                     return a.fits ? a.reflected_inertia < b.reflected_inertia : a.utilisation < b.utilisation;
                   });
}

}  // namespace

std::vector<Margin> standing_failures(const Drive& drive) {
  std::vector<Margin> failures;
  for (const Margin& margin : drive.margins()) {
    if (!margin.ok && is_standing_rule(margin.name)) failures.push_back(margin);
  }
  return failures;
}

std::vector<DriveCandidate> drive_candidates(const Drive& drive, const Catalogue& catalogue,
                                             const DriveDemand& demand) {
  const DriveDescription& present = drive.description();
  std::vector<DriveCandidate> list;
  std::size_t from = 0;
  const auto end_kind = [&] {
    rank(list, from);
    from = list.size();
  };
  const auto consider = [&](const char* kind, const std::string& name, bool used,
                            const DriveDescription& description) {
    list.push_back(judged({.kind = kind, .name = name, .used = used}, drive, description, demand));
  };

  for (const Motor& motor : catalogue.all<Motor>()) {
    DriveDescription description = present;
    description.motor = motor;
    consider("motor", motor.info.name, motor.info.name == present.motor.info.name, description);
  }
  end_kind();
  if (const auto* gear = std::get_if<GearheadDescription>(&present.transmission)) {
    const std::string used = gear->gearhead.info.name;
    for (const Gearhead& gearhead : catalogue.all<Gearhead>()) {
      DriveDescription description = present;
      std::get<GearheadDescription>(description.transmission).gearhead = gearhead;
      consider("gearhead", gearhead.info.name, gearhead.info.name == used, description);
    }
    end_kind();
    for (const Motor& motor : catalogue.all<Motor>()) {
      for (const Gearhead& gearhead : catalogue.all<Gearhead>()) {
        if (motor.info.name == present.motor.info.name || gearhead.info.name == used) continue;
        DriveDescription description = present;
        description.motor = motor;
        std::get<GearheadDescription>(description.transmission).gearhead = gearhead;
        consider("motor and gearhead", motor.info.name + " + " + gearhead.info.name, false, description);
      }
    }
    end_kind();
  }
  for (const Amplifier& amplifier : catalogue.all<Amplifier>()) {
    DriveDescription description = present;
    description.amplifier = amplifier;
    consider("amplifier", amplifier.info.name, amplifier.info.name == present.amplifier.info.name, description);
  }
  end_kind();
  if (const auto* capstan = std::get_if<CapstanDescription>(&present.transmission)) {
    for (const Cable& cable : catalogue.all<Cable>()) {
      DriveDescription description = present;
      std::get<CapstanDescription>(description.transmission).cable = cable;
      consider("cable", cable.info.name, cable.info.name == capstan->cable.info.name, description);
    }
    end_kind();
  }
  return list;
}

std::optional<double> least_ratio(const Drive& drive, const DriveDemand& demand) {
  if (std::holds_alternative<DirectDriveDescription>(drive.description().transmission)) return std::nullopt;
  const double scale = drive.ratio() * drive.efficiency();
  const TorqueLimit continuous = drive.continuous_torque(), peak = drive.peak_torque();
  // Motor, amplifier and supply at the motor shaft.
  const double for_ever = std::min(continuous.motor, continuous.amplifier) / scale;
  const double for_short = std::min({peak.motor, peak.amplifier, peak.supply}) / scale;
  return std::max(demand.continuous / for_ever, demand.peak / for_short) / drive.efficiency();
}

}  // namespace zwidth
