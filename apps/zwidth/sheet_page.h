#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sheet_arm.h"
#include "sheet_figures.h"
#include "statistic_text.h"

#include "zwidth/description/values.h"

namespace zwidth {

/// A cell of a table; `kind` is its class.
std::string cell(const std::string& text, const char* kind = "");
/// "12.5 mm" without zeros at its end.
std::string trimmed_quantity(double value, std::string_view unit);
/// The source of a value; one that is chosen has a tag.
std::string source_cell(const std::string& source, bool chosen);
/// With a capital letter first.
std::string sentence(std::string text);

/// A page of a data sheet under construction: its sections, and what they are made of.
class SheetPage {
 public:
  SheetPage(const DataSheet& sheet, const Description& description, const std::vector<SheetFigure>& figures,
            const std::vector<std::string>& overrides);

  const DataSheet& sheet() const { return sheet_; }
  const Description& description() const { return description_; }
  const std::vector<std::string>& overrides() const { return overrides_; }
  const std::vector<DescribedValue>& values() const { return values_; }
  const std::vector<std::pair<std::string, std::string>>& contents() const { return contents_; }  ///< id, title
  const std::string& body() const { return body_; }

  void section(const std::string& id, const std::string& title);
  void add(const std::string& html) { body_ += html; }
  void how(const std::string& text);
  /// Those of a section, "three" beside each other if they are small.
  void show_figures(const std::string& of_section, const char* kind = "");
  void tile(const std::string& value, const std::string& label);
  /// The values of the file that are wanted, under their tables if `grouped`.
  void values_table(const std::function<bool(const DescribedValue&)>& wanted, bool grouped);
  void facts(const std::vector<ArmFact>& lines);

  /// A table of statistics: its head, rows, and end. With `quantiles`, median and 95th percentile instead of
  /// means.
  void statistics_head(const std::string& over, bool quantiles = false);
  void statistics_head(double spacing, bool quantiles = false);
  template <class Statistic>
  void statistics(const std::string& name, const Statistic& statistic, double factor, const std::string& unit) {
    statistics_row(statistic_cells(name, statistic, factor, unit, quantiles_));
  }
  void statistics_row(const std::vector<std::string>& cells);
  void statistics_end();

  /// Whether `--set` changed this value: keys are compared without their indices.
  bool overridden(const DescribedValue& value) const;

 private:
  std::string value_text(const DescribedValue& value) const;
  std::string source_of(const DescribedValue& value) const;

  const DataSheet& sheet_;
  const Description& description_;
  const std::vector<SheetFigure>& figures_;
  const std::vector<std::string>& overrides_;
  std::vector<DescribedValue> values_;
  std::vector<std::pair<std::string, std::string>> contents_;
  std::string body_, rows_;
  std::vector<std::vector<std::string>> shown_;  // rows of the table under construction
  bool quantiles_ = false;
};

/// Sections of a tool that also turns: workspace, reach, orientations, home posture, and tables over postures.
void write_arm(SheetPage& page);
/// Apparent mass, and stiffness with vibration.
void write_inertia(SheetPage& page);
void write_stiffness(SheetPage& page);

}  // namespace zwidth
