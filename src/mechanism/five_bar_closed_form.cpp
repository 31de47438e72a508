#include "zwidth/math/trigonometry.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/family_of.h"
#include "zwidth/mechanism/five_bar.h"

namespace zwidth {
namespace {

class FiveBarClosedForm final : public ClosedForm {
 public:
  explicit FiveBarClosedForm(const FiveBarDescription& description)
      : description_(description),
        geometry_(five_bar_geometry(description)),
        mode_(working_mode(description)),
        assembly_mode_(description.assembly_mode) {}

  const FiveBarDescription& description() const { return description_; }

  ClosedPosture forward(const ActiveVector& active) const noexcept override {
    const Vector2 theta(active[0], active[1]);
    const FiveBarForward forward = five_bar_forward(geometry_, theta, assembly_mode_);
    if (!closes(forward.status)) return {.status = forward.status};
    return closed(theta, forward.position);
  }

  int branch_count() const noexcept override { return 4; }

  // Bit l of the branch: leg l in the mode that is not the device's own.
  ClosedPosture inverse(const Pose& tool, const SolveOptions& /*options*/, int branch) const noexcept override {
    const Vector2 position = tool.position.head<2>();
    const FiveBarInverse own = five_bar_inverse(geometry_, position, mode_);
    if (!closes(own.status)) return {.status = own.status, .joint = kJointsPerLeg * own.joint};
    if (branch == 0) return closed(own.theta, position);
    const bool flip[] = {(branch & 1) != 0, (branch & 2) != 0};
    const FiveBarInverse other = five_bar_inverse(
        geometry_, position,
        {.left = flip[0] ? -mode_.left : mode_.left, .right = flip[1] ? -mode_.right : mode_.right});
    for (int l = 0; l < 2; ++l) {  // the modes of a straight leg are one
      if (flip[l] && other.theta[l] == own.theta[l]) return {.joint = kJointsPerLeg * l};
    }
    return closed(other.theta, position);
  }

 private:
  static constexpr int kJointsPerLeg = 2;

  static bool closes(SolveStatus status) {
    return status == SolveStatus::reached || status == SolveStatus::degraded;
  }

  ClosedPosture closed(const Vector2& theta, const Vector2& position) const noexcept {
    ClosedPosture result{.status = SolveStatus::reached,
                         .tool = {.position = {position.x(), position.y(), 0.0}}};
    result.joints.resize(2 * kJointsPerLeg);
    for (int l = 0; l < 2; ++l) {
      // The elbow's angle from the crank's direction, in its frame.
      const auto [sine, cosine] = sine_cosine(theta[l]);
      const double motor = l == 0 ? -geometry_.half_base : geometry_.half_base;
      const double ux = position.x() - motor - geometry_.crank * cosine,
                   uy = position.y() - geometry_.crank * sine;
      result.joints[kJointsPerLeg * l] = theta[l];
      result.joints[kJointsPerLeg * l + 1] = angle_of(ux * cosine + uy * sine, uy * cosine - ux * sine);
    }
    return result;
  }

  FiveBarDescription description_;
  FiveBarGeometry geometry_;
  WorkingMode mode_;
  int assembly_mode_;
};

}  // namespace

std::shared_ptr<const ClosedForm> closed_form_of(const FiveBarDescription& five_bar) {
  return std::make_shared<FiveBarClosedForm>(five_bar);
}

const FiveBarDescription* five_bar_of(const Mechanism& mechanism) noexcept {
  const auto* five_bar = dynamic_cast<const FiveBarClosedForm*>(mechanism.closed_form());
  return five_bar != nullptr ? &five_bar->description() : nullptr;
}

}  // namespace zwidth
