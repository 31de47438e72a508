#pragma once

#include <array>
#include <string_view>

#include "zwidth/math/spatial.h"

namespace zwidth {

/// Figures of one posture that follow from its Jacobian (tool velocity = J x active rate).
enum class Figure {
  condition_number,  ///< largest over smallest singular value of J, 2-norm [-]
  manipulability,    ///< |det J| (Yoshikawa 1985) [m^3/rad^3]
  force_x,           ///< largest pure force along x within the torque limits: min_j limit_j / |J_xj| [N]
  force_y,           ///< same along y [N]
  force_z,           ///< same along z [N]
  weakest_force,     ///< force available in every direction: radius of the ball in the force polytope [N]
  strongest_force,   ///< largest force in any direction: the farthest vertex of the force polytope [N]
  step_x,  ///< tool step along x when every joint moves by its resolution, at worst: sum_j |J_xj| step_j [m]
  step_y,  ///< same along y [m]
  step_z,  ///< same along z [m]
  leg_singularity,       ///< min_i |r_i . b_i|/(d2 d3): 0 where a leg is stretched or folded; deltas only [-]
  platform_singularity,  ///< |det R|/d3^3: 0 where the forearms are coplanar; deltas only [-]
};

inline constexpr int kFigureCount = 12;
/// The figures up to here are what every map computes; the later ones are asked for.
inline constexpr int kCoreFigureCount = 5;

/// One value per figure, indexed by `Figure`.
using FigureValues = std::array<double, kFigureCount>;

inline double figure(const FigureValues& values, Figure which) {
  return values[static_cast<int>(which)];
}

struct FigureInfo {
  std::string_view name;     ///< as the enumerator, used as key and column name
  std::string_view unit;     ///< SI; "1" for pure numbers
  std::string_view meaning;  ///< one phrase
};

/// REQUIRES: 0 <= index < kFigureCount.
const FigureInfo& figure_info(int index);

/// What the figures need to know about the drives, per active joint.
struct DriveLimits {
  Vector3 torque = Vector3::Ones();  ///< largest torque of each active joint, positive [N m]
  Vector3 step = Vector3::Zero();    ///< resolution of each active joint [rad]
};

/// Figures of a 3 x 3 Jacobian [m/rad], all but the two singularity measures, which are set to zero.
/// At a singularity the condition number and the forces are infinite.
FigureValues jacobian_figures(const Matrix3& jacobian, const DriveLimits& limits);

}  // namespace zwidth
