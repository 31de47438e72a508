#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "zwidth/design/search.h"
#include "zwidth/design/study_model.h"

namespace zwidth {

/// Whether STUDY names a study, built-in or a file that has a table [study].
bool names_study(const std::string& study);

/// A study and its device, held to all rules. Throws DescriptionError.
std::unique_ptr<StudyModel> read_study_model(const std::string& study,
                                             const std::vector<std::string>& overrides);

/// Evaluates the study's designs on threads of this process, all cores if `threads` is 0. `cancel`: see
/// `WorkerOptions`. The model must outlive it.
BatchEvaluation study_evaluation(const StudyModel& model, int threads, const std::atomic<bool>* cancel);

/// How the study wants to be searched.
SearchOptions study_search_options(const StudyModel& model);

/// A study and what its search found, for verbs that need no more of it than that.
struct StudyRun {
  std::unique_ptr<StudyModel> model;
  SearchProblem problem;
  SearchResult result;

  /// Of the front.
  std::size_t size() const { return result.front.size(); }
  std::span<const double> design(std::size_t front_row) const;
  /// All to be minimised.
  std::span<const double> objectives(std::size_t front_row) const;
};
StudyRun search_study(const std::string& study, const std::vector<std::string>& overrides);

}  // namespace zwidth
