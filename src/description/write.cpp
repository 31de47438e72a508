#include "zwidth/description/write.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <ostream>

#include "zwidth/description/internal/schema.h"
#include "zwidth/description/names.h"

namespace zwidth {
namespace {

std::string text(const std::string& value) {
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20U || c == 0x7F) {
      quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string quantity(double value, Dimension dimension) {
  if (value == 0.0) return "0";
  const std::string formatted = format_quantity(value, dimension);
  return formatted.find(' ') == formatted.npos ? formatted : '"' + formatted + '"';
}

std::string array(const auto& values, Dimension dimension) {
  std::string list;
  for (const double value : values) list += (list.empty() ? "" : ", ") + quantity(value, dimension);
  return '[' + list + ']';
}

std::string rows(const Matrix3& matrix, Dimension dimension) {
  std::string list;
  for (int i = 0; i < 3; ++i) list += (list.empty() ? "" : ", ") + array(matrix.row(i), dimension);
  return '[' + list + ']';
}

// As diagonal, or as six numbers, unless rounding has made the two triangles differ.
std::string symmetric(const Matrix3& m) {
  if (m != m.transpose()) return rows(m, Dimension::inertia);
  const Vector3 products(m(0, 1), m(0, 2), m(1, 2));
  if (products.isZero(0.0)) return array(Vector3(m.diagonal()), Dimension::inertia);
  return array(std::array{m(0, 0), m(1, 1), m(2, 2), products[0], products[1], products[2]},
               Dimension::inertia);
}

std::string list(const std::vector<std::string>& names) {
  std::string names_text;
  for (const std::string& name : names) names_text += (names_text.empty() ? "" : ", ") + text(name);
  return '[' + names_text + ']';
}

struct Line {
  std::string key;
  std::string value;
};
using Lines = std::vector<Line>;

void add_source(Lines& lines, const std::string& source, const Sources& sources) {
  if (!source.empty()) lines.push_back({"source", text(source)});
  if (sources.empty()) return;
  std::string inner;
  for (const auto& [key, from] : sources) {
    inner += fmt::format("{}{} = {}", inner.empty() ? "" : ", ", join_path("", key), text(from));
  }
  lines.push_back({"sources", "{ " + inner + " }"});
}

// Fields whose value is not the one that reading starts from; values not given are left out.
template <class Owner>
void add_fields(Lines& lines, const Owner& owner, const Owner& start) {
  for (const Field<Owner>& field : fields<Owner>()) {
    std::visit(
        [&](auto member) {
          using Value = std::remove_cvref_t<decltype(owner.*member)>;
          const std::string key(field.key);
          if constexpr (std::is_same_v<Value, Interval>) {
            const Interval& interval = owner.*member;
            lines.push_back({key, array(std::array{interval.min, interval.max}, field.dimension)});
          } else if constexpr (std::is_same_v<Value, Vector3>) {
            lines.push_back({key, array(owner.*member, field.dimension)});
          } else {
            const auto value = static_cast<double>(owner.*member);
            const bool starts_so = owner.*member == start.*member && field.need == Need::optional;
            if (std::isfinite(value) && !starts_so) lines.push_back({key, quantity(value, field.dimension)});
          }
        },
        field.member);
  }
}

// A part as it stands after `key =`.
template <class Part>
std::string part(const Part& part, const Catalogue& catalogue) {
  const Part* entry = catalogue.find<Part>(part.info.name);
  if (entry != nullptr && part == *entry) return text(part.info.name);

  Lines lines;
  // A value that was taken away cannot be said on top of a catalogue entry: then the whole part is spelled out.
  bool on_top = entry != nullptr && std::ranges::all_of(entry->info.sources, [&](const auto& source) {
                  return part.info.sources.contains(source.first);
                });
  if (on_top) {
    const std::vector<PartValue> values = part_values(part), before = part_values(*entry);
    lines.push_back({"base", text(part.info.name)});
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i].value == before[i].value || (!given(values[i].value) && !given(before[i].value))) continue;
      on_top = on_top && given(values[i].value);
      if (on_top) lines.push_back({values[i].key, quantity(values[i].value, values[i].dimension)});
    }
    if (part.info.title != entry->info.title) lines.push_back({"title", text(part.info.title)});
    if (part.info.source != entry->info.source) lines.push_back({"source", text(part.info.source)});
    Sources changed;
    for (const auto& [key, source] : part.info.sources) {
      const auto before_key = entry->info.sources.find(key);
      if (before_key == entry->info.sources.end() || before_key->second != source) changed[key] = source;
    }
    add_source(lines, "", changed);
  }
  if (!on_top) {
    lines = {{"name", text(part.info.name)}, {"title", text(part.info.title)}};
    add_fields(lines, part, Part{});
    add_source(lines, part.info.source, part.info.sources);
  }
  std::string inner;
  for (const Line& line : lines) inner += (inner.empty() ? "" : ", ") + line.key + " = " + line.value;
  return "{ " + inner + " }";
}

