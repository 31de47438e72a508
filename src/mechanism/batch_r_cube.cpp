#include "zwidth/mechanism/batch_r_cube.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "zwidth/math/lanes.h"

namespace zwidth {
namespace {

// Lane by lane; NaN of negative numbers.
[[gnu::always_inline]] inline void root(const Lanes& of, Lanes& result) {
  for (int lane = 0; lane < kLanes; ++lane) result[lane] = std::sqrt(of[lane]);
}

constexpr double kSingular = 1e-12;  // squared sine of an elbow, or cosine of a drive, that counts as none

}  // namespace

// Four tool points, one in each lane.
struct RCubeStiffnessKernel {
  // What one leg gives along its force f along e_a (with the moment -z f about e_b) and its moment m about e_c.
  struct Leg {
    Lanes ff, fm, mm, z;
  };

  [[gnu::always_inline]] static inline void leg(const RCubeStiffnessBatch& batch, const Lanes& r_a,
                                                const Lanes& r_b, const Lanes& r_c, Leg& out) {
    const auto& [first, inner, outer] = batch.links_;
    const double l1 = first.length, l2 = inner.length, l3 = outer.length;
    const Lanes s1 = (r_a - batch.offset_) * (1.0 / l1), s1s1 = s1 * s1, c1c1 = 1.0 - s1s1;
    Lanes c1;
    root(c1c1, c1);
    const Lanes y = r_b, z = r_c - l1 * c1, rho2 = y * y + z * z;
    const Lanes c3 = (rho2 - (l2 * l2 + l3 * l3)) * (0.5 / (l2 * l3)), s3s3 = 1.0 - c3 * c3;
    Lanes s3;
    root(s3s3, s3);
    s3 = s3 * batch.elbow_;
    // Directions of the outer links from e_c, by the triangle they make: X = z, Y = -y.
    const Lanes along = l2 + l3 * c3, across = l3 * s3, inverse = 1.0 / rho2;
    const Lanes c2 = (along * z - across * y) * inverse, s2 = (-along * y - across * z) * inverse;
    const Lanes c = (z - l2 * c2) * (1.0 / l3), s = (-y - l2 * s2) * (1.0 / l3);

    const Lanes t = c1c1 * first.twist + s1s1 * first.bend;
    out.ff = l1 * s1s1 * first.stretch + c1c1 * (l1 * l1 * l1 / 3.0 * first.bend) + y * y * l1 * t +
             l2 * inner.twist * y * y * c2 * c2 +
             inner.bend * (l2 * y * y * s2 * s2 + l2 * l2 * y * s2 + l2 * l2 * l2 / 3.0) +
             l3 * outer.twist * z * z * s * s +
             outer.bend * (l3 * l3 * l3 / 3.0 - l3 * l3 * z * c + l3 * z * z * c * c);
    out.fm = -y * l1 * t - l2 * inner.twist * y * c2 * c2 -
             inner.bend * (l2 * y * s2 * s2 + 0.5 * l2 * l2 * s2) + l3 * outer.twist * z * s * c +
             outer.bend * (0.5 * l3 * l3 * s - l3 * z * c * s);
    out.mm = l1 * t + l2 * (inner.twist * c2 * c2 + inner.bend * s2 * s2) +
             l3 * (outer.twist * c * c + outer.bend * s * s);
    out.z = z;
    for (int lane = 0; lane < kLanes; ++lane) {
      // Where a leg stands singular it carries other wrenches.
      if (!(c1c1[lane] > kSingular && s3s3[lane] > kSingular))
        out.ff[lane] = std::numeric_limits<double>::quiet_NaN();
    }
  }

  // Calls `write(first, lanes, legs)` for every four points.
  template <class Write>
  [[gnu::always_inline]] static inline void run(const RCubeStiffnessBatch& batch, std::span<const double> x,
                                                std::span<const double> y, std::span<const double> z,
                                                Write&& write) {
    const std::size_t n = x.size();
    for (std::size_t first = 0; first < n; first += kLanes) {
      const int lanes = static_cast<int>(std::min<std::size_t>(kLanes, n - first));
      Lanes r[3];
      for (int lane = 0; lane < kLanes; ++lane) {
        const std::size_t p = first + static_cast<std::size_t>(std::min(lane, lanes - 1));
        r[0][lane] = x[p];
        r[1][lane] = y[p];
        r[2][lane] = z[p];
      }
      Leg legs[3];
      for (int i = 0; i < 3; ++i) leg(batch, r[i], r[(i + 1) % 3], r[(i + 2) % 3], legs[i]);
      write(first, lanes, legs);
    }
  }

