#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <utility>
#include <vector>

#include "zwidth/description/internal/input.h"
#include "zwidth/description/internal/schema.h"

/// Reading TOML into structs without stopping at the first mistake: every look at a table that finds something
/// wrong notes a problem, with its place, and goes on.

namespace zwidth {

/// One table being read. Every key that is asked for counts as known; `finish` complains about the others.
class TableReader {
 public:
  TableReader(Input& input, const toml::table& table, std::string path)
      : input_(&input), table_(&table), path_(std::move(path)) {}

  Input& input() const { return *input_; }
  const std::string& path() const { return path_; }
  std::string path(std::string_view key) const { return join_path(path_, key); }

  /// Whether the file has this key; it counts as known from here on.
  bool has(std::string_view key) { return look(key) != nullptr; }
  bool has_table(std::string_view key);

  /// All fields of a struct. A required one that is missing is a problem unless `partial`.
  template <class Owner>
  void read(Owner& owner, bool partial = false);

  // Each returns nothing if the key is missing (a problem if it is required) or its value is no such thing
  // (always one).
  std::optional<std::string> text(std::string_view key, Need need, std::string_view advice = {});
  std::optional<bool> flag(std::string_view key, Need need);
  std::optional<double> quantity(std::string_view key, Dimension dimension, Need need,
                                 std::string_view advice = {});
  /// An array whose entries have dimensions of their own, one each.
  std::optional<std::vector<double>> quantities(std::string_view key, const std::vector<Dimension>& dimensions,
                                                Need need, std::string_view advice = {});
  std::optional<Vector3> vector(std::string_view key, Dimension dimension, Need need,
                                std::string_view advice = {});
  std::optional<Interval> interval(std::string_view key, Dimension dimension, Need need,
                                   std::string_view advice = {});
  /// Rows of 3 x 3.
  std::optional<Matrix3> matrix(std::string_view key, Dimension dimension, Need need,
                                std::string_view advice = {});
  /// 3 x 3, [xx, yy, zz], or [xx, yy, zz, xy, xz, yz].
  std::optional<Matrix3> symmetric(std::string_view key, Dimension dimension, Need need,
                                   std::string_view advice = {});
  std::optional<std::vector<std::string>> texts(std::string_view key, std::string_view advice);
  /// A number, or an expression in a string, as text.
  std::optional<std::string> expression(std::string_view key, Need need, std::string_view advice = {});
  /// An array of them; empty if missing.
  std::vector<std::string> expressions(std::string_view key, std::string_view advice);
  /// A number, or a quantity of any dimension.
  std::optional<AnyQuantity> any_quantity(std::string_view key, Need need, std::string_view advice = {});
  template <class Enum>
  std::optional<Enum> choice(std::string_view key, const std::vector<std::pair<std::string, Enum>>& choices,
                             Need need);
  std::optional<TableReader> table(std::string_view key, Need need, std::string_view advice = {});
  /// An array of tables; empty if missing.
  std::vector<TableReader> tables(std::string_view key);
  /// The keys of this table, in the order of their names.
  std::vector<std::string> keys() const;
  /// The tables in this one, in the order of the file.
  std::vector<std::pair<std::string, TableReader>> all_tables();

  /// `source` and `sources`.
  void read_sources(std::string& source, std::map<std::string, std::string>& sources, Need need);

  void report(std::string_view key, std::string rule, std::string advice);
  /// Notes the keys that nobody asked for.
  void finish();

 private:
  const toml::node* look(std::string_view key);
  const toml::node* look(std::string_view key, Need need, std::string_view advice);
  std::optional<double> number(const toml::node& node, const std::string& path, Dimension dimension);
  std::optional<std::vector<double>> numbers(const toml::node& node, const std::string& path,
                                             Dimension dimension, const std::vector<std::size_t>& sizes,
                                             std::string_view advice);
  std::optional<Matrix3> rows(const toml::array& array, const std::string& path, Dimension dimension,
                              std::string_view advice);

  Input* input_;
  const toml::table* table_;
  std::string path_;
  std::vector<std::string> known_;
};

template <class Owner>
void TableReader::read(Owner& owner, bool partial) {
  for (const Field<Owner>& field : fields<Owner>()) {
    const Need need = partial ? Need::optional : field.need;
    const std::string advice =
        "give the " + std::string(field.meaning) + ", such as " + std::string(field.example);
    std::visit(
        [&](auto member) {
          using Value = std::remove_reference_t<decltype(owner.*member)>;
          if constexpr (std::is_same_v<Value, double>) {
            if (const auto value = quantity(field.key, field.dimension, need, advice)) owner.*member = *value;
          } else if constexpr (std::is_same_v<Value, int>) {
            if (const auto value = quantity(field.key, field.dimension, need, advice)) {
              if (*value == std::floor(*value) && std::abs(*value) < 1e6) {
                owner.*member = static_cast<int>(*value);
              } else {
                report(field.key, "must be a whole number below a million", advice);
              }
            }
          } else if constexpr (std::is_same_v<Value, Vector3>) {
            if (const auto value = vector(field.key, field.dimension, need, advice)) owner.*member = *value;
          } else {
            static_assert(std::is_same_v<Value, Interval>);
            if (const auto value = interval(field.key, field.dimension, need, advice)) owner.*member = *value;
          }
        },
        field.member);
  }
}

template <class Enum>
std::optional<Enum> TableReader::choice(std::string_view key,
                                        const std::vector<std::pair<std::string, Enum>>& choices, Need need) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.push_back(name);
  const std::optional<std::string> chosen = text(key, need, suggest("", names));
  if (!chosen) return std::nullopt;
  for (const auto& [name, value] : choices) {
    if (name == *chosen) return value;
  }
  report(key, "is not known", suggest(*chosen, names));
  return std::nullopt;
}

}  // namespace zwidth
