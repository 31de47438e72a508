#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "harness.h"

#include "zwidth/analysis/mechanical.h"
#include "zwidth/mechanism/batch_r_cube.h"
#include "zwidth/mechanism/loaded_stiffness.h"
#include "zwidth/mechanism/stiffness.h"

/// Stiffness of the R-CUBE, three legs with 18 virtual joints and 4 passive ones each, beside the matrices as
/// the method is written down, with Eigen.

namespace {

using zwidth::Matrix3;
using zwidth::Matrix6;
using zwidth::Vector3;

constexpr int kPostures = 256;

zwidth::Description device() {
  const zwidth::Material steel{.elastic_modulus = 200e9, .poisson_ratio = 0.3, .density = 7850.0};
  zwidth::Description description;
  description.name = "r-cube";
  description.mechanism = zwidth::RCubeDescription{.drive_link = 0.1117,
                                                   .inner_link = 0.0741,
                                                   .outer_link = 0.1218,
                                                   .base_offset = 0.1117,
                                                   .joint_range = {-0.5672, 0.5672}};
  for (const char* link : {"drive_link", "inner_link", "outer_link"}) {
    description.bodies.push_back({.on = link, .beam = zwidth::TubeDescription{0.01, 0.006, steel}});
  }
  return description;
}

// The leading block of the bordered inverse of each leg (Görgülü 2018, eq 5.122), summed up; the compliance of
// the springs is given.
struct Bordered {
  const zwidth::Mechanism& mechanism;
  std::vector<Matrix6> springs;

  explicit Bordered(const zwidth::Mechanism& of) : mechanism(of) {
    for (const zwidth::BeamModel& beam : of.beams())
      springs.push_back(zwidth::beam_compliance(beam.rigidity, beam.length));
  }

