#pragma once

#include <array>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/math/spatial.h"
#include "zwidth/mechanism/sizes.h"

namespace zwidth {

/// Where the tool of a serial arm is, and how it moves with the joints.
struct SerialForward {
  Pose tool;          ///< frame of the last row in the base frame
  Jacobian jacobian;  ///< 6 x joints: tool velocity per joint rate, linear over angular, base frame [m/rad or
                      ///< 1, 1 or 0]
};

/// A serial arm ready to compute with: Denavit-Hartenberg rows Rz(theta) Tz(d) Tx(a) Rx(alpha) from base to
/// tool (Denavit & Hartenberg 1955), any mix of revolute, prismatic and fixed ones. The fast way from joint
/// values to pose and Jacobian; the same arm as a leg of a `Mechanism` gives the same numbers.
class SerialChain {
 public:
  /// REQUIRES: `validate` finds nothing; at most kMaxActive rows move.
  explicit SerialChain(const SerialDescription& description);

  int joint_count() const noexcept { return joint_count_; }

  /// Pose and Jacobian of joint values [rad] or [m], which may lie beyond their ranges.
  /// No heap. REQUIRES: joints.size() == joint_count().
  void forward(const ActiveVector& joints, SerialForward& result) const noexcept;
  SerialForward forward(const ActiveVector& joints) const noexcept;
  /// The pose alone.
  Pose pose(const ActiveVector& joints) const noexcept;

  /// The same arm without the rows behind the last one that moves the tool point: what decides its position.
  /// Joints keep their order; those that are left out are the last ones.
  SerialChain position_part() const;

  /// A row of the table.
  struct Row {
    /// The angle alpha, if it only exchanges axes: most arms have no other.
    enum class Twist { none, quarter, minus_quarter, other };
    Twist twist = Twist::none;
    int joint = -1;                           ///< index of what moves it, -1 if fixed
    bool slides = false;                      ///< its joint adds to d; else to theta
    double theta = 0.0;                       ///< [rad]
    double d = 0.0, a = 0.0;                  ///< [m]
    double sin_theta = 0.0, cos_theta = 1.0;  ///< of a row that does not turn
    double sin_alpha = 0.0, cos_alpha = 1.0;
  };
  const std::vector<Row>& rows() const noexcept { return rows_; }

 private:
  template <bool with_jacobian>
  void run(const ActiveVector& joints, Pose& tool, Jacobian* jacobian) const noexcept;

  int joint_count_ = 0;
  std::vector<Row> rows_;
  std::array<double, kMaxActive> offset_{};  // theta of the rows that turn, by joint
  std::array<int, kMaxActive> slides_{};     // 1 for a joint that slides, so that its value is no angle
};

}  // namespace zwidth
