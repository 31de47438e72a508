#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/sizes.h"

namespace zwidth {

/// What a goal asks of the tool.
enum class Match {
  pose,      ///< position and, if the platform turns, orientation
  position,  ///< the position alone, with any orientation
};

/// What an arm with joints to spare may make as large as possible.
enum class RedundancyFigure {
  manipulability,     ///< sqrt(det(J J^T)) (Yoshikawa 1985)
  inverse_condition,  ///< smallest over largest singular value of J
  limit_distance,     ///< of the joint nearest to an end of its range: 1 in the middle, 0 at the end
};
/// "manipulability", "inverse_condition" or "limit_distance".
std::string_view to_string(RedundancyFigure figure);
std::optional<RedundancyFigure> redundancy_figure_named(std::string_view name);

/// Which of the postures that reach a goal an arm with joints to spare takes. Those within the joint ranges
/// come first, whatever the rule. Arms without a joint to spare do not look at it.
struct Redundancy {
  enum class Rule {
    nearest,   ///< the least change of the joints from the start, angles in rad, slides in characteristic
               ///< lengths
    keep,      ///< one joint has a given value; of what is left, the nearest
    maximise,  ///< a figure is as large as can be
  };
  Rule rule = Rule::nearest;
  int joint = -1;               ///< of keep: index among the active joints
  std::optional<double> value;  ///< of keep [rad] or [m]; left out: the value of the start
  RedundancyFigure figure = RedundancyFigure::manipulability;  ///< of maximise
};

/// The figure of one posture of a serial arm. For a goal of position alone J has only its linear rows; else
/// angular rows are multiplied by `length` [m]. REQUIRES: a column of `jacobian`, a value and a range for each
/// joint; all six rows.
double redundancy_figure(RedundancyFigure figure, Match match, const Jacobian& jacobian,
                         const ActiveVector& joints, std::span<const Interval> ranges, double length) noexcept;

}  // namespace zwidth
