#include "zwidth/math/polytope.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

namespace zwidth {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Slabs random_slabs(std::mt19937_64& random, int count, int dimension) {
  Slabs slabs;
  slabs.rows.resize(count, dimension);
  slabs.lower.resize(count);
  slabs.upper.resize(count);
  for (int j = 0; j < count; ++j) {
    for (int k = 0; k < dimension; ++k) slabs.rows(j, k) = uniform(random, -1.0, 1.0);
    slabs.lower[j] = uniform(random, -2.0, -0.2);
    slabs.upper[j] = uniform(random, 0.2, 2.0);
  }
  return slabs;
}

bool inside(const Slabs& slabs, const PolytopeVector& x, double slack = 1e-9) {
  const auto value = (slabs.rows * x).eval();
  return ((value - slabs.lower).array() >= -slack).all() && ((slabs.upper - value).array() >= -slack).all();
}

// Every edge of a closed surface of loops that turn the same way is walked once in each direction.
void expect_closed(const std::vector<std::vector<int>>& faces, std::size_t vertices) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& face : faces) {
    ASSERT_GE(face.size(), 3u);
    for (std::size_t i = 0; i < face.size(); ++i) ++edges[{face[i], face[(i + 1) % face.size()]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1u);
  }
  EXPECT_EQ(vertices + faces.size(), edges.size() / 2 + 2);  // Euler
}

TEST(Polytope, CornersLieOnEnoughPlanesAndSupportEveryDirection) {
  std::mt19937_64 random(51);
  for (int round = 0; round < 300; ++round) {
    const int d = 1 + round % 3, n = d + round % 5;
    const Slabs slabs = random_slabs(random, n, d);
    const Polytope shape = polytope(slabs);
    ASSERT_EQ(shape.status, PolytopeStatus::bounded);
    ASSERT_EQ(shape.dimension, d);
    for (const PolytopeVector& vertex : shape.vertices) {
      EXPECT_TRUE(inside(slabs, vertex));
      int on = 0;
      for (int j = 0; j < n; ++j) {
        const double value = slabs.rows.row(j).dot(vertex);
        on += std::min(std::abs(value - slabs.lower[j]), std::abs(value - slabs.upper[j])) < 1e-9 ? 1 : 0;
      }
      EXPECT_GE(on, d);
    }
    // No point that the planes admit reaches farther than the corners do: walk to the boundary along random
    // rays.
    for (int ray = 0; ray < 30; ++ray) {
      PolytopeVector u(d);
      for (double& x : u) x = uniform(random, -1.0, 1.0);
      double length = 1e9;
      for (int j = 0; j < n; ++j) {
        const double slope = slabs.rows.row(j).dot(u);
        length = std::min(length, (slope > 0.0 ? slabs.upper[j] : slabs.lower[j]) / slope);
      }
      double support = 0.0;
      for (const PolytopeVector& vertex : shape.vertices) support = std::max(support, vertex.dot(u));
      EXPECT_LE(length * u.squaredNorm(), support + 1e-9);
    }
    if (d == 3) expect_closed(shape.faces, shape.vertices.size());
    if (d == 2) {
      ASSERT_EQ(shape.faces.size(), 1u);
      EXPECT_EQ(shape.faces[0].size(), shape.vertices.size());
    }
  }
}

TEST(Polytope, VolumeIsThatOfCountedPoints) {
  std::mt19937_64 random(52);
  for (int round = 0; round < 12; ++round) {
    const int d = 2 + round % 4, n = d + 2;
    const Slabs slabs = random_slabs(random, n, d);
    const Polytope shape = polytope(slabs);
    ASSERT_EQ(shape.status, PolytopeStatus::bounded);
    PolytopeVector low = shape.vertices[0], high = low;
    for (const PolytopeVector& vertex : shape.vertices) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    const int samples = 40000;
    int hits = 0;
    for (int i = 0; i < samples; ++i) {
      PolytopeVector x(d);
      for (int k = 0; k < d; ++k) x[k] = uniform(random, low[k], high[k]);
      hits += inside(slabs, x, 0.0) ? 1 : 0;
    }
    const double share = static_cast<double>(hits) / samples;
    const double box = (high - low).prod();
    // Five standard deviations of the count.
    EXPECT_NEAR(shape.volume, share * box, 5.0 * box * std::sqrt(share * (1.0 - share) / samples) + 1e-9) << d;
  }
}

