#pragma once

#include <vector>

#include "zwidth/mechanism/posture.h"

namespace zwidth {

/// The smallest group of motions that holds those of all joints.
enum class MotionGroup {
  translation,  ///< nothing turns
  planar,       ///< within parallel planes
  spherical,    ///< about one point
  schoenflies,  ///< translations, and turns about parallel axes
  spatial,      ///< any other
};

/// "translation", "planar", ...
const char* to_string(MotionGroup group) noexcept;
/// "of translations", "in the plane", "about a point", "of translations and turns about one direction", "in
/// space".
const char* in_words(MotionGroup group) noexcept;

/// How many degrees of freedom a mechanism has at a posture, and what its active joints make of them.
///
/// A platform that every leg holds rigidly is counted with all six freedoms, whatever it is declared to do: the
/// legs have to see to that. Otherwise its declared freedoms count, for nothing else is known of it.
struct Mobility {
  /// Freedoms of joints and platform less closure equations (Grübler). The equations are those of the group
  /// that the joints move in (Hervé 1978), so that a mechanism in a plane counts as one in space does. Too low
  /// if equations repeat.
  int gruebler = 0;
  int freedoms = 0;             ///< from the rank of the closure at this posture: the true local number
  int tool_freedoms = 0;        ///< of the platform, with the joints free to follow
  int redundant_equations = 0;  ///< closure equations that repeat others: freedoms - gruebler
  int active = 0;               ///< active joints
  int loose = 0;                ///< freedoms that stay when every active joint is held
  int loose_tool = 0;           ///< of the platform among them
  int undeclared = 0;           ///< freedoms that the legs give the platform beyond what it is declared to do
  MotionGroup group = MotionGroup::spatial;
};

/// Counted at one posture by pivoted QR (tolerance 1e-8): the instantaneous freedoms, which at a singular
/// posture are more than the mechanism really has. Allocates.
Mobility mobility(const Posture& posture);

/// Freedoms counted at several postures.
struct MobilitySample {
  int tried = 0;          ///< postures tried: active joints at home, then anywhere in their ranges
  int closed = 0;         ///< of them, those that close the loops
  int singular = 0;       ///< postures counted with more freedoms than `typical`
  int most_freedoms = 0;  ///< at any of them
  /// At the posture with the fewest freedoms. Where others nearby have as many, the rank of the closure keeps,
  /// and so these are freedoms for finite motions.
  Mobility typical;
  std::vector<Posture> posture;  ///< that one; empty if none closes
};

/// Counts at the home posture and at `random` further ones, the same ones every time. Where the active joints
/// cannot be chosen freely, at postures near home that close. Allocates. The mechanism must outlive the result.
MobilitySample sample_mobility(const Mechanism& mechanism, int random = 50);

/// Joints (indices among all) that move at `posture` although every active joint is held. Allocates.
std::vector<int> loose_joints(const Posture& posture);

/// Active joints (indices among the active ones) that those before them already decide at `posture`. Allocates.
std::vector<int> decided_joints(const Posture& posture);

/// What looking for a posture came to.
struct Assembly {
  bool found = false;   ///< a posture closes the loops with every joint in its range
  bool closes = false;  ///< one closes them, be the joints where they may
  int tried = 0;        ///< starts of the search
  double gap = 0.0;     ///< the least that stays open where nothing closes [m, rad x characteristic length]
  int outside =
      -1;  ///< where one closes only so: the joint (index among all) that is farthest out of its range
  double needed = 0.0;           ///< its value there [rad] or [m]
  bool from_home = false;        ///< the solvers find it from the home guess
  std::vector<Posture> posture;  ///< the one found; empty if there is none
};

/// Looks at the home posture, then at others, the same ones every time. Allocates.
Assembly find_assembly(const Mechanism& mechanism);

}  // namespace zwidth
