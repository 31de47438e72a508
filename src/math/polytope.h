#pragma once

#include <Eigen/Core>
#include <vector>

/// Polytopes between pairs of parallel planes, and sums of segments, in up to six dimensions: corners, faces
/// and volume, exactly. For forces within torque limits and velocities within speed limits. They allocate.

namespace zwidth {

using PolytopeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// { x : lower_j <= a_j . x <= upper_j }, one row a_j per pair of planes.
struct Slabs {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 6> rows;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> lower;  ///< finite
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> upper;  ///< finite, not below lower; equal for a plane
};

/// Rows shorter than this share of the longest count as zero: what rounding leaves of an axis through the tool.
inline constexpr double kZeroRow = 1e-12;

enum class PolytopeStatus {
  bounded,
  unbounded,  ///< some direction crosses no plane: corners and faces stay empty, the volume is infinite
  empty,      ///< no point keeps all bounds
};

struct Polytope {
  PolytopeStatus status = PolytopeStatus::empty;
  int dimension = 0;  ///< of the flat that it fills: less than that of the space if a slab is a plane
  std::vector<PolytopeVector> vertices;
  /// Corners by index. In space one loop per face, counter-clockwise seen from outside (of a flat polytope the
  /// one face, either way round); in the plane one loop, counter-clockwise. Empty in other dimensions.
  std::vector<std::vector<int>> faces;
  double volume = 0.0;  ///< in all dimensions of the space: zero for a flat one
};

/// REQUIRES: 1 to 6 columns, 1 to 8 rows, sizes that agree, finite numbers, lower <= upper.
Polytope polytope(const Slabs& slabs);

/// { sum_j g_j t_j : lower_j <= t_j <= upper_j }, one column g_j per segment: what joints that are moved at
/// will within their bounds give together.
struct Segments {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 8> columns;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> lower;  ///< finite
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> upper;  ///< finite, not below lower
};

/// A zonotope. In one to three dimensions corners and faces are complete; in more, only the figures are there.
struct Zonotope {
  std::vector<PolytopeVector> vertices;
  std::vector<std::vector<int>> faces;  ///< as in `Polytope`
  double volume = 0.0;
  double inner_radius = 0.0;       ///< distance from the origin to the nearest face; 0 if it is not inside
  PolytopeVector inner_direction;  ///< unit, towards that face
  double outer_radius = 0.0;       ///< distance from the origin to the farthest corner
  PolytopeVector outer_direction;  ///< unit, towards that corner
};

/// REQUIRES: 1 to 6 rows, 1 to 8 columns, sizes that agree, finite numbers, lower <= upper.
Zonotope zonotope(const Segments& segments);

/// Largest u . x over a zonotope.
double support(const Segments& segments, const PolytopeVector& u);

}  // namespace zwidth
