#pragma once

#include <span>

#include "zwidth/mechanism/serial_chain.h"

/// A serial arm for many postures at once: structure of arrays, SIMD chosen at run time (Highway).
/// `SerialChain` and `dexterity` are the scalar twins. Jacobians are never written to memory: what is wanted of
/// one is reduced on the way.

namespace zwidth {

class SerialBatch {
 public:
  explicit SerialBatch(const SerialChain& chain);

  int joint_count() const { return joint_count_; }

  /// Tool positions [m] of joint values given joint after joint: joints[j n + p] is joint j of posture p [rad]
  /// or [m]. Joint angles must be below 1e5 rad. REQUIRES: x, y, z have n elements, joints n joint_count().
  void positions(std::span<const double> joints, std::span<double> x, std::span<double> y,
                 std::span<double> z) const;

  /// Which rows of the Jacobian.
  enum class Rows {
    position,  ///< of the tool point: 3
    pose,      ///< all 6, the angular ones times `length` so that they compare with the linear ones
  };
  /// Tool positions as above, and of the Jacobian J of each posture
  /// `manipulability`: sqrt(det(J J^T)), the product of its singular values (Yoshikawa 1985);
  /// `conditioning`: rows / (|J|_F |J^+|_F), the reciprocal of the condition number in the Frobenius norm: 1
  /// where all singular values are equal, 0 where one vanishes (Angeles 2014, section 5.8). Both lose digits,
  /// to half of them, towards a singularity. With fewer joints than rows both are 0. REQUIRES: as above;
  /// manipulability has n elements, conditioning as many or, where it is not asked for, none; length > 0.
  void dexterity(std::span<const double> joints, Rows rows, double length, std::span<double> x,
                 std::span<double> y, std::span<double> z, std::span<double> manipulability,
                 std::span<double> conditioning) const;

  /// What the kernels read.
  struct Parameters {
    int rows = 0;           ///< of the table
    int position_rows = 0;  ///< how many of them decide where the tool point is
    const SerialChain::Row* row = nullptr;
    int joints = 0;
  };

 private:
  Parameters parameters() const;

  std::vector<SerialChain::Row> rows_;
  int joint_count_ = 0;
  int position_rows_ = 0;
};

}  // namespace zwidth
