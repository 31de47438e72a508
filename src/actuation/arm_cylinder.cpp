#include "zwidth/actuation/arm_cylinder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "zwidth/actuation/require.h"

namespace zwidth {
namespace {

using std::numbers::pi;
using enum ArmCylinderLayout;

double require_finite(const char* name, double value) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::string("the ") + name + " must be finite, not " + std::to_string(value));
  }
  return value;
}

double square(double x) {
  return x * x;
}

double wrapped(double angle) {
  const double turned = std::remainder(angle, 2.0 * pi);
  return turned <= -pi ? pi : turned;
}

// Position of the largest value of `function` in [low, high], which has one maximum there.
template <class Function>
double golden_section(double low, double high, const Function& function) {
  constexpr double kShare = 0.61803398874989485;  // of a golden section
  double left = high - kShare * (high - low), right = low + kShare * (high - low);
  double at_left = function(left), at_right = function(right);
  for (int n = 0; n < 80 && high - low > 1e-13; ++n) {
    if (at_left > at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kShare * (high - low);
      at_left = function(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kShare * (high - low);
      at_right = function(right);
    }
  }
  return 0.5 * (low + high);
}

// Position of the largest value of `function` in [low, high]: the best of a raster, refined between its
// neighbours.
template <class Function>
double largest_at(double low, double high, int cells, const Function& function) {
  const double step = (high - low) / cells;
  int best = 0;
  double most = function(low);
  for (int n = 1; n <= cells; ++n) {
    const double value = function(low + n * step);
    if (value > most) {
      most = value;
      best = n;
    }
  }
  const double inner =
      golden_section(low + std::max(0, best - 1) * step, low + std::min(cells, best + 1) * step, function);
  const double corner = low + best * step;
  return function(inner) > most ? inner : corner;
}

// S and D of the length equations: d(theta_m)^2 + d(-theta_m)^2 = 2 S, and their difference 4 D sin(theta_m).
struct Sums {
  double S = 0.0;
  double D = 0.0;
};

Sums sums(const CylinderTravel& travel) {
  require_positive("shortest length", travel.min_length);
  require_positive("greatest length", travel.max_length);
  if (!(travel.min_length < travel.max_length)) {
    throw std::invalid_argument(
        "the shortest length must be less than the greatest: " + std::to_string(travel.min_length) + " m, " +
        std::to_string(travel.max_length) + " m");
  }
  if (!(travel.half_range > 0.0) || !(travel.half_range < 0.5 * pi)) {
    throw std::invalid_argument("the half range must be more than 0 and less than 90 deg, not " +
                                std::to_string(travel.half_range) + " rad");
  }
  const double low = square(travel.min_length), high = square(travel.max_length);
  return {0.5 * (low + high), (high - low) / (4.0 * std::sin(travel.half_range))};
}

// Two lengths with a given product and sum of squares, the longer first; empty if there are none.
std::optional<std::pair<double, double>> pair_of(double product, double squares) {
  const double apart = squares - 2.0 * product;
  if (!(apart >= -1e-14 * squares)) return std::nullopt;
  const double sum = std::sqrt(squares + 2.0 * product), difference = std::sqrt(std::max(0.0, apart));
  return std::pair(0.5 * (sum + difference), 0.5 * (sum - difference));
}

// The linkage of the common form with this travel and an angle alpha, as layout two; empty if there is none.
std::optional<ArmCylinderDescription> design_at(const CylinderTravel& travel, double alpha) {
  const auto [S, D] = sums(travel);
  const auto ab = pair_of(D / std::cos(alpha), S + 2.0 * D * std::tan(alpha) * std::cos(travel.half_range));
  if (!ab) return std::nullopt;
  return ArmCylinderDescription{.layout = two,
                                .l0 = ab->first * std::sin(alpha),
                                .l1 = ab->first * std::cos(alpha),
                                .l2 = ab->second,
                                .retracted_length = travel.min_length};
}

}  // namespace

ArmCylinder::ArmCylinder(const ArmCylinderDescription& description) : description_(description) {
  const double l0 = require_finite("length l0", description.l0), h = require_finite("height h", description.h);
  const double l1 = description.layout == three ? require_finite("length l1", description.l1)
                                                : require_positive("length l1", description.l1);
  const double l2 = require_positive("length l2", description.l2);
  switch (description.layout) {
    case one:  // (3.1)
      s_ = l1 * l1 + l2 * l2;
      B_ = l1 * l2;
      return;
    case two:  // (3.17)
      s_ = l0 * l0 + l1 * l1 + l2 * l2;
      A_ = -l0 * l2;
      B_ = l1 * l2;
      return;
    case two_mod:  // (3.31)
      s_ = l0 * l0 + l1 * l1 + l2 * l2;
      A_ = -l0 * l2;
      B_ = -l1 * l2;
      return;
    case three:  // (3.45), with l' = hypot(h, l2) where the thesis prints l twice
      require_positive("distance from the pivot to the arm pin", std::hypot(l0, l1));
      s_ = l0 * l0 + l1 * l1 + l2 * l2 + h * h;
      A_ = l0 * l2 - h * l1;
      B_ = -(l1 * l2 + h * l0);
      return;
  }
}

