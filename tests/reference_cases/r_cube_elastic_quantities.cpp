#include <cmath>
#include <numbers>

#include "quantities.h"

#include "zwidth/analysis/r_cube_synthesis.h"
#include "zwidth/math/laminate.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/r_cube_dynamics.h"
#include "zwidth/mechanism/r_cube_stiffness.h"
#include "zwidth/mechanism/stiffness.h"
#include "zwidth/mechanism/vibration.h"

// Stiffness, laminates and dynamics of the R-CUBE. What concerns one leg at angles of its own goes through the
// closed forms; the whole device goes through the general engine, for an r-cube described in code.

namespace zwidth::reference {
namespace {

template <class T>
const T& valid(const std::optional<T>& answer, const char* refusal) {
  if (!answer) throw Refusal(refusal);
  return *answer;
}

RCubeGeometry geometry(const Inputs& in) {
  const Vector3 l = in.vector(in.has("l") ? "l" : "l_geometry");
  const RCubeGeometry lengths{
      .drive_link = l[0], .inner_link = l[1], .outer_link = l[2], .base_offset = in.number_or("S", l[0])};
  if (!lengths.valid()) throw Refusal("bad_length");
  return lengths;
}

RCubeSolution solved(const Inputs& in) {
  const double sigma = in.number_or("sigma", -1.0);
  if (std::abs(sigma) != 1.0) throw Refusal("invalid_argument");
  const RCubeSolution at =
      r_cube_forward(geometry(in), in.vector("q"), r_cube_branches(0, static_cast<int>(sigma)));
  if (at.status == SolveStatus::unreachable)
    throw Refusal(at.drive_too_short() ? "unreachable_active" : "unreachable_passive");
  if (!at.closed()) throw Refusal(to_string(at.status));
  return at;
}

int leg(const Inputs& in) {
  const int chain = in.has("chain") ? in.integer("chain") : 1;
  if (chain < 1 || chain > 3) throw Refusal("invalid_argument");
  return chain - 1;
}

// Of one leg, given as such or as part of a posture.
Vector3 angles(const Inputs& in) {
  if (in.has("angles")) return in.vector("angles");
  const RCubeSolution at = solved(in);
  return {at.theta[leg(in)], at.swing[leg(in)], at.elbow[leg(in)]};
}

std::array<Section, 3> sections(const Inputs& in) {
  const Vector3 D = in.vector("D"), d = in.vector("d");
  return {valid(tube_section(D[0], d[0]), "bad_section"), valid(tube_section(D[1], d[1]), "bad_section"),
          valid(tube_section(D[2], d[2]), "bad_section")};
}

PlyModuli ply(const Inputs& in) {
  const Inputs material = in.table("material");
  return {.longitudinal = material.number("E1"),
          .transverse = material.number("E2"),
          .shear = material.number("G12"),
          .poisson = material.number("nu12")};
}

// Plies at 0, 90, -45 and +45 deg.
std::array<PlyGroup, 4> plies(const std::vector<double>& all, std::size_t first) {
  constexpr double kQuarter = 0.25 * std::numbers::pi;
  return {{{0.0, all.at(first)},
           {2.0 * kQuarter, all.at(first + 1)},
           {-kQuarter, all.at(first + 2)},
           {kQuarter, all.at(first + 3)}}};
}

RCubeLinks links(const Inputs& in) {
  RCubeLinks result{.geometry = geometry(in), .rigidity = {}};
  if (in.has("l_stiffness")) result.stiffness_lengths = in.vector("l_stiffness");
  const std::array<Section, 3> section = sections(in);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!in.has("plies")) {
      result.rigidity[k] = beam_rigidity(section[k], in.number("E"), in.number("G"));
      continue;
    }
    const ShearAt45 shear =
        in.has("g45") && in.text("g45") == "printed" ? ShearAt45::printed : ShearAt45::textbook;
    const WallModuli wall = valid(mean_moduli(ply(in), plies(in.list("plies"), 4 * k), shear), "bad_laminate");
    const bool transverse = in.has("bending_modulus") && in.text("bending_modulus") == "Ey";
    result.rigidity[k] =
        beam_rigidity(section[k], wall.axial, transverse ? wall.transverse : wall.axial, wall.shear);
  }
  return result;
}

RCubeMasses masses(const Inputs& in) {
  const RCubeInertia inertia = in.has("inertia") && in.text("inertia") == "thesis" ? RCubeInertia::published
                                                                                   : RCubeInertia::about_centre;
  RCubeMasses result = r_cube_masses(geometry(in), sections(in), in.number("rho"), inertia);
  result.platform = in.number_or("m_platform", 0.0);
  if (in.has("gravity")) result.gravity = in.vector("gravity");
  return result;
}

Vector6 wrench(const Inputs& in) {
  const std::vector<double> w = in.list("wrench");
  if (w.size() != 6) throw Refusal("invalid_argument");
  return Eigen::Map<const Vector6>(w.data());
}

