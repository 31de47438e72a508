#include "zwidth/actuation/cylinder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "zwidth/actuation/require.h"

namespace zwidth {
namespace {

double require_gauge(const char* name, double pressure) {
  if (!std::isfinite(pressure) || pressure < -kAtmosphere) {
    throw std::invalid_argument(std::string("the ") + name + " must be finite and not below vacuum, not " +
                                std::to_string(pressure) + " Pa");
  }
  return pressure;
}

double require_ratio(const char* name, double ratio) {
  if (!(ratio >= 0.0 && ratio < 1.0)) {
    throw std::invalid_argument(std::string("the ") + name + " must be from 0 to below 1, not " +
                                std::to_string(ratio));
  }
  return ratio;
}

}  // namespace

double cylinder_force(double rear_area, double rod_area, double rear_pressure, double rod_pressure) {
  const double A1 = require_positive("rear area", rear_area), A2 = require_positive("rod area", rod_area);
  const double P1 = require_gauge("rear pressure", rear_pressure);
  const double P2 = require_gauge("rod pressure", rod_pressure);
  return P1 * A1 - P2 * A2;
}

PressureAllocation::PressureAllocation(double rear_area, double rod_area, double bias, double max_pressure)
    : rear_area_(require_positive("rear area", rear_area)),
      rod_area_(require_positive("rod area", rod_area)),
      bias_(require_gauge("bias pressure", bias)),
      max_pressure_(require_positive("highest pressure", max_pressure)) {}

ChamberPressures PressureAllocation::pressures(double force) const noexcept {
  const double A1 = rear_area_, A2 = rod_area_;
  ChamberPressures wanted{.rear = bias_, .rod = bias_};
  if (force >= bias_ * (A1 - A2)) {
    wanted.rear = (force + bias_ * A2) / A1;
  } else {
    wanted.rod = (bias_ * A1 - force) / A2;
  }
  // A force that is not a number must not become a pressure: std::min and std::max would pass it on.
  const auto clamped = [this](double pressure) {
    return pressure > 0.0 ? (pressure < max_pressure_ ? pressure : max_pressure_) : 0.0;
  };
  const double rear = clamped(wanted.rear), rod = clamped(wanted.rod);
  return {.rear = rear, .rod = rod, .saturated = rear != wanted.rear || rod != wanted.rod};
}

Interval PressureAllocation::force_range() const noexcept {
  const double against = std::clamp(bias_, 0.0, max_pressure_);
  return {against * rear_area_ - max_pressure_ * rod_area_, max_pressure_ * rear_area_ - against * rod_area_};
}

double regulator_pressure(const Regulator& regulator, double command) noexcept {
  const double share = (command - regulator.min_command) / (regulator.max_command - regulator.min_command);
  const double possible = share > 0.0 ? std::min(share, 1.0) : 0.0;  // also where the command is not a number
  return regulator.min_pressure + possible * (regulator.max_pressure - regulator.min_pressure);
}

RegulatorCommand regulator_command(const Regulator& regulator, double pressure) noexcept {
  const double share = (pressure - regulator.min_pressure) / (regulator.max_pressure - regulator.min_pressure);
  const double possible = share > 0.0 ? std::min(share, 1.0) : 0.0;
  return {.voltage = regulator.min_command + possible * (regulator.max_command - regulator.min_command),
          .saturated = possible != share};
}

double monitored_pressure(const Regulator& regulator, double voltage) noexcept {
  return regulator.min_pressure + (voltage - regulator.min_monitor) /
                                      (regulator.max_monitor - regulator.min_monitor) *
                                      (regulator.max_pressure - regulator.min_pressure);
}

double mass_flow(const FlowPath& path, double upstream, double downstream, double temperature) {
  require_positive("upstream pressure", upstream);
  require_positive("downstream pressure", downstream);
  if (downstream > upstream) return -mass_flow(path, downstream, upstream, temperature);
  const double C = require_positive("sonic conductance", path.sonic_conductance);
  const double b = require_ratio("critical pressure ratio", path.critical_ratio);
  const double laminar = require_ratio("laminar pressure ratio", path.laminar_ratio);
  const double rho0 = require_positive("reference density", path.reference_density);
  const double T0 = require_positive("reference temperature", path.reference_temperature);
  const double T = require_positive("temperature", temperature);
  const auto phi = [b](double ratio) {
    return ratio <= b ? 1.0 : std::sqrt(1.0 - std::pow((ratio - b) / (1.0 - b), 2));
  };
  const double ratio = downstream / upstream;
  const double share = ratio <= laminar ? phi(ratio) : phi(laminar) * (1.0 - ratio) / (1.0 - laminar);
  return C * rho0 * upstream * std::sqrt(T0 / T) * share;
}

}  // namespace zwidth
