#include "zwidth/description/validate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <set>

#include "zwidth/description/internal/checks.h"
#include "zwidth/description/internal/schema.h"
#include "zwidth/description/limits.h"
#include "zwidth/description/names.h"

namespace zwidth {
namespace {

constexpr double kUnbounded = 1e8;  // [m] or [rad]; a range beyond is no range

class Validator {
 public:
  explicit Validator(const Description& description) : d_(description) {}

  std::vector<Problem> values() {
    device();
    std::visit([this](const auto& family) { check(family); }, d_.mechanism);
    for (std::size_t i = 0; i < d_.bodies.size(); ++i) check(d_.bodies[i], join_path("body", i));
    for (std::size_t i = 0; i < d_.drives.size(); ++i) check(d_.drives[i], join_path("drive", i));
    for (std::size_t i = 0; i < d_.pneumatic_drives.size(); ++i) {
      check(d_.pneumatic_drives[i], join_path("pneumatic_drive", i));
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < d_.loads.size(); ++i) {
      name(d_.loads[i].name, names, join_path("load", i) + ".name", "load");
      check(d_.loads[i], join_path("load", i));
    }
    names.clear();
    for (std::size_t i = 0; i < d_.postures.size(); ++i) {
      name(d_.postures[i].name, names, join_path("posture", i) + ".name", "posture");
      check(d_.postures[i], join_path("posture", i));
    }
    return std::move(problems_);
  }

  std::vector<Problem> names() {
    const std::vector<std::string> links = link_names(d_.mechanism);
    for (std::size_t i = 0; i < d_.bodies.size(); ++i) {
      const std::string& on = d_.bodies[i].on;
      if (std::find(links.begin(), links.end(), on) == links.end()) {
        wrong(join_path("body", i) + ".on", quoted(on), "is no link of this mechanism", suggest(on, links));
      }
    }
    const std::vector<std::string> single = joint_link_names(d_.mechanism);
    const auto is_single = [&](const std::string& link) {
      return std::find(single.begin(), single.end(), link) != single.end();
    };
    for (std::size_t i = 0; i < d_.bodies.size(); ++i) {
      const BodyDescription& body = d_.bodies[i];
      if (body.turns_with.empty()) continue;
      if (!is_single(body.turns_with)) {
        wrong(join_path("body", i) + ".turns_with", quoted(body.turns_with),
              "is no link that a joint of this mechanism moves", suggest(body.turns_with, single));
      } else if (!is_single(body.on) && std::find(links.begin(), links.end(), body.on) != links.end()) {
        wrong(join_path("body", i) + ".on", quoted(body.on), "cannot carry a body that another link turns",
              "name the one link that a joint moves; " + suggest("", single));
      }
    }
    active_ = active_joint_names(d_.mechanism);
    driven_.assign(active_.size(), false);
    for (std::size_t i = 0; i < d_.drives.size(); ++i) {
      drive_joints(d_.drives[i].joints, join_path("drive", i) + ".joints");
    }
    for (std::size_t i = 0; i < d_.pneumatic_drives.size(); ++i) {
      const PneumaticDriveDescription& drive = d_.pneumatic_drives[i];
      const std::string path = join_path("pneumatic_drive", i);
      drive_joints(drive.joints, path + ".joints");
      const bool direct = std::holds_alternative<DirectCylinderDescription>(drive.mount);
      for (const int joint : driven_joints(d_.mechanism, drive)) {
        if (joint < 0 || is_sliding_joint(d_.mechanism, joint) == direct) continue;
        const std::string& name = active_[static_cast<std::size_t>(joint)];
        if (direct) {
          wrong(path, "", fmt::format("moves \"{}\", which turns, without an arm", name),
                "write mount = { layout = \"two\", ... }, or make the joint prismatic");
        } else {
          wrong(path + ".mount", "", fmt::format("turns an arm, but \"{}\" slides", name),
                "leave mount out: the cylinder is the joint");
        }
      }
    }
    return std::move(problems_);
  }

 private:
  // Notes what is wrong with the joints that a drive names, and which are driven.
  void drive_joints(const std::vector<std::string>& joints, const std::string& key) {
    for (const std::string& joint : joints.empty() ? active_ : joints) {
      const int index = active_joint_index(d_.mechanism, joint);
      const bool is_free = index >= 0 && is_free_joint(d_.mechanism, index);
      if (index < 0) {
        wrong(key, quoted(joint), "is no active joint of this mechanism", suggest(joint, active_));
      } else if (is_free && !joints.empty()) {
        wrong(key, quoted(joint), "is free: the hand moves it", "leave it out, or take free from the joint");
      } else if (!is_free && driven_[index]) {
        wrong(key, quoted(joint), "has another drive already", "give each joint to one drive");
      } else {
        driven_[index] = true;
      }
    }
  }

