#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "zwidth/description/parts.h"
#include "zwidth/math/spatial.h"

/// A device as data: what `devices/*.toml` says, in SI units and radians, with its parts looked up.
/// No behaviour lives here. `read_description` makes one, `validate` lists what is wrong with one,
/// `write_description` prints one; `Mechanism` and `Drive` are built from one.

namespace zwidth {

inline constexpr double kStandardGravity = 9.80665;  ///< [m/s^2]

/// Where single values of a table come from, by key, when that is not the table's own source.
using Sources = std::map<std::string, std::string>;

// ---------------------------------------------------------------------------------------------- mechanism

/// A delta of three equal legs at azimuths 90, 210 and 330 deg about +z (Neal 2015, appendix A).
/// Base frame: origin in the plane of the three actuator axes, z up, y towards leg 1.
struct DeltaDescription {
  double base_radius = 0.0;      ///< d1, radius of the actuator axes [m]
  double upper_arm = 0.0;        ///< d2, length of the driven link [m]
  double forearm = 0.0;          ///< d3, length of the parallelogram [m]
  double platform_radius = 0.0;  ///< d4, radius of the joints on the platform [m]
  Interval joint_range;  ///< of every driven joint [rad]; 0 is horizontal outwards, positive lifts the elbow
  std::string source;    ///< where the values come from; "chosen: ..." where no source gives them
  Sources sources = {};

  bool operator==(const DeltaDescription&) const = default;
};

/// A planar five-bar: two cranks on fixed motors, two couplers that meet in the tool (Singh, Saha, Manivannan).
/// Base frame: origin between the motors, x from the left motor to the right one, the tool in the plane z = 0.
/// Legs "left" (joints theta1, elbow1) and "right" (theta2, elbow2).
struct FiveBarDescription {
  double crank = 0.0;      ///< r1, of each side [m]
  double coupler = 0.0;    ///< r2, of each side [m]
  double half_base = 0.0;  ///< r3, half the distance of the motors [m]
  Interval left_range;     ///< of theta1, from +x [rad]
  Interval right_range;    ///< of theta2, from +x [rad]
  int left_mode = 1;    ///< s1, +1 or -1: the left leg's root; +1 turns the crank on from the line to the tool
  int right_mode = -1;  ///< s2, of the right leg
  int assembly_mode = 1;  ///< +1: the tool lies to the left of the line from the left elbow to the right one
  std::string source;
  Sources sources = {};

  bool operator==(const FiveBarDescription&) const = default;
};

/// The R-CUBE: three equal legs, each a driven link, a universal joint, and two links on parallel revolutes,
/// carry a platform that only translates; motor i moves the tool along axis i (Görgülü 2018).
/// Base frame: motor i at S e_i, its axis along e_(i+1), its driven link along e_(i+2) at angle zero.
/// Legs leg1, leg2, leg3; in each the joints theta (driven), tilt, swing, elbow, wrist, numbered as the leg.
struct RCubeDescription {
  double drive_link = 0.0;   ///< l1 [m]
  double inner_link = 0.0;   ///< l2 [m]
  double outer_link = 0.0;   ///< l3 [m]
  double base_offset = 0.0;  ///< S, of each motor axis from the base origin [m]
  Interval joint_range;      ///< of every driven joint [rad]
  int elbow_mode = -1;       ///< sigma, +1 or -1: sign of sin of every leg's elbow angle
  std::string source;
  Sources sources = {};

