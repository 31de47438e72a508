#pragma once

#include <string>
#include <vector>

/// What a device or parts file may hold, as text. The tables of docs/device_file.md are printed from this.

namespace zwidth {

/// One key.
struct KeyReference {
  std::string key;
  std::string takes;     ///< "length [m]", "string", "\"rigid\" or \"spherical\""
  std::string left_out;  ///< what stands in when it is left out; "required" if nothing does
  std::string rule;      ///< what must hold
  std::string meaning;
  std::string example;  ///< as TOML; empty where a table or another form is meant
};

/// One table.
struct TableReference {
  std::string name;  ///< "delta", "drive", "motor"
  std::vector<KeyReference> keys;
};

/// All tables, in the order of a device file, then the parts.
std::vector<TableReference> file_reference();

/// One table as Markdown.
std::string markdown(const TableReference& table);

}  // namespace zwidth
