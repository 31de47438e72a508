#pragma once

#include <string>

#include "terminal.h"

#include "zwidth/analysis/data_sheet.h"

namespace zwidth {

/// A data sheet for a terminal, without the notes about files.
std::string data_sheet_text(const DataSheet& sheet, const Description& description, const Terminal& terminal);

/// "K < 5: 81 %, 5 to 10: 12 %, ...".
std::string shares_by_class(const GlobalConditioning& conditioning);

/// "12.3 %": of a workspace, where the condition number is below `kNearIsotropic`.
std::string near_isotropic_share(const GlobalConditioning& conditioning);

/// Unit that the manipulability of so many linear rows is shown in, and its factor from SI: sliding joints take
/// metres instead of radians.
std::string manipulability_unit(const Mechanism& mechanism, int rows, double& factor);

/// "leg singularity" of "leg_singularity".
std::string in_words(std::string_view key);

}  // namespace zwidth