Values rows(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Values values;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) values.push_back(matrix(r, c));
  }
  return values;
}

ToolMatrix square(const Inputs& in, const char* key) {
  const std::vector<double> values = in.list(key);
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(values.size()))));
  if (n < 1 || n > 6 || n * n != static_cast<Eigen::Index>(values.size())) throw Refusal("invalid_argument");
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), n, n).transpose();
}

Modes modes_of(const Inputs& in) {
  const ToolMatrix D = square(in, "matrix");
  return valid(modes(D, ToolMatrix::Identity(D.rows(), D.rows())), "invalid_argument");
}

// The device as a file would describe it, through the general engine.
struct Device {
  explicit Device(const Inputs& in) : mechanism(described(in)), solution(solve(in)) {}

  static Description described(const Inputs& in) {
    solved(in);
    sections(in);
    const RCubeGeometry l = geometry(in);
    constexpr double kAny = 0.4999 * std::numbers::pi;
    Description device;
    device.name = "r-cube";
    device.mechanism = RCubeDescription{.drive_link = l.drive_link,
                                        .inner_link = l.inner_link,
                                        .outer_link = l.outer_link,
                                        .base_offset = l.base_offset,
                                        .joint_range = {-kAny, kAny},
                                        .elbow_mode = static_cast<int>(in.number_or("sigma", -1.0))};
    const double E = in.number("E"), G = in.number("G");
    const Material material{.info = {}, .elastic_modulus = E, .poisson_ratio = 0.5 * E / G - 1.0};
    const Vector3 D = in.vector("D"), d = in.vector("d");
    const char* names[] = {"drive_link", "inner_link", "outer_link"};
    for (int k = 0; k < 3; ++k)
      device.bodies.push_back({.on = names[k], .beam = TubeDescription{D[k], d[k], material}});
    return device;
  }
  Solution solve(const Inputs& in) const {
    Solution found = solve_forward(mechanism, in.vector("q"));
    if (!found) throw Refusal(to_string(found.status));
    return found;
  }
  Matrix6 stiffness() const { return zwidth::stiffness(*solution.posture).matrix; }

  Mechanism mechanism;
  Solution solution;
};

void add_stiffness(Quantities& q) {
  q["laminate Ex,Ey,Gxy (arithmetic mean, textbook G45)"] = [](const Inputs& in) {
    const WallModuli wall = valid(mean_moduli(ply(in), plies(in.list("plies"), 0)), "bad_laminate");
    return Values{wall.axial, wall.transverse, wall.shear};
  };
  q["Frobenius norm of the 6x6 chain stiffness K_C1, unloaded"] = [](const Inputs& in) {
    return Values{stiffness_indices(r_cube_leg_elasticity(links(in), leg(in), angles(in)).stiffness).frobenius};
  };
  q["chain stiffness K_Ci"] = [](const Inputs& in) {
    return rows(r_cube_leg_elasticity(links(in), leg(in), angles(in)).stiffness);
  };
  q["chain stiffness without passive joints K*_Ci"] = [](const Inputs& in) {
    return rows(r_cube_leg_elasticity(links(in), leg(in), angles(in)).locked_stiffness());
  };
  q["6x6 loaded chain stiffness, direct method"] = [](const Inputs& in) {
    return rows(r_cube_leg_elasticity(links(in), leg(in), angles(in), wrench(in)).stiffness);
  };
  q["CF1: norm of the translation of the chain tip"] = [](const Inputs& in) {
    return Values{
        (r_cube_leg_elasticity(links(in), leg(in), angles(in)).compliance * wrench(in)).head<3>().norm()};
  };
  q["CF2: norm of the rotation of the chain tip"] = [](const Inputs& in) {
    return Values{
        (r_cube_leg_elasticity(links(in), leg(in), angles(in)).compliance * wrench(in)).tail<3>().norm()};
  };
  for (const auto& [element, r, c] : {std::tuple{"K11", 0, 0}, {"K16", 0, 5}, {"K44", 3, 3}, {"K15", 0, 4}}) {
    q[std::string("element ") + element +
      " of K_C = sum of the three chain stiffnesses with the same angles in each chain"] =
        [r = r, c = c](const Inputs& in) {
          const Vector3 each = angles(in);
          RCubeSolution equal;
          equal.theta.setConstant(each[0]);
          equal.swing.setConstant(each[1]);
          equal.elbow.setConstant(each[2]);
          return Values{r_cube_stiffness(links(in), equal)(r, c)};
        };
  }
  q["manipulator stiffness K_C"] = [](const Inputs& in) { return rows(Device(in).stiffness()); };
  q["S_f of K_C"] = [](const Inputs& in) {
    return Values{stiffness_indices(Device(in).stiffness()).frobenius};
  };
  q["S_et and S_er (spectral condition numbers of the translational and rotational 3x3 blocks)"] =
      [](const Inputs& in) {
        const StiffnessIndices of = stiffness_indices(Device(in).stiffness());
        return Values{of.condition_translation, of.condition_rotation};
      };
  q["S_da and S_dd (determinants of the 3x3 blocks)"] = [](const Inputs& in) {
    const StiffnessIndices of = stiffness_indices(Device(in).stiffness());
    return Values{of.determinant_translation, of.determinant_rotation};
  };
  q["platform twist K_C^-1 F"] = [](const Inputs& in) {
    const Device device(in);
    const Compliance give =
        compliance(stiffness(*device.solution.posture), device.mechanism.characteristic_length());
    if (give.free) throw Refusal("singular");
    return rows(give.matrix * wrench(in));
  };
}