  static std::string quoted(const std::string& text) { return '"' + shortened(text) + '"'; }

  void wrong(std::string key, std::string value, std::string rule, std::string advice) {
    problems_.push_back({.key = std::move(key),
                         .value = std::move(value),
                         .rule = std::move(rule),
                         .advice = std::move(advice)});
  }

  template <class Owner>
  void check_fields(const Owner& owner, const std::string& path) {
    const std::vector<Problem> found = field_problems(owner, path);
    problems_.insert(problems_.end(), found.begin(), found.end());
  }

  bool finite(const auto& matrix, const std::string& path) {
    if (matrix.allFinite()) return true;
    wrong(path, "", "must be finite", "give numbers");
    return false;
  }

  void device() {
    const auto unfit = [](unsigned char c) { return c < ' ' || c == 0x7f || c == '/' || c == '\\'; };
    if (d_.name.empty()) {
      wrong("device.name", "", "must not be empty", "give the device a short name");
    } else if (d_.name.front() == '.' || std::any_of(d_.name.begin(), d_.name.end(), unfit)) {
      wrong("device.name", quoted(d_.name), "must be fit for the name of a folder",
            "leave out slashes, control characters and a dot in front");
    }
    finite(d_.gravity, "device.gravity");
    rotation(d_.to_user, "device.to_user",
             "give three unit rows at right angles: the user's x, y and z axes in base coordinates");
  }

  void rotation(const Matrix3& R, const std::string& key, const std::string& advice) {
    if (!finite(R, key)) return;
    constexpr double kRounding = 1e-6;  // a matrix typed with seven digits
    const double error = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
    if (error > kRounding) {
      wrong(key, "", fmt::format("must be a rotation; its rows are {:.2g} away from orthonormal", error),
            advice);
    } else if (R.determinant() < 0.0) {
      wrong(key, "", "must be a rotation, but mirrors", "turn one of its rows round");
    }
  }

  void sign(int value, const std::string& key) {
    if (value != 1 && value != -1) {
      wrong(key, fmt::format("{}", value), "must be 1 or -1", "choose one of the two solutions");
    }
  }

  void check(const FiveBarDescription& five_bar) {
    const std::size_t before = problems_.size();
    check_fields(five_bar, "mechanism");
    sign(five_bar.left_mode, "mechanism.left_mode");
    sign(five_bar.right_mode, "mechanism.right_mode");
    sign(five_bar.assembly_mode, "mechanism.assembly_mode");
    if (problems_.size() > before) return;
    // The couplers meet where the elbows are at most two of them apart. Between the samples, each crank is at
    // most half a step away, and its elbow that much times its length.
    const double reach = 2.0 * five_bar.coupler;
    constexpr int kSteps = 72;
    const double left_step = five_bar.left_range.width() / kSteps,
                 right_step = five_bar.right_range.width() / kSteps;
    const double margin = 0.5 * five_bar.crank * (left_step + right_step);
    const bool too_wide = five_bar.half_base >= five_bar.crank + five_bar.coupler;
    struct Direction {
      double x, y;
    };
    std::array<Direction, kSteps + 1> right{};
    for (int j = 0; j <= kSteps; ++j) {
      const double angle = five_bar.right_range.min + j * right_step;
      right[static_cast<std::size_t>(j)] = {std::cos(angle), std::sin(angle)};
    }
    // From the middle of the left range outwards: what can close mostly does so there.
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
      const int from_middle = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
      const double angle = five_bar.left_range.middle() + from_middle * left_step;
      const Direction left{std::cos(angle), std::sin(angle)};
      double squared = std::numeric_limits<double>::infinity();
      for (const Direction& one : right) {
        const double across = 2.0 * five_bar.half_base + five_bar.crank * (one.x - left.x),
                     along = five_bar.crank * (one.y - left.y);
        squared = std::min(squared, across * across + along * along);
      }
      least = std::min(least, std::sqrt(squared));
      if (!too_wide && least - margin <= reach) return;
    }
    wrong("mechanism", "",
          fmt::format(
              "never closes: everywhere in left_range and right_range the elbows are {:.4g} m or more apart, "
              "out of reach of two couplers of {:.4g} m",
              least, five_bar.coupler),
          "lengthen coupler, shorten half_base, or turn the ranges towards each other");
  }

