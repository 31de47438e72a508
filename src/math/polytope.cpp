#include "zwidth/math/polytope.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

#include "zwidth/math/linear_programme.h"

namespace zwidth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;      // of sizes: two corners, or a corner and a plane, that coincide
constexpr double kIndependent = 1e-10;  // pivot beside the largest at which planes count as parallel

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using Vertices = std::vector<PolytopeVector>;
using Indices = std::vector<int>;

// Calls `visit` with every subset of `size` of the numbers below `count`, each in rising order.
void for_each_subset(int count, int size, const std::function<void(const Indices&)>& visit) {
  Indices chosen(static_cast<std::size_t>(size));
  std::iota(chosen.begin(), chosen.end(), 0);
  if (size > count) return;
  for (;;) {
    visit(chosen);
    int i = size - 1;
    while (i >= 0 && chosen[static_cast<std::size_t>(i)] == count - size + i) --i;
    if (i < 0) return;
    ++chosen[static_cast<std::size_t>(i)];
    for (int k = i + 1; k < size; ++k)
      chosen[static_cast<std::size_t>(k)] = chosen[static_cast<std::size_t>(k - 1)] + 1;
  }
}

double largest_norm(const Vertices& vertices) {
  double largest = 0.0;
  for (const PolytopeVector& vertex : vertices) largest = std::max(largest, vertex.norm());
  return largest;
}

// Index of the vertex at `point`, which is added if it is new; points of size `least` and less are rounded
// alike.
int vertex_at(Vertices& vertices, const PolytopeVector& point, double least) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double size = std::max({vertices[i].norm(), point.norm(), least});
    if ((vertices[i] - point).norm() <= kRounding * size) return static_cast<int>(i);
  }
  vertices.push_back(point);
  return static_cast<int>(vertices.size()) - 1;
}

// Orthonormal directions along the flat through some vertices, the longest first.
Vertices flat_through(const Vertices& vertices, const Indices& which, double size) {
  Vertices basis;
  const PolytopeVector& origin = vertices[static_cast<std::size_t>(which.front())];
  const auto dimension = static_cast<std::size_t>(origin.size());
  while (basis.size() < dimension) {
    PolytopeVector farthest = PolytopeVector::Zero(origin.size());
    for (const int i : which) {
      PolytopeVector rest = vertices[static_cast<std::size_t>(i)] - origin;
      for (int pass = 0; pass < 2; ++pass) {
        for (const PolytopeVector& b : basis) rest -= b * b.dot(rest);
      }
      if (rest.norm() > farthest.norm()) farthest = rest;
    }
    if (farthest.norm() <= kRounding * size) break;
    basis.push_back(farthest.normalized());
  }
  return basis;
}

