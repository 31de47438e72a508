#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/mechanism/delta.h"
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
};

/// A rigid body fixed to the link that one joint moves.
struct BodyModel {
  int joint = -1;                     ///< index in `Mechanism::joints()`, -1 for the platform
  double mass = 0.0;                  ///< [kg]
  Vector3 centre = Vector3::Zero();   ///< from the joint's point (or the platform's origin), link frame [m]
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre, link frame [kg m^2]
};

struct LegModel {
  int first = 0;                  ///< index of its first joint
  int count = 0;                  ///< number of joints
  Vector3 tip = Vector3::Zero();  ///< from the last joint's point to the attachment, last link's frame [m]
  Vector3 platform_point = Vector3::Zero();  ///< attachment in the platform frame [m]
  Attachment attachment = Attachment::rigid;
};

/// A mechanism, built once from a description and never changed: legs of joints that carry one platform.
/// Postures, and through them every other question, come from `solve_forward` and `solve_inverse`.
class Mechanism {
 public:
  /// REQUIRES: `validate(description)` finds nothing.
  explicit Mechanism(const Description& description);

  const std::string& name() const { return name_; }
  int active_count() const { return static_cast<int>(active_joints_.size()); }
  int joint_count() const { return static_cast<int>(joints_.size()); }
  /// Rows of the Jacobian: 3 for a platform that only translates, 6 otherwise.
  int tool_rows() const { return platform_ == PlatformFreedom::translation ? 3 : 6; }

  PlatformFreedom platform() const { return platform_; }
  const std::vector<JointModel>& joints() const { return joints_; }
  const std::vector<LegModel>& legs() const { return legs_; }
  const std::vector<BodyModel>& bodies() const { return bodies_; }
  const std::vector<std::string>& joint_names() const { return joint_names_; }  ///< "LEG/JOINT"
  const std::vector<std::string>& active_names() const {
    return active_names_;
  }  ///< "JOINT" when unique, else "LEG/JOINT"
  /// Index among all joints of active joint `i`.
  int active_joint(int i) const { return active_joints_[i]; }
  Interval active_range(int i) const { return joints_[active_joints_[i]].range; }
  /// All joints in a posture that closes the loops, from the description: where the general solver starts.
  const JointVector& home_guess() const { return home_guess_; }
  const Vector3& gravity() const { return gravity_; }  ///< [m/s^2], base frame
  /// Rotor and transmission inertia seen at each active joint [kg m^2]; zero until `set_drive_inertia`.
  const ActiveVector& drive_inertia() const { return drive_inertia_; }
  void set_drive_inertia(const ActiveVector& inertia) { drive_inertia_ = inertia; }
  /// A length that makes rotations comparable with translations and gaps with sizes: the longest link [m].
  double characteristic_length() const { return characteristic_length_; }

  /// The delta's lengths, if this is one: the closed forms then apply.
  const std::optional<DeltaGeometry>& delta() const { return delta_; }

 private:
  std::string name_;
  PlatformFreedom platform_ = PlatformFreedom::rigid;
  std::vector<JointModel> joints_;
  std::vector<LegModel> legs_;
  std::vector<BodyModel> bodies_;
  std::vector<std::string> joint_names_;
  std::vector<std::string> active_names_;
  std::vector<int> active_joints_;
  JointVector home_guess_;
  Vector3 gravity_;
  ActiveVector drive_inertia_;
  double characteristic_length_ = 0.0;
  std::optional<DeltaGeometry> delta_;
};

}  // namespace zwidth
