#pragma once

#include <optional>
#include <string>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/analysis/posture_sweep.h"

/// Stiffness of a device at its tool, and how fast that lets it vibrate, over its postures.

namespace zwidth {

/// What gives way in the figures.
enum class Elasticity {
  links,   ///< drives count as rigid: the stiffness of some is not known
  drives,  ///< links count as rigid: none is a beam
  both,
};
/// "links", "drives", "links and drives".
const char* to_string(Elasticity elasticity) noexcept;

/// How much of the tool's give one part accounts for.
struct GiveShare {
  bool drive = false;  ///< or a link
  std::string name;    ///< "LEG/JOINT" of a link, the active joint of a drive
  double share = 0.0;  ///< of the give along the tool's linear axes, over all postures
};

/// Over postures spread evenly over the joint ranges; motors stand still, the tool may turn as it likes.
struct StiffnessSheet {
  Elasticity of = Elasticity::links;
  std::int64_t postures = 0;              ///< whose loops closed, and whose tool was held
  std::array<PostureStatistic, 3> along;  ///< force per displacement along x, y, z [N/m]
  PostureStatistic softest, stiffest;     ///< by direction [N/m]
  PostureStatistic lowest_held;           ///< lowest natural frequency [rad/s]; empty if masses are not known
  PostureStatistic lowest_free;           ///< the same, rotors swinging against the tool; empty without drives
  std::vector<GiveShare> shares;          ///< largest first
};

/// Nothing where neither links nor drives are known to give (`Stiffness::rigid`), or the tool only turns.
/// `drives`: one per active joint, where there is one.
std::optional<StiffnessSheet> stiffness_sheet(const Mechanism& mechanism,
                                              const std::vector<std::optional<Drive>>& drives,
                                              std::int64_t samples = 1000);

}  // namespace zwidth
