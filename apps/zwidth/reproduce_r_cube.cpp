#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "r_cube_tables.h"
#include "reproduce_r_cube_elastic.h"
#include "reproduce_r_cube_search.h"
#include "reproduction.h"

#include "zwidth/analysis/r_cube_synthesis.h"
#include "zwidth/description/read.h"
#include "zwidth/math/section.h"
#include "zwidth/mechanism/r_cube.h"

/// The figures of Görgülü 2018, chapter 7, in the order of its tables.

namespace zwidth {
namespace {

using r_cube_tables::Choice;
using r_cube_tables::Design;
using r_cube_tables::Laminate;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHalfWorkspace = 0.060;   // of the 120 mm cube [m]
constexpr double kPlyThickness = 0.15e-3;  // section 6.6 [m]
constexpr double kRatio = 0.75;            // of inner to outer size in tables 7.7 and 7.8

const PrintedUnit kMillimetre{"mm", "m", 1e-3}, kMetre{"m", "m", 1.0}, kDegreeUnit{"deg", "rad", kDegree},
    kPure{"", "1", 1.0}, kGram{"g", "kg", 1e-3};

std::string numbered(const std::string& id, std::size_t index) {
  return fmt::format("{}.{:02}", id, index + 1);
}

double max_angle(const Design& design) {
  return *r_cube_max_angle(design.l1 * 1e-3, kHalfWorkspace);
}

RCubeGeometry lengths(const Design& design) {
  return {.drive_link = design.l1 * 1e-3,
          .inner_link = design.l2 * 1e-3,
          .outer_link = design.l3 * 1e-3,
          .base_offset = design.l1 * 1e-3};
}

void design_figures(Figures& figures) {
  const auto& designs = r_cube_tables::kDesigns;
  figures.under("Table 7.2: optimal designs, from their printed lengths");
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const Design& design = designs[i];
    figures
        .add(numbered("T7.2.total", i), fmt::format("design {}, l1 + l2 + l3", i + 1), kMillimetre, 1,
             design.total,
             lengths(design).total_length())
        .tolerance = 0.201e-3;  // three lengths, each rounded to 0.1 mm
    figures
        .add(numbered("T7.2.qmax", i), fmt::format("design {}, qmax (6.24)", i + 1), kDegreeUnit, 1,
             design.qmax,
             max_angle(design))
        .tolerance = 0.1 * kDegree;  // l1 is rounded
  }

  figures.under("Table 7.3: performance of the designs");
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const Design& design = designs[i];
    figures
        .add(numbered("T7.3.mu_v", i), fmt::format("design {}, manipulability (6.8)", i + 1), kMetre, 3,
             design.mu_v, r_cube_manipulability_index(design.l1 * 1e-3, max_angle(design)))
        .tolerance = 0.6e-3;
    ReproducedFigure& condition =
        figures.add(numbered("T7.3.c_v", i), fmt::format("design {}, condition (6.18)", i + 1), kPure, 3,
                    design.c_v, r_cube_condition_index(max_angle(design)));
    condition.tolerance = 1.2e-3;
    if (i == 0) {
      read_otherwise(condition, "1/cos^2 qmax, the square of the ratio of singular values",
                     "true condition number", 1.0 / std::cos(max_angle(design)), "1/cos qmax, by (4.33)");
    }
  }