std::string platform_name(PlatformFreedom platform) {
  for (const auto& [name, freedom] : platform_freedom_names()) {
    if (freedom == platform) return name;
  }
  return {};
}

std::string_view name_of(JointType type) {
  switch (type) {
    case JointType::revolute:
      return "revolute";
    case JointType::prismatic:
      return "prismatic";
    case JointType::parallelogram:
      return "parallelogram";
  }
  return {};
}

class Writer {
 public:
  Writer(std::ostream& out, const Catalogue& catalogue) : out_(out), catalogue_(catalogue) {}

  void write(const Description& description) {
    const Description untouched;
    Lines device{{"name", text(description.name)}, {"title", text(description.title)}};
    add_source(device, description.source, description.sources);
    if (description.gravity != untouched.gravity) {
      device.push_back({"gravity", array(description.gravity, Dimension::acceleration)});
    }
    if (description.to_user != untouched.to_user)
      device.push_back({"to_user", rows(description.to_user, Dimension::number)});
    table("[device]", device);
    std::visit([this](const auto& mechanism) { write_mechanism(mechanism); }, description.mechanism);
    for (const BodyDescription& body : description.bodies) write(body);
    for (const DriveDescription& drive : description.drives) write(drive);
    for (const PneumaticDriveDescription& drive : description.pneumatic_drives) write(drive);
    for (const LoadDescription& load : description.loads) write(load);
    const std::vector<Dimension> dimensions = active_joint_dimensions(description.mechanism);
    for (const PostureDescription& posture : description.postures) write(posture, dimensions);
  }

 private:
  void table(std::string_view header, const Lines& lines) {
    if (!first_) out_ << '\n';
    first_ = false;
    out_ << header << '\n';
    for (const Line& line : lines) out_ << line.key << " = " << line.value << '\n';
  }

  template <class Family>
  void write_family(const char* type, const Family& family) {
    Lines lines{{"type", text(type)}};
    add_fields(lines, family, Family{});
    add_source(lines, family.source, family.sources);
    table("[mechanism]", lines);
  }
  void write_mechanism(const DeltaDescription& delta) { write_family("delta", delta); }
  void write_mechanism(const FiveBarDescription& five_bar) { write_family("five-bar", five_bar); }
  void write_mechanism(const RCubeDescription& r_cube) { write_family("r-cube", r_cube); }

  void write_mechanism(const SerialDescription& arm) {
    Lines lines{{"type", text("serial")}};
    if (arm.platform != PlatformFreedom::rigid)
      lines.push_back({"platform", text(platform_name(arm.platform))});
    add_source(lines, arm.source, arm.sources);
    table("[mechanism]", lines);
    for (const SerialJointDescription& joint : arm.joints) {
      const bool slides = joint.type == SerialJointType::prismatic;
      const bool fixed = joint.type == SerialJointType::fixed;
      Lines row{{"name", text(joint.name)},
                {"type", text(fixed    ? "fixed"
                              : slides ? "prismatic"
                                       : "revolute")}};
      add_fields(row, joint, SerialJointDescription{});
      if (!fixed) {
        const Dimension dimension = slides ? Dimension::length : Dimension::angle;
        row.push_back({"range", array(std::array{joint.range.min, joint.range.max}, dimension)});
        row.push_back({"home", quantity(joint.home, dimension)});
        if (joint.free) row.push_back({"free", "true"});
      }
      add_source(row, joint.source, joint.sources);
      table("[[joint]]", row);
    }
  }

