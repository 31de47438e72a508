#include <numbers>

#include "quantities.h"

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

}  // namespace

void add_arm(Quantities& q) {
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
