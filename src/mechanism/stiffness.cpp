#include "zwidth/mechanism/stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/math/elimination.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth {
namespace {

using internal::closure_column;
using internal::closure_rows;

// A leg with its passive joints eliminated: N^T A = 0.
struct EliminatedLeg {
  Elimination passive;
  int wrenches() const { return passive.rows() - passive.rank(); }
};

bool gives_way(const JointModel& joint, const StiffnessOptions& options) {
  return joint.active < 0 || joint.free || options.drives == DriveState::free;
}

double drive_compliance(const JointModel& joint, const StiffnessOptions& options) {
  if (joint.active < 0 || gives_way(joint, options) || options.drive_stiffness.size() == 0) return 0.0;
  return 1.0 / options.drive_stiffness[joint.active];  // 0 for an infinite one
}

void eliminate(const Posture& posture, int l, const StiffnessOptions& options, Elimination& passive) {
  const Mechanism& mechanism = posture.mechanism();
  const LegModel& leg = mechanism.legs()[l];
  int columns = 0;
  for (int j = leg.first; j < leg.first + leg.count; ++j)
    columns += gives_way(mechanism.joints()[j], options) ? 1 : 0;
  passive.resize(closure_rows(leg), columns);
  std::array<double, 6> column;
  int c = 0;
  for (int j = leg.first; j < leg.first + leg.count; ++j) {
    if (!gives_way(mechanism.joints()[j], options)) continue;
    closure_column(posture, l, j, column);
    for (int i = 0; i < passive.rows(); ++i) passive.at(i, c) = column[i];
    ++c;
  }
}

// A wrench at the outer end of a beam, in the beam's frame.
struct EndLoad {
  double f1, f2, f3, m1, m2, m3;
};

// Beams in a leg's chain as the loops below need them.
struct PlacedBeam {
  Vector3 e1, e2, e3, end;
  const BeamFlexibility* c;
};

PlacedBeam placed(const Posture& posture, const LegModel& leg, const BeamModel& beam) {
  const Mechanism& mechanism = posture.mechanism();
  const Matrix3& R = posture.link_rotation(beam.joint);
  const bool last = beam.joint + 1 == leg.first + leg.count;
  const Vector3& span = last ? leg.tip : mechanism.joints()[beam.joint + 1].offset;
  return {R * beam.frame.col(0), R * beam.frame.col(1), R * beam.frame.col(2),
          posture.joint_point(beam.joint) + R * span, &beam.flexibility};
}

// `wrench` about the tool point p.
EndLoad end_load(const PlacedBeam& beam, const Vector6& wrench, const Vector3& p) {
  const double fx = wrench[0], fy = wrench[1], fz = wrench[2];
  const double x = p[0] - beam.end[0], y = p[1] - beam.end[1], z = p[2] - beam.end[2];
  const double mx = wrench[3] + y * fz - z * fy, my = wrench[4] + z * fx - x * fz,
               mz = wrench[5] + x * fy - y * fx;
  const auto along = [](const Vector3& e, double a, double b, double c) {
    return e[0] * a + e[1] * b + e[2] * c;
  };
  return {along(beam.e1, fx, fy, fz), along(beam.e2, fx, fy, fz), along(beam.e3, fx, fy, fz),
          along(beam.e1, mx, my, mz), along(beam.e2, mx, my, mz), along(beam.e3, mx, my, mz)};
}

double work(const BeamFlexibility& c, const EndLoad& a, const EndLoad& b) {
  return c.stretch * a.f1 * b.f1 + c.deflection_y * a.f2 * b.f2 + c.deflection_z * a.f3 * b.f3 +
         c.twist * a.m1 * b.m1 + c.turn_y * a.m2 * b.m2 + c.turn_z * a.m3 * b.m3 +
         c.slope_z * (a.f2 * b.m3 + a.m3 * b.f2) + c.slope_y * (a.f3 * b.m2 + a.m2 * b.f3);
}

// What a wrench about the tool point does on joint j of its leg.
double joint_load(const Posture& posture, const LegModel& leg, int j, const Vector6& wrench) {
  const Vector3& axis = posture.joint_axis(j);
  const Vector3 force = wrench.head<3>();
  const std::vector<JointModel>& joints = posture.mechanism().joints();
  switch (joints[j].type) {
    case JointType::prismatic:
      return axis.dot(force);
    case JointType::parallelogram: {
      const bool last = j + 1 == leg.first + leg.count;
      const Vector3 bar = posture.link_rotation(j) * (last ? leg.tip : joints[j + 1].offset);
      return axis.dot(bar.cross(force));
    }
    case JointType::revolute:
      break;
  }
  const Vector3 arm = posture.tool().position - posture.joint_point(j);
  return axis.dot(wrench.tail<3>() + arm.cross(force));
}

// D = W^T C W of one leg, lower triangle.
void leg_compliance(const Posture& posture, const LegModel& leg, std::size_t& next_beam,
                    const StiffnessOptions& options, LegStiffness& result) {
  const Mechanism& mechanism = posture.mechanism();
  const Vector3& p = posture.tool().position;
  const int n = result.wrenches;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k <= i; ++k) result.compliance(i, k) = 0.0;
  }
  const std::vector<BeamModel>& beams = mechanism.beams();
  for (; next_beam < beams.size() && beams[next_beam].joint < leg.first + leg.count; ++next_beam) {
    const PlacedBeam beam = placed(posture, leg, beams[next_beam]);
    std::array<EndLoad, 6> loads;
    for (int i = 0; i < n; ++i) loads[i] = end_load(beam, result.wrench[i], p);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k <= i; ++k) result.compliance(i, k) += work(*beam.c, loads[i], loads[k]);
    }
  }
  for (int j = leg.first; j < leg.first + leg.count; ++j) {
    const double give = drive_compliance(mechanism.joints()[j], options);
    if (give == 0.0) continue;
    std::array<double, 6> loads;
    for (int i = 0; i < n; ++i) loads[i] = joint_load(posture, leg, j, result.wrench[i]);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k <= i; ++k) result.compliance(i, k) += give * loads[i] * loads[k];
    }
  }
}

