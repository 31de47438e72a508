#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/analysis/force.h"
#include "zwidth/description/catalogue.h"
#include "zwidth/mechanism/posture.h"

/// What loads in postures ask of the drives, what the drives have, and which parts of the catalogue would do.

namespace zwidth {

/// A posture looked at, and what to call it.
struct SizingPosture {
  std::string name;
  Posture posture;
};

/// Torques of one load in one posture.
struct SizingCase {
  int posture = 0;
  int load = 0;
  ActiveVector torque;   ///< that holds load and weight [N m, N]
  ActiveVector gravity;  ///< of it for the weight alone
};

/// The most that loads of one kind ask of one joint.
struct JointDemand {
  double torque = 0.0;     ///< with its sign [N m, N]
  double available = 0.0;  ///< that way [N m, N], not negative
  double utilisation =
      0.0;           ///< |torque|/available; infinite where nothing is available, 0 where nothing is asked
  bool ok = true;    ///< utilisation <= 1, but for rounding (a part in 10^9)
  int posture = -1;  ///< where, -1 without a load of this kind
  int load = -1;     ///< under which
};

struct Sizing {
  std::vector<SizingCase> cases;        ///< load after load in the first posture, and so on
  std::vector<JointDemand> continuous;  ///< per active joint
  std::vector<JointDemand> peak;        ///< per active joint
  bool ok = true;                       ///< all of them

  const std::vector<JointDemand>& demands(LoadKind kind) const {
    return kind == LoadKind::peak ? peak : continuous;
  }
};

/// What the drives may give in a posture, for loads of a kind.
using Capability = std::function<TorqueRange(const Posture&, LoadKind)>;

/// Of electric drives, the same in every posture; zero for a joint without one.
Capability capability_of(const std::vector<std::optional<Drive>>& drives);

struct SizingOptions {
  bool gravity = true;  ///< count the weight of the bodies; a source that takes its device as balanced does not
};

/// Of a joint without a drive (`Mechanism::is_free`) the hand bears the weight; a load that needs it cannot be
/// had. REQUIRES: at least one posture and one load, all postures of one mechanism.
Sizing size_drives(std::span<const SizingPosture> postures, std::span<const LoadDescription> loads,
                   const Capability& capability, const SizingOptions& options = {});

/// What a joint torque asks of every element of a drive, for ever or for a short time, as far as the data go.
std::vector<Margin> load_margins(const Drive& drive, double joint_torque, LoadKind kind);

/// Margins of a drive that fail however hard it is driven: a supply that the amplifier does not take, a joint
/// that turns farther than the sector carries cable.
std::vector<Margin> standing_failures(const Drive& drive);

/// Asked of one drive: the largest joint torques, both zero or more [N m].
struct DriveDemand {
  double continuous = 0.0;
  double peak = 0.0;
};

/// The drive with other parts of the catalogue.
struct DriveCandidate {
  std::string kind;   ///< what is replaced: "motor", "gearhead", "motor and gearhead", "amplifier", "cable"
  std::string name;   ///< of the parts, with " + " between two
  bool used = false;  ///< the drive has it already
  bool fits = false;  ///< everything that is asked can be had
  double continuous = 0.0;         ///< joint torque that it could hold [N m]; 0 if it cannot be built
  double peak = 0.0;               ///< for a short time [N m]
  double reflected_inertia = 0.0;  ///< felt at the joint [kg m^2]
  double utilisation = 0.0;        ///< of what is asked most; infinite if it cannot be built
  std::string reason;  ///< the limit that it breaks most, or why it cannot be built; empty if it fits
};

/// Each motor, gearhead, amplifier and cable of the catalogue in the drive's place for it, and each pair of
/// motor and gearhead, all else kept (supply, gains, peak factor, geometry). Kind by kind; in a kind, those
/// that fit first, the least reflected inertia before the others; then the others, the nearest to fitting
/// first.
std::vector<DriveCandidate> drive_candidates(const Drive& drive, const Catalogue& catalogue,
                                             const DriveDemand& demand);

/// The least ratio at which the drive's motor and amplifier, with the transmission's efficiency, give what is
/// asked; empty if its transmission has no ratio of its own to choose (direct).
std::optional<double> least_ratio(const Drive& drive, const DriveDemand& demand);

}  // namespace zwidth