double ArmCylinder::length(double angle) const noexcept {
  return std::sqrt(std::max(0.0, s_ + 2.0 * (A_ * std::cos(angle) + B_ * std::sin(angle))));
}

double ArmCylinder::lever(double angle) const noexcept {
  const double d = length(angle);
  return d > 0.0 ? (B_ * std::cos(angle) - A_ * std::sin(angle)) / d : 0.0;
}

double ArmCylinder::phi(double angle) const noexcept {
  const auto& [layout, l0, l1, l2, h, retracted, source, sources] = description_;
  const double c = std::cos(angle), s = std::sin(angle);
  switch (layout) {
    case one:
      return std::atan2(l2 * c, l1 + l2 * s);
    case two:
      return std::atan2(l2 * c - l0, l1 + l2 * s);
    case two_mod:
      return std::atan2(l2 * c - l0, l1 - l2 * s);
    case three:
      return std::atan2(l0 * s + l1 * c - h, l0 * c - l1 * s + l2);
  }
  return 0.0;
}

double ArmCylinder::beta(double angle) const noexcept {
  switch (description_.layout) {
    case one:
    case two:
      return 0.5 * pi - (angle + phi(angle));
    case two_mod:
      return 0.5 * pi + (angle - phi(angle));
    case three:
      return std::atan2(description_.l1, description_.l0) + angle - phi(angle);
  }
  return 0.0;
}

double ArmCylinder::arm_radius() const noexcept {
  return description_.layout == three ? std::hypot(description_.l0, description_.l1) : description_.l2;
}

std::optional<double> ArmCylinder::push_for_torque(double torque, double angle) const noexcept {
  const double d = lever(angle);
  return std::abs(d) < kDeadPointLever ? std::nullopt : std::optional(torque / d);
}

std::optional<double> ArmCylinder::required_force(double load, double distance, double angle) const noexcept {
  const auto push = push_for_torque(load * distance * std::cos(angle), angle);
  return push ? std::optional(std::abs(*push)) : std::nullopt;
}

std::optional<PeakForce> ArmCylinder::peak_required_force(double load, double distance,
                                                          const Interval& range) const {
  if (!keeps_direction(range)) return std::nullopt;
  const auto force = [&](double angle) { return required_force(load, distance, angle).value_or(HUGE_VAL); };
  constexpr int kCells = 64;  // the force has at most a few humps over a turn
  const double at = largest_at(range.min, range.max, kCells, force);
  return std::isfinite(force(at)) ? std::optional(PeakForce{force(at), at}) : std::nullopt;
}

std::optional<double> ArmCylinder::angle(double length) const {
  require_positive("cylinder length", length);
  const double amplitude = 2.0 * std::hypot(A_, B_);
  const double cosine = (length * length - s_) / amplitude;
  constexpr double kRounding = 1e-12;
  if (!(std::abs(cosine) <= 1.0 + kRounding)) return std::nullopt;
  const double middle = std::atan2(B_, A_), apart = std::acos(std::clamp(cosine, -1.0, 1.0));
  const double ahead = wrapped(middle + apart), behind = wrapped(middle - apart);
  return std::abs(behind) < std::abs(ahead) ? behind : ahead;
}

bool ArmCylinder::keeps_direction(const Interval& range) const noexcept {
  if (std::abs(lever(range.min)) < kDeadPointLever || std::abs(lever(range.max)) < kDeadPointLever)
    return false;
  // d' vanishes half a turn apart, where B cos = A sin.
  const double first = std::atan2(B_, A_);
  return std::floor((range.max - first) / pi) == std::floor((range.min - first) / pi);
}

ArmCylinderForm ArmCylinder::form() const noexcept {
  const auto& [layout, l0, l1, l2, h, retracted, source, sources] = description_;
  const int sign = B_ < 0.0 ? -1 : 1;
  return {.a = layout == three ? std::hypot(l2, h) : std::hypot(l0, l1),
          .b = arm_radius(),
          .alpha = std::atan2(-A_, sign * B_),
          .sign = sign};
}

// ------------------------------------------------------------------------------------------------ synthesis

std::optional<ArmCylinderDescription> design_one(const CylinderTravel& travel, DesignRoot root) {
  const auto [S, D] = sums(travel);
  const auto lengths = pair_of(D, S);
  if (!lengths) return std::nullopt;
  const auto [longer, shorter] = *lengths;
  const bool plus = root == DesignRoot::plus;
  return ArmCylinderDescription{.layout = one,
                                .l1 = plus ? longer : shorter,
                                .l2 = plus ? shorter : longer,
                                .retracted_length = travel.min_length};
}

Interval feasible_levers(const CylinderTravel& travel) {
  sums(travel);
  const double sine = std::sin(travel.half_range);
  return {travel.stroke() / (2.0 * sine), (travel.max_length + travel.min_length) / (2.0 * sine)};
}