  void check(const RCubeDescription& r_cube) {
    const std::size_t before = problems_.size();
    check_fields(r_cube, "mechanism");
    sign(r_cube.elbow_mode, "mechanism.elbow_mode");
    if (problems_.size() > before) return;
    // An arm has to span from its universal joint to the tool, (y, z) = (S + l1 sin q_b, S + l1 sin q_c - l1
    // cos q_a) with all three angles free in the range.
    const Interval& range = r_cube.joint_range;
    const auto extremes = [&](auto function, std::initializer_list<double> turning_points) {
      Interval of{std::min(function(range.min), function(range.max)),
                  std::max(function(range.min), function(range.max))};
      for (const double at : turning_points) {
        if (!range.contains(at)) continue;
        of = {std::min(of.min, function(at)), std::max(of.max, function(at))};
      }
      return of;
    };
    constexpr double kPi = std::numbers::pi;
    const Interval sine = extremes([](double q) { return std::sin(q); }, {-0.5 * kPi, 0.5 * kPi}),
                   cosine = extremes([](double q) { return std::cos(q); }, {-kPi, 0.0, kPi});
    const double l1 = r_cube.drive_link, S = r_cube.base_offset;
    const Interval y{S + l1 * sine.min, S + l1 * sine.max},
        z{S + l1 * (sine.min - cosine.max), S + l1 * (sine.max - cosine.min)};
    const auto nearest = [](const Interval& i) { return std::max({i.min, -i.max, 0.0}); };
    const auto farthest = [](const Interval& i) { return std::max(-i.min, i.max); };
    const double least = std::hypot(nearest(y), nearest(z)), most = std::hypot(farthest(y), farthest(z));
    const double longest = r_cube.inner_link + r_cube.outer_link,
                 shortest = std::abs(r_cube.inner_link - r_cube.outer_link);
    if (least > longest || most < shortest) {
      wrong(
          "mechanism", "",
          fmt::format("never closes: in joint_range the outer links have to span {:.4g} to {:.4g} m, but reach "
                      "{:.4g} to {:.4g} m",
                      least, most, shortest, longest),
          least > longest ? "lengthen inner_link or outer_link, or widen joint_range"
                          : "make inner_link and outer_link more alike, or widen joint_range");
    }
  }

  void check(const SerialDescription& arm) {
    if (arm.joints.empty())
      wrong("joint", "", "is missing", "describe each row of the Denavit-Hartenberg table with [[joint]]");
    std::set<std::string> names;
    int moving = 0;
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const SerialJointDescription& joint = arm.joints[i];
      const std::string key = join_path("joint", i);
      name(joint.name, names, key + ".name", "joint");
      check_fields(joint, key);
      if (joint.type == SerialJointType::fixed) continue;
      ++moving;
      const Dimension dimension =
          joint.type == SerialJointType::prismatic ? Dimension::length : Dimension::angle;
      range_and_home(joint.range, joint.home, dimension, key);
      if (i > 0) check_rows(arm.joints[i - 1], joint, key);
    }
    if (!arm.joints.empty() && moving == 0)
      wrong("joint", "", "has no joint that moves", "make one revolute or prismatic");
    if (moving > kMaxLegJoints) {
      wrong("joint", fmt::format("{} joints", moving), fmt::format("must be at most {}", kMaxLegJoints), "");
    }
  }

  // The same of two rows that follow each other: z axes on one line.
  void check_rows(const SerialJointDescription& inner, const SerialJointDescription& joint,
                  const std::string& key) {
    constexpr double kSame = 1e-9;
    const bool both_slide =
                   inner.type == SerialJointType::prismatic && joint.type == SerialJointType::prismatic,
               both_turn = inner.type == SerialJointType::revolute && joint.type == SerialJointType::revolute;
    if (std::abs(std::sin(inner.alpha)) > kSame || !(both_slide || (both_turn && std::abs(inner.a) <= kSame)))
      return;
    wrong(key, "",
          fmt::format("{} as \"{}\" does: the link between has no length",
                      both_slide ? "slides the same way" : "turns about the same axis", inner.name),
          fmt::format("give \"{}\" {}, or leave one of the two out", inner.name,
                      both_slide ? "an alpha" : "an a or an alpha"));
  }

  void range_and_home(const Interval& range, double home, Dimension dimension, const std::string& path) {
    const std::size_t before = problems_.size();
    check_interval(range, dimension, {}, path + ".range", "give the lowest and the highest value", problems_);
    if (problems_.size() > before) return;
    check_number(home, dimension, {.min = range.min, .max = range.max}, path + ".home",
                 "start within the range, near a posture that closes the loops", problems_);
  }

