#include "zwidth/description/internal/table_reader.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace zwidth {

const toml::node* TableReader::look(std::string_view key) {
  known_.emplace_back(key);
  return table_->get(key);
}

const toml::node* TableReader::look(std::string_view key, Need need, std::string_view advice) {
  const toml::node* node = look(key);
  if (node == nullptr && need == Need::required) report(key, "is missing", std::string(advice));
  return node;
}

void TableReader::report(std::string_view key, std::string rule, std::string advice) {
  input_->report(path(key), std::move(rule), std::move(advice));
}

bool TableReader::has_table(std::string_view key) {
  const toml::node* node = look(key);
  return node != nullptr && node->is_table();
}

std::optional<std::string> TableReader::text(std::string_view key, Need need, std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  if (const toml::value<std::string>* value = node->as_string()) return value->get();
  report(key, fmt::format("must be a string, not {}", kind_of(*node)), std::string(advice));
  return std::nullopt;
}

std::optional<bool> TableReader::flag(std::string_view key, Need need) {
  const toml::node* node = look(key, need, "write true or false");
  if (node == nullptr) return std::nullopt;
  if (const toml::value<bool>* value = node->as_boolean()) return value->get();
  report(key, fmt::format("must be true or false, not {}", kind_of(*node)), "write it without quotes");
  return std::nullopt;
}

std::optional<double> TableReader::number(const toml::node& node, const std::string& path,
                                          Dimension dimension) {
  ParsedQuantity quantity;
  if (const auto* integer = node.as_integer()) {
    quantity.value = static_cast<double>(integer->get());
  } else if (const auto* real = node.as_floating_point()) {
    quantity.value = real->get();
    if (!std::isfinite(real->get())) quantity = {std::nullopt, "must be finite", "give a number"};
  } else if (const auto* text = node.as_string()) {
    quantity = parse_quantity(text->get(), dimension);
  } else {
    quantity.rule = fmt::format("must be {}, not {}", dimension_name(dimension), kind_of(node));
    quantity.advice = "give a number in SI or a string with a unit";
  }
  if (!quantity) input_->report(path, quantity.rule, quantity.advice);
  return quantity.value;
}

std::optional<std::vector<double>> TableReader::numbers(const toml::node& node, const std::string& path,
                                                        Dimension dimension,
                                                        const std::vector<std::size_t>& sizes,
                                                        std::string_view advice) {
  const toml::array* array = node.as_array();
  if (array == nullptr || std::find(sizes.begin(), sizes.end(), array->size()) == sizes.end()) {
    std::string wanted;
    for (const std::size_t size : sizes) wanted += fmt::format("{}{}", wanted.empty() ? "" : " or ", size);
    const std::string found = array == nullptr ? std::string(kind_of(node)) : fmt::format("{}", array->size());
    input_->report(path, fmt::format("must be an array of {}, not {}", wanted, found), std::string(advice));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (const auto value = number(*array->get(i), join_path(path, i), dimension)) values.push_back(*value);
  }
  if (values.size() != array->size()) return std::nullopt;
  return values;
}

std::optional<double> TableReader::quantity(std::string_view key, Dimension dimension, Need need,
                                            std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  return number(*node, path(key), dimension);
}

std::optional<std::vector<double>> TableReader::quantities(std::string_view key,
                                                           const std::vector<Dimension>& dimensions, Need need,
                                                           std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != dimensions.size()) {
    const std::string found = array == nullptr ? std::string(kind_of(*node)) : fmt::format("{}", array->size());
    report(key, fmt::format("must be an array of {}, not {}", dimensions.size(), found), std::string(advice));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (const auto value = number(*array->get(i), join_path(path(key), i), dimensions[i]))
      values.push_back(*value);
  }
  if (values.size() != dimensions.size()) return std::nullopt;
  return values;
}

std::optional<Vector3> TableReader::vector(std::string_view key, Dimension dimension, Need need,
                                           std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  const auto values = numbers(*node, path(key), dimension, {3}, advice);
  if (!values) return std::nullopt;
  return Vector3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<Interval> TableReader::interval(std::string_view key, Dimension dimension, Need need,
                                              std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  const auto values = numbers(*node, path(key), dimension, {2}, advice);
  if (!values) return std::nullopt;
  return Interval{(*values)[0], (*values)[1]};
}

std::optional<Matrix3> TableReader::rows(const toml::array& array, const std::string& path, Dimension dimension,
                                         std::string_view advice) {
  if (array.size() != 3) {
    input_->report(path, fmt::format("must have 3 rows, not {}", array.size()), std::string(advice));
    return std::nullopt;
  }
  Matrix3 matrix = Matrix3::Zero();
  bool complete = true;
  for (int i = 0; i < 3; ++i) {
    const auto row = numbers(*array.get(i), join_path(path, i), dimension, {3}, advice);
    complete = complete && row.has_value();
    if (row) matrix.row(i) = Eigen::Map<const Vector3>(row->data());
  }
  if (!complete) return std::nullopt;
  return matrix;
}

std::optional<Matrix3> TableReader::matrix(std::string_view key, Dimension dimension, Need need,
                                           std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  if (const toml::array* array = node->as_array()) return rows(*array, path(key), dimension, advice);
  report(key, fmt::format("must be an array of 3 rows, not {}", kind_of(*node)), std::string(advice));
  return std::nullopt;
}

std::optional<Matrix3> TableReader::symmetric(std::string_view key, Dimension dimension, Need need,
                                              std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  const toml::array* array = node->as_array();
  if (array != nullptr && !array->empty() && array->get(0)->is_array())
    return rows(*array, path(key), dimension, advice);
  const auto values = numbers(*node, path(key), dimension, {3, 6}, advice);
  if (!values) return std::nullopt;
  const std::vector<double>& v = *values;
  Matrix3 matrix = Vector3(v[0], v[1], v[2]).asDiagonal();
  if (v.size() == 6) {
    matrix(0, 1) = matrix(1, 0) = v[3];
    matrix(0, 2) = matrix(2, 0) = v[4];
    matrix(1, 2) = matrix(2, 1) = v[5];
  }
  return matrix;
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key, std::string_view advice) {
  const toml::node* node = look(key);
  if (node == nullptr) return std::nullopt;
  if (const toml::value<std::string>* value = node->as_string()) return std::vector{value->get()};
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    report(key, fmt::format("must be a string or an array of strings, not {}", kind_of(*node)),
           std::string(advice));
    return std::nullopt;
  }
  std::vector<std::string> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (const toml::value<std::string>* value = array->get(i)->as_string()) {
      values.push_back(value->get());
    } else {
      input_->report(join_path(path(key), i), fmt::format("must be a string, not {}", kind_of(*array->get(i))),
                     std::string(advice));
    }
  }
  return values;
}