  Matrix6 operator()(const zwidth::Posture& posture) const {
    using Matrix10 = Eigen::Matrix<double, 10, 10>;
    const Vector3 P = posture.tool().position;
    Matrix6 K = Matrix6::Zero();
    for (int leg = 0; leg < 3; ++leg) {
      Matrix10 A = Matrix10::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t b = 3 * static_cast<std::size_t>(leg) + k;
        const zwidth::BeamModel& beam = mechanism.beams()[b];
        const Matrix3 R = posture.link_rotation(beam.joint) * beam.frame;
        const Vector3 arm = P - posture.joint_point(beam.joint) - beam.length * R.col(0);
        Matrix6 J = Matrix6::Zero();
        J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R;
        J.topRightCorner<3, 3>() = -zwidth::cross_matrix(arm) * R;
        const Matrix6 JC = J * springs[b];
        A.topLeftCorner<6, 6>().noalias() += JC * J.transpose();
      }
      for (int p = 0; p < 4; ++p) {
        const int j = 5 * leg + 1 + p;
        const Vector3& axis = posture.joint_axis(j);
        A.block<3, 1>(0, 6 + p) = axis.cross(P - posture.joint_point(j));
        A.block<3, 1>(3, 6 + p) = axis;
      }
      A.bottomLeftCorner<4, 6>() = A.topRightCorner<6, 4>().transpose();
      const Matrix10 inverse = A.partialPivLu().inverse();
      K += inverse.topLeftCorner<6, 6>();
    }
    return K;
  }
};

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  const zwidth::Mechanism mechanism(device());
  const Bordered bordered(mechanism);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-0.56, 0.56);
  std::vector<zwidth::Posture> postures;
  double worst = 0.0;
  for (int p = 0; p < kPostures; ++p) {
    const zwidth::Solution solution =
        zwidth::solve_forward(mechanism, Vector3(angle(random), angle(random), angle(random)));
    postures.push_back(*solution.posture);
    const Matrix6 expected = bordered(postures.back());
    worst = std::max(worst, (zwidth::stiffness(postures.back()).matrix - expected).cwiseAbs().maxCoeff() /
                                expected.cwiseAbs().maxCoeff());
  }
  std::printf("library and bordered inverse agree to %.1e\n\n", worst);

  bench::Suite one("R-CUBE: stiffness of a posture", options);
  one.add("Eigen, fixed size: bordered 10 x 10 inverse of every leg", kPostures, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const zwidth::Posture& posture : postures) bench::keep(bordered(posture));
    }
  });
  one.add("zwidth stiffness", kPostures, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const zwidth::Posture& posture : postures) bench::keep(zwidth::stiffness(posture));
    }
  });
  one.goal(1.5e-6);
  one.run();

  // The map of a cube of 120 mm at 2 mm.
  constexpr int kSide = 61;
  std::vector<double> x, y, z;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    x.push_back(0.1117 - 0.060 + 0.002 * (i % kSide));
    y.push_back(0.1117 - 0.060 + 0.002 * (i / kSide % kSide));
    z.push_back(0.1117 - 0.060 + 0.002 * (i / kSide / kSide));
  }
  zwidth::RCubeLinks links{
      .geometry = {.drive_link = 0.1117, .inner_link = 0.0741, .outer_link = 0.1218, .base_offset = 0.1117},
      .rigidity = {}};
  links.rigidity.fill(mechanism.beams().front().rigidity);
  const zwidth::RCubeStiffnessBatch batch(links);
  std::vector<double> K(21 * x.size()), figures(zwidth::kRCubeElasticFigures * x.size());
  bench::Suite many("R-CUBE: a map of 226 981 tool points, one thread", options);
  many.add("zwidth RCubeStiffnessBatch::stiffness, K of each point", static_cast<double>(x.size()),
           [&](long n) {
             for (long it = 0; it < n; ++it) {
               batch.stiffness(x, y, z, K);
               bench::keep(K);
             }
           });
  many.goal(0.4e-6);
  many.add("zwidth RCubeStiffnessBatch::figures, give and principal stiffness", static_cast<double>(x.size()),
           [&](long n) {
             for (long it = 0; it < n; ++it) {
               batch.figures(x, y, z, figures);
               bench::keep(figures);
             }
           });
  many.goal(0.4e-6);
  many.run();

  std::vector<zwidth::Vector3> points;
  for (std::size_t p = 0; p < x.size(); ++p) points.emplace_back(x[p], y[p], z[p]);
  const bool quick = options.rounds <= 2;
  if (quick) points.resize(10'000);
  std::vector<double> times;
  std::size_t inside = 0;
  for (int round = 0; round < (quick ? 1 : 5); ++round) {
    const double start = bench::wall_seconds();
    const auto map = zwidth::map_mechanics(mechanism, zwidth::Drives(3), points, {.threads = 2});
    times.push_back(bench::wall_seconds() - start);
    inside = static_cast<std::size_t>(std::count_if(map.begin(), map.end(), [](const auto& values) {
      return !std::isnan(figure(values, zwidth::MechanicalFigure::softest));
    }));
  }
  std::printf(
      "map_mechanics of %zu tool points, %zu inside, by the code for any mechanism: stiffness, masses and "
      "frequencies.\nTwo threads, wall: median %.3f s, worst %.3f s.\n\n",
      points.size(), inside, bench::quantile(times, 0.5), bench::quantile(times, 1.0));

  bench::Suite loaded("R-CUBE: loaded, weights and geometric term, iterated", options);
  loaded.add("zwidth loaded_stiffness", 8, [&](long n) {
    const zwidth::Loading loading{.tool = (zwidth::Vector6() << 4, -3, 5, 0, 0, 0).finished()};
    for (long it = 0; it < n; ++it) {
      for (int p = 0; p < 8; ++p)
        bench::keep(zwidth::loaded_stiffness(postures[static_cast<std::size_t>(p)], loading));
    }
  });
  loaded.goal(100e-6);
  loaded.run();
  return 0;
}
