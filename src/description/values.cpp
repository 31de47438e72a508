#include "zwidth/description/values.h"

#include "zwidth/description/catalogue.h"
#include "zwidth/description/internal/schema.h"
#include "zwidth/description/names.h"
#include "zwidth/description/overload.h"

namespace zwidth {
namespace {

class Collector {
 public:
  explicit Collector(const Description& description) : device_source_(description.source) {}

  template <class Owner>
  void add_fields(const std::string& table, const Owner& owner, const std::string& fallback) {
    for (const Field<Owner>& field : fields<Owner>()) {
      std::vector<double> values = std::visit(
          Overload{[&](double Owner::*member) { return std::vector<double>{owner.*member}; },
                   [&](int Owner::*member) { return std::vector<double>{static_cast<double>(owner.*member)}; },
                   [&](Vector3 Owner::*member) {
                     const Vector3& v = owner.*member;
                     return std::vector<double>{v.x(), v.y(), v.z()};
                   },
                   [&](Interval Owner::*member) {
                     return std::vector<double>{(owner.*member).min, (owner.*member).max};
                   }},
          field.member);
      add(table, std::string(field.key), std::move(values), field.dimension, std::string(field.meaning),
          owner.source.empty() ? fallback : owner.source, owner.sources);
    }
  }

  void add_serial_joint(const std::string& table, const SerialJointDescription& joint,
                        const SerialDescription& arm) {
    const std::string& source = joint.source.empty() ? arm.source : joint.source;
    for (const Field<SerialJointDescription>& field : fields<SerialJointDescription>()) {
      const double value = joint.*std::get<double SerialJointDescription::*>(field.member);
      add(table, std::string(field.key), {value}, field.dimension, std::string(field.meaning), source,
          joint.sources);
    }
    if (joint.type == SerialJointType::fixed) return;
    add(table, "range", {joint.range.min, joint.range.max},
        joint.type == SerialJointType::prismatic ? Dimension::length : Dimension::angle,
        "lowest and highest value of " + joint.name, source, joint.sources);
  }

  // What no source gives of a part stands behind the figures as much as what no source gives of the device.
  template <class Part>
  void add_chosen(const std::string& table, const Part& part) {
    for (const PartValue& value : part_values(part)) {
      if (!zwidth::given(value.value) || !value.source.starts_with("chosen")) continue;
      list_.push_back({join_path(table, part_kind<Part>()),
                       value.key,
                       {value.value},
                       value.dimension,
                       value.meaning + " of " + part.info.name,
                       value.source});
    }
  }

  void add(const std::string& table, const std::string& key, std::vector<double> values, Dimension dimension,
           const std::string& meaning, const std::string& source, const Sources& own) {
    const auto found = own.find(key);
    std::string from = found != own.end() ? found->second : source;
    if (from.empty()) from = device_source_;
    list_.push_back({table, key, std::move(values), dimension, meaning, std::move(from)});
  }

  std::vector<DescribedValue> take() { return std::move(list_); }

 private:
  std::string device_source_;
  std::vector<DescribedValue> list_;
};

}  // namespace

std::vector<DescribedValue> described_values(const Description& description) {
  Collector collector(description);
  const Matrix3& R = description.to_user;
  collector.add(
      "device", "to_user", {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)},
      Dimension::number, "turns base coordinates into the user's, row by row", {}, description.sources);
  std::visit(Overload{[&](const SerialDescription& arm) {
                        for (std::size_t i = 0; i < arm.joints.size(); ++i) {
                          collector.add_serial_joint(join_path("joint", i), arm.joints[i], arm);
                        }
                      },
                      [](const LegsDescription&) {},
                      [&](const auto& family) { collector.add_fields("mechanism", family, {}); }},
             description.mechanism);
  for (std::size_t i = 0; i < description.bodies.size(); ++i) {
    const BodyDescription& body = description.bodies[i];
    const std::string table = join_path("body", i);
    const Matrix3& I = body.inertia;
    collector.add(table, "mass", {body.mass}, Dimension::mass, "mass of " + body.on, body.source, body.sources);
    if (!body.turns_with.empty()) {
      collector.add(table, "pivot", {body.pivot.x(), body.pivot.y(), body.pivot.z()}, Dimension::length,
                    "point where the body hangs on " + body.on + " that " + body.turns_with + " turns",
                    body.source, body.sources);
    }
    collector.add(table, "centre", {body.centre.x(), body.centre.y(), body.centre.z()}, Dimension::length,
                  "centre of mass of " + body.on, body.source, body.sources);
    collector.add(table, "inertia", {I(0, 0), I(1, 1), I(2, 2)}, Dimension::inertia,
                  "moments of inertia of " + body.on + " about its centre of mass", body.source, body.sources);
  }
  for (std::size_t i = 0; i < description.drives.size(); ++i) {
    const DriveDescription& drive = description.drives[i];
    const std::string table = join_path("drive", i);
    collector.add_fields(table, drive, {});
    std::visit(
        [&](const auto& transmission) {
          using Transmission = std::remove_cvref_t<decltype(transmission)>;
          if constexpr (!std::is_same_v<Transmission, DirectDriveDescription>)
            collector.add_fields(join_path(table, "transmission"), transmission, drive.source);
        },
        drive.transmission);
    collector.add_chosen(table, drive.motor);
    collector.add_chosen(table, drive.encoder);
    collector.add_chosen(table, drive.amplifier);
    if (const auto* capstan = std::get_if<CapstanDescription>(&drive.transmission)) {
      collector.add_chosen(join_path(table, "transmission"), capstan->cable);
    } else if (const auto* gear = std::get_if<GearheadDescription>(&drive.transmission)) {
      collector.add_chosen(join_path(table, "transmission"), gear->gearhead);
    }
    if (drive.preloader) {
      collector.add_fields(join_path(table, "preloader"), *drive.preloader, drive.source);
      collector.add_chosen(join_path(table, "preloader"), drive.preloader->material);
    }
    if (drive.output) collector.add_fields(join_path(table, "output"), *drive.output, drive.source);
  }
  for (std::size_t i = 0; i < description.pneumatic_drives.size(); ++i) {
    const PneumaticDriveDescription& drive = description.pneumatic_drives[i];
    const std::string table = join_path("pneumatic_drive", i);
    collector.add_fields(table, drive, {});
    if (const auto* arm = std::get_if<ArmCylinderDescription>(&drive.mount)) {
      collector.add_fields(join_path(table, "mount"), *arm, drive.source);
    }
  }
  for (std::size_t i = 0; i < description.loads.size(); ++i) {
    const LoadDescription& load = description.loads[i];
    const std::string table = join_path("load", i);
    collector.add(table, "force", {load.force.x(), load.force.y(), load.force.z()}, Dimension::force,
                  "force of the " + to_string(load.kind) + " load \"" + load.name + "\"", load.source,
                  load.sources);
    collector.add(table, "moment", {load.moment.x(), load.moment.y(), load.moment.z()}, Dimension::torque,
                  "moment of the " + to_string(load.kind) + " load \"" + load.name + "\"", load.source,
                  load.sources);
  }
  return collector.take();
}

}  // namespace zwidth
