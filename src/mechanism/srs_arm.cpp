#include "zwidth/mechanism/srs_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/math/svd.h"
#include "zwidth/math/trigonometry.h"
#include "zwidth/math/vector_trigonometry.h"

namespace zwidth {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReachTolerance = 1e-12;   // relative overshoot that still counts as stretched or folded
constexpr double kStraight = 1e-9;          // |s4| below this is a singular elbow
constexpr double kOnAxis = 1e-10;           // distances from an axis below this count as zero [m]
constexpr double kSineTolerance = 1e-12;    // overshoot of |s3| that is rounding
constexpr double kSquareTolerance = 1e-15;  // undershoot of a squared length that is rounding [m^2]
constexpr double kSingularWrist = 1e-10;    // hypot(M13, M23) = |s6| below this
constexpr double kRotationTolerance = 1e-6;

// Of any length but zero.
SineCosine unit(double cosine, double sine) {
  const double scale = 1.0 / std::sqrt(cosine * cosine + sine * sine);
  return {.sine = sine * scale, .cosine = cosine * scale};
}
// Half a turn on, within (-pi, pi].
double opposite(double angle) {
  return angle > 0.0 ? angle - kPi : angle + kPi;
}

bool is_rotation(const Matrix3& C) {
  const Matrix3 gap = C.transpose() * C - Matrix3::Identity();
  return gap.cwiseAbs().maxCoeff() <= kRotationTolerance && C.determinant() > 0.0;
}
bool valid(const SrsLengths& lengths, const Vector3& r) {
  const double d3 = lengths.upper_arm, d4 = lengths.forearm;
  return std::isfinite(d3) && std::isfinite(d4) && d3 > 0.0 && d4 > 0.0 && r.allFinite();
}

// theta4 up to its sign, from w = 2 d3 d4 c4 and v = 2 d3 d4 |s4| (3.23, 3.24). v as a product of differences
// keeps its digits near the ends of the reach, where acos would lose half of them.
struct Bend {
  SrsStatus status = SrsStatus::solved;
  double sine = 0.0, cosine = 1.0, angle = 0.0;
};
Bend bend_of(const SrsLengths& lengths, double rr) {
  const double d3 = lengths.upper_arm, d4 = lengths.forearm, twice = 2.0 * d3 * d4;
  const double w = rr - d3 * d3 - d4 * d4;
  if (std::abs(w) > twice * (1.0 + kReachTolerance)) return {.status = SrsStatus::unreachable};
  const double shortest = d3 - d4, longest = d3 + d4;
  const double v = std::sqrt(std::max((rr - shortest * shortest) * (longest * longest - rr), 0.0));
  const SineCosine direction = unit(w, v);
  return {.status = v < kStraight * twice ? SrsStatus::singular_elbow : SrsStatus::solved,
          .sine = direction.sine,
          .cosine = direction.cosine,
          .angle = angle_of(w, v)};
}

// theta1..theta3 as sines and cosines, for theta4 >= 0.
using ArmDirections = std::array<SineCosine, 3>;

// Two postures of the links. Each has a second reading with theta4 < 0 and the forearm turned by half a turn:
// (theta3 + pi, -theta4, theta5 + pi), or where theta3 is given (theta1 + pi, -theta2, -theta4, theta5 + pi).
struct ArmRoots {
  SrsStatus status = SrsStatus::solved;
  Bend bend = {};
  std::array<ArmDirections, 2> root = {};
};

// theta2 = atan2(b p - a z, a p + b z): both arguments are p^2 + z^2 times sine and cosine.
SineCosine shoulder(double a, double b, double p, double z) {
  return unit(a * p + b * z, b * p - a * z);
}

ArmRoots arm_roots(const SrsLengths& lengths, const Vector3& r, const Bend& bend, SrsGiven given,
                   const SineCosine& fixed) {
  const double d3 = lengths.upper_arm, d4 = lengths.forearm;
  const double x = r.x(), y = r.y(), z = r.z();
  const double s4 = bend.sine, rho2 = x * x + y * y, b = d3 + d4 * bend.cosine;
  constexpr double kOnAxis2 = kOnAxis * kOnAxis;

  ArmRoots roots{.bend = bend};
  switch (given) {
    case SrsGiven::theta1: {  // (3.25)-(3.34)
      const double p = fixed.cosine * x + fixed.sine * y, k = fixed.cosine * y - fixed.sine * x;
      if (p * p + z * z < kOnAxis2) return {.status = SrsStatus::theta2_undefined};
      if (std::abs(k) > d4 * s4 * (1.0 + kSineTolerance)) return {.status = SrsStatus::no_solution_for_theta1};
      const double s3 = std::clamp(k / (d4 * s4), -1.0, 1.0), c3 = std::sqrt((1.0 - s3) * (1.0 + s3));
      const double a = d4 * c3 * s4;
      roots.root[0] = {fixed, shoulder(a, b, p, z), {.sine = s3, .cosine = c3}};
      roots.root[1] = {fixed, shoulder(-a, b, p, z), {.sine = s3, .cosine = -c3}};
      break;
    }
    case SrsGiven::theta2: {  // (3.35)-(3.43)
      const double across2 = fixed.sine * fixed.sine * rho2;
      if (across2 < kOnAxis2) return {.status = SrsStatus::theta1_undefined};
      const double K = b - fixed.cosine * z, D = across2 - K * K;
      if (D < -kSquareTolerance) return {.status = SrsStatus::no_solution_for_theta2};
      const double R = std::sqrt(std::max(D, 0.0));
      for (const double root : {R, -R}) {
        // theta1 = atan2(y s2, x s2) +- atan2(sqrt(D), K)
        const SineCosine t1 = unit(fixed.sine * (x * K - y * root), fixed.sine * (y * K + x * root));
        const double p = t1.cosine * x + t1.sine * y, k = t1.cosine * y - t1.sine * x;
        if (p * p + z * z < kOnAxis2) return {.status = SrsStatus::theta2_undefined};
        roots.root[root == R ? 0 : 1] = {t1, fixed, unit(fixed.cosine * p - fixed.sine * z, k)};
      }
      break;
    }
    case SrsGiven::theta3: {  // (3.44)-(3.57)
      if (rho2 < kOnAxis2) return {.status = SrsStatus::theta1_undefined};
      const double k = d4 * fixed.sine * s4, a = d4 * fixed.cosine * s4, D = rho2 - k * k;
      if (D < -kSquareTolerance) return {.status = SrsStatus::no_solution_for_theta3};
      const double p = std::sqrt(std::max(D, 0.0));
      if (p * p + z * z < kOnAxis2) return {.status = SrsStatus::theta2_undefined};
      // theta1 = atan2(y, x) - atan2(k, p)
      roots.root[0] = {unit(x * p + y * k, y * p - x * k), shoulder(a, b, p, z), fixed};
      roots.root[1] = {unit(y * k - x * p, -y * p - x * k), shoulder(a, b, -p, z), fixed};
      break;
    }
  }
  return roots;
}

ArmRoots arm_roots(const SrsLengths& lengths, const Vector3& r, SrsGiven given, double given_angle) {
  if (!valid(lengths, r) || !std::isfinite(given_angle)) return {.status = SrsStatus::invalid_argument};
  const Bend bend = bend_of(lengths, r.squaredNorm());
  if (bend.status != SrsStatus::solved) return {.status = bend.status};
  return arm_roots(lengths, r, bend, given, sine_cosine(given_angle));
}

// C(0, 4) = Rz(t1) Ry(t2) Rz(t3) Ry(t4).
Matrix3 forearm_rotation(const ArmDirections& t, double s4, double c4) {
  const auto [s1, c1] = t[0];
  const auto [s2, c2] = t[1];
  const auto [s3, c3] = t[2];
  const Vector3 x2(c1 * c2, s1 * c2, -s2), y2(-s1, c1, 0.0), z2(c1 * s2, s1 * s2, c2);
  const Vector3 x3 = c3 * x2 + s3 * y2;
  Matrix3 C;
  C.col(0) = c4 * x3 - s4 * z2;
  C.col(1) = c3 * y2 - s3 * x2;
  C.col(2) = s4 * x3 + c4 * z2;
  return C;
}

// theta5..theta7 with s6 >= 0 as directions, from M = C(0, 4)^T C (3.58)-(3.81); the other solution is
// (theta5 + pi, -theta6, theta7 + pi). theta7 comes from the second row of Rz(-theta5) M and not from M31 and
// M32, as (3.81) has it, because these two vanish with theta6. Where they do, theta5 is as given and `regular`
// is false.
struct Wrist {
  std::array<SineCosine, 3> t;
  bool regular = true;
};
Wrist wrist_directions(const Matrix3& forearm, const Matrix3& C, double open_theta5) {
  const Matrix3 M = forearm.transpose() * C;
  Wrist wrist;
  const double across = std::sqrt(M(0, 2) * M(0, 2) + M(1, 2) * M(1, 2));
  wrist.regular = across >= kSingularWrist;
  wrist.t[0] = wrist.regular ? SineCosine{.sine = M(1, 2) / across, .cosine = M(0, 2) / across}
                             : sine_cosine(open_theta5);
  wrist.t[1] = {.sine = across, .cosine = M(2, 2)};
  const auto [s5, c5] = wrist.t[0];
  wrist.t[2] = {.sine = c5 * M(1, 0) - s5 * M(0, 0), .cosine = c5 * M(1, 1) - s5 * M(0, 1)};
  return wrist;
}

// Directions on their way to angles, several at once.
template <int count>
class Angles {
 public:
  void set(int i, const SineCosine& direction) {
    sine_[i] = direction.sine;
    cosine_[i] = direction.cosine;
  }
  std::array<double, count> solve() const {
    std::array<double, count> angle;
    angles_of(cosine_, sine_, angle);
    return angle;
  }

