#include "zwidth/mechanism/five_bar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "zwidth/math/trigonometry.h"

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCoincident = 1e-14;      // relative to r1 + r2 + r3, for distances that count as zero
constexpr double kReachTolerance = 1e-12;  // relative overshoot that still counts as the boundary
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();  // relative, of a distance
constexpr double kLimitTolerance = 1e-9;                                    // [rad]
constexpr double kDegraded = 1e-4;   // scale-free singularity measures below this make a pose degraded
constexpr double kSingular = 1e-12;  // and below this leave a Jacobian undefined

Vector2 left_of(const Vector2& v) {
  return {-v.y(), v.x()};
}

double cross(const Vector2& u, const Vector2& v) {
  return u.x() * v.y() - u.y() * v.x();
}

Vector2 motor_axis(const FiveBarGeometry& geometry, int leg) {
  return {leg == 0 ? -geometry.half_base : geometry.half_base, 0.0};
}

bool within(const Interval& limits, double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  return limits.contains(angle, kLimitTolerance) || limits.contains(angle + turn, kLimitTolerance) ||
         limits.contains(angle - turn, kLimitTolerance);
}

// Jp^-1 Jtheta for rows u1, u2 of Jp; zero where det Jp = 0.
Matrix2 usual_jacobian(const Vector2& u1, const Vector2& u2, double t1, double t2, double det) {
  Matrix2 J = Matrix2::Zero();
  if (det == 0.0) return J;
  const double inverse = 1.0 / det, a = t1 * inverse, b = t2 * inverse;
  J << u2.y() * a, -u1.y() * b, -u2.x() * a, u1.x() * b;
  return J;
}

// `det` is `scale` times det Jp.
bool near_singular(const FiveBarGeometry& geometry, double t1, double t2, double det, double scale = 1.0) {
  const double leg = kDegraded * geometry.crank * geometry.coupler;
  return std::abs(t1) < leg || std::abs(t2) < leg ||
         std::abs(det) < kDegraded * geometry.coupler * geometry.coupler * scale;
}

// One leg of the inverse kinematics, without the choice of a root.
struct LegReach {
  SolveStatus status = SolveStatus::unreachable;
  Vector2 along = Vector2::Zero();  // C - O
  double D2 = 0.0;                  // its square
  double k = 0.0;                   // r1 D cos(alpha)
  double root = 0.0;                // r1 D sin(alpha), exactly zero on a boundary circle
};

LegReach leg_reach(const FiveBarGeometry& geometry, const Vector2& position, int leg) {
  const double r1 = geometry.crank, r2 = geometry.coupler;
  LegReach result;
  result.along = position - motor_axis(geometry, leg);
  result.D2 = result.along.squaredNorm();
  // The product of both radicands of section 3.1, (2 r1 D sin(alpha))^2, without D itself: outside r1 + r2, or
  // inside |r1 - r2|, one factor is negative.
  const double sum = r1 + r2, difference = std::abs(r1 - r2);
  const double outer = sum * sum - result.D2, inner = result.D2 - difference * difference;
  const double outer_unit = 2.0 * sum * sum,
               inner_unit = 2.0 * sum * difference;  // squares per share of r1 + r2
  if (!(outer >= -kReachTolerance * outer_unit) || !(inner >= -kReachTolerance * inner_unit)) return result;
  const double zero = kCoincident * geometry.scale();
  if (result.D2 <= zero * zero) {  // reached only if r1 = r2: the crank angle is open
    result.status = SolveStatus::degenerate;
    return result;
  }
  result.k = 0.5 * ((r1 - r2) * sum + result.D2);
  const bool bent = outer > kRounding * outer_unit && inner > kRounding * inner_unit;
  result.root = bent ? 0.5 * std::sqrt(outer * inner) : 0.0;
  result.status = SolveStatus::reached;
  return result;
}

// D^2 (B - O) for the root `sign`: no division, and the same angle.
Vector2 scaled_crank(const LegReach& leg, int sign) {
  const double across = sign < 0 ? -leg.root : leg.root;
  return leg.along * leg.k + left_of(leg.along) * across;
}

