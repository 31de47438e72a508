#include "zwidth/description/keys.h"

#include <algorithm>
#include <cmath>

#include "zwidth/description/internal/schema.h"
#include "zwidth/description/names.h"

namespace zwidth {
namespace {

std::string component(const std::string& key, std::size_t index) {
  return key + '[' + std::to_string(index) + ']';
}

// Walks through a description in the order of its file and keeps what it meets.
class Walker {
 public:
  void walk(Description& description) {
    note_sources(description);
    vector("device.gravity", description.gravity, Dimension::acceleration);
    std::visit([this](auto& mechanism) { walk(mechanism); }, description.mechanism);
    std::size_t index = 0;
    for (BodyDescription& body : description.bodies) walk(body, join_path("body", index++));
    index = 0;
    for (DriveDescription& drive : description.drives) walk(drive, join_path("drive", index++));
    for (PneumaticDriveDescription& drive : description.pneumatic_drives) {
      walk(drive, join_path("drive", index++));
    }
    index = 0;
    for (LoadDescription& load : description.loads) {
      const std::string path = join_path("load", index++);
      note_sources(load);
      vector(path + ".force", load.force, Dimension::force);
      vector(path + ".moment", load.moment, Dimension::torque);
    }
    const std::vector<Dimension> dimensions = active_joint_dimensions(description.mechanism);
    index = 0;
    for (PostureDescription& posture : description.postures) {
      const std::string path = join_path("posture", index++) + ".joints";
      note_sources(posture);
      for (std::size_t i = 0; i < posture.joints.size(); ++i) {
        number(component(path, i), posture.joints[i], dimensions[i]);
      }
    }
  }

  std::vector<NumberSlot> numbers;
  std::vector<PartSlot> parts;

 private:
  void number(std::string key, double& value, Dimension dimension) {
    numbers.push_back({std::move(key), dimension, sources_, &value});
  }
  void vector(const std::string& key, Vector3& value, Dimension dimension) {
    for (std::size_t i = 0; i < 3; ++i) number(component(key, i), value[static_cast<int>(i)], dimension);
  }
  void interval(const std::string& key, Interval& value, Dimension dimension) {
    number(component(key, 0), value.min, dimension);
    number(component(key, 1), value.max, dimension);
  }

  // Where the values of a table are said to come from.
  template <class Owner>
  void note_sources(Owner& owner) {
    if constexpr (requires { owner.sources; }) {
      sources_ = &owner.sources;
    } else if constexpr (requires { owner.info.sources; }) {
      sources_ = &owner.info.sources;
    } else {
      sources_ = nullptr;
    }
  }

  template <class Owner>
  void fields_of(Owner& owner, const std::string& path) {
    note_sources(owner);
    for (const Field<Owner>& field : fields<Owner>()) {
      const std::string key = join_path(path, field.key);
      std::visit(
          [&](auto member) {
            auto& value = owner.*member;
            using Value = std::remove_reference_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, Interval>) {
              interval(key, value, field.dimension);
            } else if constexpr (std::is_same_v<Value, Vector3>) {
              vector(key, value, field.dimension);
            } else {
              numbers.push_back({key, field.dimension, sources_, &value});
            }
          },
          field.member);
    }
  }

  template <class Part>
  void part(Part& value, const std::string& path) {
    const std::string key = join_path(path, part_kind<Part>());
    parts.push_back({key, &value});
    fields_of(value, key);
  }

  // Mechanisms.
  void walk(DeltaDescription& mechanism) { fields_of(mechanism, "mechanism"); }
  void walk(FiveBarDescription& mechanism) { fields_of(mechanism, "mechanism"); }
  void walk(RCubeDescription& mechanism) { fields_of(mechanism, "mechanism"); }
  void walk(SerialDescription& mechanism) {
    std::size_t index = 0;
    for (SerialJointDescription& joint : mechanism.joints) {
      const std::string path = join_path("joint", index++);
      fields_of(joint, path);
      const Dimension dimension =
          joint.type == SerialJointType::prismatic ? Dimension::length : Dimension::angle;
      if (joint.type == SerialJointType::fixed) continue;
      interval(path + ".range", joint.range, dimension);
      number(path + ".home", joint.home, dimension);
    }
  }
  void walk(LegsDescription& mechanism) {
    sources_ = nullptr;
    std::size_t index = 0;
    for (LegDescription& leg : mechanism.legs) {
      const std::string path = join_path("leg", index++);
      std::size_t j = 0;
      for (JointDescription& joint : leg.joints) {
        const std::string inner = join_path(path + ".joint", j++);
        const Dimension dimension = joint.type == JointType::prismatic ? Dimension::length : Dimension::angle;
        vector(inner + ".axis", joint.axis, Dimension::number);
        vector(inner + ".point", joint.point, Dimension::length);
        interval(inner + ".range", joint.range, dimension);
        number(inner + ".home", joint.home, dimension);
      }
      vector(path + ".tip", leg.tip, Dimension::length);
      vector(path + ".platform_point", leg.platform_point, Dimension::length);
    }
  }

  // Bodies.
  void walk(WallDescription& wall, const std::string& path) {
    if (auto* material = std::get_if<Material>(&wall)) {
      part(*material, path);
      return;
    }
    auto& laminate = std::get<LaminateDescription>(wall);
    part(laminate.lamina, path + ".laminate");
    std::size_t index = 0;
    for (PlyDescription& ply : laminate.plies) {
      fields_of(ply, join_path(path + ".laminate.plies", index++));
    }
  }
  void walk(BodyDescription& body, const std::string& path) {
    if (body.beam) {
      const bool tube = std::holds_alternative<TubeDescription>(*body.beam);
      const std::string key = path + (tube ? ".tube" : ".bar");
      std::visit(
          [&](auto& beam) {
            fields_of(beam, key);
            walk(beam.wall, key);
          },
          *body.beam);
      return;
    }
    note_sources(body);
    number(path + ".mass", body.mass, Dimension::mass);
    vector(path + ".centre", body.centre, Dimension::length);
    vector(path + ".pivot", body.pivot, Dimension::length);
    for (std::size_t i = 0; i < 3; ++i) {
      number(component(path + ".inertia", i), body.inertia(static_cast<int>(i), static_cast<int>(i)),
             Dimension::inertia);
    }
  }