// Cholesky: D = L L^T, and the rows of L^-1 W^T. False if D is singular.
bool find_roots(LegStiffness& leg) {
  constexpr double kSingular = 1e-13;  // of what was on the diagonal
  const int n = leg.wrenches;
  std::array<std::array<double, 6>, 6> L;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) {
      double sum = leg.compliance(i, k);
      for (int m = 0; m < k; ++m) sum -= L[i][m] * L[k][m];
      L[i][k] = sum * L[k][k];  // the diagonal holds reciprocals
    }
    const double own = leg.compliance(i, i);
    double pivot = own;
    for (int m = 0; m < i; ++m) pivot -= L[i][m] * L[i][m];
    if (!(pivot > kSingular * own)) return false;
    L[i][i] = 1.0 / std::sqrt(pivot);
    leg.root[i] = leg.wrench[i];
    for (int m = 0; m < i; ++m) leg.root[i] -= L[i][m] * leg.root[m];
    leg.root[i] *= L[i][i];
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) leg.compliance(k, i) = leg.compliance(i, k);
  }
  return true;
}

}  // namespace

Matrix6 LegStiffness::matrix() const noexcept {
  Matrix6 K = Matrix6::Zero();
  for (int i = 0; i < wrenches; ++i) K += root[i] * root[i].transpose();
  return K;
}

namespace {

constexpr double kFree = 1e-13;  // the square of what rounding leaves of a wrench that is not there

// Makes zero what is rounding beside the largest of its kind: forces, moments, or their mean where it is both.
void drop_rounding(Matrix6& K) noexcept {
  const double kinds[] = {K.diagonal().head<3>().maxCoeff(), K.diagonal().tail<3>().maxCoeff()};
  for (int r = 0; r < 6; ++r) {
    if (K(r, r) > kFree * kinds[r / 3]) continue;
    K.row(r).setZero();
    K.col(r).setZero();
  }
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) {
      if (K(r, c) * K(r, c) <= kFree * kFree * kinds[r / 3] * kinds[c / 3]) K(r, c) = 0.0;
    }
  }
}

}  // namespace