  void write_mechanism(const LegsDescription& legs) {
    Lines lines{{"type", text("legs")}, {"platform", text(platform_name(legs.platform))}};
    add_source(lines, legs.source, legs.sources);
    table("[mechanism]", lines);
    for (const LegDescription& leg : legs.legs) {
      const bool rigid = leg.attachment == Attachment::rigid;
      Lines lines_of_leg{{"name", text(leg.name)},
                         {"tip", array(leg.tip, Dimension::length)},
                         {"attachment", text(rigid ? "rigid" : "spherical")},
                         {"platform_point", array(leg.platform_point, Dimension::length)}};
      if (leg.platform_rotation != Matrix3::Identity()) {
        lines_of_leg.push_back({"platform_rotation", rows(leg.platform_rotation, Dimension::number)});
      }
      table("[[leg]]", lines_of_leg);
      for (const JointDescription& joint : leg.joints) write(joint);
    }
  }

  void write(const JointDescription& joint) {
    const Dimension dimension = joint.type == JointType::prismatic ? Dimension::length : Dimension::angle;
    Lines lines{{"name", text(joint.name)}, {"type", text(std::string(name_of(joint.type)))}};
    if (joint.active) lines.push_back({"active", "true"});
    if (joint.free) lines.push_back({"free", "true"});
    lines.push_back({"axis", array(joint.axis, Dimension::number)});
    lines.push_back({"point", array(joint.point, Dimension::length)});
    if (joint.range != JointDescription{}.range) {
      lines.push_back({"range", array(std::array{joint.range.min, joint.range.max}, dimension)});
    }
    lines.push_back({"home", quantity(joint.home, dimension)});
    table("[[leg.joint]]", lines);
  }

  void write(const BodyDescription& body) {
    Lines lines{{"on", text(body.on)}};
    if (!body.turns_with.empty()) {
      lines.push_back({"turns_with", text(body.turns_with)});
      lines.push_back({"pivot", array(body.pivot, Dimension::length)});
    }
    if (body.beam) {
      add_source(lines, body.source, body.sources);
      table("[[body]]", lines);
      std::visit([this](const auto& beam) { write_beam(beam); }, *body.beam);
      return;
    }
    lines.push_back({"mass", quantity(body.mass, Dimension::mass)});
    lines.push_back({"centre", array(body.centre, Dimension::length)});
    lines.push_back({"inertia", symmetric(body.inertia)});
    add_source(lines, body.source, body.sources);
    table("[[body]]", lines);
  }

  void write_beam(const TubeDescription& tube) {
    Lines lines;
    add_fields(lines, tube, TubeDescription{});
    add_wall(lines, tube.wall);
    add_source(lines, tube.source, tube.sources);
    table("[body.tube]", lines);
  }

  void write_beam(const BarDescription& bar) {
    Lines lines;
    add_fields(lines, bar, BarDescription{});
    if (!bar.width_along.isZero(0.0))
      lines.push_back({"width_along", array(bar.width_along, Dimension::number)});
    add_wall(lines, bar.wall);
    add_source(lines, bar.source, bar.sources);
    table("[body.bar]", lines);
  }

  void add_wall(Lines& lines, const WallDescription& wall) {
    if (const auto* material = std::get_if<Material>(&wall)) {
      lines.push_back({"material", part(*material, catalogue_)});
      return;
    }
    const LaminateDescription& laminate = std::get<LaminateDescription>(wall);
    std::string plies;
    for (const PlyDescription& ply : laminate.plies) {
      plies += fmt::format("{}{{ count = {}, angle = {} }}", plies.empty() ? "" : ", ", ply.count,
                           quantity(ply.angle, Dimension::angle));
    }
    lines.push_back(
        {"laminate", fmt::format("{{ lamina = {}, plies = [{}], rule = {} }}",
                                 part(laminate.lamina, catalogue_), plies, text(to_string(laminate.rule)))});
  }

