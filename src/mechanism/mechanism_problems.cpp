#include "zwidth/mechanism/mechanism_problems.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "zwidth/description/names.h"
#include "zwidth/math/svd.h"
#include "zwidth/mechanism/internal/posture_builder.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/mobility.h"

namespace zwidth {
namespace {

constexpr int kFurtherPostures = 10;

// "leg[1].joint[0]" of a joint by its index among all.
std::string key_of(const Mechanism& mechanism, int joint) {
  for (std::size_t l = 0; l < mechanism.legs().size(); ++l) {
    const LegModel& leg = mechanism.legs()[l];
    if (joint < leg.first + leg.count) return fmt::format("leg[{}].joint[{}]", l, joint - leg.first);
  }
  return "leg";
}

std::string value_text(const Mechanism& mechanism, int joint, double value) {
  if (mechanism.joints()[static_cast<std::size_t>(joint)].type == JointType::prismatic)
    return fmt::format("{:.4g} mm", 1e3 * value);
  return fmt::format("{:.4g} deg", value * 57.295779513082320877);
}

std::string quoted(const std::string& name) {
  return '"' + name + '"';
}

// "a", "b" and 2 more.
std::string listed(const Mechanism& mechanism, const std::vector<int>& joints) {
  constexpr std::size_t kMost = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, joints.size()); ++i)
    text += (i == 0 ? "" : ", ") + quoted(mechanism.joint_names()[static_cast<std::size_t>(joints[i])]);
  if (joints.size() > kMost) text += fmt::format(" and {} more", joints.size() - kMost);
  return text;
}

std::string counted(int number, const char* singular, const char* plural) {
  return fmt::format("{} {}", number, number == 1 ? singular : plural);
}

std::vector<Problem> assembly_problems(const Mechanism& mechanism, const Assembly& assembly) {
  if (assembly.found) return {};
  if (!assembly.closes) {
    return {
        {.key = "leg",
         .rule = fmt::format("never closes: of {} starts in the joint ranges the best leaves the legs {:.3g} m "
                             "apart",
                             assembly.tried, assembly.gap),
         .advice =
             "check points, tips and platform points of the legs; home is to be near a posture that closes"}};
  }
  const JointModel& joint = mechanism.joints()[static_cast<std::size_t>(assembly.outside)];
  const auto text = [&](double value) { return value_text(mechanism, assembly.outside, value); };
  return {{.key = key_of(mechanism, assembly.outside) + ".range",
           .value = fmt::format("[{}, {}]", text(joint.range.min), text(joint.range.max)),
           .rule = fmt::format("excludes every posture that was found: the loops close with {} at {}, say",
                               quoted(mechanism.joint_names()[static_cast<std::size_t>(assembly.outside)]),
                               text(assembly.needed)),
           .advice = "widen the range, or move the legs"}};
}

// The solvers do not get away from home, though there is a posture.
Problem home_problem(const Mechanism& mechanism, const Posture& posture) {
  std::string values;
  for (int j = 0; j < mechanism.joint_count(); ++j) {
    const auto index = static_cast<std::size_t>(j);
    const double value = internal::wrapped(mechanism.joints()[index], posture.joints()[j]);
    values += fmt::format("{}{} {}", j == 0 ? "" : ", ", mechanism.joint_names()[index],
                          value_text(mechanism, j, value));
  }
  return {.key = key_of(mechanism, 0) + ".home",
          .rule = "is too far from a posture that closes the loops: solving starts from there and finds none",
          .advice = "set home in every joint as here: " + values};
}

std::vector<Problem> freedom_problems(const Mechanism& mechanism, const MobilitySample& sample) {
  std::vector<Problem> problems;
  const Mobility& mobility = sample.typical;
  const Posture& posture = sample.posture.front();
  const std::string counts =
      fmt::format("the mechanism has {} and {}", counted(mobility.freedoms, "freedom", "freedoms"),
                  counted(mobility.active, "active joint", "active joints"));
  if (mobility.undeclared > 0) {
    problems.push_back({.key = "mechanism.platform",
                        .rule = fmt::format("leaves out {} that the legs give the platform",
                                            counted(mobility.undeclared, "freedom", "freedoms")),
                        .advice = "write platform = \"rigid\", or hold the platform with another leg"});
  }
  if (mobility.freedoms == 0) {
    problems.push_back({.key = "mechanism",
                        .rule = "cannot move: its closure equations leave no freedom",
                        .advice = "give a leg a further joint, or take a leg away"});
    return problems;
  }
  const std::vector<int> loose = loose_joints(posture);
  if (mobility.loose > 0 && loose.empty()) {
    problems.push_back(
        {.key = "mechanism.platform",
         .rule = fmt::format("under-constrained: with every active joint held, the platform can still "
                             "move where no joint follows, about points that hold it; {}",
                             counts),
         .advice = "hold the platform with another leg, or attach one with attachment = \"rigid\""});
  }
  if (mobility.loose > 0 && !loose.empty()) {
    const bool idle = mobility.loose_tool == 0;
    problems.push_back(
        {.key = key_of(mechanism, loose.front()),
         .value = quoted(mechanism.joint_names()[static_cast<std::size_t>(loose.front())]),
         .rule = fmt::format("under-constrained: with every active joint held, {} can still move{}; {}",
                             listed(mechanism, loose),
                             idle ? " without the platform" : ", and the platform with them", counts),
         .advice =
             idle
                 ? "leave a joint out that only turns a link about itself, or make one active"
                 : "set active = true in one of them (and free = true where the hand moves it), or add a leg"});
  }
  const std::vector<int> decided = decided_joints(posture);
  if (!decided.empty()) {
    const int joint = mechanism.active_joint(decided.front());
    problems.push_back(
        {.key = key_of(mechanism, joint) + ".active",
         .value = "true",
         .rule = fmt::format("over-actuated: the other active joints already decide {}; {}",
                             quoted(mechanism.joint_names()[static_cast<std::size_t>(joint)]), counts),
         .advice = "leave active out there, for the joint follows"});
  }
  return problems;
}

