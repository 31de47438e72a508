#include "zwidth/mechanism/arm_singularities.h"

#include <cmath>
#include <numbers>

#include "zwidth/mechanism/internal/serial_closed_form.h"

namespace zwidth {
namespace {

// With theta3 = 0 the upper arm, the forearm and axis 1 lie in one plane:
// det [Jr1 Jr2 Jr4] = d3 d4 s4 p, where |p| is the distance of the wrist from axis 1.
std::vector<SrsSingularity> planar_singularities(const SrsLengths& lengths, const SrsAngles& theta) {
  const Vector3 r = srs_forward(lengths, theta).wrist.position;
  const double across = std::hypot(r.x(), r.y()), reach = r.norm();
  const std::array<SrsSingularity, 4> redundant = srs_singularities(theta);
  return {redundant[0],
          {.name = "shoulder",
           .what = "the wrist lies on axis 1",
           .where = "x = y = 0",
           .carried = "a force at right angles to the plane of the arm",
           .distance = reach > 0.0 ? std::asin(std::min(1.0, across / reach)) : 0.0},
          {.name = "wrist",
           .what = "axis 7 lies along the forearm",
           .where = "theta6 = 0 or 180 deg",
           .carried = "a force and a moment along a screw that depends on the posture",
           .distance = std::abs(std::remainder(theta[5], std::numbers::pi))}};
}

}  // namespace

std::vector<SrsSingularity> arm_singularities(const Posture& posture) {
  const auto* form = dynamic_cast<const internal::SerialClosedForm*>(posture.mechanism().closed_form());
  if (form == nullptr || !form->srs()) return {};
  const internal::SrsPattern& srs = *form->srs();
  const SrsAngles theta = srs.angles_of(posture.joints());
  if (!srs.theta3_locked) {
    const std::array<SrsSingularity, 4> sets = srs_singularities(theta);
    return {sets.begin(), sets.end()};
  }
  if (std::abs(std::sin(theta[2])) > 1e-9) return {};
  return planar_singularities(srs.lengths, theta);
}

}  // namespace zwidth
