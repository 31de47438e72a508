#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "context.h"

#include "zwidth/mechanism/sizes.h"

namespace zwidth {

/// What `zwidth size` was asked about a device whose joints cylinders move.
struct PneumaticSizeRequest {
  std::vector<LoadDescription> loads;  ///< that the device exerts on the hand; none asks for what it can hold
  std::optional<Vector3> position;     ///< of the tool [m]
  /// Names, and values of all active joints. Without these and a position the whole workspace is looked at.
  std::vector<std::pair<std::string, ActiveVector>> postures;
  bool json = false;
};

/// Prints the answer; kNo if the cylinders do not suffice or the position cannot be reached. Throws InputError
/// where a joint that is not free has no cylinder, InvalidDrive.
int size_pneumatic(const Description& description, const PneumaticSizeRequest& request,
                   const Terminal& terminal);

}  // namespace zwidth