double crank_angle(const Vector2& crank) {
  const double theta = angle_of(crank.x(), crank.y());
  return theta <= -std::numbers::pi ? std::numbers::pi : theta;
}

// The ellipse A^T u over all unit vectors u: half axes are the singular values of A, directions its right
// singular vectors.
Ellipse ellipse_of(const Matrix2& A) {
  const double a = A(0, 0), b = A(0, 1), c = A(1, 0), d = A(1, 1);
  Ellipse ellipse;
  ellipse.major = 0.5 * (std::hypot(a + d, c - b) + std::hypot(a - d, b + c));
  // From the determinant: the difference of the two terms above loses digits.
  ellipse.minor = ellipse.major > 0.0 ? std::abs(a * d - b * c) / ellipse.major : 0.0;
  const double direction = 0.5 * std::atan2(2.0 * (a * b + c * d), (a - d) * (a + d) + (c - b) * (c + b));
  ellipse.direction = direction < 0.0 ? direction + std::numbers::pi : direction;
  if (ellipse.direction >= std::numbers::pi) ellipse.direction = 0.0;
  return ellipse;
}

}  // namespace

FiveBarGeometry five_bar_geometry(const FiveBarDescription& description) {
  return {.crank = description.crank, .coupler = description.coupler, .half_base = description.half_base};
}

WorkingMode working_mode(const FiveBarDescription& description) {
  return {.left = description.left_mode, .right = description.right_mode};
}

bool can_assemble(const FiveBarGeometry& geometry) noexcept {
  return geometry.crank > 0.0 && geometry.coupler > 0.0 && geometry.half_base >= 0.0 &&
         geometry.half_base < geometry.crank + geometry.coupler && std::isfinite(geometry.scale());
}

FiveBarGeometry normalised_lengths(const FiveBarGeometry& geometry) noexcept {
  const double L = geometry.scale() / 3.0;
  return {.crank = geometry.crank / L, .coupler = geometry.coupler / L, .half_base = geometry.half_base / L};
}

namespace {

// The line between the elbows.
struct Elbows {
  SolveStatus status = SolveStatus::unreachable;
  Vector2 b1, b2;   // cranks, B_i - O_i
  Vector2 v;        // B2 - B1
  double l2 = 0.0;  // its square
  double h2 = 0.0;  // squared distance of the tool from its middle, exactly zero where the couplers align
};

Elbows elbows_at(const FiveBarGeometry& geometry, const Vector2& theta) {
  Elbows elbows;
  if (!can_assemble(geometry)) return elbows;
  const double r1 = geometry.crank, r2 = geometry.coupler, r3 = geometry.half_base;
  const auto [sin1, cos1] = sine_cosine(theta[0]);
  const auto [sin2, cos2] = sine_cosine(theta[1]);
  elbows.b1 = {r1 * cos1, r1 * sin1};
  elbows.b2 = {r1 * cos2, r1 * sin2};
  elbows.v = {elbows.b2.x() - elbows.b1.x() + 2.0 * r3, elbows.b2.y() - elbows.b1.y()};
  elbows.l2 = elbows.v.squaredNorm();
  const double zero = kCoincident * geometry.scale();
  if (elbows.l2 <= zero * zero) {
    elbows.status = SolveStatus::degenerate;
    return elbows;
  }
  elbows.h2 = r2 * r2 - 0.25 * elbows.l2;
  if (!(elbows.h2 >= -2.0 * kReachTolerance * r2 * r2)) return elbows;
  if (elbows.h2 <= kRounding * r2 * r2) elbows.h2 = 0.0;
  elbows.status = SolveStatus::reached;
  return elbows;
}

}  // namespace

