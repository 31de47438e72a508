#pragma once

#include <string>
#include <vector>

#include "context.h"

#include "zwidth/analysis/data_sheet.h"

/// What a data sheet says of a device whose tool turns as well as moves, for the terminal, the page and
/// programs.

namespace zwidth {

/// A line of a table of least, mean and most.
struct PostureRow {
  std::string name;
  const PostureStatistic* statistic = nullptr;
  double factor = 1.0;  ///< from SI to the unit shown
  std::string unit;
};

/// A table, and how its numbers came about.
struct PostureTable {
  std::string id;  ///< of its section in the page
  std::string title;
  std::string how;
  std::vector<PostureRow> rows;  ///< none of them empty
  bool quantiles = false;        ///< shows median and 95th percentile instead of the mean
};

/// The tables that this sheet has something to say in.
/// REQUIRES: sheet.arm. They point into the sheet.
std::vector<PostureTable> arm_tables(const DataSheet& sheet, const Mechanism& mechanism);

/// A line of plain facts.
struct ArmFact {
  std::string name, value, note;
};

/// Where the tool point can be.
std::vector<ArmFact> reach_facts(const ArmSheet& arm, const Mechanism& mechanism);
/// How the tool can be turned at a place.
struct PlaceOrientations {
  Vector3 position = Vector3::Zero();  ///< [m]
  OrientationsAt turning;
};
/// In the home posture, if the sheet says.
std::optional<PlaceOrientations> home_turning(const ArmSheet& arm);
/// How the tool can be turned, at one place and over all; empty for arms that have no choice.
std::vector<ArmFact> orientation_facts(const std::optional<OrientationWorkspace>& workspace,
                                       const std::optional<PlaceOrientations>& place);
/// Where a platform that turns can be in one orientation, and how it can be turned at one place.
std::vector<ArmFact> pose_facts(const PoseWorkspace& workspace);
std::vector<ArmFact> turning_facts(const TurningRange& turning);
/// What its drives can exert over those places; empty without drives.
std::vector<ArmFact> pose_load_facts(const PoseWorkspace& workspace);
/// Where it can be in some orientation, and how it can be turned there.
std::vector<ArmFact> any_orientation_facts(const PoseWorkspace& workspace);
/// An orientation as roll, pitch and yaw.
std::string orientation_text(const Matrix3& rotation);
/// The home posture.
std::vector<ArmFact> home_facts(const ArmSheet& arm, const Mechanism& mechanism);

/// REQUIRES: sheet.arm.
Json arm_json(const DataSheet& sheet);
/// Where the tool point can be, and how well conditioned: what `workspace` says. REQUIRES: arm.reach.
Json reach_json(const ArmSheet& arm);
Json pose_json(const PoseWorkspace& workspace);
Json orientations_json(const std::optional<OrientationWorkspace>& workspace);
Json place_json(const PlaceOrientations& place);

}  // namespace zwidth
