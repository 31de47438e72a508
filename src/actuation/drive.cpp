#include "zwidth/actuation/drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "zwidth/actuation/amplifier.h"
#include "zwidth/actuation/cable.h"
#include "zwidth/actuation/drive_problems.h"
#include "zwidth/actuation/encoder.h"
#include "zwidth/actuation/gearhead.h"
#include "zwidth/actuation/internal/margin.h"
#include "zwidth/math/linear_system.h"

namespace zwidth {

using internal::add_margin;

namespace {

using std::numbers::pi;

const DriveDescription& checked(const DriveDescription& description) {
  const std::vector<Problem> problems = drive_problems(description, "drive");
  if (!problems.empty()) throw InvalidDrive(to_string(problems.front()));
  return description;
}

CurrentLoop make_current_loop(const DriveDescription& description) {
  const CurrentGains gains = gains_from_registers(description.proportional_gain, description.integral_gain,
                                                  gain_scale(description.amplifier));
  const auto loop = CurrentLoop::make(description.motor.resistance, description.motor.inductance, gains);
  if (!loop) throw InvalidDrive("drive: the gains of the current loop must be finite");
  return *loop;
}

}  // namespace

const char* to_string(Limiter limiter) {
  switch (limiter) {
    case Limiter::motor:
      return "motor";
    case Limiter::slip:
      return "slip";
    case Limiter::gearhead:
      return "gearhead";
    case Limiter::amplifier:
      return "amplifier";
    case Limiter::supply:
      return "supply voltage";
    case Limiter::encoder:
      return "encoder";
  }
  return "";
}

Drive::Drive(const DriveDescription& description, const Interval& joint_range)
    : description_(checked(description)),
      joint_range_(joint_range),
      thermal_(thermal_model(description.motor)),
      current_loop_(make_current_loop(description)) {
  if (const auto* capstan = std::get_if<CapstanDescription>(&description.transmission)) {
    capstan_ = solve_capstan(capstan_dimensions(*capstan, joint_range));
    ratio_ = capstan_->ratio;
  } else if (const auto* ratio = std::get_if<RatioDescription>(&description.transmission)) {
    ratio_ = ratio->ratio;
    efficiency_ = ratio->efficiency;
  } else if (const auto* gear = std::get_if<GearheadDescription>(&description.transmission)) {
    ratio_ = reduction(gear->gearhead) * gear->further_ratio;
    efficiency_ = gear->gearhead.max_efficiency * gear->further_efficiency;
  }
  if (description.preloader) preloader_ = Flexure::make(*description.preloader);
  current_per_torque_ = 1.0 / (description.motor.torque_constant * ratio_ * efficiency_);
  angle_per_count_ = zwidth::angular_resolution(counts_per_turn(description.encoder), ratio_);
}

std::optional<Drive> Drive::try_make(const DriveDescription& description, const Interval& joint_range) {
  try {
    return Drive(description, joint_range);
  } catch (const InvalidDrive&) {
    return std::nullopt;
  }
}

const Gearhead* Drive::gearhead() const {
  const auto* gear = std::get_if<GearheadDescription>(&description_.transmission);
  return gear == nullptr ? nullptr : &gear->gearhead;
}

double Drive::further_ratio() const {
  const auto* gear = std::get_if<GearheadDescription>(&description_.transmission);
  return gear == nullptr ? 1.0 : gear->further_ratio;
}

double Drive::after_gearhead() const {
  const auto* gear = std::get_if<GearheadDescription>(&description_.transmission);
  return gear == nullptr ? 1.0 : gear->further_ratio * gear->further_efficiency;
}

TorqueLimit Drive::torque_limit(double motor_torque, double amplifier_current, double gearhead_torque) const {
  const Motor& motor = description_.motor;
  const double voltage = available_voltage(description_.amplifier, description_.supply_voltage);
  TorqueLimit limit;
  limit.motor = motor_torque * ratio_ * efficiency_;
  limit.amplifier = torque_for_current(amplifier_current);
  limit.supply = zwidth::stall_torque(motor.torque_constant, motor.resistance, voltage) * ratio_ * efficiency_;
  limit.usable = limit.motor;
  limit.limited_by = Limiter::motor;
  const auto take = [&limit](double torque, Limiter limiter) {
    if (torque >= limit.usable) return;
    limit.usable = torque;
    limit.limited_by = limiter;
  };
  take(limit.supply, Limiter::supply);
  take(limit.amplifier, Limiter::amplifier);
  if (capstan_) {
    limit.slip = capstan_->slip_torque(std::get<CapstanDescription>(description_.transmission).preload);
    take(*limit.slip, Limiter::slip);
  }
  if (gearhead() != nullptr) {
    limit.gearhead = gearhead_torque * after_gearhead();
    take(*limit.gearhead, Limiter::gearhead);
  }
  return limit;
}

TorqueLimit Drive::continuous_torque() const {
  return torque_limit(description_.motor.nominal_torque, description_.amplifier.continuous_current,
                      gearhead() == nullptr ? 0.0 : gearhead()->continuous_torque);
}

TorqueLimit Drive::peak_torque() const {
  return torque_limit(description_.motor.nominal_torque * description_.peak_factor,
                      description_.amplifier.max_current,
                      gearhead() == nullptr ? 0.0 : gearhead()->intermittent_torque);
}

TorqueLimit Drive::stall_torque() const {
  const Motor& motor = description_.motor;
  const double voltage = available_voltage(description_.amplifier, description_.supply_voltage);
  return torque_limit(zwidth::stall_torque(motor.torque_constant, motor.resistance, voltage),
                      description_.amplifier.max_current,
                      gearhead() == nullptr ? 0.0 : gearhead()->intermittent_torque);
}

SpeedLimit Drive::speed() const {
  const Motor& motor = description_.motor;
  const double voltage = available_voltage(description_.amplifier, description_.supply_voltage);
  SpeedLimit limit;
  limit.unloaded = std::max(0.0, motor_speed(motor, voltage, 0.0)) / ratio_;
  limit.at_continuous_torque = std::max(0.0, motor_speed(motor, voltage, motor.nominal_torque)) / ratio_;
  limit.usable = limit.unloaded;
  limit.limited_by = Limiter::supply;
  const auto take = [&limit](std::optional<double>& speed, double value, Limiter limiter) {
    if (!given(value)) return;
    speed = value;
    if (value >= limit.usable) return;
    limit.usable = value;
    limit.limited_by = limiter;
  };
  take(limit.motor, motor.max_speed / ratio_, Limiter::motor);
  if (gearhead() != nullptr) take(limit.gearhead, gearhead()->max_input_speed / ratio_, Limiter::gearhead);
  if (given(description_.encoder.max_frequency)) {
    take(limit.encoder, encoder_max_speed(description_.encoder) / ratio_, Limiter::encoder);
  }
  return limit;
}

std::optional<double> Drive::torque_resolution() const {
  const double step = description_.amplifier.current_resolution;
  return given(step)
             ? std::optional(zwidth::torque_resolution(description_.motor.torque_constant, step, ratio_))
             : std::nullopt;
}

double Drive::angular_resolution() const {
  return angle_per_count_;
}

double Drive::input_inertia() const {
  return description_.motor.rotor_inertia + description_.encoder.code_wheel_inertia +
         description_.input_inertia + (gearhead() == nullptr ? 0.0 : gearhead()->inertia);
}

double Drive::reflected_inertia() const {
  double at_joint = description_.output ? description_.output->inertia : 0.0;
  if (const auto* ratio = std::get_if<RatioDescription>(&description_.transmission)) at_joint += ratio->inertia;
  return zwidth::reflected_inertia(input_inertia(), at_joint, ratio_);
}

std::optional<double> Drive::perceived_mass() const {
  if (!description_.output || !(description_.output->radius > 0.0)) {
    return std::nullopt;
  }
  return mass_at_radius(reflected_inertia(), description_.output->radius);
}

double Drive::friction_torque() const {
  return torque_for_current(description_.motor.no_load_current);
}

std::optional<double> Drive::backlash() const {
  double angle = kNotGiven;
  if (const auto* ratio = std::get_if<RatioDescription>(&description_.transmission)) angle = ratio->backlash;
  if (gearhead() != nullptr) angle = gearhead()->backlash / further_ratio();
  return given(angle) ? std::optional(angle) : std::nullopt;
}

std::optional<double> Drive::cable_stiffness(double joint_angle) const {
  if (!capstan_) {
    return std::nullopt;
  }
  const auto& capstan = std::get<CapstanDescription>(description_.transmission);
  const auto section =
      rope_section(capstan.cable.bare_diameter, capstan.cable.strands, capstan.cable.wires_per_strand);
  const auto length = capstan_->equivalent_cable_length(joint_angle - capstan.mid_angle);
  if (!section || !length) {
    return std::nullopt;
  }
  return zwidth::cable_stiffness(capstan.cable.elastic_modulus, section->metal_area, *length,
                                 capstan.cable_stiffness_factor);
}

std::optional<double> Drive::joint_stiffness(double joint_angle) const {
  double known = kNotGiven;
  if (const auto* ratio = std::get_if<RatioDescription>(&description_.transmission)) known = ratio->stiffness;
  if (const auto* gear = std::get_if<GearheadDescription>(&description_.transmission)) known = gear->stiffness;
  if (given(known)) return known;
  const auto stiffness = cable_stiffness(joint_angle);
  if (!stiffness) {
    return std::nullopt;
  }
  const double radius = 0.5 * capstan_->output_pitch_diameter;
  return *stiffness * radius * radius;
}

std::optional<TwoMassModel> Drive::two_mass(double joint_angle) const {
  const auto stiffness = cable_stiffness(joint_angle);
  if (!stiffness || !description_.output) {
    return std::nullopt;
  }
  return TwoMassModel::make({.input_inertia = input_inertia(),
                             .input_damping = equivalent_damping(description_.motor),
                             .input_radius = 0.5 * capstan_->input_pitch_diameter,
                             .output_inertia = description_.output->inertia,
                             .output_radius = 0.5 * capstan_->output_pitch_diameter,
                             .tip_radius = description_.output->radius,
                             .contact_stiffness = description_.output->contact_stiffness,
                             .contact_damping = description_.output->contact_damping,
                             .cable_stiffness = *stiffness,
                             .torque_constant = description_.motor.torque_constant});
}

void Drive::add_gearhead_margins(std::vector<Margin>& margins) const {
  const Gearhead& gear = *gearhead();
  const Motor& motor = description_.motor;
  const double output = reduction(gear) * gear.max_efficiency;
  const double peak = motor.nominal_torque * description_.peak_factor;
  add_margin(margins, "gearhead torque, continuous", motor.nominal_torque * output, gear.continuous_torque,
             "N m", "the gearhead must carry the nominal motor torque for ever");
  add_margin(margins, "gearhead torque, short", peak * output, gear.intermittent_torque, "N m",
             "the gearhead must carry the peak motor torque for a short time");
  add_margin(margins, "gearhead speed", speed().unloaded * ratio_, gear.max_input_speed, "rad/s",
             "the gearhead must permit the fastest that the motor can turn at the available voltage, unloaded");
  add_margin(margins, "motor shaft", motor.shaft_diameter, gear.max_motor_shaft, "m",
             "the motor's shaft must fit the gearhead");
}

void Drive::add_capstan_margins(std::vector<Margin>& margins) const {
  const auto& capstan = std::get<CapstanDescription>(description_.transmission);
  const Motor& motor = description_.motor;
  const double peak = motor.nominal_torque * description_.peak_factor;
  const CapstanLoads loads = capstan_->loads(capstan.preload, peak);

  add_margin(margins, "preload at continuous torque", capstan_->min_preload(motor.nominal_torque),
             capstan.preload, "N",
             "the cable must not slip on the input pulley under the nominal motor torque (Neal 2015, eq 4.31)");
  add_margin(margins, "preload at peak torque", capstan_->min_preload(peak), capstan.preload, "N",
             "the cable must not slip on the input pulley under the peak motor torque (Neal 2015, eq 4.31)");
  add_margin(
      margins, "cable tension", loads.high_tension,
      given(capstan.cable.max_working_load) ? capstan.cable.max_working_load : capstan.cable.breaking_load, "N",
      "the tight side under preload and peak torque must stay within the cable's load (Neal 2015, eq 4.27)");
  add_margin(margins, "cable bend radius", capstan.cable.min_bend_radius, 0.5 * capstan_->input_pitch_diameter,
             "m", "the cable must not bend tighter around the input pulley than it may");
  add_margin(margins, "cable seat", capstan_->contact_diameter, capstan.input_diameter, "m",
             "the cable must touch the flanks of the thread, not ride on its crests (Neal 2015, eq 4.18)");
  add_margin(margins, "wrap spacing", capstan.cable.coated_diameter,
             capstan.lead * std::cos(capstan_->cable_angle), "m", "neighbouring wraps must not touch");
  add_margin(margins, "centre distance", capstan_->min_centre_distance, capstan.centre_distance, "m",
             "the pulleys with their cable must not touch");
  add_margin(margins, "sector range", joint_range_.width(), capstan_->dimensions.output_range, "rad",
             "the sector must carry cable for the whole range of the joint");
  add_margin(
      margins, "motor radial load", loads.bearing_radial, motor.max_radial_load, "N",
      "the cable's pull under preload and peak torque must stay within the motor's bearings (Neal 2015, eq "
      "4.42)");
  add_margin(
      margins, "motor axial load", loads.bearing_axial, motor.max_axial_load, "N",
      "the cable's axial pull under peak torque must stay within the motor's bearings (Neal 2015, eq 4.41)");
  if (preloader_) {
    add_margin(margins, "flexure stress", preloader_->bending_stress(capstan.preload),
               description_.preloader->material.yield_strength, "Pa",
               "the preloader must not yield under the preload (Neal 2015, eq 4.63)");
  }
}

std::vector<Margin> Drive::margins() const {
  const Motor& motor = description_.motor;
  const Amplifier& amplifier = description_.amplifier;
  std::vector<Margin> margins;
  add_margin(margins, "continuous current", motor.nominal_current, amplifier.continuous_current, "A",
             "the amplifier must hold the nominal current of the motor's catalogue, which overcomes its own "
             "friction too");
  add_margin(margins, "peak current", motor.nominal_torque * description_.peak_factor / motor.torque_constant,
             amplifier.max_current, "A", "the amplifier must give the peak torque over the torque constant");
  if (thermal_) {
    add_margin(
        margins, "winding heat", motor.nominal_torque / motor.torque_constant, thermal_->continuous_current(),
        "A", "the current of the nominal torque must not overheat the winding in a room of 25 degrees Celsius");
  }
  add_margin(margins, "supply voltage", description_.supply_voltage, amplifier.max_supply_voltage, "V",
             "the supply must not exceed what the amplifier takes");
  add_margin(margins, "least supply voltage", amplifier.min_supply_voltage, description_.supply_voltage, "V",
             "the supply must suffice for the amplifier");
  add_margin(margins, "encoder frequency",
             speed().unloaded * ratio_ / (2.0 * pi) * description_.encoder.pulses_per_turn,
             description_.encoder.max_frequency, "Hz",
             "the encoder must follow the fastest the motor can turn at the available voltage, unloaded");
  add_margin(margins, "motor speed", speed().unloaded * ratio_, motor.max_speed, "rad/s",
             "the motor must permit the fastest that it can turn at the available voltage, unloaded");
  if (gearhead() != nullptr) add_gearhead_margins(margins);
  if (capstan_) {
    add_capstan_margins(margins);
  }
  return margins;
}

std::vector<DriveFigure> Drive::figures(bool slides) const {
  std::vector<DriveFigure> figures;
  const auto put = [&](const char* key, const char* name, std::optional<double> value, const char* unit) {
    if (value && std::isfinite(*value)) {
      figures.push_back({key, name, *value, unit});
    }
  };
  const char* effort = slides ? "N" : "N m";
  put("ratio", "ratio", ratio_, slides ? "rad/m" : "");
  if (efficiency_ < 1.0) put("efficiency", "efficiency", efficiency_, "");
  put("continuous_torque", slides ? "continuous force" : "continuous torque", continuous_torque().usable,
      effort);
  put("peak_torque", slides ? "peak force" : "peak torque", peak_torque().usable, effort);
  put("stall_torque", slides ? "stall force" : "stall torque", stall_torque().usable, effort);
  put("slip_torque", slides ? "force at which the cable slips" : "torque at which the cable slips",
      continuous_torque().slip, effort);
  put("gearhead_torque",
      slides ? "force that the gearhead may carry for ever" : "torque that the gearhead may carry for ever",
      continuous_torque().gearhead, effort);
  put("backlash", "backlash at the joint", backlash(), slides ? "m" : "rad");
  put("friction_torque", "friction of the motor", friction_torque(), effort);
  put("torque_resolution", slides ? "force step" : "torque step", torque_resolution(), effort);
  put("angular_resolution", slides ? "step of the slide" : "angle step", angular_resolution(),
      slides ? "m" : "rad");
  put("max_speed", "largest speed", speed().usable, slides ? "m/s" : "rad/s");
  put("reflected_inertia", slides ? "reflected mass" : "reflected inertia", reflected_inertia(),
      slides ? "kg" : "kg m^2");
  put("perceived_mass", "perceived mass", perceived_mass(), "kg");
  put("equivalent_damping", "damping of the motor", equivalent_damping(description_.motor), "N m s/rad");
  put("mechanical_time_constant", "mechanical time constant", mechanical_time_constant(description_.motor),
      "s");
  put("electrical_time_constant", "electrical time constant", electrical_time_constant(description_.motor),
      "s");
  put("current_loop_bandwidth", "current loop bandwidth (-3 dB)", current_loop_.bandwidth(), "Hz");
  put("current_loop_damping", "current loop damping ratio", current_loop_.damping_ratio(), "");
  put("joint_stiffness", slides ? "stiffness felt at the slide" : "stiffness felt at the joint, angle zero",
      joint_stiffness(0.0), slides ? "N/m" : "N m/rad");
  if (capstan_) {
    const auto& capstan = std::get<CapstanDescription>(description_.transmission);
    put("preload", "cable preload", capstan.preload, "N");
    put("min_preload", "least preload at continuous torque",
        capstan_->min_preload(description_.motor.nominal_torque), "N");
    put("cable_length", "cable length", capstan_->cable_length, "m");
    put("cable_stiffness", "cable stiffness at joint angle zero", cable_stiffness(0.0), "N/m");
    if (preloader_) {
      put("preloader_stiffness", "preloader stiffness", preloader_->stiffness(), "N/m");
      put("preloader_deflection", "preloader deflection under the preload",
          capstan.preload / preloader_->stiffness(), "m");
    }
  }
  if (const auto model = two_mass()) {
    const GainPeak resonance = model->resonance();
    put("force_per_current", "tip force per current", model->dc_gain()[TwoMassModel::tip_force], "N/A");
    if (resonance.is_resonance) {
      put("resonance_frequency", "resonance", resonance.frequency, "Hz");
      put("resonance_peak", "resonance over static", model->resonance_peak(), "dB");
    }
    put("force_bandwidth", "force bandwidth (-3 dB)", model->bandwidth(), "Hz");
  }
  if (thermal_) {
    put("thermal_continuous_current", "current that the winding bears for ever", thermal_->continuous_current(),
        "A");
    const double peak_current =
        description_.motor.nominal_torque * description_.peak_factor / description_.motor.torque_constant;
    put("time_at_peak", "time to overheat at peak torque, from cold", thermal_->time_to_overheat(peak_current),
        "s");
  }
  return figures;
}

}  // namespace zwidth
