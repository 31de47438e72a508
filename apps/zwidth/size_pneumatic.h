#pragma once

#include <optional>

#include "context.h"

namespace zwidth {

/// What `zwidth size` was asked about a device whose joints cylinders move.
struct PneumaticSizeRequest {
  std::optional<Vector3> load;      ///< that the device exerts on the hand [N]; empty asks for what it can hold
  std::optional<Vector3> position;  ///< of the tool [m]; empty looks at the whole workspace
  bool json = false;
};

/// Prints the answer; kNo if the cylinders do not suffice or the position cannot be reached. Throws InputError
/// where a joint that is not free has no cylinder, InvalidDrive.
int size_pneumatic(const Description& description, const PneumaticSizeRequest& request,
                   const Terminal& terminal);

}  // namespace zwidth
