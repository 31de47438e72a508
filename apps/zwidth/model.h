#pragma once

#include <optional>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/description/description.h"
#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/posture.h"

namespace zwidth {

/// A device ready to be asked: its mechanism, with the drives' inertia on the joints, and its drives.
struct Model {
  /// REQUIRES: the description comes from `read_device`.
  explicit Model(const Description& description);

  Description description;
  Mechanism mechanism;
  std::vector<std::optional<Drive>> drives;  ///< of each active joint; empty where the file gives none
  std::vector<std::optional<PneumaticDrive>> pneumatic_drives;  ///< the same, of cylinders

  /// Whether active joint `i` has a drive of either kind, or needs none because the hand moves it.
  bool has_drive(int i) const;
  /// That of all of them.
  bool has_drives() const;
  /// Every active joint has an electric drive.
  bool driven() const;

  // One value per active joint; NaN for a joint without a drive.
  ActiveVector continuous_torque() const;  ///< [N m]
  ActiveVector peak_torque() const;        ///< [N m]
  ActiveVector torque_step() const;        ///< [N m]
  ActiveVector joint_step() const;         ///< [rad]
};

/// A transmission in words.
struct TransmissionText {
  std::string kind;    ///< "cable capstan", "10:1", "gearhead", "direct"
  std::string detail;  ///< the part, say; may be empty
};
TransmissionText transmission_text(const TransmissionDescription& transmission);

/// The reachable tool position nearest to another.
struct NearestPoint {
  Vector3 position = Vector3::Zero();  ///< [m], base frame
  ActiveVector joints;                 ///< [rad] or [m]
  double distance = 0.0;               ///< [m]
};

/// Searches the joint ranges from a raster of starts. Joints that do not matter to the point stay at home, and
/// an arm takes the posture nearest to home. Any finite position. Empty where no start closes the loops.
std::optional<NearestPoint> nearest_reachable(const Mechanism& mechanism, const Vector3& position);

}  // namespace zwidth
