#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <numbers>

#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/loaded_stiffness.h"
#include "zwidth/mechanism/stiffness.h"
#include "zwidth/mechanism/vibration.h"

namespace zwidth::internal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

double smallest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}
double largest(const ToolMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<ToolMatrix>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[matrix.rows() - 1];
}

const std::optional<Compliance>& compliance_of(PostureFigures& at, const FigureOptions& options) {
  return at.compliance(drives_give(options));
}

// What the tool gives along its linear axes under pure forces, the tool turning as it likes.
std::optional<ToolMatrix> linear_compliance(PostureFigures& at, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  const Mechanism& mechanism = at.mechanism();
  const int n = mechanism.linear_rows();
  if (!compliance || n == 0) return std::nullopt;
  ToolMatrix C(n, n);
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) {
      C(r, c) = compliance->matrix(mechanism.tool_axes()[static_cast<std::size_t>(r)],
                                   mechanism.tool_axes()[static_cast<std::size_t>(c)]);
    }
  }
  return C;
}

// Along or about one axis of the base, all other loads zero.
double axis_stiffness(PostureFigures& at, int axis, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  if (!compliance || row_of(at.mechanism(), axis) < 0) return kUndefined;
  return finite_or_undefined(1.0 / compliance->matrix(axis, axis));
}

double moved(PostureFigures& at, int axis, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  return compliance ? compliance->matrix.row(axis).dot(options.load) : kUndefined;
}

// By an index of Görgülü 2018, of a stiffness with all six rows.
double index_figure(PostureFigures& at, double StiffnessIndices::*index, double drives,
                    const FigureOptions& options) {
  const Stiffness& K = at.stiffness(drives_give(options, drives));
  return K.rigid || K.rows != 6 ? kUndefined : finite_or_undefined(stiffness_indices(K.matrix).*index);
}

// Shift and turn in balance with weights and load; nothing where there is no balance, or none can be computed.
std::optional<LoadedState> loaded(PostureFigures& at, const FigureOptions& options) {
  const Mechanism& mechanism = at.mechanism();
  if (at.stiffness(drives_give(options)).rigid) return std::nullopt;
  for (const BeamModel& beam : mechanism.beams()) {
    if (mechanism.joints()[static_cast<std::size_t>(beam.joint)].type == JointType::parallelogram)
      return std::nullopt;
  }
  LoadedState state = loaded_stiffness(at.posture(), {.tool = options.load},
                                       {.stiffness = at.stiffness_options(drives_give(options))});
  if (state.status != LoadedStatus::balanced) return std::nullopt;
  return state;
}

double compliance_share(PostureFigures& at, const FigureOptions& options) {
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  const int axis = index_of(options, "axis"), part = index_of(options, "part");
  if (!compliance || axis < 0 || axis > 5 || row_of(at.mechanism(), axis) < 0) return kUndefined;
  const bool drives = drives_give(options);
  const auto shares = compliance_shares(at.posture(), at.stiffness(drives), *compliance, Vector6::Unit(axis),
                                        at.stiffness_options(drives));
  if (!shares || part < 0) return kUndefined;
  const auto beams = static_cast<int>(at.mechanism().beams().size());
  if (part < beams) return shares->beams[static_cast<std::size_t>(part)];
  int drive = part - beams;
  for (int i = 0; i < at.mechanism().active_count(); ++i) {
    if (!at.mechanism().is_free(i) && drive-- == 0) return shares->drives[static_cast<std::size_t>(i)];
  }
  return kUndefined;
}

// ------------------------------------------------------------------------------------------------ vibration

// Of the links' mass on what gives way; the rotors swing against the tool where they are free.
double natural_frequency(PostureFigures& at, const FigureOptions& options, bool motors_free) {
  const Mechanism& mechanism = at.mechanism();
  const std::optional<Compliance>& compliance = compliance_of(at, options);
  if (!compliance) return kUndefined;
  const std::optional<ToolMatrix> K = felt_stiffness(mechanism, *compliance);
  if (!K || at.link_mass().llt().info() != Eigen::Success) return kUndefined;
  ToolMatrix mobility = tool_mobility(at.rates().tool, at.link_mass());
  if (motors_free) {
    if (!(mechanism.drive_inertia().minCoeff() > 0.0)) return kUndefined;
    mobility += tool_mobility(at.rates().tool, ActiveMatrix(mechanism.drive_inertia().asDiagonal()));
  }
  const auto found = modes_by_mobility(*K, mobility);
  return found ? element_of(found->frequencies, index_of(options, "mode")) / kTurn : kUndefined;
}

