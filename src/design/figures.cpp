#include "zwidth/design/figures.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <iterator>

#include "zwidth/actuation/drive_problems.h"
#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/joint_torque.h"
#include "zwidth/analysis/mechanical.h"
#include "zwidth/description/validate.h"
#include "zwidth/design/internal/device_cache.h"
#include "zwidth/design/internal/figure_table.h"
#include "zwidth/mechanism/beam_link.h"
#include "zwidth/mechanism/dynamics.h"

namespace zwidth {

using internal::kUndefined;

std::optional<BuiltDevice> BuiltDevice::try_make(const Description& description, bool with_drives) {
  if (!value_problems(description).empty() || !beam_problems(description).empty()) return std::nullopt;
  if (with_drives && !drive_problems(description).empty()) return std::nullopt;
  BuiltDevice device(description);
  if (!with_drives) return device;
  device.mechanism_ = mechanism_with_drives(description);
  device.drives_ = joint_drives(description, *device.mechanism_);
  device.pneumatic_drives_ = joint_pneumatic_drives(description, *device.mechanism_);
  return device;
}

const Mechanism& BuiltDevice::mechanism() const {
  if (!mechanism_) mechanism_.emplace(*description_);
  return *mechanism_;
}

const JacobianScale& BuiltDevice::scale() const {
  if (!scale_) scale_ = jacobian_scale(mechanism());
  return *scale_;
}

internal::DeviceCache& internal::cache_of(const BuiltDevice& device) {
  if (!device.cache_) device.cache_ = std::make_shared<DeviceCache>();
  return *device.cache_;
}

const Mechanism& internal::turning(const BuiltDevice& device) {
  if (device.mechanism().platform() != PlatformFreedom::point) return device.mechanism();
  std::optional<Mechanism>& kept = cache_of(device).turning;
  if (!kept) kept.emplace(with_turning_tool(device.description()));
  return *kept;
}

const Rates& PostureFigures::rates() {
  if (!rates_) rates_ = zwidth::rates(*posture_);
  return *rates_;
}

Jacobian PostureFigures::linear_rows() {
  return rates().tool.topRows(mechanism().linear_rows());
}

Jacobian PostureFigures::angular_rows() {
  return rates().tool.bottomRows(mechanism().tool_rows() - mechanism().linear_rows());
}

const Dexterity& PostureFigures::dexterity() {
  if (!dexterity_) {
    // Rows of one kind: what the tool does along its linear axes, or of one that only turns, all.
    dexterity_ = zwidth::dexterity(mechanism().linear_rows() > 0 ? linear_rows() : angular_rows());
  }
  return *dexterity_;
}

const TorqueRange& PostureFigures::torque_range(bool peak) {
  std::optional<TorqueRange>& kept = torque_range_[peak ? 1 : 0];
  if (!kept) {
    kept = zwidth::torque_range(device_->drives(), device_->pneumatic_drives(), posture_->active(), peak);
  }
  return *kept;
}

const ActiveMatrix& PostureFigures::mass() {
  if (!mass_) mass_ = mass_matrix(*posture_, rates());
  return *mass_;
}

const ActiveMatrix& PostureFigures::link_mass() {
  if (!link_mass_) {
    link_mass_ = mass();
    *link_mass_ -= ActiveMatrix(mechanism().drive_inertia().asDiagonal());
  }
  return *link_mass_;
}

const std::optional<ToolMatrix>& PostureFigures::apparent_mass(bool with_drives) {
  std::optional<std::optional<ToolMatrix>>& kept = apparent_mass_[with_drives ? 1 : 0];
  if (!kept) {
    const ActiveMatrix& M = with_drives ? mass() : link_mass();
    kept.emplace();
    if (M.llt().info() == Eigen::Success) {
      *kept = cartesian_mass(mechanism().linear_rows() > 0 ? linear_rows() : angular_rows(), M);
    }
  }
  return *kept;
}

const std::optional<ToolMotion>& PostureFigures::motion() {
  if (!motion_) {
    motion_.emplace();
    constexpr double kNone = 1e-12;  // of the largest inertia
    const Eigen::SelfAdjointEigenSolver<ActiveMatrix> eigen(mass(), Eigen::EigenvaluesOnly);
    const auto& inertia = eigen.eigenvalues();
    if (inertia[0] > kNone * inertia[inertia.size() - 1]) {
      *motion_ = tool_motion(*posture_, rates(), ActiveVector::Zero(mechanism().active_count()));
    }
  }
  return *motion_;
}

const StiffnessOptions& PostureFigures::stiffness_options(bool with_drives) {
  std::optional<StiffnessOptions>& kept = stiffness_options_[with_drives ? 1 : 0];
  if (!kept) {
    kept.emplace();
    if (with_drives && !device_->drives().empty()) {
      kept->drive_stiffness = drive_stiffness(*posture_, device_->drives());
    }
  }
  return *kept;
}

const Stiffness& PostureFigures::stiffness(bool with_drives) {
  std::optional<Stiffness>& kept = stiffness_[with_drives ? 1 : 0];
  if (!kept) kept = zwidth::stiffness(*posture_, stiffness_options(with_drives));
  return *kept;
}

const std::optional<Compliance>& PostureFigures::compliance(bool with_drives) {
  std::optional<std::optional<Compliance>>& kept = compliance_[with_drives ? 1 : 0];
  if (!kept) {
    kept.emplace();
    const Stiffness& K = stiffness(with_drives);
    if (!K.rigid) {
      Compliance found = zwidth::compliance(K, mechanism().characteristic_length());
      if (!found.free) *kept = found;
    }
  }
  return *kept;
}

double FigureOptions::get(const std::string& name, double otherwise) const {
  const auto found = further.find(name);
  return found == further.end() ? otherwise : found->second;
}

std::optional<Dimension> FigureDefinition::dimension() const {
  for (int d = 0; d <= static_cast<int>(Dimension::speed_torque_gradient); ++d) {
    if (si_unit(static_cast<Dimension>(d)) == unit) return static_cast<Dimension>(d);
  }
  return std::nullopt;
}

const std::vector<FigureDefinition>& figure_definitions() {
  static const std::vector<FigureDefinition> list = [] {
    std::vector<FigureDefinition> all;
    for (auto table : {internal::tool_figures, internal::force_figures, internal::mass_figures,
                       internal::stiffness_figures, internal::drive_figures, internal::device_figures}) {
      internal::FigureTable figures = table();
      std::move(figures.begin(), figures.end(), std::back_inserter(all));
    }
    std::stable_partition(all.begin(), all.end(), [](const FigureDefinition& one) { return one.of_posture; });
    return all;
  }();
  return list;
}

const FigureDefinition* find_figure(std::string_view name) {
  for (const FigureDefinition& figure : figure_definitions()) {
    if (figure.name == name) return &figure;
  }
  return nullptr;
}

double figure_value(const FigureDefinition& figure, PostureFigures& posture, const FigureOptions& options) {
  return figure.of_posture ? figure.of(posture, options) : figure.of_device(posture.device(), options);
}

double figure_value(const FigureDefinition& figure, const BuiltDevice& device, const FigureOptions& options) {
  return figure.of_posture ? kUndefined : figure.of_device(device, options);
}

}  // namespace zwidth