  // Drives.
  void walk(DirectDriveDescription&, const std::string&) {}
  void walk(CapstanDescription& capstan, const std::string& path) {
    fields_of(capstan, path);
    part(capstan.cable, path);
  }
  void walk(RatioDescription& ratio, const std::string& path) { fields_of(ratio, path); }
  void walk(GearheadDescription& gear, const std::string& path) {
    part(gear.gearhead, path);
    fields_of(gear, path);
  }
  void walk(DriveDescription& drive, const std::string& path) {
    part(drive.motor, path);
    part(drive.encoder, path);
    part(drive.amplifier, path);
    fields_of(drive, path);
    std::visit([&](auto& transmission) { walk(transmission, path + ".transmission"); }, drive.transmission);
    if (drive.preloader) {
      fields_of(*drive.preloader, path + ".preloader");
      part(drive.preloader->material, path + ".preloader");
    }
    if (drive.output) fields_of(*drive.output, path + ".output");
  }
  void walk(PneumaticDriveDescription& drive, const std::string& path) {
    part(drive.cylinder, path);
    part(drive.regulator, path);
    if (drive.potentiometer) part(*drive.potentiometer, path);
    fields_of(drive, path);
    if (auto* arm = std::get_if<ArmCylinderDescription>(&drive.mount)) fields_of(*arm, path + ".mount");
  }

  Sources* sources_ = nullptr;
};

// "drive.0.motor" as "drive[0].motor".
std::string bracketed(std::string_view key) {
  std::string result;
  for (std::size_t i = 0; i < key.size();) {
    const std::size_t end = std::min(key.find('.', i), key.size());
    const std::string_view piece = key.substr(i, end - i);
    const bool index =
        !piece.empty() && std::all_of(piece.begin(), piece.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (index && i > 0) {
      result += '[' + std::string(piece) + ']';
    } else {
      if (i > 0) result += '.';
      result += piece;
    }
    i = end + 1;
  }
  return result;
}

// Whether `key` of a slot is meant by `wanted`, which may leave out the index of an array of tables: one that
// is followed by a dot.
bool means(std::string_view wanted, std::string_view key) {
  std::size_t w = 0, k = 0;
  while (k < key.size()) {
    if (w < wanted.size() && wanted[w] == key[k]) {
      ++w;
      ++k;
      continue;
    }
    if (key[k] != '[') return false;
    const std::size_t close = key.find(']', k);
    if (close + 1 >= key.size() || key[close + 1] != '.') return false;
    k = close + 1;
  }
  return w == wanted.size();
}

template <class Slot>
std::vector<Slot> meant(std::vector<Slot> slots, std::string_view key) {
  const std::string wanted = bracketed(key);
  std::erase_if(slots, [&](const Slot& slot) { return !means(wanted, slot.key); });
  return slots;
}

}  // namespace

double NumberSlot::get() const noexcept {
  return std::visit([](const auto* value) { return static_cast<double>(*value); }, at);
}

void NumberSlot::set_source(const std::string& source) const {
  if (sources == nullptr) return;
  std::string field = key.substr(key.rfind('.') + 1);
  (*sources)[field.substr(0, field.find('['))] = source;
}

void NumberSlot::set(double value) const noexcept {
  if (const auto* real = std::get_if<double*>(&at)) {
    **real = value;
  } else {
    constexpr double kLargest = 1e9;
    *std::get<int*>(at) = static_cast<int>(std::lround(std::clamp(value, -kLargest, kLargest)));
  }
}

std::string_view PartSlot::kind() const {
  return std::visit([](const auto* part) { return part_kind<std::remove_cvref_t<decltype(*part)>>(); }, at);
}

const std::string& PartSlot::name() const {
  return std::visit([](const auto* part) -> const std::string& { return part->info.name; }, at);
}

void PartSlot::set(const PartSlot& other) const {
  std::visit([&](auto* part) { *part = *std::get<std::remove_cvref_t<decltype(part)>>(other.at); }, at);
}

std::vector<NumberSlot> number_slots(Description& description) {
  Walker walker;
  walker.walk(description);
  return std::move(walker.numbers);
}

std::vector<PartSlot> part_slots(Description& description) {
  Walker walker;
  walker.walk(description);
  return std::move(walker.parts);
}

std::vector<NumberSlot> find_numbers(Description& description, std::string_view key) {
  return meant(number_slots(description), key);
}

std::vector<PartSlot> find_parts(Description& description, std::string_view key) {
  return meant(part_slots(description), key);
}

std::vector<std::string> part_names(const PartSlot& slot, const Catalogue& catalogue) {
  std::vector<std::string> names;
  std::visit(
      [&](const auto* part) {
        for (const auto& one : catalogue.all<std::remove_cvref_t<decltype(*part)>>()) {
          names.push_back(one.info.name);
        }
      },
      slot.at);
  return names;
}

bool choose_part(const PartSlot& slot, std::string_view name, const Catalogue& catalogue) {
  return std::visit(
      [&](auto* part) {
        const auto* chosen = catalogue.find<std::remove_cvref_t<decltype(*part)>>(name);
        if (chosen != nullptr) *part = *chosen;
        return chosen != nullptr;
      },
      slot.at);
}

}  // namespace zwidth
