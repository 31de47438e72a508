#include <algorithm>

#include "zwidth/design/internal/figure_table.h"
#include "zwidth/math/linear_system.h"

namespace zwidth::internal {
namespace {

enum class Worst { smallest, largest };

double worse(double a, double b, Worst which) {
  if (std::isnan(a)) return b;
  if (std::isnan(b)) return a;
  return which == Worst::smallest ? std::min(a, b) : std::max(a, b);
}

// Of one joint's drive, or the worst of all; `electric` and `pneumatic` give NaN where there is none.
template <class Electric, class Pneumatic>
double of_drives(const BuiltDevice& device, const FigureOptions& options, Worst which, Electric electric,
                 Pneumatic pneumatic) {
  const int only = index_of(options, "joint", kAll);
  double worst = kUndefined;
  for (int i = 0; i < static_cast<int>(device.drives().size()); ++i) {
    if (only >= 0 && i != only) continue;
    const auto j = static_cast<std::size_t>(i);
    if (const auto& drive = device.drives()[j]) worst = worse(worst, electric(*drive), which);
    if (const auto& drive = device.pneumatic_drives()[j]) worst = worse(worst, pneumatic(*drive), which);
  }
  return finite_or_undefined(worst);
}

constexpr auto kNoElectric = [](const Drive&) { return kUndefined; };
constexpr auto kNoCylinder = [](const PneumaticDrive&) { return kUndefined; };

// What holds a limit, in the order of the option `element`.
FigureOption torque_element() {
  return {"element", 0, Dimension::number,
          "0 what is usable; what each would allow: 1 motor, 2 slip of the cable, 3 gearhead, 4 amplifier, 5 "
          "supply"};
}
double element(const TorqueLimit& limit, const FigureOptions& options) {
  switch (index_of(options, "element")) {
    case 0:
      return limit.usable;
    case 1:
      return limit.motor;
    case 2:
      return limit.slip.value_or(kUndefined);
    case 3:
      return limit.gearhead.value_or(kUndefined);
    case 4:
      return limit.amplifier;
    case 5:
      return limit.supply;
    default:
      return kUndefined;
  }
}
double element(const SpeedLimit& limit, const FigureOptions& options) {
  switch (index_of(options, "element")) {
    case 0:
      return limit.usable;
    case 1:
      return limit.unloaded;
    case 2:
      return limit.at_continuous_torque;
    case 3:
      return limit.motor.value_or(kUndefined);
    case 4:
      return limit.gearhead.value_or(kUndefined);
    case 5:
      return limit.encoder.value_or(kUndefined);
    default:
      return kUndefined;
  }
}

// A margin of one drive, or the worst of all of them.
double margin_figure(const BuiltDevice& device, const FigureOptions& options, Worst which,
                     const std::function<double(const Margin&)>& of) {
  const int only = index_of(options, "margin", kAll);
  const auto worst_of = [&](const std::vector<Margin>& margins) {
    double worst = kUndefined;
    for (std::size_t m = 0; m < margins.size(); ++m) {
      if (only < 0 || static_cast<int>(m) == only) worst = worse(worst, of(margins[m]), which);
    }
    return worst;
  };
  return of_drives(
      device, options, which, [&](const Drive& drive) { return worst_of(drive.margins()); },
      [&](const PneumaticDrive& drive) { return worst_of(drive.margins()); });
}
FigureOption margin_option() {
  return {"margin", kAll, Dimension::number,
          "which rule of the drive, from 0, as `report` has them; -1: the worst of all"};
}

// One that is asked for seldom: of all that the drive says of itself.
double printed(const std::vector<DriveFigure>& figures, const std::string& key) {
  for (const DriveFigure& figure : figures) {
    if (figure.key == key) return figure.value;
  }
  return kUndefined;
}

}  // namespace

FigureTable drive_figures() {
  FigureTable list;
  const auto add = [&](FigureDefinition figure) {
    figure.topic = "Drives";
    figure.of_posture = false;
    figure.needs_drives = true;
    list.push_back(std::move(figure));
  };
  const auto report = [](const std::string& key) { return "report drives[joint].figures." + key + ".value"; };
  const auto torque = [&](const std::string& name, const std::string& meaning, const std::string& key,
                          TorqueLimit (Drive::*of)() const) {
    std::vector<FigureAnswer> answers = {{report(name), {{"element", 0}}}};
    const char* elements[] = {"usable", "motor", "slip", "gearhead", "amplifier", "supply"};
    for (int e = 0; e < 6; ++e) {
      answers.push_back(
          {"report drives[joint].torque." + key + "." + elements[e], {{"element", static_cast<double>(e)}}});
    }
    add({.name = name,
         .unit = "N m",
         .meaning = meaning,
         .options = {any_joint_option("the weakest"), torque_element()},
         .answers = answers,
         .of_device = [of](const BuiltDevice& device, const FigureOptions& options) {
           return of_drives(
               device, options, Worst::smallest,
               [&](const Drive& drive) { return element((drive.*of)(), options); }, kNoCylinder);
         }});
  };
  torque("continuous_torque", "joint torque for ever, or force of a slide", "continuous",
         &Drive::continuous_torque);
  torque("peak_torque", "joint torque for a short time", "peak", &Drive::peak_torque);
  torque("stall_torque", "joint torque at standstill and the available voltage", "stall", &Drive::stall_torque);
  std::vector<FigureAnswer> speeds = {{report("max_speed"), {{"element", 0}}}};
  const char* speed_elements[] = {"usable", "unloaded", "at_continuous_torque", "motor", "gearhead", "encoder"};
  for (int e = 0; e < 6; ++e) {
    speeds.push_back({"report drives[joint].speed." + std::string(speed_elements[e]),
                      {{"element", static_cast<double>(e)}}});
  }
  add({.name = "joint_speed",
       .unit = "rad/s",
       .meaning = "fastest speed of a joint",
       .options = {any_joint_option("the slowest"),
                   {"element", 0, Dimension::number,
                    "0 what is usable; what each would allow: 1 supply, 2 supply under the continuous torque, "
                    "3 motor, 4 "
                    "gearhead, 5 encoder"}},
       .answers = speeds,
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         return of_drives(
             device, options, Worst::smallest,
             [&](const Drive& drive) { return element(drive.speed(), options); }, kNoCylinder);
       }});
  const auto direct = [&](const std::string& name, const std::string& key, const std::string& unit,
                          const std::string& meaning, Worst which, auto electric, auto cylinder) {
    add({.name = name,
         .unit = unit,
         .meaning = meaning,
         .options = {any_joint_option(which == Worst::smallest ? "the smallest" : "the largest")},
         .answers = {{report(key)}},
         .of_device = [=](const BuiltDevice& device, const FigureOptions& options) {
           return of_drives(device, options, which, electric, cylinder);
         }});
  };
  direct(
      "slip_torque", "slip_torque", "N m", "joint torque at which a cable slips", Worst::smallest,
      [](const Drive& drive) { return drive.continuous_torque().slip.value_or(kUndefined); }, kNoCylinder);
  direct(
      "reflected_inertia", "reflected_inertia", "kg m^2",
      "inertia of a drive felt at its joint, or mass at a slide", Worst::largest,
      [](const Drive& drive) { return drive.reflected_inertia(); },
      [](const PneumaticDrive& drive) { return drive.reflected_inertia(drive.joint_range().middle()); });
  direct(
      "perceived_mass", "perceived_mass", "kg", "mass of a drive felt at its output's radius", Worst::largest,
      [](const Drive& drive) { return drive.perceived_mass().value_or(kUndefined); }, kNoCylinder);
  direct(
      "friction_torque", "friction_torque", "N m", "friction of a motor felt at its joint", Worst::largest,
      [](const Drive& drive) { return drive.friction_torque(); }, kNoCylinder);
  direct(
      "backlash", "backlash", "rad", "backlash at the joint", Worst::largest,
      [](const Drive& drive) { return drive.backlash().value_or(kUndefined); }, kNoCylinder);
  direct(
      "torque_resolution", "torque_resolution", "N m", "joint torque of one current step", Worst::largest,
      [](const Drive& drive) { return drive.torque_resolution().value_or(kUndefined); }, kNoCylinder);
  direct(
      "angular_resolution", "angular_resolution", "rad", "joint angle of one step of the sensor",
      Worst::largest, [](const Drive& drive) { return drive.angular_resolution(); },
      [](const PneumaticDrive& drive) { return drive.angular_resolution().value_or(kUndefined); });
  direct(
      "ratio", "ratio", "1", "turns of the motor per turn of the joint", Worst::largest,
      [](const Drive& drive) { return drive.ratio(); }, kNoCylinder);
  direct(
      "efficiency", "efficiency", "1", "share of the motor's torque that reaches the joint", Worst::smallest,
      [](const Drive& drive) { return drive.efficiency(); }, kNoCylinder);
  direct(
      "joint_stiffness", "joint_stiffness", "N m/rad",
      "stiffness of the transmission felt at the joint, angle zero", Worst::smallest,
      [](const Drive& drive) { return drive.joint_stiffness(0.0).value_or(kUndefined); }, kNoCylinder);

