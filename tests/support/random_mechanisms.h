#pragma once

#include <cstdint>
#include <string>

#include "zwidth/description/description.h"

namespace zwidth::test {

/// A mechanism of legs that nobody designed: one to four legs (six of some kinds) of revolute, prismatic and
/// parallelogram joints, some of them active, that close at their zero posture, with a body on every link.
struct RandomMechanism {
  std::string kind;  ///< "planar, rigid legs", ...
  Description description;
};

/// The same for the same seed; kinds follow each other as seeds do. It is properly constrained, by `mobility`,
/// and its zero posture is no singularity. Link random_mechanisms.cpp.
RandomMechanism random_mechanism(std::uint64_t seed);

/// Kinds that there are: so many seeds in a row have one of each.
int random_mechanism_kinds();

}  // namespace zwidth::test
