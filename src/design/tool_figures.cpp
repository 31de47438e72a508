#include <algorithm>
#include <fmt/format.h>

#include "zwidth/analysis/dexterity.h"
#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/arm_singularities.h"
#include "zwidth/mechanism/delta.h"
#include "zwidth/mechanism/family_of.h"
#include "zwidth/mechanism/five_bar.h"
#include "zwidth/mechanism/r_cube.h"

namespace zwidth::internal {
namespace {

// The rows of the tool's translations, and of its rotations alone.
std::optional<Jacobian> translation(PostureFigures& at) {
  if (at.mechanism().linear_rows() == 0) return std::nullopt;
  return at.linear_rows();
}
std::optional<Jacobian> rotation(PostureFigures& at) {
  if (!at.mechanism().tool_turns()) return std::nullopt;
  return at.angular_rows();
}

// How far the nearest leg is from stretched or folded, and the platform from being free; 0 at the singularity.
struct LegSingularity {
  double legs = kUndefined, platform = kUndefined;
};
LegSingularity leg_singularity(PostureFigures& at) {
  const Mechanism& mechanism = at.mechanism();
  const Posture& posture = at.posture();
  const ActiveVector theta = posture.active();
  const Vector3& p = posture.tool().position;
  if (const auto& geometry = mechanism.delta()) {
    const DeltaState state(*geometry, Vector3(theta), p);
    return {state.inverse_singularity().cwiseAbs().minCoeff(), std::abs(state.direct_singularity())};
  }
  if (const auto* five_bar = std::get_if<FiveBarDescription>(&at.device().description().mechanism)) {
    const FiveBarState state(five_bar_geometry(*five_bar), Vector2(theta), p.head<2>());
    return {state.inverse_singularity().cwiseAbs().minCoeff(), std::abs(state.direct_singularity())};
  }
  if (const auto* r_cube = std::get_if<RCubeDescription>(&at.device().description().mechanism)) {
    const RCubeGeometry geometry = r_cube_geometry(*r_cube);
    const RCubeSolution solution = r_cube_forward(geometry, Vector3(theta));
    if (!solution.closed()) return {};
    return {std::min((solution.lever / geometry.drive_link).cwiseAbs().minCoeff(),
                     solution.elbow.array().sin().abs().minCoeff()),
            kUndefined};
  }
  return {};
}

double singularity_distance(PostureFigures& at, const FigureOptions& options) {
  const std::vector<SrsSingularity> sets = arm_singularities(at.posture());
  const int which = index_of(options, "which", kAll);
  double nearest = kUndefined;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (which >= 0 && static_cast<int>(i) != which) continue;
    nearest = std::isnan(nearest) ? sets[i].distance : std::min(nearest, sets[i].distance);
  }
  return nearest;
}

double passive_joint(PostureFigures& at, const FigureOptions& options) {
  int rest = index_of(options, "joint");
  if (rest < 0) return kUndefined;
  for (int j = 0; j < at.mechanism().joint_count(); ++j) {
    if (at.mechanism().joints()[static_cast<std::size_t>(j)].active >= 0 || rest-- > 0) continue;
    return at.posture().joints()[j];
  }
  return kUndefined;
}

}  // namespace