 private:
  std::array<double, count> sine_{};
  std::array<double, count> cosine_{};
};

// The second reading of four angles, see ArmRoots.
void turn_forearm(SrsGiven given, double* theta) {
  if (given == SrsGiven::theta3) {
    theta[0] = opposite(theta[0]);
    theta[1] = -theta[1];
  } else {
    theta[2] = opposite(theta[2]);
  }
  theta[3] = -theta[3];
}

// Distance of an angle [rad] from 0 or pi, whichever is nearer.
double from_half_turns(double angle) {
  return std::abs(std::remainder(angle, kPi));
}
double from_quarter_turn(double angle) {
  return std::abs(std::remainder(angle - 0.5 * kPi, kPi));
}

}  // namespace

SrsForward srs_forward(const SrsLengths& lengths, const SrsAngles& theta) noexcept {
  std::array<double, 8> angles{}, sine, cosine;
  std::copy(theta.begin(), theta.end(), angles.begin());
  sine_cosines(angles, sine, cosine);
  const auto Rz = [&](int k) { return Vector3(cosine[k - 1], sine[k - 1], 0.0); };  // what u1 becomes
  // Columns of A = Rz(t1), B = A Ry(t2), G = B Rz(t3), H = G Ry(t4), E = H Rz(t5), F = E Ry(t6), C = F Rz(t7).
  const auto turned_z = [&](const Matrix3& from, int k) {
    const Vector3 cs = Rz(k);
    Matrix3 to;
    to.col(0) = cs.x() * from.col(0) + cs.y() * from.col(1);
    to.col(1) = cs.x() * from.col(1) - cs.y() * from.col(0);
    to.col(2) = from.col(2);
    return to;
  };
  const auto turned_y = [&](const Matrix3& from, int k) {
    const Vector3 cs = Rz(k);
    Matrix3 to;
    to.col(0) = cs.x() * from.col(0) - cs.y() * from.col(2);
    to.col(1) = from.col(1);
    to.col(2) = cs.x() * from.col(2) + cs.y() * from.col(0);
    return to;
  };
  const Matrix3 A = turned_z(Matrix3::Identity(), 1), B = turned_y(A, 2), G = turned_z(B, 3),
                H = turned_y(G, 4), E = turned_z(H, 5), F = turned_y(E, 6);
  const Vector3 forearm = lengths.forearm * H.col(2);

  SrsForward result;  // (3.5), (3.9), (5.3)-(5.17)
  Vector3& r = result.wrist.position;
  r = lengths.upper_arm * B.col(2) + forearm;
  result.wrist.rotation = turned_z(F, 7);
  auto& J = result.jacobian;
  const std::array<Vector3, 7> axis = {Vector3::UnitZ(), A.col(1), B.col(2), G.col(1),
                                       H.col(2),         E.col(1), F.col(2)};
  for (int i = 0; i < 7; ++i) {
    J.col(i).head<3>() = i < 2 ? axis[i].cross(r) : i < 4 ? axis[i].cross(forearm) : Vector3(Vector3::Zero());
    J.col(i).tail<3>() = axis[i];
  }
  return result;
}

