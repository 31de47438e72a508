#include "zwidth/description/internal/description_reader.h"

#include <cmath>
#include <fmt/format.h>

#include "zwidth/description/internal/part_reader.h"
#include "zwidth/description/names.h"

namespace zwidth {
namespace {

// ------------------------------------------------------------------------------------------------ mechanism

// Any nonzero direction becomes a unit vector; one that is so already keeps its digits.
Vector3 direction(const Vector3& v) {
  constexpr double kRounding = 1e-12;
  const double norm = v.norm();
  return norm > 0.0 && std::isfinite(norm) && std::abs(norm - 1.0) > kRounding ? Vector3(v / norm) : v;
}

JointDescription read_joint(TableReader& table) {
  JointDescription joint;
  joint.name = table.text("name", Need::required, "name the joint").value_or("");
  if (const auto type = table.choice<JointType>("type",
                                                {{"revolute", JointType::revolute},
                                                 {"prismatic", JointType::prismatic},
                                                 {"parallelogram", JointType::parallelogram}},
                                                Need::required)) {
    joint.type = *type;
  }
  const Dimension dimension = joint.type == JointType::prismatic ? Dimension::length : Dimension::angle;
  joint.active = table.flag("active", Need::optional).value_or(false);
  joint.free = table.flag("free", Need::optional).value_or(false);
  const std::string_view axis_advice = "give the direction of the axis at the zero posture, such as [0, 0, 1]";
  if (const auto axis = table.vector("axis", Dimension::number, Need::required, axis_advice)) {
    joint.axis = direction(*axis);
  }
  const std::string_view point_advice =
      "give a point on the axis at the zero posture, such as [\"80 mm\", 0, 0]";
  if (const auto point = table.vector("point", Dimension::length, Need::required, point_advice))
    joint.point = *point;
  const std::string_view range_advice = "give the lowest and the highest value";
  if (const auto range = table.interval("range", dimension, Need::optional, range_advice)) joint.range = *range;
  joint.home = table.quantity("home", dimension, Need::optional).value_or(0.0);
  table.finish();
  return joint;
}

LegDescription read_leg(TableReader& table) {
  LegDescription leg;
  leg.name = table.text("name", Need::required, "name the leg").value_or("");
  const std::string_view tip_advice = "give the point that meets the platform, at the leg's zero posture";
  if (const auto tip = table.vector("tip", Dimension::length, Need::required, tip_advice)) leg.tip = *tip;
  if (const auto attachment = table.choice<Attachment>(
          "attachment", {{"rigid", Attachment::rigid}, {"spherical", Attachment::spherical}}, Need::required)) {
    leg.attachment = *attachment;
  }
  const std::string_view point_advice = "give the same point in the platform frame";
  if (const auto point = table.vector("platform_point", Dimension::length, Need::optional, point_advice)) {
    leg.platform_point = *point;
  }
  const std::string_view rows_advice =
      "give three rows, whose columns are the platform's axes at the leg's zero posture";
  if (const auto R = table.matrix("platform_rotation", Dimension::number, Need::optional, rows_advice)) {
    leg.platform_rotation = *R;
  }
  for (TableReader& joint : table.tables("joint")) leg.joints.push_back(read_joint(joint));
  table.finish();
  return leg;
}

// A family whose [mechanism] table holds plain quantities only.
template <class Family>
Family read_family(TableReader& table) {
  Family family;
  table.read(family);
  table.read_sources(family.source, family.sources, Need::optional);
  table.finish();
  return family;
}

SerialJointDescription read_serial_joint(TableReader& table) {
  SerialJointDescription joint;
  joint.name = table.text("name", Need::required, "name the joint").value_or("");
  if (const auto type = table.choice<SerialJointType>("type",
                                                      {{"revolute", SerialJointType::revolute},
                                                       {"prismatic", SerialJointType::prismatic},
                                                       {"fixed", SerialJointType::fixed}},
                                                      Need::required)) {
    joint.type = *type;
  }
  table.read(joint);
  if (joint.type != SerialJointType::fixed) {
    const Dimension dimension = joint.type == SerialJointType::prismatic ? Dimension::length : Dimension::angle;
    if (const auto range =
            table.interval("range", dimension, Need::required, "give the lowest and the highest value")) {
      joint.range = *range;
    }
    joint.home = table.quantity("home", dimension, Need::optional)
                     .value_or(joint.range.contains(0.0) ? 0.0 : joint.range.middle());
    joint.free = table.flag("free", Need::optional).value_or(false);
  }
  table.read_sources(joint.source, joint.sources, Need::optional);
  table.finish();
  return joint;
}

SerialDescription read_serial(TableReader& table, TableReader& device) {
  SerialDescription arm;
  if (const auto platform =
          table.choice<PlatformFreedom>("platform", platform_freedom_names(), Need::optional)) {
    arm.platform = *platform;
  }
  table.read_sources(arm.source, arm.sources, Need::optional);
  table.finish();
  for (TableReader& joint : device.tables("joint")) arm.joints.push_back(read_serial_joint(joint));
  return arm;
}

LegsDescription read_legs(TableReader& table, TableReader& device) {
  LegsDescription legs;
  if (const auto platform =
          table.choice<PlatformFreedom>("platform", platform_freedom_names(), Need::required)) {
    legs.platform = *platform;
  }
  table.read_sources(legs.source, legs.sources, Need::optional);
  table.finish();
  for (TableReader& leg : device.tables("leg")) legs.legs.push_back(read_leg(leg));
  return legs;
}

enum class MechanismType { delta, five_bar, r_cube, serial, legs };

std::optional<MechanismType> read_mechanism_type(TableReader& table) {
  return table.choice<MechanismType>("type",
                                     {{"delta", MechanismType::delta},
                                      {"five-bar", MechanismType::five_bar},
                                      {"r-cube", MechanismType::r_cube},
                                      {"serial", MechanismType::serial},
                                      {"legs", MechanismType::legs}},
                                     Need::required);
}

MechanismDescription read_mechanism(TableReader& device) {
  const std::string_view advice = "start one with [mechanism] and type = \"delta\", \"legs\", ...";
  std::optional<TableReader> table = device.table("mechanism", Need::required, advice);
  const bool has_legs = device.has("leg"), has_joints = device.has("joint");
  if (!table) return {};
  const auto chosen = read_mechanism_type(*table);
  if (!chosen) return {};
  const MechanismType type = chosen.value_or(MechanismType::legs);
  if (has_legs && type != MechanismType::legs)
    device.report("leg", "belongs to type = \"legs\"", "leave it out, or change mechanism.type");
  if (has_joints && type != MechanismType::serial)
    device.report("joint", "belongs to type = \"serial\"", "leave it out, or change mechanism.type");
  if (type == MechanismType::delta) return read_family<DeltaDescription>(*table);
  if (type == MechanismType::five_bar) return read_family<FiveBarDescription>(*table);
  if (type == MechanismType::r_cube) return read_family<RCubeDescription>(*table);
  if (type == MechanismType::serial) return read_serial(*table, device);
  return read_legs(*table, device);
}

// --------------------------------------------------------------------------------------------------- bodies

// The material of a link, or its laminate.
WallDescription read_wall(TableReader& table, const Catalogue& catalogue) {
  if (!table.has("laminate")) return read_part<Material>(table, "material", catalogue);
  if (table.has("material")) table.report("material", "stands beside a laminate", "give one of the two");
  LaminateDescription laminate;
  std::optional<TableReader> inner = table.table(
      "laminate", Need::required, "write laminate = { lamina = \"...\", plies = [{ count = 4 }, ...] }");
  if (!inner) return laminate;
  laminate.lamina = read_part<Lamina>(*inner, "lamina", catalogue);
  if (const auto rule = inner->choice<LaminateRule>("rule", laminate_rule_names(), Need::optional)) {
    laminate.rule = *rule;
  }
  for (TableReader& one : inner->tables("plies")) {
    PlyDescription ply;
    one.read(ply);
    one.finish();
    laminate.plies.push_back(ply);
  }
  inner->finish();
  return laminate;
}

template <class Beam>
Beam read_beam(TableReader& table, const Catalogue& catalogue) {
  Beam beam;
  table.read(beam);
  if constexpr (std::is_same_v<Beam, BarDescription>) {
    const std::string_view advice = "give the direction of the width at the zero posture, such as [0, 1, 0]";
    if (const auto along = table.vector("width_along", Dimension::number, Need::optional, advice)) {
      beam.width_along = *along;
    }
  }
  beam.wall = read_wall(table, catalogue);
  table.read_sources(beam.source, beam.sources, Need::optional);
  table.finish();
  return beam;
}

// `tube` or `bar`; nothing if the body has neither.
std::optional<BeamDescription> read_beam(TableReader& body, const Catalogue& catalogue) {
  std::optional<BeamDescription> beam;
  const bool both = body.has("tube") && body.has("bar");
  if (both) body.report("bar", "stands beside a tube", "give the link one of the two");
  const std::string_view advice = "write tube = { outer_diameter = \"20 mm\", material = \"steel-s235\" }, say";
  if (body.has("tube")) {
    if (auto tube = body.table("tube", Need::required, advice)) {
      beam = read_beam<TubeDescription>(*tube, catalogue);
    }
  } else if (body.has("bar")) {
    if (auto bar = body.table("bar", Need::required, advice)) beam = read_beam<BarDescription>(*bar, catalogue);
  }
  return beam;
}

BodyDescription read_body(TableReader& table, const Catalogue& catalogue) {
  BodyDescription body;
  body.on = table.text("on", Need::required, "name the link: \"platform\", \"LEG/JOINT\", ...").value_or("");
  body.turns_with = table.text("turns_with", Need::optional).value_or("");
  const std::string_view pivot_advice =
      "give the point where the body hangs on its link, at the leg's zero posture";
  const Need pivot_need = body.turns_with.empty() ? Need::optional : Need::required;
  if (const auto pivot = table.vector("pivot", Dimension::length, pivot_need, pivot_advice)) {
    body.pivot = *pivot;
    if (body.turns_with.empty())
      table.report("pivot", "means nothing without turns_with",
                   "name the link that turns the body, or leave it out");
  }
  const bool is_beam = table.has("tube") || table.has("bar");
  body.beam = read_beam(table, catalogue);
  for (const char* key : {"mass", "centre", "inertia"}) {
    if (is_beam && table.has(key))
      table.report(key, "follows from the section and the material",
                   "leave it out; what the link carries beside is a body of its own");
  }
  body.mass = table
                  .quantity("mass", Dimension::mass, is_beam ? Need::optional : Need::required,
                            "give the mass, such as \"80 g\"")
                  .value_or(0.0);
  const std::string_view centre_advice = "give the centre of mass, such as [\"40 mm\", 0, 0]";
  if (const auto centre = table.vector("centre", Dimension::length, Need::optional, centre_advice)) {
    body.centre = *centre;
  }
  const std::string_view inertia_advice = "give [xx, yy, zz], [xx, yy, zz, xy, xz, yz], or three rows";
  if (const auto inertia = table.symmetric("inertia", Dimension::inertia, Need::optional, inertia_advice)) {
    body.inertia = *inertia;
  }
  table.read_sources(body.source, body.sources, Need::optional);
  table.finish();
  return body;
}

// --------------------------------------------------------------------------------------------------- drives

enum class TransmissionType { direct, capstan, ratio, gearhead };

TransmissionDescription read_transmission(TableReader& drive, const Catalogue& catalogue,
                                          const std::optional<Interval>& joint_range) {
  std::optional<TableReader> table =
      drive.table("transmission", Need::optional, "write transmission = { type = \"capstan\", ... }");
  if (!table) return DirectDriveDescription{};
  const auto type = table->choice<TransmissionType>("type",
                                                    {{"direct", TransmissionType::direct},
                                                     {"capstan", TransmissionType::capstan},
                                                     {"ratio", TransmissionType::ratio},
                                                     {"gearhead", TransmissionType::gearhead}},
                                                    Need::required);
  if (!type) return DirectDriveDescription{};
  const auto finished = [&table](auto transmission) -> TransmissionDescription {
    table->read_sources(transmission.source, transmission.sources, Need::optional);
    table->finish();
    return transmission;
  };
  switch (*type) {
    case TransmissionType::direct:
      break;
    case TransmissionType::capstan: {
      CapstanDescription capstan;
      if (joint_range) capstan.mid_angle = joint_range->middle();
      table->read(capstan);
      capstan.cable = read_part<Cable>(*table, "cable", catalogue);
      return finished(std::move(capstan));
    }
    case TransmissionType::ratio: {
      RatioDescription ratio;
      table->read(ratio);
      return finished(std::move(ratio));
    }
    case TransmissionType::gearhead: {
      GearheadDescription gear;
      gear.gearhead = read_part<Gearhead>(*table, "gearhead", catalogue);
      table->read(gear);
      return finished(std::move(gear));
    }
  }
  table->finish();
  return DirectDriveDescription{};
}

std::optional<FlexureDescription> read_preloader(TableReader& drive, const Catalogue& catalogue) {
  std::optional<TableReader> table =
      drive.table("preloader", Need::optional, "write preloader = { flexible_length = ..., ... }");
  if (!table) return std::nullopt;
  FlexureDescription flexure;
  table->read(flexure);
  flexure.material = read_part<Material>(*table, "material", catalogue);
  table->read_sources(flexure.source, flexure.sources, Need::optional);
  table->finish();
  return flexure;
}

std::optional<DriveOutputDescription> read_output(TableReader& drive) {
  std::optional<TableReader> table =
      drive.table("output", Need::optional, "write output = { inertia = ..., radius = ..., ... }");
  if (!table) return std::nullopt;
  DriveOutputDescription output;
  table->read(output);
  table->read_sources(output.source, output.sources, Need::optional);
  table->finish();
  return output;
}

// The range of the first joint that the drive moves, if there is one.
std::optional<Interval> range_of_driven_joint(const MechanismDescription& mechanism,
                                              const DriveDescription& drive) {
  const std::vector<int> driven = driven_joints(mechanism, drive);
  const std::vector<Interval> ranges = active_joint_ranges(mechanism);
  if (driven.empty() || driven.front() < 0) return std::nullopt;
  return ranges[static_cast<std::size_t>(driven.front())];
}

// Names of the joints of a drive; empty for all.
std::vector<std::string> read_joints(TableReader& drive) {
  auto joints = drive.texts("joints", "write \"all\" or a list of names");
  if (!joints || *joints == std::vector<std::string>{"all"}) return {};
  if (joints->empty())
    drive.report("joints", "names no joint", "write \"all\", or leave it out, for every active joint");
  return std::move(*joints);
}

CylinderMountDescription read_mount(TableReader& drive) {
  std::optional<TableReader> table =
      drive.table("mount", Need::optional, "write mount = { layout = \"two\", l1 = ..., ... }");
  if (!table) return DirectCylinderDescription{};
  ArmCylinderDescription mount{.layout = ArmCylinderLayout::three};  // which has every length
  if (const auto layout =
          table->choice<ArmCylinderLayout>("layout", arm_cylinder_layout_names(), Need::required)) {
    mount.layout = *layout;
  }
  table->read(mount);
  table->read_sources(mount.source, mount.sources, Need::optional);
  table->finish();
  return mount;
}

PneumaticDriveDescription read_pneumatic_drive(TableReader& table, const Catalogue& catalogue) {
  PneumaticDriveDescription drive;
  drive.joints = read_joints(table);
  if (table.has("motor")) table.report("motor", "stands beside a cylinder", "give the drive one of the two");
  drive.cylinder = read_part<Cylinder>(table, "cylinder", catalogue);
  drive.regulator = read_part<Regulator>(table, "regulator", catalogue);
  if (table.has("potentiometer")) {
    drive.potentiometer = read_part<Potentiometer>(table, "potentiometer", catalogue);
  }
  table.read(drive);
  drive.mount = read_mount(table);
  table.read_sources(drive.source, drive.sources, Need::optional);
  table.finish();
  return drive;
}

DriveDescription read_drive(TableReader& table, const Catalogue& catalogue,
                            const MechanismDescription& mechanism) {
  DriveDescription drive;
  drive.joints = read_joints(table);
  drive.motor = read_part<Motor>(table, "motor", catalogue);
  drive.encoder = read_part<Encoder>(table, "encoder", catalogue);
  drive.amplifier = read_part<Amplifier>(table, "amplifier", catalogue);
  table.read(drive);
  drive.transmission = read_transmission(table, catalogue, range_of_driven_joint(mechanism, drive));
  drive.preloader = read_preloader(table, catalogue);
  drive.output = read_output(table);
  table.read_sources(drive.source, drive.sources, Need::optional);
  table.finish();
  return drive;
}

// ---------------------------------------------------------------------------------------------------- loads

LoadDescription read_load(TableReader& table) {
  LoadDescription load;
  load.name = table.text("name", Need::required, "name the load").value_or("");
  const std::string_view force_advice =
      "give the force of the tool on its environment, such as [\"10 N\", 0, 0]";
  if (const auto force = table.vector("force", Dimension::force, Need::optional, force_advice))
    load.force = *force;
  const std::string_view moment_advice = "give the moment about the tool, such as [0, 0, \"0.5 N m\"]";
  if (const auto moment = table.vector("moment", Dimension::torque, Need::optional, moment_advice))
    load.moment = *moment;
  if (const auto frame = table.choice<MomentFrame>("moment_frame", moment_frame_names(), Need::optional))
    load.moment_frame = *frame;
  if (const auto kind = table.choice<LoadKind>("kind", load_kind_names(), Need::optional)) load.kind = *kind;
  table.read_sources(load.source, load.sources, Need::optional);
  table.finish();
  return load;
}

PostureDescription read_posture(TableReader& table, const std::vector<Dimension>& dimensions) {
  PostureDescription posture;
  posture.name = table.text("name", Need::required, "name the posture").value_or("");
  const std::string_view advice = "give the active joints in their order, such as [0, \"90 deg\", \"60 deg\"]";
  if (auto joints = table.quantities("joints", dimensions, Need::required, advice))
    posture.joints = std::move(*joints);
  table.read_sources(posture.source, posture.sources, Need::optional);
  table.finish();
  return posture;
}

}  // namespace

Description read_device_tables(Input& input, const Catalogue& catalogue) {
  Description description;
  TableReader file(input, input.root(), "");
  if (auto device = file.table("device", Need::required, "start the file with [device] and name = \"...\"")) {
    description.name = device->text("name", Need::required, "give the device a short name").value_or("");
    description.title = device->text("title", Need::optional).value_or(description.name);
    const std::string_view gravity_advice = "give a vector in the base frame, such as [0, 0, -9.80665]";
    if (const auto gravity =
            device->vector("gravity", Dimension::acceleration, Need::optional, gravity_advice)) {
      description.gravity = *gravity;
    }
    const std::string_view rows_advice = "give three rows: the user's x, y and z axes in base coordinates";
    if (const auto to_user = device->matrix("to_user", Dimension::number, Need::optional, rows_advice)) {
      description.to_user = *to_user;
    }
    device->read_sources(description.source, description.sources, Need::optional);
    device->finish();
  }
  description.mechanism = read_mechanism(file);
  for (TableReader& body : file.tables("body")) description.bodies.push_back(read_body(body, catalogue));
  for (TableReader& drive : file.tables("drive")) {
    // What `validate` says of a drive by its place in the description belongs to its place in the file.
    if (drive.has("cylinder")) {
      input.alias(join_path("pneumatic_drive", description.pneumatic_drives.size()), drive.path());
      description.pneumatic_drives.push_back(read_pneumatic_drive(drive, catalogue));
    } else {
      input.alias(join_path("drive", description.drives.size()), drive.path());
      description.drives.push_back(read_drive(drive, catalogue, description.mechanism));
    }
  }
  for (TableReader& load : file.tables("load")) description.loads.push_back(read_load(load));
  const std::vector<Dimension> dimensions = active_joint_dimensions(description.mechanism);
  for (TableReader& posture : file.tables("posture")) {
    description.postures.push_back(read_posture(posture, dimensions));
  }
  file.finish();
  return description;
}

}  // namespace zwidth
