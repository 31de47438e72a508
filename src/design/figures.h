#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "zwidth/actuation/drive.h"
#include "zwidth/actuation/pneumatic_drive.h"
#include "zwidth/analysis/acceleration.h"
#include "zwidth/analysis/dexterity.h"
#include "zwidth/analysis/force.h"
#include "zwidth/description/description.h"
#include "zwidth/description/units.h"
#include "zwidth/mechanism/jacobian.h"
#include "zwidth/mechanism/posture.h"
#include "zwidth/mechanism/stiffness.h"

/// Figures of a device by name, for studies: one number each, of a posture or of the device as a whole.

namespace zwidth {

class BuiltDevice;
namespace internal {
struct DeviceCache;
DeviceCache& cache_of(const BuiltDevice& device);
}  // namespace internal

/// A device built from its description: what figures are taken of. For one thread.
class BuiltDevice {
 public:
  /// Empty where the description, which must outlive it, breaks a rule. `with_drives`: drives too, and their
  /// inertia on the joints.
  static std::optional<BuiltDevice> try_make(const Description& description, bool with_drives);

  const Description& description() const { return *description_; }
  const Mechanism& mechanism() const;
  /// Behind its condition numbers; worked out when first asked for.
  const JacobianScale& scale() const;
  const std::vector<std::optional<Drive>>& drives() const { return drives_; }
  const std::vector<std::optional<PneumaticDrive>>& pneumatic_drives() const { return pneumatic_drives_; }

 private:
  explicit BuiltDevice(const Description& description) : description_(&description) {}

  const Description* description_;
  mutable std::optional<Mechanism> mechanism_;  // built when first asked for: some figures need none
  mutable std::optional<JacobianScale> scale_;
  std::vector<std::optional<Drive>> drives_;
  std::vector<std::optional<PneumaticDrive>> pneumatic_drives_;
  friend internal::DeviceCache& internal::cache_of(const BuiltDevice&);
  mutable std::shared_ptr<internal::DeviceCache> cache_;
};

/// A posture of a built device, and what several figures need of it, computed once.
class PostureFigures {
 public:
  /// REQUIRES: a posture of the device's mechanism; both outlive this.
  PostureFigures(const BuiltDevice& device, const Posture& posture) : device_(&device), posture_(&posture) {}

  const BuiltDevice& device() const { return *device_; }
  const Mechanism& mechanism() const { return device_->mechanism(); }
  const Posture& posture() const { return *posture_; }
  const Rates& rates();
  Jacobian linear_rows();
  Jacobian angular_rows();
  const Dexterity& dexterity();
  /// What the drives may give; zero for joints that have none.
  const TorqueRange& torque_range(bool peak);
  /// Mass matrix in the active joints, with the drives' inertia.
  const ActiveMatrix& mass();
  /// The same without it.
  const ActiveMatrix& link_mass();
  /// Lambda of the linear rows, with the drives' inertia or without; empty where it is not definite.
  const std::optional<ToolMatrix>& apparent_mass(bool with_drives);
  /// Forward dynamics of the tool at rest; empty where some joint moves no mass.
  const std::optional<ToolMotion>& motion();
  /// Of links that are beams, and of the drives if that of all is known, as `at` has it; `rigid` without
  /// either.
  const Stiffness& stiffness(bool with_drives);
  const StiffnessOptions& stiffness_options(bool with_drives);
  /// Nothing where the tool is free, or nothing gives way.
  const std::optional<Compliance>& compliance(bool with_drives);

 private:
  const BuiltDevice* device_;
  const Posture* posture_;
  std::optional<Rates> rates_;
  std::optional<Dexterity> dexterity_;
  std::optional<TorqueRange> torque_range_[2];
  std::optional<ActiveMatrix> mass_, link_mass_;
  std::optional<std::optional<ToolMatrix>> apparent_mass_[2];
  std::optional<std::optional<ToolMotion>> motion_;
  std::optional<StiffnessOptions> stiffness_options_[2];
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
  std::string name;
  double otherwise = 0.0;  ///< its value if it is not given
  Dimension dimension = Dimension::number;
  std::string meaning;
};

/// Whether a figure is taken under a load of the tool.
enum class FigureLoad { none, possible, needed };

/// Where `zwidth at` or `zwidth report` say the same number.
struct FigureAnswer {
  /// "at gravity_torques[joint]": the verb, then the place in its JSON document. Entries of arrays are those of
  /// an axis of the tool (x, y, z, rx, ry, rz) or of an option of the figure. Where minimum, mean and maximum
  /// over the workspace stand there, they are those of the figure.
  std::string place;
  std::map<std::string, double> options = {};  ///< of the figure, then
  double factor = 1.0;                         ///< the figure over the answer
};

struct FigureDefinition {
  std::string name;        ///< snake_case
  std::string unit;        ///< SI; "1" of a pure number, "SI" where it depends on the device
  std::string meaning;     ///< a phrase without its unit
  std::string topic = {};  ///< what figures of one table are about
  bool of_posture = true;  ///< else of the device as a whole
  bool needs_drives = false;
  int axis = -1;  ///< of the twist, that the tool must be able to move along or turn about; -1: any
  FigureLoad load = FigureLoad::none;
  std::vector<FigureOption> options = {};
  std::vector<FigureAnswer> answers = {};
  std::function<double(PostureFigures& posture, const FigureOptions& options)> of = {};
  std::function<double(const BuiltDevice& device, const FigureOptions& options)> of_device = {};

  /// Of its unit, if that is one that quantities may have.
  std::optional<Dimension> dimension() const;
};

/// Every figure, those of postures first.
const std::vector<FigureDefinition>& figure_definitions();
/// Null if there is none of that name.
const FigureDefinition* find_figure(std::string_view name);

/// NaN where the figure is not defined: for this kind of mechanism, or because something is not known.
double figure_value(const FigureDefinition& figure, PostureFigures& posture, const FigureOptions& options);
double figure_value(const FigureDefinition& figure, const BuiltDevice& device, const FigureOptions& options);

}  // namespace zwidth