std::string platform_name(PlatformFreedom platform) {
  for (const auto& [name, freedom] : platform_freedom_names()) {
    if (freedom == platform) return name;
  }
  return "";
}

// Where lines come nearest to meeting, and how far the farthest passes by.
std::pair<Vector3, double> meeting(const Posture& posture, int first, int last) {
  Matrix3 A = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  for (int j = first; j <= last; ++j) {
    const Vector3& axis = posture.joint_axis(j);
    const Matrix3 across = Matrix3::Identity() - axis * axis.transpose();
    A += across;
    b += across * posture.joint_point(j);
  }
  const Vector3 point = A.ldlt().solve(b);
  double farthest = 0.0;
  for (int j = first; j <= last; ++j)
    farthest = std::max(farthest, (point - posture.joint_point(j)).cross(posture.joint_axis(j)).norm());
  return {point, farthest};
}

// Of an arm with joints enough for all that its platform may do: whether they do it anywhere. Where they do
// not, a link without length, if there is one, is what makes more than three joints turn about one point.
std::vector<Problem> arm_problems(const Mechanism& mechanism, const MechanismDescription& description) {
  const int n = mechanism.active_count(), rows = mechanism.tool_rows();
  if (mechanism.legs().size() != 1 || mechanism.joint_count() != n || n < rows) return {};
  constexpr int kPostures = 12;
  const double length = mechanism.characteristic_length();
  int best = 0;
  std::optional<Posture> anywhere;
  for (int k = 0; k < kPostures; ++k) {
    ActiveVector q(n);
    for (int j = 0; j < n; ++j) {
      const Interval range = mechanism.active_range(j);
      const double home = mechanism.home_guess()[mechanism.active_joint(j)];
      const double low = std::max(range.min, home - 3.0), high = std::min(range.max, home + 3.0);
      q[j] = low + (high - low) * std::fmod(0.37 + k * std::sqrt(2.0 + 3.0 * j), 1.0);  // all different
    }
    const Solution solution = solve_forward(mechanism, q);
    if (!solution) continue;
    Jacobian J = jacobian(*solution.posture);
    J.topRows(mechanism.linear_rows()) /= length;
    for (int j = 0; j < n; ++j) {
      if (mechanism.joints()[static_cast<std::size_t>(j)].type == JointType::prismatic) J.col(j) *= length;
    }
    const auto sigma = svd(J).sigma;
    int rank = 0;
    while (rank < sigma.size() && sigma[rank] > 1e-9 * std::max(1.0, sigma[0])) ++rank;
    if (rank < best) continue;
    best = rank;
    anywhere = solution.posture;
  }
  if (best >= rows || !anywhere) return {};
  const std::string ways = fmt::format("the joints move the tool in {} only, where platform = \"{}\" has {}",
                                       counted(best, "way", "ways"), platform_name(mechanism.platform()), rows);
  for (int first = 0; first + 3 < n; ++first) {
    int last = first;
    while (last + 1 < n && mechanism.joints()[static_cast<std::size_t>(last) + 1].type == JointType::revolute &&
           meeting(*anywhere, first, last + 1).second < 1e-9 * length)
      ++last;
    if (mechanism.joints()[static_cast<std::size_t>(first)].type != JointType::revolute || last < first + 3)
      continue;
    std::vector<int> joints;
    for (int j = first; j <= last; ++j) joints.push_back(j);
    // The row that lays off the link: of a serial arm there are fixed ones in between.
    std::string key = key_of(mechanism, first + 2);
    if (const auto* arm = std::get_if<SerialDescription>(&description)) {
      int row = -1;
      for (int moving = -1; moving < first + 2;)
        moving += arm->joints[static_cast<std::size_t>(++row)].type != SerialJointType::fixed ? 1 : 0;
      key = fmt::format("joint[{}]", row);
    }
    return {{.key = key,
             .rule = fmt::format("a link has no length: {} all turn about one point, so that {}",
                                 listed(mechanism, joints), ways),
             .advice = "give the rows between them a length, a or d, or leave a joint out"}};
  }
  return {{.key = "mechanism.platform",
           .rule = ways,
           .advice = "turn an axis (theta or alpha), give a link a length, or choose another platform"}};
}

}  // namespace

std::vector<Problem> mechanism_problems(const Description& description) {
  const auto* legs = std::get_if<LegsDescription>(&description.mechanism);
  if (std::holds_alternative<SerialDescription>(description.mechanism))
    return arm_problems(Mechanism(description), description.mechanism);
  if (legs == nullptr) return {};  // the families see to it themselves
  const Mechanism mechanism(description);
  const Assembly assembly = find_assembly(mechanism);
  std::vector<Problem> problems = assembly_problems(mechanism, assembly);
  if (!problems.empty()) return problems;
  const MobilitySample sample = sample_mobility(mechanism, kFurtherPostures);
  if (!sample.posture.empty()) problems = freedom_problems(mechanism, sample);
  if (problems.empty() && !assembly.from_home)
    problems.push_back(home_problem(mechanism, assembly.posture.front()));
  if (problems.empty()) problems = arm_problems(mechanism, description.mechanism);
  return problems;
}

}  // namespace zwidth
