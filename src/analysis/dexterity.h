#pragma once

#include <array>
#include <span>

#include "zwidth/mechanism/jacobian.h"

/// How evenly a mechanism moves its tool, from Jacobians alone. `dexterity` (mechanism/jacobian.h) gives the
/// figures of one Jacobian whose rows are all of one kind; here are those that compare rows of two kinds, and
/// postures.

namespace zwidth {

/// What the rows and columns of a Jacobian are measured in.
struct JacobianUnits {
  int linear_rows = 3;          ///< the first rows are linear, the others angular
  unsigned sliding_joints = 0;  ///< bit j is set where active joint j slides

  bool slides(int joint) const { return (sliding_joints >> joint & 1U) != 0; }
  /// Whether rows and columns are all of one kind, so that singular values mean something as they are.
  bool homogeneous(const Jacobian& jacobian) const;
};
/// Of the Jacobians of a mechanism.
JacobianUnits jacobian_units(const Mechanism& mechanism);

/// The dimensionally homogeneous Jacobian: angular rows and the columns of sliding joints multiplied by a
/// length [m], so that every entry is a length (Angeles 2002). REQUIRES: length > 0.
Jacobian homogeneous(const Jacobian& jacobian, const JacobianUnits& units, double length);

/// A length that makes rotations comparable with translations.
struct CharacteristicLength {
  double length = 0.0;            ///< [m]
  double conditioning = 0.0;      ///< the figure that it makes largest: 1 is isotropic, 0 singular
  double condition_number = 0.0;  ///< 1/conditioning
};

/// The length with the smallest condition number of the homogeneous Jacobian. 1 m where the units are
/// homogeneous already, or every length leaves it singular. With fewer joints than rows that of the motions
/// which there are: the largest singular value over the smallest of as many as there are joints.
CharacteristicLength characteristic_length(const Jacobian& jacobian, const JacobianUnits& units);

/// One length for many postures: the largest mean of 1/(condition number).
CharacteristicLength characteristic_length(std::span<const Jacobian> jacobians, const JacobianUnits& units);

/// What makes the Jacobians of one device homogeneous: the one rule behind every condition number that is said
/// of it, at a posture, on a map, in a data sheet and in a study. A length of the device, not of the posture,
/// so that condition numbers at two places compare; that of each posture by itself (above) would make every one
/// look as good as it can.
struct JacobianScale {
  JacobianUnits units;
  bool mixed = false;   ///< rows or columns are of two kinds; else the length changes no condition number
  double length = 1.0;  ///< [m], the device's characteristic length; 1 m unless mixed

  /// REQUIRES: rows as `Mechanism::tool_axes`.
  Jacobian homogeneous(const Jacobian& tool) const { return zwidth::homogeneous(tool, units, length); }
  /// Of linear rows alone, or of angular rows alone: joints that slide and joints that turn made comparable.
  Jacobian homogeneous_rows(const Jacobian& rows) const;
  /// Largest over smallest singular value of the homogeneous Jacobian, of a tool with fewer freedoms than rows
  /// over those that it has; infinity if it is singular.
  double condition_number(const Jacobian& tool) const;
  /// Of linear rows alone, or of angular rows alone.
  double rows_condition_number(const Jacobian& rows) const;
};
/// The length with the largest mean of 1/(condition number) over postures spread evenly over the ranges of the
/// driven joints, those that the hand moves at home (Angeles 2002). Takes some milliseconds if the units are
/// mixed, else none.
JacobianScale jacobian_scale(const Mechanism& mechanism);

/// Geometric over arithmetic mean of the eigenvalues of J J^T, between 0 (singular) and 1 (isotropic)
/// (Kim & Khosla 1991); of J^T J where joints are fewer. Rows of one kind, or a homogeneous Jacobian.
double isotropy(const Jacobian& jacobian);

/// Classes of the condition number (Singh, Saha & Manivannan, section 4.1): K < 5, 5 <= K <= 10, 10 < K <= 100
/// and beyond.
enum class ConditionClass { below_5, from_5_to_10, from_10_to_100, above_100 };
inline constexpr std::array kConditionClasses = {ConditionClass::below_5, ConditionClass::from_5_to_10,
                                                 ConditionClass::from_10_to_100, ConditionClass::above_100};
ConditionClass condition_class(double condition_number);
/// "K < 5", "5 to 10", "10 to 100", "K > 100".
const char* to_string(ConditionClass condition_class);

/// A tool with a condition number below this moves about as easily every way.
inline constexpr double kNearIsotropic = 2.0;

/// Mean of 1/(condition number) over a workspace: the global conditioning index (Gosselin & Angeles 1991). The
/// condition number itself has no mean: it grows without bound towards a singularity.
class GlobalConditioning {
 public:
  /// Adds a sample; an infinite condition number counts as 0. The weight is the volume (area, ...) of the task
  /// space that the sample stands for: equal on a lattice of the task space, `task_volume` for samples spread
  /// evenly over the joint ranges. REQUIRES: condition_number >= 1, weight >= 0.
  void add(double condition_number, double weight = 1.0);
  void add(const GlobalConditioning& other);

  double weight() const { return weight_; }  ///< of all samples
  double index() const;                      ///< between 0 and 1; 0 without samples
  double worst() const { return worst_; }    ///< smallest 1/(condition number) seen; 1 without samples
  double best() const { return best_; }      ///< largest
  double spread() const;                     ///< standard deviation of 1/(condition number)
  /// Of the whole weight, the part that is near isotropy: with condition numbers below `kNearIsotropic`.
  double near_isotropic() const;
  /// Of the whole weight, the part with condition numbers of a class; 0 without samples.
  double share(ConditionClass condition_class) const;

 private:
  double weight_ = 0.0;
  double mean_ = 0.0;
  double squares_ = 0.0;  // weighted, of differences from the mean
  double worst_ = 1.0;
  double best_ = 0.0;
  double near_weight_ = 0.0;
  std::array<double, kConditionClasses.size()> class_weight_{};
};

/// Task-space volume per volume of the joint space, sqrt(det(J J^T)): the weight of a sample drawn evenly over
/// the joint ranges. Of a redundant arm several postures share a tool position, so that the index is then one
/// over postures, not positions.
double task_volume(const Jacobian& jacobian);

}  // namespace zwidth