std::string_view to_string(SrsStatus status) {
  switch (status) {
    case SrsStatus::solved:
      return "solved";
    case SrsStatus::invalid_argument:
      return "invalid_argument";
    case SrsStatus::unreachable:
      return "unreachable";
    case SrsStatus::singular_elbow:
      return "singular_elbow";
    case SrsStatus::theta1_undefined:
      return "theta1_undefined";
    case SrsStatus::theta2_undefined:
      return "theta2_undefined";
    case SrsStatus::no_solution_for_theta1:
      return "no_solution_for_theta1";
    case SrsStatus::no_solution_for_theta2:
      return "no_solution_for_theta2";
    case SrsStatus::no_solution_for_theta3:
      return "no_solution_for_theta3";
    case SrsStatus::singular_wrist:
      return "singular_wrist";
  }
  return "";
}

SrsArmSolutions srs_arm_inverse(const SrsLengths& lengths, const Vector3& wrist, SrsGiven given,
                                double angle) noexcept {
  SrsArmSolutions result;
  const ArmRoots roots = arm_roots(lengths, wrist, given, angle);
  result.status = roots.status;
  if (roots.status != SrsStatus::solved) return result;
  Angles<8> directions;
  for (int n = 0; n < 2; ++n) {
    for (int i = 0; i < 3; ++i) directions.set(4 * n + i, roots.root[n][i]);
  }
  const std::array<double, 8> angles = directions.solve();
  for (int n = 0; n < 2; ++n) {
    std::array<double, 4>& theta = result.theta[result.count++];
    std::copy_n(angles.begin() + 4 * n, 3, theta.begin());
    theta[3] = roots.bend.angle;
    std::array<double, 4>& other = result.theta[result.count++];
    other = theta;
    turn_forearm(given, other.data());
  }
  return result;
}