  bool operator==(const RCubeDescription&) const = default;
};

/// What the platform may do.
enum class PlatformFreedom {
  translation,  ///< its axes stay parallel to the base frame's (held so by parallelograms or equal joints)
  rigid,        ///< all six degrees of freedom, less what the legs forbid
  planar_translation,  ///< x and y: the tool is a point of a plane, its orientation means nothing
  planar,              ///< x, y, and turning about z
  rotation,            ///< turning about a fixed point
  point,               ///< x, y and z: the tool is a point of the first leg's last link, which turns as it must
};

enum class SerialJointType {
  revolute,   ///< its value adds to theta
  prismatic,  ///< its value adds to d
  fixed,      ///< a row of the table without a joint
};

/// One row of a Denavit-Hartenberg table, Rz(theta) Tz(d) Tx(a) Rx(alpha).
struct SerialJointDescription {
  std::string name;
  SerialJointType type = SerialJointType::revolute;
  double theta = 0.0;         ///< about z; of a revolute joint at value zero [rad]
  double d = 0.0;             ///< along z; of a prismatic joint at value zero [m]
  double a = 0.0;             ///< along x [m]
  double alpha = 0.0;         ///< about x [rad]
  Interval range{-1e9, 1e9};  ///< [rad] or [m]
  double home = 0.0;          ///< value in the home posture [rad] or [m]
  bool free = false;          ///< moved by the hand, not by a drive
  std::string source = {};    ///< where the values come from, if not from the mechanism's source
  Sources sources = {};

  bool operator==(const SerialJointDescription&) const = default;
};

/// A serial arm. Its one leg is called "arm"; the tool frame is that of the last row.
struct SerialDescription {
  std::vector<SerialJointDescription> joints;  ///< rows from the base to the tool
  /// What of the tool frame the device is there to move and push: `point` for an arm that only positions,
  /// however the hand turns its end.
  PlatformFreedom platform = PlatformFreedom::rigid;
  std::string source;
  Sources sources = {};

  bool operator==(const SerialDescription&) const = default;
};

enum class JointType {
  revolute,       ///< turns the following links about the axis
  prismatic,      ///< slides the following links along the axis
  parallelogram,  ///< swings the following links about the axis on parallel bars: they translate on a circle
};

/// One joint of a leg, given in the base frame at the leg's zero posture, in which all its joints are zero
/// and every link frame is parallel to the base frame. (The legs' zero postures need not close the loops.)
struct JointDescription {
  std::string name;
  JointType type = JointType::revolute;
  bool active = false;  ///< independent: its value is given, and decides the posture with those of the other
                        ///< active joints
  bool free = false;    ///< of an active joint: the hand moves it, no drive does
  Vector3 axis = Vector3::UnitZ();  ///< unit vector
  Vector3 point = Vector3::Zero();  ///< a point on the axis; for a parallelogram, the root end of its bars [m]
  Interval range{-1e9, 1e9};        ///< [rad] or [m]; passive joints may leave it out
  double home = 0.0;  ///< value in a posture that closes the loops: where the solver starts [rad] or [m]

  bool operator==(const JointDescription&) const = default;
};

/// How the last link of a leg holds the platform.
enum class Attachment {
  rigid,      ///< position and orientation: the platform is the leg's last link
  spherical,  ///< position of one point only
};

/// A serial chain from the base to the platform.
struct LegDescription {
  std::string name;
  std::vector<JointDescription> joints;  ///< from the base outwards
  Vector3 tip =
      Vector3::Zero();  ///< the point of the last link that meets the platform, leg's zero posture [m]
  Attachment attachment = Attachment::rigid;
  Vector3 platform_point = Vector3::Zero();  ///< the same point, in the platform frame [m]
  /// Of the platform at the leg's zero posture: columns are its axes. Rigid attachments only.
  Matrix3 platform_rotation = Matrix3::Identity();

  bool operator==(const LegDescription&) const = default;
};

/// Any mechanism: legs from the base to one platform, whose frame carries the tool at its origin.
struct LegsDescription {
  PlatformFreedom platform = PlatformFreedom::rigid;
  std::vector<LegDescription> legs;
  std::string source;
  Sources sources = {};

  bool operator==(const LegsDescription&) const = default;
};

using MechanismDescription =
    std::variant<DeltaDescription, FiveBarDescription, RCubeDescription, SerialDescription, LegsDescription>;

/// How the moduli of a wall follow from its plies.
enum class LaminateRule {
  lamination,  ///< all plies share their strains (classical lamination theory)
  mean,        ///< mean of the plies' moduli (Görgülü 2018, eq 5.179-5.181)
};

/// Equal plies at one angle.
struct PlyDescription {
  int count = 0;
  double angle = 0.0;  ///< of the fibres from the link's axis [rad]

