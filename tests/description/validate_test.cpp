#include "zwidth/description/validate.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "description/support.h"

#include "zwidth/description/limits.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/families.h"

namespace zwidth {
namespace {

Description delta() {
  return read_description("delta", {}, catalogue());
}
Description slider() {
  return parse_description(legs_text(), "x.toml", {}, catalogue());
}

std::string only_rule(const Description& description, const std::string& key) {
  const std::vector<Problem> problems = validate(description);
  std::string all;
  for (const Problem& problem : problems) all += to_string(problem) + "\n";
  EXPECT_EQ(problems.size(), 1U) << all;
  if (problems.empty()) return {};
  EXPECT_EQ(problems[0].key, key);
  return problems[0].rule;
}

TEST(Validate, FindsNothingInGoodDevices) {
  EXPECT_TRUE(validate(delta()).empty());
  EXPECT_TRUE(validate(slider()).empty());
  EXPECT_TRUE(validate(spelled_out(delta())).empty());
}

TEST(Validate, FindsTheGapsOfADeviceMadeInCode) {
  Description device;
  device.drives.emplace_back();
  const std::vector<Problem> problems = validate(device);
  const auto has = [&](const std::string& key) {
    return std::any_of(problems.begin(), problems.end(), [&](const Problem& p) { return p.key == key; });
  };
  EXPECT_TRUE(has("device.name"));
  EXPECT_TRUE(has("mechanism.forearm"));
  EXPECT_TRUE(has("drive[0].motor.resistance"));
}

TEST(Validate, NoNumberMayBeInfinite) {
  Description device = delta();
  std::get<DeltaDescription>(device.mechanism).forearm = std::numeric_limits<double>::infinity();
  EXPECT_EQ(only_rule(device, "mechanism.forearm"), "must be finite");
  device = delta();
  device.drives[0].motor.stall_torque = std::nan("");
  EXPECT_EQ(only_rule(device, "drive[0].motor.stall_torque"), "must be finite");
  device = delta();
  device.drives[0].motor.max_axial_load = std::nan("");  // not given
  EXPECT_TRUE(validate(device).empty());
}

// The rule is exact: it agrees with solving the loops on a fine grid of equal and of random joint angles.
TEST(Validate, ADeltaIsRefusedExactlyIfNoPostureCloses) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> length(0.02, 0.3), angle(-3.0, 3.0), share(0.0, 1.0);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    Description device = delta();
    device.drives.clear();
    auto& mechanism = std::get<DeltaDescription>(device.mechanism);
    mechanism.base_radius = length(random);
    mechanism.upper_arm = length(random);
    mechanism.forearm = 0.5 * length(random);
    mechanism.platform_radius = length(random);
    const double start = angle(random);
    mechanism.joint_range = {start, std::min(3.1, start + 1.0)};
    const bool never = !validate(device).empty();
    refused += never ? 1 : 0;

