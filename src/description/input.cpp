#include "zwidth/description/internal/input.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <sstream>

#include "zwidth/description/internal/schema.h"

namespace zwidth {
namespace {

constexpr std::size_t kMostKeyParts = 16;  // no key of a description has more than five
constexpr int kDeepestNesting = 32;        // of arrays and inline tables

[[noreturn]] void refuse(std::string_view file, std::string rule, std::string advice) {
  throw DescriptionError({{.file = std::string(file), .rule = std::move(rule), .advice = std::move(advice)}});
}

// TOML parsers recurse on nesting, and a key of 500 000 parts nests as deep as that. This looks at the text
// only far enough to tell strings from the rest, and refuses what would be too deep. On text that is no TOML it
// may misjudge, but only after the place where the parser stops.
class DepthCheck {
 public:
  DepthCheck(std::string_view text, std::string_view file) : text_(text), file_(file) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      ++at_;
      if (c == '#') {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      } else if (c == '.') {
        if (++dots_ >= kMostKeyParts) stop(fmt::format("has a key of more than {} parts", kMostKeyParts));
      } else if (c == '\n' || c == '=' || c == ',') {
        dots_ = 0;
      } else if (c == '[' || c == '{') {
        dots_ = 0;
        if (++depth_ > kDeepestNesting) stop(fmt::format("nests deeper than {} brackets", kDeepestNesting));
      } else if (c == ']' || c == '}') {
        dots_ = 0;
        depth_ = std::max(0, depth_ - 1);
      }
    }
  }

 private:
  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool long_string = text_.substr(at_, 3) == triple;
    at_ += long_string ? 3 : 1;
    while (at_ < text_.size()) {
      if (quote == '"' && text_[at_] == '\\') {
        at_ += 2;
      } else if (long_string && text_.substr(at_, 3) == triple) {
        at_ += 3;
        while (at_ < text_.size() && text_[at_] == quote) ++at_;  // quotes at the end belong to the string
        return;
      } else if (!long_string && (text_[at_] == quote || text_[at_] == '\n')) {
        ++at_;
        return;
      } else {
        ++at_;
      }
    }
  }

  [[noreturn]] void stop(std::string rule) const {
    const auto line = static_cast<int>(std::count(text_.begin(), text_.begin() + at_, '\n')) + 1;
    throw DescriptionError({{.file = std::string(file_),
                             .line = line,
                             .column = 1,
                             .rule = std::move(rule),
                             .advice = "this is no description; see docs/device_file.md"}});
  }

  std::string_view text_;
  std::string_view file_;
  std::size_t at_ = 0;
  std::size_t dots_ = 0;
  int depth_ = 0;
};

std::string show_whole(const toml::node& node) {
  if (node.is_table()) return "{...}";
  if (const toml::array* array = node.as_array()) {
    std::string list;
    for (const toml::node& element : *array) list += (list.empty() ? "" : ", ") + show_whole(element);
    return '[' + list + ']';
  }
  if (const toml::value<double>* number =
          node.as_floating_point()) {  // as short as it can be told, as people write it
    std::string text = fmt::format("{}", number->get());
    return text.find_first_of(".en") == text.npos ? text + ".0" : text;
  }
  std::ostringstream out;
  node.visit([&out](const auto& value) { out << toml::toml_formatter{value, toml::format_flags::none}; });
  return out.str();
}

std::string show(const toml::node& node) {
  return shortened(show_whole(node));
}

// "drive[0].motor" or "drive.0.motor" in parts: drive, 0, motor. Empty if it is no key.
std::vector<std::string> split_key(std::string_view key) {
  std::vector<std::string> parts;
  std::string part;
  const auto end_part = [&] {
    parts.push_back(part);
    part.clear();
  };
  bool after_index = false;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const char c = key[i];
    if (c == '.') {
      if (!after_index) end_part();
      after_index = false;
    } else if (c == '[') {
      const std::size_t close = key.find(']', i);
      if (close == key.npos) return {};
      if (!after_index) end_part();
      part = std::string(key.substr(i + 1, close - i - 1));
      end_part();
      after_index = true;
      i = close;
    } else if (c == '"') {
      const std::size_t close = key.find('"', i + 1);
      if (close == key.npos || after_index) return {};
      part += std::string(key.substr(i + 1, close - i - 1));
      i = close;
    } else {
      if (after_index) return {};
      part += c;
    }
  }
  if (!after_index) end_part();
  const bool complete =
      std::none_of(parts.begin(), parts.end(), [](const std::string& p) { return p.empty(); });
  return complete && parts.size() <= kMostKeyParts ? parts : std::vector<std::string>{};
}

std::optional<std::size_t> index_of(const std::string& part) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error != std::errc() || end != part.data() + part.size()) return std::nullopt;
  return index;
}

