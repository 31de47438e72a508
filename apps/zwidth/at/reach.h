#pragma once

#include <string>
#include <vector>

#include "goal.h"

/// How `zwidth at` finds the posture that is asked about, and what it says where there is none.

namespace zwidth::at {

struct Found {
  Solution solution;
  std::string reason;               ///< why it is not reached; empty where it is
  std::vector<Solution> solutions;  ///< of --position: every branch
  Goal goal;                        ///< of --position
  bool kept_in_vain = false;        ///< it is the joint kept that it is not reached with

  bool reached() const {
    return solution.status == SolveStatus::reached || solution.status == SolveStatus::degraded;
  }
};

void find_posture(const Model& model, const Arguments& arguments, const Frame& frame, Found& found);

/// "choice": which posture an arm with joints to spare takes.
void write_choice(const Found& found, const Model& model, Answer& answer);
/// "solutions": every branch that brings the tool to the position.
void write_branches(const Found& found, const Model& model, Answer& answer);
/// "nearest_reachable". May add to the reason.
void write_nearest(Found& found, const Model& model, const Arguments& arguments, const Frame& frame,
                   Answer& answer);

}  // namespace zwidth::at
