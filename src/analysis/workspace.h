#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "zwidth/mechanism/figure.h"
#include "zwidth/mechanism/mechanism.h"

/// The reachable workspace of a mechanism with three active joints and a platform that only translates, or with
/// two and a tool that translates in a plane: the tool positions whose inverse, on the device's own branch,
/// lies within the joint ranges. All coordinates in the base frame. What is said of z does not concern a plane.
///
/// A delta goes through the batch kernels, an R-CUBE through its closed form; any other mechanism through
/// `solve_inverse`, point after point.

namespace zwidth {

/// Why the functions below cannot answer for this mechanism, as a phrase; nothing if they can.
std::optional<std::string> workspace_obstacle(const Mechanism& mechanism);

/// How to do long work.
struct Effort {
  int threads = 0;  ///< at most this many; 0 uses all cores, and more than all are not used
  std::function<void(double fraction)>
      progress;                               ///< called now and then with 0..1, from any thread, never at once
  const std::atomic<bool>* cancel = nullptr;  ///< set it to stop early
};

/// Minimum, maximum and mean of a figure over lattice points. `count` 0: not computed, or not defined for this
/// mechanism.
struct Statistic {
  std::int64_t count = 0;
  double min = 0.0;
  double max = 0.0;
  double mean = 0.0;
  Vector3 min_at = Vector3::Zero();  ///< tool position of the minimum [m]
  Vector3 max_at = Vector3::Zero();  ///< [m]
  bool unbounded = false;  ///< the figure grows without end towards a singular posture: `max` is what was found
  // Where asked for: half of them stay below the median, 5 of 100 and 95 of 100 below the percentiles.
  std::optional<double> median, percentile_5, percentile_95;
};

struct Extents;

// ------------------------------------------------------------------------------------------ lattice sweep

struct LatticeOptions {
  double spacing = 1e-3;     ///< h [m]; the lattice is the integer multiples of h in the base frame
  DriveLimits limits;        ///< torque limits and joint resolutions of the figures
  bool all_figures = false;  ///< also those beyond kCoreFigureCount
};

/// A sweep of the workspace, reduced as it goes. The same for any number of threads, to the last bit.
struct LatticeSweep {
  double spacing = 0.0;              ///< [m]
  bool complete = true;              ///< false if it was cancelled: figures then cover only a part
  std::int64_t lattice_points = 0;   ///< of the bounding box of the workspace
  std::int64_t inside = 0;           ///< lattice points in the workspace
  double volume = 0.0;               ///< inside x h^3 [m^3]; 0 in a plane
  double area = 0.0;                 ///< inside x h^2 [m^2] of a tool in a plane, else 0
  std::array<Interval, 3> bounds{};  ///< of the lattice points inside [m]
  std::array<Statistic, kFigureCount> figures;

  const Statistic& operator[](Figure figure) const { return figures[static_cast<int>(figure)]; }
};

/// REQUIRES: !workspace_obstacle(mechanism), spacing > 0. Throws std::length_error if a box around the reach
/// has more than 10^12 lattice points.
LatticeSweep sweep_workspace(const Mechanism& mechanism, const LatticeOptions& options,
                             const Effort& effort = {});

/// Moves the extremes of a sweep, with its options, from lattice points to where they really are, so that they
/// do not depend on the lattice: see `Statistic::unbounded`; a least value of 0 is approached, not always
/// reached. REQUIRES: a complete sweep of this mechanism.
void refine_extremes(const Mechanism& mechanism, const LatticeOptions& options, LatticeSweep& sweep,
                     const Effort& effort = {});

/// A lattice spacing not below `least` with which a box around the workspace has at most `most_points` points:
/// 1, 2 or 5 times a power of ten, or `least` [m].
double fitting_spacing(const Extents& extents, double least, double most_points);
/// The finest spacing of 1, 2 or 5 times a power of ten with which a sweep of this mechanism takes some
/// seconds: a point costs nanoseconds with batch kernels, a microsecond in closed form, and tens of them by
/// iteration.
double suitable_spacing(const Mechanism& mechanism, const Extents& extents);

/// The map itself: one row per lattice point inside.
struct WorkspaceMap {
  double spacing = 0.0;  ///< [m]
  bool complete = true;
  int dimension = 3;                    ///< 2 for a tool in a plane
  std::vector<Figure> defined;          ///< figures that were asked for and are defined
  std::vector<Vector3> positions;       ///< by x, then y, then z, ascending [m]
  std::vector<FigureValues> figures;    ///< of each position
  std::vector<std::string> more_names;  ///< of further columns
  std::vector<double> more;             ///< their values, position after position; NaN where there is none