    const DeltaGeometry geometry = delta_geometry(mechanism);
    const auto theta = [&](double s) { return start + s * mechanism.joint_range.width(); };
    bool closes = false;
    for (int k = 0; k <= 1000 && !closes; ++k) {
      closes = delta_forward(geometry, Vector3::Constant(theta(k / 1000.0))).status == SolveStatus::reached;
    }
    for (int k = 0; k < 300 && never; ++k) {
      const Vector3 any(theta(share(random)), theta(share(random)), theta(share(random)));
      EXPECT_NE(delta_forward(geometry, any).status, SolveStatus::reached);
    }
    // On the grid a posture that only just closes may be missed, so that only one direction is exact.
    EXPECT_FALSE(closes && never);
    if (!closes && !never) {
      double least = 1.0;
      for (int k = 0; k <= 1000; ++k) {
        least = std::min(least, std::abs(geometry.offset() + geometry.upper_arm * std::cos(theta(k / 1000.0))));
      }
      const double step = geometry.upper_arm * mechanism.joint_range.width() / 1000.0;
      EXPECT_GT(least, geometry.forearm - step);
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 1900);
}

TEST(Validate, TheNameOfADeviceIsFitForAFolder) {
  Description device = delta();
  device.name = "delta-2 (of 2006), größer";
  EXPECT_TRUE(validate(device).empty());
  for (const char* name : {"../delta", "a/b", "..", ".delta", "red\x1b[31m", "a\nb", "a\\b"}) {
    device.name = name;
    EXPECT_EQ(only_rule(device, "device.name"), "must be fit for the name of a folder") << name;
  }
}

TEST(Validate, ToUserMustTurn) {
  Description device = delta();
  device.to_user = -Matrix3::Identity();
  EXPECT_EQ(only_rule(device, "device.to_user"), "must be a rotation, but mirrors");
  device.to_user = Eigen::AngleAxisd(0.3, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_TRUE(validate(device).empty());
  device.to_user(0, 0) += 1e-5;
  EXPECT_TRUE(only_rule(device, "device.to_user").starts_with("must be a rotation; its rows are"));
}

TEST(Validate, NamesAreUnique) {
  Description device = slider();
  auto& legs = std::get<LegsDescription>(device.mechanism);
  legs.legs[0].joints[1].name = "turn";
  device.bodies.clear();
  EXPECT_EQ(only_rule(device, "leg[0].joint[1].name"), "is the name of another joint");
  legs.legs[0].joints[1].name = "a/b";
  EXPECT_EQ(only_rule(device, "leg[0].joint[1].name"), "must not contain '/'");
  legs.legs[0].joints[1].name = "slide";  // of the other leg, which is allowed
  legs.legs[1].name = "crank";
  EXPECT_EQ(only_rule(device, "leg[1].name"), "is the name of another leg");
}

TEST(Validate, JointsHaveDirectionsAndRanges) {
  Description device = slider();
  auto& joint = std::get<LegsDescription>(device.mechanism).legs[0].joints[0];
  joint.axis.setZero();
  EXPECT_EQ(only_rule(device, "leg[0].joint[0].axis"), "must not be zero");
  joint.axis = {0, 0, 2};
  EXPECT_EQ(only_rule(device, "leg[0].joint[0].axis"), "must be a unit vector");
  joint.axis = {0, 0, 1};
  joint.home = 10.0;
  EXPECT_TRUE(only_rule(device, "leg[0].joint[0].home").starts_with("must be from"));
  joint.home = 0.0;
  joint.range = {1.0, 1.0};
  EXPECT_EQ(only_rule(device, "leg[0].joint[0].range"), "must go from a smaller to a larger value");
  joint.range = JointDescription{}.range;
  EXPECT_EQ(only_rule(device, "leg[0].joint[0].range"), "is missing");
  joint.active = false;
  EXPECT_EQ(only_rule(device, "mechanism"), "has no active joint");
}

TEST(Validate, LinksHaveLengths) {
  Description device = slider();
  auto& joints = std::get<LegsDescription>(device.mechanism).legs[0].joints;
  const Vector3 knee = joints[1].point;
  joints[1].point = joints[0].point + 0.02 * joints[0].axis;  // along the axis is no way off it
  EXPECT_TRUE(only_rule(device, "leg[0].joint[1].point").starts_with("lies on the axis of \"turn\""));
  joints[1].axis = {1, 0, 0};  // a universal joint
  EXPECT_TRUE(validate(device).empty());
  joints[1] = joints[0];
  joints[1].name = "knee";
  joints[1].active = false;
  joints[1].point = knee;
  EXPECT_TRUE(validate(device).empty());
  joints[0].type = joints[1].type = JointType::prismatic;
  EXPECT_TRUE(only_rule(device, "leg[0].joint[1].axis").starts_with("is that of \"turn\""));
}

TEST(Validate, RowsOfAnArmDiffer) {
  Description device;
  device.name = "arm";
  SerialDescription arm;
  arm.joints = {{.name = "a", .d = 0.2, .range = {-1, 1}}, {.name = "b", .a = 0.1, .range = {-1, 1}}};
  device.mechanism = arm;
  EXPECT_TRUE(only_rule(device, "joint[1]").starts_with("turns about the same axis as \"a\""));
  arm.joints[0].a = 0.1;
  device.mechanism = arm;
  EXPECT_TRUE(validate(device).empty());
}

TEST(Validate, AParallelogramHasBars) {
  Description device = slider();
  auto& joints = std::get<LegsDescription>(device.mechanism).legs[0].joints;
  joints[0].type = JointType::parallelogram;
  EXPECT_TRUE(validate(device).empty());
  joints[0].point = joints[1].point;
  EXPECT_TRUE(only_rule(device, "leg[0].joint[0].point").starts_with("is where the next joint is"));
}

TEST(Validate, SizesHaveLimits) {
  Description device = slider();
  device.bodies.clear();
  auto& legs = std::get<LegsDescription>(device.mechanism);
  const LegDescription leg = legs.legs[0];
  legs.legs.resize(1);
  legs.legs[0].joints.resize(1);
  for (int i = 1; i <= kMaxLegJoints; ++i) {
    JointDescription joint = leg.joints[0];
    joint.name = "j" + std::to_string(i);
    joint.point.x() += 0.01 * i;
    joint.active = false;
    legs.legs[0].joints.push_back(joint);
  }
  EXPECT_EQ(only_rule(device, "leg[0].joint"), "must be at most 8");
  legs.legs.assign(kMaxLegs + 1, leg);
  for (int i = 0; i <= kMaxLegs; ++i) legs.legs[i].name = "l" + std::to_string(i);
  EXPECT_EQ(only_rule(device, "leg"), "must be at most 6");
  legs.legs.clear();
  EXPECT_EQ(only_rule(device, "leg"), "is missing");
}

TEST(Validate, LegsThatCannotMeetAreRefused) {
  Description device = slider();
  auto& legs = std::get<LegsDescription>(device.mechanism);
  legs.legs[1].joints[0].point.y() += 5.0;
  legs.legs[1].tip.y() += 5.0;
  EXPECT_TRUE(only_rule(device, "leg[1]").starts_with("never closes"));
}

TEST(Validate, FiveBarsMustCloseSomewhere) {
  FiveBarDescription five_bar{
      .crank = 0.1, .coupler = 0.15, .half_base = 0.03, .left_range = {1.5, 3.6}, .right_range = {-0.5, 1.6}};
  Description device;
  device.name = "five-bar";
  const auto with = [&](const FiveBarDescription& mechanism) {
    device.mechanism = mechanism;
    return validate(device);
  };
  EXPECT_TRUE(with(five_bar).empty());
  five_bar.half_base = 0.3;  // the motors too far apart
  ASSERT_EQ(with(five_bar).size(), 1u);
  EXPECT_TRUE(only_rule(device, "mechanism").starts_with("never closes"));
  five_bar.half_base = 0.03;
  five_bar.coupler = 0.06;  // the cranks turned away from each other
  five_bar.left_range = {2.8, 3.4};
  five_bar.right_range = {-0.3, 0.3};
  with(five_bar);
  EXPECT_TRUE(only_rule(device, "mechanism").starts_with("never closes"));
  five_bar.coupler = 0.15;
  five_bar.left_mode = 0;
  with(five_bar);
  EXPECT_EQ(only_rule(device, "mechanism.left_mode"), "must be 1 or -1");
}

TEST(Validate, RCubesWhoseArmsNeverReachAreRefused) {
  Description device;
  device.name = "r-cube";
  RCubeDescription r_cube{.drive_link = 0.1117,
                          .inner_link = 0.0741,
                          .outer_link = 0.1218,
                          .base_offset = 0.1117,
                          .joint_range = {-0.5, 0.5}};
  const auto rule = [&](double inner, double outer, const Interval& range) {
    RCubeDescription changed = r_cube;
    changed.inner_link = inner;
    changed.outer_link = outer;
    changed.joint_range = range;
    device.mechanism = changed;
    return validate(device).empty() ? std::string() : only_rule(device, "mechanism");
  };
  EXPECT_EQ(rule(0.0741, 0.1218, {-0.5, 0.5}), "");
  EXPECT_TRUE(rule(0.02, 0.03, {-0.5, 0.5}).starts_with("never closes"));  // too short
  EXPECT_TRUE(rule(0.02, 0.5, {-0.5, 0.5}).starts_with("never closes"));   // cannot fold enough
  EXPECT_EQ(rule(0.02, 0.04, {-0.5, 0.5}), "");                           // at the inner corner it just reaches
  EXPECT_TRUE(rule(0.02, 0.04, {0.0, 0.5}).starts_with("never closes"));  // which this range leaves out
  EXPECT_EQ(rule(0.001, 0.1119, {-3.1, 3.1}), "");                        // turning points inside the range
  r_cube.elbow_mode = 0;
  EXPECT_NE(only_rule((device.mechanism = r_cube, device), "mechanism.elbow_mode"), "");
}

TEST(Validate, InertiasBelongToBodies) {
  Description device = delta();
  Matrix3& inertia = device.bodies[0].inertia;
  const auto rule = [&] { return only_rule(device, "body[0].inertia"); };
  inertia = Vector3(1, 1, 3).asDiagonal();
  EXPECT_TRUE(rule().starts_with("belongs to no body"));
  inertia = Vector3(1, 1, -1).asDiagonal();
  EXPECT_TRUE(rule().starts_with("must be positive definite"));
  inertia = Vector3(1, 1, 1).asDiagonal();
  inertia(0, 1) = 0.1;
  EXPECT_EQ(rule(), "must be symmetric");
  inertia(1, 0) = 0.1;
  EXPECT_TRUE(validate(device).empty());
  // A thin rod in any direction, and a point.
  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Matrix3 rod = R * Vector3(1, 1, 0).asDiagonal() * R.transpose();
  inertia = 0.5 * (rod + rod.transpose());
  EXPECT_TRUE(validate(device).empty());
  inertia.setZero();
  EXPECT_TRUE(validate(device).empty());
}

Description r_cube() {
  return read_description("r-cube", {}, catalogue());
}
TubeDescription& tube_of(Description& device, std::size_t body) {
  return std::get<TubeDescription>(*device.bodies[body].beam);
}

TEST(Validate, TubesHaveAWall) {
  Description device = r_cube();
  tube_of(device, 0).inner_diameter = tube_of(device, 0).outer_diameter;
  EXPECT_TRUE(only_rule(device, "body[0].tube.inner_diameter").starts_with("must be less than outer_diameter"));
  tube_of(device, 0).inner_diameter = 0.0;
  EXPECT_TRUE(validate(device).empty());
  tube_of(device, 0).outer_diameter = 0.0;
  EXPECT_TRUE(only_rule(device, "body[0].tube.outer_diameter").starts_with("must be more than 0"));
}

TEST(Validate, MaterialsOfLinksArePossible) {
  Description device = r_cube();
  tube_of(device, 1).wall = Material{.elastic_modulus = 70e9, .poisson_ratio = 0.6, .density = 2700.0};
  EXPECT_TRUE(only_rule(device, "body[1].tube.material.poisson_ratio").starts_with("must be more than -1"));
  device = r_cube();
  auto& laminate = std::get<LaminateDescription>(tube_of(device, 1).wall);
  laminate.lamina.poisson_ratio = 5.1;  // the root of 300 / 12 is 5
  EXPECT_TRUE(
      only_rule(device, "body[1].tube.laminate.lamina.poisson_ratio").starts_with("must be less than 5"));
  laminate.lamina.poisson_ratio = -4.9;
  EXPECT_TRUE(validate(device).empty());
  for (PlyDescription& ply : laminate.plies) ply.count = 0;
  EXPECT_EQ(only_rule(device, "body[1].tube.laminate.plies"), "has no plies");
  laminate.plies.clear();
  EXPECT_EQ(only_rule(device, "body[1].tube.laminate.plies"), "has no plies");
  laminate.plies = {{.count = 3}, {.count = -1}};
  EXPECT_TRUE(only_rule(device, "body[1].tube.laminate.plies[1].count").starts_with("must be from 0"));
}

TEST(Validate, ALinkThatIsABeamHasItsMassFromIt) {
  Description device = r_cube();
  device.bodies[0].mass = 0.1;
  EXPECT_EQ(only_rule(device, "body[0].mass"), "follows from the section and the material");
  device = r_cube();
  device.bodies[0].on = "platform";
  EXPECT_EQ(only_rule(device, "body[0].on"), "is no link between two joints");
}

TEST(Validate, EveryJointHasOneDriveAtMost) {
  Description device = delta();
  device.drives.push_back(device.drives[0]);
  EXPECT_EQ(validate(device).size(), 3U);
  device.drives[0].joints = {"theta1", "theta2"};
  device.drives[1].joints = {"theta3"};
  EXPECT_TRUE(validate(device).empty());
  device.drives.resize(1);  // an active joint without a drive is allowed
  EXPECT_TRUE(validate(device).empty());
}

}  // namespace
}  // namespace zwidth
