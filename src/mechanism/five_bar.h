#pragma once

#include <array>
#include <optional>

#include "zwidth/description/description.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/solve_status.h"

/// The planar five-bar in closed form (Singh, Saha and Manivannan, as corrected in docs/devices/five-bar.md).
///
/// Base frame: origin midway between the motor axes O1 = (-r3, 0) and O2 = (r3, 0), x from the left motor to
/// the right one. Cranks of length r1 carry the elbows B1 and B2, couplers of length r2 meet in the tool point
/// C. Crank angles theta count from +x. Any one unit of length may be used throughout; torques come in force
/// times that unit. Everything here is noexcept and allocates nothing, unless it says otherwise.

namespace zwidth {

using Vector2 = Eigen::Vector2d;
using Matrix2 = Eigen::Matrix2d;

/// The lengths that kinematics needs.
struct FiveBarGeometry {
  double crank = 0.0;      ///< r1 [m]
  double coupler = 0.0;    ///< r2 [m]
  double half_base = 0.0;  ///< r3, half the distance of the motor axes [m]

  double scale() const { return crank + coupler + half_base; }
  bool operator==(const FiveBarGeometry&) const = default;
};

FiveBarGeometry five_bar_geometry(const FiveBarDescription& description);

/// Whether the lengths are finite and the legs can meet: r1, r2 > 0 and 0 <= r3 < r1 + r2. (With r3 = 0 both
/// motors share an axis, which the source leaves out.) Everything below may be
/// asked for other lengths too, and then finds nothing reachable.
bool can_assemble(const FiveBarGeometry& geometry) noexcept;

/// (r1, r2, r3) = 3 (a1, a2, a3)/(a1 + a2 + a3), the dimensionless lengths of the source.
FiveBarGeometry normalised_lengths(const FiveBarGeometry& geometry) noexcept;

/// Which root each leg takes: +1 if the crank lies counter-clockwise of the line from its motor to the tool, -1
/// if clockwise. With (+1, -1) the elbows point outwards where y > 0, and inwards where y < 0.
struct WorkingMode {
  int left = 1;    ///< s1
  int right = -1;  ///< s2
  bool operator==(const WorkingMode&) const = default;
};

/// All four, (+1, +1), (+1, -1), (-1, +1), (-1, -1).
inline constexpr std::array<WorkingMode, 4> kWorkingModes = {
    {{.left = 1, .right = 1}, {.left = 1, .right = -1}, {.left = -1, .right = 1}, {.left = -1, .right = -1}}};

WorkingMode working_mode(const FiveBarDescription& description);

// ------------------------------------------------------------------------------------------------ solving

struct FiveBarForward {
  SolveStatus status =
      SolveStatus::unreachable;        ///< reached, degraded, unreachable (elbows too far apart) or
                                       ///< degenerate (elbows coincide: C may be anywhere on a circle)
  Vector2 position = Vector2::Zero();  ///< C; zero unless reached or degraded [m]
  Matrix2 jacobian = Matrix2::Zero();  ///< pdot = jacobian thetadot; zero where det Jp = 0 [m/rad]
};

/// Tool position of two crank angles [rad]. `assembly_mode` +1: the tool lies to the left of the line from the
/// left elbow to the right one; -1: to its right. (Section 3.2, in a form that has no exceptional poses.)
FiveBarForward five_bar_forward(const FiveBarGeometry& geometry, const Vector2& theta,
                                int assembly_mode = 1) noexcept;

/// How many tool positions two crank angles have: 0, 1 (a direct singularity) or 2; none for a `degenerate`
/// pose, where they are infinitely many.
std::optional<int> five_bar_forward_count(const FiveBarGeometry& geometry, const Vector2& theta) noexcept;

struct FiveBarInverse {
  SolveStatus status = SolveStatus::unreachable;  ///< reached, degraded, unreachable, degenerate (tool on a
                                                  ///< motor axis with r1 = r2) or joint_limit
  int joint = -1;                                 ///< first leg at fault, 0 or 1; -1 if none
  Vector2 theta = Vector2::Zero();     ///< crank angles in (-pi, pi], also when one is beyond its limit [rad]
  Matrix2 jacobian = Matrix2::Zero();  ///< pdot = jacobian thetadot; zero where det Jp = 0 [m/rad]
};

/// Any crank angle.
inline constexpr std::array<Interval, 2> kAnyCrankAngle = {
    {{-3.14159265358979323846, 3.14159265358979323846}, {-3.14159265358979323846, 3.14159265358979323846}}};

/// Crank angles of a tool position [m] in one working mode (section 3.1). The range of each crank is checked
/// with 1e-9 rad and modulo a turn. Tests come in the order unreachable, degenerate, joint_limit.
FiveBarInverse five_bar_inverse(const FiveBarGeometry& geometry, const Vector2& position, WorkingMode mode = {},
                                const std::array<Interval, 2>& ranges = kAnyCrankAngle) noexcept;

/// The distinct crank angles of a tool position in all working modes, by theta1, then theta2. Modes that merge
/// at a boundary count once.
struct FiveBarSolutions {
  SolveStatus status = SolveStatus::unreachable;  ///< reached, unreachable or degenerate
  int count = 0;                                  ///< 4 inside, 2 on one boundary circle, 1 on two
  std::array<Vector2, 4> theta{};                 ///< [rad]
  std::array<WorkingMode, 4> mode{};              ///< the first of `kWorkingModes` that gives it
};
FiveBarSolutions five_bar_inverse_all(const FiveBarGeometry& geometry, const Vector2& position) noexcept;

/// The working mode and the assembly mode of a posture. Where a leg is straight, or the elbows coincide or lie
/// opposite each other, the sign is arbitrary.
WorkingMode working_mode(const FiveBarGeometry& geometry, const Vector2& theta,
                         const Vector2& position) noexcept;
int assembly_mode(const FiveBarGeometry& geometry, const Vector2& theta, const Vector2& position) noexcept;

// -------------------------------------------------------------------------------------------------- rates

/// Half axes of an ellipse, and the direction of its major axis from +x in [0, pi); 0 for a circle [rad].
struct Ellipse {
  double major = 0.0;
  double minor = 0.0;
  double direction = 0.0;
};

/// What a singular posture is called.
enum class LegShape { bent, stretched, folded };
enum class CouplerShape {
  open,
  elbows_coincide,  ///< B1 = B2: the tool turns freely about the common elbow
  aligned,          ///< B1, C, B2 on one line: the tool is free across it
};
const char* to_string(LegShape shape) noexcept;
const char* to_string(CouplerShape shape) noexcept;

struct FiveBarSingularity {
  std::array<LegShape, 2> leg = {LegShape::bent, LegShape::bent};
  CouplerShape couplers = CouplerShape::open;

