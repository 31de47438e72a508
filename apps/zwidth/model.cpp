#include "model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "terminal.h"

#include "zwidth/analysis/data_sheet.h"
#include "zwidth/analysis/joint_torque.h"

namespace zwidth {

Model::Model(const Description& of)
    : description(of),
      mechanism(mechanism_with_drives(of)),
      drives(joint_drives(of, mechanism)),
      pneumatic_drives(joint_pneumatic_drives(of, mechanism)) {}

bool Model::has_drive(int i) const {
  const auto j = static_cast<size_t>(i);
  return drives[j] || pneumatic_drives[j] || mechanism.is_free(i);
}

bool Model::has_drives() const {
  for (int i = 0; i < mechanism.active_count(); ++i) {
    if (!has_drive(i)) return false;
  }
  return true;
}

bool Model::driven() const {
  return std::all_of(drives.begin(), drives.end(), [](const auto& drive) { return drive.has_value(); });
}

namespace {

template <class Function>
ActiveVector of_drives(const Model& model, Function function) {
  ActiveVector values =
      ActiveVector::Constant(model.mechanism.active_count(), std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < values.size(); ++i) {
    if (const auto& drive = model.drives[static_cast<size_t>(i)]) {
      const std::optional<double> value = function(*drive);
      if (value) values[i] = *value;
    }
  }
  return values;
}

}  // namespace

ActiveVector Model::continuous_torque() const {
  return of_drives(*this, [](const Drive& drive) { return drive.continuous_torque().usable; });
}
ActiveVector Model::peak_torque() const {
  return of_drives(*this, [](const Drive& drive) { return drive.peak_torque().usable; });
}
ActiveVector Model::torque_step() const {
  return of_drives(*this, [](const Drive& drive) { return drive.torque_resolution(); });
}
ActiveVector Model::joint_step() const {
  ActiveVector steps = of_drives(*this, [](const Drive& drive) { return drive.angular_resolution(); });
  for (int i = 0; i < steps.size(); ++i) {
    const auto& drive = pneumatic_drives[static_cast<size_t>(i)];
    if (drive && drive->angular_resolution()) steps[i] = *drive->angular_resolution();
  }
  return steps;
}

TransmissionText transmission_text(const TransmissionDescription& transmission) {
  struct Text {
    TransmissionText operator()(const DirectDriveDescription&) const { return {"direct", ""}; }
    TransmissionText operator()(const CapstanDescription& capstan) const {
      return {"cable capstan", capstan.cable.info.title};
    }
    TransmissionText operator()(const RatioDescription& ratio) const {
      return {trimmed(ratio.ratio) + ":1",
              ratio.efficiency < 1.0 ? "efficiency " + trimmed(ratio.efficiency) : ""};
    }
    TransmissionText operator()(const GearheadDescription& gear) const {
      return {"gearhead",
              gear.gearhead.info.title +
                  (gear.further_ratio == 1.0 ? "" : ", then " + trimmed(gear.further_ratio) + ":1")};
    }
  };
  return std::visit(Text{}, transmission);
}

}  // namespace zwidth
