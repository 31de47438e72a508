#pragma once

#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/sizes.h"
#include "zwidth/mechanism/solve_status.h"

namespace zwidth {

struct SolveOptions;

/// What a closed form answers.
struct ClosedPosture {
  SolveStatus status =
      SolveStatus::unreachable;  ///< reached, degraded, unreachable or degenerate; the rest is judged later
  int joint = -1;                ///< joint at fault (index among all joints), -1 if none
  JointVector joints;            ///< all joints of the legs form, empty unless reached [rad] or [m]
  Pose tool;                     ///< platform frame in the base frame
};

/// A family of mechanisms that is solved without iteration. Each family has its own, built once from its
/// description; `solve_forward` and `solve_inverse` use it and judge what it finds. Joint ranges are not its
/// concern.
class ClosedForm {
 public:
  ClosedForm() = default;
  ClosedForm(const ClosedForm&) = delete;
  ClosedForm& operator=(const ClosedForm&) = delete;
  virtual ~ClosedForm() = default;

  /// The posture of the active joints in the device's own assembly mode.
  virtual ClosedPosture forward(const ActiveVector& active) const noexcept = 0;

  /// Number of solutions of the inverse problem that there may be; 0 where it has no closed form.
  virtual int branch_count() const noexcept = 0;

  /// Whether `inverse` answers what these options ask for; where not, the general solver does.
  virtual bool covers(const SolveOptions& options) const noexcept;

  /// Solution `branch` that brings the tool to a pose; 0 is the device's own, or for a redundant arm the one
  /// that `options` choose. REQUIRES: covers(options), 0 <= branch < branch_count().
  virtual ClosedPosture inverse(const Pose& tool, const SolveOptions& options, int branch) const noexcept = 0;
};

}  // namespace zwidth
