#include "zwidth/mechanism/arm_singularities.h"

#include <cmath>
#include <numbers>

#include "zwidth/mechanism/internal/serial_closed_form.h"

namespace zwidth {
namespace {

// How far the wrist stands from the plane of axes 1 and 2, p = c1 x + s1 y, over its most in that plane's
// turning about axis 2: the sine of the angle by which theta2 would have to change. 0 where it lies on axis 2
// for any theta2.
double tilt_from_plane(const SrsLengths& lengths, double theta2, double theta3, double theta4) {
  const double across = lengths.forearm * std::cos(theta3) * std::sin(theta4),
               along = lengths.upper_arm + lengths.forearm * std::cos(theta4);
  const double reach = std::hypot(across, along);
  if (reach < 1e-12 * (lengths.upper_arm + lengths.forearm)) return 0.0;
  return std::remainder(theta2 + std::atan2(across, along), std::numbers::pi);
}

// The least way of theta2 and theta4 to where the wrist lies in the plane of axes 1 and 2.
double shoulder_distance(const SrsLengths& lengths, const SrsAngles& theta) {
  const auto way = [&](double change) {
    return std::hypot(change, tilt_from_plane(lengths, theta[1], theta[2], theta[3] + change));
  };
  double most = way(0.0);  // with theta2 alone
  // Links of one length, folded: the wrist is in the shoulder.
  if (std::abs(lengths.upper_arm - lengths.forearm) < 1e-12 * lengths.upper_arm)
    most = std::min(most, std::abs(std::remainder(theta[3] - std::numbers::pi, 2.0 * std::numbers::pi)));
  if (most == 0.0) return 0.0;
  constexpr int kCells = 64;
  const double cell = 2.0 * most / kCells;
  double best = 0.0;
  for (int n = 0; n <= kCells; ++n) {
    const double change = -most + n * cell;
    if (way(change) < way(best)) best = change;
  }
  for (double step = 0.5 * cell; step > 1e-12; step *= 0.5) {
    for (const double change : {best - step, best + step}) {
      if (way(change) < way(best)) best = change;
    }
  }
  return std::min(most, way(best));
}

// With theta3 locked, at whatever angle, det [Jr1 Jr2 Jr4] = d3 d4 s4 p, where p = c1 x + s1 y is the distance
// of the wrist from the plane of axes 1 and 2: there joints 1 and 2 move the wrist the same way. The wrist's
// own joints turn it every way unless s6 = 0.
std::vector<SrsSingularity> locked_singularities(const SrsLengths& lengths, const SrsAngles& theta) {
  const bool plane = std::abs(std::sin(theta[2])) < 1e-9;  // the arm moves in a plane through axis 1
  const std::array<SrsSingularity, 4> redundant = srs_singularities(theta);
  SrsSingularity shoulder{
      .name = "shoulder",
      .what = "the wrist lies in the plane of axes 1 and 2",
      .where = "cos(theta1) x + sin(theta1) y = 0",
      .carried = "a force in that plane, at right angles to the way joint 4 moves the wrist",
      .distance = shoulder_distance(lengths, theta)};
  if (plane) {
    shoulder.what = "the wrist lies on axis 1";
    shoulder.where = "x = y = 0";
    shoulder.carried = "a force at right angles to the plane of the arm";
  }
  return {redundant[0],
          shoulder,
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
  return locked_singularities(srs.lengths, theta);
}

}  // namespace zwidth
