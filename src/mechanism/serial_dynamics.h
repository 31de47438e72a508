#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/mechanism/mechanism.h"
#include "zwidth/mechanism/sizes.h"

namespace zwidth {

/// Equations of motion of a serial arm straight from its joint values, by the recursive Newton–Euler algorithm
/// (Luh, Walker & Paul 1980): the fast way for a control cycle. `inverse_dynamics` and `forward_dynamics` of a
/// posture give the same numbers, of any mechanism.
///
/// Joint values may lie beyond their ranges. Nothing here allocates. REQUIRES everywhere: vectors of
/// joint_count() finite numbers; pushes empty, or six.
class SerialDynamics {
 public:
  /// Nothing unless `mechanism.serial()`. What is made of it does not follow later changes of the mechanism.
  static std::optional<SerialDynamics> of(const Mechanism& mechanism);

  int joint_count() const noexcept { return count_; }

  /// Torques [N m, N] that produce `acceleration` [rad/s^2, m/s^2] at `rate` [rad/s, m/s] against weight, drive
  /// inertia and the wrench `push` that the user exerts on the tool (base frame, linear over angular [N, N m]).
  void inverse(const ActiveVector& joints, const ActiveVector& rate, const ActiveVector& acceleration,
               const ToolVector& push, ActiveVector& torque) const noexcept;
  ActiveVector inverse(const ActiveVector& joints, const ActiveVector& rate, const ActiveVector& acceleration,
                       const ToolVector& push = {}) const noexcept;

  /// Mass matrix with drive inertia [kg m^2, kg].
  ActiveMatrix mass_matrix(const ActiveVector& joints) const noexcept;

  /// Accelerations [rad/s^2, m/s^2] under `torque` [N m, N] and `push`.
  ActiveVector forward(const ActiveVector& joints, const ActiveVector& rate, const ActiveVector& torque,
                       const ToolVector& push = {}) const noexcept;

 private:
  // Three doubles without Eigen's alignment, so that the recursion stays in registers.
  struct Vec {
    double x = 0.0, y = 0.0, z = 0.0;
  };
  // A turn by its columns.
  struct Turn {
    Vec x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
  };
  // A rigid body about the origin of its frame: mass, mass times centre, inertia.
  struct Inertia {
    double mass = 0.0;
    Vec moment;
    double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
  };
  // One link. Its frame has z along the joint's axis and its origin at the joint's point, which a sliding joint
  // carries along.
  struct Link {
    Turn turn;   // from the inner link's frame to this one at joint value zero
    Vec offset;  // of the joint's point in the inner link's frame [m]
    Inertia body;
    double drive = 0.0;  // drive inertia
    bool slides = false;
    bool empty = true;  // no body
  };
  // A body on a pin of one link that another link turns.
  struct Hung {
    int carrier = 0, turner = 0;
    Vec pin;       // in the carrier's frame
    Inertia body;  // about the pin, in the turner's frame
  };
  struct Motion;
  struct Sines;

  static Vec vec(const Vector3& v) noexcept { return {v[0], v[1], v[2]}; }
  static Inertia inertia_of(double mass, const Vector3& centre, const Matrix3& inertia) noexcept;
  template <bool weight>
  void run(const Sines& sines, const double* joints, const double* rate, const double* acceleration,
           const double* push, double* torque) const noexcept;
  Sines sines_of(const double* joints) const noexcept;
  void mass_columns(const double* joints, double* columns) const noexcept;
  void inverse_flat(const double* joints, const double* rate, const double* acceleration, const double* push,
                    double* torque) const noexcept;
  Vec carried(Vec v, int from, int to, const Sines& sines) const noexcept;

  int count_ = 0;
  std::array<Link, kMaxActive> links_;
  std::vector<Hung> hung_;
  Vec gravity_;
  Vec tool_;  // from the last link's origin, in its frame
};

}  // namespace zwidth
