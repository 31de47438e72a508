#pragma once

#include <vector>

#include "zwidth/mechanism/posture.h"

/// Which ways a posture loses or gains: inverse, direct and combined singularities (Gosselin & Angeles 1990) of
/// any mechanism of legs.

namespace zwidth {

/// A way of the tool that a posture singles out.
struct SingularDirection {
  /// Unit, rows as `Mechanism::tool_axes`; turning counts as the way of a point at the characteristic length.
  ToolVector direction;
  /// 0 at the singularity. Of a lost direction: the way of the tool over that of the joints it takes, relative
  /// to the easiest direction; of a gained one: how far the closure is from leaving it open, likewise.
  double measure = 0.0;
  /// Of a lost direction: the legs that bar it.
  std::vector<int> legs = {};
};

struct SingularDirections {
  std::vector<SingularDirection> lost;  ///< the tool cannot move there, whatever the joints do; worst first
  std::vector<SingularDirection>
      gained;  ///< the tool moves there although every active joint is held; worst first
};

/// All whose measure is below `tolerance`. A direction that the mechanism never has is not lost. Allocates;
/// costs some 0.1 ms, for it looks at other postures to know what the mechanism has elsewhere.
SingularDirections singular_directions(const Posture& posture, double tolerance = 1e-7);

}  // namespace zwidth
