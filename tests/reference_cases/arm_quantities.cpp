#include <numbers>

#include "quantities.h"

#include "zwidth/analysis/comparison.h"
#include "zwidth/analysis/posture_sweep.h"
#include "zwidth/analysis/reach.h"
#include "zwidth/mechanism/srs_arm.h"

namespace zwidth::reference {
namespace {

SrsLengths lengths(const Inputs& in) {
  return {.upper_arm = in.number_or("d3_m", 0.25), .forearm = in.number_or("d4_m", 0.25)};
}

// Seven angles, or the first few of them.
SrsAngles angles(const Inputs& in) {
  const bool degrees = in.has("theta_deg");
  const Values given = in.list(degrees ? "theta_deg" : "theta_rad");
  SrsAngles theta{};
  for (std::size_t i = 0; i < given.size() && i < theta.size(); ++i) {
    theta[i] = degrees ? given[i] * std::numbers::pi / 180.0 : given[i];
  }
  return theta;
}

SrsGiven joint_given(const Inputs& in) {
  const int joint = in.integer("given");
  if (joint < 1 || joint > 3) throw Refusal("invalid_argument");
  return SrsGiven(joint);
}
double angle_given(const Inputs& in) {
  return in.has("theta_deg") ? in.degrees("theta_deg") : in.number("theta_rad");
}

Pose wrist(const Inputs& in) {
  const Values C = in.list("C");
  Pose pose{.position = in.vector("r_m")};
  for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = C.at(i);
  return pose;
}

SrsArmSolutions arm(const Inputs& in) {
  return srs_arm_inverse(lengths(in), in.vector("r_m"), joint_given(in), angle_given(in));
}
SrsSolutions whole(const Inputs& in) {
  return srs_inverse(lengths(in), wrist(in), joint_given(in), angle_given(in));
}

template <class Solutions>
AngleRows rows(const Solutions& solutions) {
  if (solutions.status != SrsStatus::solved) throw Refusal(std::string(to_string(solutions.status)));
  AngleRows result;
  for (int i = 0; i < solutions.count; ++i) {
    result.rows.emplace_back(solutions.theta[i].begin(), solutions.theta[i].end());
  }
  return result;
}

template <class Matrix>
Values row_by_row(const Matrix& m) {
  Values values;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) values.push_back(m(i, j));
  }
  return values;
}

// The arm up to its wrist point; limits not given are those that its source means. A limit of no width, and
// theta3 where `lock_theta3`, fixes its joint.
Mechanism positioning_stage(const Inputs& in, bool lock_theta3) {
  constexpr double kDegree = std::numbers::pi / 180.0, kQuarter = 0.5 * std::numbers::pi;
  const SrsLengths length = lengths(in);
  const double alpha[] = {-kQuarter, kQuarter, -kQuarter, kQuarter};
  const Interval usual[] = {{-90.0, 90.0}, {30.0, 120.0}, {-60.0, 60.0}, {45.0, 135.0}};
  SerialDescription arm;
  for (int i = 0; i < 4; ++i) {
    const std::string key = "theta" + std::to_string(i + 1) + "_deg";
    Interval range = usual[i];
    if (in.has(key)) range = {in.list(key).at(0), in.list(key).at(1)};
    if (i == 2 && lock_theta3) range = {0.0, 0.0};
    SerialJointDescription row{.name = key, .d = i == 2 ? length.upper_arm : 0.0, .alpha = alpha[i]};
    if (range.width() > 0.0) {
      row.range = {range.min * kDegree, range.max * kDegree};
      row.home = row.range.middle();
    } else {
      row.type = SerialJointType::fixed;
      row.theta = range.min * kDegree;
    }
    arm.joints.push_back(row);
  }
  arm.joints.push_back({.name = "wrist", .type = SerialJointType::fixed, .d = length.forearm});
  Description description;
  description.mechanism = arm;
  return Mechanism(description);
}

}  // namespace

void add_arm(Quantities& q) {
  q["workspace_volume"] = [](const Inputs& in) {
    return Values{reachable_volume(positioning_stage(in, false), {.samples = 4'000'000}).value};
  };
  q["workspace_gain_of_theta3"] = [](const Inputs& in) {
    return Values{compare_workspaces(positioning_stage(in, false), positioning_stage(in, true)).gain()};
  };
  q["maximum_reach"] = [](const Inputs& in) {
    return Values{farthest_from(positioning_stage(in, false), Vector3::Zero()).distance};
  };
  q["wrist_position"] = [](const Inputs& in) {
    return row_by_row(srs_forward(lengths(in), angles(in)).wrist.position);
  };
  q["orientation"] = [](const Inputs& in) {
    return row_by_row(srs_forward(lengths(in), angles(in)).wrist.rotation);
  };
  q["jacobian"] = [](const Inputs& in) { return row_by_row(srs_forward(lengths(in), angles(in)).jacobian); };
  q["ik_arm_all"] = [](const Inputs& in) { return rows(arm(in)); };
  q["ik_full_all"] = [](const Inputs& in) { return rows(whole(in)); };
  q["ik_error"] = [](const Inputs& in) {
    return std::string(to_string(in.has("C") ? whole(in).status : arm(in).status));
  };
  q["position_minors"] = [](const Inputs& in) {
    const auto minors = srs_position_minors(lengths(in), angles(in));
    return Values(minors.begin(), minors.end());
  };
  q["position_manipulability"] = [](const Inputs& in) {
    return Values{srs_position_manipulability(lengths(in), angles(in))};
  };
  q["jacobian_rank"] = [](const Inputs& in) {
    return Values{static_cast<double>(srs_jacobian_rank(lengths(in), angles(in)))};
  };
}

}  // namespace zwidth::reference
