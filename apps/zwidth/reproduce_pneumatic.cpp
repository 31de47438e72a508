#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "reproduction.h"
#include "study.h"

#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/analysis/workspace.h"
#include "zwidth/description/read.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/families.h"
#include "zwidth/mechanism/posture.h"

/// The figures of Akhoondi Asadi 2017. The thesis publishes the lengths of the first prototype only: what it
/// says of the final device is compared with the lengths chosen in devices/pneumatic-3.toml.

namespace zwidth {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMegapascal = 1e6;

const PrintedUnit kMillimetre{"mm", "m", 1e-3}, kNewton{"N", "N", 1.0};

// Of figures 7 and 8.
constexpr double kLoad = 25.0, kDistance = 0.36, kHalfRange = 25.0 * kDegree;
const ArmCylinderDescription kFigureSeven{.layout = ArmCylinderLayout::one, .l1 = 0.25, .l2 = 0.13};
const Interval kRange{-kHalfRange, kHalfRange};

double parsed(const char* text, Dimension dimension) {
  return *parse_quantity(text, dimension).value;
}

/// Edge of the largest cube in the workspace of a device [m].
double cube(const Description& description) {
  return inscribed_shapes(Mechanism(without_free_joints(description))).cube.size;
}

/// Thickness of the region that the first prototype covers in x and y: from its reach with the second joint at
/// the far end of its range to that with the arm stretched [m].
double crescent(const Description& description) {
  const auto& rows = std::get<SerialDescription>(description.mechanism).joints;
  const Mechanism mechanism(description);
  const auto reach = [&](double theta2) {
    ActiveVector joints = ActiveVector::Zero(3);
    joints[2] = theta2;
    const Vector3 p = solve_forward(mechanism, joints).posture->tool().position;
    return std::hypot(p.x() - rows[0].a, p.y());
  };
  return reach(std::atan2(rows[2].a, rows[3].d)) - reach(rows[2].range.min);
}

/// The final device with the lengths of set B, for the larger cube (docs/devices/pneumatic.md).
Description set_b(const Catalogue& catalogue) {
  std::vector<std::string> overrides = {"joint.4.d=\"20 mm\""};
  for (const char* joint : {"0", "1", "3"}) {
    overrides.push_back(fmt::format("joint.{}.range=[\"-45 deg\", \"45 deg\"]", joint));
  }
  for (const char* drive : {"0", "1"}) {
    overrides.push_back(fmt::format("drive.{}.mount.l0=\"6.25 mm\"", drive));
    overrides.push_back(fmt::format("drive.{}.mount.l2=\"8.83883 mm\"", drive));
  }
  overrides.emplace_back("drive.2.mount.l1=\"8.83883 mm\"");
  overrides.emplace_back("drive.2.mount.h=\"6.25 mm\"");
  return read_description("pneumatic-3", overrides, catalogue);
}

/// Vertical force of the final device at theta = 0 with a pressure in the rear chamber of cylinder 3 [N].
double vertical_force(const PneumaticDriveDescription& drive, double reach, double pressure) {
  const double force = cylinder_force(drive.cylinder.rear_area, drive.cylinder.rod_area, pressure, 0.0);
  const ArmCylinder arm(std::get<ArmCylinderDescription>(drive.mount));
  return force / *arm.required_force(1.0, reach, 0.0);
}

void cylinder_figures(Figures& figures, const Catalogue& catalogue) {
  const Cylinder& cylinder = *catalogue.find<Cylinder>("airpel-m16d100.0u");
  figures.under("Section 3.1.1, figures 7 and 8: M16D100.0U in layout one");
  const auto push = [&](double pressure) {
    return cylinder_force(cylinder.rear_area, cylinder.rod_area, pressure, 0.0);
  };
  read_otherwise(
      figures.add("S3.1.1.force", "largest force, rear side", kNewton, 0, 139.0, push(0.7 * kMegapascal)),
      "at 0.7 MPa, which the source does not state", "at the catalogue's limit", push(cylinder.max_pressure),
      "100 psi, as the maker's table has it");

  const ArmCylinder arm(kFigureSeven);
  ReproducedFigure& stroke =
      figures.add("F7.stroke", "stroke of M16D100.0U over 25 deg either way", kMillimetre, 0, 100.0,
                  arm.length(kRange.max) - arm.length(kRange.min));
  stroke.tolerance = 1e-3;  // the lengths are printed to ten millimetres
  const ArmCylinderDescription exact = *design_one({0.2281, 0.3281, kHalfRange});
  figures.add("F7.l1", "l1 for a stroke of 100 mm from 228.1 mm", kMillimetre, 0, 250.0, exact.l1);
  figures.add("F7.l2", "l2", kMillimetre, 0, 130.0, exact.l2).tolerance = 5e-3;
}

void device_figures(Figures& figures, const Description& set_a, const Description& larger) {
  const PneumaticDriveDescription& third = set_a.pneumatic_drives[2];
  const auto& joints = std::get<SerialDescription>(set_a.mechanism).joints;
  const double reach = joints[4].d + joints[5].d;
  figures.under("Abstract and chapter 5: the final device, with chosen lengths");
  figures.add("A.omni", "0.75 lbf of another device", kNewton, 1, 3.3,
              0.75 * parsed("1 lbf", Dimension::force));
  ReproducedFigure& force = figures.add("A.force", "largest vertical force, rear side, theta = 0", kNewton, 2,
                                        8.75, vertical_force(third, reach, 0.7 * kMegapascal));
  force.tolerance = 0.05;  // 1.96 lbf, printed beside it, is 8.72 N
  read_otherwise(force, "set A, chosen to give it, at 0.7 MPa", "at the regulators' limit",
                 vertical_force(third, reach, third.regulator.max_pressure), "0.5 MPa");
  const double larger_cube = cube(larger);
  ReproducedFigure& small =
      figures.add("S3.3.cube", "cube in the workspace, at least", kMillimetre, 0, 50.0, cube(set_a));
  small.tolerance = 5e-3;
  read_otherwise(small, "set A, chosen to hold 5 cm and little more", "set B", larger_cube, "chosen for 80 mm");
  figures.add("F31.cube", "cube in the workspace, figure 31", kMillimetre, 0, 80.0, larger_cube).tolerance =
      3e-3;
}

std::vector<Erratum> not_reproduced(const Catalogue& catalogue) {
  const Cylinder& small = *catalogue.find<Cylinder>("airpel-m9d12.5u");
  const Cylinder& wide = *catalogue.find<Cylinder>("airpel-m16d12.5u");
  const double at_7 = small.rear_area * 0.7 * kMegapascal * small.stroke,
               at_5 = small.rear_area * 0.5 * kMegapascal * small.stroke,
               wide_at_5 = wide.rear_area * 0.5 * kMegapascal * wide.stroke;
  const ArmCylinder printed(kFigureSeven);
  const CylinderTravel travel{printed.length(kRange.min), printed.length(kRange.max), kHalfRange};
  const auto peak = [](const ArmCylinderDescription& design) {
    return ArmCylinder(design).peak_required_force(kLoad, kDistance, kRange)->force;
  };
  const double first = peak(kFigureSeven), optimal = peak(design_two_optimal(travel)),
               least = peak(*design_least_peak(travel)),
               bound = minimum_peak_force(travel.stroke(), kHalfRange, kLoad, kDistance);
  const double limit = cylinder_force(wide.rear_area, wide.rod_area, 0.7 * kMegapascal, 0.0);
  const double thick = crescent(read_description("pneumatic-1", {}, catalogue));
  return {
      {"figure 8", "the force stays below the limit, but close to it",
       fmt::format("it peaks at {:.1f} N, {:.0f} % of {:.0f} N", first, 100.0 * first / limit, limit),
       "F l_F d/(l1 l2) at +25 deg, which is exact in layout one"},
      {"figures 12, 15, 19", "each layout needs less force than the one before",
       fmt::format(
           "layout two comes down to {:.1f} N from {:.1f}; three cannot need less than the best two, {:.1f} N",
           optimal, first, least),
       fmt::format(
           "all layouts are one curve with one free number; the work of the load alone asks for {:.1f} N",
           bound)},
      {"figure 21", "largest cube of the first prototype 100 mm",
       fmt::format("no cube above {:.0f} mm fits", 1e3 * thick),
       "with joints of ±60 deg the region in x and y is a crescent of that thickness; the misprinted X of "
       "(3.68) "
       "would make it wider than the stroke in z"},
      {"figure 31, chapters 4 and 5", "80 mm cube, 8.75 N and M9D12.5U in one device",
       fmt::format("80 mm allow {:.1f} N at 0.7 MPa and {:.1f} N at 0.5; 8.75 N allow {:.1f} mm and {:.1f} mm",
                   at_7 / 0.08, at_5 / 0.08, 1e3 * at_7 / 8.75, 1e3 * at_5 / 8.75),
       fmt::format(
           "work: force times travel cannot exceed A1 p times stroke, {:.0f} N mm at 0.7 MPa, {:.0f} at 0.5; "
           "with M16D12.5U it would be {:.0f} at 0.5 MPa, and all three agree",
           1e3 * at_7, 1e3 * at_5, 1e3 * wide_at_5)},
      {"abstract, chapter 5", "1.96 lbf (8.75 N)",
       fmt::format("1.96 lbf is {:.3f} N, 8.75 N is {:.3f} lbf", 1.96 * parsed("1 lbf", Dimension::force),
                   8.75 / parsed("1 lbf", Dimension::force)),
       "the pound-force"},
      {"chapters 4 and 5", "8.75 N with ITV0030 regulators",
       "they end at 0.5 MPa; the printed force, like the 139 N of section 3.1.1, takes 0.7 MPa",
       "range of the regulator, area of the cylinder"},
  };
}

std::vector<Erratum> errata() {
  return {
      {"figure 7", "l_F = 360 and l_F = 250 mm", "l_F = 360, l1 = 250 mm", "only so is the stroke 99 mm"},
      {"figures 14 to 19", "configuration three, four", "modified two, three",
       "the captions are shifted by one"},
      {"(3.9)", "first root of d²min + d²max + …", "of (d²min + d²max)/2 + …", "(3.10); the range comes back"},
      {"(3.25), (3.39)", "minus root", "both roots", "both give the range back"},
      {"text before (3.37), (3.38)", "(3.33) and (3.34) are added", "(3.35) and (3.36)",
       "only these hold the lengths"},
      {"(3.45) to (3.53), (3.58)", "l² + l²; a = l²", "the second is l′² = h² + l2²; a = l′²",
       "plane geometry"},
      {"(3.55), (3.57)", "lever l1, angle α1 + α2 + θ − φ", "lever √(l0² + l1²), angle α1 + θ − φ",
       "virtual work; equal only if l0 = 0"},
      {"(3.61)", "element (2,2) −cos θ cos α", "+cos θ cos α", "a rotation is orthogonal; (3.64)"},
      {"(3.68)", "first and third term with l3x", "with l3z",
       "product of the table's rows; (3.84) has it right"},
      {"(3.85), J12", "… − l3z S1S2", "… − l3z S1C2 − l3x S1S2", "differences"},
      {"(3.85), J22", "l3z C1C2 twice", "once", "differences"},
      {"(3.94), Z", "l1x S3", "lex S3", "product of the table's rows"},
      {"(3.95), Vz", "l_ez", "lex", "dimension; (3.94)"},
      {"(3.98), 4T5", "theta1", "theta5", "table 3"},
      {"(3.99)", "the product of prototype 2", "that of all seven rows", "table 3"},
      {"(3.100), R21", "C1S2S3C4C5 twice", "once", "product of the table's rows"},
      {"(3.100), R22", "C1C2S4C5", "C1C2S4S5", "product of the table's rows"},
      {"(3.100), R31", "− S3C5", "− S3S5", "product of the table's rows"},
      {"(3.100), R33", "missing", "−C3S4", "product of the table's rows"},
      {"(3.101), X and Y", "last terms with S3", "with C3", "product of the table's rows"},
      {"(3.102), (3.104), (3.110)", "differentiated from the printed (3.101)", "from the right one",
       "they are exactly its derivative: an error of the source, not of the print"},
      {"(3.106)", "eigenvalues of the Jacobian", "of J Jᵀ", "the Jacobian is 3 x 5"},
      {"(3.110), T3", "a stray rate, a bracket misplaced", "−L(c12 s3 Fx + s12 s3 Fy) + L c3 Fz", "T = Jᵀ F"},
      {"(3.111), third", "T3/(l2 sin β3)", "−T3/(l sin β3), push positive", "virtual work"},
      {"section 3.2.3", "M16D12.5U", "M9D12.5U in chapter 4 and section 5.2",
       "see above: only the larger one would do"},
      {"numbering", "(3.71)–(3.82), (3.86)–(3.90), (3.108), (4.1), (4.2)", "do not exist", "the text goes on"},
  };
}

// No linkage can do better than the work that the load takes, over the stroke.
SearchFinding least_push() {
  const StudyRun found = search_study("pneumatic-arm-cylinder", {});
  constexpr double weight = 8.75, distance = 0.110, stroke = 0.0125;  // as the study has them [N], [m]
  const double half_range = std::numbers::pi / 6.0;
  const double bound = 2.0 * weight * distance * std::sin(half_range) / stroke;
  return {.id = "pneumatic.search.push",
          .source = "Section 3.1.4: the arm and its cylinder, by the study pneumatic-arm-cylinder",
          .what = fmt::format("smallest peak of the cylinder's force, {:.1f} N, over 2 F l_F sin θ_m/stroke",
                              found.objectives(0)[0]),
          .decimals = 3,
          .value = found.objectives(0)[0] / bound,
          .at_least = 1.0,
          .at_most = 1.01};
}

}  // namespace

Reproduction reproduce_pneumatic(const Catalogue& catalogue) {
  const Description set_a = read_description("pneumatic-3", {}, catalogue), larger = set_b(catalogue);
  Figures figures("pneumatic");
  cylinder_figures(figures, catalogue);
  device_figures(figures, set_a, larger);
  return {.device = "pneumatic",
          .source = "Akhoondi Asadi 2017, University of Manitoba",
          .figures = figures.take(),
          .search = {least_push()},
          .not_reproduced = not_reproduced(catalogue),
          .errata = errata(),
          .measured_only = {
              "Chapter 4, joint sweep: sensed angles and tip position over 30 s.",
              "Chapter 4, spring: commanded and monitored pressure of cylinder 3; no stiffness is printed.",
              "Chapter 4, box of 5 cm: pressures when the x limit is crossed; no force is printed."}};
}

}  // namespace zwidth