  /// "x", "y", in space "z", the names of the defined figures and those of the further columns.
  std::vector<std::string> columns() const;
};
WorkspaceMap map_workspace(const Mechanism& mechanism, const LatticeOptions& options,
                           const Effort& effort = {});

/// A line of column names, then one line per point; SI.
void write_csv(const WorkspaceMap& map, std::ostream& out);
/// NumPy .npy, version 1.0: little-endian float64, shape (points, columns), C order.
void write_npy(const WorkspaceMap& map, std::ostream& out);

// ------------------------------------------------------------------------------------ continuous figures

/// Ends of the workspace along each axis: not those of a grid, but of the workspace itself.
struct Extents {
  std::array<Interval, 3> range{};                 ///< [m]
  std::array<std::array<Vector3, 2>, 3> at{};      ///< [axis][0 min, 1 max]: tool position there [m]
  std::array<std::array<Vector3, 2>, 3> joints{};  ///< active joints there [rad]
  Vector3 size() const { return {range[0].width(), range[1].width(), range[2].width()}; }
};
Extents workspace_extents(const Mechanism& mechanism);

/// The volume of a workspace, or the area if the tool moves in a plane.
struct WorkspaceVolume {
  enum class Method {
    integral,  ///< of |det J| over the joint ranges
    lattice,   ///< counted, because det J changes sign or some joint values do not close
    outline,   ///< the same in a plane: enclosed by the boundary
  };
  Method method = Method::integral;
  double value = 0.0;           ///< [m^3], [m^2]
  double error_estimate = 0.0;  ///< [m^3], [m^2]
  int order = 0;                ///< Gauss-Legendre points per axis; 0 for the others
  double spacing = 0.0;         ///< of the lattice, or between points of the boundary [m]; 0 for the integral
};
/// "integral", "lattice", "outline".
const char* to_string(WorkspaceVolume::Method method);
WorkspaceVolume workspace_volume(const Mechanism& mechanism, const Effort& effort = {});
/// The volume, or, where it is counted on a coarser lattice than that of a complete sweep, the sweep's count.
/// What counting errs by is of first order in the spacing.
WorkspaceVolume finer_count(WorkspaceVolume volume, const LatticeSweep& sweep);

/// What the count of a complete sweep may be off by [m^3, m^2]: the volume's own error, and, where that does
/// not come from counting, how far the two lie apart.
double counting_error(const WorkspaceVolume& volume, const LatticeSweep& sweep);

/// The largest sphere, or axis-aligned cube, that lies in the workspace; of a tool in a plane the largest
/// circle, or axis-aligned square.
struct InscribedShape {
  Vector3 centre = Vector3::Zero();  ///< [m]
  double size = 0.0;                 ///< radius of the sphere or circle, edge of the cube or square [m]
  double volume = 0.0;               ///< [m^3], of circle and square the area [m^2]
};
struct InscribedShapes {
  InscribedShape sphere;
  InscribedShape cube;

  const InscribedShape& circle() const { return sphere; }  ///< what `sphere` is in a plane
  const InscribedShape& square() const { return cube; }
};
/// Centre and size to some 1e-7 of the size, from inside, as long as the workspace has no holes finer than 1/24
/// (in a plane 1/80) of it.
InscribedShapes inscribed_shapes(const Mechanism& mechanism);

// ------------------------------------------------------------------------------------------- for figures

/// A closed line in a plane, first point not repeated.
using Outline = std::vector<std::array<double, 2>>;

/// The workspace cut by a plane.
struct Slice {
  int axis = 2;                   ///< normal of the plane: 0 x, 1 y, 2 z
  double at = 0.0;                ///< its coordinate [m]
  int u = 0, v = 1;               ///< axes of the plane
  std::vector<Outline> outlines;  ///< [m]; points lie on the boundary within 1e-6 m
  double area = 0.0;              ///< enclosed, holes taken off [m^2]
};

/// Figures on a plane, on a grid of nu x nv points. Values are NaN outside the workspace.
struct SliceMap {
  Slice slice;
  int nu = 0, nv = 0;
  Interval u_range, v_range;                               ///< of the grid points [m]
  std::array<std::vector<double>, kFigureCount> values{};  ///< [figure][iv * nu + iu]
};
/// `points` grid points along the longer side of the plane. Where the tool moves in a plane, that plane is all
/// there is: axis 2, at any height.
SliceMap map_slice(const Mechanism& mechanism, const Extents& extents, int axis, double at, int points,
                   const DriveLimits& limits);

/// The part of a map where the condition number is below `limit`, the outlines within 1e-6 m of where it is
/// reached. REQUIRES: limit > 1, `map` of this mechanism.
Slice condition_region(const Mechanism& mechanism, const SliceMap& map, double limit);

/// The boundary of the workspace as triangles: the image of the faces of the joint ranges. REQUIRES: a tool
/// that moves in space.
struct SurfaceMesh {
  std::vector<Vector3> vertices;              ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< vertex indices
  std::vector<int> face;  ///< of each triangle: 2 j for joint j at its minimum, 2 j + 1 at its maximum
};
/// n + 1 vertices along each edge of a face.
SurfaceMesh workspace_surface(const Mechanism& mechanism, int n);

}  // namespace zwidth
