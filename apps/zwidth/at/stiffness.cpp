#include "zwidth/mechanism/stiffness.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "json_rows.h"
#include "section.h"

#include "zwidth/analysis/mechanical.h"
#include "zwidth/mechanism/dynamics.h"
#include "zwidth/mechanism/loaded_stiffness.h"
#include "zwidth/mechanism/vibration.h"

/// How far the tool gives way, and how it vibrates.

namespace zwidth::at {

namespace {

constexpr const char* kNoBeams =
    "not given by the source: a leg has neither a link that is a beam (tube, bar) nor a drive of known "
    "stiffness";

/// The stiffness of links alone and of links and drives, each only where it means something.
struct Elastic {
  std::optional<Stiffness> links, with_drives;
  StiffnessOptions drives;  ///< of `with_drives`

  /// What is known best.
  const Stiffness* best() const { return with_drives ? &*with_drives : links ? &*links : nullptr; }
  StiffnessOptions best_options() const { return with_drives ? drives : StiffnessOptions{}; }
  const char* best_of() const {
    return with_drives ? (links ? "links and drives" : "drives alone, the links are rigid") : "links";
  }
};

Elastic elastic(const Situation& at) {
  Elastic result;
  const Stiffness links = stiffness(at.posture);
  if (!links.rigid) result.links = links;
  result.drives.drive_stiffness = drive_stiffness(at.posture, at.model.drives);
  if (result.drives.drive_stiffness.size() > 0) {
    const Stiffness all = stiffness(at.posture, result.drives);
    if (!all.rigid) result.with_drives = all;
  }
  return result;
}

/// In the user's frame, with as many rows as the stiffness has.
Eigen::MatrixXd turned(const Situation& at, const Matrix6& matrix, int rows) {
  Matrix6 R = Matrix6::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = at.frame.R;
  const Matrix6 result = R * matrix * R.transpose();
  return result.topLeftCorner(rows, rows);
}

std::string free_text(const Situation& at, const Compliance& compliance) {
  const Vector3 linear = at.frame.R * Vector3(compliance.free_direction.head<3>());
  return fmt::format("nothing holds the tool along ({})", direction_text(linear));
}

/// Links of the mechanism that are not rigid but have no beam: those with a length.
std::string rigid_links(const Mechanism& mechanism) {
  std::string names;
  for (const LegModel& leg : mechanism.legs()) {
    for (int j = leg.first; j < leg.first + leg.count; ++j) {
      const bool last = j + 1 == leg.first + leg.count;
      const Vector3& span = last ? leg.tip : mechanism.joints()[static_cast<size_t>(j) + 1].offset;
      const bool beam = std::any_of(mechanism.beams().begin(), mechanism.beams().end(),
                                    [j](const BeamModel& one) { return one.joint == j; });
      if (beam || span.norm() < 1e-9) continue;
      names += (names.empty() ? "" : ", ") + mechanism.joint_names()[static_cast<size_t>(j)];
    }
  }
  return names;
}

void show_felt(const Situation& at, const Compliance& give, const char* label, const char* note,
               Answer& answer) {
  const auto felt = felt_stiffness(at.mechanism, give);
  if (!felt || at.frame.linear() != at.mechanism.linear_rows() || felt->rows() != at.mechanism.tool_rows())
    return;
  const ToolMatrix K = at.frame.turn * *felt * at.frame.turn.transpose();
  const int linear = at.frame.linear();
  const std::vector<std::string> names = at.frame.names();
  if (linear > 0) {
    answer.columns({names.begin(), names.begin() + linear});
    answer.cells(label, Eigen::VectorXd(K.diagonal().head(linear)), 1e-3, note);
  }
}

}  // namespace

void write_stiffness(const Situation& at, Answer& answer) {
  const Elastic state = elastic(at);
  const double length = at.mechanism.characteristic_length();
  if (!state.best()) {
    for (const char* key : {"stiffness", "stiffness_with_drives", "compliance"})
      answer.undefined(key, kNoBeams);
    answer.page().row("stiffness", "not given by the source", "no section of a link, no drive's stiffness");
    return;
  }
  if (state.links) {
    answer.put("stiffness", json_array(turned(at, state.links->matrix, state.links->rows)));
    show_felt(at, compliance(*state.links, length), "stiffness [N/mm]", "drives held, as if rigid", answer);
    const std::string rigid = rigid_links(at.mechanism);
    if (!rigid.empty()) answer.page().row("", fmt::format("links without a section count as rigid: {}", rigid));
  } else {
    answer.undefined("stiffness", "not given by the source: links without a section count as rigid");
  }
  if (state.with_drives) {
    answer.put("stiffness_with_drives",
               json_array(turned(at, state.with_drives->matrix, state.with_drives->rows)));
    show_felt(at, compliance(*state.with_drives, length), "  with the drives' own [N/mm]", "motors held",
              answer);
  } else {
    answer.undefined("stiffness_with_drives", "not given by the source: the stiffness of some drive");
  }

  const Stiffness& own = state.links ? *state.links : *state.with_drives;
  const Compliance give = compliance(own, length);
  if (give.free) {
    answer.undefined("compliance", free_text(at, give));
  } else {
    answer.put("compliance", json_array(turned(at, give.matrix, own.rows)));
  }
}

void write_deflection(const Situation& at, Answer& answer) {
  if (!at.load) return;
  const Elastic state = elastic(at);
  if (!state.best()) {
    answer.undefined("deflection", kNoBeams);
    return;
  }
  const Stiffness& own = state.links ? *state.links : *state.with_drives;
  const Compliance give = compliance(own, at.mechanism.characteristic_length());
  // The hand pushes with what the device exerts on it.
  const Vector6 push = -at.mechanism.six_components(ToolVector(at.frame.turn.transpose() * *at.load));
  if (give.free) {
    answer.undefined("deflection", free_text(at, give));
    return;
  }
  Vector6 moved = give.matrix * push;
  moved.head<3>() = (at.frame.R * moved.head<3>()).eval();
  moved.tail<3>() = (at.frame.R * moved.tail<3>()).eval();
  answer.put("deflection", json_array(Eigen::VectorXd(moved.head(own.rows))));
  answer.axes();
  answer.cells("deflection under the load [µm]", Eigen::VectorXd(moved.head<3>()), 1e6, "as the hand pushes");
  if (own.rows == 6) answer.cells("  turned by [mrad]", Eigen::VectorXd(moved.tail<3>()), kMilli);
}

void write_stiffness_indices(const Situation& at, Answer& answer) {
  const Elastic state = elastic(at);
  if (!state.best() || state.best()->rows != 6) {
    answer.undefined("stiffness_indices",
                     state.best() ? "only for a tool that is held against turning" : kNoBeams);
    return;
  }
  const StiffnessIndices indices = stiffness_indices(state.best()->matrix);
  answer.put("stiffness_indices",
             Json{{"frobenius", json_number(indices.frobenius)},
                  {"condition_translation", json_number(indices.condition_translation)},
                  {"condition_rotation", json_number(indices.condition_rotation)},
                  {"determinant_translation", json_number(indices.determinant_translation)},
                  {"determinant_rotation", json_number(indices.determinant_rotation)},
                  {"stiffness_of", state.best_of()}});
  answer.page().row("condition of the stiffness", number(indices.condition_translation),
                    fmt::format("of forces; {} of moments", number(indices.condition_rotation)));
}

void write_loaded(const Situation& at, Answer& answer) {
  const Elastic state = elastic(at);
  if (!state.best()) {
    answer.undefined("loaded", kNoBeams);
    return;
  }
  for (const BeamModel& beam : at.mechanism.beams()) {
    if (at.mechanism.joints()[static_cast<size_t>(beam.joint)].type != JointType::parallelogram) continue;
    answer.undefined("loaded", "a link that bends is moved by parallel bars: not computed");
    return;
  }
  Loading loading;
  if (at.load) loading.tool = -at.mechanism.six_components(ToolVector(at.frame.turn.transpose() * *at.load));
  const LoadedState found = loaded_stiffness(at.posture, loading, {.stiffness = state.best_options()});
  Json entry{{"status", to_string(found.status)},
             {"iterations", found.iterations},
             {"residual", json_number(found.residual)},
             {"displacement", nullptr},
             {"stiffness", nullptr},
             {"stiffness_of", state.best_of()}};
  const char* label = at.load ? "weights and load, in balance [µm]" : "sag under its own weight [µm]";
  if (found.status == LoadedStatus::balanced) {
    Vector6 moved = found.displacement;
    moved.head<3>() = (at.frame.R * moved.head<3>()).eval();
    moved.tail<3>() = (at.frame.R * moved.tail<3>()).eval();
    entry["displacement"] = json_array(Eigen::VectorXd(moved.head(state.best()->rows)));
    entry["stiffness"] = json_array(turned(at, found.stiffness, state.best()->rows));
    answer.axes();
    answer.cells(label, Eigen::VectorXd(moved.head<3>()), 1e6,
                 fmt::format("iterated {} times, {} give", found.iterations, state.best_of()), 4, 1e-9);
  } else {
    answer.page().row(label, to_string(found.status),
                      fmt::format("after {} steps, the last {} of the longest link", found.iterations,
                                  number(found.residual)));
  }
  answer.put("loaded", entry);
}

void write_compliance_shares(const Situation& at, Answer& answer) {
  const Elastic state = elastic(at);
  if (!state.best()) {
    answer.undefined("compliance_shares", kNoBeams);
    return;
  }
  const Compliance give = compliance(*state.best(), at.mechanism.characteristic_length());
  std::vector<ComplianceShares> shares;
  for (Eigen::Index r = 0; r < static_cast<Eigen::Index>(at.frame.axes.size()); ++r) {
    const ToolVector axis =
        at.frame.turn.transpose() * ToolVector::Unit(static_cast<Eigen::Index>(at.frame.axes.size()), r);
    const auto of_axis = compliance_shares(at.posture, *state.best(), give, at.mechanism.six_components(axis),
                                           state.best_options());
    if (!of_axis) {
      answer.undefined("compliance_shares", free_text(at, give));
      return;
    }
    shares.push_back(*of_axis);
  }
  constexpr double kWorthALine = 0.05;
  Json entries = Json::array();
  const auto row = [&](const char* kind, const std::string& name, auto value_of) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(shares.size()));
    for (size_t r = 0; r < shares.size(); ++r) values[static_cast<Eigen::Index>(r)] = value_of(shares[r]);
    entries.push_back(Json{{"kind", kind}, {"name", name}, {"shares", json_array(values)}});
    if (values.maxCoeff() < kWorthALine) return;
    answer.columns(at.frame.names());
    answer.cells(fmt::format("give of {} {} [%]", kind, name), values, 100.0, "", 3, 1e-9);
  };
  const auto& beams = at.mechanism.beams();
  for (size_t b = 0; b < beams.size(); ++b) {
    row("link", at.mechanism.joint_names()[static_cast<size_t>(beams[b].joint)],
        [b](const ComplianceShares& one) { return one.beams[b]; });
  }
  if (state.with_drives) {
    for (int i = 0; i < at.mechanism.active_count(); ++i) {
      if (at.mechanism.is_free(i)) continue;
      row("drive", at.mechanism.active_names()[static_cast<size_t>(i)],
          [i](const ComplianceShares& one) { return one.drives[static_cast<size_t>(i)]; });
    }
  }
  answer.put("compliance_shares", entries);
}