TEST(Polytope, OfAsManyPlanesAsDimensionsIsTheImageOfABox) {
  std::mt19937_64 random(53);
  for (int d = 1; d <= 6; ++d) {
    const Slabs slabs = random_slabs(random, d, d);
    const Polytope shape = polytope(slabs);
    ASSERT_EQ(shape.vertices.size(), std::size_t{1} << d);
    for (std::size_t corner = 0; corner < shape.vertices.size(); ++corner) {
      const auto value = (slabs.rows * shape.vertices[corner]).eval();
      for (int j = 0; j < d; ++j)
        EXPECT_NEAR(value[j], (corner >> j & 1U) != 0 ? slabs.upper[j] : slabs.lower[j], 1e-9);
    }
    const double expected =
        (slabs.upper - slabs.lower).prod() / std::abs(Eigen::MatrixXd(slabs.rows).determinant());
    EXPECT_NEAR(shape.volume / expected, 1.0, 1e-9);
  }
}

TEST(Polytope, RepeatedPlanesChangeNothing) {
  std::mt19937_64 random(54);
  const Slabs three = random_slabs(random, 4, 3);
  Slabs more;
  more.rows.resize(6, 3);
  more.lower.resize(6);
  more.upper.resize(6);
  for (int j = 0; j < 6; ++j) {
    // The same planes again, turned round and scaled; and one that is always kept.
    const int from = j % 4;
    const double factor = j < 4 ? 1.0 : -2.5;
    more.rows.row(j) = factor * three.rows.row(from);
    more.lower[j] = factor > 0.0 ? three.lower[from] : factor * three.upper[from];
    more.upper[j] = factor > 0.0 ? three.upper[from] : factor * three.lower[from];
  }
  const Polytope a = polytope(three), b = polytope(more);
  EXPECT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_EQ(a.faces.size(), b.faces.size());
  EXPECT_NEAR(a.volume, b.volume, 1e-12);
}

TEST(Polytope, VolumeInSixDimensionsOfACutCube) {
  // |x_k| <= 1 and |sum x| <= 6 - t: two corners are cut off, each a simplex of volume t^6/6!.
  Slabs slabs;
  slabs.rows.setZero(7, 6);
  slabs.rows.topRows(6).setIdentity();
  slabs.rows.row(6).setOnes();
  slabs.upper.setOnes(7);
  slabs.upper[6] = 4.5;
  slabs.lower = -slabs.upper;
  EXPECT_NEAR(polytope(slabs).volume, 64.0 - 2.0 * std::pow(1.5, 6) / 720.0, 1e-9);
}

TEST(Polytope, AnEmptyRangeFlattensIt) {
  Slabs slabs;
  slabs.rows.resize(4, 3);
  slabs.rows << 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1;
  slabs.lower.setConstant(4, -1.0);
  slabs.upper.setConstant(4, 1.0);
  slabs.lower[3] = slabs.upper[3] = 0.0;
  const Polytope hexagon = polytope(slabs);
  EXPECT_EQ(hexagon.status, PolytopeStatus::bounded);
  EXPECT_EQ(hexagon.dimension, 2);
  EXPECT_EQ(hexagon.vertices.size(), 6u);
  ASSERT_EQ(hexagon.faces.size(), 1u);
  EXPECT_EQ(hexagon.faces[0].size(), 6u);
  EXPECT_EQ(hexagon.volume, 0.0);
  slabs.lower[2] = slabs.upper[2] = 0.0;
  EXPECT_EQ(polytope(slabs).dimension, 1);
  EXPECT_EQ(polytope(slabs).vertices.size(), 2u);
  slabs.lower[1] = slabs.upper[1] = 0.0;
  EXPECT_EQ(polytope(slabs).dimension, 0);
  EXPECT_EQ(polytope(slabs).vertices.size(), 1u);
}

TEST(Polytope, SaysWhetherItIsUnboundedOrEmpty) {
  Slabs slabs;
  slabs.rows.resize(2, 3);
  slabs.rows << 1, 0, 0, 0, 1, 0;
  slabs.lower.setConstant(2, -1.0);
  slabs.upper.setConstant(2, 1.0);
  EXPECT_EQ(polytope(slabs).status, PolytopeStatus::unbounded);
  EXPECT_TRUE(std::isinf(polytope(slabs).volume));
  slabs.rows << 1, 0, 0, 1, 0, 0;
  slabs.lower << 0.5, -1.0;
  slabs.upper << 1.0, -0.5;
  EXPECT_EQ(polytope(slabs).status, PolytopeStatus::empty);
  slabs.rows << 1, 0, 0, 1e-14, 0, 1e-15;  // nothing but rounding, that no load could move into its range
  slabs.lower << -1.0, 0.5;
  slabs.upper << 1.0, 1.0;
  EXPECT_EQ(polytope(slabs).status, PolytopeStatus::empty);
}

