#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/workspace.h"

/// How evenly a device moves its tool over the whole workspace, by the condition number K of its Jacobian.

namespace zwidth {

/// Over the lattice points in the workspace, each of which stands for an equal volume, or area in a plane.
struct WorkspaceConditioning {
  double spacing = 0.0;       ///< of the lattice [m]
  std::int64_t inside = 0;    ///< lattice points in the workspace
  bool complete = true;       ///< false if it was cancelled
  GlobalConditioning of_all;  ///< every point with the same weight
};
/// The same for any number of threads. REQUIRES: !workspace_obstacle(mechanism), spacing > 0. Throws
/// std::length_error as `sweep_workspace`.
WorkspaceConditioning sweep_conditioning(const Mechanism& mechanism, double spacing, const Effort& effort = {});

/// Where a tool in a plane is moved evenly: K below a limit.
struct DexterousRegion {
  double limit = 5.0;             ///< on K
  double area = 0.0;              ///< [m^2]
  double error_estimate = 0.0;    ///< [m^2]
  double spacing = 0.0;           ///< between points of the outlines [m]
  std::vector<Outline> outlines;  ///< [m]
  /// Radii of the widest band of circles about the base origin that lie in the region with their whole
  /// circumference [m]; none if there is no such circle. Parts that are left out of the region are seen if they
  /// are wider than the spacing.
  std::optional<Interval> annulus;
};
/// REQUIRES: !workspace_obstacle(mechanism), a tool in a plane, limit > 1, points > 2 along the longer side.
DexterousRegion dexterous_region(const Mechanism& mechanism, const Extents& extents, double limit = 5.0,
                                 int points = 401);

}  // namespace zwidth