std::optional<ArmCylinderDescription> design_two(const CylinderTravel& travel, double lever, DesignRoot root,
                                                 ArmCylinderLayout layout) {
  require_positive("lever l2", lever);
  if (layout != two && layout != two_mod) {
    throw std::invalid_argument("a free lever belongs to the layouts two and two_mod");
  }
  const auto [S, D] = sums(travel);
  const Interval feasible = feasible_levers(travel);
  constexpr double kRounding = 1e-12;
  if (!feasible.contains(lever, kRounding * feasible.max)) return std::nullopt;
  // The radicand of (3.25), S - l2^2 sin^2 - l1^2, as a product: it vanishes at both ends of the feasible
  // levers.
  const double sine = std::sin(travel.half_range);
  const double l2 = std::clamp(lever, feasible.min, feasible.max);
  const double radicand =
      square(sine / l2) * (l2 - feasible.min) * (l2 + feasible.min) * (feasible.max - l2) * (feasible.max + l2);
  const double away = std::sqrt(radicand) * (root == DesignRoot::plus ? 1.0 : -1.0);
  return ArmCylinderDescription{.layout = layout,
                                .l0 = lever * std::cos(travel.half_range) + away,
                                .l1 = D / lever,
                                .l2 = lever,
                                .retracted_length = travel.min_length};
}

ArmCylinderDescription design_two_optimal(const CylinderTravel& travel, ArmCylinderLayout layout) {
  const double lever = feasible_levers(travel).min;
  return {.layout = layout,
          .l0 = lever * std::cos(travel.half_range),
          .l1 = 0.5 * (travel.min_length + travel.max_length),
          .l2 = lever,
          .retracted_length = travel.min_length};
}

std::optional<ArmCylinderDescription> design_three(const CylinderTravel& travel, double height,
                                                   double base_distance, DesignRoot root) {
  const double h = require_finite("height h", height), l2 = require_positive("distance l2", base_distance);
  const auto [S, D] = sums(travel);
  const double cosine = std::cos(travel.half_range);
  // (3.50)-(3.54); the thesis prints a = l^2 where l'^2 = h^2 + l2^2 is meant.
  const double a = h * h + l2 * l2;
  const double b = 2.0 * (l2 * a * cosine - h * D);
  const double c = D * D - 2.0 * l2 * h * D * cosine + l2 * l2 * (a - S);
  const double radicand = b * b - 4.0 * a * c;
  constexpr double kRounding = 1e-14;
  if (!(radicand >= -kRounding * (b * b + 4.0 * a * std::abs(c)))) return std::nullopt;
  const double away = std::sqrt(std::max(0.0, radicand)) * (root == DesignRoot::plus ? 1.0 : -1.0);
  const double l0 = (away - b) / (2.0 * a);
  return ArmCylinderDescription{.layout = three,
                                .l0 = l0,
                                .l1 = (D - h * l0) / l2,
                                .l2 = l2,
                                .h = h,
                                .retracted_length = travel.min_length};
}

ArmCylinderDescription design_three_optimal(const CylinderTravel& travel) {
  const ArmCylinderDescription flat = design_two_optimal(travel);
  return {.layout = three,
          .l0 = 0.0,
          .l1 = flat.l2,
          .l2 = flat.l1,
          .h = flat.l0,
          .retracted_length = travel.min_length};
}

std::optional<ArmCylinderDescription> design_least_peak(const CylinderTravel& travel) {
  const auto [S, D] = sums(travel);
  // Real lengths need S cos(alpha) + 2 D cos(theta_m) sin(alpha) >= 2 D.
  const double along = 2.0 * D * std::cos(travel.half_range);
  const double middle = std::atan2(along, S), reach = 2.0 * D / std::hypot(S, along);
  if (!(reach <= 1.0)) return std::nullopt;
  const double apart = std::acos(reach);
  const Interval range{-travel.half_range, travel.half_range};
  const auto ease = [&](double alpha) {
    const auto design = design_at(travel, alpha);
    if (!design || !(design->l1 > 0.0) || !(design->l2 > 0.0)) return 0.0;
    const auto peak = ArmCylinder(*design).peak_required_force(1.0, 1.0, range);
    return peak && peak->force > 0.0 ? 1.0 / peak->force : 0.0;
  };
  constexpr int kCells = 48;
  const double alpha = largest_at(middle - apart, middle + apart, kCells, ease);
  return ease(alpha) > 0.0 ? design_at(travel, alpha) : std::nullopt;
}

double minimum_peak_force(double stroke, double half_range, double load, double distance) {
  require_positive("stroke", stroke);
  if (!(half_range > 0.0) || !(half_range < 0.5 * pi)) {
    throw std::invalid_argument("the half range must be more than 0 and less than 90 deg, not " +
                                std::to_string(half_range) + " rad");
  }
  return 2.0 * std::abs(require_finite("load", load) * require_finite("distance", distance)) *
         std::sin(half_range) / stroke;
}

}  // namespace zwidth
