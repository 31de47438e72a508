#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "zwidth/description/catalogue.h"
#include "zwidth/description/read.h"

namespace zwidth {

inline const Catalogue& catalogue() {
  static const Catalogue loaded = Catalogue::load();
  return loaded;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::string delta_text() {
  return text_of(catalogue().directory() / "devices" / "delta.toml");
}

/// A slider crank: one leg slides, the other turns; both carry the platform, which moves freely.
inline std::string legs_text() {
  return R"([device]
name = "slider"

[mechanism]
type = "legs"
platform = "rigid"

[[leg]]
name = "crank"
tip = ["300 mm", 0, 0]
attachment = "rigid"
[[leg.joint]]
name = "turn"
type = "revolute"
active = true
axis = [0, 0, 2]
point = [0, 0, 0]
range = ["-170 deg", "170 deg"]
home = "30 deg"
[[leg.joint]]
name = "knee"
type = "revolute"
axis = [0, 0, 1]
point = ["100 mm", 0, 0]

[[leg]]
name = "rail"
tip = ["300 mm", 0, 0]
attachment = "spherical"
platform_point = [0, 0, 0]
[[leg.joint]]
name = "slide"
type = "prismatic"
axis = [1, 0, 0]
point = ["250 mm", 0, 0]
range = ["-200 mm", "200 mm"]

[[body]]
on = "crank/knee"
mass = "10 g"
centre = ["200 mm", 0, 0]
inertia = ["1 g cm^2", "34 g cm^2", "34 g cm^2", "0.5 g cm^2", 0, 0]
source = "chosen: for the test"
)";
}

/// The text with the first occurrence of `from` replaced.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the text has no " + from);
  return text.replace(at, from.size(), to);
}

inline std::vector<Problem> problems_of(const std::string& text,
                                        const std::vector<std::string>& overrides = {}) {
  try {
    parse_description(text, "x.toml", overrides, catalogue());
  } catch (const DescriptionError& error) {
    return error.problems();
  }
  return {};
}

/// The only problem; one that says so if there is none, or more than one.
inline Problem problem_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const std::vector<Problem> problems = problems_of(text, overrides);
  if (problems.size() == 1) return problems.front();
  std::string all = std::to_string(problems.size()).append(" problems");
  for (const Problem& problem : problems) all.append("\n").append(to_string(problem));
  return {.rule = all};
}

/// Line and column at which `part` starts, as problems count them.
inline std::pair<int, int> place_of(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  const auto line =
      static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')) + 1;
  const std::size_t start = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  return {line, static_cast<int>(at - start) + 1};
}

}  // namespace zwidth
