#include <Eigen/LU>
#include <Eigen/SVD>
#include <numbers>

#include "harness.h"

#include "zwidth/analysis/workspace.h"
#include "zwidth/mechanism/five_bar.h"

/// The map of the published five-bar: inverse kinematics, joint limits, Jacobian, condition number and axis
/// force limits at every lattice point, reduced to area, extremes and means. Beside it the same by the
/// textbook.

namespace {

using zwidth::Vector2;

constexpr double kPi = std::numbers::pi;
constexpr double kTorque = 0.5;

struct Reduced {
  long inside = 0;
  Eigen::Vector4d min = Eigen::Vector4d::Constant(1e300), max = -min, sum = Eigen::Vector4d::Zero();
};

// One point as one writes it down: cosine rule and atan2, inverse matrix, singular values.
void textbook_point(const zwidth::FiveBarDescription& d, const Vector2& C, Reduced& reduced) {
  Eigen::Matrix2d Jp, Jt = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vector2 O(i == 0 ? -d.half_base : d.half_base, 0.0);
    const double D = (C - O).norm();
    const double c = (d.crank * d.crank + D * D - d.coupler * d.coupler) / (2.0 * d.crank * D);
    if (!(std::abs(c) <= 1.0)) return;
    const double theta = std::atan2(C.y() - O.y(), C.x() - O.x()) + (i == 0 ? 1.0 : -1.0) * std::acos(c);
    const zwidth::Interval range = i == 0 ? d.left_range : d.right_range;
    const double turned = range.middle() + std::remainder(theta - range.middle(), 2.0 * kPi);
    if (!range.contains(turned, 1e-9)) return;
    const Vector2 crank = d.crank * Vector2(std::cos(theta), std::sin(theta)), coupler = C - O - crank;
    Jp.row(i) = coupler.transpose();
    Jt(i, i) = crank.x() * coupler.y() - crank.y() * coupler.x();
  }
  if (Jp.determinant() < 0.0) return;  // the other assembly mode
  const Eigen::Matrix2d J = Jp.inverse() * Jt;
  const Vector2 sigma = Eigen::JacobiSVD<Eigen::Matrix2d>(J).singularValues();
  Eigen::Vector4d values;
  values << sigma[0] / sigma[1], std::abs(J.determinant()), kTorque / J.row(0).cwiseAbs().maxCoeff(),
      kTorque / J.row(1).cwiseAbs().maxCoeff();
  ++reduced.inside;
  reduced.min = reduced.min.cwiseMin(values);
  reduced.max = reduced.max.cwiseMax(values);
  reduced.sum += values;
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  const double spacing = quick ? 5e-3 : 1e-3;
  const zwidth::FiveBarDescription five_bar{.crank = 0.10,
                                            .coupler = 0.15,
                                            .half_base = 0.03,
                                            .left_range = {85.0 * kPi / 180.0, 210.0 * kPi / 180.0},
                                            .right_range = {-30.0 * kPi / 180.0, 95.0 * kPi / 180.0}};
  zwidth::Description description;
  description.mechanism = five_bar;
  const zwidth::Mechanism mechanism(description);
  const zwidth::LatticeOptions options{.spacing = spacing,
                                       .limits = {.torque = zwidth::Vector3::Constant(kTorque)}};
  const zwidth::LatticeSweep sweep = sweep_workspace(mechanism, options);
  const auto first = [&](int axis) { return std::lround(sweep.bounds[axis].min / spacing); };
  const auto last = [&](int axis) { return std::lround(sweep.bounds[axis].max / spacing); };
  const auto textbook = [&] {
    Reduced reduced;
    for (long i = first(0); i <= last(0); ++i) {
      for (long j = first(1); j <= last(1); ++j) {
        textbook_point(five_bar, Vector2(static_cast<double>(i), static_cast<double>(j)) * spacing, reduced);
      }
    }
    return reduced;
  };
  const Reduced expected = textbook();
  if (expected.inside != sweep.inside || std::abs(expected.sum[0] / static_cast<double>(expected.inside) -
                                                  sweep.figures[0].mean) > 1e-9 * sweep.figures[0].mean) {
    std::fprintf(stderr, "bench_plane: the contestants disagree\n");
    return 1;
  }
  bench::Suite suite("Map of the five-bar, per lattice point of its box", bench::options_of(argc, argv));
  const auto points = static_cast<double>(sweep.lattice_points);
  suite.add("textbook: acos and atan2, Eigen inverse and SVD", points, [&](long n) {
    for (long k = 0; k < n; ++k) bench::keep(textbook().inside);
  });
  suite.add("zwidth sweep_workspace, one thread, extents included", points, [&](long n) {
    for (long k = 0; k < n; ++k) bench::keep(sweep_workspace(mechanism, options, {.threads = 1}).inside);
  });
  suite.run();
  return 0;
}
