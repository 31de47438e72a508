#pragma once

#include <optional>
#include <string>

#include "section.h"

/// What `--position` and the options beside it ask of the tool, and of the joints that this leaves open.

namespace zwidth::at {

struct Goal {
  Pose tool;                    ///< base frame
  bool by_orientation = false;  ///< the orientation counts too
  int spare = 0;                ///< joints of an arm that the goal leaves open
  SolveOptions options;         ///< its start is `near`
  std::optional<Posture> near;  ///< of --near
  std::string near_text = "home";

  Goal() = default;
  Goal(const Goal&) = delete;
  Goal& operator=(const Goal&) = delete;

  /// Which posture an arm with joints to spare takes, in words.
  std::string choice(const Mechanism& mechanism) const;
  /// The same for programs.
  Json choice_json(const Mechanism& mechanism) const;
};

/// What --orientation or --rotation says. REQUIRES: one of them is not empty. Throws InputError.
Matrix3 orientation_given(const std::string& orientation, const std::string& rotation);

/// Reads the options into `goal`, or throws InputError. The mechanism must outlive it.
void read_goal(const Arguments& arguments, const Mechanism& mechanism, const Frame& frame, Goal& goal);

}  // namespace zwidth::at
