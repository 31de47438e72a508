#include "support/random_mechanisms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <stdexcept>

#include "zwidth/description/validate.h"
#include "zwidth/mechanism/mechanism_problems.h"
#include "zwidth/mechanism/mobility.h"

namespace zwidth::test {
namespace {

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  bool chance(double share) { return number(0.0, 1.0) < share; }
  Vector3 direction() {
    Vector3 v;
    do {
      v = {number(-1, 1), number(-1, 1), number(-1, 1)};
    } while (v.norm() < 0.2 || v.norm() > 1.0);
    return v.normalized();
  }
  Vector3 in_plane() {
    const double angle = number(-3.1, 3.1);
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  Matrix3 rotation() { return Eigen::AngleAxisd(number(-3.0, 3.0), direction()).toRotationMatrix(); }

  // Which `active` of the joints of all legs are so: dealt out leg by leg, each leg's in any order.
  void activate(LegsDescription& legs, int active) {
    std::vector<std::vector<int>> order;
    for (const LegDescription& leg : legs.legs) {
      order.emplace_back(leg.joints.size());
      std::iota(order.back().begin(), order.back().end(), 0);
      std::shuffle(order.back().begin(), order.back().end(), random_);
    }
    for (std::size_t turn = 0, dealt = 0; dealt < static_cast<std::size_t>(active); ++turn) {
      const std::size_t l = turn % order.size();
      if (order[l].empty()) continue;
      JointDescription& joint = legs.legs[l].joints[static_cast<std::size_t>(order[l].back())];
      order[l].pop_back();
      joint.active = true;
      const double half = joint.type == JointType::prismatic ? number(0.02, 0.06) : number(0.3, 0.8);
      joint.range = {-half, half};
      ++dealt;
    }
  }

  // Joint points from a root to the tip, with bends between; `flat` keeps them in a plane z = const.
  LegDescription leg(int index, int joints, const Vector3& root, const Vector3& tip, bool flat) {
    LegDescription one;
    one.name = "leg" + std::to_string(index + 1);
    one.tip = tip;
    for (int k = 0; k < joints; ++k) {
      JointDescription joint;
      joint.name = "joint" + std::to_string(k + 1);
      const double share = (k + number(0.0, 0.4)) / joints;
      Vector3 bend = direction() * number(0.03, 0.1);
      if (flat) bend.z() = 0.0;
      joint.point = root + share * (tip - root) + (k > 0 ? bend : Vector3::Zero());
      one.joints.push_back(joint);
    }
    return one;
  }
  Vector3 around(int index, int count, double radius, double low, double high) {
    const double angle = 6.283185307 * (index + number(-0.2, 0.2)) / count;
    const double r = radius * number(0.8, 1.2);
    return {r * std::cos(angle), r * std::sin(angle), number(low, high)};
  }

  void turn(JointDescription& joint, const Vector3& axis) { joint.axis = axis; }
  void slide(JointDescription& joint, const Vector3& axis) {
    joint.type = JointType::prismatic;
    joint.axis = axis;
  }
  // Bars to `end`, across the axis.
  void swing(JointDescription& joint, const Vector3& end) {
    joint.type = JointType::parallelogram;
    const Vector3 bar = (end - joint.point).normalized();
    joint.axis = (direction() - bar * bar.dot(direction())).cross(bar).normalized();
  }

  void add_bodies(Description& description) {
    const auto body = [&](std::string on, const Vector3& centre) {
      BodyDescription one;
      one.on = std::move(on);
      one.mass = number(0.02, 0.2);
      one.centre = centre + 0.02 * direction();
      const Vector3 half(number(0.01, 0.05), number(0.01, 0.05), number(0.01, 0.05));
      const Matrix3 R = rotation();
      const Vector3 squares = half.cwiseAbs2();
      const Vector3 sums(squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]);
      one.inertia = R * (one.mass / 3.0 * sums).asDiagonal() * R.transpose();
      one.inertia = (0.5 * (one.inertia + one.inertia.transpose())).eval();
      description.bodies.push_back(one);
    };
    const auto& legs = std::get<LegsDescription>(description.mechanism);
    for (const LegDescription& leg : legs.legs) {
      for (const JointDescription& joint : leg.joints) body(leg.name + "/" + joint.name, joint.point);
    }
    body("platform", Vector3::Zero());
    description.gravity = kStandardGravity * direction();
  }