  void check(const DeltaDescription& delta) {
    const std::size_t before = problems_.size();
    check_fields(delta, "mechanism");
    if (problems_.size() > before) return;
    // The three forearms reach a common point only if the circle through the elbows (shifted inwards by the
    // platform radius) is no larger than they are. As all legs share the range, the distances d5 + d2
    // cos(theta) of the elbows from the z axis can be made equal, and then are the radius of that circle; while
    // all of them exceed d3 it does too.
    const double offset = delta.base_radius - delta.platform_radius;
    const auto distance = [&](double theta) { return std::abs(offset + delta.upper_arm * std::cos(theta)); };
    double least = std::min(distance(delta.joint_range.min), distance(delta.joint_range.max));
    const double flat = std::acos(std::clamp(-offset / delta.upper_arm, -1.0, 1.0));
    for (const double theta : {-flat, flat, 0.0, -std::numbers::pi, std::numbers::pi}) {
      if (delta.joint_range.contains(theta)) least = std::min(least, distance(theta));
    }
    if (least > delta.forearm) {
      wrong("mechanism", "",
            fmt::format(
                "never closes: everywhere in joint_range the elbows are more than {:.4g} m from the middle, "
                "out of reach of a forearm of {:.4g} m",
                least, delta.forearm),
            "lengthen forearm, or shorten upper_arm or base_radius");
    }
  }

  void check(const LegsDescription& legs) {
    const int count = static_cast<int>(legs.legs.size());
    if (count == 0)
      wrong("leg", "", "is missing", "describe each leg with [[leg]] and its joints with [[leg.joint]]");
    if (count > kMaxLegs) {
      wrong("leg", fmt::format("{} legs", count), fmt::format("must be at most {}", kMaxLegs), "");
    }
    std::set<std::string> names;
    int joints = 0, active = 0;
    const std::size_t before = problems_.size();
    for (std::size_t i = 0; i < legs.legs.size(); ++i) {
      const LegDescription& leg = legs.legs[i];
      const std::string path = join_path("leg", i);
      name(leg.name, names, path + ".name", "leg");
      check(leg, path);
      if (legs.platform == PlatformFreedom::point && !leg.platform_point.isZero(0.0)) {
        wrong(path + ".platform_point", "", "must be zero where the platform is a point",
              "leave it out, and put the tip into the tool point");
      }
      joints += static_cast<int>(leg.joints.size());
      active += static_cast<int>(
          std::count_if(leg.joints.begin(), leg.joints.end(), [](const auto& j) { return j.active; }));
    }
    if (count > 0 && active == 0) {
      wrong("mechanism", "", "has no active joint", "set active = true in the joints that drives move");
    }
    if (active > kMaxActive) {
      wrong("leg", fmt::format("{} active joints", active), fmt::format("must be at most {}", kMaxActive), "");
    }
    if (joints > kMaxJoints) {
      wrong("leg", fmt::format("{} joints", joints), fmt::format("must be at most {}", kMaxJoints), "");
    }
    if (problems_.size() == before) check_reach(legs);
  }

  void name(const std::string& name, std::set<std::string>& names, const std::string& key,
            const std::string& what) {
    if (name.empty()) {
      wrong(key, "", "must not be empty", "name each " + what);
    } else if (name.find('/') != name.npos) {
      wrong(key, quoted(name), "must not contain '/'", "that separates a leg from its joint");
    } else if (!names.insert(name).second) {
      wrong(key, quoted(name), "is the name of another " + what, "give each " + what + " a name of its own");
    }
  }

  void check(const LegDescription& leg, const std::string& path) {
    finite(leg.tip, path + ".tip");
    finite(leg.platform_point, path + ".platform_point");
    rotation(leg.platform_rotation, path + ".platform_rotation",
             "give three unit rows at right angles, whose columns are the platform's axes");
    const int count = static_cast<int>(leg.joints.size());
    if (count == 0) wrong(path + ".joint", "", "is missing", "describe each joint with [[leg.joint]]");
    if (count > kMaxLegJoints) {
      wrong(path + ".joint", fmt::format("{} joints", count), fmt::format("must be at most {}", kMaxLegJoints),
            "");
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < leg.joints.size(); ++i) {
      const JointDescription& joint = leg.joints[i];
      const std::string key = join_path(path + ".joint", i);
      name(joint.name, names, key + ".name", "joint");
      const Vector3& end = i + 1 < leg.joints.size() ? leg.joints[i + 1].point : leg.tip;
      check(joint, end, key);
      if (i > 0) check_link(leg.joints[i - 1], joint, key);
    }
  }

