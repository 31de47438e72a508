#include "sheet_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "figure/plot.h"
#include "figure/solid.h"
#include "mechanics.h"
#include "sheet_plane.h"
#include "terminal.h"

#include "zwidth/mechanism/posture.h"

namespace zwidth {

namespace {

constexpr double kWidth = 470.0;
constexpr double kWideWidth = 930.0;          // alone in its row
constexpr double kMapWidth = 350.0;           // three beside each other
constexpr std::array<int, 3> kCuts{2, 1, 0};  // normals of the three cuts, in reading order

char axis_name(int axis) {
  return static_cast<char>('x' + axis);
}

Interval millimetres(const Interval& range, double margin) {
  const double extra = margin * range.width();
  return {(range.min - extra) * kMilli, (range.max + extra) * kMilli};
}

/// A coordinate in a title [m].
std::string at_text(double value) {
  return fmt::format("{} mm", trimmed(std::abs(value) < 5e-7 ? 0.0 : value * kMilli, 3));
}

/// How a picture of given size shows points from a corner as large as its margins leave room for.
struct View {
  double azimuth, elevation;         // as `Solid` has them [rad]
  double left, right, top, bottom;   // margins [px]
  double width, height;              // [px]
  double scale = 1.0;                // [px/m]
  Vector3 centre = Vector3::Zero();  // [m]

