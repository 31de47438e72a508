#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/mechanism/five_bar.h"

/// Where a five-bar is singular, as lines in its plane: for figures, and to see what a working mode avoids.

namespace zwidth {

enum class FiveBarCurveKind {
  left_stretched,    ///< circle of radius r1 + r2 about O1 (6)
  left_folded,       ///< circle of radius |r1 - r2| about O1 (8)
  right_stretched,   ///< about O2 (7)
  right_folded,      ///< (9)
  elbows_coincide,   ///< circles of radius r2 about the two points that both elbows reach
  couplers_aligned,  ///< the tool midway between elbows that are 2 r2 apart
};
/// "left leg stretched", "elbows coincide", ...
const char* to_string(FiveBarCurveKind kind);
/// Inverse singularities bound the workspace; direct ones lie in it.
constexpr bool is_direct(FiveBarCurveKind kind) {
  return kind == FiveBarCurveKind::elbows_coincide || kind == FiveBarCurveKind::couplers_aligned;
}

/// One connected piece of a singular curve.
struct FiveBarCurve {
  FiveBarCurveKind kind = FiveBarCurveKind::left_stretched;
  bool closed = false;                        ///< the last point joins the first, which is not repeated
  std::vector<std::array<double, 2>> points;  ///< on the curve to rounding [m]
};

struct FiveBarCurveOptions {
  std::optional<WorkingMode> mode;                  ///< only where the posture is in this mode; none: in any
  std::array<Interval, 2> ranges = kAnyCrankAngle;  ///< of the cranks, in that mode; not looked at without one
  int points_per_turn = 720;                        ///< of each curve's parameter
};

/// All pieces, by kind. Where a leg is straight the modes merge and belong to both. Empty if the lengths cannot
/// be assembled.
std::vector<FiveBarCurve> singular_curves(const FiveBarGeometry& geometry,
                                          const FiveBarCurveOptions& options = {});

}  // namespace zwidth