FiveBarForward five_bar_forward(const FiveBarGeometry& geometry, const Vector2& theta,
                                int assembly_mode) noexcept {
  FiveBarForward result;
  const Elbows elbows = elbows_at(geometry, theta);
  result.status = elbows.status;
  if (elbows.status != SolveStatus::reached) return result;
  // C = (B1 + B2)/2 + branch h n with the unit normal n to the left of v; h/|v| in one root.
  const double slope = std::sqrt(elbows.h2 / elbows.l2), across = assembly_mode < 0 ? -slope : slope;
  const Vector2 up = across * left_of(elbows.v), half = 0.5 * elbows.v;
  result.position = 0.5 * (elbows.b1 + elbows.b2) + up;

  const Vector2 u1 = half + up, u2 = up - half;  // C - B_i
  const double det = across * elbows.l2;         // u1 x u2
  const double t1 = cross(elbows.b1, u1), t2 = cross(elbows.b2, u2);
  result.jacobian = usual_jacobian(u1, u2, t1, t2, det);
  if (near_singular(geometry, t1, t2, det)) result.status = SolveStatus::degraded;
  return result;
}

std::optional<int> five_bar_forward_count(const FiveBarGeometry& geometry, const Vector2& theta) noexcept {
  const Elbows elbows = elbows_at(geometry, theta);
  if (elbows.status == SolveStatus::degenerate) return std::nullopt;
  if (elbows.status == SolveStatus::unreachable) return 0;
  return elbows.h2 == 0.0 ? 1 : 2;
}

FiveBarInverse five_bar_inverse(const FiveBarGeometry& geometry, const Vector2& position, WorkingMode mode,
                                const std::array<Interval, 2>& ranges) noexcept {
  FiveBarInverse result;
  if (!can_assemble(geometry)) {
    result.joint = 0;
    return result;
  }
  const std::array<LegReach, 2> legs = {leg_reach(geometry, position, 0), leg_reach(geometry, position, 1)};
  for (const SolveStatus fault : {SolveStatus::unreachable, SolveStatus::degenerate}) {
    for (int i = 0; i < 2; ++i) {
      if (legs[i].status != fault) continue;
      result.status = fault;
      result.joint = i;
      return result;
    }
  }
  const Vector2 b1 = scaled_crank(legs[0], mode.left), b2 = scaled_crank(legs[1], mode.right);
  result.theta = {crank_angle(b1), crank_angle(b2)};
  // D_i^2 (C - B_i); what that does to det Jp and J is undone with one division.
  const double D2_1 = legs[0].D2, D2_2 = legs[1].D2;
  const Vector2 u1 = legs[0].along * D2_1 - b1, u2 = legs[1].along * D2_2 - b2;
  const double scaled_det = cross(u1, u2), both = D2_1 * D2_2;
  const double t1 = mode.left < 0 ? legs[0].root : -legs[0].root,
               t2 = mode.right < 0 ? legs[1].root : -legs[1].root;
  result.jacobian = usual_jacobian(u1, u2, t1 * D2_1, t2 * D2_2, scaled_det);
  for (int i = 0; i < 2; ++i) {
    if (!within(ranges[i], result.theta[i])) {
      result.status = SolveStatus::joint_limit;
      result.joint = i;
      return result;
    }
  }
  result.status =
      near_singular(geometry, t1, t2, scaled_det, both) ? SolveStatus::degraded : SolveStatus::reached;
  return result;
}

FiveBarSolutions five_bar_inverse_all(const FiveBarGeometry& geometry, const Vector2& position) noexcept {
  FiveBarSolutions result;
  if (!can_assemble(geometry)) return result;
  const std::array<LegReach, 2> legs = {leg_reach(geometry, position, 0), leg_reach(geometry, position, 1)};
  result.status = std::max(legs[0].status, legs[1].status);
  if (result.status != SolveStatus::reached) return result;
  for (const WorkingMode mode : kWorkingModes) {
    // On a boundary circle both signs give the same crank.
    if ((mode.left < 0 && legs[0].root == 0.0) || (mode.right < 0 && legs[1].root == 0.0)) continue;
    const Vector2 theta(crank_angle(scaled_crank(legs[0], mode.left)),
                        crank_angle(scaled_crank(legs[1], mode.right)));
    int at = result.count++;
    const auto before = [&](const Vector2& other) {
      return theta[0] < other[0] || (theta[0] == other[0] && theta[1] < other[1]);
    };
    for (; at > 0 && before(result.theta[at - 1]); --at) {
      result.theta[at] = result.theta[at - 1];
      result.mode[at] = result.mode[at - 1];
    }
    result.theta[at] = theta;
    result.mode[at] = mode;
  }
  return result;
}

