#pragma once

#include <optional>
#include <span>
#include <vector>

#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/stiffness_sheet.h"
#include "zwidth/mechanism/figure.h"
#include "zwidth/mechanism/stiffness.h"

/// How stiff and how heavy a tool feels, and how fast it vibrates: one posture, and maps of many.

namespace zwidth {

/// Against pure forces: the tool may turn as it likes. Motors stand still for stiffness and the first
/// frequency.
enum class MechanicalFigure {
  stiffness_x,     ///< force per displacement along x [N/m]
  stiffness_y,     ///< along y [N/m]
  stiffness_z,     ///< along z [N/m]
  softest,         ///< in the softest direction [N/m]
  stiffest,        ///< in the stiffest direction [N/m]
  mass_x,          ///< force per acceleration along x while the tool is free to move otherwise [kg]
  mass_y,          ///< along y [kg]
  mass_z,          ///< along z [kg]
  lightest,        ///< in the lightest direction [kg]
  heaviest,        ///< in the heaviest direction [kg]
  frequency_held,  ///< lowest natural frequency of links and platform, motors held [rad/s]
  frequency_free,  ///< the same, rotors swinging against the tool [rad/s]
  acceleration,    ///< that the continuous torques give in every direction, from rest and with the device's own
                   ///< weight; 0 where that takes all of them [m/s^2]
  gravity_torque,  ///< largest that holds the device's own weight, of all joints [N m], of sliding joints [N]
};
inline constexpr int kMechanicalFigureCount = 14;

/// One value per figure, NaN where it is not known or not defined.
using MechanicalValues = std::array<double, kMechanicalFigureCount>;
inline double figure(const MechanicalValues& values, MechanicalFigure which) {
  return values[static_cast<int>(which)];
}

/// REQUIRES: 0 <= index < kMechanicalFigureCount.
const FigureInfo& mechanical_figure_info(int index);

using Drives = std::vector<std::optional<Drive>>;  ///< one per active joint, where there is one

/// Of each active joint's drive where it stands [N m/rad, N/m], infinite for a joint that the hand moves; empty
/// unless all that are needed are known. REQUIRES: one entry of `drives` per active joint.
ActiveVector drive_stiffness(const Posture& posture, const Drives& drives);

/// The stiffness of a posture from all that is known to give, with what it took of the drives.
struct KnownStiffness {
  Stiffness stiffness;
  StiffnessOptions options;
  Elasticity of = Elasticity::links;
};
/// Nothing where neither links nor drives are known to give (`Stiffness::rigid`): the source does not say.
std::optional<KnownStiffness> known_stiffness(const Posture& posture, const Drives& drives);

/// Masses are known if every joint moves some (`drive_inertia` counts), the torque against gravity if anything
/// has mass, frequencies if links and platform alone do, the acceleration if every joint that is not moved by
/// the hand has its drive. Stiffness has no value where the tool is free, nor a mass where it cannot move
/// (beyond a million times the lightest counts as infinite).
MechanicalValues mechanical_figures(const Posture& posture, const Drives& drives);

/// Over the points of a lattice in the workspace. Extremes are led from there to where they are, as by
/// `refine_extremes`. Means of masses and of the largest stiffness do not settle on any lattice where singular
/// postures lie at its edge: medians and percentiles do.
struct MechanicalSweep {
  double spacing = 0.0;  ///< [m]
  std::int64_t inside = 0;
  bool complete = true;
  std::optional<Elasticity> of;  ///< what gives; nothing if the source does not say
  std::array<Statistic, kMechanicalFigureCount> figures;

  const Statistic& operator[](MechanicalFigure which) const { return figures[static_cast<int>(which)]; }
};
/// The same for any number of threads. REQUIRES: !workspace_obstacle(mechanism), spacing > 0.
MechanicalSweep sweep_mechanics(const Mechanism& mechanism, const Drives& drives, double spacing,
                                const Effort& effort = {});

/// Figures at tool positions [m]; NaN outside the workspace. The same for any number of threads; shorter if it
/// was cancelled. REQUIRES: !workspace_obstacle(mechanism).
std::vector<MechanicalValues> map_mechanics(const Mechanism& mechanism, const Drives& drives,
                                            std::span<const Vector3> positions, const Effort& effort = {});

/// Figures on the grid of a cut through the workspace, or on every `stride`-th line of it.
struct MechanicalCut {
  Slice slice;
  int nu = 0, nv = 0;
  Interval u_range, v_range;                                         ///< of the grid points [m]
  std::array<std::vector<double>, kMechanicalFigureCount> values{};  ///< [figure][iv * nu + iu], NaN outside

  const std::vector<double>& operator[](MechanicalFigure which) const {
    return values[static_cast<std::size_t>(which)];
  }
};
/// `map` of this mechanism, from `map_slice`. REQUIRES: stride > 0.
MechanicalCut cut_mechanics(const Mechanism& mechanism, const Drives& drives, const SliceMap& map, int stride,
                            const Effort& effort = {});

/// Adds to a map a column for every figure that has a value somewhere in it. The map is left as it is if that
/// was cancelled, and says so.
void add_mechanics(const Mechanism& mechanism, const Drives& drives, WorkspaceMap& map,
                   const Effort& effort = {});

/// Points in the box of a lattice for such sweeps, whose points cost some 10 us each.
inline constexpr double kMechanicalPoints = 2e4;

/// Over postures spread evenly over the joint ranges, for tools that also turn; as over a lattice.
struct MechanicalPostures {
  std::int64_t solved = 0;       ///< of them the loops closed
  bool complete = true;          ///< false if it was cancelled
  std::optional<Elasticity> of;  ///< what gives; nothing if the source does not say
  std::array<PostureStatistic, kMechanicalFigureCount> figures;

  const PostureStatistic& operator[](MechanicalFigure which) const { return figures[static_cast<int>(which)]; }
};
/// The same for any number of threads.
MechanicalPostures sweep_mechanics_of_postures(const Mechanism& mechanism, const Drives& drives,
                                               std::int64_t samples = 4000, const Effort& effort = {});

}  // namespace zwidth