  struct Named {
    const char* key;
    const char* unit;
    const char* meaning;
    Worst worst;
    bool cylinder;
  };
  constexpr Named kNamed[] = {
      {"gearhead_torque", "N m", "joint torque that the gearhead may carry for ever", Worst::smallest, false},
      {"equivalent_damping", "N m s/rad", "damping of the motor", Worst::largest, false},
      {"mechanical_time_constant", "s", "mechanical time constant of the motor", Worst::largest, false},
      {"electrical_time_constant", "s", "electrical time constant of the motor", Worst::largest, false},
      {"current_loop_bandwidth", "Hz", "bandwidth of the current loop (-3 dB)", Worst::smallest, false},
      {"current_loop_damping", "1", "damping ratio of the current loop", Worst::smallest, false},
      {"preload", "N", "preload of the cable", Worst::largest, false},
      {"min_preload", "N", "least preload of the cable at the continuous torque", Worst::largest, false},
      {"cable_length", "m", "length of the cable", Worst::largest, false},
      {"cable_stiffness", "N/m", "stiffness of the cable at joint angle zero", Worst::smallest, false},
      {"preloader_stiffness", "N/m", "stiffness of the preloader", Worst::smallest, false},
      {"preloader_deflection", "m", "deflection of the preloader under the preload", Worst::largest, false},
      {"force_per_current", "N/A", "tip force per current", Worst::smallest, false},
      {"resonance_frequency", "Hz", "resonance of motor, cable and output", Worst::smallest, false},
      {"resonance_peak", "dB", "height of that resonance over the static gain", Worst::largest, false},
      {"force_bandwidth", "Hz", "bandwidth of the force (-3 dB)", Worst::smallest, false},
      {"thermal_continuous_current", "A", "current that the winding bears for ever", Worst::smallest, false},
      {"time_at_peak", "s", "time to overheat at peak torque, from cold", Worst::smallest, false},
      {"usable_pressure", "Pa", "highest pressure of a cylinder's chamber", Worst::smallest, true},
      {"push_force", "N", "push of a cylinder at that pressure", Worst::smallest, true},
      {"pull_force", "N", "pull of a cylinder at that pressure", Worst::smallest, true},
      {"lever", "m", "lever of a cylinder in the middle of its joint's range", Worst::smallest, true},
      {"guaranteed_torque_up", "N m", "torque of a cylinder at every angle, the positive way", Worst::smallest,
       true},
      {"guaranteed_torque_down", "N m", "the same the negative way, below zero", Worst::largest, true},
      {"greatest_torque_up", "N m", "torque of a cylinder at its best angle, the positive way", Worst::smallest,
       true},
      {"greatest_torque_down", "N m", "the same the negative way, below zero", Worst::largest, true},
      {"shortest_length", "m", "from pin to pin, at the end of the range where the cylinder is shorter",
       Worst::smallest, true},
      {"greatest_length", "m", "from pin to pin, at the other end", Worst::largest, true},
      {"breakaway", "N m", "friction of a cylinder felt at its joint, from rest", Worst::largest, true},
      {"torque_error", "N m", "error of the torque from the regulators' linearity", Worst::largest, true},
      {"angular_error", "rad", "error of the angle from the potentiometer's linearity", Worst::largest, true},
  };
  for (const Named& one : kNamed) {
    const std::string key = one.key;
    const Worst which = one.worst;
    if (one.cylinder) {
      direct(key, key, one.unit, one.meaning, which, kNoElectric,
             [key](const PneumaticDrive& drive) { return printed(drive.figures(), key); });
    } else {
      direct(
          key, key, one.unit, one.meaning, which,
          [key](const Drive& drive) { return printed(drive.figures(), key); }, kNoCylinder);
    }
  }
  add({.name = "step_overshoot",
       .unit = "1",
       .meaning = "overshoot of the tip force after a step of the current, at joint angle zero",
       .options = {any_joint_option("the largest")},
       .answers = {{"report drives[joint].actuator.step.overshoot"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         return of_drives(
             device, options, Worst::largest,
             [](const Drive& drive) {
               const std::optional<TwoMassModel> model = drive.two_mass();
               if (!model) return kUndefined;
               constexpr int kSamples = 501;  // of 50 ms, as the data sheet has them
               const double target = model->dc_gain()[TwoMassModel::tip_force];
               const std::vector<double> force = model->step_force(1.0, 0.05 / (kSamples - 1), kSamples);
               return target != 0.0 ? step_metrics(force, target).overshoot : kUndefined;
             },
             kNoCylinder);
       }});
  add({.name = "margin_utilisation",
       .unit = "1",
       .meaning = "demand over capability of the rules that drives must keep: 1 is the limit",
       .options = {any_joint_option("the worst"), margin_option()},
       .answers = {{"report drives[joint].margins[margin].utilisation"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         return margin_figure(device, options, Worst::largest, [](const Margin& margin) {
           return margin.utilisation.value_or(margin.demand > 0.0 ? HUGE_VAL : 0.0);
         });
       }});
  add({.name = "margin_demand",
       .unit = "SI",
       .meaning = "what a rule of a drive demands",
       .options = {{"joint", 0, Dimension::number, "which active joint, from 0"},
                   {"margin", 0, Dimension::number, "which rule of the drive, from 0, as `report` has them"}},
       .answers = {{"report drives[joint].margins[margin].demand"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         FigureOptions one = options;
         one.further.try_emplace("joint", 0.0);
         one.further.try_emplace("margin", 0.0);
         return margin_figure(device, one, Worst::largest, [](const Margin& margin) { return margin.demand; });
       }});
  add({.name = "margin_capability",
       .unit = "SI",
       .meaning = "what is there for it",
       .options = {{"joint", 0, Dimension::number, "which active joint, from 0"},
                   {"margin", 0, Dimension::number, "which rule of the drive, from 0, as `report` has them"}},
       .answers = {{"report drives[joint].margins[margin].capability"}},
       .of_device = [](const BuiltDevice& device, const FigureOptions& options) {
         FigureOptions one = options;
         one.further.try_emplace("joint", 0.0);
         one.further.try_emplace("margin", 0.0);
         return margin_figure(device, one, Worst::smallest,
                              [](const Margin& margin) { return margin.capability; });
       }});
  return list;
}

}  // namespace zwidth::internal