  bool operator==(const PlyDescription&) const = default;
};

/// A wall of plies, whose order does not matter where it bends as part of a tube.
struct LaminateDescription {
  Lamina lamina;
  std::vector<PlyDescription> plies;
  LaminateRule rule = LaminateRule::lamination;

  bool operator==(const LaminateDescription&) const = default;
};

using WallDescription = std::variant<Material, LaminateDescription>;

/// Round tube, or round bar without an inner diameter.
struct TubeDescription {
  double outer_diameter = 0.0;  ///< [m]
  double inner_diameter = 0.0;  ///< [m]
  WallDescription wall = {};
  std::string source = {};
  Sources sources = {};

  bool operator==(const TubeDescription&) const = default;
};

/// Solid rectangular bar.
struct BarDescription {
  double width = 0.0;   ///< [m]
  double height = 0.0;  ///< [m]
  /// Direction of the width, at the leg's zero posture, of any length; what of it lies along the link does not
  /// count. Zero: the axis of the joint that moves the link.
  Vector3 width_along = Vector3::Zero();
  WallDescription wall = {};
  std::string source = {};
  Sources sources = {};

  bool operator==(const BarDescription&) const = default;
};

/// A straight, uniform link. It lies between the points of the joint that moves it and of the next joint, or
/// the leg's tip, and gives the link mass and elasticity. Links without one are rigid.
using BeamDescription = std::variant<TubeDescription, BarDescription>;

/// A rigid body fixed to a link or to the platform, or the link itself as a beam.
///
/// `on` names the link: "platform", or "LEG/JOINT" for the link that this joint moves. A delta also knows
/// "upper_arm" and "forearm", which stand for all three legs; their frame has its origin in the link's inner
/// joint, x outwards, z up, y = z x x tangential, with the upper arm horizontal and the forearm pointing up.
///
/// A body that hangs on one link by a pin and is turned by another, as parallel bars do it, names the other in
/// `turns_with` and the pin in `pivot`: the pin moves with the first link, and about it the body keeps the
/// orientation of the second.
struct BodyDescription {
  std::string on;
  std::string turns_with = {};       ///< link whose orientation it keeps; empty: that of `on`
  Vector3 pivot = Vector3::Zero();   ///< where it hangs on `on`, at the leg's zero posture [m]; with turns_with
  double mass = 0.0;                 ///< [kg]
  Vector3 centre = Vector3::Zero();  ///< centre of mass, at the leg's zero posture [m]
  Matrix3 inertia = Matrix3::Zero();         ///< about the centre of mass [kg m^2]
  std::optional<BeamDescription> beam = {};  ///< instead of mass, centre and inertia, which follow from it
  std::string source;  ///< where the values come from; "chosen: ..." where no source gives them
  Sources sources = {};

  bool operator==(const BodyDescription&) const = default;
};

// -------------------------------------------------------------------------------------------------- drives

/// A threaded input pulley that drives an output sector through a cable wound on both (Neal 2015, section 4.4).
struct CapstanDescription {
  double input_diameter = 0.0;   ///< thread major diameter d1 [m]
  double lead = 0.0;             ///< thread lead d2, single start, 60 deg V [m]
  Cable cable;                   ///< its coated diameter is d4
  double output_diameter = 0.0;  ///< d6 [m]
  double centre_distance = 0.0;  ///< of the two axes d8 [m]
  double wraps = 0.0;            ///< turns on the input pulley k_r
  double friction = 0.0;         ///< coefficient cable to pulley mu
  double preload = 0.0;          ///< cable tension at rest F_p [N]
  double output_range = 0.0;     ///< angle the output turns through theta6 [rad]; 0 takes the joint's range
  double mid_angle = 0.0;        ///< joint angle in the middle of the output range [rad]
  double cable_stiffness_factor = 1.0;  ///< S1: share of the metal's EA/l that a preloaded rope really has [-]
  std::string source;
  Sources sources = {};

