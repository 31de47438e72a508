#include "zwidth/actuation/drive_problems.h"

#include <cmath>
#include <optional>

#include "zwidth/actuation/amplifier.h"
#include "zwidth/actuation/capstan.h"
#include "zwidth/actuation/current_loop.h"
#include "zwidth/description/units.h"

namespace zwidth {
namespace {

constexpr double kSteps = 1e6;  // per metre: the finest length in a message is a micrometre

std::string length(double metres) {
  return format_quantity(std::round(metres * kSteps) / kSteps, Dimension::length);
}

/// Where on the way of one dimension from its value to `to` the cable begins to sit in its groove, on that side
/// of the limit; empty where it does not. Its contact with the groove moves one way only.
std::optional<double> seated(CapstanDimensions dimensions, double CapstanDimensions::*member, double to) {
  double from = dimensions.*member;
  while (std::abs(to - from) > 0.1 / kSteps) {
    const double middle = dimensions.*member = 0.5 * (from + to);
    (solve_capstan(dimensions).status == CapstanStatus::not_seated ? from : to) = middle;
  }
  const double rounded = (to < from ? std::floor(to * kSteps) : std::ceil(to * kSteps)) / kSteps;
  dimensions.*member = rounded;
  return solve_capstan(dimensions).status == CapstanStatus::ok ? std::optional(rounded) : std::nullopt;
}

std::string seating_advice(const CapstanDimensions& dimensions) {
  std::string advice;
  if (const auto cable = seated(dimensions, &CapstanDimensions::cable_diameter, 0.0))
    advice = "take a cable of at most " + length(*cable);
  if (const auto lead = seated(dimensions, &CapstanDimensions::lead, 2.0 * dimensions.cable_diameter)) {
    advice += advice.empty() ? "take" : ", or";
    advice += " a lead of at least " + length(*lead);
  }
  return advice.empty() ? "take a thinner cable and a larger input_diameter" : advice;
}

class Finder {
 public:
  Finder(const DriveDescription& drive, std::string path) : drive_(drive), path_(std::move(path)) {}

  std::vector<Problem> run() {
    numbers();
    if (problems_.empty()) {
      std::visit([this](const auto& transmission) { check(transmission); }, drive_.transmission);
    }
    return std::move(problems_);
  }

 private:
  void wrong(const std::string& key, std::string value, std::string rule, std::string advice) {
    problems_.push_back({.key = path_ + "." + key,
                         .value = std::move(value),
                         .rule = std::move(rule),
                         .advice = std::move(advice)});
  }

  // Descriptions made in code may break what `validate` would have told.
  void positive(const std::string& key, double value, const char* what) {
    if (value > 0.0 && std::isfinite(value)) return;
    wrong(key, std::to_string(value), "must be positive and finite", std::string("give the ") + what);
  }

  void share(const std::string& key, double value, const char* what) {
    const std::size_t before = problems_.size();
    positive(key, value, what);
    if (problems_.size() == before && value > 1.0)
      wrong(key, std::to_string(value), "must be at most 1", std::string("give the ") + what);
  }

  void numbers() {
    positive("motor.resistance", drive_.motor.resistance, "motor's resistance");
    positive("motor.inductance", drive_.motor.inductance, "motor's inductance");
    positive("motor.torque_constant", drive_.motor.torque_constant, "motor's torque constant");
    positive("motor.nominal_torque", drive_.motor.nominal_torque, "motor's nominal torque");
    positive("motor.speed_constant", drive_.motor.speed_constant, "motor's speed constant");
    positive("encoder.pulses_per_turn", drive_.encoder.pulses_per_turn, "encoder's pulses per turn");
    positive("amplifier.proportional_gain_scale", drive_.amplifier.proportional_gain_scale,
             "amplifier's proportional gain scale");
    positive("amplifier.integral_gain_scale", drive_.amplifier.integral_gain_scale,
             "amplifier's integral gain scale");
    positive("supply_voltage", drive_.supply_voltage, "supply voltage");
    positive("peak_factor", drive_.peak_factor, "peak factor");
    if (problems_.empty()) gains();
    if (drive_.preloader) {
      const FlexureDescription& flexure = *drive_.preloader;
      positive("preloader.flexible_length", flexure.flexible_length, "flexible length");
      positive("preloader.rigid_length", flexure.rigid_length, "rigid length");
      positive("preloader.width", flexure.width, "width");
      positive("preloader.height", flexure.height, "height");
      positive("preloader.material.elastic_modulus", flexure.material.elastic_modulus, "elastic modulus");
    }
  }