SrsSolutions srs_inverse(const SrsLengths& lengths, const Pose& wrist, SrsGiven given, double angle,
                         double open_theta5) noexcept {
  SrsSolutions result;
  if (!wrist.rotation.allFinite() || !is_rotation(wrist.rotation)) {
    result.status = SrsStatus::invalid_argument;
    return result;
  }
  const ArmRoots roots = arm_roots(lengths, wrist.position, given, angle);
  result.status = roots.status;
  if (roots.status != SrsStatus::solved) return result;
  Angles<16> directions;
  for (int n = 0; n < 2; ++n) {
    const ArmDirections& arm = roots.root[n];
    const Wrist hand = wrist_directions(forearm_rotation(arm, roots.bend.sine, roots.bend.cosine),
                                        wrist.rotation, open_theta5);
    if (!hand.regular) result.status = SrsStatus::singular_wrist;
    for (int i = 0; i < 3; ++i) {
      directions.set(8 * n + i, arm[i]);
      directions.set(8 * n + 4 + i, hand.t[i]);
    }
  }
  const std::array<double, 16> angles = directions.solve();
  for (int n = 0; n < 2; ++n) {
    SrsAngles theta;
    std::copy_n(angles.begin() + 8 * n, 7, theta.begin());
    theta[3] = roots.bend.angle;
    theta[4] = angles[8 * n + 4], theta[5] = angles[8 * n + 5], theta[6] = angles[8 * n + 6];
    for (const bool forearm_turned : {false, true}) {
      if (forearm_turned) {
        turn_forearm(given, theta.data());
        theta[4] = opposite(theta[4]);
      }
      for (const bool wrist_turned : {false, true}) {
        SrsAngles& one = result.theta[result.count++];
        one = theta;
        if (!wrist_turned) continue;
        one[4] = opposite(one[4]);
        one[5] = -one[5];
        one[6] = opposite(one[6]);
      }
    }
  }
  return result;
}