  figures.under("Table 7.4: performance, normalised by (7.1)");
  struct Column {
    const char* id;
    const char* what;
    double (*value)(const Design&);
    double tolerance;
  };
  // What rounding leaves: I_f is printed in two digits, mu_v and c_v are computed from l1.
  const Column columns[] = {
      {"I_f", "inertia, from table 7.3", [](const Design& d) { return d.I_f; }, 0.0215},
      {"S_f", "stiffness, from table 7.3", [](const Design& d) { return d.S_f; }, 0.51e-3},
      {"omega_n", "frequency, from table 7.3", [](const Design& d) { return d.omega_n; }, 0.51e-3},
      {"mu_v", "manipulability, from l1",
       [](const Design& d) { return r_cube_manipulability_index(d.l1 * 1e-3, max_angle(d)); }, 3.5e-3},
      {"c_v", "condition, from l1", [](const Design& d) { return r_cube_condition_index(max_angle(d)); },
       3.5e-3}};
  for (std::size_t c = 0; c < std::size(columns); ++c) {
    const Column& column = columns[c];
    Interval range{HUGE_VAL, -HUGE_VAL};
    for (const Design& design : designs) {
      range = {std::min(range.min, column.value(design)), std::max(range.max, column.value(design))};
    }
    for (std::size_t i = 0; i < designs.size(); ++i) {
      figures
          .add(numbered(std::string("T7.4.") + column.id, i), fmt::format("design {}, {}", i + 1, column.what),
               kPure, 3, designs[i].normalised[c], *normalised(column.value(designs[i]), range.min, range.max))
          .tolerance = column.tolerance;
    }
  }
}

void choice_figures(Figures& figures) {
  const auto& designs = r_cube_tables::kDesigns;
  std::vector<double> frequency, manipulability;
  for (const Design& design : designs) {
    frequency.push_back(design.normalised[2]);
    manipulability.push_back(design.normalised[3]);
  }
  figures.under("Table 7.5 and section 7.2: the choice among the designs");
  for (const Choice& choice : r_cube_tables::kChoices) {
    figures.add(fmt::format("T7.5.weight_{:g}", choice.weight),
                fmt::format("design chosen with weight {:g} of manipulability", choice.weight), kPure, 0,
                choice.design, 1.0 + *r_cube_choice(frequency, manipulability, choice.weight));
  }
  figures
      .add("S7.2.angle", "largest less smallest qmax", kDegreeUnit, 1, 8.9,
           max_angle(designs.front()) - max_angle(designs.back()))
      .tolerance = 0.1 * kDegree;
  figures.add("S7.2.length", "length gained from design 1 to 40", kMillimetre, 0, 74.0,
              lengths(designs.back()).total_length() - lengths(designs.front()).total_length());
}

void section_figures(Figures& figures) {
  figures.under("Sections 6.5 and 7.3: ratio of the diameters");
  ReproducedFigure& ratio =
      figures.add("E7.5", "d/D (7.5)", kPure, 3, 0.768, *hollow_section_ratio({}, {0.0, 0.9}));
  ratio.tolerance = 5e-3;
  read_otherwise(ratio, "normalised over 0..0.9; the source does not say over what", "over 0..0.99",
                 *hollow_section_ratio({}, {0.0, 0.99}), "(7.1) makes the answer depend on the range searched");

  figures.under("Table 7.7: sizes of the links, printed as diameters but radii of what the plies make");
  const auto& laminates = r_cube_tables::kLaminates;
  for (std::size_t i = 0; i < laminates.size(); ++i) {
    for (std::size_t link = 0; link < 3; ++link) {
      const auto& [at_0, at_90, at_45] = laminates[i].plies[link];
      const TubeDiameters tube = *laminated_tube(at_0 + at_90 + 2 * at_45, kPlyThickness, kRatio);
      const std::string which = fmt::format("solution {}, link {}", i + 1, link + 1);
      figures.add(fmt::format("T7.7.D{}.{:02}", link + 1, i + 1), which + ", outer", kMillimetre, 2,
                  laminates[i].diameters[link][0], 0.5 * tube.outer);
      figures.add(fmt::format("T7.7.d{}.{:02}", link + 1, i + 1), which + ", inner", kMillimetre, 2,
                  laminates[i].diameters[link][1], 0.5 * tube.inner);
    }
  }
}

// The nine links at given lengths and outer diameters.
double links_mass(const Vector3& length, const Vector3& outer, double ratio, double density) {
  double mass = 0.0;
  for (int link = 0; link < 3; ++link) {
    mass += 3.0 * link_mass(*tube_section(outer[link], ratio * outer[link]), length[link], density).mass;
  }
  return mass;
}

