#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "zwidth/actuation/capstan.h"
#include "zwidth/actuation/current_loop.h"
#include "zwidth/actuation/flexure.h"
#include "zwidth/actuation/motor.h"
#include "zwidth/actuation/two_mass.h"
#include "zwidth/description/description.h"

namespace zwidth {

/// The drive cannot be built: `drive_problems` is not empty. The message is the first of them.
class InvalidDrive : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// What holds a limit.
enum class Limiter { motor, slip, gearhead, amplifier, supply, encoder };

/// "motor", "slip", "gearhead", "amplifier", "supply voltage", "encoder".
const char* to_string(Limiter limiter);

/// Largest joint torque [N m], and what each element of the drive would allow.
struct TorqueLimit {
  double motor = 0.0;              ///< the motor's torque at the joint
  std::optional<double> slip;      ///< at which the cable slips; empty where nothing can slip
  std::optional<double> gearhead;  ///< that the gearhead may carry; empty without one
  double amplifier = 0.0;          ///< the torque of the amplifier's current
  double supply = 0.0;             ///< at standstill and the available voltage
  double usable = 0.0;             ///< the least of them
  Limiter limited_by = Limiter::motor;
};

/// Largest joint speed [rad/s].
struct SpeedLimit {
  double unloaded = 0.0;  ///< at the available voltage, without load
  double at_continuous_torque =
      0.0;                         ///< at the available voltage, under the continuous torque; 0 if out of reach
  std::optional<double> encoder;   ///< that the encoder can follow; empty when its limit is not given
  std::optional<double> motor;     ///< that the motor permits; empty when not given
  std::optional<double> gearhead;  ///< that the gearhead permits; empty without one, or when not given
  double usable = 0.0;             ///< the least of all but the loaded one
  Limiter limited_by = Limiter::supply;
};

/// One rule that the drive must keep: what is demanded may not exceed what is there.
struct Margin {      // checked with a part in 10^9 to spare, for limits that are met exactly
  std::string name;  ///< "cable tension"
  double demand = 0.0;
  double capability = 0.0;
  std::string unit;                   ///< of both; "" for a pure number
  std::optional<double> utilisation;  ///< demand / capability; empty when the capability is zero
  bool ok = false;                    ///< demand <= capability, but for rounding (a part in 10^9)
  std::string rule;                   ///< in words, with where it comes from
};

/// One number of a drive, for people.
struct DriveFigure {
  std::string key;   ///< stable, snake_case: "reflected_inertia"
  std::string name;  ///< "reflected inertia"
  double value = 0.0;
  std::string unit;  ///< SI: "kg m^2", "rad", "" for a pure number
};

/// Motor, transmission, encoder and amplifier of one active joint. Immutable; the two conversions of the tick
/// (`current_for_torque`, `joint_angle`) neither throw nor allocate.
class Drive {
 public:
  /// `joint_range` [rad] is the range of the joint it moves. Throws InvalidDrive where `drive_problems` finds
  /// anything; margins that fail are no errors.
  Drive(const DriveDescription& description, const Interval& joint_range);

  /// The same for a design search: empty where the constructor would throw.
  static std::optional<Drive> try_make(const DriveDescription& description, const Interval& joint_range);

  const DriveDescription& description() const { return description_; }
  const Interval& joint_range() const { return joint_range_; }

  /// Turns of the motor per turn of the joint; 1 for a direct drive.
  double ratio() const noexcept { return ratio_; }
  /// Share of the motor's torque that reaches the joint while the drive pushes. (A drive that is pushed resists
  /// by as much again.)
  double efficiency() const noexcept { return efficiency_; }
  const std::optional<Capstan>& capstan() const { return capstan_; }
  const std::optional<Flexure>& preloader() const { return preloader_; }
  const std::optional<ThermalModel>& thermal() const { return thermal_; }
  const CurrentLoop& current_loop() const { return current_loop_; }

  /// Nominal motor torque; continuous amplifier current and gearhead torque.
  TorqueLimit continuous_torque() const;
  /// Nominal motor torque times the peak factor; the amplifier's maximum current, the gearhead's intermittent
  /// torque.
  TorqueLimit peak_torque() const;
  /// Stall torque of the motor at the available voltage; the amplifier's maximum current, the gearhead's
  /// intermittent torque.
  TorqueLimit stall_torque() const;

  /// Motor torque [N m] for a joint torque [N m].
  double motor_torque(double joint_torque) const noexcept { return joint_torque / (ratio_ * efficiency_); }

  SpeedLimit speed() const;

  std::optional<double> torque_resolution()
      const;                          ///< joint torque of one current step [N m]; empty if not given
  double angular_resolution() const;  ///< joint angle of one count [rad]
  double input_inertia() const;       ///< rotor, code wheel and input pulley J1, at the motor [kg m^2]
  double reflected_inertia() const;   ///< all of the drive's inertia felt at the joint [kg m^2]
  std::optional<double> perceived_mass() const;  ///< at the output's radius [kg]; empty without an output
  double friction_torque() const;                ///< of the motor's no-load current, at the joint [N m]
  std::optional<double> backlash() const;        ///< at the joint [rad]; empty when not given

  /// Stiffness of the cable along itself [N/m] with the joint at an angle [rad]; empty for a direct drive, an
  /// unknown rope, or an angle out of the sector's reach.
  std::optional<double> cable_stiffness(double joint_angle) const;
  /// Stiffness of the transmission felt at the joint [N m/rad]: the cable's, or as given; empty otherwise.
  std::optional<double> joint_stiffness(double joint_angle) const;

  /// Two-mass model with the joint at an angle [rad]; empty without a capstan or an output.
  std::optional<TwoMassModel> two_mass(double joint_angle = 0.0) const;

  /// Every rule that the data allow to be checked, in a fixed order.
  std::vector<Margin> margins() const;

  /// What is worth printing of the drive, in a fixed order. Of a joint that slides torques are forces [N],
  /// angles lengths [m] and the ratio is turns of the motor in rad per metre.
  std::vector<DriveFigure> figures(bool slides = false) const;

  /// Motor current [A] for a joint torque [N m] that the drive pushes with, the motor's friction not
  /// compensated. Any input, no limit applied.
  double current_for_torque(double joint_torque) const noexcept { return joint_torque * current_per_torque_; }

  /// Joint torque [N m] of a motor current [A], friction not counted.
  double torque_for_current(double current) const noexcept { return current / current_per_torque_; }

  /// Joint angle [rad] from encoder counts, of which `zero` are counted at joint angle zero.
  double joint_angle(std::int64_t counts, std::int64_t zero = 0) const noexcept {
    return static_cast<double>(counts - zero) * angle_per_count_;
  }

 private:
  TorqueLimit torque_limit(double motor_torque, double amplifier_current, double gearhead_torque) const;
  const Gearhead* gearhead() const;
  /// Joint torque per torque of the gearhead's output, and turns of that per turn of the joint.
  double after_gearhead() const;
  double further_ratio() const;
  void add_capstan_margins(std::vector<Margin>& margins) const;
  void add_gearhead_margins(std::vector<Margin>& margins) const;

  DriveDescription description_;
  Interval joint_range_;
  std::optional<Capstan> capstan_;
  std::optional<Flexure> preloader_;
  std::optional<ThermalModel> thermal_;
  CurrentLoop current_loop_;
  double ratio_ = 1.0;
  double efficiency_ = 1.0;
  double current_per_torque_ = 0.0;
  double angle_per_count_ = 0.0;
};

}  // namespace zwidth