// Whether `inner` is `outer` or a key in it.
bool within(const std::string& inner, const std::string& outer) {
  if (outer.empty()) return true;
  return inner.starts_with(outer) &&
         (inner.size() == outer.size() || inner[outer.size()] == '.' || inner[outer.size()] == '[');
}

void assign(toml::table& table, const std::string& key, const toml::node& value) {
  value.visit([&](const auto& concrete) { table.insert_or_assign(key, concrete); });
}

// VALUE of an override: TOML if it is one value, else a string.
toml::table parse_value(const std::string& text) {
  try {
    DepthCheck(text, "").run();
    toml::table table = toml::parse("value = " + text);
    if (table.size() == 1 && text.find('\n') == text.npos) return table;
  } catch (const toml::parse_error&) {
  } catch (const DescriptionError&) {
  }
  return toml::table{{"value", text}};
}

[[noreturn]] void refuse_length(std::string_view file) {
  refuse(file, fmt::format("is longer than {} KiB", kLargestFile / 1024),
         "a description has a few pages: check that this is the file you mean");
}

}  // namespace

std::string_view kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    default:
      return "a date or time";
  }
}

std::string read_text(const std::string& path) {
  const auto read_all = [](std::istream& in) {
    std::string text;
    std::array<char, 1 << 14> block{};
    while (text.size() <= kLargestFile && in) {
      in.read(block.data(), block.size());
      text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    }
    return text;
  };
  const std::string file = path == "-" ? "<stdin>" : path;
  std::string text;
  if (path == "-") {
    text = read_all(std::cin);
  } else {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) {
      refuse(file, "there is no such file", "check the path");
    }
    if (status.type() == std::filesystem::file_type::directory) {
      refuse(file, "is a directory", "name a TOML file in it");
    }
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    if (!in) refuse(file, fmt::format("cannot be read: {}", std::strerror(errno)), "check its permissions");
    text = read_all(in);
    if (in.bad()) refuse(file, "cannot be read to its end", "check the disk");
  }
  if (text.size() > kLargestFile) refuse_length(file);
  return text;
}

Input::Input(std::string_view text, std::string_view file) : file_(file) {
  if (text.size() > kLargestFile) refuse_length(file);
  DepthCheck(text, file).run();
  try {
    root_ = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position& at = error.source().begin;
    constexpr std::size_t kLongest = 160;
    const std::string_view what = error.description().substr(0, kLongest);
    std::string rule = fmt::format("is not TOML: {}", what);
    std::string advice = "mend this line first; what is wrong elsewhere shows when the file can be read";
    if (what.find("utf-8") != what.npos) {
      advice = "save the file as UTF-8";
    } else if (what.find("end-of-file") != what.npos) {
      advice = "the file seems to be cut off here: is it complete?";
    }
    throw DescriptionError({{.file = file_,
                             .line = static_cast<int>(at.line),
                             .column = static_cast<int>(at.column),
                             .rule = std::move(rule),
                             .advice = std::move(advice)}});
  }
}

void Input::set(const std::string& override_text) {
  const std::size_t equals = override_text.find('=');
  std::string key = override_text.substr(0, equals);
  while (equals != std::string::npos && key.ends_with(' ')) key.pop_back();
  const std::vector<std::string> parts = split_key(key);
  const std::string label = "--set " + shortened(parts.empty() ? override_text : key);
  const auto wrong = [&](std::string rule, std::string advice) {
    problems_.push_back({.file = label, .rule = std::move(rule), .advice = std::move(advice)});
  };
  if (equals == std::string::npos) {
    wrong("has no value", "write --set KEY=VALUE, such as --set mechanism.forearm=\"170 mm\"");
    return;
  }
  if (parts.empty()) {
    wrong("is no key", "write a dotted path, such as mechanism.forearm or drive[0].motor");
    return;
  }
  if (parts.size() == 1 && !root_.contains(key)) {
    for (const auto& [name, node] : root_) {
      const toml::table* table = node.as_table();
      if (table == nullptr || !table->contains(key)) continue;
      wrong("is not at the top of the file",
            fmt::format("did you mean {}?", join_path(std::string(name.str()), key)));
      return;
    }
  }
  const toml::table value = parse_value(override_text.substr(equals + 1));
  set_in(root_, parts, 0, "", *value.get("value"), label);
}