void device_figures(Figures& figures, const RCubeDescription& device) {
  const Vector3 printed_sizes(0.015, 0.012, 0.0072),
      length(device.drive_link, device.inner_link, device.outer_link);
  constexpr double kFibreDensity = 1910.0;  // appendix A [kg/m^3]
  figures.under("Table 7.9: the chosen design, from devices/r-cube.toml");
  figures.add("T7.9.workspace", "edge of the cube-shaped workspace", kMillimetre, 0, 120.0,
              device.drive_link * (std::sin(device.joint_range.max) - std::sin(device.joint_range.min)));
  read_otherwise(figures.add("T7.9.mass", "mass of the nine links", kGram, 1, 77.7,
                             links_mass(length, printed_sizes, 0.768, kFibreDensity)),
                 "1910 kg/m³ as the fibres have, d/D = 0.768, the sizes of table 7.8 as diameters",
                 "with the sizes as radii", links_mass(length, 2.0 * printed_sizes, kRatio, kFibreDensity),
                 "what 25, 20 and 12 plies of 0.15 mm make; 1800 kg/m³, d/D = 0.75 and lengths cut to whole mm "
                 "give 77.75 g as well");
}

std::vector<Erratum> not_reproduced(const RCubeDescription& device) {
  int violated = 0;
  double worst = 0.0;
  for (const Design& design : r_cube_tables::kDesigns) {
    const double value =
        r_cube_constraints(
            {.max_angle = max_angle(design), .inner_link = design.l2 * 1e-3, .outer_link = design.l3 * 1e-3})
            ->worst();
    violated += value > 0.0 ? 1 : 0;
    worst = std::max(worst, value);
  }
  const double extended = device.base_offset + device.drive_link * std::sin(device.joint_range.max);
  return {
      {"Table 7.2", "40 designs that meet the constraints",
       fmt::format("{} of them do not, by up to {:.4f}", violated, worst),
       "constraint 5 in the first two designs, constraint 8 at C1 in the others; a search with a tolerance of "
       "about 0.01 "
       "gives such."},
      {"Table 7.9, footprint fully extended", "< 170 mm", fmt::format("{:.1f} mm", extended * 1e3),
       "S + l1 sin qmax of the chosen design; folded, its 111.7 mm are below the printed 120."},
  };
}