namespace {

Json modes_entry(const Situation& at, const Modes& modes) {
  Json entry;
  entry["frequencies"] = json_array(modes.frequencies);
  entry["shapes"] = json_rows(Eigen::MatrixXd(at.frame.turn * modes.shapes));
  return entry;
}

void show_frequencies(const Situation& at, const char* label, const Modes& modes, const char* note,
                      Answer& answer) {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < modes.frequencies.size(); ++i) names.push_back(fmt::format("mode {}", i + 1));
  answer.columns(names);
  answer.cells(label, modes.frequencies, 0.5 / std::numbers::pi, note);
  // How the tool moves in each, a turn as the way of a point at the characteristic length.
  Eigen::MatrixXd shapes = at.frame.turn * modes.shapes;
  const Eigen::Index linear = at.frame.linear();
  shapes.bottomRows(shapes.rows() - linear) *= at.mechanism.characteristic_length();
  for (Eigen::Index c = 0; c < shapes.cols(); ++c) shapes.col(c).normalize();
  const std::vector<std::string> axes = at.frame.names();
  for (Eigen::Index r = 0; r < shapes.rows(); ++r) {
    answer.cells(
        fmt::format("  {} {}", r < linear ? "along" : "about",
                    r < linear ? axes[static_cast<size_t>(r)] : axes[static_cast<size_t>(r)].substr(1)),
        Eigen::VectorXd(shapes.row(r)), 1.0, "", 3, 1e-9);
  }
}

}  // namespace