Indices all_of(const Vertices& vertices) {
  Indices all(vertices.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// The corners of a convex polygon in order, counter-clockwise from the first axis to the second.
Indices around(const Vertices& vertices, Indices corners, const PolytopeVector& first,
               const PolytopeVector& second) {
  PolytopeVector middle = PolytopeVector::Zero(first.size());
  for (const int i : corners)
    middle += vertices[static_cast<std::size_t>(i)] / static_cast<double>(corners.size());
  std::vector<std::pair<double, int>> order;
  for (const int i : corners) {
    const PolytopeVector arm = vertices[static_cast<std::size_t>(i)] - middle;
    order.emplace_back(std::atan2(arm.dot(second), arm.dot(first)), i);
  }
  std::sort(order.begin(), order.end());
  std::transform(order.begin(), order.end(), corners.begin(), [](const auto& entry) { return entry.second; });
  return corners;
}

// A face in space whose outward normal is known, as a loop that turns about it.
Indices face_loop(const Vertices& vertices, const Indices& corners, const Vertices& flat,
                  const Eigen::Vector3d& outwards) {
  const Eigen::Vector3d first = flat[0], second = flat[1];
  const bool turned = first.cross(second).dot(outwards) < 0.0;
  return around(vertices, corners, turned ? flat[1] : flat[0], turned ? flat[0] : flat[1]);
}

double polygon_area(const Vertices& vertices, const Indices& loop) {
  double twice = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const PolytopeVector& a = vertices[static_cast<std::size_t>(loop[i])];
    const PolytopeVector& b = vertices[static_cast<std::size_t>(loop[(i + 1) % loop.size()])];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

double solid_volume(const Vertices& vertices, const std::vector<Indices>& faces) {
  if (vertices.empty()) return 0.0;
  const Eigen::Vector3d apex = vertices.front();
  double six = 0.0;
  for (const Indices& face : faces) {
    const Eigen::Vector3d a = vertices[static_cast<std::size_t>(face[0])];
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Eigen::Vector3d b = vertices[static_cast<std::size_t>(face[i])],
                            c = vertices[static_cast<std::size_t>(face[i + 1])];
      six += (a - apex).dot((b - apex).cross(c - apex));
    }
  }
  return six / 6.0;
}

// Corners of a polytope with the planes that each lies in, a bit per plane.
struct Lattice {
  const Vertices& vertices;
  const std::vector<std::uint32_t>& planes;
  double size;
};

// The facets of a face of dimension k: its intersections with planes that have dimension k - 1, each once.
std::vector<Indices> facets_of(const Lattice& lattice, const Indices& face, int k) {
  std::vector<Indices> facets;
  for (int plane = 0; plane < 16; ++plane) {
    Indices common;
    for (const int i : face) {
      if ((lattice.planes[static_cast<std::size_t>(i)] >> plane & 1U) != 0) common.push_back(i);
    }
    if (common.size() == face.size() || common.size() < static_cast<std::size_t>(k)) continue;
    if (std::find(facets.begin(), facets.end(), common) != facets.end()) continue;
    if (static_cast<int>(flat_through(lattice.vertices, common, lattice.size).size()) == k - 1)
      facets.push_back(std::move(common));
  }
  return facets;
}

// d! times the volume of the cone from the corners in `apexes` over a face: from one of its corners to each
// facet that does not hold that corner (Cohen & Hickey 1979).
double simplices(const Lattice& lattice, const Indices& face, int k, Vertices& apexes) {
  const PolytopeVector& apex = lattice.vertices[static_cast<std::size_t>(face.front())];
  if (k == 0) {
    const auto d = apex.size();
    Square edges(d, d);
    for (Eigen::Index i = 0; i < d; ++i) edges.col(i) = apexes[static_cast<std::size_t>(i)] - apex;
    return std::abs(edges.determinant());
  }
  apexes.push_back(apex);
  double sum = 0.0;
  for (const Indices& facet : facets_of(lattice, face, k)) {
    if (facet.front() != face.front()) sum += simplices(lattice, facet, k - 1, apexes);
  }
  apexes.pop_back();
  return sum;
}

}  // namespace

Polytope polytope(const Slabs& slabs) {
  const int d = static_cast<int>(slabs.rows.cols()), all_rows = static_cast<int>(slabs.rows.rows());
  assert(d >= 1 && all_rows >= 1 && slabs.lower.size() == all_rows && slabs.upper.size() == all_rows);
  assert(slabs.rows.allFinite() && slabs.lower.allFinite() && slabs.upper.allFinite());
  assert((slabs.lower.array() <= slabs.upper.array()).all());
  Polytope result;

  // Coordinates of size one, so that forces and moments compare: x'_k = size_k x_k.
  PolytopeVector size = slabs.rows.cwiseAbs().colwise().maxCoeff().transpose();
  for (double& one : size) {
    if (!(one > 0.0)) one = 1.0;
  }
  Slabs scaled;
  scaled.rows.resize(all_rows, d);
  scaled.lower.resize(all_rows);
  scaled.upper.resize(all_rows);
  const double longest = slabs.rows.rowwise().norm().maxCoeff();
  int n = 0;
  for (int j = 0; j < all_rows; ++j) {
    if (slabs.rows.row(j).norm() <= kZeroRow * longest) {
      if (slabs.lower[j] > 0.0 || slabs.upper[j] < 0.0) return result;
      continue;
    }
    scaled.rows.row(n) = slabs.rows.row(j).cwiseQuotient(size.transpose());
    const double norm = scaled.rows.row(n).norm();
    scaled.rows.row(n) /= norm;
    scaled.lower[n] = slabs.lower[j] / norm;
    scaled.upper[n++] = slabs.upper[j] / norm;
  }
  const auto A = scaled.rows.topRows(n);
  const auto unbounded_or_empty = [&] {
    LinearProgramme programme{.rows = A,
                              .lower = scaled.lower.head(n),
                              .upper = scaled.upper.head(n),
                              .objective = LinearProgramme::Point::Zero(d)};
    if (maximise(programme).status == ProgrammeStatus::infeasible) return;
    result.status = PolytopeStatus::unbounded;
    result.dimension = d;
    result.volume = kInfinity;
  };

  double least = kInfinity;
  for (int j = 0; j < n; ++j) {
    const double bound = std::max(std::abs(scaled.lower[j]), std::abs(scaled.upper[j]));
    if (bound > 0.0) least = std::min(least, bound);
  }
  if (!std::isfinite(least)) least = 0.0;

  bool independent = false;
  std::vector<std::uint32_t> planes;
  for_each_subset(n, d, [&](const Indices& rows) {
    Square square(d, d);
    for (int i = 0; i < d; ++i) square.row(i) = A.row(rows[static_cast<std::size_t>(i)]);
    Eigen::FullPivLU<Square> factors;
    factors.setThreshold(kIndependent);
    factors.compute(square);
    if (!factors.isInvertible()) return;
    independent = true;
    for (unsigned corner = 0; corner < 1U << d; ++corner) {
      PolytopeVector bound(d);
      bool twice = false;
      for (int i = 0; i < d; ++i) {
        const int j = rows[static_cast<std::size_t>(i)];
        const bool high = (corner >> i & 1U) != 0;
        bound[i] = high ? scaled.upper[j] : scaled.lower[j];
        twice = twice || (high && scaled.lower[j] == scaled.upper[j]);
      }
      if (twice) continue;
      const PolytopeVector x = factors.solve(bound);
      const double slack = kRounding * std::max(x.norm(), bound.cwiseAbs().maxCoeff());
      std::uint32_t on = 0;
      bool inside = true;
      for (int j = 0; j < n && inside; ++j) {
        const double value = A.row(j).dot(x);
        inside = value >= scaled.lower[j] - slack && value <= scaled.upper[j] + slack;
        if (std::abs(value - scaled.lower[j]) <= slack) on |= 1U << (2 * j);
        if (std::abs(value - scaled.upper[j]) <= slack) on |= 2U << (2 * j);
      }
      if (!inside) continue;
      const auto index = static_cast<std::size_t>(vertex_at(result.vertices, x, least));
      if (index == planes.size()) {
        planes.push_back(on);
      } else {
        planes[index] |= on;
      }
    }
  });
  if (!independent) {
    unbounded_or_empty();
    return result;
  }
  if (result.vertices.empty()) return result;
  result.status = PolytopeStatus::bounded;

  const double extent = largest_norm(result.vertices);
  const Indices everything = all_of(result.vertices);
  const Vertices flat = flat_through(result.vertices, everything, extent);
  result.dimension = static_cast<int>(flat.size());
  const Lattice lattice{result.vertices, planes, extent};
  if (d == 1) {
    if (result.dimension == 1) result.volume = std::abs(result.vertices[1][0] - result.vertices[0][0]);
  } else if (d == 2 && result.dimension == 2) {
    result.faces = {
        around(result.vertices, everything, PolytopeVector::Unit(2, 0), PolytopeVector::Unit(2, 1))};
    result.volume = polygon_area(result.vertices, result.faces[0]);
  } else if (d == 3 && result.dimension == 2) {
    result.faces = {around(result.vertices, everything, flat[0], flat[1])};
  } else if (d == 3 && result.dimension == 3) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const PolytopeVector& vertex : result.vertices)
      middle += vertex / static_cast<double>(result.vertices.size());
    for (const Indices& face : facets_of(lattice, everything, 3)) {
      const Eigen::Vector3d outwards = result.vertices[static_cast<std::size_t>(face[0])] - middle;
      result.faces.push_back(
          face_loop(result.vertices, face, flat_through(result.vertices, face, extent), outwards));
    }
    result.volume = solid_volume(result.vertices, result.faces);
  } else if (d > 3 && result.dimension == d) {
    if (n == d) {
      result.volume = (scaled.upper - scaled.lower).head(n).prod() / std::abs(Square(A).determinant());
    } else {
      Vertices apexes;
      result.volume = simplices(lattice, everything, d, apexes);
      for (int k = 2; k <= d; ++k) result.volume /= k;
    }
  }
  result.volume /= size.prod();
  for (PolytopeVector& vertex : result.vertices) vertex = vertex.cwiseQuotient(size);
  return result;
}