 private:
  std::mt19937_64 random_;
};

// The platform at the zero posture; legs meet it where their tips are.
void meet(LegsDescription& legs, const Pose& platform) {
  for (LegDescription& leg : legs.legs) {
    leg.platform_point = platform.rotation.transpose() * (leg.tip - platform.position);
    if (leg.attachment == Attachment::rigid) leg.platform_rotation = platform.rotation;
  }
}

// ------------------------------------------------------------------------------------------------ the kinds

LegsDescription serial_arm(Maker& make) {
  LegsDescription legs;
  const int joints = make.whole(2, 7);
  LegDescription leg = make.leg(0, joints, Vector3::Zero(), {0.3, 0.1, 0.2}, false);
  for (JointDescription& joint : leg.joints)
    make.chance(0.25) ? make.slide(joint, make.direction()) : make.turn(joint, make.direction());
  legs.legs = {leg};
  meet(legs, {.position = leg.tip, .rotation = make.rotation()});
  make.activate(legs, joints);
  return legs;
}

LegsDescription positioning_arm(Maker& make) {
  LegsDescription legs;
  legs.platform = PlatformFreedom::point;
  const int joints = make.whole(2, 4);
  LegDescription leg = make.leg(0, joints, Vector3::Zero(), {0.3, 0.1, 0.2}, false);
  leg.attachment = Attachment::spherical;
  for (JointDescription& joint : leg.joints)
    make.chance(0.3) ? make.slide(joint, make.direction()) : make.turn(joint, make.direction());
  legs.legs = {leg};
  make.activate(legs, joints);
  return legs;
}

// Legs in the plane, with `joints` each; the platform a body or a point of it.
LegsDescription planar(Maker& make, PlatformFreedom platform, int joints, Attachment attachment, int fewest) {
  LegsDescription legs;
  legs.platform = platform;
  const bool body = platform != PlatformFreedom::planar_translation;
  const int count = make.whole(fewest, 4);
  const Vector3 centre(make.number(-0.03, 0.03), make.number(-0.03, 0.03), 0.0);
  for (int l = 0; l < count; ++l) {
    const Vector3 tip = body ? Vector3(centre + make.around(l, count, 0.06, 0.0, 0.0)) : centre;
    LegDescription leg = make.leg(l, joints, make.around(l, count, 0.2, 0.0, 0.0), tip, true);
    leg.attachment = attachment;
    int slides = 0;
    for (JointDescription& joint : leg.joints) {
      if (make.chance(0.3) && slides < joints - 1) {
        make.slide(joint, make.in_plane());
        ++slides;
      } else {
        make.turn(joint, make.chance(0.5) ? Vector3(Vector3::UnitZ()) : Vector3(-Vector3::UnitZ()));
      }
    }
    legs.legs.push_back(leg);
  }
  const double angle = attachment == Attachment::rigid ? make.number(-3.0, 3.0) : 0.0;
  meet(legs, {.position = centre, .rotation = Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix()});
  make.activate(legs, body ? 3 : 2);
  return legs;
}

LegsDescription planar_rigid(Maker& make) {
  return planar(make, PlatformFreedom::planar, 3, Attachment::rigid, 1);
}
LegsDescription planar_pinned(Maker& make) {
  return planar(make, PlatformFreedom::planar, 2, Attachment::spherical, 2);
}
LegsDescription planar_point(Maker& make) {
  return planar(make, PlatformFreedom::planar_translation, 2, Attachment::spherical, 1);
}
// Nothing but the legs keeps the platform in its plane.
LegsDescription planar_in_space(Maker& make) {
  return planar(make, PlatformFreedom::rigid, 3, Attachment::rigid, 2);
}

// Nothing turns: three joints per leg that slide or swing on parallel bars.
LegsDescription fixed_orientation(Maker& make, PlatformFreedom platform) {
  LegsDescription legs;
  legs.platform = platform;
  const int count = make.whole(1, 4);
  const Vector3 centre(0.0, 0.0, 0.15);
  for (int l = 0; l < count; ++l) {
    LegDescription leg = make.leg(l, 3, make.around(l, count, 0.2, 0.0, 0.05),
                                  centre + make.around(l, count, 0.05, 0.0, 0.02), false);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3& end = k < 2 ? leg.joints[k + 1].point : leg.tip;
      make.chance(0.6) ? make.swing(leg.joints[k], end) : make.slide(leg.joints[k], make.direction());
    }
    legs.legs.push_back(leg);
  }
  meet(legs, {.position = centre, .rotation = Matrix3::Identity()});
  make.activate(legs, 3);
  return legs;
}
LegsDescription translation(Maker& make) {
  return fixed_orientation(make, PlatformFreedom::translation);
}
LegsDescription translation_in_space(Maker& make) {
  return fixed_orientation(make, PlatformFreedom::rigid);
}

// As the delta's: rods on universal joints, which the declaration stands for parallelograms.
LegsDescription translation_by_rods(Maker& make) {
  LegsDescription legs;
  legs.platform = PlatformFreedom::translation;
  const int count = make.whole(2, 4);
  const Vector3 centre(0.0, 0.0, 0.15);
  for (int l = 0; l < count; ++l) {
    LegDescription leg = make.leg(l, 3, make.around(l, count, 0.2, 0.0, 0.05),
                                  centre + make.around(l, count, 0.05, 0.0, 0.02), false);
    leg.attachment = Attachment::spherical;
    for (JointDescription& joint : leg.joints) make.turn(joint, make.direction());
    if (make.chance(0.4)) make.slide(leg.joints[0], make.direction());
    legs.legs.push_back(leg);
  }
  meet(legs, {.position = centre, .rotation = Matrix3::Identity()});
  make.activate(legs, 3);
  return legs;
}

