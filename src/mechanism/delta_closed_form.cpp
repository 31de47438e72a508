#include <array>

#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

constexpr Interval kAnyAngle{-1e9, 1e9};

class DeltaClosedForm final : public ClosedForm {
 public:
  explicit DeltaClosedForm(const DeltaGeometry& geometry) : geometry_(geometry) {}

  ClosedPosture forward(const ActiveVector& active) const noexcept override {
    const DeltaForward forward = delta_forward(geometry_, active);
    if (forward.status == SolveStatus::unreachable || forward.status == SolveStatus::degenerate) {
      return {.status = forward.status};
    }
    return closed(active, forward.position);
  }

  int branch_count() const noexcept override { return 8; }

  // Bit l of the branch: leg l with its knee inwards.
  ClosedPosture inverse(const Pose& tool, const SolveOptions& /*options*/, int branch) const noexcept override {
    std::array<Knee, 3> knees;
    for (int l = 0; l < 3; ++l) knees[l] = (branch >> l & 1) != 0 ? Knee::inwards : Knee::outwards;
    const DeltaInverse inverse = delta_inverse(geometry_, tool.position, kAnyAngle, knees);
    if (inverse.status == SolveStatus::unreachable || inverse.status == SolveStatus::degenerate) {
      return {.status = inverse.status, .joint = kJointsPerLeg * inverse.joint};
    }
    return closed(inverse.theta, tool.position);
  }

 private:
  static constexpr int kJointsPerLeg = 3;

  ClosedPosture closed(const Vector3& theta, const Vector3& position) const noexcept {
    ClosedPosture result{.status = SolveStatus::reached, .tool = {.position = position}};
    result.joints.resize(3 * kJointsPerLeg);
    for (int l = 0; l < 3; ++l) {
      result.joints.segment<3>(kJointsPerLeg * l) = delta_leg_joints(geometry_, l, theta[l], position);
    }
    return result;
  }

  DeltaGeometry geometry_;
};

}  // namespace

std::shared_ptr<const ClosedForm> closed_form_of(const DeltaDescription& delta) {
  return std::make_shared<DeltaClosedForm>(delta_geometry(delta));
}

}  // namespace zwidth