  // Two joints that do the same leave the link between them without a place.
  void check_link(const JointDescription& inner, const JointDescription& joint, const std::string& key) {
    constexpr double kSame = 1e-9;
    if (inner.type != joint.type || joint.type == JointType::parallelogram || !inner.axis.allFinite() ||
        !joint.axis.allFinite() || inner.axis.norm() < kSame || joint.axis.norm() < kSame)
      return;
    const Vector3 u = inner.axis.normalized();
    if (u.cross(joint.axis.normalized()).norm() > kSame) return;
    if (joint.type == JointType::prismatic) {
      wrong(key + ".axis", "", fmt::format("is that of \"{}\", which slides the same way", inner.name),
            "turn it, or leave one of the two out");
    } else if (u.cross(joint.point - inner.point).norm() <= kSame) {
      wrong(key + ".point", "",
            fmt::format(
                "lies on the axis of \"{}\", about which this joint turns too: the link between has no length",
                inner.name),
            "move it off that axis, or leave one of the two out");
    }
  }

  void check(const JointDescription& joint, const Vector3& end, const std::string& path) {
    const Dimension dimension = joint.type == JointType::prismatic ? Dimension::length : Dimension::angle;
    finite(joint.point, path + ".point");
    if (finite(joint.axis, path + ".axis")) {
      constexpr double kRounding = 1e-9;
      const double norm = joint.axis.norm();
      if (norm < kRounding) {
        wrong(path + ".axis", "", "must not be zero", "give the direction of the axis, such as [0, 0, 1]");
      } else if (std::abs(norm - 1.0) > kRounding) {
        wrong(path + ".axis", "", "must be a unit vector", "divide it by its length");
      }
    }
    if (joint.type == JointType::parallelogram && joint.point.allFinite() && end.allFinite() &&
        joint.point == end) {
      wrong(path + ".point", "", "is where the next joint is, so that the parallelogram has no bars",
            "give the root end of its bars");
    }
    range_and_home(joint.range, joint.home, dimension, path);
    const bool bounded = joint.range.min > -kUnbounded && joint.range.max < kUnbounded;
    if (joint.active && !bounded) {
      wrong(path + ".range", "", "is missing", "an active joint needs its lowest and its highest value");
    }
    if (joint.free && !joint.active) {
      wrong(path + ".free", "true", "belongs to an active joint", "set active = true, or leave it out");
    }
  }

  // Necessary for closing: two legs, each stretched out, span the distance between their roots.
  void check_reach(const LegsDescription& legs) {
    const auto reach = [](const LegDescription& leg) {
      double sum = leg.platform_point.norm();
      for (std::size_t i = 0; i < leg.joints.size(); ++i) {
        const JointDescription& joint = leg.joints[i];
        const Vector3& end = i + 1 < leg.joints.size() ? leg.joints[i + 1].point : leg.tip;
        sum += (end - joint.point).norm();
        if (joint.type == JointType::prismatic)
          sum += std::max(std::abs(joint.range.min), std::abs(joint.range.max));
      }
      return sum;
    };
    constexpr double kRounding = 1e-9;
    for (std::size_t i = 0; i < legs.legs.size(); ++i) {
      for (std::size_t j = i + 1; j < legs.legs.size(); ++j) {
        const LegDescription &a = legs.legs[i], &b = legs.legs[j];
        const double gap = (a.joints.front().point - b.joints.front().point).norm();
        const double span = reach(a) + reach(b);
        if (gap > span * (1.0 + kRounding)) {
          wrong(join_path("leg", j), "",
                fmt::format("never closes: its root is {:.4g} m from that of \"{}\", and both stretched out "
                            "span {:.4g} m",
                            gap, a.name, span),
                "lengthen the links or move the roots together");
        }
      }
    }
  }

  // What is wrong with a link's material or laminate, whose keys lie in the table at `path`.
  void check_wall(const WallDescription& wall, const std::string& path) {
    if (const auto* material = std::get_if<Material>(&wall)) {
      check_fields(*material, path + ".material");
      return;
    }
    const LaminateDescription& laminate = std::get<LaminateDescription>(wall);
    const std::string key = path + ".laminate";
    const std::size_t before = problems_.size();
    check_fields(laminate.lamina, key + ".lamina");
    const Lamina& ply = laminate.lamina;
    const double bound = std::sqrt(ply.longitudinal_modulus / ply.transverse_modulus);
    if (problems_.size() == before && !(std::abs(ply.poisson_ratio) < bound)) {
      wrong(key + ".lamina.poisson_ratio", fmt::format("{}", ply.poisson_ratio),
            fmt::format("must be less than {:.4g}, the root of longitudinal over transverse modulus", bound),
            "give nu12, the contraction across the fibres per strain along them");
    }
    int plies = 0;
    for (std::size_t i = 0; i < laminate.plies.size(); ++i) {
      check_fields(laminate.plies[i], join_path(key + ".plies", i));
      plies += std::max(laminate.plies[i].count, 0);
    }
    if (plies == 0) {
      wrong(key + ".plies", "", "has no plies", "write plies = [{ count = 4, angle = 0 }, ...]");
    }
  }

