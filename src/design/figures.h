#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/description/description.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/stiffness.h"

/// Figures of a device by name, for studies: one number each, of a posture or of the device as a whole.

namespace zwidth {

/// A device built from its description: what figures are taken of. For one thread.
class BuiltDevice {
 public:
  /// Empty where the description, which must outlive it, breaks a rule. `with_drives`: drives too, and their
  /// inertia on the joints.
  static std::optional<BuiltDevice> try_make(const Description& description, bool with_drives);

  const Description& description() const { return *description_; }
  const Mechanism& mechanism() const;
  const std::vector<std::optional<Drive>>& drives() const { return drives_; }
  const std::vector<std::optional<PneumaticDrive>>& pneumatic_drives() const { return pneumatic_drives_; }

 private:
  explicit BuiltDevice(const Description& description) : description_(&description) {}

  const Description* description_;
  mutable std::optional<Mechanism> mechanism_;  // built when first asked for: some figures need none
  std::vector<std::optional<Drive>> drives_;
  std::vector<std::optional<PneumaticDrive>> pneumatic_drives_;
};

/// A posture of a built device, and what several figures need of it, computed once.
class PostureFigures {
 public:
  /// REQUIRES: a posture of the device's mechanism; both outlive this.
  PostureFigures(const BuiltDevice& device, const Posture& posture) : device_(&device), posture_(&posture) {}

  const BuiltDevice& device() const { return *device_; }
  const Posture& posture() const { return *posture_; }
  const Rates& rates();
  const Dexterity& dexterity();
  /// In the active joints, without the drives' inertia.
  const ActiveMatrix& link_mass();
  /// Lambda of the linear rows, with the drives' inertia or without; empty where it is not definite.
  const std::optional<ToolMatrix>& apparent_mass(bool with_drives);
  /// Of links that are beams, and of the drives if that of all is known, as `at` has it; `rigid` without
  /// either.
  const Stiffness& stiffness(bool with_drives);
  /// Nothing where the tool is free, or nothing gives way.
  const std::optional<Compliance>& compliance(bool with_drives);

 private:
  const BuiltDevice* device_;
  const Posture* posture_;
  std::optional<Rates> rates_;
  std::optional<Dexterity> dexterity_;
  std::optional<ActiveMatrix> link_mass_;
  std::optional<std::optional<ToolMatrix>> apparent_mass_[2];
  std::optional<Stiffness> stiffness_[2];
  std::optional<std::optional<Compliance>> compliance_[2];
};

/// What a figure may be told beside the posture.
struct FigureOptions {
  Vector6 load = Vector6::Zero();         ///< of the tool's surroundings on it, base frame [N, N m]
  std::map<std::string, double> further;  ///< by the names that the figure knows

  double get(const std::string& name, double otherwise) const;
};

/// One further option of a figure.
struct FigureOption {
  std::string_view name;
  double otherwise;  ///< its value if it is not given
  Dimension dimension;
  std::string_view meaning;
};

struct FigureDefinition {
  std::string_view name;     ///< snake_case
  std::string_view unit;     ///< SI
  std::string_view meaning;  ///< a phrase without its unit
  bool of_posture = true;    ///< else of the device as a whole
  bool needs_drives = false;
  bool needs_load = false;
  double (*of)(PostureFigures& posture, const FigureOptions& options) = nullptr;
  double (*of_device)(const BuiltDevice& device, const FigureOptions& options) = nullptr;
  std::span<const FigureOption> options = {};
};

/// Every figure, those of postures first.
std::span<const FigureDefinition> figure_definitions();
/// Null if there is none of that name.
const FigureDefinition* find_figure(std::string_view name);

/// NaN where the figure is not defined: for this kind of mechanism, or because something is not known.
double figure_value(const FigureDefinition& figure, PostureFigures& posture, const FigureOptions& options);
double figure_value(const FigureDefinition& figure, const BuiltDevice& device, const FigureOptions& options);

}  // namespace zwidth
