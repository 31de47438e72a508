#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/r_cube.h"

// The R-CUBE in the general form. A leg's zero posture has all its links in a row along its axis c.

namespace zwidth {
namespace {

// The leg's own axes: columns e_a, e_b, e_c.
Matrix3 leg_frame(int leg) {
  Matrix3 frame;
  for (int step = 0; step < 3; ++step) frame.col(step) = Vector3::Unit(r_cube_axis(leg, step));
  return frame;
}

// A posture from which solving may start: all driven angles in the middle of their range or, where the arms do
// not reach there, equal and as near to it as they do; failing that the best of a coarse grid.
RCubeSolution home_posture(const RCubeGeometry& geometry, const Interval& range,
                           const RCubeBranches& branches) {
  const auto at = [&](double share) { return range.middle() + 0.5 * range.width() * share; };
  const int steps = 200;
  for (int k = 0; k <= steps; ++k) {
    for (const double side : {1.0, -1.0}) {
      const RCubeSolution solution =
          r_cube_forward(geometry, Vector3::Constant(at(side * k / steps)), branches);
      if (solution.status == SolveStatus::reached) return solution;
    }
  }
  const int n = 12;
  for (int cell = 0; cell < n * n * n; ++cell) {
    const int i = cell % n, j = cell / n % n, k = cell / n / n;
    const Vector3 theta(at((2.0 * i + 1.0) / n - 1.0), at((2.0 * j + 1.0) / n - 1.0),
                        at((2.0 * k + 1.0) / n - 1.0));
    const RCubeSolution solution = r_cube_forward(geometry, theta, branches);
    if (solution.status == SolveStatus::reached) return solution;
  }
  RCubeSolution middle;
  middle.theta.setConstant(range.middle());
  return middle;
}

}  // namespace

LegsDescription legs_of(const RCubeDescription& r_cube) {
  const RCubeGeometry geometry = r_cube_geometry(r_cube);
  const RCubeSolution home = home_posture(geometry, r_cube.joint_range, r_cube_branches(0, r_cube.elbow_mode));

  LegsDescription legs;
  legs.platform = PlatformFreedom::translation;
  for (int i = 0; i < 3; ++i) {
    const Matrix3 frame = leg_frame(i);
    const Vector3 e_a = frame.col(0), e_b = frame.col(1), e_c = frame.col(2);
    const std::string number = std::to_string(i + 1);
    const auto along = [&](double length) -> Vector3 { return geometry.base_offset * e_a + length * e_c; };
    const double to_elbow = geometry.drive_link + geometry.inner_link, to_tip = geometry.total_length();
    const Eigen::Matrix<double, 5, 1> at_home = r_cube_leg_joints(home, i);
    LegDescription leg;
    leg.name = "leg" + number;
    leg.joints = {
        {.name = "theta" + number,
         .active = true,
         .axis = e_b,
         .point = along(0.0),
         .range = r_cube.joint_range,
         .home = at_home[0]},
        {.name = "tilt" + number, .axis = e_b, .point = along(geometry.drive_link), .home = at_home[1]},
        {.name = "swing" + number, .axis = e_a, .point = along(geometry.drive_link), .home = at_home[2]},
        {.name = "elbow" + number, .axis = e_a, .point = along(to_elbow), .home = at_home[3]},
        {.name = "wrist" + number, .axis = e_a, .point = along(to_tip), .home = at_home[4]}};
    leg.tip = along(to_tip);
    leg.attachment = Attachment::rigid;
    legs.legs.push_back(leg);
  }
  return legs;
}

std::vector<BodyDescription> r_cube_leg_bodies(const RCubeDescription& r_cube,
                                               const std::vector<BodyDescription>& bodies) {
  const LegsDescription legs = legs_of(r_cube);
  std::vector<BodyDescription> result;
  for (const BodyDescription& body : bodies) {
    const int joint = body.on == "drive_link"   ? 0
                      : body.on == "inner_link" ? 2
                      : body.on == "outer_link" ? 3
                                                : -1;
    if (joint < 0) {
      result.push_back(body);
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const Matrix3 frame = leg_frame(i);
      const JointDescription& moves = legs.legs[i].joints[joint];
      BodyDescription one = body;
      one.on = legs.legs[i].name + "/" + moves.name;
      if (body.beam) {
        if (auto* bar = std::get_if<BarDescription>(&*one.beam)) bar->width_along = frame * bar->width_along;
        result.push_back(one);
        continue;
      }
      one.centre = moves.point + frame * body.centre;
      one.inertia = frame * body.inertia * frame.transpose();
      result.push_back(one);
    }
  }
  return result;
}

}  // namespace zwidth
