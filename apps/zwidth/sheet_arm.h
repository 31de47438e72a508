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
};

/// The tables that this sheet has something to say in.
std::vector<PostureTable> arm_tables(const ArmSheet& arm);

/// A line of plain facts.
struct ArmFact {
  std::string name, value, note;
};

/// Where the tool point can be.
std::vector<ArmFact> reach_facts(const ArmSheet& arm);
/// The home posture.
std::vector<ArmFact> home_facts(const ArmSheet& arm, const Mechanism& mechanism);

Json arm_json(const ArmSheet& arm);

}  // namespace zwidth
