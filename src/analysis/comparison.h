#pragma once

#include <optional>
#include <string>
#include <vector>

#include "zwidth/analysis/workspace.h"

/// What two devices reach, in one base frame.

namespace zwidth {

/// Why a mechanism cannot be compared, as a phrase; nothing if it can.
std::optional<std::string> comparison_obstacle(const Mechanism& mechanism);
/// The axes that its tool point is compared along: 0 x, 1 y, 2 z. REQUIRES: !comparison_obstacle(mechanism).
std::vector<int> comparison_axes(const Mechanism& mechanism);

/// An area [m^2] or a volume [m^3], with its standard error.
struct Measure {
  double value = 0.0;
  double error = 0.0;
};

/// Where the tool points of two devices can be, in any orientation of tools that turn; counted on common cells.
/// The errors come from how the sublattices of every second cell differ; a flat side along the cells may err by
/// half a spacing more.
struct WorkspaceComparison {
  int dimension = 3;     ///< 2: areas, 3: volumes
  double spacing = 0.0;  ///< of the cells [m]
  bool complete = true;  ///< false if it was cancelled
  Measure first;         ///< reached by the first device
  Measure second;        ///< by the second
  Measure both;          ///< by both
  Measure only_first;    ///< by the first alone
  Measure only_second;   ///< by the second alone

  /// first/second - 1: what the first has more.
  double gain() const { return first.value / second.value - 1.0; }
};

struct ComparisonOptions {
  double spacing = 0.0;                      ///< [m]; 0: a round number that suits the sizes of both
  std::int64_t reach_postures = 10'000'000;  ///< drawn for each arm, see `reach_map`
  std::optional<Matrix3> orientation;        ///< platforms that turn stay in this one, from home
};

/// REQUIRES: both can be answered for, their axes are the same; spacing >= 0. Throws
/// std::length_error if a spacing asks for too many cells.
WorkspaceComparison compare_workspaces(const Mechanism& first, const Mechanism& second,
                                       const ComparisonOptions& options = {}, const Effort& effort = {});

}  // namespace zwidth