  /// A leg is straight: on the boundary, where the tool loses a freedom.
  bool inverse() const { return leg[0] != LegShape::bent || leg[1] != LegShape::bent; }
  /// The tool gains a freedom that locked motors do not hold.
  bool direct() const { return couplers != CouplerShape::open; }
  bool combined() const { return inverse() && direct(); }
  bool none() const { return !inverse() && !direct(); }
};

/// One solved posture, from which rates, forces and singularities follow.
///
/// The source's J is the inverse of what is usually called so: thetadot = J pdot. Here `jacobian()` is the
/// usual one and `inverse_jacobian()` the source's.
class FiveBarState {
 public:
  /// REQUIRES: theta and position close the loop (from five_bar_forward or five_bar_inverse).
  FiveBarState(const FiveBarGeometry& geometry, const Vector2& theta, const Vector2& position) noexcept;

  const Vector2& theta() const { return theta_; }
  const Vector2& position() const { return p_; }
  const std::array<Vector2, 2>& elbows() const { return B_; }  ///< B1, B2 [m]

  /// Jp of Jp pdot = Jtheta thetadot; its rows are the couplers C - B_i [m].
  const Matrix2& jacobian_p() const { return Jp_; }
  /// Diagonal of Jtheta, (B_i - O_i) x (C - B_i) [m^2].
  const Vector2& jacobian_theta() const { return Jt_; }
  double det_p() const { return det_p_; }  ///< det Jp = (C - B1) x (C - B2) [m^2]