  /// `flat` allows the picture to become lower.
  void fit(const std::vector<Vector3>& points, bool flat) {
    const Vector3 towards(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                          std::sin(elevation));
    const Vector3 across(-std::sin(azimuth), std::cos(azimuth), 0.0), up = towards.cross(across);
    Interval u{1e300, -1e300}, v = u;
    for (const Vector3& point : points) {
      u = {std::min(u.min, point.dot(across)), std::max(u.max, point.dot(across))};
      v = {std::min(v.min, point.dot(up)), std::max(v.max, point.dot(up))};
    }
    scale = std::min((width - left - right) / std::max(1e-9, u.width()),
                     (height - top - bottom) / std::max(1e-9, v.width()));
    if (flat) height = std::max(0.4 * width, v.width() * scale + top + bottom);
    centre =
        across * (u.middle() - 0.5 * (left - right) / scale) + up * (v.middle() + 0.5 * (top - bottom) / scale);
  }
  Solid solid() const { return Solid(width, height, azimuth, elevation, scale, centre); }
};

// --------------------------------------------------------------------------------------------------- the
// device

const Vector3 kSteel(150, 160, 174);
const Vector3 kDark(74, 84, 99);
const Vector3 kArm(66, 122, 209);
const Vector3 kForearm(205, 211, 220);
const Vector3 kPlatform(240, 150, 60);
const Vector3 kGlass(96, 150, 235);
constexpr std::array<const char*, 3> kPanes = {"wash s4 f4", "wash s3 f3", "wash s1 f1"};  // normal to x, y, z

/// Points of a circular sector, or of a whole disc, around `centre`, in the plane of `u` and `v`.
std::vector<Vector3> arc(const Vector3& centre, const Vector3& u, const Vector3& v, double radius, double from,
                         double to, int steps, bool from_centre) {
  std::vector<Vector3> points;
  if (from_centre) points.push_back(centre);
  for (int i = 0; i <= steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    points.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

void cylinder(Solid& solid, const Vector3& from, const Vector3& to, double radius, const Vector3& rgb) {
  const Vector3 axis = (to - from).normalized();
  const Vector3 u = axis.unitOrthogonal();
  const Vector3 v = axis.cross(u);
  solid.plate(arc(from, u, v, radius, 0.0, 2.0 * std::numbers::pi, 20, false), to - from, rgb);
}

/// A delta in a posture: base, sectors or motors, arms, platform. A sketch: only the lengths of the mechanism
/// and the sector's diameter are those of the device.
void draw_delta(Solid& solid, const DeltaGeometry& geometry, const Posture& posture, double sector_radius,
                double floor) {
  const double bar = 0.045 * geometry.upper_arm;
  const double half_width = 0.2 * std::min(geometry.upper_arm, 2.0 * geometry.platform_radius);
  const Vector3 p = posture.tool().position;
  std::vector<Vector3> plate;
  for (int leg = 0; leg < 3; ++leg) {
    const Vector3 out(std::cos(delta_azimuth(leg)), std::sin(delta_azimuth(leg)), 0.0);
    const Vector3 side = Vector3::UnitZ().cross(out);
    const double reach = geometry.base_radius + 0.42 * geometry.upper_arm;
    for (const double s : {-0.75, 0.75})
      plate.push_back(reach * out + s * geometry.upper_arm * side + floor * Vector3::UnitZ());
  }
  solid.layer(1.0);
  solid.plate(plate, -0.06 * geometry.upper_arm * Vector3::UnitZ(), kSteel);
  solid.layer(1.0);
  std::vector<Vector3> platform;
  for (int leg = 0; leg < 3; ++leg) {
    const double azimuth = delta_azimuth(leg);
    const Vector3 out(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vector3 side = Vector3::UnitZ().cross(out);
    const Vector3 axis = geometry.base_radius * out;
    const double theta = posture.active()[leg];
    const Vector3 along = std::cos(theta) * out + std::sin(theta) * Vector3::UnitZ();
    const Vector3 up = -std::sin(theta) * out + std::cos(theta) * Vector3::UnitZ();
    const Vector3 elbow = axis + geometry.upper_arm * along;
    const Vector3 wrist = p + geometry.platform_radius * out;
    for (const double s : {-1.0, 1.0}) {
      // A bracket on each side of the arm carries its axis.
      const Vector3 at = axis + s * 1.25 * half_width * side;
      const Vector3 drop(0.0, 0.0, floor - axis.z());
      const double top = 0.09 * geometry.upper_arm;
      const double foot = 0.3 * geometry.upper_arm;
      solid.plate({at + top * out + top * Vector3::UnitZ(), at - top * out + top * Vector3::UnitZ(),
                   at - foot * out + drop, at + foot * out + drop},
                  0.05 * geometry.upper_arm * s * side, kDark * 1.25);
      solid.bar(elbow + s * half_width * side, wrist + s * half_width * side, 0.75 * bar, kForearm);
      solid.ball(elbow + s * half_width * side, 1.25 * bar, kSteel);
      solid.ball(wrist + s * half_width * side, 1.25 * bar, kSteel);
    }
    cylinder(solid, axis - 1.2 * half_width * side, axis + 1.2 * half_width * side, 1.1 * bar, kSteel);
    cylinder(solid, elbow - half_width * side, elbow + half_width * side, 0.8 * bar, kSteel);
    solid.bar(axis, elbow, 1.7 * bar, kArm);
    if (sector_radius > 0.0) {
      const double from = -std::numbers::pi * 5.0 / 6.0;
      const double to = -std::numbers::pi / 6.0;
      const Vector3 thickness = 0.09 * geometry.upper_arm * side;
      solid.plate(arc(axis - 0.5 * thickness, along, up, sector_radius, from, to, 18, true), thickness,
                  kArm * 0.92);
      // The input pulley and its motor touch the sector from below.
      const Vector3 pulley = axis - 1.07 * sector_radius * Vector3::UnitZ();
      cylinder(solid, pulley - 0.12 * geometry.upper_arm * side, pulley + 0.16 * geometry.upper_arm * side,
               0.06 * sector_radius, kForearm);
      cylinder(solid, pulley + 0.16 * geometry.upper_arm * side, pulley + 0.75 * geometry.upper_arm * side,
               0.19 * sector_radius, kDark);
    }
    const double w = half_width * 1.25;
    platform.push_back(wrist - w * side - 0.04 * geometry.upper_arm * Vector3::UnitZ());
    platform.push_back(wrist + w * side - 0.04 * geometry.upper_arm * Vector3::UnitZ());
  }
  solid.plate(platform, 0.08 * geometry.upper_arm * Vector3::UnitZ(), kPlatform);
  solid.ball(p + 0.2 * geometry.upper_arm * Vector3::UnitZ(), 0.17 * geometry.upper_arm, kPlatform);
}

/// Links as bars between the joints of each leg: any mechanism.
void draw_links(Solid& solid, const Mechanism& mechanism, const Posture& posture) {
  const double bar = 0.03 * mechanism.characteristic_length();
  for (size_t l = 0; l < mechanism.legs().size(); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    // The first joint turns on the ground, or slides out of it.
    const Vector3& foot = posture.joint_point(leg.first);
    const JointModel& first = mechanism.joints()[static_cast<size_t>(leg.first)];
    const bool slides = first.type == JointType::prismatic;
    const double out = slides ? 1.4 * bar + posture.joints()[leg.first] : 1.4 * bar;
    const Vector3 down = !slides && foot.dot(first.axis) > 0.0 ? first.axis : Vector3(-first.axis);
    cylinder(solid, foot + (out + 1.2 * bar) * down, foot + out * down, 3.2 * bar, kDark);
    cylinder(solid, foot + out * down, foot, 1.5 * bar, kSteel);
    bool moved = false;
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const bool last = j + 1 == leg.first + leg.count;
      const Vector3& from = posture.joint_point(j);
      const Vector3 to = last ? posture.leg_tip(static_cast<int>(l)) : posture.joint_point(j + 1);
      if ((to - from).norm() > 1e-9) {
        solid.bar(from, to, bar, moved ? kForearm : kArm);
        moved = true;
      }
      solid.ball(from, 1.5 * bar, kSteel);
    }
    const Vector3& tip = posture.leg_tip(static_cast<int>(l));
    if ((posture.tool().position - tip).norm() > 1e-9) solid.bar(tip, posture.tool().position, bar, kPlatform);
  }
  solid.ball(posture.tool().position, 2.0 * bar, kPlatform);
}

void draw_mesh(Solid& solid, const SurfaceMesh& mesh, const Vector3& centre, bool front) {
  for (const auto& triangle : mesh.triangles) {
    const Vector3& a = mesh.vertices[static_cast<size_t>(triangle[0])];
    const Vector3& b = mesh.vertices[static_cast<size_t>(triangle[1])];
    const Vector3& c = mesh.vertices[static_cast<size_t>(triangle[2])];
    Vector3 normal = (b - a).cross(c - a);
    if (normal.dot((a + b + c) / 3.0 - centre) < 0.0) normal = -normal;
    if (solid.faces_viewer(normal) == front) solid.polygon({a, b, c}, kGlass, 1.0);
  }
}

/// The lines of a cut, as curves in space.
std::vector<std::vector<Vector3>> in_space(const Slice& slice) {
  std::vector<std::vector<Vector3>> curves;
  for (const Outline& outline : slice.outlines) {
    curves.emplace_back();
    for (const auto& point : outline) {
      Vector3 p;
      p[slice.axis] = slice.at;
      p[slice.u] = point[0];
      p[slice.v] = point[1];
      curves.back().push_back(p);
    }
  }
  return curves;
}

std::optional<SheetFigure> device_picture(const DataSheet& sheet, const Description& description,
                                          const SurfaceMesh& mesh) {
  const Mechanism mechanism(description);
  ActiveVector joints(mechanism.active_count());
  for (int i = 0; i < joints.size(); ++i) joints[i] = mechanism.active_range(i).middle();
  const bool arm = sheet.arm && sheet.arm->home;
  if (arm) joints = sheet.arm->home->active;
  const Solution solution = solve_forward(mechanism, joints);
  if (!solution) return std::nullopt;
  double sector = 0.0;
  for (const DriveDescription& drive : description.drives) {
    if (const auto* capstan = std::get_if<CapstanDescription>(&drive.transmission))
      sector = 0.5 * capstan->output_diameter;
  }
  std::vector<Vector3> seen = {solution.posture->tool().position};
  const auto grow = [&](const Vector3& p) { seen.push_back(p); };
  for (const Vector3& vertex : mesh.vertices) grow(vertex);
  std::array<std::vector<std::vector<Vector3>>, 3> cuts;
  const bool pose = sheet.arm && sheet.arm->pose;
  if (sheet.arm && sheet.arm->reach) {
    for (size_t axis = 0; axis < 3; ++axis) cuts[axis] = in_space(sheet.arm->reach->slices[axis].slice);
  } else if (pose) {
    for (const ReachSlice& cut : sheet.arm->pose->slices)
      cuts[static_cast<size_t>(cut.slice.axis)] = in_space(cut.slice);
  }
  for (const auto& curves : cuts) {
    for (const auto& curve : curves) std::ranges::for_each(curve, grow);
  }
  for (int j = 0; j < mechanism.joint_count(); ++j) grow(solution.posture->joint_point(j));
  double floor = 0.0;
  if (const auto& geometry = mechanism.delta()) {
    floor = -std::max(1.45 * sector, 0.3 * geometry->upper_arm);
    const double reach = geometry->base_radius + geometry->upper_arm;
    grow({reach, reach, floor});
    grow({-reach, -reach, floor});
  }
  Vector3 workspace_centre = Vector3::Zero();
  for (const Vector3& vertex : mesh.vertices)
    workspace_centre += vertex / static_cast<double>(mesh.vertices.size());
  if (!mechanism.delta()) {
    // Room for the feet.
    const double foot = 0.13 * mechanism.characteristic_length();
    for (const LegModel& leg : mechanism.legs()) {
      const Vector3& p = solution.posture->joint_point(leg.first);
      for (int k = 0; k < 3; ++k) {
        grow(p + foot * Vector3::Unit(k));
        grow(p - foot * Vector3::Unit(k));
      }
    }
    // And for the platform with its balls.
    std::vector<Vector3> ends = {solution.posture->tool().position};
    for (std::size_t l = 0; l < mechanism.legs().size(); ++l)
      ends.push_back(solution.posture->leg_tip(static_cast<int>(l)));
    for (const Vector3& end : ends) {
      for (int k = 0; k < 3; ++k) {
        grow(end + 0.4 * foot * Vector3::Unit(k));
        grow(end - 0.4 * foot * Vector3::Unit(k));
      }
    }
  }
  View view{.azimuth = -1.32,
            .elevation = 0.34,
            .left = 30.0,
            .right = 30.0,
            .top = 26.0,
            .bottom = 26.0,
            .width = 900.0,
            .height = 720.0};
  view.fit(seen, true);
  Solid solid = view.solid();
  solid.layer(0.26);
  draw_mesh(solid, mesh, workspace_centre, false);
  solid.layer(0.7);
  for (size_t axis = 0; axis < 3; ++axis) solid.pane(cuts[axis], kPanes[axis]);
  solid.layer(1.0);
  if (const auto& geometry = mechanism.delta()) {
    draw_delta(solid, *geometry, *solution.posture, sector, floor);
  } else {
    draw_links(solid, mechanism, *solution.posture);
  }
  solid.layer(0.2);
  draw_mesh(solid, mesh, workspace_centre, true);
  std::string caption =
      std::string(arm ? "In its home posture" : "In the middle of its joint ranges") +
      (pose && sheet.arm->pose->dimension() < 2    ? "."
       : pose && sheet.arm->pose->dimension() == 2 ? ", with what its tool reaches without turning."
       : pose
           ? ", with three cuts through what its tool reaches without turning: normal to x violet, to y green, "
             "to z blue."
       : arm
           ? ", with three cuts through what its tool point reaches: normal to x violet, to y green, to z blue."
           : ", with its workspace.");
  caption += mechanism.delta() ? " A sketch: link lengths, sectors and workspace are to scale, the rest is not."
                               : " A sketch: joints, lengths and workspace are to scale, the rest is not.";
  return SheetFigure{"device", "device", sheet.title.empty() ? sheet.name : sheet.title, caption,
                     solid.svg("The device and its workspace")};
}

// --------------------------------------------------------------------------------------------------- workspace

SheetFigure workspace_solid(const WorkspaceSheet& workspace) {
  const auto& range = workspace.extents.range;
  const Vector3 low(range[0].min, range[1].min, range[2].min);
  const Vector3 high(range[0].max, range[1].max, range[2].max);
  const double size = (high - low).norm();
  const double floor = low.z() - 0.12 * (high.z() - low.z());
  const auto xs = round_ticks(low.x() * kMilli, high.x() * kMilli, 5);
  const auto ys = round_ticks(low.y() * kMilli, high.y() * kMilli, 5);
  const auto zs = round_ticks(low.z() * kMilli, high.z() * kMilli, 4);
  const auto at = [&](double x, double y) { return Vector3(x / kMilli, y / kMilli, floor); };
  View view{.azimuth = -1.05,
            .elevation = 0.42,
            .left = 46.0,
            .right = 56.0,
            .top = 30.0,
            .bottom = 56.0,
            .width = kWidth,
            .height = 420.0};
  std::vector<Vector3> seen = workspace.surface.vertices;
  for (const double x : {xs.front(), xs.back()}) {
    for (const double y : {ys.front(), ys.back()}) seen.push_back(at(x, y));
  }
  seen.emplace_back(low.x() - 0.03 * size, low.y() - 0.03 * size, high.z());
  view.fit(seen, false);
  Solid solid = view.solid();
  for (const double x : xs) {
    solid.thread(at(x, ys.front()), at(x, ys.back()), "grid");
    solid.text(at(x, ys.front()), fmt::format("{:g}", x), "middle", -8.0, 18.0);
  }
  for (const double y : ys) {
    solid.thread(at(xs.front(), y), at(xs.back(), y), "grid");
    solid.text(at(xs.back(), y), fmt::format("{:g}", y), "start", 12.0, 3.0);
  }
  // The leftmost edge of the box.
  const Vector3 corner(low.x() - 0.03 * size, low.y() - 0.03 * size, floor);
  solid.thread(corner, corner + Vector3(0.0, 0.0, high.z() - floor), "axis");
  for (const double z : zs) {
    const Vector3 on(corner.x(), corner.y(), z / kMilli);
    solid.thread(on, on - Vector3(0.02 * size, 0.0, 0.0), "axis");
    solid.text(on, fmt::format("{:g}", z), "end", -11.0, 4.0);
  }
  solid.text(0.5 * (at(xs.front(), ys.front()) + at(xs.back(), ys.front())), "x [mm]", "middle", -6.0, 40.0);
  solid.text(0.5 * (at(xs.back(), ys.front()) + at(xs.back(), ys.back())), "y [mm]", "start", 36.0, 22.0);
  solid.text(Vector3(corner.x(), corner.y(), high.z()), "z [mm]", "middle", -10.0, -12.0);
  solid.layer(1.0);
  Vector3 centre = Vector3::Zero();
  for (const Vector3& vertex : workspace.surface.vertices)
    centre += vertex / static_cast<double>(workspace.surface.vertices.size());
  draw_mesh(solid, workspace.surface, centre, true);
  return {"workspace-3d", "workspace", "Workspace", "Its boundary: the image of the faces of the joint ranges.",
          solid.svg("Workspace in three dimensions")};
}

std::vector<std::vector<Point2>> curves(const Slice& slice) {
  std::vector<std::vector<Point2>> result;
  for (const Outline& outline : slice.outlines) {
    std::vector<Point2> curve;
    for (const auto& point : outline) curve.push_back({point[0] * kMilli, point[1] * kMilli});
    result.push_back(std::move(curve));
  }
  return result;
}

SheetFigure view(const WorkspaceSheet& workspace, int normal) {
  const Slice& slice = workspace.slices[static_cast<size_t>(normal)].slice;
  const auto u = static_cast<size_t>(slice.u);
  const auto v = static_cast<size_t>(slice.v);
  Plot plot(kWidth, kWidth,
            {fmt::format("{} [mm]", axis_name(slice.u)), millimetres(workspace.extents.range[u], 0.06)},
            {fmt::format("{} [mm]", axis_name(slice.v)), millimetres(workspace.extents.range[v], 0.06)});
  plot.keep_shape(false);
  const auto flat = [&](const Vector3& p) { return Point2{p[slice.u] * kMilli, p[slice.v] * kMilli}; };
  std::vector<std::array<Point2, 3>> triangles;
  for (const auto& t : workspace.surface.triangles) {
    triangles.push_back({flat(workspace.surface.vertices[static_cast<size_t>(t[0])]),
                         flat(workspace.surface.vertices[static_cast<size_t>(t[1])]),
                         flat(workspace.surface.vertices[static_cast<size_t>(t[2])])});
  }
  plot.silhouette(triangles);
  plot.curves(curves(slice), 1);
  const InscribedShapes& inscribed = workspace.inscribed;
  plot.circle(flat(inscribed.sphere.centre), inscribed.sphere.size * kMilli, {});
  plot.rectangle(flat(inscribed.cube.centre), inscribed.cube.size * kMilli, {});
  const char* names[] = {"from the side", "from the front", "from above"};
  return {
      fmt::format("view-{}{}", axis_name(slice.u), axis_name(slice.v)), "workspace",
      fmt::format("Seen {}", names[normal]),
      fmt::format("Line: cut at {} = {}. Shade: the whole workspace. Dashed: largest sphere and cube inside.",
                  axis_name(normal), at_text(slice.at)),
      plot.svg(fmt::format("Workspace {}", names[normal]))};
}

/// Finite values of a figure on all cuts: 2nd to 98th per cent, so that a few points near a singularity leave
/// colours to the rest.
Interval common_range(const WorkspaceSheet& workspace, Figure which) {
  std::vector<double> values;
  for (const SliceMap& map : workspace.slices) {
    for (const double value : map.values[static_cast<size_t>(which)]) {
      if (std::isfinite(value)) values.push_back(value);
    }
  }
  if (values.empty()) return {0.0, 1.0};
  const auto quantile = [&](double q) {
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<size_t>(k)];
  };
  const Interval range{quantile(0.02), quantile(0.98)};
  // The same everywhere: the colour of the middle.
  const double middle = range.middle();
  return range.width() < 1e-2 * std::abs(middle) ? Interval{0.9 * middle, 1.1 * middle} : range;
}

SheetFigure cut(const WorkspaceSheet& workspace, int normal, Figure which, const Interval& range,
                const char* section, const char* id, const char* name, const char* caption, const char* unit) {
  const SliceMap& map = workspace.slices[static_cast<size_t>(normal)];
  Field field{{map.u_range.min * kMilli, map.u_range.max * kMilli},
              {map.v_range.min * kMilli, map.v_range.max * kMilli},
              map.nu,
              map.nv,
              map.values[static_cast<size_t>(which)]};
  // Infinite at a singularity: drawn as the end of the scale.
  for (double& value : field.values) {
    if (std::isinf(value)) value = range.max;
  }
  Plot plot(kMapWidth, kMapWidth,
            {fmt::format("{} [mm]", axis_name(map.slice.u)),
             millimetres(workspace.extents.range[static_cast<size_t>(map.slice.u)], 0.04)},
            {fmt::format("{} [mm]", axis_name(map.slice.v)),
             millimetres(workspace.extents.range[static_cast<size_t>(map.slice.v)], 0.04)});
  plot.keep_shape();
  plot.map(field, curves(map.slice), unit, range);
  return {fmt::format("{}-{}{}", id, axis_name(map.slice.u), axis_name(map.slice.v)), section,
          fmt::format("{}, {} = {}", name, axis_name(normal), at_text(map.slice.at)), caption,
          plot.svg(fmt::format("{}, cut normal to {}", name, axis_name(normal)))};
}

/// What an arm reaches in a plane, and how well conditioned it can be there; or a platform in one orientation.
SheetFigure reach_cut(const ReachSlice& cut, const char* section, const char* name, const char* caption,
                      const Interval& range) {
  const Slice& slice = cut.slice;
  const PlaneGrid& grid = cut.conditioning;
  const Field field{{grid.u.min * kMilli, grid.u.max * kMilli},
                    {grid.v.min * kMilli, grid.v.max * kMilli},
                    grid.nu,
                    grid.nv,
                    grid.values};
  Plot plot(kMapWidth, kMapWidth, {fmt::format("{} [mm]", axis_name(slice.u)), millimetres(grid.u, 0.04)},
            {fmt::format("{} [mm]", axis_name(slice.v)), millimetres(grid.v, 0.04)});
  plot.keep_shape();
  plot.map(field, curves(slice), "", range);
  return {fmt::format("{}-{}{}", section, axis_name(slice.u), axis_name(slice.v)), section,
          fmt::format("{}, {} = {}", name, axis_name(slice.axis), at_text(slice.at)), caption,
          plot.svg(fmt::format("{}, cut normal to {}", name, axis_name(slice.axis)))};
}

/// From zero to the largest conditioning on any cut.
Interval conditioning_range(const std::vector<ReachSlice>& cuts) {
  double most = 0.0;
  for (const ReachSlice& cut : cuts) {
    for (const double value : cut.conditioning.values) {
      if (std::isfinite(value)) most = std::max(most, value);
    }
  }
  return {0.0, most > 0.0 ? most : 1.0};
}

// -------------------------------------------------------------------------------------------------------
// drives

void responses(const DriveSheet& drive, const std::string& section, const std::string& suffix,
               std::vector<SheetFigure>& figures) {
  const ActuatorResponse& response = *drive.response;
  if (!response.frequency.empty()) {
    double low = 1e300;
    double high = 0.0;
    std::vector<Point2> magnitude;
    std::vector<Point2> phase;
    for (size_t i = 0; i < response.frequency.size(); ++i) {
      const double level = 20.0 * std::log10(response.magnitude[i] / response.dc_gain);
      magnitude.push_back({response.frequency[i], level});
      phase.push_back({response.frequency[i], response.phase[i] * kDegrees});
      low = std::min(low, level);
      high = std::max(high, level);
    }
    const Interval band{response.frequency.front(), response.frequency.back()};
    Plot plot(kWidth, 320.0, {"frequency [Hz]", band, true},
              {"tip force per current [dB]", {std::max(low, -60.0) - 2.0, high + 6.0}});
    plot.line(magnitude, 1);
    plot.horizontal(0.0, fmt::format("static: {}", quantity(response.dc_gain, 1.0, "N/A")),
                    Plot::Side::left_below);
    if (response.resonance.is_resonance) {
      plot.mark({response.resonance.frequency, response.resonance_peak},
                fmt::format("{} Hz, {} dB", number(response.resonance.frequency, 4),
                            number(response.resonance_peak, 3)));
    }
    if (response.bandwidth)
      plot.vertical(*response.bandwidth, fmt::format("−3 dB at {} Hz", number(*response.bandwidth, 4)));
    figures.push_back(
        {"frequency-response" + suffix, section, "Frequency response of the actuator",
         "Tip force per motor current over its static value; joint at zero, tip against the contact stiffness.",
         plot.svg("Magnitude of the frequency response")});
    const auto [least, most] = std::minmax_element(phase.begin(), phase.end(),
                                                   [](const Point2& a, const Point2& b) { return a.y < b.y; });
    Plot angle(kWidth, 320.0, {"frequency [Hz]", band, true},
               {"phase [deg]",
                {std::floor(least->y / 45.0) * 45.0, std::max(0.0, std::ceil(most->y / 45.0) * 45.0) + 10.0}});
    angle.line(phase, 2);
    figures.push_back({"phase-response" + suffix, section, "Phase of the actuator", "Of the same response.",
                       angle.svg("Phase of the frequency response")});
  }
  if (!response.step_time.empty()) {
    std::vector<Point2> step;
    double high = 0.0;
    for (size_t i = 0; i < response.step_time.size(); ++i) {
      step.push_back({response.step_time[i] * kMilli, response.step_force[i]});
      high = std::max(high, response.step_force[i]);
    }
    Plot plot(kWidth, 320.0, {"time [ms]", {0.0, response.step_time.back() * kMilli}},
              {"tip force [N]", {0.0, 1.12 * high}});
    plot.horizontal(
        response.dc_gain * response.step_current,
        fmt::format("in the end: {}", quantity(response.dc_gain * response.step_current, 1.0, "N")));
    plot.line(step, 1);
    figures.push_back({"step-response" + suffix, section, "Step response of the actuator",
                       fmt::format("After a step of {} motor current, overshoot {:.1f} %.",
                                   trimmed(response.step_current) + " A", 100.0 * response.step.overshoot),
                       plot.svg("Tip force after a step of current")});
  }
}

void current_loop(const DriveSheet& drive, const std::string& section, const std::string& suffix,
                  std::vector<SheetFigure>& figures) {
  if (drive.current_step.size() < 2) return;
  std::vector<Point2> step;
  double high = 1.0;
  for (size_t i = 0; i < drive.current_step.size(); ++i) {
    step.push_back({static_cast<double>(i) * drive.current_step_period * kMilli, drive.current_step[i]});
    high = std::max(high, drive.current_step[i]);
  }
  Plot plot(kWidth, 320.0, {"time [ms]", {0.0, step.back().x}}, {"current / command", {0.0, 1.12 * high}});
  plot.horizontal(1.0, "command");
  plot.line(step, 3);
  if (step.size() <= 60) plot.dots(step, 3);
  figures.push_back({"current-loop" + suffix, section, "Step response of the current loop",
                     drive.current_loop_bandwidth
                         ? fmt::format("At the amplifier's sampling instants. Bandwidth {} (−3 dB).",
                                       readable(*drive.current_loop_bandwidth, "Hz"))
                         : "At the amplifier's sampling instants.",
                     plot.svg("Current after a step of the command")});
}

/// Bars of what is used of each limit.
SheetFigure margins(const DriveSheet& drive, const std::string& section, const std::string& suffix) {
  const double row = 24.0;
  const double left = 206.0;
  const double right = kWideWidth - 70.0;
  const double top = 8.0;
  double most = 1.2;
  for (const Margin& margin : drive.margins) most = std::max(most, margin.utilisation.value_or(0.0) * 1.05);
  most = std::min(most, 2.5);
  const auto x = [&](double share) { return left + (right - left) * std::min(share, most) / most; };
  const double bottom = top + row * static_cast<double>(drive.margins.size());
  std::string svg = fmt::format(
      "<svg class=\"figure\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Share of every limit that "
      "is used\"><title>Share of every limit that is used</title>",
      kWideWidth, bottom + 42.0);
  for (double share = 0.0; share <= most + 1e-9; share += most > 1.6 ? 0.5 : 0.25) {
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"middle\">{:.0f}</text>",
        x(share), top, bottom, x(share), bottom + 16.0, 100.0 * share);
  }
  double y = top;
  std::string labels;
  for (const Margin& margin : drive.margins) {
    const double share = margin.utilisation.value_or(most);
    svg += fmt::format("<text class=\"strong\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                       left - 8.0, y + 17.0, escaped(margin.name));
    svg += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"15\" rx=\"2\"/>",
                       margin.ok ? "f3" : "bad", left, y + 5.0, std::max(1.0, x(share) - left));
    labels +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kWideWidth - 2.0, y + 17.0,
                    margin.utilisation ? fmt::format("{} %", number(100.0 * share, 3)) : "no limit");
    y += row;
  }
  svg += fmt::format("<path class=\"limit\" d=\"M{0:.1f} {1:.1f}V{2:.1f}\"/>{3}", x(1.0), top, bottom, labels);
  svg += fmt::format(
      "<text class=\"strong\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">used of the limit "
      "[%]</text></svg>",
      0.5 * (left + right), bottom + 36.0);
  return {"margins" + suffix, section, "Margins",
          "At the motor's nominal torque and current unless the rule says otherwise.", svg};
}

}  // namespace