SrsElbowCircle srs_elbow_circle(const SrsLengths& lengths, const Vector3& wrist) noexcept {
  SrsElbowCircle circle;
  if (!valid(lengths, wrist)) {
    circle.status = SrsStatus::invalid_argument;
    return circle;
  }
  const double d3 = lengths.upper_arm, d4 = lengths.forearm, rr = wrist.squaredNorm();
  const Bend bend = bend_of(lengths, rr);
  circle.status = bend.status;
  if (bend.status == SrsStatus::unreachable) return circle;
  circle.bend = bend.angle;
  const double r = std::sqrt(rr);
  if (r < kOnAxis) {  // folded onto the shoulder: the elbow may be anywhere on a sphere, here on its equator
    circle.cosine_arm = Vector3(d3, 0.0, 0.0);
    circle.sine_arm = Vector3(0.0, d3, 0.0);
    return circle;
  }
  const Vector3 n = wrist / r;
  circle.centre = n * ((d3 * d3 + rr - d4 * d4) / (2.0 * r));
  const double radius = d3 * d4 * bend.sine / r;
  const bool along_z = std::hypot(n.x(), n.y()) < 1e-6;
  const Vector3 towards = along_z ? Vector3::UnitX() : Vector3::UnitZ();
  const Vector3 direction = (towards - n * n.dot(towards)).normalized();
  circle.cosine_arm = radius * direction;
  circle.sine_arm = radius * n.cross(direction);
  return circle;
}

double SrsElbowCircle::angle_of_elbow(const SrsLengths& lengths, const SrsAngles& theta) const noexcept {
  const SineCosine t1 = sine_cosine(theta[0]), t2 = sine_cosine(theta[1]);
  const Vector3 elbow = lengths.upper_arm * Vector3(t1.cosine * t2.sine, t1.sine * t2.sine, t2.cosine);
  return angle_of(elbow.dot(cosine_arm), elbow.dot(sine_arm));
}

SrsAngles srs_on_circle(const SrsLengths& lengths, const Pose& wrist, const SrsElbowCircle& circle,
                        double elbow, int branch, const SrsAngles& near) noexcept {
  const double sigma4 = (branch & 2) != 0 ? -1.0 : 1.0, sigma2 = (branch & 4) != 0 ? -1.0 : 1.0;
  const SineCosine at = sine_cosine(elbow);
  const Vector3 e = circle.centre + at.cosine * circle.cosine_arm + at.sine * circle.sine_arm;
  ArmDirections t;
  const double across = std::sqrt(e.x() * e.x() + e.y() * e.y());
  t[0] = across < kOnAxis ? sine_cosine(near[0]) : unit(sigma2 * e.x(), sigma2 * e.y());
  t[1] = unit(e.z(), sigma2 * across);
  const Vector3 f = wrist.position - e;
  const auto [s1, c1] = t[0];
  const auto [s2, c2] = t[1];
  const double fx = c2 * (c1 * f.x() + s1 * f.y()) - s2 * f.z(), fy = c1 * f.y() - s1 * f.x();
  const double straight = kStraight * lengths.forearm;
  t[2] = fx * fx + fy * fy < straight * straight ? sine_cosine(near[2]) : unit(sigma4 * fx, sigma4 * fy);
  const SineCosine bend = sine_cosine(circle.bend);
  const Wrist hand =
      wrist_directions(forearm_rotation(t, sigma4 * bend.sine, bend.cosine), wrist.rotation, near[4]);

  Angles<8> directions;
  for (int i = 0; i < 3; ++i) {
    directions.set(i, t[i]);
    directions.set(4 + i, hand.t[i]);
  }
  const std::array<double, 8> angles = directions.solve();
  SrsAngles theta = {angles[0], angles[1], angles[2], sigma4 * circle.bend, angles[4], angles[5], angles[6]};
  if ((branch & 1) != 0 && hand.regular) {
    theta[4] = opposite(theta[4]);
    theta[5] = -theta[5];
    theta[6] = opposite(theta[6]);
  }
  return theta;
}

