#pragma once

#include "zwidth/description/parts.h"
#include "zwidth/math/spatial.h"

/// A double-acting air cylinder and the two regulators that fill it (Akhoondi Asadi 2017, sections 3.1 and 4).
/// Pressures are gauge [Pa]; a force is positive when the cylinder pushes. Areas that are not positive, values
/// that are not finite and pressures below vacuum throw std::invalid_argument.

namespace zwidth {

inline constexpr double kAtmosphere = 101325.0;  ///< absolute [Pa]

/// P1 A1 - P2 A2 [N] (3.14), without friction.
double cylinder_force(double rear_area, double rod_area, double rear_pressure, double rod_pressure);

/// Pressures of the two chambers.
struct ChamberPressures {
  double rear = 0.0;       ///< P1 [Pa]
  double rod = 0.0;        ///< P2 [Pa]
  bool saturated = false;  ///< one of them was clamped: the force is not what was asked for
};

/// Shares a force between the chambers: the side that works against it stays at a bias pressure, which keeps
/// the air stiff and the seals tight, and the other does the rest. What a tick calls cannot fail.
class PressureAllocation {
 public:
  /// Areas A1 and A2 [m^2], and the pressures that the chambers may have: at rest `bias`, at most
  /// `max_pressure`.
  PressureAllocation(double rear_area, double rod_area, double bias, double max_pressure);

  /// For a force [N], clamped to 0 .. max_pressure.
  ChamberPressures pressures(double force) const noexcept;

  /// P1 A1 - P2 A2 [N].
  double force(const ChamberPressures& pressures) const noexcept {
    return pressures.rear * rear_area_ - pressures.rod * rod_area_;
  }

  /// The forces that need no clamping: pull and push [N].
  Interval force_range() const noexcept;

 private:
  double rear_area_;
  double rod_area_;
  double bias_;
  double max_pressure_;
};

/// What a regulator makes of a command [V], which it clamps to its range [Pa].
double regulator_pressure(const Regulator& regulator, double command) noexcept;

/// A command and whether it had to be clamped.
struct RegulatorCommand {
  double voltage = 0.0;  ///< [V]
  bool saturated = false;
};

/// The command for a pressure [Pa]; one out of the regulator's range gives the nearer end.
RegulatorCommand regulator_command(const Regulator& regulator, double pressure) noexcept;

/// Pressure [Pa] that the monitor output [V] reports; NaN where the regulator's monitor is not given.
double monitored_pressure(const Regulator& regulator, double voltage) noexcept;

/// A restriction, such as a tube or a valve, by ISO 6358.
struct FlowPath {
  double sonic_conductance = 0.0;    ///< C, at reference conditions [m^3/(s Pa)]
  double critical_ratio = 0.0;       ///< b, of pressures, below which the flow is choked [-]
  double laminar_ratio = 0.999;      ///< of pressures, above which the flow falls on a straight line to zero
  double reference_density = 1.185;  ///< rho0 [kg/m^3]
  double reference_temperature = 293.15;  ///< T0 [K]
};

/// Mass flow [kg/s] from a side at `upstream` to one at `downstream` [Pa, absolute], air at `temperature` [K];
/// negative when it flows back. Throws std::invalid_argument for pressures or other quantities that are not
/// positive, and ratios outside [0, 1).
double mass_flow(const FlowPath& path, double upstream, double downstream, double temperature);

}  // namespace zwidth
