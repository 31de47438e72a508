#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "zwidth/design/figures.h"

/// The tables of figures, and what their sources share. A function per topic: a figure is an entry in one of
/// them.

namespace zwidth::internal {

using FigureTable = std::vector<FigureDefinition>;

FigureTable tool_figures();       // where the tool is, and how evenly it moves
FigureTable force_figures();      // what it can push, and what holds it
FigureTable mass_figures();       // how heavy it feels, and what accelerates it
FigureTable stiffness_figures();  // how far it gives way, and how fast it vibrates
FigureTable drive_figures();      // what motors, transmissions and cylinders do by themselves
FigureTable device_figures();     // workspace, mass and loads of the whole

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// A singular posture has no finite condition number.
inline double finite_or_undefined(double value) {
  return std::isfinite(value) ? value : kUndefined;
}

// An option that counts something from 0, or kAll.
inline constexpr double kAll = -1.0;
inline int index_of(const FigureOptions& options, const std::string& name, double otherwise = 0.0) {
  return static_cast<int>(std::lround(options.get(name, otherwise)));
}

inline FigureOption joint_option() {
  return {"joint", 0, Dimension::number, "which active joint, from 0"};
}
inline FigureOption any_joint_option(const std::string& otherwise) {
  return {"joint", kAll, Dimension::number, "which active joint, from 0; -1: " + otherwise};
}
inline std::vector<FigureOption> entry_options() {
  return {{"row", 0, Dimension::number, "of the matrix, from 0"},
          {"column", 0, Dimension::number, "of the matrix, from 0"}};
}
inline FigureOption elastic_option() {
  return {"drives", 1, Dimension::number,
          "0 takes the drives as rigid; else they give where their stiffness is known"};
}
inline bool drives_give(const FigureOptions& options, double otherwise = 1.0) {
  return options.get("drives", otherwise) != 0.0;
}

// Of a matrix or vector, NaN beyond its end.
template <class Matrix>
double entry_of(const Matrix& matrix, const FigureOptions& options) {
  const int row = index_of(options, "row"), column = index_of(options, "column");
  return row >= 0 && column >= 0 && row < matrix.rows() && column < matrix.cols() ? matrix(row, column)
                                                                                  : kUndefined;
}
template <class Vector>
double element_of(const Vector& vector, int index) {
  return index >= 0 && index < vector.size() ? vector[index] : kUndefined;
}

inline constexpr const char* kAxisNames[] = {"x", "y", "z", "rx", "ry", "rz"};

// Which row of the Jacobian an axis of the twist is, counted among those of its kind; -1 if the tool has no
// freedom there.
inline int row_of(const Mechanism& mechanism, int axis) {
  const std::span<const int> axes = mechanism.tool_axes();
  for (std::size_t r = 0; r < axes.size(); ++r) {
    if (axes[r] == axis) return static_cast<int>(r);
  }
  return -1;
}

// Whether the device has cylinders, so that limits follow the posture.
inline bool pneumatic(const BuiltDevice& device) {
  return !device.description().pneumatic_drives.empty();
}
// Whether every active joint has a drive, or is moved by the hand.
inline bool has_drives(const BuiltDevice& device) {
  for (std::size_t i = 0; i < device.drives().size(); ++i) {
    const bool has = device.drives()[i] || device.pneumatic_drives()[i];
    if (!has && !device.mechanism().is_free(static_cast<int>(i))) return false;
  }
  return !device.drives().empty();
}
// Whether every active joint has an electric drive.
inline bool driven(const BuiltDevice& device) {
  for (const auto& drive : device.drives()) {
    if (!drive) return false;
  }
  return !device.drives().empty();
}

// Active torques that hold the links' weight and a load on the tool.
ActiveVector holding_torques(PostureFigures& at, const FigureOptions& options);

}  // namespace zwidth::internal