WorkingMode working_mode(const FiveBarGeometry& geometry, const Vector2& theta,
                         const Vector2& position) noexcept {
  const Vector2 Jt = FiveBarState(geometry, theta, position).jacobian_theta();
  return {.left = Jt[0] > 0.0 ? -1 : 1, .right = Jt[1] > 0.0 ? -1 : 1};
}

int assembly_mode(const FiveBarGeometry& geometry, const Vector2& theta, const Vector2& position) noexcept {
  return FiveBarState(geometry, theta, position).det_p() < 0.0 ? -1 : 1;
}

const char* to_string(LegShape shape) noexcept {
  switch (shape) {
    case LegShape::stretched:
      return "stretched";
    case LegShape::folded:
      return "folded";
    case LegShape::bent:
      break;
  }
  return "bent";
}

const char* to_string(CouplerShape shape) noexcept {
  switch (shape) {
    case CouplerShape::elbows_coincide:
      return "elbows coincide";
    case CouplerShape::aligned:
      return "couplers aligned";
    case CouplerShape::open:
      break;
  }
  return "open";
}

FiveBarState::FiveBarState(const FiveBarGeometry& geometry, const Vector2& theta,
                           const Vector2& position) noexcept
    : geometry_(geometry), theta_(theta), p_(position) {
  for (int i = 0; i < 2; ++i) {
    const auto [sine, cosine] = sine_cosine(theta[i]);
    const Vector2 b(geometry.crank * cosine, geometry.crank * sine), O = motor_axis(geometry, i);
    B_[i] = O + b;
    const Vector2 u = (p_ - O) - b;
    Jp_.row(i) = u;
    Jt_[i] = cross(b, u);
  }
  det_p_ = Jp_(0, 0) * Jp_(1, 1) - Jp_(0, 1) * Jp_(1, 0);
}

std::optional<Matrix2> FiveBarState::inverse_jacobian() const noexcept {
  const double least = kSingular * geometry_.crank * geometry_.coupler;
  if (!(Jt_.cwiseAbs().minCoeff() >= least)) return std::nullopt;
  return Matrix2(Jt_.cwiseInverse().asDiagonal() * Jp_);  // (5)
}

std::optional<Matrix2> FiveBarState::jacobian() const noexcept {
  if (!(std::abs(det_p_) >= kSingular * geometry_.coupler * geometry_.coupler)) return std::nullopt;
  return usual_jacobian(Jp_.row(0), Jp_.row(1), Jt_[0], Jt_[1], det_p_);
}

std::optional<Matrix2> FiveBarState::jacobian_rate(const Vector2& theta_rate) const noexcept {
  const std::optional<Matrix2> J = jacobian();
  if (!J) return std::nullopt;
  const Vector2 pdot = *J * theta_rate;
  Matrix2 right;  // d/dt of Jp J = Jtheta
  for (int i = 0; i < 2; ++i) {
    const Vector2 O = motor_axis(geometry_, i), b = B_[i] - O, bdot = left_of(b) * theta_rate[i];
    right.row(i) = -(pdot - bdot).transpose() * *J;
    right(i, i) += cross(bdot, p_ - O) + cross(b, pdot);
  }
  Matrix2 inverse;
  inverse << Jp_(1, 1), -Jp_(0, 1), -Jp_(1, 0), Jp_(0, 0);
  return Matrix2(inverse * right / det_p_);
}

std::optional<Vector2> FiveBarState::torque_from_force(const Vector2& force) const noexcept {
  const std::optional<Matrix2> J = jacobian();
  if (!J) return std::nullopt;
  return Vector2(J->transpose() * force);
}

std::optional<Vector2> FiveBarState::force_from_torque(const Vector2& torque) const noexcept {
  const std::optional<Matrix2> J = inverse_jacobian();
  if (!J) return std::nullopt;
  return Vector2(J->transpose() * torque);
}

