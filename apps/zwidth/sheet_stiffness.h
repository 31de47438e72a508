#pragma once

#include <string>
#include <vector>

#include "context.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/description/description.h"

/// What a data sheet says of stiffness and vibration, for the terminal, the page and programs; and, where a
/// source does not give enough, that it does not.

namespace zwidth {

/// Rows of `statistic_cells` with quantiles. Empty without a stiffness.
std::vector<std::vector<std::string>> stiffness_rows(const DataSheet& sheet);
/// "over a lattice of 5.00 mm": what those rows are over.
std::string stiffness_over(const DataSheet& sheet);

/// Which parts give way, and by what share: "44 % leg1/elbow1, 30 % leg1/swing1, ...".
std::string give_text(const StiffnessSheet& stiffness);

/// How the figures came about, in a sentence.
std::string stiffness_how(const StiffnessSheet& stiffness);

/// What is missing, in a sentence each.
std::vector<std::string> not_given(const DataSheet& sheet);

/// Moduli of laminated links by both rules, in a sentence each.
std::vector<std::string> laminate_texts(const Description& description);

Json stiffness_json(const StiffnessSheet& stiffness);
Json laminates_json(const Description& description);

}  // namespace zwidth
