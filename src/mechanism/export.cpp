#include "zwidth/mechanism/export.h"

#include <cmath>
#include <sstream>

namespace zwidth {
namespace {

constexpr double kLeastMass = 1e-9;      // [kg]
constexpr double kLeastInertia = 1e-12;  // [kg m^2]

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '/':
        result += '_';
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << (std::abs(value) < 1e-300 ? 0.0 : value);
  return out.str();
}

std::string vec(const Vector3& v) {
  return number(v[0]) + " " + number(v[1]) + " " + number(v[2]);
}

// What is fixed to one link, taken together: about its centre, both in a frame at the link's point.
struct Lump {
  double mass = 0.0;
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();

  void add(double m, const Vector3& at, const Matrix3& own) {
    const double total = mass + m;
    if (!(total > 0.0)) return;
    const auto parallel = [](double of, const Vector3& d) {
      return Matrix3(of * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose()));
    };
    const Vector3 middle = (mass * centre + m * at) / total;
    inertia += parallel(mass, centre - middle) + own + parallel(m, at - middle);
    mass = total;
    centre = middle;
  }
};

bool pinned(const BodyModel& body) {
  return body.joint >= 0 && body.turns_with != body.joint;
}

// Everything on link `joint` (-1: the platform) but bodies on pins; R turns the link's frame into the lump's.
Lump lump_of(const Mechanism& mechanism, int joint, const Matrix3& R) {
  Lump lump;
  for (const BodyModel& body : mechanism.bodies()) {
    if (body.joint != joint || pinned(body)) continue;
    lump.add(body.mass, R * (body.pivot + body.centre), R * body.inertia * R.transpose());
  }
  return lump;
}

Vector3 span_of(const Mechanism& mechanism, const LegModel& leg, int j) {
  return j + 1 == leg.first + leg.count ? leg.tip : mechanism.joints()[static_cast<std::size_t>(j) + 1].offset;
}

class Mjcf {
 public:
  Mjcf(const Posture& home, const MjcfOptions& options)
      : home_(home), mechanism_(home.mechanism()), options_(options) {}

  ExportedModel write() {
    const std::vector<LegModel>& legs = mechanism_.legs();
    const bool carried =
        legs.front().attachment == Attachment::rigid ||
        mechanism_.platform() == PlatformFreedom::point;  // the first leg's last link is the platform
    std::string bodies;
    for (std::size_t l = 0; l < legs.size(); ++l) bodies += leg(static_cast<int>(l), carried && l == 0);
    if (!carried) bodies += platform_alone();
    std::string text = "<mujoco model=\"" + escaped(mechanism_.name()) + "\">\n";
    for (const std::string& notice : notices_) text += "  <!-- " + notice + " -->\n";
    text += "  <compiler angle=\"radian\" balanceinertia=\"false\"/>\n  <option gravity=\"" +
            vec(mechanism_.gravity()) +
            "\" timestep=\"0.001\" integrator=\"RK4\" iterations=\"100\" tolerance=\"1e-15\">\n"
            "    <flag contact=\"disable\"/>\n  </option>\n  <worldbody>\n" +
            bodies + "  </worldbody>\n";
    if (!equalities_.empty()) text += "  <equality>\n" + equalities_ + "  </equality>\n";
    if (!motors_.empty()) text += "  <actuator>\n" + motors_ + "  </actuator>\n";
    return {text + "</mujoco>\n", notices_};
  }

 private:
  std::string joint_name(int j) const { return escaped(mechanism_.joint_names()[static_cast<std::size_t>(j)]); }

  static std::string inertial(const Lump& lump) {
    const Matrix3 I = lump.inertia + kLeastInertia * Matrix3::Identity();
    return "<inertial pos=\"" + vec(lump.centre) + "\" mass=\"" + number(lump.mass + kLeastMass) +
           "\" fullinertia=\"" + number(I(0, 0)) + " " + number(I(1, 1)) + " " + number(I(2, 2)) + " " +
           number(I(0, 1)) + " " + number(I(0, 2)) + " " + number(I(1, 2)) + "\"/>";
  }

  std::string solver() const {
    const std::string d = number(options_.impedance);
    return " solref=\"0.002 1\" solimp=\"" + d + " " + d + " 0.001\"";
  }

  std::string line(const std::string& text) const {
    return std::string(static_cast<std::size_t>(2 * depth_), ' ') + text + "\n";
  }

  static std::string capsule(const Vector3& to) {
    if (to.norm() < 1e-9) return {};
    return "<geom type=\"capsule\" fromto=\"0 0 0 " + vec(to) +
           "\" size=\"0.003\" mass=\"0\" contype=\"0\" conaffinity=\"0\"/>";
  }

