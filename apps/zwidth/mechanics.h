#pragma once

#include <string>
#include <vector>

#include "model.h"
#include "sheet_figures.h"
#include "sheet_json.h"
#include "terminal.h"

#include "zwidth/analysis/mechanical.h"

/// Stiffness, apparent mass and natural frequencies over a workspace, for people and as JSON.

namespace zwidth {

/// "N/mm", "g", "Hz", with the factor from SI.
struct ShownUnit {
  const char* unit;
  double factor;
};
/// `slides`: every joint does.
ShownUnit shown_unit(MechanicalFigure which, bool slides = false);

/// A row of `statistic_cells` per figure that is known.
std::vector<std::vector<std::string>> mechanics_rows(const MechanicalSweep& sweep);
std::vector<std::vector<std::string>> mechanics_rows(const MechanicalPostures& sweep);
/// Of what holds the device's own weight: torques, forces, or of joints of both kinds the largest number.
ShownUnit gravity_unit(const std::vector<bool>& joint_slides);
/// "torque against gravity".
std::string gravity_label(const std::vector<bool>& joint_slides);
/// Whether it has anything to say of these rows: apparent masses, and the torque or force against gravity.
bool knows_inertia(const MechanicalSweep& sweep);
std::vector<std::vector<std::string>> inertia_rows(const MechanicalSweep& sweep,
                                                   const std::vector<bool>& joint_slides);
/// Where the tool is softest and heaviest, and where it vibrates slowest: name, value and place.
struct MechanicsPlace {
  std::string name, value, place;
};
std::vector<MechanicsPlace> mechanics_places(const MechanicalSweep& sweep, bool in_plane);
/// Sentences: what gives, and what the source does not give.
std::vector<std::string> mechanics_notes(const std::optional<Elasticity>& of, bool masses, bool frequencies,
                                         bool accelerations);
/// What the drives can accelerate, in a sentence; empty where that is not known.
std::string acceleration_text(const MechanicalSweep& sweep, bool in_plane);

/// Heading, table, places and notes.
void print_mechanics(const MechanicalSweep& sweep, bool in_plane, Sheet& sheet);
void print_mechanics(const MechanicalPostures& sweep, Sheet& sheet);

Json mechanics_json(const MechanicalSweep& sweep);
Json mechanics_json(const MechanicalPostures& sweep);

/// Maps of the heaviest direction, the acceleration, the softest direction and the lowest frequency on the
/// cuts, as far as they are known.
std::vector<SheetFigure> mechanics_figures(const std::vector<MechanicalCut>& cuts);

}  // namespace zwidth
