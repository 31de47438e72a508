#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "zwidth/analysis/orientation.h"
#include "zwidth/analysis/pose_workspace.h"
#include "zwidth/analysis/reach.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/design/figures.h"

namespace zwidth::internal {

// What takes long and several figures of one device ask for, by the options that decide it.
struct DeviceCache {
  std::optional<Mechanism> turning;  // an arm whose tool turns, of one whose tool counts as a point
  std::optional<Extents> extents;
  std::optional<std::pair<Vector3, OrientationsAt>> turned;  // at the last place asked for
  std::map<std::int64_t, PoseWorkspace> poses;
  std::map<std::int64_t, std::optional<AnyOrientation>> anyhow;
  std::map<std::int64_t, ReachMap> maps;
  std::map<std::pair<double, double>, InscribedShapes> shapes;
  std::map<std::pair<double, int>, DexterousRegion> regions;
  std::map<std::pair<double, int>, OrientationWorkspace> orientations;
};

DeviceCache& cache_of(const BuiltDevice& device);
// The mechanism, its tool turning where it counts as a point.
const Mechanism& turning(const BuiltDevice& device);

}  // namespace zwidth::internal
