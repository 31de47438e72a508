#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/family_of.h"
#include "zwidth/mechanism/r_cube.h"

namespace zwidth {
namespace {

constexpr Interval kAnyAngle{-1e9, 1e9};

class RCubeClosedForm final : public ClosedForm {
 public:
  explicit RCubeClosedForm(const RCubeDescription& description)
      : description_(description), geometry_(r_cube_geometry(description)), elbow_(description.elbow_mode) {}

  const RCubeDescription& description() const { return description_; }

  ClosedPosture forward(const ActiveVector& active) const noexcept override {
    return closed(r_cube_forward(geometry_, active, r_cube_branches(0, elbow_)));
  }

  int branch_count() const noexcept override { return kRCubeBranches; }

  // Bits 2l and 2l + 1 of the branch: leg l's driven link turned over, its elbow on the other side.
  ClosedPosture inverse(const Pose& tool, const SolveOptions& /*options*/, int branch) const noexcept override {
    return closed(r_cube_inverse(geometry_, tool.position, kAnyAngle, r_cube_branches(branch, elbow_)));
  }

 private:
  static ClosedPosture closed(const RCubeSolution& solution) noexcept {
    if (!solution.closed()) return {.status = solution.status, .joint = solution.joint};
    ClosedPosture result{.status = solution.status, .tool = {.position = solution.position}};
    result.joints.resize(15);
    for (int l = 0; l < 3; ++l) result.joints.segment<5>(5 * l) = r_cube_leg_joints(solution, l);
    return result;
  }

  RCubeDescription description_;
  RCubeGeometry geometry_;
  int elbow_;
};

}  // namespace

std::shared_ptr<const ClosedForm> closed_form_of(const RCubeDescription& r_cube) {
  return std::make_shared<RCubeClosedForm>(r_cube);
}

const RCubeDescription* r_cube_of(const Mechanism& mechanism) noexcept {
  const auto* r_cube = dynamic_cast<const RCubeClosedForm*>(mechanism.closed_form());
  return r_cube != nullptr ? &r_cube->description() : nullptr;
}

}  // namespace zwidth
