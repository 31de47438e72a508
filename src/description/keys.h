#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/description.h"
#include "zwidth/description/units.h"

/// The numbers and parts of a description by the keys that device files give them, for whoever changes designs
/// by name: "mechanism.forearm", "mechanism.joint_range[1]", "drive[0].motor", "body[2].tube.outer_diameter".

namespace zwidth {

/// One number of a description.
struct NumberSlot {
  std::string key;
  Dimension dimension = Dimension::number;
  Sources* sources = nullptr;      ///< of its table; null where a table has none
  std::variant<double*, int*> at;  ///< in the description that was searched; valid while its lists keep their
                                   ///< lengths and its variants their types

  bool whole() const { return std::holds_alternative<int*>(at); }
  double get() const noexcept;
  /// Notes where the value comes from.
  void set_source(const std::string& source) const;
  void set(double value) const noexcept;  ///< a whole number takes the nearest one
};

/// One part of a description, to be changed for another of its kind.
struct PartSlot {
  std::string key;
  std::variant<Motor*, Gearhead*, Encoder*, Amplifier*, Cable*, Material*, Lamina*, Cylinder*, Regulator*,
               Potentiometer*>
      at;

  std::string_view kind() const;          ///< "motor", "gearhead", ...
  const std::string& name() const;        ///< of the part that is there
  void set(const PartSlot& other) const;  ///< copies the part of `other`. REQUIRES: it is of the same kind
};

/// Every number of a description, in the order of its tables; of parts those that a file may override.
std::vector<NumberSlot> number_slots(Description& description);
std::vector<PartSlot> part_slots(Description& description);

/// Those that `key` means: "drive.motor" and "drive.0.motor" are understood as after `--set`, without an index
/// every element of an array of tables is meant. Empty if there is none.
std::vector<NumberSlot> find_numbers(Description& description, std::string_view key);
std::vector<PartSlot> find_parts(Description& description, std::string_view key);

/// The parts of the kind of `slot` in the catalogue, by name.
std::vector<std::string> part_names(const PartSlot& slot, const Catalogue& catalogue);
/// Puts the catalogue's part of that name in the slot; false if there is none.
bool choose_part(const PartSlot& slot, std::string_view name, const Catalogue& catalogue);

}  // namespace zwidth