FigureTable tool_figures() {
  FigureTable list;
  const auto add = [&](FigureDefinition figure) {
    figure.topic = "Place and dexterity";
    list.push_back(std::move(figure));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = kAxisNames[axis];
    add({.name = "position_" + name,
         .unit = "m",
         .meaning = "tool position along " + name,
         .answers = {{"at position[" + std::to_string(axis) + "]"}},
         .of = [axis](PostureFigures& at, const FigureOptions&) {
           return at.posture().tool().position[axis];
         }});
  }
  add({.name = "orientation",
       .unit = "1",
       .meaning = "an entry of the tool's rotation matrix",
       .options = entry_options(),
       .answers = {{"at orientation[row][column]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return entry_of(at.posture().tool().rotation, options);
       }});
  add({.name = "active_joint",
       .unit = "SI",
       .meaning = "value of an active joint",
       .options = {joint_option()},
       .answers = {{"at joints[joint]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return element_of(at.posture().active(), index_of(options, "joint"));
       }});
  add({.name = "passive_joint",
       .unit = "SI",
       .meaning = "value of a passive joint",
       .options = {{"joint", 0, Dimension::number, "which of the passive joints, from 0"}},
       .answers = {{"at passive_joints[joint]"}},
       .of = passive_joint});
  add({.name = "jacobian",
       .unit = "SI",
       .meaning = "an entry of the Jacobian: tool velocity per rate of an active joint",
       .options = entry_options(),
       .answers = {{"at jacobian[row][column]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return entry_of(at.rates().tool, options);
       }});
  add({.name = "condition_number",
       .unit = "1",
       .meaning = "largest over smallest singular value of the Jacobian, homogeneous by the device's "
                  "characteristic length",
       .answers = {{"at condition_number"},
                   {"at homogeneous.condition_number"},
                   {"report workspace.figures.condition_number"}},
       .of = [](PostureFigures& at, const FigureOptions&) {
         return finite_or_undefined(at.device().scale().condition_number(at.rates().tool));
       }});
  add({.name = "inverse_condition",
       .unit = "1",
       .meaning =
           "its inverse: 1 isotropic, 0 singular; the mean over the workspace is the global conditioning index",
       .answers = {{"report conditioning"},
                   {"report arm.conditioning.homogeneous"},
                   {"report workspace.conditioning.homogeneous"}},
       .of = [](PostureFigures& at, const FigureOptions&) {
         return 1.0 / at.device().scale().condition_number(at.rates().tool);
       }});
  add({.name = "well_conditioned",
       .unit = "1",
       .meaning =
           "1 where the condition number is below a limit, else 0; the mean is the share of the workspace",
       .options = {{"limit", 5.0, Dimension::number, "of the condition number"}},
       .answers = {{"report conditioning.shares"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return at.device().scale().condition_number(at.rates().tool) < options.get("limit", 5.0) ? 1.0 : 0.0;
       }});
  add({.name = "isotropy",
       .unit = "1",
       .meaning = "geometric over arithmetic mean of the squared singular values: 1 isotropic, 0 singular",
       .answers = {{"at isotropy"}, {"at homogeneous.isotropy"}},
       .of = [](PostureFigures& at, const FigureOptions&) {
         return isotropy(at.device().scale().homogeneous(at.rates().tool));
       }});
  add({.name = "characteristic_length",
       .unit = "m",
       .meaning = "the device's length that a radian counts as, of a tool or of joints that turn and slide",
       .answers = {{"at homogeneous.length"},
                   {"report arm.conditioning.characteristic_length"},
                   {"report workspace.conditioning.characteristic_length"}},
       .of = [](PostureFigures& at, const FigureOptions&) {
         const JacobianScale& scale = at.device().scale();
         return scale.mixed ? scale.length : kUndefined;
       }});
  struct OfOneKind {
    const char* prefix;
    const char* of;
    std::optional<Jacobian> (*rows)(PostureFigures&);
  };
  for (const OfOneKind& kind :
       {OfOneKind{"translation", "translations", translation}, OfOneKind{"rotation", "rotations", rotation}}) {
    const std::string name = kind.prefix;
    const auto rows = kind.rows;
    add({.name = name + "_condition_number",
         .unit = "1",
         .meaning = fmt::format("condition number of the {} alone", kind.of),
         .answers = {{"at homogeneous." + name + ".condition_number"}},
         .of = [rows](PostureFigures& at, const FigureOptions&) {
           const std::optional<Jacobian> J = rows(at);
           return J ? finite_or_undefined(at.device().scale().rows_condition_number(*J)) : kUndefined;
         }});
    add({.name = name + "_inverse_condition",
         .unit = "1",
         .meaning = "its inverse",
         .answers = {{"report arm." + name + "_conditioning"},
                     {"report arm.conditioning." + name},
                     {"report workspace.conditioning." + name}},
         .of = [rows](PostureFigures& at, const FigureOptions&) {
           const std::optional<Jacobian> J = rows(at);
           return J ? 1.0 / at.device().scale().rows_condition_number(*J) : kUndefined;
         }});
    add({.name = name + "_isotropy",
         .unit = "1",
         .meaning = fmt::format("isotropy of the {} alone", kind.of),
         .answers = {{"at homogeneous." + name + ".isotropy"}},
         .of = [rows](PostureFigures& at, const FigureOptions&) {
           const std::optional<Jacobian> J = rows(at);
           return J ? isotropy(at.device().scale().homogeneous_rows(*J)) : kUndefined;
         }});
  }
  add({.name = "manipulability",
       .unit = "SI",
       .meaning = "product of the singular values of the Jacobian",
       .answers = {{"at manipulability"},
                   {"report workspace.figures.manipulability"},
                   {"report arm.manipulability"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return at.dexterity().manipulability; }});
  add({.name = "min_singular_value",
       .unit = "SI",
       .meaning = "smallest singular value of the Jacobian: tool speed per joint rate in the slowest direction",
       .answers = {{"at singularity.min_singular_value"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return at.dexterity().min_singular_value; }});
  add({.name = "max_singular_value",
       .unit = "SI",
       .meaning = "largest singular value: in the fastest direction",
       .answers = {{"at singularity.max_singular_value"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return at.dexterity().max_singular_value; }});
  add({.name = "rotation_min_singular_value",
       .unit = "SI",
       .meaning = "smallest singular value of the angular rows",
       .of = [](PostureFigures& at, const FigureOptions&) {
         return at.mechanism().tool_turns() ? dexterity(at.angular_rows()).min_singular_value : kUndefined;
       }});
  add({.name = "rotation_max_singular_value",
       .unit = "SI",
       .meaning = "largest singular value of the angular rows",
       .of = [](PostureFigures& at, const FigureOptions&) {
         return at.mechanism().tool_turns() ? dexterity(at.angular_rows()).max_singular_value : kUndefined;
       }});
  add({.name = "closure",
       .unit = "1",
       .meaning = "reciprocal condition of the loop closure: 0 where the tool gains a freedom",
       .answers = {{"at singularity.closure"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return at.rates().closure; }});
  add({.name = "leg_singularity",
       .unit = "1",
       .meaning = "of a delta, five-bar or R-CUBE, distance of the legs from stretched or folded: 0 singular",
       .answers = {{"at singularity.legs"}, {"report workspace.figures.leg_singularity"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return leg_singularity(at).legs; }});
  add({.name = "platform_singularity",
       .unit = "1",
       .meaning = "of a delta or five-bar, distance of the forearms from coplanar, or aligned: 0 singular",
       .answers = {{"at singularity.platform"}, {"report workspace.figures.platform_singularity"}},
       .of = [](PostureFigures& at, const FigureOptions&) { return leg_singularity(at).platform; }});
  add({.name = "singularity_distance",
       .unit = "rad",
       .meaning = "of an arm with shoulder, elbow and wrist, distance from its singularities, which `at` names",
       .options = {{"which", kAll, Dimension::number, "of them, from 0; -1: the nearest"}},
       .answers = {{"at singularity.sets[which].distance"}},
       .of = singularity_distance});
  return list;
}

}  // namespace zwidth::internal