// ------------------------------------------------------------------------------------------------- zonotope

namespace {

// Unit normals of the faces: of every d - 1 independent columns, once and in one of its two directions.
Vertices face_normals(const Segments& s, double longest) {
  const int d = static_cast<int>(s.columns.rows()), n = static_cast<int>(s.columns.cols());
  Vertices normals;
  if (d == 1) return {PolytopeVector::Ones(1)};
  for_each_subset(n, d - 1, [&](const Indices& chosen) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> spanned(d - 1, d);
    for (int i = 0; i < d - 1; ++i) {
      const auto column = s.columns.col(chosen[static_cast<std::size_t>(i)]);
      if (column.norm() <= kZeroRow * longest) return;
      spanned.row(i) = column.normalized();
    }
    Eigen::FullPivLU<decltype(spanned)> factors;
    factors.setThreshold(kIndependent);
    factors.compute(spanned);
    if (factors.rank() < d - 1) return;
    const PolytopeVector normal = factors.kernel().col(0).normalized();
    const bool known = std::any_of(normals.begin(), normals.end(), [&](const PolytopeVector& other) {
      return std::min((normal - other).norm(), (normal + other).norm()) <= kRounding;
    });
    if (!known) normals.push_back(normal);
  });
  return normals;
}

// Columns that lie in a face of this normal.
bool lies_in(const Segments& s, int j, const PolytopeVector& normal, double longest) {
  return std::abs(normal.dot(s.columns.col(j))) <= kRounding * longest;
}

