#pragma once

#include <optional>
#include <string_view>

#include "zwidth/description/description.h"

/// A cable-driven sector: a thread of 60 degrees on the input pulley, in which the cable lies in helical wraps,
/// and a smooth output sector that carries both cable ends (Neal 2015, section 4.4). The paper's symbols stand
/// beside each quantity; note that its d1..d14 and theta1..theta6 have nothing to do with the mechanism's.

namespace zwidth {

/// What one chooses. Lengths in metres.
struct CapstanDimensions {
  double input_diameter = 0.0;   ///< thread major diameter d1
  double lead = 0.0;             ///< advance per turn, also the pitch d2
  double cable_diameter = 0.0;   ///< over the coating d4
  double output_diameter = 0.0;  ///< of the sector's surface d6
  double centre_distance = 0.0;  ///< of the axes d8
  double wraps = 0.0;            ///< turns of cable on the input pulley k_r [-], at least 1
  double friction = 0.0;         ///< coefficient mu [-]
  double output_range = 0.0;     ///< angle the sector turns through theta6 [rad]
};

/// `joint_range` [rad] stands in when the description leaves the output range at zero.
CapstanDimensions capstan_dimensions(const CapstanDescription& description, const Interval& joint_range);

struct CapstanOptions {
  /// Repeat eq 4.16-4.18 until the helix angle belongs to the diameter at which the cable touches the flanks.
  /// Without it the angle at the pitch diameter stands, as the source first says; its published figures are
  /// iterated.
  bool iterate_helix = true;
};

enum class CapstanStatus {
  ok,
  invalid_argument,  ///< a quantity out of its range, or the pulleys overlap; `reason` says which
  not_seated,        ///< the cable rides on the thread's crests: the figures are given, but do not hold
};

/// Forces in the cable and on the input pulley's bearings under a torque on the input pulley, as magnitudes
/// [N].
struct CapstanLoads {
  double tension_difference = 0.0;  ///< half of high less low side F_u (eq 4.30)
  double preload = 0.0;             ///< tension at rest F_p
  double low_tension = 0.0;         ///< F_l = F_p - F_u; negative would mean a slack cable
  double high_tension = 0.0;        ///< F_h = F_p + F_u
  double bearing_x = 0.0;           ///< towards the sector F_bx (eq 4.39)
  double bearing_y = 0.0;           ///< across F_by (eq 4.40)
  double bearing_axial = 0.0;       ///< along the axis F_bz (eq 4.41)
  double bearing_radial = 0.0;      ///< F_br (eq 4.42)
};

/// A capstan worked out. Angles in radians, lengths in metres. With status invalid_argument the quantities
/// behind the failed rule stay zero (the smallest centre distance is there when the pulleys overlap).
struct Capstan {
  CapstanStatus status = CapstanStatus::invalid_argument;
  std::string_view reason;  ///< the rule that was broken, for people; empty when ok
  CapstanDimensions dimensions;

  double pitch_diameter = 0.0;         ///< d3 (eq 4.14)
  double contact_diameter = 0.0;       ///< where the cable touches the flanks d3* (eq 4.18)
  double helix_angle = 0.0;            ///< there theta1 (eq 4.15)
  double groove_half_angle = 0.0;      ///< in the section normal to the cable theta2 (eq 4.16)
  double input_pitch_diameter = 0.0;   ///< of the cable's centre line on the input pulley d5 (eq 4.17)
  double cable_angle = 0.0;            ///< helix angle of the cable's centre line theta3 (eq 4.19)
  double output_pitch_diameter = 0.0;  ///< of the cable's centre line on the sector d7 (eq 4.25)
  double min_centre_distance = 0.0;    ///< at which the cable paths touch (d5 + d7)/2
  double tangent_angle =
      0.0;  ///< between the centre line and the radius to the point of tangency theta4 (eq 4.24)
  double contact_angle = 0.0;      ///< wound on the input pulley theta5 (eq 4.26)
  double ratio = 0.0;              ///< output torque per input torque k_g (eq 4.43)
  double friction_exponent = 0.0;  ///< ln of the tension ratio that friction can hold q (eq 4.28)

  double length_on_input = 0.0;   ///< d9 (eq 4.45)
  double length_on_output = 0.0;  ///< d10 (eq 4.46)
  double length_between = 0.0;    ///< of both free spans d11 (eq 4.47)
  double cable_length = 0.0;      ///< d12 (eq 4.48)
  double input_width = 0.0;       ///< axial room the cable takes d13 (eq 4.50)
  double thread_width = 0.0;      ///< axial length of thread used d14 (eq 4.51)

  bool wraps_touch = false;  ///< warning: neighbouring wraps touch, d4 > d2 cos theta3

  bool ok() const { return status == CapstanStatus::ok; }

  // The following need a status other than invalid_argument (asserted). Torques may have either sign.

  /// F_u for an input torque [N m]: the tension each side gains or loses [N].
  double tension_difference(double input_torque) const;

  /// Smallest preload [N] at which an input torque [N m] does not slip (eq 4.31).
  double min_preload(double input_torque) const;

  /// Forces at a preload [N] and an input torque [N m].
  CapstanLoads loads(double preload, double input_torque) const;

  /// Forces at the smallest preload, as the source tabulates them.
  CapstanLoads loads_at_min_preload(double input_torque) const;

  /// Output torque [N m] at which the cable slips under a preload [N].
  double slip_torque(double preload) const;

  /// k_g T_u times a factor for a short time [N m] (eq 4.44).
  double output_torque(double input_torque, double factor = 1.0) const { return factor * ratio * input_torque; }

  /// Length [m] of a single cable as stiff as the two branches in parallel, from the input pulley to the
  /// sector's two anchors, with the sector `angle` [rad] away from the middle of its range (Neal 2015,
  /// table 5.1; the reading that reproduces it). Empty when the angle would unwind a whole branch.
  std::optional<double> equivalent_cable_length(double angle) const;
};

Capstan solve_capstan(const CapstanDimensions& dimensions, const CapstanOptions& options = {});

}  // namespace zwidth