  void check(const TubeDescription& tube, const std::string& path) {
    const std::size_t before = problems_.size();
    check_fields(tube, path);
    if (problems_.size() == before && !(tube.inner_diameter < tube.outer_diameter)) {
      wrong(path + ".inner_diameter", format_quantity(tube.inner_diameter, Dimension::length),
            fmt::format("must be less than outer_diameter, {}",
                        format_quantity(tube.outer_diameter, Dimension::length)),
            "take twice the wall from the outer diameter");
    }
    check_wall(tube.wall, path);
  }

  void check(const BarDescription& bar, const std::string& path) {
    check_fields(bar, path);
    finite(bar.width_along, path + ".width_along");
    check_wall(bar.wall, path);
  }

  void check_beam(const BodyDescription& body, const std::string& path) {
    const bool tube = std::holds_alternative<TubeDescription>(*body.beam);
    std::visit([&](const auto& beam) { check(beam, path + (tube ? ".tube" : ".bar")); }, *body.beam);
    if (body.mass != 0.0 || !body.centre.isZero(0.0) || !body.inertia.isZero(0.0)) {
      wrong(path + ".mass", "", "follows from the section and the material",
            "leave mass, centre and inertia at zero");
    }
    if (!body.turns_with.empty()) {
      wrong(path + ".turns_with", quoted(body.turns_with), "belongs to a body on a pin, not to the link itself",
            "leave it out");
    }
    if (body.on == "platform") {
      wrong(path + ".on", quoted(body.on), "is no link between two joints", "give its mass, or name a link");
    }
  }

  void check(const BodyDescription& body, const std::string& path) {
    if (body.beam) {
      check_beam(body, path);
      return;
    }
    check_number(body.mass, Dimension::mass, {.min = 0.0, .max = 1000.0}, path + ".mass",
                 "give the mass, such as \"80 g\"", problems_);
    finite(body.centre, path + ".centre");
    finite(body.pivot, path + ".pivot");
    const std::string key = path + ".inertia";
    if (!finite(body.inertia, key)) return;
    const Matrix3& I = body.inertia;
    const double size = I.cwiseAbs().maxCoeff();
    constexpr double kRounding =
        1e-6;  // relative: tables give few digits, and thin rods lie on the edge of the rule
    if ((I - I.transpose()).cwiseAbs().maxCoeff() > 1e-12 * size) {
      wrong(key, "", "must be symmetric", "make the entries above and below the diagonal equal");
      return;
    }
    const Vector3 principal = Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues();
    if (principal[0] < -kRounding * size) {
      wrong(key, "",
            fmt::format("must be positive definite; a principal moment is {:.3g} kg m^2", principal[0]),
            "check its signs and its units");
    } else if (principal[2] > principal[0] + principal[1] + kRounding * size) {
      wrong(key, "",
            fmt::format(
                "belongs to no body: the principal moment {:.4g} exceeds the sum of the others, {:.4g} kg m^2",
                principal[2], principal[0] + principal[1]),
            "give the moments about the centre of mass");
    }
  }

  // Whether the tool turns, so that a moment on it moves joints.
  bool tool_turns() const {
    const auto turns = [](PlatformFreedom platform) {
      return platform == PlatformFreedom::rigid || platform == PlatformFreedom::planar ||
             platform == PlatformFreedom::rotation;
    };
    if (const auto* arm = std::get_if<SerialDescription>(&d_.mechanism)) return turns(arm->platform);
    if (const auto* legs = std::get_if<LegsDescription>(&d_.mechanism)) return turns(legs->platform);
    return false;
  }

  void check(const LoadDescription& load, const std::string& path) {
    if (!finite(load.force, path + ".force") || !finite(load.moment, path + ".moment")) return;
    if (load.force.isZero(0.0) && load.moment.isZero(0.0)) {
      wrong(path, "", "is no load: force and moment are zero", "give force = [\"10 N\", 0, 0], say");
    }
    if (!load.moment.isZero(0.0) && !tool_turns()) {
      wrong(path + ".moment", "", "has the wrong dimension: the tool of this mechanism does not turn",
            "leave it out");
    }
  }