  bool operator==(const CapstanDescription&) const = default;
};

/// No transmission: the joint is the motor shaft.
struct DirectDriveDescription {
  bool operator==(const DirectDriveDescription&) const = default;
};

/// A cable, belt or gear of which no more is known than how it turns motor into joint.
struct RatioDescription {
  double ratio = 0.0;            ///< turns of the motor per turn of the joint i
  double efficiency = 1.0;       ///< share of the motor's torque that reaches the joint eta
  double stiffness = kNotGiven;  ///< felt at the joint [N m/rad]
  double backlash = kNotGiven;   ///< felt at the joint [rad]
  double inertia = 0.0;          ///< of its wheels, felt at the joint [kg m^2]
  std::string source;
  Sources sources = {};

  bool operator==(const RatioDescription& other) const;  ///< values not given are equal
};

/// A gearhead of the catalogue, and what may follow between it and the joint.
struct GearheadDescription {
  Gearhead gearhead;
  double further_ratio = 1.0;       ///< turns of the gearhead's output per turn of the joint
  double further_efficiency = 1.0;  ///< of what lies between
  double stiffness = kNotGiven;     ///< felt at the joint [N m/rad]
  std::string source;
  Sources sources = {};

  bool operator==(const GearheadDescription& other) const;  ///< values not given are equal
};

using TransmissionDescription =
    std::variant<DirectDriveDescription, CapstanDescription, RatioDescription, GearheadDescription>;

/// A leaf spring that keeps the cable preloaded (Neal 2015, section 4.5).
struct FlexureDescription {
  double flexible_length = 0.0;  ///< l1 [m]
  double rigid_length = 0.0;     ///< l2 [m]
  double width = 0.0;            ///< w [m]
  double height = 0.0;           ///< h, in the direction of bending [m]
  Material material;
  std::string source;
  Sources sources = {};

  bool operator==(const FlexureDescription&) const = default;
};

/// What the drive moves, as the two-mass actuator model sees it (Neal 2015, chapter 5).
struct DriveOutputDescription {
  double inertia = 0.0;            ///< sector pulley and what is bolted to it J2 [kg m^2]
  double radius = 0.0;             ///< from the joint axis to the point that pushes r_o [m]
  double contact_stiffness = 0.0;  ///< of what it pushes against, at that radius k_o [N/m]
  double contact_damping = 0.0;    ///< c_o [N s/m]
  std::string source;
  Sources sources = {};

  bool operator==(const DriveOutputDescription&) const = default;
};

/// Motor + transmission + encoder + amplifier of one or several active joints.
struct DriveDescription {
  std::vector<std::string> joints;  ///< names of active joints; empty means every active joint
  Motor motor;
  Encoder encoder;
  Amplifier amplifier;
  double supply_voltage = 0.0;     ///< [V]
  double proportional_gain = 0.0;  ///< of the current loop, in the amplifier's register units
  double integral_gain = 0.0;      ///< of the current loop, in the amplifier's register units
  double input_inertia = 0.0;      ///< input pulley and coupling, beside rotor and code wheel [kg m^2]
  double peak_factor = 1.0;        ///< short-time torque per continuous torque [-]
  TransmissionDescription transmission;
  std::optional<FlexureDescription> preloader;
  std::optional<DriveOutputDescription> output;
  std::string source;
  Sources sources = {};

  bool operator==(const DriveDescription&) const = default;
};

/// Where the pins of a cylinder are that turns an arm (Akhoondi Asadi 2017, section 3.1). In the plane of the
/// joint, with the pivot at the origin, the arm along +x at joint angle zero, and angles counter-clockwise.
enum class ArmCylinderLayout {
  one,      ///< base pin at (0, -l1), arm pin at l2 along the arm: lengthens as the angle grows
  two,      ///< base pin at (l0, -l1), arm pin at l2: lengthens
  two_mod,  ///< base pin at (l0, l1), arm pin at l2: the mirror image of `two`, shortens
  three,    ///< base pin at (-l2, h), arm pin at l0 along and l1 across the arm: shortens
};

/// A cylinder that turns an arm. The thesis' letters stand, for their meaning changes with the layout.
struct ArmCylinderDescription {
  ArmCylinderLayout layout = ArmCylinderLayout::one;
  double l0 = 0.0;                ///< [m]; not in `one`
  double l1 = 0.0;                ///< [m]
  double l2 = 0.0;                ///< [m]
  double h = 0.0;                 ///< [m]; only in `three`
  double retracted_length = 0.0;  ///< pin to pin with the rod in [m]
  std::string source = {};
  Sources sources = {};