ZWIDTH_WIDE Stiffness stiffness(const Posture& posture, const StiffnessOptions& options) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const double length = mechanism.characteristic_length();
  Stiffness result;
  result.leg_count = static_cast<int>(mechanism.legs().size());

  std::array<EliminatedLeg, kMaxLegs> eliminated;
  for (int l = 0; l < result.leg_count; ++l) eliminate(posture, l, options, eliminated[l].passive);
  for (bool more = true; more;) {
    more = false;
    for (int l = 0; l < result.leg_count; ++l) more |= eliminated[l].passive.step();
  }

  result.rigid = false;
  result.rows = 3;
  std::size_t next_beam = 0;
  for (int l = 0; l < result.leg_count; ++l) {
    const LegModel& model = mechanism.legs()[l];
    const Elimination& passive = eliminated[l].passive;
    LegStiffness& leg = result.legs[l];
    leg.wrenches = eliminated[l].wrenches();
    const bool holds_turning = model.attachment == Attachment::rigid;
    if (holds_turning) result.rows = 6;
    const Vector3 arm = posture.leg_tip(l) - posture.tool().position;
    for (int i = 0; i < leg.wrenches; ++i) {
      const std::array<double, 8>& n = passive.left_over(i);
      Vector6& w = leg.wrench[i];
      // Rows of rotations are scaled by the length, so that their loads are moments over it.
      w[0] = n[0];
      w[1] = n[1];
      w[2] = n[2];
      w[3] = (holds_turning ? length * n[3] : 0.0) + arm[1] * n[2] - arm[2] * n[1];
      w[4] = (holds_turning ? length * n[4] : 0.0) + arm[2] * n[0] - arm[0] * n[2];
      w[5] = (holds_turning ? length * n[5] : 0.0) + arm[0] * n[1] - arm[1] * n[0];
    }
    leg_compliance(posture, model, next_beam, options, leg);
    if (!find_roots(leg)) {
      result.rigid = true;
      continue;
    }
    for (int i = 0; i < leg.wrenches; ++i) {
      const Vector6& g = leg.root[i];
      for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) result.matrix(r, c) += g[r] * g[c];
      }
    }
  }
  if (result.rows == 3) {
    result.matrix.bottomRows<3>().setZero();
    result.matrix.rightCols<3>().setZero();
  }
  drop_rounding(result.matrix);
  return result;
}

