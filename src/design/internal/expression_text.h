#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "zwidth/description/units.h"

/// How numbers and names are told apart in expressions.

namespace zwidth::internal {

inline constexpr const char* kNameCharacters =
    "0123456789_.[]abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

inline bool digit(char c) {
  return c >= '0' && c <= '9';
}
inline bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
inline bool name_start(char c) {
  return letter(c) || c == '_';
}
inline bool name_character(char c) {
  return std::string_view(kNameCharacters).find(c) != std::string_view::npos;
}
inline bool number_start(std::string_view text, std::size_t at) {
  return digit(text[at]) || (text[at] == '.' && at + 1 < text.size() && digit(text[at + 1]));
}

// Where the number that starts at `from` ends.
inline std::size_t number_end(std::string_view text, std::size_t from) {
  std::size_t end = from;
  const auto digits = [&] {
    while (end < text.size() && digit(text[end])) ++end;
  };
  digits();
  if (end < text.size() && text[end] == '.') {
    ++end;
    digits();
  }
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    std::size_t power = end + 1;
    if (power < text.size() && (text[power] == '+' || text[power] == '-')) ++power;
    if (power < text.size() && digit(text[power])) {
      end = power;
      digits();
    }
  }
  return end;
}

// The unit behind a number, in one word or several: "60 mm", "0.1 N m".
struct NumberUnit {
  std::string text;                     ///< empty if there is none
  std::size_t end = 0;                  ///< of number and unit
  std::optional<AnyQuantity> quantity;  ///< both; nothing where the text is no unit
};
// Of the number from `from` to `end`.
inline NumberUnit number_unit(std::string_view text, std::size_t from, std::size_t end) {
  NumberUnit found{.text = "", .end = end, .quantity = std::nullopt};
  const std::string number(text.substr(from, end - from));
  std::size_t at = end;
  while (true) {
    std::size_t word = at;
    while (word < text.size() && text[word] == ' ') ++word;
    std::size_t word_end = word;
    while (word_end < text.size() && letter(text[word_end])) ++word_end;
    if (word_end == word || (at > end && word == at)) break;
    // The first word is a unit or nothing; those behind it may be names.
    const std::string words = found.text.empty() ? std::string(text.substr(word, word_end - word))
                                                 : std::string(text.substr(end, word_end - end));
    const std::size_t next = text.find_first_not_of(' ', word_end);
    const bool name = word_end < text.size() && name_character(text[word_end]);
    const bool called = next != std::string_view::npos && text[next] == '(';
    if (!found.text.empty() && (name || called)) break;
    const std::optional<AnyQuantity> quantity = parse_any_quantity(number + " " + words);
    if (!found.text.empty() && !quantity) break;
    found = {.text = words, .end = word_end, .quantity = quantity};
    if (!quantity) break;
    at = word_end;
  }
  return found;
}

}  // namespace zwidth::internal