// Links alone, with the tool kept from turning.
double upright_frequency(PostureFigures& at, const FigureOptions& options) {
  const Mechanism& mechanism = at.mechanism();
  const Stiffness& K = at.stiffness(false);
  if (K.rigid || mechanism.linear_rows() != 3 || mechanism.tool_rows() != 3) return kUndefined;
  if (at.link_mass().llt().info() != Eigen::Success) return kUndefined;
  const ToolMatrix block = K.matrix.topLeftCorner<3, 3>();
  const auto found = modes_by_mobility(block, tool_mobility(at.rates().tool, at.link_mass()));
  return found ? element_of(found->frequencies, index_of(options, "mode")) / kTurn : kUndefined;
}

FigureOption mode_option() {
  return {"mode", 0, Dimension::number, "from 0, the lowest"};
}

}  // namespace

FigureTable stiffness_figures() {
  FigureTable list;
  std::string topic = "Stiffness";
  const auto add = [&](FigureDefinition figure) {
    figure.topic = topic;
    list.push_back(std::move(figure));
  };
  add({.name = "stiffness_min",
       .unit = "N/m",
       .meaning = "force per displacement along the softest direction",
       .needs_drives = true,
       .options = {elastic_option()},
       .answers = {{"report stiffness.softest"}, {"report mechanics.figures.softest"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const std::optional<ToolMatrix> C = linear_compliance(at, options);
         return C ? 1.0 / largest(*C) : kUndefined;
       }});
  add({.name = "stiffness_max",
       .unit = "N/m",
       .meaning = "force per displacement along the stiffest direction",
       .needs_drives = true,
       .options = {elastic_option()},
       .answers = {{"report stiffness.stiffest"}, {"report mechanics.figures.stiffest"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const std::optional<ToolMatrix> C = linear_compliance(at, options);
         return C ? finite_or_undefined(1.0 / smallest(*C)) : kUndefined;
       }});
  for (int axis = 0; axis < 6; ++axis) {
    const bool turns = axis >= 3;
    const std::string letter = kAxisNames[axis % 3];
    add({.name = (turns ? "angular_stiffness_" : "stiffness_") + letter,
         .unit = turns ? "N m/rad" : "N/m",
         .meaning = turns ? "moment per rotation about " + letter + ", no force beside it"
                          : "force per displacement along " + letter + ", no other force or moment beside it",
         .needs_drives = true,
         .axis = axis,
         .options = {elastic_option()},
         .answers = turns ? std::vector<FigureAnswer>{}
                          : std::vector<FigureAnswer>{{"report stiffness.axis." + letter},
                                                      {"report mechanics.figures.stiffness_" + letter}},
         .of = [axis](PostureFigures& at, const FigureOptions& options) {
           return axis_stiffness(at, axis, options);
         }});
  }
  std::vector<FigureOption> elastic_entry = entry_options();
  elastic_entry.push_back(elastic_option());
  add({.name = "stiffness_entry",
       .unit = "SI",
       .meaning = "an entry of the stiffness matrix of the tool, forces over moments",
       .needs_drives = true,
       .options = elastic_entry,
       .answers = {{"at stiffness[row][column]", {{"drives", 0.0}}},
                   {"at stiffness_with_drives[row][column]", {{"drives", 1.0}}}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const Stiffness& K = at.stiffness(drives_give(options));
         return K.rigid ? kUndefined : entry_of(K.matrix, options);
       }});
  add({.name = "compliance_entry",
       .unit = "SI",
       .meaning = "an entry of the compliance matrix of the tool, displacements over rotations",
       .needs_drives = true,
       .options = elastic_entry,
       .answers = {{"at compliance[row][column]", {{"drives", 0.0}}}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const std::optional<Compliance>& compliance = compliance_of(at, options);
         return compliance ? entry_of(compliance->matrix, options) : kUndefined;
       }});
  add({.name = "compliance_share",
       .unit = "1",
       .meaning = "share of one part in what the tool gives along an axis",
       .needs_drives = true,
       .options = {{"part", 0, Dimension::number, "links that are beams in their order from 0, then drives"},
                   {"axis", 0, Dimension::number, "0, 1, 2 along x, y, z; 3, 4, 5 about them"},
                   elastic_option()},
       .answers = {{"at compliance_shares[part].shares[axis]"}},
       .of = compliance_share});
  const auto add_index = [&](const std::string& name, const std::string& unit, const std::string& meaning,
                             const std::string& place, double StiffnessIndices::*index) {
    add({.name = name,
         .unit = unit,
         .meaning = meaning,
         .needs_drives = true,
         .options = {{"drives", 0, Dimension::number,
                      "1 lets the drives give too, where their stiffness is known"}},
         .answers = {{"at stiffness_indices." + place, {{"drives", 1.0}}}},
         .of = [index](PostureFigures& at, const FigureOptions& options) {
           return index_figure(at, index, 0.0, options);
         }});
  };
  add_index("held_stiffness_determinant", "(N/m)^3",
            "determinant of the links' translational stiffness with the tool kept from turning",
            "determinant_translation", &StiffnessIndices::determinant_translation);
  add_index("held_rotation_stiffness_determinant", "(N m/rad)^3",
            "determinant of the links' rotational stiffness with the tool kept in its place",
            "determinant_rotation", &StiffnessIndices::determinant_rotation);
  add_index("held_stiffness_condition", "1",
            "condition number of the links' translational stiffness with the tool kept from turning",
            "condition_translation", &StiffnessIndices::condition_translation);
  add_index("held_rotation_stiffness_condition", "1",
            "condition number of the links' rotational stiffness with the tool kept in its place",
            "condition_rotation", &StiffnessIndices::condition_rotation);
  add_index("stiffness_norm", "SI", "Frobenius norm of the whole stiffness matrix of the links", "frobenius",
            &StiffnessIndices::frobenius);
  add({.name = "deflection",
       .unit = "m",
       .meaning = "displacement of the tool under a load",
       .needs_drives = true,
       .load = FigureLoad::needed,
       .options = {elastic_option()},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const std::optional<Compliance>& compliance = compliance_of(at, options);
         return compliance ? (compliance->matrix * options.load).head<3>().norm() : kUndefined;
       }});
  add({.name = "tilt",
       .unit = "rad",
       .meaning = "rotation of the tool under a load",
       .needs_drives = true,
       .load = FigureLoad::needed,
       .options = {elastic_option()},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const std::optional<Compliance>& compliance = compliance_of(at, options);
         return compliance ? (compliance->matrix * options.load).tail<3>().norm() : kUndefined;
       }});
  for (int axis = 0; axis < 6; ++axis) {
    const bool turns = axis >= 3;
    const std::string letter = kAxisNames[axis % 3];
    add({.name = (turns ? "tilt_" : "deflection_") + letter,
         .unit = turns ? "rad" : "m",
         .meaning = std::string(turns ? "that rotation about " : "that displacement along ") + letter,
         .needs_drives = true,
         .load = FigureLoad::needed,
         .options = {elastic_option()},
         .answers = {{"at deflection[" + std::to_string(axis) + "]", {{"drives", 0.0}}}},
         .of = [axis](PostureFigures& at, const FigureOptions& options) { return moved(at, axis, options); }});
  }
  add({.name = "loaded_deflection",
       .unit = "m",
       .meaning = "displacement in balance with the weights and a load, in the deflected geometry",
       .needs_drives = true,
       .load = FigureLoad::possible,
       .options = {{"axis", kAll, Dimension::number, "0, 1, 2 along x, y, z; -1: its size"}, elastic_option()},
       .answers = {{"at loaded.displacement[axis]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const auto state = loaded(at, options);
         if (!state) return kUndefined;
         const int axis = index_of(options, "axis", kAll);
         const Vector6& shift = state->displacement;
         return axis < 0 ? shift.head<3>().norm() : element_of(shift, axis);
       }});
  std::vector<FigureOption> loaded_entry = elastic_entry;
  add({.name = "loaded_stiffness_entry",
       .unit = "SI",
       .meaning = "an entry of the stiffness matrix in that balance",
       .needs_drives = true,
       .load = FigureLoad::possible,
       .options = loaded_entry,
       .answers = {{"at loaded.stiffness[row][column]"}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         const auto state = loaded(at, options);
         return state ? entry_of(state->stiffness, options) : kUndefined;
       }});

  topic = "Vibration";
  add({.name = "natural_frequency",
       .unit = "Hz",
       .meaning = "natural frequency with the motors held",
       .needs_drives = true,
       .options = {mode_option(), elastic_option()},
       .answers = {{"at natural_frequencies.held.frequencies[mode]", {}, 1.0 / kTurn},
                   {"report stiffness.lowest_frequency.held", {}, 1.0 / kTurn},
                   {"report mechanics.figures.frequency_held", {}, 1.0 / kTurn}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return natural_frequency(at, options, false);
       }});
  add({.name = "free_natural_frequency",
       .unit = "Hz",
       .meaning = "natural frequency with the motors free, rotors swinging against the tool",
       .needs_drives = true,
       .options = {mode_option(), elastic_option()},
       .answers = {{"at natural_frequencies.free.frequencies[mode]", {}, 1.0 / kTurn},
                   {"report stiffness.lowest_frequency.free", {}, 1.0 / kTurn},
                   {"report mechanics.figures.frequency_free", {}, 1.0 / kTurn}},
       .of = [](PostureFigures& at, const FigureOptions& options) {
         return natural_frequency(at, options, true);
       }});
  add({.name = "upright_natural_frequency",
       .unit = "Hz",
       .meaning = "natural frequency of the links with the tool kept from turning (the index of Görgülü 2018)",
       .needs_drives = true,
       .options = {mode_option()},
       .answers = {{"at natural_frequencies.rotation_held.frequencies[mode]", {}, 1.0 / kTurn}},
       .of = upright_frequency});
  return list;
}

}  // namespace zwidth::internal