  void check(const PostureDescription& posture, const std::string& path) {
    const std::vector<std::string> names = active_joint_names(d_.mechanism);
    const std::vector<Interval> ranges = active_joint_ranges(d_.mechanism);
    const std::vector<Dimension> dimensions = active_joint_dimensions(d_.mechanism);
    if (posture.joints.size() != names.size()) {
      wrong(path + ".joints", fmt::format("{} joints", posture.joints.size()),
            fmt::format("must be {}, one for each active joint", names.size()), "");
      return;
    }
    constexpr double kRounding = 1e-9;
    for (std::size_t i = 0; i < names.size(); ++i) {
      // A range that an angle in degrees meets exactly may miss it by rounding.
      if (!(ranges[i].min < ranges[i].max)) continue;  // said at the range itself
      if (ranges[i].contains(posture.joints[i], kRounding)) continue;
      check_number(posture.joints[i], dimensions[i], {.min = ranges[i].min, .max = ranges[i].max},
                   join_path(path + ".joints", i), "stay within the range of " + names[i], problems_);
    }
  }

  void check(const DriveDescription& drive, const std::string& path) {
    check_fields(drive, path);
    check_fields(drive.motor, path + ".motor");
    check_fields(drive.encoder, path + ".encoder");
    check_fields(drive.amplifier, path + ".amplifier");
    const Amplifier& amplifier = drive.amplifier;
    const double volts = drive.supply_voltage;
    if (volts > amplifier.max_supply_voltage && amplifier.max_supply_voltage > 0.0) {
      wrong(path + ".supply_voltage", format_quantity(volts, Dimension::voltage),
            fmt::format("is more than the amplifier takes, {} V", amplifier.max_supply_voltage), "lower it");
    } else if (volts > 0.0 && volts < amplifier.min_supply_voltage) {
      wrong(path + ".supply_voltage", format_quantity(volts, Dimension::voltage),
            fmt::format("is less than the amplifier needs, {} V", amplifier.min_supply_voltage), "raise it");
    }
    std::visit([&](const auto& transmission) { check(transmission, path + ".transmission"); },
               drive.transmission);
    if (drive.preloader) {
      check_fields(*drive.preloader, path + ".preloader");
      check_fields(drive.preloader->material, path + ".preloader.material");
    }
    if (drive.output) check_fields(*drive.output, path + ".output");
  }

  void check(const DirectDriveDescription&, const std::string&) {}

  void check(const RatioDescription& ratio, const std::string& path) { check_fields(ratio, path); }

  void check(const GearheadDescription& gear, const std::string& path) {
    check_fields(gear, path);
    const Gearhead& gearhead = gear.gearhead;
    const std::size_t before = problems_.size();
    check_fields(gearhead, path + ".gearhead");
    if (problems_.size() == before && gearhead.intermittent_torque < gearhead.continuous_torque) {
      wrong(path + ".gearhead.intermittent_torque",
            format_quantity(gearhead.intermittent_torque, Dimension::torque),
            "must not be less than continuous_torque",
            "what may be carried for ever may be carried for a short time");
    }
  }

