#pragma once

#include <optional>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/mechanism/figure.h"
#include "zwidth/mechanism/five_bar.h"
#include "zwidth/mechanism/positioning_arm.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/r_cube.h"

namespace zwidth::internal {

/// Asks a mechanism whose tool translates, in space or in a plane, posture after posture. Follows on from the
/// last answer where there is no closed form, so each thread has its own, and the same questions in the same
/// order get the same answers. Making one may take milliseconds: copy one that has not been asked yet.
///
/// A tool in a plane keeps the height of the middle posture whatever z is asked for. Its two joints come with a
/// third of value 0, its Jacobian with a third row and column of the identity, so that one code serves both.
class Probe {
 public:
  /// REQUIRES: !workspace_obstacle(mechanism). The mechanism must outlive the probe.
  explicit Probe(const Mechanism& mechanism);

  struct Answer {
    bool reached = false;              ///< the loops close; the rest means nothing otherwise
    bool on_branch = false;            ///< with the device's assembly and working modes
    bool inside = false;               ///< on the branch, with the joints within their ranges
    Vector3 joints = Vector3::Zero();  ///< active joints [rad]
    Vector3 position = Vector3::Zero();
    Matrix3 jacobian = Matrix3::Zero();
    double leg_singularity = 0.0;  ///< of planar mechanisms of two legs, and R-CUBEs; five-bars: see `figures`
    double platform_singularity = 0.0;  ///< of planar mechanisms of two legs
  };

  Answer inverse(const Vector3& position);
  /// The joint ranges are not looked at for `reached`.
  Answer forward(const Vector3& joints);
  /// Posture of the last inverse question that was reached, for what needs more than the Jacobian.
  std::optional<Posture> posture(const Vector3& position);
  /// Every figure of an answer that was reached, with the defined singularity measures of all but deltas.
  FigureValues figures(const Answer& answer, const DriveLimits& limits) const;

  /// Forgets the last answer.
  void restart() {
    last_.reset();
    arm_start_ = middle();
  }

  const Mechanism& mechanism() const { return *mechanism_; }
  int dimension() const { return dimension_; }  ///< 3, or 2 for a tool in a plane; as many joints
  /// A question costs well under a microsecond.
  bool fast() const { return mechanism_->delta() || r_cube_ || five_bar_ || arm_.arm != nullptr; }
  Interval range(int joint) const { return joint < dimension_ ? mechanism_->active_range(joint) : Interval{}; }
  Vector3 middle() const;  ///< of the joint ranges
  /// A point of n^dimension spread evenly over the joint ranges, ends included. REQUIRES: n > 1.
  Vector3 grid_joints(int index, int n) const;

 private:
  Solution solve_at(const Vector3& position);
  SolveOptions follow() const;
  bool within_ranges(const Vector3& joints) const;
  Answer answer_from(const Posture& posture) const;
  Answer answer_from(const RCubeSolution& solution) const;
  Answer arm_answer(const Vector3& joints) const;
  Answer five_bar_answer(const Vector2& theta, const Vector2& position, const Matrix2& J) const;

  const Mechanism* mechanism_;
  int dimension_ = 3;
  JacobianScale scale_;
  std::optional<RCubeGeometry> r_cube_;
  RCubeBranches r_cube_branches_;
  std::optional<FiveBarGeometry> five_bar_;
  PositioningMemory arm_memory_;
  PositioningForm arm_;                  // of three joints
  Vector3 arm_start_ = Vector3::Zero();  // of its solutions the one nearest to this is asked for
  WorkingMode mode_;
  int assembly_mode_ = 1;
  bool two_cranks_ = false;       // two legs of crank and coupler in a plane
  double modes_[2] = {1.0, 1.0};  // their signs in the middle of the joint ranges
  double height_ = 0.0;           // of a tool in a plane [m]
  Matrix3 rotation_ = Matrix3::Identity();
  // Sign of det J in the middle of the joint ranges; 0 for a mechanism of one leg, which has no loops that a
  // singularity could reassemble: all its postures are its own.
  double branch_ = 1.0;
  std::optional<Posture> middle_;  // in the middle of the joint ranges
  std::optional<Posture> last_;    // that was inside
};

/// Condition number of the Jacobian at a tool position; NaN outside the workspace.
double condition_number(Probe& probe, const Vector3& position);

/// Dimensions that the tool translates in: 2 for a tool in a plane, else 3.
inline int tool_dimension(const Mechanism& mechanism) {
  return mechanism.platform() == PlatformFreedom::planar_translation ? 2 : 3;
}

/// Figures that a sweep of this mechanism gives; with `all` also those beyond kCoreFigureCount.
std::array<bool, kFigureCount> defined_figures(const Mechanism& mechanism, bool all);

/// Whether it is a planar mechanism of two legs with two revolute joints each, as a five-bar.
bool has_two_cranks(const Mechanism& mechanism);

}  // namespace zwidth::internal