  ZWIDTH_WIDE static void figures(const RCubeStiffnessBatch& batch, std::span<const double> x,
                                  std::span<const double> y, std::span<const double> z,
                                  std::span<double> out) noexcept;
  ZWIDTH_WIDE static void stiffness(const RCubeStiffnessBatch& batch, std::span<const double> x,
                                    std::span<const double> y, std::span<const double> z,
                                    std::span<double> out) noexcept;
};

namespace {

// Smallest and largest eigenvalue of a symmetric 3 x 3 matrix (Smith 1961).
struct Ends {
  double least, most;
};
Ends principal(double xx, double yy, double zz, double xy, double xz, double yz) {
  const double mean = (xx + yy + zz) / 3.0, a = xx - mean, b = yy - mean, c = zz - mean;
  const double square = (a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0;
  const double p = std::sqrt(square);
  if (!(p > 0.0)) return {mean, mean};
  const double det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
  const double r = std::clamp(0.5 * det / (p * square), -1.0, 1.0), phi = std::acos(r) / 3.0;
  constexpr double kThird = 2.0943951023931953;
  return {mean + 2.0 * p * std::cos(phi + kThird), mean + 2.0 * p * std::cos(phi)};
}

}  // namespace

void RCubeStiffnessKernel::figures(const RCubeStiffnessBatch& batch, std::span<const double> x,
                                   std::span<const double> y, std::span<const double> z,
                                   std::span<double> out) noexcept {
  const std::size_t n = x.size();
  run(batch, x, y, z, [&](std::size_t first, int lanes, const Leg(&legs)[3]) {
    // A force along e_a is carried by leg a alone; it turns the platform about e_b by way of the leg whose
    // third axis is e_b, and that moves the platform along all three.
    Lanes give[3], off[3];
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      give[a] = legs[a].ff + legs[a].z * legs[a].z * legs[c].mm;
      // Along e_b and e_c for a force along e_a: z_b fm_a and z_a fm_c. Both orders must agree, and do.
      off[c] = legs[b].z * legs[a].fm;  // of e_a and e_b
    }
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t p = first + static_cast<std::size_t>(lane);
      const double xx = give[0][lane], yy = give[1][lane], zz = give[2][lane];
      const double xy = off[2][lane], yz = off[0][lane], xz = off[1][lane];
      const double values[] = {xx, yy, zz, xy, xz, yz};
      for (std::size_t f = 0; f < 6; ++f) out[f * n + p] = values[f];
      const Ends ends = principal(xx, yy, zz, xy, xz, yz);
      out[6 * n + p] = 1.0 / ends.most;
      out[7 * n + p] = 1.0 / ends.least;
    }
  });
}

void RCubeStiffnessKernel::stiffness(const RCubeStiffnessBatch& batch, std::span<const double> x,
                                     std::span<const double> y, std::span<const double> z,
                                     std::span<double> out) noexcept {
  const std::size_t n = x.size();
  const auto entry = [](int row, int column) {
    const int r = std::max(row, column), c = std::min(row, column);
    return r * (r + 1) / 2 + c;
  };
  run(batch, x, y, z, [&](std::size_t first, int lanes, const Leg(&legs)[3]) {
    Lanes K[21] = {};
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const Leg& leg = legs[a];
      const Lanes inverse = 1.0 / (leg.ff * leg.mm - leg.fm * leg.fm);
      const Lanes A = leg.mm * inverse, B = -leg.fm * inverse, C = leg.ff * inverse;
      K[entry(a, a)] += A;
      K[entry(3 + b, a)] += -leg.z * A;
      K[entry(3 + c, a)] += B;
      K[entry(3 + b, 3 + b)] += leg.z * leg.z * A;
      K[entry(3 + c, 3 + b)] += -leg.z * B;
      K[entry(3 + c, 3 + c)] += C;
    }
    for (std::size_t e = 0; e < 21; ++e) {
      for (int lane = 0; lane < lanes; ++lane) out[e * n + first + static_cast<std::size_t>(lane)] = K[e][lane];
    }
  });
}

RCubeStiffnessBatch::RCubeStiffnessBatch(const RCubeLinks& links, int elbow) noexcept
    : offset_(links.geometry.base_offset), elbow_(elbow) {
  assert(links.geometry.valid() && (elbow == 1 || elbow == -1));
  const double lengths[] = {links.geometry.drive_link, links.geometry.inner_link, links.geometry.outer_link};
  for (std::size_t k = 0; k < 3; ++k) {
    const BeamRigidity& beam = links.rigidity[k];
    links_[k] = {lengths[k], 1.0 / beam.axial, 1.0 / beam.bending_y, 1.0 / beam.torsion};
  }
}

void RCubeStiffnessBatch::figures(std::span<const double> x, std::span<const double> y,
                                  std::span<const double> z, std::span<double> out) const noexcept {
  assert(y.size() == x.size() && z.size() == x.size() && out.size() == kRCubeElasticFigures * x.size());
  RCubeStiffnessKernel::figures(*this, x, y, z, out);
}

void RCubeStiffnessBatch::stiffness(std::span<const double> x, std::span<const double> y,
                                    std::span<const double> z, std::span<double> out) const noexcept {
  assert(y.size() == x.size() && z.size() == x.size() && out.size() == 21 * x.size());
  RCubeStiffnessKernel::stiffness(*this, x, y, z, out);
}

}  // namespace zwidth