Segments random_segments(std::mt19937_64& random, int count, int dimension) {
  Segments segments;
  segments.columns.resize(dimension, count);
  segments.lower.resize(count);
  segments.upper.resize(count);
  for (int j = 0; j < count; ++j) {
    for (int k = 0; k < dimension; ++k) segments.columns(k, j) = uniform(random, -1.0, 1.0);
    segments.lower[j] = uniform(random, -2.0, -0.2);
    segments.upper[j] = uniform(random, 0.2, 2.0);
  }
  return segments;
}

TEST(Zonotope, CornersSupportEveryDirectionAndTheFiguresAgree) {
  std::mt19937_64 random(55);
  for (int round = 0; round < 120; ++round) {
    const int d = 1 + round % 3, n = d + round % 4;
    Segments segments = random_segments(random, n, d);
    if (round % 5 == 0 && n > 1) segments.columns.col(n - 1) = -0.7 * segments.columns.col(0);
    const Zonotope shape = zonotope(segments);
    double least = 1e9;
    for (int ray = 0; ray < 200; ++ray) {
      PolytopeVector u(d);
      for (double& x : u) x = uniform(random, -1.0, 1.0);
      u.normalize();
      double reach = -1e9;
      for (const PolytopeVector& vertex : shape.vertices) reach = std::max(reach, vertex.dot(u));
      EXPECT_NEAR(reach, support(segments, u), 1e-9);
      least = std::min(least, reach);
    }
    EXPECT_LE(shape.inner_radius, least + 1e-9);
    EXPECT_NEAR(support(segments, shape.inner_direction), shape.inner_radius, 1e-9);
    if (d == 3 && n > 3) {
      expect_closed(shape.faces, shape.vertices.size());
      double six = 0.0;
      for (const auto& face : shape.faces) {
        const Eigen::Vector3d a = shape.vertices[static_cast<std::size_t>(face[0])];
        for (std::size_t i = 1; i + 1 < face.size(); ++i) {
          const Eigen::Vector3d b = shape.vertices[static_cast<std::size_t>(face[i])],
                                c = shape.vertices[static_cast<std::size_t>(face[i + 1])];
          six += a.dot(b.cross(c));
        }
      }
      EXPECT_NEAR(six / 6.0, shape.volume, 1e-9);
    }
  }
}

TEST(Zonotope, FourActuatorsOnThreeAxes) {
  // Closed form: radius sqrt(2) (face of e1 and the fourth), volume 8 sum |det|, farthest corner
  // (1.5, 1.5, 1.5).
  Segments segments;
  segments.columns.resize(3, 4);
  segments.columns << 1, 0, 0, 0.5, 0, 1, 0, 0.5, 0, 0, 1, 0.5;
  segments.lower.setConstant(4, -1.0);
  segments.upper.setConstant(4, 1.0);
  const Zonotope shape = zonotope(segments);
  EXPECT_NEAR(shape.inner_radius, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(shape.volume, 20.0, 1e-12);
  EXPECT_NEAR(shape.outer_radius, 1.5 * std::sqrt(3.0), 1e-12);
  EXPECT_EQ(shape.faces.size(), 12u);
  EXPECT_EQ(shape.vertices.size(), 14u);
}

TEST(Zonotope, OfSegmentsInOnePlaneIsFlat) {
  Segments segments;
  segments.columns.resize(3, 3);
  segments.columns << 1, 0, 1, 0, 1, 1, 0, 0, 0;
  segments.lower.setConstant(3, -1.0);
  segments.upper.setConstant(3, 1.0);
  const Zonotope shape = zonotope(segments);
  EXPECT_EQ(shape.vertices.size(), 6u);
  EXPECT_EQ(shape.faces.size(), 1u);
  EXPECT_EQ(shape.inner_radius, 0.0);
  EXPECT_EQ(shape.volume, 0.0);
}

}  // namespace
}  // namespace zwidth
