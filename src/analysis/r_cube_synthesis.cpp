#include "zwidth/analysis/r_cube_synthesis.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/math/beam.h"
#include "zwidth/math/section.h"
#include "zwidth/mechanism/r_cube_dynamics.h"
#include "zwidth/mechanism/r_cube_stiffness.h"

namespace zwidth {
namespace {

bool positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

// cos q3 of the outer links with their end at (x, y) from the universal joint, beyond +-1 out of reach
// (eq 6.32).
double elbow_cosine(const RCubeDesign& design, double x, double y) {
  const double l2 = design.inner_link, l3 = design.outer_link;
  return (x * x + y * y - l2 * l2 - l3 * l3) / (2.0 * l2 * l3);
}

double reach(const RCubeDesign& design, double x, double y) {
  const double cosine = elbow_cosine(design, x, y);
  return cosine * cosine - 1.0;
}

// sin(q2 + q3), the outer link's slope, with the elbow on the device's side (eq 5.39-5.45 with X = y, Y = -x).
double outer_slope(const RCubeDesign& design, double x, double y) {
  const double l2 = design.inner_link, l3 = design.outer_link;
  const double cosine = std::clamp(elbow_cosine(design, x, y), -1.0, 1.0),
               sine = -std::sqrt(1.0 - cosine * cosine);
  const double X = y, Y = -x, along = l2 + l3 * cosine, across = l3 * sine;
  const double q2 = std::atan2(along * Y - across * X, along * X + across * Y), q3 = std::atan2(sine, cosine);
  return std::sin(q2 + q3);
}

}  // namespace

std::optional<double> r_cube_max_angle(double drive_link, double half_workspace) noexcept {
  if (!positive(drive_link) || !positive(half_workspace) || half_workspace > drive_link) return std::nullopt;
  return std::asin(half_workspace / drive_link);
}

std::optional<double> r_cube_drive_link(double max_angle, double half_workspace) noexcept {
  if (!positive(half_workspace) || !(max_angle > 0.0 && max_angle <= 0.5 * std::numbers::pi))
    return std::nullopt;
  return half_workspace / std::sin(max_angle);
}

double r_cube_manipulability_index(double drive_link, double max_angle) noexcept {
  return drive_link * std::cos(max_angle);
}

double r_cube_condition_index(double max_angle) noexcept {
  const double cosine = std::cos(max_angle);
  return 1.0 / (cosine * cosine);
}

double RCubeConstraints::worst() const {
  const std::array<double, 7> values = all();
  return *std::max_element(values.begin(), values.end());
}

std::optional<RCubeConstraints> r_cube_constraints(const RCubeDesign& design) noexcept {
  const std::optional<double> drive = r_cube_drive_link(design.max_angle, design.half_workspace);
  if (!drive || !positive(design.inner_link) || !positive(design.outer_link) ||
      !positive(design.half_clearance) || !(design.max_angle < 0.5 * std::numbers::pi)) {
    return std::nullopt;
  }
  const double l1 = *drive, h = design.half_clearance, dy = l1 - l1 * std::cos(design.max_angle);
  return RCubeConstraints{.far_low = reach(design, l1 + h, -h),
                          .far_high = reach(design, l1 + h, h),
                          .near = reach(design, l1 - h, 0.0),
                          .raised_far = reach(design, l1 + h, dy + h),
                          .raised_near = reach(design, l1 - h, dy),
                          .elbow = outer_slope(design, l1 - h, -h),
                          .raised_elbow = outer_slope(design, l1 - h, dy - h)};
}

std::optional<double> normalised(double value, double min, double max) noexcept {
  if (!(max > min)) return std::nullopt;
  return (value - min) / (max - min);
}

std::optional<int> r_cube_choice(std::span<const double> frequency, std::span<const double> manipulability,
                                 double weight) noexcept {
  if (frequency.empty() || frequency.size() != manipulability.size()) return std::nullopt;
  int best = 0;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < frequency.size(); ++i) {
    const double a = 1.0 - frequency[i], b = 1.0 - manipulability[i];
    const double rms = std::sqrt(0.5 * (a * a + weight * b * b));
    if (rms < least) {
      least = rms;
      best = static_cast<int>(i);
    }
  }
  return best;
}

std::optional<double> hollow_section_ratio(const HollowSection& section, const Interval& range) noexcept {
  if (!(range.min >= 0.0 && range.min < range.max && range.max < 1.0) || !positive(section.outer_diameter) ||
      !positive(section.length) || !positive(section.density) || !positive(section.elastic_modulus)) {
    return std::nullopt;
  }
  const double D = section.outer_diameter, l = section.length;
  const auto compliance = [&](double ratio) {
    return l * l * l / (12.0 * section.elastic_modulus * tube_section(D, ratio * D)->second_moment_y);
  };
  const auto inertia = [&](double ratio) {  // (6.86)
    const double d = ratio * D, m = section.density * l * tube_section(D, d)->area;
    return m * (l * l / 3.0 + (D * D + d * d) / 16.0 + l * l / 4.0);
  };
  // Compliance grows with the hole, inertia falls: their extremes lie at the ends of the range.
  const double c0 = compliance(range.min), c1 = compliance(range.max), i0 = inertia(range.min),
               i1 = inertia(range.max);
  const auto mean_square = [&](double ratio) {
    const double a = (compliance(ratio) - c0) / (c1 - c0), b = (inertia(ratio) - i1) / (i0 - i1);
    return a * a + b * b;
  };
  // Both are monotonic and convex away from the minimum, so that golden section finds it.
  constexpr double kGolden = 0.61803398874989484820;
  double low = range.min, high = range.max;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = mean_square(left), at_right = mean_square(right);
  while (high - low > 1e-9) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = mean_square(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = mean_square(right);
    }
  }
  return 0.5 * (low + high);
}

double r_cube_frequency_index(const Matrix3& leg_mass, const Matrix6& leg_stiffness) noexcept {
  const Eigen::Matrix<double, 3, 6> rows = leg_stiffness.topRows<3>();
  return leg_mass.ldlt().solve(rows).norm();
}

std::optional<RCubeObjectives> r_cube_objectives(const RCubeDesign& design,
                                                 const RCubeLinkChoice& links) noexcept {
  const double qmax = design.max_angle;
  if (!(qmax > 0.0 && qmax < 0.5 * std::numbers::pi)) return std::nullopt;
  const double l1 = design.half_workspace / std::sin(qmax);
  const RCubeGeometry geometry{
      .drive_link = l1, .inner_link = design.inner_link, .outer_link = design.outer_link, .base_offset = l1};
  if (!geometry.valid()) return std::nullopt;
  const RCubeSolution folded = r_cube_forward(geometry, {-qmax, -qmax, 0.0}),
                      extended = r_cube_forward(geometry, Vector3::Constant(qmax));
  if (!folded.closed() || !extended.closed()) return std::nullopt;
  RCubeMasses masses = r_cube_masses(geometry, {links.section, links.section, links.section}, links.density);
  masses.platform = links.platform_mass;
  const std::optional<Matrix3> mass = r_cube_cartesian_mass(masses, folded);
  if (!mass) return std::nullopt;
  const BeamRigidity beam = beam_rigidity(links.section, links.elastic_modulus, links.shear_modulus);
  const Matrix6 K = r_cube_stiffness({.geometry = geometry, .rigidity = {beam, beam, beam}}, extended);
  return RCubeObjectives{.closeness = std::tan(qmax),
                         .inertia = mass->determinant(),
                         .compliance = 1.0 / K.topLeftCorner<3, 3>().determinant()};
}

}  // namespace zwidth