// Both ends of a sum of segments that all lie along one direction, from a point.
std::array<PolytopeVector, 2> line_sum(const Segments& s, const Indices& columns, const PolytopeVector& from) {
  PolytopeVector along = PolytopeVector::Zero(from.size());
  for (const int j : columns) {
    if (s.columns.col(j).norm() > along.norm()) along = s.columns.col(j);
  }
  std::array<PolytopeVector, 2> ends{from, from};
  for (const int j : columns) {
    const bool same = along.dot(s.columns.col(j)) >= 0.0;
    ends[0] += s.columns.col(j) * (same ? s.lower[j] : s.upper[j]);
    ends[1] += s.columns.col(j) * (same ? s.upper[j] : s.lower[j]);
  }
  return ends;
}

// Corners of the face at the far end along `normal`: the farthest point, and the sums of the segments in it.
Indices face_corners(const Segments& s, const PolytopeVector& normal, double longest, double size,
                     Vertices& vertices) {
  const int n = static_cast<int>(s.columns.cols());
  PolytopeVector base = PolytopeVector::Zero(s.columns.rows());
  Indices in_face;
  for (int j = 0; j < n; ++j) {
    if (lies_in(s, j, normal, longest)) {
      in_face.push_back(j);
    } else {
      base += s.columns.col(j) * (normal.dot(s.columns.col(j)) > 0.0 ? s.upper[j] : s.lower[j]);
    }
  }
  // The corners of the flat sum lie at the far ends along the normals, in the flat, of its columns.
  Indices corners;
  const auto note = [&](const PolytopeVector& point) {
    const int index = vertex_at(vertices, point, size);
    if (std::find(corners.begin(), corners.end(), index) == corners.end()) corners.push_back(index);
  };
  if (s.columns.rows() < 3) {
    for (const PolytopeVector& end : line_sum(s, in_face, base)) note(end);
    return corners;
  }
  const Eigen::Vector3d n3 = normal;
  for (const int i : in_face) {
    const Eigen::Vector3d g = s.columns.col(i);
    if (g.norm() <= kZeroRow * longest) continue;
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d across = sign * n3.cross(g).normalized();
      PolytopeVector edge = base;
      Indices along_edge;
      for (const int j : in_face) {
        const double beyond = across.dot(Eigen::Vector3d(s.columns.col(j)));
        if (std::abs(beyond) > kRounding * longest) {
          edge += s.columns.col(j) * (beyond > 0.0 ? s.upper[j] : s.lower[j]);
        } else {
          along_edge.push_back(j);
        }
      }
      for (const PolytopeVector& end : line_sum(s, along_edge, edge)) note(end);
    }
  }
  return corners;
}

}  // namespace

