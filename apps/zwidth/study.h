#pragma once

#include <memory>
#include <string>
#include <vector>

#include "zwidth/design/study_model.h"

namespace zwidth {

/// Whether STUDY names a study, built-in or a file that has a table [study].
bool names_study(const std::string& study);

/// A study and its device, held to all rules. Throws DescriptionError.
std::unique_ptr<StudyModel> read_study_model(const std::string& study, const std::vector<std::string>& overrides);

}  // namespace zwidth