  void couple(const std::string& name, const std::string& to, double sign) {
    equalities_ += "    <joint joint1=\"" + name + "\" joint2=\"" + to + "\" polycoef=\"0 " + number(sign) +
                   " 0 0 0\"" + solver() + "/>\n";
  }

  std::string leg(int l, bool carries_platform) {
    const LegModel& model = mechanism_.legs()[static_cast<std::size_t>(l)];
    std::string text;
    depth_ = 2;
    Vector3 inner = Vector3::Zero();
    std::string last;  // body that the leg's end belongs to
    Vector3 end = Vector3::Zero();
    for (int j = model.first; j < model.first + model.count; ++j) {
      const JointModel& joint = mechanism_.joints()[static_cast<std::size_t>(j)];
      const bool bars = joint.type == JointType::parallelogram;
      const Vector3 at = home_.joint_point(j);
      const Vector3 reach = home_.link_rotation(j) * span_of(mechanism_, model, j);
      const std::string name = joint_name(j);
      text += line("<body name=\"" + name + "\" pos=\"" + vec(at - inner) + "\">");
      ++depth_;
      const bool slides = joint.type == JointType::prismatic;
      std::string element = "<joint name=\"" + name + "\" type=\"" + (slides ? "slide" : "hinge") +
                            "\" axis=\"" + vec(home_.joint_axis(j)) + "\" ref=\"" + number(home_.joints()[j]) +
                            "\"";
      if (joint.range.min > -1e8 && joint.range.max < 1e8)
        element +=
            " limited=\"true\" range=\"" + number(joint.range.min) + " " + number(joint.range.max) + "\"";
      if (joint.active >= 0) {
        const double armature = mechanism_.drive_inertia()[joint.active];
        if (armature > 0.0) element += " armature=\"" + number(armature) + "\"";
        if (!joint.free) motors_ += "    <motor name=\"" + name + "\" joint=\"" + name + "\"/>\n";
      }
      text += line(element + "/>");
      text += line(inertial(lump_of(mechanism_, j, home_.link_rotation(j))));
      if (const std::string shape = capsule(reach); !shape.empty()) text += line(shape);
      text += bodies_on_pins(j);
      inner = at;
      last = name;
      end = reach;
      if (!bars) continue;
      // What follows parallel bars does not turn with them.
      const std::string keep = name + "_keeps";
      text += line("<body name=\"" + keep + "\" pos=\"" + vec(reach) + "\">");
      ++depth_;
      text += line("<joint name=\"" + keep + "\" type=\"hinge\" axis=\"" + vec(home_.joint_axis(j)) + "\"/>");
      text += line(inertial({}));
      couple(keep, name, -1.0);
      inner = at + reach;
      last = keep;
      end.setZero();
    }
    if (carries_platform) {
      const bool point = mechanism_.platform() == PlatformFreedom::point;
      const Vector3 tool = home_.tool().position - inner;
      text += line("<site name=\"tool\" pos=\"" + vec(point ? end : tool) + "\" size=\"0.005\"/>");
      if (!point) {
        text += line("<body name=\"platform\" pos=\"" + vec(tool) + "\">");
        const Lump lump = lump_of(mechanism_, -1, home_.tool().rotation);
        text += line("  " + inertial(lump));
        text += line("</body>");
      }
    } else {
      const bool rigid = model.attachment == Attachment::rigid;
      equalities_ += "    <" + std::string(rigid ? "weld" : "connect") + " body1=\"" + last +
                     "\" body2=\"platform\"" + (rigid ? "" : " anchor=\"" + vec(end) + "\"") + solver() +
                     "/>\n";
    }
    while (depth_ > 2) {
      --depth_;
      text += line("</body>");
    }
    return text;
  }

  // Bodies that hang on link j and are turned by a neighbour of it.
  std::string bodies_on_pins(int j) {
    std::string text;
    int count = 0;
    for (const BodyModel& body : mechanism_.bodies()) {
      if (body.joint != j || !pinned(body)) continue;
      const int t = body.turns_with;
      const std::string name = joint_name(j) + "_pin" + std::to_string(++count);
      const int between = t > j ? t : j;  // the joint that turns one against the other
      if (std::abs(t - j) != 1 ||
          mechanism_.joints()[static_cast<std::size_t>(between)].type != JointType::revolute) {
        notices_.push_back("A body on " + joint_name(j) + " that " + joint_name(t) +
                           " turns is left out: more than one joint lies between them.");
        continue;
      }
      const Matrix3& R = home_.link_rotation(t);
      Lump lump;
      lump.add(body.mass, R * body.centre, R * body.inertia * R.transpose());
      text += line("<body name=\"" + name + "\" pos=\"" + vec(home_.link_rotation(j) * body.pivot) + "\">");
      text += line("  <joint name=\"" + name + "\" type=\"hinge\" axis=\"" + vec(home_.joint_axis(between)) +
                   "\"/>");
      text += line("  " + inertial(lump));
      text += line("</body>");
      couple(name, joint_name(between), t > j ? 1.0 : -1.0);
    }
    return text;
  }