double support(const Segments& segments, const PolytopeVector& u) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < segments.columns.cols(); ++j) {
    const double along = u.dot(segments.columns.col(j));
    sum += along * (along > 0.0 ? segments.upper[j] : segments.lower[j]);
  }
  return sum;
}

Zonotope zonotope(const Segments& segments) {
  const int d = static_cast<int>(segments.columns.rows()), n = static_cast<int>(segments.columns.cols());
  assert(d >= 1 && n >= 1 && segments.lower.size() == n && segments.upper.size() == n);
  assert((segments.lower.array() <= segments.upper.array()).all());
  Zonotope result;
  result.inner_direction = result.outer_direction = PolytopeVector::Unit(d, 0);
  const double longest = segments.columns.colwise().norm().maxCoeff();
  double size = 0.0;
  for (int j = 0; j < n; ++j)
    size += segments.columns.col(j).norm() * std::max(std::abs(segments.lower[j]), std::abs(segments.upper[j]));

  const Vertices normals = face_normals(segments, longest);
  result.inner_radius = normals.empty() ? 0.0 : kInfinity;
  if (normals.empty() && longest > 0.0 && d > 1) {  // all on one line: across it there is nothing
    Eigen::Index along = 0, axis = 0;
    segments.columns.colwise().norm().maxCoeff(&along);
    const PolytopeVector line = segments.columns.col(along).normalized();
    line.cwiseAbs().minCoeff(&axis);
    result.inner_direction = (PolytopeVector::Unit(d, axis) - line[axis] * line).normalized();
  }
  for (const PolytopeVector& normal : normals) {
    for (const double sign : {1.0, -1.0}) {
      const double distance = support(segments, sign * normal);
      if (distance < result.inner_radius) {
        result.inner_radius = std::max(0.0, distance);
        result.inner_direction = sign * normal;
      }
    }
  }
  for (unsigned corner = 0; corner < 1U << n; ++corner) {
    PolytopeVector sum = PolytopeVector::Zero(d);
    for (int j = 0; j < n; ++j)
      sum += segments.columns.col(j) * ((corner >> j & 1U) != 0 ? segments.upper[j] : segments.lower[j]);
    if (sum.norm() > result.outer_radius) {
      result.outer_radius = sum.norm();
      result.outer_direction = sum.normalized();
    }
  }
  // The sum of the parallelepipeds of every d columns (Shephard 1974).
  for_each_subset(n, d, [&](const Indices& chosen) {
    Square edges(d, d);
    double widths = 1.0;
    for (int i = 0; i < d; ++i) {
      const int j = chosen[static_cast<std::size_t>(i)];
      edges.col(i) = segments.columns.col(j);
      widths *= segments.upper[j] - segments.lower[j];
    }
    result.volume += std::abs(edges.determinant()) * widths;
  });
  if (d > 3) return result;

  if (normals.empty()) {  // all on one line, or a point
    Indices all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    for (const PolytopeVector& end : line_sum(segments, all, PolytopeVector::Zero(d)))
      vertex_at(result.vertices, end, size);
    return result;
  }
  for (const PolytopeVector& normal : normals) {
    for (const double sign : {1.0, -1.0}) {
      const Indices corners = face_corners(segments, sign * normal, longest, size, result.vertices);
      if (d < 3 || corners.size() < 3) continue;
      const Vertices flat = flat_through(result.vertices, corners, size);
      if (flat.size() < 2) continue;
      Indices loop = face_loop(result.vertices, corners, flat, sign * Eigen::Vector3d(normal));
      const auto same = [&](Indices other) {
        Indices mine = loop;
        std::sort(mine.begin(), mine.end());
        std::sort(other.begin(), other.end());
        return mine == other;
      };
      // Of a flat sum both sides are the same face.
      if (std::none_of(result.faces.begin(), result.faces.end(), same)) result.faces.push_back(std::move(loop));
    }
  }
  if (d == 2 && result.vertices.size() > 2) {
    result.faces = {around(result.vertices, all_of(result.vertices), PolytopeVector::Unit(2, 0),
                           PolytopeVector::Unit(2, 1))};
  }
  return result;
}

}  // namespace zwidth