std::vector<Erratum> errata() {
  return {
      {"4.40-4.44", "L = R_d/R_a with R_d = 1, then J = R_d J_n", "multiplied by the actual reach R_a",
       "the dimension."},
      {"4.59", "Ey in the bending terms", "Ex, the axial modulus",
       "bending a tube strains it along its axis; the stiffness of the chosen design halves."},
      {"4.63", "nu21 = -(E2/E1) nu12", "with a plus sign", "symmetry of the compliance."},
      {"4.96, 4.97, 6.80", "r* and a sum of inverses", "tau*, and I_d = 1/det M_C", "algebra."},
      {"4.105, 4.107, 7.11", "eigenvalues are natural frequencies", "their square roots are",
       "eq 7.11 is the root."},
      {"5.2", "R_u1(+pi/2) in H(0,10)", "R_u1(-pi/2)",
       "eq 5.21 follows only then; otherwise chain 1 is mirrored."},
      {"5.15-5.17", "constant platform rotations", "the transpose of the base's rotation times R_u1(-pi/2)",
       "as printed, the total rotation of no chain is the identity."},
      {"5.106-5.119", "inverses of Jacobians that are not square",
       "C = J_theta K_theta^-1 J_theta^T, then inverted", "the matrices are 6x18 and 6x23."},
      {"5.122, 5.159", "the rank of K_Ci is 3", "2 in every regular posture",
       "two wrenches leave the passive joints at rest."},
      {"5.129-5.134", "unit wrench, no posture", "ten times the unit wrench at q = (30, -36, -36) deg",
       "with these, all digits of 5.132 to 5.134 come out."},
      {"5.158", "J K J^T", "J K^-1 J^T", "eq 5.122."},
      {"After 5.161", "K_C + K_Cg", "one of them", "both hold the full elastic stiffness."},
      {"5.175, 5.178", "last term 1/(4 G12)", "1/(2 G12): 11.278 GPa at 45 deg, not 25.862",
       "eq 4.69 at 45 deg."},
      {"5.183, 5.184", "next frame without R_u3(-q1) R_u1(-pi/2)", "with it", "eq 5.6."},
      {"5.192-5.194", "columns of J_s", "velocity of the body's own centre due to each earlier joint",
       "its meaning."},
      {"5.211", "three equal terms with Mdot", "the product rule's four and the half sum", "differences."},
      {"5.219, 5.220", "terms with the derivative of J_m^-1", "qdd_m = J_m^-1 (rdd - Jdot_m qd_m)",
       "product rule."},
      {"5.229", "L^2/3 with velocities of the centre", "L^2/12",
       "the parallel axis is counted twice; all 40 values of omega_n carry it."},
      {"Table 5.1", "LC7 equal to LC5", "probably (-5, -5, 5) N", "the eight combinations of signs."},
      {"6.14-6.18", "squared norms", "c = 1/cos qmax", "eq 4.33."},
      {"6.26", "mu_v = cot qmax", "l1 cos qmax", "table 7.3 has eq 6.8, in m."},
      {"6.36", "numerator not squared", "squared", "eq 6.32."},
      {"6.45, 6.46", "two constraints", "the same one twice", "(-65)^2 = 65^2."},
      {"6.48", "+ 60 cot qmax", "- 60 cot qmax", "eq 6.43; as printed no published design is feasible."},
      {"6.64", "condition numbers add", "they do not", "norm of a sum."},
      {"6.72", "det of the inverse split into determinants", "only for square J", "J_theta is 6x18."},
      {"6.85, 6.86", "m l^2/4 beside m l^2/3", "m l^2/3 about the end",
       "the parallel axis is counted twice; it moves the ratio of 7.5 by 0.003."},
      {"7.5 and table 7.7", "d/D = 0.768", "0.75 in all tables that follow", "0.45/0.60."},
      {"Tables 7.7, 7.8", "diameters", "radii, for the stated plies",
       "the wall is 0.15 mm times their number; the stiffness of 7.7 fits only radii, the mass of table 7.9 "
       "only "
       "diameters."},
      {"Table 7.6", "deflections of the stated design",
       "two sets of lengths, 25.862 GPa at 45 deg, Ey in bending, no passive joints",
       "so replayed, every digit comes out."},
      {"Table 7.3", "rho, D and d", "and 0.150 kg at the platform point", "fits all 40 values of omega_n."},
      {"Table 7.9", "footprint in mm^2", "mm", "a length."},
  };
}

}  // namespace

Reproduction reproduce_r_cube(const Catalogue& catalogue) {
  const Description description = read_description("r-cube", {}, catalogue);
  const RCubeDescription& device = std::get<RCubeDescription>(description.mechanism);
  Figures figures("r-cube");
  design_figures(figures);
  choice_figures(figures);
  section_figures(figures);
  device_figures(figures, device);
  r_cube_elastic_figures(figures, description);
  r_cube_section_study(figures);
  std::vector<Erratum> misses = not_reproduced(device);
  for (Erratum& one : r_cube_elastic_misses(description)) misses.push_back(std::move(one));
  return {.device = "r-cube",
          .source = "Görgülü 2018",
          .figures = figures.take(),
          .search = r_cube_search_findings(),
          .not_reproduced = std::move(misses),
          .errata = errata(),
          .measured_only = {"Figures 7.5-7.19, which have no numbers"}};
}

}  // namespace zwidth