namespace {

// The text of a number or a string; empty otherwise.
std::string expression_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
  if (const auto* real = node.as_floating_point(); real != nullptr && std::isfinite(real->get())) {
    return fmt::format("{}", real->get());
  }
  return {};
}

}  // namespace

std::optional<std::string> TableReader::expression(std::string_view key, Need need, std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  std::string text = expression_text(*node);
  if (!text.empty()) return text;
  report(key, fmt::format("must be a number or an expression, not {}", kind_of(*node)), std::string(advice));
  return std::nullopt;
}

std::vector<std::string> TableReader::expressions(std::string_view key, std::string_view advice) {
  const toml::node* node = look(key);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) {
    report(key, fmt::format("must be an array of numbers or expressions, not {}", kind_of(*node)),
           std::string(advice));
    return {};
  }
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < array->size(); ++i) {
    texts.push_back(expression_text(*array->get(i)));
    if (!texts.back().empty()) continue;
    input_->report(join_path(path(key), i),
                   fmt::format("must be a number or an expression, not {}", kind_of(*array->get(i))),
                   std::string(advice));
  }
  return texts;
}

std::optional<AnyQuantity> TableReader::any_quantity(std::string_view key, Need need, std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  const std::string text = expression_text(*node);
  std::optional<AnyQuantity> quantity = parse_any_quantity(text);
  if (!quantity) report(key, "must be a number, or one with a unit", std::string(advice));
  return quantity;
}

std::vector<std::string> TableReader::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, node] : *table_) keys.emplace_back(key.str());
  return keys;
}

std::optional<TableReader> TableReader::table(std::string_view key, Need need, std::string_view advice) {
  const toml::node* node = look(key, need, advice);
  if (node == nullptr) return std::nullopt;
  if (const toml::table* table = node->as_table()) return TableReader(*input_, *table, path(key));
  report(key, fmt::format("must be a table, not {}", kind_of(*node)), std::string(advice));
  return std::nullopt;
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  const toml::node* node = look(key);
  if (node == nullptr) return {};
  std::vector<TableReader> readers;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    report(key, fmt::format("must be an array of tables, not {}", kind_of(*node)),
           fmt::format("start each with [[{}]]", path(key)));
    return {};
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string inner = join_path(path(key), i);
    if (const toml::table* table = array->get(i)->as_table()) {
      readers.emplace_back(*input_, *table, inner);
    } else {
      input_->report(inner, fmt::format("must be a table, not {}", kind_of(*array->get(i))),
                     fmt::format("start each with [[{}]]", path(key)));
    }
  }
  return readers;
}

std::vector<std::pair<std::string, TableReader>> TableReader::all_tables() {
  std::vector<std::pair<std::string, TableReader>> readers;
  for (const auto& [key, node] : *table_) {
    known_.emplace_back(key.str());
    if (const toml::table* table = node.as_table()) {
      readers.emplace_back(std::string(key.str()), TableReader(*input_, *table, path(key.str())));
    } else {
      report(key.str(), fmt::format("must be a table, not {}", kind_of(node)), "start each part with [NAME]");
    }
  }
  std::stable_sort(readers.begin(), readers.end(), [](const auto& a, const auto& b) {
    return a.second.table_->source().begin.line < b.second.table_->source().begin.line;
  });
  return readers;
}

void TableReader::read_sources(std::string& source, std::map<std::string, std::string>& sources, Need need) {
  const std::string_view advice = "say where the values come from; \"chosen: why\" where no source gives them";
  if (const auto value = text("source", need, advice)) source = *value;
  if (auto inner = table("sources", Need::optional, "write sources = { KEY = \"where it comes from\" }")) {
    for (const auto& [key, node] : *inner->table_) {
      const std::string name(key.str());
      if (const auto value = inner->text(name, Need::optional, advice)) sources[name] = *value;
      if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
        inner->report(name, "is the source of a key that this table does not have", suggest(name, known_));
      }
    }
  }
}

void TableReader::finish() {
  std::sort(known_.begin(), known_.end());
  known_.erase(std::unique(known_.begin(), known_.end()), known_.end());
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (!std::binary_search(known_.begin(), known_.end(), name)) {
      input_->report(path(name), "is not a key of this table", suggest(name, known_));
    }
  }
}

}  // namespace zwidth
