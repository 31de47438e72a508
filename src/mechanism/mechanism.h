#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/math/beam.h"
#include "zwidth/mechanism/closed_form.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/serial_chain.h"
#include "zwidth/mechanism/sizes.h"

namespace zwidth {

/// One joint, ready to compute with. Frames of all links are parallel to the base frame at the leg's zero
/// posture.
struct JointModel {
  JointType type = JointType::revolute;
  Vector3 axis = Vector3::UnitZ();  ///< unit, in the inner link's frame
  Vector3 offset =
      Vector3::Zero();  ///< from the inner joint's point to this one's, in the inner link's frame [m]
  Interval range;       ///< [rad] or [m]
  int active = -1;      ///< index among the active joints, -1 if passive
  bool free = false;    ///< active, but moved by the hand alone
};

/// A rigid body fixed to the link that one joint moves, or hung on it by a pin and turned by another link.
struct BodyModel {
  int joint = -1;       ///< that carries it: index in `Mechanism::joints()`, -1 for the platform
  int turns_with = -1;  ///< whose link's orientation it has: `joint`, unless it hangs on a pin
  double mass = 0.0;    ///< [kg]
  Vector3 pivot =
      Vector3::Zero();  ///< the pin, from the joint's point, carrying link's frame; 0 without one [m]
  /// From the pin (without one the joint's point, or the platform's origin), in the frame of the link that
  /// turns it [m].
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre, frame of the link that turns it [kg m^2]
};

/// A link that is a beam, from the point of the joint that moves it to that of the next one, or to the leg's
/// tip. Its mass is among the bodies.
struct BeamModel {
  int joint = -1;                       ///< that moves it: index in `Mechanism::joints()`
  double length = 0.0;                  ///< [m]
  Matrix3 frame = Matrix3::Identity();  ///< columns: along it, its section's y and z, in the link's frame
  BeamRigidity rigidity;
  BeamFlexibility flexibility;  ///< of this length
};

struct LegModel {
  int first = 0;                  ///< index of its first joint
  int count = 0;                  ///< number of joints
  Vector3 tip = Vector3::Zero();  ///< from the last joint's point to the attachment, last link's frame [m]
  Vector3 platform_point = Vector3::Zero();         ///< attachment in the platform frame [m]
  Matrix3 platform_rotation = Matrix3::Identity();  ///< of the platform at the leg's zero posture
  Attachment attachment = Attachment::rigid;
};

/// A mechanism, built once from a description and never changed: legs of joints that carry one platform.
/// Postures, and through them every other question, come from `solve_forward` and `solve_inverse`.
class Mechanism {
 public:
  /// REQUIRES: `validate(description)` and `beam_problems(description)` find nothing.
  explicit Mechanism(const Description& description);

  const std::string& name() const { return name_; }
  int active_count() const { return static_cast<int>(active_joints_.size()); }
  int joint_count() const { return static_cast<int>(joints_.size()); }
  /// Which components of the twist (vx, vy, vz, wx, wy, wz) the platform may have: the rows of the Jacobian, of
  /// tool velocities and of tool forces, in this order.
  std::span<const int> tool_axes() const;
  /// Rows of the Jacobian: 3 for a platform that only translates, 2 for a point of a plane, 6 for a rigid one.
  int tool_rows() const { return static_cast<int>(tool_axes().size()); }
  /// How many of the rows, the first ones, are linear.
  int linear_rows() const;
  /// The platform may turn.
  bool tool_turns() const { return linear_rows() < tool_rows(); }
  /// A tool vector as all six components, zero where the platform has no freedom.
  Vector6 six_components(const ToolVector& rows) const;

  PlatformFreedom platform() const { return platform_; }
  const std::vector<JointModel>& joints() const { return joints_; }
  const std::vector<LegModel>& legs() const { return legs_; }
  const std::vector<BodyModel>& bodies() const { return bodies_; }
  const std::vector<BeamModel>& beams() const { return beams_; }  ///< in the order of their joints
  const std::vector<std::string>& joint_names() const { return joint_names_; }  ///< "LEG/JOINT"
  const std::vector<std::string>& active_names() const {
    return active_names_;
  }  ///< "JOINT" when unique, else "LEG/JOINT"
  /// Index among all joints of active joint `i`.
  int active_joint(int i) const { return active_joints_[i]; }
  Interval active_range(int i) const { return joints_[active_joints_[i]].range; }
  /// Whether the hand alone moves active joint `i`: no drive does, so its torque is always zero.
  bool is_free(int i) const { return joints_[active_joints_[i]].free; }
  /// How many of the active joints drives move: all that are not free.
  int driven_count() const { return driven_count_; }
  /// Values of all active joints from those of the driven ones in their order; free ones are at home.
  /// REQUIRES: driven.size() == driven_count().
  ActiveVector with_free_at_home(const ActiveVector& driven) const;
  /// All joints in a posture that closes the loops, from the description: where the general solver starts.
  const JointVector& home_guess() const { return home_guess_; }
  const Vector3& gravity() const { return gravity_; }  ///< [m/s^2], base frame
  /// Rotor and transmission inertia seen at each active joint [kg m^2]; zero until `set_drive_inertia`.
  const ActiveVector& drive_inertia() const { return drive_inertia_; }
  void set_drive_inertia(const ActiveVector& inertia) { drive_inertia_ = inertia; }
  /// A length that makes rotations comparable with translations and gaps with sizes: the longest link [m].
  double characteristic_length() const { return characteristic_length_; }

  /// Solves in closed form; null where there is none.
  const ClosedForm* closed_form() const { return closed_form_.get(); }
  /// The rows of an arm: one leg whose joints are all active, revolute or prismatic, and whose last link is the
  /// platform. Null for other mechanisms. Its joints are all the mechanism's joints, in order.
  const SerialChain* serial() const { return serial_.get(); }
  /// The delta's lengths, if this is one.
  const std::optional<DeltaGeometry>& delta() const { return delta_; }

 private:
  std::string name_;
  PlatformFreedom platform_ = PlatformFreedom::rigid;
  std::vector<JointModel> joints_;
  std::vector<LegModel> legs_;
  std::vector<BodyModel> bodies_;
  std::vector<BeamModel> beams_;
  std::vector<std::string> joint_names_;
  std::vector<std::string> active_names_;
  std::vector<int> active_joints_;
  int driven_count_ = 0;
  JointVector home_guess_;
  Vector3 gravity_;
  ActiveVector drive_inertia_;
  double characteristic_length_ = 0.0;
  std::shared_ptr<const ClosedForm> closed_form_;  // never changes, so copies share it
  std::shared_ptr<const SerialChain> serial_;
  std::optional<DeltaGeometry> delta_;
};

}  // namespace zwidth