namespace {

// What vanishes where a joint has an angle, or its other reading; affine in the elbow point e, because on its
// circle e.r, |e| and |r - e| do not change.
double off_angle(const SrsLengths& lengths, const Pose& wrist, const Vector3& e, int joint,
                 const SineCosine& angle) {
  const double d3 = lengths.upper_arm, d4 = lengths.forearm;
  const Vector3 &r = wrist.position, f = r - e, u7 = wrist.rotation.col(2);
  const auto across = [&](double cosine, double sine) { return sine * angle.cosine - cosine * angle.sine; };
  switch (joint) {
    case 0:  // the upper arm is d3 (c1 s2, s1 s2, c2)
      return across(e.x(), e.y());
    case 1:
      return e.z() - d3 * angle.cosine;
    case 2:  // a = d4 c3 s4 and k = d4 s3 s4 (3.16, 3.17), times s2 d3
      return across(e.z() * e.dot(r) / d3 - d3 * r.z(), e.x() * r.y() - e.y() * r.x());
    case 4:  // M13 = s6 c5 and M23 = s6 s5, times d3 d4 s4; axis 4 lies along e x f
      return across(u7.dot(e.cross(f).cross(f)) / d4, u7.dot(e.cross(f)));
    case 5:
      return u7.dot(f) - d4 * angle.cosine;
    default: {  // M31 = -s6 c7 and M32 = s6 s7, times d4
      const Vector3 h = wrist.rotation.transpose() * f;
      return across(-h.x(), h.y());
    }
  }
}

}  // namespace

SrsElbows srs_elbows_with(const SrsLengths& lengths, const Pose& wrist, const SrsElbowCircle& circle, int joint,
                          double angle) noexcept {
  const SineCosine wanted = sine_cosine(angle);
  const auto off = [&](const Vector3& arm) {
    return off_angle(lengths, wrist, circle.centre + arm, joint, wanted);
  };
  // a cos + b sin + c, from three elbows.
  const double ahead = off(circle.cosine_arm), behind = off(-circle.cosine_arm), beside = off(circle.sine_arm);
  const double a = 0.5 * (ahead - behind), c = 0.5 * (ahead + behind), b = beside - c;
  const double amplitude = std::sqrt(a * a + b * b);
  const double size = lengths.upper_arm + lengths.forearm;
  const double rounding = 1e-14 * (joint == 2 || joint == 4 ? size * size : size);
  SrsElbows elbows;
  if (amplitude < rounding || std::abs(c) > amplitude + rounding) return elbows;
  const double middle = angle_of(a, b),
               half = angle_of(-c, std::sqrt(std::max(amplitude * amplitude - c * c, 0.0)));
  elbows.elbow[elbows.count++] = middle + half;
  if (half > 0.0 && half < kPi) elbows.elbow[elbows.count++] = middle - half;
  return elbows;
}

Interval srs_reach(const SrsLengths& lengths, const Interval& theta4) noexcept {
  const double d3 = lengths.upper_arm, d4 = lengths.forearm;
  const auto holds = [&](double angle) {  // some whole number of turns from it
    return angle + 2.0 * kPi * std::ceil((theta4.min - angle) / (2.0 * kPi)) <= theta4.max;
  };
  const double first = std::cos(theta4.min), last = std::cos(theta4.max);
  const double largest = holds(0.0) ? 1.0 : std::max(first, last);
  const double smallest = holds(kPi) ? -1.0 : std::min(first, last);
  // r^2 = d3^2 + d4^2 + 2 d3 d4 c4 (3.22), as a square and what is missing to it: exact where c4 is 1 or -1.
  const double longest = d3 + d4, shortest = d3 - d4;
  return {std::sqrt(shortest * shortest + 2.0 * d3 * d4 * (1.0 + smallest)),
          std::sqrt(std::max(longest * longest - 2.0 * d3 * d4 * (1.0 - largest), 0.0))};
}