void add_dynamics(Quantities& q) {
  q["joint-space mass matrix of a chain"] = [](const Inputs& in) {
    return rows(r_cube_leg_mass_matrix(masses(in), angles(in), in.number_or("m_platform_per_chain", 0.0)));
  };
  q["Frobenius norm of J_m^T M_C1 J_m, home"] = [](const Inputs& in) {
    const Matrix3 M =
        r_cube_leg_cartesian_mass(masses(in), leg(in), angles(in), in.number_or("m_platform_per_chain", 0.0));
    const Matrix3 J = RCubeState(geometry(in), solved(in)).jacobian();
    return Values{r_cube_mass_indices(J.transpose() * M * J).frobenius};
  };
  q["Frobenius norm of inv(M_1) K_C1[rows 1..3, columns 1..6], M_1 joint-space mass matrix of chain 1"] =
      [](const Inputs& in) {
        return Values{r_cube_frequency_index(
            r_cube_leg_mass_matrix(masses(in), angles(in), in.number_or("m_platform_per_chain", 0.0)),
            r_cube_leg_elasticity(links(in), leg(in), angles(in)).stiffness)};
      };
  q["Cartesian mass matrix M_C"] = [](const Inputs& in) {
    return rows(valid(r_cube_cartesian_mass(masses(in), solved(in)), "singular"));
  };
  q["I_m = det M_C, I_e = spectral condition number, I_f = Frobenius norm"] = [](const Inputs& in) {
    const RCubeMassIndices of =
        r_cube_mass_indices(valid(r_cube_cartesian_mass(masses(in), solved(in)), "singular"));
    return Values{of.determinant, of.condition, of.frobenius};
  };
  for (const char* gravity : {"", " with gravity"}) {
    q[std::string("inverse dynamics: platform force, active torques") + gravity] = [](const Inputs& in) {
      const RCubeEffort effort =
          valid(r_cube_inverse_dynamics(masses(in), solved(in), in.vector("qd"), in.vector("qdd")), "singular");
      return rows((Eigen::MatrixXd(2, 3) << effort.force.transpose(), effort.torque.transpose()).finished());
    };
  }
  q["natural frequencies sqrt(eig(inv(M_C) K_CA)), ascending"] = [](const Inputs& in) {
    const Matrix3 mass = valid(r_cube_cartesian_mass(masses(in), solved(in)), "singular");
    const Matrix3 block = Device(in).stiffness().topLeftCorner<3, 3>();
    return rows(valid(modes(block, mass), "invalid_argument").frequencies);
  };
  q["inv(M_C) K_C*"] = [](const Inputs& in) {
    return rows(dynamic_matrix(square(in, "K_C"), square(in, "M_C")));
  };
  q["Frobenius norm"] = [](const Inputs& in) { return Values{square(in, "matrix").norm()}; };
  q["square roots of the eigenvalues, ascending"] = [](const Inputs& in) {
    return rows(modes_of(in).frequencies);
  };
  q["eigenvector of the largest eigenvalue up to sign"] = [](const Inputs& in) {
    const Modes found = modes_of(in);
    return UpToSign{rows(found.shapes.col(found.shapes.cols() - 1))};
  };
  q["objectives O1, O2, O3"] = [](const Inputs& in) {
    const RCubeObjectives of = valid(r_cube_objectives({.max_angle = in.number("qmax"),
                                                        .inner_link = in.number("l2"),
                                                        .outer_link = in.number("l3"),
                                                        .half_workspace = in.number("half_workspace")},
                                                       {.section = sections(in)[0],
                                                        .elastic_modulus = in.number("E"),
                                                        .shear_modulus = in.number("G"),
                                                        .density = in.number("rho"),
                                                        .platform_mass = in.number_or("m_platform", 0.0)}),
                                     "unreachable_passive");
    return Values{of.closeness, of.inertia, of.compliance};
  };
}

}  // namespace

void add_r_cube_elastic(Quantities& quantities) {
  add_stiffness(quantities);
  add_dynamics(quantities);
}

}  // namespace zwidth::reference
