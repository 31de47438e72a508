#include "zwidth/analysis/statics.h"

#include <cmath>
#include <stdexcept>

namespace zwidth {

Wrench wrench_in_base(const Vector3& force, const Vector3& moment, MomentFrame frame,
                      const Matrix3& tool) noexcept {
  switch (frame) {
    case MomentFrame::base:
      break;
    case MomentFrame::tool:
      return {force, tool * moment};
    case MomentFrame::published:
      return {force, tool.transpose() * moment};
  }
  return {force, moment};
}

ToolVector tool_load(const Mechanism& mechanism, const Wrench& wrench) noexcept {
  Vector6 all;
  all << wrench.force, wrench.moment;
  const auto axes = mechanism.tool_axes();
  ToolVector rows(static_cast<Eigen::Index>(axes.size()));
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows[i] = all[axes[static_cast<std::size_t>(i)]];
  return rows;
}

ActiveVector load_torques(const Posture& posture, const LoadDescription& load) noexcept {
  const Wrench wrench = wrench_in_base(load.force, load.moment, load.moment_frame, posture.tool().rotation);
  return torques_for_load(jacobian(posture), tool_load(posture.mechanism(), wrench));
}

double stiffness_under_weight(double mass, double deflection, double gravity) {
  for (const double value : {mass, deflection, gravity}) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw std::invalid_argument("mass, deflection and gravity must be positive and finite");
  }
  return mass * gravity / deflection;
}

}  // namespace zwidth
