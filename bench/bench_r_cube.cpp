#include <Eigen/Dense>
#include <numbers>
#include <random>
#include <vector>

#include "harness.h"

#include "zwidth/mechanism/r_cube.h"

/// Postures of the R-CUBE, one at a time, beside the formulas as its source prints them.

namespace {

using zwidth::Vector3;

constexpr int kPoses = 1024;

// Every angle and the Jacobians as Görgülü 2018 writes them down, with the functions of the C library.
struct Textbook {
  zwidth::RCubeGeometry geometry;

  Vector3 forward(const Vector3& q) const {
    return Vector3::Constant(geometry.base_offset) + geometry.drive_link * q.array().sin().matrix();
  }
  Vector3 inverse(const Vector3& r) const {
    return ((r.array() - geometry.base_offset) / geometry.drive_link).asin();
  }
  Eigen::Matrix<double, 3, 2> passive(const Vector3& q, const Vector3& r) const {
    const double l1 = geometry.drive_link, l2 = geometry.inner_link, l3 = geometry.outer_link;
    Eigen::Matrix<double, 3, 2> angles;
    for (int a = 0; a < 3; ++a) {
      const double X = r[(a + 2) % 3] - l1 * std::cos(q[a]), Y = -r[(a + 1) % 3];
      const double c3 = (X * X + Y * Y - l2 * l2 - l3 * l3) / (2.0 * l2 * l3), s3 = -std::sqrt(1.0 - c3 * c3);
      angles(a, 0) = std::atan2((l2 + l3 * c3) * Y - l3 * s3 * X, (l2 + l3 * c3) * X + l3 * s3 * Y);
      angles(a, 1) = std::atan2(s3, c3);
    }
    return angles;
  }
  Eigen::Matrix3d jacobian(const Vector3& q) const {
    return (geometry.drive_link * q.array().cos()).matrix().asDiagonal();
  }
};

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::options_of(argc, argv);
  const zwidth::RCubeGeometry geometry{
      .drive_link = 0.1117, .inner_link = 0.0741, .outer_link = 0.1218, .base_offset = 0.1117};
  const double limit = 32.5 * std::numbers::pi / 180.0;
  const zwidth::Interval range{-limit, limit};
  const Textbook textbook{geometry};

  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(range.min, range.max);
  std::vector<Vector3> theta(kPoses), position(kPoses);
  double worst = 0.0;
  for (int p = 0; p < kPoses; ++p) {
    theta[p] = {angle(random), angle(random), angle(random)};
    const zwidth::RCubeSolution at = zwidth::r_cube_forward(geometry, theta[p]);
    position[p] = at.position;
    const auto passive = textbook.passive(theta[p], position[p]);
    worst =
        std::max({worst, (textbook.forward(theta[p]) - at.position).norm(), (passive.col(0) - at.swing).norm(),
                  (passive.col(1) - at.elbow).norm(), (textbook.inverse(at.position) - theta[p]).norm()});
  }
  std::printf("library and textbook agree to %.1e\n\n", worst);

  bench::Suite forward("R-CUBE: tool, passive joints and Jacobian of driven angles", options);
  forward.add("textbook: C library", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& q : theta) {
        const Vector3 r = textbook.forward(q);
        bench::keep(textbook.passive(q, r));
        bench::keep(textbook.jacobian(q));
      }
    }
  });
  forward.add("zwidth r_cube_forward", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& q : theta) bench::keep(zwidth::r_cube_forward(geometry, q));
    }
  });
  forward.goal(100e-9);
  forward.run();

  bench::Suite inverse("R-CUBE: driven and passive joints and Jacobian of a tool position", options);
  inverse.add("textbook: C library", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& r : position) {
        const Vector3 q = textbook.inverse(r);
        bench::keep(textbook.passive(q, r));
        bench::keep(textbook.jacobian(q));
      }
    }
  });
  inverse.add("zwidth r_cube_inverse", kPoses, [&](long n) {
    for (long it = 0; it < n; ++it) {
      for (const Vector3& r : position) bench::keep(zwidth::r_cube_inverse(geometry, r, range));
    }
  });
  inverse.goal(100e-9);
  inverse.run();
  return 0;
}