  bool operator==(const ArmCylinderDescription&) const = default;
};

/// No linkage: the rod is the sliding joint.
struct DirectCylinderDescription {
  bool operator==(const DirectCylinderDescription&) const = default;
};

using CylinderMountDescription = std::variant<DirectCylinderDescription, ArmCylinderDescription>;

/// Cylinder + two regulators + potentiometer of one or several active joints. Pressures are gauge.
struct PneumaticDriveDescription {
  std::vector<std::string> joints;  ///< names of active joints; empty means every active joint
  Cylinder cylinder;
  Regulator regulator;                         ///< one for each chamber
  std::optional<Potentiometer> potentiometer;  ///< of the joint's angle
  double supply_pressure = 0.0;                ///< [Pa]
  double bias_pressure = 0.0;                  ///< of the chamber that works against the wanted force [Pa]
  double sensor_voltage = 0.0;                 ///< across the potentiometer [V]; 0 when not given
  double sensor_step = 0.0;  ///< smallest step of its output that is read [V]; 0 when not given
  CylinderMountDescription mount;
  std::string source;
  Sources sources = {};

  bool operator==(const PneumaticDriveDescription&) const = default;
};

// --------------------------------------------------------------------------------------------------- loads

/// How long a load lasts, and so what a drive may give for it.
enum class LoadKind {
  continuous,  ///< for ever
  peak,        ///< for a short time
};

/// What the components of a moment refer to.
enum class MomentFrame {
  base,  ///< the base frame
  tool,  ///< the tool frame: M in base components is C M, where the columns of C are the tool's axes
  /// C^T M, the rotation applied the wrong way round, as the torque tables of Baser 2006 (section 5.1) come
  /// about. There to reproduce them; it is not physics.
  published,
};

/// What the tool has to push and turn with, to size the drives for.
struct LoadDescription {
  std::string name;
  Vector3 force = Vector3::Zero();   ///< of the tool on its environment, base frame [N]
  Vector3 moment = Vector3::Zero();  ///< about the tool point, in `moment_frame` [N m]
  MomentFrame moment_frame = MomentFrame::base;
  LoadKind kind = LoadKind::continuous;
  std::string source = {};
  Sources sources = {};

  bool operator==(const LoadDescription&) const = default;
};

/// A posture with a name, by its active joints.
struct PostureDescription {
  std::string name;
  std::vector<double> joints;  ///< in the order of `active_joint_names` [rad] or [m]
  std::string source = {};
  Sources sources = {};

  bool operator==(const PostureDescription&) const = default;
};

// -------------------------------------------------------------------------------------------------- device

struct Description {
  std::string name;
  std::string title;
  std::string source;
  Vector3 gravity{0.0, 0.0, -kStandardGravity};  ///< [m/s^2], base frame
  Matrix3 to_user =
      Matrix3::Identity();  ///< turns base coordinates into the user's: x to the user, y right, z up
  MechanismDescription mechanism;
  std::vector<BodyDescription> bodies;
  std::vector<DriveDescription> drives;                     ///< electric ones
  std::vector<PneumaticDriveDescription> pneumatic_drives;  ///< files give both kinds as [[drive]]
  std::vector<LoadDescription> loads;                       ///< that the device is made for
  std::vector<PostureDescription> postures;                 ///< that matter: the most extended ones, say
  Sources sources = {};

  bool operator==(const Description&) const = default;
};

}  // namespace zwidth
