#pragma once

#include <array>
#include <optional>
#include <vector>

#include "zwidth/analysis/workspace.h"

namespace zwidth::internal {

/// A set of points of a plane (z is 0) or of space that answers for one point at a time. It may follow on from
/// its last answer, so each thread has its own.
class Region {
 public:
  virtual ~Region() = default;

  virtual int dimension() const = 0;  ///< 2 or 3
  virtual bool inside(const Vector3& point) = 0;
  /// How far a point is from the boundary, in a measure that changes smoothly and is zero there: above zero
  /// inside, below outside, NaN where nothing can be said.
  virtual double margin(const Vector3& point) = 0;
  /// Outward unit normal of the boundary at a point on it, which a ray along `outwards` leaves; nothing where
  /// it is not known. Not asked for in a plane.
  virtual std::optional<Vector3> normal(const Vector3& point, const Vector3& outwards) = 0;
};

/// Points of a lattice of which it is known whether they are in a region, with a rim of such that are not.
struct RegionLattice {
  Vector3 origin = Vector3::Zero();  ///< of point (0, 0, 0)
  double spacing = 0.0;
  std::array<int, 3> count{1, 1, 1};
  std::vector<char> inside;  ///< z fastest

  Vector3 point(int i, int j, int k) const { return origin + spacing * Vector3(i, j, k); }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(count[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(count[2]) +
           static_cast<std::size_t>(k);
  }
  bool at(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < count[0] && j < count[1] && k < count[2] &&
           inside[index(i, j, k)] != 0;
  }
};

/// The largest sphere (circle), or axis-aligned cube (square), in a region, from the `tries` most promising
/// points of a lattice. `scale`: the longest side of a box round the region.
InscribedShape largest_shape(Region& region, bool cube, const RegionLattice& lattice, double scale, int tries);

}  // namespace zwidth::internal
