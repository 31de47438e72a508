#include "zwidth/mechanism/mechanism_problems.h"

#include <fmt/format.h>

#include "zwidth/mechanism/internal/posture_builder.h"
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

}  // namespace

std::vector<Problem> mechanism_problems(const Description& description) {
  const auto* legs = std::get_if<LegsDescription>(&description.mechanism);
  if (legs == nullptr) return {};  // the families see to it themselves
  const Mechanism mechanism(description);
  const Assembly assembly = find_assembly(mechanism);
  std::vector<Problem> problems = assembly_problems(mechanism, assembly);
  if (!problems.empty()) return problems;
  const MobilitySample sample = sample_mobility(mechanism, kFurtherPostures);
  if (!sample.posture.empty()) problems = freedom_problems(mechanism, sample);
  if (problems.empty() && !assembly.from_home)
    problems.push_back(home_problem(mechanism, assembly.posture.front()));
  return problems;
}

}  // namespace zwidth
