#pragma once

#include <cstddef>
#include <string_view>

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

}  // namespace zwidth::internal
