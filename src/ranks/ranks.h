#pragma once

#include <cstddef>

#include "zwidth/design/search.h"

/// A design search on the machines of a cluster: the processes ("ranks") that `mpirun -np N` starts. Rank 0
/// drives and evaluates its share; the others evaluate what it sends them.
///
///     Ranks ranks;
///     if (ranks.drives()) {
///       problem.evaluate = ranks.spread(variables, outcomes, own);
///       search(problem, options);
///     } else {
///       ranks.serve(variables, outcomes, own);
///     }

namespace zwidth {

/// The ranks of this program's MPI job. One object per process, made once: MPI cannot be started twice. All
/// calls from the thread that made it; `own` may use threads as it likes.
///
/// A rank that ends without warning (killed, its machine lost) takes the whole job with it, as MPI has it:
/// resume the search from its checkpoint.
class Ranks {
 public:
  /// Whether a launcher of MPI started this process, by the variables that Open MPI, MPICH and Slurm leave in
  /// the environment. Without one there is nobody to share the work with, and MPI need not be started.
  static bool started_by_launcher();

  /// Starts MPI. Throws std::runtime_error if that fails, or was done before.
  Ranks();
  /// Rank 0 sends the others home, who wait for that even if they never served; then MPI is ended, which waits
  /// for all of them.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool drives() const { return rank_ == 0; }

  /// The first rank that says yes, `size()` if none does; the same on all ranks, which must all ask, before
  /// rank 0 spreads anything. So that a mistake that all ranks make is reported by one.
  int first_that(bool yes) const;

  /// On rank 0: an evaluation that deals rows out to all ranks as they come free, and does its share with
  /// `own`. Rows do not depend on who evaluates them, if `own` is the same everywhere. What throws on another
  /// rank comes back as NaN. Returns false if `own` does so on any rank; the others have then finished what
  /// they had. Usable as long as this object. REQUIRES: drives().
  BatchEvaluation spread(std::size_t variables, std::size_t outcomes, BatchEvaluation own);

  /// On the other ranks: evaluates with `own` what rank 0 sends, until it sends this rank home. Waiting costs
  /// little: the longer it lasts, the more of it is slept. REQUIRES: !drives().
  void serve(std::size_t variables, std::size_t outcomes, const BatchEvaluation& own);

 private:
  int rank_ = 0;
  int size_ = 1;
  bool sent_home_ = false;
};

}  // namespace zwidth