std::vector<SheetFigure> sheet_figures(const DataSheet& sheet, const Description& description) {
  std::vector<SheetFigure> figures;
  if (sheet.plane) {
    figures = plane_sheet_figures(sheet, description);
  } else if (auto picture = device_picture(sheet, description,
                                           sheet.workspace ? sheet.workspace->surface : SurfaceMesh{})) {
    figures.push_back(std::move(*picture));
  }
  if (sheet.workspace) {
    const WorkspaceSheet& workspace = *sheet.workspace;
    if (!workspace.surface.triangles.empty()) figures.push_back(workspace_solid(workspace));
    if (workspace.slices[0].nu > 0) {
      for (const int normal : kCuts) figures.push_back(view(workspace, normal));
      const Interval condition = common_range(workspace, Figure::condition_number);
      for (const int normal : kCuts) {
        figures.push_back(cut(workspace, normal, Figure::condition_number, condition, "dexterity", "condition",
                              "Condition number", "", ""));
      }
      if (sheet.continuous) {
        const Interval force = common_range(workspace, Figure::weakest_force);
        for (const int normal : kCuts) {
          figures.push_back(cut(workspace, normal, Figure::weakest_force, force, "force", "force", "Force",
                                "In every direction, continuous.", "N"));
        }
      }
    }
  }
  if (sheet.mechanics) {
    for (SheetFigure& figure : mechanics_figures(sheet.mechanics->cuts)) figures.push_back(std::move(figure));
  }
  if (sheet.arm && sheet.arm->reach) {
    for (const int normal : kCuts) {
      const ReachSlice& cut = sheet.arm->reach->slices[static_cast<size_t>(normal)];
      if (cut.conditioning.nu > 1 && cut.conditioning.nv > 1) {
        figures.push_back(reach_cut(cut, "reach", "Reach",
                                    "Colour: 1/(condition number) of translation in the best posture found.",
                                    {0.0, 1.0}));
      }
    }
  }
  if (sheet.arm && sheet.arm->pose) {
    const std::vector<ReachSlice>& cuts = sheet.arm->pose->slices;
    const Interval range = conditioning_range(cuts);
    for (auto cut = cuts.rbegin(); cut != cuts.rend(); ++cut) {
      if (cut->conditioning.nu > 1 && cut->conditioning.nv > 1) {
        figures.push_back(reach_cut(*cut, "pose", "Home orientation",
                                    "Colour: 1/(condition number) of the Jacobian, rotations made lengths.",
                                    range));
      }
    }
  }
  for (size_t i = 0; i < sheet.drives.size(); ++i) {
    const std::string section = fmt::format("drive-{}", i);
    const std::string suffix = sheet.drives.size() > 1 ? fmt::format("-{}", i) : "";
    if (!sheet.drives[i].margins.empty()) figures.push_back(margins(sheet.drives[i], section, suffix));
    current_loop(sheet.drives[i], section, suffix, figures);
    if (sheet.drives[i].response) responses(sheet.drives[i], section, suffix, figures);
  }
  return figures;
}

std::string standalone_svg(const SheetFigure& figure) {
  std::string svg = figure.svg;
  const std::string style = fmt::format(
      "<style>svg{{--text:#1c2430;--muted:#5b6675;--grid:#e7eaef;--axis:#9aa4b2;--card:#fff;--s1:#2563c9;--s2:#"
      "d9631e;--s3:#23906b;--s4:#8b4fc6;--bad:#c9302c;"
      "font-family:system-ui,'DejaVu Sans',sans-serif;background:#fff}}{}</style>",
      figure_style());
  svg.insert(svg.find('>') + 1, style);
  svg.replace(0, 4, "<svg xmlns=\"http://www.w3.org/2000/svg\"");
  return svg + "\n";
}

}  // namespace zwidth