  void check(const PneumaticDriveDescription& drive, const std::string& path) {
    const std::size_t before = problems_.size();
    check_fields(drive, path);
    check_fields(drive.cylinder, path + ".cylinder");
    check_fields(drive.regulator, path + ".regulator");
    if (drive.potentiometer) check_fields(*drive.potentiometer, path + ".potentiometer");
    if (const auto* arm = std::get_if<ArmCylinderDescription>(&drive.mount)) check(*arm, path + ".mount");
    if (problems_.size() > before) return;
    const auto pressure = [](double value) { return format_quantity(value, Dimension::pressure); };
    const Regulator& regulator = drive.regulator;
    if (drive.cylinder.rod_area >= drive.cylinder.rear_area) {
      wrong(path + ".cylinder.rod_area", format_quantity(drive.cylinder.rod_area, Dimension::area),
            "must be less than rear_area", "take the section of the rod from the piston's");
    }
    if (regulator.min_pressure >= regulator.max_pressure) {
      wrong(path + ".regulator.min_pressure", pressure(regulator.min_pressure),
            "must be less than max_pressure", "give the pressures at the least and at the largest command");
    }
    if (regulator.min_command >= regulator.max_command) {
      wrong(path + ".regulator.min_command", format_quantity(regulator.min_command, Dimension::voltage),
            "must be less than max_command", "give the least and the largest command");
    }
    if (drive.supply_pressure > regulator.max_supply_pressure) {
      wrong(path + ".supply_pressure", pressure(drive.supply_pressure),
            fmt::format("is more than the regulators take, {}", pressure(regulator.max_supply_pressure)),
            "lower it");
    }
    const double highest =
        std::min({drive.supply_pressure, regulator.max_pressure, drive.cylinder.max_pressure});
    if (drive.bias_pressure >= highest) {
      wrong(path + ".bias_pressure", pressure(drive.bias_pressure),
            fmt::format("must be less than the highest pressure of a chamber, {}", pressure(highest)),
            "lower it");
    }
    const bool voltage = drive.sensor_voltage > 0.0, step = drive.sensor_step > 0.0;
    if ((voltage || step) && !drive.potentiometer) {
      wrong(path + (voltage ? ".sensor_voltage" : ".sensor_step"), "", "has no potentiometer to belong to",
            "name one with potentiometer = ..., or leave it out");
    } else if (step && !voltage) {
      wrong(path + ".sensor_step", "", "means nothing without sensor_voltage",
            "give the voltage across the potentiometer too");
    } else if (drive.potentiometer && drive.sensor_voltage > drive.potentiometer->max_voltage) {
      wrong(path + ".sensor_voltage", format_quantity(drive.sensor_voltage, Dimension::voltage),
            fmt::format("is more than the potentiometer takes, {} V", drive.potentiometer->max_voltage),
            "lower it");
    }
  }

  void check(const ArmCylinderDescription& arm, const std::string& path) {
    check_fields(arm, path);
    const auto misplaced = [&](const char* key, double value) {
      if (value == 0.0) return;
      wrong(path + "." + key, format_quantity(value, Dimension::length),
            fmt::format("is no length of layout \"{}\"", to_string(arm.layout)), "leave it out");
    };
    if (arm.layout == ArmCylinderLayout::one) misplaced("l0", arm.l0);
    if (arm.layout != ArmCylinderLayout::three) {
      misplaced("h", arm.h);
      if (!(arm.l1 > 0.0)) {
        wrong(path + ".l1", format_quantity(arm.l1, Dimension::length), "must be positive in this layout",
              "give the distance of the base pin from the arm's line");
      }
    } else if (arm.l0 == 0.0 && arm.l1 == 0.0) {
      wrong(path + ".l1", "0", "puts the arm pin on the pivot", "give l0 or l1 a length");
    }
  }

  void check(const CapstanDescription& capstan, const std::string& path) {
    const std::size_t before = problems_.size();
    check_fields(capstan, path);
    check_fields(capstan.cable, path + ".cable");
    if (problems_.size() > before) return;
    const Cable& cable = capstan.cable;
    if (cable.bare_diameter > cable.coated_diameter) {
      wrong(path + ".cable.bare_diameter", format_quantity(cable.bare_diameter, Dimension::length),
            "must not be more than coated_diameter", "make both equal for a cable without coating");
    }
    // A 60 deg V-thread: its pitch diameter (Neal 2015, eq 4.14) must leave some metal.
    const double pitch_diameter = capstan.input_diameter - 3.0 / 8.0 * capstan.lead * std::numbers::sqrt3;
    if (pitch_diameter <= 0.0) {
      wrong(path + ".lead", format_quantity(capstan.lead, Dimension::length),
            "cuts the thread deeper than the pulley is thick", "make it finer, or input_diameter larger");
    }
    const double touching = 0.5 * (capstan.input_diameter + capstan.output_diameter);
    if (capstan.centre_distance < touching) {
      wrong(path + ".centre_distance", format_quantity(capstan.centre_distance, Dimension::length),
            fmt::format("makes the pulleys overlap; they touch at {}",
                        format_quantity(touching, Dimension::length)),
            "move the axes apart");
    }
  }

  const Description& d_;
  std::vector<Problem> problems_;
  std::vector<std::string> active_;  // names of the active joints
  std::vector<bool> driven_;         // of each, whether a drive has been met
};

}  // namespace

std::vector<Problem> value_problems(const Description& description) {
  return Validator(description).values();
}
std::vector<Problem> name_problems(const Description& description) {
  return Validator(description).names();
}

std::vector<Problem> validate(const Description& description) {
  std::vector<Problem> problems = value_problems(description);
  const std::vector<Problem> names = name_problems(description);
  problems.insert(problems.end(), names.begin(), names.end());
  return problems;
}

}  // namespace zwidth