// A free platform on `joints` per leg, held by points of it or by its links.
LegsDescription free_platform(Maker& make, int count, int joints, Attachment attachment, int active) {
  LegsDescription legs;
  const Vector3 centre(0.02, -0.01, 0.2);
  for (int l = 0; l < count; ++l) {
    LegDescription leg = make.leg(l, joints, make.around(l, count, 0.2, 0.0, 0.05),
                                  centre + make.around(l, count, 0.08, -0.02, 0.02), false);
    leg.attachment = attachment;
    int slides = 0;
    for (JointDescription& joint : leg.joints) {
      if (make.chance(0.25) && slides < std::max(1, joints - 3)) {
        make.slide(joint, make.direction());
        ++slides;
      } else {
        make.turn(joint, make.direction());
      }
    }
    legs.legs.push_back(leg);
  }
  meet(legs, {.position = centre,
              .rotation = attachment == Attachment::rigid ? make.rotation() : Matrix3(Matrix3::Identity())});
  make.activate(legs, active);
  return legs;
}
LegsDescription six_freedoms_on_points(Maker& make) {
  return free_platform(make, make.whole(3, 4), 3, Attachment::spherical, 6);
}
LegsDescription six_freedoms_on_links(Maker& make) {
  return free_platform(make, make.whole(2, 4), 6, Attachment::rigid, 6);
}
LegsDescription three_of_six_freedoms(Maker& make) {
  return free_platform(make, 3, 2, Attachment::spherical, 3);
}

// Six struts between points, each on a universal joint.
LegsDescription hexapod(Maker& make) {
  LegsDescription legs = free_platform(make, 6, 3, Attachment::spherical, 0);
  for (LegDescription& leg : legs.legs) {
    const Vector3 along = (leg.tip - leg.joints[0].point).normalized();
    leg.joints[1].point = leg.joints[0].point;
    make.turn(leg.joints[0], (along.unitOrthogonal() + 0.3 * make.direction()).normalized());
    make.turn(leg.joints[1], along.cross(leg.joints[0].axis).normalized());
    make.slide(leg.joints[2], along);
    leg.joints[2].point = leg.joints[0].point + 0.05 * along;
    leg.joints[2].active = true;
    const double half = make.number(0.02, 0.05);
    leg.joints[2].range = {-half, half};
  }
  return legs;
}

// All axes through one point.
LegsDescription rotation(Maker& make) {
  LegsDescription legs;
  legs.platform = PlatformFreedom::rotation;
  const int count = make.whole(1, 4);
  const Vector3 centre(0.05, 0.02, 0.1);
  for (int l = 0; l < count; ++l) {
    LegDescription leg = make.leg(l, 3, make.around(l, count, 0.2, 0.0, 0.05), centre, false);
    for (JointDescription& joint : leg.joints) {
      make.turn(joint, make.direction());
      joint.point = centre + make.number(0.05, 0.15) * joint.axis;
    }
    legs.legs.push_back(leg);
  }
  meet(legs, {.position = centre, .rotation = make.rotation()});
  make.activate(legs, 3);
  return legs;
}

struct Kind {
  const char* name;
  LegsDescription (*make)(Maker&);
};
constexpr std::array kKinds = {Kind{"serial arm", serial_arm},
                               Kind{"positioning arm", positioning_arm},
                               Kind{"planar, held by links", planar_rigid},
                               Kind{"planar, held by pins", planar_pinned},
                               Kind{"planar point", planar_point},
                               Kind{"planar in space", planar_in_space},
                               Kind{"fixed orientation", translation},
                               Kind{"fixed orientation in space", translation_in_space},
                               Kind{"fixed orientation by rods", translation_by_rods},
                               Kind{"six freedoms on points", six_freedoms_on_points},
                               Kind{"six freedoms on links", six_freedoms_on_links},
                               Kind{"three of six freedoms", three_of_six_freedoms},
                               Kind{"hexapod", hexapod},
                               Kind{"rotation", rotation}};

// Well away from singularities at its zero posture, with as many active joints as freedoms.
bool sound(const Description& description) {
  constexpr double kRegular = 0.03;
  if (!validate(description).empty()) return false;
  const Mechanism mechanism(description);
  const Solution zero = solve_forward(mechanism, ActiveVector::Zero(mechanism.active_count()));
  if (!zero || zero.status != SolveStatus::reached || zero.conditioning < kRegular) return false;
  const Mobility count = mobility(*zero.posture);
  return count.freedoms == count.active && count.loose == 0 && mechanism_problems(description).empty();
}

}  // namespace

int random_mechanism_kinds() {
  return static_cast<int>(kKinds.size());
}

RandomMechanism random_mechanism(std::uint64_t seed) {
  const Kind& kind = kKinds[seed % kKinds.size()];
  Maker make(seed);
  RandomMechanism result{.kind = kind.name};
  constexpr int kPatience = 1000;
  for (int i = 0; i < kPatience; ++i) {
    result.description = {};
    result.description.name = "random";
    result.description.mechanism = kind.make(make);
    make.add_bodies(result.description);
    if (sound(result.description)) return result;
  }
  throw std::logic_error(std::string("no sound mechanism of kind ") + kind.name);
}

}  // namespace zwidth::test
