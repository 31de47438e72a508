#pragma once

#include <array>
#include <limits>

#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/serial_chain.h"

namespace zwidth::internal {

/// Joint values that bring the tool of a serial arm to a goal, found by iteration.
struct ArmAnswer {
  bool found = false;
  ActiveVector joints;     ///< [rad] or [m]
  double objective = 0.0;  ///< what the rule makes small
  bool within = false;     ///< every joint in its range
  double residual = -1.0;  ///< [m, rad x characteristic length]
  int iterations = 0;
};

/// The inverse of any serial arm with joints to spare, for a pose or a position. Every step is the change of
/// the joints that is nearest to a wish and moves the tool as it should, with all joints in their ranges; the
/// wish is none while the goal is not yet met, and then leads along the self-motion to what the rule asks for.
/// Finds the optimum next to where it starts; with several starts the best of them. No heap.
class ArmSolver {
 public:
  /// REQUIRES: mechanism.serial(), which outlives it.
  ArmSolver(const Mechanism& mechanism, const Pose& goal, const SolveOptions& options) noexcept;

  static constexpr int kSeeds = 64;

  /// From the start of the options, then, if that fails and they allow it, from seeded ones. What should be as
  /// large as possible is looked for from the seeds too, unless the options have a start.
  ArmAnswer solve() const noexcept;
  /// From seed number `seed`, 0 for the start of the options, with the joints in their ranges or, `limited`
  /// false, anywhere.
  ArmAnswer solve_from(int seed, bool limited = true) const noexcept;

 private:
  // Angles in rad, slides in characteristic lengths; equations in characteristic lengths.
  using Equations = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using EquationMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, kMaxActive>;
  using Ranges = std::array<Interval, kMaxActive>;

  ActiveVector in_units(const ActiveVector& q) const noexcept { return q.cwiseProduct(unit_); }
  double linearise(const ActiveVector& q, Equations& error, EquationMatrix& J) const noexcept;
  bool step(const EquationMatrix& J, const Equations& error, const ActiveVector& q, const Ranges& ranges,
            double damping, ActiveVector& change) const noexcept;
  bool meet(ActiveVector& q, const Ranges& ranges, int limit, ArmAnswer& answer) const noexcept;
  void improve(ActiveVector& q, const Ranges& ranges, ArmAnswer& answer) const noexcept;
  ActiveVector downhill(const ActiveVector& q) const noexcept;
  double objective(const ActiveVector& q) const noexcept;

  const Mechanism& mechanism_;
  const SerialChain& chain_;
  Pose goal_;
  SolveOptions options_;
  int n_;     // joints
  int rows_;  // of the goal: 6, or 3 of a position
  double length_;
  ActiveVector unit_;   // of each joint: 1 rad, or a characteristic length
  ActiveVector start_;  // in these
  Ranges limits_;       // in these; a kept joint's is its value, one that goes round has none
  Ranges free_;         // none but the kept joint's
};

}  // namespace zwidth::internal
