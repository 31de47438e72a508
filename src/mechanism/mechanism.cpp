#include "zwidth/mechanism/mechanism.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

// Index of the joint named "LEG/JOINT", -1 for the platform.
int joint_of(const std::string& on, const std::vector<std::string>& names) {
  if (on == "platform") return -1;
  const auto found = std::find(names.begin(), names.end(), on);
  assert(found != names.end());
  return static_cast<int>(found - names.begin());
}

}  // namespace

Mechanism::Mechanism(const Description& description) : name_(description.name), gravity_(description.gravity) {
  if (const auto* delta = std::get_if<DeltaDescription>(&description.mechanism))
    delta_ = delta_geometry(*delta);
  closed_form_ = closed_form_of(description.mechanism);
  const Description general = spelled_out(description);
  const LegsDescription& mechanism = std::get<LegsDescription>(general.mechanism);
  assert(mechanism.legs.size() <= kMaxLegs);
  platform_ = mechanism.platform;
  if (platform_ == PlatformFreedom::rigid && mechanism.legs.size() == 1) {
    const auto* rows = std::get_if<SerialDescription>(&description.mechanism);
    const auto found = rows != nullptr ? *rows : rows_of(mechanism.legs.front());
    if (found) serial_ = std::make_shared<SerialChain>(*found);
  }

  std::map<std::string, int> uses;
  for (const LegDescription& leg : mechanism.legs) {
    for (const JointDescription& joint : leg.joints) ++uses[joint.name];
  }
  std::vector<Vector3> points;  // of the joints at the legs' zero posture
  std::vector<Vector3> ends;    // of the links: the next joint's point, or the tip
  std::vector<double> home;
  for (const LegDescription& leg : mechanism.legs) {
    assert(leg.joints.size() <= kMaxLegJoints);
    LegModel model;
    model.first = joint_count();
    model.count = static_cast<int>(leg.joints.size());
    // A tool that is a point asks nothing of orientations.
    model.attachment = platform_ == PlatformFreedom::point ? Attachment::spherical : leg.attachment;
    model.platform_point = leg.platform_point;
    model.platform_rotation = leg.platform_rotation;
    Vector3 inner = Vector3::Zero();
    for (const JointDescription& joint : leg.joints) {
      JointModel one;
      one.type = joint.type;
      one.axis = joint.axis.normalized();
      one.offset = joint.point - inner;
      one.range = joint.range;
      joint_names_.push_back(leg.name + "/" + joint.name);
      if (joint.active) {
        one.active = active_count();
        one.free = joint.free;
        driven_count_ += joint.free ? 0 : 1;
        active_joints_.push_back(joint_count());
        active_names_.push_back(uses[joint.name] == 1 ? joint.name : joint_names_.back());
      }
      characteristic_length_ = std::max(characteristic_length_, one.offset.norm());
      joints_.push_back(one);
      points.push_back(joint.point);
      ends.push_back(&joint == &leg.joints.back() ? leg.tip : (&joint + 1)->point);
      home.push_back(joint.home);
      inner = joint.point;
    }
    model.tip = leg.tip - inner;
    characteristic_length_ = std::max(characteristic_length_, model.tip.norm());
    legs_.push_back(model);
  }
  assert(joint_count() <= kMaxJoints && active_count() <= kMaxActive);
  if (characteristic_length_ == 0.0)
    characteristic_length_ = 1.0;  // nothing but turns in one point: any length does
  home_guess_ = Eigen::Map<const Eigen::VectorXd>(home.data(), static_cast<Eigen::Index>(home.size()));
  drive_inertia_ = ActiveVector::Zero(active_count());

  for (const BodyDescription& body : general.bodies) {
    BodyModel model;
    model.joint = model.turns_with = joint_of(body.on, joint_names_);
    model.mass = body.mass;
    model.centre = model.joint < 0 ? body.centre : Vector3(body.centre - points[model.joint]);
    if (!body.turns_with.empty()) {
      model.turns_with = joint_of(body.turns_with, joint_names_);
      model.pivot = body.pivot - points[model.joint];
      model.centre = body.centre - body.pivot;
    }
    model.inertia = body.inertia;
    if (body.beam) {
      const Vector3& from = points[model.joint];
      const auto link = beam_link(*body.beam, from, ends[model.joint], joints_[model.joint].axis);
      assert(link);
      model.mass = link->mass;
      model.centre = link->centre - from;
      model.inertia = link->inertia;
      beams_.push_back({.joint = model.joint,
                        .length = link->length,
                        .frame = link->frame,
                        .rigidity = link->rigidity,
                        .flexibility = beam_flexibility(link->rigidity, link->length)});
    }
    if (model.joint < 0 && platform_ == PlatformFreedom::point) {
      // The platform is the first leg's last link: its turning counts, though the tool's rows leave it out.
      const LegModel& leg = legs_.front();
      model.joint = model.turns_with = leg.first + leg.count - 1;
      model.centre = leg.tip + leg.platform_rotation * body.centre;
      model.inertia = leg.platform_rotation * body.inertia * leg.platform_rotation.transpose();
    }
    bodies_.push_back(model);
  }
  std::sort(beams_.begin(), beams_.end(),
            [](const BeamModel& a, const BeamModel& b) { return a.joint < b.joint; });
}

std::span<const int> Mechanism::tool_axes() const {
  static constexpr std::array<int, 6> all = {0, 1, 2, 3, 4, 5};
  static constexpr std::array<int, 3> planar = {0, 1, 5};
  switch (platform_) {
    case PlatformFreedom::translation:
    case PlatformFreedom::point:
      return std::span(all).first(3);
    case PlatformFreedom::planar_translation:
      return std::span(all).first(2);
    case PlatformFreedom::planar:
      return planar;
    case PlatformFreedom::rotation:
      return std::span(all).last(3);
    case PlatformFreedom::rigid:
      break;
  }
  return all;
}

ActiveVector Mechanism::with_free_at_home(const ActiveVector& driven) const {
  assert(driven.size() == driven_count_);
  ActiveVector joints(active_count());
  Eigen::Index next = 0;
  for (int i = 0; i < active_count(); ++i) {
    joints[i] = is_free(i) ? home_guess_[active_joint(i)] : driven[next++];
  }
  return joints;
}

int Mechanism::linear_rows() const {
  int rows = 0;
  for (const int axis : tool_axes()) rows += axis < 3 ? 1 : 0;
  return rows;
}

Vector6 Mechanism::six_components(const ToolVector& rows) const {
  Vector6 six = Vector6::Zero();
  const std::span<const int> axes = tool_axes();
  for (std::size_t r = 0; r < axes.size(); ++r) six[axes[r]] = rows[static_cast<Eigen::Index>(r)];
  return six;
}

}  // namespace zwidth