void write_natural_frequencies(const Situation& at, Answer& answer) {
  if (at.singularity.loses) {
    answer.undefined("natural_frequencies",
                     "the tool cannot move along some direction: no mass goes with its give");
    return;
  }
  const Elastic state = elastic(at);
  if (!state.best()) {
    answer.page().row("natural frequencies", "not given by the source", "as the stiffness");
    answer.undefined("natural_frequencies", kNoBeams);
    return;
  }
  ActiveMatrix links = mass_matrix(at.posture, at.rates);
  links.diagonal() -= at.mechanism.drive_inertia();
  const double largest = links.diagonal().cwiseAbs().maxCoeff();
  if (!(links.diagonal().minCoeff() > 1e-9 * largest)) {
    answer.page().row("natural frequencies", "not given by the source", "the mass that some joint moves");
    answer.undefined("natural_frequencies", "not given by the source: the mass that some joint moves");
    return;
  }
  const ToolMatrix mobility = tool_mobility(at.rates.tool, links);
  Json entry;
  const auto felt =
      felt_stiffness(at.mechanism, compliance(*state.best(), at.mechanism.characteristic_length()));
  const std::optional<Modes> held = felt ? modes_by_mobility(*felt, mobility) : std::nullopt;
  if (!held) {
    answer.undefined("natural_frequencies", "the tool is free along some direction");
    return;
  }
  entry["stiffness_of"] = state.best_of();
  entry["held"] = modes_entry(at, *held);
  show_frequencies(at, "motors held [Hz]", *held, state.best_of(), answer);
  if (at.mechanism.drive_inertia().minCoeff() > 0.0) {
    const ActiveMatrix rotors = at.mechanism.drive_inertia().asDiagonal();
    const auto free = modes_by_mobility(*felt, mobility + tool_mobility(at.rates.tool, rotors));
    entry["free"] = free ? modes_entry(at, *free) : Json(nullptr);
    if (free) show_frequencies(at, "motors free [Hz]", *free, "rotors against tool", answer);
  } else {
    entry["free"] = nullptr;
  }
  entry["rotation_held"] = nullptr;
  if (state.links && at.mechanism.linear_rows() == 3 && at.mechanism.tool_rows() == 3) {
    const ToolMatrix block = state.links->matrix.topLeftCorner<3, 3>();
    if (const auto index = modes_by_mobility(block, mobility)) {
      entry["rotation_held"] = modes_entry(at, *index);
      show_frequencies(at, "  links, no turning [Hz]", *index, "the index of Görgülü 2018", answer);
    }
  }
  answer.put("natural_frequencies", entry);
}

}  // namespace zwidth::at