std::optional<Ellipse> FiveBarState::force_ellipse() const noexcept {
  const std::optional<Matrix2> J = inverse_jacobian();
  if (!J) return std::nullopt;
  return ellipse_of(*J);
}

std::optional<Ellipse> FiveBarState::velocity_ellipse() const noexcept {
  const std::optional<Matrix2> J = jacobian();
  if (!J) return std::nullopt;
  return ellipse_of(J->transpose());
}

double FiveBarState::condition_number() const noexcept {
  // | |cos alpha| - 1 | <= 1e-9 for the angle alpha between crank and O C, by its sine.
  constexpr double kSine2 = 2e-9 - 1e-18;
  for (int i = 0; i < 2; ++i) {
    const double limit = geometry_.crank * geometry_.crank * (p_ - motor_axis(geometry_, i)).squaredNorm();
    if (!(Jt_[i] * Jt_[i] > kSine2 * limit)) return kInfinity;
  }
  // A multiple of J that needs no division: rows Jp_1 Jtheta_22 and Jp_2 Jtheta_11.
  const double S = Jp_.row(0).squaredNorm() * (Jt_[1] * Jt_[1]) + Jp_.row(1).squaredNorm() * (Jt_[0] * Jt_[0]);
  const double delta = std::abs(Jt_[0] * Jt_[1] * det_p_);
  if (!(delta > 1e-12 * S)) return kInfinity;
  return (S + std::sqrt(std::max(S - 2.0 * delta, 0.0) * (S + 2.0 * delta))) / (2.0 * delta);
}

Vector2 FiveBarState::inverse_singularity() const noexcept {
  return Jt_ / (geometry_.crank * geometry_.coupler);
}

double FiveBarState::direct_singularity() const noexcept {
  return det_p_ / (geometry_.coupler * geometry_.coupler);
}

FiveBarSingularity FiveBarState::singularity(double tolerance) const noexcept {
  FiveBarSingularity result;
  const Vector2 sides = inverse_singularity();
  for (int i = 0; i < 2; ++i) {
    if (std::abs(sides[i]) > tolerance) continue;
    const bool along = (B_[i] - motor_axis(geometry_, i)).dot(Jp_.row(i)) > 0.0;
    result.leg[i] = along ? LegShape::stretched : LegShape::folded;
  }
  if (std::abs(direct_singularity()) <= tolerance) {
    result.couplers = Jp_.row(0).dot(Jp_.row(1)) > 0.0 ? CouplerShape::elbows_coincide : CouplerShape::aligned;
  }
  return result;
}

FiveBarConditions avoidance_conditions(const FiveBarGeometry& geometry) noexcept {
  const double r1 = geometry.crank, r2 = geometry.coupler, r3 = geometry.half_base;
  const FiveBarGeometry n = normalised_lengths(geometry);
  const auto open = [](double value, double limit) { return value > 0.0 && value < limit; };
  // |B1 B2| ranges over [max(0, 2 (r3 - r1)), 2 (r1 + r3)]. Equality counts, however the lengths were rounded.
  const double rounding = kReachTolerance * geometry.scale();
  return {.elbows_can_coincide = r3 <= r1 + rounding,
          .couplers_can_align = r3 - r1 <= r2 + rounding && r2 <= r1 + r3 + rounding,
          .can_assemble = can_assemble(geometry),
          .parallelogram = std::abs(r2 - r3) <= rounding,
          .lengths_in_range = open(n.crank, 3.0) && open(n.coupler, 3.0) && open(n.half_base, 1.5)};
}

std::optional<FiveBarInscribedCircle> inscribed_circle(const FiveBarGeometry& geometry) noexcept {
  if (!can_assemble(geometry)) return std::nullopt;
  const double longer = std::max(geometry.crank, geometry.coupler), r3 = geometry.half_base;
  if (!(longer >= r3)) return std::nullopt;
  return FiveBarInscribedCircle{.radius = std::min(geometry.crank, geometry.coupler),
                                .centre_y = std::sqrt((longer - r3) * (longer + r3))};
}

}  // namespace zwidth
