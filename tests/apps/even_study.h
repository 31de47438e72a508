#pragma once

#include <string>

namespace zwidth::testing {

/// A study of the five-bar that takes milliseconds a generation: even in a square of 60 mm, and short.
inline std::string even_study(int generations) {
  return R"toml([study]
name = "even"
device = "five-bar"
[search]
population = 20
generations = )toml" +
         std::to_string(generations) + R"toml(
[[variable]]
key = "mechanism.crank"
min = "8 cm"
max = "14 cm"
[[variable]]
key = "mechanism.coupler"
min = "9 cm"
max = "18 cm"
[[measure]]
name = "condition"
figure = "condition_number"
over = "box"
position = [0, "150 mm", 0]
size = ["60 mm", "60 mm", 0]
points = 3
statistic = "max"
[[objective]]
name = "worst"
minimise = "condition"
[[objective]]
name = "length"
minimise = "crank + coupler"
[[constraint]]
name = "well conditioned"
value = "condition"
max = 5
)toml";
}

}  // namespace zwidth::testing