void Input::set_in(toml::node& node, const std::vector<std::string>& parts, std::size_t next,
                   const std::string& path, const toml::node& value, const std::string& label) {
  const std::string& part = parts[next];
  const bool last = next + 1 == parts.size();
  const auto wrong = [&](std::string rule, std::string advice) {
    problems_.push_back({.file = label, .key = path, .rule = std::move(rule), .advice = std::move(advice)});
  };

  if (toml::array* array = node.as_array()) {
    if (const std::optional<std::size_t> index = index_of(part)) {
      if (*index >= array->size()) {
        wrong(fmt::format("has no element {}", *index),
              fmt::format("it has {}, counted from 0", array->size()));
        return;
      }
      const std::string inner = join_path(path, *index);
      if (!last) {
        set_in(*array->get(*index), parts, next + 1, inner, value, label);
        return;
      }
      value.visit([&](const auto& concrete) {
        array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*index), concrete);
      });
      overridden_[inner] = label;
      return;
    }
    for (std::size_t i = 0; i < array->size(); ++i)
      set_in(*array->get(i), parts, next, join_path(path, i), value, label);
    if (array->empty()) wrong("has no elements", "");
    return;
  }

  toml::table* table = node.as_table();
  if (table == nullptr) {
    wrong(fmt::format("is {}, which has no \"{}\"", kind_of(node), shortened(part)), "set the value itself");
    return;
  }
  const std::string inner = join_path(path, part);
  if (last) {
    assign(*table, part, value);
    overridden_[inner] = label;
    return;
  }
  toml::node* child = table->get(part);
  if (child == nullptr) {
    child = &table->insert(part, toml::table{}).first->second;
    overridden_[inner] = label;
  } else if (const toml::value<std::string>* name = child->as_string()) {
    // A part by name becomes that part with a value replaced. Where no part is meant, reading will say so.
    const std::string base = name->get();
    child = &table->insert_or_assign(part, toml::table{{"base", base}}).first->second;
    overridden_[inner] = label;
  }
  set_in(*child, parts, next + 1, inner, value, label);
}

Input::Found Input::find(const std::string& path) const {
  Found found{.node = &root_, .path = {}, .complete = true};
  if (path.empty()) return found;
  for (const std::string& part : split_key(path)) {
    const toml::node* inner = nullptr;
    if (const toml::table* table = found.node->as_table()) {
      inner = table->get(part);
      if (inner != nullptr) found.path = join_path(found.path, part);
    } else if (const toml::array* array = found.node->as_array()) {
      const std::optional<std::size_t> index = index_of(part);
      if (index) inner = array->get(*index);
      if (inner != nullptr) found.path = join_path(found.path, *index);
    }
    if (inner == nullptr) {
      found.complete = false;
      break;
    }
    found.node = inner;
  }
  return found;
}

void Input::place(Problem& problem) const {
  const Found found = find(problem.key);
  if (found.complete && problem.value.empty() && !problem.key.empty() && !found.node->is_table()) {
    problem.value = show(*found.node);
  }
  std::size_t longest = 0;
  for (const auto& [path, label] : overridden_) {
    if (within(found.path, path) && path.size() >= longest) {
      problem.file = label;
      longest = path.size();
    }
  }
  if (!problem.file.empty()) return;
  problem.file = file_;
  if (found.node->source().begin.line > 0) {
    problem.line = static_cast<int>(found.node->source().begin.line);
    problem.column = static_cast<int>(found.node->source().begin.column);
  }
}

void Input::report(const std::string& path, std::string rule, std::string advice) {
  Problem problem{.key = path, .rule = std::move(rule), .advice = std::move(advice)};
  place(problem);
  problems_.push_back(std::move(problem));
}

bool Input::faulty(const std::string& path) const {
  return std::any_of(problems_.begin(), problems_.end(), [&](const Problem& problem) {
    const std::string& key = problem.key;
    if (key.empty()) return false;
    // Without its type a table means nothing.
    constexpr std::string_view kType = ".type";
    if (key.ends_with(kType) && within(path, key.substr(0, key.size() - kType.size()))) return true;
    return within(key, path) || within(path, key);
  });
}

void Input::alias(std::string path, std::string in_file) {
  aliases_[std::move(path)] = std::move(in_file);
}

void Input::add_value_problems(const std::vector<Problem>& problems) {
  std::vector<Problem> placed;
  for (Problem problem : problems) {
    const std::size_t table = std::min(problem.key.find('.'), problem.key.size());
    if (const auto known = aliases_.find(problem.key.substr(0, table)); known != aliases_.end()) {
      problem.key = known->second + problem.key.substr(table);
    }
    if (faulty(problem.key)) continue;
    placed.push_back(problem);
    placed.back().value.clear();  // what the user wrote says more than its SI value
    place(placed.back());
    if (placed.back().value.empty()) placed.back().value = problem.value;
  }
  problems_.insert(problems_.end(), placed.begin(), placed.end());
}

void Input::throw_problems() {
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  throw DescriptionError(std::move(problems_));
}

}  // namespace zwidth