SrsReach::SrsReach(const SrsLengths& lengths, const std::array<Interval, 4>& ranges) noexcept
    : lengths_(lengths) {
  constexpr double kSlack = 1e-12;  // [rad]
  for (int i = 0; i < 4; ++i) {
    Window& window = window_[i];
    const double half = 0.5 * ranges[i].width();
    window.cos_middle = std::cos(ranges[i].middle());
    window.sin_middle = std::sin(ranges[i].middle());
    window.bounded = half < kPi;
    window.locked = half < kSlack;
    window.cos_half = window.bounded ? std::cos(half + kSlack) : -2.0;
    for (int e = 0; e < 2; ++e) {
      const double end = e == 0 ? ranges[i].min : ranges[i].max;
      window.end[e] = {std::sin(end), std::cos(end)};
    }
  }
}

// Whether either reading of the posture has all its joints within their ranges, apart from the one that was
// given.
template <class Root>
bool SrsReach::within(const Root& root, int given) const noexcept {
  const auto inside = [&](int i, double sine, double cosine) {
    const Window& w = window_[i];
    return cosine * w.cos_middle + sine * w.sin_middle >= w.cos_half;
  };
  for (const double sigma : {1.0, -1.0}) {  // of theta4
    if (!inside(3, sigma * root.s4, root.c4)) continue;
    std::array<SineCosine, 3> t = root.t;
    if (sigma < 0.0) {  // see ArmRoots
      if (given == 2) {
        t[0] = {.sine = -t[0].sine, .cosine = -t[0].cosine};
        t[1].sine = -t[1].sine;
      } else {
        t[2] = {.sine = -t[2].sine, .cosine = -t[2].cosine};
      }
    }
    bool all = true;
    for (int i = 0; i < 3 && all; ++i) all = i == given || inside(i, t[i].sine, t[i].cosine);
    if (all) return true;
  }
  return false;
}

bool SrsReach::contains(const Vector3& wrist) const noexcept {
  constexpr double kOff = 1e-9;  // [m]
  if (wrist.x() * wrist.x() + wrist.y() * wrist.y() >= kOff * kOff) return off_axis_contains(wrist);
  // On axis 1 every theta1 does: a point beside the axis, in the middle of what theta1 may be, stands for it.
  const Vector3 aside = kOff * Vector3(window_[0].cos_middle, window_[0].sin_middle, 0.0);
  const Vector3 on_axis(0.0, 0.0, wrist.z());
  return off_axis_contains(on_axis + aside) || off_axis_contains(on_axis - aside);
}

bool SrsReach::off_axis_contains(const Vector3& wrist) const noexcept {
  struct Root {
    std::array<SineCosine, 3> t;
    double s4, c4;
  };
  const Bend bend = bend_of(lengths_, wrist.squaredNorm());
  if (bend.status == SrsStatus::unreachable) return false;
  const Window& w4 = window_[3];
  const double along = bend.cosine * w4.cos_middle, across = std::abs(bend.sine * w4.sin_middle);
  if (along + across < w4.cos_half) return false;  // neither theta4 nor -theta4

  const auto try_given = [&](int i, const std::array<double, 2>& end) {
    const ArmRoots roots =
        arm_roots(lengths_, wrist, bend, SrsGiven(i + 1), {.sine = end[0], .cosine = end[1]});
    if (roots.status != SrsStatus::solved) return false;
    for (const ArmDirections& one : roots.root) {
      if (within(Root{one, bend.sine, bend.cosine}, i)) return true;
    }
    return false;
  };
  for (int i = 2; i >= 0 && bend.status == SrsStatus::solved;
       --i) {  // a locked joint leaves nothing else to try
    if (window_[i].locked) return try_given(i, window_[i].end[0]);
  }
  if (bend.status == SrsStatus::solved) {
    // The middle of theta3's range decides most points; then the ends of all ranges.
    if (try_given(2, {window_[2].sin_middle, window_[2].cos_middle})) return true;
    for (const int i : {2, 1, 0}) {
      if (!window_[i].bounded) continue;
      for (const auto& end : window_[i].end) {
        if (try_given(i, end)) return true;
      }
    }
  }
  // No joint meets an end anywhere on the elbow's circle: all of it is possible, or nothing, on either reading
  // of the shoulder.
  const SrsElbowCircle circle = srs_elbow_circle(lengths_, wrist);
  const Vector3 e = circle.centre + circle.cosine_arm, f = wrist - e;
  const double out = std::sqrt(e.x() * e.x() + e.y() * e.y());
  if (out == 0.0) return false;
  for (const double sigma2 : {1.0, -1.0}) {
    const SineCosine t1 = unit(sigma2 * e.x(), sigma2 * e.y()), t2 = unit(e.z(), sigma2 * out);
    const double fx = t2.cosine * (t1.cosine * f.x() + t1.sine * f.y()) - t2.sine * f.z();
    const double fy = t1.cosine * f.y() - t1.sine * f.x();
    const bool open = bend.status != SrsStatus::solved;  // stretched or folded: theta3 may be anything
    const SineCosine t3 =
        open ? SineCosine{.sine = window_[2].sin_middle, .cosine = window_[2].cos_middle} : unit(fx, fy);
    if (within(Root{{t1, t2, t3}, bend.sine, bend.cosine}, open ? 2 : -1)) return true;
  }
  return false;
}

