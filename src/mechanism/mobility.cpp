#include "zwidth/mechanism/mobility.h"

#include "zwidth/math/small_qr.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth {
namespace {

int rank(const Eigen::MatrixXd& matrix, Eigen::Index columns) {
  SmallQr<6 * kMaxLegs, kMaxJoints + 6> qr;
  qr.resize(static_cast<int>(matrix.rows()), static_cast<int>(columns));
  for (int c = 0; c < qr.columns(); ++c) {
    for (int r = 0; r < qr.rows(); ++r) qr.at(r, c) = matrix(r, c);
  }
  qr.factor();
  return qr.rank();
}

}  // namespace

Mobility mobility(const Posture& posture) {
  const Mechanism& mechanism = posture.mechanism();
  int rows = 0;
  for (const LegModel& leg : mechanism.legs()) rows += internal::closure_rows(leg);
  const int joints = mechanism.joint_count(), unknowns = joints + mechanism.tool_rows();

  // Closure equations A q - B x = 0 in all joint rates q and the platform's twist x.
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(rows, unknowns);
  int row = 0;
  for (int l = 0; l < static_cast<int>(mechanism.legs().size()); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    const int leg_rows = internal::closure_rows(leg);
    std::array<double, 6> column;
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      internal::closure_column(posture, l, j, column);
      for (int i = 0; i < leg_rows; ++i) equations(row + i, j) = column[i];
    }
    std::array<std::array<double, 6>, 6> platform;
    internal::platform_columns(posture, l, platform);
    for (int c = 0; c < mechanism.tool_rows(); ++c) {
      for (int i = 0; i < leg_rows; ++i) equations(row + i, joints + c) = -platform[c][i];
    }
    row += leg_rows;
  }

  Mobility result;
  result.active = mechanism.active_count();
  result.gruebler = unknowns - rows;
  const int closure_rank = rank(equations, unknowns);
  result.freedoms = unknowns - closure_rank;
  result.redundant_equations = rows - closure_rank;
  // Freedoms that remain when the platform is held are the joints' own; the rest are the tool's.
  result.tool_freedoms = result.freedoms - (joints - rank(equations, joints));
  return result;
}

}  // namespace zwidth