  std::string platform_alone() {
    depth_ = 2;
    std::string text = line("<body name=\"platform\" pos=\"" + vec(home_.tool().position) + "\">");
    ++depth_;
    const auto slide = [&](const char* axis) {
      text += line(std::string("<joint type=\"slide\" axis=\"") + axis + "\"/>");
    };
    switch (mechanism_.platform()) {
      case PlatformFreedom::translation:
      case PlatformFreedom::point:
        slide("1 0 0");
        slide("0 1 0");
        slide("0 0 1");
        break;
      case PlatformFreedom::planar_translation:
        slide("1 0 0");
        slide("0 1 0");
        break;
      case PlatformFreedom::planar:
        slide("1 0 0");
        slide("0 1 0");
        text += line("<joint type=\"hinge\" axis=\"0 0 1\"/>");
        break;
      case PlatformFreedom::rotation:
        text += line("<joint type=\"ball\"/>");
        break;
      case PlatformFreedom::rigid:
        text += line("<freejoint/>");
        break;
    }
    text += line(inertial(lump_of(mechanism_, -1, home_.tool().rotation)));
    text += line("<site name=\"tool\" size=\"0.005\"/>");
    --depth_;
    return text + line("</body>");
  }

  const Posture& home_;
  const Mechanism& mechanism_;
  const MjcfOptions& options_;
  int depth_ = 2;
  std::string equalities_, motors_;
  std::vector<std::string> notices_;
};

class Urdf {
 public:
  Urdf(const Mechanism& mechanism, const ActiveVector& effort, const ActiveVector& speed)
      : mechanism_(mechanism), effort_(effort), speed_(speed) {}

  ExportedModel write() {
    const std::vector<LegModel>& legs = mechanism_.legs();
    body_ = "  <link name=\"base\"/>\n";
    for (std::size_t l = 0; l < legs.size(); ++l) leg(legs[l], l == 0);
    if (legs.size() > 1) {
      notices_.push_back(
          "URDF is a tree: the loops are open, every leg is a branch from the base in its own zero posture, "
          "and the "
          "platform hangs on the first leg alone.");
    }
    if (lost_armature_)
      notices_.emplace_back("URDF has no inertia of rotors and transmissions: it is left out.");
    std::string text = "<?xml version=\"1.0\"?>\n";
    for (const std::string& notice : notices_) text += "<!-- " + notice + " -->\n";
    return {text + "<robot name=\"" + escaped(mechanism_.name()) + "\">\n" + body_ + "</robot>\n", notices_};
  }

 private:
  std::string joint_name(int j) const { return escaped(mechanism_.joint_names()[static_cast<std::size_t>(j)]); }

