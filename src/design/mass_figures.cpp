#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "zwidth/analysis/acceleration.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth::internal {
namespace {

constexpr double kNone = 1e-12;  // of the largest: what rounding leaves of a mobility that is zero

template <class Function>
double of_mass(PostureFigures& at, bool with_drives, Function function) {
  const std::optional<ToolMatrix>& mass = at.apparent_mass(with_drives);
  return mass ? function(*mass) : kUndefined;
}
double smallest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}
double largest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[matrix.rows() - 1];
}
double determinant(const ToolMatrix& matrix) {
  return matrix.determinant();
}

// The motion of the linear rows, or of the angular ones.
std::optional<ToolMotion> part_of(PostureFigures& at, bool turns) {
  const int linear = at.mechanism().linear_rows(), rows = at.mechanism().tool_rows();
  if ((turns ? rows - linear : linear) == 0 || !at.motion()) return std::nullopt;
  return turns ? at.motion()->rows(linear, rows - linear) : at.motion()->rows(0, linear);
}

// Of a mobility's entry or eigenvalue, the mass; undefined where it cannot be moved.
double mass_of(double mobility, double largest_mobility) {
  return mobility > kNone * largest_mobility ? 1.0 / mobility : kUndefined;
}

double axis_mass(PostureFigures& at, int axis) {
  const bool turns = axis >= 3;
  const auto part = part_of(at, turns);
  int row = row_of(at.mechanism(), axis);
  if (!part || row < 0) return kUndefined;
  if (turns) row -= at.mechanism().linear_rows();
  return mass_of(part->mobility(row, row), largest(part->mobility));
}
double principal_inertia(PostureFigures& at, bool heaviest) {
  const auto part = part_of(at, true);
  if (!part) return kUndefined;
  const double most = largest(part->mobility);
  return mass_of(heaviest ? smallest(part->mobility) : most, most);
}

double acceleration(PostureFigures& at, bool turns, bool peak, bool strongest) {
  const auto part = part_of(at, turns);
  if (!part || !has_drives(at.device()) || (peak && pneumatic(at.device()))) return kUndefined;
  const Zonotope polytope = acceleration_polytope(*part, at.torque_range(peak));
  return finite_or_undefined(strongest ? polytope.outer_radius : polytope.inner_radius);
}

double acceleration_half_axis(PostureFigures& at, bool turns, const FigureOptions& options) {
  const auto part = part_of(at, turns);
  if (!part || !driven(at.device())) return kUndefined;
  const Ellipsoid ellipsoid = acceleration_ellipsoid(*part, either_way(at.torque_range(false)));
  return finite_or_undefined(element_of(ellipsoid.lengths, index_of(options, "which")));
}

}  // namespace