  void gains() {
    const CurrentGains gains =
        gains_from_registers(drive_.proportional_gain, drive_.integral_gain, gain_scale(drive_.amplifier));
    const auto check_gain = [this](const char* key, double given, double in_units) {
      if (!std::isfinite(in_units))
        wrong(key, std::isfinite(given) ? format_quantity(given, Dimension::number) : "",
              "is beyond any current loop's gain", "give what stands in the amplifier's register");
    };
    check_gain("proportional_gain", drive_.proportional_gain, gains.proportional);
    check_gain("integral_gain", drive_.integral_gain, gains.integral);
  }

  void check(const DirectDriveDescription& /*direct*/) {}

  void check(const RatioDescription& ratio) {
    positive("transmission.ratio", ratio.ratio, "transmission's ratio");
    share("transmission.efficiency", ratio.efficiency, "transmission's efficiency");
  }

  void check(const GearheadDescription& gear) {
    const std::string key = "transmission.gearhead.";
    positive(key + "reduction_numerator", gear.gearhead.reduction_numerator, "gearhead's reduction");
    positive(key + "reduction_denominator", gear.gearhead.reduction_denominator, "gearhead's reduction");
    positive(key + "continuous_torque", gear.gearhead.continuous_torque, "gearhead's continuous torque");
    positive(key + "intermittent_torque", gear.gearhead.intermittent_torque, "gearhead's intermittent torque");
    share(key + "max_efficiency", gear.gearhead.max_efficiency, "gearhead's efficiency");
    positive("transmission.further_ratio", gear.further_ratio, "ratio behind the gearhead");
    share("transmission.further_efficiency", gear.further_efficiency, "efficiency behind the gearhead");
  }

  void check(const CapstanDescription& capstan) {
    const std::string key = "transmission.";
    positive(key + "preload", capstan.preload, "cable tension at rest");
    const CapstanDimensions dimensions = capstan_dimensions(capstan, {});
    const Capstan solved = solve_capstan(dimensions);
    if (solved.status == CapstanStatus::not_seated) {
      wrong(key + "cable.coated_diameter", length(dimensions.cable_diameter),
            "does not sit in the groove: the cable would ride on the crests of the thread, touching it at a "
            "diameter of " +
                length(solved.contact_diameter) + " where the thread ends at " +
                length(dimensions.input_diameter),
            seating_advice(dimensions));
      return;
    }
    if (solved.status == CapstanStatus::ok) return;
    if (solved.min_centre_distance > 0.0) {
      wrong(key + "centre_distance", length(dimensions.centre_distance),
            "makes the pulleys overlap: with the cable on them they touch at " +
                length(std::ceil(solved.min_centre_distance * kSteps) / kSteps),
            "move the axes at least that far apart");
    } else if (solved.pitch_diameter < 0.0) {
      wrong(key + "lead", length(dimensions.lead), "cuts the thread deeper than the pulley is thick",
            "make it finer, or input_diameter larger");
    } else if (solved.pitch_diameter > 0.0) {
      wrong(key + "cable.coated_diameter", length(dimensions.cable_diameter),
            "is too thin for the groove: its centre line would lie behind the axis",
            "take a thicker cable, a finer lead, or a larger input_diameter");
    } else {
      wrong("transmission", "", std::string(solved.reason), "see the keys of a capstan in docs/device_file.md");
    }
  }

  const DriveDescription& drive_;
  std::string path_;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> drive_problems(const DriveDescription& description, const std::string& path) {
  return Finder(description, path).run();
}

std::vector<Problem> drive_problems(const Description& description) {
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < description.drives.size(); ++i) {
    for (Problem& problem : drive_problems(description.drives[i], "drive[" + std::to_string(i) + "]"))
      problems.push_back(std::move(problem));
  }
  return problems;
}

}  // namespace zwidth
