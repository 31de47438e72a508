#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/mechanism/closed_form.h"
#include "zwidth/mechanism/internal/srs_pattern.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/serial_chain.h"

namespace zwidth::internal {

/// A serial arm without iteration: forward for any, the inverse for those of the S-R-S form, with a joint to
/// spare or with theta3 fixed. What a joint to spare leaves open is one angle, that of the elbow on its circle;
/// a joint that is kept decides it, and the best of a rule is looked for along the arcs on which no joint is
/// beyond its range, whose ends are known.
class SerialClosedForm final : public ClosedForm {
 public:
  SerialClosedForm(const SerialDescription& arm, const LegDescription& leg);

  ClosedPosture forward(const ActiveVector& active) const noexcept override;
  int branch_count() const noexcept override;
  bool covers(const SolveOptions& options) const noexcept override;
  /// Branches stand in the order of the rule, those within the joint ranges first.
  ClosedPosture inverse(const Pose& tool, const SolveOptions& options, int branch) const noexcept override;

  const std::optional<SrsPattern>& srs() const { return srs_; }

 private:
  struct Candidate {
    ActiveVector joints;
    double objective = 0.0;  ///< what the rule makes small
    bool within = false;     ///< every joint in its range

    bool better_than(const Candidate& other) const noexcept {
      return within != other.within ? within : objective < other.objective;
    }
  };
  /// The best few, best first.
  class Candidates {
   public:
    void add(const Candidate& one) noexcept;
    int count() const { return count_; }
    const Candidate& operator[](int i) const { return best_[i]; }

   private:
    static constexpr int kMost = 8;
    std::array<Candidate, kMost> best_;
    int count_ = 0;
  };
  /// What one inverse is about.
  struct Question {
    Pose wrist;
    Match match;
    Redundancy redundancy;
    ActiveVector start;
    SrsAngles near;              ///< the start's canonical angles
    SrsElbowCircle circle = {};  ///< where the elbow may be
  };

  /// Elbows, from one of them on, at which arcs of the circle end [rad].
  struct Cuts {
    std::array<double, 2 * 2 * 6 + 2> at;
    int count = 0;
  };

  SolveStatus solve(Question& question, Candidates& candidates) const noexcept;
  SolveStatus keep(Question& question, Candidates& candidates) const noexcept;
  /// One of theta1 to theta3, and where it is [rad].
  struct Angle {
    SrsGiven joint;
    double angle;
  };
  SrsStatus ask(const Question& question, SrsGiven joint, double angle, const Angle* also,
                Candidates& candidates) const noexcept;
  SolveStatus given(const Question& question, SrsGiven joint, double angle,
                    Candidates& candidates) const noexcept;
  Cuts cuts_of(const Question& question, double own) const noexcept;
  void best_of_branch(const Question& question, int branch, Candidates& candidates) const noexcept;
  bool follow(const Question& question, Candidates& candidates) const noexcept;
  bool polish(const Question& question, int branch, double elbow, bool beyond, Candidate& best) const noexcept;

  SrsAngles angles_at(const Question& question, double elbow, int branch) const noexcept;
  Candidate at(const Question& question, double elbow, int branch) const noexcept;
  Candidate candidate(const Question& question, const SrsAngles& theta) const noexcept;

  SerialChain chain_;
  double length_ = 0.0;  // characteristic
  std::optional<SrsPattern> srs_;
  std::vector<Interval> range_;
  ActiveVector home_;
};

}  // namespace zwidth::internal
