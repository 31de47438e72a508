#pragma once

#include "zwidth/mechanism/internal/closure.h"
#include "zwidth/mechanism/internal/newton.h"

/// Closing the loops of a mechanism at given active joints, led from a start by small steps, so that it stays
/// on the branch (assembly mode) of the start. Two things tell of a step that left it: Newton's second
/// correction, which is small against the first one wherever the answer nearby is the only one, and the sign of
/// the closure's determinant, which the branches that meet in a singularity do not share.

namespace zwidth::internal {

/// A posture at the home guess, loops not yet closed: the platform where the legs' tips say on average.
Posture at_home_guess(const Mechanism& mechanism);

/// Closes the loops of `posture` at its active joints by moving passive joints and platform. `closure` is left
/// as the last step had it, factored at or next to the answer.
Newton close_loops(Posture& posture, double tolerance, int limit, Budget& budget, Closure& closure);

/// Leads `posture`, closed at its active joints, to other ones without passing a singularity. On failure it is
/// left where it failed.
Newton lead_active(Posture& posture, const ActiveVector& target, double tolerance, Budget& budget,
                   Closure& closure);

/// The same by a way that goes round the other side with some of them: all by the shorter way, or one of them
/// the other way than straight. Only joints whose range is a whole turn may.
Newton lead_round(Posture& posture, const ActiveVector& target, double tolerance, int limit, Budget& budget,
                  Closure& closure);

/// Whether the loops close at joint values that could not be led to: beyond a singularity, that is. `posture`
/// is where leading failed, and is changed.
bool closes_elsewhere(Posture& posture, const ActiveVector& active, double tolerance);

}  // namespace zwidth::internal
