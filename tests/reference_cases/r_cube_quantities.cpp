#include <cmath>
#include <numbers>

#include "quantities.h"

#include "zwidth/analysis/r_cube_synthesis.h"
#include "zwidth/math/section.h"
#include "zwidth/mechanism/r_cube.h"

// Cases of the R-CUBE name their quantities in sentences; they are the keys here as they stand.

namespace zwidth::reference {
namespace {

const Interval kAnyAngle{-std::numbers::pi, std::numbers::pi};

template <class T>
const T& valid(const std::optional<T>& answer, const char* refusal = "invalid_argument") {
  if (!answer) throw Refusal(refusal);
  return *answer;
}

RCubeGeometry geometry(const Inputs& in) {
  const Vector3 l = in.vector("l");
  const RCubeGeometry lengths{
      .drive_link = l[0], .inner_link = l[1], .outer_link = l[2], .base_offset = in.number_or("S", l[0])};
  if (!lengths.valid()) throw Refusal("bad_length");
  return lengths;
}

RCubeBranches branches(const Inputs& in) {
  const double sigma = in.number_or("sigma", -1.0);
  if (std::abs(sigma) != 1.0) throw Refusal("invalid_argument");
  return r_cube_branches(0, static_cast<int>(sigma));
}

int leg(const Inputs& in) {
  const int chain = in.integer("chain");
  if (chain < 1 || chain > 3) throw Refusal("invalid_argument");
  return chain - 1;
}

RCubeSolution closed(const RCubeSolution& solution) {
  if (solution.status == SolveStatus::unreachable) {
    throw Refusal(solution.drive_too_short() ? "unreachable_active" : "unreachable_passive");
  }
  if (!solution.closed()) throw Refusal(to_string(solution.status));
  return solution;
}

RCubeSolution forward(const Inputs& in) {
  return closed(r_cube_forward(geometry(in), in.vector("q"), branches(in)));
}
RCubeSolution inverse(const Inputs& in) {
  return closed(r_cube_inverse(geometry(in), in.vector("r"), kAnyAngle, branches(in)));
}
RCubeState state(const Inputs& in) {
  return {geometry(in), forward(in)};
}

// One leg at its own three angles, whatever the others do.
RCubeState leg_state(const Inputs& in) {
  const Vector3 angles = in.vector("angles");
  RCubeSolution solution;
  solution.theta[leg(in)] = angles[0];
  solution.swing[leg(in)] = angles[1];
  solution.elbow[leg(in)] = angles[2];
  return {geometry(in), solution};
}

Values list(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
Values rows(const Matrix3& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

double max_angle(const Inputs& in) {
  return valid(r_cube_max_angle(in.number("l1"), in.number("half_workspace")), "unreachable_active");
}

RCubeDesign design(const Inputs& in) {
  return {.max_angle = in.number("qmax"),
          .inner_link = in.number("l2"),
          .outer_link = in.number("l3"),
          .half_workspace = in.number("half_workspace"),
          .half_clearance = in.number_or("half_virtual", RCubeDesign{}.half_clearance)};
}

TubeDiameters laminated(const Inputs& in) {
  int plies = 0;
  for (const double count : in.list("plies")) {
    if (count < 0.0) throw Refusal("bad_laminate");
    plies += static_cast<int>(std::lround(count));
  }
  return valid(laminated_tube(plies, in.number("ply_thickness"), in.number("ratio")), "bad_laminate");
}

double links_mass(const Inputs& in) {
  const Vector3 l = in.vector("l"), D = in.vector("D");
  double mass = 0.0;
  for (int link = 0; link < 3; ++link) {
    const Section section = valid(tube_section(D[link], in.number("ratio") * D[link]), "bad_section");
    mass += 3.0 * link_mass(section, l[link], in.number("rho")).mass;
  }
  return mass;
}

void add_kinematics(Quantities& q) {
  q["forward kinematics r"] = [](const Inputs& in) { return list(forward(in).position); };
  q["inverse kinematics, active angles"] = [](const Inputs& in) { return list(inverse(in).theta); };
  q["inverse kinematics, passive angles [[q12,q13],[q22,q23],[q32,q33]]"] = [](const Inputs& in) {
    const RCubeSolution at = inverse(in);
    return Values{at.swing[0], at.elbow[0], at.swing[1], at.elbow[1], at.swing[2], at.elbow[2]};
  };
  q["chain Jacobian J_i"] = [](const Inputs& in) { return rows(leg_state(in).leg_jacobian(leg(in))); };
  q["det J_i"] = [](const Inputs& in) { return Values{leg_state(in).leg_determinant(leg(in))}; };
  q["platform velocity"] = [](const Inputs& in) { return list(state(in).velocity(in.vector("qd"))); };
  q["platform acceleration"] = [](const Inputs& in) {
    return list(state(in).acceleration(in.vector("qd"), in.vector("qdd")));
  };
  q["chain joint velocities"] = [](const Inputs& in) {
    return list(valid(state(in).leg_rates(leg(in), in.vector("qd")), "singular"));
  };
  q["chain joint accelerations"] = [](const Inputs& in) {
    return list(valid(state(in).leg_accelerations(leg(in), in.vector("qd"), in.vector("qdd")), "singular"));
  };
}

void add_geometry(Quantities& q) {
  q["total link length"] = [](const Inputs& in) { return Values{geometry(in).total_length()}; };
  q["qmax from l1 and half workspace"] = [](const Inputs& in) { return Values{max_angle(in)}; };
  q["l1 cos(qmax)"] = [](const Inputs& in) {
    return Values{r_cube_manipulability_index(in.number("l1"), max_angle(in))};
  };
  q["1/cos(qmax)^2"] = [](const Inputs& in) { return Values{r_cube_condition_index(max_angle(in))}; };
  q["constraint values g3,g4,g5,g6,g7,g8C,g8B"] = [](const Inputs& in) {
    const auto values = valid(r_cube_constraints(design(in)), "bad_length").all();
    return Values(values.begin(), values.end());
  };
  q["normalised value"] = [](const Inputs& in) {
    return Values{valid(normalised(in.number("value"), in.number("min"), in.number("max")))};
  };
  q["1-based index of the smallest sqrt((w*^2 + weight mu*^2)/2)"] = [](const Inputs& in) {
    return Values{1.0 + valid(r_cube_choice(in.list("omega_nn"), in.list("mu_vn"), in.number("weight")))};
  };
  q["d/D minimising sqrt((CS1n^2+CS2n^2)/2), CS1, CS2 normalised with eq 7.1 over the search range"] =
      [](const Inputs& in) {
        const std::vector<double> range = in.list("ratio_range");
        return Values{valid(hollow_section_ratio({.outer_diameter = in.number("D"),
                                                  .length = in.number("L"),
                                                  .density = in.number("rho"),
                                                  .elastic_modulus = in.number("E")},
                                                 {range.at(0), range.at(1)}))};
      };
  q["difference of the largest and smallest qmax"] = [](const Inputs& in) {
    return Values{in.number("qmax_max") - in.number("qmax_min")};
  };
  q["total length of row 40 minus row 1"] = [](const Inputs& in) {
    return Values{in.number("total_row40") - in.number("total_row1")};
  };
  for (const char* link : {"1", "2", "3"}) {
    q[std::string("outer radius R = 0.15e-3 n/(1-0.75) of link ") + link] = [](const Inputs& in) {
      return Values{0.5 * laminated(in).outer};
    };
    q[std::string("inner radius r = 0.75 R of link ") + link] = [](const Inputs& in) {
      return Values{0.5 * laminated(in).inner};
    };
  }
  q["mass of the nine links"] = [](const Inputs& in) { return Values{links_mass(in)}; };
}

}  // namespace

void add_r_cube(Quantities& quantities) {
  add_kinematics(quantities);
  add_geometry(quantities);
}

}  // namespace zwidth::reference