  /// J = Jtheta^-1 Jp (5) [rad/m]; none where a leg is straight, |Jtheta_ii| < 1e-12 r1 r2.
  std::optional<Matrix2> inverse_jacobian() const noexcept;
  /// Jp^-1 Jtheta [m/rad]; none where |det Jp| < 1e-12 r2^2.
  std::optional<Matrix2> jacobian() const noexcept;
  /// Time derivative of `jacobian()` at crank rates [rad/s] [m/(rad s)].
  std::optional<Matrix2> jacobian_rate(const Vector2& theta_rate) const noexcept;

  /// Crank torques [N m] that hold a force of the tool on its environment [N]: tau = J^-T f with the source's
  /// J. None where `jacobian()` is none.
  std::optional<Vector2> torque_from_force(const Vector2& force) const noexcept;
  /// Tool force [N] of crank torques [N m]: f = J^T tau. None where `inverse_jacobian()` is none.
  std::optional<Vector2> force_from_torque(const Vector2& torque) const noexcept;

  /// Tool forces of all torques of Euclidean length 1 N m [N]; none where `inverse_jacobian()` is none.
  std::optional<Ellipse> force_ellipse() const noexcept;
  /// Tool velocities of all crank rates of Euclidean length 1 rad/s [m/s]; none where `jacobian()` is none.
  std::optional<Ellipse> velocity_ellipse() const noexcept;

  /// K = sigma_max/sigma_min of J, at least 1; infinity at and within rounding of a singularity, that is where
  /// |det| <= 1e-12 of the squared norm, or the cosine between crank and O_i C is within 1e-9 of +-1.
  double condition_number() const noexcept;

  /// Jtheta_ii/(r1 r2), the sine of the angle between crank and coupler: zero where the leg is straight.
  Vector2 inverse_singularity() const noexcept;
  /// det Jp/r2^2, the sine of the angle between the couplers: zero where the elbows coincide or lie opposite.
  double direct_singularity() const noexcept;
  /// Names of the singularities whose measures above are at most `tolerance` in magnitude.
  FiveBarSingularity singularity(double tolerance = 1e-6) const noexcept;

 private:
  FiveBarGeometry geometry_;
  Vector2 theta_;
  Vector2 p_;
  std::array<Vector2, 2> B_;
  Matrix2 Jp_;
  Vector2 Jt_;
  double det_p_;
};

// ------------------------------------------------------------------------------------------------- design

/// The conditions (a)-(e) of section 3.4.3, each with the range in which it is exact.
struct FiveBarConditions {
  bool elbows_can_coincide = false;  ///< not (a): r3 <= r1
  bool couplers_can_align = false;   ///< not (b): r3 - r1 <= r2 <= r1 + r3
  bool can_assemble = false;         ///< (c): r3 < r1 + r2
  bool parallelogram = false;        ///< not (d): r2 = r3, singular for every theta1 = theta2
  bool lengths_in_range = false;     ///< (e): normalised lengths with 0 < r1, r2 < 3 and 0 < r3 < 1.5

  /// No direct and no combined singularity anywhere.
  bool all() const {
    return !elbows_can_coincide && !couplers_can_align && can_assemble && !parallelogram && lengths_in_range;
  }
};
FiveBarConditions avoidance_conditions(const FiveBarGeometry& geometry) noexcept;

/// Circle with its centre on the y axis, tangent to the outer and the inner boundary circles (section 5).
struct FiveBarInscribedCircle {
  double radius = 0.0;    ///< min(r1, r2) [m]
  double centre_y = 0.0;  ///< sqrt(max(r1, r2)^2 - r3^2) [m]
};
/// None where no such circle exists, r3 > max(r1, r2), or the lengths cannot be assembled.
std::optional<FiveBarInscribedCircle> inscribed_circle(const FiveBarGeometry& geometry) noexcept;

}  // namespace zwidth