namespace {

// Of the leading block with N rows.
template <int N>
void invert(const Matrix6& K, double length, Compliance& result) {
  using Square = Eigen::Matrix<double, N, N>;
  Eigen::Matrix<double, N, 1> scale = Eigen::Matrix<double, N, 1>::Ones();
  if constexpr (N == 6) scale.template tail<3>().setConstant(1.0 / length);
  // Displacements d = S d' with rotations as lengths.
  const Square scaled = scale.asDiagonal() * K.topLeftCorner<N, N>() * scale.asDiagonal();
  // Most postures are far from free: 1/tr(K^-1) is not above the smallest eigenvalue, tr K not below the
  // largest.
  constexpr double kClearlyHeld = 1e-9;
  const Eigen::LLT<Square> factored(scaled);
  if (factored.info() == Eigen::Success) {
    const Square inverse = factored.solve(Square::Identity());
    if (1.0 > kClearlyHeld * scaled.trace() * inverse.trace()) {
      result.matrix.topLeftCorner<N, N>() =
          scale.asDiagonal() * (0.5 * (inverse + inverse.transpose())) * scale.asDiagonal();
      return;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Square> eigen(scaled);
  const double largest = eigen.eigenvalues()[N - 1];
  Square inverse;
  if (eigen.eigenvalues()[0] > kFree * largest) {
    inverse = scaled.ldlt().solve(Square::Identity());
    inverse = 0.5 * (inverse + inverse.transpose()).eval();
  } else {
    result.free = true;
    result.free_direction.template head<N>() = eigen.eigenvectors().col(0);
    inverse.setZero();
    for (int i = 0; i < N; ++i) {
      if (!(eigen.eigenvalues()[i] > kFree * largest)) continue;
      inverse += eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose() / eigen.eigenvalues()[i];
    }
  }
  result.matrix.topLeftCorner<N, N>() = scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace

Compliance compliance(const Stiffness& stiffness, double length) noexcept {
  assert(!stiffness.rigid && length > 0.0);
  Compliance result;
  if (stiffness.rows == 6) {
    invert<6>(stiffness.matrix, length, result);
  } else {
    invert<3>(stiffness.matrix, length, result);
  }
  return result;
}

std::optional<ToolMatrix> felt_stiffness(const Mechanism& mechanism, const Compliance& compliance) noexcept {
  const std::span<const int> axes = mechanism.tool_axes();
  ToolMatrix C(mechanism.tool_rows(), mechanism.tool_rows());
  ToolVector free(mechanism.tool_rows());
  for (std::size_t r = 0; r < axes.size(); ++r) {
    free[static_cast<Eigen::Index>(r)] = compliance.free_direction[axes[r]];
    for (std::size_t c = 0; c < axes.size(); ++c) {
      C(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = compliance.matrix(axes[r], axes[c]);
    }
  }
  constexpr double kRounding = 1e-9;
  if (compliance.free && free.norm() > kRounding) return std::nullopt;
  const Eigen::LDLT<ToolMatrix> factored(C);
  if (!factored.isPositive() || !(factored.vectorD().minCoeff() > 0.0)) return std::nullopt;
  ToolMatrix K = factored.solve(ToolMatrix::Identity(C.rows(), C.cols()));
  return ToolMatrix(0.5 * (K + K.transpose()));
}

std::optional<ComplianceShares> compliance_shares(const Posture& posture, const Stiffness& stiffness,
                                                  const Compliance& compliance, const Vector6& load,
                                                  const StiffnessOptions& options) noexcept {
  const Mechanism& mechanism = posture.mechanism();
  const Vector6 displacement = compliance.matrix * load;
  const double total = load.dot(displacement);
  if (!(total > 0.0) || (compliance.free && std::abs(load.dot(compliance.free_direction)) > 1e-9 * load.norm()))
    return std::nullopt;
  ComplianceShares shares;
  std::size_t next_beam = 0;
  for (int l = 0; l < stiffness.leg_count; ++l) {
    const LegModel& leg = mechanism.legs()[l];
    Vector6 carried = Vector6::Zero();
    const LegStiffness& own = stiffness.legs[l];
    for (int i = 0; i < own.wrenches; ++i) carried += own.root[i] * own.root[i].dot(displacement);
    const std::vector<BeamModel>& beams = mechanism.beams();
    for (; next_beam < beams.size() && beams[next_beam].joint < leg.first + leg.count; ++next_beam) {
      const PlacedBeam beam = placed(posture, leg, beams[next_beam]);
      const EndLoad end = end_load(beam, carried, posture.tool().position);
      shares.beams[next_beam] = work(*beam.c, end, end) / total;
    }
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const JointModel& joint = mechanism.joints()[j];
      const double give = drive_compliance(joint, options);
      if (give == 0.0) continue;
      const double torque = joint_load(posture, leg, j, carried);
      shares.drives[joint.active] = give * torque * torque / total;
    }
  }
  return shares;
}

StiffnessIndices stiffness_indices(const Matrix6& stiffness) noexcept {
  struct Block {
    double condition, determinant;
  };
  const auto of = [](const Matrix3& block) -> Block {
    const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(block, Eigen::EigenvaluesOnly);
    const Vector3 sizes = eigen.eigenvalues().cwiseAbs();
    if (!(sizes.minCoeff() > kFree * sizes.maxCoeff())) return {std::numeric_limits<double>::infinity(), 0.0};
    return {sizes.maxCoeff() / sizes.minCoeff(), block.determinant()};
  };
  const Block translation = of(stiffness.topLeftCorner<3, 3>()),
              rotation = of(stiffness.bottomRightCorner<3, 3>());
  return {.frobenius = stiffness.norm(),
          .condition_translation = translation.condition,
          .condition_rotation = rotation.condition,
          .determinant_translation = translation.determinant,
          .determinant_rotation = rotation.determinant};
}

}  // namespace zwidth
