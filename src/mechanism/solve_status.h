#pragma once

namespace zwidth {

/// What solving for a posture came to. Ordered from good to bad.
enum class SolveStatus {
  reached,      ///< loops closed, well conditioned, within the joint ranges
  degraded,     ///< loops closed, but near a singularity: rates and forces along one direction mean little
  joint_limit,  ///< loops closed, but a joint is outside its range
  degenerate,   ///< the equations leave the answer open (a free angle, coincident centres)
  unreachable,  ///< the loops do not close
};

/// "reached", "degraded", ...
const char* to_string(SolveStatus status) noexcept;

}  // namespace zwidth
