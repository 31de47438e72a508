#pragma once

#include <string>
#include <vector>

#include "zwidth/description/description.h"
#include "zwidth/description/units.h"

namespace zwidth {

/// One quantity that a device file gives: what it is and where it comes from.
struct DescribedValue {
  std::string table;           ///< dotted path of its table: "mechanism", "drive[0].transmission", "body[2]"
  std::string key;             ///< in that table
  std::vector<double> values;  ///< SI: one number, the two ends of a range, or the components of a vector
  Dimension dimension = Dimension::number;
  std::string meaning;  ///< a phrase without its unit
  std::string source;   ///< its own, else its table's, else the device's

  bool given() const { return !values.empty() && zwidth::given(values.front()); }
  bool chosen() const {
    return source.starts_with("chosen");
  }  ///< by the author of the file: no source gives it
};

/// Every quantity of mechanism (a delta's; the joints of a spelled-out mechanism are geometry, not parameters),
/// bodies, drives and loads, in the order of the file, and of the parts of electric drives what was chosen;
/// `part_values` lists all of a part.
std::vector<DescribedValue> described_values(const Description& description);

}  // namespace zwidth
