#pragma once

#include <optional>

#include "zwidth/mechanism/sizes.h"

/// Small undamped vibrations of the tool about a posture, from its stiffness and the mass that moves with it.

namespace zwidth {

/// Natural frequencies and what moves in them.
struct Modes {
  ToolVector frequencies;  ///< lowest first [rad/s]
  ToolMatrix shapes;       ///< columns: displacement of the tool in each mode, unit, largest entry positive
};

/// K phi = omega^2 M phi. Nothing unless both are symmetric, equal in size and positive definite.
std::optional<Modes> modes(const ToolMatrix& stiffness, const ToolMatrix& mass) noexcept;

/// The same with the inverse of the mass given, W K phi = omega^2 phi; W may be singular, where some motion has
/// no inertia's limit: then its frequency is 0. Nothing unless K is positive definite and W is not negative.
std::optional<Modes> modes_by_mobility(const ToolMatrix& stiffness, const ToolMatrix& mobility) noexcept;

/// M^-1 K, whose eigenvalues are the squares of the natural frequencies. REQUIRES: M positive definite.
ToolMatrix dynamic_matrix(const ToolMatrix& stiffness, const ToolMatrix& mass) noexcept;

/// Mobility of the tool, J M^-1 J^T: acceleration per force [1/kg, ...]. REQUIRES: M positive definite.
ToolMatrix tool_mobility(const Jacobian& jacobian, const ActiveMatrix& mass) noexcept;

}  // namespace zwidth