FigureTable mass_figures() {
  FigureTable list;
  std::string topic = "Mass that the hand feels";
  const auto add = [&](FigureDefinition figure) {
    figure.topic = topic;
    list.push_back(std::move(figure));
  };
  add({.name = "apparent_mass_min",
       .unit = "kg",
       .meaning = "apparent mass along the lightest direction, drives included",
       .needs_drives = true,
       .answers = {{"at apparent_mass.translation.lightest"},
                   {"report inertia.lightest"},
                   {"report mechanics.figures.lightest"},
                   {"report arm.lightest"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, true, smallest); }});
  add({.name = "apparent_mass_max",
       .unit = "kg",
       .meaning = "apparent mass along the heaviest direction, drives included",
       .needs_drives = true,
       .answers = {{"at apparent_mass.translation.heaviest"},
                   {"report inertia.heaviest"},
                   {"report mechanics.figures.heaviest"},
                   {"report arm.heaviest"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, true, largest); }});
  add({.name = "apparent_mass_determinant",
       .unit = "kg^n",
       .meaning = "determinant of the apparent mass, drives included",
       .needs_drives = true,
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, true, determinant); }});
  for (int axis = 0; axis < 6; ++axis) {
    const bool turns = axis >= 3;
    const std::string letter = kAxisNames[axis % 3];
    add({.name = (turns ? "apparent_inertia_" : "apparent_mass_") + letter,
         .unit = turns ? "kg m^2" : "kg",
         .meaning = turns ? "apparent inertia about " + letter + ", the tool free in all other ways"
                          : "apparent mass along " + letter + ", the tool free to move sideways",
         .needs_drives = true,
         .axis = axis,
         .answers = turns ? std::vector<FigureAnswer>{{"at apparent_mass.rotation.axis[" +
                                                       std::string(kAxisNames[axis]) + "]"}}
                          : std::vector<FigureAnswer>{{"at apparent_mass.translation.axis[" + letter + "]"},
                                                      {"report inertia.axis." + letter},
                                                      {"report mechanics.figures.mass_" + letter}},
         .of = [axis](PostureFigures& at, const FigureOptions&) { return axis_mass(at, axis); }});
  }
  for (const bool heaviest : {false, true}) {
    add({.name = heaviest ? "apparent_inertia_max" : "apparent_inertia_min",
         .unit = "kg m^2",
         .meaning =
             heaviest ? "apparent inertia about the heaviest axis" : "apparent inertia about the lightest axis",
         .needs_drives = true,
         .answers = {{heaviest ? "at apparent_mass.rotation.heaviest" : "at apparent_mass.rotation.lightest"}},
         .of = [heaviest](PostureFigures& at, const FigureOptions&) {
           return principal_inertia(at, heaviest);
         }});
  }
  add({.name = "link_mass_min",
       .unit = "kg",
       .meaning = "apparent mass of the links along the lightest direction",
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, false, smallest); }});
  add({.name = "link_mass_max",
       .unit = "kg",
       .meaning = "apparent mass of the links along the heaviest direction",
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, false, largest); }});
  add({.name = "link_mass_determinant",
       .unit = "kg^n",
       .meaning = "determinant of the apparent mass of the links",
       .of = [](PostureFigures& at, const FigureOptions&) { return of_mass(at, false, determinant); }});
  add({.name = "mass_matrix",
       .unit = "SI",
       .meaning = "an entry of the mass matrix of the active joints",
       .needs_drives = true,
       .options = entry_options(),
       .answers = {{"at mass_matrix[row][column]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) { return entry_of(at.mass(), options); }});
  add({.name = "cartesian_mass",
       .unit = "SI",
       .meaning = "an entry of the mass matrix at the tool",
       .needs_drives = true,
       .options = entry_options(),
       .answers = {{"at cartesian_mass[row][column]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         if (at.mass().llt().info() != Eigen::Success) return kUndefined;
         return finite_or_undefined(entry_of(cartesian_mass(at.rates().tool, at.mass()), options));
       }});
  add({.name = "drive_inertia",
       .unit = "SI",
       .meaning = "inertia of a joint's rotor and transmission, or mass at a slide",
       .needs_drives = true,
       .options = {joint_option()},
       .answers = {{"at drive_inertia[joint]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return element_of(at.mechanism().drive_inertia(), index_of(options, "joint"));
       }});

  topic = "Acceleration";
  for (const bool turns : {false, true}) {
    const std::string part = turns ? "rotation" : "translation",
                      what = turns ? "angular_acceleration" : "acceleration";
    const std::string words = turns ? "angular acceleration" : "acceleration",
                      unit = turns ? "rad/s^2" : "m/s^2";
    for (const bool peak : {false, true}) {
      for (const bool strongest : {false, true}) {
        std::vector<FigureAnswer> answers = {{std::string("at acceleration_limits.") +
                                              (peak ? "peak." : "continuous.") + part +
                                              (strongest ? ".strongest" : ".every_direction")}};
        if (!turns && !peak && !strongest) answers.push_back({"report mechanics.figures.acceleration"});
        add({.name = (peak ? "peak_" : "") + what + (strongest ? "_max" : "_min"),
             .unit = unit,
             .meaning = (strongest ? "largest " + words + " in any direction" : words + " in every direction") +
                        std::string(" from rest, of the ") + (peak ? "short-time" : "continuous") +
                        " torques beside the weight",
             .needs_drives = true,
             .answers = answers,
             .of = [=](PostureFigures& at, const FigureOptions&) {
               return acceleration(at, turns, peak, strongest);
             }});
      }
    }
    add({.name = what + "_ellipsoid",
         .unit = unit,
         .meaning = "a half-axis of the ellipsoid of " + words + "s of the continuous torques, weight left out",
         .needs_drives = true,
         .options = {{"which", 0, Dimension::number, "from 0, the longest"}},
         .answers = {{"at dynamic_manipulability." + part + ".half_axes[which]"}},
         .of = [turns](PostureFigures& at, const FigureOptions& options) {
           return acceleration_half_axis(at, turns, options);
         }});
    add({.name = turns ? "rotation_dynamic_manipulability" : "dynamic_manipulability",
         .unit = "SI",
         .meaning = turns ? "dynamic manipulability of the angular rows"
                          : "product of the " + words + "s of unit torques",
         .needs_drives = true,
         .answers = {{"at dynamic_manipulability." + part + ".unit_torque"}},
         .of = [turns](PostureFigures& at, const FigureOptions&) {
           const auto motion = part_of(at, turns);
           return motion ? dynamic_manipulability(*motion) : kUndefined;
         }});
    add({.name = turns ? "angular_coasting" : "coasting",
         .unit = unit,
         .meaning = "size of the tool's " + words + " when nothing holds it",
         .needs_drives = true,
         .of = [turns](PostureFigures& at, const FigureOptions&) {
           const auto motion = part_of(at, turns);
           return motion ? motion->coasting.norm() : kUndefined;
         }});
  }
  return list;
}

}  // namespace zwidth::internal