  void write(const LoadDescription& load) {
    Lines lines{{"name", text(load.name)},
                {"force", array(load.force, Dimension::force)},
                {"moment", array(load.moment, Dimension::torque)},
                {"moment_frame", text(to_string(load.moment_frame))},
                {"kind", text(to_string(load.kind))}};
    add_source(lines, load.source, load.sources);
    table("[[load]]", lines);
  }

  void write(const PostureDescription& posture, const std::vector<Dimension>& dimensions) {
    std::string joints;
    for (std::size_t i = 0; i < posture.joints.size(); ++i)
      joints += (joints.empty() ? "" : ", ") + quantity(posture.joints[i], dimensions[i]);
    Lines lines{{"name", text(posture.name)}, {"joints", '[' + joints + ']'}};
    add_source(lines, posture.source, posture.sources);
    table("[[posture]]", lines);
  }

  void write(const DriveDescription& drive) {
    Lines lines{{"joints", drive.joints.empty() ? text("all") : list(drive.joints)},
                {"motor", part(drive.motor, catalogue_)},
                {"encoder", part(drive.encoder, catalogue_)},
                {"amplifier", part(drive.amplifier, catalogue_)}};
    add_fields(lines, drive, DriveDescription{});
    add_source(lines, drive.source, drive.sources);
    table("[[drive]]", lines);

    std::visit([this](const auto& transmission) { write_transmission(transmission); }, drive.transmission);
    if (drive.preloader) {
      Lines preloader;
      add_fields(preloader, *drive.preloader, FlexureDescription{});
      preloader.push_back({"material", part(drive.preloader->material, catalogue_)});
      add_source(preloader, drive.preloader->source, drive.preloader->sources);
      table("[drive.preloader]", preloader);
    }
    if (drive.output) {
      Lines output;
      add_fields(output, *drive.output, DriveOutputDescription{});
      add_source(output, drive.output->source, drive.output->sources);
      table("[drive.output]", output);
    }
  }

  void write(const PneumaticDriveDescription& drive) {
    Lines lines{{"joints", drive.joints.empty() ? text("all") : list(drive.joints)},
                {"cylinder", part(drive.cylinder, catalogue_)},
                {"regulator", part(drive.regulator, catalogue_)}};
    if (drive.potentiometer) lines.push_back({"potentiometer", part(*drive.potentiometer, catalogue_)});
    add_fields(lines, drive, PneumaticDriveDescription{});
    add_source(lines, drive.source, drive.sources);
    table("[[drive]]", lines);
    if (const auto* arm = std::get_if<ArmCylinderDescription>(&drive.mount)) {
      Lines mount{{"layout", text(to_string(arm->layout))}};
      add_fields(mount, *arm, ArmCylinderDescription{});
      add_source(mount, arm->source, arm->sources);
      table("[drive.mount]", mount);
    }
  }

  void write_transmission(const DirectDriveDescription&) {
    table("[drive.transmission]", {{"type", text("direct")}});
  }

  void write_transmission(const CapstanDescription& capstan) {
    Lines lines{{"type", text("capstan")}};
    CapstanDescription start;
    start.mid_angle = kNotGiven;  // left out it would follow the joint's range
    add_fields(lines, capstan, start);
    lines.push_back({"cable", part(capstan.cable, catalogue_)});
    add_source(lines, capstan.source, capstan.sources);
    table("[drive.transmission]", lines);
  }

  void write_transmission(const RatioDescription& ratio) {
    Lines lines{{"type", text("ratio")}};
    add_fields(lines, ratio, RatioDescription{});
    add_source(lines, ratio.source, ratio.sources);
    table("[drive.transmission]", lines);
  }

  void write_transmission(const GearheadDescription& gear) {
    Lines lines{{"type", text("gearhead")}, {"gearhead", part(gear.gearhead, catalogue_)}};
    add_fields(lines, gear, GearheadDescription{});
    add_source(lines, gear.source, gear.sources);
    table("[drive.transmission]", lines);
  }

  std::ostream& out_;
  const Catalogue& catalogue_;
  bool first_ = true;
};

}  // namespace

void write_description(const Description& description, std::ostream& out, const Catalogue& catalogue) {
  Writer(out, catalogue).write(description);
}

}  // namespace zwidth