std::array<SrsSingularity, 4> srs_singularities(const SrsAngles& theta) noexcept {
  const double t2 = from_half_turns(theta[1]), t3 = from_quarter_turn(theta[2]), t4 = from_half_turns(theta[3]),
               t5 = from_quarter_turn(theta[4]), t6 = from_half_turns(theta[5]);
  return {{{.name = "elbow",
            .what = "the arm is stretched or folded",
            .where = "theta4 = 0 or 180 deg",
            .carried = "a force along the line from shoulder to wrist",
            .distance = t4},
           {.name = "shoulder",
            .what = "the upper arm lies along axis 1, with axis 4 at right angles to axis 2",
            .where = "theta2 = 0 or 180 deg and theta3 = +-90 deg",
            .carried = "a force along the forearm",
            .distance = std::hypot(t2, t3)},
           {.name = "wrist",
            .what = "axis 7 lies along the forearm, with axis 6 at right angles to axis 4",
            .where = "theta6 = 0 or 180 deg and theta5 = +-90 deg",
            .carried = "a force along the upper arm",
            .distance = std::hypot(t6, t5)},
           {.name = "shoulder and wrist",
            .what = "the upper arm lies along axis 1, and axis 7 along the forearm",
            .where = "theta2 = 0 or 180 deg and theta6 = 0 or 180 deg",
            .carried = "a force and a moment along a screw that depends on the posture",
            .distance = std::hypot(t2, t6)}}};
}

std::array<double, 2> srs_position_minors(const SrsLengths& lengths, const SrsAngles& theta) noexcept {
  const SineCosine t2 = sine_cosine(theta[1]), t3 = sine_cosine(theta[2]), t4 = sine_cosine(theta[3]);
  const double common = -lengths.upper_arm * lengths.forearm * lengths.forearm * t4.sine * t4.sine;
  return {common * t3.cosine, common * t2.sine * t3.sine};
}

double srs_position_manipulability(const SrsLengths& lengths, const SrsAngles& theta) noexcept {
  // By Cauchy and Binet the determinant is the sum of the squared minors: no digits are lost near a
  // singularity.
  const Eigen::Matrix<double, 3, 4> J = srs_forward(lengths, theta).jacobian.topLeftCorner<3, 4>();
  double sum = 0.0;
  for (int left_out = 0; left_out < 4; ++left_out) {
    const auto column = [&](int i) { return Vector3(J.col(i < left_out ? i : i + 1)); };
    const double minor = column(0).dot(column(1).cross(column(2)));
    sum += minor * minor;
  }
  return std::sqrt(sum);
}

int srs_jacobian_rank(const SrsLengths& lengths, const SrsAngles& theta) {
  Eigen::Matrix<double, 6, 7> J = srs_forward(lengths, theta).jacobian;
  J.topRows<3>() /= lengths.upper_arm + lengths.forearm;
  return static_cast<int>((svd(J).sigma.array() > 1e-9).count());
}

}  // namespace zwidth
