#include <algorithm>
#include <cmath>
#include <numbers>

#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

// The delta in the general form. A leg's zero posture has the upper arm horizontal and the forearm pointing up.

namespace zwidth {
namespace {

// Columns: outwards, tangential (z x outwards), up.
Matrix3 leg_frame(int leg) {
  return Eigen::AngleAxisd(delta_azimuth(leg), Vector3::UnitZ()).toRotationMatrix();
}

// A driven angle, equal on all legs, at which the loops close: the middle of the range, or the nearest to it.
double home_angle(const DeltaGeometry& geometry, const Interval& range) {
  const double middle = range.middle();
  const int steps = 200;
  for (int k = 0; k <= steps; ++k) {
    for (const double side : {1.0, -1.0}) {
      const double theta = middle + side * 0.5 * range.width() * k / steps;
      const SolveStatus status = delta_forward(geometry, Vector3::Constant(theta)).status;
      if (status == SolveStatus::reached) return theta;
    }
  }
  return middle;
}

}  // namespace

Vector3 delta_leg_joints(const DeltaGeometry& geometry, int leg, double theta,
                         const Vector3& position) noexcept {
  const Vector3 local = leg_frame(leg).transpose() * position;
  const Vector3 forearm = local - Vector3(geometry.offset() + geometry.upper_arm * std::cos(theta), 0.0,
                                          geometry.upper_arm * std::sin(theta));
  // forearm / d3 = (-cos(swing) sin(phi), -sin(swing), cos(swing) cos(phi)) with phi = theta + elbow
  const double swing = std::asin(std::clamp(-forearm.y() / geometry.forearm, -1.0, 1.0));
  const double phi = std::atan2(-forearm.x(), forearm.z());
  const double elbow = std::remainder(phi - theta, 2.0 * std::numbers::pi);
  return {theta, elbow, swing};
}

LegsDescription legs_of(const DeltaDescription& description) {
  const DeltaGeometry geometry = delta_geometry(description);
  const double home = home_angle(geometry, description.joint_range);
  const Vector3 home_position = delta_forward(geometry, Vector3::Constant(home)).position;

  LegsDescription legs;
  legs.platform = PlatformFreedom::translation;
  for (int i = 0; i < 3; ++i) {
    const Matrix3 frame = leg_frame(i);
    const Vector3 outwards = frame.col(0), lifting = -frame.col(1);  // positive angles turn about -y
    const Vector3 shoulder = description.base_radius * outwards;
    const Vector3 elbow = shoulder + description.upper_arm * outwards;
    const Vector3 at_home = delta_leg_joints(geometry, i, home, home_position);
    const std::string number = std::to_string(i + 1);

    LegDescription leg;
    leg.name = "leg" + number;
    leg.joints = {{.name = "theta" + number,
                   .type = JointType::revolute,
                   .active = true,
                   .axis = lifting,
                   .point = shoulder,
                   .range = description.joint_range,
                   .home = at_home[0]},
                  {.name = "elbow" + number,
                   .type = JointType::revolute,
                   .axis = lifting,
                   .point = elbow,
                   .home = at_home[1]},
                  {.name = "swing" + number,
                   .type = JointType::revolute,
                   .axis = outwards,
                   .point = elbow,
                   .home = at_home[2]}};
    leg.tip = elbow + description.forearm * Vector3::UnitZ();
    leg.attachment = Attachment::spherical;
    leg.platform_point = description.platform_radius * outwards;
    legs.legs.push_back(leg);
  }
  return legs;
}

std::vector<BodyDescription> delta_leg_bodies(const DeltaDescription& delta,
                                              const std::vector<BodyDescription>& bodies) {
  const LegsDescription legs = legs_of(delta);
  std::vector<BodyDescription> result;
  for (const BodyDescription& body : bodies) {
    const bool upper = body.on == "upper_arm", forearm = body.on == "forearm";
    if (!upper && !forearm) {
      result.push_back(body);
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const Matrix3 frame = leg_frame(i);
      const JointDescription& joint = legs.legs[i].joints[upper ? 0 : 2];
      BodyDescription one = body;
      one.on = legs.legs[i].name + "/" + joint.name;
      if (body.beam) {
        if (auto* bar = std::get_if<BarDescription>(&*one.beam)) bar->width_along = frame * bar->width_along;
        result.push_back(one);
        continue;
      }
      one.centre = joint.point + frame * body.centre;
      one.inertia = frame * body.inertia * frame.transpose();
      result.push_back(one);
    }
  }
  return result;
}

DeltaMasses delta_masses(const Description& description) {
  DeltaMasses masses;
  masses.gravity = -description.gravity.z();
  double along = 0.0, normal = 0.0, inertia = 0.0;
  const auto& delta = std::get<DeltaDescription>(description.mechanism);
  for (const BodyDescription& each : description.bodies) {
    BodyDescription body = each;
    if (each.beam) {
      const bool upper = each.on == "upper_arm";
      const Vector3 end =
          upper ? Vector3(delta.upper_arm * Vector3::UnitX()) : Vector3(delta.forearm * Vector3::UnitZ());
      const Vector3 axis = upper ? Vector3(-Vector3::UnitY()) : Vector3(Vector3::UnitX());
      if (const auto link = beam_link(*each.beam, Vector3::Zero(), end, axis)) {
        body.mass = link->mass;
        body.centre = link->centre;
        body.inertia = link->inertia;
      }
    }
    if (body.on == "upper_arm") {
      masses.upper_arm += body.mass;
      along += body.mass * body.centre.x();
      normal -= body.mass * body.centre.z();  // towards decreasing theta
      inertia += body.inertia(1, 1) +
                 body.mass * (body.centre.x() * body.centre.x() + body.centre.z() * body.centre.z());
    } else if (body.on == "forearm") {
      masses.forearms.array() += body.mass;
    } else if (body.on == "platform") {
      masses.platform += body.mass;
    }
  }
  if (masses.upper_arm > 0.0) {
    masses.centre_along = along / masses.upper_arm;
    masses.centre_normal = normal / masses.upper_arm;
  }
  masses.upper_arm_inertia.setConstant(inertia);
  return masses;
}

}  // namespace zwidth