  void link(const std::string& name, const Lump& lump, const Vector3& reach) {
    body_ += "  <link name=\"" + name + "\">\n";
    const Matrix3 I = lump.inertia + kLeastInertia * Matrix3::Identity();
    body_ += "    <inertial><origin xyz=\"" + vec(lump.centre) + "\"/><mass value=\"" +
             number(lump.mass + kLeastMass) + "\"/><inertia ixx=\"" + number(I(0, 0)) + "\" ixy=\"" +
             number(I(0, 1)) + "\" ixz=\"" + number(I(0, 2)) + "\" iyy=\"" + number(I(1, 1)) + "\" iyz=\"" +
             number(I(1, 2)) + "\" izz=\"" + number(I(2, 2)) + "\"/></inertial>\n";
    const double length = reach.norm();
    if (length > 1e-9) {
      const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), reach);
      const Matrix3 R = q.toRotationMatrix();
      const Vector3 rpy(std::atan2(R(2, 1), R(2, 2)), std::asin(std::fmax(-1.0, std::fmin(1.0, -R(2, 0)))),
                        std::atan2(R(1, 0), R(0, 0)));
      body_ += "    <visual><origin xyz=\"" + vec(0.5 * reach) + "\" rpy=\"" + vec(rpy) +
               "\"/><geometry><cylinder radius=\"0.003\" length=\"" + number(length) +
               "\"/></geometry></visual>\n";
    }
    body_ += "  </link>\n";
  }

  void joint(const std::string& name, const char* type, const std::string& parent, const std::string& child,
             const Vector3& at, const std::string& inner) {
    body_ += "  <joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
             "\"/><child link=\"" + child + "\"/><origin xyz=\"" + vec(at) + "\"/>" + inner + "</joint>\n";
  }

  static std::string axis(const Vector3& direction) { return "<axis xyz=\"" + vec(direction) + "\"/>"; }

  std::string limits(int j) {
    const JointModel& one = mechanism_.joints()[static_cast<std::size_t>(j)];
    const auto of = [&](const ActiveVector& values) {
      const bool known = one.active >= 0 && one.active < values.size() && std::isfinite(values[one.active]);
      return number(known ? values[one.active] : 0.0);
    };
    std::string text = "<limit";
    if (bounded(one))
      text += " lower=\"" + number(one.range.min) + "\" upper=\"" + number(one.range.max) + "\"";
    return text + " effort=\"" + of(effort_) + "\" velocity=\"" + of(speed_) + "\"/>";
  }

  static bool bounded(const JointModel& one) { return one.range.min > -1e8 && one.range.max < 1e8; }

  void leg(const LegModel& model, bool first) {
    std::string parent = "base";
    Vector3 at = Vector3::Zero(), reach = Vector3::Zero();
    for (int j = model.first; j < model.first + model.count; ++j) {
      const JointModel& one = mechanism_.joints()[static_cast<std::size_t>(j)];
      const std::string name = joint_name(j);
      at = j == model.first ? one.offset : reach;
      reach = span_of(mechanism_, model, j);
      const char* type = one.type == JointType::prismatic ? "prismatic"
                         : bounded(one)                   ? "revolute"
                                                          : "continuous";
      if (one.type == JointType::prismatic && !bounded(one)) {
        notices_.push_back("Joint " + name +
                           " slides without limits, which URDF does not know: its limits are zero.");
      }
      joint(name, type, parent, name + "_link", at, axis(one.axis) + limits(j));
      link(name + "_link", lump_of(mechanism_, j, Matrix3::Identity()), reach);
      pins(j);
      parent = name + "_link";
      if (one.active >= 0 && mechanism_.drive_inertia()[one.active] > 0.0) lost_armature_ = true;
      if (one.type != JointType::parallelogram) continue;
      const std::string keep = name + "_keeps";
      joint(keep, "continuous", parent, keep + "_link", reach,
            axis(one.axis) + "<limit effort=\"0\" velocity=\"0\"/><mimic joint=\"" + name +
                "\" multiplier=\"-1\"/>");
      link(keep + "_link", {}, Vector3::Zero());
      parent = keep + "_link";
      reach.setZero();
    }
    if (!first) return;
    if (model.attachment == Attachment::rigid) {
      const Matrix3& R = model.platform_rotation;
      joint("platform", "fixed", parent, "platform_link", reach - R * model.platform_point, "");
      link("platform_link", lump_of(mechanism_, -1, R), Vector3::Zero());
    } else {
      joint("tool", "fixed", parent, "tool_link", reach, "");
      body_ += "  <link name=\"tool_link\"/>\n";
      bool heavy = false;
      for (const BodyModel& body : mechanism_.bodies()) heavy = heavy || (body.joint < 0 && body.mass > 0.0);
      if (heavy)
        notices_.emplace_back(
            "The platform hangs on points of its legs, which a tree cannot say: its mass is left out.");
    }
  }

  void pins(int j) {
    int count = 0;
    for (const BodyModel& body : mechanism_.bodies()) {
      if (body.joint != j || !pinned(body)) continue;
      const int t = body.turns_with, between = t > j ? t : j;
      const std::string name = joint_name(j) + "_pin" + std::to_string(++count);
      if (std::abs(t - j) != 1 ||
          mechanism_.joints()[static_cast<std::size_t>(between)].type != JointType::revolute) {
        notices_.push_back("A body on " + joint_name(j) + " that " + joint_name(t) +
                           " turns is left out: more than one joint lies between them.");
        continue;
      }
      Lump lump;
      lump.add(body.mass, body.centre, body.inertia);
      joint(name, "continuous", joint_name(j) + "_link", name + "_link", body.pivot,
            axis(mechanism_.joints()[static_cast<std::size_t>(between)].axis) +
                "<limit effort=\"0\" velocity=\"0\"/><mimic joint=\"" + joint_name(between) +
                "\" multiplier=\"" + (t > j ? "1" : "-1") + "\"/>");
      link(name + "_link", lump, Vector3::Zero());
    }
  }

  const Mechanism& mechanism_;
  const ActiveVector &effort_, &speed_;
  std::string body_;
  std::vector<std::string> notices_;
  bool lost_armature_ = false;
};

}  // namespace

ExportedModel export_mjcf(const Posture& home, const MjcfOptions& options) {
  return Mjcf(home, options).write();
}

ExportedModel export_urdf(const Mechanism& mechanism, const ActiveVector& effort, const ActiveVector& speed) {
  return Urdf(mechanism, effort, speed).write();
}

}  // namespace zwidth
